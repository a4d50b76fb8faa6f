#!/bin/sh
# Makes the gateway on this machine one of a fleet, with the files beside this one (make-fleet): its
# key, and [mqtt] in its settings. Run it as root.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# Another root, such as of an image: then nothing is started.
root=${DESTDIR-}
settings=$root/etc/etcm/gateway.toml

# Site and name of [mqtt], and not those of a bus.
whose() {
  awk '/^[[:space:]]*\[/ { is_it = /^[[:space:]]*\[mqtt\]/ }
    is_it && /^[[:space:]]*(site|name)[[:space:]]*=/ { gsub(/#.*|[[:space:]]/, ""); print }' "$1" | sort
}

if [ ! -e "$settings" ]; then
  echo "install.sh: there is no $settings; install the package etcm-gateway first" >&2
  exit 1
fi
if ! grep -q '^[[:space:]]*\[mqtt\]' "$settings"; then
  cp -p "$settings" "$settings.before"
  cat "$here/mqtt.toml" >>"$settings"
elif [ "$(whose "$settings")" != "$(whose "$here/mqtt.toml")" ]; then
  echo "install.sh: $settings has another [mqtt]; put the lines of $here/mqtt.toml in its place, and again" >&2
  exit 1
fi
install -m 600 "$here/mqtt.psk" "$root/etc/etcm/mqtt.psk"
unit=$root/etc/systemd/system/etcm-gateway.service.d
mkdir -p "$unit"
printf '[Service]\nLoadCredential=mqtt.psk:/etc/etcm/mqtt.psk\n' >"$unit/mqtt.conf"
chmod 644 "$unit/mqtt.conf"
[ -z "$root" ] || exit 0

systemctl daemon-reload
systemctl enable --quiet etcm-gateway
systemctl restart etcm-gateway
sleep 5
journalctl -u etcm-gateway -n 1 --no-pager -o cat --since -10s --grep '^broker |\[mqtt\]' ||
  journalctl -u etcm-gateway -n 5 --no-pager -o cat

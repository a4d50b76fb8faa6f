#!/bin/sh
# Makes Mosquitto on this machine the broker of a fleet, with the files beside this one (make-fleet).
# Run it as root, and again whenever they are others.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# Another root, such as of an image: then nothing is started.
root=${DESTDIR-}

if [ -z "$root" ] && ! command -v mosquitto >/dev/null; then
  echo "install.sh: there is no Mosquitto here; apt-get install mosquitto, and again" >&2
  exit 1
fi

# What is there and differs stays beside it.
put() {
  if [ -e "$2" ] && ! cmp -s "$1" "$2"; then
    cp -p "$2" "$2.before"
    echo "$2 was another one: that is $2.before now"
  fi
  cp "$1" "$2"
  chmod "$3" "$2"
}
mkdir -p "$root/etc/mosquitto/conf.d"
# Who is in the fleet is read again without an end of the connections there are.
how=reload
cmp -s "$here/etcm.conf" "$root/etc/mosquitto/conf.d/etcm.conf" || how=restart
put "$here/etcm.conf" "$root/etc/mosquitto/conf.d/etcm.conf" 644
put "$here/etcm.acl" "$root/etc/mosquitto/etcm.acl" 640
put "$here/etcm.psk" "$root/etc/mosquitto/etcm.psk" 640
[ -z "$root" ] || exit 0

chgrp mosquitto /etc/mosquitto/etcm.acl /etc/mosquitto/etcm.psk
systemctl enable --quiet mosquitto
systemctl is-active --quiet mosquitto || how=restart
systemctl "$how" mosquitto
sleep 1
if systemctl is-active --quiet mosquitto; then
  echo "the broker listens on port 8883; let a firewall pass it from the gateways"
else
  journalctl -u mosquitto -n 5 --no-pager >&2
  tail -n 5 /var/log/mosquitto/mosquitto.log >&2 || true
  echo "install.sh: Mosquitto does not start; the lines above say why" >&2
  exit 1
fi

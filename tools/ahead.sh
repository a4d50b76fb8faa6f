# Makes things ahead, beside a command that goes on meanwhile. To be sourced by bash after setup.sh.
#
#   ahead_begin FUNCTION    runs it in the time that the caller leaves, and ends it with the caller
#   ahead_make NAME COMMAND...  in that function: runs this for an `ahead_await NAME`
#   ahead_await NAME        waits for it and shows what it has said; ends where it failed

# It has no share of the processors as long as anything else wants them, such as a test that looks at
# the clock. Who waits for it leaves them to it.
ahead_begin() {
  ahead_folder=$(mktemp -d)
  trap 'kill -- "-$ahead_group" 2>/dev/null || true; rm -rf "$ahead_folder"' EXIT
  # In a group of its own, for it starts programs that start others.
  set -m
  (
    set +m
    trap - EXIT
    chrt --idle --pid 0 "$BASHPID" 2>/dev/null || renice -n 19 "$BASHPID" >/dev/null
    "$1"
  ) &
  ahead_group=$!
  set +m
}

ahead_make() {
  local said=$ahead_folder/$1 status=0
  ("${@:2}") >"$said.saying" 2>&1 || status=$?
  echo "$status" >"$said.status"
  mv "$said.saying" "$said.said"
  ((status == 0)) || exit 1
}

ahead_await() {
  local said=$ahead_folder/$1
  until [[ -f $said.said ]]; do
    kill -0 "$ahead_group" 2>/dev/null || [[ -f $said.said ]] || etcm_fail "nobody makes $1 any more"
    [[ ! -t 1 ]] || printf '\r\033[K%-28s %s' "$1: build" "$(etcm_progress "$(etcm_log "$1: build")")"
    sleep 0.3
  done
  [[ ! -t 1 ]] || printf '\r\033[K'
  cat "$said.said"
  [[ $(<"$said.status") == 0 ]] || exit 1
}

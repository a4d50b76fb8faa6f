# Shared by the commands in tools/; to be sourced by bash after `set -euo pipefail`.
#
#   etcm_root                     the project's folder
#   etcm_require GROUP...         installs the packages of these groups (tools/packages) that are
#                                 missing; does nothing, quickly, when none is
#   etcm_step LABEL COMMAND...    runs the command with its output in a log, shows one line with the
#                                 progress and the time; if it fails, shows what failed and ends
#   etcm_log LABEL                the file with the output of the step of that label
#   etcm_packages GROUP...        the names of the packages of these groups
#   etcm_build_all PRESET [OPTION...] [-- TARGET...]  configures with everything that the preset and
#                                 the options have, and builds it, or these targets of it
#   etcm_build PRESET TARGET...   configures and builds these programs; asks for no package that only
#                                 tests or measurements need

etcm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
etcm_log_dir=$etcm_root/build/log

# From one run to the next little changes, and clones share what they compile.
etcm_cache_objects() {
  command -v ccache >/dev/null || return 0
  export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  export CCACHE_BASEDIR=$etcm_root CCACHE_NOHASHDIR=1
}
etcm_cache_objects

etcm_fail() {
  printf '%s: %s\n' "$(basename "$0")" "$1" >&2
  exit 1
}

etcm_packages() {
  local group
  for group in "$@"; do
    awk -v group="$group" '$1 == group {print $2}' "$etcm_root/tools/packages"
  done
}

# By itself, or as a part of another package: Node.js of its makers brings npm along.
etcm_is_installed() {
  # Asking each by name: one question for all of them ends at the first unknown one.
  [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]] ||
    dpkg-query -W -f '${db:Status-Status}, ${Provides},\n' |
    grep -E "^installed, (.*, )?$1( \(.*\))?," >/dev/null
}

etcm_require() {
  local package missing=()
  for package in $(etcm_packages "$@"); do
    etcm_is_installed "$package" || missing+=("$package")
  done
  ((${#missing[@]} == 0)) && return

  local as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null ||
      etcm_fail "needs root to install packages; as root, run: apt-get install ${missing[*]}"
    as_root=(sudo)
    sudo -v || etcm_fail "sudo refused; as root, run: apt-get install ${missing[*]}"
  fi
  command -v apt-get >/dev/null ||
    etcm_fail "knows only apt; install these by hand: ${missing[*]}"
  etcm_step "package lists" "${as_root[@]}" apt-get -q update
  etcm_step "install ${#missing[@]} packages" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q install -y --no-install-recommends "${missing[@]}"
  etcm_cache_objects
}

# The last "12/345" of a log: Ninja and CTest both write it.
etcm_progress() {
  tail -c 2000 "$1" 2>/dev/null | grep -oE '(^|\[| )[0-9]+/[0-9]+' | tail -n 1 | tr -d '[ ' || true
}

# What a person needs of a failed step's log.
etcm_show_failure() {
  grep -vE '^ *Start +[0-9]+:|[ .]Passed +[0-9.]+ sec|^\[[0-9]+/[0-9]+\] (Building|Linking)' "$1" |
    tail -n "${ETCM_FAILURE_LINES:-80}"
  printf 'the whole log: %s\n' "$1"
}

etcm_log() {
  printf '%s/%s.log' "$etcm_log_dir" "${1//[^a-zA-Z0-9]/_}"
}

etcm_step() {
  local label=$1 started=$SECONDS log status=0 watcher=
  shift
  mkdir -p "$etcm_log_dir"
  log=$(etcm_log "$label")
  : >"$log"
  # The watcher is the one in the background, so that an interrupt reaches the command.
  if [[ -t 1 ]]; then
    while kill -0 $$ 2>/dev/null; do
      printf '\r\033[K%-28s %s' "$label" "$(etcm_progress "$log")"
      sleep 0.3
    done &
    watcher=$!
  fi
  "$@" </dev/null >"$log" 2>&1 || status=$?
  if [[ -n $watcher ]]; then
    kill "$watcher" 2>/dev/null || true
    wait "$watcher" 2>/dev/null || true
    printf '\r\033[K'
  fi
  if ((status != 0)); then
    printf '%-28s FAILED after %d s\n' "$label" $((SECONDS - started))
    etcm_show_failure "$log"
    exit 1
  fi
  printf '%-28s done in %d s\n' "$label" $((SECONDS - started))
}

etcm_build_all() {
  local preset=$1 options=() targets=()
  shift
  while (($# > 0)) && [[ $1 != -- ]]; do
    options+=("$1")
    shift
  done
  (($# < 2)) || targets=(--target "${@:2}")
  cd "$etcm_root"
  etcm_step "$preset: configure" cmake --preset "$preset" -DETCM_BUILD_TESTS=ON "${options[@]}"
  etcm_step "$preset: build" cmake --build --preset "$preset" "${targets[@]}"
}

etcm_build() {
  local preset=$1 options=()
  shift
  cd "$etcm_root"
  # A build that has more stays as it is.
  [[ -f build/$preset/build.ninja ]] || options=(-DETCM_BUILD_TESTS=OFF -DETCM_BUILD_BENCH=OFF)
  etcm_step "$preset: configure" cmake --preset "$preset" "${options[@]}"
  etcm_step "$preset: build" cmake --build --preset "$preset" --target "$@"
}

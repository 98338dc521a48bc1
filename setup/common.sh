# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# Shared by the setup scripts. Source it after `set -euo pipefail`.

# shellcheck disable=SC2034  # for the scripts that source this
FORMWRIGHT_ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
FORMWRIGHT_CACHE_DIR="${FORMWRIGHT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/formwright}"
# Later make targets and CMake must agree on the place, wherever they look.
export FORMWRIGHT_CACHE="$FORMWRIGHT_CACHE_DIR"

# Node.js, if setup/native.sh had to bring its own.
PRIVATE_NODE="$FORMWRIGHT_CACHE_DIR/node"
if [ -x "$PRIVATE_NODE/bin/node" ]; then PATH="$PRIVATE_NODE/bin:$PATH"; fi

# Progress line with the seconds since the script began; on stderr, because
# some scripts answer on stdout.
say() { printf '[%4d s] %s\n' "$SECONDS" "$*" >&2; }

# One sentence on what is wrong, one on how to fix it.
fail() {
  printf 'setup: %s\n' "$1" >&2
  [ $# -lt 2 ] || printf 'setup: fix: %s\n' "$2" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "root rights are needed to run: $*" "run as root, or install sudo"
  fi
}

# Holds an exclusive lock until this script ends.
take_lock() {  # name
  mkdir -p "$FORMWRIGHT_CACHE_DIR"
  exec 9>"$FORMWRIGHT_CACHE_DIR/.lock-$1"
  if ! flock --nonblock 9; then
    say "another run holds the lock '$1'; waiting for it"
    flock 9
  fi
}

# Lists "base suite" for the Debian archives that this machine already uses,
# whatever the format of its source lists. No host name is written here.
configured_archives() {
  # shellcheck disable=SC2016  # apt expands these, not the shell
  apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' | sort -u
}

host_codename() {
  # shellcheck disable=SC1091
  (. /etc/os-release && printf '%s' "${VERSION_CODENAME:?}")
}

# Base address of the archive that serves this machine's own release.
debian_archive() {
  local codename base
  codename="$(host_codename)"
  base="$(configured_archives | awk -v suite="$codename" '$2 == suite { print $1; exit }')"
  [ -n "$base" ] || fail "no apt source serves '$codename'" \
    "configure this machine's Debian archive in /etc/apt/sources.list.d"
  printf '%s' "$base"
}

# Writes an apt configuration that shares nothing with the system except its
# network settings, and reads its package lists. Sets APT_CONFIG.
private_apt() {  # directory, then lines "deb|deb-src base suite"
  local dir="$1" keyring=/usr/share/keyrings/debian-archive-keyring.gpg
  shift
  [ -e "$keyring" ] || fail "$keyring is missing" "apt-get install debian-archive-keyring"
  local network
  network="$(apt-config dump | grep -E '^Acquire::(Check|http|https|Retries|ForceIPv)' || true)"
  mkdir -p "$dir"/state/lists/partial "$dir"/cache/archives/partial
  : >"$dir/status"
  local line type rest
  for line in "$@"; do
    read -r type rest <<<"$line"
    printf '%s [signed-by=%s] %s main\n' "$type" "$keyring" "$rest"
  done >"$dir/sources.list"
  cat >"$dir/apt.conf" <<CONF
Dir::Etc::parts "/dev/null";
Dir::Etc::sourcelist "$dir/sources.list";
Dir::Etc::sourceparts "/dev/null";
Dir::Etc::preferences "/dev/null";
Dir::Etc::preferencesparts "/dev/null";
Dir::State "$dir/state";
Dir::State::status "$dir/status";
Dir::Cache "$dir/cache";
APT::Sandbox::User "";
APT::Get::AllowUnauthenticated "false";
Acquire::Languages "none";
$network
CONF
  export APT_CONFIG="$dir/apt.conf"
  # apt-get update reports an unusable archive as a mere warning: make it fail.
  apt-get -qq -o APT::Update::Error-Mode=any update >"$dir/update.log" 2>&1 || {
    tail -n 5 "$dir/update.log" >&2
    fail "the package lists could not be read or verified" \
      "check the network; if a key is missing, apt-get install --only-upgrade debian-archive-keyring"
  }
}

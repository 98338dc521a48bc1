#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Installs the Debian package into a bare system of this machine's release, made in the cache folder, and runs it there:
# an example, the worker's answer, the manual, the completions. Needs root rights.
#   setup/test_package.sh [PACKAGE.deb]   without a name, the newest in build-package/
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$FORMWRIGHT_ROOT"

package="${1-$(find build-package -maxdepth 1 -name 'formwright_*.deb' -printf '%T@ %p\n' 2>/dev/null | sort -n | tail -n 1 | cut -d ' ' -f 2-)}"
[ -f "$package" ] || fail "there is no package to test" "run make package, or name one"
[ "$(id -u)" -eq 0 ] || fail "a system in a folder needs root rights" "run this script as root"
command -v debootstrap >/dev/null || fail "debootstrap is missing" "run setup/native.sh --test"

bare="$FORMWRIGHT_CACHE_DIR/bare-$(host_codename)"
if [ ! -e "$bare/complete" ]; then
  take_lock bare
  rm -rf "$bare"
  say "making a bare system"
  debootstrap --variant=minbase "$(host_codename)" "$bare/root" "$(debian_archive)" >"$FORMWRIGHT_CACHE_DIR/bare.log" 2>&1 ||
    fail "the bare system could not be made" "read $FORMWRIGHT_CACHE_DIR/bare.log"
  touch "$bare/complete"
fi

work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cp -a "$bare/root" "$work/root"
cp "$package" "$work/root/tmp/formwright.deb"
cp /etc/resolv.conf "$work/root/etc/" 2>/dev/null || true
apt-config dump | grep -E '^Acquire::(http|https|Retries|ForceIPv|Check)' >"$work/root/etc/apt/apt.conf.d/90network" || true

# The processor's own instructions must not be needed: nothing of AVX may stand in the program.
dpkg-deb -x "$package" "$work/files"
avx="$(objdump -d --no-show-raw-insn "$work/files/usr/bin/formwright" | grep -cE '%[yz]mm[0-9]' || true)"
[ "$avx" -eq 0 ] ||
  fail "the package's program has $avx AVX instructions, which not every x86-64 processor knows" "build it with setup/build.sh package"

# The program finds its page by /proc.
inside() {
  # shellcheck disable=SC2016  # for the inner shell
  unshare --mount --propagation private bash -c 'mount -t proc proc "$1/proc" && exec chroot "$@"' bash "$work/root" \
    /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 "$@"
}
say "installing"
inside apt-get -qq update
inside apt-get -qq -y install --no-install-recommends /tmp/formwright.deb >"$work/install.log" 2>&1 || {
  tail -n 20 "$work/install.log" >&2
  fail "the package could not be installed" "read the lines above"
}
say "running"
inside formwright --version
inside formwright list --json >/dev/null
inside formwright relief --sample torus --thickness-mm 5 --width-mm 60 --out /tmp/relief
[ -s "$work/root/tmp/relief/report.json" ]
# From here the worker is asked, since the bare system has no program that could.
inside formwright serve --port 0 --data /tmp/data >"$work/serve.log" 2>&1 &
serving=$!
trap 'kill $serving 2>/dev/null || true; rm -rf "$work"' EXIT
for _ in $(seq 100); do
  address="$(grep -oE -m 1 'http://127.0.0.1:[0-9]+' "$work/serve.log" || true)"
  [ -z "$address" ] || break
  sleep 0.1
done
[ -n "$address" ] || fail "the installed worker did not start" "read: $(cat "$work/serve.log")"
python3 - "$address" "$work/serve.log" <<'PYTHON'
import json, re, sys, urllib.request
address, log = sys.argv[1], open(sys.argv[2]).read()
token = re.search(r"#token=(\w+)", log).group(1)
page = urllib.request.urlopen(address + "/").read().decode()
assert "<title>Formwright</title>" in page, "the page is not served"
wasm = urllib.request.urlopen(address + "/wasm/formwright.wasm").read()
assert wasm[:4] == b"\0asm", "the page's solver is not served"
status = urllib.request.urlopen(urllib.request.Request(address + "/api/status", headers={"Authorization": "Bearer " + token})).read()
print("worker:", json.loads(status)["version"])
PYTHON
kill "$serving"
wait "$serving" 2>/dev/null || true
for file in usr/share/man/man1/formwright.1 usr/share/bash-completion/completions/formwright usr/share/zsh/vendor-completions/_formwright \
  usr/share/fish/vendor_completions.d/formwright.fish usr/lib/systemd/user/formwright.service usr/share/doc/formwright/copyright; do
  [ -s "$work/files/$file" ] || [ -s "$work/files/$file.gz" ] || fail "$file is not in the package" "see cmake/install.cmake"
done
grep -q '^ExecStart=/usr/bin/formwright serve' "$work/files/usr/lib/systemd/user/formwright.service" ||
  fail "the service starts another program than the package's" "see cmake/install.cmake"
inside apt-get -qq -y remove formwright >/dev/null 2>&1
[ ! -e "$work/root/usr/bin/formwright" ] || fail "the package leaves its program behind when it is removed" "see cmake/install.cmake"
say "the package installs, runs and leaves: $package ($(stat -c %s "$package") bytes)"

#!/usr/bin/env bash
# The commands of the README on another Debian: in a bare one, made by debootstrap, a copy of these
# sources installs what it needs, compiles, runs, and passes the first tier of its tests.
#   tests/distribution.sh RELEASE [COMMAND ...]
# RELEASE is bookworm, trixie, sid ...; a COMMAND takes the place of the two of the README. The bare
# Debian and its packages stay for the next time in $STICKSLIP_ROOTS (/var/cache/stickslip-roots).
set -euo pipefail
sources=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/debian_root.sh
. "$sources/tests/debian_root.sh"

release=${1:?a release of Debian, such as trixie}
shift
roots=${STICKSLIP_ROOTS:-/var/cache/stickslip-roots}
system=$roots/$release.$$
make_root "$release" "$roots/$release"

discard() {
  for folder in proc sys var/cache/apt/archives; do
    if mountpoint -q "$system/$folder"; then umount "$system/$folder"; fi
  done
  rm -rf --one-file-system "$system"
}
trap discard EXIT
trap 'exit 1' INT TERM
cp -a "$roots/$release" "$system"
mkdir -p "$system/stickslip" "$roots/packages"
tar -C "$sources" --exclude-vcs --exclude='./build*' -c . | tar -C "$system/stickslip" -x
mount -t proc proc "$system/proc"
mount -t sysfs -o ro sysfs "$system/sys"
mount --bind "$roots/packages" "$system/var/cache/apt/archives"

if [ $# -gt 0 ]; then
  inside "$system" /stickslip "$@"
else
  inside "$system" /stickslip ./bootstrap run -options_file options/quickstart.opts
  inside "$system" /stickslip ./bootstrap test
fi

#!/usr/bin/env bash
# The Debian package in a bare Debian 12: it installs with what it depends on, runs an installed
# options file, and leaves nothing behind when it is removed. Needs root, debootstrap, a mirror, and a
# build folder with all programs.
#   tests/package.sh BUILD_FOLDER NEW_FOLDER_FOR_THE_SYSTEM [MIRROR]
set -euo pipefail
build=$1 system=$2 mirror=${3:-http://deb.debian.org/debian}

(cd "$build" && cpack -G DEB)
package=$(find "$build" -maxdepth 1 -name 'stickslip_*.deb' | sort | tail -n 1)
[ -e "$system/etc/debian_version" ] || debootstrap --variant=minbase bookworm "$system" "$mirror"

inside() { chroot "$system" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
cp "$package" "$system/root/stickslip.deb"
inside apt-get update -qq
inside apt-get install -y -qq --no-install-recommends /root/stickslip.deb >"$system.log" 2>&1
rm "$system/root/stickslip.deb"
inside stickslip -version
inside stickslip -options_file /usr/share/stickslip/options/quickstart.opts
inside apt-get install -y -qq --no-install-recommends python3-numpy >>"$system.log" 2>&1
inside python3 -c 'import stickslip; print(stickslip.run(mu_d=0.25, quantities="sticking")["P_stick"])'
inside stickslip-complex -options_file /usr/share/stickslip/options/quickstart.opts | grep P_stick

inside apt-get purge -y -qq stickslip >>"$system.log" 2>&1
left=$(find "$system" -xdev -name '*stickslip*' -not -path "$system/var/cache/apt/*")
[ -z "$left" ] || { printf 'left behind:\n%s\n' "$left" >&2; exit 1; }
echo "installed, ran, removed: nothing is left"

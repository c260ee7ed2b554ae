#!/usr/bin/env bash
# The Debian package in a bare Debian: it installs with what it depends on, runs an installed options
# file, and leaves nothing behind when it is removed. Needs root, debootstrap, a mirror, and a build
# folder with all programs, or a package that was made on the same release.
#   tests/package.sh BUILD_FOLDER|PACKAGE NEW_FOLDER_FOR_THE_SYSTEM [RELEASE]
# RELEASE is bookworm unless given.
set -euo pipefail
# shellcheck source=tests/debian_root.sh
. "$(dirname "$0")/debian_root.sh"
package=$1 system=$2 release=${3:-bookworm}

if [ -d "$1" ]; then
  (cd "$1" && cpack -G DEB)
  package=$(find "$1" -maxdepth 1 -name 'stickslip_*.deb' | sort | tail -n 1)
fi
make_root "$release" "$system"

cp "$package" "$system/root/stickslip.deb"
inside "$system" / apt-get update -qq
inside "$system" / apt-get install -y -qq --no-install-recommends /root/stickslip.deb >"$system.log" 2>&1
rm "$system/root/stickslip.deb"
inside "$system" / stickslip -version
inside "$system" / stickslip -options_file /usr/share/stickslip/options/quickstart.opts
inside "$system" / apt-get install -y -qq --no-install-recommends python3-numpy >>"$system.log" 2>&1
inside "$system" / python3 -c 'import stickslip; print(stickslip.run(mu_d=0.25, quantities="sticking")["P_stick"])'
inside "$system" / stickslip-complex -options_file /usr/share/stickslip/options/quickstart.opts | grep P_stick

inside "$system" / apt-get purge -y -qq stickslip >>"$system.log" 2>&1
left=$(find "$system" -xdev -name '*stickslip*' -not -path "$system/var/cache/apt/*")
[ -z "$left" ] || { printf 'left behind:\n%s\n' "$left" >&2; exit 1; }
echo "installed, ran, removed: nothing is left"

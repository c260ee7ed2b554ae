#!/usr/bin/env bash
# Compiles stickslip from the folder above in a bare Debian, installs its package with all that it
# recommends, and removes what only compiling needed, so that the container stays small. Needs root.
set -euo pipefail
cd "$(dirname "$0")/.."
export DEBIAN_FRONTEND=noninteractive
STICKSLIP_BUILD_DIR=$(mktemp -d)  # the one of the sources may be that of another system
export STICKSLIP_BUILD_DIR
install() { apt-get install -y -qq --no-install-recommends "$@" >/dev/null; }

./bootstrap build
mapfile -t tools < <(./bootstrap packages build package)
install "${tools[@]}"
(cd "$STICKSLIP_BUILD_DIR" && cpack -G DEB)
package=$(echo "$STICKSLIP_BUILD_DIR"/stickslip_*.deb)
mapfile -t recommended < <(dpkg-deb -f "$package" Recommends | tr -d ' ' | tr ',' '\n')
chmod 755 "$STICKSLIP_BUILD_DIR"
install "$package" "${recommended[@]}"
apt-get purge -y -qq --autoremove "${tools[@]}" >/dev/null
apt-get clean
rm -rf /var/lib/apt/lists/* "$STICKSLIP_BUILD_DIR"
stickslip -version

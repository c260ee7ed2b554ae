# shellcheck shell=bash
# A bare Debian in a folder, for scripts that try stickslip there. They need root, debootstrap and a
# mirror, $DEBIAN_MIRROR or deb.debian.org.

# Installs a minimal Debian into a folder, unless there is one; half a Debian does not stay.
#   make_root RELEASE FOLDER
make_root() {
  [ -e "$2/etc/debian_version" ] && return
  rm -rf "$2.part"
  mkdir -p "$(dirname "$2")"
  debootstrap --variant=minbase "$1" "$2.part" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$2.log" 2>&1 ||
    { tail -n 20 "$2.log" >&2; return 1; }
  # Mirrors that are snapshots are out of date by intention, and nothing here has to survive a crash.
  echo 'Acquire::Check-Valid-Until "false"; Dpkg::Use-Pty "false";' >"$2.part/etc/apt/apt.conf.d/10tests"
  echo force-unsafe-io >"$2.part/etc/dpkg/dpkg.cfg.d/unsafe-io"
  mv "$2.part" "$2"
}

# Runs a command in the Debian of a folder, in one of its folders, with no variable of this environment
# but STICKSLIP_CMAKE_OPTIONS.
#   inside ROOT FOLDER COMMAND ...
inside() {
  chroot "$1" /usr/bin/env -i -C "$2" PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \
    DEBIAN_FRONTEND=noninteractive STICKSLIP_CMAKE_OPTIONS="${STICKSLIP_CMAKE_OPTIONS:-}" "${@:3}"
}

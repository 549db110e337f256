# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# Bare systems of Debian, for scripts that read this file: the functions below, and $scratch, a folder that goes
# at the end. Exits with 77 where there is no root or no debootstrap. Systems are kept in STRUT_ROOTS for the
# next time; STRUT_MIRROR is where they come from.
if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
  echo "skipped: needs root and debootstrap"
  exit 77
fi
roots=${STRUT_ROOTS:-${TMPDIR:-/tmp}/strut-roots}
mkdir -p "$roots"
scratch=$(mktemp -d "$roots/box.XXXXXX")
clean() {
  for folder in dev proc ''; do
    for box in "$scratch"/*; do ! mountpoint -q "$box/root/$folder" || umount -l "$box/root/$folder"; done
  done
  grep -q "$scratch" /proc/mounts || rm -rf --one-file-system "$scratch"
}
trap clean EXIT
trap 'exit 1' HUP INT TERM

# open_box NAME BASE: $scratch/NAME/root is a system that begins as BASE, which it leaves as it is.
open_box() {
  mkdir -p "$scratch/$1/root" "$scratch/$1/upper" "$scratch/$1/work"
  mount -t overlay overlay -o "lowerdir=$2,upperdir=$scratch/$1/upper,workdir=$scratch/$1/work" \
    "$scratch/$1/root" 2>/dev/null || cp -a "$2/." "$scratch/$1/root"
  open_rest "$1"
}
open_rest() {
  mount -t proc proc "$scratch/$1/root/proc"
  mount --bind /dev "$scratch/$1/root/dev"
  cp -L /etc/resolv.conf /etc/hosts "$scratch/$1/root/etc/"
}
close_box() {
  umount -l "$scratch/$1/root/dev" "$scratch/$1/root/proc"
  ! mountpoint -q "$scratch/$1/root" || umount -l "$scratch/$1/root"
  rm -rf --one-file-system "${scratch:?}/$1"
}

# within NAME COMMAND [NAME=VALUE...]: runs it in the box, with nothing of this machine's environment but proxies.
within() {
  box=$scratch/$1/root command=$2
  shift 2
  chroot "$box" /usr/bin/env -i HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} "$@" sh -euc "$command"
}

# bare SUITE: makes $roots/SUITE, a bare Debian.
bare() {
  [ ! -e "$roots/$1.complete" ] || return 0
  rm -rf --one-file-system "${roots:?}/$1"
  debootstrap --variant=minbase --include=ca-certificates "$1" "$roots/$1" \
    "${STRUT_MIRROR:-http://deb.debian.org/debian}" >"$roots/$1.log" 2>&1 ||
    { tail -n 20 "$roots/$1.log"; exit 1; }
  echo force-unsafe-io >"$roots/$1/etc/dpkg/dpkg.cfg.d/unsafe-io" # nothing here need survive a power cut
  : >"$roots/$1.complete"
}

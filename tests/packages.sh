#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages, in bare systems of Debian 12 and 13: each builds them twice, in folders of different
# names, in different languages and time zones, and both builds have the same bytes; lintian finds no
# error; another bare system installs and uses them (packages_use.sh), and one does what docs/strut.def says. Both Debians compute the same bits.
# Packages of one do not install on the other: GSL, CHOLMOD and HDF5 have other sonames there.
#
#   sh tests/packages.sh [OUTPUT [SUITE...]]
#
# OUTPUT: where packages go to, as OUTPUT/SUITE/*.deb (default: nowhere). What is committed is built. Needs root,
# debootstrap and the network, 4 GB of disk and, for both, half an hour; exits with 77 where there is no root
# or no debootstrap. Bare systems are kept in STRUT_ROOTS for the next time.
set -eu
source=$(cd "$(dirname "$0")/.." && pwd)
commit=$(git -C "$source" rev-parse HEAD)
output=${1:-}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- bookworm trixie
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

# builder SUITE: makes $roots/SUITE-builder, with all that the packages are built and judged with.
builder() {
  tools="git file dpkg-dev lintian diffutils python3-dev octave-dev"
  wanted=$(sed -n '/^packages=/,/"$/p' "$source/tests/install.sh"; echo "$tools")
  [ "$(cat "$roots/$1-builder.complete" 2>/dev/null)" != "$wanted" ] || return 0
  [ -d "$roots/$1-builder" ] || cp -a "$roots/$1" "$roots/$1-builder"
  mkdir -p "$scratch/builder/root"
  mount --bind "$roots/$1-builder" "$scratch/builder/root"
  open_rest builder
  cp "$source/tests/install.sh" "$scratch/builder/root/root/"
  within builder "apt-get -qq update; sh /root/install.sh
    apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends $tools; apt-get clean" >"$roots/$1.log" 2>&1 ||
    { tail -n 20 "$roots/$1.log"; exit 1; }
  close_box builder
  echo "$wanted" >"$roots/$1-builder.complete"
}

# build BOX FOLDER [NAME=VALUE...]: the packages of a clone in FOLDER of the box.
build() {
  box=$1 folder=$2
  shift 2
  git clone -q "$source" "$scratch/$box/root/$folder"
  git -C "$scratch/$box/root/$folder" checkout -q "$commit"
  within "$box" "cd $folder; git config --global --add safe.directory $folder
    cmake --workflow --preset packages" CMAKE_BUILD_PARALLEL_LEVEL="$(nproc)" "$@" >"$scratch/log" 2>&1 || { tail -n 40 "$scratch/log"; exit 1; }
  ! grep -E '[Ww]arning(:| at)' "$scratch/log" || { echo "a build with warnings"; exit 1; }
}

# section STAGE NAME: of the Apptainer definition.
section() {
  awk -v stage="$1" -v name="%$2" '/^Bootstrap:/ { inside = 0 } /^Stage:/ { now = $2 }
    /^%/ { inside = $0 == name && now == stage; next } inside' "$source/docs/strut.def"
}

for suite; do
  bare "$suite"
  builder "$suite"
  open_box build "$roots/$suite-builder"
  echo "== $suite: the first build"
  build build /root/strut
  echo "== $suite: the second build"
  build build /var/tmp/else/where LANG=C TZ=Pacific/Auckland HOME=/tmp
  first=$scratch/build/root/root/strut/build/packages
  second=$scratch/build/root/var/tmp/else/where/build/packages
  for package in "$first"/*.deb; do
    cmp "$package" "$second/$(basename "$package")"
    echo "the same bytes twice: $(basename "$package"), $(stat -c %s "$package")"
  done
  within build 'cd /root/strut/build/packages; lintian --allow-root --fail-on error *.deb'
  rm -rf "$scratch/packages"
  mkdir "$scratch/packages"
  cp "$first"/*.deb "$scratch/packages"
  if [ -n "$output" ]; then
    mkdir -p "$output/$suite"
    cp "$first"/*.deb "$output/$suite"
  fi
  close_box build
  open_box use "$roots/$suite"
  mkdir "$scratch/use/root/root/packages"
  cp "$scratch/packages"/*.deb "$source"/tests/packages_use.sh "$source"/tests/install_user.c \
    "$scratch/use/root/root/packages"
  echo "== $suite: installed and used"
  within use 'sh /root/packages/packages_use.sh'
  cp "$scratch/use/root/root/bits" "$scratch/bits.$suite"
  close_box use
  if [ "$suite" = bookworm ]; then # what the definition's image begins as
    echo "== $suite: what the Apptainer image is made of"
    open_box image "$roots/$suite"
    mkdir "$scratch/image/root/root/packages"
    cp "$scratch/packages"/*.deb "$scratch/image/root/root/packages"
    within image "$(section final post)" >"$scratch/log" 2>&1 || { tail -n 20 "$scratch/log"; exit 1; }
    [ -n "$(section final test)" ]
    within image "$(section final test)"
    close_box image
  fi
  for other in "$scratch"/bits.*; do cmp "$other" "$scratch/bits.$suite"; done
done
echo "packages of $*: built twice, judged, installed, used"

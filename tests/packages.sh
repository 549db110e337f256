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
# debootstrap and the network, 4 GB of disk and, for both, half an hour (bare_systems.sh).
set -eu
source=$(cd "$(dirname "$0")/.." && pwd)
commit=$(git -C "$source" rev-parse HEAD)
output=${1:-}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- bookworm trixie
. "$source/tests/bare_systems.sh"

# builder SUITE: makes $roots/SUITE-builder, with all that the packages are built and judged with.
builder() {
  tools="git file dpkg-dev help2man lintian diffutils"
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

#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what strut needs from Debian's own packages, with sudo only where that is needed.
#
#   sh tests/install.sh          to build and run strut
#   sh tests/install.sh tests    and what its tests need besides
set -eu

packages="gcc libc6-dev make cmake pkg-config
  libyaml-dev libgsl-dev libsuitesparse-dev libcjson-dev libhdf5-dev libarpack2-dev libglpk-dev
  libpango1.0-dev zlib1g-dev fonts-dejavu-core libjs-dygraphs"
case ${1:-} in
  '') ;;
  tests) packages="$packages g++ clang libcmocka-dev locales jq
  python3 python3-selenium chromium chromium-driver python3-vtk9 ffmpeg poppler-utils slurm-wlm munge parallel
  python3-pandas python3-matplotlib" ;;
  *) echo "usage: sh tests/install.sh [tests]" >&2; exit 1 ;;
esac

as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
# "env" because sudo does not pass the variable on.
apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@"; }

missing=
for package in $packages; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0
echo "installing$missing"
apt update
# shellcheck disable=SC2086
apt install -y --no-install-recommends $missing

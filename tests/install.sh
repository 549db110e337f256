#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what strut needs from Debian's own packages, with sudo only where that is needed.
#
#   sh tests/install.sh          to build and run strut
#   sh tests/install.sh tests    and what its tests need besides
#   sh tests/install.sh tests --without browser,films,octave,pages,slurm,vtk,wheel
#                                without what only tests of these need: ctest names them as skipped
#   sh tests/install.sh web      and what strut for browsers needs, with its tests
set -eu

usage() { echo "usage: sh tests/install.sh [web | tests [--without browser,films,octave,pages,slurm,vtk,wheel]]" >&2; exit 1; }

# What a group of tests alone needs.
group() {
  case $1 in
    browser) echo "python3-selenium chromium chromium-driver" ;;
    films) echo "ffmpeg" ;;
    octave) echo "octave" ;;
    pages) echo "python3-myst-parser furo weasyprint" ;;
    slurm) echo "slurm-wlm munge" ;;
    vtk) echo "python3-vtk9" ;;
    wheel) echo "python3-build python3-setuptools python3-wheel python3-venv patchelf mypy" ;;
    *) return 1 ;;
  esac
}

packages="gcc libc6-dev make cmake pkg-config
  libyaml-dev libgsl-dev libsuitesparse-dev libcjson-dev libhdf5-dev libarpack2-dev libglpk-dev
  libnlopt-dev libpango1.0-dev zlib1g-dev fonts-dejavu-core libjs-dygraphs"
case ${1:-} in
  '') ;;
  tests) packages="$packages g++ clang clang-format libcmocka-dev locales jq poppler-utils patch
  python3 python3-pandas python3-matplotlib python3-jsonschema python3-yaml"
    without=
    case $#,${2:-} in
      1,) ;;
      3,--without) without=$3 ;;
      *) usage ;;
    esac
    for name in $(echo "$without" | tr , ' '); do group "$name" >/dev/null || usage; done
    for name in browser films octave pages slurm vtk wheel; do
      case ,$without, in *,"$name",*) ;; *) packages="$packages $(group "$name")" ;; esac
    done ;;
  web) packages="$packages emscripten clang patch xz-utils ca-certificates nodejs npm node-acorn chromium" ;;
  *) usage ;;
esac

as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
# "env" because sudo does not pass the variable on.
apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@"; }

missing=
for package in $packages; do
  # Other nodejs packages than Debian's bring npm, and refuse Debian's.
  if [ "$package" = npm ] && command -v npm >/dev/null; then continue; fi
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
    missing="$missing $package"
done
[ -n "$missing" ] || exit 0
echo "installing$missing"

# Nothing that these packages bring shall run on this machine: no service of theirs is started now, nor
# at the next boot (slurm-wlm, munge and sysstat would be). What ran or was enabled before stays so.
# DESTDIR is another system's root, for the test of this script.
root=${DESTDIR:-}
policy=$root/usr/sbin/policy-rc.d
enabled() { # every link by which something is started at boot
  find "$root"/etc/systemd/system "$root"/etc/rc[2-5S].d -type l \
    \( -path '*.wants/*' -o -path '*.requires/*' -o -path '*/rc?.d/S*' \) 2>/dev/null | sort
}
before=$(mktemp)
enabled >"$before"
made_policy=
finish() {
  [ -z "$made_policy" ] || $as_root rm -f "$policy"
  enabled | comm -13 "$before" - | while read -r link; do
    case $link in
      */rc?.d/S*) $as_root mv "$link" "$(dirname "$link")/K01${link##*/S[0-9][0-9]}" ;; # off for good
      *) $as_root rm -f "$link" ;;
    esac
  done
  rm -f "$before"
}
trap finish EXIT
trap 'exit 1' HUP INT TERM
if [ ! -e "$policy" ]; then
  made_policy=yes
  printf '#!/bin/sh\nexit 101\n' | $as_root tee "$policy" >/dev/null # "do not start it"
  $as_root chmod 755 "$policy"
fi
apt update
apt install -y --no-install-recommends $missing

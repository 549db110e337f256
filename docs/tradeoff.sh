#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures what accuracy costs, for the crawler and five scenes of other kinds, at one operating point and
# at many: the diagrams and tables of docs/numerics.md, section "What accuracy costs". Takes a few
# minutes of CPU time. With names behind the directory, only those.
#
#   sh docs/tradeoff.sh build/release/strut docs/tradeoff [NAME]...
set -eu
[ $# -ge 2 ] || { echo "usage: docs/tradeoff.sh STRUT DIRECTORY [NAME]..." >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
strut=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
mkdir -p "$2"
output=$(cd "$2" && pwd)
shift 2
wanted=" $* "
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# study NAME MODEL OPTION...: what was printed, NAME.txt, and NAME.svg, which points-... have none of.
study() {
  name=$1 model=$2
  shift 2
  case $wanted in "  " | *" $name "*) ;; *) return 0 ;; esac
  "$strut" tradeoff "$here/../models/$model.yaml" "$@" -o "$work/$name" |
    sed '/^  took /d' >"$output/$name.txt"
  case $name in points-*) ;; *)
    awk -f "$here/smaller.awk" "$work/$name/tradeoff.svg" >"$output/$name.svg" ;;
  esac
  echo "$name"
}

study crawler crawler/crawler --periods 60 --step-sizes 4
study smooth gallery/double-pendulum
study contact basics/bouncing-node
study friction gallery/two-mass-crawler
study stiff basics/pendulum --set stiffness="1e8 N/m"
study cable gallery/d-bar
# Many operating points: the errors that one point hides.
study points crawler/crawler --vary frequency=9.8..15 --vary friction=0.05..0.5 \
  --vary start=I,II --points 40 --seed 1 --periods 60 --own-model --accuracy 0.5% \
  --integrator rk4,rk4-events,verlet-events,adaptive
study points-smooth gallery/double-pendulum --vary length=0.5..2 --vary mass=0.5..2 --points 20 \
  --seed 1 --own-model --accuracy 0.5%
study points-contact basics/bouncing-node --vary height=0.05..0.3 --vary zeta=0.02..0.5 \
  --points 40 --seed 1 --own-model --accuracy 0.5%
study points-friction gallery/two-mass-crawler --set step="50 us" --vary friction=0.05..0.3 \
  --vary frequency=6..15 --points 20 --seed 1 --own-model --accuracy 0.5%
study points-stiff basics/pendulum --vary "stiffness=1e7 N/m..1e9 N/m" --vary length=0.5..2 --points 20 \
  --seed 1 --own-model --accuracy 0.5%
study points-cable gallery/d-bar --vary bars=1e7..1e9 --points 20 --seed 1 --own-model \
  --accuracy 0.5%

#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures what accuracy costs, for the crawler and five scenes of other kinds: the diagrams and
# tables of docs/numerics.md, section "What accuracy costs". Takes some ten minutes of CPU time. With names
# behind the directory, only those.
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

# study NAME MODEL OPTION...: NAME.svg and what was printed, NAME.txt.
study() {
  name=$1 model=$2
  shift 2
  case $wanted in "  " | *" $name "*) ;; *) return 0 ;; esac
  "$strut" tradeoff "$here/../models/$model.yaml" "$@" -o "$work/$name" |
    sed '/^  took /d' >"$output/$name.txt"
  awk -f "$here/smaller.awk" "$work/$name/tradeoff.svg" >"$output/$name.svg"
  echo "$name"
}

study crawler crawler/crawler --periods 60 --steps 4 --budget "40 s"
study smooth gallery/double-pendulum --budget "20 s"
study contact basics/bouncing-node --budget "20 s"
study friction gallery/two-mass-crawler --budget "30 s"
study stiff basics/pendulum --budget "20 s"
study cable gallery/d-bar --budget "15 s"
# Many operating points: the errors that one point hides.
study points crawler/crawler --vary frequency=9.8..15 --vary friction=0.05..0.5 \
  --vary start=I,II --points 40 --seed 1 --periods 60 --steps 4 --own-model --budget "400 s" \
  --methods rk4,rk4-events,verlet-events

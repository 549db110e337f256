#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the studies of docs/paper.md and puts their tables and figures into DIRECTORY, the figures made
# smaller: figure-N.csv and figure-N-NAME.svg. With numbers behind the directory, only those. Figures 5,
# 6, 7, 9 and 11 take a minute or two, 8 and 10 longer.
#
#   sh docs/paper.sh build/release/strut docs/paper [NUMBER]...
set -eu
[ $# -ge 2 ] || { echo "usage: docs/paper.sh STRUT DIRECTORY [NUMBER]..." >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
strut=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
mkdir -p "$2"
output=$(cd "$2" && pwd)
shift 2
wanted=" $* "
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for study in "$here"/../models/crawler/figure-*.yaml; do
  name=$(basename "$study" .yaml)
  case $wanted in "  " | *" ${name#figure-} "*) ;; *) continue ;; esac
  "$strut" sweep "$study" --quiet -o "$work/$name" || [ $? -eq 5 ] # some points less accurate
  cp "$work/$name/table.csv" "$output/$name.csv"
  for picture in "$work/$name"/*.svg; do
    [ -e "$picture" ] || continue
    awk -f "$here/smaller.awk" "$picture" >"$output/$name-$(basename "$picture")"
  done
  echo "$name"
done

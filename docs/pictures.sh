#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Draws the pictures at the head of README.md into DIRECTORY: the crawler after 1,100 periods, and the
# paper's figure 8 from the table that docs/figure-8.sh made.
#
#   sh docs/pictures.sh build/release/strut docs
set -eu
[ $# -eq 2 ] || { echo "usage: docs/pictures.sh STRUT DIRECTORY" >&2; exit 1; }
strut=$1 output=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Coming to rest by integration alone: the last bits of an equilibrium are those of linear algebra
# libraries, and a thousand periods with friction make a visible difference of them.
sed 's/^initial: .*/initial: {configuration: start, settle: true}/' \
  "$here/../models/crawler/crawler.yaml" >"$work/settled.yaml"
grep -q '^initial: {configuration: start, settle: true}' "$work/settled.yaml"
"$strut" run "$work/settled.yaml" --quiet --plot "$work/crawler.svg"
"$strut" plot "$here/figure-8.csv" --x frequency --y velocity --by start --panels friction \
  --band outcome=III --plot "$work/figure-8.svg"
for picture in crawler figure-8; do
  awk -f "$here/smaller.awk" "$work/$picture.svg" >"$output/$picture.svg"
done

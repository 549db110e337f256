#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Draws docs/crawler.svg from a run of the crawler: the structure at the beginning and at the end of
# the last ten periods, and the way of every node between. Usage: docs/picture.sh STRUT OUTPUT.svg
set -eu
strut=$1 output=$2
here=$(cd "$(dirname "$0")" && pwd)
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
# Coming to rest by integration alone: the last bits of an equilibrium are those of linear algebra
# libraries, and a thousand periods with friction make a visible difference of them.
sed 's/^initial: .*/initial: {configuration: start, settle: true}/' \
  "$here/../models/crawler/crawler.yaml" >"$run/settled.yaml"
grep -q '^initial: {configuration: start, settle: true}' "$run/settled.yaml"
"$strut" run "$run/settled.yaml" --quiet -o "$run"
awk -f "$here/picture.awk" "$run/scene.yaml" "$run/nodes.csv" > "$run/picture.svg"
mv "$run/picture.svg" "$output"

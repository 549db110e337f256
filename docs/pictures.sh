#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Draws into DIRECTORY the pictures of README.md, crawler.svg, run to 0.5 %, and page.png, the page of a run; and
# compare/five.svg of docs/how-to/compare-designs.md. docs/paper.sh draws the paper's figure 8.
#
#   sh docs/pictures.sh build/release/strut docs
set -eu
[ $# -eq 2 ] || { echo "usage: docs/pictures.sh STRUT DIRECTORY" >&2; exit 1; }
strut=$1 output=$2
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The start comes to rest by integration alone, so that it does not depend on the last bits of a linear algebra
# library.
sed 's/^initial: .*/initial: {configuration: start, settle: true}/' \
  "$here/../models/crawler/crawler.yaml" >"$work/settled.yaml"
grep -q '^initial: {configuration: start, settle: true}' "$work/settled.yaml"
"$strut" run "$work/settled.yaml" --accuracy 0.5% --quiet --plot "$work/crawler.svg"
awk -f "$here/smaller.awk" "$work/crawler.svg" >"$output/crawler.svg"
# The command of the page: it begins with a line "cd models/topologies".
compare=$(sed -n 's/^strut \(compare nine-member.*\) -o five$/\1/p' "$here/how-to/compare-designs.md")
strut=$(cd "$(dirname "$strut")" && pwd)/$(basename "$strut")
# shellcheck disable=SC2086 # words of a command
(cd "$here/../models/topologies" && "$strut" $compare --quiet -o "$work/five")
mkdir -p "$output/compare"
awk -f "$here/smaller.awk" "$work/five/compare.svg" >"$output/compare/five.svg"
# The page as a browser shows it; without Chromium the old picture stays.
if command -v chromium >/dev/null; then
  "$strut" run "$work/settled.yaml" --quiet -o "$work/run"
  "$strut" view "$work/run" --quiet -o "$work/page.html"
  chromium --headless=new --no-sandbox --disable-gpu --no-first-run --hide-scrollbars \
    --disable-background-networking --disable-component-update --disable-sync --disable-quic \
    --user-data-dir="$work/profile" --window-size=1180,1010 --virtual-time-budget=4000 \
    --screenshot="$work/page.png" "file://$work/page.html" >"$work/log" 2>&1
  mv "$work/page.png" "$output/page.png"
fi

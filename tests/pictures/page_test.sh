#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The page in a real browser: Debian's Chromium without a window, driven by page_test.py.
#
#   sh tests/pictures/page_test.sh ROOT STRUT PYTHON
set -eu
root=$(cd "$1" && pwd) strut=$2 python=$3
skip() { echo "skipped: $1"; exit 77; }
command -v chromium >/dev/null || skip "there is no chromium"
command -v chromedriver >/dev/null || skip "there is no chromedriver (Debian: chromium-driver)"
"$python" -c 'import selenium' 2>/dev/null || skip "there is no python3-selenium"
strut=$(cd "$(dirname "$strut")" && pwd)/$(basename "$strut")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

sed 's/^run: .*/run: {periods: 30, of: drive, measure: {last: 10}}/; s/^output: {last: 10, /output: {last: 5, /' \
  "$root/models/crawler/crawler.yaml" >crawler.yaml
"$strut" run crawler.yaml --quiet -o crawler
"$strut" view crawler --quiet --equilibria all -o crawler.html
"$strut" equilibria crawler.yaml --json >crawler.json
"$strut" run "$root/models/gallery/two-mass-crawler.yaml" --quiet -o two-mass
"$strut" view two-mass --quiet -o two-mass.html
"$strut" run "$root/models/basics/bouncing-node.yaml" --quiet -o bouncing
"$strut" view bouncing --quiet -o bouncing.html
"$strut" view "$root/models/gallery/x-frame.yaml" --quiet -o model.html
sed '/^frequency:/d; s/^output: .*/output: {last: 5, every: 1 ms, channels: [position]}/' crawler.yaml >blind.yaml
"$strut" run blind.yaml --quiet -o blind
"$strut" view blind --quiet -o blind.html
"$strut" view blind --quiet --equilibria all -o blind-cards.html
"$strut" run "$root/models/gallery/cable-pulley.yaml" --quiet --accuracy 1% -o pulley
"$strut" view pulley --quiet -o pulley.html
"$strut" run "$root/models/gallery/two-mass-crawler.yaml" --quiet --set friction=0.3 -o rougher
"$strut" view two-mass rougher --quiet -o two.html

cat >frame.yaml <<'END'
strut: 1
nodes: {a: {position: [0, 0], fixed: both}, upper-left: {position: [0, 1.2], mass: 1}, b: {position: [3, 1.2], fixed: both}}
groups: {soft: {kind: spring, stiffness: 10}}
members: {one: {group: soft, nodes: [a, upper-left]}, two: {group: soft, nodes: [b, upper-left]}}
run: {duration: 1}
solver: {step: 1 ms}
END
"$strut" run frame.yaml --quiet -o frame
"$strut" view frame --quiet -o frame.html

# Texts that would be markup, end a script or turn the direction of writing. The language keeps names
# of nodes simple, a program that fills a scene need not: page_test.py puts such names in.
cat >hostile.yaml <<'END'
strut: 1
name: "</script><script>alert(1)</script><b>bold</b> & \"quoted\" 'too' <!-- מבנה"
description: "<img src=x onerror=alert(2)> هيكل"
source: "]]> &amp; <svg onload=alert(7)>"
parameters: {"t": "<i>7</i>"}
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0.2], mass: 1}
  c: {position: [0, 1], fixed: both} # <img src=x onerror=alert(4)>
members: {one: {kind: cable, nodes: [a, b], stiffness: 100, pretension: 10},
          two: {kind: spring, nodes: [b, c], stiffness: 100}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1}
output: {every: 10 ms, channels: [position, force]}
END
"$strut" run hostile.yaml --quiet -o hostile
"$strut" view hostile --quiet -o hostile.html
cat >spring.yaml <<'END'
strut: 1
data: {film: {file: film.csv}}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100 N/m, rest_length: 0.99}}
solver: {step: 1 ms}
run: {duration: 1}
END
printf 't [s],b.x [mm],m.force [N],m.length [s]\n0.9005,998,0.5,1\n0.5,,0.4,1\n0.25,985,0.3,1\n2,990,0.3,1\n' >film.csv
"$strut" run spring.yaml --quiet -o spring
"$strut" view spring --quiet -o spring.html
PYTHONPATH=$root/tests/support "$python" "$root/tests/pictures/page_test.py" "$work"

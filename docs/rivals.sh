#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures strut's methods beside CVODE, ARKODE and GSL: the tables and diagrams of docs/numerics.md, section "Beside
# other integrators". Takes half an hour of CPU time. It needs the preset bench and Debian's libsundials-dev.
#
#   sh docs/rivals.sh build/bench/strut_bench docs/rivals
set -eu
[ $# -eq 2 ] || { echo "usage: docs/rivals.sh STRUT_BENCH DIRECTORY" >&2; exit 1; }
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$2"
"$1" rivals -o "$work" >"$2/rivals.txt"
awk 'FNR > 1 || NR == 1' "$work"/*.csv >"$2/rivals.csv"
for name in crawler-I-10 sliding stiff-1e7 feedback drift grid-shaken; do
  awk -f "$here/smaller.awk" "$work/$name.svg" >"$2/$name.svg"
done

#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The keys of single sections.
. "$(dirname "$0")/lib.sh"

expect 0 keys member
err_empty
out_has "stiffness: number [N/m], not negative; default 0" "    Force per elongation."
grep -q '`\|](' out && fail "Markdown on the terminal"
[ "$(awk '{ if (length($0) > most) most = length($0) } END { print most }' out)" -le 79 ] ||
  fail "lines of more than 79 columns"
shows 0 "amplitude: number" keys sine solver
out_has "integrator: rk4"
refuses 1 "there is no section or key 'membre'; did you mean 'member'?" keys membre
expect 0 keys mu
[ "$(grep -c '^in ' out)" -eq 2 ] || fail "the sections of a key: $(cat out)"
out_has "Both friction coefficients"
cp out named
expect 0 help mu
same named out
tells 1 "unknown command 'membre'" help membre
refuses 1 "Sections:" keys member nothing_like_it
grep -q ' scene, part, ' err || fail "the sections are not listed"
expect 0 keys --quiet solver

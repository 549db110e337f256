#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Help, manual pages and the keys of single sections.
. "$(dirname "$0")/lib.sh"

expect 0 help
grep '^  [a-z]' out | awk '{print $1}' >commands

# The manual: every command, option and section is in it, and the typesetters find nothing wrong.
mkdir pages
expect 0 help --man
err_empty
cp out pages/strut.1
while read -r command; do
  grep -q "^\\\\fB$command\\\\fR\$" out || fail "strut(1) lacks $command"
done <commands
expect 0 help --man model
cp out pages/strut-model.5
expect 0 keys
grep '^## ' out | sed 's/## //' | while read -r section; do
  grep -qx ".SH $section" pages/strut-model.5 || echo "$section"
done >missing
[ ! -s missing ] || fail "strut-model(5) lacks $(cat missing)"
grep -o '^| `[a-z_]*`' out | tr -d '|` ' | sort -u | while read -r key; do
  grep -q "$key" pages/strut-model.5 || echo "$key"
done >missing
[ ! -s missing ] || fail "strut-model(5) lacks $(cat missing)"
while read -r command; do
  expect 0 help --man "$command"
  err_empty
  cp out "pages/strut-$command.1"
  expect 0 "$command" --help
  sed -n '1,/^Options:/d; s/^ *\(-., \)\{0,1\}--\([a-z-]*\).*/\2/p' out | sed 's/-/\\\\-/g' >listed
  while read -r option; do
    grep -q "^\(\\\\fB\\\\-.\\\\fR, \)\{0,1\}\\\\fB\\\\-\\\\-$option\\\\fR" "pages/strut-$command.1" ||
      fail "strut-$command(1) lacks --$option"
  done <listed
done <commands
if command -v mandoc >/dev/null; then
  mandoc -T lint pages/* >out 2>&1 || fail "mandoc complains"
  out_empty
else
  echo "no mandoc"
fi
if command -v man >/dev/null && man --version 2>/dev/null | grep -q '^man 2'; then
  for page in pages/*; do
    man --warnings -l "$page" >shown 2>out </dev/null || fail "man cannot show $page"
    out_empty
    [ "$(wc -l <shown)" -gt 10 ] || fail "$page is empty"
  done
else
  echo "no man"
fi
expect 1 help --man rnu
err_has "did you mean 'run'?"
expect 1 help --mn
err_has "did you mean '--man'?"

# The keys of sections.
expect 0 keys member
err_empty
out_has "stiffness: number [N/m], not negative; default 0"
out_has "    Force per elongation."
grep -q '`\|](' out && fail "Markdown on the terminal"
[ "$(awk '{ if (length($0) > most) most = length($0) } END { print most }' out)" -le 79 ] ||
  fail "lines of more than 79 columns"
expect 0 keys sine solver
out_has "amplitude: number"
out_has "integrator: rk4"
expect 1 keys membre
out_empty
err_has "there is no section or key 'membre'; did you mean 'member'?"
expect 0 keys mu
[ "$(grep -c '^in ' out)" -eq 2 ] || fail "the sections of a key: $(cat out)"
out_has "Both friction coefficients"
cp out named
expect 0 help mu
same named out
expect 1 help membre
err_has "unknown command 'membre'"
expect 1 keys member nothing_like_it
out_empty
err_has "Sections:"
grep -q ' scene, part, ' err || fail "the sections are not listed"
expect 0 keys --quiet solver
done_testing

#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The progress bar: on a terminal, nowhere else.
. "$(dirname "$0")/lib.sh"
long="--set seconds=1e6"

# for_a_while WORD...: a run, interrupted after two seconds.
for_a_while() { timeout -s INT 2 "$strut" run "$hopper" $long "$@"; }

for_a_while >out 2>err </dev/null
grep -q 'left' err && fail "a bar in a file"
[ "$(wc -l <err)" -eq 1 ] || fail "more than the message of the interruption"
for_a_while 2>&1 </dev/null | cat >out
grep -q 'left' out && fail "a bar in a pipe"

if script -qec true /dev/null >/dev/null 2>&1 </dev/null; then
  # on_terminal WORD...: the same on a terminal of its own; what it shows is in out.
  on_terminal() {
    script -qec "stty cols ${columns:-80}; timeout --foreground -s INT 2 '$strut' run '$hopper' $long $*" /dev/null \
      >out 2>err </dev/null
    tr '\r' '\n' <out >lines && mv lines out
  }
  # widest: columns of the longest line with a bar, colours left out
  widest() {
    sed "s/$(printf '\033')\\[[0-9;]*[mK]//g" out | grep left | LC_ALL=C.UTF-8 wc -L
  }
  # Runs in several parts name the part. The number of parts is unknown, so that only the time left in the
  # present run is shown.
  on_terminal --accuracy 1%
  out_has " so far"
  grep -qE '(run|motion|orbit|steps)[^:]*: [0-9]+ %' out || fail "the part is not named"
  grep ' left' out | grep -qv ' left in this run' && fail "a time left of all parts"
  columns=100
  on_terminal --accuracy 1%
  out_has " left in this run"
  columns=80
  TERM=xterm
  export TERM
  unset NO_COLOR
  on_terminal
  out_has "left" " %, " " of 1e+06 s, " "....."
  grep -q "^$(printf '\033')\\[K" out || fail "the bar is not erased"
  grep -q "$(printf '\033')\\[[0-9;]*m" out || fail "no colour on a terminal"
  columns=40
  on_terminal
  out_has "left"
  [ "$(widest)" -eq 39 ] || fail "wider than the terminal: $(widest)"
  columns=80
  NO_COLOR=1
  export NO_COLOR
  on_terminal
  grep -q "$(printf '\033')" out && fail "colour in spite of NO_COLOR"
  on_terminal --quiet
  ! grep -q "left" out || fail "a bar in spite of --quiet"
fi

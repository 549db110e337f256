#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Ctrl-C: stops within a second, keeps what there is, marks it, exit code 130.
. "$(dirname "$0")/lib.sh"

# ticks PROCESS: processor time it has used [1/100 s]; nothing once it is over.
ticks() {
  state=$(sed 's/.*) //' "/proc/$1/stat" 2>/dev/null) || return 0
  set -- $state
  [ $# -lt 13 ] || [ "$1" = Z ] || echo $((${12} + ${13}))
}

# used PROCESS TICKS: waits until it has used so much processor time, or is over. Time on the clock says
# nothing on a busy machine; here it only ends what hangs.
used() {
  waited=0
  while now=$(ticks "$1") && [ -n "$now" ] && [ "$now" -lt "$2" ] && [ $waited -lt 1200 ]; do
    sleep 0.1
    waited=$((waited + 1))
  done
}

# interrupt SIGNAL WORD...: starts a run without end, sends the signal when it is well under way, and
# grants it another second of processor time at most.
interrupt() {
  signal=$1
  shift
  "$strut" run "$hopper" --set seconds=1e6 "$@" >out 2>err </dev/null &
  process=$!
  used $process 60
  at=$(ticks $process)
  kill -s "$signal" $process
  used $process $((${at:-0} + 100))
  if [ -n "$(ticks $process)" ]; then
    fail "still running a second after SIG$signal"
    kill -KILL $process
  fi
  wait $process
  code=$?
  [ $code -eq 130 ] || fail "SIG$signal: exit code $code"
}

interrupt INT --json -o kept
out_has '"status":	"interrupted"'
err_has "interrupted at t = "
files kept contacts.csv energy.csv members.csv nodes.csv scene.yaml summary.json trajectory.h5
grep -q '"status":	"interrupted"' kept/summary.json || fail "summary.json is not marked"
[ "$(wc -l <kept/nodes.csv)" -gt 1 ] || fail "nothing was kept"
[ "$(tail -1 kept/nodes.csv | cut -d, -f1)" = "$(jq .duration kept/summary.json)" ] || fail "the last row is not the end"
if command -v h5dump >/dev/null; then
  h5dump -a status kept/trajectory.h5 | grep -q '"interrupted"' || fail "HDF5 is not marked"
fi
interrupt INT
out_has "Hopper: interrupted"
interrupt TERM --quiet
out_empty

# A method that chooses its steps stops within a step of the grid, and goes back to its begin.
sed -e 's/^solver: .*/solver: {integrator: adaptive, step: step}/' -e '/^output:/d' \
  "$hopper" >grid.yaml
hopper=grid.yaml
interrupt INT --set step=1e5 --json
out_has '"status":	"interrupted"' '"steps":	0'
err_has "interrupted at t = 0 s"
interrupt TERM --set step=1e5 --quiet
never='limit: 1e9, evaluations: 1e15' # without a ground it falls for ever
sed -i -e "s/^run: .*/initial: {settle: {$never}}\\n&/" -e '/^ground:/,/friction:/d' grid.yaml
interrupt INT --set step=1e5
err_has "interrupted while coming to rest"

# timeout(1) sends its signal twice.
timeout -s INT 2 "$strut" run "$here/hopper.yaml" --set seconds=1e6 --quiet -o twice 2>err </dev/null
grep -q '"status":	"interrupted"' twice/summary.json || fail "killed by timeout's second signal"

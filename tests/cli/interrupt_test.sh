#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Ctrl-C: stops within a second, keeps what there is, marks it, exit code 130.
. "$(dirname "$0")/lib.sh"
hopper=$here/hopper.yaml

# interrupt SIGNAL WORD...: starts a run without end, sends the signal, waits for a second at most.
interrupt() {
  signal=$1
  shift
  "$strut" run "$hopper" --set seconds=1e6 "$@" >out 2>err </dev/null &
  process=$!
  sleep 1
  kill -s "$signal" $process
  waited=0
  while kill -0 $process 2>/dev/null && [ $waited -lt 10 ]; do
    sleep 0.1
    waited=$((waited + 1))
  done
  if kill -0 $process 2>/dev/null; then
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
out_has '"status":	"interrupted"'
out_has '"steps":	0'
err_has "interrupted at t = 0 s"
interrupt TERM --set step=1e5 --quiet
never='friction: kept, limit: 1e9, speed: 1e-15, acceleration: 1e-15'
sed -i "s/^run: .*/initial: {settle: {$never}}\\n&/" grid.yaml
interrupt INT --set step=1e5
err_has "interrupted while coming to rest"

# timeout(1) sends its signal twice.
timeout -s INT 1 "$strut" run "$here/hopper.yaml" --set seconds=1e6 --quiet -o twice 2>err </dev/null
grep -q '"status":	"interrupted"' twice/summary.json || fail "killed by timeout's second signal"
done_testing

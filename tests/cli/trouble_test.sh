#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Trouble with files and streams: exit code 4, a reason, and nothing half done left behind.
. "$(dirname "$0")/lib.sh"

# The standard output.
full() {
  "$strut" "$@" >/dev/full 2>err </dev/null
  code=$?
  : >out
  [ "$code" -eq 4 ] || fail "strut $* > /dev/full: exit code $code"
  err_has "No space left on device"
}
if [ -e /dev/full ]; then
  full run "$hopper" --json
  full run "$hopper"
  full check "$hopper"
  full check "$hopper" --json
  full export "$hopper"
  full keys
  full help
  full --version
  full run --help
  "$strut" run "$hopper" --quiet >/dev/full 2>err || fail "a quiet run writes nothing"
  full run "$hopper" --json -o kept # the files were written all the same
  [ -s kept/summary.json ] || fail "no summary.json"
fi

# Closed streams: none of the files may land in them.
"$strut" run "$hopper" -o one -q </dev/null || fail "a run"
"$strut" run "$hopper" -o closed >&- 2>err </dev/null
[ $? -eq 4 ] || fail "stdout closed"
same_directory one closed
"$strut" run "$hopper" -o closed2 -q <&- >&- 2>&- || fail "all streams closed"
same_directory one closed2
"$strut" run - <&- >out 2>err
[ $? -eq 4 ] || fail "no standard input to read"
err_has "standard input"

# Directories.
touch file
refuses 4 "file" run "$hopper" -o file
expect 4 run "$hopper" -o file/below
expect 4 run "$hopper" -o ''
expect 4 run "$hopper" -o /proc/strut
mkdir -p taken/nodes.csv
tells 4 "Is a directory" run "$hopper" -o taken
files taken nodes.csv
# Known before the run starts, not after it.
if command -v timeout >/dev/null; then
  timeout 10 "$strut" run "$hopper" --set seconds=1e5 -o file >out 2>err </dev/null
  [ $? -eq 4 ] || fail "the directory was not tried before the run"
fi
mkdir locked && chmod 555 locked
if ! touch locked/x 2>/dev/null; then # root writes everywhere
  tells 4 "Permission denied" run "$hopper" -o locked
  expect 4 run "$hopper" -o locked/sub
fi
chmod 755 locked

# A full disk: whatever the moment, nothing is left.
for size in 4 16 64 128 192 256 320 384 448 512 640 4000; do
  small_disk $size || break
  "$strut" run "$hopper" -o disk/out >out 2>err </dev/null
  code=$?
  if [ $code -eq 0 ]; then
    files disk/out contacts.csv energy.csv members.csv nodes.csv scene.yaml summary.json \
      trajectory.h5
    fitted=$size
  else
    [ $code -eq 4 ] || fail "a disk of $size kB: exit code $code"
    err_has "No space left on device"
    [ "$(wc -l <err)" -eq 1 ] || fail "more than one line of complaint"
    [ -z "$(ls -A disk)" ] || fail "a disk of $size kB keeps $(ls -A disk disk/*)"
  fi
  no_disk
done
[ "$size" -lt 4000 ] || [ "${fitted:-}" = 4000 ] || fail "no disk was large enough"

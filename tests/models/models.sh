#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every model says what it shows, is valid, and runs if it has a run: begins with a comment, passes
# strut check and strut run, and what strut export makes of it gives the same summary. A model for
# statics alone has no run; what strut export makes of it must give the same check. A study, which
# says `study:`, must count its points.
#
#   sh tests/models/models.sh ROOT STRUT
set -eu
root=$(cd "$1" && pwd)
strut=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
count=0
fail() { echo "$*"; failures=$((failures + 1)); }

# still FILE: the same for one that has no run, after its check.
still() {
  "$strut" export "$1" >"$scratch/scene.yaml" || { echo "write fails"; return 1; }
  "$strut" check "$scratch/scene.yaml" --json >"$scratch/again" ||
    { echo "its effective scene is not valid"; return 1; }
  diff "$scratch/check" "$scratch/again" || { echo "its effective scene differs"; return 1; }
}

# tries FILE: says what is wrong with it.
tries() {
  head -n 1 "$1" | grep -q '^# ' || { echo "does not begin with a comment"; return 1; }
  if grep -q '^study:' "$1"; then
    "$strut" sweep "$1" --count --json >"$scratch/check" || { echo "is no valid study"; return 1; }
    return
  fi
  "$strut" check "$1" --json >"$scratch/check" || { echo "check fails"; return 1; }
  grep -q '^run:' "$1" || { still "$1"; return; }
  "$strut" run "$1" --quiet -o "$scratch/first" || { echo "run fails"; return 1; }
  "$strut" run "$scratch/first/scene.yaml" --quiet -o "$scratch/second" ||
    { echo "its effective scene does not run"; return 1; }
  diff -r "$scratch/first" "$scratch/second" || { echo "its effective scene differs"; return 1; }
}

# Self-test: files that must be noticed.
printf 'strut: 1\n' >"$scratch/silent.yaml"
printf '# says nothing\nstrut: 1\nnodes: {}\n' >"$scratch/bad.yaml"
printf '# has no axes\nstrut: 1\nstudy: Nothing\nmodel: bad.yaml\n' >"$scratch/aimless.yaml"
for bad in silent bad aimless; do # the first has no comment, the second no nodes
  ! tries "$scratch/$bad.yaml" >/dev/null 2>&1 || fail "self-test: $bad passes"
done

for model in $(find "$root/models" -name '*.yaml' | sort); do
  count=$((count + 1))
  tries "$model" >"$scratch/log" 2>&1 || fail "${model#"$root"/}: $(cat "$scratch/log")"
done
[ "$count" -ge 9 ] || fail "only $count models"
[ "$failures" -eq 0 ] && echo "$count models run"
exit "$((failures > 0))"

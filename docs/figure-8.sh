#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs what the paper's figure 8 shows: the crawler's steady velocity over the drive's frequency, from
# states I and II, on three grounds, each run with the paper's own numerics (RK4, 0.1 ms, 1100
# periods, measured over the last 100). Prints the table that `strut plot` draws.
#
#   docs/figure-8.sh STRUT [FIRST STEP LAST]     frequencies [Hz]; 1 0.1 20 if not given: 1146 runs,
#                                                some twenty minutes on two processors
set -eu
strut=$1
first=${2:-1} step=${3:-0.1} last=${4:-20}
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Comes to rest by integration: an equilibrium's search for each of the runs would cost more.
sed 's/^initial: .*/initial: {configuration: start, settle: true}/' \
  "$here/../models/crawler/crawler.yaml" >"$work/settled.yaml"
grep -q '^initial: {configuration: start, settle: true}' "$work/settled.yaml"

# One line of the table. In state III nodes 3 and 4 have met; state I lies on 1 and 4, II on 2 and 4.
cat >"$work/one" <<'END'
strut=$1 model=$2 friction=$3 start=$4 frequency=$5
"$strut" run "$model" --json --set "friction=$friction" --set "start=$start" \
  --set "frequency=$frequency Hz" 2>/dev/null |
  jq -r --arg friction "$friction" --arg start "$start" --arg frequency "$frequency" '
    (.nodes | map_values(.position)) as $n
    | (if .status != "completed" then .status
       elif ([$n.n3[0] - $n.n4[0], $n.n3[1] - $n.n4[1]] | map(. * .) | add) < 1e-4 then "III"
       elif $n.n1[1] < $n.n2[1] then "I" else "II" end) as $outcome
    | "\($frequency),\(.velocity // ""),\($start),\($friction),\($outcome)"'
END

echo 'frequency [Hz],velocity [m/s],start,friction,outcome'
for friction in 0.1 0.2 0.5; do
  for start in I II; do
    LC_ALL=C seq "$first" "$step" "$last" | sed "s/^/$friction $start /"
  done
done | xargs -P "${JOBS:-$(nproc)}" -L 1 sh "$work/one" "$strut" "$work/settled.yaml" >"$work/table"
LC_ALL=C sort -t , -k 4,4n -k 3,3 -k 1,1n "$work/table"

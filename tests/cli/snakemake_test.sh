#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The Snakefile of the documents runs a study, its failed points included, and begins again where it ended.
command -v snakemake >/dev/null || { echo "skipped: snakemake is not installed"; exit 77; }
. "$(dirname "$0")/lib.sh"
export HOME="$work" XDG_CACHE_HOME="$work/cache"
PATH=$(dirname "$strut"):$PATH
awk '/^<!-- Snakefile -->$/ { next_one = 1; next }
  inside && /^```/ { exit }
  inside { print }
  next_one && /^```/ { inside = 1 }' "$root/docs/how-to/cluster.md" >Snakefile
[ -s Snakefile ] || fail "the document has no Snakefile"
cp "$here/hopper.yaml" model.yaml
yaml grounds.yaml <<'END'
study: hops
model: model.yaml
axes: [{stiffness: [100 N/m, 200 N/m, 300 N/m]}, {seconds: [0.2, 1e-9, 0.3]}]
keep: [velocity, steps]
END
expect 3 sweep grounds.yaml -o whole --quiet
snakemake --cores 2 --quiet >out 2>err || fail "snakemake fails"
same speeds/table.csv whole/table.csv
rm speeds/table.csv speeds-done/1 speeds/shards/shard-0001-of-0004.slots
snakemake --cores 2 --quiet >out 2>err || fail "snakemake fails when it resumes"
same speeds/table.csv whole/table.csv

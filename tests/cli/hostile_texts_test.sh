#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Texts that would act in another language, or end where they should not: bytes of damaged files, names, folders.
. "$(dirname "$0")/lib.sh"

yaml model.yaml <<'END'
name: "=HYPERLINK(\"http://example.org\")"
parameters: {k: 100 N/m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: k}}
solver: {step: 1 ms}
run: {duration: 0.1 s}
END
yaml study.yaml <<'END'
study: S
model: model.yaml
axes: [{points: points.csv}]
keep: [velocity]
END

# ---- a NUL in a table or a network ----
for cell in '1\0junk' '\0' '"1\0"' '1\n\0\0\0'; do
  printf "k\n$cell\n" >points.csv
  expect 2 check study.yaml
  grep -q 'points.csv:[23]:[0-9]*: error: a NUL byte' err || fail "no place of a NUL: $cell"
done
printf 'k\n1\n' >points.csv
expect 0 check study.yaml
yaml network.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}}
controllers: {c: {network: net.csv, inputs: [0.5], scale: 1 mm}}
actuators: {d: {member: m, signal: c}}
solver: {step: 1 ms}
run: {duration: 0.1 s}
END
printf '1, 0\n\n2, 0\n' >net.csv
expect 0 check network.yaml
printf '1, 0\n\n\0\0\0\0\n\n2, 0\n' >net.csv
tells 2 "network 'net.csv', line 3: a NUL byte" check network.yaml

# ---- a folder whose name ends a here-document, and other languages ----
break=$(printf 'x\nEND\n)\ntouch PWNED\n: $(: ')
refuses 1 "control character" sweep study.yaml -o "$break" --emit slurm --shards 2
tells 1 "control character" sweep study.yaml -o "$(printf 'a\rb')" --emit slurm --shards 2
expect 0 sweep study.yaml -o "it's \$(touch PWNED) \`touch PWNED\`" --emit slurm --shards 2
mkdir bin
printf '#!/bin/sh\ncat >/dev/null\necho 1\n' >bin/sbatch && chmod +x bin/sbatch
PATH=$PWD/bin:$PATH sh out >/dev/null 2>&1
absent PWNED

# ---- a cell that a spreadsheet would compute ----
shows 0 "'=HYPERLINK" compare model.yaml model.yaml --csv

# ---- names without a look ----
named() {
  yaml named.yaml <<END
nodes: {a: {position: [0, 0], fixed: both}, "$1": {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, "$1"], stiffness: 100}}
END
}
for name in 'a\u200Bb' '\u202Eb' 'b\u2066' 'b\u00AD' 'b\uFE0F' 'b\u00A0' '\U000E0041'; do
  named "$name"
  tells 2 "cannot be the name of a node" check named.yaml
done
for name in 'Füße' '节点' 'κόμβος' 'узел'; do
  named "$name"
  expect 0 check named.yaml
done

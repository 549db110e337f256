#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Files that a scene names: parts that use them, bases; what is refused; the short scene written again.
. "$(dirname "$0")/lib.sh"

mkdir cells
yaml cells/vertebra.yaml <<'END'
name: vertebra
parameters: {height: 0.2 m, k: 1 kN/m}
groups:
  bone: {kind: bar, stiffness: 10*k, mass: 10 g}
nodes:
  middle: [0, 0]
  lower: [0, -height]
  upper: [0, height]
  front: {position: [0.3 m, 0], mass: 5 g}
members:
  b1: {group: bone, nodes: [middle, lower]}
  b2: {group: bone, nodes: [middle, upper]}
  b3: {group: bone, nodes: [middle, front]}
  b4: {group: bone, nodes: [lower, upper]}
  b5: {group: bone, nodes: [lower, front]}
  b6: {group: bone, nodes: [upper, front]}
gravity: [0, -9.81]
ground: {stiffness: 1 kN/m, height: -1 m, nodes: [lower], contacts: {lower: {stiffness: 2 kN/m}}}
solver: {step: 1e-5 s}
run: {duration: 0.1 s}
END
expect 0 check cells/vertebra.yaml

yaml spine.yaml <<'END'
name: spine
parameters: {vertebrae: 4, spacing: 0.15 m, hold: 0.9}
groups: {cable: {kind: cable, stiffness: 500 N/m, rest_length_ratio: hold}}
parts:
  vertebra: {use: cells/vertebra.yaml, parameters: {height: 0.1 m}}
place:
  v:
    part: vertebra
    repeat:
      count: vertebrae
      step: [spacing, 0]
      next:
        members:
          lower: {group: cable, nodes: [lower, next.lower]}
          upper: {group: cable, nodes: [upper, next.upper]}
          front_lower: {group: cable, nodes: [front, next.lower]}
          front_upper: {group: cable, nodes: [front, next.upper]}
nodes: {v.0.middle: {fixed: both}, v.0.lower: {fixed: x}}
END

# 1. A file as a part: its structure, with the part's keys over it, and nothing of its experiment.
shows 0 'v.3.front: {position: [0.75, 0], mass: 0.005}' export spine.yaml
out_has 'v.2.lower: [0.3, -0.1]' 'v.3.b1: {nodes: [v.3.middle, v.3.lower], kind: bar, stiffness: 10000'
out_has 'gravity: [0, 0]'
out_has_not 'ground' 'duration'
expect 0 export spine.yaml --set vertebrae=2
out_has_not 'v.2'
# By hand the same: the part's text in place of the file's, but for the names around it.
sed -n '/^groups/,/b6/p' cells/vertebra.yaml | sed 's/^/    /' >inside
sed -e '/use:/{s/{.*//' -e 'r inside' -e 'a\    parameters: {height: 0.1 m, k: 1 kN/m}' -e '}' spine.yaml >byhand.yaml
"$strut" export spine.yaml >flat
expect 0 export byhand.yaml
same flat out
# The contacts of a ground's list come with the part, and keys under the name of one change it.
printf 'ground: {stiffness: 3 kN/m, height: -1 m, nodes: [], contacts: {v.1.lower: {damping: 9}}}\n' |
  cat spine.yaml - >grounded.yaml
shows 0 'nodes: [v.0.lower, v.1.lower, v.2.lower, v.3.lower]' export grounded.yaml
out_has '  stiffness: 2000' 'v.1.lower: {damping: 9}'
# It sees no names of the scene around it, and may have names that this has too.
sed 's/10\*k/10*k*hold/' cells/vertebra.yaml >cells/asks.yaml
sed 's/vertebra.yaml/asks.yaml/' spine.yaml >asking.yaml
tells 2 "cells/asks.yaml:5:37: error: in 'stiffness' of group 'bone': unknown parameter 'hold'" check asking.yaml
err_has "asking.yaml:8:3: note: in part 'vertebra', placed here as 'v'"
printf 'parameters: {k: 3}\n' | sed '/^parameters/d' spine.yaml - >named.yaml
sed -i 's/vertebrae$/2/; s/spacing/0.15 m/; s/hold/0.9*k\/3/' named.yaml
printf 'parameters: {k: 3}\n' >>named.yaml
expect 0 check named.yaml
# A file within a file, from the folder of that one.
printf 'strut: 1\nparts: {p: {use: vertebra.yaml}}\nplace: {a: {part: p}, b: {part: p, flip: x}}\n' >cells/two.yaml
printf 'strut: 1\nparts: {q: {use: cells/two.yaml}}\nplace: {x: {part: q}, y: {part: q, at: [2 m, 0]}}\n' >four.yaml
forward='friction: {law: coulomb, mu_forward: 0.1, mu_backward: 0.9}' # of the ground, also for a mirrored copy
printf "ground: {stiffness: 1, nodes: [], contacts: {y.b.lower: {$forward}}}\n" >>four.yaml
shows 0 'y.b.front: {position: [1.7, 0], mass: 0.005}' export four.yaml
out_has 'y.b.lower: {friction: {law: coulomb, mu_static: 0.1, mu_kinetic: 0.1, mu_backward: 0.9'
# From the standard input, the folder is the current one.
"$strut" export - <spine.yaml >again
same flat again

# 2. A base: mappings key by key, lists replaced, things removed, keys that say the same replaced.
yaml longer.yaml <<'END'
base: spine.yaml
name: longer
parameters: {vertebrae: 5, spacing: remove}
groups: {cable: {rest_length: 0.1 m}}
place: {v: {repeat: {step: [0.2 m, 0]}}}
nodes: {v.last.upper: {mass: 3 g}, v.0.lower: {fixed: both}, wall: {position: [2 m, 0], fixed: both}}
members: {v.1.b3: remove, tie: {group: cable, nodes: [v.last.front, wall], rest_length_ratio: 0.5}}
END
shows 0 'name: "longer"' export longer.yaml
out_has 'v.4.upper: {position: [0.8, 0.1], mass: 0.003}' 'v.0.lower: {position: [0, -0.1], fixed: both}'
out_has_not 'v.1.b3'
out_has 'v.3.upper: {nodes: [v.3.upper, v.4.upper], kind: cable, stiffness: 500, rest_length: 0.1}'
out_has 'tie: {nodes: [v.4.front, wall], kind: cable, stiffness: 500, rest_length_ratio: 0.5}'
out_has_not 'spacing'
expect 0 compare cells/vertebra.yaml cells/two.yaml
printf 'strut: 1\nbase: longer.yaml\nname: third\nnodes: {wall: [2.5 m, 0]}\n' >third.yaml
shows 0 'wall: {position: [2.5, 0], fixed: both}' export third.yaml
printf 'strut: 1\nbase: cells/vertebra.yaml\nnodes: {middle: {mass: 1 g}, front: [0.4 m, 0]}\nmembers: {b7: remove}\n' >wrong.yaml
tells 2 "wrong.yaml:4:11: error: there is no 'b7' to remove; did you mean 'b1'?" check wrong.yaml
sed -i 's/b7: remove/b1: {stiffness: 1 Nm}/' wrong.yaml
tells 2 "wrong.yaml:4:29: error:" check wrong.yaml
sed -i 's/^members.*/groups: {bone: {stiffness: remove}}/' wrong.yaml
tells 2 "cells/vertebra.yaml:12:3: error: member 'b1'" check wrong.yaml
printf 'strut: 1\nbase: cells/vertebra.yaml\nnodes: {middle: {mass: 1 g}, front: [0.4 m, 0]}\nmembers: {b6: remove}\n' >plain.yaml
shows 0 'middle: {position: [0, 0], mass: 0.001}' export plain.yaml
out_has 'front: {position: [0.4, 0], mass: 0.005}'
edit '/^strut/d' plain.yaml tells 2 "the scene lacks 'strut'" check

# 3. What is refused, with where and why, quickly and in little memory.
mkdir h h/sub
part() { printf 'strut: 1\nname: t\nparts:\n  p: {use: "%s"}\nplace: {a: {part: p}}\n' "$1" >"h/$2.yaml"; }
ln -s /etc/passwd h/out
ln -s /dev/zero h/zero
ln -s .. h/up
mkfifo h/fifo
truncate -s 300M h/big
: >h/empty
printf 'strut: 1\nstudy: x\nmodel: m.yaml\n' >h/study
printf 'strut: 1\nnodes: {a: [0,0]\nmembers: 3\n' >h/broken
printf 'strut: 1\nnodez: {a: [0,0]}\nnodes: {b: [0,0]}\n' >h/unknown
printf 'nodes: {b: [0,0]}\n' >h/unversioned
printf -- '- 1\n- 2\n' >h/list
head -c 100000 /dev/zero >h/zeros
part self.yaml self
part c2.yaml c1
part c3.yaml c2
part c1.yaml c3
printf 'strut: 1\nbase: b2.yaml\n' >h/b1.yaml
printf 'strut: 1\nbase: b1.yaml\n' >h/b2.yaml
printf 'strut: 1\nbase: [b1.yaml]\n' >h/baselist.yaml
printf 'strut: 1\nbase: missing\nnodes: {a: 3}\n' >h/basemissing.yaml
i=1
while [ $i -le 17 ]; do
  part l$((i + 1)).yaml l$i
  i=$((i + 1))
done
printf 'strut: 1\nnodes: {a: [0,0], b: [1,0]}\nmembers: {m: {kind: bar, nodes: [a,b], stiffness: 1 N/m, mass: 1 g}}\n' >h/l18.yaml
# A file that uses two, each of which uses two, and so on: each is read once.
i=1
while [ $i -le 15 ]; do
  printf 'strut: 1\nparts: {p: {use: d%d.yaml}, q: {use: d%d.yaml}, r: {use: d%d.yaml}}\nplace: {a: {part: p}}\n' \
    $((i + 1)) $((i + 1)) $((i + 1)) >h/d$i.yaml
  i=$((i + 1))
done
sed 's/nodes: \[a,b\]/nodes: [a,c]/' h/l18.yaml >h/d16.yaml
# Three hundred files.
printf 'strut: 1\nparts:\n' >h/many.yaml
i=1
while [ $i -le 300 ]; do
  cp h/l18.yaml h/m$i.yaml
  printf '  p%d: {use: m%d.yaml}\n' $i $i >>h/many.yaml
  i=$((i + 1))
done
printf 'place: {a: {part: p1}}\n' >>h/many.yaml

# refuse NAME TEXT: h/NAME.yaml is refused with the text.
refuse() {
  tells 2 "$2" check "h/$1.yaml"
  echo "h/$1.yaml" >>refused
}
used=0
while IFS='|' read -r path text; do # a part that uses the file of the path
  used=$((used + 1))
  part "$path" used-$used
  refuse used-$used "$text"
done <<'END'
../../etc/passwd|h/used-1.yaml:4:12: error: '../../etc/passwd' has a '..'
sub/../../cells/vertebra.yaml|has a '..'
/etc/passwd|'/etc/passwd' is an absolute path
out|'h/out' leads out of the folder
up/cells/vertebra.yaml|leads out of the folder
zero|leads out of the folder
/dev/zero|is an absolute path
fifo|'h/fifo' is not a regular file
sub|is not a regular file
.|is not a regular file
|expected the path of a file
missing|cannot read 'h/missing': No such file
big|'h/big' has 314572800 bytes, expected at most
study|is a study, expected a scene
broken|h/broken:3:1: error: expected ',' or '}'
unknown|h/unknown:2:1: error: unknown key 'nodez' in part 'p'; did you mean 'nodes'?
unversioned|it lacks 'strut: 1'
list|is not a mapping
zeros|h/zeros:1:1: error:
empty|h/empty: error: the file is empty
END
err_has "h/used-20.yaml:4:12: note: the file is used here"
refuse self "in a circle: h/self.yaml -> h/self.yaml"
refuse c1 "in a circle: h/c1.yaml -> h/c2.yaml -> h/c3.yaml -> h/c1.yaml"
[ "$(grep -c error: err)" -eq 1 ] || fail "a circle is reported more than once"
refuse b1 "h/b2.yaml:2:7: error: files use each other in a circle: h/b1.yaml -> h/b2.yaml -> h/b1.yaml"
refuse baselist "expected the path of a file for 'base', found a list"
refuse basemissing "cannot read 'h/missing'"
[ "$(grep -c error: err)" -eq 1 ] || fail "a missing base has consequences"
refuse l1 "h/l17.yaml:4:12: error: files use each other more than 16 deep"
expect 0 check h/l2.yaml
refuse d1 "error: more than 1000000 values are repeated by used files"
[ "$(grep -c error: err)" -eq 1 ] || fail "one limit is reported more than once"
tells 2 "h/d16.yaml:3:36: error: unknown node 'c'" check h/d12.yaml
refuse many "more than 255 files are used"
# A program without instrumentation needs little: CPU time of each, and the memory of all.
python3 - "$strut" <<'END' || fail "refusing takes too long, or too much memory"
import resource, subprocess, sys
def run(path):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.argv[1], "check", path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, after.ru_maxrss / 1024
usual, memory = min(run("spine.yaml") for i in range(3))
if memory < 40:
    for path in open("refused").read().split():
        seconds, memory = min(run(path) for i in range(3))
        if seconds > 0.1 or memory > 64:
            sys.exit("%s: %.3f s, %.0f MB" % (path, seconds, memory))
END

# 4. The short scene again: reading it gives the same bits.
# short FILE OPTION...: what write --parts prints stands alone, and says the same.
short() {
  "$strut" export "$@" >flat || fail "write $*"
  expect 0 export --parts "$@"
  err_empty
  mkdir -p alone
  cp out alone/short.yaml
  expect 0 export alone/short.yaml
  sed '/^parameters/,/^mass_model/d' flat >flat.bare
  sed '/^parameters/,/^mass_model/d' out >out.bare
  same flat.bare out.bare
  expect 0 export --parts alone/short.yaml
  same alone/short.yaml out
}
for file in spine longer third named four plain grounded; do short $file.yaml; done
short spine.yaml --set vertebrae=3 --set hold=0.8
grep -qF 'parameters: {vertebrae: 3, spacing: 0.15 m, hold: 0.8}' alone/short.yaml || fail "what was set"
short spine.yaml --set spacing=0.25
grep -qF 'spacing: 0.25 m' alone/short.yaml || fail "a plain number gets the declared unit"
for file in crawler/crawler gallery/x-frame gallery/spine; do short "$models/$file.yaml"; done

# 5. A form in the words of its model; where a node of a copy moves, without them.
yaml chain.yaml <<'END'
parameters: {cells: 4}
groups: {cable: {kind: cable, stiffness: 100 N/m}, bar: {kind: bar, stiffness: 1 kN/m, mass: 10 g}}
parts:
  frame:
    nodes: {a: [0, 0], b: [1, 0], c: [1, 1], d: [0, 1]}
    members: {bottom: {group: cable, nodes: [a, b]}, top: {group: cable, nodes: [d, c]},
              right: {group: cable, nodes: [b, c]}, rising: {group: bar, nodes: [a, c]},
              falling: {group: bar, nodes: [d, b]}}
place: {cell: {part: frame, repeat: {count: cells, step: [1, 0], next: {merge: {b: a, c: d}}}}}
members: {left: {group: cable, nodes: [cell.0.a, cell.0.d]}}
END
expect 0 form chain.yaml --given prestress -o form.yaml
err_empty
grep -qF 'cell: {part: frame, repeat: {count: cells' form.yaml || fail "the form has lost its parts"
grep -qF 'cell.3.right: {rest_length: 0.99}' form.yaml || fail "the form's rest lengths"
finds '.self_stress.count == 4' rigidity form.yaml
expect 0 check form.yaml --set cells=4
sed 's/rising: {group: bar/rising: {group: bar, rest_length: 1.6 m/' chain.yaml >moved.yaml
tells 0 "strut: the scene is written without parameters, groups and parts" form moved.yaml --given lengths -o form.yaml
expect 0 check form.yaml
# Also where the file says start or shapes in another way than what is written, or names a file beside it.
for form in bistable-chain:densities t-bar:densities voxel-with-network:prestress; do
  model=$models/gallery/${form%:*}
  cp "$model.yaml" model.yaml
  [ ! -e "$model.csv" ] || cp "$model.csv" .
  expect 0 form model.yaml --given "${form#*:}" -o form.yaml
  grep -q '^# A scene with its parameters' form.yaml || fail "the form of $form is flat"
  expect 0 check form.yaml
done

# 6. A study of a model that uses files: its results are its own, and stand alone.
yaml study.yaml <<'END'
study: heights
model: runs.yaml
axes: [{spacing: [0.15 m, 0.2 m]}]
keep: [energy]
END
cat spine.yaml - >runs.yaml <<'END'
solver: {step: 1e-4 s}
run: {duration: 1e-3 s, measure: {}}
END
expect 0 run runs.yaml -o run --quiet
"$strut" export runs.yaml >flat
same flat run/scene.yaml
expect 0 sweep study.yaml -o results --quiet
grep -q 'use:' results/model.yaml && fail "the copy of the model uses files"
"$strut" export results/model.yaml >copied
"$strut" export runs.yaml >original
same copied original
cp -r results copy
(cd copy && "$strut" sweep study.yaml -o . --quiet >/dev/null 2>"$work/err") || fail "the copy cannot be resumed"
same_directory results copy
sed -i 's/10 g/11 g/' cells/vertebra.yaml
tells 1 "holds results of another study" sweep study.yaml -o results --quiet
sed -i 's/0.3 m, 0/0.3 kg, 0/' cells/vertebra.yaml
tells 2 "cells/vertebra.yaml:10:22: error:" sweep study.yaml -o fresh --quiet

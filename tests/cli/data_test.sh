#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measured data: files of every form, signals, laws and positions of them, results, studies; files that nobody meant.
. "$(dirname "$0")/lib.sh"

# ---- one table in many forms ----

printf 't [s],x [mm],y [mm]\n0,1,-2\n0.5,1.5,\n1,2.25,-3\n' >strut.csv
printf '\357\273\277"t";"x";"y"\r\ns;mm;mm\r\n"0,0";"1,0";2,0\r\n0,5;1,5;\r\n1,0;2,25;3,0\r\n' >machine.csv
printf 'Machine;4711\n\nt (s);x (mm);y (mm);\n0;1;-2;\n0,5;1,5;;\n1,0;2,25;-3;\n' >header.csv
printf 'mass_A\nt\tx\ty\n0\t0.001\t-0.002\n0.5\t0.0015\tnan\n1.0\t2.25e-3\t-0.003\n' >tracker.tsv
printf '# of an array\n# t, x, y\n0,10,20\n0.5,15,\n1,22.5,30\n' >pixels.csv
printf 'scorer,N,N,N,N,N,N\nbodyparts,p,p,p,q,q,q\ncoords,x,y,likelihood,x,y,likelihood\n0,10,20,1,1,1,1\n1,15,,0.5,1,1,1\n2,22.5,30,1,1,1,1\n' >film.csv
cut -d, -f1-4 film.csv >single.csv # with one body part
printf 'Frame,p,,q,\n,x,y,x,y\n0,10,20,1,1\n1,15,,1,1\n2,22.5,30,1,1\n' >markers.csv
yaml forms.yaml <<END
data:
  strut: {file: strut.csv}
  machine: {file: machine.csv, units: {y: -1 mm}}
  header: {file: header.csv, header: 3}
  tracker: {file: tracker.tsv, units: {t: s, x: m, y: m}}
  pixels: {file: pixels.csv, header: 2, units: {t: s}, scale: 0.1 mm, flip: y}
  film: {file: film.csv, units: {coords: 1/(2 Hz)}, scale: 0.1 mm, flip: y, weights: likelihood}
  turned: {file: single.csv, units: {coords: 1/(2 Hz)}, scale: 0.1 mm, flip: x, rotate: 180 deg, shift: [0, 1 mm], skip: 1}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1 N/m}}
END
expect 0 check forms.yaml --json
for form in strut machine header tracker pixels; do
  holds ".data.$form.rows == 3"
  near ".data.$form.columns | [.t.least, .t.most, .x.least, .x.most, .y.least, .y.most, .y.gaps]" \
    '[0, 1, 0.001, 0.00225, -0.003, -0.002, 1]' 1e-18
done
near '.data.film.columns | [.coords.most, ."p.x".most, ."p.y".least, ."p.likelihood".least]' '[1, 0.00225, -0.003, 0.5]' 1e-15
near '.data.turned | [.rows, (.columns | ."p.x".least, ."p.y".least)]' '[2, 0.00225, -0.002]' 1e-15 # a gap in y is one in x, too
edit 's/film.csv, units.*likelihood/markers.csv, header: 2, scale: 0.1 mm, flip: y/' forms.yaml expect 0 check --json
near '.data.film.columns | [."p.x".most, ."p.y".least, ."q.x".most]' '[0.00225, -0.003, 0.0001]' 1e-15

# ---- what is made of data ----

# A run by data of a sine is one by the sine, as exactly as straight lines and splines are.
awk 'BEGIN { print "t [s],u [mm]"; for (i = 0; i <= 200; i++) printf "%.17g,%.17g\n", i / 100, 5 * sin(6.283185307179586 * i / 100) }' >sine.csv
drive() {
  yaml <<END
data: {d: {file: sine.csv}}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100, damping: 1}}
actuators: {act: {member: m, signal: {$1}}}
solver: {integrator: adaptive, accuracy: 1e-8}
run: {duration: 1.9 s, measure: {quantities: {x: {of: b.x, take: final}}}}
END
}
drive 'sine: {amplitude: 5 mm, frequency: 1 Hz}' >sine.yaml
drive 'data: d.u' >lines.yaml
drive 'data: d.u, interpolation: smooth, outside: repeat' >spline.yaml
expect 0 run sine.yaml --json
want=$(jq .measured.x.value out)
gives .measured.x.value "$want" 5e-6 run lines.yaml
gives .measured.x.value "$want" 5e-6 run spline.yaml
drive 'data: d.u' | sed 's/1.9 s/2.1 s/' >late.yaml
refuses 2 "expected all times from 0 to 2.1 s" run late.yaml

# Results keep the files, and give themselves again; a file of another content is not lost.
for scene in lines spline; do
  expect 0 run $scene.yaml -o kept-$scene
  same sine.csv kept-$scene/sine.csv
  expect 0 run kept-$scene/scene.yaml -o again-$scene
  same kept-$scene/nodes.csv again-$scene/nodes.csv
done
echo other >again-lines/sine.csv
refuses 1 "would overwrite" run lines.yaml -o again-lines
writes_back spline.yaml

# A tensile test: loading and unloading 2 and 1.6 N/mm; the law is their mean, and is said to be.
awk 'BEGIN { print "x [mm],F [N]"; for (i = 0; i <= 500; i++) print i / 100 "," 2 * i / 100
  for (i = 499; i >= 0; i--) print i / 100 "," 1.6 * i / 100 }' >tensile.csv
yaml law.yaml <<END
data: {t: {file: tensile.csv}}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y}}
members: {m: {kind: spring, nodes: [a, b], law: {kind: table, data: t.F, over: t.x}}}
loads: {pull: {node: b, force: [5.4 N, 0]}}
END
tells 0 "loading and unloading differ by up to 2 N" check law.yaml
gives '[.equilibria[].nodes.b[0]] | max' 1.003 1e-4 equilibria law.yaml

# A part of that file has the data of the scene that uses it, which has to have them.
yaml parts.yaml <<END
parts: {arm: {use: law.yaml}}
place: {arm: {part: arm}}
END
refuses 2 "law.yaml:4:69: error: unknown data 't' for the law of member 'm'; a part takes none of its file" check parts.yaml
echo 'data: {t: {file: tensile.csv}}' >>parts.yaml
expect 0 check parts.yaml

# ---- studies ----

yaml study.yaml <<END
study: By data
model: model.yaml
data: {own: {file: tensile.csv}}
axes: [{k: [50 N/m, 100 N/m]}]
keep: [positions]
trajectories: yes
END
{
  drive 'data: d.u, outside: hold' | sed 's/stiffness: 100,/stiffness: k,/'
  echo 'parameters: {k: 100 N/m}'
} >model.yaml
expect 0 sweep study.yaml -o swept
same sine.csv swept/sine.csv
same sine.csv swept/runs/000000001/sine.csv
expect 0 sweep swept/study.yaml -o reswept
same swept/table.csv reswept/table.csv
sed -i 's/^2,.*/2,1/' sine.csv
rm swept/sine.csv
refuses 1 "" sweep study.yaml -o swept

# ---- many rows ----

awk 'BEGIN { print "t [s],u [mm],v [mm]"; for (i = 0; i < 1000000; i++) printf "%d.%03d,%d.%d,1\n", i / 1000, i % 1000, i % 7, i % 10 }' >long.csv
sed 's/sine.csv/long.csv/' lines.yaml >long.yaml
begin=$(date +%s)
expect 0 check long.yaml
[ $(($(date +%s) - begin)) -le 10 ] || fail "reading 1e6 rows takes $(($(date +%s) - begin)) s"
out_has 'long.csv  1000000'
awk 'BEGIN { print "t [s],u [mm]"; for (i = 0; i < 5000001; i++) print i ",1" }' >long.csv
refuses 2 "long.csv:5000002:1: error: more than 5000000 rows" check long.yaml

# ---- files that nobody meant ----

for bytes in '' '\n' ',' '"' '"\n"' ',,,\n,,\n' 't [s],u [mm]' 't [s],u [mm]\n' 't [s],u [mm]\r0,1\r1,2' '\377\376t\0,\0' \
  'a\0b\n1,2\n' '#\n#\n' 't [s],u [mm]\n1e999,1\n2,2\n' '(,)\n[,]\n1,2\n' 'scorer\n' 'scorer,a\nbodyparts\ncoords,x\n' \
  'coords\ncoords\ncoords\n' 't [s];u [mm]\n1;2,3,4\n' '[s],[mm]\n1,2\n'; do
  printf "$bytes" >sine.csv
  for keys in '' ', header: 2' ', header: 1' ', header: 3' ', skip: 1' ', scale: 1 mm, rotate: 1, weights: u'; do
    sed "s/sine.csv/&$keys/" lines.yaml >hostile.yaml
    "$strut" check hostile.yaml >out 2>err
    code=$?
    [ $code -eq 2 ] || fail "'$bytes'$keys: exit code $code"
    grep -qE '^(hostile.yaml|sine.csv):[0-9]+:[0-9]+: error: ' err || fail "'$bytes'$keys: no place"
  done
done
printf '\377\376t\0' >sine.csv
refuses 2 "sine.csv:1:1: error: the file is UTF-16; save it as UTF-8" check lines.yaml
ln -s /dev/zero zero.csv
mkfifo pipe.csv
for name in zero.csv pipe.csv /etc/passwd ../x.csv . ''; do
  sed "s|file: sine.csv|file: \"$name\"|" lines.yaml >hostile.yaml
  expect 2 check hostile.yaml
done

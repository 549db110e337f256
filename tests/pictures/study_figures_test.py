# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of what the runs of a study recorded: closed forms found again in the pictures.
usage: study_figures_test.py STRUT
"""
import json
import math
import os
import subprocess

from svg_paths import near, read, texts

from testing import check, finish, strut, work, write

FIRST, DASHED = (0, 0x60 / 255, 0xA8 / 255), (0.25, 0.25, 0.25)


def sweep(text, *more, code=0):
    write("study.yaml", text)
    done = subprocess.run([strut, "sweep", "study.yaml", "-o", "out", "--quiet", *more], capture_output=True, text=True)
    check(done.returncode == code, f"exit code {done.returncode}: {done.stderr}")
    return done.stderr


def curve(name):
    found = [line for path in read(name)[2] if near(path.stroke, FIRST) and not path.curved
             for line in path.lines if len(line) > 20]
    check(len(found) == 1, f"{name}: {len(found)} curves of 1")
    return found[0] if found else []


def close(name, end, wanted, tolerance):
    """Is the curve the function, up to the scales of the axes? Its times go from 0 to `end`."""
    line = curve(name)
    if not line:
        return
    left, right = line[0][0], line[-1][0]
    times = [end * (x - left) / (right - left) for x, _ in line]
    values = [wanted(t) for t in times]
    low, high = values.index(min(values)), values.index(max(values))
    scale = (line[high][1] - line[low][1]) / (values[high] - values[low])
    worst = max(abs(line[low][1] + scale * (v - values[low]) - p[1]) for v, p in zip(values, line))
    height = abs(line[high][1] - line[low][1])
    check(scale < 0 and worst < tolerance * height, f"{name}: off by {worst / height:.2g}")


os.chdir(work)
# x = 1 + a cos(10 t); two masses, the second at rest.
write("block.yaml", """strut: 1
name: Block
parameters: {far: 0.2, mass: 1 kg}
nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: mass, fixed: y}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: 100 N/m}}
configurations: {drawn: {}, out: {block: [1 + far, 0]}}
initial: {configuration: out}
solver: {step: 0.5 ms}
run: {duration: 1 s, measure: {node: block}}
output: {every: 3 ms, channels: [position]}
""")
# At rest first `far` is used nowhere: the axis is the mass.
STUDY = """strut: 1
study: motion
model: block.yaml
axes: [{mass: [1 kg]}]
variants: {rest: {initial: {configuration: drawn, velocities: {block: [1, 0]}}}, out: {output: {every: 8 ms}}}
trajectories: yes
keep: [velocity]
figures:
"""
sweep(STUDY + """  one: {kind: motion, x: time, y: x, only: node=block, difference: variant}
  begun: {kind: motion, x: elapsed, y: dx, series: variant, panels: node}
  late: {kind: motion, x: time, y: dx, only: variant=out, series: node, from: 0.5 s}
  seen: {kind: snapshots, times: [0 s, 0.1 s], difference: variant}
  alone: {kind: snapshots, times: [0 s], only: variant=out}
""")
# Both have a sample at the end, whatever is between their samples.
close("out/one.svg", 1.0, lambda t: 0.2 * math.cos(10 * t) - 0.1 * math.sin(10 * t), 2e-3)
names = sorted(name for name in os.listdir("out") if name.endswith(".svg"))
check(names == ["alone.svg", "begun.svg", "late.svg", "one.svg", "seen.svg"], f"pictures: {names}")
# The other motion: one dashed member at each of two times, as long as it is then.
dashed = [path.lines[0] for path in read("out/seen.svg")[2]
          if path.dash and near(path.stroke, DASHED) and len(path.lines) == 1]
check(len(dashed) == 2, f"seen.svg: {len(dashed)} dashed members of 2")
if len(dashed) == 2:
    lengths = [math.dist(line[0], line[-1]) for line in dashed]
    ratio = (1 + 0.1 * math.sin(10 * 0.096))  # the frame nearest to 0.096 s, which is drawn
    check(abs(lengths[1] / lengths[0] - ratio) < 2e-3, f"seen.svg: {lengths[1] / lengths[0]}, expected {ratio}")
check(not [p for p in read("out/alone.svg")[2] if p.dash and near(p.stroke, DASHED)],
      "alone.svg: there is no other motion")
late = [line for path in read("out/late.svg")[2] if near(path.stroke, FIRST) and not path.curved
        for line in path.lines if len(line) > 20]
check(not late, "late.svg: the wall does not move, so that its curve has no bends")

# Labels and limits of an axis: the motion of x, 0.1 sin(10 t) and 0.2 cos(10 t), in ranges of 1 m and 2 m.
sweep(STUDY + "".join(
    f"  y{k}: {{kind: motion, x: time, y: x, only: node=block, difference: variant, "
    f"x_label: moment, y_limits: [-{k} m, {100 * k} cm], x_limits: [0, 2]}}\n" for k in (1, 2)))
high = [max(p[1] for p in line) - min(p[1] for p in line) for line in (curve("out/y1.svg"), curve("out/y2.svg"))]
check(abs(high[0] / high[1] - 2) < 0.01, f"y_limits: heights {high}")
check(0.35 < math.dist(*([p[0]] for p in (curve("out/y1.svg")[0], curve("out/y1.svg")[-1]))) / 510 < 0.5, "x_limits")

os.rename("out", "free")

# A driven structure: a period each, one file for each point; the same motion dashed upon itself.
write("driven.yaml", open("block.yaml").read().replace("initial:", """actuators:
  drive: {member: spring, signal: {sine: {amplitude: 0.1, frequency: 2 Hz}}}
initial:""").replace("{duration: 1 s, ", "{periods: 2, of: drive, "))
sweep(STUDY.replace("block.yaml", "driven.yaml").replace("[1 kg]", "[1 kg, 2 kg]")
      .replace("  rest: {initial: {configuration: drawn, velocities: {block: [1, 0]}}}",
               "  same: {output: {every: 8 ms}}") +
      "  way: {kind: period, scale: [2, 1], difference: variant}\n"
      "  one: {kind: period, only: variant=out}\n")
names = sorted(name for name in os.listdir("out") if name.startswith(("way", "one-")))
check(names == ["one-1.svg", "one-2.svg", "way-1.svg", "way-2.svg"], f"pictures: {names}")
ways = [path.lines[0] for path in read("out/way-2.svg")[2] if path.dash and near(path.stroke, DASHED)]
check(ways and max(abs(a[1] - b[1]) for way in ways for a, b in zip(way, way[1:])) < 0.01,
      "way-2.svg: the other's way lies along x")

# Axes, legends, panels and colours are in the units of the study, else of the model, else in SI with a prefix; the
# table, `only` and limits stay in SI. Labels of the study stand in their place.
write("slider.yaml", """strut: 1
parameters: {stretch: 20 mm, stiffness: 0.1 kN/m, tilt: 0.1, mass: 1 kg}
nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: mass, fixed: y}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: stiffness}}
gravity: [9.81*sin(tilt), 0]
initial: {positions: {block: [1 m + stretch, 0]}}
solver: {step: 1 ms}
run: {duration: 50 ms, measure: {node: block}}
""")
UNITS = """strut: 1
study: units
model: slider.yaml
axes:
  - tilt: {from: 0 deg, to: 60 deg, step: 30 deg}
  - stretch: [0.5 mm, 20 mm]
  - stiffness: [100, 3000]
keep: [velocity]
figures:
  lines: {x: tilt, y: velocity, series: stretch, panels: stiffness, only: stretch=0.02, x_limits: [0, 0.5]}
  named: {x: stiffness, y: velocity, series: tilt, labels: [level, "half, way", steep], panels: stretch,
          band: status=completed}
  map: {kind: map, x: tilt, y: stretch, color: velocity, panels: stiffness}
  less: {x: tilt, y: velocity, series: stiffness, difference: stretch}
"""
os.rename("out", "driven")
sweep(UNITS, "--svg-text")
check("steep</text>" in open("out/named.svg").read() and open("out/table.csv").read().startswith("point,tilt [rad],stretch [m],stiffness [N/m],velocity [m/s],"), "units: table")
for name, wanted, missing in (
        ("lines", ("tilt in deg", "velocity in mm/s", "a) stiffness = 0.1 kN/m", "b) stiffness = 3 kN/m", "25"), ("30",)),
        ("named", ("stiffness in kN/m", "a) stretch = 0.5 mm", "b) stretch = 20 mm", "level", "half, way", "steep", "status completed of at least one tilt"), ()),
        ("less", ("velocity, stretch 0.02 less 0.0005 in mm/s",), ()),
        ("map", ("tilt in deg", "stretch in mm", "60", "20", "25"), ("tilt in rad",))):
    said = texts(f"out/{name}.svg")
    check(set(wanted) <= set(said) and not set(missing) & set(said), f"{name}.svg: {said}")
subprocess.run([strut, "sweep", "study.yaml", "-o", "out", "--quiet", "--plot", "all.json"], check=True)
panels = json.load(open("all.json"))["panels"]  # a third axis makes panels
check([panel["title"][3:] for panel in panels] == ["stiffness = 0.1 kN/m", "stiffness = 3 kN/m"], "all.json: panels")
check(panels[0]["x"]["shown"] == "deg" and near([180 / math.pi * panels[0]["x"]["shown_size"]] * 3, (1, 1, 1)),
      f"all.json: {panels[0]['x']}")
said = sweep(UNITS.replace(", steep]", "]"), code=2)
check("'labels' of figure 'named': 2 labels for the 3 values of 'tilt'" in said and "study.yaml:" in said, said)
os.rename("out", "units")
os.rename("driven", "out")

# Refusals.
for figure, wanted in (
        ("{kind: motion, x: time, y: dz}", "the motion has no column 'dz'; did you mean 'dx'?"),
        ("{kind: motion, x: time, y: node}", "column 'node' holds texts, not numbers"),
        ("{kind: motion, x: time, y: velocity}", "the motion has no column 'velocity'"),
        ("{kind: motion, x: time, y: x, series: elapsed}", "'elapsed' is recorded; expected an axis"),
        ("{kind: motion, x: time, y: x, only: x=1}", "'x' is recorded; expected an axis, or 'node'"),
        ("{kind: motion, x: time}", "figure 'bad' lacks 'y'"),
        ("{kind: map, x: mass, y: velocity}", "map 'bad' lacks 'color'"),
        ("{kind: snapshots, times: 3 s}", "expected a list of times such as"),
        ("{kind: snapshots, times: [3 kg]}", "expected a time such as"),
        ("{x: time, y: velocity}", "the table has no column 'time'"),
        ("{x: variant, y: velocity, x_limits: [2, 1]}", "'x_limits' of figure 'bad' must be two ascending"),
        ("{x: variant, y: velocity, y_limits: [0 m, 1]}", "'y_limits' of figure 'bad': expected numbers in m/s, or without unit"),
        ("{kind: map, colors: red}", "'colors'"),
        ("{x: mass, y: velocity, band: variant=rst}", "'band' of figure 'bad': 'rst' is no value of 'variant'"),
        ("{kind: snapshots, only: node}", "'only' of figure 'bad': expects COLUMN=TEXT"),
        ("{kind: snapshots, only: node=block}", "'node' is recorded; expected an axis"),
        ("{kind: snapshots, times: []}", "expected a list of times such as [0 s, 20 ms]"),
        ("{kind: snapshots, times: [3 s]}", "the record goes from 0 s to 1 s"),
        ("{kind: snapshots, difference: mass}", "'difference' of figure 'bad': it needs two values to compare; 'mass' has 1"),
        ("{kind: motion, x: time, y: x, only: node=blok}", "no node 'blok'; did you mean 'block'?"),
        ("{kind: motion, x: time, y: x, only: mass=1 g}",
         "'1 g' is no value of 'mass'; expected a number as in the table, in kg"),
        ("{kind: motion, x: time, y: x, from: 2 s}", "'from' of figure 'bad': nothing is recorded there: the record goes"),
        ("{kind: motion, x: time, y: x, from: 2 ms, to: 2 ms}", "'to' of figure 'bad' must be later than 'from'"),
        ("{kind: motion, x: time, y: x, from: 2 m}", "expected a time such as '0.1 ms' for 'from' of figure 'bad'"),
        ("{kind: motion, x: time, y: x, series: node, labels: [a]}", "1 labels for the 2 values of 'node'"),
        ("{kind: motion, x: time, y: 'x,y', labels: [a]}", "'labels' of figure 'bad': 1 labels for 2 curves"),
        ("{kind: motion, x: time, y: 'x,time'}", "'time' has another unit (s) than the columns before it (m)"),
        ("{x: variant, y: 'velocity,mass'}", "'mass' has another unit (kg) than the columns before it (m/s)"),
        ("{x: variant, y: 'velocity,velocity', labels: [a]}", "1 labels for 2 curves")):
    said = sweep(STUDY + f"  bad: {figure}\n", code=2)
    check(wanted in said and said.startswith("study.yaml:"), f"{figure}: {said}")
said = sweep(STUDY.replace("trajectories: yes\n", "") + "  bad: {kind: period}\n", code=2)
check("add 'trajectories: yes' to the study" in said and "study.yaml:" in said, said)
# Texts that are computed are known at the end.
os.rename("out", "refused")
said = sweep(STUDY + "".join(f"  {n}: {{x: variant, y: velocity, only: velocity={n}}}\n" for n in ("bad", "worse")), code=2)
check(all(f"figure '{n}': no row of the table has '{n}' in column 'velocity'" in said for n in ("bad", "worse")), said)
said = sweep(STUDY + "  bad: {kind: period}\noutput: {channels: [force]}\n", code=2)
check("'kind' of figure 'bad': the runs record no positions" in said and "study.yaml:" in said, said)
finish()

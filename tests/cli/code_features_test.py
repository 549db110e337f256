# SPDX-License-Identifier: GPL-3.0-or-later
# strut export --format code of what only some scenes have: several grounds, what breaks or yields, what follows the
# motion, and sliders. The C has strut's bits, by rk4 and verlet, and compiles without a warning.
#
#   python3 code_features_test.py STRUT
import csv
import os
import re
import subprocess

from exported_code import build, code_rows, compare, compilers
from testing import check, finish, models, path, run, write


def scene(name, text, method, step, steps, every, channels="position, energy"):
    write(name, f"strut: 1\n{text}\nsolver: {{integrator: {method}, step: {step!r} s}}\n"
          f"run: {{duration: {steps * step!r} s}}\n"
          f"output: {{every: {every * step!r} s, channels: [{channels}]}}\n")


def compare_scene(name, text, step, steps, every):
    """By rk4 with one compiler, by verlet with the other."""
    rows = []
    for method, compiler in zip(("rk4", "verlet"), (compilers[0], compilers[-1])):
        scene(name, text, method, step, steps, every)
        rows.append(compare(name, method, step, steps, every, [compiler]))
    return rows


def floats_near(name, step, steps, far):
    """Floats stay near doubles, and compile without a warning, too."""
    rows = {}
    for real in ("double", "float"):
        run("export", name, "--format", "code", "-o", real, "--real", real, "--prefix", "x")
        rows[real] = code_rows(build(compilers[-1], "x", f"-DSTEP={step!r}", f"-DSTEPS={steps}",
                                     f"-DEVERY={steps}", directory=real))
    error = max(abs(float(a) - float(b)) for a, b in zip(rows["float"][-1], rows["double"][-1]))
    print(f"{name}: error of floats [m]: {error:.1e}")
    check(error < far, f"{name}: floats are {error} m from doubles")


# ---- grounds ----

# Every shape, at rest and shaken, and laws of damping and friction; balls that slide, roll off edges and hit corners.
GROUNDS = """gravity: [0, -9.81 m/s^2]
nodes:
  a: {position: [-40 mm, 40 mm], mass: 10 g}
  b: {position: [-10 mm, 45 mm], mass: 10 g}
  c: {position: [20 mm, 42 mm], mass: 10 g}
  d: {position: [80 mm, 60 mm], mass: 10 g}
members:
  ab: {kind: spring, nodes: [a, b], stiffness: 100 N/m, damping: 0.05 N s/m}
  bc: {kind: spring, nodes: [b, c], stiffness: 100 N/m, damping: 0.05 N s/m}
  ac: {kind: bar, nodes: [a, c], stiffness: 200 N/m, damping: 0.05 N s/m}
grounds:
  floor: {height: -1 mm, stiffness: 1 kN/m, damping: 1 N s/m, friction: {mu: 0.3, stick_velocity: 1 mm/s}, contacts: {b: {stiffness: 2 kN/m}}}
  wall: {slope: 90 deg, through: [100 mm, 0], stiffness: 1 kN/m, damping: 1 N s/m, friction: {law: smooth, mu: 0.2, width: 1 mm/s}}
  chute: {normal: [3, 4], through: [-50 mm, 0], stiffness: 1 kN/m, damping_law: hunt_crossley, dissipation: 1 s/m, belt_speed: 30 mm/s, friction: {law: karnopp, mu_forward: 0.2, mu_backward: 0.6, stick_velocity: 1 mm/s}}
  hill: {profile: [[-10 mm, -5 mm], [0, -5 mm], [5 mm, 10 mm], [10 mm, -5 mm], [20 mm, 5 mm], [40 mm, 5 mm], [40 mm, -5 mm]], stiffness: 1 kN/m, friction: {mu_static: 0.8, mu_kinetic: 0.5, stick_velocity: 1 mm/s}}
  stone: {circle: {centre: [70 mm, 0], radius: 8 mm}, stiffness: 1 kN/m, damping: 1 N s/m, friction: {law: stribeck, mu_static: 0.5, mu_kinetic: 0.3, width: 1 mm/s, decay_velocity: 30 mm/s}}
  hoop: {circle: {centre: [0, 0], radius: 0.12 m, inside: yes}, stiffness: 1 kN/m, motion: {x: wave, y: {ramp: {amplitude: 2 mm, stop: 0.5 s}}}}
  table: {height: 2 mm, nodes: [a, d], motion: {y: shake}, stiffness: 1 kN/m, damping: 0.5 N s/m, friction: {mu: 0.4, stick_velocity: 1 mm/s}}
signals:
  wave: {sine: {amplitude: 2 mm, frequency: 10 Hz}}
  shake: {sine: {amplitude: 1 mm, frequency: 25 Hz}}
actuators: {pull: {member: ab, signal: {sine: {amplitude: 3 mm, frequency: 5 Hz}}}}
initial: {velocities: {a: [0.3 m/s, 0], d: [-0.4 m/s, 0]}}
"""

# Feet that come to rest in corners: two contacts that stick hold a node together.
CORNERS = """gravity: [0, -10]
nodes: {ball: {position: [0, 1 mm], mass: 2}, other: {position: [-3 mm, 12 mm], mass: 1}}
grounds:
  left: {slope: -40 deg, through: [0, 0], stiffness: 1e4, damping: 60, friction: {mu: 0.5, stick_velocity: 1 mm/s}}
  right: {normal: [-1.7320508075688772, 1], through: [0, 0], stiffness: 1e4, damping: 60, friction: {mu_static: 0.5, mu_kinetic: 0.4, stick_velocity: 1 mm/s}}
  steep: {normal: [-9, 1], through: [0.3 mm, 0], stiffness: 1e4, damping: 60, friction: {mu: 0.1, stick_velocity: 1 mm/s}}
"""

CIRCLES = """gravity: [0, -10]
nodes: {ball: {position: [10 mm, 0], mass: 1}, other: {position: [30 mm, 10 mm], mass: 1}}
members: {tie: {kind: spring, nodes: [ball, other], stiffness: 50 N/m}}
grounds: {pipe: {circle: {centre: [0, 0], radius: 60 mm, inside: yes}, stiffness: 1e4, damping: 3}}
"""

STEPS = """gravity: [0, -10]
nodes: {ball: {position: [-15 mm, 102 mm], mass: 1}}
ground: {profile: [[-1 m, 0.1 m], [0, 0.1 m], [0, 0], [1 m, 0]], stiffness: 1e4, damping: 20, motion: {x: {sine: {amplitude: 1 mm, frequency: 5 Hz}}}, friction: {law: smooth, mu: 0.1, width: 1 mm/s}}
initial: {velocity: [0.4 m/s, 0]}
"""


def test_grounds():
    compare_scene("grounds.yaml", GROUNDS, 1e-4, 20000, 200)
    floats_near("grounds.yaml", 1e-4, 500, 1e-5)
    rows = compare_scene("corners.yaml", CORNERS, 1e-4, 10000, 100)
    for kind in ("rk4", "verlet"):
        still = rows[kind == "verlet"][-2:]
        far = max(abs(float(a) - float(b)) for a, b in zip(*still))
        check(far < 1e-5, f"corners by {kind} do not come to rest: {far} m in a row")
    floats_near("corners.yaml", 1e-4, 2000, 1e-4)
    compare_scene("circles.yaml", CIRCLES, 1e-4, 5000, 100)
    compare_scene("steps.yaml", STEPS, 1e-4, 8000, 100)


# ---- what yields, breaks or is released ----

# A frame that is driven until parts of it give way: cables, a running cable, stops, hinges, with dampers and drives.
MEMORY = """gravity: [0, -9.81 m/s^2]
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0], fixed: both}
  c: {position: [1, 1], mass: 0.5}
  d: {position: [0, 1], mass: 0.5}
  e: {position: [0.5, 1.5], mass: 0.3}
members:
  post: {kind: bar, nodes: [a, d], stiffness: 800, damping: 1, law: {kind: elastic_plastic, yield: 12, second_stiffness: 60}}
  other: {kind: bar, nodes: [b, c], stiffness: 800, damping: 1, law: {kind: elastic_plastic, yield: 15}}
  top: {kind: bar, nodes: [c, d], stiffness: 500, damping: 0.5}
  up: {kind: cable, nodes: [a, c], stiffness: 200, damping: 1, rest_length_ratio: 0.95, breaks_at: 14 N}
  down: {kind: cable, nodes: [b, d], stiffness: 200, damping: 1, rest_length_ratio: 0.9, law: {kind: elastic_plastic, yield: 20, second_stiffness: 30}}
  left: {kind: cable, nodes: [d, e], stiffness: 100, damping: 0.3, released_at: 0.7 s}
  right: {kind: spring, nodes: [c, e], stiffness: 100, damping: 0.3, shortest: 0.6, longest: 0.72, breaks_at: 25 N}
  run: {kind: cable, nodes: [a, d, e, c], stiffness: 60, damping: 0.5, rest_length_ratio: 0.9, breaks_at: 14 N}
hinges:
  knee: {nodes: [a, d, c], stiffness: 3, damping: 0.02, breaks_at: 0.7 N m}
  bent: {nodes: [d, e, c], stiffness: 2, law: {kind: elastic_plastic, yield: 0.2 N m}}
  plain: {nodes: [b, c, d], stiffness: 1}
actuators:
  pull: {member: up, signal: {sine: {amplitude: 60 mm, frequency: 1 Hz}}}
  press: {member: post, signal: {sine: {amplitude: 40 mm, frequency: 1.3 Hz}}}
  wave: {member: run, signal: {sine: {amplitude: 50 mm, frequency: 2 Hz}}}
initial: {velocities: {c: [1 m/s, 0], e: [0, -1 m/s]}}
"""

LATCH = """nodes:
  wall: {position: [0, 0], fixed: both}
  block: {position: [90 mm, 0], mass: 1 kg, fixed: y}
  end: {position: [200 mm, 0], fixed: both}
members:
  spring: {nodes: [wall, block], kind: spring, stiffness: 2 kN/m, rest_length: 100 mm}
  latch: {nodes: [wall, block], kind: cable, stiffness: 10 kN/m, pretension: 20 N, released_at: 50 ms}
  weak: {nodes: [block, end], kind: spring, stiffness: 10 N/m, rest_length: 10 mm, breaks_at: 0.9 N}
"""

BROKEN = """#include <stdio.h>
#include "memory.h"
static memory_state s;
int main(void) {
  memory_init(&s);
  for (int n = 0; n < 10000; n++) memory_step_rk4(&s, NULL, 2e-4);
  printf("%d %d %d %d\\n", s.broken[MEMORY_BREAKABLE_up], s.broken[MEMORY_BREAKABLE_left],
         s.broken[MEMORY_BREAKABLE_right], s.broken[MEMORY_BREAKABLE_knee]);
  for (int k = 0; k < MEMORY_YIELDING; k++) printf("%.17g\\n", s.plastic[k]);
  printf("%.17g\\n%.17g\\n", memory_energy(&s).elastic, memory_tension(&s, MEMORY_MEMBER_down));
  return 0;
}
"""


def last_of(table, column):
    with open(path("run", table), encoding="utf-8") as file:
        head, *rows = list(csv.reader(file))
    return float(rows[-1][next(k for k, name in enumerate(head) if name.startswith(column + " "))])


def test_memory():
    compare_scene("latch.yaml", LATCH, 1e-4, 4000, 50)
    compare_scene("memory.yaml", MEMORY, 2e-4, 10000, 100)
    floats_near("memory.yaml", 2e-4, 2000, 1e-3)
    scene("memory.yaml", MEMORY, "rk4", 2e-4, 10000, 10000, "position, energy, force")
    done = run("run", "memory.yaml", "-o", "run", "--force")
    run("export", "memory.yaml", "--format", "code", "-o", "asked")
    with open(path("asked", "memory_example.c"), "w", encoding="utf-8") as main:
        main.write(BROKEN)
    lines = subprocess.run([build(compilers[0], "memory", directory="asked")], capture_output=True,
                           text=True).stdout.splitlines()
    print("broken:", lines[0], "plastic:", *lines[1:-2])
    for name, flag in zip(("up", "left", "right", "knee"), lines[0].split()):
        listed = re.search(rf"\b{name}\b[^\n]*(broke|released)", done.stdout) is not None
        check(listed == (flag == "1"), f"{name} has broken: {flag} in the code, strut says\n{done.stdout}")
    check(lines[0].count("1") >= 3, f"of what can break next to nothing has: {lines[0]}")
    check(all(abs(float(line)) > 1e-6 for line in lines[1:-2]), f"plastic strains {lines[1:-2]}")
    for what, got, want in (("elastic energy", lines[-2], last_of("energy.csv", "elastic")),
                            ("force", lines[-1], last_of("members.csv", "down.force"))):
        check(abs(float(got) - want) <= 1e-9 * max(1, abs(want)), f"{what} {got}, strut says {want}")


# ---- what follows the motion ----

# Sensors of every kind, lags, samples, starts, relays, controllers, oscillators, internal states, Maxwell branches.
def feedback_scene():
    with open(os.path.join(models, "..", "tests", "language", "good", "feedback.yaml"), encoding="utf-8") as file:
        text = file.read()
    text = re.sub(r"^(strut|solver|run|parameters):.*\n", "", text, flags=re.M).replace("gain*", "0.2*").replace(
        "gain *", "0.2 *")
    # of all that can begin something, some does
    return text.replace("of: \"l + 0 m*fan + 0*slow\"", "of: \"l + 0.001 m*fan + 0*slow\"").replace(
        "mass: 1}", "mass: 0.05}")


# Signals that start and relays that switch again and again, without internal states.
SWITCHES = """gravity: [0, -9.81 m/s^2]
nodes:
  left: {position: [0, 1 mm], mass: 0.1 kg}
  right: {position: [100 mm, 5 mm], mass: 0.1 kg}
  top: {position: [50 mm, 80 mm], mass: 0.1 kg}
members:
  foot: {kind: spring, nodes: [left, right], stiffness: 500 N/m, damping: 0.5 N s/m}
  a: {kind: cable, nodes: [left, top], stiffness: 800 N/m, damping: 0.5 N s/m, rest_length_ratio: 0.98}
  b: {kind: bar, nodes: [right, top], stiffness: 800 N/m, damping: 0.5 N s/m, breaks_at: 1 kN, law: {kind: elastic_plastic, yield: 0.8 N, second_stiffness: 200 N/m}}
grounds:
  floor: {height: 0, stiffness: 5 kN/m, damping: 3 N s/m, friction: {mu: 0.3, stick_velocity: 1 mm/s}}
  wall: {slope: 90 deg, through: [105 mm, 0], stiffness: 5 kN/m, damping: 3 N s/m, motion: {x: {sine: {amplitude: 1 mm, frequency: 3 Hz}}}}
sensors:
  pull: {force: b}
  touch: {contact: right}
  height: {position: top, along: y}
  sink: {velocity: top, along: y}
  all: {energy: total}
signals:
  hop: {half_sine: {amplitude: 8 mm, frequency: 8 Hz}, starts: {contact: right, each: yes}}
  rise: {ramp: {amplitude: 3 mm, stop: 0.1 s}, starts: {sensor: sink, below: -0.05 m/s}}
  seen: {expression: 1 mm*pull/(1 N), every: 4 ms}
controllers:
  kick: {kind: relay, of: "sink + 0*height/(1 s)", on_above: 0.01 m/s, off_below: -0.01 m/s, on_value: -1 mm, off_value: 1 mm}
  slow: {kind: relay, of: pull, on_below: -0.5 N, off_above: 0.5 N, on_value: 0.5 mm, off_value: 0, every: 10 ms}
actuators:
  one: {member: foot, signal: {sum: [hop, rise]}}
  two: {member: a, signal: {sum: [kick, slow, seen]}}
  push: {member: foot, force: {expression: 0.1 N*touch + 0.1*pull - 0.01*all/(1 m)}}
"""

MAXWELL = """nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0.1], mass: 1}
  c: {position: [2, 0], fixed: both}
members:
  one: {kind: spring, nodes: [a, b], stiffness: 50, damping: 0.1, maxwell: {stiffness: 100, time: 0.2 s, force: 1 N}}
  two: {kind: spring, nodes: [b, c], stiffness: 50, rest_length: 0.9, maxwell: {stiffness: 80, damping: 4}}
"""


def changes(rows):
    """How often a column of numbers takes another value."""
    return sum(a != b for a, b in zip(rows, rows[1:]))


def test_feedback():
    compare_scene("maxwell.yaml", MAXWELL, 1e-3, 3000, 50)
    compare_scene("feedback.yaml", feedback_scene(), 2e-4, 10000, 100)
    floats_near("feedback.yaml", 2e-4, 500, 1e-3)
    compare_scene("switches.yaml", SWITCHES, 1e-4, 20000, 100)
    floats_near("switches.yaml", 1e-4, 500, 1e-3)
    run("export", "switches.yaml", "--format", "code", "-o", "asked")
    with open(path("asked", "switches_example.c"), "w", encoding="utf-8") as main:
        main.write('#include <stdio.h>\n#include "switches.h"\nstatic switches_state s;\nint main(void) {\n'
                   "  switches_init(&s);\n  for (int n = 0; n < 20000; n++) {\n"
                   "    switches_step_rk4(&s, NULL, 1e-4);\n"
                   '    if (n % 20 == 0) printf("%d %d %.17g %.17g %.17g\\n", s.relay_above[0], s.relay_above[1], '
                   "s.started_at[0], s.held[0], s.sensor[SWITCHES_SENSOR_pull]);\n  }\n  return 0;\n}\n")
    lines = subprocess.run([build(compilers[0], "switches", directory="asked")], capture_output=True,
                           text=True).stdout.splitlines()
    counts = [changes(column) for column in zip(*(line.split() for line in lines))]
    print("changes of relays, start, sample, sensor:", *counts)
    check(all(count >= 2 for count in counts), f"something never switches: {counts}")


# ---- masses that slide along members ----

SLIDERS = """gravity: [0, -9.81 m/s^2]
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [200 mm, 0], mass: 0.2}
  c: {position: [200 mm, 100 mm], mass: 0.1}
  d: {position: [0, 150 mm], fixed: x, mass: 0.1}
members:
  ab: {kind: bar, nodes: [a, b], stiffness: 10 kN/m, damping: 1, mass: 0.1}
  bc: {kind: spring, nodes: [b, c], stiffness: 1 kN/m, mass: 0.1}
  ca: {kind: cable, nodes: [c, a], stiffness: 1 kN/m, damping: 1}
  cd: {kind: bar, nodes: [c, d], stiffness: 2 kN/m, damping: 2}
  da: {kind: bar, nodes: [d, a], stiffness: 2 kN/m, mass: 0.05}
signals:
  to_and_fro: {sine: {amplitude: 0.3, frequency: 3 Hz}}
  away: {ramp: {amplitude: 20 mm, start: 0.1 s, stop: 0.3 s}}
  zigzag: {table: [[0, 0], [0.1 s, 30 mm], [0.25 s, -30 mm], [0.4 s, 0], [2 s, 20 mm]]}
sliders:
  still: {member: ab, mass: 0.1, position: 30 %}
  metres: {member: bc, mass: 20 g, position: 40 mm, travel: away}
  shares: {member: bc, mass: 20 g, position: 0.5, moves: to_and_fro}
  both: {member: ca, mass: 20 g, position: 50 mm, moves: {sum: [to_and_fro, {constant: 0.3}]}}
  blows: {member: cd, mass: 50 g, position: 50 %, travel: zigzag}
actuators: {pull: {member: ca, signal: {sine: {amplitude: 3 mm, frequency: 2 Hz}}}}
"""


def test_sliders():
    rows = compare_scene("sliders.yaml", SLIDERS, 1e-4, 10000, 100)
    check(rows[0][-1] != rows[0][-2], "sliders are at rest")
    alone = re.sub(r"actuators:.*\n", "sensors: {x: {position: c, along: x}}\n", SLIDERS)
    compare_scene("alone.yaml", "mass_model: lumped\n" + alone, 1e-4, 5000, 100)
    watched = re.sub(r"actuators:.*\n", "sensors: {k: {energy: total}, x: {position: c, along: x}}\n"
                     "states: {z: {rate: (x - z)/(0.1 s), start: 0 m}}\n"
                     "actuators: {pull: {member: ca, signal: {expression: 0.1*z, every: 5 ms}}}\n"
                     "loads: {push: {node: b, force: [0, 1 N], signal: {expression: k/(1 J)}}}\n", SLIDERS)
    compare_scene("watched.yaml", watched, 1e-4, 5000, 100)
    floats_near("sliders.yaml", 1e-4, 1000, 1e-4)


# ---- each feature alone ----

# Code is written of what a scene has only, so that each alone must compile without a warning, too.
ALONE = """nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0.1], mass: 1}
  d: {position: [2, 0], mass: 1}
members:
  one: {kind: spring, nodes: [a, b], stiffness: 50, damping: 0.1MEMBER}
  two: {kind: cable, nodes: [b, d], stiffness: 50, rest_length: 0.9, mass: 0.1}
initial: {velocities: {b: [0, 1], d: [0.3, -1]}}
"""
GRAVITY = "gravity: [0, -9.81]\n"
GROUND = GRAVITY + "ground: {height: -0.01, stiffness: 1e4, damping: 10}\n"


def driven_by(signal, more=""):
    return f"{more}actuators: {{p: {{member: two, signal: {signal}}}}}\n"


def loaded_by(sensor, unit, more=""):
    return (f"{more}sensors: {{k: {sensor}}}\n"
            f"loads: {{f: {{node: d, force: [0, 1], signal: {{expression: k/(1 {unit})}}}}}}\n")


WAVE = "{sine: {amplitude: 0.1, frequency: 3 Hz}}"
FEATURES = {  # of the first member, and of the scene
    "plastic": (", law: {kind: elastic_plastic, yield: 0.3}", ""),
    "plastic_drive": (", law: {kind: elastic_plastic, yield: 0.3}", driven_by(WAVE)),
    "breaks": (", breaks_at: 1", ""),
    "breaks_drive": (", breaks_at: 1", driven_by(WAVE)),
    "hinge": ("", "hinges: {h: {nodes: [a, b, d], stiffness: 3, law: {kind: elastic_plastic, yield: 0.3}}}\n"),
    "lag": ("", driven_by("s", "signals: {s: {constant: 0.1, lag: 0.1 s}}\n")),
    "every": ("", driven_by("s", "signals: {s: {expression: 0.1*sin(3 Hz*t), every: 10 ms}}\n")),
    "state": ("", driven_by("{expression: 0.1 m*z}", "states: {z: {rate: 1/(1 s) - z/(1 s), start: 0}}\n")),
    "unused": ("", "sensors: {l: {length: one}}\nstates: {z: {rate: l - z/(1 s), start: 0 m s}}\n"),
    "length": ("", driven_by("{expression: 0.1*l}", "sensors: {l: {length: one}}\n")),
    "relay": ("", driven_by("k", "sensors: {x: {position: d, along: x}}\ncontrollers: {k: {kind: relay, of: x, "
                            "on_above: 2.02 m, off_below: 2.01 m, on_value: 0.1 m, off_value: 0 m}}\n")),
    "sampled_relay": ("", driven_by("k", "controllers: {k: {kind: relay, of: sin(20 Hz*t), on_above: 0.5, "
                                    "off_below: -0.5, on_value: 0.1 m, off_value: 0 m, every: 20 ms}}\n")),
    "start": ("", driven_by("s", "sensors: {v: {velocity: d, along: x}}\nsignals: {s: {ramp: {amplitude: 0.1, "
                            "stop: 0.1 s}, starts: {sensor: v, below: 0.25 m/s}}}\n")),
    "touchdown": ("", driven_by("s", GROUND + "signals: {s: {ramp: {amplitude: 0.1, stop: 0.1 s}, "
                                "starts: {contact: d}}}\n")),
    "touch": ("", loaded_by("{contact: b}", "N", GROUND).replace("k/(1 N)", "k")),
    "energy": ("", loaded_by("{energy: kinetic}", "J")),
    "force": (", law: {kind: elastic_plastic, yield: 0.3}", loaded_by("{force: one}", "N")),
    "broken_force": (", breaks_at: 1, shortest: 0.98, stop_stiffness: 100", loaded_by("{force: one}", "N")),
    "area": ("", loaded_by("{area: c}", "m^2", "cells: {c: {nodes: [a, b, d], stiffness: 3}}\n")),
    "pressure": ("", loaded_by("{pressure: c}", "N/m", "cells: {c: {nodes: [a, b, d], gas: {kind: isothermal, "
                               "pressure: 3, outside: 2}}}\n")),
    "distance": ("", loaded_by("{distance: c}", "m", "distances: {c: {nodes: [b, d], along: 30 deg, stiffness: 3}}\n")),
    "hit": ("", loaded_by("{collision_force: c}", "N", "collisions: {c: {node: d, member: one, thickness: 1.05, "
                          "stiffness: 30}}\n")),
    "maxwell_force": (", maxwell: {stiffness: 3, time: 0.1 s}", loaded_by("{force: one}", "N")),
    "slides": ("", f"sliders: {{m: {{member: one, mass: 0.1, position: 50 %, moves: {WAVE}}}}}\n"),
    "turns": ("", GRAVITY + "sliders: {m: {member: one, mass: 0.1, position: 50 %, moves: {ramp: {amplitude: 0.1, "
              "stop: 0.1 s}}}}\n"),
    "rests": ("", GRAVITY + "sliders: {m: {member: one, mass: 0.1, position: 50 %}}\n"),
    "rayleigh": ("", "rayleigh: {mass: 0.5 s^-1}\n"),
    "rayleigh_lumped": (", mass: 0.2", "mass_model: lumped\nrayleigh: {mass: 0.5 s^-1}\n"),
    "rayleigh_sliders": (", mass: 0.2", "rayleigh: {mass: 0.5 s^-1}\nsliders:\n  m: {member: one, mass: 0.1, position: 50 %, "
                         f"moves: {WAVE}}}\n  n: {{member: one, mass: 0.1, position: 30 %}}\n"),
    "shaken": ("", GROUND.replace("}", ", motion: {y: {sine: {amplitude: 10 mm, frequency: 3 Hz}}}}")),
}


def test_alone():
    for k, (name, (member, more)) in enumerate(FEATURES.items()):
        method, compiler = (("rk4", compilers[0]), ("verlet", compilers[-1]))[k % 2]
        scene(name + ".yaml", ALONE.replace("MEMBER", member) + more, method, 1e-3, 1000, 20)
        compare(name + ".yaml", method, 1e-3, 1000, 20, [compiler])
    scene("single.yaml", "nodes: {a: {position: [0, 1], mass: 1}}\ninitial: {velocity: [1, 0]}", "rk4", 1e-3, 100, 10)
    compare("single.yaml", "rk4", 1e-3, 100, 10, compilers)


if __name__ == "__main__":
    if compilers:
        test_grounds()
        test_memory()
        test_feedback()
        test_sliders()
        test_alone()
    finish()

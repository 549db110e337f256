# SPDX-License-Identifier: GPL-3.0-or-later
# strut export --code of what only some scenes have: several grounds. The C has strut's bits, by rk4 and verlet, and
# compiles without a warning.
#
#   python3 code_features_test.py STRUT MODELS
import os
import shutil
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "support"))
from exported_code import build, code_rows, compare, compilers, path, run, work, write  # noqa: E402
from findings import check, finish  # noqa: E402


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
        run("export", name, "--code", real, "--real", real, "--prefix", "x")
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
  stone: {circle: {centre: [70 mm, 0], radius: 8 mm}, stiffness: 1 kN/m, damping: 1 N s/m, friction: {mu: 0.3, stick_velocity: 1 mm/s}}
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


if __name__ == "__main__":
    if compilers:
        test_grounds()
    shutil.rmtree(work)
    finish()

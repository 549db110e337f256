# SPDX-License-Identifier: GPL-3.0-or-later
# Curves over two parameters: Duffing's folds and their cusp by the harmonic balance, the bilinear oscillator's
# grazing by its transfer function, doublings against single branches; files, refusals.
import json
import math
import os

from testing import check, finish, models, near, rows, run, work, write

duffing = os.path.join(models, "basics", "duffing.yaml")


def follow(*words, code=0):
    return run("path", "--periodic", *words, code=code)


# ---- folds: where ((s - w^2)^2 + (c w)^2) A^2 = F^2, s = 1 + 3/4 b A^2, has a vertical tangent


def frequencies(amplitude):
    """w and F of the two folds at an amplitude: d(F^2)/d(A^2) = 0 at fixed w, a quadratic equation of w^2."""
    cubic, damping = 0.05, 0.05
    # with x = A^2: F^2 = ((1 + k x - w2)^2 + c^2 w2) x, whose derivative by x is 0
    k, x = 0.75 * cubic, amplitude**2
    # (1 + k x - w2)^2 + c^2 w2 + 2 k x (1 + k x - w2) = 0
    a, b, c = 1.0, -2 * (1 + k * x) + damping**2 - 2 * k * x, (1 + k * x)**2 + 2 * k * x * (1 + k * x)
    inside = b * b - 4 * a * c
    found = []
    for sign in (-1, 1):
        if inside >= 0:
            w2 = (-b + sign * math.sqrt(inside)) / 2
            found.append((math.sqrt(w2) / 2 / math.pi, math.sqrt(((1 + k * x - w2)**2 + damping**2 * w2) * x)))
    return found


folds = json.loads(follow(duffing, "--over", "frequency=0.14Hz..0.2Hz", "--and", "force=0.06N..0.15N", "-o", "folds",
                       "--json").stdout)
curves = folds["curves"]
check([c["kind"] for c in curves] == ["fold"] and len(curves[0]["cusps"]) == 1, f"curves of folds: {len(curves)}")
check(folds["and"] == "force" and folds["and_at"] == 0.1, "the second parameter")
for p in curves[0]["points"]:
    frequency, force = p["values"]
    want = min(frequencies(p["amplitude"]), key=lambda w: abs(w[0] - frequency))
    near(frequency, want[0], f"frequency of the fold at {force}", 3e-3)
    check(0.0599 < force < 0.1501, f"a fold at {force}")
    check(p["stable"], "the fold bounds a stable motion")
ends = [curves[0]["points"][i]["values"] for i in (0, -1)]
check(all(abs(e[1] - 0.15) < 1e-5 for e in ends) and ends[0][0] < ends[1][0], f"ends {ends}")
# the cusp: the least force on the curve of folds
least = min((f for a in range(900, 1800) for f in frequencies(a / 1000)), key=lambda f: f[1])
near(curves[0]["cusps"][0][0], least[0], "frequency of the cusp", 2e-3)
near(curves[0]["cusps"][0][1], least[1], "force at the cusp", 1e-2)
# each fold of the branch is on the curve
special = [p["value"] for p in folds["branches"][0]["special"] if p["point"] == "fold"]
for value in special:
    pairs = [p["values"] for p in curves[0]["points"]]
    crossing = [a[0] + (0.1 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in zip(pairs, pairs[1:])
                if (a[1] - 0.1) * (b[1] - 0.1) <= 0 and a[1] != b[1]]
    check(min(abs(c - value) for c in crossing) < 2e-5, f"fold at {value}, curve at {crossing}")
check(os.path.exists(os.path.join(work, "folds", "curves.svg")), "no figure")
table = rows("folds", "curves.csv")
check([r["point"] for r in table].count("cusp") == 1 and len(table) == len(curves[0]["points"]), "curves.csv")

# ---- grazing: where the amplitude of the free oscillator is the gap

write("bilinear.yaml", """strut: 1
name: Bilinear oscillator
parameters: {frequency: 1 Hz, gap: 30 mm, push: 1 N}
nodes: {top: {position: [0, 1 + gap], fixed: both}, mass: {position: [0, gap], fixed: x, mass: 1}}
members: {spring: {kind: spring, nodes: [top, mass], stiffness: 100, damping: 1, rest_length: 1}}
ground: {stiffness: 100, damping: 0, contacts: {mass: {}}}
loads: {push: {node: mass, force: [0, push], signal: {sine: {amplitude: 1, frequency: frequency}}}}
solver: {integrator: rk4, step: 1 ms}
run: {periods: 100, of: push, measure: {node: mass}}
""")
grazing = json.loads(follow("bilinear.yaml", "--over", "frequency=1Hz..1.45Hz", "--and", "push=0.6N..1.6N", "--json").stdout)
check([(c["kind"], c["node"]) for c in grazing["curves"]] == [("grazing", "mass")], "curves of grazing")
for curve in grazing["curves"]:
    check(len(curve["points"]) > 20, "a short curve")
    for p in curve["points"]:
        turn = 2 * math.pi * p["values"][0]
        near(p["values"][1] / math.hypot(100 - turn**2, turn), 0.03, f"gap at {p['values']}", 1e-5)

# ---- doublings: a point of the curve is where a branch at that value doubles

write("wells.yaml", """strut: 1
name: Two wells
parameters: {force: 0.17 N, damping: 0.25 N s/m}
nodes: {wall: {position: [0, 0], fixed: both}, mass: {position: [10.2, 0], fixed: y, mass: 1}}
members:
  spring: {kind: spring, nodes: [wall, mass], law: {kind: polynomial, coefficients: [-1 N/m, 0, 1 N/m^3]},
           damping: damping, rest_length: 10}
loads: {push: {node: mass, force: [force, 0], signal: {sine: {amplitude: 1, frequency: 1/(2*pi)*1 Hz}}}}
solver: {integrator: rk4, step: 1 ms}
run: {periods: 200, of: push, measure: {node: mass}}
""")
doublings = json.loads(follow("wells.yaml", "--over", "force=0.178N..0.186N", "--values", "0.179N", "--and", "damping=0.24 N s/m..0.26 N s/m",
                           "--json").stdout)["curves"]
check([(c["kind"], c["period_multiple"]) for c in doublings] == [("period-doubling", 1)], "curves of doublings")
force, damping = doublings[0]["points"][3]["values"]
alone = json.loads(follow("wells.yaml", "--over", "force=0.176N..0.182N", "--values", "0.176N", "--set", f"damping={damping}",
                       "--json").stdout)
near([p["value"] for p in alone["branches"][0]["special"] if p["point"] == "period-doubling"][0], force, "a doubling alone",
     1e-6)

# ---- refusals


def refused(text, *words):
    done = follow(duffing, "--over", "frequency=0.14Hz..0.24Hz", *words, code=1)
    check(text in done.stderr, f"stderr lacks '{text}': {done.stderr}")


refused("--and: the model has no parameter 'forze'; did you mean 'force'?", "--and", "forze=1N..2N")
refused("--and force: expected two values LOW..HIGH", "--and", "force=2N..1N")
refused("name the same parameter", "--and", "frequency=1Hz..2Hz")
refused("missing --and NAME=LOW..HIGH", "--and", "force")
finish()

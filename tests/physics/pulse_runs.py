# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads and friction that change within a moment: the impulse on a free mass is the integral of the signal, in runs with
an accuracy and by every method with events, at steps far longer than the moment."""
import json
import math
import random

from testing import check, finish, run, write

SCENE = """strut: 1
nodes: {{a: {{position: [0, 0], mass: 1, fixed: y}}}}
loads: {{push: {{node: a, force: [1 N, 0], signal: {signal}}}}}
initial: {{velocities: {{a: [1, 0]}}}}
solver: {{{solver}}}
run: {{duration: 2 s, measure: {{quantities: {{v: {{of: a.vx-1, take: final}}}}}}}}
"""
BLOCK = """strut: 1
nodes: {{a: {{position: [0, -1 mm], mass: 1}}}}
gravity: [0, -10]
ground: {{stiffness: 1e4, damping: 10, friction: {{law: coulomb, mu: {signal}}}}}
initial: {{settle: false, velocities: {{a: [30, 0]}}}}
solver: {{{solver}}}
run: {{duration: 2 s, measure: {{quantities: {{v: {{of: a.vx, take: final}}}}}}}}
"""
SOLVERS = (("accuracy: 0.1 %", 1e-3), ("integrator: adaptive, step: 10 ms", 1e-3),
           ("integrator: adaptive, step: 50 ms, tolerance: 1e-4", 3e-2), ("integrator: adaptive8, step: 20 ms", 1e-3),
           ("integrator: rk4-events, step: 10 ms", 3e-2), ("integrator: verlet-events, step: 10 ms", 1e-1))


def integral(f, edges):
    """Of f over 2 s, which is smooth between its edges: Simpson's rule."""
    total, points = 0.0, sorted({0.0, 2.0, *(min(max(e, 0.0), 2.0) for e in edges)})
    for a, b in zip(points, points[1:]):
        n, inside = 4000, (b - a) * 1e-12
        at = [f(min(max(a + (b - a) * k / n, a + inside), b - inside)) for k in range(n + 1)]
        total += (b - a) / n / 3 * (at[0] + at[n] + 4 * sum(at[1:n:2]) + 2 * sum(at[2:n:2]))
    return total


def gaussian(t0, w):
    return (f"exp(-((t-{t0} s)/({w} s))^2)", lambda t: math.exp(-((t - t0) / w) ** 2),
            [t0 - 7 * w, t0, t0 + 7 * w], math.sqrt(math.pi) * w)


def triangle(t0, w):
    return (f"max(0, 1-abs(t-{t0} s)/({w} s))", lambda t: max(0, 1 - abs(t - t0) / w), [t0 - w, t0, t0 + w], w)


def two(t0, w):
    text, f, edges, size = gaussian(t0, w)
    other, g, more, _ = triangle(t0 / 2, w / 3)
    return f"0.2*sin(3 rad/s*t) + {text} + {other}", lambda t: 0.2 * math.sin(3 * t) + f(t) + g(t), edges + more, size


def burst(t0, w):
    text, f, edges, size = gaussian(t0, w)
    return (f"{text}*(0.2+sin(6 rad*t/({w} s)))", lambda t: f(t) * (0.2 + math.sin(6 * t / w)), edges, size)


def window(t0, w):
    text, f, edges, size = triangle(t0, w)
    return (f"({text})*cos(2 rad*(t-{t0} s)/({w} s))^2", lambda t: f(t) * math.cos(2 * (t - t0) / w) ** 2, edges, size)


def train(t0, w):
    p = 20 * w
    edges = [k * p + e for k in range(int(2 / p) + 1) for e in (0, w)]
    return (f"floor(t/({p} s)) - floor((t-{w} s)/({p} s))", lambda t: math.floor(t / p) - math.floor((t - w) / p),
            edges, 2 / p * w)


def smooth_step(t0, w):
    return (f"0.5*(tanh((t-{t0} s)/({w} s)) - tanh((t-{t0} s-{3 * w} s)/({w} s)))",
            lambda t: 0.5 * (math.tanh((t - t0) / w) - math.tanh((t - t0 - 3 * w) / w)),
            [t0 - 20 * w, t0, t0 + 3 * w, t0 + 23 * w], 3 * w)


def rational(t0, w):
    return (f"1/(1+((t-{t0} s)/({w} s))^2)^2", lambda t: 1 / (1 + ((t - t0) / w) ** 2) ** 2,
            [t0 + s * w * 10 ** k for k in range(4) for s in (-1, 1)] + [t0], w)


def velocity(scene, signal, solver):
    write("pulse.yaml", scene.format(signal=signal, solver=solver))
    result = run("run", "pulse.yaml", "--json", "--quiet", timeout=60)
    return json.loads(result.stdout)["measured"]["v"]["value"]


def right(found, expected, size, what):
    check(found is not None and abs(found - expected) <= size, f"{what}: {found}, expected {expected} +- {size}")


random.seed(60)
for n, kind in enumerate((gaussian, triangle, two, burst, window, train, smooth_step, rational) * 3):
    t0, w = random.uniform(0.2, 1.8), 10 ** random.uniform(-5, -1.5)
    if kind is train:
        w = 10 ** random.uniform(-3, -1.5)
    text, f, edges, size = kind(t0, w)
    expected = integral(f, edges)
    for solver, part in SOLVERS:
        found = velocity(SCENE, f'{{expression: "(1 s)/({w} s)*({text})"}}', solver)
        right(found, expected / w, part * (size / w + abs(expected / w)), f"{kind.__name__} {t0}, {w}, {solver}")

# Friction, a short half wave, and a table with near points.
for solver, part in SOLVERS:
    t0, w = random.uniform(0.2, 1.8), 10 ** random.uniform(-4, -2)
    found = velocity(BLOCK, f'{{expression: "(0.1 s)/({w} s)*exp(-((t-{t0} s)/({w} s))^2)"}}', solver)
    right(found, 30 - math.sqrt(math.pi), 2 * part, f"friction {t0}, {w}, {solver}")
    found = velocity(SCENE, f"{{half_sine: {{amplitude: {1 / w}, frequency: {0.5 / w}, start: {t0}}}}}", solver)
    right(found, 2 / math.pi, part, f"half wave {t0}, {w}, {solver}")
    found = velocity(SCENE, f"{{table: [[0, 0], [{t0}, 0], [{t0 + 1e-7}, {2e7}], [{t0 + 2e-7}, 0]]}}", solver)
    right(found, 2, 2 * part, f"table {t0}, {solver}")

# Rigid bars have a fixed step: the shortest pulse sets it.
PENDULUM = """strut: 1
nodes: {{o: {{position: [0, 0], fixed: both}}, b: {{position: [0, -1], mass: 1}}}}
members: {{s: {{kind: bar, nodes: [o, b], stiffness: 1e6}}}}
gravity: [0, -9.81]
loads: {{push: {{node: b, force: [1 N, 0], signal: {signal}}}}}
solver: {{{solver}}}
bars: rigid
run: {{duration: 1 s, measure: {{quantities: {{v: {{of: b.x, take: final}}}}}}}}
"""
found = velocity(PENDULUM, '{expression: "1000*exp(-((t-0.53 s)/(1 ms))^2)"}', "accuracy: 0.1 %")
right(found, 0.538822, 1e-5, "a rigid pendulum; 0.538822 with elastic bars")  # k = 1e6, adaptive
finish()

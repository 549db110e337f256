# SPDX-License-Identifier: GPL-3.0-or-later
"""What happens for a moment between two steps, in runs with an accuracy and by every method with events: balls that
strike each other, by a spring that only pushes and as a collision, against steps of a tenth of the contact."""
import random

from testing import answer, check, finish, write

SCENE = """strut: 1
parameters: {{d: 50 mm, v: {v}, k: 1e7, x: {x}, b: {b}}}
nodes: {{a: {{position: [x, b], mass: 1}}, b: {{position: [0, 0], mass: 1}}}}
{body}
initial: {{velocities: {{a: [v, 0]}}}}
solver: {{{solver}}}
run:
  duration: 1 s
  measure:
    quantities: {{va: {{of: a.vx, take: final}}, vb: {{of: b.vx, take: final}}, wb: {{of: b.vy, take: final}}}}
"""
SPRING = "members: {s: {kind: spring, nodes: [a, b], rest_length: d, stiffness: k, law: compression_only}}"
COLLISION = "collisions: {hit: {nodes: [a, b], thickness: d, stiffness: k}}"


def velocities(values, solver):
    write("balls.yaml", SCENE.format(solver=solver, **values))
    measured = answer("run", "balls.yaml")["measured"]
    return [measured[name]["value"] for name in ("va", "vb", "wb")]


random.seed(59)
for n in range(40):
    v = random.uniform(3, 30)
    values = dict(v=v, x=-random.uniform(0.1, 0.7) * v, b=random.uniform(-0.06, 0.06), body=(SPRING, COLLISION)[n % 2])
    right = velocities(values, "integrator: adaptive, step: 20 us, tolerance: 1e-11")
    for solver, part in (("accuracy: 0.1 %", 1e-3), ("integrator: adaptive, step: 10 ms", 1e-3),
                         ("integrator: adaptive8, step: 10 ms, tolerance: 1e-9", 1e-3),
                         ("integrator: rk4-events, step: 150 us", 3e-2), ("integrator: verlet-events, step: 20 us", 3e-2)):
        found = velocities(values, solver)
        error = max(abs(a - b) for a, b in zip(found, right))
        check(error <= part * v, f"run {n}, {solver}: {found}, expected {right}")

# A mass misses the anchor of its spring, whose force turns round within a step; no step is longer than the grid's.
MISS = """strut: 1
nodes: {{a: {{position: [0, 0], fixed: both}}, m: {{position: [-1, {miss}], mass: 1}}}}
members: {{s: {{kind: spring, nodes: [a, m], stiffness: 20, rest_length: 0.6}}}}
initial: {{velocities: {{m: [3, 0]}}}}
solver: {{integrator: {solver}}}
run: {{duration: 2, measure: {{quantities: {{x: {{of: m.x, take: final}}}}}}}}
"""
for miss in (0.3, 0.01, 0.003, 1e-7):
    ends = []
    for solver in ("adaptive, step: 1 ms, tolerance: 1e-9", "rk4-events, step: 20 ms", "rk4-events, step: 5 ms"):
        write("miss.yaml", MISS.format(miss=miss, solver=solver))
        ends.append(answer("run", "miss.yaml")["measured"]["x"]["value"])
    check(max(ends) - min(ends) < 1e-5, f"a miss of {miss} m: {ends}")
finish()

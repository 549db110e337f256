# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments as loads against closed forms: a chain on springs rolls up, each by M / k, beyond a turn; a weight on a bar
turns by M = m g L sin(theta), over its limit points; a barrier has the moment's work in it; runs through several turns
follow the linear equation of one angle, and their balance closes."""
import cmath
import math

from testing import answer, check, finish, write

CHAIN = """strut: 1
groups: {rod: {kind: bar, stiffness: 1 MN/m}, spring: {stiffness: 1 N m/rad}}
nodes: {w: {position: [-1, 0], fixed: both}, a: {position: [0, 0], fixed: both}, b: [1, 0], c: [2, 0], d: [3, 0]}
members: {p: {group: rod, nodes: [a, b]}, q: {group: rod, nodes: [b, c]}, r: {group: rod, nodes: [c, d]}}
hinges: {h: {group: spring, nodes: [w, a, b]}, i: {group: spring, nodes: [a, b, c]}, j: {group: spring, nodes: [b, c, d]}}
loads: {m: {LOAD}}
"""
BAR = """strut: 1
nodes: {o: {position: [0, 0], fixed: both}, w: {position: [1.5, 0], fixed: both, mass: 1}, p: {position: [AT], mass: 0.4}}
members: {rod: {kind: bar, nodes: [o, p], stiffness: 10 MN/m, damping: 100}MORE}
"""
RUN = """hinges: {h: {nodes: [w, o, p], stiffness: 0.3, damping: 0.01, rest_angle: 0}}
loads: {m: {LOAD, signal: {expression: "sin(5*t/(1 s)) + 2*t/(1 s)"}}, k: {member: rod, moment: 0.5}}
run: {duration: 4 s, measure: {quantities: {angle: {of: h.angle, take: final}}}}
"""


def answer_of(text, command, *words):
    write("moment.yaml", text)
    return answer(command, "moment.yaml", *words)


def near(found, expected, part, what):
    check(abs(found - expected) <= part * max(1, abs(expected)), f"{what}: {found}, expected {expected}")


for load, turns, own in (("member: r, moment: 2.6", (2.6, 5.2, 7.8), 2.6 * (7.8 - math.tau)),
                         ("hinge: i, moment: -0.7", (0, -0.7, -0.7), 0.49)):  # fmt: skip
    found = answer_of(CHAIN.replace("LOAD", load), "equilibria")["equilibria"]
    check(len(found) == 1, f"{load}: {len(found)} equilibria")
    for a, b, turn in zip("abc", "bcd", turns):
        (x, y), (u, v) = (found[0]["nodes"][name] for name in (a, b))
        near(math.remainder(math.atan2(v - y, u - x) - turn, math.tau), 0, 1e-12, load)
    near(found[0]["energy"] - found[0]["potential"], own, 1e-12, f"potential of {load}")
weight = "gravity: [0, -10]\nloads: {m: {member: rod, moment: 1}}\n"
path = answer_of(BAR.replace("AT", "0, -0.5").replace("MORE", "") + weight, "path", "--until", "3", "--steps", "60")
for factor, event in zip((2, -2), path["events"]):
    near(event["factor"], factor, 1e-6, "limit point")
for point in path["points"]:
    near(point["factor"], 4 * point["nodes"]["p"][0], 1e-9, "M = m g x")
snap = BAR.replace("AT", "0.6, 0.8").replace("MORE", ", s: {kind: spring, nodes: [p, w], stiffness: 1, rest_length: 1.2}")
snap = answer_of(snap + "loads: {m: {member: rod, moment: 0.02}}\n", "equilibria")
for barrier, height in zip(sorted(b["height"] for b in snap["barriers"]), (0.226833808, 0.263759290)):
    near(barrier, height, 1e-6, "barrier, and by bisection along the circle")

# I a'' + c a' + k a = sin 5 t + 2 t + 1/2 from rest
inertia, c, k, w, t = 0.1, 0.01, 0.3, 5, 4
forced = 1 / (k - inertia * w * w + 1j * w * c)
start, speed = forced.imag + 0.5 / k - 2 * c / k**2, (1j * w * forced).imag + 2 / k
root = (-c + cmath.sqrt(c * c - 4 * k * inertia)) / (2 * inertia)
free = complex(-start, (root.real * start - speed) / -root.imag)
angle = (forced * cmath.exp(1j * w * t)).imag + (2 * t + 0.5) / k - 2 * c / k**2 + (free * cmath.exp(root * t)).real
for load in ("member: rod, moment: 1", "hinge: h, moment: 1"):
    for bars, part, method, step in (("rigid", 1e-8, "rk4", "100 us"), ("elastic", 1e-4, "rk4", "20 us"),
                                     ("elastic", 1e-4, "verlet-events", "20 us"), ("elastic", 1e-4, "midpoint", "50 us"),
                                     ("elastic", 1e-4, "adaptive", "1 ms")):  # fmt: skip
        scene = BAR.replace("AT", "0.5, 0").replace("MORE", "") + RUN.replace("LOAD", load) + f"bars: {bars}\n"
        found = answer_of(scene, "run", "--integrator", method, "--step", step)
        near(found["measured"]["angle"]["value"], angle, part, f"{load}, {bars} bar, {method}")
        near(found["energy"]["residual"] / found["energy"]["exchanged"], 0, 1e-5, f"balance of {load}, {method}")
finish()

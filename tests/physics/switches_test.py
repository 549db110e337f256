#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Switches that methods with events used to miss, or to make without end.

  tests/physics/switches_test.py STRUT

Each scene of tests/physics/switches is run by adaptive, with two longest steps, and by rk4-events: what
they find must not depend on where steps happen to end, nor on the method.

- touch-together: two nodes come down in the same instant.
- square-drive: rest lengths that jump within a step.
- release-before-opening: what holds a node lets go just before the contact opens.
- edge-of-the-band: forces balance for a while at the edge of a stick band.
- yielding: static above kinetic friction; a contact stays where holding and pushing lead to each other.
- jump-at-the-edge: a drive jumps while a contact stays at the edge of its band.
- tied-and-held: both at once, with a loose tolerance.
Found by tests/bench/grids.py; there adaptive8 with long and short steps must agree, too:

- up-and-down-again: a contact opens, and is on its way back by when something else is located.
- touches-again: one that has opened comes back within a step.
- kink-of-a-margin: what ends creep falls slowly, then fast, since another force passes what friction holds.
- gives-way-briefly: a contact gives way within a step at whose ends it would hold.
- released-at-once: three contacts give way at one jump, on either side of 0 by rounding.
- creeps-out-at-a-jump, creeps-in-at-a-jump: creep ends at a jump, and could go on by the end of the step.
- cable-beside-a-jump: a cable is taut or not by its rest length at a jump, not by that of a step not taken.
- damper-turned-twice: a contact goes up and down again while it is closed.
- knee-passed-twice: a strain passes the knee of a law and comes back within a step.
- carried-by-a-belt: speeds of a contact at rest are rounding, and what cannot be located takes its time all the same.
- bounces: a search that meets a root but for rounding is at its end.

Found by random scenes of tests/physics/random_world.c:

- leaves-the-band-briefly: a contact at the edge of its band goes out and comes back within a step.
- guide-slips-briefly: a cable slips at a guide with friction and sticks again within a step.
- slack-in-a-try: a running cable with friction is slack by the end of a step that is not taken.

- guides-at-a-jump: what happens at once where a drive jumps happens with the rest length after it; and the balance
  closes. Found by a file written on the spot.
"""
import math
import os
import re

from testing import answer, check, finish, read, write

scenes = os.path.abspath("tests/physics/switches")


def run(name, *options):
    return answer("run", os.path.join(scenes, f"{name}.yaml"), *options)


def unit_of(name):
    """The drive's period, or a two-hundredth of the run: a fiftieth of it is the file's step."""
    return 50 * float(re.search(rb'step"?: ([-.e\d]+)', read(scenes, f"{name}.yaml"))[1])


def compare(name, part, most_events, *ways):
    """The ways agree in the velocity to `part`, and no one makes more than so many switches."""
    unit = unit_of(name)
    found = [(way(unit), run(name, *way(unit))) for way in ways]
    first = found[0][1]["velocity"]
    for way, one in found:
        check(abs(one["velocity"] - first) <= part * abs(first),
              f"{name}: {one['velocity']} by {way}, {first} by {found[0][0]}")
        check(one["events"] <= most_events, f"{name}: {one['events']} switches by {way}")


def adaptive(steps, tolerance, method="adaptive"):
    return lambda unit: ("--integrator", method, "--step", repr(unit / steps), "--tolerance", tolerance)


def precise(steps, tolerance):
    return adaptive(steps, tolerance, "adaptive8")


def fixed(steps, method="rk4-events"):
    return lambda unit: ("--integrator", method, "--step", repr(unit / steps))


compare("touch-together", 1e-7, 200, adaptive(100, "1e-11"), adaptive(1000, "1e-12"), fixed(1000),
        fixed(4000))
compare("square-drive", 1e-4, 1000, adaptive(100, "1e-9"), adaptive(330, "1e-10"), fixed(16000))
compare("release-before-opening", 1e-4, 400, adaptive(50, "1e-9"), adaptive(100, "1e-9"), fixed(400))
compare("edge-of-the-band", 1e-3, 1000, adaptive(50, "1e-4"), adaptive(100, "1e-9"), fixed(1000))
compare("yielding", 1e-3, 4000, adaptive(400, "1e-12"), adaptive(4000, "1e-11"), fixed(4000),
        fixed(20000))
compare("jump-at-the-edge", 1e-5, 500, adaptive(100, "1e-9"), adaptive(400, "1e-11"), fixed(1000),
        fixed(2000))
compare("tied-and-held", 5e-3, 2000, adaptive(50, "1e-4"), adaptive(100, "1e-9"))
for name, part, most_events in (("up-and-down-again", 1e-9, 90), ("touches-again", 1e-9, 50),
                                ("kink-of-a-margin", 2e-9, 120), ("gives-way-briefly", 1e-9, 120),
                                ("creeps-out-at-a-jump", 1e-9, 160), ("creeps-in-at-a-jump", 1e-9, 420),
                                ("cable-beside-a-jump", 1e-9, 180), ("carried-by-a-belt", 1e-9, 140),
                                ("damper-turned-twice", 1e-9, 210), ("knee-passed-twice", 1e-9, 8),
                                ("leaves-the-band-briefly", 2e-9, 15), ("guide-slips-briefly", 5e-9, 40),
                                ("slack-in-a-try", 1e-9, 20)):
    compare(name, part, most_events, precise(100, "1e-13"), precise(1000, "1e-13"), adaptive(100, "1e-13"))
    compare(name, 50 * part, most_events, precise(100, "1e-10"), precise(1000, "1e-13"))
compare("released-at-once", 1e-9, 120, *(precise(n, t) for n in (100, 300, 1000) for t in ("1e-10", "1e-12")),
        adaptive(100, "1e-12"))
compare("bounces", 1e-9, 20, adaptive(50, "1e-12"), adaptive(500, "1e-12"), precise(50, "1e-12"))

compare("guides-at-a-jump", 1e-9, 180, precise(50, "1e-11"), adaptive(100, "1e-11"), fixed(10000))

# A rest length that jumps: the work of the drive is what it adds to the elastic energy, and the balance
# closes.
for name in ("square-drive", "guides-at-a-jump"):
    energy = run(name, *fixed(4000)(unit_of(name)))["energy"]
    check(abs(energy["residual"]) <= 1e-7 * energy["exchanged"],
          f"{name}: {energy['residual']} J of {energy['exchanged']} J missing")

# Closed forms of what follows sensors, and rest: what must hold of x, and the most switches.
HEAD = "strut: 1\nnodes: {m: {position: [0, 0], mass: 1}}\nsolver: {step: 1}\n"
DRIVEN = HEAD + "sensors: {x: {position: m, along: x}}\ninitial: {velocities: {m: [1, 0]}}\nrun: {duration: %r}\n"
PUSH = 'loads: {push: {node: m, force: [1, 0], signal: {expression: "%s"}}}\n'
REST = HEAD + "gravity: [0, -1]\nground: {stiffness: 1e4, damping: 100}\nrun: {duration: 100}\n"
for text, axis, right, off, most_events, ways in (
        (DRIVEN % (20.5 * 0.15 * math.pi) + PUSH % "max(0, -100*x/(1 m)) - max(0, 400*x/(1 m))", 0,
         -math.sin(math.pi / 4) / 10, 2e-6, 85, (fixed(250), fixed(400), adaptive(1, "1e-7"), precise(1, "1e-8"))),
        (DRIVEN % 40.5 + PUSH % "-(x/(1 m) + 1e-15)/abs(x/(1 m) + 1e-15)", 0, 0.375, 1e-11, 25,
         (fixed(10), adaptive(1, "1e-6"), precise(1, "1e-6"))),
        (REST, 1, -1e-4, 1e-8, 40, (fixed(200), adaptive(1, "1e-5"), adaptive(1, "1e-7"), precise(1, "1e-9")))):
    write("written.yaml", text)
    for way in ways:
        one = answer("run", "written.yaml", *way(1.0))
        check(abs(one["nodes"]["m"]["position"][axis] - right) < off and one["events"] <= most_events,
              f"{text}{way(1.0)}: {one['nodes']}, {one['events']} switches")
finish()

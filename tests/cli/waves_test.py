# SPDX-License-Identifier: GPL-3.0-or-later
"""strut modes --wave against closed forms, long finite chains, and cells of several cells."""
import math

from testing import answer, check, fail, finish, run, write

TAU = 2 * math.pi


def waves(name, text, *options):
    write(name, text)
    return answer("modes", name, "--wave", *options)


def close(what, found, wanted, error=1e-9, scale=0.0):
    check(abs(found - wanted) <= error * max(abs(wanted), scale), f"{what}: {found!r}, expected {wanted!r}")


def diatomic_chain():
    """Brillouin's formula, along the chain and, by its tension, across it."""
    c, pull, light, heavy, half = 100.0, 2.0, 0.01, 0.03, 0.1
    found = waves("diatomic.yaml", f"""
strut: 1
lattice: [[0.2, 0]]
nodes: {{a: {{position: [0, 0], mass: {light}}}, b: {{position: [0.1, 0], mass: {heavy}}}, next: [0.2, 0]}}
members: {{left: {{kind: spring, nodes: [a, b], stiffness: {c}, pretension: {pull}}},
          right: {{kind: spring, nodes: [b, next], stiffness: {c}, pretension: {pull}}}}}
""")

    def formula(phase):
        total = 1 / light + 1 / heavy
        root = math.sqrt(total**2 - 4 * math.sin(math.pi * phase) ** 2 / (light * heavy))
        return sorted(math.sqrt(max(0.0, k * (total + s * root))) / TAU for k in (c, pull / half) for s in (-1, 1))

    for wave in found["waves"]:
        for value, wanted in zip(wave["frequencies"], formula(wave["phase"][0])):
            close("diatomic chain", value, wanted, 1e-9, 1.0)
    check(len(found["gaps"]) == 1 and found["gaps"][0]["below"] == 3, f"diatomic chain: gaps {found['gaps']}")
    close("lower edge", found["gaps"][0]["low"], math.sqrt(2 * c / heavy) / TAU)
    close("upper edge", found["gaps"][0]["high"], math.sqrt(2 * c / light) / TAU)
    for value, k in zip(found["speeds"][0], (pull / half, c)):
        close("speed", value, 0.2 * math.sqrt(k / 2 / (light + heavy)), 1e-5)


def square_lattice():
    """Springs along both axes and diagonals, under tension: a matrix of two by two."""
    c, pull, diagonal, mass, side = 100.0, 2.0, 40.0, 0.01, 0.1
    found = waves("square.yaml", f"""
strut: 1
lattice: [[{side}, 0], [0, {side}]]
nodes: {{a: {{position: [0, 0], mass: {mass}}}, r: [{side}, 0], u: [0, {side}], d: [{side}, {side}]}}
members: {{x: {{kind: spring, nodes: [a, r], stiffness: {c}, pretension: {pull}}},
          y: {{kind: spring, nodes: [a, u], stiffness: {c}, pretension: {pull}}},
          up: {{kind: spring, nodes: [a, d], stiffness: {diagonal}}},
          down: {{kind: spring, nodes: [r, u], stiffness: {diagonal}}}}}
""")
    for wave in found["waves"]:
        x, y = (TAU * p for p in wave["phase"])
        both = diagonal * (2 - math.cos(x + y) - math.cos(x - y))
        k = [[2 * c * (1 - math.cos(x)) + 2 * pull / side * (1 - math.cos(y)) + both,
              diagonal * (math.cos(x - y) - math.cos(x + y))],
             [0, 2 * c * (1 - math.cos(y)) + 2 * pull / side * (1 - math.cos(x)) + both]]
        middle, apart = (k[0][0] + k[1][1]) / 2, math.hypot((k[0][0] - k[1][1]) / 2, k[0][1])
        for value, wanted in zip(wave["frequencies"], (middle - apart, middle + apart)):
            close("square lattice", value, math.sqrt(max(0.0, wanted) / mass) / TAU, 1e-9, 1.0)


def finite_chain():
    """A chain of 200 cells between fixed ends swings as waves whose phase fits into it."""
    cells = 200
    nodes = "".join(f"  n{i}: {{position: [{i}, 0], mass: 0.5}}\n" for i in range(1, cells + 1))
    members = "".join(f"  m{i}: {{group: s, nodes: [n{i}, n{i + 1}]}}\n" for i in range(cells + 1))
    write("finite.yaml", f"""
strut: 1
groups: {{s: {{kind: spring, stiffness: 30, pretension: 3}}}}
nodes:
  n0: {{position: [0, 0], fixed: both}}
  n{cells + 1}: {{position: [{cells + 1}, 0], fixed: both}}
{nodes}members:
{members}""")
    finite = sorted(m["frequency"] for m in answer("modes", "finite.yaml")["modes"])
    endless = waves("endless.yaml", """
strut: 1
lattice: [[1, 0]]
nodes: {a: {position: [0, 0], mass: 0.5}, next: [1, 0]}
members: {s: {kind: spring, nodes: [a, next], stiffness: 30, pretension: 3}}
""")
    for wave in endless["waves"]:  # a sine, which the finite chain's ends cut at whole halves
        phase = wave["phase"][0]
        for value, k in zip(wave["frequencies"], (3.0, 30.0)):
            close("endless chain", value, math.sqrt(4 * k / 0.5) * math.sin(math.pi * phase) / TAU, 1e-9, 1.0)
    wanted = sorted(math.sqrt(4 * k / 0.5) * math.sin(math.pi * j / 2 / (cells + 1)) / TAU
                    for k in (3.0, 30.0) for j in range(1, cells + 1))
    for value, exact in zip(finite, wanted):
        close("chain of 200", value, exact, 1e-8)
    close("highest of both", finite[-1], endless["bands"][1]["high"], 1e-4)


CELL = """
  cell:
    nodes: {a: {position: [0, 0], mass: 0.2}, b: {position: [0.4, 0.3], mass: 0.1},
            c: {position: [0.2, -0.5], mass: 0.15}, e: [1, 0.1]}
    members:
      ab: {kind: spring, nodes: [a, b], stiffness: 40, mass: 0.05, rest_length: 0.47}
      bc: {kind: bar, nodes: [b, c], stiffness: 90, mass: 0.1, rest_length: 0.85}
      ca: {kind: cable, nodes: [c, a], stiffness: 70, rest_length: 0.5}
      be: {kind: spring, nodes: [b, e], stiffness: 50, rest_length: 0.55}
      ce: {kind: spring, nodes: [c, e], rest_length: 0.9, law: {kind: polynomial, coefficients: [30 N/m, 0, 40 N/m^3]}}
    hinges: {h: {nodes: [a, b, c], stiffness: 2, rest_angle: 1 rad}}
"""


def cells_of_cells():
    """Four cells as one: its waves in step are the cell's, one, two and three quarters of a turn apart."""
    one = waves("one.yaml", "strut: 1\nlattice: [[1, 0.1]]\nparts:" + CELL +
                "place: {c: {part: cell}}\nloads: {w: {node: c.c, force: [0, -1]}, v: {node: c.a, force: [0, 1]}}\n")
    four = waves("four.yaml", "strut: 1\nlattice: [[4, 0.4]]\nparts:" + CELL +
                 "place: {c: {part: cell, repeat: {count: 4, step: [1, 0.1], next: {merge: {e: a}}}}}\nloads:\n" +
                 "".join(f"  w{i}: {{node: c.{i}.c, force: [0, -1]}}\n  v{i}: {{node: c.{i}.a, force: [0, 1]}}\n"
                         for i in range(4)))
    if one["moved"] < 1e-3 or one["residual"] > 1e-12 or four["residual"] > 1e-12:
        fail(f"cells of cells: {one['moved']}, {one['residual']}, {four['residual']}")
    at = {round(w["phase"][0], 9): w["frequencies"] for w in one["waves"]}
    together = sorted(at[0.0] + 2 * at[0.25] + at[0.5])
    for value, wanted in zip(four["waves"][0]["frequencies"], together):
        close("four cells", value, wanted, 1e-9, 1.0)
    check(together[-1] >= 1 and len(together) == 24, "four cells: nothing was compared")


def held_cells():
    """Cells that hang from supports let no wave below a frequency pass; their weight stretches what holds them."""
    found = waves("held.yaml", """
strut: 1
gravity: [0, -10]
lattice: [[1, 0]]
nodes: {a: {position: [0, -1], mass: 2}, next: [1, -1], top: {position: [0, 0], fixed: both}}
members: {s: {kind: spring, nodes: [a, next], stiffness: 30, pretension: 3},
          hang: {kind: cable, nodes: [top, a], stiffness: 100}}
""")
    sag = 20 / 100
    close("sag", -1 - found["nodes"]["a"][1], sag)
    close("sag of the image", -1 - found["nodes"]["next"][1], sag)
    for wave in found["waves"]:
        swing = 2 * (1 - math.cos(TAU * wave["phase"][0]))
        wanted = sorted((20 / (1 + sag) + 30 * swing, 100 + 3 * swing))
        for value, k in zip(wave["frequencies"], wanted):
            close("held cells", value, math.sqrt(k / 2) / TAU)
    close("below", found["gaps"][0]["high"], math.sqrt(20 / 1.2 / 2) / TAU)
    check(found["gaps"][0]["below"] == 0, "held cells: no gap under the first band")


def refusals():
    def refuse(text, code, message, *options):
        write("bad.yaml", "strut: 1\n" + text)
        run("modes", "bad.yaml", "--wave", *options, code=code, err=message)

    pair = "nodes: {a: {position: [0, 0], mass: 1}, b: [1, 0]}\nmembers: {m: {nodes: [a, b], stiffness: 1, kind: bar}}\n"
    refuse(pair, 1, "--wave needs 'lattice'")
    refuse("lattice: [1, 0]\n" + pair, 2, "a lattice has one or two steps")
    refuse("lattice: [[0, 0]]\n" + pair, 2, "must lead somewhere")
    refuse("lattice: [[1, 0], [2, 0]]\n" + pair, 2, "parallel")
    refuse("lattice: [[1, 1 N]]\n" + pair, 2, "length")
    refuse("lattice: [[2, 0]]\n" + pair, 2, "no node lies a step")
    refuse("lattice: [[1, 0]]\n" + pair, 1, "--at 'nowhere'", "--at", "nowhere")
    refuse("lattice: [[1, 0]]\n" + pair, 1, "--wave knows no ground", "--stuck")
    refuse("lattice: [[1, 0]]\n" + pair.replace("mass: 1", "mass: 0"), 3, "has no mass")
    refuse("lattice: [[1, 0]]\ngravity: [0, -1]\n" + pair, 3, "no equilibrium near this shape")


diatomic_chain()
square_lattice()
finite_chain()
cells_of_cells()
held_cells()
refusals()
finish()

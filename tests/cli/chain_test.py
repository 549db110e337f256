# SPDX-License-Identifier: GPL-3.0-or-later
"""strut equilibria finds every state of a chain of bistable cells, those about to vanish too.

The chain is enumerated apart: where the first apex stands tells where all others must, by the balance
of one cell after the other, so that its equilibria are the roots of one function of one number."""
import math

from testing import answer, check, fail, finish, write

HEIGHT, SPACING = 0.3, 2.0
REST = math.sqrt(1 + HEIGHT * HEIGHT)


def force(x):
    return 2 * x * (1 - REST / math.sqrt(1 + x * x))


def stiffness(x):
    return 2 * (1 - REST / (1 + x * x) ** 1.5)


def shoot(first, coupling, cells):
    """Heights of all apexes, and the force that the last one lacks."""
    heights, step = [first], 0.0
    for _ in range(cells - 1):
        step += force(heights[-1]) / coupling
        heights.append(heights[-1] + step)
        if abs(heights[-1]) > 3:
            return heights, math.copysign(math.inf, heights[-1])
    return heights, step + force(heights[-1]) / coupling


def enumerate_all(coupling, cells, points=40000):
    found, before, lacked = [], None, None
    for k in range(points):
        first = 0.66 * (k + 0.37) / points - 0.33
        lacks = shoot(first, coupling, cells)[1]
        if before is not None and lacks * lacked < 0:
            low, high = before, first
            for _ in range(100):
                middle = 0.5 * (low + high)
                if shoot(middle, coupling, cells)[1] * lacked > 0:
                    low = middle
                else:
                    high = middle
            heights, rest = shoot(0.5 * (low + high), coupling, cells)
            if len(heights) == cells and abs(rest) < 1:
                found.append(heights)
        before, lacked = first, lacks
    return found


def is_stable(heights, coupling):
    pivot = None
    for i, x in enumerate(heights):
        neighbours = (i > 0) + (i < len(heights) - 1)
        diagonal = stiffness(x) + coupling * neighbours
        pivot = diagonal - (coupling ** 2 / pivot if pivot else 0)
        if pivot <= 0:
            return False
    return True


def write_chain(cells):
    lines = ["strut: 1", "name: Chain", "parameters: {coupling: 0.01 N/m}", "groups:",
             "  bar: {kind: bar, stiffness: 1 N/m}", "  apex: {fixed: x, mass: 1 kg}", "nodes:"]
    for i in range(cells):
        y = SPACING * i
        lines += [f"  left{i}: {{position: [-1, {y}], fixed: both}}",
                  f"  right{i}: {{position: [1, {y}], fixed: both}}",
                  f"  apex{i}: {{position: [0, {y + HEIGHT}], group: apex}}"]
    lines += ["members:"]
    for i in range(cells):
        lines += [f"  rising{i}: {{group: bar, nodes: [left{i}, apex{i}]}}",
                  f"  falling{i}: {{group: bar, nodes: [apex{i}, right{i}]}}"]
        if i:
            lines += [f"  between{i}: {{kind: spring, nodes: [apex{i - 1}, apex{i}], "
                      f"stiffness: coupling, rest_length: {SPACING}}}"]
    write(f"chain-{cells}.yaml", "\n".join(lines) + "\n")


def check_chain(cells, coupling, seed):
    what = f"{cells} cells, coupling {coupling}, seed {seed}"
    states = [h for h in enumerate_all(coupling, cells) if is_stable(h, coupling)]
    reported = answer("equilibria", f"chain-{cells}.yaml", "--set", f"coupling={coupling} N/m", "--seed", str(seed))
    stable = [e for e in reported["equilibria"] if e["label"] == "stable"]
    for heights in states:
        if not any(all(abs(e["nodes"][f"apex{i}"][1] - SPACING * i - x) < 1e-6
                       for i, x in enumerate(heights)) for e in stable):
            fail(f"{what}: lacks the state at " + " ".join(f"{x:.6f}" for x in heights))
    check(len(stable) == len(states), f"{what}: {len(stable)} stable states, not {len(states)}")
    missed = reported["missed"]
    check(0 < missed["probability"] <= missed["probability_bound"] <= 1, f"{what}: chance {missed}")
    rare = sum(e["found"] <= 2 for e in stable)
    if rare > 2 and missed["unreached"] == 0 and missed["probability_bound"] < 4 / reported["starts"]:
        fail(f"{what}: {rare} states were hardly met, of which nothing is said: {missed}")


for number in (2, 3, 4):
    write_chain(number)
# the states of the shorter chains, as models/gallery/bistable-chain.yaml has them
check(len(enumerate_all(0.01, 2)) == 9 and len(enumerate_all(0.01, 4)) == 81, "the enumeration itself is wrong")
check_chain(2, 0.02914, 1)
check_chain(3, 0.0285, 1)
for value in (0.02, 0.0288, 0.02885, 0.0289, 0.029, 0.0291, 0.02913, 0.02914, 0.0292):
    check_chain(4, value, 1)
for number in (2, 3):
    check_chain(4, 0.029, number)

finish()

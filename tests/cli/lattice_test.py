# SPDX-License-Identifier: GPL-3.0-or-later
"""strut equilibria of lattices of n bistable cells, which have 2^n stable states, one for each choice of
up or down, as long as their coupling is weak: all where they are few; else what it says of the rest holds."""
import re

from testing import answer, check, finish, models, run


def cells(columns, rows):
    return "equilibria", f"{models}/parts/bistable-lattice.yaml", "--set", f"columns={columns}", "--set", f"rows={rows}"


def choice(equilibrium, columns, rows):
    """Which apexes are below the feet of their arches."""
    return tuple(equilibrium["nodes"][f"cell.{i}.{j}.apex"][1] < 2 * j for i in range(columns) for j in range(rows))


for columns, rows in ((2, 2), (2, 3)):
    reported = answer(*cells(columns, rows))
    stable = {choice(e, columns, rows) for e in reported["equilibria"] if e["label"] == "stable"}
    labels = [e["label"] for e in reported["equilibria"]]
    check(len(stable) == labels.count("stable") == 2 ** (columns * rows),
          f"{columns} x {rows} cells: {labels.count('stable')} stable states, {len(stable)} different ones")
    check(reported["missed"]["at_least"] == 0, f"{columns} x {rows} cells: {reported['missed']}")

printed = run(*cells(6, 4)).stdout
listed = int(re.search(r"equilibria +(\d+)", printed)[1])
more = int(re.search(r"more stable ones exist, at least \(95 %\) +(\d+)", printed)[1])
chance = float(re.search(r"next start finds a new stable one +([0-9.]+)", printed)[1])
check("cut short" in printed and 1000 < more <= 2 ** 24 - listed and chance > 0.5, f"6 x 4 cells: {printed[:800]}")

finish()

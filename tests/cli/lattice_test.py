# SPDX-License-Identifier: GPL-3.0-or-later
"""strut equilibria of lattices of n bistable cells, which have 2^n stable states, one for each choice of
up or down, as long as their coupling is weak: all where they are few; else what it says of the rest holds.

usage: lattice_test.py STRUT LATTICE
"""
import json
import subprocess
import sys

from testing import fail, finish, strut


def find(columns, rows):
    done = subprocess.run([strut, "equilibria", sys.argv[2], "--json", "--set", f"columns={columns}",
                           "--set", f"rows={rows}"], capture_output=True, text=True)
    if done.returncode:
        fail(f"{columns} x {rows} cells: {done.stderr}")
    return json.loads(done.stdout)


def choice(equilibrium, columns, rows):
    """Which apexes are below the feet of their arches."""
    return tuple(equilibrium["nodes"][f"cell.{i}.{j}.apex"][1] < 2 * j
                 for i in range(columns) for j in range(rows))


for columns, rows in ((2, 2), (2, 3), (6, 4)):
    what, cells = f"{columns} x {rows} cells", columns * rows
    reported = find(columns, rows)
    stable = [e for e in reported["equilibria"] if e["label"] == "stable"]
    missed = reported["missed"]
    if len({choice(e, columns, rows) for e in stable}) != len(stable):
        fail(f"{what}: one state is listed twice")
    if len(stable) + missed["at_least"] > 2 ** cells:
        fail(f"{what}: {len(stable)} states, and at least {missed['at_least']} more")
    if cells <= 6 and len(stable) != 2 ** cells:
        fail(f"{what}: {len(stable)} stable states")
    if cells > 6 and not (missed["cut_short"] and missed["at_least"] > 1000 and
                          missed["probability_bound"] > 0.5):
        fail(f"{what}: {len(stable)} states, {missed}")

finish()

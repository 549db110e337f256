# SPDX-License-Identifier: GPL-3.0-or-later
"""strut equilibria of lattices of n bistable cells, which have 2^n stable states, one for each choice of
up or down, as long as their coupling is weak: all where they are few; else what it says of the rest holds.

usage: lattice_test.py STRUT LATTICE
"""
import json
import re
import subprocess
import sys

from testing import check, fail, finish, strut


def find(columns, rows, *options):
    done = subprocess.run([strut, "equilibria", sys.argv[2], "--set", f"columns={columns}", "--set", f"rows={rows}",
                           *options], capture_output=True, text=True)
    check(not done.returncode, f"{columns} x {rows} cells: {done.stderr}")
    return done.stdout


def choice(equilibrium, columns, rows):
    """Which apexes are below the feet of their arches."""
    return tuple(equilibrium["nodes"][f"cell.{i}.{j}.apex"][1] < 2 * j for i in range(columns) for j in range(rows))


for columns, rows in ((2, 2), (2, 3)):
    reported = json.loads(find(columns, rows, "--json"))
    stable = {choice(e, columns, rows) for e in reported["equilibria"] if e["label"] == "stable"}
    labels = [e["label"] for e in reported["equilibria"]]
    if not len(stable) == labels.count("stable") == 2 ** (columns * rows):
        fail(f"{columns} x {rows} cells: {labels.count('stable')} stable states, {len(stable)} different ones")
    check(reported["missed"]["at_least"] == 0, f"{columns} x {rows} cells: {reported['missed']}")

printed = find(6, 4)
listed = int(re.search(r"(\d+) equilibria from", printed)[1])
more = int(re.search(r"at least (\d+) more stable ones exist", printed)[1])
chance = float(re.search(r"finds a new stable one: about ([0-9.]+)", printed)[1])
if "cut short" not in printed or not more > 1000 or listed + more > 2 ** 24 or not chance > 0.5:
    fail(f"6 x 4 cells: {printed[:800]}")

finish()

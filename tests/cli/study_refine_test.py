# SPDX-License-Identifier: GPL-3.0-or-later
# Refined maps: the same answer as all points of the finest grid where the edge has a formula, with a
# part of the points; the same bytes whatever the threads, shards, kills; the map drawn is that of the
# finest grid.
import math
import os
import random
import shutil
import signal

from testing import answer, check, copy_models, finish, path, read, rows, run, same_table, stopped, write


copy_models()


def limit(height):
    """Load at which the arch snaps through: L^3 = L0 there."""
    rest = math.hypot(1, height)
    length = rest ** (1 / 3)
    return 2000 * math.sqrt(length ** 2 - 1) * (rest / length - 1)


def study(name, heights, loads, more="", keep="stable_count"):
    write(name + ".yaml", f"""strut: 1
study: map
model: copied/basics/von-mises-truss.yaml
compute: equilibria
axes: [{{stiffness: [1000 N/m, 2000 N/m]}}, {{height: {heights}}}, {{load: {loads}}}]
keep: [{keep}]
figures: {{map: {{kind: map, x: height, y: load, color: stable_count, panels: stiffness}}}}
{more}""")


COARSE = ("{from: 0.2 m, to: 0.52 m, count: 5}", "{from: 0 N, to: 90 N, step: 15 N}")
FULL = ("{from: 0.2 m, to: 0.52 m, count: 17}", "{from: 0 N, to: 90 N, step: 3.75 N}")
REFINE = "refine: {where: stable_count, depth: 2}\n"


def the_edge_is_found():
    study("full", *FULL)
    study("fine", *COARSE, REFINE)
    count = answer("sweep", "fine.yaml", "--count")
    check(count["points"] == 2 * 5 * 7 and count["most_points"] == 2 * 17 * 25, f"{count}")
    run("sweep", "full.yaml", "-o", "full", "--quiet")
    run("sweep", "fine.yaml", "-o", "fine", "--quiet")
    full, fine = rows("full/table.csv"), rows("fine/table.csv")
    print(f"    {len(fine)} points of {len(full)}")
    check(len(fine) < 0.45 * len(full), f"{len(fine)} points of {len(full)}")
    for row in full:
        top = limit(float(row["height [m]"])) * float(row["stiffness [N/m]"]) / 1000
        states = 2 if float(row["load [N]"]) < top else 1
        check(int(row["stable_count"]) == states, f"not as by the formula: {row}, limit {top}")
    check([full[int(row["point"])] for row in fine] == fine, "rows with the same bits and numbers")
    check(read("full/map.svg") == read("fine/map.svg"), "the map is that of all points")
    status = answer("sweep", "fine.yaml", "-o", "fine", "--status")
    check(status["points"] == status["done"] == len(fine), f"{status}")
    again = answer("sweep", "fine.yaml", "-o", "fine")
    check(again["computed"] == 0, f"{again}")


def same_bytes():
    table = read("fine/table.csv")
    same_table("fine.yaml", "fine", shards=())
    # Shards in rounds, in any order, until no one waits for another.
    rounds = random.Random(1)
    for _ in range(12):
        order = [0, 1, 2]
        rounds.shuffle(order)
        waits = [run("sweep", "fine.yaml", "-o", "parts", "--quiet", "--shard", f"{k}/3").stderr for k in order]
        if not any("run this shard again" in text for text in waits):
            break
        if os.path.exists(path("parts/shards")) and len(os.listdir(path("parts/shards"))) == 3 and \
                waits[-1]:
            check("run all shards again" in run("sweep", "--merge", "parts", code=4).stderr, "an early merge")
    run("sweep", "--merge", "parts", "--quiet")
    check(read("parts/table.csv") == table, "shards: another table")


def a_shard_without_points():
    """All coarse points are of shard 0: the other one ends at once, and says whom it waits for."""
    shutil.copy("models/basics/sliding-block.yaml", path("block.yaml"))
    write("few.yaml", """strut: 1
study: few
model: block.yaml
axes: [{mu: {from: 0.1, to: 0.4, count: 3}}, {mass: {from: 1, to: 3, count: 3}}]
refine: {where: steps, depth: 1}
keep: [steps]
""")
    run("sweep", "few.yaml", "-o", "few", "--quiet", "--shard", "1/2", timeout=60, err="9 points of other shards")
    for k in (0, 1):
        run("sweep", "few.yaml", "-o", "few", "--quiet", "--shard", f"{k}/2", timeout=60)
    run("sweep", "--merge", "few")


def emitted():
    run("sweep", "fine.yaml", "-o", "fine", "--emit", "slurm", "--shards", "3", err="in rounds")


def killed():
    table = read("fine/table.csv")
    for n in range(8):
        stopped("sweep", "fine.yaml", "-o", "killed", "--quiet", after=random.Random(n).uniform(0.01, 0.25),
                by=signal.SIGKILL if n % 2 else signal.SIGINT)
    run("sweep", "fine.yaml", "-o", "killed", "--quiet")
    check(read("killed/table.csv") == table, "kills: another table")


def numbers_and_failures():
    """Numbers that differ by more than asked; a failed point is an edge, too."""
    study("flat", *COARSE, "refine: {where: energy_1, depth: 3, by: 1000}\n", "energies")
    run("sweep", "flat.yaml", "-o", "flat", "--quiet", code=2)  # the figure's column is not kept
    study("flat", *COARSE, "refine: {where: energy_1, depth: 3, by: 1000}\n", "energies, stable_count")
    run("sweep", "flat.yaml", "-o", "flat", "--quiet")
    check(len(rows("flat/table.csv")) == 2 * 5 * 7, "nothing differs by so much")
    study("steep", *COARSE, "refine: {where: energy_1, depth: 1, by: 0}\n", "energies, stable_count")
    run("sweep", "steep.yaml", "-o", "steep", "--quiet")
    check(len(rows("steep/table.csv")) == 2 * 9 * 13, "everything differs")
    write("fails.yaml", """strut: 1
study: fails
model: copied/basics/von-mises-truss.yaml
compute: path
axes: [{height: {from: 0.2 m, to: 0.52 m, count: 3}}, {load: {from: 0 N, to: 90 N, count: 3}}]
refine: {where: end, depth: 1}
keep: [end]
path: {until: 0.1}
""")
    run("sweep", "fails.yaml", "-o", "fails", "--quiet", code=3)  # no load at all
    table = rows("fails/table.csv")
    check(9 < len(table) < 25 and any(r["status"] != "completed" for r in table), f"{len(table)}")


def refused(more, said):
    write("bad.yaml", f"""strut: 1
study: bad
model: copied/basics/von-mises-truss.yaml
compute: equilibria
keep: [stable_count]
axes: [{{height: {COARSE[0]}}}, {{load: {COARSE[1]}}}, {{stiffness: [1, 2]}}]
{more}""")
    run("sweep", "bad.yaml", "-o", "bad", code=2, err=said)


the_edge_is_found()
same_bytes()
a_shard_without_points()
emitted()
killed()
numbers_and_failures()
refused("refine: {where: outcome, depth: 2}\n", "no column 'outcome'")
refused("refine: {where: stable_count, depth: 2, axes: [height, stiffness]}\n", "cannot be refined")
finish()

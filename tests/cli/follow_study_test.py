# SPDX-License-Identifier: GPL-3.0-or-later
# Studies that follow motions: Duffing's folds over the force, threads, a kill, Ctrl-C, refusals.
import filecmp
import json
import math
import os
import shutil
import signal

from periodic import DUFFING, duffing_folds_at
from testing import answer, check, finish, path, rows, run, stopped, write

with open(DUFFING, encoding="utf-8") as file:
    write("duffing.yaml", file.read() + "configurations: {drawn: {}}\n")
STUDY = """strut: 1
study: Duffing's folds
model: duffing.yaml
axes: [{force: [0.06 N, 0.1 N, 0.15 N]}]
follow:
  over: frequency
  from: 0.14 Hz
  to: 0.24 Hz
figures: {widest: {x: force, y: amplitude_max}}
"""
write("study.yaml", STUDY)

# ---- the same bytes from one thread and from several, and the folds of the harmonic balance

check("points             3" in run("check", "study.yaml").stdout, "check tells the points")
check("points   3\n" in run("sweep", "study.yaml", "--count").stdout, "the count")
report = answer("sweep", "study.yaml", "-o", "out")
run("sweep", "study.yaml", "-o", "one", "--threads", "1", "-q")
for name in ("branches.csv", "branches.svg", "report.json", "table.csv", "widest.svg"):
    check(filecmp.cmp(path("out", name), path("one", name), shallow=False), f"threads change {name}")
table = rows("out", "table.csv")
check([row["folds"] for row in table] == ["0", "2", "2"], f"folds: {table}")
check(all(row["status"] == "completed" and row["branches"] == "1" for row in table), f"table: {table}")
points = rows("out", "branches.csv")
check(len(points) == sum(int(row["branch_points"]) for row in table), "rows of all branches")
for force in ("0.1", "0.15"):
    folds = [float(p["frequency [Hz]"]) for p in points if p["force [N]"] == force and p["point"] == "fold"]
    check(len(folds) == 2, f"folds at {force}: {folds}")
    for got, want in zip(folds, duffing_folds_at(float(force))):
        check(abs(got - want) < 5e-3 * want, f"a fold at {force} N: {got}, expected {want}")
    wide = [row for row in table if row["force [N]"] == force][0]
    mine = max(float(p["amplitude [m]"]) for p in points if p["force [N]"] == force and p["stable"] == "yes")
    check(float(wide["amplitude_max [m]"]) == mine, "the widest stable motion")
check([p["axes"]["force"] for p in report["points"]] == [0.06, 0.1, 0.15], "axes of the report")
check([s["point"] for s in report["points"][2]["result"]["branches"][0]["special"]] == ["fold", "fold"], "the report")
check(report == json.load(open(path("out", "report.json"), encoding="utf-8")), "report.json")
check("done     3\n" in run("sweep", "study.yaml", "-o", "out", "--status").stdout, "status")

# ---- one point alone is what `strut path --periodic` finds

run("path", "--periodic", "duffing.yaml", "--over", "frequency=0.14Hz..0.24Hz", "--set", "force=0.15", "-o", "alone", "-q")
alone = rows("alone", "branches.csv")
check([{"force [N]": "0.15", **p} for p in alone] == [p for p in points if p["force [N]"] == "0.15"], "the command alone")

# ---- what is there is not computed again; a point lost before its row is

before = os.stat(path("out", "branches", "000000000.csv")).st_mtime_ns
run("sweep", "study.yaml", "-o", "out", "-q")
check(os.stat(path("out", "branches", "000000000.csv")).st_mtime_ns == before, "computed again")
os.rename(path("out", "branches", "000000001.csv"), path("away.csv"))
check("remove points.slots" in run("sweep", "study.yaml", "-o", "out", "-q", code=4).stderr, "a missing file")
os.rename(path("away.csv"), path("out", "branches", "000000001.csv"))

# ---- killed, and interrupted: the same command goes on

write("long.yaml", STUDY.replace("0.15 N]", "0.15 N, 0.2 N]").replace("to: 0.24 Hz", "to: 0.3 Hz\n  accuracy: 0.001 %"))
run("sweep", "long.yaml", "-o", "whole", "-q")
for stop, wait in ((signal.SIGKILL, 0.7), (signal.SIGINT, 0.7)):
    shutil.rmtree(path("part"), ignore_errors=True)
    job = stopped("sweep", "long.yaml", "-o", "part", "-q", "--threads", "1", after=wait, by=stop)
    if stop == signal.SIGINT and job.returncode != 0:
        check("interrupted after" in job.stderr, f"interrupt: {job.stderr}")
        partial = rows("part", "branches-partial.csv")
        check({p["finished"] for p in partial} <= {"yes", "no"}, "what is finished")
    run("sweep", "long.yaml", "-o", "part", "-q")
    for name in ("branches.csv", "report.json", "table.csv"):
        check(filecmp.cmp(path("part", name), path("whole", name), shallow=False), f"{stop} changes {name}")
    check(not os.path.exists(path("part", "branches-partial.csv")), "a partial file is left")
    check(not [f for f in os.listdir(path("part", "branches")) if "partial" in f], "partial branches are left")

# ---- without axes; from configurations; kicks

write("single.yaml", STUDY.replace("axes: [{force: [0.06 N, 0.1 N, 0.15 N]}]\n", "").replace(
    "figures: {widest: {x: force, y: amplitude_max}}", "  at: [0.17 Hz]\n  start_from: [drawn]\n  basins: yes"))
single = answer("sweep", "single.yaml", "-o", "single")
result = single["points"][0]["result"]
check(len(result["branches"]) == 1 and len(result["basins"]) >= 1, f"a single point: {result['notes']}")
check(len(rows("single", "branches.csv")) == len(result["branches"][0]["points"]), "rows of a single point")

# ---- a point that cannot be followed is a row

write("damped.yaml", STUDY.replace("force: [0.06 N, 0.1 N, 0.15 N]", "damping: [0, 0.05]").replace(
    "figures: {widest: {x: force, y: amplitude_max}}", ""))
done = run("sweep", "damped.yaml", "-o", "damped", "-q", code=3)
table = rows("damped", "table.csv")
check([row["status"] == "completed" for row in table] == [False, True], f"a failed point: {table}")
check("starts no branch" in table[0]["message"] or "periodic" in table[0]["message"], table[0]["message"])
check("1 of 2 points failed" in done.stderr, done.stderr)

# ---- refusals


def refused(text, *words, change=None, code=1):
    if change:
        write("changed.yaml", STUDY.replace(*change))
    run(*(words or ("check",)), "changed.yaml" if change else "study.yaml", code=code, err=text)


refused("--shard cannot be used", "sweep", "-o", "none", "--shard", "0/2")
refused("--emit cannot be used", "sweep", "-o", "none", "--emit", "slurm")
refused("the study follows motions over 'frequency'", "sweep", "-o", "none", "--set", "frequency=1", code=2)
refused("9:16: error: 'start_from' of what is followed: the model has no configuration 'I'", change=(
    "figures:", "  start_from: [I]\nfigures:"), code=2)
refused("no drive whose period", change=("figures:", "run: {duration: 5 s}\nfigures:"), code=2)
refused("the table has no column 'velocity'", change=("y: amplitude_max", "y: velocity"), code=2)
finish()

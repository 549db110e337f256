# SPDX-License-Identifier: GPL-3.0-or-later
# Points of a sweep per second of CPU, with batch and without, measured in turn in one run: the crawler
# at the paper's numerics (rk4, 0.1 ms), and by verlet-events, on one thread.
#
#   python3 sweep_batch.py STRUT [POINTS [PERIODS]]
import os
import resource
import shutil
import subprocess
import sys
import tempfile

strut = os.path.realpath(sys.argv[1])
points = int(sys.argv[2]) if len(sys.argv) > 2 else 64
periods = int(sys.argv[3]) if len(sys.argv) > 3 else 110
model = os.path.realpath(os.path.join(os.path.dirname(__file__), "../../models/crawler/crawler.yaml"))
REPEATS = 3

STUDY = """strut: 1
study: batch
model: MODEL
axes:
  - frequency: {from: 5 Hz, to: 15 Hz, count: POINTS}
SOLVER
run: {periods: PERIODS, measure: {last: 10}}
keep: [velocity, periods]
"""


def seconds(work, batch):
    folder = os.path.join(work, "out")
    shutil.rmtree(folder, ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([strut, "sweep", "study.yaml", "-o", folder, "--threads", "1", "--quiet"] +
                   (["--batch", str(batch)] if batch else []), cwd=work, check=True)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with open(os.path.join(folder, "table.csv"), "rb") as file:
        return spent, file.read()


print(f"{points} points of {periods} periods, points per second of CPU (best of {REPEATS})")
for name, solver in (("rk4", ""), ("verlet-events",
                                   "solver: {integrator: verlet-events, step: 0.08 ms}")):
    work = tempfile.mkdtemp()
    shutil.copy(model, work)
    with open(os.path.join(work, "study.yaml"), "w") as file:
        file.write(STUDY.replace("MODEL", os.path.basename(model)).replace("POINTS", str(points))
                   .replace("SOLVER", solver).replace("PERIODS", str(periods)))
    best, tables = {}, set()
    for _ in range(REPEATS):
        for batch in (1, 2, 4, 0):
            spent, table = seconds(work, batch)
            best[batch] = min(spent, best.get(batch, spent))
            tables.add(table)
    for batch, spent in best.items():
        print(f"  {name:14} batch {batch or 'as is good'!s:10} {points / spent:8.1f}  "
              f"x {best[1] / spent:.2f}")
    if len(tables) != 1:
        sys.exit("the tables differ")
    shutil.rmtree(work)

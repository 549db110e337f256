#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much sooner strut has the paper's figure 8 than the paper's way of computing it.

usage: figure8_speed.py STRUT [THREADS [SAMPLE [SEED]]]

All 1146 runs with `accuracy: 0.5 %`, until the motion is steady, by one `strut sweep` with THREADS (2)
threads; against the same runs of 1100 periods of rk4 at 0.1 ms one after another on one thread without
batch. Of these a SAMPLE (24) is run, half of it before the sweep and half after: one frequency drawn from
each of so many parts of equal simulated time, friction and start drawn too, and their time per simulated
second scaled to all. Prints elapsed and CPU seconds and both ratios; on a machine that does other things
at the same time the CPU seconds say more.
"""
import csv
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time

strut = os.path.abspath(sys.argv[1])
threads = int(sys.argv[2]) if len(sys.argv) > 2 else 2
sample = int(sys.argv[3]) if len(sys.argv) > 3 else 24
seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
model = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "models", "crawler",
                     "crawler.yaml")
FREQUENCIES = [i / 10 for i in range(10, 201)]
FRICTIONS, STARTS, PERIODS = ["0.1", "0.2", "0.5"], ["I", "II"], 1100


def sweep(name, text, work, options):
    """Elapsed and CPU seconds, and the table."""
    path = os.path.join(work, name + ".yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"strut: 1\nstudy: {name}\nmodel: {os.path.basename(model)}\n{text}")
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    run = subprocess.run([strut, "sweep", path, "-o", os.path.join(work, name)] + options,
                         capture_output=True, text=True, check=False)
    elapsed, after = time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode not in (0, 3):
        sys.exit(f"FAILED: {run.stderr}")
    with open(os.path.join(work, name, "table.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return elapsed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, rows


def drawn():
    """So many points, of equal shares of the simulated time of all."""
    generator = random.Random(seed)
    total = sum(1 / f for f in FREQUENCIES)
    points = []
    for part in range(sample):
        wanted, reached = (part + generator.random()) / sample * total, 0.0
        for f in FREQUENCIES:
            reached += 1 / f
            if reached >= wanted:
                break
        points.append((f, generator.choice(FRICTIONS), generator.choice(STARTS)))
    generator.shuffle(points)
    return points


def the_papers_way(name, points, work):
    """Elapsed and CPU seconds per simulated second."""
    text = "axes:\n  - zip:\n"
    for key, column in zip(("frequency", "friction", "start"), zip(*points)):
        text += f"      {key}: [{', '.join(str(v) for v in column)}]\n"
    elapsed, cpu, rows = sweep(name, text + "keep: [duration, steps, outcome]\n", work,
                               ["--threads", "1"] + no_lanes())
    simulated = sum(float(row["duration [s]"]) for row in rows)
    wanted = sum(PERIODS / f for f, _, _ in points)
    if abs(simulated / wanted - 1) > 1e-4:  # whole steps
        sys.exit(f"FAILED: {simulated} s simulated instead of {wanted} s")
    return elapsed / simulated, cpu / simulated


def no_lanes():
    text = subprocess.run([strut, "sweep", "--help"], capture_output=True, text=True, check=False)
    return ["--batch", "1"] if "--batch" in text.stdout + text.stderr else []


def main():
    points = drawn()
    with tempfile.TemporaryDirectory() as work:
        shutil.copy(model, work)
        first = the_papers_way("before", points[0::2], work)
        elapsed, cpu, rows = sweep("figure-8", f"""axes:
  - friction: [{', '.join(FRICTIONS)}]
  - start: [{', '.join(STARTS)}]
  - frequency: {{from: 1 Hz, to: 20 Hz, step: 0.1 Hz}}
solver: {{accuracy: 0.5 %}}
run: {{measure: {{steady: true}}}}
keep: [velocity, motion, periods, force_evaluations, check_evaluations, method, outcome]
""", work, ["--threads", str(threads)])
        last = the_papers_way("after", points[1::2], work)
    simulated = len(FRICTIONS) * len(STARTS) * PERIODS * sum(1 / f for f in FREQUENCIES)
    paper = [simulated * (a + b) / 2 for a, b in zip(first, last)]
    forces = [float(r["force_evaluations"]) + float(r["check_evaluations"]) for r in rows
              if r["status"] == "completed"]
    print(f"figure 8 at 0.5 %: {len(rows)} runs, {len(rows) - len(forces)} failed, in {elapsed:.1f} s "
          f"on {threads} threads, {cpu:.1f} s of CPU time; {sum(forces) / len(forces):.0f} forces a run")
    print(f"the paper's way: {paper[0]:.0f} s, {paper[1]:.0f} s of CPU time (before the sweep "
          f"{1e3 * first[1]:.3f} ms per simulated second, after it {1e3 * last[1]:.3f} ms; {sample} of 1146 "
          f"runs, {simulated:.0f} s in all), {simulated * 4e4 / 1146:.0f} forces a run")
    print(f"sooner by a factor of {paper[0] / elapsed:.1f} (elapsed), {threads * paper[1] / cpu:.1f} "
          f"(CPU time, both threads busy)")
    print("dearest runs: " + "; ".join(
        f"{r['frequency [Hz]']} Hz, mu {r['friction']}, {r['start']}: {work_of(r):.2g} forces, {r['method']}"
        for r in sorted(rows, key=work_of)[-8:]))


def work_of(row):
    return float(row["force_evaluations"] or 0) + float(row["check_evaluations"] or 0)


main()

#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random points of the paper's figures 8 and 10, by strut and by a program that shares no code with it.

usage: points_test.py STRUT REFERENCE_POINTS [COUNT [SEED [LOWEST]]]

COUNT points of each figure (6 if not given), of frequencies from LOWEST (1 Hz) for figure 8. Strut runs them with
`accuracy: 0.5 %` and checks itself (`check: {half_step: yes}`); the other program takes fixed steps
of 4 us, and of 1 us where the two differ. Where neither changes its mind about where it ends, the
outcomes must be equal, and velocities of motions that repeat themselves within 2 % or 0.1 mm/s.
"""
import csv
import os
import random
import shutil
import subprocess
import sys
import tempfile

strut, reference = (os.path.abspath(path) for path in sys.argv[1:3])
count = int(sys.argv[3]) if len(sys.argv) > 3 else 6
seed = int(sys.argv[4]) if len(sys.argv) > 4 else 20171
lowest = float(sys.argv[5]) if len(sys.argv) > 5 else 1.0
models = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "models", "crawler")
STEP, FINE_STEP = "4e-6", "1e-6"
RELATIVE, ABSOLUTE = 0.02, 1e-4  # of the velocity; [m/s]


def draw(generator, figure):
    """A point: frequency [Hz], friction, start, amplitude [m]."""
    start = generator.choice(["I", "II"])
    friction = generator.choice([0.1, 0.2, 0.5, round(generator.uniform(0.05, 0.7), 4)])
    if figure == 8:
        return round(generator.uniform(lowest, 20), 4), friction, start, 1e-4
    size = round(generator.uniform(1e-4, 1e-3), 7)
    friction = generator.choice([0.1, friction])  # the paper's map has 0.1 only
    return round(generator.uniform(10, 15), 4), friction, start, size if start == "I" else -size


def study(figure, points):
    """What strut is asked: all points zipped."""
    columns = {"frequency": [p[0] for p in points], "friction": [p[1] for p in points],
               "start": [p[2] for p in points], "amplitude": [p[3] for p in points]}
    lists = "\n".join(f"      {name}: [{', '.join(str(v) for v in values)}]"
                      for name, values in columns.items())
    run = "{measure: {steady: true}}" if figure == 8 else "{duration: 1 s}"
    model = "crawler/crawler.yaml" if figure == 8 else "crawler/switch.yaml"
    return f"""strut: 1
study: Random points of figure {figure}
model: {model}
axes:
  - zip:
{lists}
solver: {{accuracy: 0.5 %}}
run: {run}
check: {{half_step: yes}}
keep: [velocity, motion, periods, force_evaluations, check_evaluations, outcome]
"""


def by_strut(figure, points, work):
    path = os.path.join(work, f"figure-{figure}.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(study(figure, points))
    directory = os.path.join(work, f"figure-{figure}")
    subprocess.run([strut, "sweep", path, "-o", directory], check=False,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(os.path.join(directory, "table.csv"), encoding="utf-8") as file:
        return list(csv.DictReader(file))


def by_reference(figure, points, step):
    """Side by side, in two halves."""
    lines = [f"{figure} {p[0]!r} {p[1]!r} {p[2]} {p[3]!r}\n" for p in points]
    halves = [lines[0::2], lines[1::2]]
    running = [subprocess.Popen([reference, step], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                text=True) for _ in halves]
    for process, half in zip(running, halves):
        process.stdin.write("".join(half))
        process.stdin.close()
    answers = [process.stdout.read().splitlines() for process in running]
    for process in running:
        if process.wait() != 0:
            sys.exit("FAILED: the reference gave up")
    answers = [answers[i % 2][i // 2].split() for i in range(len(points))]
    return [{"outcome": a[0], "motion": a[1], "velocity": float(a[2])} for a in answers]


def apart(row, other):
    """Why the two do not say the same, or None."""
    if row["status"] != "completed":
        return f"strut: {row['status']}, {row['message']}"
    if row["outcome"] != other["outcome"]:
        return f"strut ends in {row['outcome']}, the other in {other['outcome']}"
    velocity = float(row["velocity [m/s]"])
    if other["motion"] != "periodic":
        return None
    error = abs(velocity - other["velocity"])
    if error > max(ABSOLUTE, RELATIVE * abs(other["velocity"])):
        return f"strut {1e3 * velocity:.4f} mm/s, the other {1e3 * other['velocity']:.4f} mm/s"
    return None


def compare(figure, points, rows, others):
    """Prints and counts; returns how many differ for good."""
    flipping = changing = irregular = wrong = 0
    worst = 0.0
    for point, row, other in zip(points, rows, others):
        words = f"figure {figure}: f {point[0]} Hz, mu {point[1]}, {point[2]}, {1e3 * point[3]:.4f} mm"
        if row["flips"] == "1":
            flipping += 1
            continue
        reason = apart(row, other)
        if reason:
            fine = by_reference(figure, [point], FINE_STEP)[0]
            if fine["outcome"] != other["outcome"] or fine["motion"] != other["motion"]:
                changing += 1
                print(f"{words}: the other program changes its mind: {other}, {fine}; {row}")
                continue
            reason, other = apart(row, fine), fine
        if reason:
            wrong += 1
            print(f"FAILED: {words}: {reason}; {row}")
        elif other["motion"] == "irregular":
            irregular += 1
            print(f"{words}: no motion that repeats itself; {row}; {other}")
        elif figure == 8 and abs(other["velocity"]) > 5e-3:
            worst = max(worst, abs(float(row["velocity [m/s]"]) / other["velocity"] - 1))
    outcomes = {name: sum(r["outcome"] == name for r in rows) for name in ("I", "II", "III")}
    print(f"figure {figure}, seed {seed}: {len(points)} points, outcomes {outcomes}; "
          f"{flipping} flip, {changing} flip in the other program only, {irregular} irregular, "
          f"{wrong} differ" + (f"; velocities above 5 mm/s within {100 * worst:.2g} %"
                               if figure == 8 else ""), flush=True)
    return wrong


def notices(points, rows, others):
    """A comparison that cannot fail would be none."""
    twisted = [dict(other, velocity=other["velocity"] * 1.03 + 2e-4, outcome="none") for other in others]
    return all(apart(row, other) for row, other in zip(rows, twisted))


def same_crawler():
    """The two models differ in what drives them and how long, and in nothing else."""
    texts = []
    for name in ("crawler.yaml", "switch.yaml"):
        with open(os.path.join(models, name), encoding="utf-8") as file:
            texts.append(file.read().split("\ngroups:")[1])
    kept = [[line for line in text.splitlines() if not line.startswith(("  drive:", "run:", "output:"))]
            for text in texts]
    return kept[0] == kept[1] and len(kept[0]) > 40


def main():
    failures = 0
    if not same_crawler():
        sys.exit("FAILED: crawler.yaml and switch.yaml are not the same crawler")
    with tempfile.TemporaryDirectory() as work:
        shutil.copytree(models, os.path.join(work, "crawler"))
        for figure in (8, 10):
            generator = random.Random(f"{figure} {seed}")
            points = [draw(generator, figure) for _ in range(count)]
            rows = by_strut(figure, points, work)
            others = by_reference(figure, points, STEP)
            if len(rows) != count or not notices(points, rows, others):
                sys.exit("FAILED: the comparison does not notice what is wrong")
            failures += compare(figure, points, rows, others)
    sys.exit(1 if failures else 0)


main()

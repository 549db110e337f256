#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What --accuracy keeps and costs on the crawler at random operating points.

  tests/bench/accuracy.py STRUT [POINTS [SEED [REFERENCES]]]

Frequencies from 9.8 to 15 Hz, friction from 0.05 to 0.5, both starts. The reference is `adaptive` with
a tolerance of 2e-8, of points that miss confirmed by `rk4-events` at 8 us; both run 160 periods and
measure the last 10.
Errors are relative to the velocity, or to the scale that the summary names where that is larger. Cost
is forces per simulated second over those of rk4 at 0.1 ms; total counts what checking cost too. Points
that miss what is wanted are named. The file REFERENCES keeps the references, which take most of the
time, for another run.
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile

strut = sys.argv[1]
count = int(sys.argv[2]) if len(sys.argv) > 2 else 40
random.seed(int(sys.argv[3]) if len(sys.argv) > 3 else 20261121)
keep = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
model = pathlib.Path(__file__).parents[2] / "models/crawler/crawler.yaml"
points = [(round(random.uniform(9.8, 15), 4), round(random.uniform(0.05, 0.5), 4),
           random.choice(["I", "II"])) for _ in range(count)]


def run(file, point, *options):
    frequency, friction, start = point
    words = [strut, "run", str(file), "--json", "--set", f"frequency={frequency}",
             "--set", f"friction={friction}", "--set", f"start={start}", *options]
    return json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout)


def at(part, values):
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


with tempfile.TemporaryDirectory() as folder:
    long = pathlib.Path(folder) / "long.yaml"
    text = model.read_text(encoding="utf-8")
    long.write_text(text.replace("periods: 1100", "periods: 160").replace("{last: 100}", "{last: 10}")
                    .replace("output: {last: 10,", "output: {last: 1,"), encoding="utf-8")
    known = json.loads(keep.read_text(encoding="utf-8")) if keep and keep.exists() else {}

    def right_at(point, method, *options):
        """The reference by one of the two methods, from the file where it is there."""
        name = " ".join(map(str, point)) + " " + method
        if name not in known:
            known[name] = run(long, point, "--integrator", method, *options)["velocity"]
            if keep:
                keep.write_text(json.dumps(known, indent=1), encoding="utf-8")
        return known[name]

    reference = {p: right_at(p, "adaptive", "--step", "1 ms", "--tolerance", "2e-8") for p in points}
    print(f"{'wanted':>8} {'median':>9} {'90 %':>9} {'worst':>9} {'cost':>6} {'total':>9} "
          f"{'periods: mean':>13} {'median':>6} {'90 %':>5} {'worst':>5} {'kept':>6}")
    for wanted in ("1%", "0.5%", "0.1%", "0.04%"):
        errors, costs, totals, periods, kept = [], [], [], [], 0
        for point in points:
            found = run(model, point, "--accuracy", wanted)
            claim = found["accuracy"]
            right = reference[point]
            error = abs(found["velocity"] - right) / max(abs(right), claim["scale"])
            errors.append(100 * error)
            costs.append(found["force_evaluations"] / found["duration"] / 40000)
            totals.append(found["force_evaluations"] + claim["check_evaluations"])
            periods.append(found["duration"] * point[0])
            kept += error <= claim["wanted"]
            if error > claim["wanted"]:
                other = right_at(point, "rk4-events", "--step", "8 us")
                print(f"missed {wanted} at {point}: {found['velocity']:.7g}, adaptive {right:.7g}, "
                      f"rk4-events {other:.7g}, error {100 * error:.3g} %, reported "
                      f"{100 * claim['expected']:.3g} %")
        mean = lambda values: sum(values) / len(values)
        print(f"{wanted:>8} {at(0.5, errors):8.4f}% {at(0.9, errors):8.4f}% {max(errors):8.4f}% "
              f"{mean(costs):6.3f} {mean(totals):9.0f} "
              f"{mean(periods):13.1f} {at(0.5, periods):6.0f} {at(0.9, periods):5.0f} "
              f"{max(periods):5.0f} {kept:3d}/{count}", flush=True)

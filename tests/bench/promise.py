#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does `strut run --accuracy X` keep X? On random scenes of six classes.

  tests/bench/promise.py STRUT [SCENES [SEED [FOLDER [CLASS...]]]]

SCENES of each class (default 50): smooth, contact, friction, stiff (promise_scenes.py), and of wide_scenes.py five
times as many of every kind that the language has, wide, and six times as many robots with sensors, reflexes, stops and
running cables, robots; or of the classes named. Of robots X is 1 %, and the cost is compared with that of the cheapest
run with a step or tolerance of its own, of any method, whose error is truly that small. Else X is 1 %, 0.5 % or
0.1 %, at random; of wide ones 0.2 % instead of 0.1 %. The reference is `adaptive` with a tolerance of 1e-11; it counts where the same
with 1e-9 on another grid, or `rk4-events` with a small step, agrees to a twentieth of X; scenes where
none does, because the motion is chaotic over its time, are made again and counted as such; those of them
that a run vouches for are counted too. An error is
relative to the velocity or to the scale that the summary names, where that is larger. A run that ends
with "kept": false makes no promise; those are counted by themselves. Scenes that break a promise are
left in FOLDER. Exit code 1 where more than one in a hundred does, or more than one in ten promise
nothing.
"""
import json
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import promise_scenes

strut = sys.argv[1]
count = int(sys.argv[2]) if len(sys.argv) > 2 else 50
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 20261121
folder = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 and sys.argv[4] != "-" else None
classes = sys.argv[5:] or list(promise_scenes.CLASSES)
TIMES = {"wide": 5, "robots": 6}


def run(file, *options, limit=600):
    words = [strut, "run", str(file), "--json", *options]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return None, f"took more than {limit} s"
    if done.returncode:
        return None, done.stderr.strip()
    return json.loads(done.stdout), ""


def reference(file, grid, wanted, scale):
    """The velocity, or None where two ways do not agree."""
    one, why = run(file, "--integrator", "adaptive", "--step", repr(grid), "--tolerance", "1e-11")
    if not one:
        return None, why
    right = one["velocity"]
    enough = 0.05 * wanted * max(abs(right), scale)
    for options in (["adaptive", "--step", repr(grid / 3), "--tolerance", "1e-9"],
                    ["rk4-events", "--step", repr(min(grid, 0.2 * one["step_limit"] if one["step_limit"] else grid))]):
        two, why = run(file, "--integrator", *options)
        if two and abs(two["velocity"] - right) <= enough:
            return right, ""
    return None, why or f"{right} or {two['velocity']}"


def cheapest(file, grid, right, allowed):
    """The fewest force evaluations of a run whose velocity, and those of runs with finer steps, are that near."""
    least = None
    for method in ("rk4", "verlet", "euler", "verlet-events", "rk4-events"):
        for halvings in range(7, -6, -1):
            one, _ = run(file, "--integrator", method, "--step", repr(grid * 2.0 ** -halvings), limit=60)
            if not one or not abs(one["velocity"] - right) <= allowed:
                break
            least = min(least or one["force_evaluations"], one["force_evaluations"])
    for power in range(11, 2, -1):
        one, _ = run(file, "--integrator", "adaptive", "--step", repr(20 * grid), "--tolerance", f"1e-{power}")
        if not one or not abs(one["velocity"] - right) <= allowed:
            break
        least = min(least or one["force_evaluations"], one["force_evaluations"])
    return least


ratios = []


def one_scene(kind, number, work, totals):
    """One scene that has a reference: 'kept', 'broken' or 'none'."""
    for attempt in range(20):
        chance = random.Random(f"{seed} {kind} {number} {attempt}")
        scene, grid = promise_scenes.make(kind, chance)
        wanted = 0.01 if kind == "robots" else chance.choice([0.01, 0.005, 0.002 if kind == "wide" else 0.001])
        file = work / f"{kind}-{number}.yaml"
        file.write_text(json.dumps(scene, indent=1), encoding="utf-8")
        found, why = run(file, "--accuracy", repr(wanted))
        scale = found["accuracy"]["scale"] if found else 1e-300
        right, other = reference(file, grid, wanted, scale)
        if right is None:
            totals["chaotic"] += 1
            totals["vouched"] += bool(found and found["accuracy"]["kept"])
            continue
        if not found:
            return "none", file, f"{why} (right: {right})"
        error = abs(found["velocity"] - right) / max(abs(right), scale)
        reported = found["accuracy"]
        totals["forces"] += found["force_evaluations"] + reported["check_evaluations"]
        totals["midpoint"] += found["method"] == "midpoint"
        what = (f"wanted {wanted}, error {error:.2g}, expected {reported['expected']}, "
                f"v {found['velocity']:.6g} right {right:.6g} scale {scale:.2g}: {reported['why']}")
        if not reported["kept"]:
            return "none", file, what
        if kind == "robots":
            least = cheapest(file, grid, right, wanted * max(abs(right), scale))
            if least:
                ratios.append((found["force_evaluations"] + reported["check_evaluations"]) / least)
        return ("kept" if error <= wanted else "broken"), file, what
    return "none", file, "no scene with a reference"


COUNTED = ("kept", "broken", "none", "chaotic", "vouched", "forces", "midpoint")


def main():
    totals = dict.fromkeys(COUNTED, 0)
    with tempfile.TemporaryDirectory() as name:
        work = folder or pathlib.Path(name)
        work.mkdir(parents=True, exist_ok=True)
        print(f"{'class':>9} {'kept':>5} {'broken':>7} {'no promise':>11} {'no reference':>13} "
              f"{'of these kept':>14} {'by midpoint':>12} {'forces':>12}")
        for kind in classes:
            part = dict.fromkeys(COUNTED, 0)
            for number in range(TIMES.get(kind, 1) * count):
                result, file, what = one_scene(kind, number, work, part)
                part[result] += 1
                if result != "kept":
                    print(f"{file.stem}: {result}: {what}", file=sys.stderr, flush=True)
                elif folder:
                    file.unlink()
            print(f"{kind:>9} {part['kept']:5d} {part['broken']:7d} {part['none']:11d} "
                  f"{part['chaotic']:13d} {part['vouched']:14d} {part['midpoint']:12d} {part['forces']:12d}", flush=True)
            for key, value in part.items():
                totals[key] += value
    scenes = sum(TIMES.get(kind, 1) for kind in classes) * count
    if ratios:
        print(f"robots: {statistics.median(ratios):.2f} times the cheapest run that is as accurate, by the median")
    promised = totals["kept"] + totals["broken"]
    print(f"{totals['kept']} of {promised} promises kept; {totals['none']} of {scenes} scenes got none; "
          f"{totals['chaotic']} scenes without a reference were made again")
    return int(100 * totals["broken"] > scenes or 10 * totals["none"] > scenes)


sys.exit(main())

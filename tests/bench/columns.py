#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does `strut run --accuracy X` keep X for every column of the motion, however it is taken?

  tests/bench/columns.py STRUT [SCENES [SEED [FOLDER]]]

SCENES random scenes (default 20) of promise_scenes.py, with hinges, cells and collisions added to those that
have the nodes for them, each measured by twelve random columns or expressions of columns with a random
`take`. X is 2 to 0.2 %. A reference is `adaptive` with a tolerance of 1e-11 on a grid of its own; a value counts
where `rk4-events` with small steps, or `adaptive` with 1e-9 on a third grid, agrees to a twentieth of X.
Errors are relative to the value, or to its scale where that is larger. Scenes with a wrong answer are left in
FOLDER. Prints a table by column and by take. Exit code 1 where a value that a run says to keep is wrong.
"""
import collections
import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import promise_scenes

strut = sys.argv[1]
count = int(sys.argv[2]) if len(sys.argv) > 2 else 20
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 20261125
folder = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None

KINDS = ["smooth", "contact", "friction", "stiff", "wide", "wide", "wide"]
TAKES = ["mean", "min", "max", "range", "rms", "final", "change", "rate", "rise", "arrival", "max", "min"]
LIMIT = 120  # of one run [s]


def add_elements(scene, chance):
    """Hinges, cells and collisions between the nodes that there are; names of what was added."""
    nodes, members = list(scene["nodes"]), scene.get("members", {})
    joined = {frozenset(m["nodes"]) for m in members.values()}
    place = {n: p["position"] if isinstance(p, dict) else p for n, p in scene["nodes"].items()}
    if any(not isinstance(p, list) or any(not isinstance(x, (int, float)) for x in p) for p in place.values()):
        return
    if len(nodes) >= 3 and chance.random() < 0.4:
        a, b, c = chance.sample(nodes, 3)
        scene["hinges"] = {"joint": {"nodes": [a, b, c], "stiffness": 0.5, "damping": 0.01}}
    if len(nodes) >= 3 and chance.random() < 0.4:
        a, b, c = nodes[:3]
        (ax, ay), (bx, by), (cx, cy) = place[a], place[b], place[c]
        if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0:
            b, c = c, b
        scene["cells"] = {"air": {"nodes": [a, b, c], "pressure": 2.0}}
    bars = [m for m, d in members.items() if d.get("kind") != "cable"]
    if len(nodes) >= 4 and bars and chance.random() < 0.3:
        bar = chance.choice(bars)
        other = [n for n in nodes if n not in members[bar]["nodes"]]
        node = chance.choice(other)
        (ax, ay), (bx, by) = (place[n] for n in members[bar]["nodes"])
        px, py = place[node]
        along = max(0.0, min(1.0, ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) /
                             ((bx - ax) ** 2 + (by - ay) ** 2)))
        gap = ((px - ax - along * (bx - ax)) ** 2 + (py - ay - along * (by - ay)) ** 2) ** 0.5
        if gap > 1e-3 and frozenset((node,)) not in joined:
            scene["collisions"] = {"hit": {"node": node, "member": bar, "thickness": 0.9 * gap,
                                           "stiffness": 5e3, "damping": 1.0}}


def columns(scene):
    """Every column of the scene: its expression and its kind."""
    found = [("com." + c, "com." + c) for c in ("x", "y", "vx", "vy")]
    for n in scene["nodes"]:
        found += [(f"{n}.{c}", "NODE." + c) for c in ("x", "y", "vx", "vy")]
        if "ground" in scene:
            found += [(f"{n}.{c}", "NODE." + c) for c in ("height", "normal", "friction", "normal", "friction")]
    for m in scene.get("members", {}):
        found += [(f"{m}.{c}", "MEMBER." + c)
                  for c in ("length", "stretch", "rate", "force", "force", "angle")]
    nodes = list(scene["nodes"])
    found += [(f"angle({nodes[0]}, {nodes[-1]})", "angle(A, B)"), (f"distance({nodes[0]}, {nodes[-1]})", "distance(A, B)")]
    found += [("energy." + c, "energy." + c) for c in ("kinetic", "elastic", "gravity", "contact", "total")]
    found += [("work.drives", "work.drives"), ("losses.members", "losses"), ("losses.contact", "losses"),
              ("losses.friction", "losses"), ("losses.total", "losses"), ("largest_force", "largest_force")]
    if "hinges" in scene:
        found += [(f"joint.{c}", "HINGE." + c) for c in ("angle", "rate", "moment")]
    if "cells" in scene:
        found += [(f"air.{c}", "CELL." + c) for c in ("area", "pressure")]
    if "collisions" in scene:
        found += [(f"hit.{c}", "COLLISION." + c) for c in ("gap", "force", "force")]
    return found


def measure(scene, chance):
    """Twelve quantities: kinds and takes by their names."""
    known = {}
    all_columns = columns(scene)
    members = list(scene.get("members", {}))
    quantities = {}
    for i in range(12):
        expression, kind = chance.choice(all_columns)
        take = chance.choice(TAKES)
        if take == "arrival":
            take = "max"  # targets that are certainly reached are made in main
        if members and chance.random() < 0.15:
            other = chance.choice(members)
            expression, kind = chance.choice(
                [(f"abs({other}.force)", "abs(MEMBER.force)"), (f"{other}.force * {other}.rate", "FORCE * RATE"),
                 (f"hypot(com.vx, com.vy)", "hypot"), (f"max(energy.kinetic, energy.elastic)", "max(ENERGY)")])
        quantities[f"q{i}"] = {"of": expression, "take": take}
        known[f"q{i}"] = (kind, take)
    scene["run"].setdefault("measure", {})["quantities"] = quantities
    return known


def run(file, *options):
    words = [strut, "run", str(file), "--json", *options]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return None, "endless"
    try:
        return json.loads(done.stdout), done.stderr.strip()
    except json.JSONDecodeError:
        return None, done.stderr.strip()


def add_arrivals(scene, known, right, chance):
    """Some extremes become arrivals at a target that the reference passes."""
    for name, quantity in scene["run"]["measure"]["quantities"].items():
        found = right["measured"][name]
        if quantity["take"] != "max" or chance.random() > 0.3 or not found["value"]:
            continue
        low = found["value"] - 0.3 * found["scale"]
        quantity.update(take="arrival", target=f"{low} {found['unit']}" if found["unit"] != "1" else low)
        known[name] = (known[name][0], "arrival")


def references(file, grid):
    one, why = run(file, "--integrator", "adaptive", "--step", repr(grid), "--tolerance", "1e-11")
    if not one or one["status"] != "completed":
        return None, why
    limit = one["step_limit"] or grid
    others = [run(file, "--integrator", "adaptive", "--step", repr(0.37 * grid), "--tolerance", "1e-9")[0],
              run(file, "--integrator", "rk4-events", "--step", repr(0.2 * min(grid, limit)))[0]]
    return one, [o for o in others if o and o["status"] == "completed"]


def error_of(found, right):
    if found["value"] is None or right["value"] is None:
        return None if found["value"] is right["value"] else float("inf")
    size = max(abs(right["value"]), right["scale"] or 0.0, found["scale"] or 0.0)
    return abs(found["value"] - right["value"]) / size if size else 0.0


def main():
    totals, by_column, by_take = (collections.Counter(), collections.defaultdict(collections.Counter),
                                  collections.defaultdict(collections.Counter))
    with tempfile.TemporaryDirectory() as work:
        for number in range(count):
            chance = random.Random(f"{seed} {number}")
            scene, grid = promise_scenes.make(chance.choice(KINDS), chance)
            add_elements(scene, chance)
            known = measure(scene, chance)
            wanted = chance.choice([0.02, 0.01, 0.005, 0.002])
            file = pathlib.Path(work) / f"c{number}.yaml"
            file.write_text(json.dumps(scene, indent=1), encoding="utf-8")
            one, others = references(file, grid)
            if not one:
                totals["no reference"] += 1
                continue
            add_arrivals(scene, known, one, chance)
            file.write_text(json.dumps(scene, indent=1), encoding="utf-8")
            one, others = references(file, grid)
            found, why = run(file, "--accuracy", repr(wanted))
            if not found:
                totals["endless" if why == "endless" else "failed"] += 1
                print(f"c{number}: {why}", flush=True)
                continue
            totals["runs"] += 1
            totals["kept runs"] += found["accuracy"]["kept"]
            bad = False
            for name, (kind, take) in known.items():
                right, mine = one["measured"][name], found["measured"][name]
                agree = [e for e in (error_of(o["measured"][name], right) for o in others) if e is not None]
                both_none = right["value"] is None
                if both_none or not agree or min(agree) > 0.05 * wanted:
                    totals["values without reference"] += 1
                    continue
                error = error_of(mine, right)
                row, column = by_take[take], by_column[kind]
                for c in (totals, row, column):
                    c["values"] += 1
                    c["kept"] += bool(mine["kept"])
                if not mine["kept"] or mine["zero"]:
                    continue
                size = max(abs(right["value"]), right["scale"] or 0.0)
                reported = mine["expected"]
                for c in (totals, row, column):
                    c["wrong"] += error > wanted
                    c["reported too small"] += bool(reported is not None and error * size > reported and error > 1e-6)
                    c["by more than 3"] += bool(reported is not None and error * size > 3 * reported and error > 1e-6)
                if error > wanted:
                    bad = True
                    print(f"c{number} {name} {scene['run']['measure']['quantities'][name]}: {mine['value']:.9g}, "
                          f"right {right['value']:.9g}, wanted {wanted}, reported {reported}", flush=True)
            if bad and folder:
                folder.mkdir(parents=True, exist_ok=True)
                (folder / file.name).write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    for title, table in (("column", by_column), ("take", by_take), ("", {"all": totals})):
        print(f"\n{title:24} values   kept  wrong  reported too small  by more than 3")
        for name, row in sorted(table.items()):
            print(f"{name:24} {row['values']:6} {row['kept']:6} {row['wrong']:6} {row['reported too small']:10}"
                  f" {row['by more than 3']:10}")
    print({k: v for k, v in totals.items() if k not in ("values", "kept", "wrong", "reported too small")})
    return 1 if totals["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does the answer to a small tolerance depend on the grid? Where it does, a change of contact was missed.

  tests/bench/grids.py STRUT [SCENES [SEED [FOLDER [CLASS...]]]]

SCENES of each class (default 20): friction, contact, wide and robots of promise_scenes.py, or of the classes named.
Each is run on a grid by `adaptive8` and on another one by `adaptive`, with a tolerance of 1e-10, and once more with
gravity changed by 1e-11 of itself, or by 1e-10 m/s^2 where there is none; where the nodes end in the same places to
1e-7 of the structure's width, that is the right answer, else the scene is sensitive and tells nothing. Both methods
then run on a grid thirty times as coarse with tolerances of 1e-10 and 1e-12: where all is well, the smaller tolerance
is right to 1e-6. Scenes in which it is not are left in FOLDER. Exit code 1 where more than one in 500 is.
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import promise_scenes

LONGEST = 12  # periods of a run


def ends(strut, file, method, tolerance, step):
    """Where the nodes are at the end; None where the run does not come that far within a minute."""
    words = [strut, "run", str(file), "--json", "--integrator", method, "--tolerance", tolerance, "--step", repr(step)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode:
        return None
    return [x for node in json.loads(done.stdout)["nodes"].values() for x in node["position"]]


def heavier(scene, file):
    """The scene with another gravity, beside its file."""
    other = file.with_suffix(".heavier.yaml")
    gravity = scene.get("gravity", [0, 0])
    changed = {**scene, "gravity": [gravity[0], gravity[1] * (1 + 1e-11) - (1e-10 if gravity[1] == 0 else 0)]}
    other.write_text(json.dumps(changed), encoding="utf-8")
    return other


def width(scene):
    """The larger side of the box around the nodes."""
    places = [n["position"] if isinstance(n, dict) else n for n in scene["nodes"].values()]
    sides = [max(p[k] for p in places) - min(p[k] for p in places) for k in (0, 1)]
    return max(*sides, 1e-2)


def apart(one, other, size):
    return max(abs(a - b) for a, b in zip(one, other)) / size


def verdict(strut, file, scene, grid):
    """'same', 'sensitive', 'slow' or 'different', and what was seen."""
    right = ends(strut, file, "adaptive8", "1e-10", grid / 3)
    beside = heavier(scene, file)
    others = [ends(strut, file, "adaptive", "1e-10", grid / 5), ends(strut, beside, "adaptive8", "1e-10", grid / 3)]
    beside.unlink()
    if right is None or None in others:
        return "slow", ""
    size = width(scene)
    if any(apart(right, other, size) > 1e-7 for other in others):
        return "sensitive", ""
    for method in ("adaptive8", "adaptive"):
        seen = []
        for tolerance in ("1e-10", "1e-12"):
            found = ends(strut, file, method, tolerance, 10 * grid)
            seen.append(apart(found, right, size) if found else float("inf"))
        if seen[1] > 1e-6:
            return "different", f"{method}: {seen[0]:.1e} with 1e-10, {seen[1]:.1e} with 1e-12; grid {grid!r}"
    return "same", ""


def main():
    words = dict(enumerate(sys.argv[1:]))
    strut, count, seed = words[0], int(words.get(1, 20)), words.get(2, "20261129")
    classes = sys.argv[5:] or ["friction", "contact", "wide", "robots"]
    totals = dict.fromkeys(("same", "sensitive", "slow", "different"), 0)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(words.get(3, name))
        folder.mkdir(parents=True, exist_ok=True)
        for kind in classes:
            for number in range(count):
                scene, grid = promise_scenes.make(kind, random.Random(f"{seed} {kind} {number}"))
                if "periods" in scene["run"]:
                    scene["run"] = {"periods": min(LONGEST, scene["run"]["periods"]), "of": scene["run"]["of"]}
                file = folder / f"{kind}-{number}.yaml"
                file.write_text(json.dumps(scene, indent=1), encoding="utf-8")
                result, what = verdict(strut, file, scene, grid)
                totals[result] += 1
                if result == "different":
                    print(f"{file.stem}: {what}", flush=True)
                else:
                    file.unlink()
    print(f"{totals['different']} of {sum(totals.values())} scenes depend on the grid; {totals['sensitive']} are "
          f"sensitive, {totals['slow']} took too long")
    return int(500 * totals["different"] > sum(totals.values()))


sys.exit(main())

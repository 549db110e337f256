# SPDX-License-Identifier: GPL-3.0-or-later
"""strut modes and strut rigidity count the same: motions without stiffness of random structures at rest.

Drawn without prestress, bars resist both ways. Cables are just taut and resist nothing to first order, so that
the motions left are those that rigidity finds without them."""
import random

from testing import answer, check, finish, write

STRUCTURES = 60


def draw(seed):
    """Nodes, some at random and some on a grid, and members as (kind, nodes, stiffness)."""
    draws = random.Random(seed)
    count, grid = draws.randint(4, 9), seed % 3 == 0
    place = (lambda: draws.randint(0, 3) * 0.37) if grid else (lambda: draws.uniform(0, 2))
    places = list({(place(), place()) for _ in range(count)})
    pairs = [(i, j) for i in range(len(places)) for j in range(i)]
    draws.shuffle(pairs)
    members = [(draws.choice(("bar", "cable")), pair, 10 ** draws.uniform(1, 6))
               for pair in pairs[:draws.randint(len(places) - 1, 2 * len(places))]]
    return places, draws.sample(range(len(places)), draws.randint(0, min(3, len(places) - 1))), members


def write_scene(structure, kinds):
    """With members of these kinds only; `kinds` says as what each is written."""
    places, fixed, members = structure
    lines = ["strut: 1", "nodes:"]
    for i, (x, y) in enumerate(places):
        lines.append(f"  n{i}: {{position: [{x!r}, {y!r}], mass: 1{', fixed: both' * (i in fixed)}}}")
    lines.append("members:")
    for k, (kind, (i, j), stiffness) in enumerate(members):
        if kind in kinds:
            lines.append(f"  m{k}: {{kind: {kinds[kind]}, nodes: [n{i}, n{j}], stiffness: {stiffness!r}}}")
    write("scene.yaml", "\n".join(lines) + "\n")


for seed in range(STRUCTURES):
    structure = draw(seed)
    if not any(kind == "bar" for kind, _, _ in structure[2]):
        continue
    for modes_of, rigidity_of in (({"bar": "bar", "cable": "bar"}, {"bar": "bar", "cable": "bar"}),
                                  ({"bar": "bar", "cable": "cable"}, {"bar": "bar"})):
        write_scene(structure, modes_of)
        modes = answer("modes", "scene.yaml").get("modes", [])
        free = sum(mode["eigenvalue"] == 0 for mode in modes)
        write_scene(structure, rigidity_of)
        expected = answer("rigidity", "scene.yaml").get("mechanisms", {}).get("count")
        check(free == expected, f"structure {seed}, {modes_of}: {free} modes, {expected} mechanisms")
        least = min((mode["frequency"] for mode in modes if mode["eigenvalue"] > 0), default=1)
        check(least > 1e-4, f"structure {seed}, {modes_of}: a mode at {least} Hz")

finish()

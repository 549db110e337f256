# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of strut equilibria, rigidity and form against what the same commands print as JSON."""
import json
import math
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree as tree

from svg_paths import has_segment, near, read, segments

from testing import check, finish, run, work, write

EDGE, WHITE, BLUE = (0.1, 0.1, 0.1), (1, 1, 1), (0, 0x60 / 255, 0xA8 / 255)


def circles(paths):
    """Centres of the nodes, in the order in which they are drawn."""
    found = []
    for path in paths:
        if path.curved and near(path.stroke, EDGE) and near(path.fill, WHITE):
            for line in path.lines:
                found.append(tuple((min(p[d] for p in line) + max(p[d] for p in line)) / 2 for d in (0, 1)))
    return found


def scale_of(places, drawn):
    """Points to a metre, from the pair of nodes farthest from each other."""
    pairs = [(math.dist(places[i], places[k]), i, k) for i in range(len(places)) for k in range(i)]
    apart, i, k = max(pairs)
    return math.dist(drawn[i], drawn[k]) / apart


def check_shape(what, places, drawn):
    """Whether the nodes are drawn where they are, to one scale, upright. Returns the scale."""
    scale = scale_of(places, drawn)
    left = drawn[0][0] - scale * places[0][0]
    top = drawn[0][1] + scale * places[0][1]
    worst = max(math.dist((left + scale * x, top - scale * y), at) for (x, y), at in zip(places, drawn))
    check(worst < 0.05, f"{what}: a node is {worst} pt from its place")
    return scale


def members_of(model):
    text = run("export", model).stdout
    nodes = text[text.index("\nnodes:"):text.index("\nmembers:")]
    block = text[text.index("\nmembers:"):]
    found = re.findall(r"^  (\w+): \{nodes: \[(\w+), (\w+)\], kind: (\w+)", block, re.M)
    names = re.findall(r"^  (\w+):", nodes, re.M)
    check(found and names, f"{model}: cannot be read")
    return [(name, kind, names.index(a), names.index(b)) for name, a, b, kind in found], names


def check_members(what, members, drawn, paths, forces=None):
    """A line for each member, bars thicker than springs and these than cables, slack ones dashed."""
    lines = segments(paths)
    widths = {}
    for name, kind, a, b in members:
        path = has_segment(lines, drawn[a], drawn[b], 0.03)
        check(path, f"{what}: no line for {name}")
        if path:
            slack = kind == "cable" and forces is not None and not forces[name] > 0
            check(bool(path.dash) == slack, f"{what}: {name} {'is not' if slack else 'is'} dashed")
            widths.setdefault(kind, path.width)
    for thick, thin in (("bar", "spring"), ("spring", "cable"), ("bar", "cable")):
        if thick in widths and thin in widths:
            check(widths[thick] > 1.2 * widths[thin], f"{what}: widths are {widths}")


root = os.getcwd()
os.chdir(work)
crawler = os.path.join(root, "models/crawler/crawler.yaml")

# Equilibria: those that stand, by energy, each to the same scale where it rests on the ground.
found = json.loads(run("equilibria", crawler, "--json", "--plot", "e.svg").stdout)["equilibria"]
standing = [e for e in found if e["outcome"] == "stands"]
standing.sort(key=lambda e: e["energy"])
members, names = members_of(crawler)
_, _, paths = read("e.svg")
centres = circles(paths)
check(len(centres) == 5 * len(standing), f"{len(centres)} nodes for {len(standing)} that stand")
scales = []
remaining = list(standing)
for k in range(len(centres) // 5):
    drawn = centres[5 * k:5 * k + 5]
    fits = [e for e in remaining if abs(e["energy"] - remaining[0]["energy"]) < 1e-6]
    # Mirror images have one energy: the card is one of them.
    best = min(fits, key=lambda e: sum(
        math.dist((d[0] - drawn[0][0], drawn[0][1] - d[1]),
                  tuple(scale_of(list(e["rest"]["nodes"].values()), drawn) * (p - q)
                        for p, q in zip(place, e["rest"]["nodes"]["n1"])))
        for d, place in zip(drawn, e["rest"]["nodes"].values())))
    remaining.remove(best)
    scales.append(check_shape(f"card {best['name']}", list(best["rest"]["nodes"].values()), drawn))
    check_members(f"card {best['name']}", members, drawn, paths)
check(scales and max(scales) < 1.0001 * min(scales), f"cards have several scales: {scales}")
first = open("e.svg", "rb").read()
run("equilibria", crawler, "--plot", "e.svg")
check(open("e.svg", "rb").read() == first, "equilibria: other bytes the second time")

# Rigidity: the drawn shape with its forces and states; mechanisms as displaced shapes.
model = os.path.join(root, "models/gallery/hexagon-three-bars.yaml")
said = json.loads(run("rigidity", model, "--json", "--plot", "r.svg").stdout)
members, names = members_of(model)
_, _, paths = read("r.svg")
centres = circles(paths)
states = len(said["self_stress"]["states"])
check(len(centres) == len(names) * (1 + states), f"rigidity: {len(centres)} nodes")
places = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
for k in range(len(centres) // len(names)):
    check_shape(f"rigidity panel {k}", places, centres[6 * k:6 * k + 6])
    check_members(f"rigidity panel {k}", members, centres[6 * k:6 * k + 6], paths)
moved = [path for path in paths if near(path.stroke, BLUE) and not path.curved]
check(sum(len(path.lines) for path in moved) == len(members) * said["mechanisms"]["count"],
      "rigidity: a mechanism's members are missing")

# Form: where the new model starts, over what was drawn.
arm = os.path.join(root, "models/gallery/arm.yaml")
said = json.loads(run("form", arm, "--json", "--plot", "f.svg").stdout)
members, names = members_of(arm)
_, _, paths = read("f.svg")
centres = circles(paths)
check(len(centres) == len(names), f"form: {len(centres)} nodes of {len(names)}")
check_shape("form", list(said["nodes"].values()), centres)
check_members("form", members, centres, paths, said["forces"])

# More states and mechanisms than there is room for: the rest is counted.
run("rigidity", os.path.join(root, "models/parts/michell-wheel.yaml"), "--plot", "m.svg", "--width", "column")
run("rigidity", os.path.join(root, "models/parts/michell-wheel.yaml"), "--plot", "m.svg")

# Names of other scripts and a title that looks like markup: nothing of it becomes part of the file.
SCRIPTS = ["ש" * 31, "م" * 31, "n" * 60, "結構"]
TITLE = '</text><script>x</script> & "quoted" <b>bold</b>'
with open("names.yaml", "w", encoding="utf-8") as file:
    nodes = "".join(f"  {name}: {{position: [{x}, {y}], mass: 1}}\n" for name, x, y in
                    zip(SCRIPTS, (-1, 1, 0, 0), (0, 0, 1, -1)))
    sides = "".join(f"  c{k}: {{kind: cable, nodes: [{SCRIPTS[k % 2]}, {SCRIPTS[2 + k // 2]}], "
                    "stiffness: 100, rest_length: 1.3}\n" for k in range(4))
    bars = "".join(f"  b{k}: {{kind: bar, nodes: [{SCRIPTS[2 * k]}, {SCRIPTS[2 * k + 1]}], "
                   "stiffness: 1000}\n" for k in range(2))
    file.write(f"strut: 1\nname: '{TITLE}'\nnodes:\n{nodes}members:\n{bars}{sides}")
for command in ("equilibria", "rigidity", "form"):
    for width in ("page", "column", "40 mm"):
        run(command, "names.yaml", "--plot", "names.svg", "--width", width)
        _, _, paths = read("names.svg")
        check(len(circles(paths)) >= 4, f"{command} of {width}: nodes are missing")
        elements = {e.tag.split("}")[-1] for e in tree.parse("names.svg").iter()}
        check(not elements & {"script", "b", "text", "a", "image"}, f"{command}: has {elements}")
run("rigidity", "names.yaml", "--plot", "names.pdf")
if shutil.which("pdftotext"):
    text = subprocess.run(["pdftotext", "names.pdf", "-"], capture_output=True, text=True).stdout
    check(TITLE[:20] in text and "nnnnn" in text, f"the PDF of other scripts says {text}")

# Other files, and what is refused.
run("rigidity", model, "--plot", "r.png", "--width", "column")
with open("r.png", "rb") as file:
    head = file.read(24)
check(head[1:4] == b"PNG" and int.from_bytes(head[16:20], "big") == round(88 / 25.4 * 300),
      "a column is not 88 mm wide at 300 dots to the inch")
run("rigidity", model, "--plot", "r.pdf", "--width", "120 mm")
if shutil.which("pdftotext"):
    text = subprocess.run(["pdftotext", "-layout", "r.pdf", "-"], capture_output=True, text=True).stdout
    check(all(f"n{k}" in text for k in range(1, 7)) and "self-stress" in text, f"the PDF says {text}")
run("rigidity", model, "--plot", "r.jpeg", code=1, err=".svg, .pdf or .png")
run("rigidity", model, "--width", "column", code=1, err="--width needs --plot FILE")
run("equilibria", crawler, "--plot", "x.svg", "--width", "3 s", code=1, err="expects a length")
run("form", arm, "--plot", "x.svg", "--width", "5 m", code=1, err="between 40 mm and 1 m")
run("form", arm, "--plot", "nowhere/x.svg", code=4, err="nowhere")
check(not os.path.exists("x.svg"), "a refusal left a picture")
finish()

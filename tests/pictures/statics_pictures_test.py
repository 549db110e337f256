# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of strut equilibria, rigidity and form against what the same commands print as JSON."""
import math
import os
import shutil
import subprocess
import xml.etree.ElementTree as tree

import testing
from svg_paths import Window, circles, has_segment, near, read, segments
from testing import answer, check, exported, finish, models, run, work, write

EDGE, BLUE = (0.1, 0.1, 0.1), (0, 0x60 / 255, 0xA8 / 255)
os.chdir(work)


def check_shape(what, places, drawn):
    """Whether the nodes are drawn where they are, to one scale, upright. Returns the scale."""
    window = Window(places, drawn)
    check(window.worst < 0.05, f"{what}: a node is {window.worst} pt from its place")
    return window.scale


def members_of(model):
    """(name, kind, indices of both nodes) of each, and how many nodes there are."""
    scene = exported(model)
    names = list(scene["nodes"])
    return [(name, member["kind"], *map(names.index, member["nodes"]))
            for name, member in scene["members"].items()], len(names)


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


crawler = f"{models}/crawler/crawler.yaml"

# Equilibria: those that stand, by energy, each to the same scale where it rests on the ground.
found = answer("equilibria", crawler, "--plot", "e.svg")["equilibria"]
remaining = sorted((e for e in found if e["outcome"] == "stands"), key=lambda e: e["energy"])
members, _ = members_of(crawler)
paths = read("e.svg")[2]
centres = circles(paths, EDGE)
check(len(centres) == 5 * len(remaining), f"{len(centres)} nodes for {len(remaining)} that stand")
scales = []
for k in range(len(centres) // 5):
    drawn = centres[5 * k:5 * k + 5]
    # Mirror images have one energy: the card is one of them.
    fits = [e for e in remaining if abs(e["energy"] - remaining[0]["energy"]) < 1e-6]
    best = min(fits, key=lambda e: Window(list(e["rest"]["nodes"].values()), drawn).worst)
    remaining.remove(best)
    scales.append(check_shape(f"card {best['name']}", list(best["rest"]["nodes"].values()), drawn))
    check_members(f"card {best['name']}", members, drawn, paths)
check(scales and max(scales) < 1.0001 * min(scales), f"cards have several scales: {scales}")
first = testing.read("e.svg")
run("equilibria", crawler, "--plot", "e.svg")
check(testing.read("e.svg") == first, "equilibria: other bytes the second time")

# Rigidity: the drawn shape with its forces and states; mechanisms as displaced shapes.
model = f"{models}/gallery/hexagon-three-bars.yaml"
said = answer("rigidity", model, "--plot", "r.svg")
members, count = members_of(model)
paths = read("r.svg")[2]
centres = circles(paths, EDGE)
check(len(centres) == count * (1 + len(said["self_stress"]["states"])), f"rigidity: {len(centres)} nodes")
places = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
for k in range(len(centres) // count):
    check_shape(f"rigidity panel {k}", places, centres[6 * k:6 * k + 6])
    check_members(f"rigidity panel {k}", members, centres[6 * k:6 * k + 6], paths)
moved = [path for path in paths if near(path.stroke, BLUE) and not path.curved]
check(sum(len(path.lines) for path in moved) == len(members) * said["mechanisms"]["count"],
      "rigidity: a mechanism's members are missing")

# Form: where the new model starts, over what was drawn.
arm = f"{models}/gallery/arm.yaml"
said = answer("form", arm, "--plot", "f.svg")
members, count = members_of(arm)
paths = read("f.svg")[2]
centres = circles(paths, EDGE)
check(len(centres) == count, f"form: {len(centres)} nodes of {count}")
check_shape("form", list(said["nodes"].values()), centres)
check_members("form", members, centres, paths, said["forces"])

# More states and mechanisms than there is room for: the rest is counted.
run("rigidity", f"{models}/parts/michell-wheel.yaml", "--plot", "m.svg", "--width", "column")
run("rigidity", f"{models}/parts/michell-wheel.yaml", "--plot", "m.svg")

# Names of other scripts and a title that looks like markup: nothing of it becomes part of the file.
SCRIPTS = ["ש" * 31, "م" * 31, "n" * 60, "結構"]
TITLE = '</text><script>x</script> & "quoted" <b>bold</b>'
nodes = "".join(f"  {name}: {{position: [{x}, {y}], mass: 1}}\n"
                for name, x, y in zip(SCRIPTS, (-1, 1, 0, 0), (0, 0, 1, -1)))
sides = "".join(f"  c{k}: {{kind: cable, nodes: [{SCRIPTS[k % 2]}, {SCRIPTS[2 + k // 2]}], stiffness: 100, "
                "rest_length: 1.3}\n" for k in range(4))
bars = "".join(f"  b{k}: {{kind: bar, nodes: [{SCRIPTS[2 * k]}, {SCRIPTS[2 * k + 1]}], stiffness: 1000}}\n"
               for k in range(2))
write("names.yaml", f"strut: 1\nname: '{TITLE}'\nnodes:\n{nodes}members:\n{bars}{sides}")
for command in ("equilibria", "rigidity", "form"):
    for width in ("page", "column", "40 mm"):
        run(command, "names.yaml", "--plot", "names.svg", "--width", width)
        check(len(circles(read("names.svg")[2], EDGE)) >= 4, f"{command} of {width}: nodes are missing")
        elements = {e.tag.split("}")[-1] for e in tree.parse("names.svg").iter()}
        check(not elements & {"script", "b", "text", "a", "image"}, f"{command}: has {elements}")


def check_pdf(*words, texts):
    run("rigidity", *words, "--plot", "r.pdf")
    if shutil.which("pdftotext"):
        said = subprocess.run(["pdftotext", "-layout", "r.pdf", "-"], capture_output=True, text=True, check=True).stdout
        check(all(text in said for text in texts), f"the PDF of {words} says {said}")


check_pdf("names.yaml", texts=[TITLE[:20], "nnnnn"])
check_pdf(model, "--width", "120 mm", texts=["self-stress", *(f"n{k}" for k in range(1, 7))])

# Other files, and what is refused.
run("rigidity", model, "--plot", "r.png", "--width", "column")
head = testing.read("r.png")[:24]
check(head[1:4] == b"PNG" and int.from_bytes(head[16:20], "big") == round(88 / 25.4 * 300),
      "a column is not 88 mm wide at 300 dots to the inch")
run("rigidity", model, "--plot", "r.jpeg", code=1, err=".svg, .pdf or .png")
run("rigidity", model, "--width", "column", code=1, err="--width needs --plot FILE")
run("equilibria", crawler, "--plot", "x.svg", "--width", "3 s", code=1, err="expects a length")
run("form", arm, "--plot", "x.svg", "--width", "5 m", code=1, err="between 40 mm and 1 m")
run("form", arm, "--plot", "nowhere/x.svg", code=4, err="nowhere")
check(not os.path.exists("x.svg"), "a refusal left a picture")
finish()

# SPDX-License-Identifier: GPL-3.0-or-later
"""strut modes --plot: what is drawn is where `strut modes --json` says that the nodes go."""
import json
import math
import os
import re
import subprocess

from svg_paths import has_segment, near, read, segments

from testing import fail, finish, strut, work

SWING = 0.08  # of the structure's larger extent
UNSTRAINED = 1e-9  # rounding
REST, ARROW = (0.8, 0.8, 0.8), (0, 0x9E / 255, 0x73 / 255)


def members_of(model):
    """Name to the names of both nodes, of the gallery's simple names."""
    text = subprocess.run([strut, "export", model], capture_output=True, text=True).stdout
    found = re.findall(r"^  (\w+): \{nodes: \[(\w+), (\w+)\]", text, re.M)
    return {name: (a, b) for name, a, b in found}


def strains(nodes, members, moved):
    """Of each member, to first order."""
    result = {}
    for name, (a, b) in members.items():
        along = [nodes[b][d] - nodes[a][d] for d in (0, 1)]
        change = [moved[b][d] - nodes[b][d] - moved[a][d] + nodes[a][d] for d in (0, 1)]
        result[name] = sum(u * v for u, v in zip(along, change)) / sum(u * u for u in along)
    return result


def panels_of(paths):
    """The paths from one shape at rest to the next."""
    panels, before = [], False
    for path in paths:
        at_rest = near(path.stroke, REST) and not path.curved
        if at_rest and not before:
            panels.append([])
        before = at_rest
        if panels:
            panels[-1].append(path)
    return panels[:-1]  # the last one is the key's


def check_panel(what, panel, nodes, members, shape):
    found = segments(panel)
    rest = [s for s in found if near(s[2].stroke, REST)]
    ends = [p for s in rest for p in s[:2]]
    left, right = min(p[0] for p in ends), max(p[0] for p in ends)
    top, bottom = min(p[1] for p in ends), max(p[1] for p in ends)
    low = [min(p[d] for p in nodes.values()) for d in (0, 1)]
    high = [max(p[d] for p in nodes.values()) for d in (0, 1)]
    size = max(high[0] - low[0], high[1] - low[1])
    scale = max(right - left, bottom - top) / size
    place = lambda p: (left + scale * (p[0] - low[0]), bottom - scale * (p[1] - low[1]))
    if abs((right - left) - scale * (high[0] - low[0])) > 0.02:
        fail(f"{what}: x and y have different scales")
    most = max(math.hypot(*s) for s in shape.values())
    moved = {n: [nodes[n][d] + SWING * size / most * shape[n][d] for d in (0, 1)] for n in nodes}
    strain = strains(nodes, members, moved)
    largest = max(map(abs, strain.values()))
    coloured = [s for s in found if not s[2].dash and not near(s[2].stroke, REST)
                and not near(s[2].stroke, (0.1, 0.1, 0.1))]
    shades = []
    for name, (a, b) in members.items():
        if not has_segment(rest, place(nodes[a]), place(nodes[b])):
            fail(f"{what}: {name} at rest is not drawn where it is")
        bent = has_segment(coloured, place(moved[a]), place(moved[b]))
        if not bent:
            fail(f"{what}: {name} is not drawn where it is displaced")
        else:
            shades.append((strain[name] / largest, sum(bent.stroke)))
    for name, at in nodes.items():  # an arrow from the place at rest towards the displaced one
        start, end = place(at), place(moved[name])
        if math.dist(start, end) > 12 and not any(
                near(s[2].stroke, ARROW) and math.dist(s[0], start) < 0.02 for s in found):
            fail(f"{what}: no arrow starts at {name}")
    if largest < UNSTRAINED and len({bright for _, bright in shades}) > 1:
        fail(f"{what}: nothing stretches, but colours differ")
    for (one, bright_one) in shades if largest > UNSTRAINED else []:  # more stretch is brighter
        for (two, bright_two) in shades:
            if one > two + 0.1 and bright_one <= bright_two:
                fail(f"{what}: a strain of {one:.2f} is no brighter than one of {two:.2f}")
    return scale


def check(model, arguments, expected):
    file = os.path.join(work, "a.svg")
    command = [strut, "modes", model, *arguments, "--json", "--plot", file]
    run = subprocess.run(command, capture_output=True)
    if run.returncode != 0:
        return fail(f"{command}: {run.stderr}")
    first = open(file, "rb").read()
    subprocess.run(command, capture_output=True)
    if open(file, "rb").read() != first:
        fail(f"{model}: drawn again it has other bytes")
    width, height, paths = read(file)
    answer = json.loads(run.stdout)
    panels = panels_of(paths)
    modes = [m for m in answer["modes"] if m["kind"] != "rigid-body"] or answer["modes"]
    if len(panels) != expected:
        return fail(f"{model} {arguments}: {len(panels)} panels of {expected}")
    members = members_of(model)
    scales = [check_panel(f"{model} {arguments} panel {i + 1}", panel, answer["nodes"], members,
                          modes[i]["shape"]) for i, panel in enumerate(panels)]
    if max(scales) - min(scales) > 1e-3 * max(scales):
        fail(f"{model}: panels have different scales: {scales}")
    for path in paths:
        for x, y in (p for line in path.lines for p in line):
            ground = near(path.stroke, (0.3, 0.3, 0.3)) or path.stroke is None or \
                near(path.stroke, (0.72, 0.72, 0.72))
            if not ground and not (-0.5 <= x <= width + 0.5 and -0.5 <= y <= height + 0.5):
                return fail(f"{model} {arguments}: ({x}, {y}) is beyond the page")


check("models/gallery/x-frame.yaml", [], 5)
check("models/gallery/x-frame.yaml", ["--width", "column", "--count", "2"], 2)
check("models/crawler/crawler.yaml", [], 6)
check("models/crawler/crawler.yaml", ["--at", "II", "--count", "11"], 9)
check("models/gallery/t-bar.yaml", [], 5)
check("models/gallery/t-bar.yaml", ["--count", "3"], 3)  # nothing but rigid motions: they are drawn
check("models/gallery/arm.yaml", ["--count", "3"], 3)
check("models/gallery/double-pendulum.yaml", [], 4)

for bad, code in (("x.gif", 1), ("nowhere/x.svg", 4)):
    run = subprocess.run([strut, "modes", "models/gallery/x-frame.yaml", "--plot", bad], capture_output=True)
    if run.returncode != code or run.stdout or not run.stderr:
        fail(f"--plot {bad}: exit code {run.returncode}, {run.stdout}, {run.stderr}")
finish()

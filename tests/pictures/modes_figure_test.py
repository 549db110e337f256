# SPDX-License-Identifier: GPL-3.0-or-later
"""strut modes --plot: what is drawn is where `strut modes --json` says that the nodes go."""
import math
import os

import testing
from svg_paths import has_segment, near, read, segments
from testing import check, exported, fail, finish, models, run, work

SWING = 0.08  # of the structure's larger extent
UNSTRAINED = 1e-9  # rounding
REST, ARROW = (0.8, 0.8, 0.8), (0, 0x9E / 255, 0x73 / 255)
os.chdir(work)


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


def check_figure(model, *words, expected):
    what = f"{model} {words}"
    answer = testing.answer("modes", f"{models}/{model}.yaml", *words, "--plot", "a.svg")
    first = testing.read("a.svg")
    run("modes", f"{models}/{model}.yaml", *words, "--plot", "a.svg")
    check(testing.read("a.svg") == first, f"{what}: drawn again it has other bytes")
    width, height, paths = read("a.svg")
    panels = panels_of(paths)
    modes = [m for m in answer["modes"] if m["kind"] != "rigid-body"] or answer["modes"]
    if len(panels) != expected:
        return fail(f"{what}: {len(panels)} panels of {expected}")
    members = {name: member["nodes"] for name, member in exported(f"{models}/{model}.yaml")["members"].items()}
    scales = [check_panel(f"{what} panel {i + 1}", panel, answer["nodes"], members, modes[i]["shape"])
              for i, panel in enumerate(panels)]
    check(max(scales) - min(scales) <= 1e-3 * max(scales), f"{what}: panels have different scales: {scales}")
    grounds = ((0.3, 0.3, 0.3), (0.72, 0.72, 0.72))
    outside = [(x, y) for path in paths if path.stroke and not any(near(path.stroke, ground) for ground in grounds)
               for line in path.lines for x, y in line
               if not (-0.5 <= x <= width + 0.5 and -0.5 <= y <= height + 0.5)]
    check(not outside, f"{what}: {outside[:2]} are beyond the page")


check_figure("gallery/x-frame", expected=5)
check_figure("gallery/x-frame", "--width", "column", "--count", "2", expected=2)
check_figure("crawler/crawler", expected=6)
check_figure("crawler/crawler", "--at", "II", "--count", "11", expected=9)
check_figure("gallery/t-bar", expected=5)
check_figure("gallery/t-bar", "--count", "3", expected=3)  # nothing but rigid motions: they are drawn
check_figure("gallery/arm", "--count", "3", expected=3)
check_figure("gallery/double-pendulum", expected=4)

for bad, code in (("x.gif", 1), ("nowhere/x.svg", 4)):
    done = run("modes", f"{models}/gallery/x-frame.yaml", "--plot", bad, code=code)
    check(done.stderr and not done.stdout, f"--plot {bad}: {done.stdout}, {done.stderr}")
finish()

# SPDX-License-Identifier: GPL-3.0-or-later
"""strut path --plot: the curve is that of path.csv, the shapes are those of path.json."""
import csv
import json
import math
import os
import re
import subprocess

from svg_paths import distance, has_segment, near, read, segments

from testing import fail, finish, strut, work

CURVE, CURVE_WIDTH = (0.15, 0.15, 0.15), 1.2


def members_of(model):
    text = subprocess.run([strut, "export", model], capture_output=True, text=True).stdout
    return [(a, b) for a, b in re.findall(r"^  \w+: \{nodes: \[(\w+), (\w+)\]", text, re.M)]


def centres(paths, page):
    """Where the dots are, with their fill."""
    return [((min(p[0] for p in line) + max(p[0] for p in line)) / 2,
             (min(p[1] for p in line) + max(p[1] for p in line)) / 2, path.fill)
            for path in paths if path.curved and path.fill and not near(path.fill, (1, 1, 1))
            for line in path.lines if max(p[0] for p in line) - min(p[0] for p in line) < 6]


def check_curve(what, paths, rows, column, sign, height="factor", upright=False):
    """Where the rows of path.csv are on the page. Cairo drops points on straight lines.

    The motion of `column` runs to the right and `height` up, or the other way round.
    """
    unstable = [int(r["negative_eigenvalues"] or 0) > 0 for r in rows]
    pieces = [(line, bool(path.dash)) for path in paths for line in path.lines
              if near(path.stroke, CURVE) and abs(path.width - CURVE_WIDTH) < 1e-6
              and not path.curved]
    if any(unstable):
        pieces.pop()  # the sample in the key
    motion = [sign * (float(r[column]) - float(rows[0][column])) for r in rows]
    over = [float(r[height]) for r in rows]
    values = [over, [-v for v in motion]] if upright else [motion, [-v for v in over]]
    low = [min(v) for v in values]
    corner = [min(p[d] for line, _ in pieces for p in line) for d in (0, 1)]
    scale = [(max(p[d] for line, _ in pieces for p in line) - corner[d]) / (max(values[d]) - low[d]) for d in (0, 1)]
    drawn = [tuple(corner[d] + scale[d] * (values[d][k] - low[d]) for d in (0, 1)) for k in range(len(rows))]
    for k in range(len(rows) - 1):
        middle = [(drawn[k][d] + drawn[k + 1][d]) / 2 for d in (0, 1)]
        # An event's edge is as stable as the point at its other end.
        wanted = unstable[k] if not rows[k]["event"] else unstable[k + 1]
        if rows[k]["event"] and rows[k + 1]["event"]:
            wanted = next(u for r, u in zip(rows[k:], unstable[k:]) if not r["event"])
        if min(distance(middle, line) for line, dashed in pieces if dashed == wanted) > 0.02:
            fail(f"{what}: the curve does not lead from row {k} of path.csv to the next, "
                 f"{'un' if wanted else ''}stable")
    for line, _ in pieces:
        for point in line:
            if min(math.dist(point, d) for d in drawn) > 0.02:
                fail(f"{what}: the curve has a corner at {point}, path.csv has not")
    return drawn


def check_shapes(what, paths, answer, members, larger):
    """Start, events and end, told by their colours from the dots of the key."""
    start = answer["points"][0]["nodes"]
    stops = [answer["points"][0]] + answer["events"] + [answer["points"][-1]]
    shapes = [{n: [start[n][d] + larger * (stop["nodes"][n][d] - start[n][d]) for d in (0, 1)]
               for n in start} for stop in stops]
    found = [s for s in segments(paths) if not near(s[2].stroke, CURVE)]
    # The window: some two places that make all members of all shapes be there.
    nodes = [p for shape in shapes for p in shape.values()]
    low = [min(p[d] for p in nodes) for d in (0, 1)]
    high = [max(p[d] for p in nodes) for d in (0, 1)]
    coloured = [s for s in found if max(s[2].stroke) - min(s[2].stroke) > 0.2
                and not near(s[2].stroke, (0.8353, 0.3686, 0.0))]
    ends = [p for s in coloured for p in s[:2]]
    left, right = min(p[0] for p in ends), max(p[0] for p in ends)
    bottom = max(p[1] for p in ends)
    scale = (right - left) / (high[0] - low[0])
    place = lambda p: (left + scale * (p[0] - low[0]), bottom - scale * (p[1] - low[1]))
    for i, shape in enumerate(shapes):
        for a, b in members:
            if not has_segment(coloured, place(shape[a]), place(shape[b])):
                return fail(f"{what}: {a}-{b} of shape {i} is not drawn where it is")


def check(model, arguments, column, sign, larger, width="page", shapes=True, height="factor", upright=False):
    what = f"{model} {' '.join(arguments)}"
    file = os.path.join(work, "a.svg")
    command = [strut, "path", model, *arguments, "--json", "--plot", file, "--width", width, "-o", work]
    run = subprocess.run(command, capture_output=True)
    if run.returncode != 0:
        return fail(f"{command}: {run.stderr}")
    rows = list(csv.DictReader(open(os.path.join(work, "path.csv"), newline="")))
    page_width, page_height, paths = read(file)
    answer = json.loads(run.stdout)
    drawn = check_curve(what, paths, rows, column, sign, height, upright)
    if not drawn:
        return
    dots = centres(paths, page_width)
    stops = [0] + [i for i, r in enumerate(rows) if r["event"]] + [len(rows) - 1]
    for i in stops:
        if not any(math.dist(dot[:2], drawn[i]) < 0.1 for dot in dots):
            fail(f"{what}: no dot at {rows[i]}")
    if shapes:
        check_shapes(what, paths, answer, members_of(model), larger)
    for path in paths:
        for x, y in (p for line in path.lines for p in line):
            if path.stroke and not (-1 < x < page_width + 1 and -1 < y < page_height + 1):
                return fail(f"{what}: ({x}, {y}) is beyond the page")


check("models/gallery/von-mises.yaml", ["--set", "load=0.1"], "apex.y [m]", -1, 1)
check("models/gallery/von-mises.yaml", ["--set", "load=0.1"], "apex.y [m]", -1, 1, "column")
check("models/gallery/half-t-bar.yaml", ["--set", "force=1", "--until", "100"], "n4.x [m]", 1, 200)
check("models/gallery/x-frame.yaml", ["--set", "down=1", "--until", "10"], "n3.y [m]", -1, 1)
check("models/gallery/x-frame.yaml", ["--set", "right=1", "--load", "push", "--until", "10"], "n3.x [m]", 1, 1)
check("models/gallery/x-joint.yaml", ["--set", "load=1", "--until", "15"], "top_right.y [m]", -1, 500)

# Pushed through by the apex, which draws its reaction; and over a number, which runs to the right.
check("models/gallery/von-mises.yaml", ["--over", "apex.y", "--until", "-0.5 m"], "apex.y [m]", -1,
      1, height="apex.reaction_y [N]")
check("models/gallery/von-mises.yaml", ["--set", "load=0.01", "--over", "load", "--until", "0.1 N"],
      "apex.y [m]", -1, 1, height="value [N]", upright=True, shapes=False)

# What moves by rounding alone is not enlarged, and no second row of the key says so.
heights = []
for model, over, until in (("mast-with-guys", "tension", "8 N"), ("clustered-square-pulled", "pull", "0.5 m")):
    file = os.path.join(work, "a.svg")
    subprocess.run([strut, "path", f"models/gallery/{model}.yaml", "--over", over, "--until", until, "--quiet",
                    "--plot", file], check=True)
    heights.append(read(file)[1])
if abs(heights[0] - heights[1]) > 0.01:
    fail(f"a mast that does not move: the picture is {heights[0]} high, not {heights[1]}")

# A slider that snaps from one cable to the other: dashes from kink to kink, and nowhere else.
TOGGLE = """strut: 1
nodes: {anchor: {position: [0, 0.5], fixed: both}, left: {position: [-1, 0], fixed: both},
        right: {position: [1, 0], fixed: both}, tip: {position: [-0.12, 0], fixed: y}}
members: {over: {kind: spring, nodes: [anchor, tip], stiffness: 500, rest_length: 0.7},
          a: {kind: cable, nodes: [left, tip], stiffness: 2000, rest_length: 1.1},
          b: {kind: cable, nodes: [right, tip], stiffness: 2000, rest_length: 1.1}}
loads: {push: {node: tip, force: [2 N, 0]}}
"""
STOP = 0.1
TURN = 500 * (1 - 0.7 / math.hypot(STOP, 0.5)) * -STOP / 2
model, file = os.path.join(work, "toggle.yaml"), os.path.join(work, "a.svg")
open(model, "w", encoding="utf-8").write(TOGGLE)
run = subprocess.run([strut, "path", model, "--until", str(2 * TURN), "--plot", file, "--json",
                      "-o", work], capture_output=True, text=True)
if run.returncode != 0:
    fail(f"toggle: {run.stderr}")
else:
    rows = list(csv.DictReader(open(os.path.join(work, "path.csv"), newline="")))
    drawn = check_curve("toggle", read(file)[2], rows, "tip.x [m]", 1)
    for row in rows:
        x = float(row["tip.x [m]"])
        middle = -STOP - 1e-9 < x < STOP - 1e-9
        if row["negative_eigenvalues"] and (int(row["negative_eigenvalues"]) > 0) != middle:
            fail(f"toggle: the path from x = {x} on is judged wrong: {row}")
    dashed = [line for path in read(file)[2] if path.dash and near(path.stroke, CURVE)
              and abs(path.width - CURVE_WIDTH) < 1e-6 for line in path.lines]
    kinks = [d for d, row in zip(drawn, rows) if row["event"] == "limit point at a kink"]
    if len(dashed) != 2 or len(kinks) != 2:  # the branch, and the sample in the key
        fail(f"toggle: {len(dashed)} dashed lines, {len(kinks)} kinks")
    else:
        for end, kink in zip((dashed[0][0], dashed[0][-1]), kinks):
            if math.dist(end, kink) > 0.02:
                fail(f"toggle: the unstable branch ends at {end}, the kink is at {kink}")
    answer = json.loads(run.stdout)
    for event, turn in zip(answer["events"], (TURN, TURN, -TURN, -TURN)):
        if abs(event["factor"] - turn) > 1e-9 or abs(event["force"] - 2 * turn) > 1e-9:
            fail(f"toggle: {event['kind']} at {event['factor']}, not {turn}")

# Names of any script and length, and a node that comes to touch the ground.
LONG = "a_rather_long_name_of_some_sixty_letters_for_a_mere_node_of_it"
HOSTILE = f"""strut: 1
nodes:
  {LONG}: {{position: [0, 0.02], mass: 1, fixed: x}}
  {"ש" * 32}: {{position: [-1, 0.1], fixed: both}}
  {"م" * 31}: {{position: [1, 0.1], fixed: both}}
members:
  {"ä" * 32}: {{kind: bar, nodes: [{LONG}, {"ש" * 32}], stiffness: 1000}}
  b: {{kind: cable, nodes: [{LONG}, {"م" * 31}], stiffness: 1000}}
ground: {{stiffness: 1e4}}
loads:
  {"م" * 32}: {{node: {LONG}, force: [0, -50]}}
"""
model = os.path.join(work, "hostile.yaml")
open(model, "w", encoding="utf-8").write(HOSTILE)
for size in ("page", "column", "40 mm"):
    file = os.path.join(work, "a.svg")
    run = subprocess.run([strut, "path", model, "--load", "م" * 32, "--until", "2", "--plot",
                          file, "--width", size], capture_output=True, text=True)
    if run.returncode != 0 or run.stderr:
        fail(f"names of other scripts, {size}: {run.returncode} {run.stderr}")
    else:
        read(file)
for bad, code in (("x.gif", 1), ("nowhere/x.svg", 4)):
    run = subprocess.run([strut, "path", "models/gallery/von-mises.yaml", "--set", "load=1",
                          "--plot", bad], capture_output=True)
    if run.returncode != code or run.stdout or not run.stderr:
        fail(f"--plot {bad}: exit code {run.returncode}, {run.stdout}, {run.stderr}")
# Title, labels and limits; an event beyond the limits has no marker there.
call = [strut, "path", "models/gallery/von-mises.yaml", "--set", "load=0.1", "--quiet"]
words = ["--title", "Own title", "--x-label", "own label", "--x-limits", "0,0.02", "--y-limits", "-0.02,0.05"]
for name, more in (("plain.svg", []), ("own.svg", words)):
    subprocess.run(call + more + ["--plot", f"{work}/{name}"], check=True)
plain, own = (read(f"{work}/{name}")[2] for name in ("plain.svg", "own.svg"))
left = [len([c for c in centres(p, None) if c[0] < 250 and c[1] < 170]) for p in (plain, own)]
if left != [4, 1]:
    fail(f"path: {left} markers on the curve without and with limits, not 4 and 1")
for bad, why in ((["--x-limits", "2,1", "--plot", f"{work}/bad.svg"], "two ascending numbers"),
                 (["--title", "x"], "--title needs --plot"), (["--y-label", "x"], "--y-label needs --plot")):
    done = subprocess.run(call + bad, capture_output=True, text=True)
    if done.returncode != 1 or why not in done.stderr:
        fail(f"path {bad}: {done.returncode} {done.stderr}")
# The other commands take a title.
for command in (["modes"], ["rigidity"], ["equilibria"], ["form"], ["compare", "--no-motion", "--no-states"]):
    texts = []
    for title in ("A", "A longer title"):
        subprocess.run([strut, *command, "models/gallery/x-frame.yaml", "--quiet", "--title", title, "--plot",
                        f"{work}/a.svg"], check=True, stdout=subprocess.DEVNULL)
        texts.append(open(f"{work}/a.svg", encoding="utf-8").read().count("<use "))
    if texts[1] - texts[0] != 13:
        fail(f"{command[0]} --title: {texts} letters")

finish()

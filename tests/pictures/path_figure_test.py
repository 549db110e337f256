# SPDX-License-Identifier: GPL-3.0-or-later
"""strut path --plot: the curve is that of path.csv, the shapes are those of path.json."""
import math
import os

import testing
from svg_paths import distance, has_segment, middle, near, read, segments
from testing import check, exported, fail, finish, models, rows, run, work, write

CURVE, CURVE_WIDTH = (0.15, 0.15, 0.15), 1.2
GALLERY = f"{models}/gallery"
os.chdir(work)


def dots(paths):
    """Where the dots are."""
    filled = [path for path in paths if path.curved and path.fill and not near(path.fill, (1, 1, 1))]
    return [middle(line) for path in filled for line in path.lines
            if max(p[0] for p in line) - min(p[0] for p in line) < 6]


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


def check_figure(model, *words, column, sign=-1, larger=1, height="factor", upright=False):
    """larger: how many times as far as in path.json shapes have gone; 0: they overlap the curve."""
    what = f"{model} {' '.join(words)}"
    answer = testing.answer("path", f"{GALLERY}/{model}.yaml", *words, "--plot", "a.svg", "-o", work)
    table = rows("path.csv")
    page_width, page_height, paths = read("a.svg")
    drawn = check_curve(what, paths, table, column, sign, height, upright)
    for point, row in zip(drawn, table):
        if row["event"] or row in (table[0], table[-1]):
            check(any(math.dist(dot, point) < 0.1 for dot in dots(paths)), f"{what}: no dot at {row}")
    if larger:
        members = exported(f"{GALLERY}/{model}.yaml")["members"].values()
        check_shapes(what, paths, answer, [member["nodes"] for member in members], larger)
    outside = [(x, y) for path in paths if path.stroke for line in path.lines for x, y in line
               if not (-1 < x < page_width + 1 and -1 < y < page_height + 1)]
    check(not outside, f"{what}: {outside[:2]} are beyond the page")


check_figure("von-mises", "--set", "load=0.1", column="apex.y [m]")
check_figure("von-mises", "--set", "load=0.1", "--width", "column", column="apex.y [m]")
check_figure("half-t-bar", "--set", "force=1", "--until", "100", column="n4.x [m]", sign=1, larger=200)
check_figure("x-frame", "--set", "down=1", "--until", "10", column="n3.y [m]")
check_figure("x-frame", "--set", "right=1", "--load", "push", "--until", "10", column="n3.x [m]", sign=1)
check_figure("x-joint", "--set", "load=1", "--until", "15", column="top_right.y [m]", larger=500)

# Pushed through by the apex, which draws its reaction; and over a number, which runs to the right.
check_figure("von-mises", "--over", "apex.y", "--until", "-0.5 m", column="apex.y [m]", height="apex.reaction_y [N]")
check_figure("von-mises", "--set", "load=0.01", "--over", "load", "--until", "0.1 N", column="apex.y [m]", larger=0,
             height="value [N]", upright=True)

# What moves by rounding alone is not enlarged, and no second row of the key says so.
heights = []
for model, over, until in (("mast-with-guys", "tension", "8 N"), ("clustered-square-pulled", "pull", "0.5 m")):
    run("path", f"{GALLERY}/{model}.yaml", "--over", over, "--until", until, "--quiet", "--plot", "a.svg")
    heights.append(read("a.svg")[1])
check(abs(heights[0] - heights[1]) <= 0.01,
      f"a mast that does not move: the picture is {heights[0]} high, not {heights[1]}")

# A slider that snaps from one cable to the other: dashes from kink to kink, and nowhere else.
STOP = 0.1
TURN = 500 * (1 - 0.7 / math.hypot(STOP, 0.5)) * -STOP / 2
write("toggle.yaml", """strut: 1
nodes: {anchor: {position: [0, 0.5], fixed: both}, left: {position: [-1, 0], fixed: both},
        right: {position: [1, 0], fixed: both}, tip: {position: [-0.12, 0], fixed: y}}
members: {over: {kind: spring, nodes: [anchor, tip], stiffness: 500, rest_length: 0.7},
          a: {kind: cable, nodes: [left, tip], stiffness: 2000, rest_length: 1.1},
          b: {kind: cable, nodes: [right, tip], stiffness: 2000, rest_length: 1.1}}
loads: {push: {node: tip, force: [2 N, 0]}}
""")
answer = testing.answer("path", "toggle.yaml", "--until", str(2 * TURN), "--plot", "a.svg", "-o", work)
table = rows("path.csv")
drawn = check_curve("toggle", read("a.svg")[2], table, "tip.x [m]", 1)
for row in table:
    x = float(row["tip.x [m]"])
    between = -STOP - 1e-9 < x < STOP - 1e-9
    if row["negative_eigenvalues"] and (int(row["negative_eigenvalues"]) > 0) != between:
        fail(f"toggle: the path from x = {x} on is judged wrong: {row}")
dashed = [line for path in read("a.svg")[2] if path.dash and near(path.stroke, CURVE)
          and abs(path.width - CURVE_WIDTH) < 1e-6 for line in path.lines]
kinks = [d for d, row in zip(drawn, table) if row["event"] == "limit point at a kink"]
check(len(dashed) == 2 and len(kinks) == 2,  # the branch, and the sample in the key
      f"toggle: {len(dashed)} dashed lines, {len(kinks)} kinks")
for end, kink in zip((dashed[0][0], dashed[0][-1]), kinks):
    check(math.dist(end, kink) <= 0.02, f"toggle: the unstable branch ends at {end}, the kink is at {kink}")
for event, turn in zip(answer["events"], (TURN, TURN, -TURN, -TURN)):
    check(abs(event["factor"] - turn) <= 1e-9 and abs(event["force"] - 2 * turn) <= 1e-9,
          f"toggle: {event['kind']} at {event['factor']}, not {turn}")

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
write("hostile.yaml", HOSTILE)
for size in ("page", "column", "40 mm"):
    done = run("path", "hostile.yaml", "--load", "م" * 32, "--until", "2", "--plot", "a.svg", "--width", size)
    check(not done.stderr, f"names of other scripts, {size}: {done.stderr}")
    read("a.svg")

# Title, labels and limits; an event beyond the limits has no marker there.
CALL = ("path", f"{GALLERY}/von-mises.yaml", "--set", "load=0.1", "--quiet")
run(*CALL, "--plot", "plain.svg")
run(*CALL, "--plot", "own.svg", "--title", "Own title", "--x-label", "own label", "--x-limits", "0,0.02",
    "--y-limits", "-0.02,0.05")
left = [len([c for c in dots(read(f"{name}.svg")[2]) if c[0] < 250 and c[1] < 170]) for name in ("plain", "own")]
check(left == [4, 1], f"path: {left} markers on the curve without and with limits, not 4 and 1")
for code, why, *words in ((1, "x.gif", "--plot", "x.gif"), (4, "nowhere", "--plot", "nowhere/x.svg"),
                          (1, "two ascending numbers", "--x-limits", "2,1", "--plot", "bad.svg"),
                          (1, "--title needs --plot", "--title", "x"), (1, "--y-label needs --plot", "--y-label", "x")):
    check(not run(*CALL, *words, code=code, err=why).stdout, f"path {words} prints something")
# The other commands take a title.
for command in (["modes"], ["rigidity"], ["equilibria"], ["form"], ["compare", "--no-motion", "--no-states"]):
    texts = []
    for title in ("A", "A longer title"):
        run(*command, f"{GALLERY}/x-frame.yaml", "--quiet", "--title", title, "--plot", "a.svg")
        texts.append(testing.read("a.svg").count(b"<use "))
    check(texts[1] - texts[0] == 13, f"{command[0]} --title: {texts} letters")

finish()

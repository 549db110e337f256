# SPDX-License-Identifier: GPL-3.0-or-later
"""strut run --plot: what is drawn is where nodes.csv of the same run says that the nodes are."""
import csv
import itertools
import json
import math
import os
import re
import signal

import testing
from svg_paths import Window, circles, distance, has_segment, near, read, segments, texts
from testing import check, exported, fail, finish, models, stopped, work, write

EDGE, PALE = (0.1, 0.1, 0.1), (0.72, 0.72, 0.72)
os.chdir(work)


def run(*words, **how):
    return testing.run("run", *words, "-q", **how)


def frames_of(directory):
    """(times, for each frame a list of (x, y))."""
    with open(f"{directory}/nodes.csv", encoding="utf-8") as file:
        table = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    return [row[0] for row in table], [list(zip(row[1::2], row[2::2])) for row in table]


def members_of(model):
    """Indices of both nodes of each."""
    scene = exported(model)
    names = list(scene["nodes"])
    return [[names.index(node) for node in member["nodes"]] for member in scene["members"].values()]


def check_shape(what, places, drawn, lines, members):
    window = Window(places, drawn)
    check(window.worst <= 0.03, f"{what}: a node is {window.worst} pt from its place")
    for a, b in members:
        check(has_segment(lines, drawn[a], drawn[b], 0.03),
              f"{what}: a member between nodes {a + 1} and {b + 1} is missing")
    return window


def check_snapshots(model, words, expected, common):
    """The shapes are those of the frames nearest to the times, all to one scale."""
    run(model, "-o", "out", "--plot", "a.svg", "--draw", "snapshots", *words)
    times, frames = frames_of("out")
    width, height, paths = read("a.svg")
    drawn, members, lines = circles(paths, EDGE), members_of(model), segments(paths)
    if len(drawn) != 5 * len(expected):
        return fail(f"{model} {words}: {len(drawn)} nodes are drawn")
    windows = []
    for k, wanted in enumerate(expected):
        nearest = min(range(len(times)), key=lambda f: abs(times[f] - wanted))
        shape = drawn[5 * k:5 * k + 5]
        windows.append(check_shape(f"{words} at {wanted} s", frames[nearest], shape, lines, members))
        for x, y in shape:
            check(0 < x < width and 0 < y < height, f"{words}: a node is drawn beyond the page")
    scales = [window.scale for window in windows]
    check(max(scales) - min(scales) <= 1e-3 * scales[0], f"{words}: shapes have different scales")
    # Cells stand in rows and columns: with one window for all, origins differ by whole cells.
    lefts = sorted(window.left for window in windows)
    steps = [b - a for a, b in zip(lefts, lefts[1:]) if b - a > 0.1]
    if common and steps and (max(steps) - min(steps) > 0.1 or len(steps) > 3):
        fail(f"{words}: the way that it goes is not seen: origins at {lefts}")


THROWN = """strut: 1
name: Thrown triangle
gravity: [0, -9.81 m/s^2]
ground: {stiffness: 1e4 N/m, damping: 5 N s/m, friction: {law: karnopp, mu: 0.3, stick_velocity: 0.1 mm/s}}
nodes: {a: [0, 0], b: [0.1 m, 0], c: [0.05 m, 0.03 m]}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 1e4 N/m, mass: 0.1 kg},
          ac: {kind: bar, nodes: [a, c], stiffness: 1e4 N/m, mass: 0.1 kg},
          bc: {kind: bar, nodes: [b, c], stiffness: 1e4 N/m, mass: 0.1 kg}}
initial: {velocities: {a: [1, 2 m/s], b: [1, 2.5 m/s], c: [1, 2 m/s]}}
solver: {step: 0.05 ms}
run: {duration: 0.7 s}
"""


def check_ground():
    """A structure that leaves the ground: in a row of snapshots the ground is at one height."""
    write("thrown.yaml", THROWN)
    run("thrown.yaml", "--plot", "thrown.svg", "--draw", "snapshots")
    width, height, paths = read("thrown.svg")
    lines = [s for s in segments(paths) if near(s[2].stroke, (0.3, 0.3, 0.3))
             and abs(s[0][1] - s[1][1]) < 1e-6 and abs(s[0][0] - s[1][0]) > 0.3 * width]
    below = [s[0][1] for s in lines if s[0][1] > 0.6 * height]
    check(len(below) >= 2 and max(below) - min(below) <= 0.02, f"the ground of the last row is drawn at {below}")


def check_period(factors):
    """The nodes' ways over the last period, exaggerated from their mean places."""
    scale = ["--scale", "%g,%g" % factors] if factors != (1, 1) else []
    run("short.yaml", "-o", "out2", "--plot", "b.svg", "--draw", "period", *scale)
    times, frames = frames_of("out2")
    last = [f for t, f in zip(times, frames) if t > times[-1] - 0.1 - 1e-6]
    means = [tuple(sum(f[i][d] for f in last) / len(last) for d in (0, 1)) for i in range(5)]
    touches = [min(f[i][1] for f in last) < 1e-4 for i in range(5)]
    rest = [(m[0], 0.0) if down else m for m, down in zip(means, touches)]
    check(touches == [True, False, False, True, False], f"the ground is touched by {touches}")
    paths = read("b.svg")[2]
    window = check_shape(f"period {factors}", rest if scale else frames[-1], circles(paths, PALE),
                         segments(paths), members_of("short.yaml"))
    trails = [p for p in paths if abs(p.width - 1.5) < 1e-6 and not p.curved and p.stroke]
    brightness, at = -1.0, 0
    ways = [[] for _ in range(5)]
    for path in trails:  # each node's from dark to bright, one after the other
        bright = sum(w * c for w, c in zip((0.299, 0.587, 0.114), path.stroke))
        if bright < brightness - 0.2:
            at += 1
        elif bright < brightness - 0.01:
            fail(f"period {factors}: a way grows darker")
        brightness = bright
        for line in path.lines:
            ways[min(at, 4)] += line
    if at != 4:
        return fail(f"period {factors}: {at + 1} ways are drawn")
    for i in range(5):
        wanted = [window.on_page([rest[i][d] + factors[d] * (f[i][d] - rest[i][d]) for d in (0, 1)]) for f in last]
        for point in ways[i]:
            if min(math.dist(point, w) for w in wanted) > 0.03:
                return fail(f"period {factors}: the way of node {i + 1} goes through {point}")
        for w in wanted:
            if distance(w, ways[i]) > 0.05:
                return fail(f"period {factors}: the way of node {i + 1} misses {w}")
    check(max(f[3][1] for f in last) > 1e-4 > max(f[0][1] for f in last), "node 4 does not lift, or node 1 does")


def check_two_periods():
    """A motion that repeats after two periods of its drive is drawn over both, until it is where it began."""
    run(f"{models}/crawler/crawler.yaml", "--accuracy", "2%", "--draw", "period", "--plot", "two.svg",
        "--set=friction=0.1", "--set=frequency=13.613 Hz", "--set=amplitude=0.2986 mm")
    said = " ".join(texts("two.svg"))
    check("over the 2 periods of the drive after which they repeat (146.9 ms)" in said, f"two periods: {said}")


def check_overview():
    """The last shape, and the curve of the measured node's displacement over the last periods."""
    run("short.yaml", "-o", "out3", "--plot", "c.svg")
    times, frames = frames_of("out3")
    paths = read("c.svg")[2]
    check_shape("overview", frames[-1], circles(paths, EDGE), segments(paths), members_of("short.yaml"))
    first = next(i for i, t in enumerate(times) if t > times[-1] - 0.5 - 1e-6)
    curves = [line for p in paths if not p.curved and p.stroke and not p.dash and p.width > 0.9
              for line in p.lines if len(line) > 50]
    if not curves:
        return fail("overview: no curve")
    line = curves[0]  # that of the displacement
    span = times[-1] - times[first]
    to_time = lambda x: times[first] + span * (x - line[0][0]) / (line[-1][0] - line[0][0])
    value = {round(t, 6): f[0][0] for t, f in zip(times, frames)}
    pairs = [(value[round(to_time(x), 3)], y) for x, y in line if round(to_time(x), 3) in value]
    low, high = min(pairs), max(pairs)
    slope = (high[1] - low[1]) / (high[0] - low[0])
    check(len(pairs) >= 50 and slope < 0, f"overview: {len(pairs)} points of the displacement, slope {slope}")
    for v, y in pairs:
        if abs(low[1] + slope * (v - low[0]) - y) > 0.6:
            return fail(f"overview: the displacement of {v} m is drawn at {y}")


SPRING = """strut: 1
data: {film: {file: film.csv}, gauge: {file: gauge.csv}}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100 N/m, rest_length: 1}}
initial: {positions: {b: [1.01, 0]}}
solver: {step: 1 ms}
run: {duration: 1 s}
output: {channels: [position, force, com.x]}
"""


def check_data():
    """Columns of data named as those of a run are dots beside its curves, in a run of its results, too."""
    film = [(0.02 * i, 1 + 0.01 * math.cos(0.2 * i)) for i in range(61)]
    write("film.csv", "t [s],b.x [mm],b.y [s],com.x [m],a.height [m],c.x [m]\n" +
          "".join(f"{t!r},{1e3 * x!r},1,{2 * x!r},1,1\n" for t, x in film))
    write("gauge.csv", "t [ms],m.force [kN]\n" +
          "".join(f"{0.5 * i},{'' if i == 8 else i * 1e-6}\n" for i in range(4000)))
    write("spring.yaml", SPRING)
    for source, words in (("spring.yaml", ["-o", "spring"]), ("spring/scene.yaml", [])):
        run(source, *words, "--plot", "spring.json", "--draw", "curves")
        panels = json.load(open("spring.json"))["panels"]
        curves = {(p["y"]["name"], s["label"]): s for p in panels for s in p["series"] if not s.get("dots")}
        dots = {(p["y"]["name"], s["label"]): s for p in panels for s in p["series"] if s.get("dots")}
        wanted = {("position", "b.x"): film, ("com.x", "com.x"): [(t, 2 * x) for t, x in film],
                  ("member force", "m"): [(5e-4 * i, 1e-3 * i) for i in range(0, 4000, 9)]}
        check({(y, label.removesuffix(" measured")) for y, label in dots} == set(wanted), f"dots of {set(dots)}")
        for (y, label), rows in wanted.items():
            series = dots[y, label + " measured"]
            found = list(zip(series["x"], series["y"]))
            rows = [(t, value) for t, value in rows if t <= 1]
            check(len(found) == len(rows) and all(math.dist(a, b) < 1e-9 for a, b in zip(found, rows)),
                  f"data of {label}: {len(found)} dots from {found[:2]}, expected {len(rows)} from {rows[:2]}")
            check((y, label) in curves, f"no curve of {label} beside its data")
    check(max(abs(a - x) for a, (_, x) in zip(curves["position", "b.x"]["y"][::20], film)) < 1e-5,
          "the curve beside data is not that of the node")


def check_same_bytes():
    for view in ("overview", "period", "snapshots", "curves"):
        for ending in ("svg", "pdf", "png"):
            drawn = []
            for _ in range(2):
                run("short.yaml", "--plot", f"same.{ending}", "--draw", view, "--width", "column")
                drawn.append(testing.read(f"same.{ending}"))
            check(drawn[0] == drawn[1], f"{view}: drawn again the {ending} has other bytes")


def check_refusals():
    run("short.yaml", "--draw", "curves", code=1, err="--draw needs --plot FILE")
    run("short.yaml", "--title", "Own title", code=1, err="--title needs --plot FILE")
    for err, *words in (("did you mean 'overview'", "--draw", "overveiw"),
                        ("--scale goes with", "--scale", "10,2"),
                        ("--times goes with", "--draw", "period", "--times", "1 s"),
                        ("two numbers above 0", "--draw", "period", "--scale", "10"),
                        ("two numbers above 0", "--draw", "period", "--scale", "0,1"),
                        ("--times expects", "--draw", "snapshots", "--times", "1 N"),
                        ("nothing is recorded at 3 s", "--draw", "snapshots", "--times", "1.5 s,3 s")):
        run("short.yaml", "--plot", "none.svg", *words, code=1, err=err)
    run("short.yaml", "--plot", "nowhere/x.svg", code=4)
    write("coarse.yaml", SHORT.replace("every: 1/(100*frequency)", "every: 20 ms"))
    run("coarse.yaml", "--plot", "none.svg", "--draw", "period", code=1, err="every: 1 ms")
    check(not os.path.exists("none.svg"), "a run that was refused left a picture")
    run("coarse.yaml", "--plot", "plain.svg")  # an overview there is
    run("coarse.yaml", "--plot", "titled.svg", "--title", "Own title")
    check(testing.read("plain.svg") != testing.read("titled.svg"), "--title changes nothing")


def check_stopped():
    """A run that diverged, or was stopped, is drawn as far as it came."""
    wild = SHORT.replace("last: 10,", "")
    write("wild.yaml", wild)
    wrong = ("--force", "--set", "step=0.7 ms", "--plot", "stopped.svg")
    for view in ("overview", "snapshots", "curves", "period"):
        run("wild.yaml", *wrong, "--draw", view, code=3)
        check(os.path.exists("stopped.svg"), f"a run that diverged is not drawn: {view}")
        os.remove("stopped.svg")
    run("short.yaml", *wrong, code=3, err="nothing to draw")  # it did not come to the last periods
    write("endless.yaml", wild.replace("periods: 20", "periods: 1000000"))
    before, looks = os.listdir("."), itertools.count()
    stopped("run", "endless.yaml", "-q", "-o", "far", "--plot", "stopped.svg", by=signal.SIGINT,
            after=lambda: os.listdir(".") != before and next(looks) > 150)  # 0.3 s after
    check(os.path.exists("stopped.svg"), "a run that was stopped is not drawn")


with open(f"{models}/crawler/crawler.yaml", encoding="utf-8") as file:
    CRAWLER = file.read()
SHORT = CRAWLER.replace("periods: 1100", "periods: 20").replace("measure: {last: 100}", "measure: {node: n1, last: 2}")
write("short.yaml", SHORT)
# the change from state I to II, figure 11
tilt = CRAWLER.replace("{sine: {amplitude: amplitude, frequency: frequency}}",
                       "{half_sine: {amplitude: 0.8 mm, frequency: 10 Hz}}")
tilt = re.sub(r"^run:.*", "run: {duration: 1 s}", tilt, flags=re.M)
write("tilt.yaml", re.sub(r"^output:.*", "output: {every: 1 ms}", tilt, flags=re.M))
check_snapshots("tilt.yaml", [], [0, 0.2, 0.4, 0.6, 0.8, 1.0], True)
check_snapshots("tilt.yaml", ["--times", "0 s, 50 ms,100 ms,0.15 s, 1"], [0, 0.05, 0.1, 0.15, 1.0], True)
check_snapshots("tilt.yaml", ["--times", "300.4 ms", "--width", "column"], [0.3], True)
check_snapshots("short.yaml", [], [1.4, 1.52, 1.64, 1.76, 1.88, 2.0], True)
check_ground()
check_period((1, 1))
check_period((10, 2))
check_two_periods()
check_overview()
check_data()
check_same_bytes()
check_refusals()
check_stopped()
finish()

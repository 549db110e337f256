# SPDX-License-Identifier: GPL-3.0-or-later
"""strut run --plot: what is drawn is where nodes.csv of the same run says that the nodes are."""
import csv
import json
import math
import os
import re
import signal
import subprocess
import time

from svg_paths import distance, has_segment, near, read, segments, texts

from testing import check, fail, finish, strut, work

crawler = open("models/crawler/crawler.yaml").read()
EDGE, PALE, WHITE = (0.1, 0.1, 0.1), (0.72, 0.72, 0.72), (1, 1, 1)


def run(*words, code=0, err=""):
    done = subprocess.run([strut, "run", *words], capture_output=True, text=True)
    if done.returncode != code or err not in done.stderr:
        fail(f"strut run {words}: exit code {done.returncode}, expected {code}; {done.stderr}")
    return done


def rows_of(directory):
    """(times, for each frame a list of (x, y))."""
    lines = list(csv.reader(open(os.path.join(directory, "nodes.csv"))))[1:]
    frames = [[(float(r[k]), float(r[k + 1])) for k in range(1, len(r), 2)] for r in lines]
    return [float(r[0]) for r in lines], frames


def members_of(model):
    text = subprocess.run([strut, "export", model], capture_output=True, text=True).stdout
    pairs = re.findall(r"^  \w+: \{.*nodes: \[n(\d), n(\d)\]", text, re.M)
    return [(int(a) - 1, int(b) - 1) for a, b in pairs]


def circles(paths, stroke):
    """Centres of the nodes drawn with that edge, in their order."""
    found = []
    for path in paths:
        if path.curved and near(path.stroke, stroke) and near(path.fill, WHITE):
            for line in path.lines:
                found.append(tuple((min(p[d] for p in line) + max(p[d] for p in line)) / 2 for d in (0, 1)))
    return found


def fit(places, drawn):
    """Scale and origin that take places [m] to the page, from the widest pair."""
    order = sorted(range(len(places)), key=lambda i: places[i][0])
    a, b = order[0], order[-1]
    scale = (drawn[b][0] - drawn[a][0]) / (places[b][0] - places[a][0])
    return scale, drawn[a][0] - scale * places[a][0], drawn[a][1] + scale * places[a][1]


def placed(frame, place):
    scale, left, top = frame
    return (left + scale * place[0], top - scale * place[1])


def check_shape(what, places, drawn, lines, members):
    frame = fit(places, drawn)
    for place, centre in zip(places, drawn):
        if math.dist(placed(frame, place), centre) > 0.03:
            fail(f"{what}: a node is at {centre} instead of {placed(frame, place)}")
    for a, b in members:
        if not has_segment(lines, drawn[a], drawn[b], 0.03):
            fail(f"{what}: a member between nodes {a + 1} and {b + 1} is missing")
    return frame


def check_snapshots(here, model, words, expected, common):
    """The shapes are those of the frames nearest to the times, all to one scale."""
    file, out = os.path.join(here, "a.svg"), os.path.join(here, "out")
    run(model, "-q", "-o", out, "--plot", file, "--draw", "snapshots", *words)
    times, frames = rows_of(out)
    width, height, paths = read(file)
    drawn, members, lines = circles(paths, EDGE), members_of(model), segments(paths)
    if len(drawn) != 5 * len(expected):
        return fail(f"{model} {words}: {len(drawn)} nodes are drawn")
    windows = []
    for k, wanted in enumerate(expected):
        nearest = min(range(len(times)), key=lambda f: abs(times[f] - wanted))
        shape = drawn[5 * k:5 * k + 5]
        what = f"{words} at {wanted} s"
        windows.append(check_shape(what, frames[nearest], shape, lines, members))
        for x, y in shape:
            check(0 < x < width and 0 < y < height, f"{words}: a node is drawn beyond the page")
    if max(w[0] for w in windows) - min(w[0] for w in windows) > 1e-3 * windows[0][0]:
        fail(f"{words}: shapes have different scales")
    # Cells stand in rows and columns: with one window for all, origins differ by whole cells.
    lefts = sorted(w[1] for w in windows)
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


def check_ground(here):
    """A structure that leaves the ground: in a row of snapshots the ground is at one height."""
    model, file = os.path.join(here, "thrown.yaml"), os.path.join(here, "thrown.svg")
    open(model, "w").write(THROWN)
    run(model, "-q", "--plot", file, "--draw", "snapshots")
    width, height, paths = read(file)
    lines = [s for s in segments(paths) if near(s[2].stroke, (0.3, 0.3, 0.3))
             and abs(s[0][1] - s[1][1]) < 1e-6 and abs(s[0][0] - s[1][0]) > 0.3 * width]
    below = [s[0][1] for s in lines if s[0][1] > 0.6 * height]
    check(len(below) >= 2 and max(below) - min(below) <= 0.02, f"the ground of the last row is drawn at {below}")


def check_period(here, model, factors):
    """The nodes' ways over the last period, exaggerated from their mean places."""
    file, out = os.path.join(here, "b.svg"), os.path.join(here, "out2")
    scale = ["--scale", "%g,%g" % factors] if factors != (1, 1) else []
    run(model, "-q", "-o", out, "--plot", file, "--draw", "period", *scale)
    times, frames = rows_of(out)
    last = [f for t, f in zip(times, frames) if t > times[-1] - 0.1 - 1e-6]
    means = [tuple(sum(f[i][d] for f in last) / len(last) for d in (0, 1)) for i in range(5)]
    touches = [min(f[i][1] for f in last) < 1e-4 for i in range(5)]
    rest = [(m[0], 0.0) if down else m for m, down in zip(means, touches)]
    check(touches == [True, False, False, True, False], f"the ground is touched by {touches}")
    paths = read(file)[2]
    window = check_shape(f"period {factors}", rest if scale else frames[-1], circles(paths, PALE),
                         segments(paths), members_of(model))
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
        wanted = [placed(window, [rest[i][d] + factors[d] * (f[i][d] - rest[i][d]) for d in (0, 1)]) for f in last]
        for point in ways[i]:
            if min(math.dist(point, w) for w in wanted) > 0.03:
                return fail(f"period {factors}: the way of node {i + 1} goes through {point}")
        for w in wanted:
            if distance(w, ways[i]) > 0.05:
                return fail(f"period {factors}: the way of node {i + 1} misses {w}")
    check(max(f[3][1] for f in last) > 1e-4 > max(f[0][1] for f in last), "node 4 does not lift, or node 1 does")


def check_two_periods(here):
    """A motion that repeats after two periods of its drive is drawn over both, from where it began to where it is again."""
    file = os.path.join(here, "two.svg")
    setting = ("friction=0.1", "frequency=13.613 Hz", "amplitude=0.2986 mm")
    run("models/crawler/crawler.yaml", "-q", "--accuracy", "2%", "--draw", "period", "--plot", file,
        *(word for each in setting for word in ("--set", each)))
    said = " ".join(texts(file))
    check("over the 2 periods of the drive after which they repeat (146.9 ms)" in said, f"two periods: {said}")


def check_overview(here, model):
    """The last shape, and the curve of the measured node's displacement over the last periods."""
    file, out = os.path.join(here, "c.svg"), os.path.join(here, "out3")
    run(model, "-q", "-o", out, "--plot", file)
    times, frames = rows_of(out)
    paths = read(file)[2]
    check_shape("overview", frames[-1], circles(paths, EDGE), segments(paths), members_of(model))
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


def check_data(here):
    """Columns of data named as those of a run are dots beside its curves, in a run of its results, too."""
    film = [(0.02 * i, 1 + 0.01 * math.cos(0.2 * i)) for i in range(61)]
    with open(os.path.join(here, "film.csv"), "w") as file:
        file.write("t [s],b.x [mm],b.y [s],com.x [m],a.height [m],c.x [m]\n")
        file.writelines(f"{t!r},{1e3 * x!r},1,{2 * x!r},1,1\n" for t, x in film)
    with open(os.path.join(here, "gauge.csv"), "w") as file:
        file.write("t [ms],m.force [kN]\n")
        file.writelines(f"{0.5 * i},{'' if i == 8 else i * 1e-6}\n" for i in range(4000))
    model, file, out = (os.path.join(here, name) for name in ("spring.yaml", "spring.json", "spring"))
    open(model, "w").write(SPRING)
    for source in (model, os.path.join(out, "scene.yaml")):
        run(source, "-q", *(["-o", out] if source == model else []), "--plot", file, "--draw", "curves")
        panels = json.load(open(file))["panels"]
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


def check_same_bytes(here, model):
    for view in ("overview", "period", "snapshots", "curves"):
        for ending in ("svg", "pdf", "png"):
            one, two = (os.path.join(here, f"{n}.{ending}") for n in ("one", "two"))
            for file in (one, two):
                run(model, "-q", "--plot", file, "--draw", view, "--width", "column")
            if open(one, "rb").read() != open(two, "rb").read():
                fail(f"{view}: drawn again the {ending} has other bytes")


def check_refusals(here, model):
    file = os.path.join(here, "none.svg")
    refuse = lambda err, *words, code=1: run(model, "-q", *words, code=code, err=err)
    refuse("did you mean 'overview'", "--plot", file, "--draw", "overveiw")
    refuse("--draw needs --plot FILE", "--draw", "curves")
    refuse("--title needs --plot FILE", "--title", "Own title")
    refuse("--scale goes with", "--plot", file, "--scale", "10,2")
    refuse("--times goes with", "--plot", file, "--draw", "period", "--times", "1 s")
    refuse("two numbers above 0", "--plot", file, "--draw", "period", "--scale", "10")
    refuse("two numbers above 0", "--plot", file, "--draw", "period", "--scale", "0,1")
    refuse("--times expects", "--plot", file, "--draw", "snapshots", "--times", "1 N")
    refuse("nothing is recorded at 3 s", "--plot", file, "--draw", "snapshots", "--times", "1.5 s,3 s")
    refuse("", "--plot", os.path.join(here, "nowhere", "x.svg"), code=4)
    coarse = os.path.join(here, "coarse.yaml")
    open(coarse, "w").write(open(model).read().replace("every: 1/(100*frequency)", "every: 20 ms"))
    run(coarse, "-q", "--plot", file, "--draw", "period", code=1, err="every: 1 ms")
    check(not os.path.exists(file), "a run that was refused left a picture")
    run(coarse, "-q", "--plot", file)  # an overview there is
    plain = open(file).read()
    run(coarse, "-q", "--plot", file, "--title", "Own title")
    check(open(file).read() != plain, "--title changes nothing")


def check_stopped(here, model):
    """A run that diverged, or was stopped, is drawn as far as it came."""
    file = os.path.join(here, "stopped.svg")
    wild = os.path.join(here, "wild.yaml")
    open(wild, "w").write(open(model).read().replace("last: 10,", ""))
    run(wild, "-q", "--force", "--set", "step=0.7 ms", "--plot", file, code=3)
    if not os.path.exists(file):
        return fail("a run that diverged is not drawn")
    for ending in ("", " --draw snapshots", " --draw curves", " --draw period"):
        run(wild, "-q", "--force", "--set", "step=0.7 ms", "--plot", file, *ending.split(), code=3)
    os.remove(file)
    run(model, "-q", "--force", "--set", "step=0.7 ms", "--plot", file, code=3,
        err="nothing to draw")  # it did not come to the last periods
    endless = os.path.join(here, "endless.yaml")
    open(endless, "w").write(open(wild).read().replace("periods: 20", "periods: 1000000"))
    before = set(os.listdir(here))
    far = os.path.join(here, "far")
    child = subprocess.Popen([strut, "run", endless, "-q", "-o", far, "--plot", file],
                             stderr=subprocess.PIPE, text=True)
    for _ in range(300):  # it watches for signals before it makes files
        if set(os.listdir(here)) != before:
            break
        time.sleep(0.1)
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=60)
    check(os.path.exists(file), "a run that was stopped is not drawn")


short = os.path.join(work, "short.yaml")
open(short, "w").write(crawler.replace("periods: 1100", "periods: 20")
                       .replace("measure: {last: 100}", "measure: {node: n1, last: 2}"))
tilt = os.path.join(work, "tilt.yaml")  # the change from state I to II, figure 11
pulse = "{half_sine: {amplitude: 0.8 mm, frequency: 10 Hz}}"
text = crawler.replace("{sine: {amplitude: amplitude, frequency: frequency}}", pulse)
text = re.sub(r"^run:.*", "run: {duration: 1 s}", text, flags=re.M)
open(tilt, "w").write(re.sub(r"^output:.*", "output: {every: 1 ms}", text, flags=re.M))
check_snapshots(work, tilt, [], [0, 0.2, 0.4, 0.6, 0.8, 1.0], True)
check_snapshots(work, tilt, ["--times", "0 s, 50 ms,100 ms,0.15 s, 1"], [0, 0.05, 0.1, 0.15, 1.0], True)
check_snapshots(work, tilt, ["--times", "300.4 ms", "--width", "column"], [0.3], True)
check_snapshots(work, short, [], [1.4, 1.52, 1.64, 1.76, 1.88, 2.0], True)
check_ground(work)
check_period(work, short, (1, 1))
check_period(work, short, (10, 2))
check_two_periods(work)
check_overview(work, short)
check_data(work)
check_same_bytes(work, short)
check_refusals(work, short)
check_stopped(work, short)
finish()

# SPDX-License-Identifier: GPL-3.0-or-later
"""One run has one answer: no output option changes a number, a summary speaks of one span, all outputs list the same
equilibria, and an accuracy that was not reached is reported everywhere."""
import json
import os
import re
import shutil
import subprocess

import testing
from testing import answer, check, finish, models, numbers, rows, run, work, write

tests = os.path.dirname(os.path.abspath(__file__))
os.chdir(work)

# A robot to an accuracy by its orbit.
with open(f"{tests}/oblique-x.yaml", encoding="utf-8") as file:
    ROBOT = file.read() + """solver: {accuracy: 1 %}
output: {last: 5, every: 1/(100*frequency), channels: [position, force, energy]}
"""
# Fixed steps that end when the motion is steady, also with a measured quantity, by the ladder.
FIXED = ROBOT.replace("accuracy: 1 %", "integrator: rk4-events, step: 20 us").replace("periods: 400", "periods: 60")
MEASURED = ROBOT.replace("periods: 400", "periods: 40").replace(
    "steady: true}", "steady: true, quantities: {pull: {of: left.force, take: max}}}")
# Its step is too large by half: it is lost at a step that must not depend on what is recorded.
LOST = """strut: 1
nodes: {wall: {position: [0, 0], fixed: both}, a: {position: [1.01, 0], fixed: y, mass: 1}}
members: {m: {kind: spring, nodes: [wall, a], stiffness: 1e4, rest_length: 1}}
solver: {integrator: euler, step: 30 ms}
run: {duration: 100 s}
output: {every: 0.13 s}
"""


def without_clock(table):
    """The table but for the time that the computation took."""
    return re.sub(r" force evaluations in .*", " force evaluations", table)


def answers(name, *more, code=0):
    """What each way of asking for the same run says of it: tables and summaries."""
    shutil.rmtree("d", ignore_errors=True)
    tables, summaries, warnings = [], [], []
    for words in ((), ("-o", "d"), ("--plot", "p.svg"), ("-o", "d", "--plot", "p.svg", "--draw", "period")):
        done = run("run", name, *more, *words, code=code)
        tables.append(without_clock(done.stdout))
        warnings.append(done.stderr)
    for words in (("--json",), ("--json", "-o", "d"), ("--json", "--quiet", "--plot", "p.svg", "-o", "d")):
        done = run("run", name, *more, *words, code=code)
        warnings.append(done.stderr)
        found = json.loads(done.stdout)
        del found["wall_time"]
        summaries.append(found)
    warnings.append(run("run", name, *more, "--quiet", code=code).stderr)
    summaries.append(json.loads(testing.read("d/summary.json")))
    for what, all_of_them in (("table", tables), ("summary", summaries), ("stderr", warnings)):
        for i, other in enumerate(all_of_them):
            parts = (str(text).split(", " if what == "summary" else "\n") for text in (all_of_them[0], other))
            differ = [pair for pair in zip(*parts) if pair[0] != pair[1]]
            check(other == all_of_them[0], f"{name} {more}: {what} {i} says otherwise: {differ[:6]}")
    return summaries[0], tables[0]


def column(name, key):
    """The cells of a column of a table, as texts."""
    return [value for row in rows(name) for title, value in row.items() if title.split(" [")[0] == key]


def stored(energy):
    return sum(energy[key] for key in ("kinetic", "elastic", "gravity", "contact"))


def check_span(name):
    """The summary in d is of the state at its duration, with works and losses until then."""
    s = json.loads(testing.read("d/summary.json"))
    at = [abs(row["time"] - s["duration"]) < 1e-9 * s["duration"] for row in numbers("d/nodes.csv")]
    check(sum(at) == 1, f"{name}: {sum(at)} records of the end")
    last = numbers("d/nodes.csv")[at.index(True)]
    for node, values in s["nodes"].items():
        there = [last[f"{node}.x"], last[f"{node}.y"]]
        check(there == values["position"], f"{name}: {node} ends at {values['position']}, recorded {there}")
    last = numbers("d/energy.csv")[at.index(True)]
    for key, value in s["energy"].items():
        if key in last:
            check(abs(last[key] - value) <= 1e-12 * s["energy"]["exchanged"],
                  f"{name}: {key} is {value}, recorded {last[key]}")
    e = s["energy"]
    works = e["drive_work"] + e["load_work"] + e["belt_work"] + e["support_work"]
    losses = e["dissipated_members"] + e["dissipated_contact"] + e["dissipated_friction"]
    check(abs(stored(e) - e["initial"] - works + losses - e["residual"]) < 1e-9 * e["exchanged"],
          f"{name}: the balance does not add up")
    return s


write("robot.yaml", ROBOT)
write("fixed.yaml", FIXED)
write("measured.yaml", MEASURED)
write("lost.yaml", LOST)

# No option of output changes a number, and what is at the end is the state at the printed duration.
for name in ("robot.yaml", "fixed.yaml", "measured.yaml"):
    answers(name)
    check_span(name)
for path in ("basics/bouncing-node.yaml", "basics/belt.yaml", "basics/sliding-block.yaml"):
    answers(f"{models}/{path}")
answers(f"{models}/basics/pendulum.yaml", "--set", "stiffness=1e12 N/m", "--accuracy", "0.1%")
answers(f"{models}/basics/bouncing-node.yaml", "--accuracy", "1%")
answers("lost.yaml", "--force", code=3)

# The works of the whole span are those of a run over the same span by another method.
robot = check_span("robot.yaml") if run("run", "robot.yaml", "-q", "-o", "d") else {}
write("again.yaml", ROBOT.replace("accuracy: 1 %", "integrator: rk4-events, step: 5 us")
      .replace("periods: 400, of: drive", f"duration: {robot['duration']!r}")
      .replace("measure: {last: 20, steady: true}", "measure: {last: 0.1}").replace("last: 5, ", ""))
again = answer("run", "again.yaml")
for key in ("drive_work", "dissipated_members", "dissipated_friction"):
    one, two = robot["energy"][key], again["energy"][key]
    check(abs(one - two) < 0.03 * abs(two), f"{key} over {robot['duration']} s is {one}, by fixed steps {two}")
for node, values in again["nodes"].items():
    x, other = values["position"][0], robot["nodes"][node]["position"][0]
    check(abs(x - other) < 0.4e-3, f"{node} ends at {other}, by fixed steps at {x}")

# So a sweep's power is the drives' power.
write("power.yaml", "strut: 1\nstudy: power\nmodel: robot.yaml\naxes: [{friction: [0.3]}]\n"
      "keep: [duration, work, positions]\n")
run("sweep", "power.yaml", "-o", "s", "--quiet")
row = {key: float(column("s/table.csv", key)[0]) for key in ("duration", "drive_work", "x_a")}
check(row["duration"] == robot["duration"], f"sweep: duration {row['duration']}")
check(row["drive_work"] == robot["energy"]["drive_work"], f"sweep: work {row['drive_work']}")
check(row["x_a"] == robot["nodes"]["a"]["position"][0], f"sweep: a at {row['x_a']}")
power, steady = row["drive_work"] / row["duration"], robot["window_drive_work"] / robot["window_duration"]
check(0.5 * steady < power < 2 * steady, f"power {power} W, that of the steady motion {steady} W")

# In a sweep, with trajectories and without, each point is that run.
tables = []
for more in ("", "trajectories: yes\n"):
    write("each.yaml", "strut: 1\nstudy: each\nmodel: fixed.yaml\naxes: [{friction: {from: 0.2, to: 0.5, step: 0.1}}]\n"
          "keep: [velocity, duration, work, losses, residual, force_evaluations, positions, contacts]\n" + more)
    shutil.rmtree("each", ignore_errors=True)
    run("sweep", "each.yaml", "-o", "each", "--quiet")
    tables.append(testing.read("each/table.csv"))
check(tables[0] == tables[1], "trajectories change the table")
alone = answer("run", "fixed.yaml")
for key, value in (("velocity", alone["velocity"]), ("duration", alone["duration"]),
                   ("drive_work", alone["energy"]["drive_work"]), ("residual", alone["energy"]["residual"]),
                   ("y_d", alone["nodes"]["d"]["position"][1]), ("duty_a", alone["contacts"]["a"]["duty"])):
    check(float(column("each/table.csv", key)[1]) == value, f"each: {key} is not {value}")

# One judgement of the balance: the caveat has none of its own.
plain = answer("run", f"{models}/crawler/crawler.yaml")
check(plain["energy"]["balance"] == "closed" and "residual" not in plain["caveat"], str(plain["caveat"]))

# Table, figure, page, JSON and CSV list the same equilibria.
for path, axis in (("crawler/crawler.yaml", "friction: [0.1]"), ("gallery/two-mass-crawler.yaml", "friction: [0.1]"),
                   ("gallery/d-bar.yaml", "end: [0.3 s]"), ("gallery/x-joint.yaml", "base: [50 mm]")):
    model = f"{models}/{path}"
    reported = answer("equilibria", model)["equilibria"]
    stands = sorted((e for e in reported if e["outcome"] == "stands"), key=lambda e: e["energy"])
    table = run("equilibria", model, "--plot", "e.pdf").stdout
    listed = re.search(r"\n  equilibrium .*\n((?:  \S.*\n)*)", table)
    lines = listed.group(1).splitlines() if listed else []
    check(sorted(line.split()[0] for line in lines) == sorted(e["name"] for e in stands), f"{path}: table {lines}")
    if shutil.which("pdftotext"):
        text = subprocess.run(["pdftotext", "-layout", "e.pdf", "-"], capture_output=True, text=True).stdout
        count = re.search(r"(\d+) stable equilibri", text)
        check(count and int(count.group(1)) == len(stands), f"{path}: the figure has {count}, not {len(stands)}")
        for e in stands[:9]:
            milli = f"{1e3 * e['energy']:.6g}".replace("-", "\u2212")
            check(milli in text or milli.replace("\u2212", "-") in text or abs(e["energy"]) < 1e-9 or
                  abs(e["energy"]) >= 1, f"{path}: the figure lacks {milli} mJ of {e['name']}")
    write("states.yaml", f"strut: 1\nstudy: states\nmodel: {os.path.basename(path)}\ncompute: equilibria\naxes: [{{{axis}}}]\n"
          "keep: [stable_count, states, energies]\n")
    shutil.copy(model, ".")
    shutil.rmtree("states", ignore_errors=True)
    run("sweep", "states.yaml", "-o", "states", "--quiet")
    check(column("states/table.csv", "stable_count") == [str(len(stands))], f"{path}: sweep")
    for i, e in enumerate(stands[:3]):
        check(float(column("states/table.csv", f"energy_{i + 1}")[0]) == e["energy"], f"{path}: sweep")
        check(column("states/table.csv", f"state_{i + 1}")[0] == e["name"], f"{path}: sweep")
    compared = answer("compare", model, "--no-motion")["models"][0]["states"]
    check({s["name"]: s["energy"] for s in compared} == {e["name"]: e["energy"] for e in stands}, f"{path}: compare")
    run("view", model, "-o", "e.html")

# An accuracy that is not reached: a warning also when quiet, an exit code of its own, a column, a field, a line.
chaos = os.path.join(tests, "chaotic.yaml")
little = ("--accuracy", "0.2%", "--budget", "1")
answers(chaos, *little, code=5)
done = run("run", chaos, *little, "--quiet", "-o", "chaos", code=5)
check("strut: warning: the requested accuracy is NOT kept" in done.stderr and not done.stdout, done.stderr)
done = run("run", chaos, *little, code=5)
check(re.search(r"\n  accuracy +NOT kept: ", done.stdout), done.stdout)
reported = answer("run", chaos, *little, code=5)
check(reported["status"] == "completed" and not reported["accuracy"]["kept"], str(reported["accuracy"]))
check([w["code"] for w in reported["warnings"]] == ["accuracy"] and reported["worth"].startswith("NOT kept"), str(reported))
run("view", "chaos", "-o", "chaos.html")
check(b"NOT kept" in testing.read("chaos.html"), "the page does not say that the accuracy was not kept")
with open(chaos, encoding="utf-8") as file:
    scene = re.sub(r"solver: .*", "solver: {accuracy: 0.2 %, budget: 1}", file.read())
write("chaos.yaml", scene.replace("amplitude: 0.0369", "amplitude: push") + "parameters: {push: 0.0369}\n")
write("study.yaml", "strut: 1\nstudy: chaos\nmodel: chaos.yaml\naxes: [{push: [0.0369, 1e-3]}]\nkeep: [velocity]\n")
done = run("sweep", "study.yaml", "-o", "points", "--quiet", code=5)
check("1 of 2 points are less accurate than requested" in done.stderr and "NOT kept" in done.stderr, done.stderr)
check(run("sweep", "study.yaml", "-o", "points", "--quiet", code=5).stdout == "", "a sweep that is done already")
check(column("points/table.csv", "accuracy_kept") == ["0", "1"], str(column("points/table.csv", "accuracy_kept")))
check(column("points/table.csv", "status") == ["completed", "completed"], "a point that failed")
done = run("sweep", "--merge", "points", "--quiet", code=5)
write("search.yaml", "strut: 1\nstudy: best\nmodel: chaos.yaml\nsearch:\n  maximise: velocity\n"
      "  over: {push: {from: 0.0369, to: 0.037}}\n  evaluations: 3\nkeep: [velocity]\n")
run("sweep", "search.yaml", "-o", "best", "--quiet", code=5, err="the best point is less accurate than requested")

# What a number is worth stands in one plain line, with an accuracy and without.
line = re.search(r"\n  accuracy +(.*)\n", run("run", f"{models}/crawler/crawler.yaml").stdout).group(1)
check(line == "not known: fixed steps of rk4 pass over touchdowns and changes between sticking and "
      "slipping; --accuracy 1% estimates the error", line)
line = re.search(r"\n  accuracy +(.*)\n", run("run", "robot.yaml").stdout).group(1)
check(re.fullmatch(r"accurate to within 0\.\d+ % for this model; 1 % requested", line), line)
# Exit codes are listed where people look.
check("less accurate than requested" in run("help").stdout, "no exit code 5")
finish()

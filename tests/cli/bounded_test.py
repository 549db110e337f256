# SPDX-License-Identifier: GPL-3.0-or-later
# What a scene asks for is done soon, or refused by name at once: long profiles, runs that would not end, samples beyond
# the run, and structures at rest; and what killed processes leave goes, and hidden characters do not act on the terminal.
import itertools
import json
import math
import os
import pty
import random
import re
import resource
import subprocess

from testing import check, files_in, finish, stopped, strut, work, write


def run(*words, code=0):
    """The output, and the seconds of processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run([strut, *words], capture_output=True, text=True, cwd=work, timeout=600)
    check(done.returncode == code, f"{words}: exit code {done.returncode}: {done.stderr[-300:]}")
    return done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


MASS = """strut: 1
nodes: {w: {position: [0, 0], fixed: both}, b: {position: [1 m, 0], mass: 1 kg}}
members: {s: {kind: spring, nodes: [w, b], stiffness: STIFFNESS, damping: 0.1}}
initial: {velocities: {b: [0.1, 0]}}
"""


def profiles():
    """Checked in time that grows like the points, and run in about the same time."""
    def scene(name, count, height, method):
        points = ", ".join(f"[{x:.12g}, {height(x):.12g}]"
                           for x in (-100 + 200 * k / (count - 1) for k in range(count)))
        write(name, MASS.replace("STIFFNESS", "100 N/m").replace("fixed: both", "mass: 1 kg") +
              f"solver: {{integrator: {method}, step: 1 ms}}\nrun: {{duration: 1 s}}\ngravity: [0, -9.81]\n"
              f"ground: {{stiffness: 1e4, damping: 10, friction: {{mu: 0.3, stick_velocity: 10 mm/s}}, "
              f"profile: [{points}]}}\n")

    generator = random.Random(1)
    for name, height in (("hill", lambda x: -0.001 * x * x - 1), ("rough", lambda x: -1 + 1e-6 * generator.random())):
        scene(f"{name}.yaml", 100000, height, "rk4")
        _, seconds = run("check", f"{name}.yaml")
        check(seconds < 10, f"{name}: checked in {seconds:.2f} s")
    # Of a hill, on which a node touches one facet, whatever their number.
    for method in ("rk4", "rk4-events", "adaptive"):
        spent = {}
        for count in (100, 100000):
            scene("short.yaml", count, lambda x: -0.001 * x * x - 1, method)
            done, _ = run("run", "short.yaml")
            text = re.search(r"evaluations in ([\d.]+) (\w+)", done.stdout)
            spent[count] = float(text[1]) * {"us": 1e-6, "ms": 1e-3, "s": 1}[text[2]]
        check(spent[100000] < 20 * spent[100] + 0.2, f"{method}: {spent} s")


def endless_runs():
    for method in ("adaptive", "adaptive8"):
        write("stiff.yaml", MASS.replace("STIFFNESS", "1e30") + f"solver: {{integrator: {method}, step: 1 ms}}\n"
              "run: {duration: 1 s}\n")
        done, seconds = run("run", "stiff.yaml", code=3)
        check(f"{method} would take more than 1e+09 steps" in done.stderr and seconds < 5, done.stderr)
    write("rare.yaml", MASS.replace("STIFFNESS", "100 N/m") + "solver: {integrator: rk4, step: 1 ms}\n"
          "run: {duration: 1 s}\noutput: {every: 1e300 s, channels: [position]}\n")
    run("run", "rare.yaml", "-o", "rare")
    with open(os.path.join(work, "rare/nodes.csv"), encoding="utf-8") as file:
        times = [float(line.split(",")[0]) for line in file.readlines()[1:]]
    check(times == [0, 1], f"samples at {times}")


def accuracy_of_stiff_scenes():
    """What sets the step of fixed steps may never touch: it costs no accuracy's worth of them."""
    write("high.yaml", MASS.replace("STIFFNESS", "100 N/m") + "ground: {stiffness: 1e11, height: -1, damping: 1e4}\n"
          "solver: {step: 1 ms}\nrun: {duration: 20 s, measure: {quantities: {x: {of: b.x, take: max}}}}\n")
    for accuracy in ("2 %", "0.1 %"):
        done, _ = run("run", "high.yaml", "--accuracy", accuracy, "--json")
        answer = json.loads(done.stdout)
        check(answer["accuracy"]["kept"] and answer["accuracy"]["check_evaluations"] < 1e5, done.stdout[-600:])
    # A wheel of stiff, damped spokes rolls down a slope: adaptive takes 1.3e8 evaluations for a run to 1.18019 m/s.
    write("wheel.yaml", """strut: 1
gravity: [0, -9.8]
groups: {b: {kind: bar, stiffness: 1e7, damping: 1e4}}
parts: {spoke: {nodes: {hub: {position: [0, 0]}, f: {position: [0, -1], mass: 0.01}}, members: {s: {group: b, nodes: [hub, f]}}}}
place: {p: {part: spoke, at: [0, cos(20 deg)/cos(5 deg)], turn: 15 deg, repeat: {count: 9, turn: 40 deg, closed: yes,
  next: {merge: {hub: hub}, members: {r: {group: b, nodes: [f, next.f]}}}}}}
nodes: {p.0.hub: {mass: 1}}
ground: {slope: -5 deg, stiffness: 1e6, damping: 1e4, friction: {law: coulomb, mu: 2}, nodes: ["p.*.f"]}
initial: {velocities: {p.0.hub: [1.2, -0.1]}}
run: {duration: 20, measure: {last: 10, quantities: {v: {of: p.0.hub.vx/cos(5 deg), take: mean}}}}
""")
    answer = json.loads(run("run", "wheel.yaml", "--accuracy", "1 %", "--json")[0].stdout)
    check(answer["method"] == "implicit" and answer["accuracy"]["kept"] and answer["force_evaluations"] < 3e6 and
          abs(answer["measured"]["v"]["value"] / 1.18019 - 1) < 1e-3, str(answer)[-900:])


def killed():
    """A run that is killed while it writes leaves its stage, which the next one removes."""
    write("long.yaml", MASS.replace("STIFFNESS", "100 N/m") + "solver: {integrator: rk4, step: 1 us}\n"
          "run: {duration: 1000 s}\noutput: {every: 1 ms, channels: [position]}\n")
    write("brief.yaml", MASS.replace("STIFFNESS", "100 N/m") + "solver: {integrator: rk4, step: 1 ms}\n"
          "run: {duration: 1 s}\n")
    folder, looks = os.path.join(work, "killed"), itertools.count()  # 0.2 s of them
    stopped("run", "long.yaml", "-o", "killed", "--quiet",
            after=lambda: os.path.isdir(folder) and os.listdir(folder) and next(looks) > 100)
    check(any(name.startswith(".strut-stage") for name in os.listdir(folder)), "there is no stage")
    run("run", "brief.yaml", "-o", "killed", "--quiet")
    left = [name for name in files_in(folder) if name.startswith(".") or ".strut-" in name]
    check(not left, f"left: {left}")


def hidden():
    """A title that turns the direction of writing appears as its number in a terminal, and as it is in a pipe."""
    write("hidden.yaml", MASS.replace("STIFFNESS", "100 N/m") +
          'name: "b\u202e"\nsolver: {step: 1 ms}\nrun: {duration: 1 s}\n')
    try:
        ours, theirs = pty.openpty()
    except OSError:
        print("no terminals here: hidden characters are not tested")
        return
    process = subprocess.Popen([strut, "run", "hidden.yaml"], cwd=work, stdout=theirs, stderr=theirs)
    shown = b""
    os.close(theirs)
    try:
        while part := os.read(ours, 4096):
            shown += part
    except OSError:
        pass  # the other end is closed
    process.wait()
    check("\u202e" not in shown.decode() and "b\\u202E" in shown.decode(), shown.decode())
    done, _ = run("run", "hidden.yaml")
    check("b\u202e" in done.stdout, done.stdout)
    done, _ = run("check", "hidden.yaml", "--set", "x=1", code=2)
    write("hidden.yaml", 'strut: 1\nnodes: {"a\u202e": {position: [0, 0], mas: 1}}\n')
    done, _ = run("check", "hidden.yaml", code=2)
    check("\u202e" not in done.stderr and "did you mean 'mass'" in done.stderr, done.stderr)


def at_rest():
    """A smaller tolerance costs no more where nothing moves: rounding has no speed to be compared with."""
    for feet in (2, 12):  # in registers, and by the general kernel
        nodes = {f"f{k}": [k, 0] for k in range(feet)} | {f"t{k}": [k + 0.5, 0.8] for k in range(feet)}
        bars = [(f"f{k}", f"t{k}") for k in range(feet)] + [(f"t{k}", f"f{k + 1}") for k in range(feet - 1)]
        bars += [(f"{row}{k}", f"{row}{k + 1}") for row in "ft" for k in range(feet - 1)]
        scene = {"strut": 1, "gravity": [0, -9.81], "nodes": {n: {"position": at, "mass": 1} for n, at in nodes.items()},
                 "members": {a + b: {"kind": "bar", "nodes": [a, b], "stiffness": 5e3, "damping": 5} for a, b in bars},
                 "ground": {"stiffness": 1e4, "damping": 50, "friction": {"law": "coulomb", "mu": 0.3}},
                 "initial": {"settle": True}, "run": {"duration": 2}, "solver": {"step": 0.01}}
        write("rest.yaml", json.dumps(scene))
        for method in ("adaptive", "adaptive8"):
            costs = []
            for tolerance in ("1e-4", "1e-12"):
                done, _ = run("run", "rest.yaml", "--integrator", method, "--tolerance", tolerance, "--json")
                answer = json.loads(done.stdout)
                costs.append(answer["force_evaluations"])
                check(abs(answer["velocity"]) < 1e-11, f"{method}, {tolerance}: velocity {answer['velocity']}")
            check(costs[1] <= 1.5 * costs[0] < 2e5, f"{method}, {feet} feet at rest: {costs} evaluations")


def hubs():
    """A hub's matrix column costs in proportion to its spokes, whatever their order."""
    for turned in (False, True):
        seconds = []
        for count in (10000, 40000):
            nodes = {"hub": {"position": [0, 0], "mass": 1}}
            nodes |= {f"n{k}": [round(math.cos(k), 6), round(math.sin(k), 6)] for k in range(count)}
            spokes = [(f"m{k}", {"kind": "spring", "nodes": ["hub", f"n{k}"], "stiffness": 1, "mass": 1e-3})
                      for k in (range(count - 1, -1, -1) if turned else range(count))]
            write("star.yaml", json.dumps({"strut": 1, "nodes": nodes, "members": dict(spokes),
                                           "solver": {"step": 1e-3}, "run": {"duration": 2e-3}}))
            seconds.append(run("check", "star.yaml")[1])
        check(seconds[1] < 8 * seconds[0] + 0.5, f"hubs of 10,000 and 40,000 spokes: {seconds} s")


profiles()
hubs()
at_rest()
endless_runs()
accuracy_of_stiff_scenes()
killed()
hidden()
finish()

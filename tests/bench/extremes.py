#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What does each method do at the extremes? Small scenes whose exact answer is a closed form.

  tests/bench/extremes.py STRUT [--write] [--quick] [ROW...]

Prints a table with a column for each method and one for `--accuracy 0.1%`. ROW names kinds of rows (ROWS);
--quick takes a few that need seconds; --write puts the rows into the table docs/extremes.txt (ten minutes for
all). Cells:

  E           holds: the error E is within the bound of the row
  warns E     with a warning (WARNINGS), a caveat, or an accuracy that is not kept
  unknown E   the bound is above 10 %, E is within it, and the summary says "not known"
  stops       the run ended with an error
  refuses     the run did not begin
  too long    more than 60 s of CPU time, or 2e9 steps
  WRONG E     anything else

Bounds follow from the order of a method and its step, before anything is run (`phase_error`, and `bound` of
each scene); of `adaptive` from its tolerance and the steps that it took. An error is relative to the
amplitude, distance or mean force. Reasons go to stderr. Exit code 1 where a cell is WRONG.
"""
import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
from typing import Callable

TABLE = pathlib.Path(__file__).parents[2] / "docs" / "extremes.txt"
METHODS = ["rk4", "euler", "verlet", "rk4-events", "euler-events", "verlet-events", "adaptive", "adaptive8", "midpoint"]
FORCES = {"adaptive": 6, "adaptive8": 13}  # per step
COLUMNS = METHODS + ["--accuracy 0.1%"]
TOLERANCE, PROMISE = 1e-9, 1e-3  # of adaptive and of --accuracy
CPU_SECONDS, MOST_STEPS = 60, 2e9
KNOWN, ROUNDING = 0.1, 1e-9  # a bound above KNOWN says nothing about a result
WARNINGS = ("accuracy", "energy_balance", "stick_band", "step_limit")


@dataclasses.dataclass
class Case:
    """One scene for one method, with the exact value of the measured quantity `x`."""
    scene: dict
    duration: float
    step: float
    of: str
    exact: float
    scale: float  # of errors
    bound: Callable  # of the error, from the number of steps, which adaptive chooses itself
    take: str = "final"
    unit: str = "m"
    options: tuple = ()


def base(method):
    return method.split("-")[0]


def phase_error(method, z, steps, size=1.0):
    """Error of an oscillation after steps with z = step times rad/s, relative to its amplitude.

    Phase: exact for verlet, euler and midpoint, leading terms for rk4, which also loses amplitude; euler's
    velocities are half a step off. `size` is a hundredth of the structure's size over the amplitude, at
    least 1, since `adaptive` compares its error per step with that and with the velocity.
    """
    if base(method) == "rk4":
        return steps * (z**5 / 120 + z**6 / 144)
    if method.startswith("adaptive"):
        return size * TOLERANCE * steps
    if method == "midpoint":
        return steps * (z - 2 * math.atan(z / 2))
    return steps * (2 * math.asin(min(1, z / 2)) - z) + (z / 2 if base(method) == "euler" else 0)


def energy_error(method, z, steps):
    """Error of an oscillator's energy, relative to it: rk4's grows, those of verlet and euler come and go."""
    if method.startswith("adaptive"):
        return 2 * TOLERANCE * steps
    return {"rk4": steps * z**6 / 72, "verlet": z**2 / 4, "euler": z / 2}.get(base(method), 0)


def modal_bound(method, step, modes, size):
    """Twice the errors of modes [(rad/s, share of the amplitude)], none of them above its whole range."""
    return lambda steps: ROUNDING + 2 * sum(abs(share) * min(2, phase_error(method, w * step, steps, size))
                                            for w, share in modes)


def whole(duration, step):
    """The largest step up to `step` that divides the duration."""
    return duration / math.ceil(duration / step * (1 - 1e-12))


def row_of_masses(masses, springs, start):
    """A row of masses 1 m apart along x, each on a spring to the one before, the first to a wall."""
    nodes = {"n0": {"position": [0, 0], "fixed": "both"}}
    members = {}
    for i, (mass, stiffness) in enumerate(zip(masses, springs), 1):
        nodes[f"n{i}"] = {"position": [i, 0], "mass": mass, "fixed": "y"}
        members[f"s{i}"] = {"kind": "spring", "nodes": [f"n{i - 1}", f"n{i}"], "stiffness": stiffness, "rest_length": 1}
    positions = {f"n{i}": [i + x, 0] for i, x in enumerate(start, 1)}
    return {"strut": 1, "nodes": nodes, "members": members, "initial": {"positions": positions}}


def two_masses(method, k1, m2, start):
    """Wall - k1 - 1 kg - 1 N/m - m2, both modes, for a quarter of the slow period; the second mass counts."""
    total, product = k1 + 1 + 1 / m2, k1 / m2
    fast = (total + math.sqrt(total**2 - 4 * product)) / 2
    slow = product / fast
    r1, r2 = 1 / (k1 + 1 - slow), 1 / (1 - fast * m2)  # x1/x2 of the slow mode, x2/x1 of the fast one
    a = (start[1] - r2 * start[0]) / (1 - r1 * r2)
    b = start[0] - r1 * a
    modes = [(math.sqrt(slow), a / 0.25), (math.sqrt(fast), b * r2 / 0.25)]
    duration = math.pi / 2 / math.sqrt(slow)
    step = duration / 100
    if method in METHODS[:6]:  # half the largest stable step of verlet, 0.35 of that of rk4
        step = whole(duration, min(step, 1 / math.sqrt(fast)))
    exact = 2 + 0.25 * sum(share * math.cos(w * duration) for w, share in modes)
    return Case(row_of_masses([1, m2], [k1, 1], start), duration, step, "n2.x", exact, 0.25,
                modal_bound(method, step, modes, 1))


def stiffness(method, ratio):
    return two_masses(method, ratio, 1, (0, 0.25))


def mass(method, ratio):
    return two_masses(method, 1, ratio, (0.25, 0.25))


def friction(method, mu):
    """A block that slides at 1 m/s for 1 s or until it stops. Exact friction for methods with events."""
    g, k, speed, band, step = 9.81, 1e5, 1, 1e-4, 1e-4
    events = "events" in method or method in ("adaptive", "adaptive8", COLUMNS[-1])
    time = min(1, speed / (mu * g)) if mu else 1
    way = speed * time - mu * g * time**2 / 2
    if not events:  # stops up to a step late, and keeps the speed with which it enters the band
        error = (speed * step + band * (1 - time)) / way if time < 1 else ROUNDING + mu * g * step
    elif method == "euler-events":
        error = mu * g * step / speed
    else:  # the motion is a parabola, which these follow
        error = 1e-6
    law = {"law": "coulomb", "mu": mu} if events else {"law": "karnopp", "mu": mu, "stick_velocity": band}
    scene = {"strut": 1, "gravity": [0, -g], "nodes": {"n": {"position": [0, -g / k], "mass": 1}},
             "ground": {"stiffness": k, "damping": 100, "friction": law}, "initial": {"velocity": [speed, 0]}}
    return Case(scene, 1, step, "n.x", way, way, lambda steps: ROUNDING + error)


def oscillator(method, periods, step, energy=False, options=()):
    """1 kg on 1 N/m, 0.25 m from its rest, for whole periods and an eighth."""
    duration = 2 * math.pi * (periods + 0.125)
    exact, scale = (0.25**2 / 2, 0.25**2 / 2) if energy else (1 + 0.25 * math.sqrt(0.5), 0.25)
    scene = row_of_masses([1], [1], [0.25])
    if energy:
        return Case(scene, duration, step, "energy.total", exact, scale, unit="J",
                    bound=lambda steps: 1e-6 + 2 * energy_error(method, step, steps))
    return Case(scene, duration, step, "n1.x", exact, scale, modal_bound(method, step, [(1, 1)], 1), options=options)


def steps(method, part, options=()):
    """100 periods with a part of the limit; adaptive and midpoint, which have none, take that of verlet."""
    return oscillator(method, 100, part * (math.sqrt(8) if base(method) == "rk4" else 2), options=options)


def forced(method, part):
    return steps(method, part, ("--force",) if method in METHODS else ())


def energy(method, periods):
    return oscillator(method, periods, 2 * math.pi / 100, energy=True)


def phase(method, periods):
    """With the step at which the order of the method predicts a phase error of 0.04 rad."""
    angle = 2 * math.pi * periods
    second = math.sqrt(0.04 * 24 / angle)
    step = {"rk4": (0.04 * 120 / angle)**0.25, "euler": second, "verlet": second,
            "midpoint": second / math.sqrt(2)}.get(base(method), 2 * math.pi / 8)
    return oscillator(method, periods, step)


def events(method, rate):
    """A node between two walls for 1 s, each contact with a touchdown and a lift-off: their mean force."""
    gap, touch = 1.5 / rate, 0.5 / rate  # at 1 m/s: flight and contact take 2 / rate
    w = math.pi / touch
    wall = {"stiffness": w**2, "nodes": ["n"]}
    scene = {"strut": 1, "nodes": {"n": {"position": [0, gap / 2], "mass": 1}},
             "grounds": {"floor": {"height": 0, **wall}, "ceiling": {"through": [0, gap], "normal": [0, -1], **wall}},
             "initial": {"velocity": [0, 1]}}
    z = 0.05
    step = whole(1, z / w)  # a quarter of the steps are in contact; 2 / rate: the window may cut a contact
    return Case(scene, 1, step, "n.normal", rate, rate, take="mean", unit="N",
                bound=lambda steps: 2 / rate + 2 * energy_error(method, z, steps / 4))


def nodes(method, count):
    """A chain between two walls, for 5/4 periods of the standing wave with a tenth of the highest frequency."""
    number = round(2 * (count + 1) / math.pi * math.asin(0.1))
    angle = number * math.pi / (count + 1)
    w = 2 * math.sin(angle / 2)
    scene = row_of_masses([1] * count, [1] * count, [0.25 * math.sin(i * angle) for i in range(1, count + 1)])
    scene["nodes"]["wall"] = {"position": [count + 1, 0], "fixed": "both"}
    scene["members"]["last"] = {"kind": "spring", "nodes": [f"n{count}", "wall"], "stiffness": 1, "rest_length": 1}
    middle = round((number // 2 + 0.5) * math.pi / angle)  # an antinode
    duration = 1.25 * 2 * math.pi / w
    step = whole(duration, 0.4)  # 0.4 of verlet's limit
    return Case(scene, duration, step, f"n{middle}.x", middle, 0.25,
                modal_bound(method, step, [(w, math.sin(middle * angle))], 0.04 * count))


# kind: title, function, values, values of --quick
ROWS = {
    "stiffness": ("stiffness ratio {}", stiffness, ["1e-6", "1", "1e4", "1e8", "1e12"], ["1e4"]),
    "mass": ("mass ratio {}", mass, ["1e-6", "1e-3", "1e3", "1e6"], ["1e-3", "1e6"]),
    "friction": ("friction {}", friction, ["0", "1e-3", "1", "1e3", "1e6"], ["0", "1e6"]),
    "steps": ("step {} of the limit", steps, ["0.2", "0.5", "0.9", "1", "1.05", "1.1"], ["0.2", "1", "1.1"]),
    "forced": ("step {}, `--force`", forced, ["1.1"], ["1.1"]),
    "events": ("{} events/s", events, ["1e5"], ["1e3"]),
    "nodes": ("{} nodes", nodes, ["1e5"], ["1e3"]),
    "energy": ("{} periods, energy", energy, ["1e6"], ["1e3"]),
    "phase": ("{} periods, position", phase, ["1e6"], []),
}


def judge(strut, folder, kind, value, method):
    """The verdict of one cell, and the reason."""
    case = ROWS[kind][1](method, int(float(value)) if kind == "nodes" else float(value))
    if method in METHODS and case.duration / case.step > MOST_STEPS:
        return "too long", f"{case.duration / case.step:.1e} steps"
    quantity, words = {"of": case.of, "take": case.take}, ["--integrator", method]
    if method.startswith("adaptive"):
        words += ["--tolerance", repr(TOLERANCE)]
    elif method not in METHODS:
        quantity["accuracy"] = f"{PROMISE * case.scale!r} {case.unit}"
        words = ["--accuracy", repr(PROMISE)]
    case.scene["solver"] = {"step": case.step}
    case.scene["run"] = {"duration": case.duration, "measure": {"last": case.duration, "quantities": {"x": quantity}}}
    file = folder / f"{kind}-{value}-{method.split()[0]}.yaml"
    file.write_text(json.dumps(case.scene), encoding="utf-8")
    done = subprocess.run(["sh", "-c", f'ulimit -t {CPU_SECONDS}; exec "$@"', "sh", strut, "run", str(file), "--json",
                           "--threads", "1", *words, *case.options], capture_output=True, text=True, check=False)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return "too long", f"more than {CPU_SECONDS} s of CPU time"
    if done.returncode in (1, 3) and done.stderr:
        return ("stops" if '"status":\t"diverged"' in done.stdout else "refuses"), done.stderr.strip()
    if done.returncode not in (0, 5):
        return "WRONG", f"exit code {done.returncode}: {done.stderr.strip()}"
    return verdict(case, method, json.loads(done.stdout))


def verdict(case, method, found):
    got = found["measured"]["x"]["value"]
    error = math.inf if got is None else abs(got - case.exact) / case.scale
    bound = case.bound(found["force_evaluations"] / FORCES[method] if method in FORCES else found["steps"])
    short = re.sub(r"e([+-])0*", lambda sign: "e" + sign[1].strip("+"), f"{error:.1g}")
    words = [warning["text"] for warning in found["warnings"] if warning["code"] in WARNINGS]
    words += [found["caveat"]] if found["caveat"] else []
    if method not in METHODS:
        bound = PROMISE
        words += [] if found["accuracy"]["kept"] else [found["accuracy"]["why"]]
    text = f"got {got!r}, exactly {case.exact!r}: error {error:.2g}, bound {bound:.2g}"
    if words:
        return f"warns {short}", "; ".join([text, *words])
    if error <= bound <= KNOWN:
        return short, text
    return ("unknown " if error <= bound and found["worth"].startswith("not known") else "WRONG ") + short, text


def main():
    flags = [word for word in sys.argv[2:] if word.startswith("--")]
    kinds = [word for word in sys.argv[2:] if word not in flags] or list(ROWS)
    quick = "--quick" in flags
    rows = [(kind, value) for kind in kinds for value in ROWS[kind][3 if quick else 2]]
    lines = ["| extreme | " + " | ".join(COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
    wrong = 0
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        strut = os.path.abspath(sys.argv[1])
        cells = {(row, method): pool.submit(judge, strut, pathlib.Path(name), *row, method)
                 for row in rows for method in COLUMNS}
        for row in rows:
            results = [cells[row, method].result() for method in COLUMNS]
            for method, (cell, why) in zip(COLUMNS, results):
                print(f"{row[0]} {row[1]} {method}: {cell}: {why}", file=sys.stderr, flush=True)
                wrong += cell.startswith("WRONG")
            lines.append("| " + " | ".join([ROWS[row[0]][0].format(row[1])] + [cell for cell, _ in results]) + " |")
    print("\n".join(lines))
    if "--write" in flags and not quick:
        known = {line.split(" | ")[0]: line for line in TABLE.read_text(encoding="utf-8").splitlines() + lines}
        titles = ["| " + title.format(value) for title, _, values, _ in ROWS.values() for value in values]
        table = lines[:2] + [known[title] for title in titles]
        TABLE.write_text("\n".join(table) + "\n", encoding="utf-8")
    print(f"{len(lines) - 2} rows, {wrong} cells WRONG")
    return int(wrong > 0)


sys.exit(main())

# SPDX-License-Identifier: GPL-3.0-or-later
"""strut tradeoff: errors against closed forms, fronts and percentiles once more, its files."""
import json
import math
import os
import re
import statistics
import sys

import testing
from testing import check, fail, files_in, finish, models, needs, path, write

needs("numpy")
import numpy  # noqa: E402

slower = int(sys.argv[2]) if len(sys.argv) > 2 else 1
OSCILLATOR, BALL, BLOCK, PENDULUM = (
    f"{models}/basics/{name}.yaml" for name in ("oscillator", "bouncing-node", "sliding-block", "pendulum"))
CRAWLER, TWO = f"{models}/crawler/crawler.yaml", f"{models}/gallery/two-mass-crawler.yaml"
HOPPER = os.path.realpath("tests/cli/hopper.yaml")


def run(*words, **how):
    """Times after --cpu-time are as much longer as this build is slower (sanitizers)."""
    longer = [re.sub(r"^\d+(?= s$)", lambda seconds: str(slower * int(seconds[0])), word) for word in words]
    return testing.run("tradeoff", *longer, timeout=600 * slower, **how)


def read(*words):
    return json.loads(run(*words, "--json").stdout)


def without_clock(answer):
    """The answer but for the time that the computation took."""
    answer = json.loads(json.dumps(answer))
    del answer["spent_seconds"], answer["base_seconds"]
    for setting in answer["settings"]:
        del setting["cpu"], setting["seconds"]
    return answer


def infinite(values):
    return [math.inf if v is None else v for v in values]


def close(a, b, relative=1e-12):
    return a == b or math.isclose(a, b, rel_tol=relative)


def check_spreads(what, answer):
    for row in answer["settings"]:
        for kind in ("step_error", "total_error"):
            reported = row[kind]
            points = infinite(reported["points"])
            wanted = [statistics.median(points), numpy.percentile(points, 90, method="inverted_cdf"), max(points)]
            found = infinite([reported["median"], reported["percentile_90"], reported["worst"]])
            check(all(map(close, wanted, found)), f"{what}: {row['group']} {row['step']}: {kind} {found}, not {wanted}")
        check(row["diverged"] == row["step_error"]["points"].count(None),
              f"{what}: {row['group']} {row['step']} does not count what diverged")


def check_front(what, answer):
    """A setting is on the front of its model unless another is no worse in both, better in one."""
    for row in answer["settings"]:
        cost, error = row["evaluations"], row["step_error"]["worst"]
        others = [(r["evaluations"], r["step_error"]["worst"]) for r in answer["settings"]
                  if r["model"] == row["model"] and r["step_error"]["worst"] is not None]
        wanted = error is not None and not any(c <= cost and e <= error and (c < cost or e < error) for c, e in others)
        check(row["front"] == wanted, f"{what}: {row['group']} {row['step']}: front is {row['front']}")


def check_advice(what, answer):
    """The cheapest stable one whose group keeps the error from there on down, for one more at least."""
    own = [r for r in answer["settings"] if r["model"] == answer["models"][0]["name"]]
    for advice in answer["advice"]:
        keepers = []
        for row in own:
            finer = [r for r in own if r["group"] == row["group"] and
                     (r["tolerance"] <= row["tolerance"] if row["tolerance"] is not None else r["step"] <= row["step"])]
            if len(finer) > 1 and not row["above_limit"] and all(
                    r["total_error"]["worst"] is not None and
                    r["total_error"]["worst"] <= advice["error"] for r in finer):
                keepers.append(row["evaluations"])
        reported = advice["setting"]
        cost = None if reported is None else answer["settings"][reported]["evaluations"]
        check(cost == min(keepers, default=None),
              f"{what}: advice for {advice['error']} is {reported}, costs that keep it: {keepers}")


def check_errors(what, answer):
    """Velocities: errors from values, reference and floor."""
    for row in answer["settings"]:
        model = next(m for m in answer["models"] if m["name"] == row["model"])
        own = answer["models"][0]
        for p, value in enumerate(row["values"]):
            for kind, m in (("step_error", model), ("total_error", own)):
                reported, reference = row[kind]["points"][p], m["values"][p]
                wanted = None if value is None else max(
                    abs(value - reference) / max(abs(reference), answer["scale"]), m["floor"]["points"][p])
                check(reported == wanted or (reported and wanted and close(reported, wanted, 1e-9)),
                      f"{what}: {row['group']} {row['step']}: {kind} {reported}, not {wanted}")


# ---- A mass on a spring: x = 1 + a Re R(i w h)^n for RK4, 1 + a cos(n acos(1 - z^2/2)) for Verlet.
answer = read(OSCILLATOR)
w, a, size = 10.0, 0.01, 1.0
floor = answer["models"][0]["floor"]["worst"]
reference = answer["models"][0]["values"][2]
# Its end is where the cosine vanishes.
check(abs(reference - 1) <= max(floor, 1e-13) and 0 <= floor < 1e-9,
      f"the oscillator ends at {reference}, floor {floor}")
for row in answer["settings"]:
    n = round(answer["duration"] / row["step"])
    z = w * answer["duration"] / n
    if row["method"] == "rk4":
        value, per_step = ((1 + 1j * z - z**2 / 2 - 1j * z**3 / 6 + z**4 / 24) ** n).real, 4
    elif row["method"] == "verlet" and z < 2:
        value, per_step = math.cos(n * math.acos(1 - z * z / 2)), 1
    else:
        continue
    what, error = f"{row['group']} at {row['step']}", row["step_error"]["worst"]
    wanted = max(a * abs(value) / size, floor)
    if error is None or error > 1:
        check(abs(value) * a >= 1, f"{what} diverged")
    else:
        check(abs(error - wanted) <= 2 * floor + 1e-9 * wanted + 1e-13, f"{what}: {error}, not {wanted}")
    ratio = n * per_step / answer["base_evaluations"]
    check(abs(row["evaluations"] / ratio - 1) <= 2 / n, f"{what} costs {row['evaluations']}, not {ratio}")
steps = [r["step"] for r in answer["settings"] if r["method"] == "rk4"]
check(any(h > 2.828 / w for h in steps) and sum(h < 2.829 / w for h in steps) >= 8,
      f"rk4's steps {steps} do not lie on both sides of its limit")
check(any(r["diverged"] and r["step_error"]["worst"] is None for r in answer["settings"]),
      "nothing diverged above the limit")
check_front("oscillator", answer)
check_advice("oscillator", answer)
check(not any(r["method"].endswith("-events") for r in answer["settings"]),
      "methods with events in a scene without any")

# ---- The energy of the same: R R* to the n-th, no reference needed.
answer = read(OSCILLATOR, "--measure", "energy", "--integrator", "rk4")
for row in answer["settings"]:
    n = round(answer["duration"] / row["step"])
    z = 10.0 * answer["duration"] / n
    gain = abs((1 - z**6 / 72 + z**8 / 576) ** n - 1)
    found = row["step_error"]["worst"]
    check(found is None or z >= 1 or 0.2 * gain < found < 5 * gain + 1e-14,
          f"energy at {row['step']}: {found}, of the order of {gain}")

# ---- Contact, drawn at random: everything once more from the values. Twice the same bits.
words = (HOPPER, "--vary", "stiffness=(300 N/m)..(0.5 kN/m)", "--points", "11",
         "--seed", "7", "--step-sizes", "3", "--own-model")
answer = read(*words)
for judge in (check_spreads, check_errors, check_front, check_advice):
    judge("ball", answer)
drawn = [p["stiffness"] for p in answer["points"]]
check(len(set(drawn)) == 11 and all(300 <= k <= 500 for k in drawn), f"stiffnesses {drawn}")
check(sum(r["base"] for r in answer["settings"]) == 1, "there is not one base")
base = answer["settings"][answer["base_setting"]]
check(base["method"] == "rk4" and base["evaluations"] == 1 and base["base"], f"the base is {base}")
check(without_clock(read(*words)) == without_clock(answer), "the same seed gives something else")
check(read(*words[:-4], "8", *words[-3:])["points"] != answer["points"], "another seed gives the same points")

# ---- Words are drawn too; other models of a block that slides.
answer = read(BLOCK, "--step-sizes", "3", "--vary", "mu=0.2,0.3", "--points", "6")
check({round(p["mu"], 9) for p in answer["points"]} == {0.2, 0.3}, f"words: {answer['points']}")
names = [m["name"] for m in answer["models"]]
check(names[0] == "unchanged model" and "Coulomb friction" in names, f"models of a block: {names}")
coulomb = answer["models"][names.index("Coulomb friction")]
for point, value in zip(answer["points"], coulomb["values"]):
    # Way to the stop, in a second: v^2 / (2 mu g).
    check(close(value, 1 / (2 * point["mu"] * 9.81), 1e-6), f"Coulomb's block at mu {point['mu']}: {value}")

# ---- Files: all of them or none; the same numbers as in the answer.
done = run(BALL, "--step-sizes", "4", "-o", "deep/out", "--own-model")
names = sorted(files_in(path("deep/out")))
check(names == ["tradeoff.csv", "tradeoff.json", "tradeoff.svg"], f"files: {names}")
check("cheapest setting" in done.stdout and re.search(r"^ *0.5 % ", done.stdout, re.M),
      f"the table lacks something: {done.stdout}")
before = [testing.read("deep/out", name) for name in names]
table, written = testing.rows("deep/out/tradeoff.csv"), json.loads(before[1])
check(len(table) == len(written["settings"]), f"{len(table)} rows of {len(written['settings'])} settings")
for row, setting in zip(table, written["settings"]):
    error, = infinite([setting["step_error"]["worst"]])
    check((float(row["step [s]"]), row["group"], float(row["error worst"])) ==
          (setting["step"], setting["group"], error), f"{row} and {setting} differ")
check(b"</svg>" in before[2], "half a picture")
steps = re.findall(r">([\d.]+ .?s(?:, [^<]*)?)</t>", before[2].decode())  # of the front: equal ones with their methods
front = sum(s["front"] and s["model"] == written["settings"][0]["model"] for s in written["settings"])
check(steps and len(set(steps)) == len(steps) <= front, f"labels {steps} of {front} settings on the front")
os.makedirs(path("blocked/tradeoff.svg"))
done = run(BALL, "--step-sizes", "1", "-o", "blocked", code=4)
check(not done.stdout and files_in(path("blocked")) == ["tradeoff.svg"],
      f"a blocked file: {done.stdout} {files_in(path('blocked'))}")
run(BALL, "--integrator", "rk5", "-o", "deep/out", code=1)
check(before == [testing.read("deep/out", name) for name in names], "a refusal changed files")
run(BALL, "--step-sizes", "1", "-o", "/dev/full/x", code=4)

# ---- An accuracy: the recommended setting, run as the report writes it, keeps the error, against a much
# finer run by another method; it is the cheapest measured, and half the error lies on the measured curve.
def measure(file, *words):
    return testing.answer("run", file, "--quiet", *words)["velocity"]


def promise(answer, i):
    """The largest error of a setting and all finer ones of its group, and the cost."""
    row = answer["settings"][i]
    finer = [r for r in answer["settings"] if r["group"] == row["group"] and r["model"] == row["model"] and
             (r["tolerance"] or 0) <= (row["tolerance"] or 0) and (row["tolerance"] or r["step"] <= row["step"])]
    return max(infinite(r["total_error"]["worst"] for r in finer))


def check_half(what, answer):
    advice = answer["advice"][0]
    if advice["half_setting"] is None or advice["half_setting"] == advice["setting"]:
        wanted = None if advice["half_setting"] is None else 1
        return advice["half_cost"] == wanted or fail(f"{what}: half costs {advice['half_cost']}, not {wanted}")
    fine = answer["settings"][advice["half_setting"]]
    key = "step" if fine["tolerance"] is None else "tolerance"
    coarse = min((i for i, r in enumerate(answer["settings"]) if r["group"] == fine["group"] and
                  r["model"] == fine["model"] and r[key] > fine[key]),
                 key=lambda i: answer["settings"][i][key])
    (x, a), (y, b) = [(math.log(promise(answer, i)), math.log(answer["settings"][i]["evaluations"]))
                      for i in (coarse, advice["half_setting"])]
    slope = (b - a) / (y - x) if x > y else 0.0  # where the coarser one is as good: the cost of the finer one
    cost = math.exp(b + slope * (math.log(advice["error"] / 2) - y))
    wanted = max(1, cost / answer["settings"][advice["setting"]]["evaluations"])
    check(close(wanted, advice["half_cost"], 1e-9), f"{what}: half costs {advice['half_cost']}, not {wanted}")


for file, accuracy in ((BLOCK, "1e-4"), (HOPPER, "0.1%"), (HOPPER, "1e-6"), (TWO, "2%"), (TWO, "0.1%")):
    what, words = f"{file} to {accuracy}", (file, "--accuracy", accuracy, "--own-model", "--measure", "velocity")
    report, answer = run(*words).stdout, read(*words)
    solver = re.search(r"(solver: {.*})", report)
    if not solver:
        fail(f"{what}: no recommendation: {report[-800:]}")
        continue
    check_advice(what, answer)
    check_half(what, answer)
    advice, wanted = answer["advice"][0], eval(accuracy.replace("%", "/100"))
    row = answer["settings"][advice["setting"]]
    with open(file, encoding="utf-8") as text:
        write("model.yaml", re.sub(r"(?m)^solver: .*$", solver[1], text.read()))
    other = ("rk4-events", f"{row['step'] / 2048} s") if row["method"] == "adaptive" else ("adaptive", "1 ms")
    fine = measure(file, "--integrator", other[0], "--step", other[1], "--tolerance", "1e-11")
    error = abs(measure("model.yaml") - fine) / max(abs(fine), answer["scale"])
    floor = answer["models"][0]["floor"]["worst"]
    check(error <= wanted and abs(error - row["step_error"]["worst"]) <= 3 * floor + 1e-3 * wanted,
          f"{what}: {solver[1]} is {error} off, reported {row['step_error']['worst']}")
    check(advice["known"] and floor <= 0.01 * wanted, f"{what}: floor {floor}")
    # The work is bounded, and counts all that is reported.
    work = answer["work"]
    least = answer["base_evaluations"] * sum(r["evaluations"] for r in answer["settings"] if not r["diverged"])
    check(least <= work["evaluations"] <= 30 * work["unit"] and work["limit"] == 30 and not work["cut_by_time"],
          f"{what}: work {work}, of which settings {least}")
    # The same numbers again, with another limit of CPU time too.
    again = read(*words, "--cpu-time", "5000 s")
    check(without_clock(again) == without_clock(answer), f"{what}: two reports differ: {answer} {again}")

# ---- What the reference does not tell is not claimed; a limit of time that cuts is reported.
done = run(OSCILLATOR, "--accuracy", "1e-15")
check("not known: the references differ by more" in done.stdout, f"1e-15: {done.stdout[-500:]}")
done = run(OSCILLATOR, "--accuracy", "1e-6", "--measure", "energy", "--integrator", "rk4")
check("solver: {integrator: rk4, step: " in done.stdout, f"energy: {done.stdout[-500:]}")
done = run(CRAWLER, "--accuracy", "1%", "--cpu-time", "2 s")
check("cut by --cpu-time" in done.stdout, f"a cut study: {done.stdout[-500:]}")
check("cut by --cpu-time" not in run(OSCILLATOR, "--accuracy", "1%").stdout, "a short study is cut")


# ---- Rigid bars of a pendulum vibrate nowhere: no limit says how long a step makes sense, and the
# answer is still that of the stiff ones, nearly. They are a bargain: steps of a tenth of a second.
found = read(PENDULUM, "--integrator", "rk4", "--step-sizes", "3", "--cpu-time", "6 s")
rigid = [model for model in found["models"] if model["name"] == "rigid bars"]
check(len(rigid) == 1 and rigid[0]["model_error"]["worst"] < 1e-3,
      f"rigid bars of a pendulum change the answer: {rigid}")
longest = max([r["step"] for r in found["settings"] if r["model"] == "rigid bars"], default=0)
check(longest >= 0.02 * found["duration"], f"rigid bars of a pendulum step by {longest} at most")

# ---- A method that no step is too long for begins at a hundred times the explicit limit, here
# sqrt(8) / sqrt(3 k / m), and comes down to it.
found = read(PENDULUM, "--set", "stiffness=1e8 N/m", "--integrator", "rk4,midpoint",
             "--step-sizes", "8", "--cpu-time", "6 s", "--own-model")
limit = math.sqrt(8) / math.sqrt(3 * 1e8)
steps = [r["step"] / limit for r in found["settings"] if r["method"] == "midpoint"]
check(80 < max(steps) < 100 and 0.8 < min(steps) < 2, f"midpoint's steps are {steps} times the explicit limit")
for row in found["settings"]:
    error = row["step_error"]["worst"]
    check(row["method"] != "midpoint" or error < 0.01 * (row["step"] / limit / 95) ** 1.9,
          f"midpoint at {row['step']}: {error}")

# ---- Other models are offered where a scene has what they change, and bars that are driven cannot be
# rigid. What one costs does not take it from the others: every one of them is run.
for file, wanted, *words in (
        (CRAWLER, ["lumped masses", "rigid bars", "Hunt-Crossley ground",
                                         "Coulomb friction", "smooth friction"], "--cpu-time", "5 s"),
        (BALL, ["Hunt-Crossley ground"], "--cpu-time", "1 s"),
        (TWO, ["Coulomb friction", "smooth friction"],
         "--cpu-time", "3 s", "--set", "step=50 us", "--set", "band=1 mm/s"),
        (OSCILLATOR, [], "--cpu-time", "1 s")):
    found = read(file, "--step-sizes", "1", "--periods", "3", *words)["models"]
    for model in found:
        check(model["run"], f"{file}: {model['name']} is not run: {model['remark']}")
    names = [model["name"].split(",")[0] for model in found[1:]]
    check(names == wanted, f"{file}: other models are {names}, not {wanted}")

# ---- At the first of these points nothing touches down; refined steps make a difference at others.
found = read(CRAWLER, "--vary", "frequency=9.8..15", "--vary",
             "friction=0.05..0.5", "--vary", "start=I,II", "--points", "3", "--seed", "1", "--periods", "3",
             "--step-sizes", "1", "--own-model", "--cpu-time", "1 s", "--integrator", "verlet-events")
groups = {row["group"] for row in found["settings"]}
check({"verlet-events, refined", "verlet-events, refined 8"} <= groups, f"no refined steps over several points: {groups}")

# ---- What a model's reader notes is said once, not at each point.
done = run(PENDULUM, "--vary", "stiffness=1e9..2e9", "--points", "3", "--step-sizes", "1",
           "--integrator", "rk4", "--own-model", "--cpu-time", "3 s")
check(done.stderr.count("note: --set stiffness") == 1, f"notes of three points: {done.stderr}")

# ---- Wrong use: one sentence, nothing on stdout.
for words, text in (
        (("--measure", "speed"), "--measure expects velocity, position or energy"),
        (("--integrator", "rk4,rk5"), "unknown method 'rk5'"),
        (("--integrator", ""), "unknown method ''"),
        (("--step-sizes", "0"), "a whole number from 1 to 40"),
        (("--periods", "-1"), "--periods expects"),
        (("--cpu-time", "3 m"), "--cpu-time expects"),
        (("--accuracy", "0"), "--accuracy must be above zero, found 0"),
        (("--accuracy", "101%"), "--accuracy must be at most 20 %, found 101 %"),
        (("--accuracy", "1 mm"), "--accuracy expects a number without unit"),
        (("--cpu-time", "-3 s"), "--cpu-time expects"),
        (("--points", "3"), "need --vary"),
        (("--seed", "3"), "need --vary"),
        (("--vary", "height"), "--vary expects NAME=RANGE"),
        (("--vary", "height=..2"), "--vary expects NAME=LOW..HIGH"),
        (("--vary", "height=1.."), "--vary expects NAME=LOW..HIGH"),
        (("--vary", "height=1,,2"), "--vary expects NAME=LOW..HIGH"),
        (("--vari", "height=1..2"), "did you mean '--vary'")):
    done = run(BALL, *words, code=1)
    check(not done.stdout and text in done.stderr and done.stderr.count("\n") <= 2, f"{words}: {done.stderr}")
for words, text in ((("--vary", "heigth=1..2"), "tradeoff: --vary heigth: the model has no such parameter; did you mean 'height'?"),
                    (("--vary", "height=1 s..2 s"), "operating point 1"),
                    (("--set", "step=0"), "step")):
    done = run(BALL, *words, code=2)
    check(not done.stdout and text in done.stderr, f"{words}: {done.stderr}")
done = run(f"{models}/gallery/x-joint.yaml", code=2)
check(not done.stdout and done.stderr, f"a scene without a run: {done.stderr}")
finish()

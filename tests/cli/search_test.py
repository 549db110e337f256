# SPDX-License-Identifier: GPL-3.0-or-later
# Studies that search: an optimum with a formula, by each method; the same bytes whatever the threads
# and kills; constraints, worst cases, choices; and searches that cannot find anything, which are reported.
#
#   python3 search_test.py STRUT [--long]
import json
import math
import os
import re
import signal
import sys
import time

from testing import answer, check, copy_models, finish, path, read, rows, run, same_table, stopped, write

copy_models()


def search(name, body, *words, code=0):
    """Runs the study and returns its report."""
    write(name + ".yaml", "strut: 1\nstudy: A search\nmodel: copied/basics/oscillator.yaml\ncompute: modes\n"
          "keep: [frequencies, at]\n" + body)
    done = run("sweep", name + ".yaml", "-o", name, "--json", *words, code=code)
    return json.loads(done.stdout) if done.stdout else done.stderr


# A mass on a spring: its frequency is sqrt(k/m)/(2 pi).
wanted = (2 * math.pi * 2.0) ** 2
GOAL = "minimise: abs(frequency_1 - 2 Hz)"
OVER = "over: {stiffness: {from: 10 N/m, to: 1000 N/m, scale: log}}"

# ---- a formula, by each method ----

for method, evaluations, within in (("multistart", 120, 1e-6), ("crs2", 120, 1e-6),
                                    ("direct", 120, 1e-4), ("isres", 200, 0.05),
                                    ("cobyla", 80, 1e-5), ("bobyqa", 80, 0.01), ("sbplx", 80, 1e-5),
                                    ("neldermead", 80, 1e-5), ("cma", 150, 1e-4)):
    found = search(method, f"search: {{{GOAL}, {OVER}, method: {method}, " f"evaluations: {evaluations}}}\n")["best"][0]
    value = found["values"]["stiffness"]
    check(abs(value / wanted - 1) < within, f"{method} found {value}, expected {wanted}")
    check(found["objective"] == min(float(r["objective [Hz]"]) for r in rows(method, "table.csv")
                                    if r["search"] == "1"), f"{method}: not the best of its rows")
check(abs(answer("modes", "crs2/best.yaml")["modes"][0]["frequency"] - 2) < 1e-5, "best.yaml is not the best")
best = rows("crs2", "best.csv")
check(len(best) == 1 and best[0] in rows("crs2", "table.csv"), "best.csv is no row of the table")

# ---- the same bytes ----

SEVERAL = f"search: {{{GOAL}, {OVER}, starts: 5, seed: 7, evaluations: 60}}\n"
search("one", SEVERAL, "--threads", "1")
for threads in ("2", "8"):
    search("several" + threads, SEVERAL, "--threads", threads)
    for name in ("table.csv", "best.csv", "best.yaml", "points.slots"):
        check(read("one", name) == read("several" + threads, name), f"{threads} threads change {name}")
search("generations", f"search: {{{GOAL}, {OVER}, method: cma, starts: 2, evaluations: 70}}\n", "--threads", "1")
same_table("generations.yaml", "generations", (8,), ())
before = read("one", "table.csv")
again = search("one", SEVERAL)
check(again["computed"] == 0 and read("one", "table.csv") == before, "a search was computed again")
starts = [o["best"]["values"]["stiffness"] for o in again["searches"]]
check(len(starts) == 5 and again["best"][0]["agreeing"] >= 4, f"starts found {starts}")

# ---- killed and resumed ----

GAIT = f"""strut: 1
study: Fastest gait
model: copied/crawler/crawler.yaml
set: {{friction: 0.2}}
search:
  maximise: velocity
  over: {{frequency: {{from: 5 Hz, to: 15 Hz}}, amplitude: {{from: 0.02 mm, to: 0.3 mm}}}}
  evaluations: 50
  seed: SEED
solver: {{accuracy: 2 %}}
run: {{measure: {{steady: true}}}}
keep: [velocity, work]
"""
for seed in range(1, 6 if "--long" in sys.argv else 2):
    write("gait.yaml", GAIT.replace("SEED", str(seed)))
    found = answer("sweep", "gait.yaml", "-o", f"gait{seed}")["best"][0]
    check(found["objective"] >= 0.0242, f"the gait of seed {seed} is {found}")
    check(abs(found["check"] / found["objective"] - 1) < 0.02, f"the gait does not stand: {found}")
check(f'{answer("run", "gait1/best.yaml")["velocity"]}' in read("gait1", "best.csv").decode(), "best.yaml runs elsewhere")
write("gait.yaml", GAIT.replace("SEED", "1"))
for how in (signal.SIGKILL, signal.SIGINT):
    begun = time.monotonic()
    stopped("sweep", "gait.yaml", "-o", "killed", "--quiet", by=how, after=lambda: (
        os.path.exists(path("killed", "points.slots")) and time.monotonic() - begun > 0.1))
check(os.path.exists(path("killed", "points.slots")) and
      not os.path.exists(path("killed", "table.csv")), "the search was not interrupted")
run("sweep", "gait.yaml", "-o", "killed", "--quiet")
for name in ("table.csv", "best.csv", "points.slots"):
    check(read("gait1", name) == read("killed", name), f"killed and resumed: {name} differs")

# ---- constraints, worst cases, choices, whole numbers, outer axes ----

for method in ("multistart", "crs2", "direct", "isres", "cobyla", "sbplx"):
    found = search("limit-" + method, "search: {maximise: stiffness, " + OVER +
                   f", method: {method}, evaluations: 150, subject_to: [frequency_1 <= 2 Hz]}}\n")
    value = found["best"][0]["values"]["stiffness"]
    check(found["best"][0]["feasible"] and 0.93 < value / wanted <= 1 + 1e-12,
          f"{method} under a condition found {value}, expected {wanted}")
found = search("robust", f"search: {{{GOAL}, {OVER}, worst_over: {{mass: [1 kg, 4 kg]}}}}\n")
# Frequencies f and f/2 are as far from 2 Hz as each other at f = 8/3 Hz.
value = found["best"][0]["values"]["stiffness"]
check(abs(value / (2 * math.pi * 8 / 3) ** 2 - 1) < 1e-5, f"the worst of two masses: {value}")
table = rows("robust", "table.csv")
check([r["mass [kg]"] for r in table[:4]] == ["1", "4", "1", "4"], "scenarios are not in order")
found = search("choice", "search: {" + GOAL + ", over: {stiffness: [50 N/m, 160 N/m, 300 N/m], "
               "mass: {from: 1, to: 3, integer: yes}}, evaluations: 100}\n")
check(found["searches"][0]["end"] == "enumerated" and found["searches"][0]["evaluations"] == 9 and
      found["best"][0]["values"] == {"stiffness": 160, "mass": 1}, f"choices: {found['best'][0]}")
write("drop.yaml", """strut: 1
parameters: {start: "low", phase: 1 rad}
nodes: {a: {position: [0, 0], mass: 1 kg}, b: {position: [1, 0], mass: 1 kg}}
members: {s: {kind: spring, nodes: [a, b], stiffness: 10 N/m, rest_length: 2 + sin(phase)}}
configurations: {low: {}, middle: {b: [1.5, 0]}, high: {b: [3, 0]}}
initial: {configuration: start}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 2 ms, measure: {last: 1 ms, quantities: {gap: {of: b.x - a.x, take: final}, pull: {of: s.force, take: final}}}}
""")
write("words.yaml", """strut: 1
study: Words and angles
model: drop.yaml
search: {maximise: pull, over: {start: [low, middle, high], phase: {from: 0 deg, to: 360 deg, wraps: yes}},
         subject_to: [gap < 2 m, motion != periodic], evaluations: 150}
keep: [gap, pull, motion]
""")
found = answer("sweep", "words.yaml", "-o", "words")["best"][0]
check(found["values"]["start"] == "middle" and
      abs(found["values"]["phase"] / (1.5 * math.pi) - 1) < 1e-2, f"words and angles: {found}")
NAMES = "strut: 1\nstudy: Names\nmodel: drop.yaml\nsearch: {maximise: pull, over: {start: %s}, evaluations: %d}\nkeep: [pull]\n"
for count, end in ((1, "used up"), (2, "used up"), (3, "enumerated"), (4, "enumerated")):  # all that there may be
    write("names.yaml", NAMES % ("[low, middle, high]", count))
    found = answer("sweep", "names.yaml", "-o", f"names-{count}")
    check(found["searches"][0]["end"] == end and found["searches"][0]["evaluations"] == min(count, 3) and
          (count < 3 or found["best"][0]["values"] == {"start": "high"}), f"{count} evaluations of names: {found}")
for text, word in ((NAMES, "middle"), (NAMES.replace("pull", "work"), "drive_work")):
    write("names.yaml", text % ("[low, midle]" if text is NAMES else "[low, high]", 1))
    run("sweep", "names.yaml", "-o", "names", code=2, err=f"did you mean '{word}'?")
found = search("outer", "axes: [{mass: [1 kg, 2 kg, 3 kg]}]\nsearch: {" + GOAL + ", " + OVER + "}\n")
for item, mass in zip(found["best"], (1, 2, 3)):
    check(abs(item["values"]["stiffness"] / (mass * wanted) - 1) < 1e-5, f"mass {mass}: {item}")
check(len(rows("outer", "best.csv")) == 3 and os.path.exists(path("outer", "best-3.yaml")), "one best for each of the axes")

# ---- two goals: the front has a formula, |f - 1 Hz| + |f - 2 Hz| = 1 Hz between the two ----

PARETO = ("search: {minimise: [abs(frequency_1 - 1 Hz), abs(frequency_1 - 2 Hz)], over: {stiffness: "
          "{from: 10 N/m, to: 1000 N/m, scale: log}, mass: {from: 1, to: 2}}, evaluations: 150}\n"
          "figures: {front: {kind: points, x: objective, y: objective_2, color: mass}}\n")
found = search("pareto", PARETO)
front = found["fronts"][0]
check(len(front) > 20 and found["best"] == [], f"a front of {len(front)} points")
for point in front:
    check(abs(point["objective"] + point["objective_2"] - 1) < 1e-9, f"off the front: {point}")
check(front[0]["objective"] < 0.05 and front[-1]["objective"] > 0.95, f"the front ends at {front[-1]}")
check(len(rows("pareto", "best.csv")) == len(front), "best.csv is not the front")
check(b"<svg" in read("pareto", "front.svg"), "no figure of the front")
mode = answer("modes", "pareto/best.yaml")["modes"][0]["frequency"]
check(abs(mode - 1.5) < 0.1, f"the compromise of the front has {mode} Hz")
same_table("pareto.yaml", "pareto", (1,), ())

# ---- figures ----

search("drawn", "axes: [{mass: [1 kg, 2 kg]}]\nsearch: {" + GOAL + ", " + OVER + ", starts: 2, "
       "evaluations: 30}\nfigures: {best: {kind: best, only: mass=2}, "
       "points: {kind: points, x: stiffness, y: frequency_1, only: mass=1}, "
       "beside: {kind: winner}}\n")
for name in ("best.svg", "points.svg", "beside.svg"):
    check(b"<svg" in read("drawn", name), f"no {name}")

# ---- what cannot be found is reported ----

found = search("never", f"search: {{{GOAL}, {OVER}, subject_to: [frequency_1 < 0.1 Hz], " "evaluations: 40}\n", code=3)
check(not found["best"][0]["feasible"] and found["best"][0]["bounds"] == {"stiffness": "lower"},
      f"infeasible everywhere: {found['best'][0]}")
found = search("constant", "search: {minimise: 0*frequency_1, " + OVER + ", evaluations: 30}\n")
check(found["searches"][0]["constant"], "a constant objective is not reported")
found = search("nothing", "search: {minimise: frequency_3, " + OVER + ", evaluations: 30}\n", code=3)
check(found["best"] == [] and found["searches"][0]["without_objective"] ==
      found["searches"][0]["evaluations"] > 0, f"no objective anywhere: {found['searches'][0]}")
found = search("single", "search: {" + GOAL + ", " + OVER + ", evaluations: 1}\n")
check(found["searches"][0]["evaluations"] == 1 and found["best"][0]["values"]["stiffness"] == 100,
      f"one evaluation: {found}")


def refuse(body, *texts, words=()):
    said = search("refused", body, *words, code=2)
    for text in texts:
        check(text in said, f"expected '{text}' for {body}, found {said}")


refuse("search: {minimise: frequence_1, " + OVER + "}\n", "refused.yaml:6:20: ", "frequency_1", "'keep' chooses")
refuse("search: {minimise: frequency_1*m, " + OVER + "}\n", "the unit 'm' needs a number before it, such as '1 m'\n")
refuse("search: {minimise: at, " + OVER + "}\n", "refused.yaml:6:20: ", "holds texts")
refuse("search: {minimise: 2 Hz, " + OVER + "}\n", "refused.yaml:6:20: ", "names no column")
refuse("search: {minimise: frequency_1 + 1 kg, " + OVER + "}\n", "refused.yaml:6:")
for range_, text in (("{from: -2, to: -1, scale: log}", "logarithmic"),
                     ("[1 N/m]", "no choice"), ("5", "needs a range"),
                     ("{from: 1.2, to: 1.8, integer: yes}", "whole numbers"),
                     ("{from: 1, to: 2, start: 3}", "'start' outside"),
                     ("{from: 1, to: 2, scale: log, wraps: yes}", "cannot wrap"),
                     ("{from: 1 mm, to: 2 mm}", "stiffness")):
    refuse("search: {" + GOAL + ", over: {stiffness: " + range_ + "}}\n", "refused.yaml:6:", text)
refuse("search: {" + GOAL + ", over: {mess: {from: 1, to: 2}}}\n", "no parameter 'mess'", "mass")
for condition, text in (("frequency_1 < 1 kg", "compared"), ("at < 2", "texts"),
                        ("at = ", "missing"), ("where = II", "no such column"),
                        ("frequency_1 = 2", "numbers are compared"), ("frequency_1", "comparison"),
                        ("1 < frequency_1 < 2", "comparison"), ("1 < 2", "neither side")):
    refuse("search: {" + GOAL + ", " + OVER + f", subject_to: [\"{condition}\"]}}\n", "refused.yaml:6:", text)
refuse("search: {minimise: [at], " + OVER + "}\n", "a list of two")
refuse("search: {minimise: [frequency_1, frequency_2], " + OVER + ", method: cma}\n", "nsga2")
refuse("search: {" + GOAL + ", " + OVER + ", method: nsga2}\n", "two goals")
refuse("axes: [{mass: [1, 2]}]\nfigures: {a: {kind: best}}\n", "is of a search")
refuse("search: {" + GOAL + ", " + OVER + ", evaluations: 0}\n", "refused.yaml:6:", "evaluations")
refuse("axes: [{stiffness: [1, 2]}]\nsearch: {" + GOAL + ", " + OVER + "}\n", "given twice")
refuse("axes: [{mass: [1, 2]}]\nrefine: {where: at, depth: 1}\nsearch: {" + GOAL + ", " + OVER +
       "}\n", "no grid to refine")
refuse("trajectories: yes\ncompute: run\nsearch: {" + GOAL + ", " + OVER + "}\n", "refused.yaml")
write("fine.yaml", "strut: 1\nstudy: x\nmodel: copied/basics/oscillator.yaml\ncompute: modes\nsearch: {" + GOAL + ", " + OVER + "}\n")
run("sweep", "fine.yaml", "-o", "fine", "--retry", code=1, err="depends on those before")
check(run("sweep", "fine.yaml", "--count").stdout.startswith("  points at most  203\n"), "--count")
check("are finished" in run("sweep", "--merge", "one").stdout, "a finished search")
done = answer("sweep", "one.yaml", "-o", "one", "--status")
check(done["finished"] and 0 < done["done"] <= done["points"] == 303, f"the status is {done}")
text = run("sweep", "one.yaml", "-o", "one").stdout
check("minimise  abs(frequency_1 - 2 Hz)\n" in text and re.search(r" [\d.]+ [nup]?Hz\s", text)
      and re.search(r"beside stiffness +[\d.]+ [mnup]?Hz", text)
      and "searches that agree" in text, f"the report is {text}")

write("words.yaml", read("words.yaml").decode().replace("[low, middle, high]", "{from: 1, to: 2}"))
check("is a text" in run("sweep", "words.yaml", "-o", "no", code=2).stderr, "a range of texts")
write("words.yaml", read("words.yaml").decode().replace("360", "90"))
check("full turn" in run("sweep", "words.yaml", "-o", "no", code=2).stderr, "half an angle wraps")

finish()

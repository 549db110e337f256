# SPDX-License-Identifier: GPL-3.0-or-later
# Derivatives of runs and of statics by parameters: formulas, the crawler through its contacts, a contact that only just
# happens, the ends of ranges; and the same bytes whatever the threads.
import cmath
import json
import math

from testing import check, copy_models, finish, read, rows, run, sweep, write

copy_models()


def derivatives(model, *words):
    """Of a run: (of, by) -> row."""
    done = run("run", model, "--json", *words)
    return {(row["of"], row["by"]): row for row in json.loads(done.stdout)["derivatives"]}


def holds(row, wanted, relative, what):
    """Is the derivative right within its own error, and that small?"""
    good = row["value"] is not None and abs(row["value"] - wanted) <= row["error"] <= relative * abs(wanted)
    check(good, f"{what}: {row}, expected {wanted}")


def cell(row, of, by):
    texts = [row[next(name for name in row if name.split(" ")[0] == f"{of}.d.{by}{end}")] for end in ("", ".error")]
    return {"value": float(texts[0]) if texts[0] else None, "error": float(texts[1]) if texts[1] else None}


def flies(h, k, t, g=9.81):  # the height of the ball below; of complex numbers, for derivatives
    v = (2 * g * h) ** 0.5
    touch = 2 / k ** 0.5 * (math.pi - cmath.atan(v * k ** 0.5 / g))
    bounce, t = 2 * v / g + touch, t - v / g
    t -= touch + bounce * ((t / bounce).real // 1)
    return v * t - g * t * t / 2


# ---- a ball that falls, is in touch with a spring, and flies: bounces in closed form ----

BALL = """strut: 1
parameters: {height: 100 mm, mass: 1 kg, stiffness: 1e4 N/m, unused: 1}
gravity: [0, -9.81 m/s^2]
nodes: {ball: {position: [0, height], mass: mass}}
ground: {stiffness: stiffness}
solver: {step: 0.1 ms}
run:
  duration: 0.25 s
  measure: {derivatives: [height, stiffness],
            quantities: {y: {of: ball.y, take: final}, lands: {of: ball.y, take: arrival, target: 0 m}}}
"""
for end in (1.15, 0.25):  # after several bounces, and one
    write("ball.yaml", BALL.replace("0.25 s", f"{end} s"))
    found = derivatives("ball.yaml")
    holds(found["y", "height"], flies(0.1 + 1e-30j, 1e4, end).imag / 1e-30, 1e-5, "height by that before")
    holds(found["y", "stiffness"], flies(0.1, 1e4 + 1e-30j, end).imag / 1e-30, 1e-4, "height by the ground's stiffness")
holds(found["lands", "height"], 0.5 * math.sqrt(2 / 9.81 / 0.1), 1e-6, "time of arrival")
check(derivatives("ball.yaml", "--threads", "1") == derivatives("ball.yaml", "--threads", "4"), "threads change bits")

# ---- a parameter that nothing uses, and one that has no neighbours ----

unused = BALL.replace("derivatives: [height, stiffness]", "derivatives: [height, unused]")
write("unused.yaml", unused)
run("run", "unused.yaml", code=1, err="'unused': unused.yaml:2:62: nothing in the scene uses parameter 'unused'")
write("drops.yaml", """strut: 1
parameters: {height: 100 mm, count: 2}
gravity: [0, -9.81 m/s^2]
parts: {drop: {nodes: {ball: {position: [0, height], mass: 1 kg}}}}
place: {d: {part: drop, repeat: {count: count, step: [1 m, 0]}}}
solver: {step: 0.1 ms}
run: {duration: 0.1 s, measure: {derivatives: [count, height], quantities: {y: {of: d.1.ball.y, take: final}}}}
""")
done = json.loads(run("run", "drops.yaml", "--json").stdout)
found = {row["by"]: row for row in done["derivatives"] if row["of"] == "y"}
holds(found["height"], 1.0, 1e-8, "beside one that is not known")
check(found["count"]["verdict"] == "not known", str(found))
said = [w["text"] for w in done["warnings"] if w["code"] == "derivatives"]
check(len(said) == 1 and "there are no derivatives by 'count'" in said[0], f"no warning: {done['warnings']}")
write("drops-study.yaml", "strut: 1\nstudy: s\nmodel: drops.yaml\nkeep: [y]\naxes: [{height: [100 mm, 200 mm]}]\n")
done = run("sweep", "-o", "drops", "drops-study.yaml")
check("there are no derivatives by 'count'" in done.stderr, f"no warning of a sweep: {done.stderr}")
row = rows("drops", "table.csv")[0]
check(cell(row, "y", "count")["value"] is None, str(row))
holds(cell(row, "y", "height"), 1.0, 1e-8, "in a sweep, beside one that is not known")

# ---- a mass that swings to the ground and only just touches it: its damper makes a kink ----

write("graze.yaml", """strut: 1
parameters: {start: 2 m, mass: 1 kg}
nodes: {top: {position: [0, 3 m], fixed: both}, ball: {position: [0, start], mass: mass, fixed: x}}
members: {spring: {kind: spring, nodes: [top, ball], stiffness: 40 N/m, rest_length: 2 m}}
ground: {stiffness: 1e4 N/m, damping: 50 N s/m, nodes: [ball]}
solver: {integrator: adaptive, tolerance: 1e-10, step: 10 ms}
run: {duration: 0.8 s, measure: {derivatives: [start], quantities: {y: {of: ball.y, take: final}, v: {of: ball.vy, take: rms}}}}
""")
check(derivatives("graze.yaml")["y", "start"]["verdict"] == "not differentiable here", "grazing is not noticed")
before, w = derivatives("graze.yaml", "--set", "start=1.9 m"), math.sqrt(40.0)
holds(before["y", "start"], math.cos(w * 0.8), 1e-6, "without a touch")
holds(before["v", "start"], w * math.sqrt(0.5 - math.sin(1.6 * w) / (3.2 * w)), 1e-6, "a mean, as exact as the run")

# ---- the crawler: 438 touchdowns and changes between stick and slip ----

crawler = read("copied", "crawler", "crawler.yaml").decode().split("\nsolver:")[0]
crawler = crawler.replace("law: karnopp", "law: coulomb").replace(", stick_velocity: 0.1 mm/s", "")
write("crawler.yaml", crawler + """
solver: {integrator: adaptive, tolerance: 1e-9, step: 1 ms}
run: {duration: 0.5 s, measure: {derivatives: [friction], quantities: {x: {of: n1.x, take: final}}}}
""")
found = derivatives("crawler.yaml")["x", "friction"]
holds(found, 0.045371, 5e-5, "the crawler's way by friction")
check(abs(found["value"] - 0.045371) < 5e-7, f"five digits: {found}")

# ---- its steady velocity, by periodic orbits that are solved for ----

write("steady.yaml", crawler + """
solver: {accuracy: 1 %}
run: {periods: 400, of: drive, measure: {steady: true, last: 1, derivatives: [friction]}}
""")
holds(derivatives("steady.yaml")["velocity", "friction"], -0.02281, 2e-3, "the crawler's steady velocity by friction")

# ---- the end of a range: friction of 0 is the least ----

write("slide.yaml", """strut: 1
parameters: {mu: 0}
gravity: [0, -10 m/s^2]
nodes: {block: {position: [0, 0], mass: 1 kg}}
ground: {stiffness: 1e6 N/m, friction: {law: coulomb, mu: mu}}
initial: {velocities: {block: [1 m/s, 0]}, settle: false}
solver: {integrator: adaptive, step: 1 ms, tolerance: 1e-9}
run: {duration: 0.1 s, measure: {derivatives: [mu], quantities: {x: {of: block.x, take: final}}}}
""")
found = derivatives("slide.yaml")["x", "mu"]
check(found["value"] is not None and abs(found["value"] + 0.05) < 1e-3, f"one-sided derivative: {found}")

# ---- statics: frequencies and the limit load of von Mises' truss ----

for row in sweep("modes", "model: copied/basics/oscillator.yaml\ncompute: modes\nkeep: [frequencies, at]\nlowest: 1\n"
                 "axes: [{stiffness: [100 N/m, 400 N/m]}]\nderivatives: [stiffness, mass]\n"):
    stiffness = float(row["stiffness [N/m]"])
    frequency = math.sqrt(stiffness) / 2 / math.pi
    holds(cell(row, "frequency_1", "stiffness"), frequency / 2 / stiffness, 1e-6, "frequency by stiffness")
    holds(cell(row, "frequency_1", "mass"), -frequency / 2, 1e-6, "frequency by mass")

row, = sweep("limit", "model: copied/basics/von-mises-truss.yaml\ncompute: path\nkeep: [limit_factor, end]\n"
             "set: {load: 1 N}\naxes: [{span: [1 m]}]\npath: {until: 20}\nderivatives: [height, stiffness]\n")
rest = math.hypot(1, 0.3)
length = rest ** (1 / 3)
apex = math.sqrt(length ** 2 - 1)
holds(cell(row, "limit_factor", "height"), 2000 * apex / length * 0.3 / rest, 1e-5, "limit load by height")
holds(cell(row, "limit_factor", "stiffness"), 2 * apex * (rest / length - 1), 1e-5, "limit load by stiffness")

# ---- a search that follows them: from the middle of the box to the one minimum in a few points ----

SEARCH = ("model: copied/basics/oscillator.yaml\ncompute: modes\nkeep: [frequencies]\nlowest: 1\n"
          'search: {minimise: "(frequency_1/(2 Hz) - 1)^2 + (mass/(1 kg) - 0.7)^2", evaluations: 40, method: bfgs,\n'
          "  over: {stiffness: {from: 10 N/m, to: 1000 N/m, scale: log}, mass: {from: 0.5 kg, to: 2 kg}}}\n")
sweep("follows", SEARCH)
best = min(float(row["objective"]) for row in rows("follows", "table.csv"))
check(best < 1e-15, f"bfgs: {best}")
sweep("bound", SEARCH.replace("from: 0.5 kg", "from: 0.9 kg"))
best = min(float(row["objective"]) for row in rows("bound", "table.csv"))
check(abs(best - 0.04) < 1e-12, f"bfgs at a bound: {best}")
finish()

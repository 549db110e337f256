# SPDX-License-Identifier: GPL-3.0-or-later
# Sensitivity analyses against closed forms: derivatives with their errors, first-order and total indices
# of a product of lognormal numbers, shares of texts and signs; the same bytes whatever the threads and
# interruptions; failed points; what is refused.
import math
import os

from testing import check, finish, read, rows, run, work, write


def sweep(name, text, *words, code=0):
    write(name + "-study.yaml", "strut: 1\nstudy: s\n" + text)
    done = run("sweep", name + "-study.yaml", "-o", name, *words, code=code)
    return done.stdout, rows(f"{name}/sensitivity.csv")


def pick(table, of, measure, parameter="", **others):
    found = [r for r in table if r["of"] == of and r["measure"] == measure
             and r["parameter"] == parameter and all(r[k] == v for k, v in others.items())]
    check(len(found) == 1, f"{of} {measure} {parameter}: {len(found)} rows")
    return found[0]


def near(row, wanted, relative):
    check(math.isclose(float(row["value"]), wanted, rel_tol=relative), f"{row}: expected {wanted}")


def within(row, wanted, errors=4.0):
    """The value is within so many of its own errors, which are no large ones."""
    value, error = float(row["value"]), float(row["error"])
    check(abs(value - wanted) <= errors * error + 1e-12, f"{row}: expected {wanted}")
    check(error < 0.1, f"{row}: a large error")


OSCILLATOR = """strut: 1
name: A mass on a spring
parameters: {stiff: 100 N/m, heavy: 2 kg, idle: 0.5, long: 1 m}
nodes: {wall: {position: [0, 0], fixed: both}, mass: {position: [1, 0], mass: heavy, fixed: y}}
members: {spring: {nodes: [wall, mass], kind: spring, stiffness: stiff, rest_length: long + 0 m*idle}}
solver: {step: 1 ms}
run: {duration: 1 s}
"""


# The frequency is a product of powers of lognormal numbers.
def products():
    write("oscillator.yaml", OSCILLATOR)
    text = """model: oscillator.yaml
compute: modes
lowest: 1
keep: [frequencies, total_mass]
sensitivity: {of: [frequency_1, total_mass],
              over: {stiff: {lognormal: [100 N/m, 0.6]}, heavy: {lognormal: [2 kg, 0.4]}, idle: {uniform: [0, 1]}},
              samples: 512}
"""
    said, table = sweep("product", text)
    a, b = math.exp(0.3 ** 2) - 1, math.exp(0.2 ** 2) - 1  # squared variations of both factors
    whole = (1 + a) * (1 + b) - 1
    f = math.sqrt(100 / 2) / 2 / math.pi
    mean = f * math.exp(0.3 ** 2 / 2 + 0.2 ** 2 / 2)
    of = "frequency_1"
    within(pick(table, of, "first_order", "stiff"), a / whole)
    within(pick(table, of, "total", "stiff"), a * (1 + b) / whole)
    within(pick(table, of, "first_order", "heavy"), b / whole)
    within(pick(table, of, "total", "heavy"), b * (1 + a) / whole)
    within(pick(table, of, "total", "idle"), 0.0)
    within(pick(table, of, "mean"), mean)
    near(pick(table, of, "deviation"), mean * math.sqrt(whole), 0.05)
    for parameter, wanted in (("stiff", f / 200), ("heavy", -f / 4), ("idle", 0.0)):
        row = pick(table, of, "derivative", parameter)
        check(abs(float(row["value"]) - wanted) <= float(row["error"]) + 1e-15, str(row))
        check(float(row["error"]) <= 1e-6 * abs(wanted) + 1e-15, str(row))
    near(pick(table, of, "elasticity", "stiff"), 0.5, 1e-6)
    near(pick(table, of, "elasticity", "heavy"), -0.5, 1e-6)
    check(pick(table, of, "derivative", "stiff")["unit"] == "Hz/(N/m)", "unit of a derivative")
    check(pick(table, of, "derivative", "heavy")["unit"] == "Hz/kg", "unit of a derivative")
    # a sum of one: the mass owes all to one parameter; a sign that never changes has no indices
    within(pick(table, "total_mass", "first_order", "heavy"), 1.0)
    check(pick(table, "total_mass > 0", "share")["value"] == "1", "share of a sign")
    check(pick(table, "total_mass > 0", "total", "heavy")["value"] == "", "index without variance")
    # a threshold: shares of a lognormal mass below and above its median; a line for each point of an axis
    report, cut = sweep("cut", text.replace("samples: 512", "samples: 64, threshold: 2").replace(
        "sensitivity:", "axes: [{long: [1 m, 2 m]}]\nsensitivity:"))
    for condition, share in (("total_mass > 2", 0.5), ("|total_mass| <= 2", 0.5), ("total_mass < -2", 0.0)):
        row = pick(cut, condition, "share", **{"long [m]": "2"})
        check(abs(float(row["value"]) - share) < 0.05 and row["used"] == "128", str(row))
        check(condition in report, report)
    check(len([line for line in report.splitlines() if "  share  " in line]) >= 6, report)
    check("first_order  stiff" in said and "total_mass > 0" not in said, said)
    picture = read("product/sensitivity.svg").decode()
    check(picture.startswith("<?xml") and len(picture) > 2000, "the figure")
    # threads and resumption
    sweep("alone", text, "--threads", "1")
    for name in ("table.csv", "sensitivity.csv", "sensitivity.svg"):
        check(read(f"product/{name}") == read(f"alone/{name}"), f"{name} depends on threads")
    slots = read("alone/points.slots")
    write("alone/points.slots", slots[:len(slots) // 3])
    os.remove(os.path.join(work, "alone", "sensitivity.csv"))
    sweep("alone", text)
    check(read("product/sensitivity.csv") == read("alone/sensitivity.csv"), "resumed")
    # another seed, and the rows of a wider study at each point of an axis
    _, other = sweep("other", text.replace("samples: 512", "samples: 64, seed: 2"))
    check(pick(other, of, "total", "stiff")["value"] != pick(table, of, "total", "stiff")["value"],
          "the seed changes nothing")
    _, wide = sweep("wide", text.replace("sensitivity:", "axes: [{long: [1 m, 2 m]}]\nsensitivity:")
                    .replace("512", "16"))
    _, narrow = sweep("narrow", text.replace("512", "16"))
    check(len(wide) == 2 * len(narrow), "rows at each point of the axis")
    for row in narrow:
        twin = pick(wide, row["of"], row["measure"], row["parameter"], **{"long [m]": "1"})
        check(all(twin[k] == row[k] for k in row), f"{row} {twin}")
    check(len(read("wide/sensitivity.svg")) > 2000, "the figure over an axis")


# A curved result: the error of the derivative is that of its curvature. Runs with an accuracy: theirs does not count,
# since derivatives are those of runs with error control. A result that is missing beside the medians has none.
def errors():
    write("fall.yaml", """strut: 1
name: A mass that falls
parameters: {start: 1 m/s, pull: 9.81 m/s^2}
gravity: [0, -pull]
nodes: {top: {position: [0, 0], fixed: both}, mass: {position: [0, 1], mass: 1 kg}}
members: {idle: {nodes: [top, mass], kind: cable, stiffness: 1 N/m, rest_length: 100 m}}
initial: {velocities: {mass: [start, start]}}
solver: {integrator: rk4-events, step: 1 ms}
run:
  duration: 0.5 s
  measure:
    last: 0.5 s
    quantities: {height: {of: mass.y, take: max}, right: {of: mass.vx, take: final},
                 late: {of: mass.y, take: arrival, target: 1.05 m}}
""")
    text = """model: fall.yaml
keep: [quantities]
sensitivity: {of: [height, right, late], over: {start: {uniform: [-1 m/s, 3 m/s]}}, samples: 64}
"""
    _, table = sweep("fall", text)  # height: 1 + start^2/(2 pull) above start = 0
    row = pick(table, "height", "derivative", "start")
    check(abs(float(row["value"]) - 1 / 9.81) <= float(row["error"]) + 1e-7, str(row))
    check(float(row["error"]) < 1e-4, str(row))
    # the share of a sign, with an interval that holds it: start > 0 in three quarters
    row = pick(table, "right > 0", "share")
    check(float(row["low"]) <= 0.75 <= float(row["high"]) and row["used"] == "128", str(row))
    near(pick(table, "right > 0", "total", "start"), 1.0, 0.3)
    # a result that is missing at some points is described by the others
    row = pick(table, "late", "mean")
    check(0 < int(row["used"]) < 128, str(row))
    row = pick(table, "late", "total", "start")
    check(0 < int(row["used"]) < 64, str(row))
    _, rough = sweep("rough", text + "solver: {accuracy: 1 %}\n")
    row = pick(rough, "height", "derivative", "start")
    check(float(row["error"]) < 1e-6 and row["verdict"] == "differentiable", str(row))
    check(abs(float(row["value"]) - 1 / 9.81) <= float(row["error"]), str(row))
    _, never = sweep("never", text.replace("uniform: [-1 m/s, 3 m/s]", "uniform: [0.5 m/s, 0.7 m/s]"))
    row = pick(never, "late", "derivative", "start")
    check(row["value"] == row["error"] == "" and row["verdict"] == "not known", str(row))


# The one mechanism: the same derivatives as those that a study asks for itself, beside which it stands.
def own():
    text = """model: oscillator.yaml
compute: modes
lowest: 2
keep: [frequencies, total_mass]
derivatives: [stiff]
axes: [{long: [1 m, 2 m]}]
sensitivity: {of: [frequency_1, degrees_of_freedom], over: {heavy: {normal: [2 kg, 0.1 kg]}}, samples: 2}
""".replace("keep: [", "keep: [degrees_of_freedom, ")
    _, analysed = sweep("analysed", text)
    table = rows("analysed/table.csv")
    for row in table:
        f = math.sqrt(100 / float(row["heavy [kg]"])) / 2 / math.pi
        check(abs(float(row["frequency_1.d.stiff [Hz/(N/m)]"]) - f / 200) < 1e-9 * f, f"own derivatives: {row}")
        medians = row["point"] in ("0", "7")
        check(bool(row["frequency_1.d.heavy [Hz/kg]"]) == medians, f"derivatives at the medians alone: {row}")
        check(row["frequency_1.d.heavy.verdict"] == ("differentiable" if medians else ""), str(row))
    value = pick(analysed, "frequency_1", "derivative", "heavy", **{"long [m]": "1"})["value"]
    check(value == table[0]["frequency_1.d.heavy [Hz/kg]"], "another derivative than that of the table")
    row = pick(analysed, "degrees_of_freedom", "derivative", "heavy", **{"long [m]": "1"})
    check(row["value"] == row["error"] == "0", f"of a count: {row}")
    write("oscillator.yaml", OSCILLATOR.replace("mass: heavy", "mass: heavy + 1 kg*abs(idle)"))
    _, kink = sweep("kink", text.replace("{heavy: {normal: [2 kg, 0.1 kg]}}", "{idle: {uniform: [-1, 1]}}"))
    row = pick(kink, "frequency_1", "derivative", "idle", **{"long [m]": "1"})
    check(row["value"] == "" and row["verdict"] == "not differentiable here", f"of a kink: {row}")
    write("oscillator.yaml", OSCILLATOR)


# Texts: shares of each, and what decides.
def texts():
    write("truss.yaml", """strut: 1
name: A shallow arch
parameters: {load: 5 N, idle: 0}
nodes: {left: {position: [-1, 0], fixed: both}, right: {position: [1, 0], fixed: both},
        apex: {position: [0, 0.3], mass: 1 kg}}
members: {falling: {kind: bar, nodes: [apex, left], stiffness: 1000 N/m},
          rising: {kind: bar, nodes: [apex, right], stiffness: 1000 N/m}}
loads: {weight: {node: apex, force: [0 N*idle, -load]}}
initial: {settle: true}
solver: {step: 1 ms}
run: {duration: 10 ms}
configurations: {up: {apex: [0, 0.3]}, down: {apex: [0, -0.3]}}
""")
    _, table = sweep("arch", """model: truss.yaml
keep: [outcome]
sensitivity: {of: [outcome], over: {load: {uniform: [5 N, 15 N]}, idle: {uniform: [0, 1]}}, samples: 32,
              derivatives: no}
""")
    up = 0.4949917  # it snaps through above 9.949917 N
    names = {r["of"] for r in table}
    check("outcome = up" in names, str(names))
    row = pick(table, "outcome = up", "share")
    check(float(row["low"]) <= up <= float(row["high"]), str(row))
    row = pick(table, "outcome = up", "total", "load")
    check(abs(float(row["value"]) - 1.0) < 0.3, str(row))
    check(float(pick(table, "outcome = up", "total", "idle")["value"]) == 0.0, "an idle parameter")
    check(not any(r["measure"] == "derivative" for r in table), "derivatives of a text")


def refused():
    base = """model: oscillator.yaml
compute: modes
keep: [frequencies]
"""
    for more, words in (
            ("sensitivity: {of: [frequenci_1], over: {stiff: {uniform: [1 N/m, 2 N/m]}}}\n",
             "wrong.yaml:6:20: error: the sensitivity analysis: the table has no column 'frequenci_1'; did you mean "
             "'frequency_1'?"),
            ("sensitivity: {of: [frequency_1]}\n", "lacks 'over'"),
            ("sensitivity: {of: [], over: {stiff: {uniform: [1 N/m, 2 N/m]}}}\n",
             "expected columns of the table for 'of'"),
            ("sensitivity: {of: [frequency_1], over: {}}\n", "must have from 1 to 20 entries"),
            ("sensitivity: {of: [frequency_1], over: {stif: {uniform: [1 N/m, 2 N/m]}}}\n",
             "no parameter 'stif'; did you mean 'stiff'"),
            ("sensitivity: {of: [frequency_1], over: {stiff: {uniform: [2 N/m, 1 N/m]}}}\n", "two ascending numbers"),
            ("sensitivity: {of: [frequency_1], over: {stiff: {uniform: [1 N/m, 2 N/m]}}, "
             "samples: 0, derivatives: no}\n", "neither samples nor derivatives"),
            ("axes: [{stiff: [1 N/m]}]\nsensitivity: {of: [frequency_1], over: "
             "{stiff: {uniform: [1 N/m, 2 N/m]}}}\n", "given twice"),
            ("axes: [{long: {from: 1 m, to: 2 m, count: 3}}, {idle: {from: 0, to: 1, count: 3}}]\n"
             "refine: {where: frequency_1, depth: 1}\nsensitivity: {of: [frequency_1], over: "
             "{stiff: {uniform: [1 N/m, 2 N/m]}}}\n", "exclude each other"),
            ("search: {maximise: frequency_1, over: {idle: {from: 0, to: 1}}}\n"
             "sensitivity: {of: [frequency_1], over: {stiff: {uniform: [1 N/m, 2 N/m]}}}\n",
             "exclude each other"),
            ("", "lacks 'axes'")):
        write("wrong.yaml", "strut: 1\nstudy: s\n" + base + more)
        run("sweep", "wrong.yaml", "-o", "wrong", code=2, err=words)
    write("right.yaml", "strut: 1\nstudy: s\n" + base + "sensitivity: {of: [frequency_1], over: "
          "{stiff: {uniform: [1 N/m, 2 N/m]}}, samples: 4}\n")
    said = run("sweep", "right.yaml", "-o", "right", "--shard", "0/2", code=1).stderr
    check("needs all points in one file" in said, said)
    said = run("sweep", "right.yaml", "--count").stdout
    check("points   13\n" in said, said)


products()
errors()
own()
texts()
refused()
finish()

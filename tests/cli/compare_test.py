# SPDX-License-Identifier: GPL-3.0-or-later
"""strut compare: its numbers are those of the single commands, its differences those of the texts.

usage: compare_test.py STRUT
"""
import csv
import json
import math
import os
import re
import xml.etree.ElementTree as tree

from testing import answer, check, exported, fail, files_in, finish, models, needs, read, run, work, write

needs("numpy", "yaml")
import numpy  # noqa: E402

CRAWLER, X = f"{models}/crawler/crawler.yaml", f"{models}/gallery/x-frame.yaml"
TRUSS = f"{models}/basics/von-mises-truss.yaml"
SQUARE, PENDULUM = f"{models}/basics/x-frame.yaml", f"{models}/basics/pendulum.yaml"
TWO, SNAP = f"{models}/gallery/two-mass-crawler.yaml", f"{models}/gallery/von-mises.yaml"


def same(what, found, wanted, relative=1e-12):
    if found is None or wanted is None:
        check(found is wanted, f"{what}: {found}, not {wanted}")
    elif not abs(found - wanted) <= relative * max(abs(found), abs(wanted)):
        fail(f"{what}: {found!r}, not {wanted!r}")


def check_counts(path, v):
    reported = answer("check", path)
    for key in ("nodes", "bars", "springs", "cables", "contacts", "actuators", "degrees_of_freedom", "step_limit"):
        same(f"{path}: {key}", v[key], reported[key])
    same(f"{path}: members", v["members"], len(reported["members"]))


def check_rigidity(path, v):
    stands = answer("rigidity", path, "--at", "start")
    same(f"{path}: self-stress", v["self_stress_states"], stands["self_stress"]["count"])
    moves = stands["mechanisms"]
    same(f"{path}: rigid", v["rigid_body_motions"], moves["rigid_body"])
    same(f"{path}: mechanisms", v["mechanisms"], moves["count"] - moves["rigid_body"])
    same(f"{path}: finite", v["finite_mechanisms"], moves["finite"])
    force = [m["force"] for m in stands["members_at"].values()]
    same(f"{path}: tension", v["largest_tension"], max(0, *force), 1e-9)
    same(f"{path}: compression", v["largest_compression"], max(0, *[-f for f in force]), 1e-9)
    same(f"{path}: prestress", v["prestress"], math.sqrt(sum(f * f for f in force) / len(force)), 1e-9)


def check_states(path, model):
    reported, v = answer("equilibria", path), model["values"]
    stands = {e["name"]: e["energy"] for e in reported["equilibria"] if e["outcome"] == "stands"}
    check({s["name"]: s["energy"] for s in model["states"]} == stands, f"{path}: states {model['states']}, not {stands}")
    energies = [s["energy"] for s in model["states"]]
    check(energies == sorted(energies), f"{path}: states are not in the order of their energy")
    same(f"{path}: number of states", v["stable_states"], len(stands))
    same(f"{path}: lowest", v["lowest_energy"], min(stands.values()))
    same(f"{path}: span", v["energy_span"], max(stands.values()) - min(stands.values()))
    barriers = [(b["from"], b["to"], b["height"]) for b in reported["barriers"]]
    check([(b["from"], b["to"], b["height"]) for b in model["barriers"]] == barriers, f"{path}: barriers differ")
    return barriers


def check_frequencies(path, v):
    elastic = [m["frequency"] for m in answer("modes", path)["modes"] if m["kind"] == "elastic"]
    for i in range(3):
        same(f"{path}: frequency {i + 1}", v[f"frequency_{i + 1}"], elastic[i] if i < len(elastic) else None)


def check_motion(path, model, *options):
    """The run and, from it alone, what is made of it."""
    reported, v = answer("run", path, "--accuracy", "0.5%", "--steady", "0.5%", *options), model["values"]
    same(f"{path}: velocity", v["velocity"], reported["velocity"])
    same(f"{path}: error", v["velocity_error"], reported["accuracy"]["expected"])
    spent = reported["force_evaluations"] + reported["accuracy"]["check_evaluations"]
    same(f"{path}: evaluations", v["evaluations_per_second"], spent / reported["duration"])
    period = 1 / v["drive_frequency"]
    same(f"{path}: travel", v["travel_per_period"], reported["velocity"] * period)
    # that run ends with whole periods of the steady motion, by another tolerance
    work = reported["window_drive_work"] / reported["window_duration"] * period
    same(f"{path}: energy", v["drive_energy_per_period"], work, 2e-3)
    same(f"{path}: power", v["drive_power"], v["drive_energy_per_period"] / period)
    same(f"{path}: transport", v["cost_of_transport"], v["drive_power"] / (v["mass"] * 9.81 * abs(v["velocity"])))
    duty = {n: c["duty"] for n, c in reported["contacts"].items()}
    for node, c in model["contacts"].items():
        check(abs(c["duty"] - duty[node]) <= 0.03, f"{path}: {node} touches {c['duty']}, in the run {duty[node]}")
    touching = [c["duty"] for c in model["contacts"].values() if c["duty"] > 0]
    same(f"{path}: duty", v["contact_duty"], sum(touching) / len(touching))


def stiffness(scene, at):
    """Every node under unit loads, from the members' law, for a scene that strut wrote."""
    names = list(scene["nodes"])
    index = {n: i for i, n in enumerate(names)}
    q = numpy.array([at[n]["position"] for n in names])
    k = numpy.zeros((2 * len(names), 2 * len(names)))
    for m in scene["members"].values():
        a, b = (index[n] for n in m["nodes"])
        d = q[b] - q[a]
        length = math.hypot(*d)
        u = d / length
        t = m["stiffness"] * (length - m["rest_length"])
        if m["kind"] == "cable" and t <= 0:
            continue
        block = m["stiffness"] * numpy.outer(u, u) + t / length * (numpy.eye(2) - numpy.outer(u, u))
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            k[2 * i:2 * i + 2, 2 * j:2 * j + 2] += sign * block
    free = numpy.ones(2 * len(names), bool)
    for n, node in scene["nodes"].items():
        fixed = node.get("fixed", "") if isinstance(node, dict) else ""
        free[2 * index[n]:2 * index[n] + 2] = fixed not in ("x", "both"), fixed not in ("y", "both")
    for n in names:
        if "ground" in scene and q[index[n], 1] < 0:
            for d in range(2):
                k[2 * index[n] + d, 2 * index[n] + d] += scene["ground"]["stiffness"]
    k = k[numpy.ix_(free, free)]
    x, y = (q - q.mean(axis=0)).T
    rigid = numpy.stack([numpy.tile([1, 0], len(names)), numpy.tile([0, 1], len(names)),
                         numpy.stack([-y, x], 1).ravel()], 1)[free]
    loose = [r for r in rigid.T if free.all() and abs(r @ k @ r) < 1e-9 * k.max() * (r @ r)]
    p = numpy.eye(len(k))
    if loose:
        basis = numpy.linalg.qr(numpy.stack(loose, 1))[0]
        p -= basis @ basis.T
    flexible = p @ numpy.linalg.pinv(k, rcond=1e-11) @ p if loose else numpy.linalg.inv(k)
    result = numpy.full(2 * len(names), numpy.nan)
    result[free] = 1 / numpy.diag(flexible)
    return {n: result[2 * i:2 * i + 2] for n, i in index.items()}


def check_stiffness(path, model):
    scene = exported(path)
    wanted = stiffness(scene, model["nodes"])
    for node, reported in model["nodes"].items():
        for d in range(2):
            here = wanted[node][d]
            same(f"{path}: stiffness of {node} in {'xy'[d]}", reported["stiffness"][d],
                 None if math.isnan(here) else here, 1e-6)
    for d in range(2):
        least = min(w[d] for w in wanted.values() if not math.isnan(w[d]))
        same(f"{path}: softest", model["values"][f"stiffness_{'xy'[d]}"], least, 1e-6)


# ---- numbers ----
for path in (X, SQUARE, SNAP):
    model = answer("compare", path, "--no-motion")["models"][0]
    check_counts(path, model["values"])
    check_rigidity(path, model["values"])
    check_states(path, model)
    check_frequencies(path, model["values"])
check_states(TRUSS, answer("compare", TRUSS, "--no-motion")["models"][0])  # two of different energies
for path in (X, SQUARE, CRAWLER):
    check_stiffness(path, answer("compare", path, "--no-motion", "--no-states")["models"][0])

crawler = answer("compare", CRAWLER, "--no-states")["models"][0]
check_counts(CRAWLER, crawler["values"])
check_rigidity(CRAWLER, crawler["values"])
check_frequencies(CRAWLER, crawler["values"])
check_motion(CRAWLER, crawler)
same("mass", crawler["values"]["mass"], 0.14)
check(crawler["values"]["lowest_energy"] is None and crawler["reasons"]["lowest_energy"] == "not requested",
      "states that were not asked for")

window = answer("compare", PENDULUM, "--no-states")["models"][0]["motion"]
check(window == "mean over 0.4833 s", f"a mean over a window says {window}")

# ---- unlike structures, settings, CSV ----
both = answer("compare", "--set", "frequency=10.5 Hz", "--set", "start=II", CRAWLER, X, TWO, PENDULUM, "--no-states")
by = {m["model"]: m for m in both["models"]}
check(list(by) == ["crawler", "x-frame", "two-mass-crawler", "pendulum"], f"labels {list(by)}")
same("frequency set", by["crawler"]["values"]["drive_frequency"], 10.5)
same("frequency set", by["two-mass-crawler"]["values"]["drive_frequency"], 10.5, 1e-9)
if by["x-frame"]["without_parameters"] != ["frequency", "start"] or \
        by["two-mass-crawler"]["without_parameters"] != ["start"]:
    fail("parameters that a model does not have are not reported")
check_motion(CRAWLER, by["crawler"], "--set", "frequency=10.5 Hz", "--set", "start=II")
check(by["x-frame"]["values"]["velocity"] is None and "drive" in by["x-frame"]["reasons"]["drive_frequency"],
      "a structure without drive")
for model in both["models"]:
    for key, value in model["values"].items():
        check((value is None) == (key in model["reasons"]), f"{model['model']}: {key} is {value}, {model['reasons'].get(key)}")
rows = list(csv.DictReader(run("compare", CRAWLER, X, "--no-states", "--csv").stdout.splitlines()))
alone = answer("compare", CRAWLER, X, "--no-states")["models"]
for row, model in zip(rows, alone):
    check(row["model"] == model["model"] and row["name"] == model["name"], f"CSV: {row['model']}")
    for key, value in model["values"].items():
        cell = next(c for n, c in row.items() if n.split(" ")[0] == key)
        if key != "cpu_per_second":
            same(f"CSV: {key}", float(cell) if cell else None, value, 0)
check("mass [kg]" in rows[0] and "contact_duty" in rows[0], f"CSV: header {list(rows[0])}")

os.chdir(work)
# ---- differences ----
text = """strut: 1
name: one
parameters: {stiff: 100 N/m, unlike: 1}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1 kg}}
members:
  ab: {kind: spring, nodes: [a, b], stiffness: stiff}
"""
write("one.yaml", text)
write("two.yaml", text.replace("name: one", "name: two").replace(
    "stiffness: stiff}", "stiffness: 200 N/m}\n  ac: {kind: cable, nodes: [a, b], "
    "stiffness: 1 N/m}").replace(", unlike: 1", ""))
found = answer("compare", "one.yaml", "two.yaml", "one.yaml", "--no-states", "--no-motion")
reported = {d["where"]: (d["change"], d["was"], d["is"]) for d in found["models"][1]["differences"]}
if reported != {"parameters.unlike": ("removed", "1", None),
            "members.ab.stiffness": ("changed", "100", "200"),
            "members.ac": ("added", None, "{nodes: [a, b], kind: cable, stiffness: 1, " "rest_length_ratio: 1}")}:
    fail(f"differences: {reported}")
check(not found["models"][2]["differences"] and found["models"][2]["model"] == "one.yaml", "a model against itself")
check("differences" not in found["models"][0], "the first differs from itself")
# stiffer by a factor: a spring from a wall, whose stiffness along it is its own
same("stiffness of a spring", found["models"][0]["values"]["stiffness_x"], 100)
check(found["models"][0]["reasons"].get("stiffness_y") is not None, "a spring without tension resists across")
for whole, at in zip(answer("compare", SQUARE, TWO, "--no-states", "--no-motion")["models"],
                     answer("compare", SQUARE, TWO, "--no-states", "--no-motion", "--mass", "500 g")["models"]):
    faster = math.sqrt(whole["values"]["mass"] / 0.5)  # by the formula, where no weight stiffens
    same("frequency at equal mass", at["values"]["frequency_1"], whole["values"]["frequency_1"] * faster, 1e-6)
out = run("compare", "one.yaml", "two.yaml", "--no-states", "--no-motion").stdout
for line in ("two: against the first", "members.ac +added", "parameters.unlike +removed",
             "members.ab.stiffness +changed +100 +200"):
    check(re.search(line, out), f"the table lacks '{line}'")

# ---- files ----
run("compare", "one.yaml", "two.yaml", SQUARE, "--no-motion", "-q", "-o", "kept")
names = sorted(files_in("kept"))
check(names == ["compare.csv", "compare.json", "compare.svg", "model-1.svg", "model-2.svg", "model-3.svg"], names)
for name in names[2:]:
    tree.parse(f"kept/{name}")
run("compare", "one.yaml", "two.yaml", SQUARE, "--no-motion", "-q", "-o", "again")
for name in names:
    check(read("kept", name) == read("again", name), f"{name} is not the same a second time")
run("compare", "one.yaml", "-q", "-o", "kept", "--no-motion")
check(len(files_in("kept")) == 4, "a picture of an earlier comparison stays")
run("compare", "one.yaml", "--no-states", "--plot", "sheet.svg")
tree.parse("sheet.svg")


def written(*words):
    """The texts of a figure: of its title, panels and legend."""
    run("compare", *words, "--no-states", "--no-motion", "-q", "--plot", "sheet.svg")
    return [t.text for t in tree.parse("sheet.svg").iter("{urn:strut:texts}t")]


# The title is the name of all scenes; the legend has what is to be seen, and a driven spring is seen as driven.
write("driven.yaml", text + "actuators: {drive: {member: ab, signal: {sine: {amplitude: 1 mm, frequency: 1 Hz}}}}\n")
LEGEND = {"bar", "spring", "cable", "driven"}
for words, first, legend in ((["driven.yaml", "driven.yaml"], ["one", "driven"], {"driven"}),
                             (["one.yaml", "driven.yaml"], ["one", "one"], {"spring", "driven"}),
                             (["two.yaml", "one.yaml"], ["two", "nodes 2, members 2, mass 1 kg"], {"spring", "cable"}),
                             ([X, "one.yaml"], ["x-frame", "Snelson's X, standing nodes 4"], {"bar", "spring", "cable"})):
    said = written(*words)
    check(LEGEND & set(said) == legend and [said[0], said[1][:len(first[1])]] == first, f"{words}: {said}")

# ---- one, twenty ----
for i in range(20):
    write(f"m{i}.yaml", text.replace("100 N/m", f"{100 + i} N/m"))
many = answer("compare", *[f"m{i}.yaml" for i in range(20)], "--no-states", "--no-motion")
for i, model in enumerate(many["models"]):
    same(f"model {i} of twenty", model["values"]["stiffness_x"], 100 + i)
run("compare", *[f"m{i}.yaml" for i in range(20)], "--no-states")

# ---- bad use ----
def refused(code, needle, *words, stdin=""):
    done = run("compare", *words, code=code, err=needle, stdin=stdin)
    check(not done.stdout, f"strut compare {' '.join(words)}: prints something")


refused(1, "missing MODEL...")
refused(4, "nosuch.yaml", "one.yaml", "nosuch.yaml", "-o", "none")
write("bad.yaml", text.replace("kind: spring", "kind: sprong"))
write("worse.yaml", "strut: 1\nnods: {}\n")
done = run("compare", "one.yaml", "bad.yaml", "worse.yaml", code=2)
for needle in ("bad.yaml:6", "spring", "worse.yaml:2", "nodes"):
    check(needle in done.stderr, f"bad models among good ones: stderr lacks '{needle}': {done.stderr}")
check(not os.path.exists("none"), "a refused comparison leaves a directory")
refused(1, "did you mean 'stiff'", "--set", "stif=3", "one.yaml", "two.yaml")
refused(1, "no model has such a parameter", "--set", "stif=3", "one.yaml", "two.yaml")
refused(1, "'two.yaml' has no such parameter", "one.yaml", "two.yaml", "--set", "stif=3")
refused(2, "frog", "one.yaml", "two.yaml", "--set", "stiff=frog")
# ---- settings behind a model are its own; scenes' names; notes once ----
done = run("compare", "one.yaml", "one.yaml", "--set", "stiff=200 N/m", "one.yaml", "--set",
           "stiff=300 N/m", "--no-states", "--no-motion", "--json")
own = {m["model"]: m for m in json.loads(done.stdout)["models"]}
check(list(own) == ["one", "one stiff=200 N/m", "one stiff=300 N/m"], f"labels of settings: {list(own)}")
first = own["one"]["values"]["stiffness_x"]
for label, stiffness in (("one stiff=200 N/m", 200), ("one stiff=300 N/m", 300)):
    check(own[label]["parameters"]["stiff"] == stiffness and own[label]["values"]["stiffness_x"] != first,
          f"{label} is not set: {own[label]['parameters']}")
done = run("compare", "--set", "stiff=1e6", "one.yaml", "one.yaml", "--no-states", "--no-motion")
check(done.stderr.count("note:") == 1, f"not one note on --set: {done.stderr}")
done = run("compare", CRAWLER, PENDULUM, "--no-states", "--no-motion")
check("Nine-member multistable crawler" in done.stdout, f"no name of the scene: {done.stdout[:300]}")
refused(1, "--accuracy", "one.yaml", "--accuracy", "0")
refused(1, "--accuracy", "one.yaml", "--accuracy", "200%")
refused(1, "--csv", "one.yaml", "--csv", "--json")
refused(1, "'-' once", "-", "-", stdin=text)
done = run("compare", "-", "one.yaml", "--no-states", "--csv", stdin=text)
check(done.stdout.split("\n")[1].startswith("stdin,one,2,1,"), f"the standard input: {done.stdout}")
run("check", "one.yaml", "two.yaml", code=1)

# ---- one that fails does not stop the others ----
falls = """strut: 1
nodes: {a: {position: [0, 0], mass: 1 kg}}
gravity: [0, -1]
initial: {settle: {limit: 0.1 s}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1 s}
"""
open("falls.yaml", "w").write(falls)
done = run("compare", "falls.yaml", "one.yaml", "--no-states", "--json", code=3)
reported = json.loads(done.stdout)["models"]
if reported[0]["status"] == "completed" or reported[1]["status"] != "completed" or \
        "falls" not in done.stderr or reported[0]["values"]["velocity"] is not None:
    fail(f"a model that fails: {reported[0]['status']}, {done.stderr}")

finish()

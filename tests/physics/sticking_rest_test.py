# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest by friction alone: blocks and frames on slopes settle onto the set of equilibria that sticking makes, or are told
at once that nothing holds them; the shapes on a slope have names and the coefficient that they need, and paths begin
there. Against closed forms: the angle of friction, and the moments about the feet."""
import json
import math
import time

from testing import answer, check, finish, near, path, run, write

LAWS = {"coulomb": "law: coulomb", "karnopp": "law: karnopp, stick_velocity: 0.1 mm/s",
        "stribeck": "law: stribeck, width: 0.1 mm/s, decay_velocity: 1 mm/s"}
X = [("a", 0, 0), ("b", .1, .01), ("c", .1, .11), ("d", 0, .1)]
ROW = [(f"l{i}", .1 * i, .001 * (i % 2)) for i in range(4)] + [(f"u{i}", .05 + .1 * i, .09) for i in range(3)]
EDGES = [(f"l{i}", f"u{i}") for i in range(3)] + [(f"u{i}", f"l{i + 1}") for i in range(3)] + [
    (f"l{i}", f"l{i + 1}") for i in range(3)] + [("u0", "u1"), ("u1", "u2")]


def structure(kind, turn):
    """A block, Snelson's X, or a row of triangles with four feet, turned onto the slope."""
    c, s = math.cos(turn), math.sin(turn)

    def nodes(places):
        return "nodes: {" + ", ".join(f"{n}: [{c * x - s * y}, {s * x + c * y}]" for n, x, y in places) + "}\n"

    if kind == "block":
        return "nodes: {b: {position: [0, 0], mass: 1}}\n"
    if kind == "x":
        return nodes(X) + """groups:
  bar: {kind: bar, stiffness: 1e5, damping: 10, mass: 0.1}
  cable: {kind: cable, stiffness: 1000, damping: 1, rest_length_ratio: 0.95}
members: {ac: {group: bar, nodes: [a, c]}, bd: {group: bar, nodes: [b, d]}, ab: {group: cable, nodes: [a, b]},
          bc: {group: cable, nodes: [b, c]}, cd: {group: cable, nodes: [c, d]}, da: {group: cable, nodes: [d, a]}}
"""
    members = ", ".join(f"m{i}: {{group: s, nodes: [{a}, {b}]}}" for i, (a, b) in enumerate(EDGES))
    return nodes(ROW) + ("groups: {s: {kind: spring, stiffness: 3e3, damping: 3, mass: 0.05}}\n"
                         f"members: {{{members}}}\n")


def scene(name, kind, slope, law, mu, more="initial: {settle: {friction: kept}}\n", tilted=False):
    """On a slope, or on level ground below gravity that leans alike."""
    lean = slope if tilted else 0.0
    write(name, "strut: 1\n" + structure(kind, 0.0 if tilted else slope) + f"""
gravity: [{-9.81 * math.sin(lean)}, {-9.81 * math.cos(lean)}]
ground: {{slope: {0.0 if tilted else slope}, stiffness: 1e5, damping: 100, friction: {{{LAWS[law]}, {mu}}}}}
solver: {{integrator: adaptive, step: 1 ms}}
run: {{duration: 0.2 s}}
""" + more)


def rests(kind, slope, law, mu, tilted):
    scene("rests.yaml", kind, slope, law, mu, tilted=tilted)
    text = run("run", "rests.yaml", "--json").stdout
    what = f"{kind}, {math.degrees(slope):.0f} deg, {law}, {mu}"
    if not text:
        return
    found = json.loads(text)
    moves = found["energy"]["kinetic"]
    check(found["settle_time"] < 2.0, f"{what}: settled after {found['settle_time']} s")
    if law == "coulomb":  # inside Karnopp's band the law as printed creeps
        check(moves < 1e-16, f"{what}: {moves} J of motion after it has settled")


for kind in ("block", "x", "row"):
    for degrees in (0, 5, 20):
        slope = math.radians(degrees)
        tan = math.tan(slope)
        enough = ["mu: 0.8", "mu_static: 0.8, mu_kinetic: 0.1"]
        enough += [f"mu: {tan * 1.01!r}", f"mu: {tan * (1 + 1e-7)!r}"] if degrees else []
        for law in ("coulomb", "karnopp"):
            for mu in enough:
                rests(kind, slope, law, mu, degrees == 5 and law == "karnopp")
        if not degrees:  # what vanishes with the speed holds nothing, but does no harm on level ground
            rests(kind, slope, "stribeck", "mu_static: 0.8, mu_kinetic: 0.1", False)
            continue
        for law, mu in (("coulomb", f"mu: {tan * (1 - 1e-6)!r}"), ("karnopp", "mu: 0.01"),
                        ("stribeck", "mu_static: 0.8, mu_kinetic: 0.1")):
            scene("slides.yaml", kind, slope, law, mu)
            began = time.monotonic()
            run("run", "slides.yaml", code=3, err=f"a static coefficient of at least {tan:.4g}")
            check(time.monotonic() - began < 20, f"{kind}, {degrees} deg, {law}: told only after long")
        scene("slides.yaml", kind, slope, "coulomb", "mu: 0.8", "initial: {settle: true}\n")
        run("run", "slides.yaml", code=3, err="friction acts with initial.settle.friction: kept")

# Paths begin at rest by friction: pushed up, down the slope, and near the angle of friction.
for degrees, mu, way in ((20, 0.8, 1), (20, 0.8, -1), (5, 0.1, 1), (30, 0.5774, -1)):
    a = math.radians(degrees)
    scene("path.yaml", "block", a, "coulomb", f"mu: {mu}",
          f"loads: {{p: {{node: b, force: [{way * math.cos(a)}, {way * math.sin(a)}]}}}}\npath: {{friction: kept}}\n")
    found = answer("path", "path.yaml", "--until", "20")
    slips = [event["factor"] for event in found["events"] if event["kind"] == "slips"]
    near(slips[0] if slips else "", 9.81 * (mu * math.cos(a) + way * math.sin(a)), f"path {degrees}, {mu}, {way}", 1e-6)
scene("path.yaml", "block", a, "coulomb", "mu: 0.5", "loads: {p: {node: b, force: [1, 0]}}\npath: {friction: kept}\n")
run("path", "path.yaml", code=3, err="a friction coefficient of at least 0.5774")

# Shapes on a slope: each with the least coefficient, which holds it; a run from its name stays there.
NAMED = "configurations: {S: {contacts: [a, b]}}\n"
for tilted in (False, True):
    slope = math.radians(5)
    tan = math.tan(slope)
    scene("shapes.yaml", "x", slope, "coulomb", "mu: 0.3",
          NAMED + "initial: {settle: {friction: kept}}\n", tilted=tilted)
    found = answer("equilibria", "shapes.yaml")
    stand = [e for e in found["equilibria"] if e["outcome"] == "stands"]
    check(found["start"] in ("S", "S-2"), f"the start settles in {found['start']}")
    check(len(stand) > 3, "few shapes stand on a slope")
    c, s = (1.0, 0.0) if tilted else (math.cos(slope), math.sin(slope))
    for e in stand:
        near(e["rest"]["friction"], tan, f"{e['name']} needs friction")
        at = {n: (c * x + s * y, c * y - s * x) for n, (x, y) in e["rest"]["nodes"].items()}
        centre = [sum(p[k] for p in at.values()) / 4 for k in (0, 1)]
        feet = sorted(e["rest"]["contacts"], key=lambda n: at[n])
        weight = 0.2 * 9.81
        far = weight * math.cos(slope) * (centre[0] - at[feet[0]][0]) - weight * math.sin(slope) * centre[1]
        near(e["rest"]["contacts"][feet[1]], far / (at[feet[1]][0] - at[feet[0]][0]),
             f"{e['name']}: push on {feet[1]}", 1e-2)
    for mu, law in ((tan * (1 + 1e-6), "coulomb"), (0.3, "coulomb"), (0.3, "karnopp")):
        scene("named.yaml", "x", slope, law, f"mu: {mu!r}", NAMED + "initial: {equilibrium: S}\n", tilted=tilted)
        text = run("run", "named.yaml", "--json").stdout
        moves = json.loads(text)["energy"]["kinetic"] if text else 1
        check(moves < 1e-16, f"from S with {law}, {mu}: {moves} J of motion")
    scene("named.yaml", "x", slope, "coulomb", f"mu: {tan * (1 - 1e-6)!r}", NAMED + "initial: {equilibrium: S}\n")
    run("run", "named.yaml", code=3, err=f"a friction coefficient of at least {tan:.4g} holds it")

# The paper's crawler on 5 degrees, by its own law: every start of figure 8, and its outcomes.
write("slope.yaml", "strut: 1\nbase: crawler.yaml\nparameters: {slope: 5 deg}\n"
      "gravity: [-9.81 m/s^2*sin(slope), -9.81 m/s^2*cos(slope)]\n")
with open("models/crawler/crawler.yaml", encoding="utf-8") as model:
    write("crawler.yaml", model.read())
write("study.yaml", """strut: 1
study: Starts of figure 8 on a slope
model: slope.yaml
variants: {settled: {initial: {configuration: start, settle: {friction: kept}}}, named: {}}
axes: [{friction: [0.1, 0.2, 0.5]}, {start: [I, II]}]
run: {periods: 2, of: drive, measure: {last: 1}}
output: {last: 1}
keep: [velocity, outcome]
""")
run("sweep", "study.yaml", "-o", "starts", "--quiet")
with open(path("starts", "table.csv"), encoding="utf-8") as table:
    lines = [line.split(",") for line in table.read().splitlines()[1:]]
check(len(lines) == 12 and all(line[3] == line[5] and line[6] == "completed" for line in lines),
      f"starts of figure 8 on a slope: {lines}")

# A push that ends with a jump of its table; a slide that bristles stop; a weeble, whose foot is rounder than its member is long.
RUN = "solver: {integrator: adaptive, step: 7 ms}\nrun: {duration: 0.5, measure: {quantities: {q: {of: a.x"
for text, wanted, error in (
        ("loads: {l: {node: a, force: [1, 0], signal: {table: [[0, 1], [0.3, 1], [0.3, 0]]}}}\n"
         f"nodes: {{a: {{position: [0, 0], mass: 1}}}}\n{RUN}, take: final}}}}}}}}", 0.3 * 0.15 + 0.3 * 0.2, 1e-9),
        ("nodes: {a: {position: [0, -1 mm], mass: 1}}\ngravity: [0, -10]\ninitial: {velocities: {a: [1, 0]}}\n"
         "ground: {stiffness: 1e4, damping: 20, nodes: [a], friction: {law: lugre, mu_static: 0.5, mu_kinetic: 0.4, "
         f"decay_velocity: 1 mm/s, presliding: 0.1 mm, relaxation: 1 ms}}}}\n{RUN}, take: final}}}}}}}}",
         1 / (2 * 0.4 * 10), 1e-2),
        ("members: {m: {kind: bar, nodes: [a, b], stiffness: 1e5, damping: 30}}\ngravity: [0, -9.81]\n"
         "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1 mm, 0.1], mass: 1}}\n"
         "ground: {stiffness: 1e5, damping: 30, nodes: [a], friction: {law: smooth, mu: 5, width: 2 mm/s}}\n"
         f"feet: {{f: {{member: m, node: a, radius: 0.2}}}}\n{RUN} - b.x, take: arrival, target: 0}}}}}}}}",
         math.pi / 2 * math.sqrt(0.01 / 9.81 / 0.3), 4e-3)):
    write("one.yaml", f"strut: 1\n{text}\n")
    for method in ("adaptive", "implicit"):
        found = answer("run", "one.yaml", "--integrator", method)["measured"]["q"]["value"]
        near(found, wanted, f"{method}, {text[:9]}", error)
# The last copy pulled by 1 m; statics need no masses.
write("row.yaml", "strut: 1\nplace: {p: {part: k, repeat: {count: 12, step: [1, 0], next: {merge: {b: a}}}}}\n"
      "parts: {k: {nodes: {a: [0, 0], b: [1, 0]}, members: {m: {kind: spring, nodes: [a, b], stiffness: 12}}}}\n"
      "nodes: {p.0.a: {fixed: both}, p.*.b: {fixed: y}}\nrun: {duration: 1 s}\n")
row = answer("path", "row.yaml", "--over", "p.last.b.x", "--until", "1")
near(row["points"][-1]["forces"]["p.0.m"], 1.0, "row", 1e-6)

finish()

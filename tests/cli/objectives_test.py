# SPDX-License-Identifier: GPL-3.0-or-later
# Numbers that a search may ask for, against closed forms: cost of transport, positive work, the time
# at which something is reached, the largest force and its member, the lowest barrier,
# stiffness at a node, distances from a shape and from a curve of force over displacement.
import math

from testing import answer, check, copy_models, finish, models, near, run, sweep, write

copy_models()


# A block that a stiff actuator pushes along rough ground: the work per distance is the friction, and
# the cost of transport its coefficient.
BLOCK = """strut: 1
name: A block pushed along the ground
parameters: {friction: 0.3, speed: 20 mm/s, fall: 9.81 m/s^2}
gravity: [0, -fall]
nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [100 mm, 0], mass: 0.5 kg}}
members: {push: {nodes: [wall, block], kind: spring, stiffness: 5 kN/m, damping: 20 N s/m, rest_length: 100 mm}}
ground: {friction: {mu: friction, stick_velocity: 0.01 mm/s}, nodes: [block], stiffness: 1 MN/m, damping: 300 N s/m}
actuators: {drive: {member: push, signal: {expression: speed*time}}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 1 s, measure: {last: 0.5 s%s}}
"""
QUANTITIES = """, quantities: {
      peak: {of: largest_force, take: max},
      there: {of: block.x, take: arrival, target: 115 mm},
      never: {of: block.x, take: arrival, target: 2 m},
      pushed: {of: work.drives, take: rise},
      away: {of: -block.x, take: rise}}"""


def moves():
    write("block.yaml", BLOCK % QUANTITIES)
    write("plain.yaml", BLOCK % "")
    rows = sweep("cost", """model: block.yaml
axes: [{friction: [0.1, 0.3]}]
keep: [velocity, cost_of_transport, quantities]
""")
    for row, mu in zip(rows, (0.1, 0.3)):
        force = mu * 0.5 * 9.81
        near(row["cost_of_transport"], mu, f"cost of transport at friction {mu}", 1e-4)
        near(row["work_per_distance [N]"], force, "work per distance", 1e-4)
        near(row["pushed [J]"], force * 0.01, "positive work", 1e-4)
        near(row["peak [N]"], force, "largest force", 1e-3)
        check(row["peak_member"] == "push", str(row))
        near(row["there [s]"], 0.75 + force / 5e3 / 0.02, "arrival", 1e-6)
        check(row["never [s]"] == "", str(row))
        check(abs(float(row["away [m]"])) < 1e-12, str(row))
    # without weight or motion there is no cost of transport
    for name, axis in (("still", "speed: [0 mm/s]"), ("weightless", "fall: [0 m/s^2]")):
        row, = sweep(name, f"model: plain.yaml\naxes: [{{{axis}}}]\nkeep: [velocity, cost_of_transport]\n")
        check(row["cost_of_transport"] == "" and (row["work_per_distance [N]"] == "") == (name == "still"), str(row))
    # the report and the summary
    said = run("run", "block.yaml").stdout
    check("in push" in said and "the target was not reached" in said, said)
    reported = answer("run", "block.yaml")["measured"]
    check(reported["peak"]["member"] == "push" and reported["never"]["value"] is None, str(reported))
    check("member" not in reported["there"], str(reported))
    # an arrival that never comes does not keep a wanted accuracy from being reached
    reported = answer("run", "block.yaml", "--accuracy", "1%")
    check(reported["accuracy"]["kept"] is True and reported["measured"]["never"]["value"] is None, str(reported))


def compared():
    row = sweep("steady", f"""model: copied/crawler/crawler.yaml
axes: [{{frequency: [10 Hz]}}]
solver: {{accuracy: 0.5 %}}
run: {{measure: {{steady: true}}}}
keep: [velocity, cost_of_transport]
""")[0]
    reported = answer("compare", f"{models}/crawler/crawler.yaml",
                          f"{models}/basics/belt.yaml", "--no-states")
    near(row["cost_of_transport"], reported["models"][0]["values"]["cost_of_transport"],
         "cost of transport of strut compare", 0.01)


def at_rest():
    row = sweep("barriers", f"""model: copied/crawler/crawler.yaml
compute: equilibria
axes: [{{friction: [0.1]}}]
lowest: 20
keep: [stable_count, barriers, lowest_barrier]
""")[0]
    barriers = [float(row[f"barrier_{i} [J]"]) for i in range(1, 21) if row[f"barrier_{i} [J]"]]
    check(len(barriers) == int(row["stable_count"]), str(row))
    near(row["lowest_barrier [J]"], min(barriers), "lowest barrier", 1e-15)


# Von Mises' truss: the stiffness of its apex, the force that holds it, its shape turned and moved.
TRUSS = "copied/basics/von-mises-truss.yaml"


def of_truss(name, text, model=TRUSS, axis="load: [0 N]"):
    row, = sweep(name, f"model: {model}\naxes: [{{{axis}}}]\n{text}\n")
    return row


def goals():
    rest = math.hypot(1, 0.3)

    def force(u):
        y = 0.3 + u
        return 2000 * y * (1 - rest / math.hypot(1, y))

    stiffness = "compute: modes\nkeep: [stiffness]\nstiffness_at: "
    for degrees in (90, 0, 30):
        row = of_truss(f"stiffness-{degrees}", stiffness + f"{{node: apex, direction: {degrees} deg}}")
        x, y = 2000 / rest ** 2, 2000 * 0.09 / rest ** 2
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        near(row["stiffness [N/m]"], 1 / (c * c / x + s * s / y), f"stiffness at {degrees} deg")
    held = (of_truss("held-left", stiffness + "{node: left, direction: 0 deg}"),
            of_truss("held-block", stiffness + "{node: block, direction: 90 deg}", "copied/basics/oscillator.yaml",
                     "steps: [200]"))
    for row in held:
        check(row["stiffness [N/m]"] == "", str(row))
    points = [-0.05, -0.1, -0.2, -0.35, -0.5, -0.6]
    for off in (0.0, 2.0):
        pairs = ", ".join(f"[{u} m, {force(u) + off} N]" for u in points)
        row = of_truss(f"curve-{off}", f"""compute: path
path: {{over: apex.y, until: -0.6 m, steps: 2000}}
keep: [curve_distance, end]
curve: [{pairs}]""")
        found = row["curve_distance [N]"]
        check(found != "" and abs(float(found) - off) < 0.02, f"curve off by {off}: {row}")
    row = of_truss("far", "compute: path\npath: {over: apex.y, until: -0.1 m}\nkeep: [curve_distance]\n"
                   "curve: [[-0.5 m, 0 N]]")
    check(row["curve_distance [N]"] == "", str(row))
    # as drawn but for the apex, which hangs 0.1 m lower; turned by 30 degrees and moved
    def turned(x, y):
        c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
        return f"[{c * x - s * y + 5} m, {s * x + c * y - 3} m]"

    for low, wanted in ((0.0, 0.0), (0.1, 0.1 * math.sqrt(2 / 9))):
        shape = (f"{{left: {turned(-1, 0)}, right: {turned(1, 0)}, apex: {turned(0, 0.3 - low)}}}")
        for compute, place in (("modes", ""), ("run", "run: {duration: 10 ms}\n")):
            row = of_truss(f"shape-{compute}-{low}", f"compute: {compute}\nkeep: [shape_distance]\n{place}shape: {shape}")
            check(abs(float(row["shape_distance [m]"]) - wanted) < 1e-9, f"{row}: {wanted}")
    # the nearest of the stable states: the apex below
    row = of_truss("below", "compute: equilibria\nkeep: [shape_distance, stable_count]\n"
                   "shape: {left: [-1 m, 0 m], right: [1 m, 0 m], apex: [0 m, -0.3 m]}")
    check(abs(float(row["shape_distance [m]"])) < 1e-9, str(row))
    row = of_truss("like", 'compute: modes\nat: "II"\nkeep: [shape_distance]\nlike: "II"',
                   "copied/crawler/crawler.yaml", "friction: [0.1]")
    check(float(row["shape_distance [m]"]) < 1e-5, str(row))
    base = f"strut: 1\nstudy: s\nmodel: {TRUSS}\naxes: [{{load: [0 N]}}]\n"
    for more, words in (
            ("compute: modes\nkeep: [stiffness]\n", "'stiffness' needs 'stiffness_at'"),
            ("compute: modes\nkeep: [stiffness]\nstiffness_at: {node: top, direction: 0 deg}\n",
             "7:22: error: 'stiffness_at' of the study: the model has no node 'top'"),
            ("compute: modes\nstiffness_at: {node: apex, direction: 0 deg}\n", "add it to 'keep'"),
            ("compute: modes\nkeep: [stiffness]\nstiffness_at: {node: apex, direction: 1 m}\n", "expected an angle"),
            ("keep: [shape_distance]\n", "'shape_distance' needs 'shape' of the study, or 'like'"),
            ("keep: [shape_distance]\nlike: \"II\"\n", "no configuration 'II'"),
            ("keep: [shape_distance]\nshape: {tip: [0, 0]}\n", "no node 'tip'"),
            ("keep: [shape_distance]\nshape: {apex: 3}\n", "expected two numbers"),
            ("compute: path\nkeep: [curve_distance]\ncurve: [[1 mm, 2 N]]\n", "'over: NODE.x'"),
            ("compute: path\npath: {over: apex.y, until: -1 mm}\nkeep: [curve_distance]\n"
             "curve: [[1 N, 2 N]]\n", "expected a length"),
            ("compute: path\npath: {over: apex.y, until: -1 mm}\nkeep: [curve_distance]\n"
             "curve: [3]\n", "expected a displacement and a force")):
        write("wrong.yaml", base + more)
        run("sweep", "wrong.yaml", "-o", "wrong", code=2, err=words)


moves()
goals()
compared()
at_rest()
finish()

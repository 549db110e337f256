# SPDX-License-Identifier: GPL-3.0-or-later
# Studies of what is at rest: columns against closed forms and against the commands, structures whose
# size differs from point to point, the same bytes whatever the threads and shards.
import math

from testing import answer, check, copy_models, finish, near, run, same_table, sweep, work, write

copy_models()


def paths():
    truss = "copied/basics/von-mises-truss.yaml"
    rows = sweep("path", f"""model: {truss}
compute: path
axes: [{{height: [0.3 m, 0.4 m, 0.5 m]}}]
path: {{until: 3}}
""")
    for row, h in zip(rows, (0.3, 0.4, 0.5)):
        rest = math.hypot(1, h)
        y = math.sqrt(rest ** (2 / 3) - 1)  # L^3 = L0 span^2
        most = y * (rest / rest ** (1 / 3) - 1)
        one = 0.2 * (rest / math.hypot(1, 0.2) - 1)
        near(row["limit_factor"], most / one, f"limit load at height {h}")
        check(row["critical_factor"] == row["limit_factor"] and row["end"] == "until", str(row))
    alone = answer("path", truss, "--until", "3", "--set", "height=0.4 m")
    first = [e for e in alone["events"] if e["kind"] == "limit point"][0]
    check(float(rows[1]["limit_factor"]) == first["factor"], "the command's factor, to the bit")
    rows = sweep("pushed", f"""model: {truss}
compute: path
axes: [{{height: [0.3 m, 0.4 m]}}]
path: {{over: apex.y, until: -0.5 m}}
""")
    check(rows[0]["last_factor [m]"] == "-0.5", f"a displacement's unit: {rows[0]}")


CHAIN = """strut: 1
parameters: {cells: 4, mass: 2 kg}
nodes: {left: {position: [0, 0], fixed: both}, right: {position: [1, 0]}}
beams:
  rod: {nodes: [left, right], bending_stiffness: 1 N m^2, axial_stiffness: 1e5 N, mass: mass,
        parts: cells, clamped: start}
solver: {step: 1e-5}
run: {duration: 1e-3}
"""


def sizes():
    """The number of parts of a beam is a parameter: what is counted, and frequencies that converge."""
    write("chain.yaml", CHAIN)
    axes = "model: chain.yaml\naxes: [{cells: [2, 4, 20]}]\n"
    kept = "keep: [node_count, member_count, degrees_of_freedom, total_mass"
    rows = sweep("beam", axes + "compute: modes\nlowest: 2\n" + kept + ", frequencies]\n")
    exact = 1.87510407 ** 2 / (2 * math.pi) * math.sqrt(1 / 2)
    errors = []
    for row, n in zip(rows, (2, 4, 20)):
        free = 2 * int(row["node_count"]) - 2
        check(int(row["degrees_of_freedom"]) in (free, free - 2), f"freedoms of {n} parts: {row}")
        near(row["total_mass [kg]"], 2, "mass", 1e-14)
        errors.append(abs(float(row["frequency_1 [Hz]"]) / exact - 1))
    counts = [int(row["member_count"]) for row in rows]
    check(counts[1] - counts[0] == 2 and counts[2] - counts[1] == 16, f"members: {counts}")
    check(errors[0] > errors[1] > errors[2] and errors[2] < 2e-3, f"errors {errors}")
    # A run keeps the names of the first point; what a point does not have is empty, and the reverse.
    rows = sweep("run", axes + kept + ", positions, contacts, velocity]\n")
    check([int(row["node_count"]) for row in rows] == [int(r["node_count"]) for r in rows], "counts of runs")
    check(all(row["x_right [m]"] and row["x_rod.1 [m]"] for row in rows), f"positions: {rows[0]}")
    back = sweep("back", axes.replace("[2, 4, 20]", "[20, 4, 2]") + "keep: [positions]\n")
    check(back[0]["x_rod.7 [m]"] and not back[1]["x_rod.7 [m]"] and back[2]["x_rod.1 [m]"],
          "nodes that a point lacks are empty")
    same_table("back-study.yaml", "back", shards=())


def rigidity():
    jib = "copied/topologies/jib.yaml"
    name = next(line.split(":")[0].strip() for line in open(f"{work}/{jib}", encoding="utf-8")
                if line.startswith("  ") and "friction" in line)
    rows = sweep("rigid", f"model: {jib}\ncompute: rigidity\naxes: [{{{name}: [0.1, 0.2]}}]\n")
    alone = answer("rigidity", jib)
    for row in rows:
        for column, wanted in (("rank", alone["rank"]),
                               ("self_stress_count", alone["self_stress"]["count"]),
                               ("mechanism_count", alone["mechanisms"]["count"]),
                               ("rigid_body", alone["mechanisms"]["rigid_body"]),
                               ("infinitesimal", alone["mechanisms"]["infinitesimal"])):
            check(int(row[column]) == wanted, f"{column}: {row[column]}, expected {wanted}")


def equilibria():
    """A truss with two states: energies and barriers by formula, then one state where the load is high."""
    study = "model: copied/basics/von-mises-truss.yaml\ncompute: equilibria\nlowest: 2\naxes: [{load: [0 N, 20 N]}]\n"
    rows = sweep("two", study)
    check([row["stable_count"] for row in rows] == ["2", "1"], f"states: {rows}")
    top = 1000 * (math.hypot(1, 0.3) - 1) ** 2  # both bars straight
    near(rows[0]["barrier_1 [J]"], top, "barrier", 1e-9)
    near(rows[0]["barrier_2 [J]"], top, "barrier", 1e-9)
    check(abs(float(rows[0]["energy_2 [J]"])) < 1e-12, "energy of the drawn shape")
    check(rows[1]["barrier_1 [J]"] == "" and rows[1]["state_2"] == "", "no way out, no second state")
    same_table("two-study.yaml", "two", (1, 2), (0, 0))


FRAME = """strut: 1
base: copied/gallery/x-frame.yaml
parameters: {stiffness: 100 N/m}
groups: {cable: {stiffness: stiffness}}
"""


def forms():
    """Snelson's X: the side of the square where cables and bars balance, one state of self-stress."""
    write("frame.yaml", FRAME)
    axes = "model: frame.yaml\naxes: [{stiffness: [50 N/m, 100 N/m, 400 N/m]}]\n"
    rows = sweep("form", axes + "compute: form\nkeep: [moved, residual, lengths, positions]\n")
    for row, c in zip(rows, (50, 100, 400)):
        side = (c * 0.95 + 1000) / (c + 1000)
        near(row["length_top [m]"], side, f"side with cables of {c} N/m")
        near(row["x_n3 [m]"], side, "position")
        near(row["moved [m]"], math.sqrt(2) * (1 - side), "moved")
        check(float(row["residual [N]"]) < 1e-9, "residual")
    rows = sweep("state", axes + "compute: rigidity\n")
    check(all(row["self_stress_count"] == "1" and row["super_stable"] == "1" and
              row["mechanism_count"] == "0" for row in rows), f"self-stress: {rows[0]}")


def failures():
    """What has no equilibrium or asks for what is not there fails in its row, and holds no other."""
    truss = "copied/basics/von-mises-truss.yaml"
    rows = sweep("lost", f"""model: {truss}
compute: modes
at: nowhere
axes: [{{height: [0.3 m, 0.4 m]}}]
""", code=3)
    check(all("nowhere" in row["message"] for row in rows), f"{rows}")
    write("bad.yaml", f"""strut: 1
study: s
model: {truss}
compute: path
axes: [{{height: [0.3 m, 0.4 m]}}]
path: {{over: apex.y, until: 1 s}}
""")
    done = run("sweep", "bad.yaml", "-o", "bad", code=2)
    check("'until' is in s, expected m" in done.stderr, done.stderr)


paths()
sizes()
rigidity()
equilibria()
forms()
failures()
finish()

# SPDX-License-Identifier: GPL-3.0-or-later
# Foreign structures: imported, they have the results of the same structure in the gallery or of a closed
# form; what a scene cannot say is listed by place, what cannot be read is an error by place and leaves no file.
#
#   python3 import_test.py STRUT        (with the Python package of the same build)
import math
import os
import re

from testing import answer, check, finish, formats, models, path, read, run, write

gallery = os.path.join(models, "gallery")


def imported(name, *words, text=None):
    """The scene of what was written as that file, or of the text, and what was said."""
    if text:
        write(name, text)
    said = formats("import", name, *words, "-o", "scene.yaml").stderr
    return read("scene.yaml").decode(), said


def stable_energies(model):
    found = answer("equilibria", model)
    return sorted(e["energy"] for e in found["equilibria"] if e["label"] == "stable")


def same_numbers(got, want, tolerance, what):
    near = len(got) == len(want) and all(abs(a - b) <= tolerance * max(1e-12, abs(b)) for a, b in zip(got, want))
    check(near, f"{what}: {got}, expected {want}")


def is_snelsons_x(what):
    same_numbers(stable_energies("scene.yaml"), stable_energies(f"{gallery}/x-frame.yaml"), 1e-9, what)


BOX = """# a square of cables with two bars
nodes: {A: [0, 0], B: [1, 0], C: [1, 1], D: [0, 1], far away: [9, 9]}
connections:
  rope:
    - bottom: [A, B]
    - [B, C]
    - [C, D]
    - [D, A]
  strut: [[B, D], [A, C]]
builders:
  rope: {stiffness: 100, type: string, initial_length_ratio: 0.95}
  strut: {stiffness: 1000, type: bar}
pin: {A: [True, True, False], B: [False, true, False]}
control: [bottom]
"""


def tensegritysim():
    scene, said = imported("box.yaml", text=BOX)
    check(scene.startswith("# Imported by strut from 'box.yaml', YAML of TensegritySim."), scene[:80])
    check("box.yaml:14:1: note: not imported: which strings are controlled" in said, said)
    check("node far_away, which nothing uses" in said and "bottom: {group: rope" in scene, said)
    is_snelsons_x("energies of Snelson's X")
    scene, _ = imported("box.yaml", "--unit", "10 cm")
    check("position: [0.1, 0.1]" in scene, "another unit of length")
    write("running.yaml", BOX.replace("- bottom: [A, B]", "- bottom: [D, A, B]").replace("    - [D, A]\n", ""))
    check("bottom: {group: rope, nodes: [D, A, B]}" in imported("running.yaml")[0], "a string over a node")


ARCH = """# an arch with a flexure, pressed through a spring
PARAMETERS
w, 8.0
h, 3.
side, 9.0
press, 1.4, [1;2.5;4]
label, 'text'
NODES
0, 0, 0, 1, 1
1, w/2, h, 1, 0
2, X0+w, Y0, 1, 1
3, X1, h + w, 1, 0
4, 1, 1, 1, 1
SPRINGS
0-1, side
2-1, LINEAR(k=side), SQRT((w/2)**2 + h**2)
1-3, k=press
LONGITUDINAL FLEXELS
4-1, BEZIER(u_i=[1]; f_i=[1;2])
ANGULAR SPRINGS
0-1-2, 7.5
LOADING
3, Y, -10, -3.0
then
1, Y, 2
"""


def springable():
    scene, said = imported("arch.csv", text=ARCH)
    for place in ("6:13: note: not imported: a range", "7:8: note: not imported: a parameter that is a text",
                  "19:6: note: not imported: an element with the behaviour 'BEZIER",
                  "13:1: note: not imported: node n4"):
        check(f"arch.csv:{place}" in said, f"not listed: {place}: {said}")
    check("h_value: 3" in scene, "the name of a unit")
    check("n2: {position: [8, 0]" in scene and "n1: {position: [w/2, h_value]" in scene, scene)

    check("""path:
  stages:
    - {load: load1, stop: {n3.y: -3}}
    - {load: load2}""" in scene, "stages of the loading")
    stages = answer("path", "scene.yaml")
    first = stages["earlier_stages"][0]
    check(first["end"] == "stop" and all(
        abs(here - there) < 1e-14 * 8 for name, place in first["points"][-1]["nodes"].items()
        for here, there in zip(stages["points"][0]["nodes"][name], place)), "stages")
    write("blocked.csv", ARCH + "then\nblock\n1, Y\n3, Y, 5\n")
    check("    - {load: load3, hold: [n1.y]}" in imported("blocked.csv")[0], "a node that is held")
    check("    - {load: [load2, load3]}" in imported("together.csv", text=ARCH + "3, Y, 5\n")[0], "loads of one step")
    imported("arch.csv", text=ARCH.split("then")[0].replace(", -3.0", ""))

    def limits(model):
        found = answer("path", model, "--load", "load1" if model == "scene.yaml" else "down",
                              "--until", "3")
        return [e["factor"] for e in found["events"] if "limit" in e["kind"]][:2]
    same_numbers(limits("scene.yaml"), limits(f"{gallery}/arch-with-flexure.yaml"), 1e-6,
                 "limit loads of the arch with a flexure")
    # distances: their signs and nodes, and a contact by its formula
    scene, said = imported("distances.csv", text="""PARAMETERS
f, 3
NODES
0,0,0,1,1
1,2,1,0,0
2,5,0,1,1
X DISTANCE FLEXELS
1-0, 20, 1.5
Y DISTANCE SPRINGS
1-0, CONTACT(f0=f;uc=.05;delta=0.9)
DISTANCE SPRINGS
1-0-2, LINEAR(k=1e-9)
POINT2MID Y DISTANCE SPRINGS
1-0-2, 5
LOADING
1, Y, -2
""")
    check("d1: {nodes: [n0, n1], along: x, stiffness: 20, rest_distance: 1.5}" in scene, scene)
    check("d3: {node: n1, line: [n0, n2], stiffness: 1e-9}" in scene, scene)
    check("d4: {nodes: [m1, n1], along: y, stiffness: 5}" in scene, scene)
    end = answer("path", "scene.yaml", "--load", "load1")["points"][-1]
    x, y = end["nodes"]["n1"]
    same_numbers([x, 3 * ((0.9 - y) / 0.05) ** 3 + 5 * (1 - y)], [1.5, 2], 1e-6, "a node on distances")
    # cables that are written as two pieces, a running one, an angle beyond half a turn
    scene, said = imported("cables.csv", text="""PARAMETERS
k, 100
NODES
0,0,0,1,1
1,1,0,0,1
2,1,1,0,0
3,0,1,0,0
4,2,1,1,1
SPRINGS
0-2, 10*k
1-3, 10*k
0-1, PIECEWISE(k_i=[1e-5; k]; u_i=[0.01]; us=0.005), 0.94
1-2, PIECEWISE(k_i=[1e-5; k]; u_i=[0.01]; us=0.005), 0.94
2-3, PIECEWISE(k_i=[1e-5;k];u_i=[0.01];us=0.005), 0.94
3-0, PIECEWISE(k_i=[1e-5;k];u_i=[0.01];us=0.005), 0.94
""")
    check("nearly slack up to a knee becomes a cable" in said and scene.count("kind: cable") == 4, said)
    is_snelsons_x("energies of Snelson's X of two pieces")
    write("path.csv", "NODES\n0,0,0,1,1\n1,1,1,0,0\n2,2,0,1,1\nPATH SPRINGS\n0-1-2, PIECEWISE(k_i=[1;5];u_i=[0.1])\n"
          "ANGULAR SPRINGS\n0-1-2, 1, 1.5*PI\nAREA SPRINGS\n0-1-2, 3\n")
    scene, said = imported("path.csv")
    check("law: {kind: bilinear, knee: 0.1, second_stiffness: 5}" in scene, scene)
    check("area1: {nodes: [n0, n1, n2], stiffness: 3}" in scene, scene)
    check(f"rest_angle: {-0.5 * math.pi!r}" in scene, f"an angle within half a turn: {scene}")
    # nearly slack on one side only: a table says what it does there; a middle of fixed nodes is a fixed node
    write("middle.csv", "NODES\n0,0,0,1,1\n1,1,1,1,1\n2,0,1.5,1,1\n3,0.75,1.5,0,0\n4,2,0,0,0\nSPRINGS\n"
          "2-3, PIECEWISE(k_i=[1e-6; 1]; u_i=[0.01]; us=0.005; mode=1), 0.5\n3-4, 2\nPOINT2MID Y DISTANCE SPRINGS\n"
          "3-0-1, CONTACT(f0=0.5;uc=0.1;delta=0)\nMID2POINT X DISTANCE FLEXELS\n3-0-2, 4, -0.25\n4-3-0, 1\n")
    scene, said = imported("middle.csv")
    check("points: [[-0.01, -1e-8], [0, 0], [0.01, 1e-8], [0.02, 0.01000001]]" in scene, scene)
    check("m1: {position: [0.5, 0.5], fixed: both}" in scene and "d1: {nodes: [m1, n3], along: y" in scene, scene)
    check("d2: {nodes: [n3, m2], along: x, stiffness: 4, rest_distance: -0.25}" in scene, scene)
    check("a distance from the middle of nodes that move" in said and "d3" not in scene, said)
    # curves that do not fold back are tables, or curves by their control points, as those that do; gases are gases
    scene, said = imported("curves.csv", text="""NODES
0,0,0,1,1
1,1,0,0,1
2,0,1,1,0
3,0,2,1,1
4,3,0,1,1
5,4,0,0,1
6,3,1,1,1
SPRINGS
0-1, PIECEWISE(k_i=[2; -1; 4]; u_i=[0.1; 0.2]; us=0.01)
0-2, BEZIER(u_i=[0.1; 0.2; 0.6]; f_i=[3; -2; 4])
4-5, ZIGZAG(u_i=[0.1; 0.3]; f_i=[1; 0.5]; epsilon=0.1; mode=-1)
5-6, BEZIER2(u_i=[3; -2; 1]; f_i=[4; -4; 0]; mode=-1)
4-6, ZIGZAG2(u_i=[1; 0.5; 2]; f_i=[2; 0.5; 3]; epsilon=0.25)
AREA SPRINGS
4-5-6, ISENTROPIC(n=2; R=3; T0=0.5; gamma=1.5), 0.7
LOADING
1, X, 1
2, Y, 1
""")
    numbers = [float(x) for x in re.findall(r"-?[\d.]+", re.search(r"s1: .*points: (.*)", scene).group(1))]
    same_numbers(numbers, [-0.4, -0.9, -0.2, -0.1, -0.1, -0.2, 0, 0, 0.1, 0.2, 0.2, 0.1, 0.4, 0.9], 1e-12, "pieces")
    check("points: [[-0.3, -0.5], [-0.1, -1], [0, 0], [0.1, 1]]" in scene, scene)
    check("law: {kind: curve, control_points: [[0, 0], [0.1, 3], [0.2, -2], [0.6, 4]], mirrored: yes}" in scene, scene)
    check("law: {kind: curve, control_points: [[-1, 0], [2, 4], [-3, -4], [0, 0]]}" in scene, scene)
    check("law: {kind: curve, points: [[0, 0], [1, 2], [0.5, 0.5], [2, 3]], rounding: 0.25, mirrored: yes}" in scene,
          scene)
    pressure = 3 / 0.7 * (0.7 / 0.5) ** 1.5
    gas = re.search(r"gas: \{kind: isentropic, pressure: (\S+), outside: (\S+), exponent: 1.5\}", scene)
    same_numbers([float(x) for x in gas.groups()], [pressure, 3 / 0.7], 1e-12, "a gas")


RODS = """nodes: {a: [-5, 0, 2], b: [5, 0, 2], c: [5, 10, 2], d: [-5, 10, 2]}
pair_groups:
  cross rod: [[a, c], [b, d]]
  edge string:
    - [a, b]
    - [b, c]
    - [c, d]
    - [d, a]
  string: [[a, c]]
  box: [[a, b]]
builders:
  rod: {class: tgRodInfo, parameters: {density: 0.688, radius: 0.31, friction: 0.9}}
  edge: {class: tgBasicActuatorInfo, parameters: {stiffness: 500, damping: 4, pretension: 100, history: 1}}
  box: {class: tgBoxInfo}
"""


def ntrt():
    scene, said = imported("rods.yaml", text=RODS)
    for text in ("not imported: 'friction'", "not imported: 'history'", "pairs of the class 'tgBoxInfo'"):
        check(text in said, f"not listed: {text}: {said}")
    check("rods.yaml:12:" in said, said)
    check("bars: rigid" in scene and "c: {position: [0.5, 1]}" in scene, "decimetres")
    mass = float(re.search(r"cross_rod-1: .*mass: ([\d.e-]+) kg", scene).group(1))
    same_numbers([mass], [0.688 * math.pi * 0.31 ** 2 * math.hypot(10, 10)], 1e-12, "the mass of a rod")
    check("edge_string-1: {kind: cable, nodes: [a, b], stiffness: 500 N/m, damping: 4 N s/m, pretension: 10 N}"
          in scene, "a force of decimetres")
    check("string-1: {kind: cable, nodes: [a, c], stiffness: 1000 N/m, damping: 10 N s/m, pretension: 0 N}"
          in scene, "the default builder")
    run("rigidity", "scene.yaml", "--quiet")
    write("upright.yaml", RODS.replace("-5, ", "7, ").replace("[5, 0, 2]", "[7, 0, 12]")
          .replace("[5, 10, 2]", "[7, 10, 12]"))
    check("c: {position: [1.2, 1]}" in imported("upright.yaml")[0], "the plane z y")
    # structures in others: turned about their middle, scaled, moved on from each other, bonds between neighbours
    os.makedirs(path("base"), exist_ok=True)
    write("base/rods.yaml", RODS.replace("  box: [[a, b]]\n", "").replace("  box: {class: tgBoxInfo}\n", ""))
    scene, said = imported("row.yaml", "base/rods.yaml", text="""substructures:
  t1/t2/t3: {path: ../base/rods.yaml, offset: [20, 0, 0]}
  top:
    path: ./base/rods.yaml
    translation: [20, 15, 0]
    scale: 0.5
    rotation: {axis: [0, 0, 3], angle: 90}
bond_groups:
  string:
    t1/t2/t3/node_node: [[b, a], [c, d]]
  t2/top/node_node:
    stiff string: [[d, a]]
builders:
  stiff: {class: tgBasicActuatorInfo, parameters: {stiffness: 7}}
  rod: {class: tgRodInfo, parameters: {density: 2, radius: 0.5}}
""")
    places = {"t1.a": [-0.5, 0], "t2.a": [1.5, 0], "t3.c": [4.5, 1]}
    # turned by 90 degrees about (0, 5), a comes to (5, 0), halved to (2.5, 2.5), and moved to (22.5, 17.5)
    places["top.a"] = [2.25, 1.75]
    for node, place in places.items():
        found = re.search(rf"  {node}: \{{position: \[(.*), (.*)\]\}}", scene)
        same_numbers([float(x) for x in found.groups()], place, 1e-12, f"place of {node}")
    check(scene.count("kind: bar") == 8 and scene.count("kind: cable") == 25, scene)
    check("t1_t2_string-1: {kind: cable, nodes: [t1.b, t2.a]" in scene, scene)
    check("t2_t3_string-2: {kind: cable, nodes: [t2.c, t3.d]" in scene, scene)
    check("t2_top_stiff_string-1: {kind: cable, nodes: [t2.d, top.a], stiffness: 7 N/m" in scene, scene)
    mass = float(re.search(r"top.cross_rod-1: .*mass: ([\d.e-]+) kg", scene).group(1))
    same_numbers([mass], [2 * math.pi * 0.25 * math.hypot(5, 5)], 1e-12, "a rod of an outer builder, halved")
    write("outer.yaml", "substructures: {left/right: {path: row.yaml, offset: [100, 0, 0]}}\nbond_groups:\n"
          "  string: {left/right/node_node: [[t3.b, t1.a], [top.a, top.a]]}\n")
    scene, said = imported("outer.yaml", "row.yaml", "base/rods.yaml")
    check("left_right_string-1: {kind: cable, nodes: [left.t3.b, right.t1.a]" in scene, scene)
    for change, words in (("t1/t2/t3/node_node: [[b, a], [c, d]]", "t1/t2/node_edge: [[b, a/d]]"),
                          ("[[b, a], [c, d]]", "[[b, e]]"), ("t2/top/node_node", "t2/nowhere/node_node"),
                          ("axis: [0, 0, 3]", "axis: [0, 0, 0]"), ("axis: [0, 0, 3]", "axis: [0, 1, 0]"),
                          ("scale: 0.5", "size: 0.5"), ("t2/top/node_node", "t2/node_node"), ("path: ./base/rods.yaml", "path: [1]"),
                           ("../base/rods.yaml", "../base/sticks.yaml")):
        text = read("row.yaml").decode()
        write("bad.yaml", text.replace(change, words))
        message = formats("import", "bad.yaml", "base/rods.yaml", "-o", "none.yaml", code=2).stderr
        check("bad.yaml:" in message or "rods.yaml:1:" in message, message)
    write("deep.yaml", "substructures: {x: {path: deep.yaml}}\n")
    check("more than 16 deep" in formats("import", "deep.yaml", "-o", "none.yaml", code=2).stderr, "a circle")
    write("twice.yaml", "substructures: {x: {path: row.yaml}}\nbond_groups: {string: {x/x/node_node: [[a, a]]}}\n")
    check("nodes are called 'a'" in
          formats("import", "twice.yaml", "row.yaml", "base/rods.yaml", "-o", "none.yaml", code=2).stderr, "which a")


def tables():
    write("nodes.csv", "node,x [mm],y [m],fixed,mass [g],colour\nA,0,0,both,,red\nB,1000,0,y,1000,\n"
          "C,1000,1,no,1000,\nD,0,1,,1000,\n")
    write("members.csv", "member,kind,from,over,to,stiffness [N/cm],pretension [N],rest_length [m]\n"
          "bottom,cable,A,,B,1,,0.95\nright,cable,B,,C,1,,0.95\ntop,cable,C,,D,1,5,\nleft,cable,D,,A,1,,0.95\n"
          "f,bar,B,,D,10,,\nr,bar,A,,C,10,0,\n")
    for files in (("nodes.csv", "members.csv"), ("members.csv", "nodes.csv")):
        scene, said = imported(files[0], files[1])
        check("nodes.csv:1:34: note: not imported: the column 'colour'" in said, said)
        is_snelsons_x("energies of Snelson's X as tables")
        modes = [answer("modes", m, "--at", "equilibrium-1")["modes"]
                 for m in ("scene.yaml", f"{gallery}/x-frame.yaml")]
        same_numbers([m["frequency"] for m in modes[0]], [m["frequency"] for m in modes[1]], 1e-9, "modes")
    # what strut itself lists can be read again, but for the stiffness
    formats("build", f"{gallery}/x-frame.yaml", "-o", "build")
    rows = read("build/members.csv").decode().splitlines()
    imported("listed.csv", "build/nodes.csv", text="\n".join([rows[0] + ",stiffness [N/m]"] + [
        row + (",1000" if ",bar," in row else ",100") for row in rows[1:]]) + "\n")
    is_snelsons_x("energies of a build list")


def refused(name, text, *expected, words=()):
    write(name, text)
    message = formats("import", name, *words, "-o", "none.yaml", code=2).stderr
    for part in expected:
        check(part in message, f"{name}: {part!r} is not said of {text[:60]!r}: {message}")
    check(not os.path.exists(path("none.yaml")), f"{name}: a scene is written")


def bad_input():
    for old, new, part in (("[1, 1]", "[1, 1, 3]", "2:34: error: node 'C' is not in the plane"),
                           ("[C, D]", "[C, E]", "7:11: error: there is no node 'E'"),
                           ("type: bar", "type: rod", "expected 'type: bar'"),
                           ("stiffness: 1000", "stiffness: much", "expected a number for the stiffness"),
                           ("  rope: {", "  ropes: {", "'rope' has no builder"),
                           ("pin:", "pins:", "found 'pins'"), ("control:", "surface:", "not planar"),
                           ("stiffness: 100,", "stiffness: -100,", "negative"),
                           ("A: [0, 0]", "A: [0, .nan]", "expected a number")):
        refused("bad.yaml", BOX.replace(old, new, 1), part)
    for old, new, part in (("[5, 0, 2]", "[5, 0, 3]", "strut is planar"), ("[d, a]", "[d, x]", "8:11: error"),
                           ("builders:", "substructures:", "expected path, rotation, translation, scale or offset"),
                           ("class: tgRodInfo, ", "", "'class'"), ("radius: 0.31", "radius: r", "a number"),
                           ("[-5, 10, 2]", "[-5, 10]", "three coordinates"), ("nodes:", "knots:", "'knots'")):
        refused("bad.yaml", RODS.replace(old, new, 1), part)
    for old, new, part in (("0-1, side", "0-1, sid", ":15:6: error: 'sid' is no expression"),
                           ("0-1, side", "0-9, side", "there is no node 9"), ("0-1, side", "0, side", "numbers"),
                           ("3, Y, -10", "3, Z, -10", "X or Y"), ("1, w/2, h, 1, 0", "1, w/2, h, 1", "a node"),
                           ("1, w/2, h, 1, 0", "1, w/2, h, 1, 2", "expected 0 or 1"),
                           ("1, w/2, h, 1, 0", "0, w/2, h, 1, 0", "given twice"),
                           ("PARAMETERS", "", "expected a section"), ("w/2", "w/0", "no expression"),
                           ("w, 8.0", "w, __import__('os')", "no expression"), ("w/2", "(" * 300, "expression")):
        refused("bad.csv", ARCH.replace(old, new, 1), part, "bad.csv:")
    refused("bad.csv", "NODES\n0,0,0,1,1\n", "no member")
    refused("bad.csv", "NODES\n99999999999999999999,0,0,1,1\n", "expected a node")
    good = "member,kind,from,to,stiffness [N/m]\nm,bar,a,b,1\n"
    for text, part in (("node,x,y\na,0,0\nb,1,one\n", "bad.csv:3:5: error: expected a number for 'y'"),
                       ("node,x [kg],y\na,0,0\nb,1,1\n", "expected a length"),
                       ("node,x,y\na,0,0\na,1,1\n", "given twice"), ("node,x\na,0\nb,1\n", "no column 'y'"),
                       ("node,x,y,fixed\na,0,0,both\nb,1,1,z\n", "no, x, y or both"),
                       ("node,x,y\na,0,0\n", "there is no node 'b'"), ("node,x,y\na,0,0\nb,1\n", "3")):
        write("good.csv", good)
        refused("bad.csv", text, part, words=("good.csv",))
    write("good.csv", "node,x,y,fixed,mass\na,0,0,both,\nb,1,1,no,1\n")
    for text, part in ((good.replace("bar", "rod"), "bad.csv:2:3: error: expected bar, spring or cable"),
                       (good.replace(",1\n", ",1 N/m\n"), "expected a number"), (good.replace("a,b", "a,"), "lacks"),
                       (good.replace("[N/m]", "[N]"), "stiffness"), (good.replace("kind", "sort"), "'kind'")):
        refused("bad.csv", text, part, words=("good.csv",))
    for text in ("[" * 5000, b"\x00\xff\x00", "a: 1\n", ""):  # none of the formats
        refused("odd", text, "odd:")
    refused("odd", "- a\n", "expected a mapping", words=("--from", "ntrt"))
    refused("odd", b"\xff\xfe", "odd", words=("--from", "tensegritysim"))
    refused("odd", b"NODES\n\xff,0,0,1,1\n", "odd:2:1", words=("--from", "springable"))


def files():
    write("box.yaml", BOX)
    write("mine.yaml", "precious")
    formats("import", "box.yaml", "-o", "mine.yaml", code=4)
    check(read("mine.yaml") == b"precious", "somebody else's file")
    printed = formats("import", "box.yaml").stdout
    formats("import", "box.yaml", "-o", "scene.yaml")
    check(read("scene.yaml").decode() == printed, "the same scene on standard output")
    for words, code, text in ((("box.yaml",) * 3, 1, "one file"), (("box.yaml",) * 17, 1, "one file"),
                              (("box.yaml", "--unit", "3 kg"), 1, "unit"), (("box.yaml", "--unit", "0 m"), 1, "above 0"),
                              (("box.yaml", "box.yaml"), 1, "one file"), (("none.yaml",), 4, "none.yaml"),
                              (("box.yaml", "--from", "urdf"), 1, "ntrt")):
        done = formats("import", *words, code=code)
        check(text in done.stderr, f"{words}: {done.stderr}")


tensegritysim()
springable()
ntrt()
tables()
bad_input()
files()
finish()

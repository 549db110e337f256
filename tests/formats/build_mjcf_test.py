# SPDX-License-Identifier: GPL-3.0-or-later
# The build list: lengths by closed forms, drawings at true scale, read back. MuJoCo's format: its free
# vibration and its motions are strut's, where a MuJoCo is here (Python's, Debian's libmujoco-dev, or npm's
# mujoco-js named by STRUT_MUJOCO_JS); what it cannot say is refused or listed.
#
#   python3 build_mjcf_test.py STRUT        (with the Python package of the same build)
import math
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree as xml

from testing import answer, check, finish, formats, models, path, rows, run, write

here = os.path.dirname(os.path.realpath(__file__))
SVG = "{http://www.w3.org/2000/svg}"


# Names and a title that XML and DXF must each write in their own way; a cable over a guide; a driven spring.
write("frame.yaml", """strut: 1
name: A < B & C
nodes: {a.1: {position: [0, 0], fixed: both, mass: 1 kg}, b: {position: [300 mm, 0], fixed: y, mass: 1 kg},
        "ç": {position: [0, 400 mm], mass: 1 kg}}
members: {bar: {kind: bar, nodes: [a.1, b], stiffness: 1000 N/m, rest_length: 310 mm},
          post: {kind: bar, nodes: [a.1, "ç"], stiffness: 1000 N/m},
          x-y: {kind: cable, nodes: [b, "ç"], stiffness: 500 N/m, pretension: 10 N},
          run: {kind: cable, nodes: [a.1, b, "ç"], stiffness: 400 N/m, rest_length: 780 mm},
          pull: {kind: spring, nodes: [b, "ç"], stiffness: 50 N/m, rest_length: 0.4 m}}
actuators: {drive: {member: pull, signal: {sine: {amplitude: 1 mm, frequency: 1 Hz}}}}
""")


def svg_lines(file):
    """Of each member: the points [mm], by the page's own width and view box."""
    root = xml.parse(path(file)).getroot()
    box = [float(x) for x in root.get("viewBox").split()]
    scale = [float(re.fullmatch(r"([\d.]+)mm", root.get(k)).group(1)) / box[i]
             for k, i in (("width", 2), ("height", 3))]
    lines = {}
    for line in root.iter(SVG + "polyline"):
        points = [[float(v) * s for v, s in zip(p.split(","), scale)] for p in line.get("points").split()]
        lines[line.find(SVG + "title").text] = points
    ruler = next(root.iter(SVG + "line"))
    return lines, (float(ruler.get("x2")) - float(ruler.get("x1"))) * scale[0], root


def dxf_entities(file):
    with open(path(file), encoding="ascii") as stream:
        words = stream.read().splitlines()
    pairs = list(zip(words[::2], words[1::2]))
    entities = []
    for code, value in pairs:
        if code == "0":
            entities.append({"0": value})
        else:
            entities[-1].setdefault(code, value)
    return entities, pairs


def length_of(points):
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def build_list():
    out = formats("build", "frame.yaml", "-o", "build", "--allowance", "15 mm").stdout
    check("x-y" in out, "the table")
    members = {r["member"]: r for r in rows("build/members.csv")}
    made = {"bar": 0.310, "post": 0.4, "x-y": 0.5 - 10 / 500, "run": 0.78, "pull": 0.4}
    for name, value in made.items():
        row = members[name]
        check(abs(float(row["made length [m]"]) - value) < 1e-12, f"{name} is made {row}")
        cable = row["kind"] == "cable"
        check(row["cut length [m]"] == "" if not cable
              else abs(float(row["cut length [m]"]) - value - 0.03) < 1e-12, f"{name} is cut {row}")
        check(row["driven"] == ("yes" if name == "pull" else "no"), f"driven: {row}")
    check(members["run"]["over"] == "b" and members["bar"]["from"] == "a.1", "the nodes of members")
    check(abs(float(members["run"]["length in shape [m]"]) - 0.8) < 1e-12, "a length over a guide")
    check(abs(float(members["bar"]["force in shape [N]"]) + 10) < 1e-9, "the force of a pressed bar")
    nodes = {r["node"]: r for r in rows("build/nodes.csv")}
    check([nodes[n]["holes"] for n in ("a.1", "b", "ç")] == ["3", "4", "4"], f"holes: {nodes}")
    check(nodes["b"]["fixed"] == "y" and nodes["b"]["cables"] == "2", f"{nodes['b']}")


def drawings_are_at_true_scale():
    lines, ruler, root = svg_lines("build/drawing.svg")
    for name, row in ((r["member"], r) for r in rows("build/members.csv")):
        want = 1000 * float(row["length in shape [m]"])
        check(abs(length_of(lines[name]) - want) < 1e-4, f"{name} is {length_of(lines[name])} mm, not {want}")
    check(abs(ruler - 100) < 1e-9, f"the ruler has {ruler} mm")
    texts = [t.text for t in root.iter(SVG + "text")]
    check("x-y  510.00" in texts and "bar  310.00" in texts and "ç" in texts, f"labels: {texts}")
    entities, pairs = dxf_entities("build/drawing.dxf")
    check(("9", "$INSUNITS") in pairs and pairs[pairs.index(("9", "$INSUNITS")) + 1] == ("70", "4"),
          "the unit of the DXF is the millimetre")
    bars = [e for e in entities if e["0"] == "LINE" and e["8"] == "BARS"]
    got = sorted(math.dist((float(e["10"]), float(e["20"])), (float(e["11"]), float(e["21"]))) for e in bars)
    check(len(got) == 2 and abs(got[0] - 300) < 1e-4 and abs(got[1] - 400) < 1e-4, f"bars in the DXF: {got}")
    holes = [(float(e["10"]), float(e["20"])) for e in entities if e["0"] == "CIRCLE"]
    check(sorted(holes) == [(0, 0), (0, 400), (300, 0)], f"holes in the DXF: {holes}")
    check(any(e.get("1") == "\\U+00E7" for e in entities), "a name that is not ASCII")


def built_or_refused():
    formats("build", "frame.yaml", "-o", "build")  # its own files
    write("mine/members.csv", "precious") if os.makedirs(path("mine")) is None else None
    formats("build", "frame.yaml", "-o", "mine", code=4)
    check(os.listdir(path("mine")) == ["members.csv"], f"{os.listdir(path('mine'))}")
    rigid = f"{models}/gallery/x-frame.yaml"
    formats("build", rigid, "-o", "x")
    for words, code, text in (
            (("build",), 1, "-o"),
            (("build", "-o", "y", "--allowance", "1 kg"), 1, "allowance"),
            (("build", "-o", "y", "--allowance=-1 mm"), 1, "0 or more"),
            (("build", "-o", "y", "--prefix", "z"), 1, "--prefix"),
            (("mjcf", "-o", "y.xml", "--allowance", "1 mm"), 1, "--allowance"),
            (("mjcf", "-o", "y.xml", "--at", "x"), 1, "--at"),
            (("mjcf",), 1, "-o"),
            (("urdf", "-o", "y"), 1, "vtk")):
        done = formats(words[0], "frame.yaml", *words[1:], code=code)
        check(text in done.stderr, f"{words}: {done.stderr}")
    write("bare.yaml", "strut: 1\nnodes: {a: {position: [0, 0], fixed: both}}\n")
    formats("build", "bare.yaml", "-o", "y", code=2)
    write("zero.yaml", "strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0]}}\n"
          "members: {m: {kind: cable, nodes: [a, b], stiffness: 10 N/m, rest_length: 0 m}}\n")
    check("'m' cannot be made" in formats("build", "zero.yaml", "-o", "y", code=2).stderr, "a rest length of 0")
    check(not os.path.exists(path("y")), "nothing is left")


# ---- MuJoCo ----

def find_mujoco():
    """A function of a file, a step and a duration that gives rows of numbers, and the joints' names."""
    def reported(words, **more):
        def simulate(file, step, seconds):
            done = subprocess.run([*words, path(file), str(step), str(seconds)], capture_output=True,
                                  text=True, timeout=60, **more)
            if done.returncode:
                raise RuntimeError(done.stderr)
            rows = [line.split(",") for line in done.stdout.splitlines()]
            return rows[0], [[float(x) for x in row] for row in rows[1:]]
        return simulate

    if os.environ.get("STRUT_MUJOCO_JS") and shutil.which("node"):
        return reported(["node", os.path.join(here, "mujoco_run.mjs")])
    try:
        import mujoco
    except ImportError:
        compiler = shutil.which("cc")
        made = compiler and subprocess.run([compiler, os.path.join(here, "mujoco_run.c"), "-o",
                                            path("mujoco_run"), "-lmujoco"], capture_output=True)
        return reported([path("mujoco_run")]) if made and made.returncode == 0 else None

    def simulate(file, step, seconds):
        try:
            model = mujoco.MjModel.from_xml_path(path(file))
        except ValueError as error:
            raise RuntimeError(str(error)) from error
        data = mujoco.MjData(model)
        model.opt.timestep = step
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        rows = []
        for _ in range(round(seconds / step)):
            mujoco.mj_step(model, data)
            rows.append([data.time, *data.qpos])
        return ["time", *(model.joint(i).name for i in range(model.njnt))], rows
    return simulate


def frequency(times, values):
    """From the first to the last upward zero crossing, each by a straight line."""
    crossings = [t0 - v0 * (t1 - t0) / (v1 - v0)
                 for t0, v0, t1, v1 in zip(times, values, times[1:], values[1:]) if v0 < 0 <= v1]
    return (len(crossings) - 1) / (crossings[-1] - crossings[0])


def string_text(kind):
    return f"""strut: 1
name: A "string"
mass_model: lumped
nodes:
  left: {{position: [-1, 0], fixed: both}}
  right: {{position: [1, 0], fixed: both}}
  mid: {{position: [0, 0], mass: 0.8 kg}}
members:
  one: {{kind: {kind}, nodes: [left, mid], stiffness: 50 N/m, pretension: 20 N, mass: 0.2 kg}}
  two: {{kind: {kind}, nodes: [mid, right], stiffness: 50 N/m, pretension: 20 N, mass: 0.2 kg}}
initial: {{velocities: {{mid: [0, 1 mm/s]}}}}
solver: {{step: 1 ms}}
run: {{duration: 3 s}}
"""


def vibrates_alike(simulate, kind):
    write("string.yaml", string_text(kind))
    formats("mjcf", "string.yaml", "-o", "string.xml")
    names, motion = simulate("string.xml", 1e-3, 10)
    at = names.index("mid.y")
    got = frequency([r[0] for r in motion], [r[at] for r in motion])
    exact = math.sqrt(2 * 20 / 1 / 1.0) / (2 * math.pi)  # 2 T / L over the mass and half of the members'
    modes = answer("modes", "string.yaml")
    ours = modes["modes"][0]["frequency"]
    check(abs(ours / exact - 1) < 1e-9, f"strut's frequency {ours}, exact {exact}")
    check(abs(got / exact - 1) < 1e-3, f"MuJoCo's frequency {got}, exact {exact}")


def moves_alike(simulate, text, seconds, tolerance, name):
    write(name, text)
    formats("mjcf", name, "-o", "motion.xml")
    names, motion = simulate("motion.xml", 1e-4, seconds)
    run("run", name, "-o", "motion", "--quiet")
    end = rows("motion/nodes.csv")[-1]
    for joint, value in zip(names[1:], motion[-1][1:]):
        node, axis = joint.rsplit(".", 1)
        moved = float(end[f"{node}.{axis} [m]"]) - START[name][node]["xy".index(axis)]
        check(abs(moved - value) < tolerance, f"{name}: {joint} moved {value} in MuJoCo, {moved} in strut")


START = {"hanging.yaml": {"m": (0.1, -1)}, "frame-cables.yaml": {"n2": (1, 0), "n3": (1, 1), "n4": (0, 1)}}

HANGING = """strut: 1
gravity: [0, -9.81 m/s^2]
mass_model: lumped
nodes: {top: {position: [0, 0], fixed: both}, wall: {position: [1, 0], fixed: both},
        m: {position: [0.1, -1], mass: 2 kg}}
members: {rope: {kind: spring, nodes: [top, m], stiffness: 300 N/m, damping: 3 N s/m, rest_length: 1 m},
          side: {kind: spring, nodes: [wall, m], stiffness: 40 N/m, rest_length: 1.2 m}}
loads: {push: {node: m, force: [4 N, -1 N]}}
solver: {step: 0.1 ms}
run: {duration: 1 s}
"""
CABLES = """strut: 1
nodes: {n1: {position: [0, 0], fixed: both}, n2: {position: [1, 0], mass: 1 kg, fixed: y},
        n3: {position: [1, 1], mass: 1 kg}, n4: {position: [0, 1], mass: 1 kg}}
members: {right: {kind: cable, nodes: [n2, n3], stiffness: 100 N/m, rest_length: 0.95 m},
          top: {kind: cable, nodes: [n3, n4], stiffness: 100 N/m, rest_length: 0.95 m},
          left: {kind: cable, nodes: [n4, n1, n2], stiffness: 100 N/m, rest_length: 1.9 m},
          falling: {kind: bar, nodes: [n2, n4], stiffness: 1000 N/m},
          rising: {kind: bar, nodes: [n1, n3], stiffness: 1000 N/m}}
initial: {velocities: {n3: [2 m/s, -1 m/s]}}
solver: {step: 0.1 ms}
run: {duration: 1 s}
"""


def mjcf_motions():
    simulate = find_mujoco()
    if not simulate:
        print("there is no MuJoCo here: its runs are left out")
        return False
    vibrates_alike(simulate, "spring")
    moves_alike(simulate, HANGING, 1, 1e-6, "hanging.yaml")
    try:
        vibrates_alike(simulate, "cable")
        moves_alike(simulate, CABLES, 1, 1e-4, "frame-cables.yaml")  # cables go slack and taut
    except RuntimeError as error:
        check("springlength" in str(error), f"{error}")
        print("this MuJoCo has no springs that only pull (it is older than 2.3): cables are left out")
    return True


def mjcf_says_or_tells():
    done = formats("mjcf", f"{models}/crawler/crawler.yaml", "-o", "crawler.xml", code=0)
    reported = done.stderr
    for text in ("signals of actuators", "contacts", "consistent masses"):
        check(text in reported, f"not reported: {text}: {reported}")
    root = xml.parse(path("crawler.xml")).getroot()
    check(root.find("worldbody/geom[@type='plane']") is not None, "the ground")
    check(len(root.findall("actuator/motor")) > 0, "the drive")
    for part, word in (("hinges: {h: {nodes: [a, b, c], stiffness: 1}}", "hinges"),
                       ("collisions: {c: {nodes: [a, c], thickness: 1 mm, stiffness: 1 N/m}}", "collisions"),
                       ("rayleigh: {mass: 1 Hz}", "Rayleigh")):
        write("odd.yaml", "strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1},"
              " c: {position: [1, 1], mass: 1}}\nmembers: {m: {kind: bar, nodes: [a, b], stiffness: 1},"
              f" n: {{kind: bar, nodes: [b, c], stiffness: 1}}}}\n{part}\n")
        done = formats("mjcf", "odd.yaml", "-o", "odd.xml", code=2)
        check(word in done.stderr, f"{part}: {done.stderr}")
    write("light.yaml", "strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0]}}\n"
          "members: {m: {kind: bar, nodes: [a, b], stiffness: 1 N/m}}\n")
    check("'b' has no mass" in formats("mjcf", "light.yaml", "-o", "odd.xml", code=2).stderr, "a node without mass")
    check(not os.path.exists(path("odd.xml")), "nothing is written")
    write("mine.xml", "<precious/>")
    write("string.yaml", string_text("spring"))
    formats("mjcf", "string.yaml", "-o", "mine.xml", code=4)


build_list()
drawings_are_at_true_scale()
built_or_refused()
mjcf_says_or_tells()
mjcf_motions()
finish()

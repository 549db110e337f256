# SPDX-License-Identifier: GPL-3.0-or-later
# strut export --format code: the C that it writes compiles without a warning, and steps with strut's bits: on this
# machine, and on a Cortex-M4 under QEMU where arm-none-eabi-gcc, newlib and qemu-system-arm are here (Debian's
# gcc-arm-none-eabi, libnewlib-arm-none-eabi, qemu-system-arm). Floats stay near; what there is no code for is
# refused by the name of its key.
#
#   python3 code_test.py STRUT
import csv
import os
import re
import shutil
import subprocess

from exported_code import (
    STRICT, build, code_rows, compare, compare_model, compilers, here, same_rows, scene, strut_rows)
from testing import check, finish, models, path, run, write


# Every kind of signal, slack cables, several drives of a member, a slope, a belt and friction of every kind.
def terms(friction, ground, method, step, steps, every):
    return f"""strut: 1
name: 'odd */ title \\\\ of "terms"'
mass_model: lumped
gravity: [0.5 m/s^2, -9.81 m/s^2]
nodes:
  a-b: {{position: [0, 0.1 m], mass: 0.2 kg}}
  a_b: {{position: [0.5 m, 0.1 m], mass: 0.3 kg}}
  top: {{position: [0.25 m, 0.4 m], mass: 0.1 kg}}
  wall: {{position: [1 m, 1 m], fixed: both}}
  rail: {{position: [0.6 m, 0.8 m], fixed: x, mass: 0.1 kg}}
members:
  base: {{kind: bar, nodes: [a-b, a_b], stiffness: 2000 N/m, damping: 1 N s/m, mass: 0.1 kg}}
  left: {{kind: spring, nodes: [a-b, top], stiffness: 500 N/m, damping: 0.5 N s/m}}
  right: {{kind: spring, nodes: [a_b, top], stiffness: 500 N/m}}
  rope: {{kind: cable, nodes: [top, wall], stiffness: 300 N/m, damping: 1 N s/m, rest_length_ratio: 0.99}}
  hang: {{kind: cable, nodes: [rail, top], stiffness: 300 N/m, rest_length_ratio: 0.95}}
ground: {{stiffness: 5000 N/m, {ground}, friction: {friction}}}
signals:
  wave: {{sine: {{amplitude: 20 mm, frequency: 3 Hz, phase: 30 deg, start: 20 ms, stop: 700 ms}}}}
  pulse: {{half_sine: {{amplitude: 30 mm, frequency: 2 Hz, start: 100 ms}}}}
  rise: {{ramp: {{amplitude: 10 mm, start: 100 ms, stop: 400 ms}}}}
  points: {{table: [[0, 0], [0.1 s, 10 mm], [0.35 s, -10 mm], [0.6 s, 5 mm]]}}
actuators:
  one: {{member: left, signal: {{sum: [wave, rise]}}}}
  two: {{member: left, signal: pulse}}
  three: {{member: rope, signal: points}}
loads:
  push: {{node: a_b, force: [1 N, 0], signal: {{square: {{amplitude: 1, frequency: 4 Hz}}}}}}
  hold: {{node: top, force: [0, 0.5 N], signal: {{constant: 1}}}}
initial: {{velocities: {{a-b: [0.3 m/s, -1 m/s], top: [0, 2 m/s]}}}}
solver: {{integrator: {method}, step: {step!r} s}}
run: {{duration: {steps * step!r} s}}
output: {{every: {every * step!r} s, channels: [position, energy]}}
"""


# A chain of bars with consistent masses, more than have a dense inverse; and free in x alone at one end.
def chain(method, step, steps, every):
    nodes = "".join(f"  n{k}: {{position: [{k} m, 0]{', fixed: both' if k == 0 else ''}"
                    f"{', fixed: y' if k == 12 else ''}}}\n" for k in range(13))
    members = "".join(f"  m{k}: {{kind: bar, nodes: [n{k}, n{k + 1}], stiffness: 1000 N/m, mass: 1 kg}}\n"
                      for k in range(12))
    return (f"strut: 1\ngravity: [0, -9.81 m/s^2]\nnodes:\n{nodes}members:\n{members}"
            f"solver: {{integrator: {method}, step: {step!r} s}}\nrun: {{duration: {steps * step!r} s}}\n"
            f"output: {{every: {every * step!r} s, channels: [position]}}\n")


def test_terms():
    laws = {"karnopp": ("{law: karnopp, mu_static: 0.5, mu_kinetic: 0.3, stick_velocity: 1 mm/s}",
                        "damping: 5 N s/m, slope: 5 deg, belt_speed: 0.1 m/s"),
            "smooth": ("{law: smooth, mu: 0.4, width: 1 mm/s}",
                       "damping_law: hunt_crossley, dissipation: 0.5 s/m, height: 1 mm"),
            "forward": ("{law: karnopp, mu_forward: 0.2, mu_backward: 0.6, stick_velocity: 1 mm/s}",
                        "damping: 5 N s/m")}
    for n, (name, (friction, ground)) in enumerate(laws.items()):
        method = ("rk4", "verlet", "rk4")[n]
        write(name + ".yaml", terms(friction, ground, method, 2e-4, 4000, 100))
        compare(name + ".yaml", method, 2e-4, 4000, 100, compilers[n % max(1, len(compilers)):][:1])
    write("chain.yaml", chain("rk4", 1e-3, 2000, 100))
    compare("chain.yaml", "rk4", 1e-3, 2000, 100, compilers[:1])


# Every strain, law and kind of actuator, and expressions of every operation; the motion is large enough for stops,
# collisions and the pieces of all laws.
ELEMENTS = """strut: 1
nodes:
  a: {position: [0, 0], fixed: both}
  p: {position: [1, 0.5], mass: 1}
  q: {position: [2, 0.5], mass: 1}
  b: {position: [3, 0], mass: 1}
  c: {position: [1.5, 1.5], mass: 0.5}
members:
  tendon: {kind: cable, nodes: [a, p, q, b], stiffness: 100, damping: 1, mass: 0.1, rest_length: 3}
  plain: {kind: spring, nodes: [a, p], stiffness: 10, damping: 0.1}
  one_way: {kind: spring, nodes: [p, q], stiffness: 10, law: compression_only}
  other_way: {kind: bar, nodes: [q, b], stiffness: 10, law: {carries: tension}}
  stopped: {kind: spring, nodes: [a, q], stiffness: 10, shortest: 1.9 m, longest: 2.1 m,
            stop_stiffness: 500 N/m, stop_damping: 3 N s/m}
  bilinear: {kind: spring, nodes: [p, b], stiffness: 10, law: {kind: bilinear, knee: 20 mm, second_stiffness: 30 N/m}}
  play: {kind: spring, nodes: [a, b], stiffness: 10, law: {kind: play, gap: 5 mm}}
  polynomial: {kind: cable, nodes: [a, p], law: {kind: polynomial, coefficients: [10 N/m, 0, 200 N/m^3]}}
  logarithmic: {kind: spring, nodes: [p, q], axial_stiffness: 10 N, law: logarithmic}
  exponential: {kind: spring, nodes: [q, b], stiffness: 10, law: {kind: exponential, scale: 50 mm, carries: both}}
  table: {kind: spring, nodes: [a, q], law: {kind: table, points: [[-10 mm, -1 N], [0, 0], [20 mm, 5 N]]}}
  smooth: {kind: spring, nodes: [p, b], law: {kind: table, smooth: yes, points: [[-10 mm, -1 N], [0, 0], [20 mm, 5 N]]}}
  up: {kind: spring, nodes: [p, c], stiffness: 40, damping: 0.2}
  reeled: {kind: cable, nodes: [a, p, c], axial_stiffness: 20 N, damping: 0.1, rest_length: 1.5}
  wound: {kind: spring, nodes: [p, b], axial_stiffness: 5 N, law: logarithmic}
  down: {kind: spring, nodes: [c, q], stiffness: 40}
  odd: {kind: spring, nodes: [a, c], stiffness: 5} # 17 members: slots of hinges and cells lie behind a gap
hinges:
  plain: {nodes: [a, p, q], stiffness: 2 N m/rad, damping: 0.1 N m s/rad, rest_angle: 170 deg}
  drawn: {nodes: [p, q, b], stiffness: 3, law: {kind: play, gap: 2 deg}}
  spun: {nodes: [q, c, p], stiffness: 0.2}
  listed: {nodes: [b, q, p], law: {kind: table, points: [[-10 deg, -1 N m], [10 deg, 1 N m]]}}
cells:
  pumped: {nodes: [p, q, c], pressure: 2 N/m}
  cold: {nodes: [p, q, c], gas: {kind: isothermal, pressure: 3 N/m, outside: 1 N/m}}
  quick: {nodes: [q, c, p], gas: {kind: isentropic, exponent: 1.3, pressure: 3 N/m}}
  foam: {nodes: [p, q, c], stiffness: 20 N/m^3, damping: 0.5, rest_area: 0.1, law: compression_only}
  stiffening: {nodes: [q, c, p], law: {kind: polynomial, coefficients: [5, 0, 40]}}
collisions:
  on: {node: c, member: tendon_line, thickness: 0.9 m, stiffness: 100 N/m, damping: 2 N s/m}
  discs: {nodes: [p, q], thickness: 0.95 m, stiffness: 1 kN/m}
distances:
  ahead: {nodes: [p, q], along: 30 deg, stiffness: 5 N/m, damping: 0.1}
  high: {nodes: [c, a], along: y, law: {kind: polynomial, coefficients: [5 N/m, 0, 20 N/m^3]}}
  aside: {node: c, line: [p, q], stiffness: 5 N/m, damping: 0.1, rest_distance: -0.1 m, law: compression_only}
signals:
  wave: {sine: {amplitude: 50 mm, frequency: 1 Hz}}
  all: {expression: "0.02 m * (sin(9 Hz*t) + cos(3 Hz*t) - tan(0.1 Hz*t) * exp(-t/(1 s)) + log(1 + t/(1 s)) / log10(20 + t/(1 s)) + sqrt(1 + t/(1 s)) + abs(sin(5 Hz*t)) + min(t/(1 s), 0.3) - max(t/(1 s), 0.2) + floor(4 Hz*t) - ceil(3 Hz*t) + round(2 Hz*t) + hypot(t/(1 s), 1) + (atan2(t/(1 s), 1) + asin(0.1) + acos(0.5 Hz*t) - atan(t/(1 s)))/(1 rad) + (1 + t/(1 s))^1.5) - wave"}
actuators:
  pull: {member: tendon, signal: wave}
  more: {member: tendon, signal: {sine: {amplitude: 5 mm, frequency: 3 Hz}}}
  winch: {member: reeled, signal: wave}
  reel: {member: wound, signal: all}
  bend: {hinge: plain, signal: {sine: {amplitude: 10 deg, frequency: 1 Hz}}}
  pump: {cell: pumped, signal: {sine: {amplitude: 1 N/m, frequency: 2 Hz}}}
  follow: {member: up, signal: all}
  push: {member: down, force: {half_sine: {amplitude: 5 N, frequency: 1 Hz}}}
  turn: {hinge: drawn, moment: {ramp: {amplitude: 1 N m, stop: 0.5 s}}}
loads:
  shake: {node: b, force: [1 N, 0], signal: {square: {amplitude: 1, frequency: 4 Hz}}}
initial: {velocities: {c: [2 m/s, -3 m/s], b: [0, 1 m/s]}}
"""


def test_elements():
    for method, compiler in zip(("rk4", "verlet"), (compilers[0], compilers[-1])):
        text = ELEMENTS.replace("tendon_line", "one_way")
        write("elements.yaml", text + f"solver: {{integrator: {method}, step: 0.2 ms}}\nrun: {{duration: 1 s}}\n"
              "output: {every: 10 ms, channels: [position, force, length, energy]}\n")
        compare("elements.yaml", method, 2e-4, 5000, 50, [compiler])
    with open(path("run", "members.csv"), encoding="utf-8") as table:
        heads, *rows = list(csv.reader(table))
    with open(path("run", "energy.csv"), encoding="utf-8") as table:
        heads_of_energies, *all_energies = list(csv.reader(table))
    energies = dict(zip(heads_of_energies, all_energies[-1]))
    wanted = dict(zip(heads, map(float, rows[-1])))
    names = [re.sub(r"\..*", "", head) for head in heads if ".force" in head]
    queries = "".join(f'  printf("%.17g %.17g\\n", elements_length(&s, ELEMENTS_MEMBER_{n}), '
                      f"elements_tension(&s, ELEMENTS_MEMBER_{n}));\n" for n in names)
    with open(path("code", "elements_example.c"), "w", encoding="utf-8") as main:
        main.write('#include <stdio.h>\n#include "elements.h"\nstatic elements_state s;\nint main(void) {\n'
                   "  elements_init(&s);\n  for (int n = 0; n < 5000; n++) elements_step_verlet(&s, NULL, 2e-4);\n"
                   f'{queries}  printf("%.17g\\n", elements_energy(&s).elastic);\n  return 0;\n}}\n')
    lines = subprocess.run([build(compilers[0], "elements")], capture_output=True, text=True).stdout.splitlines()
    for name, line in zip(names, lines):
        length, tension = map(float, line.split())
        for key, got in ((f"{name}.length [m]", length), (f"{name}.force [N]", tension)):
            check(abs(got - wanted[key]) <= 1e-9 * max(1, abs(got)), f"{key}: {got}, strut says {wanted[key]}")
    elastic = float(next(v for k, v in energies.items() if k.startswith("elastic")))
    check(abs(float(lines[-1]) - elastic) < 1e-9 * abs(elastic), f"elastic energy {lines[-1]}, strut says {elastic}")
    rows = {}
    for real in ("double", "float"):
        run("export", "elements.yaml", "--format", "code", "-o", real, "--real", real)
        rows[real] = code_rows(build(compilers[-1], "elements", "-DSTEP=2e-4", "-DSTEPS=1000", "-DEVERY=1000",
                                     directory=real))
    error = max(abs(float(a) - float(b)) for a, b in zip(rows["float"][-1], rows["double"][-1]))
    print(f"error of floats with elements [m]: {error:.1e}")
    check(error < 2e-5, f"floats are {error} m from doubles")


HELD = """#include <stdio.h>
#include "crawler.h"
static crawler_state s, copy;
int main(void) {
  crawler_inputs in = {.given = {1}, .value = {5e-5}};
  crawler_init(&s);
  for (int n = 0; n < 1000; n++) crawler_step_verlet(&s, &in, 2e-5);
  copy = s;
  for (int n = 0; n < 500; n++) crawler_step_verlet(&s, &in, 2e-5);
  s = copy;
  for (int n = 0; n < 1000; n++) crawler_step_verlet(&s, &in, 2e-5);
  crawler_energies e = crawler_energy(&s);
  printf("%.17g\\n", crawler_time(&s));
  for (int i = 0; i < 2 * CRAWLER_NODES; i++) printf("%.17g ", s.q[i]);
  printf("\\n%.17g %.17g %.17g %.17g\\n", e.kinetic, e.elastic, e.gravity, e.contact);
  printf("%.17g %.17g\\n", crawler_length(&s, CRAWLER_MEMBER_m8), crawler_tension(&s, CRAWLER_MEMBER_m8));
  return 0;
}
"""


def test_inputs():
    """A held input is a constant signal; snapshots; energies."""
    file = scene("crawler/crawler.yaml", "verlet", 2e-5, 2000, 2000, lambda text: re.sub(
        r"signal: .sine: .*?\}\}", "signal: {constant: 0.05 mm}", text))
    want = strut_rows(file)
    with open(path("run", "energy.csv"), encoding="utf-8") as table:
        energies = list(csv.reader(table))[-1][1:5]
    run("export", os.path.join(models, "crawler", "crawler.yaml"), "--format", "code", "-o", "held")
    with open(path("held", "crawler_example.c"), "w", encoding="utf-8") as main:
        main.write(HELD)
    lines = subprocess.run([build(compilers[0], "crawler", directory="held")], capture_output=True,
                           text=True).stdout.splitlines()
    check(abs(float(lines[0]) - 0.04) < 1e-15, f"time {lines[0]}")
    same_rows("held input", [lines[1].split()], want[-1:])
    same_rows("energies", [lines[2].split()], [energies])
    length, tension = map(float, lines[3].split())
    check(abs(tension - 1e4 * (length - 0.01005)) < 1.0, f"tension {tension} at length {length}")


DAMPED = """strut: 1
gravity: [0, -9.81 m/s^2]
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [0.5 m, 0], fixed: both}
  c: {position: [0.5 m, 0.5 m], mass: 0.2 kg}
  d: {position: [0, 0.5 m], mass: 0.2 kg}
groups:
  post: {kind: bar, stiffness: 2000 N/m, damping: 4 N s/m, mass: 0.1 kg}
  rope: {kind: cable, stiffness: 500 N/m, damping: 2 N s/m, rest_length_ratio: 0.9}
members:
  left: {group: post, nodes: [a, d]}
  right: {group: post, nodes: [b, c]}
  top: {group: post, nodes: [c, d]}
  up: {group: rope, nodes: [a, c]}
  down: {group: rope, nodes: [b, d]}
actuators: {drive: {member: up, signal: {sine: {amplitude: 10 mm, frequency: 2 Hz}}}}
initial: {velocities: {c: [1 m/s, 0]}}
solver: {integrator: rk4, step: 0.2 ms}
run: {duration: 2 s}
"""


def test_floats():
    """Of a structure that damping brings onto an orbit the error does not grow: a few roundings of 6e-8 at half a
    metre, and a drive at its time."""
    write("damped.yaml", DAMPED)
    rows = {}
    for real in ("double", "float"):
        run("export", "damped.yaml", "--format", "code", "-o", real, "--real", real, "--prefix", "d")
        rows[real] = code_rows(build(compilers[0], "d", "-DSTEP=2e-4", "-DSTEPS=10000", "-DEVERY=500",
                                     directory=real))
    errors = [max(abs(float(a) - float(b)) for a, b in zip(x, y)) for x, y in zip(*rows.values())]
    print("errors of floats [m]:", " ".join(f"{e:.1e}" for e in errors))
    check(0 < max(errors) < 2e-6 and errors[-1] < 2e-6, f"floats are {max(errors)} m from doubles")


def test_arm():
    """The crawler on a Cortex-M4, whose doubles are newlib's and libgcc's, has the bits of this machine."""
    tools = ("arm-none-eabi-gcc", "arm-none-eabi-size", "qemu-system-arm")
    if not all(map(shutil.which, tools)):
        print("skipped: a Cortex-M4 (" + ", ".join(t for t in tools if not shutil.which(t)) + " missing)")
        return
    core = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]
    folder = path("arm")
    for real in ("float", "double"):
        run("export", os.path.join(models, "crawler", "crawler.yaml"), "--format", "code", "-o", "arm", "--real", real)
        done = subprocess.run([tools[0], *core, *STRICT, "-O2", "-c", "crawler.c", "-o", "crawler.o"], cwd=folder,
                              capture_output=True, text=True)
        check(done.returncode == 0, f"{tools[0]}: {done.stderr[:2000]}")
        print(real, subprocess.run([tools[1], "crawler.o"], cwd=folder, capture_output=True, text=True).stdout)
    flags = ["-DSTEPS=200", "-DEVERY=50"]
    done = subprocess.run([tools[0], *core, "-std=gnu99", "-ffp-contract=off", "-O2", "--specs=rdimon.specs", *flags,
                           os.path.join(here, "code_cortex_m4.c"), "crawler_example.c", "crawler.c", "-lm",
                           "-Wl,--section-start=.vectors=0", "-o", "m4"], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        print("skipped: a Cortex-M4 (no newlib for it)")
        return
    done = subprocess.run([tools[2], "-M", "mps2-an386", "-nographic", "-semihosting", "-monitor", "none", "-serial",
                           "null", "-kernel", "m4"], cwd=folder, capture_output=True, text=True, timeout=60)
    there = [line.split(",")[1:] for line in done.stdout.splitlines()[1:]]
    same_rows("Cortex-M4", there, code_rows(build(compilers[0], "crawler", *flags, directory="arm")))


def test_words():
    crawler = os.path.join(models, "crawler", "crawler.yaml")
    refused = run("export", os.path.join(models, "gallery", "wave-crawler.yaml"), "--format", "code", "-o", "no", code=2)
    check("friction law coulomb (its stops and starts are located within steps; use karnopp or smooth)"
          in refused.stderr, f"Coulomb's law is refused by: {refused.stderr}")
    refused = run("export", os.path.join(models, "gallery", "x-with-ring.yaml"), "--format", "code", "-o", "no", code=2)
    check("bars: rigid (" in refused.stderr and "use bars: elastic)" in refused.stderr,
          f"rigid bars are refused by: {refused.stderr}")
    check(not os.path.exists(path("no")), "a scene that is refused leaves a folder")
    for words, text in ((("--format", "code", "-o", "no", "--real", "half"), "double"),
                        (("--format", "code", "-o", "no", "--prefix", "9x"), "--prefix expects a letter"),
                        (("--format", "code"), "missing -o DIR"),
                        (("--format", "code", "-o", "no", "--at", "I"), "--at is not for code"),
                        (("--prefix", "x"), "--prefix is for --format code"), (("--real", "float"), "--real is for --format code")):
        done = run("export", crawler, *words, code=1)
        check(text in done.stderr, f"{words}: {done.stderr}")
    write("2 legs.v2.yaml", open(crawler, encoding="utf-8").read())
    run("export", "2 legs.v2.yaml", "--format", "code", "-o", "odd")
    check(os.path.exists(path("odd", "model_2_legs.h")), f"odd names: {os.listdir(path('odd'))}")


def test_page():
    """The C of the page about it compiles."""
    page = open(os.path.join(models, "..", "docs", "how-to", "embed.md"), encoding="utf-8").read()
    run("export", os.path.join(models, "crawler", "crawler.yaml"), "--format", "code", "-o", "page")
    with open(path("page", "crawler_example.c"), "w", encoding="utf-8") as main:
        main.write(re.search(r"```c\n(.*?)```", page, re.S).group(1))
    build(compilers[0], "crawler", directory="page")


if __name__ == "__main__":
    test_words()
    if compilers:
        compare_model("crawler/crawler.yaml", "rk4", 1e-4, 5000, 100)
        compare_model("crawler/crawler.yaml", "verlet", 2e-5, 5000, 100, compilers[:1])
        compare_model("gallery/x-tower-on-slope.yaml", "rk4", 2e-4, 2000, 100, compilers[-1:])
        test_terms()
        test_elements()
        test_inputs()
        test_floats()
        test_arm()
        test_page()
    finish()

# SPDX-License-Identifier: GPL-3.0-or-later
# Branches of periodic motions against closed forms: multipliers and amplitude of a linear oscillator,
# Duffing's folds, the cascade of doublings in two wells, the bilinear oscillator's grazing, Den Hartog's
# boundary of motions without stops, the two-mass crawler; refusals, threads, files.
import json
import math
import os
import signal

from periodic import BILINEAR, DUFFING, WELLS, duffing_folds_at, follow, special
from testing import check, finish, models, near, read, rows, run, stopped, write


def root(f, a, b):
    for _ in range(100):
        middle = (a + b) / 2
        a, b = (a, middle) if f(a) * f(middle) <= 0 else (middle, b)
    return a


# ---- linear: multipliers exp(-c T / 2 m), amplitude by the transfer function

write("linear.yaml", """strut: 1
parameters: {frequency: 1 Hz}
nodes: {wall: {position: [0, 0], fixed: both}, mass: {position: [10, 0], fixed: y, mass: 1}}
members: {spring: {kind: spring, nodes: [wall, mass], stiffness: 100, damping: 0.5, rest_length: 10}}
loads:
  push: {node: mass, force: [1 N, 0], signal: {sine: {amplitude: 1, frequency: frequency}}}
solver: {integrator: rk4, step: 1 ms}
run: {periods: 200, of: push, measure: {node: mass}}
""")
run("path", "--periodic", "linear.yaml", "--over", "frequency=1Hz..3Hz", "-o", "linear")
table = rows("linear", "branches.csv")
check(len(table) > 30, f"{len(table)} points")
near(float(table[0]["frequency [Hz]"]), 1, "the lower end", 1e-12)
near(float(table[-1]["frequency [Hz]"]), 3, "the upper end", 1e-12)
for row in table:
    f, turn = float(row["frequency [Hz]"]), 2 * math.pi * float(row["frequency [Hz]"])
    near(float(row["multiplier"]), math.exp(-0.25 / f), f"multiplier at {f}", 1e-5)
    near(float(row["amplitude [m]"]), 1 / math.hypot(100 - turn**2, 0.5 * turn), f"amplitude at {f}", 1e-4)
    want = math.pi * 0.5 * turn * float(row["amplitude [m]"])**2
    near(float(row["work [J]"]), want, f"work at {f}", 1e-4)
    check(row["stable"] == "yes" and row["period_multiple"] == "1", "not stable")
figure = read("linear", "branches.svg").decode()
check(">stable</t>" in figure and not any(f">{word}</t>" in figure for word in ("unstable", "fold", "period doubling")),
      "the legend explains what is not there")

# ---- Duffing: folds of the harmonic balance, small amplitude

duffing = follow(DUFFING, "frequency=0.14Hz..0.22Hz")
folds = [p["value"] for p in special(duffing, "fold")]
high, low = duffing_folds_at(0.1)
check(len(folds) == 2, f"folds at {folds}")
near(folds[0], high, "upper fold", 2e-3)
near(folds[1], low, "lower fold", 2e-3)
for p in special(duffing, "fold"):
    near(p["multiplier"][0], 1, "multiplier at a fold", 2e-2)
stable = [p["stable"] for p in duffing["branches"][0]["points"]]
check(stable[0] and stable[-1] and not all(stable), "stability over the folds")

# ---- doublings in two wells: the cascade, whose steps shrink by Feigenbaum's 4.669

write("wells.yaml", WELLS)
wells = follow("wells.yaml", "force=0.165N..0.19N")
doublings = [special(wells, "period-doubling", i)[0]["value"] for i in range(3)]
near((doublings[1] - doublings[0]) / (doublings[2] - doublings[1]), 4.64, "ratio of doublings", 0.03)
check([b["period_multiple"] for b in wells["branches"][:3]] == [1, 2, 4], "period multiples")
check(wells["branches"][1]["doubled_from"] == 1, "the doubled branch's parent")
near(wells["branches"][1]["points"][0]["value"], doublings[0], "begin of the doubled branch", 1e-4)
check(wells["branches"][1]["points"][2]["stable"], "the doubled branch is stable at first")

# ---- the bilinear oscillator touches where the linear amplitude is the gap

write("bilinear.yaml", BILINEAR)


def over_gap(f):
    turn = 2 * math.pi * f
    return 1 / math.hypot(100 - turn**2, turn) - 0.03


bilinear = follow("bilinear.yaml", "frequency=1Hz..2Hz")
grazings = special(bilinear, "grazing")
check(len(grazings) == 2 and all(p["node"] == "mass" for p in grazings), f"grazings: {grazings}")
near(grazings[0]["value"], root(over_gap, 1, 1.58), "first grazing", 3e-4)
near(grazings[-1]["value"], root(over_gap, 1.6, 2), "last grazing", 3e-4)

# ---- Den Hartog 1931: dry friction, and where motions without stops end

write("dry.yaml", """strut: 1
name: Dry friction
parameters: {friction: 0.3, ratio: 0.8}
gravity: [0, -10 m/s^2]
nodes: {wall: {position: [0, -10 mm], fixed: both}, mass: {position: [1, -10 mm], mass: 1}}
members: {spring: {kind: spring, nodes: [wall, mass], stiffness: 100, rest_length: 1}}
ground: {stiffness: 1000, damping: 50, contacts: {mass: {}}, friction: {law: coulomb, mu: friction}}
loads: {push: {node: mass, force: [10 N, 0], signal: {sine: {amplitude: 1, frequency: ratio*10/(2*pi)*1 Hz}}}}
solver: {integrator: rk4-events, step: 1 ms}
run: {periods: 200, of: push, measure: {node: mass}}
""")


def without_stops(r):
    """Largest friction over force for which the half cycle of x'' + x has no stop."""
    static, half = 1 / (1 - r * r), math.pi / r

    def free(b):
        sine_part = -b * math.sin(half) / (1 + math.cos(half))
        phase = sine_part / (static * r)
        if abs(phase) >= 1:
            return False
        phase = math.asin(phase)
        phase = math.pi - phase if static * math.cos(phase) < 0 else phase
        return all(b * math.sin(t) + sine_part * math.cos(t) < static * r * math.sin(r * t + phase)
                   for t in (half * k / 2000 for k in range(1, 2000)))

    low, high = 0.0, 1.5
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if free(middle) else (low, middle)
    return low


for ratio in (0.8, 1.2):
    dry = follow("dry.yaml", "friction=0.2..0.85", "--set", f"ratio={ratio}")
    sticks = special(dry, "stick")
    check(sticks and sticks[0]["node"] == "mass", f"ratio {ratio}: no stick: {dry['branches'][0]['special']}")
    if sticks:
        near(sticks[0]["value"], without_stops(ratio), f"first stop at ratio {ratio}", 1e-3)

# ---- the two-mass crawler's velocities, computed apart (models/gallery)

crawler = os.path.join(models, "gallery", "two-mass-crawler.yaml")
for friction, velocity in ((0.1, -3.6798), (0.3, -4.4777), (0.5, -2.6839)):
    two = follow(crawler, f"friction={friction - 0.01}..{friction + 0.01}", "--values", str(friction),
                 "--set", "periods=300", "--steps", "1")
    points = two["branches"][0]["points"]
    start = [p for p in points if p.get("point") == "start"]
    near(start[0]["velocity"], velocity * 1e-3, f"velocity at friction {friction}", 1e-3)

# ---- the same for any number of threads, and twice

for threads in ("1", "3"):
    run("path", "--periodic", "bilinear.yaml", "--over", "frequency=1.2Hz..1.4Hz", "-o", f"threads-{threads}", "-q",
        env={"OMP_NUM_THREADS": threads})
check(read("threads-1", "branches.csv") == read("threads-3", "branches.csv"), "the number of threads changes the result")

# ---- two starts on one branch are reported

both = follow("bilinear.yaml", "frequency=1Hz..1.4Hz", "--values", "1.1Hz,1.2Hz")
check(len(both["branches"]) == 1 and "on branch 1" in both["notes"][0], f"notes {both['notes']}")

# ---- an interrupted branch is kept, and marked; the first waits may end within the run that starts it

for wait in (1.5, 4, 12, 30):
    partial = stopped("path", "--periodic", f"{models}/crawler/crawler.yaml", "--set", "friction=0.2", "--at", "I",
                      "--over", "frequency=9Hz..13Hz", "--values", "10Hz", "-o", "partial", "--json", "-q", after=wait,
                      by=signal.SIGINT)
    if partial.stdout:
        break
check(partial.returncode not in (0, 1) and "interrupted" in partial.stderr, f"interrupt: {partial}")
got = json.loads(partial.stdout)
check("interrupted" in got["notes"][-1] and got["branches"][0]["begins"] == "interrupted", f"{got['notes']}")
check(len(rows("partial", "branches.csv")) == len(got["branches"][0]["points"]) >= 2, "points of a partial branch")

# ---- kicks: a linear motion always comes back, the larger of two stable ones does not

kicked = follow("linear.yaml", "frequency=1Hz..1.1Hz", "--values", "1.05Hz", "--basins")
check(kicked["basins"][0]["forwards"] is None, f"kicks {kicked['basins']}")
between = round((low + high) / 2, 4)
kicked = follow(DUFFING, "frequency=0.14Hz..0.22Hz", "--values", f"{between}Hz,0.14Hz", "--basins")
pushed = [b for b in kicked["basins"] if b["value"] == between]
check(len(pushed) == 2, f"two stable motions at {between} Hz: {kicked['basins']}")
check(all(b["backwards"] is not None and 0 < b["backwards"] < 20 for b in pushed), f"kicks {pushed}")

# ---- refusals


def refused(model, over, text, *words, code=1):
    run("path", "--periodic", model, *(("--over", over) if over else ()), *words, code=code, err=text)


refused("linear.yaml", None, "missing --over NAME=LOW..HIGH")
refused("linear.yaml", "frequenzy=1Hz..2Hz", "did you mean 'frequency'?")
refused("linear.yaml", "frequency=2Hz..1Hz", "the lower one first")
refused("linear.yaml", "frequency=1Hz..2Hz", "within the range", "--values", "3Hz")
refused("linear.yaml", "frequency=1Hz..2Hz", "no configuration 'I'", "--at", "I")
refused("bilinear.yaml", "frequency=1Hz..2Hz", "locates no events", "--integrator", "rk4")
text = read("linear.yaml").decode()
write("seconds.yaml", text.replace("periods: 200, of: push", "duration: 5 s"))
refused("seconds.yaml", "frequency=1Hz..2Hz", "no drive whose period")
write("two.yaml", text.replace("solver:", "  pull: {node: mass, force: [1 N, 0], "
                               "signal: {sine: {amplitude: 1, frequency: 1.3*frequency}}}\nsolver:"))
refused("two.yaml", "frequency=1Hz..2Hz", "does not repeat itself")
refused("wells.yaml", "force=0.39N..0.41N", "no periodic motion to follow", "--set", "start=11 m", "--set", "force=0.4",
        code=3)

finish()

# SPDX-License-Identifier: GPL-3.0-or-later
# Curves over two parameters: Duffing's folds and their cusp by the harmonic balance, the bilinear oscillator's
# grazing by its transfer function, doublings against single branches; files, refusals.
import math
import os

from periodic import BILINEAR, DUFFING, WELLS, duffing_folds, follow, special
from testing import check, finish, near, rows, run, work, write

# ---- folds: those of the harmonic balance

folds = follow(DUFFING, "frequency=0.14Hz..0.2Hz", "--and", "force=0.06N..0.15N", "-o", "folds")
curves = folds["curves"]
check([c["kind"] for c in curves] == ["fold"] and len(curves[0]["cusps"]) == 1, f"curves of folds: {len(curves)}")
check(folds["and"] == "force" and folds["and_at"] == 0.1, "the second parameter")
for p in curves[0]["points"]:
    frequency, force = p["values"]
    want = min(duffing_folds(p["amplitude"]), key=lambda w: abs(w[0] - frequency))
    near(frequency, want[0], f"frequency of the fold at {force}", 3e-3)
    check(0.0599 < force < 0.1501, f"a fold at {force}")
    check(p["stable"], "the fold bounds a stable motion")
ends = [curves[0]["points"][i]["values"] for i in (0, -1)]
check(all(abs(e[1] - 0.15) < 1e-5 for e in ends) and ends[0][0] < ends[1][0], f"ends {ends}")
# the cusp: the least force on the curve of folds
least = min((f for a in range(900, 1800) for f in duffing_folds(a / 1000)), key=lambda f: f[1])
near(curves[0]["cusps"][0][0], least[0], "frequency of the cusp", 2e-3)
near(curves[0]["cusps"][0][1], least[1], "force at the cusp", 1e-2)
# each fold of the branch is on the curve
pairs = [p["values"] for p in curves[0]["points"]]
for value in (p["value"] for p in special(folds, "fold")):
    crossing = [a[0] + (0.1 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in zip(pairs, pairs[1:])
                if (a[1] - 0.1) * (b[1] - 0.1) <= 0 and a[1] != b[1]]
    check(min(abs(c - value) for c in crossing) < 2e-5, f"fold at {value}, curve at {crossing}")
check(os.path.exists(os.path.join(work, "folds", "curves.svg")), "no figure")
table = rows("folds", "curves.csv")
check([r["point"] for r in table].count("cusp") == 1 and len(table) == len(curves[0]["points"]), "curves.csv")

# ---- grazing: where the amplitude of the free oscillator is the gap

write("bilinear.yaml", BILINEAR)
grazing = follow("bilinear.yaml", "frequency=1Hz..1.45Hz", "--and", "push=0.6N..1.6N")
check([(c["kind"], c["node"]) for c in grazing["curves"]] == [("grazing", "mass")], "curves of grazing")
for curve in grazing["curves"]:
    check(len(curve["points"]) > 20, "a short curve")
    for p in curve["points"]:
        turn = 2 * math.pi * p["values"][0]
        near(p["values"][1] / math.hypot(100 - turn**2, turn), 0.03, f"gap at {p['values']}", 1e-5)

# ---- doublings: a point of the curve is where a branch at that value doubles

write("wells.yaml", WELLS)
doublings = follow("wells.yaml", "force=0.178N..0.186N", "--values", "0.179N", "--and",
                   "damping=0.24 N s/m..0.26 N s/m")["curves"]
check([(c["kind"], c["period_multiple"]) for c in doublings] == [("period-doubling", 1)], "curves of doublings")
force, damping = doublings[0]["points"][3]["values"]
alone = follow("wells.yaml", "force=0.176N..0.182N", "--values", "0.176N", "--set", f"damping={damping}")
near(special(alone, "period-doubling")[0]["value"], force, "a doubling alone", 1e-6)

# ---- refusals


def refused(text, *words):
    run("path", "--periodic", DUFFING, "--over", "frequency=0.14Hz..0.24Hz", *words, code=1, err=text)


refused("--and: the model has no parameter 'forze'; did you mean 'force'?", "--and", "forze=1N..2N")
refused("--and force: expected two values LOW..HIGH", "--and", "force=2N..1N")
refused("name the same parameter", "--and", "frequency=1Hz..2Hz")
refused("missing --and NAME=LOW..HIGH", "--and", "force")
finish()

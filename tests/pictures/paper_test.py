# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/paper.md: every figure's study is run there, every picture shown is there, and the tables beside
them are those that strut makes today, as far as friction lets two computers agree.

usage: paper_test.py STRUT [NUMBER]...     figures to run again; 5 6 9 11 if none is given
"""
import csv
import glob
import math
import os
import re
import subprocess
import sys
import tempfile

from testing import check, fail, finish, strut

numbers = sys.argv[2:] or ["5", "6", "9", "11"]
MOST_BYTES = 3.1e6


def alike(column, one, other):
    """Texts and counts as they are; velocities to 2 %, places to 1 mm, all else to 5 %."""
    try:
        a, b = float(one or "nan"), float(other or "nan")
    except ValueError:
        return one == other
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) == math.isnan(b)
    if re.match(r"(x|y|height)_", column):
        return abs(a - b) < 1e-3
    if column.startswith("velocity_spread") or column in ("kinetic [J]", "force_evaluations", "periods"):
        return a >= 0 and b >= 0  # of last bits
    return abs(a - b) <= (0.02 if column.startswith("velocity") else 0.05) * max(abs(a), 1e-6)


page = open("docs/paper.md", encoding="utf-8").read()
shown = re.findall(r"!\[[^\]]+\]\(paper/([\w-]+\.svg)\)", page)
there = [os.path.basename(f) for f in glob.glob("docs/paper/*.svg")]
check(sorted(shown) == sorted(there), f"shown and there are not the same: {set(shown) ^ set(there)}")
for table in glob.glob("docs/paper/*.csv"):
    study = f"models/crawler/{os.path.basename(table)[:-4]}.yaml"
    check(os.path.exists(study) and f"strut sweep {study}" in page, f"docs/paper.md has no command for {table}")
size = sum(os.path.getsize(f) for f in glob.glob("docs/paper/*"))
check(size <= MOST_BYTES, f"docs/paper has {size} bytes")

with tempfile.TemporaryDirectory() as now:
    subprocess.run(["sh", "docs/paper.sh", strut, now, *numbers], check=True, stdout=subprocess.DEVNULL)
    for number in numbers:
        name = f"figure-{number}"
        old = list(csv.DictReader(open(f"docs/paper/{name}.csv", newline="")))
        new = list(csv.DictReader(open(f"{now}/{name}.csv", newline="")))
        if len(old) != len(new) or old[0].keys() != new[0].keys():
            fail(f"{name}: another table; sh docs/paper.sh STRUT docs/paper {number}")
            continue
        for a, b in zip(old, new):
            for column in a:
                if not alike(column, a[column], b[column]):
                    fail(f"{name}, point {a['point']}: {column} is {b[column]}, was {a[column]}")
        pictures = {os.path.basename(f) for f in glob.glob(f"{now}/{name}-*.svg")}
        wanted = {f for f in shown if re.match(rf"{name}-(?!long)", f)}
        check(pictures == wanted, f"{name}: draws {pictures}, docs/paper.md shows {wanted}")
# It notices a velocity that is not the same.
if alike("velocity [m/s]", "0.0100", "0.0103") or alike("outcome", "I", "II") or \
        alike("x_n1 [m]", "0.01", "0.02"):
    fail("self-test: different tables pass")
finish()

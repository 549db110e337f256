# SPDX-License-Identifier: GPL-3.0-or-later
"""README's pictures are what strut draws today, and figure 8's table is what strut computes today.

usage: readme_test.py STRUT
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile

from svg_compare import differ

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "support"))
from findings import fail, finish  # noqa: E402

strut = os.path.abspath(sys.argv[1])


if not shutil.which("jq"):
    print("skipped: there is no jq")
    sys.exit(77)
with tempfile.TemporaryDirectory() as now:
    subprocess.run(["sh", "docs/pictures.sh", strut, now], check=True)
    for name in ("crawler.svg", "figure-8.svg"):
        why = differ(f"docs/{name}", os.path.join(now, name))
        if why:
            fail(f"docs/{name} is not what strut draws today: {why}; sh docs/pictures.sh draws it")

rows = {}
for row in csv.DictReader(open("docs/figure-8.csv")):
    rows[float(row["frequency [Hz]"]), row["start"], row["friction"]] = row
if len(rows) != 6 * 191:
    fail(f"docs/figure-8.csv has {len(rows)} rows")
again = subprocess.run(["sh", "docs/figure-8.sh", strut, "17.3", "1", "17.3"], capture_output=True,
                       text=True, check=True).stdout.splitlines()
for row in csv.DictReader(again):
    old = rows[float(row["frequency [Hz]"]), row["start"], row["friction"]]
    before, after = float(old["velocity [m/s]"]), float(row["velocity [m/s]"])
    if abs(before - after) > 1e-9 * abs(before) or old["outcome"] != row["outcome"]:
        fail(f"figure 8: {old} is now {row}")
if len(again) != 7:
    fail(f"figure 8 at one frequency has {len(again)} lines")
finish()

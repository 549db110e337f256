# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of README, of the comparison of designs and of the tutorial are what strut draws today, and the
table of figure 8 is what strut computes today."""
import csv
import os
import re
import shutil
import subprocess
import tempfile

from svg_compare import differ

from testing import check, fail, finish, strut


TABLE = "docs/paper/figure-8.csv"
with tempfile.TemporaryDirectory() as now:
    subprocess.run(["sh", "docs/pictures.sh", strut, now], check=True)
    study = open("models/crawler/figure-8.yaml", encoding="utf-8").read()
    for variant in ("paper", "strut"):
        title = re.search(rf'^  {variant}:\n.*\n.*title: "(.*)"', study, re.M).group(1)
        subprocess.run([strut, "plot", TABLE, "--x", "frequency", "--y", "velocity", "--by", "start",
                        "--panels", "friction", "--band", "outcome=III", "--only", f"variant={variant}",
                        "--title", title, "--plot", f"{now}/large.svg"], check=True)
        with open(f"{now}/figure-8-{variant}.svg", "w", encoding="utf-8") as small:
            subprocess.run(["awk", "-f", "docs/smaller.awk", f"{now}/large.svg"], stdout=small, check=True)
    subprocess.run(["sh", "docs/tutorial.sh", strut, f"{now}/tutorial"], check=True)
    shown = re.findall(r"!\[[^]]+\]\((tutorial/[^)]+)\)", open("docs/tutorial.md", encoding="utf-8").read())
    if sorted(shown) != sorted(f"tutorial/{name}" for name in os.listdir("docs/tutorial")) or len(shown) < 3:
        fail(f"docs/tutorial.md shows {shown}, docs/tutorial holds {os.listdir('docs/tutorial')}")
    for name, drawn in [("crawler.svg", "crawler.svg"), ("compare/five.svg", "compare/five.svg"),
                        ("paper/figure-8-paper.svg", "figure-8-paper.svg"),
                        ("paper/figure-8-strut.svg", "figure-8-strut.svg"), *zip(shown, shown)]:
        why = differ(f"docs/{name}", f"{now}/{drawn}")
        check(not why, f"docs/{name} is not what strut draws today: {why}; sh docs/redraw.sh")

    # One frequency again, which forgets its roundings.
    shutil.copy("models/crawler/crawler.yaml", now)
    one = re.sub(r"frequency: \{from.*\}", "frequency: [17.3]", study)
    with open(f"{now}/one.yaml", "w", encoding="utf-8") as file:
        file.write(one)
    subprocess.run([strut, "sweep", f"{now}/one.yaml", "--quiet", "-o", f"{now}/one"], check=True)
    again = list(csv.DictReader(open(f"{now}/one/table.csv")))

KEYS = ("variant", "frequency [Hz]", "start", "friction")
rows = {tuple(row[key] for key in KEYS): row for row in csv.DictReader(open(TABLE))}
check(len(rows) == 2 * 6 * 191, f"{TABLE} has {len(rows)} rows")
for row in again:
    old = rows[tuple(row[key] for key in KEYS)]
    before, after = float(old["velocity [m/s]"]), float(row["velocity [m/s]"])
    near = 1e-9 * abs(before) if row["variant"] == "paper" else 0.01 * abs(before) + 1e-6
    check(abs(before - after) <= near and old["outcome"] == row["outcome"], f"figure 8: {old} is now {row}")
check(len(again) == 12, f"figure 8 at one frequency has {len(again)} rows")
finish()

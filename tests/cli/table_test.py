# SPDX-License-Identifier: GPL-3.0-or-later
# The table of a sweep in other programs: the lines of docs/output.md for pandas, Octave and LibreOffice
# are run as they stand there, and what these programs then hold is the table.
# A program that is missing is said; exit code 77 where all are.
import csv
import importlib.util
import json
import math
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as tree
import zipfile

import testing
from testing import check, finish, strut, work, write

root = os.getcwd()


def lines_of(program):
    """The block behind "<!-- run: PROGRAM -->" in docs/output.md."""
    with open(f"{root}/docs/output.md", encoding="utf-8") as file:
        found = re.findall(f"<!-- run: {program} -->\n```text\n(.*?)```\n", file.read(), re.S)
    check(len(found) == 1, f"docs/output.md has {len(found)} blocks for {program}")
    return found[0]


def run(words, text=None, name=None):
    if name:
        write(name, text)
        text = None
    done = subprocess.run(words, input=text, capture_output=True, text=True, cwd=work,
                          env={**os.environ, "HOME": work, "MPLBACKEND": "Agg"})
    check(done.returncode == 0, f"{words[0]}: exit code {done.returncode}: {done.stderr[-2000:]}")
    return done.stdout


def rows(path):
    with open(f"{work}/{path}", newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def number(text):
    return float(text) if text else math.nan


def same(a, b, tolerance=0.0):
    return (math.isnan(a) and math.isnan(b)) or abs(a - b) <= tolerance * abs(b)


TEXTS = ("start", "motion", "outcome", "status", "message")


def make_tables():
    """That of the document's section on other programs, and one with points that fail."""
    with open(f"{root}/docs/output.md", encoding="utf-8") as file:
        block = re.search("\n## Other programs\n.*?```sh\n(.*?)```\n", file.read(), re.S).group(1)
    shutil.copytree(f"{root}/models", f"{work}/models")
    os.environ["PATH"] = os.path.dirname(strut) + os.pathsep + os.environ["PATH"]
    run(["sh", "-eu"], block)
    write("fails.yaml", """strut: 1
study: fails
model: models/crawler/crawler.yaml
axes: [{step: [0.1 ms, 10 ms]}, {start: [I, II]}]
run: {periods: 20, measure: {last: 5}}
keep: [velocity, motion]
""")
    testing.run("sweep", "fails.yaml", "-o", "fails", "--quiet", code=3)
    check("," in rows("fails/table.csv")[-1][-1], "a message with a comma would test more")


def pandas():
    script = lines_of("pandas") + """
import json
import matplotlib.pyplot as plt
g = pandas.read_csv("fails/table.csv", float_precision="round_trip")
axes = plt.gcf().axes[0]
print(json.dumps({"names": list(t.columns), "rows": t.values.tolist(), "fails": g.values.tolist(),
  "lines": [[list(l.get_xdata()), list(l.get_ydata())] for l in axes.get_lines()],
  "labels": [l.get_label() for l in axes.get_lines()]}))
"""
    found = json.loads(run([sys.executable, "-"], script))
    names, *table = rows("speeds/table.csv")
    check(found["names"] == names, f"pandas: {found['names']}")
    for path, values in (("speeds", found["rows"]), ("fails", found["fails"])):
        names, *wanted = rows(f"{path}/table.csv")
        check(len(values) == len(wanted), f"pandas: {len(values)} rows of {path}")
        for row, cells in zip(values, wanted):
            for name, value, cell in zip(names, row, cells):
                text = name in TEXTS and cell
                good = value == cell if text else same(float(value), number(cell))
                check(good, f"pandas: {path}: {name}: {value}, not {cell}")
    check(found["labels"] == ["I", "II"], f"pandas: {found['labels']}")
    for label, (x, y) in zip(found["labels"], found["lines"]):
        wanted = [(float(r[3]), float(r[4])) for r in table if r[1] == "0.5" and r[2] == label]
        check(list(zip(x, y)) == wanted, f"pandas: the line of {label}")


def octave(program):
    # What is drawn is written instead: the machine need not have a screen.
    script = """1;
function plot(x, y), printf("%.17g %.17g\\n", [x, y]'); end
function xlabel(text), printf("%s\\n", text); end
function ylabel(text), printf("%s\\n", text); end
""" + lines_of("octave") + """
file = fopen("fails/table.csv"); fgetl(file);
g = textscan(file, "%f %f %q %f %q %q %q", "Delimiter", ","); fclose(file);
printf("%g %g %d\\n", numel(g{4}), sum(isnan(g{4})), sum(strcmp(g{6}, "completed")));
printf("%s\\n", g{7}{end});
"""
    said = run([program, "--no-gui", "--quiet", "--norc", "script.m"], script, "script.m").splitlines()
    names, *table = rows("speeds/table.csv")
    wanted = [(float(r[3]), float(r[4])) for r in table if r[1] == "0.5" and r[2] == "I"]
    found = [tuple(float(v) for v in line.split()) for line in said[:len(wanted)]]
    near = all(same(a, b, 1e-15) for f, w in zip(found, wanted) for a, b in zip(f, w))
    check(near, f"Octave: {found}, not {wanted}")  # textscan errs in the last bits
    check(said[len(wanted):len(wanted) + 2] == [names[3], names[4]], f"Octave: {said}")
    check(said[-2] == "4 2 2", f"Octave: points that fail: {said[-2]}")
    message = rows("fails/table.csv")[-1][-1]
    check(said[-1] == message, f"Octave: '{said[-1]}', not '{message}'")


def cells_of(path):
    """The first sheet of an OpenDocument file: texts and numbers."""
    office, table = (f"{{urn:oasis:names:tc:opendocument:xmlns:{n}:1.0}}" for n in ("office", "table"))
    sheet = tree.fromstring(zipfile.ZipFile(path).read("content.xml")).find(f".//{table}table")
    for row in sheet.iter(f"{table}table-row"):
        cells = []
        for cell in row.findall(f"{table}table-cell"):
            value = cell.get(f"{office}value")
            value = float(value) if value else "".join(cell.itertext())
            cells += [value] * min(int(cell.get(f"{table}number-columns-repeated", "1")), 50)
        yield cells


def spreadsheet():
    for path in ("speeds", "fails"):
        run(["sh", "-eu"], lines_of("spreadsheet").replace("speeds", path))
        names, *wanted = rows(f"{path}/table.csv")
        head, *found = list(cells_of(f"{work}/{path}/table.ods"))[:len(wanted) + 1]
        check(head[:len(names)] == names, f"spreadsheet: {head}")
        for row, cells in zip(found, wanted):
            row += [""] * len(names)
            for name, value, cell in zip(names, row, cells):
                good = (value == cell if name in TEXTS or not cell else
                        isinstance(value, float) and same(value, float(cell), 1e-14))
                check(good, f"spreadsheet: {path}: {name}: {value}, not {cell}")


tested = 0
octave_program = shutil.which("octave-cli") or shutil.which("octave")
modules = all(importlib.util.find_spec(m) for m in ("pandas", "matplotlib"))
make_tables()
for name, there, test in (
        ("pandas and matplotlib", modules, pandas),
        ("Octave", octave_program, lambda: octave(octave_program)),
        ("LibreOffice", shutil.which("soffice"), spreadsheet)):
    if there:
        test()
        tested += 1
        print(f"{name}: tested")
    else:
        print(f"{name}: skipped, not installed")
finish(tested)

# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/gallery.md: every model is there, and every picture is the one that strut draws today. The models
of its tables have a command but no picture: it is drawn here, and thrown away. Studies are no models."""
import glob
import os
import re
import shlex
import subprocess
import tempfile

from svg_compare import differ
from testing import check, fail, finish, strut

MOST_BYTES = 3.4e6
# Their modes come in pairs of one frequency, of which every mixture is as good: last bits choose one.
PAIRED = ("parts-michell-wheel.svg", "parts-michell-wheel-12.svg")


page = open("docs/gallery.md", encoding="utf-8").read()
ROW = re.compile(r"^\| \[([\w-]+)\]\(\.\./(models/[\w/-]+\.yaml)\).* \| `strut (\w+) ?(.*)` \|$", re.M)
tabled = {row[1]: row for row in ROW.findall(page)}
for model in sorted(glob.glob("models/**/*.yaml", recursive=True)):
    if re.search(r"^study:", open(model, encoding="utf-8").read(), re.M):
        continue
    check(f"](../{model})" in page, f"{model} is not in docs/gallery.md")
    if model in tabled:
        continue
    sizes = 2 if model.startswith("models/parts/") else 1
    if len(re.findall(rf"^strut \w+ {re.escape(model)} .*--plot [\w-]+\.svg$", page, re.M)) != sizes:
        fail(f"{model} has not {sizes} commands of its own in docs/gallery.md")
for model in re.findall(r"\]\(\.\./(models/[^)]+\.yaml)\)", page):
    check(os.path.exists(model), f"docs/gallery.md shows {model}, which is not there")
shown = re.findall(r"!\[[^\]]+\]\(gallery/([\w-]+\.svg)\)", page)
drawn = re.findall(r"--plot ([\w-]+\.svg)$", page, re.M)
there = sorted(os.path.basename(f) for f in glob.glob("docs/gallery/*"))
if not (sorted(shown) == sorted(drawn) == there):
    fail(f"shown, drawn and there are not the same: {set(shown) ^ set(drawn)}, " f"{set(shown) ^ set(there)}")
size = sum(os.path.getsize(f) for f in glob.glob("docs/gallery/*"))
check(size <= MOST_BYTES, f"the pictures have {size} bytes")

with tempfile.TemporaryDirectory() as now:
    subprocess.run(["sh", "docs/gallery.sh", strut, now], check=True)
    for name in sorted(set(there) & set(drawn)):
        why = differ(f"docs/gallery/{name}", os.path.join(now, name), name in PAIRED)
        if why:
            fail(f"docs/gallery/{name} is not what strut draws today: {why}; "
                 "if that is as it should be: sh docs/gallery.sh STRUT docs/gallery")

    for name, model, command, options in tabled.values():
        check(os.path.basename(model) == f"{name}.yaml", f"the row of {model} is called {name}")
        picture = os.path.join(now, "tabled.svg")
        run = subprocess.run([strut, command, model, *shlex.split(options), "--plot", picture],
                             capture_output=True, text=True)
        if run.returncode != 0 or os.path.getsize(picture) < 2000:
            fail(f"{model}: strut {command} {options} does not draw it: {run.stderr}")
        if os.path.exists(picture):
            os.remove(picture)

    # It notices a model that changed.
    broken = os.path.join(now, "broken.svg")
    for name, command in (
            ("gallery-x-frame.svg", ["modes", "models/gallery/x-frame.yaml", "--count", "4"]),
            ("gallery-half-t-bar.svg", ["path", "models/gallery/half-t-bar.yaml", "--set",
                                        "force=1", "--until", "100"])):
        text = open(command[1], encoding="utf-8").read()
        for old, new in (("stiffness: 1000", "stiffness: 200"), ("kind: cable", "kind: spring")):
            model = os.path.join(now, "broken.yaml")
            open(model, "w", encoding="utf-8").write(text.replace(old, new))
            if old not in text:
                continue
            subprocess.run([strut, command[0], model, *command[2:], "--width", "column", "--plot",
                            broken], stdout=subprocess.DEVNULL, check=True)
            if not differ(os.path.join(now, name), broken):
                fail(f"{name} is taken for a picture of a model with {new} instead of {old}")
finish()

# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/gallery.md: every model is there, and every picture is the one that strut draws today.

Pictures are compared line by line: each needs one of the same colour, length and direction, or
extent, in the other. Places are not compared, because letters of another version of Pango move
things and shapes of the same energy may change places, nor last bits, in which libraries differ.

usage: gallery_test.py STRUT
"""
import glob
import math
import os
import re
import subprocess
import sys
import tempfile

from svg_paths import near, read

strut = os.path.abspath(sys.argv[1])
SAME = 0.6  # [pt]
STRAYS = 0.01  # of all lines, without a counterpart: a hatched edge, a thinned curve
MOST_BYTES = 2.5e6
# Its modes come in pairs of one frequency, of which every mixture is as good: last bits choose one.
PAIRED = "gallery-michell-wheel.svg"
failures = 0


def fail(text):
    global failures
    failures += 1
    print("FAILED:", text)


def extent(line, straight):
    """Width and height; of a straight line with a sign for falling or rising."""
    xs, ys = [p[0] for p in line], [p[1] for p in line]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    if straight and (line[1][0] - line[0][0]) * (line[1][1] - line[0][1]) < 0:
        height = -height
    return width, height


def features(paths):
    """(colour, filled?, width, height) of each line and area; halos of letters left out."""
    result = []
    for path in paths:
        if near(path.stroke, (1, 1, 1)):
            continue
        for line in path.lines:
            size = extent(line, len(line) == 2)
            if path.fill:
                result.append((path.fill, True, *size))
            if path.stroke:
                result.append((path.stroke, False, *size))
    return result


def without_counterpart(some, others):
    """How many of some find none among the others, each of which serves once."""
    shelves = {}
    for colour, filled, width, height in others:
        key = (filled, round(width), round(height))
        shelves.setdefault(key, []).append((colour, width, height))
    lost = 0
    for colour, filled, width, height in some:
        best = None
        for i in range(math.floor(width - SAME), math.ceil(width + SAME) + 1):
            for k in range(math.floor(height - SAME), math.ceil(height + SAME) + 1):
                for other in shelves.get((filled, i, k), []):
                    apart = max(abs(other[1] - width), abs(other[2] - height))
                    tint = max(abs(a - b) for a, b in zip(other[0], colour))
                    if apart <= SAME and tint <= 0.06 and (best is None or apart < best[0]):
                        best = (apart, (filled, i, k), other)
        if best is None:
            lost += 1
        else:
            shelves[best[1]].remove(best[2])
    return lost


def differ(one, two):
    """Why two pictures are not the same; None where they are."""
    (width1, height1, paths1), (width2, height2, paths2) = read(one), read(two)
    if abs(width1 - width2) > 0.1 or abs(height1 - height2) > 0.1 * height1:
        return f"{width1} by {height1} pt, now {width2} by {height2}"
    some, others = features(paths1), features(paths2)
    if os.path.basename(one) == PAIRED:
        return None if abs(len(some) - len(others)) <= STRAYS * len(some) else "other lines"
    lost = without_counterpart(some, others) + without_counterpart(others, some)
    if lost > STRAYS * (len(some) + len(others)):
        return f"{lost} of {len(some)} + {len(others)} lines differ"
    return None


page = open("docs/gallery.md", encoding="utf-8").read()
for model in sorted(glob.glob("models/**/*.yaml", recursive=True)):
    if f"](../{model})" not in page:
        fail(f"{model} is not in docs/gallery.md")
    if len(re.findall(rf"^strut \w+ {re.escape(model)} .*--plot [\w-]+\.svg$", page, re.M)) != 1:
        fail(f"{model} has no command of its own in docs/gallery.md")
for model in re.findall(r"\]\(\.\./(models/[^)]+\.yaml)\)", page):
    if not os.path.exists(model):
        fail(f"docs/gallery.md shows {model}, which is not there")
shown = re.findall(r"!\[[^\]]+\]\(gallery/([\w-]+\.svg)\)", page)
drawn = re.findall(r"--plot ([\w-]+\.svg)$", page, re.M)
there = sorted(os.path.basename(f) for f in glob.glob("docs/gallery/*"))
if not (sorted(shown) == sorted(drawn) == there):
    fail(f"shown, drawn and there are not the same: {set(shown) ^ set(drawn)}, "
         f"{set(shown) ^ set(there)}")
size = sum(os.path.getsize(f) for f in glob.glob("docs/gallery/*"))
if size > MOST_BYTES:
    fail(f"the pictures have {size} bytes")

with tempfile.TemporaryDirectory() as now:
    subprocess.run(["sh", "docs/gallery.sh", strut, now], check=True)
    for name in sorted(set(there) & set(drawn)):
        why = differ(f"docs/gallery/{name}", os.path.join(now, name))
        if why:
            fail(f"docs/gallery/{name} is not what strut draws today: {why}; "
                 "if that is as it should be: sh docs/gallery.sh STRUT docs/gallery")

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
sys.exit(failures > 0)

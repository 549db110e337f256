# SPDX-License-Identifier: GPL-3.0-or-later
"""Every text of every figure in docs can be read: no two overlap, none leaves its page or is cut. Nor in
narrow figures of crowded structures, where single values far beyond a scale are told.

SVGs say in their metadata where their texts are, which are drawn as outlines: a line
<t box="X Y WIDTH HEIGHT">TEXT</t> for each. Units are points.

usage: overlap_test.py STRUT [DIRECTORY]
"""
import glob
import html
import os
import re
import subprocess
import sys

from testing import check, fail, finish, strut, work, write

HAIR = 0.3  # boxes may share so much [pt]
TEXT = re.compile(r'<t box="(\S+) (\S+) (\S+) (\S+)">(.*?)</t>')
PAGE = re.compile(r'viewBox="(\S+) (\S+) (\S+) (\S+)"')


def read_texts(path):
    """[(box, cut?, text)] of a figure: cut if it leaves the page."""
    with open(path, encoding="utf-8") as file:
        written = file.read()
    page = tuple(map(float, PAGE.search(written).groups()))
    found = [(tuple(map(float, text[:4])), html.unescape(text[4])) for text in TEXT.findall(written)]
    return [(box, min(box[:2]) < -HAIR or any(box[i] + box[i + 2] > page[i + 2] + HAIR for i in (0, 1)), text)
            for box, text in found]


def share(a, b):
    """Width and height of what two boxes have in common; negative where they are apart."""
    return [min(a[i] + a[i + 2], b[i] + b[i + 2]) - max(a[i], b[i]) for i in range(2)]


def find_faults(path):
    texts = read_texts(path)
    if not texts:
        return ["has no texts in its metadata"]
    faults = []
    for i, (box, cut, text) in enumerate(texts):
        if cut:
            faults.append(f"'{text}' leaves the page")
        if text.endswith("\u2026"):
            faults.append(f"'{text}' is shortened")
        for other, _, name in texts[:i]:
            if min(share(box, other)) > HAIR:
                faults.append(f"'{name}' and '{text}' overlap")
    return faults


def check_faults(path):
    for fault in find_faults(path):
        fail(f"{path}: {fault}")


directory = sys.argv[2] if len(sys.argv) > 2 else "docs"
count = 0
for figure in sorted(glob.glob(os.path.join(directory, "**/*.svg"), recursive=True)):
    count += 1
    check_faults(figure)
check(count >= 80, f"only {count} figures in {directory}")

for model in ("gallery/dual-triangle", "gallery/bistable-chain", "gallery/zeeman", "crawler/crawler"):
    figure = os.path.join(work, os.path.basename(model) + ".svg")
    subprocess.run([strut, "equilibria", f"models/{model}.yaml", "--width", "column", "--quiet", "--plot", figure],
                   check=True)
    check_faults(figure)
told = " ".join(text for _, _, text in read_texts(os.path.join(work, "dual-triangle.svg")))
check("167 kJ" in told and "1 barrier beyond the scale" in told, f"dual-triangle.svg says '{told}'")

# An outlier of a curve.
write("curve.csv", "x [m],y [J]\n" + "".join(f"{k},{1000 if k == 33 else k % 7}\n" for k in range(60)))
curve = os.path.join(work, "curve.svg")
subprocess.run([strut, "plot", os.path.join(work, "curve.csv"), "--plot", curve], check=True)
check_faults(curve)
told = " ".join(text for _, _, text in read_texts(curve))
check("1 point beyond the scale, up to 1 kJ" in told, f"curve.svg says '{told}'")
finish()

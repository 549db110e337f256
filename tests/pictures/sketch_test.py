# SPDX-License-Identifier: GPL-3.0-or-later
"""What `strut check` draws: true to scale, within its columns, whatever the structure and its names.

usage: sketch_test.py STRUT
"""
import os
import random
import subprocess
import tempfile
import unicodedata

from testing import fail, finish, strut

MARKS = {"●": "free", "▲": "held", "△": "y", "▷": "x"}
ASCII = {"o": "free", "#": "held", "^": "y", ">": "x"}


def check(text, locale="C.UTF-8", columns=None):
    """The lines of the sketch, and its line with the extent."""
    with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8", delete=False) as file:
        file.write(text)
    environment = dict(os.environ, LC_ALL=locale)
    environment.pop("COLUMNS", None)
    if columns:
        environment["COLUMNS"] = str(columns)
    run = subprocess.run([strut, "check", file.name], env=environment, capture_output=True)
    os.unlink(file.name)
    if run.returncode != 0:
        fail(f"exit code {run.returncode}: {run.stderr[:300]}\n{text[:500]}")
        return [], ""
    out = run.stdout.decode("utf-8").split("\n")
    end = next(i for i, line in enumerate(out) if line.startswith("  nodes  "))
    lines = out[2:end - 1]
    return lines[:-1], lines[-1]


def width(line):
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in line)


def scene(nodes, members=(), more="", held=()):
    quoted = [n[0].replace('"', '\\"') for n in nodes]
    text = "strut: 1\nnodes:\n"
    for i, (_, x, y) in enumerate(nodes):
        fixed = f", fixed: {held[i]}" if i < len(held) and held[i] else ""
        text += f'  "{quoted[i]}": {{position: [{x!r}, {y!r}], mass: 1{fixed}}}\n'
    text += "members:\n" if members else ""
    for i, (a, b, kind) in enumerate(members):
        text += (f'  m{i}: {{nodes: ["{quoted[a]}", "{quoted[b]}"], kind: {kind}, '
                 "stiffness: 1, mass: 1}\n")
    return text + more


def marks(lines, names=MARKS):
    return [(column, row, names[c]) for row, line in enumerate(lines)
            for column, c in enumerate(line) if c in names]


def test_scale():
    """Marks of random nodes stand where one linear map, the same in x and y, puts them."""
    random.seed(7)
    for size in (1.0, 1e-9, 1e9):
        nodes = [(f"n{i}", size * random.uniform(-1, 1), size * random.uniform(-0.4, 0.4))
                 for i in range(7)]
        lines, extent = check(scene(nodes))
        places = sorted((c, r) for c, r, _ in marks(lines))
        low = min(n[1] for n in nodes), min(n[2] for n in nodes)
        high = max(n[1] for n in nodes), max(n[2] for n in nodes)
        left, right = min(p[0] for p in places), max(p[0] for p in places)
        bottom = max(p[1] for p in places)
        cell = (high[0] - low[0]) / (right - left)
        for _, x, y in nodes:
            at = left + (x - low[0]) / cell, bottom - (y - low[1]) / (2 * cell)
            if not any(abs(c - at[0]) <= 1.2 and abs(r - at[1]) <= 1.1 for c, r in places):
                fail(f"no mark near {at}:\n" + "\n".join(lines))
        if len(places) > 7 or len(places) < 5:
            fail(f"{len(places)} marks of 7 nodes")


def test_extent():
    square = [("a", 0, 0), ("b", 0.0965, 0), ("c", 0.0965, 0.0284)]
    lines, extent = check(scene(square, [(0, 1, "bar"), (1, 2, "cable")]))
    if extent != "  96.5 mm x 28.4 mm":
        fail("extent: " + extent)
    for name in "abc":
        if not any("●" + name in line or name + "●" in line for line in lines):
            fail(f"no name {name}:\n" + "\n".join(lines))
    bottom = lines[-1]
    if sum("\u2801" <= c <= "\u28ff" for c in bottom) < 20:
        fail("no bar along the bottom: " + bottom)


def test_typo():
    """One coordinate a thousand times too large: its node stands alone, with its name."""
    square = [("a", 0, 0), ("b", 1, 0), ("c", 1, 1), ("typo", 0, 1000)]
    lines, extent = check(scene(square, [(0, 1, "bar"), (2, 3, "bar")]))
    if "typo" not in "".join(lines[:2]) or extent != "  1 m x 1 km":
        fail("the outlier: " + extent + "\n" + "\n".join(lines))
    if "+2" not in "\n".join(lines):
        fail("three nodes in one place are not counted:\n" + "\n".join(lines))


def test_crowd():
    """Among thousands of nodes only the one that stands alone has a mark and its name."""
    side = 40
    nodes = [(f"n{i}", i % side, i // side) for i in range(side * side)]
    nodes[1234] = ("stray", 900, 20)
    members = [(i, i + 1, "bar") for i in range(side * side - 1)]
    lines, extent = check(scene(nodes, members))
    text = "\n".join(lines)
    if text.count("●") != 1 or "●stray" not in text or " +" in text or "900 m" not in extent:
        fail("the stray node in a crowd:\n" + text)


def test_supports_and_ground():
    nodes = [("p", 0, 0), ("q", 1, 0), ("r", 1, 0.5), ("s", 0, 0.5)]
    held = ["both", "y", "x", None]
    members = [(0, 1, "bar"), (1, 2, "bar"), (2, 3, "bar")]
    ground = "ground: {stiffness: 1}\n"
    lines, extent = check(scene(nodes, members, ground, held))
    if sorted(k for _, _, k in marks(lines)) != ["free", "held", "x", "y"]:
        fail("supports:\n" + "\n".join(lines))
    if set(lines[-1].strip()) != {"▔"}:
        fail("the ground is not under the feet:\n" + "\n".join(lines))
    if extent != "  1 m x 500 mm,  ▲ held,  △ held in y,  ▷ held in x":
        fail("what the marks mean: " + extent)
    lines, extent = check(scene(nodes, members, ground, held), "C")
    text = "\n".join(lines) + extent
    if any(ord(c) > 126 for c in text):
        fail("not ASCII:\n" + text)
    if sorted(k for _, _, k in marks(lines, ASCII)) != ["free", "held", "x", "y"]:
        fail("supports in ASCII:\n" + text)
    if set(lines[-1].strip()) != {"="}:
        fail("no ground in ASCII:\n" + text)
    _, extent = check(scene(nodes, members, "ground: {stiffness: 1, height: -50}\n", held))
    if "the ground is far away" not in extent:
        fail("a far ground: " + extent)


def test_names():
    hostile = ["x-_.9", "שלום", "مرحبا", "ż" * 30, "結構", "e\u0301", "\u0e44\u0e17\u0e22", "a"]
    nodes = [(name, i % 4, i // 4 * 0.7) for i, name in enumerate(hostile)]
    for locale in ("C.UTF-8", "C"):
        lines, _ = check(scene(nodes), locale)
        text = "\n".join(lines)
        if any(unicodedata.bidirectional(c) in ("R", "AL") or unicodedata.combining(c)
               for c in text):
            fail("letters that turn the line or combine:\n" + text)
        for number in ("#2", "#3", "#6", "#7"):
            if number not in text:
                fail(f"no {number} in its name's place:\n" + text)
        if "x-_.9" not in text or "ż" * 15 in text:
            fail("names:\n" + text)
        if ("結構" in text) != (locale == "C.UTF-8"):
            fail("wide letters:\n" + text)
    wide = [("結構結構", 0, 0), ("b", 1, 0), ("c", 0, 0.5), ("d", 1, 0.5)]
    lines, _ = check(scene(wide, [(0, 1, "bar"), (2, 3, "bar")]))
    at = [width(line[:line.index(c)]) for c, line in (("b", lines[-1]), ("d", lines[0]))]
    if at[0] != at[1]:
        fail("wide letters shift what stands behind them:\n" + "\n".join(lines))


def test_sizes():
    grid = [(f"n{i}", i % 75, i // 75) for i in range(75 * 75)]
    many = [(i, i + 1, "bar") for i in range(75 * 75 - 1)] + \
           [(i, i + 75, "cable") for i in range(75 * 74)]
    shapes = {
        "one node": scene([("only", 3, 4)]),
        "in one place": scene([("a", 1, 1), ("b", 1, 1), ("c", 1, 1)]),
        "level": scene([("a", 0, 0), ("b", 5, 0)], [(0, 1, "spring")]),
        "upright": scene([("a", 0, 0), ("b", 0, 5)], [(0, 1, "spring")]),
        "hardly apart": scene([("a", 1e9, 0), ("b", 1e9 + 1e-6, 3e-9)], [(0, 1, "spring")]),
        "very flat": scene([("a", 0, 0), ("b", 1e9, 1e-9)], [(0, 1, "spring")]),
        "many": scene(grid, many),
    }
    for name, text in shapes.items():
        for locale in ("C.UTF-8", "C"):
            for columns in (None, 40, 5, 300):
                if name == "many" and columns not in (None, 40):
                    continue
                lines, extent = check(text, locale, columns)
                most = max(20, min(columns or 72, 72))
                if not lines or len(lines) + 1 > 16:
                    fail(f"{name}: {len(lines)} lines")
                if max(map(width, lines)) > most:
                    fail(f"{name}: wider than {most}:\n" + "\n".join(lines))
                if any(line != line.rstrip() for line in lines):
                    fail(f"{name}: blanks at a line's end")
                if "nan" in extent or "inf" in extent:
                    fail(f"{name}: {extent}")


for test in [test_scale, test_extent, test_typo, test_crowd, test_supports_and_ground,
             test_names, test_sizes]:
    test()
finish()

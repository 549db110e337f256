# SPDX-License-Identifier: GPL-3.0-or-later
"""strut plot: curves lie where the table's numbers say, bands and panels too; what it refuses.

usage: plot_test.py STRUT
"""
import json
import math
import os
import re
import time
import xml.etree.ElementTree as tree

import testing
from svg_paths import near, read, texts
from testing import check, finish, run, work, write

FIRST, SECOND = (0, 0x60 / 255, 0xA8 / 255), (0xD5 / 255, 0x5E / 255, 0)
BAND, FRAME = (0.86, 0.86, 0.86), (0.25, 0.25, 0.25)


def plot(*words, code=0, err=""):
    done = run("plot", *words, code=code, err=err)
    check(code or not done.stderr, f"strut plot {words}: {done.stderr}")
    return done


def fills_of(name):
    """Fills of a map's cells, row by row."""
    return [path.fill for path in read(name)[2] if path.fill and not near(path.fill, (1, 1, 1)) and not path.curved
            and max(p[0] for p in path.lines[0]) - min(p[0] for p in path.lines[0]) > 50]


def curves(paths, colour):
    """Lines of that colour with many points: the curves, not the legend's samples."""
    return [line for path in paths if near(path.stroke, colour) and not path.curved
            for line in path.lines if len(line) > 4]


def affine(values, places):
    """(slope, offset, largest deviation) of the line through the first and last."""
    slope = (places[-1] - places[0]) / (values[-1] - values[0])
    offset = places[0] - slope * values[0]
    return slope, offset, max(abs(slope * v + offset - p) for v, p in zip(values, places))


def check_curve(what, xs, ys, line):
    check(len(line) == len(xs), f"{what}: {len(line)} points of {len(xs)}")
    if len(line) != len(xs):
        return None
    low, high = ys.index(min(ys)), ys.index(max(ys))
    slope_x, offset_x, worst_x = affine(xs, [p[0] for p in line])
    slope_y = (line[high][1] - line[low][1]) / (ys[high] - ys[low])
    offset_y = line[low][1] - slope_y * ys[low]
    worst_y = max(abs(slope_y * y + offset_y - p[1]) for y, p in zip(ys, line))
    check(slope_x > 0 > slope_y, f"{what}: x runs right and y runs up")
    check(worst_x < 0.02 and worst_y < 0.02, f"{what}: off by {worst_x}, {worst_y} pt")
    return slope_x, offset_x, slope_y, offset_y


def boxes(paths, fill):
    found = []
    for path in paths:
        if near(path.fill, fill) and not path.curved:
            for line in path.lines:
                xs, ys = [p[0] for p in line], [p[1] for p in line]
                found.append((min(xs), min(ys), max(xs), max(ys)))
    return found


os.chdir(work)

# Two curves in one frame, one of them broken.
xs = [1 + 0.1 * i for i in range(40)]
one = [math.sin(x) * 0.01 for x in xs]
two = [0.02 * math.exp(-x) for x in xs]
rows = "".join(f"{x!r},{a!r},{b!r}\r\n" for x, a, b in zip(xs, one, two))
write("curves.csv", "frequency [Hz],one [m/s],\"two, \"\"quoted\"\" [m/s]\"\r\n" + rows)
plot("curves.csv", "--y", "one", "--plot", "one.svg")
_, _, paths = read("one.svg")
found = curves(paths, FIRST)
check(len(found) == 1, f"{len(found)} curves of 1")
if found:
    check_curve("one.svg", xs, one, found[0])
cells = rows.replace(f"{one[20]!r}", "", 1)
write("broken.csv", "frequency [Hz],one [m/s],two [m/s]\n" + cells.replace("\r", ""))
plot("broken.csv", "--plot", "broken.svg")
found = curves(read("broken.svg")[2], FIRST)
check(sorted(len(line) for line in found) == [19, 20], "a cell without a number breaks the curve")

# Panels, groups and bands: all frames share their scales, bands reach half way to the neighbours.
table = "f [Hz],v [m/s],start,mu,outcome\n"
for mu in (0.1, 0.2):
    for start, sign in (("I", 1), ("II", -1)):
        for i in range(30):
            outcome = "III" if mu == 0.2 and start == "I" and 10 <= i < 14 else start
            table += f"{1 + i},{sign * mu * (i - 7) ** 2 * 1e-3!r},{start},{mu},{outcome}\n"
write("panels.csv", table)
plot("panels.csv", "--by", "start", "--panels", "mu", "--band", "outcome=III", "--plot", "panels.svg")
_, _, paths = read("panels.svg")
maps = []
for colour, sign in ((FIRST, 1), (SECOND, -1)):
    found = curves(paths, colour)
    check(len(found) == 2, f"panels.svg: {len(found)} curves of 2")
    for mu, line in zip((0.1, 0.2), found):
        maps.append(check_curve(f"panels.svg, {mu}", [1.0 + i for i in range(30)],
                                [sign * mu * (i - 7) ** 2 * 1e-3 for i in range(30)], line))
if all(maps) and len(maps) == 4:
    check(all(abs(m[0] - maps[0][0]) < 1e-3 and abs(m[2] / maps[0][2] - 1) < 1e-3 for m in maps),
          "panels.svg: scales differ between panels")
    bands = [b for b in boxes(paths, BAND) if b[3] - b[1] > 40]
    check(len(bands) == 1, f"panels.svg: {len(bands)} bands of 1")
    if bands:
        slope, offset = maps[1][:2]
        for place, value in ((bands[0][0], 10.5), (bands[0][2], 14.5)):
            check(abs(slope * value + offset - place) < 0.05, f"panels.svg: a band ends at {place}")

# Some of the rows, and the second of two texts less the first, wherever its rows stand.
table, fs = "f [Hz],v [m/s],way,mu,outcome\n", [1 + 0.5 * i for i in range(40)]
values = {"slow": [0.01 * math.sin(f) for f in fs], "fast": [0.012 * math.cos(f) for f in fs]}
for way, order in (("slow", 1), ("fast", -1)):
    for f, v in list(zip(fs, values[way]))[::order]:
        if (way, f) != ("slow", 11.0):  # the first side lacks a row
            table += f"{f},{v!r},{way},0.1,{'III' if f > 15 or way == 'fast' and f == 4 else 'I'}\n"
write("ways.csv", table)
plot("ways.csv", "--only", "way=slow", "--plot", "only.svg")
kept = [i for i, f in enumerate(fs) if f != 11.0]
check_curve("only.svg", [fs[i] for i in kept], [values["slow"][i] for i in kept], curves(read("only.svg")[2], FIRST)[0])
plot("ways.csv", "--panels", "mu", "--difference", "way", "--plot", "less.svg")
found = curves(read("less.svg")[2], FIRST)
less = [b - a for a, b in zip(values["slow"], values["fast"])]
check(sorted(len(line) for line in found) == [19, 20], "less.svg: a gap where one side has no row")
lines = sorted(([p for p in line][::-1] if line[0][0] > line[-1][0] else line for line in found),
               key=lambda line: line[0][0])
if len(lines) == 2:
    both = [affine(f, [p[0] for p in line])[:2] + affine(v, [p[1] for p in line])[2:]
            for f, v, line in ((fs[:20], less[:20], lines[0]), (fs[21:], less[21:], lines[1]))]
    check(all(b[2] < 0.02 for b in both), f"less.svg: the curve is not the difference: {both}")
MAP = ("ways.csv", "--kind", "map", "--y", "mu", "--label", "outcome")
plot(*MAP, "--difference", "way", "--plot", "differs.svg")
plot(*MAP, "--only", "way=fast", "--plot", "fast.svg")


def hatched(name):  # the lines of the hatching are as long as nothing else in the map
    return len(read(name)[2])


check(hatched("differs.svg") > hatched("fast.svg"), "differs.svg: where they differ it is hatched")
write("same.csv", "f,v,way\n" + "".join(f"{i},{'I' if i % 2 else 'II'},{w}\n" for w in "ab" for i in range(6)))
SAME = ("same.csv", "--kind", "map", "--y", "f", "--label", "v")
plot(*SAME, "--difference", "way", "--plot", "same.svg")
plot(*SAME, "--only", "way=b", "--plot", "b.svg")
check(hatched("same.svg") == hatched("b.svg"), "same.svg: nothing differs, yet it is marked")

# Logarithmic axes. Zigzag, since Cairo makes one line of pieces that go on straight.
logs = [-3.0 * i + 0.3 * (i % 2) for i in range(12)]
write("log.csv", "step [s],error\n" + "".join(f"{2.0 ** -i!r},{2.0 ** y!r}\n" for i, y in enumerate(logs)))
plot("log.csv", "--log", "xy", "--plot", "log.svg")
line = curves(read("log.svg")[2], FIRST)[0]
check_curve("log.svg", [-float(i) for i in range(12)][::-1], logs[::-1], line[::-1])

# Columns share the y axis, so that they need one unit.
write("two.csv", "f [Hz],v [m/s],w [J]\n" + "".join(f"{x!r},{a!r},{2e-3 * x * x!r}\n" for x, a in zip(xs, one)))
plot("two.csv", "--y", "v,w", "--plot", "a.svg", code=1, err="different units (m/s, J)")

# Legends show numbers with a prefix; labels that are given stand in their place.
write("stiff.csv", "x [m],y [N],k [N/m],px [px]\n1,2,2000,0.1\n2,3,2000,0.1\n1,5,500,0.2\n2,1,500,0.2\n")
for words, wanted in ((["stiff.csv", "--by", "k"], {"k 2 kN/m", "k 500 N/m"}),
                      (["stiff.csv", "--y", "px"], {"px in px", "0.10", "0.20"}),
                      (["stiff.csv", "--by", "k", "--labels", "hard,soft one"], {"hard", "soft one"})):
    plot(*words, "--plot", "words.svg")
    check(wanted <= set(texts("words.svg")), f"{words}: {texts('words.svg')}")
for words, err in ((["two.csv", "--y", "v", "--labels", "a,b"], "2 labels were given for 1 curve"),
                   (["two.csv", "--kind", "map", "--labels", "a"], "has no option --labels")):
    plot(*words, "--plot", "a.svg", code=1, err=err)

# With --svg-text texts are texts, the same and in the same boxes as the outlines; nothing else changes.
plot("stiff.csv", "--by", "k", "--title", "<a> & b", "--plot", "outlines.svg")
plot("stiff.csv", "--by", "k", "--title", "<a> & b", "--plot", "texts.svg", "--svg-text")
noted = [tree.parse(f"{name}.svg").iter("{urn:strut:texts}t") for name in ("outlines", "texts")]
noted = [[(t.text, [float(n) for n in t.get("box").split()]) for t in each] for each in noted]
written = list(tree.parse("texts.svg").iter("{http://www.w3.org/2000/svg}text"))
check(noted[0] == noted[1] and [t.text for t in written] == [text for text, _ in noted[0]], "texts.svg: other texts")
for t, (text, box) in zip(written, noted[0]):
    at, turned = [float(n) for n in re.findall(r"[-\d.]+", t.get("transform"))], "rotate" in t.get("transform")
    x, y = float(t.get("x")), float(t.get("y"))
    x, y = (at[0] + y, at[1] - x) if turned else (at[0] + x, at[1] + y)
    check(box[0] - 2 < x < box[0] + box[2] + 3 and box[1] - 1 < y < box[1] + box[3] + 3, f"texts.svg: {text} is at {x}, {y}")
shapes = [[path.lines for path in read(f"{name}.svg")[2]] for name in ("outlines", "texts")]
check(shapes[0] == shapes[1], "texts.svg: other lines")
plot("stiff.csv", "--svg-text", "--plot", "a.pdf", code=1, err="--svg-text is for figures that end with .svg")

# Limits and labels that are given.
plot("two.csv", "--y", "v", "--x-limits", "0,10", "--y-limits", "-0.02,0.02", "--plot", "limits.svg",
     "--x-label", "frequency of the drive", "--y-label", "speed", "--title", "Own title")
found = check_curve("limits.svg", xs, one, curves(paths := read("limits.svg")[2], FIRST)[0])
frames = [path.lines[0] for path in paths if near(path.stroke, FRAME) and len(path.lines[0]) >= 4]
if found and frames:
    low, high = (f(p[0] for p in frames[0]) for f in (min, max))
    check(abs(found[1] - low) < 0.05 and abs(10 * found[0] + found[1] - high) < 0.05, "limits.svg: x from 0 to 10")
    top, bottom = (f(p[1] for p in frames[0]) for f in (min, max))
    check(abs(0.02 * found[2] + found[3] - top) < 0.05, "limits.svg: y up to 0.02")
for words, err in ((["--x-limits", "3,1"], "two ascending numbers"),
                   (["--y-limits", "0,1", "--log", "y"], "above 0"),
                   (["--y-limits", "x"], "two ascending numbers"),
                   (["--colors", "grey"], "has no option --colors")):
    plot("two.csv", "--y", "v", *words, "--plot", "a.svg", code=1, err=err)

# An eighth curve has the colour of the first, and other dashes.
write("many.csv", "t," + ",".join(f"rise_n{k} [m]" for k in range(8)) + ",accuracy_kept\n" + "".join(
    f"{i}," + ",".join(f"{k + math.sin(i)!r}" for k in range(8)) + f",{i % 9 and 1}\n" for i in range(30)))
plot("many.csv", "--y", ",".join(f"rise_n{k}" for k in range(8)), "--plot", "many.svg")
dashes = [path.dash for path in read("many.svg")[2] if near(path.stroke, FIRST) and not path.curved
          and any(len(line) > 4 for line in path.lines)]
check(len(dashes) == 2 and bool(dashes[0]) != bool(dashes[1]), f"many.svg: dashes {dashes}")
check({"rise in m", "accuracy not kept"} <= set(texts("many.svg")) and 4 * 8 + 1 ==
      sum(path.curved and not path.fill for path in read("many.svg")[2]), "many.svg: rings")

# Rounding noise is drawn as a level line.
write("noise.csv", "t [s],y [m],c [N]\n" + "".join(
    f"{i},{1e-16 * (-1) ** i!r},{0.1 + 1e-16 * (i * i % 7)!r}\n" for i in range(30)))
for name in "yc":
    plot("noise.csv", "--y", name, "--plot", "noise.svg")
    heights = [p[1] for path in read("noise.svg")[2] if near(path.stroke, FIRST) for line in path.lines for p in line]
    check(heights and max(heights) - min(heights) < 0.01, f"noise.svg, {name}: it is no level line")

# A map: every cell where its row says.
write("map.csv", "a,b,c\n" + "".join(f"{i},{k},{'x' if (i + k) % 3 else 'y'}\n" for i in range(5) for k in range(4)))
plot("map.csv", "--kind", "map", "--plot", "map.svg")
fills = fills_of("map.svg")
check(len(fills) == 20, f"map.svg: {len(fills)} cells of 20")
kinds = {(fill, (i + k) % 3 == 0) for fill, (k, i) in zip(fills, ((k, i) for k in range(4) for i in range(5)))}
check(len(kinds) == 2, "map.svg: a cell has another's colour")
plot("map.csv", "--kind", "map", "--label", "a", "--plot", "numbers.svg")
write("hole.csv", testing.read("map.csv").decode().replace("2,1,y", "2,1,"))
plot("hole.csv", "--kind", "map", "--plot", "hole.svg")
fills = fills_of("hole.svg")
check(len(fills) == 19 and len(set(fills)) == 2, "a cell of which nothing is said has no category")

# A map of a signed quantity: blue below zero, brown above, near white at it, whatever the extremes.
write("signed.csv", "a,b,v [m/s]\n" + "".join(
    f"{i},{k},{0.01 * (i - 1) * (1 + k)!r}\n" for i in range(5) for k in range(4)))


def cells_of(*words):
    plot("signed.csv", "--kind", "map", *words, "--plot", "signed.svg")
    return fills_of("signed.svg")[:20]


shades = cells_of()
check(len(shades) == 20, f"signed.svg: {len(shades)} cells of 20")
for k, fill in enumerate(shades):
    i = k % 5
    sign = (fill[0] > fill[2] + 0.02) - (fill[2] > fill[0] + 0.02)
    check(sign == (i > 1) - (i < 1), f"signed.svg: cell {k} has the colour {fill}")
check(all(abs(f[0] - f[1]) < 0.01 and abs(f[1] - f[2]) < 0.01 for f in cells_of("--colors", "grey")),
      "signed.svg: --colors grey")
check(cells_of("--colors", "sequential") != shades, "signed.svg: --colors sequential")

# A point between two gaps is seen.
write("lone.csv", "t,x\n" + "".join(f"{i},{'' if i in (3, 5) else i * i}\n" for i in range(40)))
plot("lone.csv", "--plot", "lone.svg")
dots = [path for path in read("lone.svg")[2] if path.curved and near(path.fill, FIRST)]
check(len(dots) == 1, f"lone.svg: {len(dots)} dots of 1")
for name, *words in (("map", "--kind", "map"), ("panels", "--by", "start", "--panels", "mu", "--band", "outcome=III")):
    plot(f"{name}.csv", *words, "--plot", "again.svg")
    check(testing.read("again.svg") == testing.read(f"{name}.svg"), f"{name}: other bytes the second time")

# Oscillations too fast to be seen are an area, from least to largest; slower ones are a curve.
for per_point, area in ((0.02, False), (0.45, True)):
    write("fast.csv", "t [s],x [m]\n" + "".join(
        f"{i},{(1 + i / 2000) * math.sin(2 * math.pi * per_point * i)}\n" for i in range(1000)))
    plot("fast.csv", "--width", "column", "--plot", "fast.svg")
    found, pale = curves(read("fast.svg")[2], FIRST), "stroke-opacity" in re.sub(r'stroke-opacity[:="]+1\D', "", open("fast.svg").read())
    check(len(found) == 1 and pale == area and ("areas: ranges of oscillations" in texts("fast.svg")) == area,
          f"fast.svg: {len(found)} curves, {pale}")
    if area:
        left, right = ([p[1] for p in found[0] if side(p[0])] for side in (
            lambda x: x < found[0][0][0] + 8, lambda x: x > max(p[0] for p in found[0]) - 8))
        grown = (max(right) - min(right)) / (max(left) - min(left))
        check(abs(grown - 1.5) < 0.06, f"fast.svg: the area is {grown} times as high at its end")

# Rows of one text stand side by side; a band is behind their bars; names that are too wide stand upwards.
rows = [("walk", 1, "I"), ("walk", 2, "II"), ("hop", 3, "I"), ("a long name of it", 4, "I")]
write("same.csv", "gait,speed [mm/s],state\n" + "".join(f"{g},{v},{s}\n" for g, v, s in rows))
plot("same.csv", "--band", "state=II", "--width", "column", "--plot", "same.svg")
plot("same.csv", "--plot", "same.json")
series = json.load(open("same.json"))["panels"][0]["series"][0]
check(near(series["x"], (-0.175, 0.175, 1, 2)) and near(series["y"], (1, 2, 3, 4)) and series["bar"] == 0.35,
      f"same.json: {series}")
check("state II" in texts("same.svg"), f"same.svg: no band in {texts('same.svg')}")
boxes = {text: [float(x) for x in box.split()]
         for box, text in re.findall(r'<t box="(.*?)".*?>(.*?)</t>', open("same.svg").read())}
for name, _, _ in rows:
    check(boxes[name][3] > boxes[name][2], f"same.svg: '{name}' lies in {boxes[name]}")
plot("same.csv", "--log", "x", "--plot", "a.svg", code=1, err="'gait' holds texts, which have no logarithmic axis")
plot("two.csv", "--x", "v", "--y", "v,w", "--plot", "a.svg", code=1, err="different units (m/s, J)")

# The data of a figure have the axes that were asked for.
plot("same.csv", "--x", "gait", "--y", "speed", "--y-label", "pace", "--y-limits", "1,9", "--log", "y",
     "--plot", "axes.json")
axis = json.load(open("axes.json"))["panels"][0]["y"]
check((axis["name"], axis["from"], axis["to"], axis["logarithmic"]) == ("pace", 1, 9, True), f"axes.json: {axis}")

# Charts of a row line up below titles of one line and of two.
write("titles.csv", "kind,x,y\n" + "".join(f"{name},{x},{x}\n" for name in ("a", "a name for which two lines are needed")
                                        for x in (1, 2)))
plot("titles.csv", "--x", "x", "--y", "y", "--panels", "kind", "--plot", "titles.svg")
middles = [float(box.split()[1]) for box in re.findall(r'<t box="([^"]*)">y</t>', open("titles.svg").read())]
check(len(middles) == 2 and middles[0] == middles[1], f"titles.svg: labels at {middles}")

# Numbers over texts are bars side by side, as high as the numbers.
write("bars.csv", "gait,speed [mm/s],side\n" + "".join(f"{g},{v},{s}\n" for g, v, s in (
    ("walk", 2, "a"), ("hop", -4, "a"), ("crawl", 6, "a"), ("walk", 3, "b"), ("hop", 1, "b"))))
plot("bars.csv", "--by", "side", "--plot", "bars.svg")
bars = [path.lines[0] for path in read("bars.svg")[2] if path.stroke and path.width > 5 and len(path.lines[0]) == 2]
heights = [line[0][1] - line[1][1] for line in bars]
check(len(bars) == 5 and all(abs(h / heights[0] - v / 2) < 0.01 for h, v in zip(heights, (2, -4, 6, 3, 1))),
      f"bars.svg: {heights}")
check(len({round(line[0][0]) for line in bars}) == 5, "bars.svg: bars lie over each other")
check({"walk", "hop", "crawl", "side a", "side b"} <= set(texts("bars.svg")), f"bars.svg: {texts('bars.svg')}")

# Refusals: where, what was expected, and nothing left behind.
plot("curves.csv", "--x", "freqency", "--plot", "a.svg", code=1, err="did you mean 'frequency'?")
plot("panels.csv", "--y", "start", "--plot", "a.svg", code=1, err="does not hold numbers")
plot("curves.csv", code=1, err="missing --plot FILE")
plot("curves.csv", "--plot", "a.bmp", code=1, err=".svg, .pdf or .png")
plot("curves.csv", "--kind", "pie", "--plot", "a.svg", code=1, err="curves")
plot("curves.csv", "--doubt", "one", "--plot", "a.svg", code=1, err="has no option --doubt")
plot("curves.csv", "--plot", "nowhere/a.svg", code=4, err="nowhere")
plot("ways.csv", "--only", "way=slo", "--plot", "a.svg", code=1, err="has 'slo' in column 'way'")
plot("ways.csv", "--band", "way=slo", "--plot", "a.svg", code=1, err="has 'slo' in column 'way'")
plot("ways.csv", "--only", "way", "--plot", "a.svg", code=1, err="expects COLUMN=TEXT")
plot("ways.csv", "--difference", "mu", "--plot", "a.svg", code=1, err="nothing to compare")
plot("ways.csv", "--difference", "f", "--plot", "a.svg", code=1, err="more than 2 sides to compare")
plot("ways.csv", "--difference", "wya", "--plot", "a.svg", code=1, err="did you mean 'way'?")
write("ragged.csv", "a,b\n1,2\n3\n4,5,6\n")
done = plot("ragged.csv", "--plot", "a.svg", code=2, err="ragged.csv:3:1: error: 1 cells, expected 2")
check("ragged.csv:4:1" in done.stderr, "only the first bad row is reported")
write("open.csv", 'a,b\n1,"2\n')
plot("open.csv", "--plot", "a.svg", code=2, err="open.csv:2:3: error: unterminated quoted cell")
write("empty.csv", "")
plot("empty.csv", "--plot", "a.svg", code=2, err="empty")
write("header.csv", "a,b\n")
plot("header.csv", "--plot", "a.svg", code=2, err="no rows")
write("nan.csv", "a,b\n1,nan\n2,\n")
plot("nan.csv", "--plot", "a.svg", code=1, err="'b' does not hold numbers")
check(not os.path.exists("a.svg"), "a refusal left a picture")
write("bytes.csv", b"a\xff\xfe,b\n1,2\n3,4\n")
plot("bytes.csv", "--plot", "bytes.svg")

# A million rows take seconds.
write("long.csv", "t [s],x [m]\n" + "".join(f"{i},{i % 1000}\n" for i in range(1000000)))
begin = time.monotonic()
plot("long.csv", "--plot", "long.svg")
check(time.monotonic() - begin < 60, "a million rows take a minute")
check(os.path.getsize("long.svg") < 1e6, "a million rows make a large picture")
finish()

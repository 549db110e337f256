# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines and areas of an SVG as Cairo writes it, in points on the page; letters left out.

Cairo 1.16 puts colours into style="...", 1.18 into attributes of their own; both place things with
matrices, docs/smaller.awk tells lines by their steps. What is read here is the same for all.
"""
import math
import re
import xml.etree.ElementTree as tree

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
UNIT = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)


def product(a, b):
    """The matrix that does b first, then a."""
    return (a[0] * b[0] + a[2] * b[1], a[1] * b[0] + a[3] * b[1],
            a[0] * b[2] + a[2] * b[3], a[1] * b[2] + a[3] * b[3],
            a[0] * b[4] + a[2] * b[5] + a[4], a[1] * b[4] + a[3] * b[5] + a[5])


def placed(m, x, y):
    return (m[0] * x + m[2] * y + m[4], m[1] * x + m[3] * y + m[5])


def colour(text):
    """Red, green, blue from 0 to 1, or None."""
    if not text or text == "none" or text.startswith("url"):
        return None
    if text.startswith("#"):
        digits = text[1:] if len(text) == 7 else "".join(2 * c for c in text[1:])
        return tuple(int(digits[i:i + 2], 16) / 255 for i in (0, 2, 4))
    if text.startswith("rgb"):
        parts = [float(n) for n in NUMBER.findall(text)][:3]
        return tuple(p / (100 if "%" in text else 255) for p in parts)
    return {"black": (0, 0, 0), "white": (1, 1, 1)}.get(text)


def texts(path):
    """What is written in the picture, as its metadata say."""
    return re.findall(r"<t [^>]*>([^<]*)</t>", open(path, encoding="utf-8").read())


class Path:
    """fill, stroke: colours or None; width, dash; lines: lists of points, `curved` if some bend."""

    def __init__(self, element, matrix):
        style = dict(part.split(":", 1) for part in element.get("style", "").split(";") if part)
        get = lambda key, other=None: style.get(key, element.get(key, other))
        self.fill = colour(get("fill", "black"))
        self.stroke = colour(get("stroke"))
        self.width = float(get("stroke-width", "1"))
        dash = get("stroke-dasharray", "none")
        self.dash = None if dash == "none" else [float(n) for n in NUMBER.findall(dash)]
        self.curved = "c" in element.get("d", "").lower()
        self.lines = []
        here = start = (0.0, 0.0)
        for command, rest in re.findall(r"([MLCZHVmlczhv])([^MLCZHVmlczhv]*)", element.get("d", "")):
            n = [float(t) for t in NUMBER.findall(rest)]
            if command in "Zz":
                here = start
                continue
            if command in "HhVv":  # the other coordinate stays
                stays = 0.0 if command.islower() else here[command == "H"]
                n = [v for t in n for v in ((t, stays) if command in "Hh" else (stays, t))]
            points = []
            for i in range(0, len(n) - 1, 2):
                if i % (6 if command in "Cc" else 2) == 0:
                    origin = here if command.islower() else (0.0, 0.0)
                here = (origin[0] + n[i], origin[1] + n[i + 1])
                points.append(placed(matrix, *here))
            if command in "Mm":
                start = (origin[0] + n[0], origin[1] + n[1])
                self.lines.append(points)
            elif points and self.lines:
                self.lines[-1] += points
        self.lines = [line for line in self.lines if len(line) > 1]


def matrix_of(element):
    text = element.get("transform", "")
    numbers = [float(n) for n in NUMBER.findall(text)]
    if text.startswith("matrix"):
        return tuple(numbers)
    if text.startswith("translate"):
        return (1.0, 0.0, 0.0, 1.0, numbers[0], numbers[1] if len(numbers) > 1 else 0.0)
    if text.startswith("scale"):
        return (numbers[0], 0.0, 0.0, numbers[-1], 0.0, 0.0)
    return UNIT


def read(file):
    """(width, height, paths in the order they are drawn)."""
    root = tree.parse(file).getroot()
    paths = []

    def walk(element, matrix):
        name = element.tag.split("}")[-1]
        if name in ("defs", "clipPath", "pattern", "symbol", "mask"):
            return
        matrix = product(matrix, matrix_of(element))
        if name == "path":
            path = Path(element, matrix)
            if path.lines:
                paths.append(path)
        for child in element:
            walk(child, matrix)

    walk(root, UNIT)
    size = [float(NUMBER.findall(root.get(side))[0]) for side in ("width", "height")]
    return size[0], size[1], paths


def near(colour_a, colour_b):
    return colour_a is not None and max(abs(a - b) for a, b in zip(colour_a, colour_b)) < 0.01


def middle(line):
    """Of the box around a line."""
    return tuple((min(p[d] for p in line) + max(p[d] for p in line)) / 2 for d in (0, 1))


def circles(paths, stroke):
    """Centres of the nodes drawn with that edge, in their order."""
    return [middle(line) for path in paths for line in path.lines
            if path.curved and near(path.stroke, stroke) and near(path.fill, (1, 1, 1))]


class Window:
    """Where places [m] are on the page, upright, by where the two farthest apart are drawn."""

    def __init__(self, places, drawn):
        pairs = [(math.dist(places[i], places[k]), i, k) for i in range(len(places)) for k in range(i)]
        apart, i, k = max(pairs)
        self.scale = math.dist(drawn[i], drawn[k]) / apart
        self.left = drawn[i][0] - self.scale * places[i][0]
        self.top = drawn[i][1] + self.scale * places[i][1]
        self.worst = max(math.dist(self.on_page(place), at) for place, at in zip(places, drawn))

    def on_page(self, place):
        return self.left + self.scale * place[0], self.top - self.scale * place[1]


def segments(paths):
    """All straight lines of two points: (start, end, path)."""
    return [(line[0], line[1], path) for path in paths if not path.curved and path.stroke
            for line in path.lines if len(line) == 2]


def has_segment(found, a, b, tolerance=0.02):
    """The first path with a segment between these points, in either direction; or None."""
    close = lambda p, q: abs(p[0] - q[0]) < tolerance and abs(p[1] - q[1]) < tolerance
    for start, end, path in found:
        if (close(start, a) and close(end, b)) or (close(start, b) and close(end, a)):
            return path
    return None


def distance(point, line):
    """Distance of a point from a line through points."""
    best = math.inf
    for a, b in zip(line, line[1:]):
        along = (b[0] - a[0], b[1] - a[1])
        square = along[0] ** 2 + along[1] ** 2
        t = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / square if square else 0
        t = max(0, min(1, t))
        best = min(best, math.dist(point, (a[0] + t * along[0], a[1] + t * along[1])))
    return best

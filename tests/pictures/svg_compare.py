# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two SVGs show the same, whatever the versions of the libraries that drew them.

Pictures are compared line by line: each needs one of the same colour, length and direction, or
extent, in the other. Places are not compared, because letters of another version of Pango move
things and shapes of the same energy may change places, nor last bits, in which libraries differ.
"""
import math

from svg_paths import near, read

SAME = 0.6  # [pt]
STRAYS = 0.01  # of all lines, without a counterpart: a hatched edge, a thinned curve


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


def differ(one, two, only_counts=False):
    """Why two pictures are not the same; None where they are. Or only by how many lines there are."""
    (width1, height1, paths1), (width2, height2, paths2) = read(one), read(two)
    if abs(width1 - width2) > 0.1 or abs(height1 - height2) > 0.1 * height1:
        return f"{width1} by {height1} pt, now {width2} by {height2}"
    some, others = features(paths1), features(paths2)
    if only_counts:
        return None if abs(len(some) - len(others)) <= STRAYS * len(some) else "other lines"
    lost = without_counterpart(some, others) + without_counterpart(others, some)
    if lost > STRAYS * (len(some) + len(others)):
        return f"{lost} of {len(some)} + {len(others)} lines differ"
    return None

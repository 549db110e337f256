# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions for ParaView: a VTK file per frame (.vtp, XML PolyData), and structure.pvd, which lists them with their times.

Points are the nodes with z = 0, cells the members as lines, both in the scene's order; a structure without members has
its nodes as cells. The ground is part 1. Numbers are Float64 with the same bits as in the run's tables.
"""

from __future__ import annotations

import base64
import csv
import itertools
import math
import os
import re
import struct
from typing import Any, Iterator, Mapping, Sequence

from .. import Scene
from . import Failure, kind_of, number, shape, write_folder

_MOST_FRAMES = 10000
_HEAD = '<?xml version="1.0"?>\n<VTKFile type="%s" version="%s" byte_order="LittleEndian"%s>\n<%s>\n'
_DATA = _HEAD % ("PolyData", "1.0", ' header_type="UInt64"', "PolyData")
_PIECE = '<Piece NumberOfPoints="%d" NumberOfVerts="%d" NumberOfLines="%d" NumberOfStrips="0" NumberOfPolys="0">\n'
_TAIL = "</Piece>\n</PolyData>\n</VTKFile>\n"
_Row = Mapping[str, float]


def _array(name: str, kind: str, values: Sequence[float], more: str = "") -> str:
    data = struct.pack(f"<{len(values)}{'d' if kind == 'Float64' else 'i'}", *values)
    text = base64.b64encode(struct.pack("<Q", len(data)) + data).decode()
    return f'<DataArray type="{kind}" Name="{name}"{more} format="binary">{text}</DataArray>\n'


def _whole(name: str, values: Sequence[int]) -> str:
    return _array(name, "Int32", values)


def _vectors(name: str, pairs: Sequence[Sequence[float]]) -> str:
    return _array(name, "Float64", [v for x, y in pairs for v in (x, y, 0.0)], ' NumberOfComponents="3"')


def _names(name: str, texts: Sequence[str]) -> str:
    codes = " ".join(str(code) for text in texts for code in (*text.encode(), 0))
    head = f'<DataArray type="String" Name="{name}" NumberOfTuples="{len(texts)}" format="ascii">'
    return f"{head}{codes}</DataArray>\n"


def _cells(tag: str, cells: Sequence[Sequence[int]]) -> str:
    ends, flat = itertools.accumulate(map(len, cells)), itertools.chain(*cells)
    return f"<{tag}>\n{_whole('connectivity', list(flat))}{_whole('offsets', list(ends))}</{tag}>\n"


def _outline(ground: dict[str, Any], middle: Sequence[float], far: float) -> list[Any]:
    """Points of the surface, the solid to the right; ends of lines and profiles reach beyond `far` from the middle."""
    if "circle" in ground:
        (x, y), r = ground["circle"]["centre"], ground["circle"]["radius"]
        return [(x + r * math.cos(k * math.pi / 48), y - r * math.sin(k * math.pi / 48)) for k in range(97)]
    slope, (x, y) = ground.get("slope", 0), ground.get("through", (0, ground.get("height", 0)))
    points = ground.get("profile", [(x, y), (x + math.cos(slope), y + math.sin(slope))])

    def beyond(end: Any, beside: Any) -> tuple[float, float]:
        by = (far + math.dist(middle, end)) / math.dist(end, beside)
        return end[0] + by * (end[0] - beside[0]), end[1] + by * (end[1] - beside[1])

    return [beyond(points[0], points[1]), *ground.get("profile", []), beyond(points[-1], points[-2])]


def _sides(points: Sequence[Any]) -> Iterator[tuple[Any, Any, int]]:
    """Those of a profile and in which of its convex pieces they are: at a concave corner it turns to the left."""
    piece = 0
    for a, b, c in zip(points, points[1:], [*points[2:], *points[-1:]]):
        yield a, b, piece
        piece += (b[0] - a[0]) * (c[1] - b[1]) > (b[1] - a[1]) * (c[0] - b[0])


def _normal(ground: dict[str, Any], piece: int, point: Any) -> tuple[float, float]:
    """Out of the ground at a node; of a convex piece of a profile that of its nearest side."""
    if "circle" in ground:
        centre, inside = ground["circle"]["centre"], ground["circle"].get("inside") in (True, "yes")
        size = math.dist(point, centre) * (-1 if inside else 1) or math.inf
        return (point[0] - centre[0]) / size, (point[1] - centre[1]) / size
    slope = ground.get("slope", 0)
    best = -math.inf, (-math.sin(slope), math.cos(slope))
    for a, b, k in _sides(ground.get("profile", ())):
        way = (a[1] - b[1]) / math.dist(a, b), (b[0] - a[0]) / math.dist(a, b)
        if k == piece:
            best = max(best, ((point[0] - a[0]) * way[0] + (point[1] - a[1]) * way[1], way))
    return best[1]


class _Structure:
    """What all frames share."""

    def __init__(self, scene: Scene) -> None:
        self.nodes, self.names, words = scene.names("nodes"), scene.names("members"), scene.to_dict()
        members = [words["members"][name] for name in self.names]
        self.cells = [[self.nodes.index(node) for node in member["nodes"]] for member in members]
        self.kinds = [kind_of(member) for member in members]
        self.rest = shape(scene, None)["rest_length"]
        self.grounds = words.get("grounds", {"": words["ground"]} if "ground" in words else {})
        moving = any("motion" in g and ("circle" in g or "profile" in g) for g in self.grounds.values())
        #: of each contact, called NODE, NODE.GROUND or with .PIECE behind: the node, its ground and the piece
        self.contacts: dict[str, tuple[int, dict[str, Any], int]] = {}
        for i, node in enumerate(self.nodes):
            for key, ground in self.grounds.items():
                for name in () if moving else scene.names("contacts"):
                    found = re.fullmatch(re.escape(node) + f"(?:[.]{re.escape(key)})?(?:[.]([0-9]+))?", name)
                    if found:
                        self.contacts[name] = i, ground, int(found[1] or 1) - 1

    def pushes(self, position: Sequence[Any], contact: Sequence[Any]) -> list[tuple[float, float]]:
        """Forces of the ground on the nodes."""
        found = [(0.0, 0.0)] * len(self.nodes)
        for (i, ground, piece), (normal, friction) in zip(self.contacts.values(), contact):
            (x, y), (a, b) = _normal(ground, piece, position[i]), found[i]
            found[i] = a + normal * x + friction * y, b + normal * y - friction * x
        return found

    def frame(self, time: float, row: dict[str, Any], first: Sequence[Any]) -> str:
        position, length, force = row["position"], row["length"], row["force"]
        moved = [(x - a, y - b) for (x, y), (a, b) in zip(position, first)]
        text = f"{_DATA}<FieldData>\n" + _array("TimeValue", "Float64", [time], ' NumberOfTuples="1"')
        text += _names("node_names", self.nodes) + _names("member_names", self.names) + "</FieldData>\n"
        count, lines = len(position), len(self.cells)
        text += _PIECE % (count, 0 if lines else count, lines) + "<PointData>\n"
        text += _whole("node", range(count)) + _vectors("displacement", moved)
        text += _vectors("velocity", row["velocity"]) if row["velocity"] else ""
        text += _vectors("contact_force", self.pushes(position, row["contact"])) if row["contact"] else ""
        text += "</PointData>\n"
        if lines:
            loose = [f == 0 for f in force] if force else [a <= b for a, b in zip(length, self.rest)]
            slack = [int(kind == 2 and none) for kind, none in zip(self.kinds, loose)]
            strain = [a / b - 1 if b > 0 else 0 for a, b in zip(length, self.rest)]
            text += f"<CellData>\n{_whole('kind', self.kinds)}{_whole('slack', slack)}"
            text += _array("length", "Float64", length) + _array("strain", "Float64", strain)
            text += (_array("force", "Float64", force) if force else "") + "</CellData>\n"
        text += f"<Points>\n{_vectors('Points', position)}</Points>\n"
        return text + (_cells("Lines", self.cells) if lines else _cells("Verts", [[i] for i in range(count)])) + _TAIL

    def outlines(self, low: float, high: float, y: float, size: float) -> str:
        """The grounds around the motion."""
        lines = [_outline(g, ((low + high) / 2, y), high - low + 2 * size) for g in self.grounds.values()]
        points = [point for line in lines for point in line]
        ends = list(itertools.accumulate(map(len, lines)))
        cells = [list(range(end - len(line), end)) for line, end in zip(lines, ends)]
        text = _DATA + _PIECE % (len(points), 0, len(cells))
        return f"{text}<Points>\n{_vectors('Points', points)}</Points>\n{_cells('Lines', cells)}{_TAIL}"


def _rows(folder: str, name: str, every: int = 1) -> Iterator[_Row]:
    """Numbers by column of a table of a run; none where it was not recorded."""
    path = os.path.join(folder, f"{name}.csv")
    try:
        with open(path, newline="", encoding="utf-8") as file:
            for row in itertools.islice(csv.DictReader(file), 0, None, every):
                yield {title: float(value or "nan") for title, value in row.items()}
    except FileNotFoundError:
        return
    except (ValueError, TypeError, csv.Error):
        raise Failure(f"'{path}' is not the table of a run", 4) from None


def _values(row: _Row, names: Sequence[str], *titles: str) -> Any:
    """Numbers of all things, tuples where there are several titles; [] where they were not recorded."""
    if not names or f"{names[0]}.{titles[0]}" not in row:
        return []
    if len(titles) == 1:
        return [row[f"{name}.{titles[0]}"] for name in names]
    return [[row[f"{name}.{title}"] for title in titles] for name in names]


def _motion(s: _Structure, folder: str, every: int) -> Iterator[tuple[float, dict[str, Any]]]:
    """Time and what was recorded of each frame."""
    others = (itertools.chain(_rows(folder, name, every), itertools.repeat({})) for name in ("members", "contacts"))
    for nodes, members, contacts in zip(_rows(folder, "nodes", every), *others):
        position = _values(nodes, s.nodes, "x [m]", "y [m]")
        if not position:
            raise Failure(f"'{folder}/nodes.csv' has no position of the nodes: the run recorded none", 4)
        lines = ([position[i] for i in cell] for cell in s.cells)
        yield nodes["time [s]"], {
            "position": position,
            "velocity": _values(nodes, s.nodes, "vx [m/s]", "vy [m/s]"),
            "length": _values(members, s.names, "length [m]") or [sum(map(math.dist, p, p[1:])) for p in lines],
            "force": _values(members, s.names, "force [N]"),
            "contact": _values(contacts, list(s.contacts), "normal [N]", "friction [N]"),
        }


def write(scene: Scene, folder: str, at: str | None, run: str | None) -> str:
    """Writes the frames of the run, or the shape, and returns how many there are."""
    s, still = _Structure(scene), shape(scene, at)
    still |= {"force": still["tension"], "velocity": [], "contact": []}
    count = sum(1 for _ in _rows(run, "nodes")) if run else 1
    if not count:
        raise Failure(f"'{run}' has no nodes.csv with positions: the run recorded none", 4)
    every = -(-count // _MOST_FRAMES)
    size = max(max(x) - min(x) for x in zip(*still["position"])) or 1.0
    frames: list[str] = []

    def texts() -> Iterator[tuple[str, str]]:
        first, low, high = list[Any](), math.inf, -math.inf
        for time, row in _motion(s, run, every) if run else [(0.0, still)]:
            first = first or row["position"]
            low, high = min(low, *(x for x, _ in row["position"])), max(high, *(x for x, _ in row["position"]))
            name = f"structure_{len(frames):05}.vtp"
            frames.append(f'<DataSet timestep="{number(time)}" part="0" file="{name}"/>\n')
            yield name, s.frame(time, row, first)
        ground: list[str] = []
        if s.grounds:
            yield "ground.vtp", s.outlines(low, high, first[0][1], size)
            ground = [re.sub(r'"0" file="structure_\d+', '"1" file="ground', line) for line in frames]
        head = _HEAD % ("Collection", "0.1", "", "Collection")
        yield "structure.pvd", f"{head}{''.join(frames + ground)}</Collection>\n</VTKFile>\n"

    write_folder(folder, texts(), r"structure_\d{5}\.vtp|ground\.vtp")
    chosen = f"\nevenly chosen from {count} recorded: at most {_MOST_FRAMES} are written" if every > 1 else ""
    return f"{len(frames)} frame{'s' * (len(frames) > 1)} in '{folder}': open structure.pvd with ParaView{chosen}"

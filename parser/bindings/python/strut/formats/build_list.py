# SPDX-License-Identifier: GPL-3.0-or-later
"""What it takes to build a structure: lengths to cut, holes to drill, and a drawing at true scale [mm].

A cable is cut with an allowance at both ends. The drawings show each member with the length to cut, without force,
beside a line of 100 mm to check a print by.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Sequence
from xml.sax.saxutils import escape

from .. import Scene
from . import Failure, cell, kind_of, number, shape, write_folder

_MARGIN, _HOLE = 15.0, 1.0  #: [mm]
_STROKES = ('stroke-width="0.7"', 'stroke-width="0.35" stroke-dasharray="2 1"', 'stroke-width="0.25"')
_LAYERS = ("BARS", "SPRINGS", "CABLES")
_MEMBERS = "member,kind,from,over,to,made length [m],cut length [m],length in shape [m],force in shape [N],driven"


@dataclass
class _Member:
    name: str
    words: dict[str, Any]
    made: float  #: without force [m]
    cut: float | None  #: of a cable [m]
    length: float
    force: float | None
    driven: bool

    @property
    def label(self) -> str:
        return f"{self.name}  {1000 * (self.made if self.cut is None else self.cut):.2f}"


def _members(scene: Scene, words: dict[str, Any], at: dict[str, Any], allowance: float) -> list[_Member]:
    driven = {a.get("member") for a in words.get("actuators", {}).values() if "signal" in a}
    members = []
    for i, name in enumerate(scene.names("members")):
        own, made = words["members"][name], at["rest_length"][i]
        rigid = words.get("bars") == "rigid" and own["kind"] == "bar"
        if not made > 0:
            raise Failure(f"member '{name}' cannot be made: its rest length is {made:g} m; give it a stiffness and "
                          "a pretension that leave some length")  # fmt: skip
        cut = made + 2 * allowance if own["kind"] == "cable" else None
        force = None if rigid else at["tension"][i]
        members.append(_Member(name, own, made, cut, at["length"][i], force, name in driven))
    if not members:
        raise Failure("the scene has no members to build")
    return members


class _Drawing:
    """Where things are on the sheet, x to the right and y up [mm]."""

    def __init__(self, name: str, members: Sequence[_Member], nodes: Sequence[str], position: Any) -> None:
        self.name, self.members = name, members
        self.points = {node: (1000 * x, 1000 * y) for node, (x, y) in zip(nodes, position)}
        self.letters = min(4.0, max(1.2, min(1000 * member.length for member in members) / 15))
        x, y = zip(*self.points.values())
        self.left, self.bottom = min(x) - _MARGIN, min(y) - _MARGIN - 3 * self.letters
        self.width = max(max(x) + _MARGIN - self.left, 100 + 2 * _MARGIN)
        self.height = max(y) + _MARGIN - self.bottom

    def line(self, member: _Member) -> list[tuple[float, float]]:
        return [self.points[node] for node in member.words["nodes"]]

    def middle(self, member: _Member) -> tuple[float, float, float]:
        """That of a member's first stretch, and its angle, read from below [degrees]."""
        (a, b), (c, d) = sorted(self.line(member)[:2])
        size = math.hypot(c - a, d - b)
        lift = 0.4 * self.letters / size if size > 0 else 0
        return (a + c) / 2 - lift * (d - b), (b + d) / 2 + lift * (c - a), math.degrees(math.atan2(d - b, c - a))

    def svg(self) -> str:
        size, letters = f"{self.width:.6f}mm", f'<text font-size="{self.letters:.3f}"'
        lines = ['<?xml version="1.0" encoding="UTF-8"?>', f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" height="{self.height:.6f}mm" '
                 f'viewBox="0 0 {self.width:.6f} {self.height:.6f}" font-family="sans-serif">',
                 f"<title>{escape(self.name)}, true scale; lengths in mm, without force; cables as cut</title>"]  # fmt: skip

        def at(x: float, y: float) -> tuple[float, float]:  # y runs down
            return x - self.left, self.bottom + self.height - y

        for member in self.members:
            points = " ".join("%.6f,%.6f" % at(*point) for point in self.line(member))
            x, y, angle = self.middle(member)
            turn = "translate(%.6f %.6f) rotate(%.4f)" % (*at(x, y), 0 - angle)
            lines += [f'<polyline class="{member.words["kind"]}" fill="none" stroke="black" '
                      f'{_STROKES[kind_of(member.words)]} points="{points}"><title>{escape(member.name)}</title></polyline>',
                      f'{letters} text-anchor="middle" transform="{turn}">{escape(member.label)}</text>']  # fmt: skip
        for name, point in self.points.items():
            x, y = at(*point)
            lines += [f'<circle cx="{x:.6f}" cy="{y:.6f}" r="{_HOLE}" fill="white" stroke="black" stroke-width="0.25"/>',
                      f'{letters} font-weight="bold" x="{x + 1.5 * _HOLE:.6f}" y="{y - 1.5 * _HOLE:.6f}">'
                      f"{escape(name)}</text>"]  # fmt: skip
        foot = self.height - _MARGIN / 2
        lines += [f'<line class="ruler" x1="{_MARGIN}" y1="{foot:.6f}" x2="{_MARGIN + 100}" y2="{foot:.6f}" '
                  'stroke="black" stroke-width="0.35"/>',
                  f'{letters} x="{_MARGIN}" y="{foot - 1:.6f}">this line is 100 mm</text>', "</svg>", ""]  # fmt: skip
        return "\n".join(lines)

    def dxf(self) -> str:
        pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER")]
        pairs += [(9, "$ACADVER"), (1, "AC1009"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC")]
        pairs += [(0, "SECTION"), (2, "ENTITIES")]

        def put(kind: str, layer: str, *points: tuple[float, float]) -> None:
            pairs.extend([(0, kind), (8, layer)])
            for i, (x, y) in enumerate(points):
                pairs.extend([(10 + i, f"{x:.6f}"), (20 + i, f"{y:.6f}"), (30 + i, 0)])

        def letter(layer: str, x: float, y: float, angle: float, text: str) -> None:
            put("TEXT", layer, (x, y))
            plain = "".join(c if c < "\x80" else f"\\U+{ord(c):04X}" if c < "\U00010000" else "?" for c in text)
            pairs.extend([(40, f"{self.letters:.3f}"), (50, f"{angle:.4f}"), (1, plain)])

        for member in self.members:
            line = self.line(member)
            for stretch in zip(line, line[1:]):
                put("LINE", _LAYERS[kind_of(member.words)], *stretch)
            letter("LABELS", *self.middle(member), member.label)
        for name, (x, y) in self.points.items():
            put("CIRCLE", "HOLES", (x, y))
            pairs.append((40, f"{_HOLE:.3f}"))
            letter("LABELS", x + 1.5 * _HOLE, y + 1.5 * _HOLE, 0, name)
        foot, begin = self.bottom + _MARGIN / 2, self.left + _MARGIN
        put("LINE", "RULER", (begin, foot), (begin + 100, foot))
        letter("RULER", begin, foot + 1, 0, "this line is 100 mm")
        return "".join(f"{code}\n{value}\n" for code, value in [*pairs, (0, "ENDSEC"), (0, "EOF")])


def write(scene: Scene, folder: str, at: str | None, allowance: float) -> str:
    """Returns the list as a table for people."""
    if allowance < 0:
        raise Failure("--allowance expects a length of 0 or more", 1)
    found, words, nodes = shape(scene, at), scene.to_dict(), scene.names("nodes")
    members = _members(scene, words, found, allowance)
    drawing = _Drawing(scene["name"] or "structure", members, nodes, found["position"])
    rows = [_MEMBERS]
    for m in members:
        first, *over, last = map(cell, m.words["nodes"])
        numbers = ("" if v is None else number(v) for v in (m.made, m.cut, m.length, m.force))
        driven = "yes" if m.driven else "no"
        rows.append(",".join([cell(m.name), m.words["kind"], first, ";".join(over), last, *numbers, driven]))
    passed = [(node, kind_of(m.words)) for m in members for node in m.words["nodes"]]
    points = ["node,x [m],y [m],fixed,holes,bars,springs,cables"]
    wide = max(6, *(len(m.name) for m in members if len(m.name) < 30))
    table = [f"  {'member':{wide}}  kind    {'made':>10}  {'cut':>10}  {'in shape':>10}"]
    for m in members:
        lengths = "".join(f"  {'' if v is None else f'{1000 * v:.2f} mm':>10}" for v in (m.made, m.cut, m.length))
        table.append(f"  {m.name:{wide}}  {m.words['kind']:6}{lengths}{'  driven' if m.driven else ''}")
    table += ["", "  node    holes"]
    for node, (x, y) in zip(nodes, found["position"]):
        own = words["nodes"][node]
        held = own.get("fixed", "no") if isinstance(own, dict) else "no"
        count = [passed.count((node, kind)) for kind in range(3)]
        points.append(",".join([cell(node), number(x), number(y), held, str(sum(count)), *map(str, count)]))
        table.append(f"  {node:6}  {sum(count):5}")
    others = [f"{len(words[kind])} {kind}" for kind in ("hinges", "cells", "collisions", "distances", "sliders") if kind in words]
    table += ["", "  not in this list: " + ", ".join(others)] if others else []
    files = {"members.csv": rows, "nodes.csv": points}
    texts = [(name, "\n".join([*lines, ""])) for name, lines in files.items()]
    write_folder(folder, [*texts, ("drawing.svg", drawing.svg()), ("drawing.dxf", drawing.dxf())])
    return "\n".join([*table, ""])

# SPDX-License-Identifier: GPL-3.0-or-later
"""springable: sections of comma-separated lines, with expressions of parameters. Without units: SI."""

from __future__ import annotations

import math
import re
from typing import Sequence

from . import number
from ._draft import HELD, Draft, Source, Wrong, collected
from ._springable_laws import Line, Skip, split

TITLE = "CSV of springable"
#: sections of distances: direction, whether from the middle of two nodes, whether the node comes first
_DISTANCES = {"X DISTANCE": "x", "Y DISTANCE": "y", "POINT2MID X DISTANCE": "x", "POINT2MID Y DISTANCE": "y"}
_DISTANCES |= {"MID2POINT X DISTANCE": "x", "MID2POINT Y DISTANCE": "y", "DISTANCE": ""}
_SPRINGS = ("", "LONGITUDINAL", "ANGULAR", "PATH", "AREA", *_DISTANCES)


class _Reader(Line):
    """A file, line by line."""

    def __init__(self, draft: Draft, source: Source) -> None:
        super().__init__(source)
        self.draft, self.section = draft, ""
        self.counts: dict[str, int] = {}
        self.stage: list[str] = []  #: names of its loads
        self.stages: list[str] = []
        self.staged = self.blocking = False
        self.hold: list[str] = []
        self.stop = ""

    def read(self, number: int, line: str) -> None:
        self.line, self.fields = number, split(line, ",")
        first = self.text(0)
        if line.isspace() or not line or first.startswith("#"):
            return
        begins = re.fullmatch(r"(PARAMETERS|NODES|LOADING)|(.*?) ?(SPRINGS|FLEXELS)", first)
        if begins and len(self.fields) == 1:
            self.section = begins[1] or (begins[2] if begins[2] in _SPRINGS else "OTHERS")
            self.section = self.section or "LONGITUDINAL"
            return
        try:
            self.element()
        except Skip as skipped:
            self.note(skipped.args[1], f"not imported: {skipped.args[0]}")

    def element(self) -> None:
        read = {"PARAMETERS": self.parameter, "NODES": self.node, "LOADING": self.load, "AREA": self.area}
        read |= {"LONGITUDINAL": self.spring, "PATH": self.spring, "ANGULAR": self.angle}
        read |= dict.fromkeys(_DISTANCES, self.distance)
        if not self.section:
            self.error(0, "expected a section such as PARAMETERS or NODES")
        if self.section not in read:
            raise Skip("an element of a kind that is not known", 0)
        read[self.section]()

    def add(self, section: str, name: str, text: str, nodes: Sequence[str] = ()) -> str:
        """Adds an element with the next of its names, whose nodes are used."""
        self.counts[name] = self.counts.get(name, 0) + 1
        name += str(self.counts[name])
        for node in nodes:
            self.draft.use(node)
        self.draft.add(section, name, f"{{{text}}}", self.source, self.place(0))
        return name

    def parameter(self) -> None:
        name = self.text(0)
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) or len(self.fields) < 2:
            self.error(0, "expected a parameter: NAME, VALUE")
        if name in self.own:
            self.error(0, f"parameter '{name:.60}' is given twice")
        if self.text(1).startswith("'"):
            raise Skip("a parameter that is a text", 1)
        value = self.expression(1)[1]
        if self.text(2):
            self.note(2, "not imported: a range; give it as an axis of a study")
        own = self.own[name] = f"{name}_value" if name in self.taken else name
        self.values[own] = value
        self.draft.add("parameters", own, number(value), self.source, self.place(0))

    def node(self) -> None:
        if len(self.fields) != 5 or not re.fullmatch(r"\d{1,9}", self.text(0), re.ASCII):
            self.error(0, "expected a node: NUMBER, X, Y, 0 or 1, 0 or 1")
        index = int(self.text(0))
        if index in self.points:
            self.error(0, f"node {index} is given twice")
        for i in (3, 4):
            if self.text(i) not in ("0", "1"):
                self.error(i, f"expected 0 or 1, found '{self.text(i):.60}'")
        (x, first), (y, second) = self.expression(1), self.expression(2)
        held = int(self.text(3)) + 2 * int(self.text(4))
        self.points[index] = first, second, held == 3
        self.draft.node(f"n{index}", x, y, HELD[held], self.source, self.place(0))

    def chain(self, least: int, most: int) -> list[str]:
        """The nodes "0-2-1" as n0, n2, n1."""
        parts = self.text(0).split("-")
        if not least <= len(parts) <= most or not all(re.fullmatch(r"\d{1,9}", part, re.ASCII) for part in parts):
            more = " or more" if most > least else ""
            self.error(0, f"expected {least}{more} numbers of nodes with dashes between")
        for part in parts:
            if int(part) not in self.points:
                self.error(0, f"there is no node {int(part)}")
        return [f"n{int(part)}" for part in parts]

    def rest(self, key: str) -> str:
        """The natural length, distance or area in the third field."""
        return f", {key}: {self.expression(2)[0]}" if self.text(2) else ""

    def spring(self) -> None:
        path = self.section == "PATH"
        nodes = self.chain(2, 32 if path else 2)
        rest, stiffness = self.rest("rest_length"), self.stiffness()
        text = f"kind: spring, nodes: NODES, stiffness: {stiffness}{rest}"
        if stiffness is None:
            pieces = self.two_pieces(len(nodes) > 2, rest)
            text = pieces or f"kind: spring, nodes: NODES{rest}{self.curve()}"
        self.add("members", "path" if path else "s", text.replace("NODES", f"[{', '.join(nodes)}]"), nodes)

    def angle(self) -> None:
        nodes, rest = self.chain(3, 3), ""
        if self.text(2):
            text, angle = self.expression(2)
            within = number(angle - 2 * math.pi) if angle > math.pi else text  # half a turn
            rest = f", rest_angle: {within}"
        self.add("hinges", "a", f"nodes: [{', '.join(nodes)}]{self.law(rest)}", nodes)

    def area(self) -> None:
        nodes = self.chain(3, 32)
        x, y, _ = zip(*(self.points[int(node[1:])] for node in nodes))
        u, v = [a - x[0] for a in x], [b - y[0] for b in y]
        drawn = abs(sum(a * d - c * b for a, b, c, d in zip(u, v, u[1:], v[1:]))) / 2
        law = self.gas(drawn) or self.law(self.rest("rest_area"))
        self.add("cells", "area", f"nodes: [{', '.join(nodes)}]{law}", nodes)

    def middle(self, ends: Sequence[str]) -> str:
        """A fixed node in the middle of two fixed nodes."""
        (x, y, held), (u, v, also) = (self.points[int(end[1:])] for end in ends)
        if not (held and also):
            raise Skip("a distance from the middle of nodes that move", 0)
        self.counts["m"] = self.counts.get("m", 0) + 1
        name = f"m{self.counts['m']}"
        self.draft.node(name, number((x + u) / 2), number((y + v) / 2), HELD[3], self.source, self.place(0))
        return name

    def distance(self) -> None:
        axis, of_middle = _DISTANCES[self.section], "MID" in self.section
        count = 3 if of_middle or not axis else 2
        nodes, rest = self.chain(count, count), self.rest("rest_distance")
        law = self.contact() or self.law(rest)
        if not axis:
            self.add("distances", "d", f"node: {nodes[0]}, line: [{nodes[1]}, {nodes[2]}]{law}", nodes)
            return
        used = [self.middle(nodes[1:]) if of_middle else nodes[1], nodes[0]]
        pair = used[::-1] if self.section.startswith("MID") else used
        self.add("distances", "d", f"nodes: [{', '.join(pair)}], along: {axis}{law}", used)

    def end_stage(self) -> None:
        """The first stage is written only if it must be."""
        if self.stage and (self.staged or self.stop):
            loads = self.stage[0] if len(self.stage) == 1 else f"[{', '.join(self.stage)}]"
            hold = f", hold: [{', '.join(self.hold)}]" if self.hold else ""
            self.stages.append(f"    - {{load: {loads}{hold}{self.stop}}}")
        self.stage, self.hold, self.stop, self.blocking = [], [], "", False

    def load(self) -> None:
        first, axis = self.text(0), self.text(1)
        if len(self.fields) == 1 and first in ("then", "block"):
            self.staged = self.staged or first == "then"
            if first == "then":
                self.end_stage()
            self.blocking = first == "block"
            return
        known = re.fullmatch(r"\d{1,9}", first, re.ASCII) and int(first) in self.points and axis in ("X", "Y")
        if not known or len(self.fields) < (2 if self.blocking else 3):
            self.error(0, "expected a load: NODE, X or Y, FORCE")
        node = f"n{int(first)}"
        if len(self.fields) == 2:
            self.hold.append(f"{node}.{axis.lower()}")
            return
        if self.text(3):
            self.stop = f", stop: {{{node}.{axis.lower()}: {number(self.expression(3)[1])}}}"
        force = self.expression(2)[0]
        pair = f"{force}, 0" if axis == "X" else f"0, {force}"
        self.stage.append(self.add("loads", "load", f"node: {node}, force: [{pair}]", [node]))


def read(draft: Draft, sources: Sequence[Source]) -> None:
    source = sources[0]
    if draft.unit != 1:
        raise Wrong(source, (1, 1), "expressions of springable are taken in metres: --unit is for the other formats")
    reader = _Reader(draft, source)
    for i, line in enumerate(source.text.split("\n"), 1):
        with collected():
            reader.read(i, line.rstrip("\r"))
    reader.end_stage()
    for line in ["  stages:", *reader.stages] if reader.stages else ():
        draft.lines["path"].append((line, source, (1, 1)))
    if not reader.points and not source.wrong:
        raise Wrong(source, (1, 1), "the file has no section NODES")

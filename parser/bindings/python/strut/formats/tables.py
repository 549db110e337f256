# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of nodes and one of members (CSV), with units in their headers as strut's own tables have them."""

from __future__ import annotations

import re
from typing import Sequence

from ._draft import Draft, Place, Source, Wrong, collected, is_number

TITLE = "tables of nodes and members"
_CELL = re.compile(r'(?:^|,)(?:"((?:[^"]|"")*)"|([^,"]*))(?=,|$)')
#: columns that are numbers by title, and the keys of the language; "" are read otherwise
_NODES = {"node": "", "x": "", "y": "", "fixed": "", "mass": "mass"}
_MEMBERS = {"member": "", "kind": "", "from": "", "over": "", "to": ""}
_MEMBERS |= {name: name.replace(" ", "_") for name in ("stiffness", "axial stiffness", "damping", "mass")}
_MEMBERS |= {name: name.replace(" ", "_") for name in ("rest length", "rest length ratio", "pretension")}
_MEMBERS |= {"force density": "force_density", "made length": "rest_length"}  # that of a build list
_LENGTHS = ("x", "y", "rest length", "made length")


class _Row:
    """Cells by title, with their units and places."""

    def __init__(self, source: Source, titles: list[tuple[str, str]], cells: list[tuple[str, Place]]) -> None:
        self.source, self.units = source, dict(titles)
        self.cells = {title: cell for (title, _), cell in zip(titles, cells)}

    def text(self, title: str) -> str:
        return self.cells.get(title, ("", (1, 1)))[0]

    def error(self, title: str, text: str) -> None:
        raise Wrong(self.source, self.cells[title][1], text)

    def value(self, draft: Draft, title: str) -> str:
        """A number with its column's unit, "" where there is none."""
        text, unit = self.text(title), self.units.get(title, "")
        unit = "" if unit == "1" else unit
        if text and not is_number(text):
            self.error(title, f"expected a number for '{title}', found '{text:.40}'")
        if text and not unit and title in _LENGTHS:
            return draft.length(float(text))
        return f"{text.removeprefix('+')} {unit}".strip() if text else ""

    def values(self, draft: Draft, keys: dict[str, str]) -> str:
        given = ((key, self.value(draft, title)) for title, key in keys.items() if key and title in self.cells)
        return "".join(f", {key}: {value}" for key, value in given if value)


def _cells(line: str, number: int) -> list[tuple[str, Place]]:
    found = [(m, m.start() + m[0].startswith(",")) for m in _CELL.finditer(line)]
    return [((m[1] or "").replace('""', '"') if m[2] is None else m[2].strip(), (number, at + 1)) for m, at in found]


def _rows(source: Source, keys: dict[str, str], of: str) -> list[_Row]:
    lines = [line.rstrip("\r") for line in source.text.removeprefix("\ufeff").split("\n")]
    head = _cells(lines[0], 1)
    parts = [re.fullmatch(r"(.*?)(?: ?\[(.*)\])?", cell, re.DOTALL) for cell, _ in head]
    titles = [(m[1].replace("_", " "), m[2] or "") for m in parts if m]
    for needed in ("node", "x", "y") if of == "nodes" else ("member", "kind", "from", "to"):
        if needed not in dict(titles):
            raise Wrong(source, (1, 1), f"the table of {of} has no column '{needed}'")
    for (title, _), (_, place) in zip(titles, head):
        if title not in keys:
            source.note(place, f"not imported: the column '{title:.60}'")
    rows = []
    for i, line in enumerate(lines[1:], 2):
        cells = _cells(line, i)
        if line and len(cells) != len(titles):
            raise Wrong(source, (i, 1), f"expected {len(titles)} cells as in the header, found {len(cells)}")
        rows += [_Row(source, titles, cells)] if line else []
    return rows


def _node(draft: Draft, row: _Row) -> None:
    held = row.text("fixed").replace("no", "")
    if not row.text("node"):
        row.error("node", "a node has no name")
    if held not in ("", "x", "y", "both"):
        row.error("fixed", f"expected no, x, y or both for 'fixed', found '{held:.40}'")
    for axis in "xy":
        if not row.value(draft, axis):
            row.error(axis, "a coordinate is missing")
    more = row.values(draft, _NODES) + (held and f", fixed: {held}")
    draft.node(row.text("node"), row.value(draft, "x"), row.value(draft, "y"), more, row.source, row.cells["node"][1])


def _member(draft: Draft, row: _Row) -> None:
    if row.text("kind") not in ("bar", "spring", "cable"):
        row.error("kind", f"expected bar, spring or cable for 'kind', found '{row.text('kind'):.40}'")
    nodes: list[str] = []
    for title in ("from", "over", "to"):
        names = row.text(title).split(";") if row.text(title) else []
        if not names and title != "over":
            row.error(title, "a member lacks one of its nodes")
        for name in names:
            if not draft.has_node(name):
                row.error(title, f"there is no node '{name:.60}'")
        nodes += map(draft.use, names)
    text = f"{{kind: {row.text('kind')}, nodes: [{', '.join(nodes)}]{row.values(draft, _MEMBERS)}}}"
    draft.add("members", row.text("member"), text, row.source, row.cells["member"][1])


def read(draft: Draft, sources: Sequence[Source]) -> None:
    nodes, members = sources
    if "member" in (title for title, _ in _cells(nodes.text.split("\n")[0].strip(), 1)):
        nodes, members = members, nodes
    for row in _rows(nodes, _NODES, "nodes"):
        with collected():
            _node(draft, row)
    for row in _rows(members, _MEMBERS, "members"):
        with collected():
            _member(draft, row)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices as Matrix Market files, with CSV files of what their rows and columns are called."""

from __future__ import annotations

from typing import Any, Iterator

from .. import Scene
from . import cell, number, write_folder

_TITLES = {
    "connectivity": "integer general\n% connectivity: -1 at a member's first node, 1 at its second",
    "equilibrium": "real general\n% equilibrium matrix: member forces to the loads that they hold, 1",
    "mass": "real symmetric\n% mass, kg",
    "stiffness_elastic": "real symmetric\n% elastic stiffness, N/m",
    "stiffness_geometric": "real symmetric\n% geometric stiffness, N/m",
    "stiffness_contact": "real symmetric\n% stiffness of the ground, N/m",
    "damping": "real symmetric\n% damping, N s/m",
}


def _columns(scene: Scene) -> str:
    """Members, hinges and cells; `over` are the nodes in between where there are any."""
    words = scene.to_dict()
    rows, inner = [], "hinges" in words or "cells" in words
    for kind in ("members", "hinges", "cells"):
        for name in scene.names(kind):
            thing = words[kind][name]
            first, *between, last = thing["nodes"]
            inner = inner or bool(between)
            rows.append([cell(name), thing.get("kind", kind[:-1]), cell(first), cell(last), " ".join(between)])
    lines = [",".join([str(i), *row][: 6 if inner else 5]) for i, row in enumerate(rows, 1)]
    return "\n".join([f"column,member,kind,from,to{',over' if inner else ''}", *lines, ""])


def write(scene: Scene, folder: str, at: str | None) -> None:
    matrices = scene.matrices(at=at)
    raw: Any = matrices._raw

    def values(name: str) -> Any:
        return raw.array(name).tolist()

    def texts() -> Iterator[tuple[str, str]]:
        nodes = scene.names("nodes")
        places = zip(nodes, values("position"))
        lines = [f"{i},{cell(name)},{number(x)},{number(y)}" for i, (name, (x, y)) in enumerate(places, 1)]
        yield "node_names.csv", "\n".join(["row,node,x,y", *lines, ""])
        rows = enumerate(map(int, values("coordinates")), 1)
        lines = [f"{i},{cell(nodes[row // 2])},{'xy'[row % 2]}" for i, row in rows]
        yield "rows.csv", "\n".join(["row,node,coordinate", *lines, ""])
        yield "columns.csv", _columns(scene)
        for name, title in _TITLES.items():
            if raw.array(f"{name}.value") is None:
                continue
            entries = zip(*(values(f"{name}.{part}") for part in ("row", "column", "value")))
            lower = "symmetric" in title
            lines = [f"{int(i) + 1} {int(j) + 1} {number(v)}" for i, j, v in entries if i >= j or not lower]
            size = " ".join(str(int(n)) for n in values(f"{name}.size"))
            head = f"%%MatrixMarket matrix coordinate {title}; at: {at or 'drawn'}"
            yield f"{name}.mtx", "\n".join([head, f"{size} {len(lines)}", *lines, ""])

    write_folder(folder, texts(), r"stiffness_contact\.mtx")

# SPDX-License-Identifier: GPL-3.0-or-later
"""TensegritySim: nodes, connections by builder, pins. Without units: metres and newtons."""

from __future__ import annotations

from typing import Sequence

from . import number
from ._draft import HELD, Draft, Source, Tree, collected, own_name

TITLE = "YAML of TensegritySim"
_KEYS = ("nodes", "builders", "connections", "pin")


def read(draft: Draft, sources: Sequence[Source]) -> None:
    root = Tree.read(sources[0])
    for key, _ in root.mapping("with nodes and connections"):
        with collected():
            if key.word == "surface":
                key.error("a structure on a cylinder is not planar")
            elif key.word == "control":
                key.note("not imported: which strings are controlled; 'actuators' drive rest lengths")
            elif key.word not in _KEYS:
                key.error(f"expected {', '.join(_KEYS)}, control or surface, found '{key.word:.60}'")
    nodes, builders, connections = (
        root.get(name) or root.error(f"expected the key '{name}' with a mapping") for name in _KEYS[:3]
    )
    _nodes(draft, nodes, root.get("pin"))
    for key, value in connections.mapping("for 'connections'"):
        with collected():
            bar = _builder(draft, key, builders.get(key.word))
            unnamed = 0
            for item in value.listing(f"a list of connections for '{key.word:.60}'"):
                if item.pairs is None:
                    unnamed += 1
                    _connection(draft, nodes, key.word, f"{key.word}-{unnamed}", item, bar)
                for name, ends in item.pairs or ():
                    _connection(draft, nodes, key.word, name.word, ends, bar)


def _nodes(draft: Draft, nodes: Tree, pins: Tree | None) -> None:
    for key, value in nodes.mapping("for 'nodes'"):
        with collected():
            x, y, *z = value.point(f"two or three coordinates for node '{key.word:.60}'", 2, 3)
            if any(z):
                value.error(f"node '{key.word:.60}' is not in the plane z = 0")
            pin = pins and pins.get(key.word)
            held = pin.listing("a list such as [True, True, False]", 2)[:2] if pin else []
            on = sum(i for i, item in enumerate(held, 1) if item.word in ("True", "true", "yes", "1"))
            draft.node(key.word, draft.length(x), draft.length(y), HELD[on], key.source, key.place)
    for key, _ in pins.mapping("for 'pin'") if pins else ():
        with collected():
            if not nodes.get(key.word):
                key.error(f"there is no node '{key.word:.60}' to pin")


def _builder(draft: Draft, key: Tree, builder: Tree | None) -> bool:
    """Writes a group; whether it is of bars."""
    if not builder or builder.pairs is None:
        key.error(f"'{key.word:.60}' has no builder")
    kind, given, ratio = map(builder.get, ("type", "stiffness", "initial_length_ratio"))
    if not kind or kind.word not in ("bar", "string"):
        (kind or builder).error(f"expected 'type: bar' or 'type: string' of builder '{key.word:.60}'")
    stiffness = (given or builder.error(f"builder '{key.word:.60}' lacks 'stiffness'")).number("the stiffness")
    for name, value in builder.pairs:
        if value not in (kind, given, ratio):
            name.note(f"not imported: '{name.word:.60}' of a builder")
    text = f"{{kind: {'bar' if kind.word == 'bar' else 'cable'}, stiffness: {number(stiffness)} N/m, "
    text += f"rest_length_ratio: {number(ratio.number('the ratio') if ratio else 1)}}}"
    draft.add("groups", key.word, text, key.source, key.place)
    return kind.word == "bar"


def _connection(draft: Draft, nodes: Tree, group: str, name: str, ends: Tree, bar: bool) -> None:
    with collected():
        items = ends.listing("a list of two or more nodes", 2, 2 if bar else 32)
        for end in items:
            if not nodes.get(end.word):
                end.error(f"there is no node '{end.word:.60}'")
        used = ", ".join(draft.use(end.word) for end in items)
        draft.add("members", name, f"{{group: {own_name(group)}, nodes: [{used}]}}", ends.source, ends.place)

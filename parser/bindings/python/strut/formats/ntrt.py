# SPDX-License-Identifier: GPL-3.0-or-later
"""NTRT: nodes, pairs by tag, builders by tag, structures in structures. Lengths are decimetres; y is up."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Sequence

from . import number
from ._draft import Draft, Source, Tree, collected

TITLE = "YAML of NASA's Tensegrity Robotics Toolkit"
_KEYS = ("nodes", "pair_groups", "builders", "substructures", "bond_groups")
_ATTRIBUTES = ("path", "rotation", "translation", "scale", "offset")
_CLASSES = dict.fromkeys(("tgBasicActuatorInfo", "tgBasicContactCableInfo"), "string")
_CLASSES |= dict.fromkeys(("tgKinematicActuatorInfo", "tgKinematicContactCableInfo"), "string") | {"tgRodInfo": "rod"}
_DEFAULTS = {"rod": {"radius": 0.5, "density": 1.0}, "string": {"stiffness": 1000.0, "damping": 10.0, "pretension": 0.0}}
_MOST_DEPTH, _MOST_STRUCTURES, _MOST_NODES = 16, 10000, 20000
_HEAD = """bars: rigid  # as NTRT's rods; their stiffness is for statics
# Gravity, ground and control are not in NTRT's file."""


@dataclass(eq=False)
class _Node:
    name: str  #: behind those of the structures around it: outer.inner.node
    p: list[float]
    key: Tree


@dataclass
class _Pairs:
    base: str  #: of the members' names
    tags: str
    key: Tree
    ends: list[tuple[_Node, _Node]]


def _point(tree: Tree) -> list[float]:
    return tree.point("three coordinates [x, y, z]", 3, 3)


@dataclass
class _Structure:
    source: Source
    prefix: str = ""
    depth: int = 0
    nodes: list[_Node] = field(default_factory=list)  #: those of structures in it first

    def find(self, item: Tree) -> _Node:
        """The node of that name: its own, or the only one of structures in it."""
        name = item.text or ""
        found = [node for node in self.nodes if node.name == self.prefix + name]
        found = found or [node for node in self.nodes if name and node.name.endswith("." + name)]
        if len(found) > 1:
            which = f"write of which structure it is, STRUCTURE.{name:.60}"
            item.error(f"{len(found)} nodes are called '{name:.60}': {which}")
        return found[0] if found else item.error(f"there is no node '{name:.60}'")

    def part(self, name: str, key: Tree) -> _Structure:
        prefix = f"{self.prefix}{name}."
        nodes = [node for node in self.nodes if node.name.startswith(prefix)]
        if not nodes:
            key.error(f"there is no structure '{name:.60}' with nodes")
        return _Structure(self.source, prefix, self.depth, nodes)

    def place(self, attributes: Tree, index: int) -> None:
        """The index-th of a key: rotated, scaled, moved on by the offset, moved."""
        rotation, scale, offset, translation = map(attributes.get, ("rotation", "scale", "offset", "translation"))
        if rotation:
            self.rotate(rotation)
        factor = scale.number("a scale") if scale else 1.0
        centre = self.centre()
        shift = [index * a for a in _point(offset)] if offset else [0.0] * 3
        shift = [a + b for a, b in zip(shift, _point(translation))] if translation else shift
        for node in self.nodes if scale or offset or translation else ():
            node.p = [c + factor * (a - c) + b for a, b, c in zip(node.p, shift, centre)]

    def centre(self) -> list[float]:
        return [sum(node.p[c] for node in self.nodes) / max(1, len(self.nodes)) for c in range(3)]

    def rotate(self, rotation: Tree) -> None:
        """About the middle without a reference."""
        axis, angle, reference = map(rotation.get, ("axis", "angle", "reference"))
        if not axis or not angle:
            rotation.error("expected a rotation with 'axis' and 'angle'")
        way, turn = _point(axis), math.radians(angle.number("an angle"))
        centre, size = _point(reference) if reference else self.centre(), math.hypot(*way)
        if not size > 0:
            axis.error("the axis of a rotation has no direction")
        x, y, z = (a / size for a in way)
        for node in self.nodes:
            a, b, c = (p - q for p, q in zip(node.p, centre))
            across = (y * c - z * b, z * a - x * c, x * b - y * a)
            along = (x * a + y * b + z * c) * (1 - math.cos(turn))
            terms = zip(centre, (a, b, c), across, (x, y, z))
            node.p = [q + v * math.cos(turn) + w * math.sin(turn) + u * along for q, v, w, u in terms]


class _Reader:
    def __init__(self, sources: Sequence[Source]) -> None:
        self.sources, self.trees = sources, dict[str, Tree]()
        self.pairs: list[_Pairs] = []
        self.builders: dict[str, Tree] = {}  #: those of outer structures replace those of inner ones
        self.structures = 0
        self.whole = _Structure(sources[0])
        self.read(self.whole)

    def read(self, s: _Structure) -> None:
        root = self.trees[s.source.name] = self.trees.get(s.source.name) or Tree.read(s.source)
        parts: dict[str, list[tuple[Tree, Tree]]] = {name: [] for name in _KEYS}
        for key, value in root.mapping("with nodes and pair_groups"):
            with collected():
                if key.word not in parts:
                    key.error(f"expected {', '.join(_KEYS)}, found '{key.word:.60}'")
                parts[key.word] = value.mapping(f"for '{key.word}'")
        for key, value in parts["substructures"]:
            with collected():
                self.read_parts(s, key, value)
        self.builders |= {key.word: value for key, value in parts["builders"]}
        for key, value in parts["nodes"]:
            with collected():
                s.nodes.append(_Node(s.prefix + key.word, _point(value), key))
        if len(s.nodes) > _MOST_NODES:
            root.error(f"these are more than {_MOST_NODES} nodes")
        for key, value in parts["pair_groups"]:
            with collected():
                self.read_pairs(s, s, key, value, s.prefix + key.word, key.word)
        for outer, bonds in parts["bond_groups"]:
            with collected():
                for inner, value in bonds.mapping(f"of bonds or tags in '{outer.word:.60}'"):
                    with collected():
                        bond, tags = (outer, inner) if "/" in outer.word else (inner, outer)
                        self.read_bonds(s, bond, tags.word, value)
        if not parts["nodes"] and not parts["substructures"]:
            root.error("expected mappings 'nodes' and 'pair_groups'")

    def read_pairs(self, a: _Structure, b: _Structure, key: Tree, value: Tree, base: str, tags: str) -> None:
        pairs = _Pairs(base, tags, key, [])
        self.pairs.append(pairs)
        for item in value.listing(f"a list of pairs for '{tags:.60}'"):
            with collected():
                first, second = item.listing("a pair of nodes [a, b]", 2, 2)
                pairs.ends.append((a.find(first), b.find(second)))

    def read_bonds(self, s: _Structure, bond: Tree, tags: str, value: Tree) -> None:
        """ "a/b/c/node_node": pairs between neighbours."""
        *names, kind = bond.word.split("/")
        if kind == "node_edge":
            bond.error("'node_edge' is not read: it places structures in space by itself; use node_node")
        if kind != "node_node" or len(names) < 2 or "/" in tags:
            bond.error("expected a bond between structures, a/b/node_node, in tags, or tags in such a bond")
        for a, b in zip(names, names[1:]):
            base = f"{s.prefix}{a}_{b}_{tags}"
            self.read_pairs(s.part(a, bond), s.part(b, bond), bond, value, base, f"{tags} {a} {b}")

    def read_parts(self, s: _Structure, key: Tree, value: Tree) -> None:
        for name, _ in value.mapping(f"with the path of '{key.word:.60}'"):
            if name.word not in _ATTRIBUTES:
                name.error(f"expected path, rotation, translation, scale or offset, found '{name.word:.60}'")
        path = value.get("path") or key.error(f"'{key.word:.60}' has no path")
        tail = re.sub(r"^(\.\.?/)+", "", path.word)
        found = [source for source in self.sources if tail and f"/{source.name}".endswith(f"/{tail}")]
        if len(found) != 1:
            path.error(f"{len(found)} of the files are called '{tail:.200}'; name those of structures behind the first")
        for index, part in enumerate(filter(None, key.word.split("/"))):
            child = _Structure(found[0], f"{s.prefix}{part}.", s.depth + 1)
            self.structures += 1
            if child.depth > _MOST_DEPTH or self.structures > _MOST_STRUCTURES:
                key.error(f"more than {_MOST_STRUCTURES} structures, or more than {_MOST_DEPTH} deep in each other")
            self.read(child)
            child.place(value, index)
            s.nodes += child.nodes


def _has(words: str, some: str) -> bool:
    return all(word in words.split(" ") for word in some.split())


def _builder(pairs: _Pairs, builder: Tree | None) -> tuple[str, dict[str, float]]:
    """ "rod" or "string", and its parameters; "": a scene has no word for it, which is noted."""
    if not builder:
        kind = next((kind for kind in _DEFAULTS if _has(pairs.tags, kind)), "")
        if not kind:
            pairs.key.note(f"not imported: '{pairs.tags:.60}' has no builder")
        return kind, _DEFAULTS.get(kind, {})
    name = builder.get("class") or builder.error("expected a builder with a 'class'")
    kind = _CLASSES.get(name.word, "")
    if not kind:
        name.note(f"not imported: pairs of the class '{name.word:.60}'")
    given, known = builder.get("parameters"), dict(_DEFAULTS.get(kind, {}))
    for key, value in given.pairs or () if given and kind else ():
        if key.word in known:
            known[key.word] = value.number(key.word)
        else:
            key.note(f"not imported: '{key.word:.60}'")
    return kind, known


def _plane(nodes: Sequence[_Node]) -> tuple[int, float]:
    """The coordinate that is x, 0 or 2, and lengths that are rounding."""
    first = nodes[0].p
    faint = 1e-12 * max(abs(a - b) for node in nodes for a, b in zip(node.p, first))
    off = [[node for node in nodes if abs(node.p[c] - first[c]) > faint] for c in (0, 2)]
    if off[0] and off[1]:
        text = "is not in one plane with those before it: strut is planar, and all nodes must have the same z or x"
        off[1][0].key.error(f"node '{off[1][0].name:.60}' {text}")
    return (2 if off[1] else 0), faint


def read(draft: Draft, sources: Sequence[Source]) -> None:
    reader = _Reader(sources)
    nodes = reader.whole.nodes
    if any(source.wrong for source in sources) or not nodes:
        return
    across, faint = _plane(nodes)
    for node in nodes:
        x, y = (draft.length(0 if abs(node.p[c]) <= faint else node.p[c]) for c in (across, 1))
        with collected():
            draft.node(node.name, x, y, "", node.key.source, node.key.place)
    for pairs in reader.pairs:
        with collected():
            builder = next((value for tags, value in reader.builders.items() if _has(pairs.tags, tags)), None)
            kind, given = _builder(pairs, builder)
            for i, (a, b) in enumerate(pairs.ends if kind else (), 1):
                ends = f"nodes: [{draft.use(a.name)}, {draft.use(b.name)}]"
                if kind == "rod":
                    draft.head = [_HEAD]
                    size = math.hypot(a.p[across] - b.p[across], a.p[1] - b.p[1])
                    mass = number(given["density"] * math.pi * given["radius"] ** 2 * size)
                    text = f"{{kind: bar, {ends}, stiffness: 1e6 N/m, mass: {mass} kg}}"
                else:  # stiffness and damping have no length in their units; forces and densities have
                    stiffness, damping = number(given["stiffness"]), number(given["damping"])
                    text = f"{{kind: cable, {ends}, stiffness: {stiffness} N/m, damping: {damping} N s/m, "
                    text += f"pretension: {draft.length(given['pretension'])} N}}"
                draft.add("members", f"{pairs.base}-{i}", text, pairs.key.source, pairs.key.place)

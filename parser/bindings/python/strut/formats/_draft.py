# SPDX-License-Identifier: GPL-3.0-or-later
"""What the importers share: files with places, YAML trees, and the scene that is being made."""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
from typing import Any, Iterator, NoReturn, Sequence

from .. import SceneError, _strut, loads
from . import Failure, number

Place = tuple[int, int]  #: line and column, from 1

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_SECTIONS = "parameters groups nodes members hinges cells distances loads path".split()
HELD = ("", ", fixed: x", ", fixed: y", ", fixed: both")  #: behind a node's position: 1 for x, 2 for y
_YAML_WORDS = {"y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf"}


class Wrong(Exception):
    """A mistake in a file, at a place."""

    def __init__(self, source: Source, place: Place, text: str) -> None:
        super().__init__(text)
        self.source, self.place = source, place


@contextlib.contextmanager
def collected() -> Iterator[None]:
    """Lists a mistake in its file; those behind it are found, too."""
    try:
        yield
    except Wrong as wrong:
        wrong.source.said.append((wrong.place, "error", str(wrong)))


class Source:
    """A file to import, and what is said about it."""

    def __init__(self, name: str, data: bytes) -> None:
        self.name, self.said = name, list[tuple[Place, str, str]]()
        self.text = data.decode(errors="replace")
        bad = re.search("[\0\ufffd]", self.text)
        if bad:
            before = self.text[: bad.start()]
            place = before.count("\n") + 1, len(before) - before.rfind("\n")
            self.said.append((place, "error", "a character that is not UTF-8, or NUL"))

    def note(self, place: Place, text: str) -> None:
        self.said.append((place, "note", text))

    @property
    def wrong(self) -> bool:
        return any(kind == "error" for _, kind, _ in self.said)

    def report(self) -> str:
        """All errors and notes, in the order of the file."""
        said = sorted(dict.fromkeys(self.said), key=lambda each: each[0])[:200]
        return "".join(f"{self.name}:{at[0]}:{at[1]}: {kind}: {text}\n" for at, kind, text in said)


def is_number(text: str) -> bool:
    return bool(_NUMBER.fullmatch(text)) and math.isfinite(float(text))


class Tree:
    """A value of a YAML file: a text, a list of trees, or pairs of trees."""

    def __init__(self, source: Source, words: list[Any]) -> None:
        self.source, self.place = source, (words[0], words[1])
        children = [Tree(source, word) for word in words[2]] if isinstance(words[2], list) else []
        self.text: str | None = words[2] if isinstance(words[2], str) else None
        self.pairs = list(zip(children[::2], children[1::2])) if len(words) > 3 else None
        self.items = children if self.text is None and self.pairs is None else None

    @staticmethod
    def read(source: Source) -> Tree:
        try:
            return Tree(source, json.loads(_strut.yaml_places(source.name, source.text)))
        except SceneError as error:
            place = (error.line or 1, error.column or 1)
            raise Wrong(source, place, error.messages[0].text if error.messages else error.message) from None

    @property
    def word(self) -> str:
        """The text, "" of lists and mappings."""
        return self.text or ""

    def get(self, key: str) -> Tree | None:
        """The value of a key."""
        return next((value for name, value in self.pairs or () if name.text == key), None)

    def error(self, text: str) -> NoReturn:
        raise Wrong(self.source, self.place, text)

    def note(self, text: str) -> None:
        self.source.note(self.place, text)

    def mapping(self, what: str) -> list[tuple[Tree, Tree]]:
        """Its pairs."""
        return self.error(f"expected a mapping {what}") if self.pairs is None else self.pairs

    def listing(self, what: str, least: int = 0, most: float = math.inf) -> list[Tree]:
        """Its items."""
        if self.items is None or not least <= len(self.items) <= most:
            self.error(f"expected {what}")
        return self.items

    def number(self, what: str) -> float:
        if self.text is None or not is_number(self.text):
            found = "a mapping" if self.pairs is not None else "a list" if self.text is None else self.text
            self.error(f"expected a number for {what}, found '{found:.60}'")
        return float(self.text)

    def point(self, what: str, least: int, most: int) -> list[float]:
        return [item.number("a coordinate") for item in self.listing(what, least, most)]


def own_name(name: str) -> str:
    """A name as a scene may have it: other characters are underscores."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", name[:200]) or "_"
    plain = re.match("[A-Za-z]", name) and name.lower() not in _YAML_WORDS
    return name if plain else json.dumps(name)


class Draft:
    """The scene that is being made: lines in sections, each with the place that it comes from."""

    def __init__(self, unit: float) -> None:
        self.unit = unit  #: of lengths [m]
        self.head: list[str] = []
        self.lines: dict[str, list[tuple[str, Source, Place]]] = {name: [] for name in _SECTIONS}
        self._nodes: dict[str, tuple[str, Source, Place]] = {}
        self._used: set[str] = set()

    def length(self, value: float) -> str:
        """A length of the file in metres; decimal units leave decimal numbers."""
        parts = round(1 / self.unit)
        decimal = parts >= 1 and abs(1 / self.unit - parts) < 1e-9 * parts
        return number(value / parts if decimal else value * self.unit)

    def add(self, section: str, name: str, value: str, source: Source, place: Place) -> None:
        self.lines[section].append((f"  {own_name(name)}: {value}", source, place))

    def node(self, name: str, x: str, y: str, more: str, source: Source, place: Place) -> None:
        """Adds a node; it is written where something uses it, since a scene refuses nodes without use."""
        if name in self._nodes:
            raise Wrong(source, place, f"node '{name:.60}' is given twice")
        self._nodes[name] = f"{{position: [{x}, {y}]{more}}}", source, place

    def has_node(self, name: str) -> bool:
        return name in self._nodes

    def use(self, name: str) -> str:
        self._used.add(name)
        return own_name(name)

    def text(self, title: str, sources: Sequence[Source]) -> str:
        """The scene; what strut finds wrong in it is listed at the places that its lines come from."""
        names = [re.sub(r"[^ -~]", "_", os.path.basename(source.name)) for source in sources]
        shown = "' and '".join(names[:2])
        lines = [f"# Imported by strut from '{shown}', {title}.", "strut: 1", f"name: {json.dumps(names[0])}"]
        places: dict[int, tuple[Source, Place]] = {}
        if not any(self.lines[section] for section in ("members", "hinges", "cells", "distances")):
            raise Failure(f"'{sources[0].name}' has no member that a scene could have")
        for name, (value, source, place) in self._nodes.items():
            if name in self._used:
                self.add("nodes", name, value, source, place)
            else:
                source.note(place, f"not imported: node {own_name(name)}, which nothing uses")
        lines += self.head
        for section, entries in self.lines.items():
            lines += [f"{section}:"] if entries else []
            for line, source, place in entries:
                lines.append(line)
                places[len(lines)] = source, place
        try:
            loads("\n".join(lines), name=f"the scene of '{names[0]}'")
        except SceneError as error:
            for message in error.messages:
                source, place = places.get(message.line, (sources[0], (1, 1)))
                source.said.append((place, "error", message.text))
        return "\n".join(lines) + "\n"

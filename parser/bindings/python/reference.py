# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints docs/python-api.md: every public name of the package, from its signature and docstring.

    PYTHONPATH=build/release/python python3 -P parser/bindings/python/reference.py >docs/python-api.md
"""

from __future__ import annotations

import functools
import inspect
from typing import Any, Iterator

import strut

HEAD = """# Python reference

<!-- Written by parser/bindings/python/reference.py; do not edit. -->
[strut from Python](python.md) shows by example how these are used. Numbers are in SI units. `Value` is a number or a
text with a unit, such as `"10 Hz"`, `Values` one or several of them. Arrays are
numpy arrays; their shapes are in parentheses, as in (samples, nodes, 2).
"""


def parameter(p: inspect.Parameter) -> str:
    """One parameter as it is written."""
    star = {p.VAR_POSITIONAL: "*", p.VAR_KEYWORD: "**"}.get(p.kind, "")
    hint = "" if p.annotation is p.empty else f": {p.annotation}"
    default = "" if p.default is p.empty else f" = {p.default!r}" if hint else f"={p.default!r}"
    return star + p.name + hint + default


def call(name: str, function: Any) -> str:
    """A signature, on one line if it is short."""
    signature = inspect.signature(function)
    given = [p for p in signature.parameters.values() if p.name != "self"]
    words: list[str] = []
    for before, p in zip([None, *given], given):
        if before is not None and before.kind is p.POSITIONAL_ONLY and p.kind is not p.POSITIONAL_ONLY:
            words.append("/")
        if p.kind is p.KEYWORD_ONLY and (before is None or before.kind is not p.KEYWORD_ONLY):
            words.append("*")
        words.append(parameter(p))
    result = signature.return_annotation
    arrow = "" if result is signature.empty else f" -> {result}"
    line = f"{name}({', '.join(words)}){arrow}"
    if len(line) > 100:
        line = f"{name}(\n    " + ",\n    ".join(words) + f",\n){arrow}"
    return line


def entry(title: str, signature: str, text: str | None) -> str:
    return f"### `{title}`\n\n```python\n{signature}\n```\n\n{text or ''}\n"


def members(kind: type) -> Iterator[str]:
    """The public methods and properties that a class defines itself."""
    for name, member in vars(kind).items():
        if name.startswith("_"):
            continue
        title = f"{kind.__name__}.{name}"
        if isinstance(member, (property, functools.cached_property)):
            getter = member.fget if isinstance(member, property) else member.func
            yield entry(title, f"{name}: {getter.__annotations__['return']}", inspect.getdoc(member))
        elif isinstance(member, staticmethod) or (inspect.isfunction(member) and member.__name__ == name):
            yield entry(title, call(name, getattr(kind, name)), inspect.getdoc(member))


def main() -> None:
    print(HEAD)
    kinds = [kind for kind in map(vars(strut).get, strut.__all__) if inspect.isclass(kind)]
    print("## Functions\n")
    for name in strut.__all__:
        thing = getattr(strut, name)
        if inspect.isfunction(thing):
            print(entry(name, call(name, thing), inspect.getdoc(thing)))
    print(entry("models", "models: pathlib.Path", "The folder of the models that come with strut."))
    for kind in kinds:
        bases = [base.__name__ for base in kind.__bases__ if base in kinds]
        print(f"## {kind.__name__}\n")
        if bases:
            print(f"Inherits from {' and '.join(f'[{b}](#{b.lower()})' for b in bases)}.\n")
        print(f"{inspect.getdoc(kind)}\n")
        fields = {n: a for n, a in vars(kind).get("__annotations__", {}).items() if not n.startswith("_")}
        if fields:
            lines = (f"{name}: {getattr(hint, '__forward_arg__', hint)}" for name, hint in fields.items())
            print("```python\n" + "\n".join(lines) + "\n```\n")
        for text in members(kind):
            print(text)


main()

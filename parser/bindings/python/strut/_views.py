# SPDX-License-Identifier: GPL-3.0-or-later
"""What notebooks show: tables of words and numbers, figures, pages."""

from __future__ import annotations

import html
from typing import Any, Iterable, Iterator, Mapping

from ._errors import in_python

_MOST_ROWS = 12  # of a list


class View:
    """What a notebook shows of a page; `html` is the page's text, to be written to a file."""

    def __init__(self, html: str) -> None:
        self.html = html

    def _repr_html_(self) -> str:
        return frame(self.html)


def frame(page: str) -> str:
    """A page within a notebook's."""
    return (
        f'<iframe srcdoc="{html.escape(page)}" '
        'style="width: 100%; height: 640px; border: 0"></iframe>'
    )


def _cell(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(map(_cell, value))
    return f"{value:.6g}" if isinstance(value, float) else html.escape(in_python(str(value)))


def _is_short(value: object) -> bool:
    """A number or a text, or some of these."""
    if isinstance(value, tuple):
        return 0 < len(value) <= 4 and not any(isinstance(item, (tuple, Mapping)) for item in value)
    return value is not None and not isinstance(value, (Mapping, list))


def _rows(words: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, object]]:
    """The short values of a summary, those of a mapping behind its name and a dot."""
    for name, value in words.items():
        if _is_short(value):
            yield before + name, value
        elif isinstance(value, Mapping) and not before:
            yield from _rows(value, f"{name}.")


def _table(lines: Iterable[Iterable[object]], head: Iterable[str] = ()) -> str:
    heads = "".join(f"<th>{_cell(name)}</th>" for name in head)
    body = "".join(
        "<tr>" + "".join(f"<td style='text-align: left'>{_cell(value)}</td>" for value in line) + "</tr>"
        for line in lines
    )
    return "<table>" + (f"<tr>{heads}</tr>" if heads else "") + body + "</table>"


def summary(words: Mapping[str, Any]) -> str:
    """A table of what a result's summary says in short."""
    return _table(_rows(words))


def things(all_things: Iterable[Mapping[str, Any]], count: int) -> str:
    """A table with a row for each of the first things, and a column for what they all have."""
    shown = [thing for thing, _ in zip(all_things, range(_MOST_ROWS))]
    names = [name for name in (shown[0] if shown else ()) if any(_is_short(t[name]) for t in shown)]
    lines = [[value if _is_short(value := thing.get(name)) else "" for name in names] for thing in shown]
    more = f"<p>... and {count - len(shown)} more</p>" if count > len(shown) else ""
    return _table(lines, names) + more

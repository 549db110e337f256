# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures by matplotlib, of the results' own data; and what notebooks show: tables, figures, pages."""

from __future__ import annotations

import html
import math
import re
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Mapping, Sequence

from ._errors import in_python
from ._values import COMPONENTS, UnknownName, numpy, unknown

if TYPE_CHECKING:
    from ._results import Equilibria, Modes, Path, Result, Run
    from ._scene import Scene
    from ._sweep import Table

_PREFIXES = "fpnµm kMGTP"
_PREFIXED = re.compile(r"(m|s|N|J|W|Hz|Pa|rad|B|V|A)(?![\w^])")  #: units that take one


def axes(ax: Any) -> Any:
    """The axes to draw into: new ones unless they are given."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot  # type: ignore[import]
    except ImportError as error:
        raise ImportError(
            "plot() needs matplotlib (Debian: python3-matplotlib; else: pip install matplotlib)"
        ) from error
    return pyplot.subplots(layout="constrained")[1]


class Scale:
    """Numbers in a unit with the prefix that suits the largest of them, as in the program's figures."""

    def __init__(self, values: Any, unit: str | None) -> None:
        finite = numpy().abs(values)[numpy().isfinite(values)]
        largest = float(finite.max()) if finite.size else 0.0
        self.unit, self.factor = unit or "", 1.0
        if _PREFIXED.match(self.unit) and largest > 0:
            group = math.floor(math.log10(largest) / 3 + 1e-12)
            if -5 <= group <= 5:
                self.factor = 1000.0**group
                self.unit = _PREFIXES[group + 5].strip() + self.unit

    def __call__(self, values: Any) -> Any:
        return values / self.factor

    def label(self, name: str) -> str:
        """The label of an axis: "velocity in mm/s"."""
        name = name.replace("_", " ")
        return name if self.unit in ("", "1") else f"{name} in {self.unit}"


def run(result: Run, name: str | None, ax: Any) -> Any:
    """A recorded array over time, a line for each thing; of several components the first."""
    if not result.channels:
        raise ValueError("the run has recorded nothing to plot")
    name = name or result.channels[0]
    channel = name.split(".")[0]
    if channel not in result.channels:
        raise UnknownName(unknown(channel, result.channels, "recorded channel"))
    whole = result[name]
    shape = numpy().shape(whole)
    names = getattr(whole, "names", (name,))
    values = numpy().asarray(whole)
    if len(shape) == 3 or (len(shape) == 2 and "." in name):  # components: the first is x, or normal
        values = values[..., 0]
        name += f" {COMPONENTS[channel][0]}"
    time, scale = Scale(result.time, "s"), Scale(values, result.unit(channel))
    ax = axes(ax)
    lines = ax.plot(time(result.time), scale(values))
    for line, label in zip(lines, names):
        line.set_label(label)
    ax.set_xlabel(time.label("time"))
    ax.set_ylabel(scale.label(name))
    if 1 < len(lines) <= 12:
        ax.legend()
    return ax


def equilibria(result: Equilibria, ax: Any) -> Any:
    """Energies of the equilibria that stand, above the lowest, and the barriers between them."""
    standing = result.standing or list(result)
    lowest = min((each.energy for each in standing), default=0.0)
    above = {each.name: each.energy - lowest for each in standing}
    place = {name: i for i, name in enumerate(above)}
    barriers = [
        (b["from"], b["to"], above[b["from"]] + b["height"])
        for b in result.barriers
        if b["from"] in above and b["to"] in above and b["height"] is not None
    ]
    scale = Scale(numpy().array([*above.values(), *(top for *_, top in barriers)]), "J")
    ax = axes(ax)
    for start, end, top in barriers:
        x = place[start], (place[start] + place[end]) / 2, place[end]
        heights = numpy().array([above[start], top, above[end]])
        ax.plot(x, scale(heights), color="0.8", linewidth=0.8, zorder=1)
    ax.scatter(place.values(), scale(numpy().array([*above.values()])), marker="_", s=400, zorder=2)
    ax.set_xticks([*place.values()], [*place], rotation=45, ha="right")
    ax.set_ylabel(scale.label("energy above the lowest"))
    return ax


def modes(result: Modes, ax: Any) -> Any:
    """The natural frequency of each mode."""
    frequency = result.array("modes.frequency")
    scale = Scale(frequency, "Hz")
    ax = axes(ax)
    ax.stem(range(1, len(frequency) + 1), scale(frequency))
    ax.set_xlabel("mode")
    ax.set_ylabel(scale.label("frequency"))
    return ax


def path(result: Path, ax: Any) -> Any:
    """The load's factor, or what is varied, over the coordinate that moves most; unstable parts dashed."""
    varied = result.summary["over"]
    word = "value" if varied else "factor"
    nodes, steps = result.array("points.nodes"), result.array(f"points.{word}")
    moves = nodes - nodes[0]
    node, along = numpy().unravel_index(numpy().abs(moves).max(axis=0).argmax(), nodes.shape[1:])
    name = [*result[0]["nodes"]][node]
    x = Scale(moves[:, node, along], "m")
    y = Scale(steps, result.summary["unit"])
    stable = [point["stable"] for point in result]
    turns = [i for i in range(1, len(stable)) if stable[i] != stable[i - 1]]
    ax = axes(ax)
    for first, last in zip([0, *turns], [*turns, len(stable) - 1]):
        part = slice(first, last + 1)
        line = "-" if stable[first] else "--"
        ax.plot(x(moves[part, node, along]), y(steps[part]), line, color="C0")
    for event in result.events:
        moved = event["nodes"][name][along] - nodes[0, node, along]
        ax.plot(x(moved), y(event[word]), "o", color="C1")
    ax.set_xlabel(x.label(f"displacement of {name} along {'xy'[along]}"))
    ax.set_ylabel(y.label(varied or "load factor"))
    return ax


def structure(scene: Scene, nodes: Any, force: Any, ax: Any) -> Any:
    """The structure and the names of its nodes; with forces tension red and compression blue, as wide as they are large."""
    largest = 1.0 if force is None else float(numpy().abs(force).max(initial=0.0)) or 1.0
    scale, ax = Scale(nodes, "m"), axes(ax)
    place = scale(nodes)
    for k, (a, b) in enumerate(scene.array("members.nodes").astype(int)):
        part = None if force is None else force[k] / largest
        colour = "C0" if part is None else "0.6" if abs(part) < 1e-9 else "tab:red" if part > 0 else "tab:blue"
        ax.plot(*place[[a, b]].T, color=colour, linewidth=1.5 if part is None else 0.5 + 3 * abs(part))
    ax.plot(*place.T, "o", color="0.2", markersize=3)
    for name, at in zip(scene.names("nodes"), place):
        ax.annotate(name, at, (3, 3), textcoords="offset points")
    ax.set(xlabel=scale.label("x"), ylabel=scale.label("y"), aspect="equal")
    return ax


def sweep(table: Table, column: str | None, ax: Any) -> Any:
    """A column over the parameter, or as a map over the two parameters, that vary; without these over the first column."""
    if column is None:
        kept = [name for name in table.columns[len(table.axes) :] if name in table.units and name != "accuracy_kept"]
        if not kept:
            raise ValueError("the table has no column of numbers to plot")
        column = kept[0 if table.axes else -1]
    over = [name for name, count in zip(table.axes, table.shape) if count > 1] or [table.columns[0]]
    if len(over) not in (1, 2) or len(table.shape) < len(table.axes):
        raise ValueError("plot() shows a column over one or two axes; choose the points that vary in these")
    scales = [Scale(table[name], table.units.get(name)) for name in (*over, column)]
    ax = axes(ax)
    ax.set_xlabel(scales[0].label(over[0]))
    if len(over) == 1:
        ax.plot(scales[0](table[over[0]]), scales[1](table[column]), "o-" if table.axes else "o", markersize=3)
        ax.set_ylabel(scales[1].label(column))
        return ax
    x, y, z = (scale(table.grid(name).squeeze()) for scale, name in zip(scales, (*over, column)))
    colours = ax.pcolormesh(x, y, z, shading="nearest")
    ax.figure.colorbar(colours, ax=ax, label=scales[2].label(column))
    ax.set_ylabel(scales[1].label(over[1]))
    return ax


def residuals(rows: Sequence[Mapping[str, str]], ax: Any) -> Any:
    """Residuals over where they were measured, dots for each quantity of each match."""
    ax = axes(ax)
    for name in dict.fromkeys((row["match"], row["of"]) for row in rows):
        own = [row for row in rows if (row["match"], row["of"]) == name]
        at = [float(row["at"] or i + 1) for i, row in enumerate(own)]
        ax.plot(at, [float(row["residual"]) for row in own], "o", markersize=3, label=": ".join(name))
    ax.set(xlabel="at", ylabel="residual in multiples of the noise")
    ax.legend()
    return ax


def bars(result: Result, value: str, ax: Any) -> Any:
    """A value of all models that have it, a bar for each."""
    known = {m["model"]: m["values"][value] for m in result.models if m["values"].get(value) is not None}
    if not known:
        raise UnknownName(f"no model has a value '{value}'; models[0]['values'] lists them")
    values = numpy().array([*known.values()])
    scale, ax = Scale(values, result.units.get(value)), axes(ax)
    ax.bar([*known], scale(values))
    ax.set_ylabel(scale.label(value))
    return ax


def tradeoff(result: Result, ax: Any) -> Any:
    """Median step errors of the unchanged model over costs, both relative: a line for each method."""
    ax = axes(ax)
    own = [s for s in result.settings if s["model"] == result.models[0]["name"] and s["step_error"]["median"]]
    for group in dict.fromkeys(s["group"] for s in own):
        points = [(s["evaluations"], s["step_error"]["median"]) for s in own if s["group"] == group]
        ax.plot(*zip(*sorted(points)), "o-", markersize=3, label=group)
    ax.set(xscale="log", yscale="log", xlabel="force evaluations, base setting = 1", ylabel="step error")
    ax.legend()
    return ax


# ---- notebooks ----

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

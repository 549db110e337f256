# SPDX-License-Identifier: GPL-3.0-or-later
"""Sweeps: arrays in, a table out."""

from __future__ import annotations

import itertools
from array import array
from functools import cached_property
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Mapping, NamedTuple, Sequence

from . import _plots, _strut
from ._results import Picklable
from ._values import UnknownName, numpy, refuse_bytes, unknown

if TYPE_CHECKING:
    import numpy as np

    from ._results import _Raw
    from ._scene import Scene

    Array = np.ndarray[Any, np.dtype[np.float64]]


class Plan(NamedTuple):
    """The points of a sweep as the library takes them."""

    names: tuple[str, ...]
    shape: tuple[int, ...]  #: lengths of the axes, or the number of points
    rows: int
    numbers: Any  #: rows * len(names) doubles
    words: tuple[str | None, ...] | None  #: values of parameters that are texts


def plan(scene: Scene, axes: Mapping[str, Iterable[object] | object], points: Any, names: Sequence[str] | None) -> Plan:
    """Points of axes, every combination, or of whole rows."""
    if points is not None:
        if axes or names is None:
            raise TypeError("points need names=[...] of their columns, and no axes besides")
        return _rows(scene, points, tuple(names))
    if names is not None:
        raise TypeError("names are those of the columns of points=")
    columns = [_values(scene, name, values) for name, values in axes.items()]
    shape = tuple(len(column) for column in columns)
    return _planned(tuple(axes), shape, list(itertools.product(*columns)))


def _planned(names: tuple[str, ...], shape: tuple[int, ...], rows: list[Any]) -> Plan:
    flat = [value for row in rows for value in row]
    numbers = array("d", (0.0 if isinstance(value, str) else value for value in flat))
    if not any(isinstance(value, str) for value in flat):
        return Plan(names, shape, len(rows), numbers, None)
    words = tuple(value if isinstance(value, str) else None for value in flat)
    return Plan(names, shape, len(rows), numbers, words)


def _rows(scene: Scene, points: Any, names: tuple[str, ...]) -> Plan:
    if hasattr(points, "__array__") or hasattr(points, "__array_interface__"):
        rows = numpy().ascontiguousarray(points, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != len(names):
            raise ValueError(f"points have the shape {rows.shape}, not (..., {len(names)})")
        return Plan(names, (len(rows),), len(rows), rows, None)
    listed = [list(row) for row in points]
    if any(len(row) != len(names) for row in listed):
        raise ValueError(f"every point needs {len(names)} values, one for each name")
    columns = [_values(scene, name, (row[i] for row in listed)) for i, name in enumerate(names)]
    return _planned(names, (len(listed),), [list(row) for row in zip(*columns)])


def _values(scene: Scene, name: str, values: Iterable[object] | object) -> list[Any]:
    """Numbers in SI; words of a parameter that is a text."""
    refuse_bytes(values)
    if isinstance(values, str) or not isinstance(values, Iterable):
        values = [values]
    is_word = isinstance(scene.get(f"parameters.{name}"), str)
    return [_value(scene, name, value, is_word) for value in values]


def _value(scene: Scene, name: str, value: Any, is_word: bool) -> Any:
    refuse_bytes(value)
    if is_word:
        return str(value)
    if isinstance(value, str):  # "8 Hz": the language says how much that is
        return scene.with_({name: value})[f"parameters.{name}"]
    return float(value)


class Table(Picklable):
    """A sweep's results: a row per point, columns by name. table["velocity"] is an array [SI], a column of
    words such as table["status"] a tuple; table.grid("velocity") has the shape of the axes."""

    axes: tuple[str, ...]  #: names of the parameters
    shape: tuple[int, ...]  #: lengths of the axes, or the number of points
    _count: int

    def __init__(self, raw: _Raw, work: Plan) -> None:
        self.__dict__.update(_raw=raw, axes=work.names, shape=work.shape, _count=work.rows)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns: axes, what was kept, "status" and "message"."""
        return (*self._raw.columns(), "status", "message")

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of the columns of numbers."""
        units = {name: self._raw.unit(name) for name in self._raw.columns()}
        return {name: unit for name, unit in units.items() if unit is not None}

    def __len__(self) -> int:
        return self._count

    @property
    def csv(self) -> str:
        """The table as CSV, with units."""
        return self._raw.table()

    def __getitem__(self, column: str) -> Any:
        if column not in self.columns:
            raise UnknownName(unknown(column, self.columns, "column"))
        if column == "status":
            return self.status
        found = self._raw.array(column)
        if found is not None:
            return numpy().asarray(found)
        return tuple(self._raw.words(column, self._count))

    @property
    def status(self) -> tuple[str, ...]:
        """The status of each point: "completed", or why it failed."""
        return tuple(_strut.status_text(code) for code in self._codes)

    @property
    def _codes(self) -> list[int]:
        """Of each point 0, or the number of its failure."""
        return [int(code) for code in self._raw.array("status").tolist()]

    def grid(self, column: str) -> Array:
        """A column of numbers in the shape of the axes."""
        return self[column].reshape(self.shape)  # type: ignore[no-any-return]

    def array(self, *columns: str) -> Array:
        """Columns of numbers side by side, (points, columns); without names all of them."""
        names = columns or [name for name in self.columns if name != "status" and self._raw.array(name) is not None]
        return numpy().column_stack([self[name] for name in names])  # type: ignore[no-any-return]

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The rows as dictionaries."""
        columns = {name: self[name] for name in self.columns}
        return ({name: column[i] for name, column in columns.items()} for i in range(len(self)))

    def to_pandas(self) -> Any:
        """The table as a pandas DataFrame."""
        import pandas  # type: ignore[import]

        return pandas.DataFrame({name: self[name] for name in self.columns})

    def __repr__(self) -> str:
        failed = sum(code != 0 for code in self._codes)
        shown = f", {failed} failed" if failed else ""
        return f"<strut.Table: {len(self)} points{shown}; {', '.join(self.columns)}>"

    def plot(self, column: str | None = None, *, ax: Any = None) -> Any:
        """Draws a column, the first that was kept if not given, by matplotlib; returns the axes.

        Over one parameter it is a curve, over two a map.
        """
        return _plots.sweep(self, column, ax)

    def _repr_html_(self) -> str:
        return _plots.things(self, len(self))

# SPDX-License-Identifier: GPL-3.0-or-later
"""What computations return: words of the JSON as attributes, arrays as items."""

from __future__ import annotations

import html
import json
from typing import TYPE_CHECKING, Any, ClassVar, Iterator, Protocol

from . import _strut
from ._values import Named, UnknownName, Words, from_words, numpy, options, unknown

if TYPE_CHECKING:
    import numpy as np

    from ._scene import Scene

    Array = np.ndarray[Any, np.dtype[np.float64]]


class _Raw(Protocol):
    """What a result asks: _strut.Result or _Stored."""

    def status(self) -> str: ...
    def json(self) -> str: ...
    def table(self) -> str: ...
    def warnings(self) -> list[str]: ...
    def array(self, name: str) -> Any: ...
    def array_names(self) -> list[str]: ...
    def columns(self) -> list[str]: ...
    def unit(self, name: str) -> str | None: ...
    def words(self, column: str, count: int) -> list[str | None]: ...
    def yaml(self) -> str: ...
    def svg(self, names: tuple[str, ...], values: tuple[str, ...]) -> str: ...
    def html(self) -> str: ...


class _Stored:
    """A result out of a pickle: all of its numbers and texts, but no figure and no page."""

    def __init__(self, raw: _Raw) -> None:
        self._status, self._json, self._table = raw.status(), raw.json(), raw.table()
        self._warnings, self._names, self._columns = (
            raw.warnings(),
            raw.array_names(),
            raw.columns(),
        )
        self._arrays = {name: numpy().array(raw.array(name)) for name in self._names}
        self._units = {name: raw.unit(name) for name in self._names}
        rows = max((len(array) for array in self._arrays.values() if array.ndim), default=0)
        self._words = {
            name: raw.words(name, rows)
            for name in [*self._columns, "message"]
            if name not in self._arrays
        }
        try:
            self._yaml: str | None = raw.yaml()
        except Exception:  # of results that are no model
            self._yaml = None

    def status(self) -> str:
        return self._status

    def json(self) -> str:
        return self._json

    def table(self) -> str:
        return self._table

    def warnings(self) -> list[str]:
        return self._warnings

    def array(self, name: str) -> Any:
        array = self._arrays.get(name)
        if array is None and "." in name:  # one thing of a channel is a column of it
            array = from_words(json.loads(self._json), name.split("."))
        return array

    def array_names(self) -> list[str]:
        return self._names

    def columns(self) -> list[str]:
        return self._columns

    def unit(self, name: str) -> str | None:
        return self._units.get(name)

    def words(self, column: str, count: int) -> list[str | None]:
        return self._words.get(column, [None] * count)

    def yaml(self) -> str:
        if self._yaml is None:
            raise ValueError("this result is no model")
        return self._yaml

    def svg(self, names: tuple[str, ...], values: tuple[str, ...]) -> str:
        raise ValueError("a result out of a pickle has no figure")

    def html(self) -> str:
        raise ValueError("a result out of a pickle has no page")


def frame(page: str) -> str:
    """A page within a notebook's."""
    return (
        f'<iframe srcdoc="{html.escape(page)}" '
        'style="width: 100%; height: 640px; border: 0"></iframe>'
    )


class Result:
    """What a computation returned. Attributes are the words of the program's JSON, items arrays by name."""

    _command: ClassVar[str] = ""
    _list: ClassVar[str] = ""  #: the JSON's list that it is about

    def __init__(self, raw: _Raw, scene: Scene | None) -> None:
        self._raw = raw
        self._scene = scene
        self._words: Words | None = None

    @property
    def summary(self) -> Words:
        """The program's JSON as a dictionary."""
        words = self._words
        if words is None:
            words = self._words = json.loads(self._raw.json(), object_hook=Words)
        assert words is not None
        return words

    @property
    def json(self) -> str:
        """The program's --json, byte for byte."""
        return self._raw.json()

    @property
    def table(self) -> str:
        """The table that the program prints."""
        return self._raw.table()

    @property
    def warnings(self) -> list[str]:
        """What the program would warn of."""
        return self._raw.warnings()

    @property
    def array_names(self) -> list[str]:
        """Names of the arrays that are not in the summary."""
        return self._raw.array_names()

    def unit(self, name: str) -> str | None:
        """The unit of such an array, such as "m/s"."""
        return self._raw.unit(name)

    def array(self, name: str) -> Array:
        """An array by its dotted name, such as "position.n1.x" or "equilibria.energy"."""
        found = self._raw.array(name)
        if found is None:
            raise UnknownName(unknown(name, self._raw.array_names(), "array"))
        return numpy().asarray(found)  # type: ignore[no-any-return]

    def svg(self, **more: object) -> str:
        """The figure that --plot draws: svg(draw="period", width="column")."""
        return self._raw.svg(*options(more))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self.summary:
            return self.summary[name]
        if self._list:
            found = self._raw.array(f"{self._list}.{name}")
            if found is not None:
                return numpy().asarray(found)
        raise AttributeError(unknown(name, self.summary, "word in this result"))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.summary]

    def __repr__(self) -> str:
        return f"<strut.{type(self).__name__} of '{self.summary.get('name', '')}'>"

    def __getstate__(self) -> dict[str, Any]:
        raw = self._raw if isinstance(self._raw, _Stored) else _Stored(self._raw)
        return {"_raw": raw, "_scene": self._scene, "_words": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


class _List(Result):
    """A result that is a list of things: they are items, and arrays over them attributes."""

    @property
    def _things(self) -> list[Words]:
        things: list[Words] = self.summary[self._list]
        return things

    def __len__(self) -> int:
        return len(self._things)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        return self._things[key]


#: the components of each channel: ("x", "y") of "position"
_COMPONENTS = {name: components for name, _, components, _ in _strut.channels()}


def _recorded(kind: str) -> dict[str, tuple[str, int | None]]:
    """What is recorded of one thing of a kind by the names of its columns: channel and component."""
    return {
        column: (name, i if len(columns) > 1 else None)
        for name, of, _, columns in _strut.channels()
        if of == kind
        for i, column in enumerate(columns)
    }


class _Trajectories:
    """What was recorded of one thing: run.nodes["n1"].x, and the summary's words of it."""

    def __init__(self, run: Run, name: str, words: Words, arrays: dict[str, tuple[str, int | None]]):
        self._run, self._name, self._words, self._arrays = run, name, words, arrays

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._words:
            return self._words[name]
        if name not in self._arrays:
            raise AttributeError(unknown(name, [*self._words, *self._arrays]))
        channel, component = self._arrays[name]
        array = self._run[channel][self._name]
        return array if component is None else array[:, component]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._words, *self._arrays]

    def __repr__(self) -> str:
        return f"<{self._name}: {', '.join([*self._words, *self._arrays])}>"


_NODE = _recorded("nodes")
_MEMBER = _recorded("members")


class Run(Result):
    """A run. Attributes are words of its summary (run.velocity, run.energy.residual), items what was
    recorded: run["position"]["n1"] (samples, 2), run["position.n1.y"], run["energy.kinetic"]."""

    _command = "run"

    if TYPE_CHECKING:
        velocity: float
        velocity_spread: float | None
        status: str
        energy: Any
        steady: Any
        method: str
        step: float
        duration: float

    @property
    def time(self) -> Array:
        """The instants at which was recorded [s]."""
        found = self._raw.array("time")
        return numpy().asarray(found if found is not None else ())  # type: ignore[no-any-return]

    @property
    def channels(self) -> list[str]:
        """What was recorded: "position", "force", ..."""
        return [*dict.fromkeys(name.split(".")[0] for name in self.array_names if name != "time")]

    def __getitem__(self, name: str) -> Any:
        array = self._raw.array(name)
        if array is None:
            parts = name.split(".", 1)
            if len(parts) == 2 and parts[0] in self.channels:  # out of a pickle
                return self._component(*parts)
            raise UnknownName(unknown(name, ["time", *self.channels], "array"))
        array = numpy().asarray(array)
        names = self._names(name)
        return array if names is None else Named(array, names, 1)

    def _component(self, channel: str, rest: str) -> Any:
        named = self[channel]
        if rest in named.names:
            return named[rest]
        thing, _, component = rest.rpartition(".")
        components = _COMPONENTS.get(channel, ())
        if thing not in named.names or component not in components:
            raise UnknownName(unknown(rest, named.names))
        return named[thing][:, components.index(component)]

    def _names(self, channel: str) -> tuple[str, ...] | None:
        """Names of a channel's things, in the order of its columns."""
        if channel not in self.channels:
            return None
        assert self._scene is not None
        return self._scene.names(channel)

    @property
    def nodes(self) -> Words:
        """Each node: x, y, vx, vy, ... over time as recorded, and the summary's `position` at the end."""
        there = self.summary.get("nodes", {})
        assert self._scene is not None
        names = self._scene.names("nodes")
        return Words({n: _Trajectories(self, n, there.get(n, Words()), _NODE) for n in names})

    @property
    def members(self) -> Words:
        """Each member: length and force over time as recorded."""
        assert self._scene is not None
        names = self._scene.names("members")
        return Words({n: _Trajectories(self, n, Words(), _MEMBER) for n in names})

    def to_yaml(self) -> str:
        """The scene as it was run: running it gives the same bits."""
        return self._raw.yaml()

    def to_pandas(self) -> Any:
        """What was recorded as a table over time, with columns such as "position.n1.x"."""
        import pandas  # type: ignore[import]

        columns = {}
        for channel in self.channels:
            for name, part in self[channel].items():
                components = _COMPONENTS.get(channel, ())
                for i, component in enumerate(components):
                    columns[f"{channel}.{name}.{component}"] = part[:, i]
                if not components:
                    columns[f"{channel}.{name}"] = part
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))

    def html(self) -> str:
        """The page that `strut view` writes."""
        return self._raw.html()

    def __repr__(self) -> str:
        words = self.summary
        velocity = words.get("velocity")
        shown = "" if velocity is None else f", {velocity:.5g} m/s"
        return f"<strut.Run of '{words.get('name', '')}': {words.get('status')}{shown}>"

    def _repr_html_(self) -> str | None:
        try:
            return frame(self.html())
        except ValueError:  # nothing recorded, or out of a pickle
            return None


class Equilibrium(Words):
    """One shape at rest, with the words of the JSON: energy, nodes, forces, verdict, ..."""

    __slots__ = ("_scene",)
    _scene: Any

    def modes(self, **more: object) -> Modes:
        """Vibration about it."""
        found: Modes = self._scene.modes(at=self["name"], **more)
        return found

    def rigidity(self, **more: object) -> Rigidity:
        """Self-stress and mechanisms in it."""
        found: Rigidity = self._scene.rigidity(at=self["name"], **more)
        return found

    def __repr__(self) -> str:
        return f"<strut.Equilibrium {self['name']}: {self['verdict']}, {self['energy']:.6g} J>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _equilibrium, (self._scene, dict(self))


def _equilibrium(scene: Scene | None, words: dict[str, Any]) -> Equilibrium:
    found = Equilibrium(words)
    found._scene = scene
    return found


class Equilibria(_List):
    """Equilibria by number or name: found["II"].energy; found.energy is the array over all."""

    _command = "equilibria"
    _list = "equilibria"

    if TYPE_CHECKING:
        energy: Array
        barriers: list[Any]

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return [_equilibrium(self._scene, words) for words in self._things[key]]
        if not isinstance(key, str):
            return _equilibrium(self._scene, self._things[key])
        for words in self._things:
            if words["name"] == key:
                return _equilibrium(self._scene, words)
        raise UnknownName(unknown(key, self.names, "equilibrium"))

    @property
    def names(self) -> list[str]:
        """Names, in their order."""
        return [words["name"] for words in self._things]

    @property
    def standing(self) -> list[Equilibrium]:
        """Those in which it comes to rest on the ground."""
        return [e for e in self if e["outcome"] == "stands"]

    def html(self) -> str:
        """The page that `strut view` writes."""
        return self._raw.html()

    def _repr_html_(self) -> str | None:
        try:
            return frame(self.html())
        except ValueError:
            return None

    def __repr__(self) -> str:
        return f"<strut.Equilibria of '{self.summary['name']}': {len(self)}>"


class Modes(_List):
    """Modes by number, lowest first: modes[0].frequency; modes.frequency is the array over all [Hz]."""

    _command = "modes"
    _list = "modes"

    if TYPE_CHECKING:
        frequency: Array
        shape: Array

    def __repr__(self) -> str:
        return f"<strut.Modes of '{self.summary['name']}': {len(self)}>"


class Path(_List):
    """Points of a path: path[3].factor; path.factor is the array over all."""

    _command = "path"
    _list = "points"

    if TYPE_CHECKING:
        factor: Array

    def __repr__(self) -> str:
        return f"<strut.Path of '{self.summary['name']}': {len(self)} points>"


class Rigidity(Result):
    """States of self-stress and mechanisms."""

    _command = "rigidity"


class Form(Result):
    """A shape or a prestress that was found."""

    _command = "form"

    def to_yaml(self) -> str:
        """The new model."""
        return self._raw.yaml()

    def scene(self) -> Scene:
        """The new model."""
        from ._scene import loads

        return loads(self.to_yaml(), name="<form>")


class Matrices(Result):
    """Matrices by name: mass, connectivity, equilibrium, stiffness_elastic, stiffness_geometric, damping
    and, where nodes touch the ground, stiffness_contact."""

    _command = "matrices"
    names = (
        "mass",
        "connectivity",
        "equilibrium",
        "stiffness_elastic",
        "stiffness_geometric",
        "damping",
        "stiffness_contact",
    )

    def coordinates(self, name: str) -> tuple[Array, Array, Array, tuple[int, int]]:
        """Rows, columns and values of the entries, and the size: what every sparse library takes."""
        if self._raw.array(f"{name}.value") is None:
            raise UnknownName(unknown(name, [n for n in self.names if n != name], "matrix"))
        rows, columns = (self.array(f"{name}.{word}").astype(int) for word in ("row", "column"))
        size = self.array(f"{name}.size")
        return rows, columns, self.array(f"{name}.value"), (int(size[0]), int(size[1]))

    def dense(self, name: str) -> Array:
        """The matrix with its zeros."""
        rows, columns, values, size = self.coordinates(name)
        matrix = numpy().zeros(size)
        numpy().add.at(matrix, (rows, columns), values)
        return matrix  # type: ignore[no-any-return]

    def __getitem__(self, name: str) -> Any:
        """scipy's csr_array, or a dense array where scipy is not installed."""
        rows, columns, values, size = self.coordinates(name)
        try:
            from scipy.sparse import csr_array  # type: ignore[import]
        except ImportError:
            return self.dense(name)
        return csr_array((values, (rows, columns)), shape=size)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __dir__(self) -> list[str]:
        return [*object.__dir__(self), *self.names]

    def __repr__(self) -> str:
        there = [name for name in self.names if self._raw.array(f"{name}.value") is not None]
        return f"<strut.Matrices: {', '.join(there)}>"

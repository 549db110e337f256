# SPDX-License-Identifier: GPL-3.0-or-later
"""What computations return: words of the JSON as attributes, arrays as items."""

from __future__ import annotations

import json
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Iterator, Sequence, Union

from . import _plots, _strut, _views
from ._errors import Error, in_python
from ._values import COMPONENTS, Frozen, Named, UnknownName, Value, Words
from ._values import fixed, from_words, numpy, options, unknown, words

if TYPE_CHECKING:
    import numpy as np

    from ._scene import Scene

    Array = np.ndarray[Any, np.dtype[np.float64]]
    _Raw = Union[_strut.Result, "_Stored"]


class _Stored:
    """A result out of a pickle: all of its numbers and texts, but no figure and no page."""

    def __init__(self, raw: _Raw) -> None:
        self._status, self._json, self._table = raw.status(), raw.json(), raw.table()
        self._warnings, self._names, self._columns = (
            raw.warnings(),
            raw.array_names(),
            raw.columns(),
        )
        self._arrays = {name: fixed(raw.array(name)) for name in self._names}
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

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        for array in self._arrays.values():
            array.flags.writeable = False

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


class Result(Frozen):
    """What a computation returned; it does not change.

    Attributes are the words of the program's JSON, items arrays by name, all in SI units.
    """

    _command: ClassVar[str] = ""
    _list: ClassVar[str] = ""  #: the JSON's list that it is about
    _raw: _Raw
    _scene: Scene | None

    def __init__(self, raw: _Raw, scene: Scene | None) -> None:
        self.__dict__.update(_raw=raw, _scene=scene)

    @cached_property
    def summary(self) -> Words:
        """The program's JSON as a dictionary."""
        return words(self._raw.json())

    @property
    def json(self) -> str:
        """The program's --json, byte for byte."""
        return self._raw.json()

    @property
    def table(self) -> str:
        """The table that the program prints."""
        return self._raw.table()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the model and about these numbers."""
        return tuple(map(in_python, self._raw.warnings()))

    @property
    def array_names(self) -> tuple[str, ...]:
        """Names of the arrays that are not in the summary."""
        return tuple(self._raw.array_names())

    def unit(self, name: str) -> str | None:
        """The unit of such an array, such as "m/s"; None where there is no such array."""
        return self._raw.unit(name)

    def array(self, name: str) -> Array:
        """An array by its dotted name, such as "position.n1.x" (samples) or "equilibria.energy" (equilibria).

        Lists of the summary are dimensions: "modes.shape" is (modes, nodes, 2). It is read-only.
        """
        found = self._raw.array(name)
        if found is None:
            raise UnknownName(unknown(name, self.array_names, "array"))
        return numpy().asarray(found)  # type: ignore[no-any-return]

    def svg(
        self,
        *,
        title: str | None = None,
        width: Value | None = None,
        draw: str | None = None,
        scale: str | Sequence[float] | None = None,
        times: str | Sequence[Value] | None = None,
        x_label: str | None = None,
        y_label: str | None = None,
        x_limits: str | Sequence[Value] | None = None,
        y_limits: str | Sequence[Value] | None = None,
    ) -> str:
        """The program's figure of it, as the text of an SVG file.

        `width` is "page", "column" or a length [m]. Of a run `draw` is "overview", "period", "snapshots" or
        "curves"; `scale` the magnification of the motion (x, y) in the figure "period", `times` the instants
        of the snapshots [s]. Labels and limits (low, high) [SI] are those of the axes.
        """
        return self._raw.svg(*options({n: v for n, v in locals().items() if n != "self"}))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self.summary:
            return self.summary[name]
        if self._list:
            found = self._raw.array(f"{self._list}.{name}")
            if found is not None:
                return numpy().asarray(found)
            things = self.summary[self._list]
            if things and name in things[0]:
                return tuple(thing.get(name) for thing in things)
        raise AttributeError(unknown(name, dir(self), "word in this result"))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.summary]

    def __repr__(self) -> str:
        return f"<strut.{type(self).__name__} of '{self.summary.get('name', '')}'>"

    def _figure(self) -> str:
        """What notebooks show below the summary."""
        return self.svg()

    def _repr_html_(self) -> str:
        try:
            figure = self._figure()
        except (ValueError, Error):  # nothing recorded, out of a pickle, or without a figure
            figure = ""
        return figure + _views.summary(self.summary)

    def _of(self) -> Scene:
        assert self._scene is not None
        return self._scene

    def __getstate__(self) -> dict[str, Any]:
        raw = self._raw if isinstance(self._raw, _Stored) else _Stored(self._raw)
        return {"_raw": raw, "_scene": self._scene}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


class _List(Result):
    """A result that is a list of things: they are items, and arrays over them attributes."""

    @property
    def _things(self) -> tuple[Words, ...]:
        things: tuple[Words, ...] = self.summary[self._list]
        return things

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(self._things[0] if self._things else ())]

    def __len__(self) -> int:
        return len(self._things)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        return self._things[key]

    def __repr__(self) -> str:
        return f"<strut.{type(self).__name__} of '{self.summary['name']}': {len(self)} {self._list}>"

    def _repr_html_(self) -> str:
        return super()._repr_html_() + _views.things(self._things, len(self))


def _recorded(kind: str) -> dict[str, tuple[str, int | None]]:
    """What is recorded of one thing of a kind by the names of its columns: channel and component."""
    return {
        column: (name, i if len(columns) > 1 else None)
        for name, of, _, columns in _strut.channels()
        if of == kind
        for i, column in enumerate(columns)
    }


class _Trajectories(Frozen):
    """What was recorded of one thing: run.nodes["n1"].x, and the summary's words of it."""

    _run: Run
    _name: str
    _words: Words
    _columns: dict[str, tuple[str, int | None]]

    def __init__(self, run: Run, name: str, there: Words, of_kind: dict[str, tuple[str, int | None]]):
        recorded = run.channels
        columns = {column: at for column, at in of_kind.items() if at[0] in recorded}
        self.__dict__.update(_run=run, _name=name, _words=there, _columns=columns)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._words:
            return self._words[name]
        if name not in self._columns:
            raise AttributeError(unknown(name, [*self._words, *self._columns]))
        channel, component = self._columns[name]
        array = self._run[channel][self._name]
        return array if component is None else array[:, component]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._words, *self._columns]

    def __repr__(self) -> str:
        return f"<{self._name}: {', '.join([*self._words, *self._columns])}>"


_NODE = _recorded("nodes")
_MEMBER = _recorded("members")


class Run(Result):
    """A run.

    Attributes are words of its summary: velocity [m/s], velocity_spread [m/s], status, method, step [s],
    duration [s], energy.kinetic and others [J], steady.kind, contacts["n1"].duty, ... Items are what was recorded:
    run["position"] (samples, nodes, 2), run["position"]["n1"] (samples, 2), run["position.n1.y"] (samples),
    run["energy.kinetic"].
    """

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
        """The instants of the samples (samples) [s]."""
        found = self._raw.array("time")
        return numpy().asarray(found if found is not None else ())  # type: ignore[no-any-return]

    @cached_property
    def channels(self) -> tuple[str, ...]:
        """The channels that were recorded: "position", "force", ..."""
        names = (name if name in COMPONENTS else name.split(".")[0] for name in self.array_names)
        return (*dict.fromkeys(name for name in names if name != "time"),)

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
        components = COMPONENTS.get(channel, ())
        if thing not in named.names or component not in components:
            raise UnknownName(unknown(rest, named.names))
        return named[thing][:, components.index(component)]

    def _names(self, channel: str) -> tuple[str, ...] | None:
        """Names of a channel's things, in the order of its columns."""
        if channel not in self.channels:
            return None
        return self._of().names(channel)

    @property
    def nodes(self) -> Words:
        """The nodes by name: nodes["n1"].x, .y [m], .vx, .vy [m/s], ... (samples), and .position at the end [m]."""
        there = self.summary.get("nodes", {})
        names = self._of().names("nodes")
        return Words({n: _Trajectories(self, n, there.get(n, Words()), _NODE) for n in names})

    @property
    def members(self) -> Words:
        """The members by name: members["m8"].length [m] and .force [N], tension positive, (samples)."""
        names = self._of().names("members")
        return Words({n: _Trajectories(self, n, Words(), _MEMBER) for n in names})

    def to_yaml(self) -> str:
        """The scene as it was run: running it gives the same bits."""
        return self._raw.yaml()

    def to_pandas(self) -> Any:
        """What was recorded as a pandas DataFrame over time, with columns such as "position.n1.x"."""
        import pandas  # type: ignore[import]

        columns = {}
        for channel in self.channels:
            for name, part in self[channel].items():
                components = COMPONENTS.get(channel, ())
                for i, component in enumerate(components):
                    columns[f"{channel}.{name}.{component}"] = part[:, i]
                if not components:
                    columns[f"{channel}.{name}"] = part
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))

    def html(self) -> str:
        """A page for any browser, which plays the motion."""
        return self._raw.html()

    def view(self) -> _views.View:
        """That page for a notebook."""
        return _views.View(self.html())

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """Draws a recorded array over time by matplotlib, and returns the axes.

        `name` is a channel, such as "force" (default: the first one recorded), with a line for each thing (of
        positions and other vectors the first component), or one item, such as "position.n1.y". `ax` are the axes
        to draw into (default: new ones).
        """
        return _plots.run(self, name, ax)

    def __repr__(self) -> str:
        said = self.summary
        velocity = said.get("velocity")
        shown = "" if velocity is None else f", {velocity:.5g} m/s"
        return f"<strut.Run of '{said.get('name', '')}': {said.get('status')}{shown}>"

    def _figure(self) -> str:
        return _views.frame(self.html())


class Equilibrium(Words):
    """An equilibrium: name, energy [J], nodes [m], forces [N] by member, outcome, verdict, eigenvalues, ..."""

    __slots__ = ("_scene",)
    _scene: Any

    def modes(self, *, count: int | None = None, wave: bool = False, stuck: bool = False) -> Modes:
        """Vibration modes about this equilibrium; the arguments are those of Scene.modes."""
        found: Modes = self._scene.modes(at=self["name"], count=count, wave=wave, stuck=stuck)
        return found

    def rigidity(self) -> Rigidity:
        """Self-stress and mechanisms of this equilibrium."""
        found: Rigidity = self._scene.rigidity(at=self["name"])
        return found

    def __repr__(self) -> str:
        return f"<strut.Equilibrium {self['name']}: {self['verdict']}, {self['energy']:.6g} J>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _equilibrium, (self._scene, dict(self))


def _equilibrium(scene: Scene | None, words: dict[str, Any]) -> Equilibrium:
    found = Equilibrium(words)
    object.__setattr__(found, "_scene", scene)
    return found


class Equilibria(_List):
    """All equilibria, by number or name: found["II"].energy [J]; found.energy is the array over all (equilibria).

    `barriers` are the energy barriers between them: barriers[0].height [J].
    """

    _command = "equilibria"
    _list = "equilibria"

    if TYPE_CHECKING:
        energy: Array
        barriers: list[Any]

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return [_equilibrium(self._scene, there) for there in self._things[key]]
        if not isinstance(key, str):
            return _equilibrium(self._scene, self._things[key])
        for there in self._things:
            if there["name"] == key:
                return _equilibrium(self._scene, there)
        raise UnknownName(unknown(key, self.names, "equilibrium"))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the equilibria, in their order."""
        return tuple(there["name"] for there in self._things)

    @property
    def standing(self) -> tuple[Equilibrium, ...]:
        """The equilibria in which the structure comes to rest on the ground."""
        return tuple(each for each in self if each["outcome"] == "stands")

    def html(self) -> str:
        """A page for any browser, with all of them."""
        return self._raw.html()

    def plot(self, *, ax: Any = None) -> Any:
        """Draws the energies of those that stand and the barriers between them by matplotlib; returns the axes."""
        return _plots.equilibria(self, ax)

    def _figure(self) -> str:
        return _views.frame(self.html())


class Modes(_List):
    """Vibration modes by number, lowest first: modes[0].frequency [Hz].

    Over all modes: modes.frequency (modes), modes.damping_ratio (modes), modes.shape (modes, nodes, 2).
    """

    _command = "modes"
    _list = "modes"

    if TYPE_CHECKING:
        frequency: Array
        shape: Array

    def plot(self, *, ax: Any = None) -> Any:
        """Draws the frequencies by matplotlib; returns the axes."""
        return _plots.modes(self, ax)


class Path(_List):
    """The points of a path, in their order: path[3].factor, path[3].nodes [m].

    Over all points: path.factor (points), or path.value where a parameter, an actuator or a displacement was
    varied; path.array("points.nodes") (points, nodes, 2). `events` are limit points, bifurcations and others.
    """

    _command = "path"
    _list = "points"

    if TYPE_CHECKING:
        factor: Array

    def plot(self, *, ax: Any = None) -> Any:
        """Draws load factor or varied value over the largest displacement by matplotlib; returns the axes.

        Unstable parts are dashed, events are dots.
        """
        return _plots.path(self, ax)


class Rigidity(Result):
    """States of self-stress and mechanisms; their counts are in summary["self_stress"] and ["mechanisms"]."""

    _command = "rigidity"

    @property
    def self_stress(self) -> Named:
        """A basis of the states of self-stress: relative forces, tension positive, (states, members).

        self_stress[0] is a state, self_stress["m8"] a member's part in all of them.
        """
        return self._basis("self_stress", "states.forces", "members", ())

    @property
    def mechanisms(self) -> Named:
        """Displacements of the mechanisms, largest 1, (mechanisms, nodes, 2)."""
        return self._basis("mechanisms", "modes.nodes", "nodes", (2,))

    def _basis(self, word: str, array: str, kind: str, rest: tuple[int, ...]) -> Named:
        names, found = self._of().names(kind), self._raw.array(f"{word}.{array}")
        if found is None and self.summary[word]["count"]:
            raise ValueError(f"the {self.summary[word]['count']} of {word} are too many to be listed")
        empty = numpy().empty((0, len(names), *rest))
        return Named(fixed(empty if found is None else found), names, 1)

    def plot(self, state: int = 0, *, ax: Any = None) -> Any:
        """Draws a state of self-stress by matplotlib, tension red, compression blue; returns the axes."""
        states, scene = self.self_stress.array, self._of()
        force = states[state] if len(states) else numpy().zeros(states.shape[1])
        return _plots.forces(scene, scene.array("nodes.position"), force, ax)


class Form(Result):
    """A shape or a prestress: nodes [m]; lengths, rest_lengths [m], forces [N], densities [N/m] by member."""

    _command = "form"

    def plot(self, *, ax: Any = None) -> Any:
        """Draws the shape with its forces by matplotlib, tension red, compression blue; returns the axes."""
        return _plots.forces(self.scene(), self.array("nodes"), self.array("forces"), ax)

    def to_yaml(self) -> str:
        """The new model as a file."""
        return self._raw.yaml()

    def scene(self) -> Scene:
        """The new model as a scene."""
        from ._scene import loads

        return loads(self.to_yaml(), name="<form>")


_MATRICES = (
    "mass",
    "connectivity",
    "equilibrium",
    "stiffness_elastic",
    "stiffness_geometric",
    "damping",
    "stiffness_contact",
)


class Matrices(Result):
    """Matrices by name, such as matrices.mass: sparse ones of scipy, dense ones where it is not installed.

    There are mass, connectivity, equilibrium, stiffness_elastic, stiffness_geometric, damping
    and, where nodes touch the ground, stiffness_contact; `names` are those that there are."""

    _command = "matrices"

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the matrices."""
        return tuple(name for name in _MATRICES if self._raw.array(f"{name}.value") is not None)

    def coordinates(self, name: str) -> tuple[Array, Array, Array, tuple[int, int]]:
        """Row indices, column indices and values, (entries) each, and the size (rows, columns)."""
        if name not in self.names:
            raise UnknownName(unknown(name, self.names, "matrix"))
        rows, columns = (self.array(f"{name}.{word}").astype(int) for word in ("row", "column"))
        size = self.array(f"{name}.size")
        return rows, columns, self.array(f"{name}.value"), (int(size[0]), int(size[1]))

    def dense(self, name: str) -> Array:
        """The matrix as a dense array (rows, columns)."""
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
        return f"<strut.Matrices: {', '.join(self.names)}>"

    def _repr_html_(self) -> str:
        sizes = {name: self.coordinates(name) for name in self.names}
        rows = ({"matrix": n, "size": at[3], "entries": len(at[2])} for n, at in sizes.items())
        return _views.things(rows, len(sizes))

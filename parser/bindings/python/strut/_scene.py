# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes: opened, changed, written, and everything that is computed of them."""

from __future__ import annotations

import json
import os
from functools import cached_property
from typing import TYPE_CHECKING, Any, Callable, Iterable, Literal, Mapping, Sequence

from . import _strut
from ._errors import in_python
from ._results import Equilibria, Form, Matrices, Modes, Path, Rigidity, Run
from ._simulation import Simulation
from ._sweep import Table, plan
from ._views import View
from ._values import Frozen, UnknownName, Value, Words
from ._values import fixed, numpy, options, refuse_bytes, settings, unknown, words

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[np.float64]]

__all__ = ["Scene", "load", "loads"]

Progress = Callable[[float], object]
Bars = Literal["elastic", "rigid"]
MassModel = Literal["consistent", "lumped"]

#: keys that do not act by themselves: texts, and parameters, whose values are in the numbers of the scene
_LABELS = ("name", "description", "source", "parameters")


class Scene(Frozen):
    """A structure with its experiment, as a file describes it. It never changes: `with_` makes another.

    Attributes are the words of the file in SI units (scene.members["m8"].stiffness); items are single values
    by dotted name (scene["run.duration"]), None for keys that the file does not have. Two scenes are equal if they
    describe the same structure and experiment, whether or not with parts, expressions or units; their names,
    descriptions and parameters may differ.
    """

    _raw: _strut.Scene
    _name: str

    def __init__(self, raw: _strut.Scene, name: str) -> None:
        self.__dict__.update(_raw=raw, _name=name)

    @staticmethod
    def from_dict(description: Mapping[str, Any], /, **parameters: object) -> Scene:
        """A scene of a dictionary with the language's keys; values are numbers in SI or texts with units.

        Keywords set its parameters. Places in messages are keys, such as nodes.n3.mass.
        """
        text = json.dumps(description, default=_plain, indent=1)
        return loads(text, parameters, name="<dict>")

    def with_(self, mapping: Mapping[str, object] | None = None, /, **parameters: object) -> Scene:
        """The same scene with other values of parameters: scene.with_(frequency="10 Hz", start="II").

        Calling a scene is the same: scene(frequency=9).
        """
        return Scene(_strut.with_(self._raw, *settings(mapping, parameters)), self._name)

    __call__ = with_

    # ---- what is in it ----

    @property
    def name(self) -> str:
        """The name that the file gives, or else that of the file."""
        return self["name"] or self._name

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about values that are valid but implausible."""
        return tuple(map(in_python, self._raw.warnings()))

    def names(self, kind: str) -> tuple[str, ...]:
        """Names of the things of a kind ("nodes", "members", "parameters", ...), in the order of arrays."""
        return self._raw.names(kind)

    def __getitem__(self, name: str) -> Any:
        return self._raw.value(name)

    def array(self, name: str) -> Array:
        """A read-only array of the drawn structure, in the order of `names`.

        "nodes.position" (nodes, 2) [m], "nodes.mass" (nodes) [kg]; of (members): "members.length" and
        "members.rest_length" [m], "members.stiffness" [N/m], "members.damping" [N s/m], "members.mass" [kg],
        "members.pretension" [N]; "members.nodes" (members, 2), indices of nodes.
        """
        found = self._raw.array(name)
        if found is None:
            raise UnknownName(f"a scene has no array '{name}'")
        return numpy().asarray(found)  # type: ignore[no-any-return]

    def to_dict(self) -> dict[str, Any]:
        """The scene as a dictionary with every value resolved, in SI units; a copy that may be changed."""
        return json.loads(self._raw.json())  # type: ignore[no-any-return]

    def to_yaml(self, *, parts: bool = False) -> str:
        """The scene as a file: with every value resolved, or with `parts` as it was written, in short."""
        return self._raw.yaml(parts)

    @cached_property
    def nodes(self) -> Words:
        """The nodes by name: nodes["n1"].position is (x, y) [m] of the drawn structure, an array."""
        given, position = self._words["nodes"], fixed(self.array("nodes.position"))
        return Words(
            (name, Words(given[name] if isinstance(given[name], dict) else {}, position=position[i]))
            for i, name in enumerate(self.names("nodes"))
        )

    @cached_property
    def _words(self) -> Words:
        return words(self._raw.json())

    @cached_property
    def _effective(self) -> str:
        return json.dumps({n: v for n, v in self._words.items() if n not in _LABELS})

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._effective == other._effective

    def __hash__(self) -> int:
        return hash(self._effective)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._words[name]
        except KeyError:
            raise AttributeError(unknown(name, self._words, "word in this scene")) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._words]

    def __repr__(self) -> str:
        nodes, members = len(self.names("nodes")), len(self.names("members"))
        return f"<strut.Scene '{self.name}': {nodes} nodes, {members} members>"

    def svg(self) -> str:
        """The drawn structure as an SVG picture."""
        return self._raw.svg()

    def html(self, *, equilibria: bool = False) -> str:
        """A page for any browser that shows the structure, with `equilibria` all of these, too."""
        return self._raw.html(equilibria)

    def view(self, *, equilibria: bool = False) -> View:
        """That page for a notebook."""
        return View(self.html(equilibria=equilibria))

    def _repr_html_(self) -> str:
        return self.svg()

    def __reduce__(self) -> tuple[Any, ...]:
        try:
            return _restore, (self.to_yaml(parts=True), self._name)
        except Exception:  # what --parts cannot say
            return _restore, (self.to_yaml(), self._name)

    # ---- what is computed of it ----

    def _call(self, kind: type[Any], given: Mapping[str, object]) -> Any:
        """Calls the library with the arguments of a method, its locals().

        What an interrupted or failed call returned becomes error.result.
        """
        raw = _strut.Result()
        pairs = options({name: value for name, value in given.items() if name not in _NO_OPTIONS})
        progress: Any = given.get("progress")
        try:
            self._raw.call(raw, kind._command, *pairs, progress)
        except BaseException as error:
            if raw:
                error.result = kind(raw, self)  # type: ignore[attr-defined]
            raise
        if progress is not None:
            progress(1.0)
        return kind(raw, self)

    def run(
        self,
        *,
        accuracy: Value | None = None,
        budget: float | None = None,
        integrator: str | None = None,
        step: Value | None = None,
        tolerance: Value | None = None,
        steady: Value | None = None,
        bars: Bars | None = None,
        mass_model: MassModel | None = None,
        friction_law: str | None = None,
        damping_law: str | None = None,
        force: bool = False,
        channels: str | Sequence[str] | None = None,
        record: bool = True,
        progress: Progress | None = None,
    ) -> Run:
        """Simulates it: run(accuracy="0.5 %"), or run(integrator="rk4-events", step="50 us").

        `accuracy` chooses method and step for this relative error of the velocity; `budget` limits its work, in
        units of one run with a fine fixed step (default 20). Without it `integrator` and `step` [s] replace those
        of the scene, `tolerance` is the error tolerance of "adaptive" and "adaptive8", and `force=True` allows a step
        above the stability limit. `steady` ends the run once the motion repeats within this relative tolerance.
        `bars`, `mass_model`, `friction_law` and `damping_law` replace those of the scene. `channels` are
        recorded instead of those of the scene; `record=False` records nothing.
        `progress(fraction)` is called a few times per second; an exception that it raises ends the run. A run that
        fails raises RunError, whose `result` is the run until then; an interrupted run's KeyboardInterrupt has it, too.
        """
        return self._call(Run, locals())  # type: ignore[no-any-return]

    def equilibria(
        self,
        *,
        supports: str | Sequence[str] | None = None,
        starts: int | None = None,
        seed: int | None = None,
        all: bool = False,
    ) -> Equilibria:
        """Finds all equilibria and the energy barriers between them: equilibria()["II"].energy.

        `supports` are the only contact nodes that are held (default: all choices of them). `starts` is the number
        of random starts of each search, `seed` the seed of their random numbers. `all=True` lists every
        equilibrium in the text `table`.
        """
        return self._call(Equilibria, locals())  # type: ignore[no-any-return]

    def modes(
        self,
        *,
        at: str | None = None,
        count: int | None = None,
        wave: bool = False,
        stuck: bool = False,
    ) -> Modes:
        """Computes natural frequencies [Hz] and mode shapes about an equilibrium.

        `at` is the name of the equilibrium, or "drawn" (default: the equilibrium of the start). `count` is the
        number of modes, lowest first. `stuck=True` treats closed contacts as stuck. `wave=True` computes waves of
        the structure repeated by its lattice instead.
        """
        return self._call(Modes, locals())  # type: ignore[no-any-return]

    def rigidity(self, *, at: str | None = None) -> Rigidity:
        """Finds the states of self-stress and the mechanisms of a shape.

        `at` is "drawn" (default), "start", or the name of an equilibrium.
        """
        return self._call(Rigidity, locals())  # type: ignore[no-any-return]

    def form(
        self,
        *,
        given: Literal["densities", "lengths", "prestress"] | None = None,
        least_tension: Value | None = None,
        least_density: Value | None = None,
        objective: Literal["largest", "sum", "squares"] | None = None,
    ) -> Form:
        """Finds an equilibrium shape or a prestress; `form().scene()` is the model that has it.

        `given` names what is prescribed (default: what the scene prescribes). `least_tension` [N] and
        `least_density` [N/m] are lower bounds on tension and force density of every cable. `objective` is what
        the prestress minimises: the largest force, the sum of all, or the sum of their squares.
        """
        return self._call(Form, locals())  # type: ignore[no-any-return]

    def path(
        self,
        *,
        load: str | Sequence[str] | None = None,
        over: str | None = None,
        from_: Value | None = None,
        until: Value | None = None,
        stop: str | None = None,
        at: str | None = None,
        friction: Literal["none", "kept"] | None = None,
        branches: int | None = None,
        steps: int | None = None,
    ) -> Path:
        """Follows an equilibrium past limit points: path(load="push"), or path(over="n3.y", until="-20 mm").

        `load` names the loads that a factor scales (default: all constant ones); `over` names a parameter, an
        actuator, or the displacement NODE.x or NODE.y of a node that varies instead. `from_` and `until` are the
        start and end values, a factor or a value in SI units; `stop`, such as "n1.x=10 mm", ends the path earlier.
        `at` is the equilibrium to start from. `friction="kept"` lets contacts stick and slide along the path.
        `branches` is the depth to which paths that leave at bifurcations are followed; `steps` is the maximum
        number of steps (default 400).
        """
        return self._call(Path, locals())  # type: ignore[no-any-return]

    def matrices(self, *, at: str | None = None) -> Matrices:
        """Computes mass, stiffness, damping and equilibrium matrices of a shape.

        `at` is "drawn" (default), "start", or the name of an equilibrium.
        """
        return self._call(Matrices, locals())  # type: ignore[no-any-return]

    def simulation(
        self,
        *,
        integrator: str | None = None,
        step: Value | None = None,
        tolerance: Value | None = None,
        bars: Bars | None = None,
        mass_model: MassModel | None = None,
        friction_law: str | None = None,
        damping_law: str | None = None,
        force: bool = False,
    ) -> Simulation:
        """Opens a run that the caller advances, with live arrays; the arguments are those of `run`."""
        given = {name: value for name, value in locals().items() if name not in _NO_OPTIONS}
        return Simulation(self._raw.simulation(*options(given)), self)

    def sweep(
        self,
        axes: Mapping[str, Iterable[object] | object] | None = None,
        /,
        *,
        points: Any = None,
        names: Sequence[str] | None = None,
        keep: str | Sequence[str] = (),
        compute: str | None = None,
        at: str | None = None,
        lowest: int | None = None,
        limit_evaluations: int | None = None,
        limit_time: Value | None = None,
        threads: int | None = None,
        accuracy: Value | None = None,
        budget: float | None = None,
        integrator: str | None = None,
        step: Value | None = None,
        tolerance: Value | None = None,
        steady: Value | None = None,
        bars: Bars | None = None,
        mass_model: MassModel | None = None,
        friction_law: str | None = None,
        damping_law: str | None = None,
        progress: Progress | None = None,
        **parameters: Iterable[object] | object,
    ) -> Table:
        """Computes many points on all processors: sweep(frequency=[8, 9, 10], friction=[0.1, 0.5]).

        `parameters` of the scene get lists of values, and every combination is a point; the last parameter changes
        fastest. Those of the dictionary `axes` come first, then those with the name of an argument, such as
        `step`. Alternatively `points` (points, parameters) are rows of values of the parameters `names`.
        `compute` is "run" (default), "equilibria", "modes", "rigidity", "path" or "form"; `keep` names the columns,
        as in a study. `at` is the equilibrium of modes, rigidity and path, and `lowest` the number of
        frequencies, energies and barriers in a row. A point fails after `limit_evaluations` force evaluations or
        `limit_time` [s]. `threads` is the number of threads (default automatic). The others are arguments of
        `run`. A failed point is a row with its status and message.
        """
        given = {name: value for name, value in locals().items() if name not in _NO_OPTIONS}
        own = self.names("parameters")
        wrong = [name for name in parameters if name not in own]
        if wrong:
            known = [*own, *given, "points", "names", "keep", "progress"]
            raise TypeError(f"sweep(): {unknown(wrong[0], known, 'parameter or argument')}")
        alike = {name: given.pop(name) for name in own if given.get(name) is not None}
        work = plan(self, {**(axes or {}), **alike, **parameters}, points, names)
        pairs = options(given, [name for name, _ in _strut.options("sweep")])
        kept = (keep,) if isinstance(keep, str) else tuple(keep)
        raw = _strut.Result()
        try:
            self._raw.sweep(
                raw, work.names, work.rows, work.numbers, work.words, kept, *pairs, progress
            )
        except BaseException as error:
            if raw:
                error.result = Table(raw, work)  # type: ignore[attr-defined]
            raise
        if progress is not None:
            progress(1.0)
        return Table(raw, work)


#: local names of a method that are no options of the library
_NO_OPTIONS = {"self", "progress", "axes", "points", "names", "keep", "parameters"}


def _plain(value: Any) -> Any:
    """Numbers and arrays of numpy for JSON."""
    refuse_bytes(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "__float__"):
        return float(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Iterable):
        return list(value)
    raise TypeError(f"a scene holds numbers, texts, lists and dictionaries, not {type(value).__name__}")


def _restore(text: str, name: str) -> Scene:
    """A scene out of a pickle."""
    return loads(text, name=name)


def load(
    path: str | os.PathLike[str], mapping: Mapping[str, object] | None = None, /, **parameters: object
) -> Scene:
    """Opens a scene's file: load("crawler.yaml", frequency="10 Hz", start="II").

    Keywords set parameters; plain numbers are in SI units, texts may have units. SceneError has the place
    of every mistake.
    """
    return Scene(_strut.open(path, *settings(mapping, parameters)), os.fspath(path))


def loads(
    text: str,
    mapping: Mapping[str, object] | None = None,
    /,
    *,
    name: str = "<text>",
    **parameters: object,
) -> Scene:
    """Opens a scene's text, in the language or in JSON; `name` stands for the file in messages."""
    return Scene(_strut.open_text(name, text, *settings(mapping, parameters)), name)

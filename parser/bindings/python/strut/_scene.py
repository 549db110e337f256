# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes: opened, changed, written, and everything that is computed of them."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Sequence

from . import _strut
from ._results import Equilibria, Form, Matrices, Modes, Path, Result, Rigidity, Run
from ._simulation import Simulation
from ._sweep import Table, plan
from ._values import UnknownName, Words, numpy, options, refuse_bytes, settings, unknown

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[np.float64]]

__all__ = ["Scene", "load", "loads"]

Progress = Callable[[float], object]


class Scene:
    """A structure with its experiment, as a file describes it. It never changes: `with_` makes another.

    Attributes are the words of the file in SI units (scene.members["m8"].stiffness); items are single values
    by dotted name (scene["run.duration"]), None where the file says nothing.
    """

    _raw: _strut.Scene
    _name: str
    _words: Words | None

    def __init__(self, raw: _strut.Scene, name: str) -> None:
        self._raw = raw
        self._name = name
        self._words = None

    @staticmethod
    def from_dict(description: Mapping[str, Any], /, **more: object) -> Scene:
        """A scene of a dictionary with the language's keys; values are numbers in SI or texts with units.

        Places in messages are keys, such as nodes.n3.mass.
        """
        return loads(json.dumps(description, default=_plain, indent=1), name="<dict>", **more)

    def with_(self, mapping: Mapping[str, object] | None = None, /, **more: object) -> Scene:
        """The same scene with other values of parameters: scene.with_(frequency="10 Hz", start="II")."""
        return Scene(_strut.with_(self._raw, *settings(mapping, more)), self._name)

    __call__ = with_

    # ---- what is in it ----

    @property
    def name(self) -> str:
        """The name that the file gives, or else that of the file."""
        return self["name"] or self._name

    @property
    def warnings(self) -> list[str]:
        """What is valid but implausible."""
        return self._raw.warnings()

    def names(self, kind: str) -> tuple[str, ...]:
        """Names of the things of a kind ("nodes", "members", "parameters", ...), in the order of arrays."""
        return self._raw.names(kind)

    def __getitem__(self, name: str) -> Any:
        return self._raw.value(name)

    def array(self, name: str) -> Array:
        """An array of the drawn structure, such as "nodes.position" or "members.stiffness"."""
        found = self._raw.array(name)
        if found is None:
            raise UnknownName(f"a scene has no array '{name}'")
        return numpy().asarray(found)  # type: ignore[no-any-return]

    def to_dict(self) -> dict[str, Any]:
        """The scene with every value resolved, in SI units."""
        return json.loads(self._raw.json())  # type: ignore[no-any-return]

    def to_yaml(self, *, parts: bool = False) -> str:
        """As `strut write`: every value resolved, or with parameters, groups and parts."""
        return self._raw.yaml(parts)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        words = self._words
        if words is None:
            words = self._words = json.loads(self._raw.json(), object_hook=Words)
        try:
            return words[name]
        except KeyError:
            raise AttributeError(unknown(name, words, "word in this scene")) from None

    def __repr__(self) -> str:
        nodes, members = len(self.names("nodes")), len(self.names("members"))
        return f"<strut.Scene '{self.name}': {nodes} nodes, {members} members>"

    def svg(self) -> str:
        """The drawn structure as an SVG picture."""
        return self._raw.svg()

    def html(self, *, equilibria: bool = False) -> str:
        """The page that `strut view` writes; with equilibria they are searched."""
        return self._raw.html(equilibria)

    def _repr_html_(self) -> str:
        return self.svg()

    def __reduce__(self) -> tuple[Any, ...]:
        try:
            return _restore, (self.to_yaml(parts=True), self._name)
        except Exception:  # what --parts cannot say
            return _restore, (self.to_yaml(), self._name)

    # ---- what is computed of it ----

    def _call(
        self, kind: type[Any], given: Mapping[str, object], progress: Progress | None = None
    ) -> Any:
        """Calls the library; what an interrupted or failed call returned becomes error.result."""
        raw = _strut.result()
        try:
            self._raw.call(raw, kind._command, *options(given), progress)
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
        accuracy: float | str | None = None,
        channels: str | Sequence[str] | None = None,
        record: bool | None = None,
        progress: Progress | None = None,
        **more: object,
    ) -> Run:
        """Simulates it, as `strut run` with its options: run(accuracy="0.5 %", integrator="rk4-events").

        `channels` are recorded instead of those of the scene, `record=False` records none.
        `progress(fraction)` is called now and then; what it raises ends the run. A run that fails
        raises RunError, whose `result` is the run up to there; so has KeyboardInterrupt.
        """
        given: dict[str, object] = {"accuracy": accuracy, "channels": channels, "record": record}
        run: Run = self._call(Run, {**given, **more}, progress)
        return run

    def equilibria(self, **more: object) -> Equilibria:
        """All shapes in which it can rest, and the barriers between: equilibria()["II"].energy."""
        found: Equilibria = self._call(Equilibria, more)
        return found

    def modes(self, *, at: str | None = None, **more: object) -> Modes:
        """Natural frequencies and mode shapes about an equilibrium."""
        found: Modes = self._call(Modes, {"at": at, **more})
        return found

    def rigidity(self, *, at: str | None = None, **more: object) -> Rigidity:
        """States of self-stress and mechanisms."""
        found: Rigidity = self._call(Rigidity, {"at": at, **more})
        return found

    def form(self, **more: object) -> Form:
        """An equilibrium shape or a prestress; `scene()` of what it returns is that model.

        The program's --from is written from_: form(from_="densities").
        """
        found: Form = self._call(Form, _from(more))
        return found

    def path(self, **more: object) -> Path:
        """Follows an equilibrium as a load, an actuator or a parameter changes: path(load="push")."""
        found: Path = self._call(Path, _from(more))
        return found

    def matrices(self, *, at: str | None = None) -> Matrices:
        """Mass, stiffness, equilibrium matrix and others, as sparse matrices of scipy where it is installed."""
        found: Matrices = self._call(Matrices, {"at": at})
        return found

    def simulation(self, **more: object) -> Simulation:
        """A run that is advanced from outside, with live arrays: simulation(step="0.1 ms")."""
        return Simulation(self._raw.simulation(*options(more)), self)

    def sweep(
        self,
        axes: Mapping[str, Iterable[object] | object] | None = None,
        /,
        *,
        points: Any = None,
        names: Sequence[str] | None = None,
        keep: str | Sequence[str] = (),
        progress: Progress | None = None,
        **more: Iterable[object] | object,
    ) -> Table:
        """Computes many points on all processors: sweep(frequency=[8, 9, 10], friction=[0.1, 0.5]).

        Keywords are parameters with their values, of which every combination is a point; the last one
        changes fastest. Or `points` are rows, whose columns are the parameters `names`. `keep` are
        columns as of a study. Other keywords are options, as strut.options("sweep") lists them. A point
        that fails is a row with its status and message.
        """
        known = {name for name, _ in _strut.options("sweep")} - set(self.names("parameters"))
        given = {
            name: value
            for name, value in more.items()
            if name in known or name.replace("_", "-") in known
        }
        varied = {**(axes or {}), **{n: v for n, v in more.items() if n not in given}}
        pairs = options(given, known)
        work = plan(self, varied, points, names)
        kept = (keep,) if isinstance(keep, str) else tuple(keep)
        raw = _strut.result()
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


def _from(given: dict[str, object]) -> dict[str, object]:
    """The options with from_ as from, which is a word of Python's."""
    return {name.rstrip("_"): value for name, value in given.items()}


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
    path: str | os.PathLike[str], mapping: Mapping[str, object] | None = None, /, **more: object
) -> Scene:
    """Opens a scene's file: load("crawler.yaml", frequency="10 Hz", start="II").

    Keywords set parameters; plain numbers are in SI units, texts may have units. SceneError has the place
    of every mistake.
    """
    return Scene(_strut.open(path, *settings(mapping, more)), os.fspath(path))


def loads(
    text: str,
    mapping: Mapping[str, object] | None = None,
    /,
    *,
    name: str = "<text>",
    **more: object,
) -> Scene:
    """Opens a scene's text, in the language or in JSON; `name` stands for the file in messages."""
    return Scene(_strut.open_text(name, text, *settings(mapping, more)), name)

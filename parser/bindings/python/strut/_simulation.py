# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations: a run that Python advances."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Callable, Mapping, Sequence

from . import _strut
from ._results import Run, _Stored
from ._values import COMPONENTS, Frozen, Named, Words, fixed, numpy, parts_of, unknown

if TYPE_CHECKING:
    from ._scene import Scene


class Motion(Run):
    """A run under a controller: what it recorded, and a summary with `velocity`, the mean one along x [m/s].

    Energies are those at the end; `input_work` is the controller's part of `drive_work`. There is no figure and no page.
    """

    _guesses = {
        **Run._guesses,
        **dict.fromkeys(("accuracy", "steady"), "a run under a controller measures from start to end"),
    }


def controlled(
    sim: Simulation, scene: Scene, controller: Callable[[Simulation], object], channels: Sequence[str]
) -> Motion:
    """Advances by single steps, before each of which the controller sets inputs, and records as the scene says."""
    steps, until = 0, scene["run.duration"] - 0.5 * sim.step
    stride = max(1, round(scene.get("output.every", 0.0) / sim.step))
    watched = [getattr(sim, name) for name in channels]
    time: list[float] = []
    rows: list[list[Any]] = [[] for _ in channels]
    start, before = sim.com.x.copy(), _energies(sim)

    def motion() -> Motion:
        arrays = {"time": fixed(time), **{name: fixed(each) for name, each in zip(channels, rows)}}
        words: dict[str, Any] = {name: scene[name] for name in ("name", "parameters") if scene.get(name) is not None}
        words |= {"status": "completed" if sim.time >= until else "interrupted", "duration": sim.time, "steps": steps}
        words |= {"step": sim.step, "velocity": float(sim.com.x - start) / sim.time if steps else None}
        words["nodes"] = {name: {"position": place.tolist()} for name, place in sim.position.items()}
        energy, initial = _energies(sim), sum(before[name] for name in ("kinetic", "elastic", "gravity", "contact"))
        words["energy"] = energy | {"initial": initial, "residual": _balance(energy) - _balance(before)}
        units = {name: "s" if name == "time" else _strut.unit(name) for name in arrays}
        missing = "a run under a controller has no {}; plot() draws it, save('x.csv') writes it"
        return Motion(_Stored(missing, arrays, units, json=json.dumps(words)), scene)

    try:
        while sim.time < until:
            controller(sim)
            sim.advance(1)
            steps += 1
            if steps % stride == 0:
                time.append(sim.time)
                for row, values in zip(rows, watched):
                    row.append(values.array.copy())
    except BaseException as error:
        error.result = motion()  # type: ignore[attr-defined]
        raise
    return motion()


def _energies(sim: Simulation) -> dict[str, float]:
    return {**{name: float(value) for name, value in sim.energy.items()}, "input_work": sim.input_work}


def _balance(energy: Mapping[str, float]) -> float:
    """What is stored and dissipated, less the work that was done; drive_work has input_work in it."""
    return sum(-value if name.endswith("_work") else value for name, value in energy.items() if name != "input_work")


_INPUTS = {"rest": "members", "actuators": "actuators", "load": "nodes"}


class Simulation(Frozen):
    """A run that is advanced from outside, by one thread at a time.

    Arrays are live: they follow every advance; copy() what shall stay. They are the channels that a scene
    can record: position and velocity (nodes, 2), length and force (members), contact (contacts, 2), com.x, energy, ...
    Inputs are written at any time, and hold from the next advance on: rest (members) [m], actuators (in
    their unit; NAN: as the scene says), load (nodes, 2) [N]:

        sim.rest["m8"] = sim.rest0["m8"] + 0.3e-3
        sim.advance(10)
        print(sim.time, sim.velocity["n1"][0])
    """

    advance: Callable[[int], None]  #: advance(steps): bits do not depend on how steps are divided
    snapshot: Callable[[], _strut.Snapshot]  #: all of the state, inputs too
    restore: Callable[[_strut.Snapshot], None]  #: back to a snapshot; what follows has the same bits
    _raw: _strut.Simulation
    _scene: Scene
    _rest0: list[float] | None

    def __init__(self, raw: _strut.Simulation, scene: Scene) -> None:
        rest = raw.input("rest")
        self.__dict__.update(
            _raw=raw,
            _scene=scene,
            _rest0=None if rest is None else rest.tolist(),
            advance=raw.advance,
            snapshot=raw.snapshot,
            restore=raw.restore,
        )

    def advance_to(self, time: float) -> None:
        """Makes the steps until `time` [s] is reached, none where it has passed."""
        self.advance(max(0, math.ceil((time - self.time) / self.step - 1e-9)))

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self._raw.time()

    @property
    def step(self) -> float:
        """The step [s]; of a method with error control the time between two stops."""
        return self._raw.step()

    @property
    def input_work(self) -> float:
        """Work that changes of inputs have done [J]."""
        return self._raw.input_work()

    def __getattr__(self, name: str) -> Any:
        # Only for arrays that were not read yet: they become attributes.
        if name in COMPONENTS:
            array, kind = self._raw.array(name), name
        elif name in _INPUTS:
            array, kind = self._raw.input(name), _INPUTS[name]
        elif parts := parts_of(name, COMPONENTS):  # com.x, a single number
            self.__dict__[name] = Words({n: getattr(self, channel).array.reshape(()) for n, channel in parts.items()})
            return self.__dict__[name]
        elif name == "rest0":
            kind = "members"
            array = None if self._rest0 is None else fixed(self._rest0)
        else:
            raise AttributeError(unknown(name, [*COMPONENTS, "com", *_INPUTS, "rest0", "advance"], "array or input"))
        if array is None:
            raise AttributeError(f"this simulation has no {name}")
        array = numpy().asarray(array)
        live = Named(array, self._scene.names(kind))
        self.__dict__[name] = live
        return live

    def __dir__(self) -> list[str]:
        arrays = [*COMPONENTS, *_INPUTS, "rest0"]
        return [*super().__dir__(), *(name for name in arrays if hasattr(self, name))]

    def __repr__(self) -> str:
        return f"<strut.Simulation of '{self._scene.name}' at {self.time:.6g} s>"

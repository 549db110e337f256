# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations: a run that Python advances."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Sequence

from . import _strut
from ._results import Run
from ._values import COMPONENTS, Frozen, Named, Words, fixed, numpy, parts_of, unknown

if TYPE_CHECKING:
    from ._scene import Scene


class Motion(Run):
    """A run under a controller: what any run is, but of one motion as it is, neither steady nor of a known accuracy.

    `energy.input_work` is the controller's part of `energy.drive_work`.
    """


def controlled(sim: Simulation, until: float, controller: Callable[[Simulation], object]) -> Motion:
    """Advances by single steps, before each of which the controller sets inputs."""
    try:
        while sim.time < until:
            controller(sim)
            sim.advance(1)
    except BaseException as error:
        error.result = sim.finish()  # type: ignore[attr-defined]
        raise
    return sim.finish()


_INPUTS = {"rest": "members", "actuators": "actuators", "load": "nodes", "rates": "actuators"}


class Held(Named):
    """Values of actuators: held["drive"] = value, or value, rate."""

    __slots__ = ("_rates",)

    def __init__(self, array: Any, names: Sequence[str], rates: Named) -> None:
        super().__init__(array, names)
        object.__setattr__(self, "_rates", rates)

    def __setitem__(self, key: Any, value: Any) -> None:
        value, rate = value if type(key) is str and type(value) is tuple else (value, 0.0)
        super().__setitem__(key, value)
        self._rates[key] = rate


class Simulation(Frozen):
    """A run that is advanced from outside, by one thread at a time.

    Arrays are live: they follow every advance; copy() what shall stay. They are the channels that a scene
    can record: position and velocity (nodes, 2), length and force (members), contact (contacts, 2), com.x, energy, ...
    Inputs are written at any time, and hold from the next advance on: rest (members) [m], actuators (in
    their unit; NAN: as the scene says), load (nodes, 2) [N]. Dampers do not see a value that only jumps: write an
    actuator's rate beside it, at which it then moves:

        sim.rest["m8"] = sim.rest0["m8"] + 0.3e-3
        sim.actuators["drive"] = 1e-3, 0.05
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

    def finish(self) -> Motion:
        """The run that simulation(record=True) was, up to its end or as far as it came. It stays where it is."""
        return Motion(self._raw.finish(), self._scene)

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
        names = self._scene.names(kind)
        live = Held(array, names, self.rates) if name == "actuators" else Named(array, names)
        self.__dict__[name] = live
        return live

    def __dir__(self) -> list[str]:
        arrays = [*COMPONENTS, *_INPUTS, "rest0"]
        return [*super().__dir__(), *(name for name in arrays if hasattr(self, name))]

    def __repr__(self) -> str:
        return f"<strut.Simulation of '{self._scene.name}' at {self.time:.6g} s>"

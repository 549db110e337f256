# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations: a run that Python advances."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Sequence

from . import _strut
from ._values import COMPONENTS, Frozen, Named, UnknownName, fixed, numpy, unknown

if TYPE_CHECKING:
    from ._scene import Scene

class Motion(Frozen):
    """What a run under a controller has recorded: `time` (samples) [s], and arrays of channels by name.

    motion["position"]["n1"] is (samples, 2); `velocity` is the mean one along x, of the centre of mass [m/s].
    """

    time: Any
    velocity: float
    _arrays: dict[str, Named]

    def __init__(self, time: Any, arrays: dict[str, Named], velocity: float) -> None:
        self.__dict__.update(time=time, velocity=velocity, _arrays=arrays)

    def __getitem__(self, channel: str) -> Named:
        arrays = self.__dict__.get("_arrays", {})  # none while it comes out of a pickle
        if channel not in arrays:
            raise UnknownName(unknown(channel, arrays, "channel"))
        return arrays[channel]  # type: ignore[no-any-return]

    def __getattr__(self, name: str) -> Named:
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(str(error)) from None

    def __repr__(self) -> str:
        return f"<strut.Motion: {len(self.time)} samples of {', '.join(self._arrays)}>"


def controlled(
    sim: Simulation, controller: Callable[[Simulation], object], until: float, channels: Sequence[str]
) -> Motion:
    """Advances by single steps, before each of which the controller sets inputs, and records after each."""
    time, rows = [], {name: [] for name in channels}  # type: ignore[var-annotated]
    begin, place = sim.time, getattr(sim, "com.x").copy()
    while sim.time < until - 0.5 * sim.step:
        controller(sim)
        sim.advance(1)
        time.append(sim.time)
        for name in channels:
            rows[name].append(getattr(sim, name).copy())
    arrays = {n: Named(fixed(each), getattr(sim, n).names, 1) for n, each in rows.items()}
    way = float((getattr(sim, "com.x") - place).sum())
    return Motion(fixed(time), arrays, way / (sim.time - begin))


_INPUTS = {"rest": "members", "actuators": "actuators", "load": "nodes"}


class Simulation(Frozen):
    """A run that is advanced from outside, by one thread at a time.

    `advance(steps)` makes steps; the bits do not depend on how steps are divided into calls. `snapshot()`
    returns all of the state, inputs too, and `restore(snapshot)` goes back to it.
    Arrays are live: they follow every advance; copy() what shall stay. They are the channels that a scene
    can record: position and velocity (nodes, 2), length and force (members), contact (contacts, 2), energy, ...
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

    def __getattr__(self, name: str) -> Named:
        # Only for arrays that were not read yet: they become attributes.
        if name in COMPONENTS:
            array, kind = self._raw.array(name), name
        elif name in _INPUTS:
            array, kind = self._raw.input(name), _INPUTS[name]
        elif name == "rest0":
            kind = "members"
            array = None if self._rest0 is None else fixed(self._rest0)
        else:
            raise AttributeError(unknown(name, [*COMPONENTS, *_INPUTS, "rest0", "advance"]))
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

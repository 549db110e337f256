# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as a model of MuJoCo (MJCF), in its plane x z.

A node is a body with a slide joint for each free coordinate, NODE.x and NODE.y, 0 where the run begins, and a site; a
member is a spatial tendon. Rest lengths that are driven, loads and forces of actuators are motors, whose controls are
the signals; those of constant loads are in the key frame "start".
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as xml
from typing import Any

from .. import Scene, loads
from . import Failure, number, shape, write_file

_CONTACTS = ("stiffness, damping and static friction of contacts: MuJoCo has its own soft contacts, which get the kinetic "
             "coefficient and may creep")  # fmt: skip
_SIGNALS = ("signals of actuators: their values are the controls, of a driven rest length its change in m (a driven cable "
            "then pushes where it would be slack, and an axial_stiffness does not follow the length)")  # fmt: skip
_RIGID = "rigid bars: they are constraints of MuJoCo, as stiff as its step allows"
_MASSES = "consistent masses of members: half of each is at either end, as with mass_model: lumped"
_DAMPERS = "dampers of cables act while these are slack, too"
_VARYING = "signals of loads: their values are the controls"
_CONSTANT = 'constant loads act where the controls of the key frame "start" are set'


def _refuse(words: dict[str, Any]) -> None:
    """What MJCF cannot express."""
    members, ground = words.get("members", {}).values(), words.get("ground", {})
    frictions = [each.get("friction", {}) for each in (ground, *ground.get("contacts", {}).values())]

    def special(m: dict[str, Any]) -> Any:
        law = m.get("law", {})
        return law.get("kind", "linear") != "linear" or (law.get("carries", "both") != "both" and m["kind"] != "cable")

    found = {
        "hinges and beams": "hinges" in words,
        "cells": "cells" in words,
        "collisions": "collisions" in words,
        "distances": "distances" in words,
        "feet": "feet" in words,
        "friction that follows a signal": any(isinstance(f.get("mu", 0), (dict, str)) for f in frictions),
        "grounds other than one line at rest": "grounds" in words or any(k in ground for k in ("profile", "circle", "motion")),
        "belts": ground.get("belt_speed", 0) != 0,
        "supports that move": any("moves" in n for n in words["nodes"].values() if isinstance(n, dict)),
        "moments": any("moment" in load for load in words.get("loads", {}).values()),
        "rotating masses": "unbalances" in words,
        "sliders": "sliders" in words,
        "sensors and controllers": any(key in words for key in ("sensors", "states", "oscillators", "controllers")),
        "Rayleigh's damping": "rayleigh" in words,
        "laws of members": any(map(special, members)),
        "springs over guides": any(len(m["nodes"]) > 2 and m["kind"] != "cable" for m in members),
        "stops": any("shortest" in m or "longest" in m for m in members),
        "members that break or are released": any("breaks_at" in m or "released_at" in m for m in members),
        "Maxwell branches": any("maxwell" in m for m in members),
        "friction at guides": any(m.get("guide_friction", 0) > 0 for m in members),
        "guides with a radius": any("guide_radius" in m for m in members),
        "damping ratios of running cables": any(len(m["nodes"]) > 2 and m.get("damping_ratio", 0) > 0 for m in members),
    }
    listed = ", ".join(name for name, there in found.items() if there)
    if listed:
        raise Failure(f"the scene has what MJCF is not written for: {listed}; leave it out to export the rest")


def _add(to: xml.Element, tag: str, **given: Any) -> xml.Element:
    """An element; None is left out, pairs of numbers have blanks between."""
    texts = {}
    for key, value in given.items():
        if value is not None:
            numbers = value if isinstance(value, (list, tuple)) else [value]
            texts[key] = value if isinstance(value, str) else " ".join(map(number, numbers))
    return xml.SubElement(to, tag, texts)


class _Writer:
    """A model of MuJoCo that grows; `notes` are what it does not say."""

    def __init__(self, scene: Scene) -> None:
        self.notes: list[str] = []
        self.words = words = loads(scene.to_yaml()).to_dict()  # with the start as positions
        _refuse(words)
        self.at, self.names = shape(scene, None), scene.names("nodes")
        self.stiffness = scene._raw.array("members.stiffness").tolist()
        self.members, self.solver = words.get("members", {}), words.get("solver", {})
        self.rigid = [m["kind"] == "bar" and words.get("bars") == "rigid" for m in self.members.values()]
        initial, drawn = words.get("initial", {}), dict(zip(self.names, self.at["position"]))
        self.start = drawn | initial.get("positions", {})
        self.velocity = dict.fromkeys(self.names, (0, 0)) | initial.get("velocities", {})
        held = ((name, n.get("fixed", "") if isinstance(n, dict) else "") for name, n in words["nodes"].items())
        self.fixed = {name: (word in ("x", "both"), word in ("y", "both")) for name, word in held}
        x, y = zip(*self.start.values())
        self.radius = 0.01 * (max(max(x) - min(x), max(y) - min(y)) or 1)  #: of what touches the ground
        self.ground, self.touching = words.get("ground"), scene.names("contacts")
        self.root = xml.Element("mujoco", model=words.get("name") or "structure")
        _add(self.root, "compiler", angle="radian", inertiafromgeom="false")
        gx, gy = words.get("gravity", (0, 0))
        method = "RK4" if self.solver.get("integrator", "").startswith("rk4") else "Euler"
        _add(self.root, "option", timestep=self.solver.get("step"), gravity=(gx, 0, gy), integrator=method)
        if words.get("mass_model") != "lumped" and any(m.get("mass", 0) > 0 for m in self.members.values()):
            self.notes.append(_MASSES)
        damped = (m.get("damping", 0) or m.get("damping_ratio", 0) for m in self.members.values() if m["kind"] == "cable")
        self.notes += [_DAMPERS] * any(damped)

    def world(self) -> None:
        world = _add(self.root, "worldbody")
        if self.ground:
            self.notes.append(_CONTACTS)
            slope = self.ground.get("slope", 0)
            x, y = self.ground.get("through", (0, self.ground.get("height", 0)))
            place = x + self.radius * math.sin(slope), 0, y - self.radius * math.cos(slope)
            _add(world, "geom", name="ground", type="plane", contype="0", conaffinity="1", pos=place,
                 euler=(0, -slope, 0), size=(0, 0, 1))  # fmt: skip
        for name, mass in zip(self.names, self.at["weight"]):
            body = _add(world, "body", name=name, pos=(self.start[name][0], 0, self.start[name][1]))
            for fixed, axis, way in zip(self.fixed[name], "xy", ("1 0 0", "0 0 1")):
                if not fixed:
                    _add(body, "joint", name=f"{name}.{axis}", type="slide", axis=way)
            if not all(self.fixed[name]):
                if not mass > 0:
                    raise Failure(f"node '{name}' has no mass, which MuJoCo wants of each body that moves")
                _add(body, "inertial", pos="0 0 0", mass=mass, diaginertia=[mass * self.radius**2] * 3)
            if self.ground and name in self.touching:
                own = self.ground.get("contacts", {}).get(name, {}).get("friction", self.ground.get("friction", {}))
                _add(body, "geom", type="sphere", contype="1", conaffinity="0", size=self.radius,
                     friction=(own.get("mu_kinetic", 0), 0.005, 0.0001))  # fmt: skip
            _add(body, "site", name=name)

    def tendons(self) -> None:
        tendons = _add(self.root, "tendon") if self.members else self.root
        rigid = _add(self.root, "equality") if any(self.rigid) else self.root
        self.notes += [_RIGID] * any(self.rigid)
        for i, (name, member) in enumerate(self.members.items()):
            rest, given = self.at["rest_length"][i], dict[str, Any]()
            if self.rigid[i]:  # as stiff as the step allows; 0.002 is MuJoCo's own
                stiff = 2 * self.solver.get("step", 0.002), 1
                _add(rigid, "tendon", tendon1=name, solref=stiff, solimp="0.9999 0.9999 0.001")
            else:
                given = {"stiffness": self.stiffness[i], "damping": self.at["damping_coefficient"][i] or None}
                given["springlength"] = (0, rest) if member["kind"] == "cable" else rest
            tendon = _add(tendons, "spatial", name=name, **given)
            for node in member["nodes"]:
                _add(tendon, "site", site=node)

    def motors(self) -> None:
        """Drives and loads, and what they are and how fast nodes move where the run begins."""
        drives, loads = self.words.get("actuators", {}), self.words.get("loads", {})
        motors, controls = xml.Element("actuator"), list[float]()
        for name, drive in drives.items():
            stiffness = self.stiffness[list(self.members).index(drive["member"])]
            _add(motors, "motor", name=name, tendon=drive["member"], gear=stiffness if "signal" in drive else -1)
            controls.append(0)
        for name, load in loads.items():
            for force, fixed, axis in zip(load["force"], self.fixed[load["node"]], "xy"):
                if force and not fixed:
                    _add(motors, "motor", name=f"{name}.{axis}", joint=f"{load['node']}.{axis}", gear=force)
                    controls.append("signal" not in load)
        self.notes += [_SIGNALS] * bool(drives)
        self.notes += [_VARYING] * any("signal" in load for load in loads.values())
        self.notes += [_CONSTANT] * any("signal" not in load for load in loads.values())
        if controls:
            self.root.append(motors)
        free = [v for name in self.names for v, fixed in zip(self.velocity[name], self.fixed[name]) if not fixed]
        if any(free) or controls:
            key = _add(self.root, "keyframe")
            _add(key, "key", name="start", qvel=free if any(free) else None, ctrl=controls or None)


def write(scene: Scene, path: str) -> list[str]:
    """Returns what the file does not say."""
    writer = _Writer(scene)
    writer.world()
    writer.tendons()
    writer.motors()
    xml.indent(writer.root)
    text = xml.tostring(writer.root, "unicode", short_empty_elements=True)
    write_file(path, f"<!-- Written by strut: plane x z, SI units. -->\n{text}\n")
    return writer.notes

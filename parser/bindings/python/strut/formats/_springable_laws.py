# SPDX-License-Identifier: GPL-3.0-or-later
"""springable's expressions and behaviours as those of a scene."""

from __future__ import annotations

import json
import re
from typing import NoReturn, Sequence

from .. import SceneError, loads
from . import number
from ._draft import Source, Wrong, own_name

_WORDS = {"PI": "pi", "ARCSIN": "asin", "ARCCOS": "acos", "ARCTAN": "atan"}
_WORDS |= {word: word.lower() for word in ("SIN", "COS", "TAN", "SQRT", "EXP", "LOG", "ABS")}
_NOTHING = 1e-3  #: of the second stiffness: a first one below is that of a slack cable


class Skip(Exception):
    """What a scene cannot say: text and number of the field."""


def split(text: str, separator: str) -> list[tuple[str, int]]:
    """Parts between separators outside of brackets, without blanks at their ends, and where they begin."""
    parts, begin, depth = [], 0, 0
    for i, c in enumerate(text + separator):
        depth += (c in "([{") - (c in ")]}")
        if c == separator and (depth <= 0 or i == len(text)):
            part = text[begin:i]
            parts.append((part.strip(), begin + len(part) - len(part.lstrip())))
            begin = i + 1
    return parts


def _evaluate(text: str, parameters: dict[str, float]) -> float:
    """As a scene does; SceneError where it cannot."""
    lines = [f"  {name}: {number(value)}" for name, value in parameters.items()]
    lines = ["parameters:", *lines] if lines else []
    load = "loads: {l: {node: a, force: [%s, 0]}}" % json.dumps(text)
    scene = loads("\n".join(["strut: 1", *lines, "nodes: {a: {position: [0, 0], mass: 1}}", load]))
    return float(scene.to_dict()["loads"]["l"]["force"][0])


def _refused(names: Sequence[str], lines: Sequence[str]) -> set[str]:
    """The names whose line under `parameters` strut refuses."""
    try:
        loads("\n".join(["strut: 1", "parameters:", *lines, "nodes: {a: {position: [0, 0], mass: 1}}"]))
        return set()
    except SceneError as error:
        return {names[each.line - 3] for each in error.messages if 0 <= each.line - 3 < len(names)}


def _taken(text: str) -> set[str]:
    """Names of parameters that are those of units, functions or words of YAML."""
    found = re.findall(r"^[ \t]*([A-Za-z_]\w*)[ \t]*,", text, re.ASCII | re.MULTILINE)
    names = list(dict.fromkeys(found))
    units = set(names) - _refused(names, [f"  u{i}: 1 {name}" for i, name in enumerate(names)])
    quoted = {name for name in names if own_name(name) != name}
    return quoted | units | _refused(names, [f"  {own_name(name)}: 1" for name in names])


class Line:
    """A line's fields, with what they mean to a scene; the behaviour is the second field."""

    def __init__(self, source: Source) -> None:
        self.source, self.line = source, 1
        self.fields: list[tuple[str, int]] = []
        self.taken = _taken(source.text)
        self.own: dict[str, str] = {}  #: of parameters, by their names in the file
        self.values: dict[str, float] = {}  #: by own names
        self.points: dict[int, tuple[float, float, bool]] = {}  #: x, y, whether both are held

    def text(self, i: int) -> str:
        return self.fields[i][0] if i < len(self.fields) else ""

    def place(self, i: int) -> tuple[int, int]:
        return self.line, self.fields[i][1] + 1 if i < len(self.fields) else 1

    def error(self, i: int, text: str) -> NoReturn:
        raise Wrong(self.source, self.place(i), text)

    def note(self, i: int, text: str) -> None:
        self.source.note(self.place(i), text)

    def expression(self, i: int, text: str | None = None) -> tuple[str, float]:
        """An expression as a scene's, or its number where it names coordinates of nodes, and its value."""
        text = self.text(i) if text is None else text
        fixed = False

        def word(found: re.Match[str]) -> str:
            nonlocal fixed
            name = found[0]
            point = self.points.get(int(name[1:])) if re.fullmatch(r"[XY]\d{1,9}", name) else None
            if name in self.own or point is None:
                return self.own.get(name, _WORDS.get(name, name))
            fixed = True
            return f"({number(point[name[0] == 'Y'])})"

        own = re.sub(r"(?<![\d.])[A-Za-z_]\w*", word, text.replace("**", "^"), flags=re.ASCII)
        own = re.sub(r"\.(?!\d)", ".0", own)  # "1."
        try:
            value = _evaluate(own, self.values)
        except SceneError as error:
            why = error.messages[0].text if error.messages else error.message
            self.error(i, f"'{text:.60}' is no expression of the parameters: {why}")
        return number(value) if fixed else own, value

    def stiffness(self) -> str | None:
        """That of "k", "k=3" or "LINEAR(k=3)"; None: the behaviour is another."""
        text = self.text(1)
        if text.startswith("LINEAR(") and text.endswith(")"):
            text = text[7:-1]
        text = re.sub(r"^k *=", "", text).strip()
        if not text:
            self.error(1, "expected a mechanical behaviour")
        return None if re.search("[;=]", text) else self.expression(1, text)[0]

    def behaviour(self) -> tuple[str, dict[str, str]]:
        """Its name and its arguments."""
        name, _, rest = self.text(1).partition("(")
        parts = (part.partition("=") for part, _ in split(rest.removesuffix(")"), ";"))
        return name, {key.strip(): value.strip() for key, _, value in parts}

    def skip(self) -> NoReturn:
        text = f"an element with the behaviour '{self.text(1):.40}'; see 'law' of members and hinges"
        raise Skip(text, 1)

    def _list(self, text: str) -> list[float]:
        if text[:1] + text[-1:] != "[]":
            self.skip()
        return [self.expression(1, part)[1] for part, _ in split(text[1:-1], ";")]

    def curve(self) -> str:
        """A PIECEWISE or ZIGZAG behaviour as a table; BEZIER, BEZIER2 or ZIGZAG2 as a curve, which may fold back."""
        name, given = self.behaviour()
        if name not in ("PIECEWISE", "ZIGZAG", "BEZIER", "BEZIER2", "ZIGZAG2"):
            self.skip()
        u, f = [0.0, *self._list(given.get("u_i", ""))], [0.0]
        if name == "PIECEWISE":
            u.append(2 * u[-1])
            slopes = self._list(given.get("k_i", ""))
            for slope, a, b in zip(slopes, u, u[1:]):
                f.append(f[-1] + slope * (b - a))
            f += [0.0] * (len(slopes) >= len(u))  # too many
        else:
            f += self._list(given.get("f_i", ""))
        if len(u) != len(f):
            self.skip()
        side = int(given["mode"]) if re.fullmatch(r"[-+]?\d+", given.get("mode", "")) else 0
        points, mirrored = list(zip(u, f)), [(-x, -y) for x, y in zip(u, f)][::-1]
        if name in ("PIECEWISE", "ZIGZAG"):
            if any(b <= a for a, b in zip(u, u[1:])):
                self.skip()  # it folds back
            self.note(1, "rounded corners of a behaviour become sharp ones of a table")
            points = mirrored[-2 if side > 0 else 0 : -1] + points[: 2 if side < 0 else None]
            kind, end = "table, points", ""
        else:
            points = mirrored if side < 0 else points
            kind = "curve, control_points" if name.startswith("BEZIER") else "curve, points"
            rounding = self.expression(1, given.get("epsilon", ""))[1] if name == "ZIGZAG2" else 0
            end = f", rounding: {number(rounding)}" * (rounding > 0) + ", mirrored: yes" * (side == 0)
        listed = ", ".join(f"[{number(x)}, {number(y)}]" for x, y in points)
        return f", law: {{kind: {kind}: [{listed}]{end}}}"

    def law(self, rest: str) -> str:
        stiffness = self.stiffness()
        return rest + self.curve() if stiffness is None else f", stiffness: {stiffness}{rest}"

    def two_pieces(self, running: bool, rest: str) -> str | None:
        """A cable where the first piece is as good as none: slack below the knee. Along a path a bilinear law."""
        name, given = self.behaviour()
        pieces, knees = (split(given.get(key, "")[1:-1], ";") for key in ("k_i", "u_i"))
        if name != "PIECEWISE" or len(pieces) != 2 or len(knees) != 1:
            return None
        (first, low), (second, high), (knee, _) = (self.expression(1, part) for part, _ in pieces + knees)
        slack = low <= _NOTHING * high
        if not running and (not slack or "mode" in given):  # a table says what it does on one side
            return None
        if not slack:
            self.note(1, "two pieces become a bilinear law, whose knee is sharp")
            law = f"law: {{kind: bilinear, knee: {knee}, second_stiffness: {second}}}"
            return f"kind: spring, nodes: NODES, stiffness: {first}{rest}, {law}"
        below = "" if rest else ", slack below its drawn length"
        self.note(1, f"a spring that is nearly slack up to a knee becomes a cable{below}")
        return f"kind: cable, nodes: NODES, stiffness: {second}" + (f"{rest} + {knee}" if rest else "")

    def contact(self) -> str:
        """CONTACT(f0; uc; delta): the force f0 ((delta - d) / uc)^3 pushes below the distance delta."""
        name, given = self.behaviour()
        if name != "CONTACT":
            return ""
        force, width, distance = (self.expression(1, given.get(key, ""))[0] for key in ("f0", "uc", "delta"))
        law = f'kind: polynomial, coefficients: [0, 0, "({force}) / ({width})^3"], carries: compression'
        return f", rest_distance: {distance}, law: {{{law}}}"

    def gas(self, drawn: float) -> str:
        """ISOTHERMAL(n; R; T0) or ISENTROPIC(...; gamma): a gas at the pressure n R T0 / v0 around it, v0 natural."""
        name, given = self.behaviour()
        if name not in ("ISOTHERMAL", "ISENTROPIC"):
            return ""
        amount, gas, heat = (self.expression(1, given.get(key, ""))[1] for key in ("n", "R", "T0"))
        exponent = self.expression(1, given.get("gamma", ""))[1] if name == "ISENTROPIC" else 1.0
        natural = self.expression(2)[1] if self.text(2) else drawn
        if not (drawn > 0 and natural > 0):
            self.skip()
        outside = amount * gas * heat / natural
        inside = outside * (natural / drawn) ** exponent
        end = f", exponent: {number(exponent)}" if name == "ISENTROPIC" else ""
        return f", gas: {{kind: {name.lower()}, pressure: {number(inside)}, outside: {number(outside)}{end}}}"

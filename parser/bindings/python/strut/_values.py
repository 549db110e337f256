# SPDX-License-Identifier: GPL-3.0-or-later
"""Values: Python's to texts of the language, texts to numbers, arrays with names."""

from __future__ import annotations

import functools
import inspect
import itertools
import json
import operator
import os
from typing import TYPE_CHECKING, Any, Callable, Container, Iterable, Iterator, Mapping, Sequence

from . import _strut

if TYPE_CHECKING:
    import numpy as np

#: the components of each channel: ("x", "y") of "position"
COMPONENTS = {name: components for name, _, components, _ in _strut.channels()}
Value = float | str  #: a number [SI], or a text with a unit
Values = Value | Sequence[Value]
Pairs = tuple[tuple[str, ...], tuple[str, ...]]


def refuse_bytes(value: object) -> None:
    """Bytes are no text, though they are iterable and float() takes them."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        raise TypeError(f"a number or a text is needed, not {type(value).__name__}")


def text(value: object) -> str:
    """A setting or an option as the program takes it: numbers in SI, texts as they are."""
    if isinstance(value, str):
        return value
    refuse_bytes(value)
    if isinstance(value, bool) or type(value).__name__ == "bool_":  # numpy's, too
        return "yes" if value else "no"
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    try:
        return str(operator.index(value))  # type: ignore[arg-type]
    except TypeError:
        pass
    if hasattr(value, "__float__"):
        return repr(float(value))
    if isinstance(value, Iterable):
        return ",".join(text(item) for item in value)
    raise TypeError(f"a number or a text is needed, not {type(value).__name__}")


def settings(mapping: Mapping[str, object] | None, more: Mapping[str, object]) -> Pairs:
    """Settings of parameters as names and texts."""
    merged = {**(mapping or {}), **more}
    return tuple(merged), tuple(text(value) for value in merged.values())


#: arguments whose names the library spells in another way
_SPELLED = {"from_": "from"}


def argument(option: str) -> str:
    """The argument that an option of the library is."""
    return next((own for own, name in _SPELLED.items() if name == option), option.replace("-", "_"))


def options(given: Mapping[str, object], spelled: Container[str] = ()) -> Pairs:
    """Arguments as the library's options: mass_model is mass-model, those that are None are not given."""
    there = {
        name if name in spelled else _SPELLED.get(name, name.replace("_", "-")): value
        for name, value in given.items()
        if value is not None
    }
    return tuple(there), tuple(text(value) for value in there.values())


def numpy() -> Any:
    """numpy, which only arrays need."""
    try:
        import numpy
    except ImportError as error:
        raise ImportError("arrays need numpy: pip install numpy, or Debian's python3-numpy") from error
    return numpy


def fixed(array: Any) -> Any:
    """A copy that is read-only, as all arrays of results."""
    copy = numpy().array(array)
    copy.flags.writeable = False
    return copy


class UnknownName(KeyError):
    """A KeyError whose text is a sentence, shown without quotes."""

    __str__ = Exception.__str__


class Frozen:
    """An object whose attributes cannot be set."""

    __slots__ = ()

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} objects do not change: cannot set '{name}'")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} objects do not change: cannot delete '{name}'")


class Words(Frozen, dict[str, Any]):
    """A dictionary that does not change, whose items are attributes, too: run.energy.residual.

    `dict(words)` is a copy that can be changed. Lists within are tuples.
    """

    __slots__ = ()

    def __missing__(self, name: str) -> Any:
        raise UnknownName(unknown(str(name), self))

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(str(error)) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)

    def _refuse(self, *_: object, **__: object) -> Any:
        raise TypeError(f"{type(self).__name__} objects do not change; dict(...) makes a copy that can")

    __setitem__ = __delitem__ = clear = pop = popitem = setdefault = update = _refuse  # type: ignore
    __ior__ = _refuse  # type: ignore[assignment]


def words(text: str) -> Words:
    """The object that a JSON text is, as Words; lists are tuples."""

    def fixed(value: Any) -> Any:
        return tuple(map(fixed, value)) if isinstance(value, list) else value

    def each(item: dict[str, Any]) -> Words:
        return Words({name: fixed(value) for name, value in item.items()})

    found: Words = json.loads(text, object_hook=each)
    return found


#: names that people write for others
_MEANT = {
    **dict.fromkeys(("dt", "time_step", "timestep"), "step"),
    **dict.fromkeys(("method", "solver"), "integrator"),
    **dict.fromkeys(("t", "t_end", "tend", "time", "until"), "duration"),
    **dict.fromkeys(("n_jobs", "workers"), "threads"),
    **dict.fromkeys(("rtol", "tol"), "tolerance"),
}


def unknown(name: str, known: Iterable[str], what: str = "name") -> str:
    """A sentence for a name that is not there, with those that may have been meant."""
    import difflib

    names = list(dict.fromkeys(one for one in known if not one.startswith("_")))
    close = [_MEANT[name]] if _MEANT.get(name) in names else difflib.get_close_matches(name, names, 3)
    if close:
        return f"no {what} '{name}'; did you mean {' or '.join(map(repr, close))}?"
    listed = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    return f"no {what} '{name}'" + (f"; there are {listed}" if names else "")


def hinted(function: Any) -> Any:
    """The function, whose error for an unknown keyword has those that may have been meant."""
    code = function.__code__
    known = [name for name in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount] if name != "self"]
    if code.co_flags & inspect.CO_VARKEYWORDS:  # it looks at them itself
        return function

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        for name in named:
            if name not in known:
                _, near, names = unknown(name, known).partition("; ")
                raise TypeError(f"{function.__name__}() got an unexpected keyword argument '{name}'{near}{names}")
        return function(*given, **named)

    return call


def parts_of(name: str, channels: Iterable[str]) -> dict[str, str]:
    """The channels that begin with a name and a dot, by what follows: "com.x" of "com" by "x"."""
    return {channel.removeprefix(f"{name}."): channel for channel in channels if channel.startswith(f"{name}.")}


def all_parts(channels: Values | None) -> list[str] | None:
    """Channels, of which "com" is all that begin so: com.x, com.y, ..."""
    if channels is None:
        return None
    names = text(channels).split(",")
    return [part for n in names for part in parts_of(n, () if n in COMPONENTS else COMPONENTS).values() or [n]]


def unrecorded(name: str, things: Callable[[str], Sequence[str]]) -> str | None:
    """The reason why a run lacks a channel; None: no channel has that name."""
    kind = next((kind for channel, kind, _, _ in _strut.channels() if name in (channel, channel.split(".")[0])), None)
    if kind is None:
        return None
    if kind != "run" and not things(kind):
        return f"no '{name}': the scene has no {kind}"
    return f"'{name}' was not recorded: run(channels=['{name}'])"


class Named(Frozen):
    """A numpy array one axis of which has names: force["m8"], force[0], force.max().

    Whatever numpy's arrays can do it can, too; `array` is the array itself.
    """

    __slots__ = ("array", "names", "_axis", "_index", "_parts")

    array: np.ndarray[Any, Any]
    names: tuple[str, ...]
    _axis: int
    _index: dict[str, int]
    _parts: dict[str, Any]

    def __init__(self, array: Any, names: Sequence[str], axis: int = 0) -> None:
        own = object.__setattr__
        own(self, "array", array)
        own(self, "names", tuple(names))
        own(self, "_axis", axis)
        own(self, "_index", {name: i for i, name in enumerate(self.names)})
        own(self, "_parts", {})  # views, so that a name costs one look-up

    def _part(self, name: str) -> Any:
        """The view behind a name."""
        try:
            i = self._index[name]
        except KeyError:
            raise UnknownName(unknown(name, self.names)) from None
        part = self.array[(slice(None),) * self._axis + (i,)]
        if part.ndim:  # a lone number would be a copy
            self._parts[name] = part
        return part

    def __getitem__(self, key: Any) -> Any:
        if type(key) is str:
            part = self._parts.get(key)
            return self._part(key) if part is None else part
        return self.array[key]

    def __setitem__(self, key: Any, value: Any) -> None:
        if type(key) is str:
            try:
                key = (slice(None),) * self._axis + (self._index[key],)
            except KeyError:
                raise UnknownName(unknown(key, self.names)) from None
        self.array[key] = value

    def items(self) -> Iterator[tuple[str, Any]]:
        """Pairs of a name and its part of the array."""
        return ((name, self._part(name)) for name in self.names)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __len__(self) -> int:
        return len(self.array)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.array)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name in Named.__slots__:
            raise AttributeError(name)
        return getattr(self.array, name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(name for name in dir(self.array) if not name.startswith("__"))]

    def __repr__(self) -> str:
        shown = ", ".join(self.names[:4]) + (", ..." if len(self.names) > 4 else "")
        return f"<strut array {self.array.shape} of {shown}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Named, (self.array.copy(), self.names, self._axis)


def _forward(name: str) -> Callable[..., Any]:
    def method(self: Named, *others: Any) -> Any:
        plain = [other.array if isinstance(other, Named) else other for other in others]
        return getattr(self.array, name)(*plain)

    method.__name__ = name
    return method


for _operator in "add sub mul truediv floordiv mod pow matmul".split():
    setattr(Named, f"__{_operator}__", _forward(f"__{_operator}__"))
    setattr(Named, f"__r{_operator}__", _forward(f"__r{_operator}__"))
for _operator in "neg pos abs lt le gt ge eq ne".split():
    setattr(Named, f"__{_operator}__", _forward(f"__{_operator}__"))
Named.__hash__ = None  # type: ignore[assignment]  # as of arrays


def from_words(value: Any, path: Sequence[str]) -> Any:
    """The array behind a dotted name of a JSON: lists on the way are dimensions, gaps are NAN.

    The library has the same (strutlib_result_array); this is for results that came out of a pickle.
    """

    def walk(at: Any, rest: Sequence[str]) -> Any:
        inner = isinstance(at, Mapping)
        if isinstance(at, list) or (inner and not rest):
            return [walk(item, rest) for item in (at.values() if inner else at)]
        if inner:
            names = (".".join(rest[:i]) for i in range(len(rest), 0, -1))  # names may have dots
            name = next((name for name in names if name in at), None)
            return walk(at[name], rest[1 + name.count(".") :]) if name is not None else None
        return None if rest or isinstance(at, (str, bool)) else at

    nested = walk(value, path)
    return fixed(_padded(nested)) if isinstance(nested, list) else None


def _padded(at: Any) -> Any:
    """The array of nested lists, short ones filled up with NAN; None is NAN."""
    if not isinstance(at, list):
        return numpy().array(at, float)
    parts = [_padded(item) for item in at]
    sizes = itertools.zip_longest(*(part.shape for part in parts), fillvalue=0)
    whole = numpy().full((len(parts), *map(max, sizes)), float("nan"))
    for i, part in enumerate(parts):
        whole[(i, *map(slice, part.shape))] = part
    return whole

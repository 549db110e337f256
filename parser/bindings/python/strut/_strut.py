# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects around the handles of libstrut.so.0 (parser/bindings/abi/abi.h), by ctypes. It converts and checks;
names, tables and everything for people are in the package's other files.

An object keeps what it was made of: an array lives as long as somebody looks at it, and with it the handle that
owns its numbers.
"""

from __future__ import annotations

import ctypes
import operator
import os
import pathlib
import threading
import time
from array import array as doubles
from ctypes import byref, c_char_p, c_double, c_int, c_long, c_size_t, c_void_p
from typing import Any, Callable, Iterator, Sequence

from . import _errors

Progress = Callable[[float], object]

_LIBRARY = ctypes.CDLL(os.fspath(pathlib.Path(__file__).with_name("libstrut.so.0")))
_ABI_VERSION = 2
_LOOK, _PIECE = 0.05, 5e-3  # s: how often signals are looked for in calls and while a simulation is advanced
_BUSY = "another thread is advancing this simulation; one simulation per thread"
_NOTE = ctypes.CFUNCTYPE(c_int, c_void_p, c_double)


# ---- calls ----


def _bytes(text: str | None) -> bytes:
    if not isinstance(text, str):
        raise TypeError(f"a text is needed, not {text!r}")
    return _whole(text.encode())


def _whole(text: bytes) -> bytes:
    if b"\0" in text:
        raise ValueError("a text holds the character NUL")
    return text


def _texts(texts: Sequence[str | None]) -> Any:
    """A `const char *const *`; None is NULL."""
    return (c_char_p * len(texts))(*(None if text is None else _bytes(text) for text in texts))


def _pairs(names: Sequence[str], values: Sequence[str]) -> tuple[int, Any, Any]:
    """Settings or options as three arguments."""
    if len(names) != len(values):
        raise ValueError("as many values as names are needed")
    return len(names), _texts(names), _texts(values)


def _decode(text: bytes | None) -> Any:
    return None if text is None else text.decode("utf-8", "surrogateescape")


#: what the functions take: a handle or a pointer, bytes, a size, an int, a long
_ARGUMENTS = {"p": c_void_p, "s": c_char_p, "n": c_size_t, "i": c_int, "l": c_long}
#: what they return; "t" is a text of the library's, "o" one of the caller's
_RETURNED = {"v": None, "p": c_void_p, "t": c_char_p, "o": c_void_p, "n": c_size_t, "i": c_int, "d": c_double}


def _function(name: str, returned: str, arguments: str = "") -> Any:
    """strutlib_NAME. With "!" behind the arguments it takes an error, too, which it raises where it returns nothing."""
    function = getattr(_LIBRARY, "strutlib_" + name)
    function.argtypes = [_ARGUMENTS[kind] for kind in arguments.rstrip("!")]
    function.restype = _RETURNED[returned]
    if arguments.endswith("!"):
        function.argtypes = [*function.argtypes, c_void_p]

        def fallible(*given: Any) -> Any:
            error = c_void_p()
            found = function(*given, byref(error))
            if not found:
                raise _exception(error.value)
            return _own(found) if returned == "o" else found

        return fallible
    return function if returned != "t" else lambda *given: _decode(function(*given))


def _own(text: int) -> Any:
    """A text that belongs to the caller."""
    copy = _decode(ctypes.string_at(text))
    _release(text)
    return copy


def _until_none(function: Callable[..., Any], *given: Any) -> Iterator[Any]:
    """function(..., 0), function(..., 1), ... before None."""
    i = 0
    while (item := function(*given, i)) is not None:
        yield item
        i += 1


_release = _function("release", "v", "p")
_error_status = _function("error_status", "i", "p")
_error_message = _function("error_message", "t", "p")
_error_report = _function("error_report", "t", "p")
_error_count = _function("error_count", "n", "p")
_error_free = _function("error_free", "v", "p")
_located = [
    _function(f"error_{part}", "n" if part in ("line", "column", "length") else "t", "pn")
    for part in ("file", "line", "column", "length", "text", "source", "hint", "key")
]
_status_name = _function("status_name", "t", "i")


def _exception(error: int | None) -> BaseException:
    """The exception for an error, which is freed."""
    if error is None:  # the library could not even say why
        return MemoryError()
    messages = [tuple(part(error, i) for part in _located) for i in range(_error_count(error))]
    name = _status_name(_error_status(error))
    exception = _errors.make(name, _error_message(error), _error_report(error), messages)
    _error_free(error)
    return exception


class _Handle:
    """An object of the library, freed with this one."""

    _free: Callable[[int | None], None]
    _handle: int | None

    def __init__(self, handle: int | None) -> None:
        self._handle = handle

    def __del__(self) -> None:
        self._free(self.__dict__.get("_handle"))


class _Control(_Handle):
    """Interrupts calls and tells their progress."""

    _free = _function("control_free", "v", "p")
    _create = _function("control_create", "p")
    _interrupt = _function("interrupt", "v", "p")
    _on_progress = _function("control_on_progress", "v", "ppp")

    def __init__(self) -> None:
        super().__init__(_Control._create())
        if self._handle is None:
            raise MemoryError

    def wait(self, call: Callable[[], Any], progress: Progress | None) -> BaseException | None:
        """Makes the call in a thread of its own, and returns when it has; returns what signals or `progress` raised.

        Python runs the handlers of signals between two of its own instructions only, and only in the thread that
        began the program: so Ctrl-C ends everything within a moment, also what reports no progress.
        """
        done, fraction, raised = threading.Event(), [0.0], None

        def compute() -> None:
            try:
                call()
            finally:
                done.set()

        def note(_: object, reached: float) -> int:
            fraction[0] = reached
            return 0

        callback = _NOTE(note)
        if progress is not None:
            _Control._on_progress(self._handle, callback, None)
        thread = threading.Thread(target=compute)
        thread.start()
        while not done.is_set():
            try:
                if not done.wait(_LOOK if raised is None else None) and progress is not None:
                    progress(fraction[0])
            except BaseException as error:
                raised = raised or error
                _Control._interrupt(self._handle)
        thread.join()
        _Control._on_progress(self._handle, None, None)
        return raised


class Array:
    """Doubles as numpy sees them, without a copy."""

    def __init__(self, owner: object, data: int, shape: list[int], stride: list[int], read_only: bool) -> None:
        self.owner, self.shape, self.stride = owner, shape, stride
        self.__array_interface__: dict[str, Any] = {
            "version": 3,
            "typestr": "<f8",
            "data": (data, read_only),
            "shape": tuple(shape),
            "strides": tuple(8 * step for step in stride),
        }

    def tolist(self) -> Any:
        """Lists of numbers; they are a copy."""
        if 0 in self.shape:
            return []
        span = 1 + sum((count - 1) * step for count, step in zip(self.shape, self.stride))
        numbers = doubles("d", ctypes.string_at(self.__array_interface__["data"][0], 8 * span))

        def part(at: int, axis: int) -> Any:
            if axis == len(self.shape):
                return numbers[at]
            return [part(at + i * self.stride[axis], axis + 1) for i in range(self.shape[axis])]

        return part(0, 0)


def _array(function: Any, owner: _Handle, name: str, read_only: bool = True) -> Any:
    data, dimensions, shape, stride = c_void_p(), c_int(), (c_size_t * 4)(), (c_size_t * 4)()
    if not function(owner._handle, _bytes(name), byref(data), byref(dimensions), shape, stride):
        return None
    count = dimensions.value
    return Array(owner, data.value or 0, shape[:count], stride[:count], read_only)


# ---- what a call returns ----


class Result(_Handle):
    """A strutlib_result: made empty, filled by a scene's call."""

    _free = _function("result_free", "v", "p")
    _status = _function("result_status", "i", "p")
    _array = _function("result_array", "i", "pspppp")
    _unit = _function("result_array_unit", "t", "ps")
    _cell = _function("result_cell", "t", "psn")
    _yaml = _function("result_yaml", "o", "p!")
    _svg = _function("result_svg", "o", "pnpp!")
    _html = _function("result_html", "o", "p!")
    _command, _json, _table = (_function(f"result_{part}", "t", "p") for part in ("command", "json", "table"))
    _warning, _array_name, _column = (
        _function(f"result_{part}", "t", "pn") for part in ("warning", "array_name", "column")
    )

    def __init__(self) -> None:
        super().__init__(None)

    def __bool__(self) -> bool:
        return self._handle is not None

    def _filled(self) -> int:
        if self._handle is None:
            raise ValueError("there is no result")
        return self._handle

    def command(self) -> str:
        return Result._command(self._filled())  # type: ignore[no-any-return]

    def status(self) -> str:
        return _status_name(Result._status(self._filled()))  # type: ignore[no-any-return]

    def json(self) -> str:
        return Result._json(self._filled())  # type: ignore[no-any-return]

    def table(self) -> str:
        return Result._table(self._filled())  # type: ignore[no-any-return]

    def warnings(self) -> list[str]:
        return list(_until_none(Result._warning, self._filled()))

    def array(self, name: str) -> Any:
        self._filled()
        return _array(Result._array, self, name)

    def array_names(self) -> list[str]:
        return list(_until_none(Result._array_name, self._filled()))

    def columns(self) -> list[str]:
        return list(_until_none(Result._column, self._filled()))

    def unit(self, name: str) -> str | None:
        return Result._unit(self._filled(), _bytes(name))  # type: ignore[no-any-return]

    def words(self, column: str, count: int) -> list[str | None]:
        """The texts of a sweep's column, one per point."""
        return [Result._cell(self._filled(), _bytes(column), i) for i in range(count)]

    def yaml(self) -> str:
        return Result._yaml(self._filled())  # type: ignore[no-any-return]

    def svg(self, names: tuple[str, ...], values: tuple[str, ...]) -> str:
        return Result._svg(self._filled(), *_pairs(names, values))  # type: ignore[no-any-return]

    def html(self) -> str:
        return Result._html(self._filled())  # type: ignore[no-any-return]


class Snapshot(_Handle):
    """A strutlib_snapshot."""

    _free = _function("snapshot_free", "v", "p")

    def __init__(self, handle: int, simulation: Simulation) -> None:
        super().__init__(handle)
        self._simulation = simulation  # kept, so that no other one takes its place in memory


class Simulation(_Handle):
    """A strutlib_simulation. Many steps are divided into pieces of some milliseconds, between which Python looks for
    signals; the bits do not depend on that."""

    _free = _function("simulation_close", "v", "p")
    _advance = _function("simulation_advance", "i", "plp")
    _array = _function("simulation_array", "i", "pspppp")
    _input = _function("simulation_input", "i", "pspppp")
    _snapshot = _function("simulation_snapshot", "p", "p!")
    _restore = _function("simulation_restore", "i", "ppp")
    _time, _step, _work = (_function(f"simulation_{part}", "d", "p") for part in ("time", "step", "input_work"))

    def __init__(self, handle: int, control: _Control) -> None:
        super().__init__(handle)
        self._control = control
        self._step_time = _PIECE  # s of one step as last measured: nothing is known, one step at first
        self._lock = threading.Lock()  # held while a thread advances it

    def _idle(self) -> int | None:
        if self._lock.locked():
            raise RuntimeError(_BUSY)
        return self._handle

    def advance(self, steps: int, /) -> None:
        left, error = operator.index(steps), c_void_p()
        if left < 0:
            raise ValueError("the number of steps is negative")
        if left >= 2**63:
            raise OverflowError("so many steps are never done")
        if not self._lock.acquire(blocking=False):
            raise RuntimeError(_BUSY)
        try:
            while left > 0:
                piece = max(1, min(left, int(_PIECE / self._step_time)))
                begin = time.perf_counter()
                failed = Simulation._advance(self._handle, piece, byref(error))
                # A step that met the scheduler shall not make all later pieces small: at most ten times as fast.
                self._step_time = max((time.perf_counter() - begin) / piece, 0.1 * self._step_time)
                if failed:
                    raise _exception(error.value)
                left -= piece
        finally:
            self._lock.release()

    @property
    def time(self) -> float:
        return Simulation._time(self._idle())  # type: ignore[no-any-return]

    @property
    def step(self) -> float:
        return Simulation._step(self._idle())  # type: ignore[no-any-return]

    @property
    def input_work(self) -> float:
        return Simulation._work(self._idle())  # type: ignore[no-any-return]

    def array(self, name: str) -> Any:
        self._idle()
        return _array(Simulation._array, self, name)

    def input(self, name: str) -> Any:
        self._idle()
        return _array(Simulation._input, self, name, read_only=False)

    def snapshot(self) -> Snapshot:
        return Snapshot(Simulation._snapshot(self._idle()), self)

    def restore(self, snapshot: Snapshot, /) -> None:
        error = c_void_p()
        if not isinstance(snapshot, Snapshot):
            raise TypeError("restore takes what snapshot() returned")
        if Simulation._restore(self._idle(), snapshot._handle, byref(error)):
            raise _exception(error.value)


# ---- scenes ----


class Scene(_Handle):
    """A strutlib_scene."""

    _free = _function("close", "v", "p")
    _name_count = _function("name_count", "n", "ps")
    _name = _function("name", "t", "psn")
    _number = _function("scene_number", "i", "psp")
    _flag = _function("scene_flag", "i", "psp")
    _text = _function("scene_text", "t", "ps")
    _array = _function("scene_array", "i", "pspppp")
    _warning = _function("scene_warning", "t", "pn")
    _yaml = _function("scene_yaml", "o", "pi!")
    _json = _function("scene_json", "o", "p!")
    _svg = _function("scene_svg", "o", "p!")
    _html = _function("scene_html", "o", "pip!")
    _simulation = _function("simulation_open", "p", "pnppp!")
    _sweep = _function("sweep", "p", "pnpnppnpnpppppp")
    _calls = {
        name: _function(name, "p", "pnpppp")
        for name in ("run", "equilibria", "modes", "rigidity", "form", "path", "matrices")
    }

    def names(self, kind: str) -> tuple[str, ...]:
        count = Scene._name_count(self._handle, _bytes(kind))
        return tuple(Scene._name(self._handle, _bytes(kind), i) for i in range(count))

    def value(self, name: str) -> float | bool | str | None:
        """A number, a flag or a text by its dotted name, or None."""
        key, number, flag = _bytes(name), c_double(), c_int()
        if Scene._number(self._handle, key, byref(number)):
            return number.value
        if Scene._flag(self._handle, key, byref(flag)):
            return bool(flag.value)
        return Scene._text(self._handle, key)  # type: ignore[no-any-return]

    def array(self, name: str) -> Any:
        return _array(Scene._array, self, name)

    def warnings(self) -> list[str]:
        return list(_until_none(Scene._warning, self._handle))

    def yaml(self, parts: bool) -> str:
        return Scene._yaml(self._handle, parts)  # type: ignore[no-any-return]

    def json(self) -> str:
        return Scene._json(self._handle)  # type: ignore[no-any-return]

    def svg(self) -> str:
        return Scene._svg(self._handle)  # type: ignore[no-any-return]

    def html(self, equilibria: bool) -> str:
        return self._wait(_Control(), Scene._html, equilibria)  # type: ignore[no-any-return]

    def simulation(self, names: tuple[str, ...], values: tuple[str, ...]) -> Simulation:
        control = _Control()

        def simulate(*given: Any) -> Simulation:
            return Simulation(Scene._simulation(*given), control)

        return self._wait(control, simulate, *_pairs(names, values))  # type: ignore[no-any-return]

    def _wait(self, control: _Control, function: Any, *given: Any) -> Any:
        """What a function of the library returns that takes a control last; raises what it or a signal does."""
        answer: list[Any] = []
        failed: list[BaseException] = []

        def call() -> None:
            try:
                answer.append(function(self._handle, *given, control._handle))
            except BaseException as error:
                failed.append(error)

        raised = control.wait(call, None) or next(iter(failed), None)
        if raised is not None:
            raise raised
        return answer[0]

    def _fill(self, result: Result, function: Any, given: tuple[Any, ...], progress: Progress | None) -> None:
        """Puts what the call returns into `result`, also where it failed or was interrupted; then raises."""
        control, error = _Control(), c_void_p()

        def call() -> None:
            result._handle = function(self._handle, *given, control._handle, byref(error))

        raised = control.wait(call, progress)
        if raised is not None:
            _error_free(error)
            raise raised
        if error or not result:
            raise _exception(error.value)

    def call(
        self,
        result: Result,
        command: str,
        names: tuple[str, ...],
        values: tuple[str, ...],
        progress: Progress | None,
    ) -> None:
        if command not in Scene._calls:
            raise ValueError(f"no such command: {command}")
        self._fill(result, Scene._calls[command], _pairs(names, values), progress)

    def sweep(
        self,
        result: Result,
        axes: tuple[str, ...],
        count: int,
        points: Any,
        words: tuple[str | None, ...] | None,
        keep: tuple[str, ...],
        names: tuple[str, ...],
        values: tuple[str, ...],
        progress: Progress | None,
    ) -> None:
        numbers = memoryview(points)
        if numbers.format != "d" or numbers.nbytes != 8 * count * len(axes):
            raise ValueError("a double is needed for each point and axis")
        if words is not None and len(words) != count * len(axes):
            raise ValueError("a word or None is needed for each point and axis")
        spelled = None if words is None else _texts(words)
        table = (len(axes), _texts(axes), count, numbers.tobytes(), spelled, len(keep), _texts(keep))
        self._fill(result, Scene._sweep, (*table, *_pairs(names, values), None, None), progress)


_open = _function("open", "p", "snpp!")
_open_text = _function("open_text", "p", "ssnnpp!")
_with = _function("scene_with", "p", "pnpp!")


def open(path: str | os.PathLike[str], names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_open(_whole(os.fsencode(path)), *_pairs(names, values)))


def open_text(name: str, text: str, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    source = text.encode()
    return Scene(_open_text(_bytes(name), source, len(source), *_pairs(names, values)))


def with_(scene: Scene, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_with(scene._handle, *_pairs(names, values)))


# ---- the library as a whole ----

_option_name, _option_help = (_function(f"option_{part}", "t", "sn") for part in ("name", "help"))
_channel = _function("channel", "t", "n")
_channel_kind = _function("channel_kind", "t", "s")
_channel_component, _channel_column = (_function(f"channel_{part}", "t", "sn") for part in ("component", "column"))
_yaml_places = _function("yaml_places", "o", "ss!")
status_text: Callable[[int], str] = _function("status_text", "t", "i")


def options(command: str) -> list[tuple[str, str]]:
    """Options of a command and what they mean."""
    word = _bytes(command)
    return [(name, _option_help(word, i)) for i, name in enumerate(_until_none(_option_name, word))]


def channels() -> list[tuple[str, str, tuple[str, ...], tuple[str, ...]]]:
    """(name, kind, components, columns) of each."""
    return [
        (
            name,
            _channel_kind(_bytes(name)),
            tuple(_until_none(_channel_component, _bytes(name))),
            tuple(_until_none(_channel_column, _bytes(name))),
        )
        for name in _until_none(_channel)
    ]


def yaml_places(name: str, text: str) -> str:
    """A YAML text as JSON, with places."""
    return _yaml_places(_bytes(name), _bytes(text))  # type: ignore[no-any-return]


if (_found := _function("abi_version", "i")()) < _ABI_VERSION:
    raise ImportError(f"libstrut.so.0 is older than this package: interface {_found}, not {_ABI_VERSION}")
version: str = _function("version", "t")()

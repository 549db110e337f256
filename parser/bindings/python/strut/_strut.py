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
import re
import threading
import time
from array import array as doubles
from ctypes import byref, c_char_p, c_double, c_int, c_long, c_size_t, c_void_p
from typing import Any, Callable, Iterator, Sequence

from . import _errors

Progress = Callable[[float], object]

_LIBRARY = ctypes.CDLL(os.fspath(pathlib.Path(__file__).with_name("libstrut.so.0")))
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


class _Api:
    """The functions of the library without strutlib_, as abi.h declares them; texts of the library's as str."""

    _DECLARED = re.compile(r"STRUTLIB_API ([^;(]*?)strutlib_(\w+)\(([^)]*)\);")
    _TYPES = {"void": None, "int": c_int, "long": c_long, "size_t": c_size_t, "double": c_double, "const char *": c_char_p}

    def __init__(self, header: str) -> None:
        version = int(header.partition("#define STRUTLIB_ABI_VERSION ")[2].split()[0])
        if (found := _LIBRARY.strutlib_abi_version()) < version:
            raise ImportError(f"libstrut.so.0 is older than this package: interface {found}, not {version}")
        self.calls = re.findall(r"\bX\((\w+)\)", header.partition("#define STRUTLIB_CALLS(X)")[2].partition("\n")[0])
        for returned, name, arguments in self._DECLARED.findall(header):
            function = getattr(_LIBRARY, "strutlib_" + name)
            words = [re.sub(r"\w+$", "", word).strip() for word in arguments.split(",") if word != "void"]
            function.argtypes = [self._TYPES.get(word, c_void_p) for word in words]
            function.restype = self._TYPES.get(returned.strip(), c_void_p)
            wrap = {"const char *": _shown, "char *": _given}.get(returned.strip())
            setattr(self, name, wrap(function) if wrap else function)

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)  # all others: for mypy

    def ask(self, name: str, *given: Any) -> Any:
        """What a function returns that takes an error last, which is raised."""
        error = c_void_p()
        found = getattr(self, name)(*given, byref(error))
        if error:
            raise _exception(error.value)
        return found


def _shown(function: Any) -> Any:
    return lambda *given: _decode(function(*given))


def _given(function: Any) -> Any:
    """A function whose text belongs to the caller, who keeps a copy."""

    def copied(*given: Any) -> Any:
        text = function(*given)
        copy = _decode(ctypes.string_at(text)) if text else None
        _api.release(text)
        return copy

    return copied


def _until_none(function: Callable[..., Any], *given: Any) -> Iterator[Any]:
    """function(..., 0), function(..., 1), ... before None."""
    i = 0
    while (item := function(*given, i)) is not None:
        yield item
        i += 1


_api = _Api(pathlib.Path(__file__).with_name("abi.h").read_text("utf-8"))
_LOCATED = ("file", "line", "column", "length", "text", "source", "hint", "key")


def _exception(error: int | None) -> BaseException:
    """The exception for an error, which is freed."""
    if error is None:  # the library could not even say why
        return MemoryError()
    located = [getattr(_api, f"error_{part}") for part in _LOCATED]
    messages = [tuple(part(error, i) for part in located) for i in range(_api.error_count(error))]
    name = _api.status_name(_api.error_status(error))
    exception = _errors.make(name, _api.error_message(error), _api.error_report(error), messages)
    _api.error_free(error)
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

    _free = _api.control_free

    def __init__(self) -> None:
        super().__init__(_api.control_create())
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
            _api.control_on_progress(self._handle, callback, None)
        thread = threading.Thread(target=compute)
        thread.start()
        while not done.is_set():
            try:
                if not done.wait(_LOOK if raised is None else None) and progress is not None:
                    progress(fraction[0])
            except BaseException as error:
                raised = raised or error
                _api.interrupt(self._handle)
        thread.join()
        _api.control_on_progress(self._handle, None, None)
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

    _free = _api.result_free
    def __init__(self) -> None:
        super().__init__(None)

    def __bool__(self) -> bool:
        return self._handle is not None

    def _filled(self) -> int:
        if self._handle is None:
            raise ValueError("there is no result")
        return self._handle

    def command(self) -> str:
        return _api.result_command(self._filled())  # type: ignore[no-any-return]

    def status(self) -> str:
        return _api.status_name(_api.result_status(self._filled()))  # type: ignore[no-any-return]

    def json(self) -> str:
        return _api.result_json(self._filled())  # type: ignore[no-any-return]

    def table(self) -> str:
        return _api.result_table(self._filled())  # type: ignore[no-any-return]

    def warnings(self) -> list[str]:
        return list(_until_none(_api.result_warning, self._filled()))

    def array(self, name: str) -> Any:
        self._filled()
        return _array(_api.result_array, self, name)

    def array_names(self) -> list[str]:
        return list(_until_none(_api.result_array_name, self._filled()))

    def columns(self) -> list[str]:
        return list(_until_none(_api.result_column, self._filled()))

    def unit(self, name: str) -> str | None:
        return _api.result_array_unit(self._filled(), _bytes(name))  # type: ignore[no-any-return]

    def words(self, column: str, count: int) -> list[str | None]:
        """The texts of a sweep's column, one per point."""
        return [_api.result_cell(self._filled(), _bytes(column), i) for i in range(count)]

    def yaml(self) -> str:
        return _api.ask("result_yaml", self._filled())  # type: ignore[no-any-return]

    def svg(self, names: tuple[str, ...], values: tuple[str, ...]) -> str:
        return _api.ask("result_svg", self._filled(), *_pairs(names, values))  # type: ignore[no-any-return]

    def html(self) -> str:
        return _api.ask("result_html", self._filled())  # type: ignore[no-any-return]


class Snapshot(_Handle):
    """A strutlib_snapshot."""

    _free = _api.snapshot_free

    def __init__(self, handle: int, simulation: Simulation) -> None:
        super().__init__(handle)
        self._simulation = simulation  # kept, so that no other one takes its place in memory


class Simulation(_Handle):
    """A strutlib_simulation. Many steps are divided into pieces of some milliseconds, between which Python looks for
    signals; the bits do not depend on that."""

    _free = _api.simulation_close
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
                failed = _api.simulation_advance(self._handle, piece, byref(error))
                # A step that met the scheduler shall not make all later pieces small: at most ten times as fast.
                self._step_time = max((time.perf_counter() - begin) / piece, 0.1 * self._step_time)
                if failed:
                    raise _exception(error.value)
                left -= piece
        finally:
            self._lock.release()

    @property
    def time(self) -> float:
        return _api.simulation_time(self._idle())  # type: ignore[no-any-return]

    @property
    def step(self) -> float:
        return _api.simulation_step(self._idle())  # type: ignore[no-any-return]

    @property
    def input_work(self) -> float:
        return _api.simulation_input_work(self._idle())  # type: ignore[no-any-return]

    def array(self, name: str) -> Any:
        self._idle()
        return _array(_api.simulation_array, self, name)

    def input(self, name: str) -> Any:
        self._idle()
        return _array(_api.simulation_input, self, name, read_only=False)

    def snapshot(self) -> Snapshot:
        return Snapshot(_api.ask("simulation_snapshot", self._idle()), self)

    def restore(self, snapshot: Snapshot, /) -> None:
        if not isinstance(snapshot, Snapshot):
            raise TypeError("restore takes what snapshot() returned")
        _api.ask("simulation_restore", self._idle(), snapshot._handle)


def _fill(result: Result, function: Any, given: tuple[Any, ...], progress: Progress | None) -> None:
    """Puts what the call returns into `result`, also where it failed or was interrupted; then raises."""
    control, error = _Control(), c_void_p()

    def call() -> None:
        result._handle = function(*given, control._handle, byref(error))

    raised = control.wait(call, progress)
    if raised is not None:
        _api.error_free(error)
        raise raised
    if error or not result:
        raise _exception(error.value)


# ---- scenes ----


class Scene(_Handle):
    """A strutlib_scene."""

    _free = _api.close
    def names(self, kind: str) -> tuple[str, ...]:
        count = _api.name_count(self._handle, _bytes(kind))
        return tuple(_api.name(self._handle, _bytes(kind), i) for i in range(count))

    def value(self, name: str) -> float | bool | str | None:
        """A number, a flag or a text by its dotted name, or None."""
        key, number, flag = _bytes(name), c_double(), c_int()
        if _api.scene_number(self._handle, key, byref(number)):
            return number.value
        if _api.scene_flag(self._handle, key, byref(flag)):
            return bool(flag.value)
        return _api.scene_text(self._handle, key)  # type: ignore[no-any-return]

    def array(self, name: str) -> Any:
        return _array(_api.scene_array, self, name)

    def warnings(self) -> list[str]:
        return list(_until_none(_api.scene_warning, self._handle))

    def yaml(self, parts: bool) -> str:
        return _api.ask("scene_yaml", self._handle, parts)  # type: ignore[no-any-return]

    def json(self) -> str:
        return _api.ask("scene_json", self._handle)  # type: ignore[no-any-return]

    def svg(self) -> str:
        return _api.ask("scene_svg", self._handle)  # type: ignore[no-any-return]

    def html(self, equilibria: bool) -> str:
        return self._wait(_Control(), "scene_html", equilibria)  # type: ignore[no-any-return]

    def simulation(self, names: tuple[str, ...], values: tuple[str, ...]) -> Simulation:
        control = _Control()
        return Simulation(self._wait(control, "simulation_open", *_pairs(names, values)), control)

    def _wait(self, control: _Control, function: str, *given: Any) -> Any:
        """What a function of the library returns that takes a control last; raises what it or a signal does."""
        answer: list[Any] = []
        failed: list[BaseException] = []

        def call() -> None:
            try:
                answer.append(_api.ask(function, self._handle, *given, control._handle))
            except BaseException as error:
                failed.append(error)

        raised = control.wait(call, None) or next(iter(failed), None)
        if raised is not None:
            raise raised
        return answer[0]

    def call(
        self,
        result: Result,
        command: str,
        names: tuple[str, ...],
        values: tuple[str, ...],
        progress: Progress | None,
    ) -> None:
        if command not in _api.calls:
            raise ValueError(f"no such command: {command}")
        _fill(result, getattr(_api, command), (self._handle, *_pairs(names, values)), progress)

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
        table = (self._handle, len(axes), _texts(axes), count, numbers.tobytes(), spelled, len(keep), _texts(keep))
        _fill(result, _api.sweep, (*table, *_pairs(names, values), None, None), progress)


def open(path: str | os.PathLike[str], names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_api.ask("open", _whole(os.fsencode(path)), *_pairs(names, values)))


def open_text(name: str, text: str, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    source = text.encode()
    return Scene(_api.ask("open_text", _bytes(name), source, len(source), *_pairs(names, values)))


def with_(scene: Scene, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_api.ask("scene_with", scene._handle, *_pairs(names, values)))


def study(result: Result, path: Any, folder: Any, given: Any, pairs: Any, progress: Progress | None) -> None:
    """Computes a study's file with settings `given` and options."""
    files = (_whole(os.fsencode(path)), _whole(os.fsencode(folder)))
    _fill(result, _api.study, (*files, *_pairs(*given), *_pairs(*pairs)), progress)


# ---- the library as a whole ----

version: str = _api.version()
status_text: Callable[[int], str] = _api.status_text


def options(command: str) -> list[tuple[str, str]]:
    """Options of a command and what they mean."""
    word = _bytes(command)
    return [(name, _api.option_help(word, i)) for i, name in enumerate(_until_none(_api.option_name, word))]


def option_types(command: str) -> list[tuple[str, str | None]]:
    """Kind and words, such as "elastic|rigid", of each of them."""
    word = _bytes(command)
    return [(kind, _api.option_words(word, i)) for i, kind in enumerate(_until_none(_api.option_kind, word))]


def channels() -> list[tuple[str, str, tuple[str, ...], tuple[str, ...]]]:
    """(name, kind, components, columns) of each."""
    return [
        (
            name,
            _api.channel_kind(_bytes(name)),
            tuple(_until_none(_api.channel_component, _bytes(name))),
            tuple(_until_none(_api.channel_column, _bytes(name))),
        )
        for name in _until_none(_api.channel)
    ]


def yaml_places(name: str, text: str) -> str:
    """A YAML text as JSON, with places."""
    return _api.ask("yaml_places", _bytes(name), _bytes(text))  # type: ignore[no-any-return]


for _call in (*_api.calls, "study"):
    _errors.switches.update(name for (name, _), (kind, _) in zip(options(_call), option_types(_call)) if kind == "flag")

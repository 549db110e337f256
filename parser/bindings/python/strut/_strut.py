# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects around the handles of libstrut.so.0 (parser/bindings/abi/abi.h), by ctypes. It converts and checks;
names, tables and everything for people are in the package's other files.

An object keeps what it was made of: an array lives as long as somebody looks at it, and with it the handle that
owns its numbers.
"""

from __future__ import annotations

import ctypes
import functools
import itertools
import operator
import os
import pathlib
import re
import threading
import time
from array import array as doubles
from ctypes import byref, c_char_p, c_double, c_int, c_long, c_size_t, c_void_p
from typing import Any, Callable, Sequence

from . import _errors

Progress = Callable[[float], object]

_HERE = pathlib.Path(__file__).parent

#: the folder of the models that come with strut: in the package, or where the program has them
models = next(
    (
        folder
        for folder in (_HERE / "models", *(above / "share/strut/models" for above in _HERE.parents))
        if folder.is_dir()
    ),
    _HERE / "models",
)

# A wheel brings fonts of its own for figures, for machines that have none.
if (_HERE / "fonts").is_dir() and not os.path.exists("/etc/fonts/fonts.conf"):
    os.environ.setdefault("FONTCONFIG_FILE", os.fspath(_HERE / "fonts/fonts.conf"))

_LIBRARY = ctypes.CDLL(os.fspath(_HERE / "libstrut.so.0"))
_LOOK, _PIECE = 0.05, 5e-3  # s: how often signals are looked for in calls and while a simulation is advanced
_BUSY = "another thread is advancing this simulation; one simulation per thread"
_NOTE = ctypes.CFUNCTYPE(c_int, c_void_p, c_double)


# ---- calls ----


def _bytes(text: str | bytes | None) -> bytes:
    if isinstance(text, bytes):
        return text
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


def _taken(text: int | None) -> Any:
    """A copy of a text that belongs to the caller."""
    copy = _decode(ctypes.string_at(text)) if text else None
    _api.release(text)
    return copy


class _Function:
    """A function of the library as abi.h declares it: texts are str, handles objects, and errors are raised."""

    _TYPES = {"void": None, "int": c_int, "long": c_long, "size_t": c_size_t, "double": c_double, "const char *": c_char_p}

    def __init__(self, returned: str, name: str, arguments: str) -> None:
        self._words = [re.sub(r"\w+$", "", word).strip() for word in arguments.split(",") if word != "void"]
        self._fails = self._words[-1:] == ["strutlib_error **"]
        convert: dict[str, Callable[[Any], Any]] = {"const char *": _decode, "char *": _taken}
        self._convert = convert.get(returned, lambda found: found)
        self.function = getattr(_LIBRARY, "strutlib_" + name)
        self.function.argtypes = [self._TYPES.get(word, c_void_p) for word in self._words]
        self.function.restype = self._TYPES.get(returned, c_void_p)

    def both(self, *given: Any) -> tuple[Any, int | None]:
        """What it returns, and its error, which is to be freed."""
        error = c_void_p()
        plain = [
            value.pointer() if isinstance(value, _Handle) else _bytes(value) if word == "const char *" else value
            for word, value in zip(self._words, given)
        ]
        found = self.function(*plain, *[byref(error)] * self._fails)
        return self._convert(found), error.value

    def __call__(self, *given: Any) -> Any:
        found, error = self.both(*given)
        if error is not None:
            raise _exception(error)
        return found


class _Api:
    """The functions of the library without strutlib_."""

    _DECLARED = re.compile(r"STRUTLIB_API ([^;(]*?)strutlib_(\w+)\(([^)]*)\);")

    def __init__(self, header: str) -> None:
        version = int(header.partition("#define STRUTLIB_ABI_VERSION ")[2].split()[0])
        if (found := _LIBRARY.strutlib_abi_version()) < version:
            raise ImportError(f"libstrut.so.0 is older than this package: interface {found}, not {version}")
        self.calls = re.findall(r"\bX\((\w+)\)", header.partition("#define STRUTLIB_CALLS(X)")[2].partition("\n")[0])
        for returned, name, arguments in self._DECLARED.findall(header):
            setattr(self, name, _Function(returned.strip(), name, arguments))

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)  # all others: for mypy


def _until_none(function: Callable[..., Any], *given: Any) -> list[Any]:
    """function(..., 0), function(..., 1), ... before None."""
    return list(iter(map(functools.partial(function, *given), itertools.count()).__next__, None))


class _Handle:
    """An object of the library, freed with this one. Its attributes are the library's functions of such objects."""

    _of: str  #: what their names begin with
    _free: Callable[[int | None], None]
    _handle: int | None

    def __init__(self, handle: int | None) -> None:
        self._handle = handle

    def __del__(self) -> None:
        self._free(self.__dict__.get("_handle"))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return functools.partial(getattr(_api, f"{self._of}_{name}"), self)

    def pointer(self) -> int | None:
        return self._handle


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


class _Control(_Handle):
    """Interrupts calls and tells their progress."""

    _of, _free = "control", _api.control_free

    def __init__(self) -> None:
        super().__init__(_api.control_create())
        if self._handle is None:
            raise MemoryError

    def call(
        self, function: _Function, given: tuple[Any, ...], progress: Progress | None = None, result: Result | None = None
    ) -> Any:
        """What a function returns that takes a control last, called in a thread of its own; raises what it, signals or
        `progress` did. What it returned also goes into `result`.

        Python runs the handlers of signals between two of its own instructions only, and only in the thread that
        began the program: so Ctrl-C ends everything within a moment, also what reports no progress.
        """
        done, fraction, answer = threading.Event(), [0.0], list[tuple[Any, int | None]]()
        raised = list[BaseException]()

        def compute() -> None:
            try:
                answer.append(function.both(*given, self))
            except BaseException as error:
                raised.append(error)
            finally:
                done.set()

        def note(_: object, reached: float) -> int:
            fraction[0] = reached
            return 0

        callback = _NOTE(note)
        if progress is not None:
            self.on_progress(callback, None)
        thread = threading.Thread(target=compute)
        thread.start()
        while not done.is_set():
            try:
                if not done.wait(None if raised else _LOOK) and progress is not None:
                    progress(fraction[0])
            except BaseException as error:
                raised.append(error)
                _api.interrupt(self)
        thread.join()
        self.on_progress(None, None)
        found, failure = answer[0] if answer else (None, None)
        if result is not None:
            result._handle = found
        if raised:
            _api.error_free(failure)
            raise raised[0]
        if failure is not None or found is None:
            raise _exception(failure)
        return found


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
    if not function(owner, name, byref(data), byref(dimensions), shape, stride):
        return None
    count = dimensions.value
    return Array(owner, data.value or 0, shape[:count], stride[:count], read_only)


# ---- what a call returns ----


class Result(_Handle):
    """A strutlib_result: made empty, filled by a scene's call."""

    json: Callable[[], str]
    table: Callable[[], str]
    yaml: Callable[[], str]
    html: Callable[[], str]
    _of, _free = "result", _api.result_free

    def __init__(self) -> None:
        super().__init__(None)

    def __bool__(self) -> bool:
        return self._handle is not None

    def pointer(self) -> int:
        if self._handle is None:
            raise ValueError("there is no result")
        return self._handle

    def status(self) -> str:
        return _api.status_name(_api.result_status(self))  # type: ignore[no-any-return]

    def warnings(self) -> list[str]:
        return _until_none(_api.result_warning, self)

    def array(self, name: str) -> Any:
        return _array(_api.result_array, self, name)

    def array_names(self) -> list[str]:
        return _until_none(_api.result_array_name, self)

    def columns(self) -> list[str]:
        return _until_none(_api.result_column, self)

    def unit(self, name: str) -> str | None:
        return _api.result_array_unit(self, name)  # type: ignore[no-any-return]

    def words(self, column: str, count: int) -> list[str | None]:
        """The texts of a sweep's column, one per point."""
        return [_api.result_cell(self, column, i) for i in range(count)]

    def svg(self, names: tuple[str, ...], values: tuple[str, ...]) -> str:
        return _api.result_svg(self, *_pairs(names, values))  # type: ignore[no-any-return]


class Snapshot(_Handle):
    """A strutlib_snapshot."""

    _of, _free = "snapshot", _api.snapshot_free

    def __init__(self, handle: int, simulation: Simulation) -> None:
        super().__init__(handle)
        self._simulation = simulation  # kept, so that no other one takes its place in memory


class Simulation(_Handle):
    """A strutlib_simulation. Many steps are divided into pieces of some milliseconds, between which Python looks for
    signals; the bits do not depend on that."""

    time: Callable[[], float]
    step: Callable[[], float]
    input_work: Callable[[], float]
    _of, _free = "simulation", _api.simulation_close

    def __init__(self, handle: int, control: _Control) -> None:
        super().__init__(handle)
        self._control = control
        self._step_time = _PIECE  # s of one step as last measured: nothing is known, one step at first
        self._lock = threading.Lock()  # held while a thread advances it

    def pointer(self) -> int | None:
        if self._lock.locked():
            raise RuntimeError(_BUSY)
        return self._handle

    def advance(self, steps: int, /) -> None:
        left, error, function = operator.index(steps), c_void_p(), _api.simulation_advance.function
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
                failed = function(self._handle, piece, byref(error))
                # A step that met the scheduler shall not make all later pieces small: at most ten times as fast.
                self._step_time = max((time.perf_counter() - begin) / piece, 0.1 * self._step_time)
                if failed:
                    raise _exception(error.value)
                left -= piece
        finally:
            self._lock.release()

    def array(self, name: str) -> Any:
        return _array(_api.simulation_array, self, name)

    def input(self, name: str) -> Any:
        return _array(_api.simulation_input, self, name, read_only=False)

    def finish(self) -> Result:
        run = Result()
        run._handle = _api.simulation_finish(self)
        return run

    def snapshot(self) -> Snapshot:
        return Snapshot(_api.simulation_snapshot(self), self)

    def restore(self, snapshot: Snapshot, /) -> None:
        if not isinstance(snapshot, Snapshot):
            raise TypeError("restore takes what snapshot() returned")
        _api.simulation_restore(self, snapshot)


# ---- scenes ----


class Scene(_Handle):
    """A strutlib_scene."""

    yaml: Callable[[bool], str]
    json: Callable[[], str]
    svg: Callable[[], str]
    _of, _free = "scene", _api.close

    def names(self, kind: str) -> tuple[str, ...]:
        return tuple(_api.name(self, kind, i) for i in range(_api.name_count(self, kind)))

    def value(self, name: str) -> float | bool | str | None:
        """A number, a flag or a text by its dotted name, or None."""
        number, flag = c_double(), c_int()
        if _api.scene_number(self, name, byref(number)):
            return number.value
        if _api.scene_flag(self, name, byref(flag)):
            return bool(flag.value)
        return _api.scene_text(self, name)  # type: ignore[no-any-return]

    def array(self, name: str) -> Any:
        return _array(_api.scene_array, self, name)

    def warnings(self) -> list[str]:
        return _until_none(_api.scene_warning, self)

    def html(self, equilibria: bool) -> str:
        return _Control().call(_api.scene_html, (self, equilibria))  # type: ignore[no-any-return]

    def simulation(self, names: tuple[str, ...], values: tuple[str, ...]) -> Simulation:
        control = _Control()
        return Simulation(control.call(_api.simulation_open, (self, *_pairs(names, values))), control)

    def call(
        self, result: Result, command: str, names: tuple[str, ...], values: tuple[str, ...], progress: Progress | None
    ) -> None:
        if command not in _api.calls:
            raise ValueError(f"no such command: {command}")
        _Control().call(getattr(_api, command), (self, *_pairs(names, values)), progress, result)

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
        table = (self, len(axes), _texts(axes), count, numbers.tobytes(), spelled, len(keep), _texts(keep))
        _Control().call(_api.sweep, (*table, *_pairs(names, values), None, None), progress, result)


def open(path: str | os.PathLike[str], names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_api.open(_whole(os.fsencode(path)), *_pairs(names, values)))


def open_text(name: str, text: str, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    source = str.encode(text)
    return Scene(_api.open_text(name, source, len(source), *_pairs(names, values)))


def with_(scene: Scene, names: tuple[str, ...], values: tuple[str, ...]) -> Scene:
    return Scene(_api.scene_with(scene, *_pairs(names, values)))


def study(result: Result, path: Any, folder: Any, given: Any, pairs: Any, progress: Progress | None) -> None:
    """Computes a study's file with settings `given` and options."""
    files = (_whole(os.fsencode(path)), _whole(os.fsencode(folder)))
    _Control().call(_api.study, (*files, *_pairs(*given), *_pairs(*pairs)), progress, result)


# ---- the library as a whole ----

version: str = _api.version()
status_text: Callable[[int], str] = _api.status_text
yaml_places: Callable[[str, str], str] = _api.yaml_places


def options(command: str) -> list[tuple[str, str]]:
    """Options of a command and what they mean."""
    return list(zip(_until_none(_api.option_name, command), _until_none(_api.option_help, command)))


def option_types(command: str) -> list[tuple[str, str | None]]:
    """Kind and words, such as "elastic|rigid", of each of them."""
    return [(kind, _api.option_words(command, i)) for i, kind in enumerate(_until_none(_api.option_kind, command))]


def channels() -> list[tuple[str, str, tuple[str, ...], tuple[str, ...]]]:
    """(name, kind, components, columns) of each."""

    def parts(function: _Function, name: str) -> tuple[str, ...]:
        return tuple(_until_none(function, name))

    return [
        (name, _api.channel_kind(name), parts(_api.channel_component, name), parts(_api.channel_column, name))
        for name in _until_none(_api.channel)
    ]


unit: Callable[[str], str] = _api.channel_unit  #: of a channel


for _call in (*_api.calls, "study"):
    _errors.switches.update(name for (name, _), (kind, _) in zip(options(_call), option_types(_call)) if kind == "flag")

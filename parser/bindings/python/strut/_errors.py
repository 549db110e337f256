# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions. _strut makes one by make() for each error of the library."""

from __future__ import annotations

import builtins
import os
import re
from errno import ENOENT
from typing import Any, NamedTuple

_OPTION = re.compile(r"""--([a-z][a-z-]*)(?:[ =](\d[\d.]*[ ]?%|[A-Z]+\b|'[^']*'|"[^"]*"))?""")
switches: set[str] = set()  #: options without value, of the library


def in_python(text: str) -> str:
    """A message of the library with the program's options as Python's arguments: --force is force=True."""

    def argument(found: re.Match[str]) -> str:
        name, value = found[1].replace("-", "_"), found[2]
        name = "from_" if name == "from" else name
        if name in switches:
            return f"{name}=True" + (f" {value}" if value else "")
        if value is None or value == "VALUE":
            return name
        return f"{name}={value!r}" if value.endswith("%") else f"{name}={value}"

    return _OPTION.sub(argument, re.sub(r"--set (?=\S+=)", "", text))


class Message(NamedTuple):
    """One mistake, with its place in a scene's text."""

    file: str
    line: int  #: from 1; 0: the file as a whole, or a setting
    column: int  #: from 1, in characters
    length: int  #: of what is wrong, in characters
    text: str
    source: str  #: the line itself
    hint: str | None  #: the word that was probably meant
    key: str  #: the key there, such as "nodes.n3.mass"

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        return f"{place}: {self.text}"


class Error(Exception):
    """The base of strut's exceptions.

    `status` is a word such as "bad_scene" or "diverged", `message` one sentence, `report` all of it with
    the lines of the file that are wrong, `messages` every mistake with its place, and `result` what a call
    that failed or was interrupted has computed until then.
    """

    status: str = ""
    message: str = ""
    report: str = ""
    messages: tuple[Message, ...] = ()
    result: Any = None

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self.args, self.__dict__)


def _first(part: str, hint: str, text: str) -> Any:
    """A part of the first message, None where there is none."""

    def get(self: Error) -> Any:
        return getattr(self.messages[0], part) if self.messages else None

    get.__annotations__["return"] = hint
    return property(get, doc=text)


class SceneError(Error, ValueError):
    """A scene is not valid. The first mistake's place, hint and key are attributes; `messages` has all."""

    file = _first("file", "str | None", "The file of the first mistake.")
    line = _first("line", "int | None", "Its line, from 1.")
    column = _first("column", "int | None", "Its column, from 1.")
    length = _first("length", "int | None", "Characters that are wrong.")
    hint = _first("hint", "str | None", "The word that was probably meant.")
    key = _first("key", "str | None", 'The key there, such as "nodes.n3.mass".')


class UsageError(Error, ValueError):
    """An argument has a value that the call cannot take."""


class RunError(Error, RuntimeError):
    """A computation failed: it diverged, its step is too large, it did not settle, a matrix is singular."""


class FileError(Error, OSError):
    """A file could not be read or written."""


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""


class MemoryError(Error, builtins.MemoryError):
    """Memory is out."""


_CLASSES: dict[str, type[Error]] = {
    "usage": UsageError,
    "bad_scene": SceneError,
    "file_trouble": FileError,
    "no_memory": MemoryError,
}


def make(status: str, message: str, report: str, messages: list[tuple[Any, ...]]) -> Error:
    """The exception for an error of the library."""
    located = tuple(Message(*entry) for entry in messages)
    located = tuple(each._replace(text=in_python(each.text)) for each in located)
    message = in_python(message)
    text = message if len(located) < 2 else "\n".join(["", *map(str, located)])
    kind = _CLASSES.get(status, RunError)
    if kind is FileError and message.endswith(os.strerror(ENOENT)):
        kind = MissingFileError
    error = kind(text)
    error.status = status
    error.message = message
    error.report = in_python(report)
    error.messages = located
    return error

# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions. _strut calls make() for each error of the library."""

from __future__ import annotations

import builtins
from typing import Any, NamedTuple

__all__ = ["Error", "FileError", "MemoryError", "Message", "RunError", "SceneError", "UsageError"]


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
    """What strut refused or could not do.

    `status` is a word such as "bad_scene" or "diverged", `message` one sentence, `report` what the
    program prints, `messages` every located mistake, and `result` what a failed call computed before.
    """

    status: str = ""
    message: str = ""
    report: str = ""
    messages: tuple[Message, ...] = ()
    result: Any = None

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self.args, self.__dict__)


class SceneError(Error, ValueError):
    """A scene is not valid. The first mistake's place, hint and key are attributes; `messages` has all."""

    @property
    def file(self) -> str | None:
        return self.messages[0].file if self.messages else None

    @property
    def line(self) -> int | None:
        return self.messages[0].line if self.messages else None

    @property
    def column(self) -> int | None:
        return self.messages[0].column if self.messages else None

    @property
    def length(self) -> int | None:
        return self.messages[0].length if self.messages else None

    @property
    def hint(self) -> str | None:
        return self.messages[0].hint if self.messages else None

    @property
    def key(self) -> str | None:
        return self.messages[0].key if self.messages else None


class UsageError(Error, ValueError):
    """An option that a call does not have, or a value that it cannot take."""


class RunError(Error, RuntimeError):
    """A computation failed: it diverged, its step is too large, it did not settle, a matrix is singular."""


class FileError(Error, OSError):
    """A file could not be read or written."""


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
    text = message if len(located) < 2 else "\n".join(["", *map(str, located)])
    error = _CLASSES.get(status, RunError)(text)
    error.status = status
    error.message = message
    error.report = report
    error.messages = located
    return error

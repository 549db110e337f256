# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of other programs; `python3 -m strut.formats --help` lists them."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
from typing import Any, Iterable, Mapping

from .. import Scene, SceneError, loads

_LIST = ".strut-files"


class Failure(Exception):
    """Ends a command: a sentence for people, and the exit code."""

    def __init__(self, text: str, code: int = 2) -> None:
        super().__init__(text)
        self.code = code


def number(value: float) -> str:
    """The shortest text with the bits of a number."""
    return re.sub(r"e([-+])0*", lambda e: "e" + e[1].strip("+"), repr(float(value) + 0.0)).removesuffix(".0")


def cell(text: str) -> str:
    """A cell of CSV."""
    return '"' + text.replace('"', '""') + '"' if re.search('[",\n\r]', text) else text


def length(text: str, option: str) -> float:
    """An option such as "20 mm" in metres."""
    try:
        probe = loads('strut: 1\nnodes: {a: {position: ["%s", 0], mass: 1}}' % text.replace('"', " "))
    except SceneError:
        raise Failure(f"{option} expects a length such as '20 mm', not '{text}'", 1) from None
    return float(probe.to_dict()["nodes"]["a"]["position"][0])


def shape(scene: Scene, at: str | None) -> dict[str, Any]:
    """Arrays of the structure in a shape as lists: position, weight, length, rest_length, tension, ..."""
    raw = scene.matrices(at=at)._raw
    names = ("position", "weight", "length", "rest_length", "tension", "damping_coefficient")
    return {name: raw.array(name).tolist() for name in names}


def kind_of(member: Mapping[str, Any]) -> int:
    return ("bar", "spring", "cable").index(member["kind"])


def _entry(name: str, data: bytes) -> str:
    """A line of the list of files that strut wrote, which stands in their folder."""
    return f"{len(data)} {hashlib.sha256(data).hexdigest()[:16]} {name}\n"


def _refuse_others(folder: str, name: str) -> None:
    """What strut did not write, or somebody has changed since, stays."""
    path = os.path.join(folder, name)
    if os.path.lexists(path):
        if os.path.isfile(path) and not os.path.islink(path):
            with open(path, "rb") as file:
                data = file.read()
            try:
                with open(os.path.join(folder, _LIST), encoding="utf-8", errors="replace") as file:
                    known = not data or _entry(name, data) in file
            except FileNotFoundError:
                known = not data
            if known:
                return
        raise Failure(f"'{path}' is not overwritten: strut did not write it, or it has been changed since", 4)


def write_file(path: str, text: str) -> None:
    """Writes a file, whole or not at all."""
    folder, name = os.path.split(path)
    write_folder(folder or ".", [(name, text)])


def write_folder(folder: str, texts: Iterable[tuple[str, str]], own: str = "") -> None:
    """Writes all files into a folder, or none; earlier files of which `own` is the pattern go."""
    there, stage, entries = os.path.isdir(folder), "", dict[str, str]()
    try:
        os.makedirs(folder, exist_ok=True)
        stage = tempfile.mkdtemp(prefix=".strut-stage-", dir=folder)
        for name, text in texts:
            with open(os.path.join(stage, name), "wb") as file:
                file.write(text.encode())
            entries[name] = _entry(name, text.encode())
        old = [name for name in os.listdir(folder) if name not in entries and re.fullmatch(own, name)]
        for name in [*entries, *old]:
            _refuse_others(folder, name)
        with open(os.path.join(folder, _LIST), "a", encoding="utf-8") as listed:
            listed.writelines(entries.values())
        for name in old:
            os.unlink(os.path.join(folder, name))
        for name in entries:
            os.replace(os.path.join(stage, name), os.path.join(folder, name))
    except OSError as error:
        raise Failure(f"cannot write into '{folder}': {error.strerror}", 4) from None
    finally:
        if stage:
            shutil.rmtree(stage, ignore_errors=True)
        if not there and os.path.isdir(folder) and not os.listdir(folder):
            os.rmdir(folder)

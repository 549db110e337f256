#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every function of abi.h with NULL for each of its pointers in turn: an error or nothing, never a crash.

null_test.py LIBRARY HEADER
"""

import ctypes
import faulthandler
import re
import sys

SCENE = b"""strut: 1
parameters: {k: 100}
nodes: {w: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}
members: {s: {kind: spring, nodes: [w, b], stiffness: k}}
solver: {step: 1 ms}
run: {duration: 10 ms}
"""
USAGE = 1
# Pointers that may be NULL by the header, beside handles that are released.
MAY_BE_NULL = {"error", "control", "words", "row", "context", "progress"}
RELEASES = re.compile(r"strutlib_(release|close|\w+_free|simulation_close)$")


def prototypes(header):
    text = re.sub(r"/\*.*?\*/", "", open(header).read(), flags=re.S)
    text = re.sub(r"^#.*$", "", text, flags=re.M)
    found = re.findall(r"STRUTLIB_API\s+([\w\s*]+?)(strutlib_\w+)\s*\(([^)]*)\)\s*;", text)
    assert len(found) == text.count("STRUTLIB_API"), "a function that is not understood"
    for answer, name, arguments in found:
        words = [] if arguments.strip() == "void" else [a.strip() for a in arguments.split(",")]
        yield answer.strip(), name, [re.fullmatch(r"(.*?)(\w+)", a, flags=re.S).groups() for a in words]


def answer_type(text):
    if text.endswith("*"):
        return ctypes.c_void_p
    return {"void": None, "int": ctypes.c_int, "long": ctypes.c_long, "size_t": ctypes.c_size_t,
            "double": ctypes.c_double}[text]


class Values:
    """A valid argument of each name and type of the header."""

    def __init__(self, library):
        self.library = library
        library.strutlib_open_text.restype = ctypes.c_void_p
        library.strutlib_run.restype = ctypes.c_void_p
        library.strutlib_simulation_open.restype = ctypes.c_void_p
        library.strutlib_simulation_snapshot.restype = ctypes.c_void_p
        library.strutlib_control_create.restype = ctypes.c_void_p
        size = ctypes.c_size_t
        none = ctypes.c_void_p(None)
        self.scene = library.strutlib_open_text(b"scene", SCENE, size(len(SCENE)), size(0), none, none, none)
        scene = ctypes.c_void_p(self.scene)
        self.result = library.strutlib_run(scene, size(0), none, none, none, none)
        self.simulation = library.strutlib_simulation_open(scene, size(0), none, none, none, none)
        self.snapshot = library.strutlib_simulation_snapshot(ctypes.c_void_p(self.simulation), none)
        self.control = library.strutlib_control_create()
        assert self.scene and self.result and self.simulation and self.snapshot and self.control
        self.kept = []

    def keep(self, value):
        self.kept.append(value)
        return value

    def of(self, kind, name):
        kind = " ".join(kind.replace("*", " * ").split())
        if name == "error":
            return self.keep(ctypes.pointer(ctypes.c_void_p(None)))
        if kind.startswith("strutlib_error") or kind.startswith("const strutlib_error"):
            error = ctypes.c_void_p(None)
            self.library.strutlib_open_text(b"x", b"a", ctypes.c_size_t(1), ctypes.c_size_t(0), None, None,
                                            ctypes.byref(error))
            return error
        for handle in ("scene", "result", "simulation", "snapshot", "control"):
            if f"strutlib_{handle} *" in kind:
                return ctypes.c_void_p(getattr(self, handle))
        if kind in ("strutlib_progress", "strutlib_row", "void *"):
            return ctypes.c_void_p(None)
        if "char * const *" in kind:
            text = {"axes": b"k", "keep": b"status", "names": b"step", "words": b""}.get(name, b"1 ms")
            return self.keep((ctypes.c_char_p * 1)(text))
        if kind in ("const char *", "char *"):
            text = {"kind": b"nodes", "path": b"/nowhere", "text": SCENE, "command": b"run", "column": b"k",
                    "input": b"rest"}.get(name, b"s")
            return self.keep(ctypes.c_char_p(text))
        if "double" in kind and "*" in kind:
            return self.keep((ctypes.c_double * 4)(1.0)) if kind == "const double *" else self.keep((ctypes.c_void_p * 4)())
        if kind == "int *":
            return self.keep((ctypes.c_int * 4)())
        if kind == "size_t *":
            return self.keep((ctypes.c_size_t * 4)())
        numbers = {"size_t": ctypes.c_size_t, "int": ctypes.c_int, "long": ctypes.c_long, "double": ctypes.c_double}
        if kind in numbers:
            length = {"length": len(SCENE), "i": 0, "status": 0, "point": 0}.get(name, 1)
            return numbers[kind](length)
        raise SystemExit(f"no value is known for an argument '{kind} {name}'")


def main():
    faulthandler.enable()
    library = ctypes.CDLL(sys.argv[1])
    values = Values(library)
    failures, calls = [], 0
    for answer, name, arguments in prototypes(sys.argv[2]):
        function = getattr(library, name)
        for at, (kind, called) in enumerate(arguments):
            pointer = "*" in kind
            if not pointer or (RELEASES.search(name) and at == 0 and len(arguments) == 1):
                if pointer:
                    function.restype = answer_type(answer)
                    function(None)
                continue
            given = [values.of(k, n) for k, n in arguments]
            given[at] = None
            sys.stderr.write(f"{name}: {called}\n") if "-v" in sys.argv else None
            function.restype = answer_type(answer)
            back = function(*given)
            calls += 1
            errors = [i for i, (_, n) in enumerate(arguments) if n == "error"]
            if called in MAY_BE_NULL or not errors or not isinstance(given[errors[0]], ctypes._Pointer):
                continue
            error = given[errors[0]].contents
            status = library.strutlib_error_status(error)
            failed = back != 0 if answer == "int" else not back
            if not (error.value and status == USAGE and failed):
                failures.append(f"{name}: NULL as '{called}' is no usage error (status {status})")
    print("\n".join(failures) or f"{calls} calls")
    return bool(failures) or calls < 100


if __name__ == "__main__":
    sys.exit(main())

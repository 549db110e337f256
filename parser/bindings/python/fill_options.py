# SPDX-License-Identifier: GPL-3.0-or-later
"""Fills files of the package with the options that the library has.

    python3 fill_options.py PACKAGE NAME.py.in...

PACKAGE is the package's folder in the build tree, which gets NAME.py: a line `@OPTIONS call@` becomes the keyword
arguments of a call, `@HELP call@` a line about each, and `@CALL call: what it does@` the method of a scene.
"""

from __future__ import annotations

import importlib
import pathlib
import re
import sys
import types

TYPES = {"number": "Value", "whole": "int", "range": "str"}
MOST_WORDS = 6  #: of a literal type
METHOD = '''
    def {0}(
        self, *,
        @OPTIONS {0}@
    ) -> {1}:
        """{2}

        @HELP {0}@
        """
        return self._call({1}, locals())  # type: ignore[no-any-return]'''


def annotation(kind: str, words: str | None) -> str:
    """The type of an option, and its default."""
    if kind == "flag":
        return "bool = False"
    if words == "yes|no":
        return "bool | None = None"
    if kind != "word" or not words:
        return f"{TYPES.get(kind, 'Values')} | None = None"
    listed = ", ".join(f'"{word}"' for word in words.split("|"))
    return ("str" if listed.count(",") >= MOST_WORDS else f"Literal[{listed}]") + " | None = None"


def main(package: str, *templates: str) -> None:
    sys.dont_write_bytecode = True
    sys.modules["strut"] = strut = types.ModuleType("strut")  # files of which are still to be written
    strut.__path__ = [package]
    library, values, errors = (importlib.import_module(f"strut.{name}") for name in ("_strut", "_values", "_errors"))

    def fill(line: re.Match[str]) -> str:
        indent, what, call = line.groups()
        options = [(values.argument(name), help) for name, help in library.options(call)]
        if what == "HELP":
            return "\n".join(f"{indent}`{name}`: {errors.in_python(help)}." for name, help in options)
        types = library.option_types(call)
        return "\n".join(f"{indent}{name}: {annotation(*of)}," for (name, _), of in zip(options, types))

    def method(line: re.Match[str]) -> str:
        return METHOD.format(line[1], line[1].capitalize(), line[2])

    for template in map(pathlib.Path, templates):
        text = re.sub(r"(?m)^    @CALL (\w+): (.*)@$", method, template.read_text("utf-8"))
        text = re.sub(r"(?m)^( *)@(OPTIONS|HELP) (\w+)@$", fill, text)
        pathlib.Path(package, template.stem).write_text(text, "utf-8")


main(*sys.argv[1:])

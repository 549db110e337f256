# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of other programs: strut's models and runs for them, and their structures as strut's models."""

from __future__ import annotations

import argparse
import os
import re
import sys
from typing import Any, NoReturn, Sequence

from .. import Error, FileError, MemoryError, RunError, Scene, UsageError, load
from . import Failure, build_list, length, matrix_market, mjcf, ntrt, springable, tables, tensegritysim, vtk
from . import write_file
from ._draft import Draft, Source, Tree, collected

_READERS: dict[str, Any] = {"ntrt": ntrt, "tensegritysim": tensegritysim, "springable": springable, "tables": tables}


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise Failure(f"{message}; see {self.prog} --help", 1)


def _parser() -> _Parser:
    parser = _Parser("python3 -m strut.formats", description=__doc__)
    formats = parser.add_subparsers(dest="format", metavar="FORMAT", required=True)

    def add(name: str, words: str, out: str) -> argparse.ArgumentParser:
        own = formats.add_parser(name, help=words, description=words)
        what = "model or directory of a run" if name == "vtk" else "model"
        own.add_argument("model", metavar="MODEL", help=f"file of a {what}")
        own.add_argument("-o", "--output", metavar=out, required=True, help="where to write: all files or none")
        own.add_argument("--set", metavar="NAME=VALUE", action="append", default=[], help="changes a parameter")
        if name != "mjcf":
            own.add_argument("--at", metavar="NAME", help="shape: drawn (default), start, or an equilibrium")
        return own

    read = "reads a structure of another program and writes a model: of " + ", ".join(_READERS)
    own = formats.add_parser("import", help=read, description=read)
    own.add_argument("files", metavar="FILE", nargs="+", help="two of tables; of ntrt those of substructures follow")
    own.add_argument("-o", "--output", metavar="MODEL.yaml", help="the model (default: print it)")
    own.add_argument("--from", dest="reader", choices=_READERS, help="the format (default: recognised)")
    own.add_argument("--unit", metavar="LENGTH", help="unit of length of the file (default: 1 dm of ntrt, else 1 m)")
    add("vtk", "every frame of a run, or a shape, for ParaView", "DIR")
    add("mjcf", "a model for MuJoCo; what it cannot express is refused or listed", "FILE.xml")
    add("matrices", "connectivity, equilibrium, mass, damping and stiffness as Matrix Market files", "DIR")
    build = add("build", "lengths to cut, holes, and drawings (SVG, DXF) at true scale", "DIR")
    build.add_argument("--allowance", metavar="LENGTH", default="0", help="what a cable needs at each end")
    return parser


def _guess(source: Source) -> str:
    if re.search(r"^[ \t]*NODES[ \t\r]*$", source.text, re.MULTILINE):
        return "springable"
    tree = Tree.read(source)
    if tree.get("connections"):
        return "tensegritysim"
    if any(map(tree.get, ("pair_groups", "substructures", "bond_groups"))):
        return "ntrt"
    if tree.pairs is None and "," in source.text.split("\n")[0]:
        return "tables"
    tree.error("this is of no format that is known: name it by --from")


def _read(given: argparse.Namespace, sources: Sequence[Source]) -> str:
    """The scene, "" where there is a mistake."""
    with collected():
        if any(source.wrong for source in sources):
            return ""
        name = given.reader or _guess(sources[0])
        unit = length(given.unit, "--unit") if given.unit else 0.1 if name == "ntrt" else 1.0
        if not unit > 0:
            raise Failure("--unit expects a length above 0, such as '1 cm'", 1)
        if name != "ntrt" and len(sources) != (2 if name == "tables" else 1):
            raise Failure(f"{name} needs {'two tables' if name == 'tables' else 'one file'}", 1)
        draft = Draft(unit)
        _READERS[name].read(draft, sources)
        return "" if any(source.wrong for source in sources) else draft.text(_READERS[name].TITLE, sources)
    return ""


def _import(given: argparse.Namespace) -> None:
    sources = []
    for name in given.files:
        with open(name, "rb") as file:
            sources.append(Source(name, file.read()))
    try:
        text = _read(given, sources)
    finally:
        sys.stderr.write("".join(source.report() for source in sources))
    if any(source.wrong for source in sources):
        raise Failure("")
    if given.output:
        write_file(given.output, text)
    else:
        sys.stdout.write(text)


def _scene(given: argparse.Namespace, run: str | None = None) -> Scene:
    """The model, or that of a run."""
    if run and (given.at or given.set):
        raise Failure("--at and --set are for models: a run has its own shapes", 1)
    if run and not os.path.exists(os.path.join(run, "summary.json")):
        raise Failure(f"'{run}' holds no run: a directory of 'strut run -o' does", 4)
    pairs = [setting.partition("=") for setting in given.set]
    return load(os.path.join(run, "scene.yaml") if run else given.model, {name: value for name, _, value in pairs})


def _run(words: Sequence[str]) -> None:
    given = _parser().parse_args(words)
    if given.format == "import":
        _import(given)
    elif given.format == "vtk":
        run = given.model if os.path.isdir(given.model) else None
        print(vtk.write(_scene(given, run), given.output, given.at, run))
    elif given.format == "mjcf":
        for note in mjcf.write(_scene(given), given.output):
            print(f"strut: not said in '{given.output}': {note}", file=sys.stderr)
    elif given.format == "matrices":
        matrix_market.write(_scene(given), given.output, given.at)
    else:
        print(build_list.write(_scene(given), given.output, given.at, length(given.allowance, "--allowance")), end="")


def main(words: Sequence[str]) -> int:
    """The exit code, which is that of the program strut for the same trouble."""
    codes = {UsageError: 1, RunError: 3, FileError: 4, MemoryError: 4}
    try:
        _run(words)
    except Failure as failure:
        if str(failure):
            print(f"strut: {failure}", file=sys.stderr)
        return failure.code
    except Error as error:
        print(error.report.rstrip() or f"strut: {error.message}", file=sys.stderr)
        return next((code for kind, code in codes.items() if isinstance(error, kind)), 2)
    except OSError as error:
        print(f"strut: cannot open '{error.filename}': {error.strerror}", file=sys.stderr)
        return 4
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

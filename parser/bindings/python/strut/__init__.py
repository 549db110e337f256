# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar tensegrity structures and robots: multistable statics, contact dynamics, sweeps.

    import strut
    crawler = strut.load(strut.models / "crawler/crawler.yaml", start="II")
    run = crawler.run(accuracy="0.5 %")
    run.velocity, run["position.n1.x"]

Names are those of the scene's file and of the program's JSON, numbers are in SI units, texts may have units.
Results and scenes do not change. `models` is the folder of the models that come with strut.
"""

from ._errors import Error, FileError, MemoryError, Message, MissingFileError, RunError, SceneError, UsageError
from ._results import Equilibria, Equilibrium, Form, Matrices, Modes, Path, Result, Rigidity, Run
from ._scene import Scene, load, loads, run
from ._simulation import Motion, Simulation
from ._strut import models, version as __version__
from ._studies import Comparison, Fit, Study, Tradeoff, compare, fit, sweep, tradeoff
from ._sweep import Table
from ._values import Frozen as _Frozen, Named, Words, hinted as _hinted, unknown as _unknown

__all__ = [  # fmt: skip
    "Comparison", "Equilibria", "Equilibrium", "Error", "FileError", "Fit", "Form", "Matrices", "MemoryError", "Message",
    "MissingFileError", "Modes", "Motion", "Named", "Path", "Result", "Rigidity", "Run", "RunError", "Scene",
    "SceneError", "Simulation", "Study", "Table", "Tradeoff", "UsageError", "Words", "compare", "fit", "load", "loads",
    "models", "run", "sweep", "tradeoff",
]

#: commands of the program that are no functions here, and what does it
_ELSEWHERE = {
    **dict.fromkeys(("Model", "open", "read"), "strut.load(FILE)"),
    "simulate": "strut.run(FILE), or strut.load(FILE).run()",
    "check": "strut.load(FILE) checks it; its `warnings` are those of the command",
    "examples": "strut.models is the folder of them",
    "export": "strut.load(FILE).to_yaml()",
    "help": "help(strut), or strut help in a terminal",
    "keys": "strut keys NAME in a terminal",
    "plot": "results and tables have plot()",
}


def __getattr__(name: str) -> object:
    of_scene = name in ("equilibria", "form", "matrices", "modes", "path", "rigidity", "simulation", "view")
    there = f"strut.load(FILE).{name}()" if of_scene else _ELSEWHERE.get(name)
    raise AttributeError(f"no 'strut.{name}': {there}" if there else _unknown(name, __all__, "name in strut"))


for _name in set(__all__) - {"models"}:
    _thing = globals()[_name]
    _thing.__module__ = "strut"  # messages say strut.SceneError, whichever file it is in
    if not isinstance(_thing, type):
        globals()[_name] = _hinted(_thing)
    elif issubclass(_thing, _Frozen):
        for _method, _function in [*vars(_thing).items()]:
            if not _method.startswith("_") and hasattr(_function, "__code__"):
                setattr(_thing, _method, _hinted(_function))

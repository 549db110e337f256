# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar tensegrity structures and robots: multistable statics, contact dynamics, sweeps.

    import strut
    crawler = strut.load(strut.models / "crawler/crawler.yaml", start="II")
    run = crawler.run(accuracy="0.5 %")
    run.velocity, run["position.n1.x"]

Names are those of the scene's file and of the program's JSON, numbers are in SI units, texts may have units.
Results and scenes do not change. `models` is the folder of the models that come with strut.
"""

from ._files import models
from ._errors import (
    Error,
    FileError,
    MemoryError,
    Message,
    MissingFileError,
    RunError,
    SceneError,
    UsageError,
)
from ._results import (
    Equilibria,
    Equilibrium,
    Form,
    Matrices,
    Modes,
    Path,
    Result,
    Rigidity,
    Run,
)
from ._scene import Scene, load, loads
from ._simulation import Simulation
from ._strut import version as __version__
from ._studies import Fit, Study, fit, sweep
from ._sweep import Table
from ._values import Named, Words

__all__ = [
    "Equilibria",
    "Equilibrium",
    "Error",
    "FileError",
    "Fit",
    "Form",
    "Matrices",
    "MemoryError",
    "Message",
    "MissingFileError",
    "Modes",
    "Named",
    "Path",
    "Result",
    "Rigidity",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "Study",
    "Table",
    "UsageError",
    "Words",
    "fit",
    "load",
    "loads",
    "models",
    "sweep",
]

for _name in set(__all__) - {"models"}:  # messages say strut.SceneError, whichever file it is in
    globals()[_name].__module__ = "strut"
del _name

# SPDX-License-Identifier: GPL-3.0-or-later
"""mypy accepts the package and a caller's program, and sees a wrong one."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import main

RIGHT = """
import strut
scene = strut.load("a.yaml", frequency="10 Hz", start="II")
run = scene.run(accuracy="0.5 %", channels=["position"])
speed: float = run.velocity + run.time[-1] + run["position.n1.x"][0] + run.energy.residual
table: strut.Table = scene.sweep(frequency=[1, 2], keep=["velocity"])
energy: float = scene.equilibria()["II"].energy
sim = scene.simulation(step="0.1 ms")
sim.rest["m8"] = sim.rest0["m8"] + 1e-3
sim.advance(10)
stress = scene.rigidity(at="drawn").self_stress["m8"] * 2.0
run.plot("force", ax=None)
shape: strut.Scene = scene.form(given="prestress", least_tension="1 N").scene()
same: bool = scene == shape
x = scene.nodes["n1"].position[0] + table.array("velocity")[0]
text: str = scene.path(over="n1.x", until=1).svg(width="column") + str(strut.models / "a.yaml")
"""
WRONG = """
import strut
strut.load(3).run()
strut.load("a.yaml").simulation().advance("ten")
strut.load("a.yaml").modes(cout=1)
strut.load("a.yaml").form(given="nothing")
"""

if shutil.which("mypy") is None:
    print("mypy is not installed")
    sys.exit(77)


PACKAGE = os.path.abspath(os.environ["PYTHONPATH"])


class Types(unittest.TestCase):
    def check(self, *words: str) -> tuple[int, str]:
        done = subprocess.run(
            ["mypy", "--strict", "--no-error-summary", *words],
            capture_output=True,
            text=True,
            env={**os.environ, "MYPYPATH": PACKAGE},
            cwd=self.folder.name,
        )
        return done.returncode, done.stdout + done.stderr

    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_the_package_and_programs_that_use_it(self):
        self.assertEqual(self.check("-p", "strut"), (0, ""))
        program = pathlib.Path(self.folder.name, "program.py")
        program.write_text(RIGHT)
        self.assertEqual(self.check(str(program)), (0, ""))
        program.write_text(WRONG)
        code, printed = self.check(str(program))
        self.assertEqual((code, printed.count("error:")), (1, 4), printed)


main()

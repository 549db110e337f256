# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel installs by pip without network, computes and draws, and all libraries that it loads are its own.

    python3 tests/python/wheel_test.py WHEEL_FOLDER
"""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = """
import strut, sys
crawler = strut.load(strut.models / "crawler/crawler.yaml")
run = crawler.run(accuracy="1 %")
print("velocity", run.velocity)
print("sweep", *crawler.sweep(frequency=[9, 10], keep="velocity").status)
print("drawn", run.svg().count("<path") > 100, len(crawler.modes().svg()) > 1000)
"""
LOADED = """
for line in open("/proc/self/maps"):
    if ".so" in line:
        print("loaded", line.split()[-1])
"""
FORMATS = """
import contextlib, io, strut
from strut.formats.__main__ import main
assert main(["build", str(strut.models / "gallery/x-frame.yaml"), "-o", "parts"]) == 0
rows = open("parts/members.csv").read().splitlines()
with open("members.csv", "w") as file:
    file.write(rows[0] + ",stiffness [N/m]\\n" + "".join(row + ",1000\\n" for row in rows[1:]))
with contextlib.redirect_stderr(io.StringIO()):  # columns that are not read
    assert main(["import", "parts/nodes.csv", "members.csv", "-o", "again.yaml"]) == 0
"""
ARRAYS = """
import numpy, scipy.linalg, strut, matplotlib
matplotlib.use("agg")
from matplotlib import pyplot
run = strut.load(strut.models / "basics/x-frame.yaml").run()
run.plot("force").figure.savefig("figure.png")
print(run["position"].shape, numpy.linalg.inv(numpy.eye(3)).sum())
"""
if importlib.util.find_spec("ensurepip") is None:
    print("not installed: python3-venv")
    sys.exit(77)

OUTSIDE = re.compile(r"ld-linux|lib(c|m|dl|rt|pthread|resolv|util|gcc_s)\.so|libstdc\+\+\.so")
CLEAN = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "LANG": "C.UTF-8"}
FOLDER = pathlib.Path(sys.argv[1])


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.here = pathlib.Path(cls.folder.name)
        cls.python = cls.here / "venv/bin/python"
        (cls.wheel,) = FOLDER.glob("strut-*.whl")
        subprocess.run([sys.executable, "-m", "venv", cls.here / "venv"], check=True, env=CLEAN)
        before = time.monotonic()
        pip = [cls.python, "-m", "pip", "install", "-q", "--no-index", "--disable-pip-version-check", cls.wheel]
        subprocess.run(pip, check=True, env=CLEAN)
        took = time.monotonic() - before
        print(f"{cls.wheel.name}: {cls.wheel.stat().st_size / 1e6:.1f} MB, installed in {took:.1f} s")

    def run_python(self, text: str, **more: str) -> str:
        done = subprocess.run(
            [self.python, "-c", text],
            capture_output=True,
            text=True,
            check=False,
            env={**CLEAN, "MPLCONFIGDIR": str(self.here), **more},
            cwd=self.here,
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stderr)
        return done.stdout

    def test_it_computes_and_draws_with_libraries_of_its_own(self):
        said = [line.split(" ", 1) for line in self.run_python(PROGRAM + LOADED).splitlines()]
        values = dict(said)
        self.assertAlmostEqual(float(values["velocity"]), 0.01003, delta=1e-4)
        self.assertEqual(values["sweep"], "completed completed")
        self.assertEqual(values["drawn"], "True True")
        loaded = {path for word, path in said if word == "loaded"}
        own = {path for path in loaded if path.startswith(f"{self.here}/venv")}
        self.assertGreater(len(own), 30)
        pythons = self.run_python("import ctypes, tempfile\n" + LOADED)
        for path in loaded - own:
            outside = OUTSIDE.match(os.path.basename(path)) or "/lib-dynload/" in path or path in pythons
            self.assertTrue(outside, f"{path} is not of the wheel")

    def test_formats_of_other_programs(self):
        self.run_python(FORMATS)
        self.assertIn("falling: {kind: bar", (self.here / "again.yaml").read_text())

    def test_every_library_that_a_file_needs_is_inside(self):
        (package,) = self.here.glob("venv/lib/python*/site-packages/strut")
        libraries = {path.name for path in (package / "libs").iterdir()}
        for file in [package / "libstrut.so.0", *(package / "libs").iterdir()]:
            said = subprocess.run(["readelf", "-d", file], capture_output=True, text=True, check=True).stdout
            for needed in re.findall(r"\(NEEDED\).*\[(.*)\]", said):
                self.assertTrue(needed in libraries or OUTSIDE.match(needed), f"{file.name}: {needed}")
            where = set(re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", said))
            self.assertLessEqual(where, {"$ORIGIN", "$ORIGIN/libs"}, file.name)

    def test_licences_of_what_is_inside(self):
        (info,) = self.here.glob("venv/lib/python*/site-packages/strut-*.dist-info")
        there = {path.name for path in info.rglob("*")}
        for name in ("LICENSE", "libgfortran5.copyright", "fonts-dejavu-core.copyright"):
            self.assertIn(name, there)
        self.assertGreater(sum(name.endswith(".copyright") for name in there), 30)

    def test_beside_debians_numpy_and_matplotlib(self):
        debian = "/usr/lib/python3/dist-packages"
        if not all(os.path.isdir(f"{debian}/{name}") for name in ("numpy", "matplotlib", "scipy")):
            self.skipTest("numpy, scipy or matplotlib is not installed")
        self.assertIn("3.0", self.run_python(ARRAYS, PYTHONPATH=debian))
        self.assertGreater((self.here / "figure.png").stat().st_size, 5000)


unittest.main(argv=sys.argv[:1])

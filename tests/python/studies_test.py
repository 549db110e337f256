# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies by file in Python: the program's files and numbers, verdicts without exceptions, mistakes with places."""

import math
import os
import pathlib
import pickle
import random
import subprocess
import sys
import tempfile
import unittest.mock

from arrays import main, np, program, strut

MODEL = """strut: 1
name: spring
parameters: {k: 100 N/m, c: 1 N s/m, part: 1}
nodes: {w: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}
members: {s: {kind: spring, nodes: [w, b], stiffness: k*part, damping: c, rest_length: 0.9}}
solver: {step: 1 ms}
run: {duration: 0.5}
output: {every: 10 ms, channels: [position]}
"""
FIT = """strut: 1
study: Spring
model: model.yaml
data: {film: {file: film.csv}}
fit:
  over: {k: {from: 50 N/m, to: 200 N/m}, c: {from: 0.2 N s/m, to: 5 N s/m}}
  match: {film: {time: film.t, b.x: film.x, noise: 0.1 mm}}
  starts: 2
"""
POINTS = "strut: 1\nstudy: Points\nmodel: model.yaml\naxes: [{k: [50, 100, 1e9]}]\nkeep: [velocity]\n"
SEARCH = """strut: 1
study: Best
model: model.yaml
search: {over: {c: {from: 0.5 N s/m, to: 3 N s/m}}, maximise: velocity, starts: 1, evaluations: 12}
keep: [velocity]
"""


def film() -> str:
    """The mass on its spring by formula, with a noise of 0.1 mm."""
    rate, damping, chance = math.sqrt(100 - 0.25), 0.5, random.Random(1)
    lines = ["t [s],x [mm]"]
    for i in range(51):
        t = i / 100
        x = 0.9 + 0.1 * math.exp(-damping * t) * (math.cos(rate * t) + damping / rate * math.sin(rate * t))
        lines.append(f"{t},{1e3 * x + chance.gauss(0, 0.1):.6f}")
    return "\n".join(lines) + "\n"


class Studies(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        texts = {"model.yaml": MODEL, "film.csv": film(), "fit.yaml": FIT, "points.yaml": POINTS, "search.yaml": SEARCH}
        for name, text in texts.items():
            pathlib.Path(name).write_text(text)

    def assert_same_files(self, one: str, other: str) -> None:
        names = sorted(os.listdir(one))
        self.assertEqual(names, sorted(os.listdir(other)))
        for name in names:
            if name not in ("points.slots", ".strut-files"):  # how long points took, what was there before
                self.assertEqual(pathlib.Path(one, name).read_bytes(), pathlib.Path(other, name).read_bytes(), name)

    def test_a_fit_is_the_program_s(self):
        fractions: list[float] = []
        fit = strut.fit("fit.yaml", output="python", threads=2, progress=fractions.append)
        self.assertEqual(fit.json, program("sweep", "fit.yaml", "-o", "program", "--json"))
        self.assert_same_files("python", "program")
        self.assertTrue(fit.identified and not fit.undetermined and not fit.warnings)
        for name, truth in (("k", 100), ("c", 1)):
            found = fit.parameters[name]
            self.assertEqual(found.verdict, "identified")
            self.assertLess(abs(found.value - truth), 3 * found.standard_error)
            self.assertTrue(found.low < found.value < found.high)
        self.assertEqual([start.agrees for start in fit.starts], [True, True])
        self.assertEqual((fit.alignments, fit.omissions, fit.reason), ((), (), None))
        run = strut.load("model.yaml").run()
        self.assertEqual((run.steady, run.accuracy, run.measured), (None, None, None))
        self.assertEqual(fit.table.csv, pathlib.Path("python/table.csv").read_text())
        self.assertEqual((fit["k"][0], fractions[-1]), (fit.parameters.k.value, 1.0))
        again = pickle.loads(pickle.dumps(fit))
        self.assertEqual(again.figures, {file.name: file.read_text() for file in sorted(pathlib.Path("program").glob("*.svg"))})
        self.assertEqual(fit.svg(), again.figures["fit.svg"])
        fit.save("kept.csv")
        self.assertEqual(pathlib.Path("kept.csv").read_bytes(), pathlib.Path("program/table.csv").read_bytes())
        self.assertRaisesRegex(ValueError, "^'.png' is .*: .json .svg .csv$", fit.save, "kept.png")
        residuals = fit.plot(ax=unittest.mock.Mock()).plot.call_args.args[1]
        self.assertAlmostEqual(sum(r * r for r in residuals), fit.starts[0].sum, 6)
        self.assertEqual((again.parameters, list(again["end"])), (fit.parameters, list(fit["end"])))
        self.assertIn("k 99.", repr(fit))

    def test_what_is_not_identified_is_no_exception(self):
        pathlib.Path("fit.yaml").write_text(FIT.replace("c: {from: 0.2 N s/m, to: 5 N s/m}", "part: {from: 0.5, to: 2}"))
        fit = strut.fit("fit.yaml", output="python")
        program("sweep", "fit.yaml", "-o", "program", code=5)
        self.assert_same_files("python", "program")
        self.assertFalse(fit.identified)
        self.assertIsNone(fit.parameters["k"].low)
        self.assertNotEqual(fit.parameters["k"].verdict, "identified")
        self.assertIn("k", fit.undetermined[0].words)
        self.assertTrue(any("not all parameters are identified" in text for text in fit.warnings))

    def test_other_studies_have_tables(self):
        study = strut.sweep("points.yaml", output="python", set={"c": "2 N s/m"})
        program("sweep", "points.yaml", "-o", "program", "--set", "c=2 N s/m", code=3)
        self.assert_same_files("python", "program")
        self.assertEqual((study.points, study.failed, len(study.table)), (3, 1, 3))
        self.assertEqual([*study.plot("k", ax=unittest.mock.Mock()).plot.call_args.args[1]], [50e-9, 100e-9, 1])
        self.assertEqual([status == "completed" for status in study.table.status], [True, True, False])
        self.assertTrue(np.isfinite(study["velocity"][:2]).all() and study["message"][2])
        self.assertTrue(any("1 of 3 points failed" in text for text in study.warnings))
        self.assertEqual(strut.sweep("points.yaml", output="python", set={"c": "2 N s/m"}).computed, 0)
        self.assertEqual(strut.sweep("points.yaml", output="python", set={"c": "2 N s/m"}, retry=True).computed, 1)
        best = strut.sweep("search.yaml", output="best")
        self.assertEqual(best.json, program("sweep", "search.yaml", "-o", "searched", "--json").replace("searched/", "best/"))
        self.assertIn(best.best[0].objective, best["velocity"])

    def test_mistakes_have_places(self):
        pathlib.Path("fit.yaml").write_text(FIT.replace("{k: {from", "{kk: {from").replace("starts: 2", "starts: many"))
        with self.assertRaises(strut.SceneError) as caught:
            strut.fit("fit.yaml")
        self.assertEqual([m.line for m in caught.exception.messages], sorted(m.line for m in caught.exception.messages))
        self.assertEqual((caught.exception.file, caught.exception.line), ("fit.yaml", 6))
        self.assertIn("did you mean 'k'?", caught.exception.report)
        pathlib.Path("fit.yaml").write_text(FIT)
        pathlib.Path("model.yaml").write_text(MODEL.replace("mass: 1", "mass: -1").replace("kind: spring", "kind: sprang"))
        with self.assertRaises(strut.SceneError) as caught:
            strut.fit("fit.yaml")
        self.assertEqual([m.line for m in caught.exception.messages if m.file == "model.yaml"], [4, 5])
        pathlib.Path("model.yaml").write_text(MODEL)
        for call, error, text in ((lambda: strut.fit("points.yaml"), strut.UsageError, "not a study that fits"),
                                  (lambda: strut.fit("fit.yaml", retry=True), strut.UsageError, "retry=True"),
                                  (lambda: strut.fit("fit.yaml", threads=0), strut.UsageError, "threads"),
                                  (lambda: strut.sweep("fit.yaml", set={"m": 1}), strut.SceneError, "'m'"),
                                  (lambda: strut.sweep("no.yaml"), FileNotFoundError, "no.yaml"),
                                  (lambda: strut.sweep("fit.yaml", output="film.csv"), strut.FileError, "film.csv")):
            with self.assertRaisesRegex(error, text):
                call()

    def test_nothing_is_printed(self):
        code = "import strut; strut.fit('fit.yaml'); strut.sweep('points.yaml')"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_an_interrupted_study_resumes(self):
        def stop(fraction: float) -> None:
            if fraction > 0:  # on a busy machine no point is done at first
                raise RuntimeError("enough")

        many = POINTS.replace("[50, 100, 1e9]", "{from: 50, to: 100, count: 3000}")
        pathlib.Path("points.yaml").write_text(many)
        with self.assertRaisesRegex(RuntimeError, "enough"):
            strut.sweep("points.yaml", output="python", progress=stop)
        study = strut.sweep("points.yaml", output="python")
        self.assertEqual(len(study.table), 3000)
        self.assertLess(study.computed, 3000)
        program("sweep", "points.yaml", "-o", "program")
        self.assert_same_files("python", "program")


main()

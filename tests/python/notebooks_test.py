# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs and the notebook of docs/python run and draw; those whose libraries are not installed are left out."""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from support import ROOT, main, skip_without

skip_without("numpy", "matplotlib")

NEEDS = {"controller": "matplotlib", "crawlers": "matplotlib", "gait": "scipy", "sensitivity": "openturns"}


class Notebooks(unittest.TestCase):
    def test_every_one_runs_and_draws(self):
        files = {path.stem: path for path in (ROOT / "docs/python").glob("*.py")}
        self.assertEqual(set(files), set(NEEDS))
        for name, path in files.items():
            if importlib.util.find_spec(NEEDS[name]) is None:
                print(f"{name}: {NEEDS[name]} is not installed", flush=True)
                continue
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                picture = pathlib.Path(folder, "picture.png")
                done = subprocess.run(
                    [sys.executable, path, picture],
                    capture_output=True,
                    text=True,
                    env={**os.environ, "MPLCONFIGDIR": folder},
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertGreater(picture.stat().st_size, 10000)
                print(done.stdout, flush=True)

    def test_the_cells_of_the_notebook_run_in_order(self):
        cells = json.loads((ROOT / "docs/python/first-steps.ipynb").read_text())["cells"]
        self.assertEqual(len(cells), 10)
        program = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder,
                                  env={**os.environ, "MPLCONFIGDIR": folder, "MPLBACKEND": "agg"})
            self.assertEqual(done.returncode, 0, done.stderr)
            for words in ("accurate to within", "at 8 Hz", "limit point"):
                self.assertIn(words, done.stdout.replace("_", " "))


main()

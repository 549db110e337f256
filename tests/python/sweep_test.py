# SPDX-License-Identifier: GPL-3.0-or-later
"""A sweep in Python: the bits of the program's table, whole samples, failures as rows, interrupts."""

import csv
import pathlib
import pickle
import tempfile
import unittest

from arrays import CRAWLER, interrupt, main, np, program, strut

STUDY = """strut: 1
study: A few points
model: {model}
axes: [{{friction: [0.1, 0.3]}}, {{start: [I, II]}}, {{frequency: [9 Hz, 10 Hz, 11.3 Hz]}}]
keep: [velocity, outcome, work]
"""
AXES = {"friction": [0.1, 0.3], "start": ["I", "II"], "frequency": ["9 Hz", 10, np.float64(11.3)]}


def quick_crawler() -> str:
    """The crawler with a tenth of its periods, as a text."""
    return CRAWLER.read_text().replace("periods: 1100", "periods: 40").replace("last: 100", "last: 10")


class Sweeps(unittest.TestCase):
    def setUp(self) -> None:
        self.scene = strut.loads(quick_crawler())

    def test_options_of_method_and_model_are_those_of_run(self):
        for options in ({"accuracy": "1 %"}, {"integrator": "verlet", "step": "30 us"},
                        {"integrator": "rk4-events", "friction_law": "coulomb"}):
            table = self.scene.sweep({"friction": [0.1, 0.3]}, keep=["velocity"], **options)
            wanted = [self.scene(friction=f).run(**options).velocity for f in (0.1, 0.3)]
            self.assertEqual(list(table["velocity"]), wanted, options)
        for options, text in (({"integrator": "rk5"}, "rk4"), ({"accuracy": "-1"}, "accuracy"),
                              ({"tolerance": "1 kg"}, "tolerance"), ({"bars": "soft"}, "rigid")):
            with self.assertRaisesRegex(strut.UsageError, text):
                self.scene.sweep({"friction": [0.1, 0.3]}, keep=["velocity"], **options)

    def test_the_table_has_the_bits_of_the_programs(self):
        table = self.scene.sweep(AXES, keep=["velocity", "outcome", "work"])
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "crawler.yaml").write_text(quick_crawler())
            study = pathlib.Path(folder, "study.yaml")
            study.write_text(STUDY.format(model="crawler.yaml"))
            program("sweep", study, "--quiet", "-o", f"{folder}/results")
            text = pathlib.Path(folder, "results/table.csv").read_text()
        rows = list(csv.reader(text.splitlines()))
        self.assertEqual(len(rows) - 1, len(table))
        for i, header in enumerate(rows[0]):
            name = header.split(" [")[0]
            if name not in table.columns:
                self.assertEqual(name, "point")
                continue
            column = table[name]
            if isinstance(column, tuple):
                words = [row[i] for row in rows[1:]]
                self.assertEqual([word or "" for word in column], words, name)
            else:
                np.testing.assert_array_equal(column, [float(row[i] or "nan") for row in rows[1:]])
        self.assertEqual(table.shape, (2, 2, 3))
        self.assertEqual(table.grid("velocity").shape, (2, 2, 3))
        self.assertEqual(table["start"][:4], ("I", "I", "I", "II"))
        np.testing.assert_array_equal(table["frequency"][:3], [9, 10, 11.3])
        self.assertEqual(set(table.status), {"completed"})
        self.assertEqual(table.array("frequency", "velocity").shape, (12, 2))
        row = list(table)[5]
        self.assertEqual((row["friction"], row["start"], row["frequency"]), (0.1, "II", 11.3))
        self.assertNotIn("\n", repr(table))
        again = pickle.loads(pickle.dumps(table))
        np.testing.assert_array_equal(again["velocity"], table["velocity"])
        self.assertEqual((again["outcome"], again.csv), (table["outcome"], table.csv))

    def test_threads_and_samples_change_no_bit(self):
        samples = np.column_stack([np.linspace(8, 12, 9), np.linspace(0.1, 0.5, 9)])
        names = ["frequency", "friction"]
        tables = [
            self.scene.sweep(points=points, names=names, keep="velocity", threads=threads)
            for points in (samples, samples.tolist(), np.asfortranarray(samples))
            for threads in (1, 2)
        ]
        for table in tables:
            np.testing.assert_array_equal(table["velocity"], tables[0]["velocity"])
            np.testing.assert_array_equal(table.array(*names), samples)
        runs = [self.scene(frequency=f, friction=mu).run().velocity for f, mu in samples[[0, 4]]]
        np.testing.assert_array_equal(tables[0]["velocity"][[0, 4]], runs)

    def test_a_point_that_fails_is_a_row(self):
        table = self.scene.sweep(step=["0.1 ms", "1 ms"], keep="velocity")
        self.assertEqual(table.status, ("completed", "the step is above the stability limit"))
        self.assertTrue(np.isnan(table["velocity"][1]) and not np.isnan(table["velocity"][0]))
        self.assertIn("stable step", table["message"][1])
        self.assertIn("1 failed", repr(table))

    def test_bad_sweeps_are_refused(self):
        for error, call in (
            (TypeError, lambda: self.scene.sweep(frequenz=[1, 2])),
            (strut.Error, lambda: self.scene.sweep({"frequenz": [1, 2]})),
            (strut.Error, lambda: self.scene.sweep(frequency=[1, float("nan")])),
            (strut.Error, lambda: self.scene.sweep(frequency=[1], keep="speed")),
            (strut.Error, lambda: self.scene.sweep(frequency=[])),
            (strut.Error, lambda: self.scene.sweep(frequency=["3 kg"])),
            (strut.Error, lambda: self.scene.sweep(frequency=[1], threads=-1)),
            (TypeError, lambda: self.scene.sweep(points=[[1]])),
            (TypeError, lambda: self.scene.sweep(points=[[1]], names=["frequency"], friction=[1])),
            (TypeError, lambda: self.scene.sweep(frequency=[None])),
            (ValueError, lambda: self.scene.sweep(points=[[1, 2]], names=["frequency"])),
            (ValueError, lambda: self.scene.sweep(points=np.zeros(3), names=["frequency"])),
        ):
            self.assertRaises(error, call)

    def test_ctrl_c_keeps_the_points_that_are_done(self):
        scene = strut.load(CRAWLER)
        seen = []
        many = {"frequency": np.linspace(8, 12, 1000), "step": ["0.1 ms"]}
        table = interrupt(lambda: scene.sweep(many, keep="velocity", progress=seen.append), 1.5).result
        self.assertIn("interrupted", table.status)
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(self.scene.sweep(friction=[0.1])["friction"][0], 0.1)


main()

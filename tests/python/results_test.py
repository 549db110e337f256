# SPDX-License-Identifier: GPL-3.0-or-later
"""Python gets what the program prints: the same bytes of JSON, the same bits of every number, on ten models."""

import csv
import json
import pathlib
import tempfile
import unittest

from arrays import MODELS, main, np, program, strut

from strut import _values
from strut.formats import matrix_market

RUNS = {
    "crawler/crawler": {"accuracy": "1 %"},
    "basics/belt": {},
    "basics/bouncing-node": {},
    "basics/oscillator": {},
    "basics/pendulum": {},
    "basics/sliding-block": {},
    "basics/slope": {},
    "basics/spinning-bar": {},
    "basics/x-frame": {},
    "gallery/two-mass-crawler": {"integrator": "rk4-events"},
}


def columns_of(path: pathlib.Path) -> dict:
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return {name: np.array([float(row[i] or "nan") for row in rows[1:]]) for i, name in enumerate(rows[0])}


class Runs(unittest.TestCase):
    def test_a_run_has_the_bytes_of_the_programs_files(self):
        for name, options in RUNS.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                model = MODELS / f"{name}.yaml"
                words = [f"--{option}={value}" for option, value in options.items()]
                program("run", model, "--quiet", *words, "-o", f"{folder}/run")
                there = pathlib.Path(folder, "run")
                run = strut.load(model).run(**options)
                self.assertEqual(run.json, (there / "summary.json").read_text())
                self.assertEqual(run.to_yaml(), (there / "scene.yaml").read_text())
                paths = list(there.glob("*.csv"))
                self.assertTrue(paths)
                for path in paths:
                    for column, numbers in columns_of(path).items():
                        mine = recorded(run, path.stem, column)
                        np.testing.assert_array_equal(mine, numbers, f"{path.name}: {column}")

    def test_what_is_recorded_changes_no_number(self):
        for name in ("crawler/crawler", "topologies/jib"):
            with self.subTest(name):
                scene, options = strut.load(MODELS / f"{name}.yaml"), {"accuracy": "1 %", "steady": "0.5 %"}
                run = scene.run(**options)
                self.assertEqual(scene.run(record="no", **options).json, run.json)
                keep = ["velocity", "duration", "work", "positions"]
                table = scene.sweep(keep=keep, **options)
                self.assertEqual(table["accuracy_kept"][0], 1)
                self.assertEqual(table["duration"][0], run.duration)
                self.assertEqual(table["drive_work"][0], run.energy.drive_work)
                node = scene.names("nodes")[0]
                self.assertEqual(table[f"x_{node}"][0], run.nodes[node].position[0])


def recorded(run: strut.Run, file: str, column: str):
    """The array of a column such as "n1.vx [m/s]" of nodes.csv."""
    name = column.split(" [")[0]
    if name == "time":
        return run.time
    if file == "energy":
        return run["energy"][name]
    thing, _, word = name.rpartition(".")
    if file == "nodes":
        return getattr(run.nodes[thing], word)
    if file == "members":
        return run[word][thing]
    return run[f"{file.rstrip('s')}.{thing}.{word}"]


class Statics(unittest.TestCase):
    def test_statics_have_the_bytes_of_the_programs_json(self):
        cases = [
            ("crawler/crawler", "modes", {"at": "II"}, {}),
            ("crawler/crawler", "rigidity", {"at": "I"}, {}),
            ("basics/von-mises-truss", "equilibria", {}, {}),
            ("basics/von-mises-truss", "rigidity", {}, {}),
            ("basics/x-frame", "modes", {}, {}),
            ("gallery/x-frame", "rigidity", {}, {}),
            ("gallery/x-frame", "form", {"given": "prestress"}, {}),
            ("gallery/von-mises", "path", {"load": "weight"}, {"load": 1}),
        ]
        for name, command, options, settings in cases:
            with self.subTest(f"{command} {name}"):
                model = MODELS / f"{name}.yaml"
                words = [f"--{option}={value}" for option, value in zip(*_values.options(options))]
                words += [f"--set={name}={value}" for name, value in settings.items()]
                printed = program(command, model, "--json", "--quiet", *words)
                scene = strut.load(model, settings)
                mine = getattr(scene, command)(**options)
                self.assertEqual(mine.json, printed)
                self.assertEqual(json.loads(json.dumps(mine.summary)), json.loads(printed))

    def test_matrices_are_those_of_the_exported_files(self):
        model = MODELS / "crawler/crawler.yaml"
        with tempfile.TemporaryDirectory() as folder:
            matrix_market.write(strut.load(model), f"{folder}/m", "II")
            matrices = strut.load(model).matrices(at="II")
            for path in pathlib.Path(folder, "m").glob("*.mtx"):
                lines = [x for x in path.read_text().splitlines()]
                numbers = [list(map(float, x.split())) for x in lines if x[0] != "%"]
                dense = np.zeros([int(n) for n in numbers[0][:2]])
                for row, column, value in numbers[1:]:
                    dense[int(row) - 1, int(column) - 1] = value
                    if "symmetric" in lines[0]:
                        dense[int(column) - 1, int(row) - 1] = value
                np.testing.assert_array_equal(matrices.dense(path.stem), dense, path.stem)

    def test_equilibria_are_found_by_name(self):
        found = strut.load(MODELS / "crawler/crawler.yaml").equilibria()
        self.assertEqual(found["II"].name, "II")
        self.assertEqual(found["II"].outcome, "stands")
        energies = [equilibrium.energy for equilibrium in found]
        np.testing.assert_array_equal(found.energy, energies)
        self.assertEqual(found.array("equilibria.nodes").shape, (len(found), 5, 2))
        self.assertEqual(len(found["II"].modes().frequency), 10)
        self.assertRaisesRegex(KeyError, "did you mean 'I", lambda: found["IIII"])


class Values(unittest.TestCase):
    def test_words_are_attributes_and_recordings_items(self):
        run = strut.load(MODELS / "basics/x-frame.yaml").run(channels="position,force,energy")
        self.assertEqual(run.summary["energy"]["residual"], run.energy.residual)
        self.assertEqual(run["position"].shape, (len(run.time), 4, 2))
        np.testing.assert_array_equal(run["position"][run["position"].names[1]][:, 1],
                                      run.nodes[run["position"].names[1]].y)
        member = run["force"].names[0]
        np.testing.assert_array_equal(run["force." + member], run.members[member].force)
        np.testing.assert_array_equal(run["energy.kinetic"], run["energy"]["kinetic"])
        self.assertEqual(run.unit("force"), "N")
        self.assertIn("completed", repr(run))
        self.assertNotIn("\n", repr(run))
        self.assertRaisesRegex(AttributeError, "did you mean 'energy'", lambda: run.enrgy)
        with self.assertRaises(ValueError):
            run.time[0] = 1  # results do not change

    def test_arrays_outlive_what_they_are_of(self):
        force = strut.load(MODELS / "basics/x-frame.yaml").run().array("force")
        kept = force.copy()
        strut.load(MODELS / "basics/x-frame.yaml", {}).run()
        np.testing.assert_array_equal(force, kept)

    def test_a_scene_comes_back_from_a_dictionary(self):
        scene = strut.load(MODELS / "crawler/crawler.yaml", friction=0.2)
        again = strut.Scene.from_dict(scene.to_dict())
        self.assertEqual(again.to_dict(), scene.to_dict())
        self.assertEqual(again.modes().json, scene.modes().json)
        self.assertEqual(scene.members["m8"].rest_length, 0.01)
        self.assertEqual(scene["parameters.friction"], 0.2)
        self.assertEqual(scene(start="III")["parameters.start"], "III")
        numbers = {"nodes": {"a": np.array([0.0, 0]), "b": (np.float32(1), np.int64(0))}}
        described = {"strut": 1, **numbers, "members": {"m": {"kind": "spring", "nodes": ["a", "b"],
                     "stiffness": "4 N/cm"}}}
        described["nodes"]["b"] = {"position": described["nodes"]["b"], "mass": 1}
        built = strut.Scene.from_dict(described)
        self.assertEqual(built["members.m.stiffness"], 400.0)
        np.testing.assert_array_equal(built.array("nodes.position"), [[0, 0], [1, 0]])

    def test_notebooks_get_a_drawing_and_a_page(self):
        scene = strut.load(MODELS / "basics/x-frame.yaml")
        self.assertIn("<svg", scene._repr_html_())
        run = scene.run()
        self.assertTrue(run._repr_html_().startswith("<iframe srcdoc="))
        self.assertIn("<svg", run.svg())
        self.assertTrue(scene.run(record=False)._repr_html_().startswith("<table>"))

    def test_tables_for_pandas(self):
        skip = __import__("importlib.util").util.find_spec("pandas") is None
        if skip:
            self.skipTest("pandas is not installed")
        run = strut.load(MODELS / "basics/pendulum.yaml").run()
        table = run.to_pandas()
        self.assertEqual(len(table), len(run.time))
        name = [c for c in table.columns if c.startswith("position")][-1]
        np.testing.assert_array_equal(table[name], run[name])


main()

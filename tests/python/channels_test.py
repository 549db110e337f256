# SPDX-License-Identifier: GPL-3.0-or-later
"""A channel of the table is the same numbers by CSV, HDF5 and page, in a run, a simulation and a pickle."""

import base64
import csv
import json
import pathlib
import pickle
import re
import tempfile
import unittest
import zlib

from arrays import main, np, program, strut

from strut import _strut

SCENE = """strut: 1
nodes: {a: {position: [-0.5, 0], mass: 0.1}, b: {position: [0.5, 0], mass: 0.2}, c: {position: [0, 0.6], mass: 0.3}}
members: {ab: {kind: spring, nodes: [a, b], stiffness: 2000, mass: 0.5},
          bc: {kind: spring, nodes: [b, c], stiffness: 1000, mass: 0.2},
          ca: {kind: cable, nodes: [c, a], stiffness: 1500, mass: 0.1}}
initial: {velocities: {a: [0.1, -1], b: [0, 2], c: [-1, 0.3]}}
solver: {step: 0.1 ms}
run: {duration: 0.5 s}
output: {every: 5 ms, channels: [position, angular_momentum]}
"""
NAME = "angular_momentum"


def decoded(block: dict, frames: int) -> np.ndarray:
    """A page's block (frames, columns), as player.js decodes it."""
    numbers, value, shift = [], 0, 0
    for byte in zlib.decompress(base64.b64decode(block["bytes"]), -15):
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(-(value + 1) // 2 if value % 2 else value // 2)
            value = shift = 0
    columns = np.array(numbers, dtype=float).reshape(block["columns"], frames)
    columns[:, 1:] = columns[:, :1] + np.cumsum(np.cumsum(columns[:, 1:], axis=1), axis=1)
    return columns.T * block["quantum"]


class Channels(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.place = pathlib.Path(cls.folder.name)
        (cls.place / "spin.yaml").write_text(SCENE)
        program("run", cls.place / "spin.yaml", "--quiet", "-o", cls.place / "out")
        cls.scene = strut.load(cls.place / "spin.yaml")
        cls.run_ = cls.scene.run(record=True)
        cls.array = np.asarray(cls.run_[NAME])

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_the_csv_has_these_numbers(self) -> None:
        with open(self.place / "out" / "nodes.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        for i, name in enumerate(["a", "b", "c", "total"]):
            column = [float(row[f"{name}.{NAME} [kg m^2/s]"]) for row in rows]
            self.assertEqual(column, self.array[:, i].tolist())

    def test_hdf5_has_these_numbers(self) -> None:
        # The program reads its trajectory.h5 again for the page.
        program("view", self.place / "out", "-o", self.place / "page.html")
        page = (self.place / "page.html").read_text()
        data = json.loads(re.search(r'id="strut-data">(.*?)</script>', page, re.S).group(1))
        motion = data["motion"]
        block = motion[NAME]
        self.assertEqual(block["unit"], "kg m^2/s")
        self.assertEqual((block["names"], block["columns"]), (["a", "b", "c", "total"], 4))
        there = decoded(block, motion["frames"])
        self.assertEqual(motion["frames"], len(self.array))
        self.assertLessEqual(np.abs(there - self.array).max(), 0.51 * block["quantum"])

    def test_a_run_names_them(self) -> None:
        named = self.run_[NAME]
        self.assertEqual(named.names, ("a", "b", "c", "total"))
        self.assertEqual(self.run_[f"{NAME}.total"].tolist(), self.array[:, 3].tolist())
        self.assertEqual(self.run_.nodes["b"].angular_momentum.tolist(), self.array[:, 1].tolist())
        self.assertLess(np.ptp(self.array[:, 3]) / self.array[0, 3], 1e-10)
        self.assertEqual(self.run_._raw.unit(NAME), "kg m^2/s")
        again = pickle.loads(pickle.dumps(self.run_))
        self.assertEqual(again[f"{NAME}.total"].tolist(), self.array[:, 3].tolist())

    def test_it_may_be_asked_for(self) -> None:
        only = self.scene.run(channels=NAME)
        self.assertEqual(only.channels, (NAME,))
        self.assertEqual(np.asarray(only[NAME]).tolist(), self.array.tolist())

    def test_every_observable_is_a_channel(self) -> None:
        run = self.scene.run(channels="position,com.x,energy.total,stretch")
        self.assertEqual(run.channels, ("position", "stretch", "com.x", "energy.total"))
        self.assertEqual(run["com.x"].shape, (len(run.time), 1))
        self.assertEqual(run["stretch.bc"].tolist(), run["stretch"]["bc"].tolist())
        self.assertEqual(run.members["ab"].stretch.tolist(), run["stretch"]["ab"].tolist())
        again = pickle.loads(pickle.dumps(run))
        self.assertEqual(again["energy.total"].tolist(), run["energy.total"].tolist())

    def test_a_simulation_has_it(self) -> None:
        simulation = self.scene.simulation()
        live = simulation.angular_momentum
        self.assertEqual(live.names, ("a", "b", "c", "total"))
        self.assertEqual(live["total"], self.array[0, 3])
        simulation.advance(50)
        self.assertEqual(list(live), self.array[1].tolist())

    def test_all_channels_are_described(self) -> None:
        channels = {name: (kind, parts, columns) for name, kind, parts, columns in _strut.channels()}
        self.assertEqual(channels["velocity"], ("nodes", ("x", "y"), ("vx", "vy")))
        self.assertEqual(channels[NAME], ("nodes", (), (NAME,)))
        self.assertEqual(channels["contact"][1], ("normal", "friction"))
        self.assertEqual(channels["energy"][:2], ("energies", ()))
        self.assertEqual(self.scene.names("energy"), self.scene.names("energies"))
        with self.assertRaises(strut.UsageError) as caught:
            self.scene.run(channels="momentum")
        self.assertIn(NAME, str(caught.exception))


if __name__ == "__main__":
    main()

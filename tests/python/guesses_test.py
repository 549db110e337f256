# SPDX-License-Identifier: GPL-3.0-or-later
"""What people try first works, or the error says what does; every command of the program has its place in Python."""

import os
import pathlib
import pickle
import re
import tempfile
import unittest

from support import MODELS, main, program, skip_without

skip_without("numpy")
import strut  # noqa: E402

ROBOT = MODELS / "basics/robot.yaml"


class Guesses(unittest.TestCase):
    def test_values_by_name(self):
        robot = strut.load(ROBOT)
        self.assertEqual(robot["frequency"], 5.0)
        self.assertEqual(robot["parameters.friction"], 0.4)
        self.assertIsNone(robot.get("run.duration"))
        self.assertEqual(robot["nodes"]["top"].position, (0.05, 0.06))
        self.assertRaisesRegex(KeyError, "did you mean 'frequency'", lambda: robot["frequncy"])
        self.assertRaisesRegex(AttributeError, "did you mean 'equilibria'", lambda: robot.equlibria)
        self.assertRaisesRegex(AttributeError, r"scene\['frequency'\]", lambda: robot.frequency)
        self.assertRaisesRegex(AttributeError, "scene.NAME=VALUE.", lambda: robot.copy)
        self.assertRaisesRegex(TypeError, "scene.NAME=VALUE.", lambda: robot.__setitem__("frequency", 6))
        self.assertRaisesRegex(KeyError, "^no name 'frnt'; did you mean 'front'", lambda: robot.nodes["frnt"])

    def test_runs(self):
        robot = strut.load(ROBOT)
        self.assertEqual(strut.run(ROBOT).velocity, robot.run().velocity)
        self.assertEqual(robot.run(frequency=6).velocity, robot(frequency=6).run().velocity)
        self.assertAlmostEqual(robot.run(duration=0.3).duration, 0.3)
        self.assertNotIn("steady", robot.run(steady=False).summary)
        self.assertRaisesRegex(TypeError, "did you mean 'friction'", robot.run, fricton=1)
        crawler = strut.load(MODELS / "crawler/crawler.yaml")  # records its last 10 periods
        self.assertEqual(crawler.run(duration=0.05)["time"][-1], 0.05)
        self.assertAlmostEqual(crawler.run(periods=2)["time"][-1], 0.2)

    def test_results(self):
        run = strut.load(ROBOT).run()
        self.assertEqual(run.t.tolist(), run.time.tolist())
        self.assertRaisesRegex(AttributeError, "run.nodes", lambda: run.x)
        self.assertRaisesRegex(AttributeError, "view", lambda: run.animate)
        self.assertEqual(run.position["top"].tolist(), run["position"]["top"].tolist())
        self.assertRaisesRegex(AttributeError, "did you mean 'position'", lambda: run.positions)
        self.assertRaisesRegex(AttributeError, "to_pandas", lambda: run.df)
        self.assertRaisesRegex(KeyError, r"run.nodes\['top'\]", lambda: run["top.x"])
        self.assertRaisesRegex(KeyError, r"run.members\['muscle'\]", lambda: run["muscle"])
        self.assertRaisesRegex(AttributeError, "^no word in this result 'qqq'; there are [a-z]", lambda: run.qqq)
        with tempfile.TemporaryDirectory() as made:
            folder = pathlib.Path(made)
            for name in ("a.json", "a.svg", "a.html", "a.yaml", "a.csv"):
                run.save(folder / name)
                self.assertGreater(os.path.getsize(folder / name), 100)
            head, first = (folder / "a.csv").read_text().split("\n")[:2]
            self.assertEqual(head.split(",")[:2], ["time", "position.rear.x"])
            self.assertEqual(float(first.split(",")[1]), run["position.rear.x"][0])
            self.assertRaisesRegex(ValueError, "a.png|'.png'", run.save, folder / "a.png")

    def test_a_controller(self):
        robot = strut.load(ROBOT)
        calls = []

        def hold(sim):
            calls.append(sim.time)
            sim.rest["muscle"] = sim.rest0["muscle"]

        motion = robot.run(controller=hold, duration=0.01, step="0.1 ms")
        self.assertEqual(len(calls), 100)
        self.assertEqual(motion["position"]["top"].shape, (100, 2))
        self.assertEqual(pickle.loads(pickle.dumps(motion)).position["top"].shape, (100, 2))
        self.assertRaisesRegex(AttributeError, "did you mean 'position'", lambda: motion.positon)
        self.assertEqual(motion.velocity, robot.run(duration=0.01, step="0.1 ms").velocity)
        sim = robot.simulation(step="0.1 ms")
        sim.advance_to(0.01)
        self.assertAlmostEqual(sim.time, 0.01)
        sim.advance_to(0.005)
        self.assertAlmostEqual(sim.time, 0.01)
        self.assertRaisesRegex(ValueError, "duration", robot.run, controller=hold, step="0.1 ms")

    def test_every_command_has_its_place(self):
        commands = re.findall(r"^  ([a-z]+)  ", program("help"), re.M)
        self.assertGreater(len(commands), 14)
        for command in commands:
            if not hasattr(strut, command):
                self.assertRaisesRegex(AttributeError, f"no 'strut.{command}': .", getattr, strut, command)
        self.assertRaisesRegex(AttributeError, "did you mean 'load'", lambda: strut.laod)
        self.assertRaisesRegex(AttributeError, "strut.load", lambda: strut.Model)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""What people try first works, or the error says what does; every command of the program has its place in Python."""

import os
import pathlib
import pickle
import re
import tempfile
import unittest.mock

from support import MODELS, main, program, skip_without

skip_without("numpy")
import strut  # noqa: E402

ROBOT = MODELS / "basics/robot.yaml"


class Guesses(unittest.TestCase):
    def test_values_by_name(self):
        robot = strut.load(ROBOT)
        self.assertEqual((robot["frequency"], robot["parameters.friction"]), (5.0, 0.4))
        self.assertEqual((robot.get("run.duration"), robot["nodes"]["top"].position), (None, (0.05, 0.06)))
        self.assertRaisesRegex(KeyError, "did you mean 'frequency'", lambda: robot["frequncy"])
        for name, said in (("equlibria", "did you mean 'equilibria'"), ("frequency", r"scene\['frequency'\]"),
                           ("copy", "scene.NAME=VALUE."), ("save", "to_yaml"), ("film", "--animate")):
            self.assertRaisesRegex(AttributeError, said, getattr, robot, name)
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
        self.assertEqual(run.position["top"].tolist(), run["position"]["top"].tolist())
        self.assertRaisesRegex(KeyError, r"run.nodes\['top'\]", lambda: run["top.x"])
        self.assertRaisesRegex(KeyError, r"run.members\['muscle'\]", lambda: run["muscle"])
        for name, said in (("x", "run.nodes"), ("animate", "view"), ("film", "save"), ("positions", "did you mean 'position'"), ("df", "to_pandas"),
                           ("qqq", "^no word in this result 'qqq'; there are [a-z]")):
            self.assertRaisesRegex(AttributeError, said, getattr, run, name)
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
        self.assertEqual(motion["position"]["top"].shape, (101, 2))
        self.assertEqual(pickle.loads(pickle.dumps(motion)).position["top"].shape, (101, 2))
        self.assertRaisesRegex(AttributeError, "did you mean 'position'", lambda: motion.positon)
        self.assertEqual(motion.velocity, robot.run(duration=0.01, step="0.1 ms").velocity)
        sim = robot.simulation(step="0.1 ms")
        sim.advance_to(0.01)
        self.assertAlmostEqual(sim.time, 0.01)
        sim.advance_to(0.005)
        self.assertAlmostEqual(sim.time, 0.01)
        self.assertRaisesRegex(ValueError, "duration", robot.run, controller=hold, step="0.1 ms")
        self.assertAlmostEqual(float(sim.com.x), robot.run(duration=0.01, step="0.1 ms", channels="com.x").com.x[-1])

    def test_a_controlled_run_is_as_good_as_a_run(self):
        robot, how = strut.load(ROBOT), {"duration": 0.1, "step": "0.1 ms"}
        for more in ({"every": "10 ms", "channels": "position,energy,com.x"}, {"every": "3.33 ms"}, {"every": "30 us"}, {},
                     {"duration": 0.01234, "channels": ["com"]}, {"integrator": "rk4-events", "every": "0.7 ms"}):
            run, motion = (robot.run(**{**how, **more}, **controlled) for controlled in ({}, {"controller": lambda sim: None}))
            self.assertEqual((motion.channels, motion.time.tolist()), (run.channels, run.time.tolist()), more)
            for name in motion.channels:
                self.assertEqual(motion[name].tolist(), run[name].tolist(), (name, more))
                self.assertEqual(motion.unit(name), run.unit(name))
            own, energy = dict(motion.summary), dict(motion.energy)
            self.assertEqual(energy.pop("input_work"), 0)
            self.assertEqual({**own, "energy": energy}, run.summary)
        run, motion = robot.run(**how), robot.run(controller=lambda sim: None, **how)
        self.assertEqual((motion.svg(), motion.to_csv()), (run.svg(), run.to_csv()))
        self.assertIn("completed", repr(pickle.loads(pickle.dumps(motion))))
        self.assertTrue(motion.view().html.startswith("<!DOCTYPE html>"))

        def push(sim):
            sim.load["top"] = (0, 0.1)

        how |= {"every": "10 ms"}
        pushed = robot.run(controller=push, **how)
        self.assertGreater(abs(pushed.energy.load_work + pushed.energy.input_work), 1e-5)
        self.assertLess(abs(pushed.energy.residual), 1e-8)

        def pull(sim):
            sim.rest[0] = sim.rest0[0] * (1 - 0.02 * sim.time)

        pulled = robot.run(controller=pull, **how)
        self.assertGreater(abs(pulled.energy.input_work), 1e-5)
        self.assertLess(abs(pulled.energy.residual), 1e-3 * abs(pulled.energy.input_work))

        def look_ahead(sim):
            here = sim.snapshot()
            sim.load["top"] = (0, 5)
            sim.advance(300)
            sim.restore(here)

        more = {"integrator": "rk4-events", "every": "0.3 ms"}
        run, motion = robot.run(**how | more), robot.run(controller=look_ahead, **how | more)
        self.assertEqual((motion.table.split("computed")[0], motion.to_csv()), (run.table.split("computed")[0], run.to_csv()))

        def stop(sim):
            if sim.time > 0.05:
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt) as caught:
            robot.run(controller=stop, **how)
        self.assertEqual(caught.exception.result.status, "interrupted")
        self.assertAlmostEqual(caught.exception.result.time[-1], 0.0501)
        sim = robot.simulation(step="0.1 ms", record=True)
        sim.advance(7)
        kept = sim.snapshot()
        motion = sim.finish()
        self.assertEqual((motion.status, motion["position"][-1].tolist()), ("interrupted", sim.position.tolist()))
        self.assertRaisesRegex(ValueError, "was finished", sim.advance, 1)
        self.assertRaisesRegex(ValueError, "of another simulation", sim.restore, kept)
        self.assertRaisesRegex(ValueError, "records nothing, or was finished", sim.finish)
        self.assertRaisesRegex(ValueError, "records nothing", robot.simulation(step="0.1 ms").finish)

    def test_channels(self):
        robot, how = strut.load(ROBOT), {"duration": 0.01, "step": "0.1 ms"}
        run = robot.run(channels="com,position", **how)
        self.assertEqual(run.channels, ("position", "com.x", "com.y", "com.vx", "com.vy"))
        run = robot.run(channels=["pressure"], **how)
        for name, said in (("pressure", "no 'pressure': the scene has no cells"), ("com", r"run\(channels=\['com'\]\)"),
                           ("force", r"'force' was not recorded: run\(channels=\['force'\]\)")):
            self.assertRaisesRegex(AttributeError, said, getattr, run, name)
            self.assertRaisesRegex(KeyError, said, lambda: run[name])

    def test_keywords(self):
        robot = strut.load(ROBOT)
        cases = [
            (robot.run, "controlller", "'controller'"),
            (robot.run, "method", "'integrator'"),
            (robot.run, "dt", "'step'"),
            (robot.sweep, "thread", "'threads'"),
            (robot.modes, "cout", "'count'"),
            (robot.simulation, "stp", "'step'"),
            (robot.equilibria, "strats", "'starts'"),
            (robot.rigidity, "att", "'at'"),
            (robot.form, "gven", "'given'"),
            (robot.path, "upto", "until"),
            (robot.matrices, "att", "'at'"),
            (robot.modes().svg, "widht", "'width'"),
            (strut.fit, "outptu", "'output'"),
            (strut.sweep, "sett", "'set'"),
        ]
        for function, name, meant in cases:
            given = ["a.yaml"] * (function in (strut.fit, strut.sweep))
            self.assertRaisesRegex(TypeError, f"{name}.*{meant}", function, *given, **{name: 1})
        run = robot.run(every="2 ms", duration=0.01)
        self.assertAlmostEqual(run.time[1], 0.002)
        wrong = {"controller": print, "duration": 1, "accuracy": "1 %"}
        self.assertRaisesRegex(TypeError, "step='0.1 ms': it takes no accuracy", robot.run, **wrong)

    def test_every_command_is_the_program_s(self):
        """Those of `strut help`: what Python computes has the program's bytes, or the error says what does it."""
        truss, spring, frame = (MODELS / f"{name}.yaml" for name in ("basics/von-mises-truss", "basics/oscillator", "gallery/x-frame"))
        scene, study = strut.load(ROBOT), pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()), "study.yaml")
        there = study.parent
        study.with_name("robot.yaml").write_text(ROBOT.read_text())
        study.write_text("strut: 1\nstudy: Speeds\nmodel: robot.yaml\naxes: [{friction: [0.1, 0.2]}]\nkeep: [velocity]\n")
        computed = {
            "run": lambda: (scene.run().json, ROBOT),
            "sweep": lambda: (strut.sweep(study, output=there / "one").json, study, "-o", there / "two"),
            "compare": lambda: (strut.compare(ROBOT, spring, set={"friction": 0.2}).json, "--set=friction=0.2", ROBOT, spring),
            "tradeoff": lambda: (strut.tradeoff(spring, step_sizes=3).json, spring, "--step-sizes=3"),
            "equilibria": lambda: (scene.equilibria().json, ROBOT),
            "path": lambda: (strut.load(truss).path(until=1).json, truss, "--until=1"),
            "modes": lambda: (scene.modes(count=2).json, ROBOT, "--count=2"),
            "rigidity": lambda: (scene.rigidity().json, ROBOT),
            "form": lambda: (strut.load(frame).form(given="prestress").json, frame, "--given=prestress"),
        }
        elsewhere = {
            "check": lambda: "warnings" in program("check", ROBOT, "--json") and scene.warnings == (),
            "view": lambda: scene.view().html.startswith("<!DOCTYPE html>"),
            "export": lambda: scene.to_yaml() == program("export", ROBOT),
            "examples": lambda: all((strut.models / line.split()[0]).exists() for line in program("examples").splitlines()),
            **dict.fromkeys(("plot", "keys", "help")),
        }
        commands = re.findall(r"^  ([a-z]+)  ", program("help"), re.M)
        self.assertEqual(sorted(commands), sorted([*computed, *elsewhere]))
        measured = re.compile(r'\n\t*"(wall_time|table|cpu|cpu_per_second|(\w+_)?seconds)":[^\n]*')
        for command, compute in computed.items():
            mine, *words = compute()
            with self.subTest(command):
                printed = program(command, *words, "--json", "--quiet")
                self.assertEqual(measured.sub("", mine), measured.sub("", printed))
        for command, holds in elsewhere.items():
            with self.subTest(command):
                self.assertRaisesRegex(AttributeError, f"no 'strut.{command}': .", getattr, strut, command)
                self.assertTrue(holds is None or holds())
        crawlers = strut.compare(scene, scene(friction=0.2), no_motion=True)
        self.assertEqual([model["values"].friction for model in crawlers.models], [0.1, 0.05])
        self.assertIn("<svg", crawlers.svg())
        strut.compare(scene, scene(friction=0.2), no_motion=True, plot=study.with_name("two.svg"), title="Two of them")
        self.assertGreater(study.with_name("two.svg").stat().st_size, 10000)
        self.assertRaisesRegex(ValueError, "no other svg; options of the figure", crawlers.svg, width="column")
        self.assertRaisesRegex(KeyError, "^no model has a value 'velocity'", crawlers.plot)
        self.assertEqual([*crawlers.plot("friction", ax=unittest.mock.Mock()).bar.call_args.args[1]], [0.1, 0.05])
        self.assertRaisesRegex(TypeError, "did you mean 'accuracy'", strut.compare, scene, acuracy=1)
        self.assertRaisesRegex(ValueError, "accuracy.*'1 m'", strut.compare, scene, accuracy="1 m")
        self.assertRaises(strut.MissingFileError, strut.tradeoff, "none.yaml")
        self.assertRaisesRegex(ValueError, "^unknown picture format 'x.gif'", strut.compare, scene, plot="x.gif")
        bare = strut.loads("{strut: 1, nodes: {a: {position: [0, 0], mass: 1}}}", name="mine.yaml")
        with self.assertRaisesRegex(strut.SceneError, "^mine.yaml:2:1: ") as caught:
            strut.tradeoff(bare)
        self.assertNotIn("strut-", caught.exception.report)  # the folder of the call
        deep, bare = f"{pathlib.Path(strut.__file__).parents[1]}/a/b/c/studies.py", {"PATH": "", "STRUT": ""}
        with unittest.mock.patch.object(strut._studies, "__file__", deep), unittest.mock.patch.dict(os.environ, bare):
            self.assertRaises(FileNotFoundError, strut._studies._program)  # not one that is far above
        self.assertRaisesRegex(AttributeError, "did you mean 'load'", lambda: strut.laod)
        self.assertRaisesRegex(AttributeError, "strut.load", lambda: strut.Model)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads and processes give the bytes of one; objects come through pickles; memory does not grow."""

import concurrent.futures
import gc
import multiprocessing
import pickle
import resource
import tracemalloc
import unittest

from arrays import CRAWLER, MODELS, main, np, strut

ACCURATE = {"accuracy": "2 %", "channels": "position,force"}


def run_at(scene: strut.Scene, frequency: float) -> strut.Run:
    return scene(frequency=frequency).run(**ACCURATE)


def bytes_of(run: strut.Run) -> bytes:
    return run.json.encode() + run["position"].array.tobytes() + run["force"].array.tobytes()


class Threads(unittest.TestCase):
    def test_eight_threads_give_the_bytes_of_one(self):
        scene = strut.load(CRAWLER)
        frequencies = [8, 9, 10, 11, 12, 13, 14, 15]
        alone = [bytes_of(run_at(scene, f)) for f in frequencies]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            together = [bytes_of(run) for run in pool.map(lambda f: run_at(scene, f), frequencies)]
        self.assertEqual(alone, together)

    def test_results_are_read_by_eight_threads(self):
        run = strut.load(MODELS / "basics/x-frame.yaml").run()

        def read(_: int) -> bytes:
            fresh = strut.Run(run._raw, run._scene)
            return fresh["position"].array.tobytes() + repr(fresh.summary).encode()

        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            self.assertEqual(len(set(pool.map(read, range(200)))), 1)

    def test_processes_give_the_bytes_of_one(self):
        scene = strut.load(CRAWLER)
        here = run_at(scene, 9)
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            there = pool.apply(run_at, (scene, 9))
        self.assertEqual(bytes_of(there), bytes_of(here))


class Pickles(unittest.TestCase):
    def test_a_scene_stays_what_it_is(self):
        scene = strut.load(CRAWLER, friction=0.2)
        again = pickle.loads(pickle.dumps(scene))
        self.assertEqual(again.to_yaml(), scene.to_yaml())
        self.assertEqual(again(start="II")["parameters.start"], "II")
        parts = strut.load(MODELS / "parts/x-chain.yaml", cells=3)
        again = pickle.loads(pickle.dumps(parts))
        self.assertEqual(again.to_dict()["nodes"], parts.to_dict()["nodes"])
        self.assertEqual(len(again(cells=4).names("members")), len(parts(cells=4).names("members")))

    def test_results_keep_their_numbers(self):
        scene = strut.load(MODELS / "basics/x-frame.yaml")
        run = scene.run()
        again = pickle.loads(pickle.dumps(run))
        self.assertEqual((again.json, again.table, again.to_yaml()), (run.json, run.table, run.to_yaml()))
        for name in ("position", "energy", "position.n2.y", "energy.kinetic", "force.top"):
            np.testing.assert_array_equal(again[name], run[name], name)
        self.assertTrue(again._repr_html_().startswith("<table>"))
        modes = scene.modes()
        again = pickle.loads(pickle.dumps(modes))
        np.testing.assert_array_equal(again.shape, modes.shape)
        np.testing.assert_array_equal(again.frequency, modes.frequency)
        found = strut.load(MODELS / "basics/von-mises-truss.yaml").equilibria()
        again = pickle.loads(pickle.dumps(found))
        np.testing.assert_array_equal(again.array("equilibria.nodes"), found.array("equilibria.nodes"))
        self.assertEqual(again[0].modes().json, found[0].modes().json)
        one = pickle.loads(pickle.dumps(found[0]))
        self.assertEqual(one, found[0])


def round_of_everything() -> None:
    scene = strut.load(MODELS / "basics/oscillator.yaml", mass=2)
    run = scene(mass=3).run()
    run["position"].array.sum()
    run.nodes["block"].x.sum()
    run._raw.array("position").tolist()
    scene.modes().frequency.sum()
    scene.matrices().dense("mass")
    scene.to_dict()
    pickle.loads(pickle.dumps(scene))
    pickle.loads(pickle.dumps(run))
    for wrong in (lambda: strut.loads("strut: 2"), lambda: scene.run(step="3 kg"), lambda: run["a.b"]):
        try:
            wrong()
        except (strut.Error, KeyError):
            pass


class Memory(unittest.TestCase):
    def test_rounds_of_everything_leave_nothing(self):
        tracemalloc.start(1)
        for _ in range(150):  # until what Python keeps for later use has its size
            round_of_everything()
        gc.collect()
        before = tracemalloc.get_traced_memory()[0]
        resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for _ in range(100):
            round_of_everything()
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        self.assertLess(grown, 20_000)  # a lost object per round would be more
        resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - resident
        self.assertLess(resident, 8_000)  # KB

    def test_types_and_modules_are_counted(self):
        import sys

        def count() -> int:
            return sum(sys.getrefcount(type(x)) for x in (raw, result))

        scene = strut.load(MODELS / "basics/oscillator.yaml")
        run = scene.run()
        raw, result = scene._raw, run._raw
        before = count()
        for _ in range(50):
            scene.with_(mass=3).run()
        gc.collect()
        self.assertLess(abs(count() - before), 5)


if __name__ == "__main__":
    main()

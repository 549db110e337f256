# SPDX-License-Identifier: GPL-3.0-or-later
"""A simulation that Python advances: a run's bits, live arrays, inputs, snapshots, interrupts, cost."""

import threading
import timeit
import unittest

from arrays import CRAWLER, MODELS, interrupt, main, np, strut


class Simulations(unittest.TestCase):
    def setUp(self) -> None:
        self.scene = strut.load(CRAWLER)
        self.sim = self.scene.simulation(step="0.1 ms")

    def test_its_steps_are_those_of_a_run(self):
        for name in ("basics/oscillator", "basics/bouncing-node", "basics/x-frame"):
            scene = strut.load(MODELS / f"{name}.yaml")
            run = scene.run(channels="position,velocity")
            sim = scene.simulation()
            for part in np.diff(np.linspace(0, run.summary["steps"], 7).astype(int)):
                sim.advance(int(part))
            np.testing.assert_array_equal(sim.position.array, run["position"][-1], name)
            np.testing.assert_array_equal(sim.velocity.array, run["velocity"][-1], name)

    def test_a_drive_that_is_written_with_its_rate_is_the_scenes_own(self):
        def error(step, rated):
            own, sim = (self.scene.simulation(step=step, integrator="rk4-events") for _ in range(2))
            own.advance(round(0.3 / step))
            while sim.time < own.time - 0.5 * step:
                turned = 20 * np.pi * sim.time
                pair = 1e-4 * np.sin(turned), 1e-4 * 20 * np.pi * np.cos(turned)
                sim.actuators["drive"] = pair if rated else pair[0]
                sim.advance(1)
            return abs(sim.position - own.position).max()

        coarse, fine = error(1e-4, True), error(2.5e-5, True)
        self.assertLess(fine, 0.3 * coarse)
        self.assertLess(100 * fine, error(2.5e-5, False))  # dampers use the rate

    def test_arrays_are_live_and_have_names(self):
        x = self.sim.position["n1"]
        before = x.copy()
        self.sim.advance(500)
        self.assertFalse(np.array_equal(before, x))
        np.testing.assert_array_equal(self.sim.position.array[0], x)
        self.assertEqual(self.sim.force.shape, (9,))
        self.assertEqual(self.sim.force["m8"], self.sim.force[7])
        self.assertIs(self.sim.force, self.sim.force)
        self.assertEqual(self.sim.contact.names, self.scene.names("contacts"))
        self.assertAlmostEqual(self.sim.energy["elastic"], 22.69, places=1)
        with self.assertRaises(ValueError):
            x[0] = 0  # the state is the engine's
        self.assertRaisesRegex(KeyError, "there are n1, n2", lambda: self.sim.position["n9"])
        self.assertRaisesRegex(AttributeError, "no angle", lambda: self.sim.angle)
        self.assertRaises(AttributeError, lambda: self.sim.postion)
        np.testing.assert_array_equal(self.sim.position - self.sim.position, np.zeros((5, 2)))
        sim = self.sim
        del self.sim
        force = sim.force.array
        del sim  # what somebody looks at stays
        self.assertEqual(len(force.tolist()), 9)

    def test_inputs_hold_until_they_are_written_again(self):
        self.sim.rest["m8"] = self.sim.rest0["m8"] + 0.3e-3
        self.sim.actuators["drive"] = 1e-4, -0.02
        self.sim.advance(100)
        self.assertEqual(self.sim.rest["m8"], self.sim.rest0["m8"] + 0.3e-3)
        self.assertAlmostEqual(self.sim.actuators["drive"], -1e-4, places=15)
        self.assertNotEqual(self.sim.input_work, 0)
        self.sim.actuators["drive"] = 0
        self.assertEqual(self.sim.rates["drive"], 0)
        with self.assertRaises(ValueError):
            self.sim.rest0["m8"] = 3
        self.sim.load["n2"] = (1, -2)
        self.sim.advance(1)
        np.testing.assert_array_equal(self.sim.load["n2"], [1, -2])

    def test_inputs_that_mean_nothing_are_refused(self):
        before = self.sim.position.copy()
        for wrong in (float("nan"), -1.0, float("inf")):
            self.sim.rest["m8"] = wrong
            self.assertRaises(strut.UsageError, self.sim.advance, 1)
        np.testing.assert_array_equal(self.sim.position, before)
        self.sim.rest["m8"] = self.sim.rest0["m8"]
        self.sim.advance(1)
        self.assertRaises(ValueError, self.sim.advance, -1)
        self.assertRaises(TypeError, self.sim.advance, 1.5)
        self.assertRaises(OverflowError, self.sim.advance, 10**30)
        self.assertRaises(TypeError, self.sim.restore, 3)
        self.assertRaises(strut.UsageError, self.sim.restore, self.scene.simulation().snapshot())
        self.assertRaisesRegex(TypeError, "unexpected keyword", self.scene.simulation, stepp="1 ms")

    def test_a_step_alone_takes_a_method_that_the_friction_allows(self):
        for keys in ({"solver": {"accuracy": 0.01, "integrator": "rk4"}}, {"solver": {"step": 1e-4}}, {}):
            rest = {key: value for key, value in self.scene.to_dict().items() if key != "solver"}
            strut.Scene.from_dict(rest | keys).simulation(step="0.1 ms", friction_law="coulomb").advance(1)

    def test_a_snapshot_brings_everything_back(self):
        self.sim.advance(300)
        kept = self.sim.snapshot()
        ends = []
        for _ in range(2):
            self.sim.actuators["drive"] = 1e-4, 1e-3
            self.sim.advance(200)
            ends.append((self.sim.time, self.sim.position.copy().tobytes()))
            self.sim.restore(kept)
            self.assertEqual(self.sim.rates["drive"], 0)
        self.assertEqual(ends[0], ends[1])

    def test_one_thread_at_a_time(self):
        self.sim.advance(100)
        thread = threading.Thread(target=lambda: self.sim.advance(3_000_000))
        thread.start()
        with self.assertRaises(RuntimeError):
            while thread.is_alive():
                self.sim.time
        thread.join()
        self.assertGreater(self.sim.time, 300)

    def test_ctrl_c_ends_many_steps(self):
        interrupt(lambda: self.sim.advance(10**12), 0.2)
        before = self.sim.time
        self.sim.advance(10)
        self.assertGreater(self.sim.time, before)

    def test_cost_of_a_call(self):
        """Prints what a call costs beside a step; the limit is generous, for machines are busy."""
        self.sim.advance(20000)

        def cost(calls: int, steps: int) -> float:
            best = min(timeit.repeat(lambda: self.sim.advance(steps), repeat=7, number=calls))
            return best / (calls * steps) * 1e6

        by_one, by_ten, at_once = cost(5000, 1), cost(1000, 10), cost(1, 20000)
        print(f"us per step: {by_one:.3f} by one, {by_ten:.3f} by ten, {at_once:.3f} at once")
        self.assertLess(by_ten, 3 * at_once)


main()

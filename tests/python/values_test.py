# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes and results behave as Python's values: they do not change, compare, and say what they have."""

import inspect
import json
import pickle
import unittest

from arrays import MODELS, main, np, strut

from strut import _errors, _strut, _values

CRAWLER = strut.load(MODELS / "crawler/crawler.yaml")
FRAME = strut.load(MODELS / "gallery/x-frame.yaml")
RUN = strut.load(MODELS / "basics/x-frame.yaml").run()
TRUSS = strut.load(MODELS / "gallery/von-mises.yaml", load=1)
RESULTS = {
    "run": RUN,
    "equilibria": TRUSS.equilibria(),
    "modes": FRAME.modes(),
    "rigidity": FRAME.rigidity(),
    "form": FRAME.form(given="prestress"),
    "path": TRUSS.path(load="weight"),
    "matrices": FRAME.matrices(),
    "table": TRUSS.sweep(height=[0.4, 0.5], compute="path", keep="limit_factor"),
}

PARTS = """
strut: 1
parameters: {width: 50 cm, count: 3}
parts:
  cell: {nodes: {a: {position: [0, 0], mass: 1 g}, b: {position: [width, 2 * 10 cm], mass: 20 g}}, members: {m: {kind: bar, nodes: [a, b], stiffness: 4 N/cm}}}
place: {cell: {part: cell, repeat: {count: count, step: [width, 0]}}}
solver: {step: 0.1 ms}
run: {duration: 1 ms}
"""


class Frozen(unittest.TestCase):
    def test_attributes_cannot_be_set(self):
        sim = CRAWLER.simulation()
        for thing in (CRAWLER, sim, RUN["position"], RUN.energy, RUN.nodes["n1"], FRAME.nodes["n1"], *RESULTS.values(),
                      RESULTS["equilibria"][0]):
            for name in ("frequency", "velocity", "_raw", "array", "anything"):
                self.assertRaisesRegex(AttributeError, "do not change", setattr, thing, name, 30)
                self.assertRaises(AttributeError, delattr, thing, name)

    def test_mappings_and_lists_cannot_be_changed(self):
        for words in (RUN.summary, RUN.energy, CRAWLER.members, CRAWLER.nodes["n1"], RESULTS["equilibria"][0],
                      RESULTS["modes"][0], RESULTS["path"].summary):
            before = repr(words)
            for change in (
                lambda: words.__setitem__("a", 1),
                lambda: words.__delitem__(next(iter(words))),
                lambda: words.update(a=1),
                lambda: words.pop(next(iter(words))),
                lambda: words.setdefault("a", 1),
                lambda: words.__ior__({"a": 1}),
                words.clear,
                words.popitem,
            ):
                self.assertRaisesRegex(TypeError, "do not change", change)
            self.assertEqual(repr(words), before)
        copy = dict(RUN.energy)
        copy["kinetic"] = 3
        self.assertNotEqual(copy, RUN.energy)

        def lists(value):
            if isinstance(value, dict):
                return any(map(lists, value.values()))
            return isinstance(value, list) or (isinstance(value, tuple) and any(map(lists, value)))

        for name, result in RESULTS.items():
            if name != "table":
                self.assertFalse(lists(result.summary), name)
                self.assertIsInstance(result.warnings, tuple)
        self.assertFalse(lists(CRAWLER.configurations))
        self.assertEqual(pickle.loads(pickle.dumps(RUN.summary)), RUN.summary)
        self.assertIs(type(pickle.loads(pickle.dumps(RUN.summary)).energy), strut.Words)
        changed = CRAWLER.to_dict()  # a copy, for changes
        changed["name"] = "other"
        self.assertNotEqual(CRAWLER.name, "other")

    def test_arrays_are_read_only(self):
        again = pickle.loads(pickle.dumps(RUN))
        for array in (RUN.time, RUN["force"], again["force"], again.time, RESULTS["rigidity"].self_stress,
                      RESULTS["modes"].frequency, RESULTS["table"]["limit_factor"], CRAWLER.array("nodes.position"),
                      CRAWLER.nodes["n1"].position, again["position.n2.y"], RUN["position"]["n1"]):
            with self.assertRaises(ValueError):
                array[0] = 1


class Arguments(unittest.TestCase):
    def test_a_wrong_keyword_is_pythons_error(self):
        for call in (CRAWLER.equilibria, CRAWLER.modes, CRAWLER.rigidity, CRAWLER.form, CRAWLER.path,
                     CRAWLER.matrices, CRAWLER.simulation, CRAWLER.svg, RUN.svg, RUN.plot,
                     RESULTS["equilibria"][0].modes, RESULTS["equilibria"][0].rigidity):
            self.assertRaisesRegex(TypeError, "unexpected keyword argument 'acuracy'", call, acuracy=1)
        self.assertRaisesRegex(TypeError, "did you mean 'accuracy'", CRAWLER.sweep, friction=[1], acuracy=1)
        self.assertRaisesRegex(TypeError, "did you mean 'accuracy'", CRAWLER.run, acuracy=1)

    def test_arguments_are_the_librarys_options(self):
        for command in ("run", "equilibria", "modes", "rigidity", "form", "path", "matrices", "sweep"):
            given = inspect.signature(getattr(strut.Scene, command)).parameters
            names = {_values._SPELLED.get(name, name.replace("_", "-")) for name in given}
            there = {name.replace("_", "-") for name, _ in _strut.options(command)}
            extra = {"self", "progress", "axes", "points", "names", "keep", "parameters", "controller", "changes"}
            self.assertEqual(there, names - extra, command)

    def test_messages_name_arguments(self):
        for call, words in (
            (lambda: CRAWLER.run(step="1 ms"), "force=True"),
            (lambda: CRAWLER.run(accuracy=0.1, step=1e-4), "give either accuracy, or integrator and step"),
            (lambda: CRAWLER.run(integrator="rk5"), "^integrator expects"),
            (lambda: CRAWLER.path(over="friction"), "missing until"),
            (lambda: CRAWLER.with_(frequency="10 kg"), "frequency=10 kg: expected a frequency"),
            (lambda: CRAWLER.modes(count="a"), "^count expects"),
            (lambda: CRAWLER.equilibria(supports=["n9"]), "^supports: there is no node"),
            (lambda: RUN.svg(width="xx"), "^width='xx'"),
        ):
            with self.assertRaisesRegex(strut.Error, words) as caught:
                call()
            said = str(caught.exception) + caught.exception.report + caught.exception.message
            self.assertNotIn("--", said)
            self.assertNotIn("option", said)
        self.assertEqual(_errors.in_python("use a smaller step, or --accuracy 1%"),
                         "use a smaller step, or accuracy='1%'")

    def test_errors_are_pythons_kinds(self):
        with self.assertRaises(FileNotFoundError) as caught:
            strut.load("/nowhere/arm.yaml")
        self.assertIsInstance(caught.exception, strut.FileError)
        self.assertIs(type(pickle.loads(pickle.dumps(caught.exception))), strut.MissingFileError)
        self.assertRaises(ValueError, CRAWLER.modes, at="IV")
        self.assertRaises(RuntimeError, CRAWLER.run, step="1 ms")
        self.assertRaises(KeyError, lambda: RESULTS["table"]["speed"])
        with self.assertRaises(AttributeError):
            CRAWLER.run(channels=["position"]).nodes["n1"].vx  # not recorded


class Names(unittest.TestCase):
    def test_dir_lists_everything_there_is(self):
        sim = CRAWLER.simulation()
        for thing, names in (
            (CRAWLER, "members nodes actuators run with_ to_yaml"),
            (RUN, "velocity energy steps method channels plot"),
            (RESULTS["modes"], "frequency shape modes condition"),
            (RESULTS["path"], "factor events stable"),
            (RESULTS["equilibria"], "energy barriers standing"),
            (RESULTS["rigidity"], "rank self_stress mechanisms"),
            (RESULTS["matrices"], "mass damping"),
            (sim, "position force rest rest0 load actuators advance time"),
            (RUN["force"], "names array max mean shape"),
            (RUN.energy, "kinetic residual"),
            (RUN.nodes["n1"], "x y position"),
            (RESULTS["table"], "axes shape columns grid"),
        ):
            there = dir(thing)
            for name in names.split():
                self.assertIn(name, there)
            for name in there:
                getattr(thing, name)
        self.assertNotIn("stiffness_contact", dir(RESULTS["matrices"]))

    def test_positions_are_pairs_whatever_the_file_wrote(self):
        scene = strut.loads(PARTS)
        for name, wanted in (("cell.0.b", (0.5, 0.2)), ("cell.2.a", (1.0, 0.0))):
            position = scene.nodes[name].position
            self.assertEqual((position.shape, position.dtype), ((2,), float))
            np.testing.assert_allclose(position, wanted, rtol=1e-15)
        self.assertEqual(scene.nodes["cell.0.b"].mass, 0.02)
        np.testing.assert_allclose(scene(width=1).nodes["cell.2.a"].position, (2, 0))
        mixed = strut.loads("strut: 1\nnodes: {a: [1 cm, 2 * 3 mm], b: {position: [0, 0], fixed: both}}\n"
                            "members: {m: {kind: bar, nodes: [a, b], stiffness: 1, mass: 1}}\n"
                            "solver: {step: 1 ms}\nrun: {duration: 1 ms}\n")
        np.testing.assert_allclose(mixed.nodes.a.position, (0.01, 0.006))
        self.assertEqual(mixed.nodes.b.fixed, "both")
        for path in sorted(MODELS.glob("gallery/*.yaml"))[::5]:
            scene = strut.load(path)
            self.assertEqual(tuple(scene.nodes), scene.names("nodes"))
            for i, node in enumerate(scene.nodes.values()):
                np.testing.assert_array_equal(node.position, scene.array("nodes.position")[i])

    def test_scenes_compare_by_what_they_do(self):
        again = strut.load(MODELS / "crawler/crawler.yaml")
        self.assertEqual(CRAWLER, again)
        self.assertEqual(hash(CRAWLER), hash(again))
        self.assertEqual(CRAWLER(frequency=10), CRAWLER(frequency="0.01 kHz"))
        self.assertNotEqual(CRAWLER, CRAWLER(frequency=11))
        self.assertNotEqual(CRAWLER, 3)
        parts = strut.loads(PARTS)
        self.assertEqual(parts, strut.loads(parts.to_yaml(), name="other"))
        self.assertEqual(parts, pickle.loads(pickle.dumps(parts)))
        self.assertNotEqual(parts, parts(count=4))
        self.assertEqual(len({parts, strut.loads(PARTS), CRAWLER}), 2)

    def test_self_stress_is_an_array(self):
        chain = strut.load(MODELS / "parts/x-chain.yaml").rigidity()
        stress = chain.self_stress
        self.assertEqual((stress.shape, stress.names), ((5, 26), chain._scene.names("members")))
        listed = chain.summary["self_stress"]["states"]
        for i, state in enumerate(listed):
            np.testing.assert_array_equal(stress[i], [*state["forces"].values()])
        np.testing.assert_array_equal(stress["left"], [state["forces"]["left"] for state in listed])
        self.assertEqual(chain.mechanisms.shape, (3, 12, 2))
        # each state is in equilibrium
        balance = chain._scene.matrices()["equilibrium"]
        balance = balance if isinstance(balance, np.ndarray) else balance.toarray()
        np.testing.assert_allclose(balance @ stress.array.T, 0, atol=1e-12)
        self.assertEqual(TRUSS.rigidity().self_stress.shape, (0, 2))
        self.assertEqual(TRUSS.rigidity().mechanisms.shape, (0, 3, 2))

    def test_the_models_are_there(self):
        self.assertEqual(strut.load(strut.models / "crawler/crawler.yaml"), CRAWLER)
        self.assertEqual(json.loads(json.dumps(RUN.summary)), json.loads(RUN.json))


main()

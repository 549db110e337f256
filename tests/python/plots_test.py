# SPDX-License-Identifier: GPL-3.0-or-later
"""plot() draws the results' numbers by matplotlib, where it is installed; notebooks show tables and figures."""

import html.parser
import pickle
import sys
import unittest
import unittest.mock

from support import MODELS, main, skip_without

skip_without("numpy", "matplotlib")

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402

matplotlib.use("agg")

from matplotlib import pyplot  # noqa: E402

import strut  # noqa: E402
from strut import _plots  # noqa: E402

CRAWLER = strut.load(MODELS / "crawler/crawler.yaml")
FRAME = strut.load(MODELS / "gallery/x-frame.yaml")
TRUSS = strut.load(MODELS / "gallery/von-mises.yaml", load=1)
NAME = "</script><b>&\"'"
BAR = {"strut": 1,
       "nodes": {"a": {"position": [0, 0], "fixed": "both"}, "b": {"position": [1, 0], "fixed": "y", "mass": 1}},
       "members": {"ab": {"kind": "bar", "nodes": ["a", "b"], "stiffness": 1e4}}}


class Plots(unittest.TestCase):
    def tearDown(self) -> None:
        pyplot.close("all")

    def test_a_run_over_time(self):
        run = CRAWLER.run(channels=["position", "force", "energy"])
        ax = run.plot("force")
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("time in s", "force in N"))
        self.assertEqual([line.get_label() for line in ax.get_lines()], [f"m{i}" for i in range(1, 10)])
        np.testing.assert_array_equal(ax.get_lines()[7].get_ydata(), run["force.m8"])
        given = pyplot.subplots()[1]
        ax = run.plot("position.n2.y", ax=given)
        self.assertIs(ax, given)
        self.assertEqual(ax.get_ylabel(), "position.n2.y in mm")
        np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), 1e3 * run["position.n2.y"])
        self.assertEqual(run.plot().get_ylabel(), "position x in m")
        self.assertEqual(len(run.plot("position").get_lines()), 5)
        np.testing.assert_allclose(run.plot("position.n3").get_lines()[0].get_ydata(), run["position.n3.x"])
        self.assertIn(" in ", run.plot("energy").get_ylabel())
        self.assertRaisesRegex(KeyError, "no recorded channel 'velocity'", run.plot, "velocity")
        self.assertRaisesRegex(ValueError, "recorded nothing", CRAWLER.run(record=False).plot)

    def test_equilibria_and_their_barriers(self):
        found = CRAWLER.equilibria()
        ax = found.plot()
        self.assertEqual([text.get_text() for text in ax.get_xticklabels()], [e.name for e in found.standing])
        energy = np.array([e.energy for e in found.standing])
        height = ax.collections[0].get_offsets()[:, 1]
        self.assertEqual(ax.get_ylabel(), "energy above the lowest in J")
        np.testing.assert_allclose(height, energy - energy.min(), atol=1e-12)
        self.assertGreater(len(ax.get_lines()), 5)

    def test_modes_paths_states_and_forms(self):
        modes = CRAWLER.modes(at="II")
        ax = modes.plot()
        self.assertEqual(ax.get_ylabel(), "frequency in kHz")
        np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), modes.frequency / 1e3)
        path = TRUSS.path(load="weight")
        ax = path.plot()
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("displacement of apex along y in m", "load factor"))
        kinds = [line.get_linestyle() for line in ax.get_lines()]
        self.assertEqual(kinds[:3], ["-", "--", "-"])
        self.assertEqual(len(kinds), 3 + len(path.events))
        drawn = np.concatenate([line.get_ydata() for line in ax.get_lines()[:3]])
        self.assertEqual(set(drawn), set(path.factor))
        over = TRUSS.path(over="stiffness", until=2).plot()
        self.assertEqual(over.get_ylabel(), "stiffness in N/m")
        states = FRAME.rigidity().plot()
        self.assertEqual([line.get_color() for line in states.get_lines()[:6]], 4 * ["tab:red"] + 2 * ["tab:blue"])
        self.assertEqual(len(TRUSS.rigidity().plot().get_lines()), 3)  # no state: grey members, and nodes
        self.assertEqual(len(FRAME.form(given="prestress").plot().get_lines()), 7)
        self.assertRaises(IndexError, FRAME.rigidity().plot, 5)

    def test_sweeps(self):
        table = CRAWLER.sweep(frequency=[8, 9, 10], keep=["velocity", "outcome"])
        ax = table.plot()
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("frequency in Hz", "velocity in mm/s"))
        np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), 1e3 * table["velocity"])
        table = CRAWLER.sweep(frequency=[8, 10], friction=[0.1, 0.3], keep="velocity")
        ax = table.plot("velocity")
        np.testing.assert_allclose(ax.collections[0].get_array().ravel(), 1e3 * table["velocity"])
        self.assertEqual(len(ax.figure.axes), 2)  # and the scale of colours
        with self.assertRaisesRegex(ValueError, "one or two axes"):
            CRAWLER.sweep(points=[[8, 0.1], [9, 0.2]], names=["frequency", "friction"], keep="velocity").plot()
        self.assertEqual(strut.tradeoff(MODELS / "basics/oscillator.yaml", step_sizes=3).plot().get_lines()[0].get_label(), "rk4")

    def test_prefixes_are_those_of_the_programs_figures(self):
        for largest, unit, label in ((2e-3, "m", "a in mm"), (999e-6, "m", "a in µm"), (1000, "N/m", "a in kN/m"),
                                     (1e-3, "kg", "a in kg"), (2e-6, "m^2", "a in m^2"), (0.1, "mm", "a in mm"), (0, "m", "a in m"), (5, "1", "a"), (3, "", "a"),
                                     (float("nan"), "s", "a in s"), (1e30, "J", "a in J")):
            scale = _plots.Scale(np.array([-largest, 0.0]), unit)
            self.assertEqual(scale.label("a"), label)

    def test_without_matplotlib_it_says_how_to_install_it(self):
        hidden = {name: None for name in [*sys.modules, "matplotlib"] if name.split(".")[0] == "matplotlib"}
        with unittest.mock.patch.dict(sys.modules, hidden):
            for result in (FRAME.modes(), TRUSS.sweep(height=[0.4], compute="path", keep="limit_factor")):
                self.assertRaisesRegex(ImportError, "python3-matplotlib.*pip install matplotlib", result.plot)


class Reader(html.parser.HTMLParser):
    """Tags of a page as a browser sees them, but what is within a figure or a page of its own."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []

    def handle_starttag(self, tag, attributes) -> None:
        self.tags.append(tag)


class Notebooks(unittest.TestCase):
    def results(self, scene: strut.Scene):
        return {
            "run": scene.run(channels=["position"]),
            "equilibria": scene.equilibria(),
            "modes": scene.modes(),
            "rigidity": scene.rigidity(),
            "form": scene.form(given="prestress"),
            "path": scene.path(load="on_n3"),
            "matrices": scene.matrices(),
            "sweep": scene.sweep(keep="velocity"),
        }

    def test_all_results_have_a_view(self):
        for name, result in self.results(strut.load(MODELS / "basics/x-frame.yaml", load=1)).items():
            with self.subTest(name):
                shown = result._repr_html_()
                self.assertIn("<table>", shown)
                self.assertLess(len(shown), 2e6)
                if name in ("modes", "rigidity", "form", "path"):
                    self.assertIn("<svg", shown)
                elif name in ("run", "equilibria"):
                    self.assertTrue(shown.startswith("<iframe srcdoc="))
                again = pickle.loads(pickle.dumps(result))
                self.assertIn("<table>", again._repr_html_())
        self.assertIn("2 more", _plots.things([{"a": 1.0}] * 14, 14))
        self.assertNotIn("--", strut.load(MODELS / "basics/x-frame.yaml").run()._repr_html_().split("</iframe>")[1])

    def test_names_cannot_break_the_page(self):
        described = strut.load(MODELS / "basics/x-frame.yaml", load=1).to_dict()
        described["name"] = NAME
        described["description"] = NAME
        for name, result in {**self.results(strut.Scene.from_dict(described)),
                             "scene": strut.Scene.from_dict(described)}.items():
            with self.subTest(name):
                shown = result._repr_html_()
                self.assertNotIn("<b>", shown)
                self.assertNotIn("</script", shown)
                reader = Reader()
                reader.feed(shown)
                self.assertFalse({"b", "script"} & set(reader.tags))
        page = strut.Scene.from_dict(described).run(channels=["position"]).html()
        self.assertTrue(NAME not in page and "</script><b>" not in page)


main()

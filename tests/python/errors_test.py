# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input raises, with every mistake's place, and never crashes; nothing prints."""

import io
import os
import contextlib
import pickle
import unittest

from support import MODELS, main

import strut
from strut import _strut

CRAWLER = MODELS / "crawler/crawler.yaml"


class Errors(unittest.TestCase):
    def test_all_mistakes_have_their_places(self):
        text = "strut: 1\rnodes: {a: [0, 0], b: {positon: [1, 2]}}\nmembers: {q: 3}\n"
        with self.assertRaises(strut.SceneError) as caught:
            strut.loads(text, name="arm.yaml")
        error = caught.exception
        self.assertEqual((error.file, error.line, error.column, error.length), ("arm.yaml", 2, 24, 7))
        self.assertEqual((error.hint, error.messages[0].source), ("position", text.splitlines()[1]))
        self.assertEqual(error.key, "nodes.b.positon")
        self.assertEqual([message.line for message in error.messages], [2, 3])
        self.assertIn("arm.yaml:3:14: ", str(error))
        self.assertIn("^~~~~~~", error.report)
        self.assertEqual(error.status, "bad_scene")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.messages), (str(error), error.messages))

    def test_a_dictionarys_mistakes_have_keys(self):
        with self.assertRaises(strut.SceneError) as caught:
            strut.Scene.from_dict({"strut": 1, "nodes": {"a": {"position": [0, 0], "mas": 1}}})
        self.assertIn("nodes.a.mas", [message.key for message in caught.exception.messages])

    def test_bad_settings_and_options(self):
        self.assertRaisesRegex(strut.SceneError, "did you mean 'frequency'", strut.load, CRAWLER, frequenz=10)
        scene = strut.load(CRAWLER)
        self.assertRaises(strut.SceneError, scene.with_, frequency="10 kg")
        self.assertRaises(strut.SceneError, scene.with_, frequency=float("nan"))
        self.assertRaisesRegex(TypeError, "did you mean 'integrator'", scene.run, integratr="rk4")
        self.assertRaises(strut.UsageError, scene.modes, at="IV")
        self.assertRaises(TypeError, scene.with_, frequency=object())
        self.assertRaises(TypeError, scene.with_, frequency=None)
        for value in (b"1", bytearray(b"1"), [b"1"]):
            self.assertRaisesRegex(TypeError, "not byte", scene.with_, frequency=value)
            self.assertRaisesRegex(TypeError, "not byte", scene.sweep, frequency=value)
        self.assertRaisesRegex(TypeError, "not None", _strut.options, None)
        self.assertRaises(ValueError, scene.with_, frequency="1\0")
        self.assertRaises(AttributeError, lambda: scene.nodez)
        self.assertRaises(KeyError, scene.array, "nodes.weight")
        self.assertRaises(KeyError, lambda: scene["nodes.n9.0"])
        self.assertIsNone(scene.get("nodes.n9.0"))
        self.assertEqual(scene.names("nothing"), ())

    def test_files(self):
        self.assertRaises(strut.Error, strut.load, "/nowhere/arm.yaml")
        self.assertRaises(strut.Error, strut.load, os.fspath(MODELS))
        self.assertRaises(ValueError, strut.load, "a\0b")
        self.assertRaises(strut.SceneError, strut.loads, "")
        with self.assertRaises(strut.Error):
            strut.loads("strut: 1\nname: \udcff\n".encode("utf-8", "surrogateescape").decode("latin1"))

    def test_a_failed_run_keeps_what_it_has(self):
        scene = strut.load(CRAWLER)
        with self.assertRaisesRegex(strut.RunError, "largest stable step") as caught:
            scene.run(step="1 ms")
        self.assertEqual(caught.exception.status, "step_too_large")
        with self.assertRaises(strut.RunError) as caught:
            scene.run(step="1 ms", force=True)
        self.assertEqual(caught.exception.status, "diverged")
        self.assertEqual(caught.exception.result.status, "diverged")
        self.assertEqual(len(caught.exception.result.time), 0)  # it would record its last periods
        pickle.dumps(caught.exception)

    def test_the_module_itself_checks_its_arguments(self):
        raw = strut.load(CRAWLER)._raw
        for wrong in (
            lambda: _strut.Scene(),
            lambda: _strut.open("a", ("a",), ()),
            lambda: _strut.open_text("a", "b", (1,), (2,)),
            lambda: strut.loads(b"strut: 1"),
            lambda: raw.call(_strut.Result(), "dance", (), (), None),
            lambda: raw.sweep(_strut.Result(), ("a",), 2, b"12345678", None, (), (), (), None),
            lambda: raw.sweep(_strut.Result(), ("a",), -1, memoryview(b""), None, (), (), (), None),
            lambda: raw.names(3),
            lambda: raw.array(None),
            _strut.Result().json,
        ):
            self.assertRaises((TypeError, ValueError), wrong)

    def test_a_callback_that_raises_ends_the_run(self):
        def stop(fraction):
            raise LookupError(fraction)

        with self.assertRaises(LookupError) as caught:
            strut.load(CRAWLER).run(progress=stop, step="1 us")
        self.assertEqual(caught.exception.result.status, "interrupted")

    def test_nothing_prints(self):
        (read, write), kept, printed = os.pipe(), (os.dup(1), os.dup(2)), io.StringIO()
        try:
            os.dup2(write, 1), os.dup2(write, 2)
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                self.test_bad_settings_and_options()
                strut.load(CRAWLER).run(accuracy="2 %")
        finally:
            os.dup2(kept[0], 1), os.dup2(kept[1], 2)
            for each in (*kept, write):
                os.close(each)
        self.assertEqual(os.read(read, 1000), b"")
        os.close(read)
        self.assertEqual(printed.getvalue(), "")


main()

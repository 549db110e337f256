# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/python-api.md is what the package says now: every public thing has a docstring, and the page has it."""

import functools
import inspect
import subprocess
import sys
import unittest

from support import ROOT, main

import strut

PRINTS = ROOT / "parser/bindings/python/reference.py"
PAGE = ROOT / "docs/python-api.md"


class Reference(unittest.TestCase):
    def test_the_page_is_current(self):
        done = subprocess.run([sys.executable, "-P", PRINTS], capture_output=True, text=True, check=True)
        again = f"PYTHONPATH=BUILD/python python3 -P {PRINTS.relative_to(ROOT)} >{PAGE.relative_to(ROOT)}"
        self.assertTrue(done.stdout == PAGE.read_text(), f"write the page again: {again}")

    def test_everything_public_is_explained_and_typed(self):
        things = {name: getattr(strut, name) for name in strut.__all__ if name != "models"}
        for kind in [thing for thing in things.values() if inspect.isclass(thing)]:
            things |= {f"{kind.__name__}.{name}": member for name, member in vars(kind).items()
                       if not name.startswith("_") and getattr(member, "__name__", name) == name
                       and (callable(member) or isinstance(member, (property, functools.cached_property)))}
        for name, thing in things.items():
            self.assertTrue(inspect.getdoc(thing), f"{name} has no docstring")
            if inspect.isfunction(thing):
                self.assertIn("return", thing.__annotations__, name)
                for parameter in inspect.signature(thing).parameters.values():
                    self.assertTrue(parameter.name == "self" or parameter.annotation is not parameter.empty, name)
                    if parameter.kind is parameter.VAR_KEYWORD:
                        self.assertIn(parameter.name, ("parameters", "changes"), name)  # of the scene and of its run


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs what CMake has built; nothing is compiled here."""

import pathlib
import sys

from setuptools import Distribution, setup

if not pathlib.Path(__file__).with_name("VERSION").exists():
    sys.exit("strut is built by CMake: cmake --build --preset release --target wheel")

# It holds a compiled library, though it has no sources of one.
setup(distclass=type("Built", (Distribution,), {"has_ext_modules": lambda self: True}))

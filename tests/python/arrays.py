# SPDX-License-Identifier: GPL-3.0-or-later
"""For tests of the Python package with arrays: they are skipped where numpy is not installed."""

from support import MODELS, interrupt, main, program, skip_without

skip_without("numpy")

import numpy as np  # noqa: E402

import strut  # noqa: E402

CRAWLER = MODELS / "crawler/crawler.yaml"
__all__ = ["CRAWLER", "MODELS", "interrupt", "main", "np", "program", "strut"]

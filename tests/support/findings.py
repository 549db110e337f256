# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of the program share: findings, told as they come and counted, and the exit code."""
import os
import sys

_found = 0


def fail(text):
    global _found
    _found += 1
    print("FAILED:", text)


def check(good, text):
    if not good:
        fail(text)


def files_in(folder):
    """Names of all files in a folder but strut's list of those it wrote."""
    return [name for name in os.listdir(folder) if name != ".strut-files"]


def finish(tested=True):
    """The end of a test: 1 where something failed, 77 (skipped) where nothing could be tested."""
    print(f"{_found} failures")
    sys.exit(1 if _found else 0 if tested else 77)

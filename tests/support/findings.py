# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of the program share: findings, told as they come and counted, and the exit code."""
import sys

_found = 0


def fail(text):
    global _found
    _found += 1
    print("FAILED:", text)


def check(good, text):
    if not good:
        fail(text)


def finish():
    """The end of a test: 1 where something failed."""
    print(f"{_found} failures")
    sys.exit(_found > 0)

# SPDX-License-Identifier: GPL-3.0-or-later
"""For the tests of the Python package: the program besides it, and where models are.

    PYTHONPATH=BUILD/python python3 -X dev -W error tests/python/NAME_test.py PROGRAM
"""

import collections.abc
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = ROOT / "models"
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else ""


def program(*words: object, code: int = 0) -> str:
    """What the program prints; it must return `code`."""
    done = subprocess.run([PROGRAM, *map(os.fspath, map(str, words))], capture_output=True, text=True, check=False)
    if done.returncode != code:
        raise AssertionError(f"strut {words}: {done.returncode}, expected {code}: {done.stderr}")
    return done.stdout


def interrupt(call: collections.abc.Callable, after: float) -> KeyboardInterrupt:
    """What the call raises, by Ctrl-C after a while; within a second, on an idle machine 0.2 s."""
    sent = []

    def press() -> None:
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, press)
    timer.start()
    try:
        call()
    except KeyboardInterrupt as error:
        took = time.monotonic() - sent[0]
        print(f"interrupted in {took:.3f} s", flush=True)
        if took < 1.0:
            return error
        raise AssertionError(f"it took {took} s") from error
    finally:
        timer.join()
    raise AssertionError("it was not interrupted")


def skip_without(*modules: str) -> None:
    """Ends the test as skipped where a module is not installed."""
    import importlib.util

    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if missing:
        print("not installed:", *missing)
        sys.exit(77)


def main() -> None:
    sys.unraisablehook = lambda left: (print(left), os._exit(1))  # such as a file that is left open
    unittest.main(argv=sys.argv[:1], verbosity=1)

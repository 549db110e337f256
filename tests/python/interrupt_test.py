# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C ends a run, a sweep, a search and a simulation within 0.2 s, and Python goes on as before."""

import os
import signal
import threading
import time
import unittest

from arrays import CRAWLER, MODELS, interrupt, main, strut

class Interrupts(unittest.TestCase):
    def interrupted(self, call, after: float = 0.3) -> KeyboardInterrupt:
        error = interrupt(call, after)
        self.sane()
        return error

    def sane(self) -> None:
        self.assertEqual(strut.load(MODELS / "basics/oscillator.yaml").run().status, "completed")

    def test_a_run(self):
        error = self.interrupted(lambda: strut.load(CRAWLER).run(step="1 us"))
        self.assertEqual(error.result.status, "interrupted")
        self.assertGreater(error.result.summary["steps"], 0)

    def test_an_accurate_run(self):
        self.interrupted(lambda: strut.load(CRAWLER, start="II").run(accuracy="0.001 %"))

    def test_equilibria(self):
        self.interrupted(lambda: strut.load(CRAWLER).equilibria(starts=1000000))

    def test_another_handler_may_let_it_go_on(self):
        calls = []
        before = signal.signal(signal.SIGINT, lambda *_: calls.append(1))
        try:
            threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            run = strut.load(CRAWLER).run(step="0.05 ms")
        finally:
            signal.signal(signal.SIGINT, before)
        self.assertEqual((run.status, calls), ("completed", [1]))

    def test_other_threads_go_on(self):
        """Only the thread that began Python sees Ctrl-C."""
        results = []
        thread = threading.Thread(target=lambda: results.append(strut.load(CRAWLER).run()))
        thread.start()
        self.interrupted(lambda: time.sleep(30), after=0.1)
        thread.join()
        self.assertEqual(results[0].status, "completed")


main()

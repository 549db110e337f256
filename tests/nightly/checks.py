# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of nightly.py, one row each."""
from typing import NamedTuple

BUILD = "cmake --preset {0} && cmake --build --preset {0} -j {{jobs}}"
TESTS = BUILD.format("tests")
PASSED = r"\d+% tests passed, (\d+) tests? failed out of (\d+)"


NOT_WITH_THREADS = (
    "allocations", "abi_leaks", "abi_null", "document_limits",  # limits of memory, and allocators of their own
    "cli_interrupt", "cli_view", "slots", "study_limits",  # times, which the sanitizer takes ten times as long for
    "install",  # links programs without it
    "world_methods",  # thresholds of eight random scenes, as gcc draws them
)


class Check(NamedTuple):
    """What is run from the repository's root, and where its log has the number.

    command: for the shell; {jobs}, {minutes}, {scenes} and {folder} are filled in. Other than 0 has failed.
    number: a pattern; its last match is shown as `shown` has it, where {total} is the sum of the first group over all
      matches. Without a match the check has failed.
    least: what the last group must reach.
    """
    name: str
    about: str
    command: str
    number: str
    shown: str
    hours: float  # a longer one is ended, and has failed
    least: float | None = None


def suite(name, about, preset, hours, before="", but=()):
    """The tests of a preset, but these."""
    test = f"{before} ctest --test-dir build/{preset} -j {{jobs}} --output-on-failure"
    if but:
        test += f" -E '^({'|'.join(but)})$'"
    return Check(name, about, BUILD.format(preset) + " && " + test.strip(), PASSED, "{0} of {1} tests failed", hours)


def target(name, about, what, number, shown, hours):
    """A target of the preset tests."""
    return Check(name, about, f"{TESTS} && cmake --build --preset tests --target {what}", number, shown, hours)


def fuzzer(name):
    corpus = f"{{folder}}/corpus-{name}"
    seeds = "" if name == "abi" else f"build/fuzz/tests/unpack_cases tests/language/bad {corpus} && "
    return Check(
        f"fuzz-{name}", f"the fuzzer of {name}, with both sanitizers",
        f"{BUILD.format('fuzz')} && mkdir -p {corpus} && {seeds}"
        f"build/fuzz/tests/fuzz_{name} -max_total_time=$(({{minutes}} * 60)) -max_len=8192 "
        f"-artifact_prefix={{folder}}/{name}- {corpus} -verbosity=0 -print_final_stats=1",
        r"stat::number_of_executed_units: (\d+)", "{0} inputs, none of which crashed it", 2)


CHECKS = (
    suite("suite", "all tests, at full speed with assertions", "tests", 2),
    suite("sanitize", "all tests under the address and undefined-behaviour sanitizers", "sanitize", 12),
    suite("threads", "all tests that the thread sanitizer lets run, under it", "threads", 12,
          "TSAN_OPTIONS=ignore_noninstrumented_modules=1 "  # and what tells it of the joins of OpenMP
          "OMP_TOOL_LIBRARIES=$(ls /usr/lib/llvm-*/lib/libarcher.so | tail -1)", NOT_WITH_THREADS),
    Check("memory", "memory read before it is written: models under valgrind",
          f"{TESTS} && sh tests/nightly/valgrind.sh build/tests/strut models/basics models/topologies",
          r"(\d+) commands, (\d+) with errors", "{0} commands under valgrind, {1} with errors", 4),
    *(fuzzer(name) for name in ("document", "scene", "study", "exchange", "abi")),
    Check("mutants", "planted bugs that the tests notice",
          "python3 tests/bench/mutants.py --jobs {jobs} --whole || true",
          r"(\d+) of (\d+) noticed, (\d+) %", "{0} of {1} noticed, {2} %", 12, 95),
    target("kills", "studies killed at a random moment a hundred times, and resumed", "sweep_kills",
           r"killed_and_resumed: ([\d.]+) s", "the same bytes as without", 2),
    Check("disks", "full disks and closed pipes", f"{TESTS} && ctest --test-dir build/tests -R 'cli_trouble|^sweep$' "
          "--output-on-failure", PASSED, "{0} of {1} tests failed", 1),
    target("malloc", "each allocation of a command fails once", "memory_walk",
           r": (\d+) allocations, exit codes", "{total} allocations failed, one at a time", 6),
    Check("scenes", "random scenes: is the accuracy kept that a run states?",
          f"{TESTS} && python3 tests/bench/promise.py build/tests/strut $(({{scenes}} / 15))",
          r"(\d+) of (\d+) promises kept; (\d+) of (\d+) scenes got none",
          "{0} of {1} promises kept; {2} of {3} scenes without", 10),
    Check("grids", "random scenes: does the answer to a small tolerance depend on the grid?",
          f"{TESTS} && python3 tests/bench/grids.py build/tests/strut $(({{scenes}} / 4)) 20261129 {{folder}}/grids",
          r"(\d+) of (\d+) scenes depend on the grid", "{0} of {1} scenes depend on the grid", 3),
    target("golden", "the golden motions and works by two compilers at four levels", "golden_all",
           r"clang -O0: rk4 motion ([0-9a-f]+)", "the same bits", 1),
    Check("node", "strut for browsers: the golden bits, answers of all models, pages in a browser", "sh tests/web.sh",
          PASSED, "{0} of {1} tests failed", 3),
    target("extremes", "long runs, ratios of 1e12, 270,000 members", "extremes", r"(Built target extremes)", "held", 4),
    target("paper", "two hundred points of the paper's figures against the independent program", "paper_points",
           r"(Built target paper_points)", "the same", 2),
)

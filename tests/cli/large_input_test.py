#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of 3.6 MB that are wrong in hundreds of thousands of places: strut check must answer with 50
messages and the number of the others, within 0.5 s of processor time and 64 MB of memory. The test
allows four times the time, because a busy machine slows processor time down too; memory is memory.

  python3 large_input_test.py STRUT SANITIZED
"""
import os
import re
import resource
import subprocess
import sys
import tempfile

SECONDS, MEGABYTES = 0.5, 64
BUSY = 4  # how much slower a processor may be that others use as well
SHOWN = 50

STRUT, SANITIZED = sys.argv[1], sys.argv[2] == "1"
MODEL = """strut: 1
nodes: {a: [0, 0], b: [1 m, 0]}
members: {m: {kind: bar, nodes: [a, b], stiffness: 1 N/m}}
"""
HEAD = "strut: 1\n"


def each(count, line):
    """The lines of numbers 0 to count - 1, made one by one: this process must stay small."""
    return (line.format(i=i, n=i + 1) for i in range(count))


def chain(*parts):
    for part in parts:
        if isinstance(part, str):
            yield part
        else:
            yield from part


# name: (the text in pieces, a pattern that stderr must have, how many errors there are or None)
SHAPES = {
    "parameters that name unknown ones":
        (lambda: chain(MODEL, "parameters:\n", each(200000, "  p{i}: q{i}\n")),
         r"unknown parameter 'q0'; did you mean 'p0'\?", 200000),
    "the same on one line":
        (lambda: chain("{strut: 1, nodes: {a: [0, 0]}, parameters: {",
                       each(200000, "p{i}: q{i}, "), "}}\n"), "unknown parameter 'q0'", None),
    "unknown keys":
        (lambda: chain(MODEL, each(250000, "nodes{i}: 1\n")),
         r"unknown key 'nodes0' in the scene; did you mean 'nodes'\?", 250000),
    "unknown keys of a node":
        (lambda: chain(HEAD, "nodes: {a: {position: [0, 0], ", each(200000, "mass{i}: 1, "), "}}\n"),
         "unknown key 'mass0' in node 'a'", None),
    "duplicate keys":
        (lambda: chain(MODEL, "parameters:\n", each(350000, "  p: 11\n")),
         "duplicate key 'p'; the first one is in line 5", 349999),
    "unknown nodes of members":
        (lambda: chain(HEAD, "nodes: {a: [0, 0]}\nmembers:\n",
                       each(100000, "  m{i}: {{nodes: [a, b{i}]}}\n")), "unknown node 'b0'", None),
    "unknown nodes where there are many":
        (lambda: chain(HEAD, "nodes:\n", each(50000, "  n{i}: [0, {i}]\n"), "members:\n",
                       each(50000, "  m{i}: {{kind: bar, nodes: [n{i}, m{i}]}}\n")),
         r"unknown node 'm0' in 'nodes' of member 'm0'; did you mean 'n0'\?", 50000),
    "unknown groups where there are many":
        (lambda: chain(HEAD, "groups:\n", each(70000, "  gr{i}: {{mass: 1 g}}\n"), "nodes:\n",
                       each(70000, "  n{i}: {{group: gx{i}}}\n")), "unknown group 'gx0'", 70000),
    "a circle of all parameters":
        (lambda: chain(MODEL, "parameters:\n", each(200000, "  p{i}: p{n}\n"), "  p200000: p0\n"),
         "more than 200 deep", None),
    "parameters that depend on themselves":
        (lambda: chain(MODEL, "parameters:\n", each(200000, "  p{i}: p{i}\n")), "'p0' depends on itself", 200000),
    "expressions that are none":
        (lambda: chain(MODEL, "parameters:\n", each(180000, "  p{i}: 1 +* {i}\n")), r"unexpected '\*'", 180000),
    "unknown units":
        (lambda: chain(MODEL, "parameters:\n", each(150000, "  p{i}: {i} furlong\n")),
         "unknown unit 'furlong'", 150000),
    "unknown functions":
        (lambda: chain(MODEL, "parameters:\n", each(180000, "  p{i}: sine(1)\n")),
         "unknown function 'sine'; did you mean 'sin'", 180000),
    "nodes that are numbers":
        (lambda: chain(HEAD, "nodes:\n", each(270000, "  n{i}: 5\n")), "expected a position", 270000),
    "nodes that are empty":
        (lambda: chain(HEAD, "nodes:\n", each(240000, "  n{i}: {{}}\n")), "node 'n0' lacks 'position'", 240000),
    "loads on unknown nodes":
        (lambda: chain(MODEL, "loads:\n", each(140000, "  l{i}: {{node: x{i}}}\n")), "unknown node 'x0'", None),
    "configurations of unknown nodes":
        (lambda: chain(MODEL, "configurations:\n", each(130000, "  c{i}: {{x: [0, 0]}}\n")),
         "unknown node 'x'", 130000),
    "tags": (lambda: chain(HEAD, "nodes:\n", each(220000, "  n{i}: !t 5\n")), "tags", None),
    "brackets": (lambda: chain("a: ", each(3600, "[" * 1000)), "more than 64 levels", 1),
    "braces": (lambda: chain("a: ", each(900, "{{a: " * 1000)), "more than 64 levels", 1),
    "parentheses":
        (lambda: chain(MODEL, "parameters:\n  p: ", each(3600, "(" * 1000), "\n"), "'p'", 1),
    "a long sum":
        (lambda: chain(MODEL, "parameters:\n  p: ", each(1800, "1+" * 1000), "q\n"), "longer than 1000", 1),
    "one name": (lambda: chain(MODEL, each(3600, "k" * 1000), ": 1\n"), "expected ':'", 1),
    "long names":
        (lambda: chain(MODEL, "parameters:\n", each(4000, "  " + "p" * 900 + "{i}: 1\n")),
         "may have at most 255 bytes", 4000),
    "anchors": (lambda: chain("x:\n", each(250000, "  - &a{i} 1\n")), "more than 1000 anchors", 1),
    "aliases of aliases":
        (lambda: chain("a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n",
                       each(200, "a{n}: &a{n} [*a{i}, *a{i}]\n"), each(250000, "# filled up\n")),
         "values repeated by aliases", 1),
    "unknown aliases": (lambda: chain("x:\n", each(500000, "  - *u\n")), r"unknown alias '\*u'", 1),
    "an open quote": (lambda: chain('"', each(1200, "a\\n" * 1000)), "never closed", 1),
    "bytes that are no text": (lambda: chain(HEAD, each(1800, "\udcff\n" * 1000)), "0xFF", 1),
    "controls": (lambda: chain(HEAD, each(1800, "\x01\n" * 1000)), r"U\+0001", None),
}


def check(path):
    """Exit code, stderr, seconds of processor time, largest memory [MB] of strut check."""
    with open(path + ".err", "w+b") as errors, open(os.devnull, "wb") as nothing:
        child = subprocess.Popen([STRUT, "check", path], stdout=nothing, stderr=errors,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (60, 60)))
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = status
        errors.seek(0)
        text = errors.read().decode(errors="replace")
    return status, text, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    failures = []
    seconds_most = SECONDS * BUSY * (5 if SANITIZED else 1)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "large.yaml")
        for name, (pieces, pattern, count) in SHAPES.items():
            with open(path, "w", errors="surrogateescape") as file:
                file.writelines(pieces())
            status, errors, seconds, memory = check(path)
            print(f"{name}: {os.path.getsize(path) / 1e6:.1f} MB, {seconds:.2f} s, {memory:.0f} MB")
            shown = len(re.findall(r"^\S*: error: ", errors, re.M))
            rest = re.search(r"^\.\.\. and (\d+) more$", errors, re.M)
            found = shown + (int(rest.group(1)) if rest else 0)
            if os.waitstatus_to_exitcode(status) != 2:
                failures.append(f"{name}: exit code {os.waitstatus_to_exitcode(status)}")
            if not re.search(pattern, errors):
                failures.append(f"{name}: stderr lacks {pattern}: {errors[:400]}")
            if shown > SHOWN or len(errors) > 500 * (SHOWN + 1):
                failures.append(f"{name}: {shown} messages of {len(errors)} bytes")
            if count is not None and found != count:
                failures.append(f"{name}: {found} errors, expected {count}")
            if seconds > seconds_most:
                failures.append(f"{name}: {seconds:.2f} s of processor time")
            if memory > MEGABYTES and not SANITIZED:
                failures.append(f"{name}: {memory:.1f} MB")
    for failure in failures:
        print("FAILED:", failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The n-th allocation of the whole program fails, those of libraries included: an error, or none, but
never a signal; and so it is under limits of memory (ulimit -v) that grow in small steps.

Left out are allocations that HDF5, GLib, Pango, Fontconfig and libgfortran make themselves, and with HDF5 the C
library's, which it calls: these end the process from inside, whatever their caller does. docs/dev/testing.md
says what guards against that.

  python3 library_memory_test.py STRUT FAILING_MALLOC COUNT

COUNT allocations of each command, spread evenly; 0 is each of them.
"""
import os
import re
import resource
import shutil
import subprocess
import sys

from testing import check, finish, work

STRUT, PRELOAD, COUNT = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3])
HERE = os.path.dirname(os.path.abspath(__file__))
MODELS = os.path.abspath("models")
HOPPER, PENTAGON = f"{HERE}/hopper.yaml", f"{HERE}/pentagon.yaml"
ABORTING = "libglib:libpango:libfontconfig:libgfortran"
WITH_HDF5 = ABORTING + ":libhdf5:libc.so"
# cairo 1.16 dereferences NULL while it finishes a large figure; GLib ends where the loader has no memory for its thread;
# fontconfig copies what expat had no memory for; pixman writes to NULL while it is loaded
CRASHING = WITH_HDF5 + ":libcairo:libpixman:ld-linux:libexpat"
COMMANDS = {  # name: (words, folders and files to remove before, libraries that are spared)
    "run": (["run", HOPPER, "--set", "seconds=0.1", "-o", "out", "--quiet"], WITH_HDF5),
    "sweep": (["sweep", "study.yaml", "-o", "out", "--threads", "1", "--quiet"], WITH_HDF5),
    "export": (["export", PENTAGON], ABORTING),
    "view": (["view", "kept", "-o", "out.html", "--quiet"], WITH_HDF5),
    "path": (["path", f"{MODELS}/basics/von-mises-truss.yaml", "--set", "load=12", "-o", "out"], ABORTING + ":libgsl"),
    "modes": (["modes", PENTAGON, "-o", "out"], ABORTING),
    "rigidity": (["rigidity", PENTAGON, "-o", "out"], ABORTING + ":libgsl"),  # GSL checks none of its own: LU crashes
    "form": (["form", PENTAGON, "-o", "out.html", "--quiet"], ABORTING),
    "check": (["check", HOPPER], ABORTING),
    "search": (["sweep", "search.yaml", "-o", "out", "--threads", "1", "--quiet"], WITH_HDF5),
    "evolution": (["sweep", "evolution.yaml", "-o", "out", "--threads", "1", "--quiet"], WITH_HDF5),
    "front": (["sweep", "front.yaml", "-o", "out", "--threads", "1", "--quiet"], WITH_HDF5),
    "sensitivity": (["sweep", "sensitivity.yaml", "-o", "out", "--threads", "1", "--quiet"], WITH_HDF5),
    "follow": (["path", "--periodic", f"{MODELS}/gallery/two-mass-crawler.yaml", "--over", "friction=0.09..0.13",
                "--set", "periods=60", "--steps", "2", "-o", "out"], CRASHING),
    "table": (["run", f"{MODELS}/basics/robot.yaml"], ABORTING),
}
TIMED = re.compile(r"evaluations in .* per step")
GOOD = os.path.abspath("tests/language/good")
for theme in ("elements", "memory", "feedback", "grounds", "collisions", "drives"):
    COMMANDS[theme] = (["run", f"{GOOD}/{theme}.yaml", "--quiet"], ABORTING)


def call(words, limit=None, **environment):
    shutil.rmtree("out", ignore_errors=True)
    if os.path.exists("out.html"):
        os.remove("out.html")
    return subprocess.run(
        [STRUT, *words], capture_output=True, text=True, errors="replace", timeout=120,
        env=dict(os.environ, **{"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", **environment}),
        preexec_fn=limit and (lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))))


def fails_everywhere(name, words, spared):
    """Every n-th allocation of the command fails once."""
    done = call(words, LD_PRELOAD=PRELOAD, STRUT_SPARE=spared, STRUT_COUNT_FILE="count")
    check(done.returncode == 0, f"{name}: exit code {done.returncode}: {done.stderr}")
    with open("count", encoding="utf-8") as file:
        total = int(file.read())
    whole, step = done.stdout, max(1, total // COUNT) if COUNT else 1
    codes = {}
    last = range(total - 99, total + 1) if name in ("elements", "table") else ()  # laws are compiled, cells printed there
    for n in sorted({*range(1 + step // 2, total + 1, step), *last}):
        done = call(words, LD_PRELOAD=PRELOAD, STRUT_SPARE=spared, STRUT_FAIL_AT=str(n))
        codes[done.returncode] = codes.get(done.returncode, 0) + 1
        check(done.returncode >= 0, f"{name}: allocation {n} of {total}: signal {-done.returncode}")
        check(done.returncode == 0 or done.stderr or name == "form", f"{name}: allocation {n} of {total}: not a word")
        if name == "table" and done.returncode == 0:  # all of it, but for the seconds that it took
            check(TIMED.sub("", done.stdout) == TIMED.sub("", whole), f"allocation {n} of {total}: {done.stdout}")
    print(f"{name}: {total} allocations, exit codes {codes}", flush=True)
    check(codes.get(4, 0) > 0, f"{name}: nothing failed")


def limited(name, words, times=1, **environment):
    """From the limit on at which the program starts at all, in steps of a megabyte."""
    begin = 40 << 20
    while call(["--version"], begin).returncode != 0:
        begin += 1 << 20
    step = (1 << 20) if not COUNT else (3 << 20)
    codes = {}
    for limit in range(begin, begin + (60 << 20), step):
        for _ in range(times):
            done = call(words, limit, **environment)
            codes[done.returncode] = codes.get(done.returncode, 0) + 1
            check(done.returncode >= 0, f"{name}: with {limit >> 20} MB: signal {-done.returncode}")
            check(done.returncode != 2, f"{name}: {done.stderr}")
    print(f"{name}: from {begin >> 20} MB on, exit codes {codes}", flush=True)


os.chdir(work)
for model in (HOPPER, f"{MODELS}/basics/oscillator.yaml", f"{MODELS}/crawler/switch.yaml"):
    shutil.copy(model, ".")
with open("study.yaml", "w", encoding="utf-8") as study:
    study.write(f"strut: 1\nstudy: s\nmodel: hopper.yaml\naxes:\n  - seconds: [0.1, 0.2]\ntrajectories: yes\n")
with open("map.yaml", "w", encoding="utf-8") as study:  # two threads ask for the same equilibria
    study.write(f"strut: 1\nstudy: s\nmodel: switch.yaml\naxes:\n  - amplitude: [0.1 mm, 0.5 mm, 1 mm]\n"
                "  - frequency: [10 Hz, 11 Hz, 12 Hz, 13 Hz]\nrun: {duration: 20 ms}\nkeep: [outcome]\n")
OVER = "over: {stiffness: {from: 50 N/m, to: 150 N/m}, mass: {from: 0.5 kg, to: 2 kg}}"
for study_name, rest in (
        ("search", f"search: {{maximise: frequency_1, {OVER}, evaluations: 12}}"),
        ("evolution", f"search: {{maximise: frequency_1, {OVER}, method: cma, evaluations: 24}}"),
        ("front", f"search: {{maximise: [frequency_1, -total_mass], {OVER}, evaluations: 24}}"),
        ("sensitivity", "sensitivity: {of: [frequency_1], samples: 8, over: {mass: {normal: [1 kg, 0.1 kg]}}}")):
    with open(f"{study_name}.yaml", "w", encoding="utf-8") as study:
        study.write(f"strut: 1\nstudy: s\nmodel: oscillator.yaml\ncompute: modes\nlowest: 1\n"
                    f"keep: [frequencies, total_mass]\n{rest}\n")
subprocess.run([STRUT, "run", HOPPER, "--set", "seconds=0.1", "-o", "kept", "--quiet"], check=True)
wanted = sys.argv[4:] or COMMANDS
for command in wanted:
    fails_everywhere(command, *COMMANDS[command])
for command in ("run", "sweep", "export", "view", "path"):
    if command in wanted:
        limited(command, COMMANDS[command][0])
if "table" in wanted:  # Fontconfig, Pango and GLib end the process where they find no memory
    limited("plot", COMMANDS["table"][0] + ["--plot", "out.svg"])
if "modes" in wanted:  # OpenBLAS, if it is the BLAS, waits at exit for threads that it could not start
    limited("modes", COMMANDS["modes"][0], OPENBLAS_NUM_THREADS="8")
if "sweep" in wanted:
    limited("map", ["sweep", "map.yaml", "-o", "out", "--threads", "2", "--quiet"], times=5)
shutil.rmtree(os.getcwd())
finish()

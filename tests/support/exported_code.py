# SPDX-License-Identifier: GPL-3.0-or-later
# What the tests of strut export --format code share: they are called as TEST.py STRUT MODELS.
import csv
import os
import re
import shutil
import struct
import subprocess
import sys

from testing import check, models, path, run, write

here = os.path.dirname(os.path.realpath(sys.argv[0]))
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]


def scene(name, method, step, steps, every, edit=lambda text: text):
    """A model of the repository with another run; its file is NAME.yaml."""
    text = edit(open(os.path.join(models, name), encoding="utf-8").read())
    text = re.sub(r"^(run|output|solver):.*\n(?:[ #\n].*\n|\n)*", "", text, flags=re.M)
    text += (f"\nsolver: {{integrator: {method}, step: {step} s}}\nrun: {{duration: {steps * step!r} s}}\n"
             f"output: {{every: {every * step!r} s, channels: [position, energy]}}\n")
    file = os.path.basename(name)
    write(file, text)
    return file


def bits(number):
    return struct.pack("<d", float(number) + 0.0)


def strut_rows(file):
    """Positions by strut run, with -0 as 0."""
    run("run", file, "-o", "run", "--quiet", "--force")
    with open(path("run", "nodes.csv"), encoding="utf-8") as table:
        rows = list(csv.reader(table))
    columns = [k for k, name in enumerate(rows[0]) if re.search(r"[.][xy] \[m\]$", name)]
    return [[row[k] for k in columns] for row in rows[1:]]


def build(compiler, stem, *flags, directory="code"):
    program = path(directory, f"{stem}-{os.path.basename(compiler)}")
    done = subprocess.run([compiler, *STRICT, "-O2", *flags, f"{stem}_example.c", f"{stem}.c", "-lm", "-o",
                           program], cwd=path(directory), capture_output=True, text=True)
    check(done.returncode == 0, f"{compiler} {stem}: {done.stderr[:2000]}")
    return program


def code_rows(program):
    done = subprocess.run([program], capture_output=True, text=True, timeout=60)
    return [line.split(",")[1:] for line in done.stdout.splitlines()[1:]]


compilers = [c for c in ("gcc", "clang") if shutil.which(c)]


def stem_of(file):
    return re.sub(r"[^A-Za-z0-9]", "_", file.split(".")[0])


def same_rows(what, got, want):
    check(len(got) == len(want), f"{what}: {len(got)} rows, expected {len(want)}")
    for n, (a, b) in enumerate(zip(got, want)):
        if list(map(bits, a)) != list(map(bits, b)):
            check(False, f"{what}: row {n} has other bits: {a} and {b}")
            break


def compare(file, method, step, steps, every, using=compilers):
    stem, want = stem_of(file), strut_rows(file)
    run("export", file, "--format", "code", "-o", "code")
    for compiler in using:
        program = build(compiler, stem, f"-DSTEP={step!r}", f"-DSTEPS={steps}", f"-DEVERY={every}",
                        f"-DMETHOD={stem}_step_{method}")
        same_rows(f"{file} {method} {compiler}", code_rows(program), want)
    return want


def compare_model(name, method, step, steps, every, using=compilers):
    return compare(scene(name, method, step, steps, every), method, step, steps, every, using)

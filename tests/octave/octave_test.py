# SPDX-License-Identifier: GPL-3.0-or-later
"""strut in Octave: its calls work, and every number is the program's, bit for bit, on ten models.

usage: octave_test.py STRUT FOLDER-OF-THE-FUNCTIONS SOURCE
"""
import csv
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

strut, functions, source = (os.path.abspath(a) for a in sys.argv[1:4])
octave = shutil.which("octave-cli")
if not octave or not os.path.exists(os.path.join(functions, "strut_mex.mex")):
    print("skipped: no Octave here")
    sys.exit(77)
here = os.path.join(source, "tests", "octave")
models = os.path.join(source, "models")


def run_octave(code, *, check=True):
    environment = dict(os.environ, STRUT_MODELS=models)
    done = subprocess.run(
        [octave, "--no-init-file", "--no-history", "-q", "--path", functions, "--path", here, "--eval", code],
        capture_output=True, text=True, env=environment, cwd=source)
    if check and done.returncode:
        sys.exit(f"octave: {code}\n{done.stdout}{done.stderr}")
    return done.stdout


def bits(value):
    return struct.pack(">d", float(value)).hex()


def flatten(name, value, to):
    """The values of a JSON object under the names that show.m prints."""
    if isinstance(value, dict):
        for key, item in value.items():
            field = "".join(c if c.isalnum() or c == "_" else "_" for c in key)
            flatten(f"{name}.{field if field[0].isalpha() else 'x' + field}", item, to)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            flatten(f"{name}.{i}", item, to)
    elif isinstance(value, bool):
        to[name] = str(int(value))
    elif isinstance(value, (int, float)):
        to[name] = bits(value)
    elif isinstance(value, str):
        to[name] = value


def shown(text):
    """The same names from show.m: vectors are lists."""
    values = {}
    for line in text.splitlines():
        name, _, value = line.partition(" ")
        if name.endswith("]"):
            base, _, index = name[:-1].rpartition("[")
            values.setdefault(base, []).append(value)
        elif value not in ("null", "''"):
            values[name] = value[1:-1] if value.startswith("'") else value
    return values


def compare_json(command, model, text, options):
    printed = subprocess.run([strut, command, "--json", *options, model], capture_output=True, text=True)
    expected, found = {}, shown(text)
    flatten("json", json.loads(printed.stdout), expected)
    numbers = {}
    for name, value in found.items():
        if isinstance(value, list):
            numbers[name] = value
    checked = 0
    # every number that the program prints is among those of its list, in their order
    for name, value in expected.items():
        base = name
        while base and base not in found:
            base = base.rpartition(".")[0]
        if any(part in name for part in ("wall_time",)) or not base:
            continue
        have = found[base] if isinstance(found[base], list) else [found[base]]
        if value not in have:
            sys.exit(f"{command} {model}: {name} is {value}, in Octave {base}: {have[:4]}")
        checked += 1
    if checked < 10:
        sys.exit(f"{command} {model}: only {checked} values could be compared")
    return checked


def compare_run(model):
    found = run_octave(f"show ('run', '{model}')")
    checked = compare_json("run", model, found, [])
    values = shown(found)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([strut, "run", "-q", "-o", folder + "/r", model], check=True, capture_output=True)
        with open(folder + "/r/nodes.csv", newline="") as file:
            rows = [r for r in csv.reader(line for line in file if not line.startswith("#"))]
    head = [h.split(" ")[0] for h in rows[0]]
    body = rows[1:]
    samples = len(body)
    if [bits(r[0]) for r in body] != values["time"]:
        sys.exit(f"run {model}: the times differ")
    column = 0
    for axis in "xy":
        names = [i for i, h in enumerate(head) if h.endswith("." + axis)]
        for k, i in enumerate(names):
            if [bits(r[i]) for r in body] != values[axis][k * samples:(k + 1) * samples]:
                sys.exit(f"run {model}: column {head[i]} differs")
            column += samples
    return checked + column


print(run_octave(f"source ('{here}/octave_test.m')"), end="")
run_octave(f"source ('{here}/tsgfem.m')")
count = 0
runs = ["crawler/crawler.yaml", "gallery/t-bar.yaml", "gallery/d-bar.yaml", "gallery/sliding-mass-crawler.yaml",
        "gallery/double-pendulum.yaml"]
rest = [("modes", "gallery/t-bar.yaml"), ("modes", "gallery/arm.yaml"), ("rigidity", "gallery/t-bar.yaml"),
        ("rigidity", "gallery/x-with-ring.yaml"), ("rigidity", "crawler/crawler.yaml"),
        ("equilibria", "gallery/d-bar.yaml"), ("equilibria", "gallery/half-t-bar.yaml")]
for model in runs:
    count += compare_run(os.path.join(models, model))
for command, model in rest:
    path = os.path.join(models, model)
    count += compare_json(command, path, run_octave(f"show ('{command}', '{path}')"), [])
blocks = re.findall(r"```matlab\n(.*?)```", open(os.path.join(source, "docs", "octave.md")).read(), re.S)
run_octave("graphics_toolkit('gnuplot'); set (0, 'DefaultFigureVisible', 'off');\n" + "\n".join(blocks)
           if shutil.which("gnuplot") else re.sub(r"plot\(.*?\);", "", "\n".join(blocks)))
print(f"{count} values as the program has them, and {len(blocks)} pieces of docs/octave.md")

#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""nightly.py: what it makes of checks that hold, fail, say nothing or take too long; whether its table can be run."""
import json
import pathlib
import re
import sys
import tempfile
from types import SimpleNamespace

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import nightly  # noqa: E402
from checks import CHECKS, Check  # noqa: E402
from testing import check, finish  # noqa: E402

ROOT = nightly.ROOT


def made(command, number=r"(\d+) of (\d+)", shown="{0} of {1}", hours=1.0, least=None):
    return Check("one", "a check <b>", command, number, shown, hours, least)


def try_one(folder, *given, **named):
    options = SimpleNamespace(folder=folder, jobs=3, minutes=2, scenes=9)
    return nightly.try_check(made(*given, **named), options)


def verdicts(folder):
    good = try_one(folder, "echo 1 of 2; echo {jobs} of {minutes}")
    check(good["good"] and good["shown"] == "3 of 2", good)
    bad = try_one(folder, "echo 3 of 4; exit 5")
    check(not bad["good"] and bad["shown"].startswith("exit code 5: 3 of 4"), bad)
    silent = try_one(folder, "echo nothing")
    check(not silent["good"], silent)
    slow = try_one(folder, "sleep 60", hours=0.0001)
    check(not slow["good"] and "ended" in slow["shown"] and slow["seconds"] < 30, slow)
    check(not try_one(folder, "echo 94 of 94", least=95)["good"], "too few")
    check(try_one(folder, "echo 94 of 95", least=95)["good"], "enough")
    summed = try_one(folder, "printf 'a: 3\\nb: 4\\n'", number=r": (\d+)", shown="{total}")
    check(summed["shown"] == "7", summed)


def page(folder):
    results = {"golden": {"good": False, "shown": "<b>", "seconds": 90, "date": "2026-11-28", "commit": "c"}}
    path, summary = nightly.write_page(folder, results)
    text = path.read_text()
    check("&lt;b&gt;" in text and "<b>" not in text and 'class="failed"' in text, text)
    check(summary.startswith(f"0 of {len(CHECKS)} good, 1 failed"), summary)


def table():
    presets = json.loads((ROOT / "CMakePresets.json").read_text())
    presets = {one["name"] for one in presets["configurePresets"]}
    lists = (ROOT / "tests/CMakeLists.txt").read_text()
    check(len({one.name for one in CHECKS}) == len(CHECKS), "two checks have one name")
    for one in CHECKS:
        groups = re.compile(one.number).groups
        one.shown.format(*["1"] * groups, total=1)
        one.command.format(jobs=1, minutes=1, scenes=9, folder="f")
        for preset in re.findall(r"--preset (\w+)", one.command):
            check(preset in presets, f"{one.name}: no preset {preset}")
        for target in re.findall(r"--target (\w+)", one.command):
            check(re.search(rf"(add_custom|strut_python)_target\({target}\b", lists), f"{one.name}: no target {target}")
        for script in re.findall(r"tests/[\w/]+\.(?:py|sh)", one.command):
            check((ROOT / script).is_file(), f"{one.name}: no file {script}")


with tempfile.TemporaryDirectory() as name:
    verdicts(pathlib.Path(name))
    page(pathlib.Path(name))
table()
finish()

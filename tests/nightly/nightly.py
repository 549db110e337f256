#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The long checks before a release, one after the other, and a page with a number and a date for each.

    python3 tests/nightly/nightly.py              all of them: many hours
    python3 tests/nightly/nightly.py NAME...      these; the page keeps the others' last numbers, with their dates
    python3 tests/nightly/nightly.py --list

Packages: sh tests/install.sh tests, sh tests/install.sh web, valgrind, libomp-dev. The page, the log of each check and
results.json are in build/nightly, or in --folder. The exit code is 1 where one of those that ran has failed.
"""
import argparse
import datetime
import html
import json
import os
import pathlib
import re
import signal
import shutil
import subprocess
import sys
import time

sys.dont_write_bytecode = True
from checks import CHECKS  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>strut: nightly checks</title>
<style>body {{ font: 15px/1.4 sans-serif; margin: 2em auto; max-width: 70em; padding: 0 1em }}
table {{ border-collapse: collapse; width: 100% }}
td, th {{ border-bottom: 1px solid #ccc; padding: .3em .6em; text-align: left; vertical-align: top }} .failed {{ background: #fdd }} .missing {{ color: #888 }}</style>
<h1>strut: nightly checks</h1><p>{summary}</p>
<table><tr><th>check<th>what<th>result<th>took<th>date<th>commit</tr>
{rows}</table></html>
"""


def commit():
    if not shutil.which("git"):
        return "no commit"
    text = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True,
                          check=False)
    return text.stdout.strip() or "no commit"


def run_to(log, command, limit):
    """Its exit code, or None where it took longer than the limit [s]; what it starts ends with it."""
    with open(log, "wb") as out:
        child = subprocess.Popen(["sh", "-c", command], cwd=ROOT, stdin=subprocess.DEVNULL, stdout=out,
                                 stderr=subprocess.STDOUT, start_new_session=True)
        try:
            return child.wait(timeout=limit)
        except subprocess.TimeoutExpired:
            return None
        finally:  # also where this program is ended
            if child.poll() is None:
                os.killpg(child.pid, signal.SIGKILL)
                child.wait()


def number_of(check, text):
    """What the page shows of a log, and whether it is good enough; None where the log has no number."""
    found = list(re.finditer(check.number, text))
    if not found:
        return None, False
    groups = [group or "" for group in found[-1].groups()]
    total = sum(int(m.group(1)) for m in found) if "{total}" in check.shown else 0
    return check.shown.format(*groups, total=total), check.least is None or float(groups[-1]) >= check.least


def try_check(check, options):
    log = options.folder / f"{check.name}.log"
    command = check.command.format(jobs=options.jobs, minutes=options.minutes, scenes=options.scenes,
                                   folder=options.folder)
    began = time.monotonic()
    code = run_to(log, command, 3600 * check.hours)
    shown, enough = number_of(check, log.read_text(errors="replace"))
    if code is None:
        shown = f"ended after {check.hours:g} hours"
    elif code or shown is None:
        shown = f"exit code {code}" + (f": {shown}" if shown else "") + f"; see {log.name}"
        enough = False
    return {"good": code == 0 and enough, "shown": shown, "seconds": round(time.monotonic() - began),
            "date": datetime.date.today().isoformat(), "commit": commit()}


def took(seconds):
    if seconds < 120:
        return f"{seconds} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def write_page(folder, results):
    rows = []
    for check in CHECKS:
        one = results.get(check.name)
        cells = [check.name, check.about] + ([one["shown"], took(one["seconds"]), one["date"], one["commit"]] if one
                                             else ["not run", "", "", ""])
        kind = "missing" if not one else "good" if one["good"] else "failed"
        rows.append(f'<tr class="{kind}">' + "".join(f"<td>{html.escape(cell)}" for cell in cells) + "</tr>\n")
    known = [results[check.name]["good"] for check in CHECKS if check.name in results]
    left = len(CHECKS) - len(known)
    summary = f"{known.count(True)} of {len(CHECKS)} good, {known.count(False)} failed, {left} not run."
    page = folder / "report.html"
    part = folder / "report.html.part"
    part.write_text(PAGE.format(summary=summary, rows="".join(rows)), encoding="utf-8")
    part.replace(page)
    return page, summary


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--list", action="store_true", help="print the checks")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "build" / "nightly")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--minutes", type=int, default=30, help="of each fuzzer (default: 30)")
    parser.add_argument("--scenes", type=int, default=1000, help="random ones (default: 1000)")
    options = parser.parse_args()
    unknown = set(options.names) - {check.name for check in CHECKS}
    if unknown:
        parser.error(f"no such check: {' '.join(sorted(unknown))}; --list prints them")
    if min(options.jobs, options.minutes) < 1 or options.scenes < 15:
        parser.error("--jobs and --minutes are at least 1, --scenes at least 15")
    options.folder = options.folder.resolve()
    return options


def main():
    options = parse()
    if options.list:
        for check in CHECKS:
            print(f"{check.name:14} {check.about}")
        return 0
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    options.folder.mkdir(parents=True, exist_ok=True)
    record, failed = options.folder / "results.json", False
    results = json.loads(record.read_text()) if record.is_file() else {}
    for check in CHECKS:
        if options.names and check.name not in options.names:
            continue
        print(f"{check.name}: ", end="", flush=True)
        one = results[check.name] = try_check(check, options)
        failed = failed or not one["good"]
        print(f"{'good' if one['good'] else 'FAILED'}, {one['shown']} ({took(one['seconds'])})", flush=True)
        record.write_text(json.dumps(results, indent=1))
        write_page(options.folder, results)
    page, summary = write_page(options.folder, results)
    print(f"{summary} {page}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())

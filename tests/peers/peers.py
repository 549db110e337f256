#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of examples of other programs: runs these, and checks the table of docs/comparison.md.

    python3 peers.py STRUT            fails where a number is not met, or the table is not what it prints
    python3 peers.py STRUT --write    writes the table

A section of examples.ini asks a model a question (ask: a command and its options; filter: jq, which may use
tests/gallery/gallery.jq) and gives the number, who made it, and how far strut's may be from it, as a part of it.
"""
import configparser
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(ROOT, "docs", "comparison.md")
BEGIN, END = "<!-- peers -->\n", "<!-- /peers -->\n"


def answer(strut, row):
    """strut's number, or what went wrong."""
    command, *options = row["ask"].split()
    done = subprocess.run([strut, command, os.path.join(ROOT, row["model"]), *options, "--json"],
                          capture_output=True, text=True, timeout=300)
    if done.returncode:
        return done.stderr.strip()
    got = subprocess.run(["jq", "-L", os.path.join(ROOT, "tests", "gallery"),
                          f'include "gallery"; {row["filter"]}'],
                         input=done.stdout, capture_output=True, text=True)
    try:
        return float(got.stdout)
    except ValueError:
        return got.stdout.strip() + got.stderr.strip()


def difference(got, want):
    """Of strut's number from theirs, as a part of it, to one digit."""
    share = abs(got - want) / abs(want)
    return "below 2e-8" if share < 2e-8 else f"{share:.0e}"


def table(strut):
    """The table's lines, and what is wrong."""
    rows = configparser.ConfigParser(interpolation=None, delimiters=("=",), comment_prefixes=("#",))
    rows.optionxform = str
    rows.read(os.path.join(HERE, "examples.ini"), encoding="utf-8")
    lines = ["| example | what | number | made by | strut differs by |", "|---|---|---|---|---|"]
    wrong = []
    for name in rows.sections():
        row, want = rows[name], float(rows[name]["number"])
        got = answer(strut, row)
        if not isinstance(got, float):
            wrong.append(f"{name}: {got}")
            continue
        if abs(got - want) > float(row["within"]) * abs(want):
            wrong.append(f"{name}: {got!r}, expected {want!r} within {row['within']}")
        link = row["example"]  # tests are not installed beside the pages
        if row["model"].startswith("models/"):
            link = f"[{link}](../{row['model']})"
        lines.append(f"| {link} | {row['what']} | {want:.9g} | {row['by']} | {difference(got, want)} |")
    return lines, wrong


def main():
    lines, wrong = table(os.path.abspath(sys.argv[1]))
    for text in wrong:
        print("FAILED:", text)
    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    found = re.search(re.escape(BEGIN) + "(.*?)" + re.escape(END), page, re.S)
    if not found:
        sys.exit(f"{PAGE} has no place for the table")
    made = "\n".join(lines) + "\n"
    if "--write" in sys.argv:
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(page[:found.start(1)] + made + page[found.end(1):])
    elif found.group(1) != made:
        wrong.append("the table")
        print("FAILED: the table of docs/comparison.md is another; run tests/peers/peers.py STRUT --write")
    print(f"{len(lines) - 2} numbers")
    sys.exit(bool(wrong))


main()

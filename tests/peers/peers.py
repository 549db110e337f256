#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of examples of other programs: runs these, and checks the tables of docs/comparison.md.

    python3 peers.py STRUT            fails if a number is not met, or if the tables of the page differ
    python3 peers.py STRUT --write    writes the tables

A section of examples.txt is of who made the numbers. An example is a line EXAMPLE: WHAT, and indented
  MODEL COMMAND OPTIONS | FILTER | NUMBER | WITHIN
with a jq filter, which may use tests/gallery/gallery.jq, and how far strut's number may be from theirs, as a part of
it. A line that ends with a backslash goes on in the next.
"""
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(ROOT, "docs", "comparison.md")
BEGIN, END = "<!-- peers -->\n", "<!-- /peers -->\n"
SAME = "<2e-8"
TITLES = {"closed form": "Closed forms", "computed apart": "Independent computations",
          "stored results": "Results that the program stores"}


def examples():
    """All rows, in order."""
    with open(os.path.join(HERE, "examples.txt"), encoding="utf-8") as file:
        lines = re.sub(r" \\\n +", " ", file.read()).splitlines()
    for line in lines:
        if line.startswith("["):
            by = line.strip("[]")
        elif line.startswith("  "):
            question, *filters, number, within = line.split("|")
            model, ask = question.split(maxsplit=1)
            yield {"by": by, "example": example, "what": what, "model": model, "ask": ask.strip(),
                   "filter": "|".join(filters).strip(), "number": number.strip(), "within": within.strip()}
        elif line and not line.startswith("#"):
            example, what = line.split(": ", 1)


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
    """Relative difference of strut's number from theirs, to one digit."""
    share = abs(got - want) / abs(want)
    return SAME if share < 2e-8 else f"{share:.0e}"


def tables(strut):
    """The lines of the tables, one for each origin of numbers, how many numbers these have, and errors."""
    origins, wrong = {}, []
    for row in examples():
        want, name = float(row["number"]), f"{row['example']}, {row['what']}"
        got = answer(strut, row)
        if not isinstance(got, float):
            wrong.append(f"{name}: {got}")
            continue
        if abs(got - want) > float(row["within"]) * abs(want):
            wrong.append(f"{name}: {got!r}, expected {want!r} within {row['within']}")
        link = row["example"].removeprefix(row["by"].split()[0] + ", ")
        found, alike = origins.setdefault(row["by"], ([], []))
        # models of the tests are not installed beside the pages
        link = f"[{link}](../{row['model']})" if row["model"].startswith("models/") else f"`{link}`"
        if difference(got, want) == SAME:
            alike.append(link)
            continue
        found.append(f"| {link}: {row['what']} | {difference(got, want)} |")
    lines = []
    for origin, (found, alike) in origins.items():
        lines += [f"### {TITLES.get(origin, origin)}", ""]
        if found:
            lines += ["| example | difference |", "|---|---|", *found, ""]
        if alike:
            others = "other numbers" if found else "numbers"
            lines += [f"{len(alike)} {others} differ by less than 2e-8.", ""]
    return lines, sum(len(found) + len(alike) for found, alike in origins.values()), wrong


def main():
    lines, numbers, wrong = tables(os.path.abspath(sys.argv[1]))
    for text in wrong:
        print("FAILED:", text)
    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    found = re.search(re.escape(BEGIN) + "(.*?)" + re.escape(END), page, re.S)
    if not found:
        sys.exit(f"{PAGE} has no place for the tables")
    made = "\n".join(lines) + "\n"
    if "--write" in sys.argv:
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(page[:found.start(1)] + made + page[found.end(1):])
    elif found.group(1) != made:
        wrong.append("the tables")
        print("FAILED: docs/comparison.md has other tables; run tests/peers/peers.py STRUT --write")
    print(f"{numbers} numbers")
    sys.exit(bool(wrong))


main()

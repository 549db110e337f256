# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers that a page says strut prints are printed.

A line "<!-- printed -->" claims this of the paragraph, list or table behind it: each of its numbers stands in an sh or
matlab block of the same section (up to the next heading) or in what the block printed, rounded to the digits shown.
Signs count where the page has one. Units may have other prefixes there, 500 um for 0.5 mm, or be missing, as in JSON.
Code and links are left out, and numbers in names such as n1 or P7.

usage: docs_numbers.py PAGE FOLDER, where FOLDER/%05d.log is what the block at that line printed
"""
import math
import os
import re
import sys

MARKER = "<!-- printed -->"
PREFIXES = {"": 1.0, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6}
BASES = {"%": ("%", 0.01), "degrees": ("rad", math.pi / 180), "deg": ("rad", math.pi / 180)}
BASES.update({base: (base, 1.0) for base in "N/m m/s rad/s m/s² Hz rad N J W g s m".split()})
UNIT = re.compile(r" ?([" + "".join(PREFIXES) + r"]?)(" + "|".join(sorted(BASES, key=len, reverse=True)) +
                  r")(?![\w/²^])")
NUMBER = re.compile(r"(?<![\w.])([-+−]?)(\d{1,3}(?:,\d{3})+|\d+(?:\.\d+)?)([eE][-+]?\d+)?(?![\d]|\.\d)")
SLACK = 0.6  # of a unit of the last digit: rounding, and last bits that differ from machine to machine


def numbers(text):
    """Of each number its text, sign ("" if there is none), size and unit of the last digit as written, and the base
    unit behind it with its factor."""
    for match in NUMBER.finditer(text):
        digits, exponent = match[2].replace(",", ""), float("1" + (match[3] or ""))
        unit = UNIT.match(text, match.end())
        base, factor = BASES[unit[2]] if unit else ("", 1.0)
        factor *= PREFIXES[unit[1]] if unit else 1.0
        last = 10.0 ** -len(digits.partition(".")[2]) * exponent
        text_of_it, sign = match[0] + (unit[0] if unit else ""), match[1].replace("−", "-")
        yield text_of_it, sign, float(digits) * exponent, last, base, factor


def occurs(claim, printed):
    _, sign, size, last, base, factor = claim
    for _, other_sign, other_size, _, other_base, other_factor in printed:
        if sign and (sign == "-") != (other_sign == "-"):
            continue
        if base == "":  # the unit of a column, say, is above it
            factor = other_factor = 1.0
        elif other_base not in ("", base):
            continue
        if abs(size * factor - other_size * other_factor) <= SLACK * last * factor:
            return True
    return False


def sections(lines):
    """Of each section the claimed paragraphs, with their lines, and the blocks of commands, with theirs."""
    claims, blocks, fence = [], [], None
    for at, line in enumerate(lines):
        if re.match(" *```", line):
            if fence is None and line.strip() in ("```sh", "```matlab"):
                end = next((i for i in range(at + 1, len(lines)) if lines[i].strip() == "```"), len(lines))
                blocks.append((at + 1, "\n".join(lines[at + 1:end])))
            fence = line if fence is None else None
        elif fence is None and line.startswith("#"):
            yield claims, blocks
            claims, blocks = [], []
        elif fence is None and line == MARKER:
            end = next((i for i in range(at + 1, len(lines)) if not lines[i]), len(lines))
            claims.append((at + 2, re.sub(r"`[^`]*`|\]\([^)]*\)", "", "\n".join(lines[at + 1:end]))))
    yield claims, blocks


page, folder = sys.argv[1:]
failures = 0


def fail(line, text):
    global failures
    failures += 1
    print(f"{page}, line {line}: {text}")


with open(page, encoding="utf-8") as file:
    lines = file.read().split("\n")
for at, text in enumerate(lines):
    if text != MARKER and text.strip(" <!->") == MARKER.strip(" <!->"):
        fail(at + 1, f"not spelled {MARKER}")
for claims, blocks in sections(lines):
    printed = []
    for line, text in blocks if claims else []:
        log = os.path.join(folder, f"{line:05d}.log")  # there is none of a command that was not run
        if os.path.exists(log):
            with open(log, encoding="utf-8") as output:
                text += "\n" + output.read()
        printed += numbers(text)
    for line, text in claims:
        claimed = list(numbers(text))
        if not claimed:
            fail(line, f"no number behind {MARKER}")
        for claim in claimed:
            if not occurs(claim, printed):
                fail(line, f"no command of this section prints {claim[0]}")
sys.exit(failures > 0)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints engine/study/tradeoff/rivals_table.h from the tables of `strut_bench rivals`: for each class of scenes and each
error the least and largest quotient of the CPU times of the best other solver and of strut's best method.

usage: rivals_table.py docs/rivals/rivals.txt > engine/study/tradeoff/rivals_table.h
"""
import re
import sys

CLASSES = {  # by the features that strut_tradeoff_classify reads; smooth friction on a contact is in none
    "CONTACT": ("crawler", "bouncing", "sliding"),
    "STIFF": ("bars",),
    "SMOOTH": ("net", "the net", "arm", "law", "10,000"),
}


def quotients(path):
    """(class, error as text): quotients of CPU times of its scenes, None where no other keeps the error."""
    found, scene, by_time = {}, None, False
    for line in open(path, encoding="utf-8"):
        if re.match(r"\S", line):
            scene = next((c for c, words in CLASSES.items() if line.startswith(words)), None)
        elif line.startswith("  error"):
            by_time = "CPU s" in line
        elif scene and by_time and re.match(r"  \de-\d\d ", line):
            text = line.split()[-2]
            found.setdefault((scene, line.split()[0]), []).append(None if text == "-" else float(text))
    return found


if __name__ == "__main__":
    rows = []
    for (scene, error), values in sorted(quotients(sys.argv[1]).items(), key=lambda i: (i[0][0], -float(i[0][1]))):
        known = [v for v in values if v is not None] or [0]
        rows.append(f"  X({scene}, {error}, {min(known):g}, {max(known):g}, {len(values)}, {values.count(None)})")
    print("/* SPDX-License-Identifier: GPL-3.0-or-later */\n"
          "/* Made by tests/bench/rivals_table.py from docs/rivals/rivals.txt: class, error, least and largest\n"
          "   quotient, scenes, those on which no other solver keeps the error. */\n"
          "#ifndef STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H\n"
          "#define STRUT_ENGINE_STUDY_TRADEOFF_RIVALS_TABLE_H\n"
          "/* clang-format off */\n"
          "#define STRUT_RIVALS(X) \\\n" + " \\\n".join(rows) + "\n#endif")

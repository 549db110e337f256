# SPDX-License-Identifier: GPL-3.0-or-later
r"""Every known answer about the structures of models/gallery and models/parts, by --json.

  gallery_test.py STRUT [NAME...]     NAMEs: only these models

A section of a file tests/gallery/*.answers is of the NAME.yaml of one of the two, or of models:

  [NAME]
  # a comment
  COMMAND [OPTIONS...] [%VARIANT] | FILTER | EXPECTED | TOLERANCE
  %VARIANT = SED-SCRIPT

The first runs `strut COMMAND MODEL OPTIONS... --json`, puts its output through the jq filter
(which may contain |, may use tests/gallery/gallery.jq, and gives one value) and compares. TOLERANCE
is absolute; EXPECTED then is a number, a list or a mapping of numbers, as jq writes or computes
them (without any |):
  0.995454545, (95 + 1000)/1100, root(2*3), [1, 2.5, 1e-3], {n1: [0, 1], n2: (1/3)}
With the TOLERANCE `=` the filter's value, as a text, must be EXPECTED to the letter:
  rigidity | .class | 1 | =        equilibria | stable | 1 | =       equilibria | .remark | null | =
A command that fails gives {"status": its exit status, "message": what it said}:
  modes --set load=20 | .status | 3 | =
The second line makes a variant of the scene by sed, for what a parameter cannot change:
  %free = s/fixed: [a-z]*/mass: 1/
A line that ends with a backslash goes on in the next. A line without a command asks that of the
line before, and so does what follows a ` ;; `: FILTER | EXPECTED | TOLERANCE.
"""
import glob
import json
import os
import re
import subprocess
import sys

from testing import check, fail, finish, models, path, strut, write

HERE = os.path.dirname(os.path.realpath(__file__))


def judge(answer, questions):
    """For each (filter, expected, tolerance) what is wrong with the answer; None: nothing."""
    tests = []
    for taken, expected, tolerance in questions:
        if tolerance == "=":
            wanted = json.dumps(expected)
            test = f'({taken}) | tostring | if . == {wanted} then null else "got \\(.), expected " + {wanted} end'
        else:
            test = (f"({taken}) as $got | ({expected}) as $want | ({tolerance}) as $near | "
                    "if agrees($got; $want; $near) then null else "
                    '"got \\($got | tojson), expected \\($want | tojson) within \\($near)" end')
        tests.append(f"[try ({test}) catch .]")
    done = subprocess.run(["jq", "-c", "-L", HERE, 'include "gallery"; ' + ", ".join(tests)], input=answer,
                          capture_output=True, text=True, check=False)
    if done.returncode == 0:
        values = [json.loads(line) for line in done.stdout.splitlines()]
        return [value[0] if len(value) == 1 else f"the filter gives {len(value)} values" for value in values]
    if len(questions) == 1:
        return [done.stderr.strip()]
    return [judge(answer, [question])[0] for question in questions]


def ask(model, command, variants):
    """What a command prints."""
    name, *words = command.split()
    for word in [word for word in words if word.startswith("%")]:
        words.remove(word)
        write("variant.sed", variants[word[1:]])
        done = subprocess.run(["sed", "-f", path("variant.sed"), model], capture_output=True, check=True)
        model = path("variant.yaml")
        write(model, done.stdout)
    done = subprocess.run([strut, name, model, *words, "--json"], capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else json.dumps({"status": done.returncode, "message": done.stderr})


def logical_lines(text):
    """(number, line), those that go on in the next joined."""
    held, start = "", 0
    for number, line in enumerate(text.splitlines(), 1):
        held, start = held + line.removesuffix("\\"), start or number
        if not line.endswith("\\"):
            yield start, held
            held, start = "", 0


def find_wrong(model, lines):
    """How many questions there are, and {number: what is wrong} of those whose answer is."""
    asked, variants, wrong, command = {}, {}, {}, ""
    for number, line in lines:
        if line.startswith("%"):
            name, script = line[1:].split("=", 1)
            variants[name.strip()] = script
        elif line.strip() and not line.startswith("#"):
            for question in re.sub(" +;; +", "\n|", line).splitlines():
                part = [part.strip() for part in question.split("|")]
                command = part[0] or command
                if len(part) < 4:
                    wrong[number] = f"not COMMAND | FILTER | EXPECTED | TOLERANCE: {question}"
                else:
                    asked.setdefault(command, []).append((number, (" | ".join(part[1:-2]), part[-2], part[-1])))
    for command, questions in asked.items():
        if missing := set(re.findall(r"%(\w+)", command)) - variants.keys():
            wrong[questions[0][0]] = f"{command}: no variant {missing}"
            continue
        answer = ask(model, command, variants)
        verdicts = judge(answer, [question for _, question in questions])
        for (number, question), what in zip(questions, verdicts):
            if what:
                wrong[number] = f"{command}: {question[0]}: {what} {json.loads(answer).get('message', '')}"
    return sum(map(len, asked.values())), wrong


# ---- the test itself: right answers pass, wrong ones are noticed ----
write("self.yaml", """strut: 1
name: itself
parameters: {long: 3 m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [long, 4 m], mass: 1}}
members: {m: {kind: bar, nodes: [a, b], stiffness: 1 N/m}}
""")
GOOD = r"""# right, all of them
%wide = s/4 m/40 m/
check | .name | itself | =
check | .members.m.drawn_length | 5 | 1e-12 ;; .members.m.stiffness | 1 | 0
| .members[] | [.drawn_length, .stiffness] | [root(9 + 16), 1] | 1e-12
check --set long=30 %wide | .members.m.drawn_length | 50 | \
  1e-12
check --set long=2kg | .status | 2 | =
"""
BAD = """check | .name | itsel | =
check | .members.m.drawn_length | 5.1 | 1e-2
check | .members.m.drawn_length | [5] | 1e-2
check | .members.m.no_length | 5 | 1e-2
check | .members[] | [.drawn_length] | [5, 1] | 1e-2
check --set long=2kg | .members.m.drawn_length | 5 | 1e-2
check --set long=30 | .members.m.drawn_length | 5 | 1e-2
check %none | .members.m.drawn_length | 5 | 1e-2
check | .members.m.drawn_length | 5
check | .members.( | 5 | 1
check | .name | itself | = ;; .members.m.stiffness | 2 | 0
"""
check(find_wrong(path("self.yaml"), logical_lines(GOOD)) == (6, {}), "a right answer is wrong")
noticed = find_wrong(path("self.yaml"), logical_lines(BAD))[1]
check(noticed.keys() == set(range(1, 12)), f"the test of itself notices only {noticed}")

# ---- the answers ----
sections, count = {}, 0
for file in sorted(glob.glob(f"{HERE}/*.answers")):
    with open(file, encoding="utf-8") as text:
        for number, line in logical_lines(text.read()):
            if line.startswith("["):
                name, lines = line.strip("[]"), []
                check(name not in sections, f"two sections [{name}]")
                sections[name] = os.path.basename(file), lines
            elif sections:
                lines.append((number, line))
for folder in ("gallery", "parts"):
    for file in glob.glob(f"{models}/{folder}/*.yaml"):
        name = os.path.basename(file).removesuffix(".yaml")
        check(name in sections, f"{file} needs a section [{name}] in tests/gallery")
for name, (file, lines) in sections.items():
    if name not in (sys.argv[2:] or sections):
        continue
    places = [f"{models}/{folder}{name}.yaml" for folder in ("gallery/", "parts/", "")]
    found = [place for place in places if os.path.exists(place)]
    if not found:
        fail(f"{file}: there is no {name}.yaml")
        continue
    questions, wrong = find_wrong(found[0], lines)
    count += questions
    for number, what in wrong.items():
        fail(f"{file}:{number}: {what}")
print(f"{count} answers")
finish()

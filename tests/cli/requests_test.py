# SPDX-License-Identifier: GPL-3.0-or-later
# Single evaluations: the bits of a sweep, answers in order whatever fails, hostile requests, interrupts,
# and the files of DAKOTA.
#
#   python3 requests_test.py STRUT
import csv
import json
import math
import os
import signal
import subprocess
import time

from testing import check, copy_models, finish, models, strut, work, write

truss = f"{models}/basics/von-mises-truss.yaml"
crawler = f"{models}/crawler/crawler.yaml"
copy_models()


def run(*words, code=0, lines=None, timeout=60):
    text = lines if isinstance(lines, bytes) else "".join(x + "\n" for x in lines or []).encode()
    done = subprocess.run([strut, *words], capture_output=True, cwd=work, input=text, timeout=timeout)
    check(done.returncode == code, f"strut {' '.join(words)}: exit code {done.returncode}, expected "
          f"{code}: {done.stderr.decode()}")
    return done


def answers(*words, code=0, lines):
    out = run("sweep", "--requests", "-", *words, code=code, lines=lines).stdout.decode()
    return [json.loads(line) for line in out.splitlines()]


def read(name):
    with open(os.path.join(work, name), encoding="utf-8") as file:
        return file.read()


write("block.yaml", """strut: 1
parameters: {stiffness: 100 N/m, seconds: 0.1 s, place: "near", id: 1}
nodes:
  wall: {position: [0, 0], fixed: both}
  block: {position: [1 m, 0], mass: id * 1 kg, fixed: y}
members:
  spring: {kind: spring, nodes: [wall, block], stiffness: stiffness, rest_length: 1 m}
configurations: {near: {}, far: {block: [1.2, 0]}}
initial: {configuration: place}
solver: {step: 1 ms}
run: {duration: seconds, measure: {node: block, quantities: {reach: block.x}}}
""")


def results_are_those_of_a_sweep():
    write("grid.yaml", f"""strut: 1
study: grid
model: copied/crawler/crawler.yaml
axes: [{{friction: [0.1, 0.3]}}, {{frequency: [9.7 Hz, 10 Hz]}}]
run: {{periods: 30, measure: {{last: 5}}}}
keep: [velocity, work, motion, positions]
""")
    run("sweep", "grid.yaml", "-o", "grid", "--quiet")
    with open(os.path.join(work, "grid/table.csv"), newline="") as file:
        table = list(csv.DictReader(file))
    asked = [{"friction": float(r["friction"]), "frequency": float(r["frequency [Hz]"])} for r in table]
    got = answers("grid.yaml", lines=[json.dumps(x) for x in asked])
    check(len(got) == 4, f"{len(got)} answers of 4")
    for row, answer in zip(table, got):
        bare = {k.split(" [")[0]: v for k, v in row.items()}
        for name, value in answer["results"].items():
            same = (bare[name] == (value or "")) if isinstance(value, str) or value is None else (
                float(bare[name]) == value)
            check(same, f"{name}: {value}, in the table {bare[name]}")
    units = answers("grid.yaml", lines=['{"set": {"friction": 0.1, "frequency": "9700 mHz"}}'])
    check(units[0]["results"]["velocity"] == got[0]["results"]["velocity"], "a text with a unit")


def every_computation():
    lines = [json.dumps({"id": w, "set": {}, "compute": w}) for w in
             ("equilibria", "modes", "rigidity", "path", "form")]
    got = answers(truss, "--compute", "modes", lines=lines + ["{}"])
    check([a.get("id") for a in got[:5]] == ["equilibria", "modes", "rigidity", "path", "form"], "ids")
    for answer in got:
        check(answer["code"] == 0 and answer["results"], f"an answer: {answer}")
    search = ['{"set": {"load": 0}, "compute": "equilibria"}']
    check(answers(truss, "--compute", "modes", lines=search) ==
          answers(truss, "--compute", "modes", "--threads", "2", lines=search), "two threads")
    # small vibration: 2 k sin^2 of the bars' slope, on 1 kg, with the rest lengths of the drawn shape
    level = {"id": 1.5, "set": {"load": 0, "stiffness": 500}, "keep": "frequencies"}
    got = answers(truss, "--compute", "modes", lines=[json.dumps(level)])[0]
    slope = 0.3 / math.hypot(1, 0.3)
    exact = math.sqrt(2 * 500 * slope ** 2) / (2 * math.pi)
    check(got["id"] == 1.5 and abs(got["results"]["frequency_1"] / exact - 1) < 1e-9,
          f"{got}, expected {exact}")
    count = json.loads(run("sweep", truss, "--requests", "-", "--compute", "modes", "--count", "--json").stdout)
    check({"name": "frequency_1", "unit": "Hz", "text": False} in count["results"],
          f"the columns: {count}")


def kept_and_measured():
    got = answers("block.yaml", "--keep", "reach,duration",
                  lines=['{"set": {"place": "far"}}', '{"seconds": 0.2, "id": 3}'])
    check(abs(got[0]["results"]["reach"] - 1.2) > 1e-3, "it moved")
    still = got[1]["results"]
    check(still["duration"] == 0.2 and abs(still["reach"] - 1) < 1e-12 and "id" not in got[1],
          f"'id' is a parameter here: {got[1]}")


def studies_and_their_variants():
    write("ways.yaml", """strut: 1
study: ways
model: block.yaml
axes: [{stiffness: [1 N/m]}]
set: {seconds: 20 ms}
derive: {id: 2}
variants: {coarse: {solver: {step: 2 ms}}, fine: {solver: {step: 0.5 ms}}}
limit: {evaluations: 100}
keep: [steps]
""")
    lines = ['{"set": {}}', '{"set": {}, "variant": "fine"}', '{"seconds": 0.04}', '{"seconds": 1}',
             '{"set": {}, "variant": "finer"}']
    got = answers("ways.yaml", code=2, lines=lines)
    check([a["code"] for a in got] == [0, 0, 0, 3, 2], f"{got}")
    check([a["results"]["steps"] for a in got[:3]] == [10, 40, 20], f"{got}")
    check("coarse" in got[4]["message"] and "100 force" in got[3]["message"], f"{got}")


def failures_go_on():
    deep = '{"a": ' * 40
    lines = [
        '{"height": 0.3}',
        '{"height": -1',                               # 2: cut off
        '{"hight": 2, "load": true}',                  # 3: both are reported
        '',                                            # blank lines are no requests
        '{"height": 1e999}',                           # 5
        '[1]', deep, '"\\ud800"', '{"height": 01}', '{"height": 1, "height": 2}',  # 6 to 10
        '{"set": {}, "keep": ["limits"]}', '{"set": {}, "compute": "magic"}', '{"set": {}, "wrong": 1}',
        '{"set": {}, "at": "start"}', '{"set": {}, "variant": "a"}', '{"id": [1], "set": {}}',
        '{"height": "5 kg"}', '{"stiffness": -1}', "nan", "{'height': 1}", '{"height": "\tx"}',
        '{"height": 0.4, "id": null}']
    got = answers(truss, "--compute", "form", code=2, lines=lines)
    check([a["line"] for a in got] == [i + 1 for i, x in enumerate(lines) if x], "each in its turn")
    for answer in got:
        good = answer["line"] in (1, len(lines))
        check((answer["code"] == 0) == good, f"line {answer['line']}: {answer}")
        if not good:
            place = f"<stdin>:{answer['line']}:" if answer["line"] != 18 else f"{truss}:27:56: "
            check(answer["message"].startswith(place),
                  f"without a place: {answer['message']}")
    by_line = {a["line"]: a for a in got}
    check(by_line[2]["message"].startswith("<stdin>:2:14: expected ',' or '}'"), by_line[2]["message"])
    check("did you mean 'height'" in by_line[3]["message"] and len(by_line[3]["messages"]) == 2,
          f"{by_line[3]}")
    check("given twice" in by_line[10]["message"], by_line[10]["message"])
    check("more than 32" in by_line[7]["message"], by_line[7]["message"])
    # a line that is too long is refused once, and the next one is read
    long = b'{"height": ' + b" " * (3 << 20) + b'0.3}\n{"height": 0.3}\n{"height"\0: 1}\n{"h\xff": 1}'
    got = answers(truss, "--compute", "form", code=2, lines=long)
    check([a["code"] for a in got] == [2, 0, 2, 2] and "1048576" in got[0]["message"], f"{got}")
    # a point that fails is answered, with exit code 3
    step = ['{"set": {"stiffness": 1e9}}', '{"set": {"stiffness": 1}}']
    got = answers("block.yaml", "--keep", "steps", code=3, lines=step)
    check(got[0]["code"] == 3 and got[0]["message"] and got[1]["results"] == {"steps": 100}, f"{got}")


def wrong_use():
    for words, code, text in (
            ((truss, "--keep", "velocty"), 1, "did you mean 'velocity'"),
            ((truss, "--compute", "magic"), 1, "expected run"),
            ((truss, "more"), 1, "unexpected argument 'more'"),
            (("-",), 1, "standard input"),
            ((truss, "--dakota", "a"), 1, "PARAMETERS RESULTS"),
            ((truss, "--compute", "modes", "--requests", "nothing"), 4, "nothing"),
            ((truss, "--set", "hight=1"), 2, "did you mean 'height'"),
            (("block.yaml", "--keep", "reich"), 2, "reich"),
            (("block.yaml", "--at", "x"), 1, "at")):
        how = () if "--dakota" in words or "--requests" in words else ("--requests", "-")
        done = run("sweep", *words, *how, code=code, lines=[])
        check(text in done.stderr.decode(), f"{words}: {done.stderr.decode()}")


def files():
    write("requests.jsonl", '{"height": 0.3}\n{"height": "x"}')
    run("sweep", truss, "--compute", "form", "--requests", "requests.jsonl", "--answers", "answers.jsonl", code=2)
    got = [json.loads(line) for line in read("answers.jsonl").splitlines()]
    check(len(got) == 2 and "requests.jsonl:2:12: " in got[1]["message"], f"{got}")
    write("mine.jsonl", "precious")
    run("sweep", truss, "--compute", "form", "--requests", "requests.jsonl", "--answers", "mine.jsonl", code=4)
    check(read("mine.jsonl") == "precious", "somebody else's file")


def a_worker_answers_at_once_and_can_be_stopped():
    worker = subprocess.Popen([strut, "sweep", "block.yaml", "--requests", "-", "--keep", "steps"], cwd=work,
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    worker.stdin.write(b'{"seconds": 0.05}\n')
    worker.stdin.flush()
    check(json.loads(worker.stdout.readline())["results"] == {"steps": 50}, "the first answer")
    worker.send_signal(signal.SIGINT)  # while it waits for a request
    check(worker.wait(10) == 130, f"stopped with {worker.returncode}")
    check(worker.stderr.read() == b"", "nothing to say")
    worker = subprocess.Popen([strut, "sweep", "block.yaml", "--requests", "-", "--answers", "part.jsonl"], cwd=work,
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    worker.stdin.write(b'{"seconds": 0.05}\n{"seconds": 1e6}\n')
    worker.stdin.flush()
    time.sleep(1)
    worker.send_signal(signal.SIGTERM)  # within a run
    check(worker.wait(10) == 130, f"stopped with {worker.returncode}")
    check(len(read("part.jsonl").splitlines()) == 1, "the answers until then")


STANDARD = """                                          2 variables
                      {stiffness} stiffness
                                    {place} place
                                          {count} functions
{functions}                                          1 derivative_variables
                                          1 DVV_1:stiffness
                                          1 analysis_components
                              block.yaml AC_1:strut
                                          1 eval_id
                                          0 metadata
"""
APREPRO = """                    {{ DAKOTA_VARS     =                      2 }}
                    {{ stiffness =  {stiffness} }}
                    {{ place =                 "{place}" }}
                    {{ DAKOTA_FNS      =                      {count} }}
{functions}                    {{ DAKOTA_DER_VARS =                      0 }}
                    {{ DAKOTA_AN_COMPS =                      0 }}
                    {{ DAKOTA_EVAL_ID  =                      1:2 }}
"""


def dakota(form, functions, code=0, stiffness="1.500000000000000e+02", place="far", keep="reach,steps"):
    line = "    {0} ASV_{1}:{2}\n" if form is STANDARD else "    {{ ASV_{1}:{2} = {0} }}\n"
    text = "".join(line.format(wanted, i + 1, name) for i, (name, wanted) in enumerate(functions))
    write("params.in", form.format(stiffness=stiffness, place=place, count=len(functions), functions=text))
    if os.path.exists(os.path.join(work, "results.out")):
        os.remove(os.path.join(work, "results.out"))
    return run("sweep", "block.yaml", "--keep", keep, "--dakota", "params.in", "results.out",
               code=code).stderr.decode()


def dakota_files():
    asked = '{"set": {"stiffness": 150, "place": "far"}}'
    want = answers("block.yaml", "--keep", "reach,steps", lines=[asked])[0]["results"]
    for form in (STANDARD, APREPRO):
        dakota(form, [("steps", 1), ("reach", 1)])
        got = [line.split() for line in read("results.out").splitlines()]
        check([g[1] for g in got] == ["steps", "reach"], f"in the order that DAKOTA wants: {got}")
        check({g[1]: float(g[0]) for g in got} == want, f"{got}, expected {want}")
        dakota(form, [("steps", 0), ("reach", 1)])
        check(read("results.out").split()[1:] == ["reach"], "what is not wanted is left out")
        dakota(form, [("response_fn_1", 1)], keep="reach")
        check(float(read("results.out").split()[0]) == want["reach"], "the only result")
        # a failed point; and one whose value makes no scene
        for stiffness in ("1e+12", "-5.0e+00"):
            dakota(form, [("reach", 1)], stiffness=stiffness)
            check(read("results.out") == "FAIL\n", f"{stiffness}: {read('results.out')}")
        for functions, words in (([("reach", 3)], "numerical_gradients"), ([("speed", 1)], "steps"),
                                 ([("reach", "x")], "from 0 to 7")):
            message = dakota(form, functions, code=2)
            check(words in message and "params.in:" in message, f"{functions}: {message}")
            check(not os.path.exists(os.path.join(work, "results.out")), "no results")
    for text, words in (
            ("", "lacks 'variables'"), ("2 variables\n1 stiffness\n", "ends within the 2 variables"),
            ("1 variables\n1 stifness\n1 functions\n1 ASV_1:steps\n", "params.in:2:3"),
            ("1 variables\nfar stiffness\n1 functions\n1 ASV_1:steps\n", "expected a number"),
            ("-1 variables\n", "params.in:1:1"), ("1 variables\nstiffness\n", "'VALUE NAME'"),
            ("9999999999 variables\n", "up to 100000"), ("{ DAKOTA_VARS = 1\n", "'{ NAME = VALUE }'"),
            ("1 variables\n1 stiffness\n1 variables\n", "once"), ("1 apples\n", "expected one of"),
            ("1 variables\n1 stiffness\n1 functions\n1 ASV_1:steps\n1 metadata\ns MD_1\n", "metadata")):
        write("params.in", text)
        done = run("sweep", "block.yaml", "--keep", "steps", "--dakota", "params.in", "none.out", code=2)
        check(words in done.stderr.decode(), f"{text!r}: {done.stderr.decode()}")


results_are_those_of_a_sweep()
every_computation()
kept_and_measured()
studies_and_their_variants()
failures_go_on()
wrong_use()
files()
a_worker_answers_at_once_and_can_be_stopped()
dakota_files()
finish()

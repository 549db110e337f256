# SPDX-License-Identifier: GPL-3.0-or-later
# What a point may cost, and the rows of a sweep that is interrupted: those that are done, with the
# bytes that they have in the end.
import os
import shutil
import signal
import time

from testing import check, copy_models, finish, path, read, rows, run, same_table, stopped, write

copy_models()


def lines(name):
    return read(name).decode().splitlines()


write("block.yaml", """strut: 1
parameters: {mass: 1 kg, seconds: 10 ms}
nodes: {wall: {position: [0, 0], fixed: both}, block: {position: [1, 0], mass: mass, fixed: y}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: 100, damping: 1}}
solver: {step: 1 ms}
run: {duration: seconds, measure: {node: block}}
""")


def study(name, rest):
    write(name + ".yaml", "strut: 1\nstudy: s\nmodel: block.yaml\n" + rest)


def evaluations():
    """A budget of force evaluations: the same rows whatever the threads and shards."""
    study("budget", "axes: [{seconds: [10 ms, 1000 s, 20 ms, 10000 s, 0.3 s, 0.4 s, 5000 s, 1 s]}]\n"
                    "limit: {evaluations: 20000}\nkeep: [duration, steps]\ncheck: {half_step: yes}\n")
    run("sweep", "budget.yaml", "-o", "one", "--threads", "1", code=3)
    table = rows("one/table.csv")
    good = [r["status"] == "completed" for r in table]
    check(good == [True, False, True, False, True, True, False, True], f"{good}")
    check(table[1]["status"] == "the work allowed was used up" and
          "work budget of 20000 force evaluations" in table[1]["message"], f"{table[1]}")
    same_table("budget.yaml", "one", (2, 8), (3, 3, 0), code=3)
    # An accuracy has its own budget, which this one bounds.
    write("accurate.yaml", f"""strut: 1
study: s
model: copied/crawler/crawler.yaml
axes: [{{friction: [0.1]}}]
solver: {{accuracy: 0.1 %}}
limit: {{evaluations: 3000}}
keep: [velocity, force_evaluations]
""")
    done = run("sweep", "accurate.yaml", "-o", "accurate", code=3)
    row = rows("accurate/table.csv")[0]
    check(row["status"] != "completed" or float(row["force_evaluations"]) < 10000, f"{row} {done}")


def clock():
    """Wall time: the row says that it depends on the machine; --retry computes it again."""
    study("clock", "axes: [{seconds: [10 ms, 1e6 s, 20 ms, 1e6 s, 30 ms]}]\n"
                   "limit: {time: 0.2 s}\nkeep: [duration]\n")
    began = time.monotonic()
    run("sweep", "clock.yaml", "-o", "clock1", "--threads", "2", code=3)
    check(time.monotonic() - began < 20, "it takes long")
    table = rows("clock1/table.csv")
    for k in (1, 3):
        check(table[k]["status"] == "the work allowed was used up" and
              "0.2 s by the clock" in table[k]["message"] and
              "another machine" in table[k]["message"], f"{table[k]}")
    check(all(table[k]["status"] == "completed" for k in (0, 2, 4)), "the others")
    study("clock", "axes: [{seconds: [10 ms, 1e6 s, 20 ms, 1e6 s, 30 ms]}]\n"
                   "limit: {time: 0.1 s}\nkeep: [duration]\n")
    run("sweep", "clock.yaml", "-o", "clock1", "--retry", code=3)
    check("0.1 s by the clock" in rows("clock1/table.csv")[1]["message"], "another time, with --retry")
    write("search.yaml", f"""strut: 1
study: s
model: copied/crawler/crawler.yaml
compute: equilibria
axes: [{{friction: [0.1]}}]
limit: {{time: 50 ms}}
""")
    run("sweep", "search.yaml", "-o", "search", code=3)
    check("0.05 s by the clock" in rows("search/table.csv")[0]["message"], "a search is ended")


def partial():
    """Ctrl-C: the rows that are done, byte for byte those of the whole table."""
    study("long", "axes: [{mass: {from: 1 kg, to: 2 kg, count: 200}}]\nset: {seconds: 100 s}\n"
                  "keep: [duration, velocity]\n")
    run("sweep", "long.yaml", "-o", "whole", "--quiet")
    whole = lines("whole/table.csv")
    check(not os.path.exists(path("whole/table-partial.csv")), "the whole table needs no partial one")
    for wait in (0.5, 1.0):
        shutil.rmtree(path("stopped"), ignore_errors=True)
        said = stopped("sweep", "long.yaml", "-o", "stopped", "--threads", "2", after=wait, by=signal.SIGINT).stderr
        if os.path.exists(path("stopped/table.csv")):
            print("    it was done before it could be interrupted")
            continue
        check("the same command resumes" in said, said)
        if "has the" not in said:
            continue
        part = lines("stopped/table-partial.csv")
        check(part[0] == whole[0] and 1 < len(part) < len(whole), f"{len(part)} lines")
        check(part == [line for line in whole if line in set(part)], "rows and their order")
        check(f"has the {len(part) - 1} rows" in said, said)
    run("sweep", "long.yaml", "-o", "stopped", "--quiet")
    check(lines("stopped/table.csv") == whole, "resumed")
    check(not os.path.exists(path("stopped/table-partial.csv")), "the partial table is removed")


evaluations()
clock()
partial()
finish()

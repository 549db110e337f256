# SPDX-License-Identifier: GPL-3.0-or-later
# Points of files and of samples: strut's own tables read back to the same bits, distributions against
# their closed forms, the same bytes whatever the threads, shards and interruptions, files that lead
# elsewhere.
import math
import os
import shutil

from testing import check, finish, path, read, rows, run, same_table, write


write("block.yaml", """strut: 1
parameters: {stiffness: 100 N/m, mass: 1 kg, seconds: 2 ms, place: "near", shift: 0 m, turn: 0, slow: 0 m/s}
nodes: {wall: {position: [0, 0], fixed: both},
        block: {position: [1 m + shift + turn * 1 m + slow * 1 s, 0], mass: mass, fixed: y}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: stiffness, damping: 1 N s/m}}
configurations: {near: {}, far: {block: [1.2, 0]}}
initial: {configuration: place}
solver: {step: 10 us}
run: {duration: seconds, measure: {node: block}}
""")


def sweep(name, axes, *words):
    write(name + ".yaml", f"strut: 1\nstudy: s\nmodel: block.yaml\naxes: {axes}\nkeep: [duration]\n")
    run("sweep", name + ".yaml", "-o", name, "--quiet", *words)
    return rows(name + "/table.csv")


def own_tables_are_points():
    """A table gives its own points again; copies beside the results are enough."""
    first = sweep("first", "[{mass: {from: 1 kg, to: 3 kg, count: 7}}, "
                           "{place: [near, far]}, {seconds: [1 ms, 0.1 s/3]}]")
    shutil.copy(path("first/table.csv"), path("points.csv"))
    again = sweep("again", "[{points: {file: points.csv, columns: [mass, place, seconds]}}]")
    check([(r["mass [kg]"], r["place"], r["seconds [s]"]) for r in first] ==
          [(r["mass [kg]"], r["place"], r["seconds [s]"]) for r in again], "the same bits")
    os.remove(path("points.csv"))
    os.rename(path("again"), path("moved"))
    run("sweep", "moved/study.yaml", "-o", "once-more", "--quiet")
    check(read("once-more/table.csv") == read("moved/table.csv"), "from the copies")
    # A changed cell is another study.
    text = read("moved/points-1.csv").decode()
    write("moved/points-1.csv", text.replace("near", "far", 1))
    run("sweep", "moved/study.yaml", "-o", "once-more", code=1, err="another study")


def units_and_quotes():
    write("units.csv", '\ufeff"mass [g]",place,stiffness,seconds [ms]\r\n'
                       '100,"near",1e2,0.1\r\n"0.1",far,+3,7\r\n\r\n')
    table = sweep("units", "[{points: units.csv}]")
    check([r["mass [kg]"] for r in table] == ["0.1", "0.0001"], f"masses {table}")
    check([r["seconds [s]"] for r in table] == ["0.0001", "0.007"], f"seconds {table}")
    check([r["stiffness [N/m]"] for r in table] == ["100", "3"], f"stiffness {table}")


OVER = ("{mass: {uniform: [1 kg, 2 kg]}, stiffness: {log_uniform: [1 N/m, 1000 N/m]}, "
        "shift: {normal: [0 m, 10 mm]}, seconds: {triangular: [1 ms, 2 ms, 5 ms]}, "
        "turn: {lognormal: [0.1, 0.2]}}")


def normal(z):
    return 0.5 * (1 + math.erf(z / math.sqrt(2)))


def triangular(x):
    return (x - 1e-3) ** 2 / (4e-3 * 1e-3) if x < 2e-3 else 1 - (5e-3 - x) ** 2 / (4e-3 * 3e-3)


SHARES = {"mass [kg]": lambda x: x - 1,
          "stiffness [N/m]": lambda x: math.log(x) / math.log(1000),
          "shift [m]": lambda x: normal(x / 0.01),
          "seconds [s]": triangular,
          "turn": lambda x: normal(math.log(x / 0.1) / 0.2)}


def samples():
    """Shares of the distributions are uniform: within strata by lhs, closer than chance by sobol."""
    count = 256
    far = {}
    for scheme in ("sobol", "lhs", "random"):
        table = sweep(scheme, f"[{{sample: {{count: {count}, seed: 5, scheme: {scheme}, over: {OVER}}}}}]")
        check(len(table) == count, f"{scheme}: {len(table)} points")
        shares = {c: [f(float(r[c])) for r in table] for c, f in SHARES.items()}
        for column, values in shares.items():
            check(all(0 < u < 1 for u in values), f"{scheme}: shares of {column}")
            ordered = sorted(values)
            far[scheme, column] = max(max(abs(u - i / count), abs(u - (i + 1) / count)) for i, u in enumerate(ordered))
            strata = len({int(u * count) for u in values})
            if scheme == "lhs":
                check(strata == count, f"lhs: {column} meets {strata} strata")
            limit = {"sobol": 0.012, "lhs": 1.001 / count, "random": 1.63 / math.sqrt(count)}[scheme]
            check(far[scheme, column] < limit, f"{scheme}: {column} is off by {far[scheme, column]}")
        # Numbers are independent: quadrants of each pair, Kolmogorov's distance of each alone.
        names = list(shares)
        for i, a in enumerate(names):
            for b in names[:i]:
                quarter = sum(u < .5 and v < .5 for u, v in zip(shares[a], shares[b])) / count
                check(abs(quarter - 0.25) < 0.09, f"{scheme}: {a} and {b}: {quarter}")
    other = sweep("other", f"[{{sample: {{count: {count}, seed: 6, over: {OVER}}}}}]")
    check(other[0]["mass [kg]"] != rows("sobol/table.csv")[0]["mass [kg]"], "another seed")
    # A parameter more changes no other.
    more = sweep("more", f"[{{sample: {{count: {count}, seed: 5, over: "
                         f"{OVER[:-1]}, slow: {{uniform: [0, 1]}}}}}}}}]")
    check(all(a["mass [kg]"] == b["mass [kg]"] and a["turn"] == b["turn"] for a, b in
              zip(more, rows("sobol/table.csv"))), "a parameter more changes others")


def same_bytes():
    axes = f"[{{sample: {{count: 40, scheme: lhs, over: {OVER}}}}}, {{place: [near, far]}}]"
    sweep("whole", axes)
    same_table("whole.yaml", "whole")


def refused(axes, *said):
    write("bad.yaml", f"strut: 1\nstudy: s\nmodel: block.yaml\naxes: [{axes}]\n")
    done = run("sweep", "bad.yaml", "-o", "bad", code=2, timeout=10)
    for text in said:
        check(text in done.stderr, f"{axes}: lacks '{text}': {done.stderr}")
    check(not os.path.exists(path("bad")), f"{axes}: a folder was made")


def elsewhere():
    os.mkdir(path("inner"))
    os.symlink("/etc/passwd", path("link.csv"))
    os.symlink("/etc", path("etc"))
    os.mkfifo(path("pipe.csv"))
    write("fine.csv", "mass [kg]\n1\n")
    os.symlink("../fine.csv", path("inner/up.csv"))
    refused("{points: link.csv}", "bad.yaml:4:17:", "leads out of the folder")
    refused("{points: etc/passwd}", "leads out of the folder")
    refused("{points: pipe.csv}", "not a regular file")
    refused("{points: inner}", "not a regular file")
    refused("{points: ../fine.csv}", "has a '..'")
    refused("{points: /dev/zero}", "absolute path")
    refused("{points: none.csv}", "No such file")
    check(len(sweep("linked", "[{points: inner/up.csv}]")) == 1, "a link within the folder")
    write("cells.csv", "mass [kg],stiffness [N/m]\n1,x\n2,3\n,-4 N/m\n")
    refused("{points: cells.csv}", "cells.csv:2:3: error: expected a number for 'stiffness', found 'x'",
            "cells.csv:4:1: error: expected a number for 'mass', found an empty cell", "cells.csv:4:2:")
    write("many.csv", "mass\n" + "1\n" * 1000001)
    refused("{points: many.csv}", "1000001 rows")


own_tables_are_points()
units_and_quotes()
samples()
same_bytes()
elsewhere()
finish()

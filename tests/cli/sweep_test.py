# SPDX-License-Identifier: GPL-3.0-or-later
# strut sweep from outside: points against numpy, rows against single runs, the same bytes whatever
# the threads, shards and kills, points that fail, studies that have changed.
#
#   python3 sweep_test.py STRUT [KILLS]      KILLS: 10 if not given
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time

from testing import answer, check, copy_models, finish, models, needs, read, rows, run, same_table, stopped, strut, sweep, work, write

needs("numpy")
import numpy as np  # noqa: E402

kills = int(sys.argv[2]) if len(sys.argv) > 2 else 10
copy_models()
os.chdir(work)

BLOCK = """strut: 1
name: Block
parameters: {stiffness: 100 N/m, mass: 1 kg, seconds: 0.5 s, step: 1 ms, place: "near"}
nodes:
  wall: {position: [0, 0], fixed: both}
  block: {position: [1, 0], mass: mass, fixed: y}
members:
  spring: {kind: spring, nodes: [wall, block], stiffness: stiffness, damping: 1 N s/m}
configurations: {near: {}, far: {block: [1.2, 0]}}
initial: {configuration: place}
solver: {step: step}
run: {duration: seconds, measure: {node: block}}
"""
write("block.yaml", BLOCK)


def points_are_those_of_numpy():
    write("grid.yaml", """strut: 1
study: grid
model: block.yaml
axes:
  - place: [near, far]
  - stiffness: {from: 1 N/m, to: 1000 N/m, count: 7, scale: log}
  - zip: {mass: {from: 1 kg, to: 2 kg, step: 0.1 kg}, step: {from: 1 ms, to: 2 ms, count: 11}}
  - seconds: {from: 5 ms, to: 16 ms, step: 2 ms}
keep: [duration]
""")
    count = answer("sweep", "grid.yaml", "--count")
    stiffness = np.geomspace(1, 1000, 7)
    mass = np.linspace(1, 2, 11)
    step = np.linspace(1e-3, 2e-3, 11)
    seconds = np.arange(5e-3, 16e-3, 2e-3)
    total = 2 * 7 * 11 * len(seconds)
    check(count["points"] == total, f"{count['points']} points, expected {total}")
    run("sweep", "grid.yaml", "-o", "grid", "--quiet")
    table = rows("grid/table.csv")
    check(len(table) == total, "the table's length")
    for n, row in enumerate(table):
        i = np.unravel_index(n, (2, 7, 11, len(seconds)))
        wanted = [stiffness[i[1]], mass[i[2]], step[i[2]], seconds[i[3]]]
        found = [float(row[k]) for k in ("stiffness [N/m]", "mass [kg]", "step [s]", "seconds [s]")]
        good = (np.allclose(found, wanted, rtol=1e-14, atol=0) and
                row["place"] == ("near", "far")[i[0]] and int(row["point"]) == n)
        check(good, f"point {n}: {row}, expected {wanted}")
        if not good:
            return
    # Ends and steps have the bits of what was written.
    check(table[-1]["mass [kg]"] == "2" and table[5]["seconds [s]"] == "0.015", "bits of the ends")


CRAWLER = """strut: 1
study: crawler
model: copied/crawler/crawler.yaml
axes:
  - start: [I, II]
  - frequency: {from: 8 Hz, to: 16 Hz, count: 9}
run: {periods: 12, measure: {last: 4}}
keep: [velocity, force_evaluations, residual, work, contacts, positions, outcome]
"""


ROD = """strut: 1
parameters: {mass: 1 kg, stiff: 1e5 N/m}
gravity: [0, -9.81]
nodes: {pin: {position: [0, 0], fixed: both}, tip: {position: [0, 1], mass: mass}}
members: {rod: {kind: bar, nodes: [pin, tip], stiffness: stiff, damping: 10}}
initial: {settle: true}
solver: {step: 1 ms}
run: {duration: 0.1 s}
"""


def warnings_are_counted():
    """Once per cause, with how many runs gave it; and a column for unstable starts."""
    write("rod.yaml", ROD)
    write("rods.yaml", """strut: 1
study: rods
model: rod.yaml
axes: [{mass: [1 kg, 2 kg, 3 kg]}]
""")
    done = run("sweep", "rods.yaml", "-o", "rods", "--json", "--threads", "2")
    warnings = json.loads(done.stdout)["warnings"]
    check(len(warnings) == 1 and warnings[0]["runs"] == 3 and warnings[0]["point"] == 0, f"warnings {warnings}")
    check(done.stderr.count("warning") == 1 and "3 of 3 runs, first point 0: " in done.stderr,
          f"warnings on stderr: {done.stderr}")
    check([row["start_unstable"] for row in rows("rods/table.csv")] == ["1"] * 3, "the column of unstable starts")
    write("rod.yaml", ROD.replace("settle: true", "settle: {perturb: yes}"))
    done = run("sweep", "rods.yaml", "-o", "hanging", "--json")
    check(not json.loads(done.stdout)["warnings"] and not done.stderr, "warnings of nothing")
    write("deep.yaml", """strut: 1
parameters: {depth: 1 mm}
nodes: {block: {position: [0, -depth], mass: 1}}
gravity: [0, -9.81]
ground: {stiffness: 1e5, damping: 100, friction: {mu: 0.3, stick_velocity: 1 mm/s}}
solver: {step: 0.1 ms}
run: {duration: 1 ms}
""")
    write("deeper.yaml", "strut: 1\nstudy: s\nmodel: deep.yaml\nkeep: [outcome]\naxes: [{depth: [0.01 mm, 2 cm, 3 cm]}]\n")
    done = run("sweep", "deeper.yaml", "-o", "deeper", "--json")
    deep = [(w["code"], w["runs"], w["point"]) for w in json.loads(done.stdout)["warnings"]]
    check({("inside_ground", 2, 1), ("outcome", 3, 0)} <= set(deep) and "node block starts inside the ground" in done.stderr, f"{deep}")
    check([row["start_unstable"] for row in rows("hanging/table.csv")] == ["0"] * 3, "the column of stable starts")


def rows_are_single_runs():
    write("crawler.yaml", CRAWLER)
    run("sweep", "crawler.yaml", "-o", "one", "--threads", "1", "--quiet")
    table = rows("one/table.csv")
    write("single.yaml", open(f"{models}/crawler/crawler.yaml").read().replace(
        "run: {periods: 1100, of: drive, measure: {last: 100}}",
        "run: {periods: 12, of: drive, measure: {last: 4}}"))
    for n in (0, 4, 13):
        row = table[n]
        single = answer("run", "single.yaml", "--set", f"start={row['start']}",
                                "--set", f"frequency={row['frequency [Hz]']} Hz")
        pairs = [(row["velocity [m/s]"], single["velocity"]),
                 (row["force_evaluations"], single["force_evaluations"]),
                 (row["drive_work [J]"], single["energy"]["drive_work"]),
                 (row["residual [J]"], single["energy"]["residual"]),
                 (row["duty_n4"], single["contacts"]["n4"]["duty"]),
                 (row["x_n5 [m]"], single["nodes"]["n5"]["position"][0])]
        for found, wanted in pairs:
            check(float(found) == wanted, f"point {n}: {found}, a run by itself gives {wanted}")
        check(row["outcome"] == row["start"], f"point {n} ends as {row['outcome']}")
    check(len({row["velocity [m/s]"] for row in table}) == len(table), "velocities are all alike")


# Points that fail or have other terms stand between those that go side by side; all are run twice.
MIXED = """strut: 1
study: mixed
model: copied/crawler/crawler.yaml
axes:
  - start: [I, II]
  - step: [0.1 ms, 10 ms]
  - friction: [0, 0, 0.1, 0.1, 0.1, 0, 0, 0, 0, 0, 0, 0.5]
run: {periods: 10, measure: {last: 1}}
check: {half_step: yes}
"""
MOTIONS = """strut: 1
study: motions
model: copied/crawler/crawler.yaml
axes:
  - frequency: {from: 8 Hz, to: 16 Hz, count: 11}
run: {periods: 10, measure: {last: 1}}
trajectories: yes
"""
EVENTS = CRAWLER.replace("study: crawler", "study: events").replace(
    "run:", "solver: {integrator: verlet-events, step: 0.05 ms}\nrun:")


def threads_change_nothing():
    write("mixed.yaml", MIXED)
    write("motions.yaml", MOTIONS)
    write("events.yaml", EVENTS)
    ends = {"crawler": 0, "events": 0, "mixed": 3, "motions": 0}
    for name, code in ends.items():
        run("sweep", f"{name}.yaml", "-o", f"{name}-1", "--threads", "1", "--quiet", code=code)
        for threads in (2, 5):
            folder = f"{name}-{threads}"
            run("sweep", f"{name}.yaml", "-o", folder, "--threads", f"{threads}", "--quiet", code=code)
            for file in ("table.csv", "points.slots"):
                check(read(f"{folder}/{file}") == read(f"{name}-1/{file}"), f"{folder}/{file}")
    same_table("crawler.yaml", "one", (), (0, 0))
    table = rows("mixed-1/table.csv")
    check(len(table) == 48 and [row["status"] for row in table].count("completed") == 24,
          "half of the mixed points fail")
    check(all(float(row["check_velocity [m/s]"]) != float(row["velocity [m/s]"])
              for row in table if row["status"] == "completed"), "mixed: half the step")
    same_runs("motions-5", "motions-1")


def same_runs(one, other):
    for n in range(11):
        for file in ("summary.json", "trajectory.h5", "scene.yaml"):
            name = f"runs/{n:09d}/{file}"
            check(read(one, name) == read(other, name), f"{one}: {name}")


def killed_and_resumed():
    before = 0
    for n in range(kills):
        child = stopped("sweep", "crawler.yaml", "-o", "killed", "--threads", "2", "--quiet",
                        after=random.uniform(0.0, 0.25))
        if child.returncode == 0:  # over before: once more from the beginning
            check(read("killed/table.csv") == read("one/table.csv"), f"after {n} kills: table")
            shutil.rmtree("killed")
            before = 0
            continue
        if not os.path.exists("killed/points.slots"):
            continue
        seen = subprocess.run([strut, "sweep", "crawler.yaml", "-o", "killed", "--status", "--json"],
                              capture_output=True, text=True)
        if seen.returncode:  # killed before the header was whole
            continue
        done = json.loads(seen.stdout)["done"]
        check(done >= before, f"{before} points were done, now {done}")
        before = done
    end = answer("sweep", "crawler.yaml", "-o", "killed")
    check(end["computed"] == end["points"] - before,
          f"{end['computed']} computed at the end, {before} were done of {end['points']}")
    check(read("killed/table.csv") == read("one/table.csv"), "after kills: table")
    again = answer("sweep", "crawler.yaml", "-o", "killed")
    check(again["computed"] == 0, "a finished sweep computes again")


def stages(folder):
    """Folders below it in which results of runs are gathered."""
    return [f"{path}/{name}" for path, names, _ in os.walk(folder) for name in names
            if name.startswith(".strut-stage-")]


def killed_while_recording():
    write("motions.yaml", MOTIONS)
    run("sweep", "motions.yaml", "-o", "recorded", "--quiet")
    left = 0
    for n in range(kills):
        chance = random.random()
        stopped("sweep", "motions.yaml", "-o", "cut", "--threads", "2", "--quiet",
                after=lambda: stages("cut") and random.random() < 0.1 + 0.9 * chance)
        left += len(stages("cut"))
        if os.path.exists("cut/points.slots") and n % 3 == 2:
            os.remove("cut/points.slots")  # begin anew, so that there is something to kill
    check(left > 0, "no kill left anything: nothing was tested")
    # What is not provably strut's stays: other names, no mark, the mark of another machine.
    others = ["cut/runs/000000002/.strut-stage-mine", "cut/runs/000000003/.strut-stage-1-0"]
    for folder, name in zip(others, ("notes", ".strut-stage")):
        os.makedirs(folder, exist_ok=True)
        write(f"{folder}/{name}", "mine\n")
    run("sweep", "motions.yaml", "-o", "cut", "--quiet")
    check(sorted(stages("cut")) == others, f"after kills: {stages('cut')}")
    for folder, name in zip(others, ("notes", ".strut-stage")):
        check(read(f"{folder}/{name}") == b"mine\n", f"{folder} was touched")
    check(read("cut/table.csv") == read("recorded/table.csv"), "after kills: table")
    same_runs("cut", "recorded")


def interrupted():
    run("sweep", "crawler.yaml", "-o", "stopped", "--quiet")
    os.remove("stopped/points.slots")  # its table is that of an earlier sweep then
    slots = "stopped/points.slots"
    child = stopped("sweep", "crawler.yaml", "-o", "stopped", "--threads", "1", by=signal.SIGINT,
                    after=lambda: os.path.exists(slots) and os.path.getsize(slots) > 6000)
    if child.returncode == 0:
        return  # it was over before
    check(child.returncode == 130, f"interrupted: exit code {child.returncode}")
    check("the same command resumes" in child.stderr, f"interrupted: {child.stderr}")
    check(not os.path.exists("stopped/table.csv"), "an earlier table beside new points")
    run("sweep", "crawler.yaml", "-o", "stopped", "--quiet")
    check(read("stopped/table.csv") == read("one/table.csv"), "after an interrupt: table")


def points_that_fail():
    write("fails.yaml", """strut: 1
study: fails
model: block.yaml
set: {seconds: 5 s}
axes:
  - step: [1 ms, 1, 2 ms]
  - stiffness: [100, 200]
keep: [velocity]
""")
    run("sweep", "fails.yaml", "-o", "fails", code=3, err="2 of 6 points failed")
    table = rows("fails/table.csv")
    check([row["status"] for row in table].count("completed") == 4, "four complete")
    check(all("above the largest stable step" in row["message"] and not row["velocity [m/s]"]
              for row in table[2:4]), "why they failed")
    status = answer("sweep", "fails.yaml", "-o", "fails", "--status")
    check([f["point"] for f in status["failures"]] == [2, 3] and status["missing"] == 0, "status")


def failed_points_once_more():
    """A failed point is never computed again, but by --retry; what is done is not."""
    def computed(*words):
        return answer("sweep", "fails.yaml", "-o", "fails", *words, code=3)["computed"]
    table, slots = read("fails/table.csv"), read("fails/points.slots")
    check(computed() == 0, "failed points are computed again")
    check(computed("--retry") == 2, "--retry")
    check(read("fails/table.csv") == table and read("fails/points.slots") == slots, "--retry: table")
    run("sweep", "fails.yaml", "-o", "shards2", "--shard", "1/2", "--quiet", code=3)
    run("sweep", "fails.yaml", "-o", "shards2", "--shard", "0/2", "--retry", "--quiet", code=3)
    run("sweep", "fails.yaml", "-o", "shards2", "--shard", "1/2", "--retry", "--quiet", code=3)
    run("sweep", "--merge", "shards2", code=3)
    check(read("shards2/table.csv") == table, "--retry of shards: table")
    for word in ("--status", "--count"):
        run("sweep", "fails.yaml", "-o", "fails", "--retry", word, code=1)


def a_directory_stands_for_itself():
    """study.yaml and model.yaml of the results make them again, wherever they are."""
    os.makedirs("models/deep")
    write("models/deep/block.yaml", BLOCK)
    # Places of all kinds: in quotes, with an anchor, in a flow mapping, behind a wide character.
    ways = ["model: models/deep/block.yaml   # where it is",
            "model: 'models/deep/block.yaml'", "model: &m models/deep/block.yaml",
            "model:\n  models/deep/block.yaml", "model: |-\n  models/deep/block.yaml"]
    for n, way in enumerate(ways):
        write("own.yaml", f"strut: 1\nstudy: \"\u00fc\"\n{way}\naxes: [{{mass: [1 kg, 2 kg]}}]\n")
        run("sweep", "own.yaml", "-o", f"own{n}", "--set", "seconds=0.1 s", "--quiet")
        copy = read(f"own{n}/study.yaml").decode()
        check("# A copy; its model was models/deep/block.yaml" in copy, copy)
        check("# It was run with --set seconds=0.1 s" in copy, copy)
        os.rename(f"own{n}", f"models/moved{n}")
        place = f"models/moved{n}"
        run("sweep", f"{place}/study.yaml", "-o", f"again{n}", "--set", "seconds=0.1 s", "--quiet")
        check(read(f"again{n}/table.csv") == read(f"{place}/table.csv"), f"{way}: table")
        before = read(f"{place}/study.yaml"), read(f"{place}/model.yaml")
        end = answer("sweep", f"{place}/study.yaml", "-o", place, "--set", "seconds=0.1 s")
        check(end["computed"] == 0, f"{way}: not the same study")
        check((read(f"{place}/study.yaml"), read(f"{place}/model.yaml")) == before, "copies of copies")
    # A copy of a copy is the same text; a model that has changed is another study.
    check(read("again0/study.yaml").count(b"A copy") == 1, "copies of copies")
    write("models/moved0/model.yaml", BLOCK.replace("1 N s/m", "2 N s/m"))
    run("sweep", "models/moved0/study.yaml", "-o", "again0", "--set", "seconds=0.1 s", code=1)
    # What is not ours stays: results in the study's own folder.
    os.makedirs("home")
    write("home/block.yaml", BLOCK)
    write("home/model.yaml", "another one")
    write("home/mine.yaml", "strut: 1\nstudy: x\nmodel: block.yaml\naxes: [{mass: [1 kg]}]\n")
    run("sweep", "home/mine.yaml", "-o", "home", code=1, err="give another directory")
    check(sorted(os.listdir("home")) == ["block.yaml", "mine.yaml", "model.yaml"] and
          read("home/model.yaml") == b"another one", "a file of the user's is gone")
    os.remove("home/model.yaml")
    run("sweep", "home/mine.yaml", "-o", "home", "--quiet")
    run("sweep", "home/mine.yaml", "-o", "home", "--quiet")


def checked_again():
    table = sweep("check", """model: block.yaml
axes:
  - seconds: [0.1 s, 0.157 s]
  - place: [near, far]
check: {half_step: yes}
""")
    for row in table:
        check(row["check_outcome"] == row["outcome"] and row["flips"] == "0", f"{row}")
        v, w = float(row["velocity [m/s]"]), float(row["check_velocity [m/s]"])
        check(abs(v - w) < 1e-6, "half the step, about the same velocity")
        check(v == 0 or v != w, "the second run has another step")


def figures():
    study = """strut: 1
study: figures
model: block.yaml
axes:
  - mass: [1 kg, 2 kg, 3 kg]
  - seconds: [0.1 s, 0.2 s]
figures:
  lines: {x: mass, y: velocity, series: seconds, title: All lines}
  map: {kind: map, x: mass, y: seconds, color: outcome}
"""
    write("figures.yaml", study)
    run("sweep", "figures.yaml", "-o", "figures", "--quiet")
    check(b"<svg" in read("figures/lines.svg"), "lines.svg")
    check(b"<svg" in read("figures/map.svg"), "map.svg")
    os.remove("figures/map.svg")
    write("figures.yaml", study.replace("  lines:", "  curves:"))
    end = answer("sweep", "figures.yaml", "-o", "figures")
    check(end["computed"] == 0, "another figure is no other study")
    check(b"<svg" in read("figures/map.svg") and b"<svg" in read("figures/curves.svg"), "anew")
    write("figures.yaml", study.replace("y: velocity", "y: velocitie"))
    said = run("sweep", "figures.yaml", "-o", "figures", code=2, err="did you mean 'velocity'?").stderr
    check("figure 'lines'" in said, said)


def trajectories():
    sweep("motion", """model: block.yaml
axes: [{mass: [1 kg, 2 kg]}]
set: {place: far}
trajectories: yes
""", "--threads", "2")
    for n in range(2):
        run("run", "block.yaml", "-o", "alone", "--set", f"mass={n + 1} kg", "--set", "place=far", "--quiet")
        folder = f"motion/runs/{n:09d}"
        check(sorted(os.listdir(folder)) ==
              [".strut-files", "scene.yaml", "summary.json", "trajectory.h5"], "files of a run")
        # The scene's text names a parameter as it was given; the rest has the same bytes.
        there, alone = (json.loads(read(f"{d}/summary.json")) for d in (folder, "alone"))
        check(there == alone, f"{folder}/summary.json")


def what_has_changed_is_refused():
    run("sweep", "fails.yaml", "-o", "other", code=3)
    table = read("other/table.csv")
    write("block.yaml", BLOCK.replace("damping: 1 N s/m", "damping: 2 N s/m"))
    run("sweep", "fails.yaml", "-o", "other", code=1, err="another study")
    write("block.yaml", "# A comment changes nothing.\n" + BLOCK.replace("name: Block", "name:  Block"))
    run("sweep", "fails.yaml", "-o", "other", "--quiet", code=3)
    check(read("other/table.csv") == table, "a comment: table")
    run("sweep", "fails.yaml", "-o", "other", "--set", "seconds=1", code=1)
    write("block.yaml", BLOCK)


def names_of_columns():
    """A parameter may bear a column's name; no two columns bear the same."""
    names = ("velocity", "run_velocity", "check_velocity", "flips", "x_block", "outcome")
    extra = "".join(f"{name}: 1, " for name in names)
    write("names.yaml", BLOCK.replace("parameters: {", "parameters: {" + extra).replace(
        "stiffness: stiffness,", "stiffness: stiffness*" + "*".join(names) + ","))
    axes = "".join(f"  - {name}: [1]\n" for name in names)
    write("columns.yaml", f"""strut: 1
study: columns
model: names.yaml
axes:
{axes}keep: [velocity, positions, outcome]
check: {{half_step: yes}}
""")
    run("sweep", "columns.yaml", "-o", "columns", "--quiet")
    head = [name.split(" ")[0] for name in read("columns/table.csv").decode().splitlines()[0].split(",")]
    check(len(set(head)) == len(head), f"columns of one name: {head}")
    for name in ("run_run_velocity", "run_check_velocity", "run_flips", "run_x_block", "run_outcome"):
        check(name in head, f"no column {name}: {head}")


def two_at_once():
    """The second is informed of the first, and what the first makes is the table."""
    write("two.yaml", read("crawler.yaml").decode())
    words = [strut, "sweep", "two.yaml", "-o", "two", "--threads", "1", "--quiet"]
    children = [subprocess.Popen(words, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [child.communicate()[1] for child in children]
    codes = sorted(child.returncode for child in children)
    check(codes in ([0, 4], [0, 0]), f"two at once: exit codes {codes}")  # [0, 0]: one after another
    check(codes[1] == 0 or "is writing" in "".join(said), f"two at once: {said}")
    check(read("two/table.csv") == read("one/table.csv"), "two at once: table")


def no_room():
    """A full disk and one that cannot be written: exit code 4, and then the sweep goes on."""
    os.makedirs("disk")

    def mount(*options):
        return subprocess.run(["mount", *options, "disk"], capture_output=True).returncode == 0
    write("room.yaml", """strut: 1
study: room
model: block.yaml
axes: [{mass: {from: 1 kg, to: 2 kg, count: 900}}]
set: {seconds: 1 ms}
keep: [velocity]
""")
    run("sweep", "room.yaml", "-o", "block.yaml", code=4, err="block.yaml")
    run("sweep", "room.yaml", "-o", "room", "--quiet")
    if os.getuid() or not mount("-t", "tmpfs", "-o", "size=80k", "none"):
        print("no disk of its own: a full disk is not tested")
        return
    try:
        run("sweep", "room.yaml", "-o", "disk/x", "--quiet", code=4, err="No space left on device")
        check(not os.path.exists("disk/x/table.csv"), "a table on a full disk")
        mount("-o", "remount,rw,size=1000k")
        done = answer("sweep", "room.yaml", "-o", "disk/x", "--status")
        end = answer("sweep", "room.yaml", "-o", "disk/x")
        check(0 < end["computed"] == done["missing"] < 900, f"after a full disk: {end}, {done}")
        check(read("disk/x/table.csv") == read("room/table.csv"), "after a full disk: table")
        mount("-o", "remount,ro")
        run("sweep", "room.yaml", "-o", "disk/y", code=4)
        run("sweep", "room.yaml", "-o", "disk/x", code=4)
        check(read("disk/x/table.csv") == read("room/table.csv"), "on a disk for reading: table")
    finally:
        subprocess.run(["umount", "disk"], check=True)


def wrong_use():
    run("sweep", "fails.yaml", code=3)
    check(os.path.exists(os.path.join(work, "fails", "table.csv")), "without -o: a folder named after the study")
    run("sweep", "fails.yaml", "-o", "other", "--threads", "0", code=1)
    run("sweep", "nowhere.yaml", "-o", "other", code=4)
    run("sweep", "fails.yaml", "-o", "nothing", "--status", code=4)
    check(not os.path.exists("nothing"), "--status makes no directory")
    write("bad.yaml", "strut: 1\nstudy: x\nmodel: block.yaml\naxes:\n  - masss: [1 kg]\n")
    said = run("sweep", "bad.yaml", "-o", "other", code=2,
               err="bad.yaml:5:5: error: the model has no parameter 'masss'; did you mean 'mass'?").stderr
    check("^~~~~" in said, said)


def memory_is_flat():
    write("many.yaml", """strut: 1
study: many
model: block.yaml
set: {seconds: 1 ms}
axes:
  - mass: {from: 1 kg, to: 2 kg, count: 100}
  - stiffness: {from: 10, to: 20, count: COUNT}
keep: [velocity]
""")
    text = read("many.yaml").decode()
    # The address sanitizer would keep what was released.
    keeps = {**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=0"}
    peak = []
    for n, count in enumerate((5, 300)):
        write("many.yaml", text.replace("COUNT", str(count)))
        child = subprocess.Popen([strut, "sweep", "many.yaml", "-o", f"many{n}", "--quiet"], env=keeps)
        most = 0
        while child.poll() is None:
            try:
                with open(f"/proc/{child.pid}/status") as file:
                    most = max([most] + [int(line.split()[1]) for line in file if line.startswith("VmHWM")])
            except (OSError, ValueError):
                pass
            time.sleep(0.002)
        check(child.returncode == 0, "many points")
        peak.append(most)
    print(f"memory of 500 and 30000 points: {peak[0]} and {peak[1]} kB")
    check(peak[1] < peak[0] + 3000, f"memory grows with the points: {peak} kB")


for test in (points_are_those_of_numpy, warnings_are_counted, rows_are_single_runs,
             threads_change_nothing, killed_and_resumed, interrupted, points_that_fail,
             failed_points_once_more, a_directory_stands_for_itself, checked_again, figures,
             trajectories, killed_while_recording,
             what_has_changed_is_refused, names_of_columns, two_at_once,
             no_room, wrong_use, memory_is_flat):
    began = time.time()
    test()
    print(f"{test.__name__}: {time.time() - began:.1f} s")
finish()

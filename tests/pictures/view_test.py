# SPDX-License-Identifier: GPL-3.0-or-later
"""What `strut view` writes: its data, taken apart again, are those of the run; no name breaks out."""
import base64
import csv
import html.parser
import json
import os
import zlib

import testing
from testing import check, finish, models, run, work, write

CRAWLER = f"{models}/crawler/crawler.yaml"
os.chdir(work)


class Page(html.parser.HTMLParser):
    """Elements, texts of scripts, and everything that would ask somebody else."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.scripts, self.title, self.outside, self.inside = [], [], "", [], None
        self.text = testing.read(path).decode()
        self.feed(self.text)
        self.close()
        data = [text for kind, text in self.scripts if ("id", "strut-data") in kind]
        check(len(data) == 1, f"{path}: {len(data)} elements of data")
        self.raw = data[0]
        self.data = json.loads(self.raw, parse_constant=lambda word: check(False, word))

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.inside = tag
        if tag == "script":
            self.scripts.append((attributes, ""))
        self.outside += [value for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag):
        self.inside = None

    def handle_data(self, data):
        if self.inside == "script":
            kind, text = self.scripts[-1]
            self.scripts[-1] = (kind, text + data)
        elif self.inside == "title":
            self.title += data


def integers(data):
    number, shift = 0, 0
    for byte in data:
        number |= (byte & 127) << shift
        shift += 7
        if not byte & 128:
            yield number >> 1 if not number & 1 else -(number >> 1) - 1
            number, shift = 0, 0


def columns(block, frames):
    """The block's columns of values, each of `frames` numbers, all bytes used."""
    number = list(integers(zlib.decompress(base64.b64decode(block["bytes"], validate=True), -15)))
    check(len(number) == frames * block["columns"], "a block of another length")
    found = []
    for c in range(block["columns"]):
        n = slope = 0
        column = []
        for f, z in enumerate(number[c * frames:(c + 1) * frames]):
            slope = z if f < 2 else slope + z
            n = z if f == 0 else n + slope
            check(abs(n) <= 2 ** 49, "a number too large")
            column.append(n * block["quantum"])
        found.append(column)
    return found


def table(path, keep=lambda name: True):
    """Times and columns of a CSV file."""
    with open(path, encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    return [[float(row[i]) for row in rows] for i, name in enumerate(head) if i == 0 or keep(name)]


def same(block, frames, wanted, what):
    for c, (found, column) in enumerate(zip(columns(block, frames), wanted, strict=True)):
        for f in range(frames):
            if not abs(found[f] - column[f]) <= 0.5000001 * block["quantum"]:
                check(False, f"{what}, column {c}, frame {f}: {found[f]} is not {column[f]}")
                return


def crawler():
    run("run", CRAWLER, "-o", "crawl", "-q")
    said = run("view", "crawl", "-o", "crawl.html")
    page = Page("crawl.html")
    motion = page.data["motion"]
    check(said.stdout == f"crawl.html: 1001 frames, {1e-6 * len(page.text.encode()):.1f} MB\n", said.stdout)
    check(not page.outside, f"asks for {page.outside}")
    check(page.title == "Nine-member multistable crawler", page.title)
    check(any("Dygraph" in text for _, text in page.scripts), "no dygraphs")
    check("Permission is hereby granted" in page.text and "Vanderkam" in page.text, "no licence of dygraphs")
    check("<!--strut:" not in page.text, "a placeholder is left")
    check((motion["frames"], motion["recorded"], motion["every"]) == (1001, 1001, 1), "frames")
    check(motion["status"] == "completed" and motion["track"] is None, "status")
    check(abs(sum(motion["weights"]) - 0.14) < 1e-12, "weights")
    nodes = table("crawl/nodes.csv")
    check(columns(motion["time"], 1001)[0] == nodes[0], "times are not exact")
    same(motion["position"], 1001, nodes[1:], "positions")
    same(motion["force"], 1001, table("crawl/members.csv", lambda n: ".force" in n)[1:], "forces")
    same(motion["contact"], 1001, table("crawl/contacts.csv")[1:], "contacts")
    check(motion["position"]["quantum"] == 5e-8, "quantum of positions")
    check(motion["energy"] is None, "energies that were not recorded")
    velocity = json.loads(testing.read("crawl/summary.json"))["velocity"]
    rows = {row["label"]: row["value"] for row in page.data["summary"]}
    check(rows["run"] == "completed" and
          rows["mean velocity of the centre of mass along x"].startswith(f"{1e3 * velocity:.4g} mm/s"),
          f"summary: {rows}")
    run("view", "crawl", "-o", "again.html", "-q")
    check(testing.read("again.html") == page.text.encode(), "not the same bytes twice")
    parameters = {row["label"]: row["value"] for row in page.data["parameters"]}
    check(parameters == {"frequency": "10 Hz", "amplitude": "0.1 mm", "friction": "0.1", "start": "I",
                         "step": "0.1 ms", "integration method": "rk4",
                         "integration step": "100 us"}, f"parameters: {parameters}")
    check(page.data["equilibria"] is None and not page.data["equilibria_remark"], "equilibria that nobody asked for")
    run("view", "crawl", "--equilibria", "all", "-o", "all.html")
    cards(Page("all.html").data, "crawl/scene.yaml")


def cards(data, scene):
    """The cards are equilibria that strut finds; those that stand come first, the named ones ahead."""
    found = {e["name"]: e for e in testing.answer("equilibria", scene)["equilibria"]}
    listed = data["equilibria"]
    check(len(listed) == 40 and len(listed) + data["equilibria_left_out"] == len(found), "cards")
    check([card["name"] for card in listed[:4]] == ["III", "III-2", "I", "II"],
          f"first: {[card['name'] for card in listed[:4]]}")
    standing = [name for name, e in found.items() if e["outcome"] == "stands"]
    check(set(standing) <= {card["name"] for card in listed}, "some that stand have no card")
    for card in listed:
        other = found[card["name"]]
        where = [x for node in data["nodes"] for x in other["nodes"][node["name"]]]
        check(all(abs(a - b) <= 5.001e-9 * abs(b) for a, b in zip(card["position"], where)), "shape")
        check(card["energy"] == other["energy"] and card["verdict"] == other["verdict"] and
              card["stands"] == (other["outcome"] == "stands"), f"card {card['name']}")
        forces = other["forces"].values()
        check(all(abs(a - b) <= 5.001e-9 * abs(b) for a, b in zip(card["force"], forces)), "forces")
        if card["stands"]: # what presses on the ground carries the whole
            check(abs(sum(card["normal"]) - 0.14 * 9.81) < 1e-5, f"normals of {card['name']}")
    for barrier in data["barriers"]:
        check(0 <= barrier["from"] < 40 and 0 <= barrier["to"] < 40 and barrier["height"] > 0, f"barrier {barrier}")


def everything(name, *changes):
    """The crawler's scene as a file: with everything recorded from the start, every millisecond."""
    scene = testing.read(CRAWLER).decode()
    for old, new in (("output: ", "# "), *changes):
        check(old in scene, f"the crawler has no '{old}'")
        scene = scene.replace(old, new)
    write(name, scene + "\noutput: {every: 1 ms, channels: [position, velocity, length, force, contact, energy]}\n")


def short_run():
    everything("short.yaml", ("periods: 1100", "periods: 20"), ("last: 100", "last: 10"))
    run("run", "short.yaml", "-o", "short", "-q")
    run("view", "short", "-o", "short.html")
    motion = Page("short.html").data["motion"]
    check(len(motion["energy_names"]) == 11 == motion["energy"]["columns"], "energies")
    head = testing.read("short/energy.csv").decode().splitlines()[0]
    places = [head.find(name) for name in motion["energy_names"]]
    check(places == sorted(places) and places[0] > 0, "energies have other names")
    energy = table("short/energy.csv")
    same(motion["energy"], motion["frames"], energy[1:12], "energies")
    check(max(energy[1]) > 100 * motion["energy"]["quantum"], "the kinetic energy is lost")


def paper_run():
    """The whole of the paper's run, every millisecond, with everything recorded."""
    everything("paper.yaml")
    run("run", "paper.yaml", "-o", "paper", "-q")
    run("view", "paper", "-o", "paper.html")
    page = Page("paper.html")
    motion = page.data["motion"]
    check(len(page.text.encode()) < 5e6, f"the paper's run takes {len(page.text.encode())} bytes")
    check(motion["recorded"] == 110001 and motion["frames"] * motion["every"] >= 110001, "frames")
    time = columns(motion["time"], motion["frames"])[0]
    check(len(time) == motion["frames"] and time[0] == 0 and abs(time[-1] - 110) < 1e-9, "times")


HOSTILE = ["</script><script>alert(1)</script>", "<!--<script> -->]]> & \"quotes\" 'more'",
           "שלום <b>עולם</b> \u2028line"]
NAMES = ["שלום", "مرحبا", "наука", "a" * 60, "_-.", "0"]


def hostile():
    """Texts that would like to be markup; the language keeps markup out of the names of things."""
    quoted = [json.dumps(text, ensure_ascii="\u2028" in text) for text in HOSTILE]
    lines = ["strut: 1", f"name: {quoted[0]}", f"description: {quoted[1]}", f"source: {quoted[2]}",
             "nodes:", f"  {NAMES[0]}: {{position: [0, 0], fixed: both}}"]
    lines += [f"  {name}: {{position: [{i + 1}, {i % 2}], mass: 1}}" for i, name in enumerate(NAMES[1:])]
    lines += ["members:"]
    for one, two in zip(NAMES, NAMES[1:]):
        lines.append(f"  {one}: {{kind: bar, nodes: [{one}, {two}], stiffness: 1000}}")
    write("hostile.yaml", "\n".join(lines) + "\n")
    run("view", f"{models}/gallery/x-frame.yaml", "-o", "plain.html")
    run("view", "hostile.yaml", "-o", "hostile.html")
    plain, page = Page("plain.html"), Page("hostile.html")
    check(page.tags == plain.tags, "names add elements")
    check(page.title == HOSTILE[0], f"title {page.title}")
    check([page.data[key] for key in ("name", "description", "source")] == HOSTILE, "texts")
    check([node["name"] for node in page.data["nodes"]] == NAMES, "names of nodes")
    check([m["name"] for m in page.data["members"]] == NAMES[:-1], "names of members")
    check([(m["from"], m["to"]) for m in page.data["members"]] ==
          [(i, i + 1) for i in range(len(NAMES) - 1)], "ends of members")
    check([node["fixed"] for node in page.data["nodes"][:2]] == [[True, True], [False, False]], "supports")
    check(not any(c in page.raw for c in "<>&\u2028\u2029"), "the data are not escaped")
    check(page.data["motion"] is None and page.data["study"] is None, "a model does not move")
    check("alert(1)" in page.data["yaml"], "the scene's text")


def measured():
    """Columns of data named as those of the run, at times of the run."""
    write("film.csv", "t [s],b.x [mm],m.force [N],b.y [s],a.y [m]\n0,1010,,1,2\n0.5,1003,2,1,\n3,1,1,1,1\n")
    write("spring.yaml", "strut: 1\ndata: {film: {file: film.csv}}\nrun: {duration: 1}\nsolver: {step: 1 ms}\n"
          "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}}\n"
          "members: {m: {kind: spring, nodes: [a, b], stiffness: 100, rest_length: 0.99}}\n")
    run("run", "spring.yaml", "-o", "spring", "-q")
    run("view", "spring", "-o", "spring.html")
    motion = Page("spring.html").data["motion"]
    check(motion["position"]["data"] == [[], [[0, 2]], [[0, 1.01], [0.5, 1.003]], []], f"{motion['position']['data']}")
    check(motion["force"]["data"] == [[[0.5, 2]]], f"{motion['force']['data']}")


def diverged():
    """A step too large: frames end where the structure leaves all bounds, and the page says so."""
    everything("wild.yaml")
    run("run", "wild.yaml", "--set", "step=0.5 ms", "--set", "friction=0", "--force", "-o", "wild", "-q", code=3)
    run("view", "wild", "-o", "wild.html")
    data = Page("wild.html").data
    motion = data["motion"]
    check(motion["status"] == "diverged" and 1 <= motion["frames"] < motion["recorded"],
          f"diverged: {motion['status']}, {motion['frames']} of {motion['recorded']}")
    check(motion["position"]["quantum"] == 5e-8, "what diverges takes the motion's digits")
    check(data["summary"][0]["value"].startswith("diverged: "), f"{data['summary'][0]}")


def alone():
    """Nothing at rest, and nothing looked for: the page says why there are no cards."""
    write("falling.yaml", "strut: 1\nnodes: {stone: {position: [0, 1], mass: 1}}\ngravity: [0, -9.81]\n")
    run("view", "falling.yaml", "-o", "falling.html")
    data = Page("falling.html").data
    check(not data["equilibria"] and len(data["equilibria_remark"]) > 10, "no word on equilibria")
    run("view", f"{models}/gallery/x-frame.yaml", "--equilibria", "none", "-o", "none.html")
    data = Page("none.html").data
    check(data["equilibria"] is None and data["equilibria_remark"], "equilibria all the same")


crawler()
short_run()
paper_run()
hostile()
measured()
diverged()
alone()
finish()

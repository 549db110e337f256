# SPDX-License-Identifier: GPL-3.0-or-later
"""Films of `strut run --animate`: what ffprobe and ffmpeg find in them, and what happens without.

usage: film_test.py STRUT
"""
import itertools
import os
import re
import signal
import stat
import subprocess
import time

from testing import check, finish, needs, read, run, stopped, work, write

needs("ffmpeg", "ffprobe")
hopper = os.path.abspath("tests/cli/hopper.yaml")
os.chdir(work)

# A ball that flies 0.6 m in 1 s, on a straight line and at one speed.
BALL = """strut: 1
nodes:
  ball: {position: [0, 0], mass: 1}
initial: {velocities: {ball: [0.6, 0]}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1}
output: {every: 5 ms, channels: [energy]}
"""


def call(code, *words, path=None):
    return run("run", *words, code=code, env={"PATH": path} if path else None)


def probe(path):
    """Codec, width, height, frames, duration [s]."""
    out = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                          "stream=codec_name,width,height,nb_read_frames:format=duration", "-of",
                          "default=noprint_wrappers=1", path], capture_output=True, text=True)
    check(not out.stderr, f"ffprobe {path}: {out.stderr}")
    found = dict(line.split("=") for line in out.stdout.split())
    return (found["codec_name"], int(found["width"]), int(found["height"]),
            int(found["nb_read_frames"]), float(found["duration"]))


def frames(path, width, height):
    """All frames as grey pixels."""
    out = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "gray",
                          "-vsync", "0", "-"], capture_output=True)
    size = width * height
    return [out.stdout[i:i + size] for i in range(0, len(out.stdout), size)]


def middle(picture):
    """The mean column of what is drawn between title and foot."""
    columns = [i % 640 for i, pixel in enumerate(picture[:290 * 640])
               if pixel < 128 and i >= 45 * 640]
    return sum(columns) / len(columns)


def test_formats():
    """Size, length and number of frames; pictures that are not blank and that differ."""
    for name, codec, size, rate, words, count in [
            ("a.mp4", "h264", (1280, 720), 30, ["--speed", "1/2"], 31),
            ("a.webm", "vp9", (1280, 720), 20, ["--fps", "20"], 11),
            ("a.gif", "gif", (640, 360), 25, ["--speed", "0.25"], 51)]:
        said = call(0, hopper, "--animate", name, *words).stdout
        found = probe(name)
        check(found[:4] == (codec, *size, count), f"{name}: {found}")
        check(abs(found[4] - count / rate) < 0.02, f"{name} lasts {found[4]} s")
        check(f"film {name}: {size[0]} x {size[1]}, {count} frames" in said, said[-400:])
        pictures = frames(name, *size)
        check(len(pictures) == count, f"{name}: {len(pictures)} pictures")
        for picture in pictures[::10]:
            dark = sum(1 for pixel in picture if pixel < 128)
            check(0.001 * len(picture) < dark < 0.2 * len(picture), f"{name}: {dark} dark pixels")
        check(len(set(pictures)) == len(pictures), f"{name}: two pictures are the same")


def test_motion():
    """The ball is where its time says, in each picture: the film keeps time and scale."""
    write("ball.yaml", BALL)
    call(0, "ball.yaml", "--quiet", "--animate", "ball.gif")
    pictures = frames("ball.gif", 640, 360)
    check(len(pictures) == 26, f"{len(pictures)} pictures")
    # 0.6 m are drawn as wide as the page of 400 pt less 18 pt on both sides; 1.6 pixels are 1 pt.
    span = 1.6 * (400 - 2 * 18)
    for k, picture in enumerate(pictures):
        wanted = 320 + span * (k / 25 - 0.5)
        check(abs(middle(picture) - wanted) < 1.0, f"picture {k}: ball at {middle(picture)}, not {wanted}")
    # The window goes along with what moves far.
    write("pair.yaml", BALL.replace("initial:", """  mate: {position: [10 mm, 0], mass: 1}
members: {bar: {nodes: [ball, mate], kind: bar, stiffness: 1000}}
initial:""").replace("{ball: [0.6, 0]}", "{ball: [0.6, 0], mate: [0.6, 0]}"))
    call(0, "pair.yaml", "--quiet", "--animate", "pair.gif")
    for k, picture in enumerate(frames("pair.gif", 640, 360)):
        check(abs(middle(picture) - 320) < 1.0, f"picture {k}: pair at {middle(picture)}")


def test_many_frames():
    """A long GIF, whose frames have a palette each: as many frames, as long."""
    call(0, "ball.yaml", "--quiet", "--animate", "many.gif", "--speed", "1/12")
    found = probe("many.gif")
    check(found[3] == 301 and abs(found[4] - 301 / 25) < 0.02, f"many frames: {found}")


def test_same_bytes():
    for name in ("mp4", "gif"):
        for which in ("b", "c"):
            call(0, hopper, "--quiet", "--animate", f"{which}.{name}", "--fps", "10")
        check(read(f"b.{name}") == read(f"c.{name}"), f"two {name} of the same run differ")


def test_names():
    """Names that a shell, an option parser or ffmpeg's protocols would misread."""
    for name in ("-v.gif", "a:b.gif", "$(touch x) '\".gif", "שלום %d.gif"):
        call(0, "ball.yaml", "--quiet", f"--animate={name}")
        check(os.path.exists(name) and probe("./" + name)[0] == "gif", name)
    check(not os.path.exists("x"), "a shell was there")


def test_said():
    """What is too short or recorded too seldom is reported, with what to do."""
    said = call(0, hopper, "--animate", "d.gif").stdout
    check(re.search(r"lasts only 500 ms; --speed 1/10 makes a film of 5 s", said), said[-300:])
    with open(hopper, encoding="utf-8") as file:
        text = file.read().replace("every: 1 ms", "every: 100 ms").replace("seconds: 0.5", "seconds: 3")
    write("seldom.yaml", text)
    said = call(0, "seldom.yaml", "--animate", "d.gif").stdout
    check("recorded every 100 ms but shown every 40 ms" in said, said[-300:])
    check(call(0, hopper, "--animate", "d.gif", "--quiet").stdout == "", "not quiet")
    said = call(0, hopper, "--animate", "d.gif", "--json").stdout
    check(said.lstrip().startswith("{") and said.rstrip().endswith("}"), "no JSON")


def fake(text):
    os.makedirs("fake", exist_ok=True)
    write("fake/ffmpeg", "#!/bin/sh\n" + text)
    os.chmod("fake/ffmpeg", stat.S_IRWXU)
    return os.path.abspath("fake")


def left(*allowed):
    """Names of the work's files that are neither known nor allowed."""
    return [n for n in os.listdir(".") if n not in before and n not in allowed and n not in ("fake", ".strut-files")]


def test_without():
    """No ffmpeg: known before anything is run. One that fails: its words, and no file."""
    for words in (["--animate", "n.mp4"], ["--animate", "n.mp4", "-o", "out"]):
        long = ["--set", "seconds=1e7"]
        begin = time.monotonic()
        said = call(4, hopper, *long, *words, path="/nowhere")
        check(time.monotonic() - begin < 5, "it ran first")
        check("cannot find ffmpeg" in said.stderr and "apt-get install ffmpeg" in said.stderr and
              said.stderr.count("\n") == 1 and not said.stdout, said.stderr)
    check(not left(), f"left: {left()}")
    call(0, hopper, "--animate", "old.mp4")
    old = read("old.mp4")
    for script, word in [("echo 'no codec today' >&2\nexit 1\n", "no codec today\n"),
                         ("exit 1\n", ""),
                         ("cat >/dev/null\necho 'disk full' >&2\nexit 2\n", "disk full\n")]:
        said = call(4, hopper, "--animate", "old.mp4", path=fake(script) + ":" + os.environ["PATH"])
        check(said.stderr == word + "strut: error: ffmpeg could not write 'old.mp4'\n", said.stderr)
        check("velocity" in said.stdout, "the run's own table is missing")
        check(not left("old.mp4"), f"left: {left('old.mp4')}")
        check(read("old.mp4") == old, "the old file is gone")


def test_usage():
    for code, words, message in [
            (1, ["--animate", "f.avi"], ".mp4, .webm or .gif"),
            (1, ["--animate", ".mp4"], ".mp4, .webm or .gif"),
            (1, ["--speed", "1"], "--animate"),
            (1, ["--fps", "2"], "--animate"),
            (1, ["--animate", "f.mp4", "--speed", "0"], "--speed"),
            (1, ["--animate", "f.mp4", "--speed", "1/0"], "--speed"),
            (1, ["--animate", "f.mp4", "--speed", "fast"], "--speed"),
            (1, ["--animate", "f.mp4", "--fps", "1000"], "--fps"),
            (1, ["--animate", "f.mp4", "--speed", "1e-6"], "--speed"),
            (1, ["--animate", "f.mp4", "--set", "seconds=1e7"], "1e+07 s"), # not run first
            (4, ["--animate", "nowhere/f.mp4"], "nowhere/f.mp4")]:
        said = call(code, hopper, *words)
        check(message in said.stderr, f"{words}: {said.stderr}")
    check(not left("old.mp4"), f"left: {left('old.mp4')}")


def test_interrupt():
    """Ctrl-C while the film is made: no film, nothing left, and no ffmpeg behind."""
    looks = itertools.count()  # 0.3 s of them
    done = stopped("run", hopper, "--animate", "i.mp4", "--speed", "0.001", by=signal.SIGINT, after=lambda: (
        any(name.startswith("i.mp4.") for name in os.listdir(".")) and next(looks) > 150))
    check(done.returncode == 130, f"exit code {done.returncode}: {done.stderr}")
    check("interrupted" in done.stderr and "velocity" in done.stdout, done.stderr)
    check(not left("old.mp4"), f"left: {left('old.mp4')}")


for test in (test_formats, test_motion, test_many_frames, test_same_bytes, test_names, test_said):
    test()
before = set(os.listdir("."))
for test in (test_without, test_usage, test_interrupt):
    test()
finish()

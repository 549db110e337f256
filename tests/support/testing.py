# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Python tests share: the program, a folder to work in, and findings, which are printed as they come and
counted. Tests are called as TEST.py STRUT ... in the repository's root, with this folder in PYTHONPATH."""
import atexit
import csv
import importlib.util
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

strut = os.path.realpath(sys.argv[1])
models = os.path.realpath("models")
work = tempfile.mkdtemp()
atexit.register(shutil.rmtree, work, ignore_errors=True)
_found = 0


def needs(*names):
    """Skips the test where one of these is not installed, a program or a module of Python."""
    missing = [name for name in names if not shutil.which(name) and not importlib.util.find_spec(name)]
    if missing:
        print("skipped: there is no", *missing)
        sys.exit(77)


def fail(text):
    global _found
    _found += 1
    print("FAILED:", text)


def check(good, text):
    if not good:
        fail(text)


def failed():
    return _found > 0


def near(found, wanted, what, relative=1e-9):
    check(found != "" and math.isclose(float(found), wanted, rel_tol=relative), f"{what}: {found}, expected {wanted}")


def path(*names):
    """Of a file in the folder of the test."""
    return os.path.join(work, *names)


def write(name, text):
    with open(path(name), "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())


def read(*names):
    with open(path(*names), "rb") as file:
        return file.read()


def rows(*names):
    """Of a CSV file in the folder of the test, each as {column: text}."""
    with open(path(*names), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(*names):
    """The same as numbers, under the columns' names without their units."""
    return [{key.rsplit(" [", 1)[0]: float(value) for key, value in row.items()} for row in rows(*names)]


def run(*words, code=0, err="", timeout=120, stdin="", env=None):
    """Runs strut in the folder of the test, with `env` beside its own environment; what it printed. Its exit code is to
    be `code`, or one of several, and its messages are to have `err`."""
    done = subprocess.run([strut, *words], capture_output=True, text=True, cwd=work, timeout=timeout, check=False,
                          input=stdin, env={**os.environ, **(env or {})})
    check(done.returncode in (code if isinstance(code, tuple) else (code,)) and err in done.stderr,
          f"strut {' '.join(words)}: exit code {done.returncode}, expected {code}: {done.stderr}")
    return done


def stopped(*words, after, by=signal.SIGKILL):
    """As run, but ended by a signal after so many seconds, or as soon as `after()` holds."""
    child = subprocess.Popen([strut, *words], cwd=work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    begun = time.monotonic()
    while child.poll() is None and time.monotonic() - begun < 60:
        if after() if callable(after) else time.monotonic() - begun >= after:
            break
        time.sleep(0.002)
    child.send_signal(by)
    out, err = child.communicate(timeout=120)
    return subprocess.CompletedProcess(words, child.returncode, out, err)


def answer(*words, **how):
    """What strut prints as JSON."""
    return json.loads(run(*words, "--json", **how).stdout)


def exported(model):
    """What strut export writes, as a mapping."""
    import yaml
    return yaml.safe_load(run("export", model).stdout)


def formats(*words, code=0, timeout=60):
    """Runs `python3 -m strut.formats` of the same build in the folder of the test."""
    environment = {**os.environ, "PYTHONPATH": path(os.path.dirname(strut), "python"), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, "-X", "dev", "-W", "error", "-m", "strut.formats", *words], cwd=work,
                          env=environment, capture_output=True, text=True, timeout=timeout, check=False)
    check(done.returncode == code and "Traceback" not in done.stderr,
          f"formats {' '.join(words)}: exit code {done.returncode}, expected {code}: {done.stderr}")
    return done


def copy_models():
    """A study names what is below its folder: models are then in `copied`."""
    shutil.copytree(models, path("copied"))


def sweep(name, text, *words, code=0):
    """The table of a study."""
    write(f"{name}-study.yaml", "strut: 1\nstudy: s\n" + text)
    run("sweep", f"{name}-study.yaml", "-o", name, "--quiet", *words, code=code)
    return rows(name, "table.csv")


def same_table(study, folder, threads=(1, 3), shards=(0, 0, 0), code=0):
    """The study has the table of the folder by any number of threads, and by shards, which end with
    these exit codes and are merged."""
    wanted = read(folder, "table.csv")
    for count in threads:
        run("sweep", study, "-o", f"{folder}-by-{count}", "--quiet", "--threads", str(count), code=code)
        check(read(f"{folder}-by-{count}", "table.csv") == wanted, f"{study}: another table by {count} threads")
    for k, end in reversed(list(enumerate(shards))):
        run("sweep", study, "-o", f"{folder}-parts", "--quiet", "--shard", f"{k}/{len(shards)}", code=end)
    if shards:
        run("sweep", "--merge", f"{folder}-parts", code=code)
        check(read(f"{folder}-parts", "table.csv") == wanted, f"{study}: another table by shards")


def files_in(folder):
    """Names of all files in a folder but strut's list of those it wrote."""
    return [name for name in os.listdir(folder) if name != ".strut-files"]


def finish(tested=True):
    """The end of a test: 1 where something failed, 77 (skipped) where nothing could be tested."""
    print(f"{_found} failures")
    sys.exit(1 if _found else 0 if tested else 77)

# SPDX-License-Identifier: GPL-3.0-or-later
"""How many planted bugs does the suite notice? Not part of the suite: it takes an hour.

    python3 tests/bench/mutants.py                    all bugs of mutants_table.py, as a table
    python3 tests/bench/mutants.py NAME...            these only
    python3 tests/bench/mutants.py --whole            survivors also meet the whole suite
    python3 tests/bench/mutants.py --check            only: is each text there exactly once?

A bug (a "mutant" in the literature) is a text of one source file and what stands there instead. The
tool copies the tree into a scratch folder, checks that the named tests pass there, and then for one
bug after the other: plants it, builds and runs the tests named for it until one fails, and takes it
out again. A bug that no test notices survives. Verdicts are kept in the scratch folder's verdicts.json,
so that an interrupted run goes on; a bug that was changed, or is named, is tried again.
"""
import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
from mutants_table import MUTANTS  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 240  # for one test: a bug may make a program run for ever


def run(command, cwd, environment=None):
    done = subprocess.run(command, cwd=cwd, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace")
    return done.returncode, done.stdout


def digest(mutant):
    text = "\0".join((mutant.file, mutant.text, mutant.instead))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def find_trouble(mutant, tree):
    """What is wrong with a line of the table, or None."""
    path = tree / mutant.file
    if not path.is_file():
        return f"there is no file {mutant.file}"
    count = path.read_text().count(mutant.text)
    if count != 1:
        return f"its text is in {mutant.file} {count} times, expected once"
    if mutant.text == mutant.instead:
        return "nothing is changed"
    return None


def copy_tree(tree):
    """Brings the copy up to date; what did not change keeps its time, so that little is built anew."""
    code, listing = run(["git", "ls-files", "-co", "--exclude-standard"], ROOT)
    if code:
        sys.exit("mutants.py: this is no Git tree")
    names = {name for name in listing.splitlines() if (ROOT / name).is_file()}
    for name in names:
        source, copy = ROOT / name, tree / name
        content = source.read_bytes()
        if copy.is_file() and copy.read_bytes() == content:
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(content)
        copy.chmod(source.stat().st_mode & 0o777)
    for copy in sorted(tree.rglob("*")):
        inside = copy.relative_to(tree)
        if copy.is_file() and inside.parts[0] != "build" and inside.as_posix() not in names:
            copy.unlink()


class Suite:
    """The copy's build folder."""

    def __init__(self, tree, jobs):
        self.tree, self.jobs = tree, str(jobs)
        self.folder = tree / "build" / "tests"
        self.environment = dict(os.environ, CCACHE_BASEDIR=str(tree), CCACHE_NOHASHDIR="1")

    def configure(self):
        command = ["cmake", "--preset", "tests"]
        if shutil.which("ccache"):  # a bug that is taken out again costs no compiler
            command += [f"-DCMAKE_{x}_COMPILER_LAUNCHER=ccache" for x in ("C", "CXX")]
        code, output = run(command, self.tree, self.environment)
        if code:
            sys.exit(f"mutants.py: cannot configure the copy\n{output}")
        # CTest itself does not tell the commands of programs that are not built yet.
        self.programs = {}
        for listing in self.folder.rglob("CTestTestfile.cmake"):
            for line in listing.read_text().splitlines():
                test = re.match(r"add_test\(\[(=*)\[(.*?)\]\1\] (.*)\)$", line)
                if test:
                    self.programs[test[2]] = self.programs_in(re.findall(r'"(.*?)"', test[3]))

    def programs_in(self, command):
        """The targets that a test's command line names."""
        paths = [Path(word) for word in command if word.startswith(str(self.folder))]
        folders = {self.folder, self.folder / "golden"}
        return {path.name for path in paths if path not in folders}

    def names(self, wanted):
        """The tests that one pattern of the table means; there must be some."""
        found = [name for name in self.programs if re.fullmatch(wanted, name)]
        return found or sys.exit(f"mutants.py: there is no test {wanted}")

    def build(self, names=None):
        """None: everything. Returns what the build said where it failed, else None."""
        command = ["cmake", "--build", "--preset", "tests", "-j", self.jobs]
        if names is not None:
            targets = sorted(set().union(*(self.programs[name] for name in names)))
            command += ["--target", *targets]
        code, output = run(command, self.tree, self.environment)
        return output if code else None

    def failures(self, wanted=None, stop=True, without=None):
        """Names of the tests that fail."""
        command = ["ctest", "--test-dir", str(self.folder), "-j", self.jobs, "--timeout", str(SECONDS)]
        command += ["-R", f"^({wanted})$"] if wanted else []
        command += ["-E", f"^({without})$"] if without else []
        command += ["--stop-on-failure"] if stop else []
        code, output = run(command, self.tree, self.environment)
        if "(Not Run)" in output:
            sys.exit(f"mutants.py: not all tests could be run\n{output}")
        failed = re.findall(r"^\s*\d+ - (\S+) \((?!Skipped)", output, re.M)
        return failed if code else []


def try_mutant(suite, mutant, whole):
    """The verdict on one bug: the tests that notice it, none where it survives."""
    path = suite.tree / mutant.file
    original = path.read_text()
    path.write_text(original.replace(mutant.text, mutant.instead))
    trouble, failed = None, []
    try:
        for wanted in mutant.tests.split("|"):
            trouble = suite.build(suite.names(wanted))
            failed = suite.failures(wanted) if trouble is None else []
            if trouble is not None or failed:
                break
        if trouble is None and not failed and whole:
            trouble = suite.build()
            failed = suite.failures(without=mutant.tests) if trouble is None else []
    finally:
        path.write_text(original)
    if trouble is not None:
        return {"verdict": "does not build", "by": trouble.strip().splitlines()[-1:]}
    return {"verdict": "caught" if failed else "survived", "by": failed[:1]}


def check_baseline(suite, mutants):
    """Without a bug the named tests pass, or else a verdict means nothing."""
    wanted = "|".join(sorted({mutant.tests for mutant in mutants}))
    trouble = suite.build(suite.names(wanted))
    if trouble is not None:
        sys.exit(f"mutants.py: the copy does not build\n{trouble}")
    failed = suite.failures(wanted, stop=False)
    if failed:
        sys.exit(f"mutants.py: without any bug these tests fail: {' '.join(failed)}")


def print_table(mutants, verdicts):
    print("| bug | file | what it breaks | noticed by |\n|---|---|---|---|")
    for mutant in mutants:
        verdict = verdicts.get(mutant.name, {"verdict": "not tried", "by": []})
        by = " ".join(verdict["by"]) if verdict["verdict"] == "caught" else verdict["verdict"]
        print(f"| {mutant.name} | `{mutant.file}` | {mutant.breaks} | {by} |")
    tried = [verdicts[m.name]["verdict"] for m in mutants if m.name in verdicts]
    caught = tried.count("caught")
    if tried:
        print(f"\n{caught} of {len(tried)} noticed, {100 * caught / len(tried):.0f} %")
    return caught == len(mutants)


def main():
    parser = argparse.ArgumentParser(description="How many planted bugs does the suite notice?")
    parser.add_argument("names", nargs="*", help="bugs to try again, instead of all untried ones")
    parser.add_argument("--scratch", type=Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--whole", action="store_true", help="survivors meet the whole suite")
    parser.add_argument("--check", action="store_true", help="only look for the texts")
    parser.add_argument("--unchecked", action="store_true", help="leave out the run without bugs")
    options = parser.parse_args()
    unknown = set(options.names) - {m.name for m in MUTANTS}
    if unknown:
        sys.exit(f"mutants.py: no such bug: {' '.join(sorted(unknown))}")
    troubles = [(m.name, find_trouble(m, ROOT)) for m in MUTANTS]
    for name, trouble in troubles:
        if trouble:
            print(f"{name}: {trouble}")
    if options.check or any(trouble for _, trouble in troubles):
        sys.exit(any(trouble for _, trouble in troubles))

    tree, record = options.scratch / "tree", options.scratch / "verdicts.json"
    tree.mkdir(parents=True, exist_ok=True)
    verdicts = json.loads(record.read_text()) if record.is_file() else {}
    chosen = [m for m in MUTANTS if not options.names or m.name in options.names]
    untried = [m for m in chosen if options.names or
               verdicts.get(m.name, {}).get("digest") != digest(m) or
               (options.whole and verdicts[m.name]["verdict"] == "survived")]
    copy_tree(tree)
    suite = Suite(tree, options.jobs)
    suite.configure()
    if untried and not options.unchecked:
        check_baseline(suite, untried)
    for mutant in untried:
        began = time.monotonic()
        verdict = try_mutant(suite, mutant, options.whole)
        verdicts[mutant.name] = dict(verdict, digest=digest(mutant))
        record.write_text(json.dumps(verdicts, indent=1, sort_keys=True))
        print(f"{mutant.name}: {verdict['verdict']} {' '.join(verdict['by'])} "
              f"({time.monotonic() - began:.0f} s)", file=sys.stderr, flush=True)
    sys.exit(not print_table(chosen, verdicts))


if __name__ == "__main__":
    main()

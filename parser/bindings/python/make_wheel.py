# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the wheel: the package of a build tree with every shared library that it needs inside.

    python3 make_wheel.py SOURCE BUILD VERSION LIBRARY

SOURCE is the repository, BUILD the build tree, which gets strut-VERSION-*.whl, LIBRARY libstrut.so.0. Needs
Debian's python3-build, python3-setuptools, python3-wheel, patchelf and binutils; nothing is downloaded.

Copied libraries have other names (a hash of their bytes), so that a process may have Debian's beside them. Left
outside are the libraries that every Linux has, those of glibc and gcc.
"""

from __future__ import annotations

import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

OUTSIDE = re.compile(r"ld-linux|lib(c|m|dl|rt|pthread|resolv|util|gcc_s)\.so|libstdc\+\+\.so")
PYTHON = "cp311"  #: the oldest Python
EPOCH = "315532800"  #: 1980, the earliest date that a zip file can have: the same bytes from a clone and from an archive
FONTS = "/usr/share/fonts/truetype/dejavu"
FONTS_CONF = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig>
  <dir prefix="relative">.</dir>
  <cachedir prefix="xdg">fontconfig</cachedir>
</fontconfig>
"""


def run(*words: object) -> str:
    """What a program prints."""
    return subprocess.run(list(map(str, words)), check=True, capture_output=True, text=True).stdout


def libraries(file: pathlib.Path) -> list[pathlib.Path]:
    """The libraries that a file needs, directly or not, and that are not on every Linux."""
    found = re.findall(r"^\t(\S+) => (\S+) \(", run("ldd", file), re.MULTILINE)
    return [pathlib.Path(path) for name, path in found if not OUTSIDE.match(name)]


def copy_libraries(module: pathlib.Path, library: pathlib.Path, to: pathlib.Path) -> list[pathlib.Path]:
    """Copies all that the library needs, under new names, for its copy `module`; returns where they came from."""
    to.mkdir()
    there = libraries(library)
    names = {}
    for path in there:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]
        names[path.name] = path.name.replace(".so", f"-{digest}.so", 1)
        copy = to / names[path.name]
        shutil.copyfile(path, copy)
    renamed = [word for name, new in names.items() for word in ("--replace-needed", name, new)]
    run("strip", "--strip-unneeded", module)
    for name in names.values():
        (to / name).chmod(0o755)
        run("patchelf", "--set-soname", name, to / name)
    # One change at a time: patchelf 0.14 mixes up the texts of several.
    for file, where in [(module, "$ORIGIN/libs"), *((to / name, "$ORIGIN") for name in names.values())]:
        run("patchelf", "--set-rpath", where, file)
        run("patchelf", *renamed, file)
    return there


def owners(paths: list[pathlib.Path]) -> set[str]:
    """The Debian packages of files, which may know these below / or below /usr."""
    names = {str(name) for path in paths for name in (path, path.resolve())}
    names |= {name.removeprefix("/usr") for name in names}
    asked = subprocess.run(["dpkg", "-S", *names], capture_output=True, text=True, check=False)
    found = dict(reversed(line.split(": ", 1)) for line in asked.stdout.splitlines())
    for path in paths:
        if not {str(path), str(path.resolve()), str(path.resolve()).removeprefix("/usr")} & found.keys():
            sys.exit(f"{path} is of no Debian package: its licence is not known")
    return {owner.split(":")[0] for owner in found.values()}


def copy_licences(paths: list[pathlib.Path], to: pathlib.Path) -> None:
    """The licence of each package that a file is of, and the texts that it refers to."""
    to.mkdir()
    for owner in owners(paths):
        text = pathlib.Path(f"/usr/share/doc/{owner}/copyright").read_text("utf-8")
        (to / f"{owner}.copyright").write_text(text, "utf-8")
        for licence in re.findall(r"/usr/share/common-licenses/([\w.+-]*[\w+])", text):
            if os.path.exists(f"/usr/share/common-licenses/{licence}"):  # some name what is not there
                shutil.copyfile(f"/usr/share/common-licenses/{licence}", to / licence)


def platform(files: list[pathlib.Path]) -> str:
    """manylinux with the oldest glibc that has all symbols of the files."""
    needed = re.findall(r"\bGLIBC_2\.(\d+)", run("objdump", "-p", *files))
    return f"manylinux_2_{max(map(int, needed))}_{os.uname().machine}"


def fill(stage: pathlib.Path, source: pathlib.Path, build: pathlib.Path, library: pathlib.Path) -> None:
    """Puts into the folder all that the wheel holds."""
    shutil.rmtree(stage, ignore_errors=True)
    package = stage / "strut"
    shutil.copytree(build / "python/strut", package, ignore=shutil.ignore_patterns("__pycache__"))
    module = package / library.name
    copied = copy_libraries(module, library, package / "libs")
    fonts = [pathlib.Path(FONTS, f"DejaVuSans{kind}.ttf") for kind in ("", "-Bold")]
    (package / "fonts").mkdir()
    for font in fonts:
        shutil.copy(font, package / "fonts")
    (package / "fonts/fonts.conf").write_text(FONTS_CONF)
    copy_licences([*copied, *fonts], stage / "licenses")
    for name in ("pyproject.toml", "setup.py"):
        shutil.copy(source / "parser/bindings/python" / name, stage)
    shutil.copy(source / "LICENSE", stage)
    shutil.copy(source / "docs/python.md", stage / "README.md")
    tag = platform([module, *(package / "libs").iterdir()])
    (stage / "setup.cfg").write_text(f"[bdist_wheel]\npy_limited_api = {PYTHON}\nplat_name = {tag}\n")


def main(source: str, build: str, version: str, library: str) -> None:
    stage, output = pathlib.Path(build, "wheel"), pathlib.Path(build)
    fill(stage, pathlib.Path(source), output, pathlib.Path(library))
    (stage / "VERSION").write_text(version)
    for old in output.glob("strut-*.whl"):
        old.unlink()
    os.environ.setdefault("SOURCE_DATE_EPOCH", EPOCH)
    run(sys.executable, "-P", "-m", "build", "--wheel", "--no-isolation", "--outdir", output, stage)


if __name__ == "__main__":
    main(*sys.argv[1:])

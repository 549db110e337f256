# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that come with the package."""

from __future__ import annotations

import os
import pathlib

_HERE = pathlib.Path(__file__).parent

#: the folder of the models that come with strut: in the package, or where the program has them
models = next(
    (
        folder
        for folder in (_HERE / "models", *(above / "share/strut/models" for above in _HERE.parents))
        if folder.is_dir()
    ),
    _HERE / "models",
)


def live_script() -> str:
    """The text of strut-live.js: the engine for browsers, in the package or where the program has it."""
    given = os.environ.get("STRUT_LIVE_SCRIPT")
    places = (_HERE / "strut-live.js", *(above / "share/strut/strut-live.js" for above in _HERE.parents))
    found = next((place for place in places if place.is_file()), None)
    if given:
        found = pathlib.Path(given)
    if found is None:
        raise FileNotFoundError(
            "live=True needs strut-live.js, which this installation does not have: build it with "
            "'cmake --preset web && cmake --build --preset web' and set the environment variable "
            "STRUT_LIVE_SCRIPT to build/web/strut-live.js"
        )
    return found.read_text("utf-8")


# A wheel brings fonts of its own for figures, for machines that have none.
if (_HERE / "fonts").is_dir() and not os.path.exists("/etc/fonts/fonts.conf"):
    os.environ.setdefault("FONTCONFIG_FILE", os.fspath(_HERE / "fonts/fonts.conf"))

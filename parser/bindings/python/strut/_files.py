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

# A wheel brings fonts of its own for figures, for machines that have none.
if (_HERE / "fonts").is_dir() and not os.path.exists("/etc/fonts/fonts.conf"):
    os.environ.setdefault("FONTCONFIG_FILE", os.fspath(_HERE / "fonts/fonts.conf"))

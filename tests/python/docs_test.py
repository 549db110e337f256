# SPDX-License-Identifier: GPL-3.0-or-later
"""Every Python block of README.md and docs/python.md runs, in order, in a folder that holds models/. A text block
directly behind a Python block is what it prints."""

import contextlib
import io
import os
import re
import shutil
import tempfile

from support import ROOT, skip_without

skip_without("numpy", "pandas")

count = 0
with tempfile.TemporaryDirectory() as folder:
    shutil.copytree(ROOT / "models", os.path.join(folder, "models"))
    os.chdir(folder)
    for page in ("README.md", "docs/python.md"):
        text = (ROOT / page).read_text()
        names: dict = {}
        for block in re.finditer(r"^```python\n(.*?)^```$(?:\n\n```text\n(.*?)^```$)?", text, re.MULTILINE | re.DOTALL):
            line = text[: block.start()].count("\n") + 2
            code = "\n" * (line - 1) + block[1]  # so that tracebacks name the document's lines
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(code, page, "exec"), names)
            if block[2] is not None:
                assert printed.getvalue() == block[2], (page, line, printed.getvalue())
            count += 1
    os.chdir("/")
assert count >= 6, count
print(count, "blocks")

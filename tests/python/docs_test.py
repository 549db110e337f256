# SPDX-License-Identifier: GPL-3.0-or-later
"""Every Python block of docs/python.md runs, in order, in a folder that holds models/."""

import os
import re
import tempfile

from support import ROOT, skip_without

skip_without("numpy", "pandas")

text = (ROOT / "docs/python.md").read_text()
names: dict = {}
count = 0
with tempfile.TemporaryDirectory() as folder:
    os.symlink(ROOT / "models", os.path.join(folder, "models"))
    os.chdir(folder)
    for block in re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        line = text[: block.start()].count("\n") + 2
        code = "\n" * (line - 1) + block[1]  # so that tracebacks name the document's lines
        exec(compile(code, "docs/python.md", "exec"), names)
        count += 1
    os.chdir("/")
assert count >= 5, count
print(count, "blocks")

# SPDX-License-Identifier: GPL-3.0-or-later
"""Furo as Debian packages it lacks some of what the theme is known for: its style sheet loads normalize.css from
a web server's root, knows no dark theme by the reader's preference, and its script is a module, which browsers
do not load from files. This puts these right, with Debian 12's furo and with Debian 13's."""
import pathlib
import re

import furo

STYLES = pathlib.Path(furo.__file__).parent / "theme" / "furo" / "static" / "styles" / "furo.css"
NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")
IMPORT = re.compile(r"@import url\([^)]*normalize\.css\);")


def dark_variables():
    """The colours of furo's dark theme, for html_theme_options, by which both ways to choose it get them."""
    block = re.search(r'body\[data-theme="?dark"?\]\s*\{(.*?)\}', STYLES.read_text(encoding="utf-8"), re.S)
    return dict(re.findall(r"--([\w-]+):\s*([^;}]+)", block[1])) if block else {}


def replace_script(app, pagename, templatename, context, doctree):
    """Pages load site.js instead of furo.js."""
    context["script_files"] = [script for script in context["script_files"]
                               if "scripts/furo.js" not in str(getattr(script, "filename", script))]


def include_normalize(app, exception):
    if exception:
        return
    styles = pathlib.Path(app.outdir) / "_static" / "styles" / "furo.css"
    text = styles.read_text(encoding="utf-8")
    if IMPORT.search(text):
        normalize = NORMALIZE.read_text(encoding="utf-8")
        styles.write_text(IMPORT.sub(lambda match: normalize, text, 1), encoding="utf-8")


def setup(app):
    app.connect("html-page-context", replace_script, priority=900)
    app.connect("build-finished", include_normalize)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

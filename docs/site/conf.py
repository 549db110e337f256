# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the documentation site: Sphinx reads the Markdown pages of docs/ as they are.

    cmake --build --preset release --target site
"""
import pathlib
import re
import sys

here = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True  # this folder is not for what is built
sys.path.insert(0, str(here))
from strut_theme import dark_variables  # noqa: E402

project = "strut"
author = "the strut developers"
copyright = "the strut developers, GPL version 3 or later"
version = re.search(r"project\(strut VERSION ([0-9.]+)", (here.parents[1] / "CMakeLists.txt").read_text())[1]

extensions = ["myst_parser", "strut_navigation", "strut_sources", "strut_layout", "strut_paper", "strut_theme",
              "strut_cheat_sheet", "strut_try"]
exclude_patterns = ["site"]
# Pages are plain Markdown, as GitHub shows it: nothing of MyST's own syntax, no quotes or dashes replaced.
myst_heading_anchors = 6
myst_disable_syntax = ["myst_role", "myst_target", "myst_line_comment", "myst_block_break"]
smartquotes = False
highlight_language = "none"

html_theme = "furo"
html_title = "strut"
html_static_path = ["site.css", "site.js"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_sourcelink = False
html_use_index = False
html_theme_options = {"navigation_with_keys": True, "dark_css_variables": dark_variables()}
pygments_style = "strut_layout.LightStyle"
pygments_dark_style = "github-dark"

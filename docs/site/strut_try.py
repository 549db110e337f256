# SPDX-License-Identifier: GPL-3.0-or-later
"""Complete scenes of the pages get a link "Try it", which opens them in the playground.

These are blocks of YAML, and here-documents of shell commands that write a scene, if `strut check` accepts them.
Needs the settings strut_playground, the file playground.html that the preset `web` builds, which is copied to the
site, and strut_program, the program. Without them there are no links. site.js opens the playground beside the text.
"""
import base64
import json
import pathlib
import re
import shutil
import subprocess
import tempfile
import zlib
from html import escape

from docutils import nodes
from sphinx.errors import ConfigError

PLAYGROUND = "try.html"  # on the site, beside the page about it
DOCUMENT = re.compile(r"^cat\s*>\s*(?P<name>\S+\.yaml)\s*<<\s*'?(?P<end>\w+)'?\n(?P<text>(?:.*\n)*?)(?P=end)$", re.M)


def packed(scene):
    """An object as the playground's links hold it: JSON, deflated (raw, RFC 1951), in base64url without padding."""
    squeeze = zlib.compressobj(9, zlib.DEFLATED, -15)
    data = squeeze.compress(json.dumps(scene).encode()) + squeeze.flush()
    return base64.urlsafe_b64encode(data).decode().rstrip("=")


def scenes(block):
    """What may be a scene in a block: (file's name, text) each."""
    text = block.astext() + "\n"
    if block.get("language") == "yaml":
        return [("scene.yaml", text)]
    return [(match["name"], match["text"]) for match in DOCUMENT.finditer(text)]


def is_complete(program, text):
    """A scene in itself, which strut accepts without other files. Studies are none."""
    if not re.search(r"^strut: 1\b", text, re.M) or re.search(r"^study:", text, re.M):
        return False
    with tempfile.TemporaryDirectory() as empty:
        return subprocess.run([program, "check", "-q", "-"], input=text.encode(), cwd=empty, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, check=False).returncode == 0


def add_links(app, doctree):
    if not app.config.strut_playground or app.builder.format != "html":
        return
    # From the page to the top of the site; the name is that of a page in the builder's eyes.
    there = app.builder.get_relative_uri(app.env.docname, PLAYGROUND[:-len(".html")])
    for block in list(doctree.findall(nodes.literal_block)):
        links = []
        for name, text in scenes(block):
            if is_complete(app.config.strut_program, text):
                address = f"{there}#s={packed({'text': text, 'name': name, 'settings': {}})}"
                links.append(f'<a class="try" href="{escape(address)}">Try {escape(name)}</a>')
        if links:
            html = f'<p class="try">{" ".join(links)}</p>'
            block.parent.insert(block.parent.index(block) + 1, nodes.raw("", html, format="html"))


def check_settings(app):
    if app.config.strut_playground and not shutil.which(app.config.strut_program):
        raise ConfigError(f"strut_program: there is no program {app.config.strut_program!r}")


def copy_playground(app, exception):
    if not exception and app.config.strut_playground and app.builder.format == "html":
        shutil.copyfile(app.config.strut_playground, pathlib.Path(app.outdir) / PLAYGROUND)


def setup(app):
    app.add_config_value("strut_playground", "", "env")
    app.add_config_value("strut_program", "strut", "env")
    app.connect("builder-inited", check_settings)
    app.connect("doctree-read", add_links)
    app.connect("build-finished", copy_playground)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

# SPDX-License-Identifier: GPL-3.0-or-later
"""How pages look beyond the style sheet.

- Images of a paragraph of their own become figures; their text is the caption if it has several words.
- Tables of keys get a class, by which narrow screens show each row as a paragraph, and so do wide tables.
- A model in a here-document of a shell command is highlighted as YAML.
"""
import re

from docutils import nodes
from pygments.lexers.data import YamlLexer
from pygments.lexers.shell import BashLexer
from pygments.styles.tango import TangoStyle

WIDE = 7  # columns of a table that gets smaller text


def only_images(paragraph):
    return any(isinstance(child, nodes.image) for child in paragraph) and all(
        isinstance(child, nodes.image) or not child.astext().strip() for child in paragraph)


def make_figures(app, doctree):
    for paragraph in list(doctree.findall(nodes.paragraph)):
        if not only_images(paragraph):
            continue
        figures = []
        for image in paragraph.findall(nodes.image):
            text = " ".join(image.get("alt", "").split())
            figure = nodes.figure("", image.deepcopy())
            if " " in text:
                figure += nodes.caption(text, text)
                doctree.set_id(figure)
            figures.append(figure)
        row = nodes.container("", *figures, classes=["figures"])
        paragraph.replace_self(row)


def mark_tables(app, doctree):
    for table in doctree.findall(nodes.table):
        head = [entry.astext() for entry in next(table.findall(nodes.row)).children]
        if len(head) > 3 and head[0] == "key" and head[-1] == "meaning":
            table["classes"].append("keys")
            for entry in table.findall(nodes.entry):
                if not entry.astext():
                    entry["classes"].append("empty")
        if len(head) >= WIDE:
            table["classes"].append("wide")


# Bright colours of Pygments' style "tango", darkened for a contrast of 4.5.
DARKER = {"#4e9a06": "#38700a", "#ce5c00": "#a84b00", "#c4a000": "#7a6400", "#00A000": "#007000"}


class LightStyle(TangoStyle):
    styles = {token: re.sub("#[0-9A-Fa-f]{6}", lambda color: DARKER.get(color[0], color[0]), style)
              for token, style in TangoStyle.styles.items()}


class ShellLexer(BashLexer):
    name = "Shell with models"
    aliases = ["sh"]
    document = re.compile(r"^(?P<command>.*>\s*\S+\.yaml\b.*<<\s*'?(?P<end>\w+)'?.*\n)(?P<text>(?:.*\n)*?)(?P=end)$", re.M)

    def get_tokens_unprocessed(self, text):
        start = 0
        pieces = []
        for match in self.document.finditer(text):
            pieces += [(start, match.start("text"), BashLexer), (match.start("text"), match.end("text"), YamlLexer)]
            start = match.end("text")
        pieces.append((start, len(text), BashLexer))
        for begin, end, lexer in pieces:
            piece = text[begin:end]
            tokens = (lexer.get_tokens_unprocessed(self, piece) if lexer is BashLexer
                      else lexer().get_tokens_unprocessed(piece))
            for index, token, value in tokens:
                yield begin + index, token, value


def setup(app):
    app.add_lexer("sh", ShellLexer)
    app.connect("doctree-read", make_figures)
    app.connect("doctree-read", mark_tables)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

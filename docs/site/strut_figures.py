# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of a paragraph of their own become figures; their text is the caption if it has several words."""
from docutils import nodes


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


def setup(app):
    app.connect("doctree-read", make_figures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

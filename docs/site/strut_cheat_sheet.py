# SPDX-License-Identifier: GPL-3.0-or-later
"""The cheat sheet as a PDF: its page of the site, set by WeasyPrint with cheat-sheet.css on one A4 page."""
import pathlib
import re

from sphinx.util import logging

PAGE = "cheat-sheet"
STYLES = pathlib.Path(__file__).with_name("cheat-sheet.css")


def link_pdf(app, pagename, templatename, context, doctree):
    """The first paragraph says how the PDF is made. On the site it is there."""
    if pagename == PAGE:
        context["body"] = re.sub(r"(</h1>\s*)<p>.*?</p>", rf'\1<p><a href="{PAGE}.pdf">PDF of one page</a></p>',
                                 context["body"], count=1, flags=re.S)


def write_pdf(app, exception):
    if exception or app.builder.name != "html":
        return
    try:
        import weasyprint
    except ImportError:
        logging.getLogger(__name__).warning("no cheat-sheet.pdf: weasyprint is missing")
        return
    page = (pathlib.Path(app.outdir) / f"{PAGE}.html").read_text(encoding="utf-8")
    article = re.search(r"<article[^>]*>.*</article>", page, re.S)[0]
    html = f'<html lang="en"><head><title>strut: cheat sheet</title></head><body>{article}</body></html>'
    weasyprint.HTML(string=html, base_url=str(app.outdir)).write_pdf(
        str(pathlib.Path(app.outdir) / f"{PAGE}.pdf"), stylesheets=[weasyprint.CSS(filename=str(STYLES))])


def setup(app):
    app.connect("html-page-context", link_pdf)
    app.connect("build-finished", write_pdf)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar is made of docs/index.md, whose tables are the groups; headings keep the anchors of GitHub."""
import re

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.builders.html import StandaloneHTMLBuilder

LINK = re.compile(r"\]\(([^):#]+)\.md\)")
SEARCH_PAGE = "find"  # Sphinx calls its own page of results "search", and docs/search.md has that name


def groups(text):
    """The groups of pages of the start page, as (title, pages): what stands before the first table, and each
    table by the first cell of its head."""
    result = [("Start", [])]
    seen = set()
    lines = text.splitlines()
    for line, following in zip(lines, lines[1:] + [""]):
        if re.match(r"\|[-| ]+\|$", following):
            result.append((line.split("|")[1].strip().capitalize(), []))
        for page in LINK.findall(line):
            if page not in seen:
                seen.add(page)
                result[-1][1].append(page)
    return result


def add_navigation(app, docname, source):
    if docname != "index":
        return
    for title, pages in groups(source[0]):
        source[0] += "\n".join(["\n\n```{toctree}", ":hidden:", ":titlesonly:", f":caption: {title}", "", *pages, "```"])


def add_anchors(app, doctree):
    """Sphinx names headings in its own way; GitHub's names are added where they differ."""
    for section in doctree.findall(nodes.section):
        slug = section.get("slug") or section.get("myst-anchor", "").partition("#")[2]
        if slug and slug not in section["ids"]:
            section["ids"].append(slug)


class SiteBuilder(StandaloneHTMLBuilder):
    """Sphinx's builder of HTML, with the page of search results under another name."""

    def handle_page(self, pagename, addctx, templatename="page.html", *args, **kwargs):
        if pagename == "search" and templatename == "search.html":
            pagename = SEARCH_PAGE
        super().handle_page(pagename, addctx, templatename, *args, **kwargs)


def link_search_page(app, pagename, templatename, context, doctree):
    pathto = context["pathto"]
    context["pathto"] = lambda name, *args, **kwargs: pathto(
        SEARCH_PAGE if name == "search" else name, *args, **kwargs)


def setup(app):
    app.add_builder(SiteBuilder, override=True)
    app.add_lexer("csv", TextLexer)
    app.connect("source-read", add_navigation)
    app.connect("doctree-read", add_anchors)
    app.connect("html-page-context", link_search_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

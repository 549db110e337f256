# SPDX-License-Identifier: GPL-3.0-or-later
"""Links from pages to files of the repository that are no pages, such as models, lead to a page of the site
that shows the file: highlighted, with a link to the file itself. A folder is a list of its files."""
import os
import pathlib
import shutil
from html import escape

from docutils import nodes
from markdown_it import MarkdownIt
from pygments.lexers import get_lexer_for_filename
from pygments.util import ClassNotFound
from sphinx import addnodes

FOLDER = "source"  # of the site
README = "README.md"  # the site's own start page stands for the repository's


def repository(app):
    return pathlib.Path(app.srcdir).resolve().parent


def page_of(app, path, asked):
    """The name of the site's page for a file or folder of the repository, or None if it has no page. Adds the
    file to the set `asked` if that page has to be made here."""
    root = repository(app)
    if not path.exists() or root not in path.parents:
        return None
    name = path.relative_to(root).as_posix()
    if name == README:
        return "index"
    if path.suffix == ".md" and name.startswith("docs/"):
        return name[len("docs/"):-len(".md")]
    asked.add(name)
    return f"{FOLDER}/{name}"


def link_sources(app, doctree):
    """Replaces what MyST makes of a link to a file that is no page: a download, or a reference to nothing."""
    folder = pathlib.Path(app.env.doc2path(app.env.docname)).resolve().parent
    asked = app.env.strut_sources.setdefault(app.env.docname, set())
    for node in list(doctree.findall(lambda node: isinstance(
            node, (addnodes.download_reference, addnodes.pending_xref)))):
        target = node["reftarget"].partition("#")[0]
        path = folder / target
        if node.get("refdomain") == "doc":  # of myst-parser 4, which gives a page's name
            path = pathlib.Path(app.srcdir).resolve() / f"{target}.md"
        path = pathlib.Path(os.path.normpath(path))
        if path.suffix == ".md" and pathlib.Path(app.srcdir).resolve() in path.parents:
            continue
        page = target and page_of(app, path, asked)
        if page:
            inside = app.builder.get_relative_uri(app.env.docname, page)
            reference = nodes.reference("", "", internal=True, refuri=inside)
            reference.extend(child.deepcopy() for child in node[0].children)
            parent = node.parent
            parent.replace(node, reference)


def show_markdown(app, path, page, asked):
    """A README of a folder as HTML, its links leading to pages of the site."""
    parser = MarkdownIt("commonmark").enable("table")
    tokens = parser.parse(path.read_text(encoding="utf-8"))
    for block in tokens:
        for token in block.children or []:
            if token.type == "link_open" and ":" not in token.attrs["href"]:
                href, _, anchor = token.attrs["href"].partition("#")
                target = page_of(app, pathlib.Path(os.path.normpath(path.parent / href)), asked)
                if target is None:
                    raise ValueError(f"{path}: no file for the link {href}")
                token.attrs["href"] = app.builder.get_relative_uri(page, target) + (anchor and "#" + anchor)
    html = parser.renderer.render(tokens, parser.options, {})
    html = html.replace("<code>", '<code class="docutils literal">')
    return html.replace("<table>", '<div class="table-wrapper"><table class="docutils">').replace(
        "</table>", "</table></div>")


def show_file(app, path, name):
    try:
        lexer = get_lexer_for_filename(path.name).aliases[0]
    except ClassNotFound:
        lexer = {".cff": "yaml"}.get(path.suffix, "text")
    raw = pathlib.Path(app.outdir) / FOLDER / name
    raw.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, raw)
    code = app.builder.highlighter.highlight_block(path.read_text(encoding="utf-8"), lexer)
    return (f'<h1>{escape(path.name)}</h1>\n<p><code class="docutils literal">{escape(name)}</code> '
            f'(<a href="{escape(path.name)}" download>download</a>)</p>\n{code}')


def show_folder(app, path, page, asked):
    root = repository(app)
    readme = path / "README.md"
    head = show_markdown(app, readme, page, asked) if readme.exists() else f"<h1>{escape(path.name)}</h1>"
    rows = []
    for file in sorted(path.iterdir()):
        if file.suffix in (".yaml", ".txt", ".csv", ".py"):
            href = app.builder.get_relative_uri(page, page_of(app, file, asked))
            rows.append(f'<li><a href="{href}">{escape(file.name)}</a></li>')
    return (f'{head}\n<p>Files of <code class="docutils literal">{escape(path.relative_to(root).as_posix())}</code>:'
            f"</p>\n<ul>\n" + "\n".join(rows) + "\n</ul>")


def source_pages(app):
    """Yields a page for each file and folder that some page links to, and that those pages link to."""
    asked = set().union(*app.env.strut_sources.values())
    made = set()
    while asked - made:
        name = min(asked - made)
        made.add(name)
        path = repository(app) / name
        page = f"{FOLDER}/{name}"
        if path.is_dir():
            body = show_folder(app, path, page, asked)
        elif path.suffix == ".md":
            body = show_markdown(app, path, page, asked)
        else:
            body = show_file(app, path, name)
        yield page, {"title": path.name, "body": body}, "page.html"


def prepare(app, env, docnames):
    if not hasattr(env, "strut_sources"):
        env.strut_sources = {}  # page -> names of files that it links to


def forget(app, env, docname):
    getattr(env, "strut_sources", {}).pop(docname, None)


def merge(app, env, docnames, other):
    for docname in docnames:
        if docname in other.strut_sources:
            env.strut_sources[docname] = other.strut_sources[docname]


def setup(app):
    app.connect("env-before-read-docs", prepare)
    app.connect("env-purge-doc", forget)
    app.connect("env-merge-info", merge)
    app.connect("doctree-read", link_sources, priority=100)  # before Sphinx collects files to download
    app.connect("html-collect-pages", source_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True, "env_version": 1}

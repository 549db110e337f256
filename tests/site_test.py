# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site builds without a warning, and what is built holds together: every link, anchor and image
of every page leads somewhere, every page can be reached and is in the sidebar, nothing is loaded from elsewhere,
no page shows Markdown, and the cheat sheet is one page.

    python3 tests/site_test.py ROOT SITE PROGRAM

builds ROOT/docs into the folder SITE, with an empty page in place of the playground and PROGRAM, strut. Exits with 77 where Sphinx or a part of it is missing.
"""
import base64
import html.parser
import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
import zlib

root = pathlib.Path(sys.argv[1]).resolve()
site = pathlib.Path(sys.argv[2]).resolve()
program = pathlib.Path(sys.argv[3]).resolve()
failures = 0

VOID = {"img", "br", "hr", "input", "link", "meta", "source", "col", "wbr"}
# What Markdown leaves in a text that was not understood.
LEFTOVERS = ("](", "<!--", "-->", "```", "**", "|--", "[@", "\\label", "\\autoref", "{toctree}")


def fail(text):
    global failures
    failures += 1
    print("FAILED:", text)


class Page(html.parser.HTMLParser):
    """What a page has and needs."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.ids, self.links, self.loaded, self.images = set(), [], [], []
        self.navigation, self.headings, self.text = [], [], []
        self.open = []  # (tag, classes) around the place
        self.feed(text)
        self.close()

    def inside(self, tags, kind=None):
        return any(tag in tags and (kind is None or kind in classes) for tag, classes in self.open)

    def handle_starttag(self, tag, attributes):
        attributes = {name: value or "" for name, value in attributes}
        if "id" in attributes:
            self.ids.add(attributes["id"])
        if tag == "a" and "href" in attributes:
            self.links.append(attributes["href"])
            if self.inside({"div"}, "sidebar-tree"):
                self.navigation.append(attributes["href"])
        elif tag == "form" and "action" in attributes:
            self.links.append(attributes["action"])
        elif tag == "link" and "href" in attributes:
            self.loaded.append(attributes["href"])
        elif tag == "script" and "src" in attributes:
            self.loaded.append(attributes["src"])
        elif tag == "img":
            self.images.append((attributes.get("src", ""), attributes.get("alt", "")))
        if re.fullmatch("h[1-6]", tag) and self.inside({"article"}):
            self.headings.append(int(tag[1]))
        if tag not in VOID:
            self.open.append((tag, attributes.get("class", "").split()))

    def handle_endtag(self, tag):
        for place in range(len(self.open) - 1, -1, -1):
            if self.open[place][0] == tag:
                del self.open[place:]
                return

    def handle_data(self, data):
        if not self.inside({"script", "style", "pre", "code"}):
            self.text.append(data)


def target(page, link):
    """The file and the anchor that a link of a page leads to."""
    path, _, anchor = link.partition("#")
    path = urllib.parse.unquote(path.partition("?")[0])
    return ((page.parent / path).resolve() if path else page), urllib.parse.unquote(anchor)


def is_web(link):
    return re.match(r"[a-z]+:", link) is not None


def faults(folder):
    """What is wrong with the pages of a folder."""
    folder = folder.resolve()
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))
             if path.name != "try.html"}
    leads = {}
    for path, page in pages.items():
        name = path.relative_to(folder)
        leads[path] = set()
        for link in page.links:
            if is_web(link):
                continue
            file, anchor = target(path, link)
            leads[path].add(file)
            if not file.is_file() or folder not in file.parents:
                yield f"{name}: no file for the link {link}"
            elif anchor and file in pages and anchor not in pages[file].ids:
                yield f"{name}: no anchor for the link {link}"
        for source, text in page.images:
            file, _ = target(path, source)
            if is_web(source) or not file.is_file() or folder not in file.parents:
                yield f"{name}: no image {source}"
            if not text.strip():
                yield f"{name}: no text for the image {source}"
        for source in page.loaded:
            if is_web(source) or source.startswith("/") or not target(path, source)[0].is_file():
                yield f"{name}: loads {source}"
        text = " ".join(page.text)
        for leftover in LEFTOVERS:
            if leftover in text:
                place = text.index(leftover)
                yield f"{name}: shows {text[max(0, place - 30):place + 30]!r}"
        if page.headings.count(1) != 1 and path.name != "find.html":  # whose title a script writes
            yield f"{name}: {page.headings.count(1)} titles"
        for before, after in zip(page.headings, page.headings[1:]):
            if after > before + 1:
                yield f"{name}: a heading of level {after} after one of level {before}"
    for path in sorted(folder.rglob("*.css")):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.S)
        for source in re.findall(r"""url\(\s*['"]?([^'")]+)""", text):
            if not source.startswith("data:") and (
                    is_web(source) or source.startswith("/") or not target(path, source)[0].is_file()):
                yield f"{path.relative_to(folder)}: loads {source}"

    reached, next_ones = set(), {folder / "index.html"}
    while next_ones:
        reached |= next_ones
        next_ones = {file for path in next_ones for file in leads.get(path, ()) if file in pages} - reached
    for path in sorted(set(pages) - reached):
        yield f"{path.relative_to(folder)}: no link leads here"


def build(tree, out, *settings):
    """Builds the site of a tree; returns whether that worked, and what was said."""
    with tempfile.TemporaryDirectory() as doctrees:
        done = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-c",
                               tree / "docs" / "site", "-d", doctrees, *settings, tree / "docs", out],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode == 0, done.stdout


def check_self():
    """Pages with a fault that must be found, and a small copy of the site with dead links."""
    good = '<article><h1 id="a">A</h1><a href="b.html#b">b</a><img src="i.svg" alt="i"><code>](</code></article>'
    back = '<article><h1 id="b">B</h1><a href="index.html">A</a></article>'
    cases = [(good, back, None),
             (good.replace("b.html#b", "c.html"), back, "no file for the link c.html"),
             (good.replace("b.html#b", "b.html#c"), back, "no anchor for the link b.html#c"),
             (good.replace("b.html#b", "../b.html"), back, "no file for the link ../b.html"),
             (good.replace("i.svg", "j.svg"), back, "no image j.svg"),
             (good.replace('alt="i"', 'alt=""'), back, "no text for the image"),
             (good.replace('<a href="b.html#b">b</a>', ""), back, "b.html: no link leads here"),
             (good, back.replace("B", "[B](b.md)"), "shows"),
             (good, back.replace("B", "&lt;!-- printed --&gt;"), "shows"),
             (good, back.replace("h1", "h2"), "0 titles"),
             (good, back + "<article><h3>C</h3></article>", "a heading of level 3 after one of level 1"),
             (good, back + '<script src="https://example.org/x.js"></script>', "loads https://example.org/x.js")]
    for first, second, wanted in cases:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "index.html").write_text(first)
            (folder / "b.html").write_text(second)
            (folder / "i.svg").write_text("<svg/>")
            found = list(faults(folder))
        if wanted is None and found:
            fail(f"self-test: a good page has faults: {found}")
        if wanted is not None and not any(wanted in fault for fault in found):
            fail(f"self-test: not found: {wanted}; but {found}")

    wrong = {"[a](nowhere.md)": "nowhere.md", "[b](../models/nowhere.yaml)": "nowhere.yaml",
             "[c](cheat-sheet.md#nowhere)": "nowhere", "![d](nowhere.svg)": "nowhere.svg", "### Deep": "header level"}
    with tempfile.TemporaryDirectory() as name:
        tree = pathlib.Path(name)
        shutil.copytree(root / "docs" / "site", tree / "docs" / "site")
        shutil.copyfile(root / "CMakeLists.txt", tree / "CMakeLists.txt")
        (tree / "docs" / "index.md").write_text("# A\n\n[b](cheat-sheet.md)\n\n" + "\n\n".join(wrong) + "\n")
        (tree / "docs" / "cheat-sheet.md").write_text("# B\n")
        (tree / "docs" / "orphan.md").write_text("# C\n")
        worked, said = build(tree, tree / "out")
    if worked:
        fail("self-test: a site with dead links builds")
    lines = [line for line in said.splitlines() if "WARNING" in line]
    for text, wanted in wrong.items():
        if not any("index.md" in line and wanted in line.lower() for line in lines):
            fail(f"self-test: no warning of {text}:\n{said}")
    if not any("orphan.md" in line and "toctree" in line for line in lines):
        fail(f"self-test: no warning of a page that is in no group:\n{said}")


def check_pages():
    """Every Markdown page is a page of the site and in its sidebar."""
    index = Page((site / "index.html").read_text(encoding="utf-8"))
    sidebar = {target(site / "index.html", link)[0] for link in index.navigation}
    for source in sorted((root / "docs").rglob("*.md")):
        name = source.relative_to(root / "docs").with_suffix(".html")
        if not (site / name).is_file():
            fail(f"no page {name}")
        elif name.name != "index.html" and site / name not in sidebar:
            fail(f"{name} is not in the sidebar")
    # docs/search.md and Sphinx's page of search results want the same name.
    if 'id="search-results"' in (site / "search.html").read_text(encoding="utf-8") or not (site / "find.html").is_file():
        fail("search.html is not the page of docs/search.md")
    titles = (site / "searchindex.js").read_text(encoding="utf-8")
    for title in ("Statics", "Gallery", "Changelog"):
        if title not in titles:
            fail(f"the search does not know the page {title}")


def check_cheat_sheet():
    pdf = site / "cheat-sheet.pdf"
    if not pdf.is_file():
        fail("no cheat-sheet.pdf")
    elif not shutil.which("pdfinfo"):
        print("no pdfinfo: the pages of the cheat sheet are not counted")
    else:
        told = subprocess.run(["pdfinfo", pdf], stdout=subprocess.PIPE, text=True, check=True).stdout
        if not re.search(r"^Pages: +1$", told, re.M) or "(A4)" not in told:
            fail(f"the cheat sheet is not one page of A4:\n{told}")
        text = subprocess.run(["pdftotext", pdf, "-"], stdout=subprocess.PIPE, text=True, check=True).stdout
        for words in ("strut run", "exit codes", "output:"):
            if words not in text:
                fail(f"the cheat sheet lacks {words!r}")


def check_playground():
    """Complete scenes have a link that holds them; what is no scene, or needs other files, has none."""
    links = {}
    for path in site.rglob("*.html"):
        for link in re.findall(r'class="try" href="([^"]*)"', path.read_text(encoding="utf-8")):
            file, packed = target(path, link)
            if file != site / "try.html" or not packed.startswith("s="):
                fail(f"{path.name}: the link {link} does not lead to the playground")
                continue
            data = base64.urlsafe_b64decode(packed[2:] + "=" * (-len(packed[2:]) % 4))
            links.setdefault(path.stem, []).append(json.loads(zlib.decompress(data, -15)))
    names = {page: [scene["name"] for scene in found] for page, found in links.items()}
    if names.get("tutorial") != ["falling.yaml", "shape.yaml", "robot.yaml"]:
        fail(f"scenes to try in the tutorial: {names.get('tutorial')}")
    for page in ("language", "parts", "cheat-sheet"):
        if page not in names:
            fail(f"no scene to try in {page}")
    if "worm.yaml" in names.get("parts", []):
        fail("a scene that needs another file can be tried")
    for scene in (scene for found in links.values() for scene in found):
        done = subprocess.run([program, "check", "-q", "-"], input=scene["text"], text=True, check=False)
        if done.returncode or scene["settings"] != {}:
            fail(f"{scene['name']} cannot be tried")


missing = [name for name in ("sphinx", "myst_parser", "furo", "weasyprint") if not importlib.util.find_spec(name)]
if missing:
    print("skipped: there is no", ", ".join(missing), "(Debian: python3-myst-parser furo weasyprint)")
    sys.exit(77)
check_self()
if site.exists():
    shutil.rmtree(site)
with tempfile.TemporaryDirectory() as name:
    page = pathlib.Path(name) / "playground.html"
    page.write_text("<!DOCTYPE html><title>playground</title>")
    worked, said = build(root, site, "-D", f"strut_playground={page}", "-D", f"strut_program={program}")
if not worked:
    fail(f"the site does not build:\n{said}")
else:
    for fault in faults(site):
        fail(fault)
    check_pages()
    check_cheat_sheet()
    check_playground()
    print(len(list(site.rglob("*.html"))), "pages")
sys.exit(failures > 0)

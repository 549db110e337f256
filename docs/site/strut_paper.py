# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/joss/paper.md is written for Pandoc: its citations, references to figures and list of references are
filled in here from paper.bib."""
import pathlib
import re

PAGE = "joss/paper"


def entries(text):
    """The entries of a BibTeX file: key -> field -> value."""
    result = {}
    for key, body in re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", text, re.M | re.S):
        fields = re.findall(r"^\s*(\w+)\s*=\s*\{(.*?)\},?$", body, re.M | re.S)
        result[key] = {name.lower(): re.sub(r"[{}]", "", value).replace("--", "–") for name, value in fields}
    return result


def authors(entry):
    """Of a work without authors, a program, its name."""
    return [name.strip() for name in entry.get("author", entry["title"].partition(":")[0]).split(" and ")]


def short(entry):
    names = [name.split(",")[0] for name in authors(entry)]
    if len(names) > 2 or names[-1] == "others":
        return names[0] + " et al."
    return " and ".join(names)


def full(entry):
    names = "; ".join("et al." if name == "others" else name for name in authors(entry))
    where = entry.get("journal") or entry.get("booktitle") or entry.get("publisher") or entry.get("howpublished", "")
    parts = [f"{names} ({entry['year']})" if "year" in entry else names,
             entry["title"] if "author" in entry else ""]
    parts.append(" ".join(filter(None, [where and f"*{where}*", entry.get("volume"), entry.get("pages")])))
    parts.append(entry.get("note", ""))
    if "doi" in entry:
        parts.append(f"[doi:{entry['doi']}](https://doi.org/{entry['doi']})")
    elif "url" in entry:
        parts.append(f"<{entry['url']}>")
    return ". ".join(filter(None, parts)).replace("..", ".")


def fill_in(text, works):
    head = re.match(r"---\n(.*?)\n---\n", text, re.S)
    title = re.search(r'^title: "?(.*?)"?$', head[1], re.M)[1]
    text = re.sub(r"^(#+ )", r"#\1", text[head.end():], flags=re.M)

    cited = set()

    def cite(match):
        keys = re.findall(r"@(\w+)", match[0])
        cited.update(keys)
        if match[0].startswith("["):
            return "(" + "; ".join(f"{short(works[key])} {works[key].get('year', '')}".strip() for key in keys) + ")"
        return f"{short(works[keys[0]])} ({works[keys[0]]['year']})"

    text = re.sub(r"\[@[^\]]*\]|(?<![\w.])@\w+", cite, text)
    numbers = {label: n for n, label in enumerate(re.findall(r"\\label\{([^}]*)\}", text), 1)}
    text = re.sub(r"\\label\{[^}]*\}", "", text)
    text = re.sub(r"\\autoref\{([^}]*)\}", lambda match: f"figure {numbers[match[1]]}", text)
    text = re.sub(r"^(figure \d)", lambda match: match[1].capitalize(), text, flags=re.M)
    labels = iter(numbers.values())
    text = re.sub(r"!\[", lambda match: f"![Figure {next(labels)}: ", text)
    references = "\n".join(sorted(f"- {full(works[key])}" for key in cited))
    return f"# {title}\n{text.rstrip()}\n\n{references}\n"


def read_paper(app, docname, source):
    if docname == PAGE:
        bibliography = pathlib.Path(app.srcdir) / "joss" / "paper.bib"
        source[0] = fill_in(source[0], entries(bibliography.read_text(encoding="utf-8")))


def setup(app):
    app.connect("source-read", read_paper)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

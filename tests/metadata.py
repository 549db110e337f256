# SPDX-License-Identifier: GPL-3.0-or-later
"""What describes strut to archives, indices and journals agrees.

CMakeLists.txt, CITATION.cff, codemeta.json and docs/changelog.md name one version, and the first three one licence.
CITATION.cff has the fields that the Citation File Format 1.2.0 requires, codemeta.json those of CodeMeta 2.0 that
archives read, docs/joss/paper.md the head that the Journal of Open Source Software requires. Each work that the
article cites is in paper.bib, and each one there is cited; its pictures exist. A self-test first breaks copies of
these files, one by one, and checks that each fault is found.

usage: metadata.py ROOT
"""
import datetime
import json
import os
import re
import shutil
import sys
import tempfile

try:
    import yaml
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

CMAKE, CITATION, CODEMETA, CHANGELOG = "CMakeLists.txt", "CITATION.cff", "codemeta.json", "docs/changelog.md"
ARTICLE, BIBLIOGRAPHY = "docs/joss/paper.md", "docs/joss/paper.bib"
FIELDS = {
    CITATION: "cff-version message title authors abstract type version license keywords references".split(),
    CODEMETA: "@context @type name description version license programmingLanguage author keywords "
              "referencePublication".split(),
    ARTICLE: "title tags authors affiliations date bibliography".split(),
}
SECTIONS = ["Summary", "Statement of need", "State of the field", "Features", "Verification", "Availability",
            "Acknowledgements", "References"]
IMAGE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")


def read(root, name):
    with open(os.path.join(root, name), encoding="utf-8") as file:
        return file.read()


def first(pattern, text):
    """The first group of the first match; None without one."""
    match = re.search(pattern, text, re.M)
    return match and match[1]


def article_parts(text):
    """The YAML head of the article, and the text after it."""
    match = re.fullmatch(r"---\n(.*?)\n---\n(.*)", text, re.S)
    return (yaml.safe_load(match[1]), match[2]) if match else ({}, text)


def missing_fields(name, mapping):
    return [f"{name}: no {field}" for field in FIELDS[name] if not mapping.get(field)]


def person(author):
    return author.get("name") or f"{author.get('given-names')} {author.get('family-names')}"


def citation_faults(citation):
    faults = []
    if citation.get("cff-version") != "1.2.0":
        faults.append(f"{CITATION}: not cff-version 1.2.0")
    if citation.get("type") not in ("software", "dataset"):
        faults.append(f"{CITATION}: type is neither software nor dataset")
    for work in citation.get("references") or []:
        faults += [f"{CITATION}: a reference without {field}" for field in ("type", "title", "authors")
                   if not work.get(field)]
        if work.get("type") == "conference-paper" and not (work.get("conference") or {}).get("name"):
            faults.append(f"{CITATION}: a conference paper without a conference")
    for author in (citation.get("authors") or []) + [a for work in citation.get("references") or []
                                                     for a in work.get("authors") or []]:
        if not author.get("name") and not (author.get("family-names") and author.get("given-names")):
            faults.append(f"{CITATION}: an author without a name")
    return faults


def article_faults(root, head, body):
    faults = []
    known = {str(place.get("index")) for place in head.get("affiliations") or [] if place.get("name")}
    for author in head.get("authors") or []:
        places = set(re.split(r"[,\s]+", str(author.get("affiliation", ""))))
        if not author.get("name") or not places <= known:
            faults.append(f"{ARTICLE}: an author without a name or a listed affiliation")
    try:
        datetime.datetime.strptime(str(head.get("date")), "%d %B %Y")
    except ValueError:
        faults.append(f"{ARTICLE}: the date {head.get('date')} is not like 27 November 2026")
    if head.get("bibliography") != os.path.basename(BIBLIOGRAPHY):
        faults.append(f"{ARTICLE}: bibliography is not {os.path.basename(BIBLIOGRAPHY)}")
    sections = re.findall(r"^# (.+)$", body, re.M)
    faults += [f"{ARTICLE}: no section {name}" for name in SECTIONS if name not in sections]
    cited = set(re.findall(r"(?<![\w\\])@([A-Za-z][\w-]*)", body))
    listed = re.findall(r"^@\w+\{([^,\s]+),", read(root, BIBLIOGRAPHY), re.M)
    faults += [f"{BIBLIOGRAPHY}: {key} is listed twice" for key in set(listed) if listed.count(key) > 1]
    faults += [f"{ARTICLE}: {key} is not in {BIBLIOGRAPHY}" for key in sorted(cited - set(listed))]
    faults += [f"{BIBLIOGRAPHY}: {key} is not cited in {ARTICLE}" for key in sorted(set(listed) - cited)]
    folder = os.path.join(root, os.path.dirname(ARTICLE))
    faults += [f"{ARTICLE}: no image {image}" for image in IMAGE.findall(body)
               if not os.path.exists(os.path.join(folder, image))]
    return faults


def all_faults(root):
    """One sentence for each fault of the files below root."""
    cmake = read(root, CMAKE)
    citation = yaml.safe_load(read(root, CITATION))
    codemeta = json.loads(read(root, CODEMETA))
    head, body = article_parts(read(root, ARTICLE))
    faults = missing_fields(CITATION, citation) + missing_fields(CODEMETA, codemeta) + missing_fields(ARTICLE, head)

    version = first(r"^project\(strut VERSION ([\w.]+)", cmake)
    for name, other in ((CITATION, citation.get("version")), (CODEMETA, codemeta.get("version")),
                        (CHANGELOG, first(r"^## ([\w.]+)", read(root, CHANGELOG)))):
        if other != version:
            faults.append(f"{name}: version {other}, but {CMAKE} has {version}")
    licence = first(r"SPDX-License-Identifier: (\S+)", cmake)
    for name, other in ((CITATION, citation.get("license")),
                        (CODEMETA, first(r"^https://spdx\.org/licenses/(\S+)$", codemeta.get("license") or ""))):
        if other != licence:
            faults.append(f"{name}: license {other}, but {CMAKE} has {licence}")

    authors = [person(author) for author in citation.get("authors") or []]
    for name, others in ((CODEMETA, codemeta.get("author")), (ARTICLE, head.get("authors"))):
        if [other.get("name") for other in others or []] != authors:
            faults.append(f"{name}: not the authors of {CITATION}")
    if codemeta.get("keywords") != citation.get("keywords"):
        faults.append(f"{CODEMETA}: not the keywords of {CITATION}")
    published = (codemeta.get("referencePublication") or {}).get("name")
    if published not in [work.get("title") for work in citation.get("references") or []]:
        faults.append(f"{CODEMETA}: referencePublication is not among the references of {CITATION}")
    return faults + citation_faults(citation) + article_faults(root, head, body)


def self_test(root):
    """Faults that all_faults overlooks in broken copies."""
    version = first(r"^project\(strut VERSION ([\w.]+)", read(root, CMAKE))
    licence = "GPL-3.0-or-later"
    image = IMAGE.search(read(root, ARTICLE))[1]
    broken = [(CMAKE, f"VERSION {version}", "VERSION 9.9.9"), (CITATION, f"version: {version}", "version: 9.9.9"),
              (CODEMETA, f'"version": "{version}"', '"version": "9.9.9"'), (CHANGELOG, f"## {version}", "## 9.9.9"),
              (CMAKE, licence, "MIT"), (CITATION, licence, "MIT"), (CODEMETA, licence, "MIT"),
              (CITATION, "message:", "massage:"), (CITATION, "conference:", "conferences:"),
              (CODEMETA, '"description"', '"descriptions"'), (CODEMETA, "The strut developers", "Others"),
              (ARTICLE, "tags:", "labels:"), (ARTICLE, "index: 1", "index: 2"), (ARTICLE, "\ndate: ", "\ndate: the "),
              (ARTICLE, "# Statement of need", "# Need"), (ARTICLE, image, "nowhere.svg"),
              (ARTICLE, "@schorr2018", "@nobody1900"), (BIBLIOGRAPHY, "{schorr2018,", "{nobody1900,")]
    overlooked = []
    for name, old, new in broken:
        with tempfile.TemporaryDirectory() as copy:
            for file in (CMAKE, CITATION, CODEMETA, CHANGELOG, ARTICLE, BIBLIOGRAPHY):
                os.makedirs(os.path.dirname(os.path.join(copy, file)), exist_ok=True)
                shutil.copy(os.path.join(root, file), os.path.join(copy, file))
            for other in IMAGE.findall(read(root, ARTICLE)):
                path = os.path.normpath(os.path.join(os.path.dirname(ARTICLE), other))
                os.makedirs(os.path.dirname(os.path.join(copy, path)), exist_ok=True)
                open(os.path.join(copy, path), "w", encoding="utf-8").close()
            if all_faults(copy):
                return [f"self-test: an unbroken copy has faults: {all_faults(copy)}"]
            text = read(copy, name)
            with open(os.path.join(copy, name), "w", encoding="utf-8") as file:
                file.write(text.replace(old, new, 1))
            if old not in text or not all_faults(copy):
                overlooked.append(f"self-test: {name} with '{new}' instead of '{old}' passes")
    return overlooked


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: metadata.py ROOT")
    root = sys.argv[1]
    faults = all_faults(root) or self_test(root)
    for fault in faults:
        print("FAILED:", fault)
    print(f"{len(faults)} failures")
    sys.exit(bool(faults))


main()

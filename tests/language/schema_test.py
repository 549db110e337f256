#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The schema and the reader agree: what strut accepts passes the schema, and what the schema can see of
a bad file it reports in the same line; it reports nothing in lines that are right.

    schema_test.py STRUT UNPACK_CASES"""
import glob
import json
import os
import random
import re
import subprocess
import sys

from testing import check, fail, finish, needs, strut, work

needs("yaml", "jsonschema")
import yaml  # noqa: E402
from jsonschema import Draft7Validator  # noqa: E402

here = os.path.dirname(os.path.abspath(__file__))
top = os.path.dirname(os.path.dirname(here))


def schema(*options):
    return json.loads(subprocess.run([strut, "keys", "--schema", *options], check=True, stdout=subprocess.PIPE).stdout)


# ---- YAML 1.2 with the line of every value and key ----

NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$")


def scalar(node):
    text = node.value
    if node.style is not None:
        return text
    if text in ("", "~", "null", "Null", "NULL"):
        return None
    if text in ("true", "True", "TRUE", "false", "False", "FALSE"):
        return text.lower() == "true"
    if NUMBER.match(text):
        return float(text) if re.search(r"[.eE]", text) else int(text)
    return text


class Located:
    """A document as plain values; lines[path] is the line of a value, keys[path] that of its key."""

    def __init__(self, text):
        self.lines, self.keys = {}, {}
        self.value = self.take(yaml.compose(text, Loader=yaml.SafeLoader), ())

    def take(self, node, path):
        self.lines[path] = node.start_mark.line + 1
        if isinstance(node, yaml.SequenceNode):
            return [self.take(item, path + (i,)) for i, item in enumerate(node.value)]
        if isinstance(node, yaml.MappingNode):
            pairs = {}
            for key, value in node.value:
                self.keys[path + (key.value,)] = key.start_mark.line + 1
                pairs[key.value] = self.take(value, path + (key.value,))
            return pairs
        return scalar(node)


def complaints(validator, document):
    """(line, message) for everything that the schema refuses."""
    for error in validator.iter_errors(document.value):
        path = tuple(error.absolute_path)
        if error.validator == "additionalProperties" and error.validator_value is False:
            for key in error.instance:
                if key not in error.schema["properties"]:
                    yield document.keys[path + (key,)], f"unknown key {key}"
        elif "propertyNames" in error.absolute_schema_path:
            yield document.keys[path + (error.instance,)], f"name {error.instance}"
        else:
            yield document.lines[path], error.message[:200]


def words_of(tree):
    """The lists of words in a schema as messages say them: "a, b or c"."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            if key == "enum" and all(isinstance(word, (str, bool)) for word in value):
                words = [word for word in value if isinstance(word, str)]
                yield " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
            yield from words_of(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from words_of(value)


# ---- what passes ----

scene, study = Draft7Validator(schema()), Draft7Validator(schema("--study"))
for each in scene, study:
    Draft7Validator.check_schema(each.schema)


def validator_of(document):
    return study if isinstance(document.value, dict) and "study" in document.value else scene


def must_pass(path):
    with open(path, encoding="utf-8") as file:
        document = Located(file.read())
    for line, message in complaints(validator_of(document), document):
        fail(f"{path}:{line}: {message}")


good = [path for pattern in ("models/**/*.yaml", "tests/language/good/*.yaml", "tests/language/studies/good/*.yaml",
                             "tests/**/*.yaml", "docs/**/*.yaml")
        for path in sorted(glob.glob(os.path.join(top, pattern), recursive=True)) if "/bad/" not in path]
good = list(dict.fromkeys(good))
for path in good:
    must_pass(path)
print(f"{len(good)} good files")

# ---- what fails in the same line ----

# Faults of shape that depend on other values of the file.
UNSEEN = {
    "contacts-mixed.yaml",  # nodes, or lists of nodes, but not both
    "parts-lattice-next.yaml",  # one count or a lattice decide the form of step and next
    "parts-lattice-one-step.yaml",
    "parts-next-list.yaml",
    "parts-step-two.yaml",
    "parts-name-exists.yaml",  # the node is in a copy
    "shape-list.yaml",  # the position of a node called shape, if there is one
}

known_words = set(words_of(scene.schema)) | set(words_of(study.schema))


def is_visible(message):
    if message.startswith("unknown key '"):
        return True
    if re.search(r", found (a list|a mapping|nothing)", message):
        return True
    found = re.match(r"expected (.*?) for '.*', found '", message)
    return bool(found) and found.group(1) in known_words


def announced(path):
    with open(path.replace(".yaml", ".expect"), encoding="utf-8") as file:
        for line in file:
            place = re.match(r"([0-9]+):[0-9]+: (.*)", line)
            if place:
                yield int(place.group(1)), place.group(2)


visible = missed = 0
subprocess.run([sys.argv[2], os.path.join(here, "bad"), work, "--messages"], check=True)
for path in sorted(glob.glob(os.path.join(work, "*.yaml"))):
    with open(path, "rb") as file:
        text = file.read()
    try:
        text = text.decode()
        document = Located(text)
    except (UnicodeDecodeError, yaml.YAMLError, AttributeError, TypeError, RecursionError):
        continue # a fault of YAML
    expected = list(announced(path))
    seen = list(complaints(validator_of(document), document))
    lines = {line for line, _ in seen}
    for line, message in expected:
        if is_visible(message):
            visible += 1
            if line not in lines and os.path.basename(path) not in UNSEEN:
                fail(f"{path}:{line}: strut says '{message}', the schema nothing")
    right = {line for line, _ in expected}
    for line, message in seen:
        check(line in right, f"{path}:{line}: the schema says '{message}', strut nothing")
print(f"{visible} faults that a schema can see")
check(visible >= 120, "too few faults were compared")

# ---- keys of good files, misspelt: both find the same lines ----


def keys_of(node):
    if isinstance(node, yaml.SequenceNode):
        for item in node.value:
            yield from keys_of(item)
    elif isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            if value.value != "remove":  # whether there is such a thing the schema cannot know
                yield key
            yield from keys_of(value)


def unknown_to_strut(path, text):
    run = subprocess.run([strut, "check", "-q", "-"], input=text, encoding="utf-8", cwd=os.path.dirname(path),
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return {int(line) for line in re.findall(r":([0-9]+):[0-9]+: error: (?:unknown key|there is no '[^']*' to remove)", run.stderr)}


random.seed(1)
compared = 0
for path in sorted(glob.glob(os.path.join(here, "good", "*.yaml"))):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    keys = list(keys_of(yaml.compose(text, Loader=yaml.SafeLoader)))
    for key in random.sample(keys, min(5, len(keys))):
        end = key.start_mark.index + len(key.value)
        if key.style is not None or text[key.start_mark.index:end] != key.value:
            continue
        changed = text[:end] + "qx" + text[end:]
        document = Located(changed)
        found = list(complaints(scene, document))
        by_schema = {line for line, message in found if message.startswith("unknown key")}
        by_strut = unknown_to_strut(path, changed)
        if not by_schema <= by_strut <= {line for line, _ in found}:
            fail(f"{path}: '{key.value}' misspelt: the schema reports {by_schema}, strut {by_strut}")
        compared += bool(by_strut)
print(f"{compared} misspelt keys")
check(compared >= 60, "too few misspelt keys were compared")
finish()

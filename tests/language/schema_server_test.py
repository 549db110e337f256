#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The schema in an editor: the real yaml-language-server completes, explains and marks errors with it.

    schema_server_test.py STRUT

The server is not in Debian: npm install yaml-language-server (1.25 for node 20), and its program on the PATH
or in STRUT_YAML_SERVER."""
import json
import os
import re
import shutil
import subprocess
import sys
import threading

from testing import check, failed, strut, work

top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
program = os.environ.get("STRUT_YAML_SERVER") or shutil.which("yaml-language-server")
if not program or not shutil.which("node"):
    print("skipped: yaml-language-server is not installed")
    sys.exit(77)


class Server:
    def __init__(self):
        self.process = subprocess.Popen([program, "--stdio"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.count = 0
        threading.Timer(100, self.process.kill).start()
        self.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {
            "textDocument": {"completion": {"completionItem": {"snippetSupport": True}},
                             "hover": {"contentFormat": ["markdown"]}}}})
        self.tell("initialized", {})
        self.tell("workspace/didChangeConfiguration", {"settings": {"yaml": {
            "validate": True, "hover": True, "completion": True, "schemaStore": {"enable": False}}}})

    def send(self, message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.process.stdin.flush()

    def receive(self):
        length = 0
        while True:
            line = self.process.stdout.readline()
            if not line:
                sys.exit("the server has ended")
            if line == b"\r\n":
                return json.loads(self.process.stdout.read(length))
            if line.lower().startswith(b"content-length:"):
                length = int(line.split(b":")[1])

    def tell(self, method, params):
        self.send({"method": method, "params": params})

    def wait(self, wanted):
        while True:
            message = self.receive()
            if "method" in message and "id" in message:  # the server asks: it has its settings already
                settings = [{"validate": True, "hover": True, "completion": True, "schemaStore": {"enable": False}}]
                known = message["method"] == "workspace/configuration"
                self.send({"id": message["id"], "result": settings if known else None})
            elif wanted(message):
                return message

    def ask(self, method, params):
        self.count += 1
        number = self.count
        self.send({"id": number, "method": method, "params": params})
        return self.wait(lambda message: message.get("id") == number and "method" not in message).get("result")

    def open(self, path, text):
        """Opens a document; its diagnostics as {(line, text before, message)}."""
        uri = "file://" + path
        self.tell("textDocument/didOpen", {"textDocument": {"uri": uri, "languageId": "yaml", "version": 1, "text": text}})
        found = self.wait(lambda m: m.get("method") == "textDocument/publishDiagnostics" and m["params"]["uri"] == uri)
        lines = text.splitlines()
        return [(d["range"]["start"]["line"] + 1, lines[d["range"]["start"]["line"]][d["range"]["start"]["character"]:
                 d["range"]["end"]["character"]], d["message"]) for d in found["params"]["diagnostics"]]


schema = os.path.join(work, "strut-1.schema.json")
with open(schema, "w", encoding="utf-8") as file:
    subprocess.run([strut, "keys", "--schema"], check=True, stdout=file)
head = "# yaml-language-server: $schema=strut-1.schema.json\n"
server = Server()
number = 0


def document(text):
    """A document with the mark | in it: path, text without the mark, text up to it, diagnostics."""
    global number
    number += 1
    path = os.path.join(work, f"{number}.yaml")
    whole = head + text.replace("|", "")
    marked = head + text
    return path, whole, marked, server.open(path, whole)


def completed(text):
    path, whole, marked, _ = document(text)
    before = marked[:marked.index("|")]
    place = {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}
    result = server.ask("textDocument/completion", {"textDocument": {"uri": "file://" + path}, "position": place})
    items = result["items"] if isinstance(result, dict) else result
    return {item["label"]: item for item in items}


def hovered(text):
    path, whole, marked, _ = document(text)
    before = marked[:marked.index("|")]
    place = {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}
    result = server.ask("textDocument/hover", {"textDocument": {"uri": "file://" + path}, "position": place})
    contents = result["contents"] if result else ""
    return contents["value"] if isinstance(contents, dict) else str(contents)


# A model of the house has no errors.
for model in ("models/crawler/crawler.yaml", "models/parts/x-chain.yaml", "models/gallery/kangaroo.yaml"):
    if not os.path.exists(os.path.join(top, model)):
        continue
    with open(os.path.join(top, model), encoding="utf-8") as file:
        found = document(file.read().replace("|", " "))[3]
    check(not found, f"{model}: {found}")

# Completion.
keys = completed("strut: 1\n|\n")
for key in ("nodes", "members", "ground", "solver", "configurations"):
    check(key in keys, f"'{key}' is not offered at the top: {sorted(keys)[:60]}")
keys = completed("strut: 1\nmembers:\n  ab:\n    |\n")
for key in ("nodes", "kind", "stiffness", "rest_length_ratio"):
    check(key in keys, f"'{key}' is not offered in a member: {sorted(keys)}")
check("position" not in keys, "'position' is offered in a member")
keys = completed("strut: 1\nnodes:\n  a:\n    |\n")
for key in ("position", "fixed", "mass"):
    check(key in keys, f"'{key}' is not offered in a node: {sorted(keys)}")
keys = completed("strut: 1\nactuators:\n  a:\n    signal:\n      |\n")
check("sine" in keys, f"'sine' is not offered in a signal: {sorted(keys)}")
words = completed("strut: 1\nsolver:\n  integrator: |\n")
for word in ("rk4", "rk4-events", "adaptive"):
    check(word in words, f"'{word}' is not offered for integrator: {sorted(words)}")
words = completed("strut: 1\nmembers:\n  ab:\n    kind: |\n")
check({"bar", "spring", "cable"} <= set(words), f"kinds: {sorted(words)}")
keys = completed("strut: 1\ncontrollers:\n  a:\n    kind: relay\n    |\n")
check("on_above" in keys and "gain" not in keys, f"keys of a relay: {sorted(keys)}")

# Hover: meaning, unit, default.
text = hovered("strut: 1\nmembers:\n  ab:\n    stiff|ness: 3\n")
check("Force per elongation" in text and "N/m" in text and "Default: `0`" in text, f"hover of stiffness: {text}")
text = hovered("strut: 1\nsolver:\n  integra|tor: rk4\n")
check("Time integration method" in text and "Default: `rk4`" in text, f"hover of integrator: {text}")
text = hovered("strut: 1\ngrou|nd: {stiffness: 3}\n")
check("line that nodes may touch" in text, f"hover of ground: {text}")


# Errors: place and message.
def one(text, line, part, message):
    found = document(text)[3]
    check(len(found) == 1 and found[0][0] == line + 1 and found[0][1] == part and re.search(message, found[0][2]),
          f"{text!r}: {found}, expected {(line + 1, part, message)}")


one("strut: 1\nmembers:\n  ab: {nodes: [a, b], stifness: 3}\n", 3, "stifness", "stifness is not allowed")
one("strut: 1\nnodez: {}\n", 2, "nodez", "nodez is not allowed")
one("strut: 1\nnodes:\n  a: [0, 1, 2]\n", 3, "[0, 1, 2]", "too many")
one("strut: 1\nnodes:\n  a: {position: [0, 1], masss: 2}\n", 3, "masss", "masss is not allowed")
one("strut: 1\nnodes:\n  a: {position: 3}\n", 3, "3", "array")
one("strut: 1\nmembers:\n  ab: {kind: rod}\n", 3, "rod", '"bar".*"spring".*"cable"')
one("strut: 1\nmembers: [ab]\n", 2, "[ab]", "object")
one("strut: 1\nmembers:\n  ab: {stiffness: [3]}\n", 3, "[3]", "number")
one("strut: 1\nground: 3\n", 2, "3", "ground")
one("strut: 1\nloads: {a: {node: n, force: [0, 1], signal: {sin: {amplitude: 1}}}}\n", 2, "sin", "sin is not allowed")
one("strut: 2\n", 1, "2", "1")
one("strut: 1\ngroups:\n  g: {stiffness: -1}\n", 3, "-1", "minimum")
server.process.kill()
server.process.wait()
shutil.rmtree(work)
print("some expectations failed" if failed() else f"{number} documents, {program}")
os._exit(failed())

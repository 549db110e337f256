/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Writes index.d.ts: index.d.ts.in with what abi.h and the module itself say in place of its lines "@NAME@".
 *
 *   node types.mjs PACKAGE abi.h index.d.ts.in index.d.ts
 */
import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, header, template, types] = process.argv.slice(2);
const strut = await import(pathToFileURL(resolve(folder, "index.js")).href);
await strut.load();
const abi = readFileSync(header, "utf8");

/* The calls that are made alike: X(run) X(equilibria) ... */
const calls = Array.from(/#define STRUTLIB_CALLS\(X\) (.*)/.exec(abi)[1].matchAll(/X\((\w+)\)/g), (found) => found[1]);
if (calls.join() !== strut.CALLS.join()) throw new Error("index.js has other calls than abi.h: " + calls);

/* #define STRUTLIB_OK 0, with a comment or without. */
const statuses = Array.from(
  abi.matchAll(/#define STRUTLIB_([A-Z_]+) (\d+)(?: +\/\* (.*) \*\/)?\n/g),
  ([, name, number]) => ({ name, number: Number(number) }))
  .filter(({ name, number }) => !["DIMENSIONS", "ABI_VERSION"].includes(name) && number < 100);

const capital = (word) => word[0].toUpperCase() + word.slice(1);
const quoted = (word) => (/^[a-z_]\w*$/i.test(word) ? word : JSON.stringify(word));
const union = (words) => words.map((word) => "\n  | " + JSON.stringify(word)).join("");
const comment = (text, indent) => indent + "/** " + text.replaceAll("*/", "* /") + " */\n";

function optionsOf(call, extra = "") {
  const fields = Object.entries(strut.optionsOf(call)).map(([name, help]) =>
    comment(capital(help) + ".", "  ") + "  " + quoted(name) + "?: Value;\n").join("");
  return "/** Options of " + call + ", as the program has them. */\nexport interface " + capital(call) + "Options {\n" +
    fields + extra + "}\n";
}

const KEEP = comment("Columns to keep, as a study's `keep`; none: the usual ones.", "  ") + "  keep?: string[];\n";

const parts = {
  STATUSES: "/** Statuses of abi.h, and -1: the engine failed, and load() starts another. */\nexport type Status = -1" +
    statuses.map(({ number }) => " | " + number).join("") + ";\n" +
    "/** A status as a word. */\nexport type StatusName =" +
    union(statuses.map(({ number }) => strut.statusName(number))) + ";\n",
  CHANNELS: "/** What a run can record. */\nexport type Channel =" + union(strut.channels().map(({ name }) => name)) + ";\n",
  CALLS: "/** The calls that are made alike. */\nexport type Call =" + union(calls) + ";\n",
  OPTIONS: [...calls, "simulate"].map((call) => optionsOf(call)).join("\n") + "\n" + optionsOf("sweep", KEEP),
  METHODS: calls.map((call) =>
    comment("The call `" + call + "`; a result that is not whole has its error.", "  ") +
    "  " + call + "(options?: " + capital(call) + "Options, control?: Control): Result;\n").join("")
};

writeFileSync(types, readFileSync(template, "utf8").replace(/^ *@([A-Z]+)@\n/gm, (_, name) => parts[name]));

/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The module has the program's bits: the JSON of each call on each model is the program's, byte for byte, but for
 * wall_time; a failure has the program's message; matrices and sweeps have the program's tables.
 *
 *   node tests/web/bits_test.mjs build/web/package build/tests/strut [WORD]
 *
 * WORD: only models whose path has it.
 */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { DIFFERENT, SLOW } from "./bits_known.mjs";

const [packageFolder, program, word = ""] = process.argv.slice(2);
const { load, open } = await import(pathToFileURL(resolve(packageFolder, "index.js")).href);
await load();

const CALLS = ["run", "equilibria", "modes", "rigidity", "path", "form"];
const isStudy = (text) => /^(model|axes|search):/m.test(text);

function models() {
  return readdirSync("models", { recursive: true }).map((name) => join("models", name))
    .filter((path) => path.endsWith(".yaml") && path.includes(word) && !isStudy(readFileSync(path, "utf8"))).sort();
}

/* The other files of its folder: bases, networks. */
function filesBeside(path) {
  const folder = dirname(path), names = readdirSync(folder).filter((name) => /\.(yaml|csv)$/.test(name));
  return Object.fromEntries(names.map((name) => [name, readFileSync(join(folder, name), "utf8")]));
}

/* {text, failure}: its JSON, and the lines of its message where it failed; of some failures there is both. */
function byProgram(call, path) {
  const found = spawnSync(resolve(program), [call, basename(path), "--json"], {
    cwd: dirname(path), encoding: "utf8", maxBuffer: 1 << 30, timeout: 120000
  });
  return {
    text: found.stdout.replace(/\n\t*"wall_time":[^\n]*/, ""),
    failure: found.stderr.replace(/^strut: /gm, "").split("\n").filter((line) => !line.startsWith("warning"))
  };
}

function byModule(call, scene) {
  try {
    const result = scene[call]();
    try {
      return { text: result.jsonText };
    } finally {
      result.close();
    }
  } catch (error) {
    return { failure: error.report.split("\n") };
  }
}

/* The first lines in which the module's answer differs from the program's, or null. */
function difference(mine, theirs) {
  const [a, b] = mine.failure ? [mine.failure, theirs.failure] : [mine.text.split("\n"), theirs.text.split("\n")];
  const at = a.findIndex((line, i) => line !== b[i]);
  if (at < 0 && a.length === b.length) return null;
  const line = at < 0 ? a.length : at;
  return { program: (b[line] ?? "").trim(), module: (a[line] ?? "").trim() };
}

let same = 0;
const wrong = [], known = [];

async function compareModel(path) {
  const options = { name: basename(path), files: filesBeside(path) }, text = readFileSync(path, "utf8");
  for (const call of CALLS) {
    const name = call + " " + path.slice("models/".length);
    if (SLOW.has(name)) continue;
    let mine;
    try {
      const scene = await open(text, options);
      mine = byModule(call, scene);
      scene.close();
    } catch (error) {
      mine = { failure: error.report.split("\n") };
    }
    const found = difference(mine, byProgram(call, path));
    if (!found && DIFFERENT.has(name)) wrong.push({ name, program: "the same", module: "the same" });
    else if (!found) same++;
    else (DIFFERENT.has(name) ? known : wrong).push({ name, ...found });
  }
}

/* A study of the crawler's friction over a few periods, by both: the same table. */
async function compareSweep() {
  const folder = mkdtempSync(join(tmpdir(), "strut-bits-"));
  const frictions = [0.1, 0.2, 0.3];
  try {
    writeFileSync(join(folder, "crawler.yaml"), readFileSync("models/crawler/crawler.yaml"));
    writeFileSync(join(folder, "study.yaml"),
      "strut: 1\nstudy: friction\nmodel: crawler.yaml\naxes: [{friction: [" + frictions.join(", ") + "]}]\n" +
      "keep: [velocity, outcome]\n");
    const ran = spawnSync(resolve(program), ["sweep", "study.yaml", "--accuracy", "2%", "-o", "out"],
      { cwd: folder, encoding: "utf8" });
    assert.equal(ran.status, 0, ran.stderr);
    const scene = await open(readFileSync("models/crawler/crawler.yaml", "utf8"), { name: "crawler.yaml" });
    const swept = scene.sweep(["friction"], frictions.map((friction) => [friction]),
      { keep: ["velocity", "outcome"], accuracy: "2%" });
    const table = readFileSync(join(folder, "out/table.csv"), "utf8");
    if (swept.table === table) same++;
    else wrong.push({ name: "sweep", program: table, module: swept.table });
  } finally {
    rmSync(folder, { recursive: true });
  }
}

for (const path of models()) await compareModel(path);
if (!word) await compareSweep();
for (const { name, program: theirs, module: mine } of known)
  console.log("known: " + name + "\n  program " + theirs + "\n  module  " + mine);
for (const { name, program: theirs, module: mine } of wrong)
  console.log("DIFFERENT: " + name + "\n  program " + theirs + "\n  module  " + mine);
console.log(same + " the same, " + known.length + " known to differ, " + wrong.length + " wrong");
process.exitCode = wrong.length ? 1 : 0;

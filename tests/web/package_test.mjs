/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The npm package strut-wasm: what it holds, its types, its functions, its errors, its memory, and hostile input.
 *
 *   node tests/web/package_test.mjs build/web/package [TYPESCRIPT]
 *
 * TYPESCRIPT: the folder of npm's typescript; without it the types are not compiled.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";

const [folder, typescript] = process.argv.slice(2).map((path) => resolve(path));
const strut = await import(pathToFileURL(join(folder, "index.js")).href);
const { module } = await import(pathToFileURL(join(folder, "memory.js")).href);
const { open, StrutError } = strut;

const SPRING = `strut: 1
nodes: {wall: {position: [0, 0], fixed: both}, tip: {position: [0.1, 0], mass: 0.1}}
members: {spring: {nodes: [wall, tip], kind: spring, stiffness: 100, rest_length: rest}}
parameters: {rest: 80 mm}
solver: {step: 1 ms}
run: {duration: 0.1 s}
`;
const CRAWLER = readFileSync("models/crawler/crawler.yaml", "utf8");

/* The StrutError that work throws, with this status. */
function failure(status, work) {
  let found = null;
  try {
    work();
  } catch (error) {
    found = error;
  }
  assert.ok(found instanceof StrutError, "threw " + found);
  assert.equal(found.status, status, found.message);
  return found;
}

async function opening(status, ...given) {
  let found = null;
  await open(...given).catch((error) => { found = error; });
  assert.ok(found instanceof StrutError, "threw " + found);
  assert.equal(found.status, status, found.message);
  return found;
}

/* ---- the package ---- */

test("the module is at most 730 kB when it is loaded", () => {
  const size = gzipSync(readFileSync(join(folder, "strut.wasm")), { level: 9 }).length;
  assert.ok(size <= 730000, size + " bytes gzipped");
});

test("npm packs the files that it names, and the tarball works in an empty folder", () => {
  const empty = mkdtempSync(join(tmpdir(), "strut-npm-"));
  const npm = (...words) => execFileSync("npm", words, { cwd: empty, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
  try {
    const [packed] = JSON.parse(npm("pack", folder, "--json"));
    assert.deepEqual(packed.files.map(({ path }) => path).sort(), [
      "LICENSE", "README.md", "THIRD_PARTY.md", "index.d.ts", "index.js", "memory.js", "package.json", "strut.mjs",
      "strut.wasm"
    ]);
    writeFileSync(join(empty, "package.json"), "{}");
    npm("install", "--offline", "--no-audit", "--no-fund", "./" + packed.filename);
    writeFileSync(join(empty, "use.mjs"), 'import { open } from "strut-wasm";\n' +
      "const scene = await open(" + JSON.stringify(SPRING) + ");\nconsole.log(scene.run().status);\n");
    assert.equal(execFileSync("node", ["use.mjs"], { cwd: empty, encoding: "utf8" }), "0\n");
  } finally {
    rmSync(empty, { recursive: true });
  }
});

test("the types are those that the module has, and a strict program compiles", { skip: !existsSync(typescript || "") },
  () => {
    const sample = mkdtempSync(join(tmpdir(), "strut-types-"));
    const compile = (text) => {
      writeFileSync(join(sample, "sample.mts"), text);
      execFileSync("node", [join(typescript, "lib/tsc.js"), "--noEmit", "--strict", "--target", "esnext", "--module",
        "nodenext", "sample.mts"], { cwd: sample, encoding: "utf8" });
    };
    const from = JSON.stringify(join(folder, "index.js"));
    const head = "import { open, StrutError, type Result } from " + from + ";\nconst s = await open('');\n";
    try {
      compile(head + "const r: Result = s.run({ accuracy: '0.5 %', channels: ['position'] }, { limit: 1 });\n" +
        "const x: number = r.array('position')!.data[0]! + r.number('velocity')!;\n" +
        "s.sweep(['f'], [[1], ['2 Hz']], { keep: ['velocity'] }, { row: (point) => point > 3 });\n" +
        "const m = s.simulate({ 'friction-law': 'karnopp' }).advance(3).set('load', 'n1.x', x);\n" +
        "m.restore(m.snapshot());\ntry { s.path({ over: 'f' }); } catch (e) { if (e instanceof StrutError) e.messages[0]?.line; }\n");
      for (const wrong of ["s.run({ acuracy: 1 });", "s.simulate().set('lod', 'n1.x', 1);", "s.nothing();"])
        assert.throws(() => compile(head + wrong), undefined, wrong);
    } finally {
      rmSync(sample, { recursive: true });
    }
  });

/* ---- what it does ---- */

test("scenes", async () => {
  const scene = await open(SPRING, { name: "spring.yaml" });
  assert.deepEqual(scene.names("nodes"), ["wall", "tip"]);
  assert.equal(scene.index("nodes", "tip"), 1);
  assert.equal(scene.index("nodes", "nobody"), -1);
  assert.equal(scene.number("parameters.rest"), 0.08);
  assert.equal(scene.with({ rest: "90 mm" }).number("parameters.rest"), 0.09);
  assert.equal(scene.with({ rest: 0.1 + 0.2 }).number("parameters.rest"), 0.1 + 0.2);
  assert.equal(scene.number("nothing"), null);
  assert.deepEqual(scene.array("nodes.position"), { data: Float64Array.of(0, 0, 0.1, 0), shape: [2, 2] });
  assert.equal(scene.json().members.spring.stiffness, 100);
  assert.match(scene.yaml({ parts: true }), /rest/);
  assert.equal(JSON.parse(scene.pageData()).nodes.length > 0, true);
});

test("calls, with options, progress and a limit", async () => {
  const scene = await open(CRAWLER, { name: "crawler.yaml" });
  const heard = [];
  const result = scene.run({ accuracy: "0.5 %", channels: ["position"] }, { progress: (f) => { heard.push(f); } });
  assert.equal(result.error, null);
  assert.equal(result.command, "run");
  assert.equal(result.json.velocity, result.number("velocity"));
  assert.ok(heard.every((fraction) => fraction >= 0 && fraction <= 1));
  assert.deepEqual(result.arrays.includes("position"), true);
  assert.equal(result.unit("position"), "m");
  const stopped = scene.run({}, { limit: 0.05 });
  assert.equal(stopped.status, 10);
  assert.equal(stopped.error.status, 10);
  assert.throws(() => scene.run({}, { progress() { throw new Error("mine"); } }), /mine/);
  assert.equal(scene.modes({ at: "drawn" }).array("modes.shape").shape[1], scene.names("nodes").length);
});

test("sweeps tell of their rows", async () => {
  const scene = await open(SPRING), rows = [];
  const swept = scene.sweep(["rest"], [[0.07], [0.09]], { keep: ["outcome"] }, { row: (...row) => { rows.push(row); } });
  assert.deepEqual(rows, [[0, 0], [1, 0]]);
  assert.deepEqual(Array.from(swept.array("rest").data), [0.07, 0.09]);
  assert.equal(swept.cell("status", 2), null);
  assert.equal(scene.sweep(["rest"], [[0.07], [0.08], [0.09]], {}, { row: () => true }).status, 10);
});

test("a simulation has the bits of a run, and inputs", async () => {
  const scene = await open(SPRING), run = scene.run(), simulation = scene.simulate();
  simulation.advance(40).advance(60);
  const last = run.array("position"), now = simulation.array("position");
  assert.deepEqual(Array.from(now.data), Array.from(last.data.slice(-4)));
  const before = simulation.snapshot();
  simulation.write("load", [0, 0, 3, 0]).set("load", "tip.y", 1);
  assert.deepEqual(Array.from(simulation.input("load").data), [0, 0, 3, 1]);
  const there = Array.from(simulation.advance(10).array("position").data);
  simulation.restore(before).write("load", [0, 0, 3, 1]).advance(10);
  assert.deepEqual(Array.from(simulation.array("position").data), there);
  assert.notEqual(simulation.set("rest", "spring", 0.07).advance().inputWork, 0);
  failure(1, () => simulation.write("load", [1]));
  failure(1, () => simulation.write("lod", [1]));
  failure(1, () => simulation.set("rest", "spring", NaN).advance());
});

for (const page of ["docs/javascript.md", "parser/bindings/web/package/README.md"])
  test("the blocks of " + page + " run, one after the other", () => {
    const blocks = Array.from(readFileSync(page, "utf8").matchAll(/^```js\n(.*?)^```$/gms), ([, block]) => block);
    const address = JSON.stringify(pathToFileURL(join(folder, "index.js")).href);
    const text = blocks.join("").replaceAll('"strut-wasm"', address);
    assert.notEqual(execFileSync("node", ["--input-type=module"], { input: text, encoding: "utf8" }), "");
  });

/* ---- errors ---- */

test("a scene's mistakes have their places", async () => {
  const error = await opening(2, SPRING.replace("stiffness", "stifness"), { name: "spring.yaml" });
  assert.deepEqual([error.messages[0].line, error.messages[0].hint], [3, "stiffness"]);
  assert.match(error.report, /spring\.yaml:3:/);
});

test("wrong use", async () => {
  const scene = await open(SPRING);
  failure(1, () => scene.run({ acuracy: 1 }));
  failure(1, () => scene.run({ accuracy: {} }));
  failure(1, () => scene.run("fast"));
  failure(1, () => scene.run({ accuracy: "0.5 %\0" }));
  failure(1, () => scene.sweep(["rest"], [[1, 2]]));
  failure(1, () => scene.sweep("rest", [1]));
  failure(1, () => scene.names(7));
  failure(1, () => scene.simulate().advance(1.5));
  failure(1, () => scene.simulate().restore(scene));
  failure(1, () => scene.svg()); /* figures are not there */
  failure(1, () => scene.run().svg());
  scene.close();
  scene.close();
  failure(1, () => scene.names("nodes"));
  for (const text of [undefined, null, 7, {}, []]) await opening(1, text);
});

/* ---- memory and hostile input ---- */

test("2,000 scenes and results that are closed leave no memory behind", async () => {
  const round = async () => {
    const scene = await open(SPRING, { files: { "a/b.csv": "1" } }), result = scene.run(), simulation = scene.simulate();
    const snapshot = simulation.snapshot();
    result.array("position");
    for (const owner of [snapshot, simulation, result, scene]) owner.close();
  };
  for (let i = 0; i < 20; i++) await round();
  const before = module().HEAPU8.length;
  for (let i = 0; i < 2000; i++) await round();
  assert.equal(module().HEAPU8.length, before);
  assert.deepEqual(module().FS.readdir("/scenes"), [".", ".."]);
});

test("hostile texts are errors", async () => {
  const nested = "[".repeat(100000);
  for (const text of ["", "\0", SPRING + "\0", "\ud800", "strut: 1\nnodes: \udfff\ud800", nested, "{".repeat(100000),
    "strut: 1\nnodes: " + nested, "&a [*a]", "strut: 1\nnodes: {a: [1e999, 0]}", "x".repeat(10_000_000),
    "- ".repeat(500000)])
    await opening(2, text);
  await opening(2, SPRING, { settings: { "\ud800": 1 } });
  await opening(8, SPRING, { files: { "a": "1", "a/b": "2" } });
  assert.equal((await open(SPRING, { name: "</script><b>" })).run().status, 0);
});

test("100,000 nodes are opened", async () => {
  const nodes = Array.from({ length: 100000 }, (_, i) => "n" + i + ": [" + i + ", 0]");
  const members = nodes.slice(1).map((_, i) => "m" + i + ": {nodes: [n" + i + ", n" + (i + 1) + "], kind: bar, mass: 1, stiffness: 1}");
  const scene = await open("strut: 1\nnodes: {" + nodes.join(", ") + "}\nmembers: {" + members.join(", ") + "}\n");
  assert.equal(scene.names("nodes").length, 100000);
  scene.close();
});

test("out of memory is status 9, and the module works on", async () => {
  const scene = await open(SPRING), wide = scene.with({ rest: 0.09 });
  const blocks = [], engine = module();
  for (let size = 1 << 30; size >= 1024; size >>= 1)
    for (let block; (block = engine._malloc(size));) blocks.push(block);
  await opening(9, SPRING);
  failure(9, () => scene.run());
  for (const block of blocks) engine._free(block);
  assert.equal(scene.run().status, 0);
  assert.equal(wide.run().status, 0);
});

test("a trap is told, and load() starts another engine", async () => {
  const scene = await open(SPRING);
  const error = failure(-1, () => module()._strutlib_result_status(-16)); /* a wild pointer, as no caller has it */
  assert.match(error.message, /load\(\)/);
  assert.throws(() => scene.names("nodes"), error);
  assert.throws(() => strut.version(), error);
  assert.equal((await open(SPRING)).run().status, 0);
  assert.throws(() => scene.names("nodes"), error);
  scene.close();
});

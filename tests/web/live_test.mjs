/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a person does on a live page, in headless Chromium: node live_test.mjs STRUT STRUT_LIVE_JS [PICTURES].
 * PICTURES: a folder that receives screenshots. The exit code is 0 if everything holds.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const [program, script, pictures] = process.argv.slice(2).map((path) => resolve(path));
const models = join(dirname(fileURLToPath(import.meta.url)), "../../models");
const crawler = join(models, "crawler/crawler.yaml");
const folder = mkdtempSync(join(tmpdir(), "strut-live-"));
const LONG = 120000;
const tests = [], wanted = process.env.ONLY;
const test = (name, run) => tests.push({ name, run });

/* ---- what strut writes ---- */

function strut(...given) {
  return execFileSync(program, given, { cwd: folder, encoding: "utf8",
    env: { ...process.env, STRUT_LIVE_SCRIPT: script } });
}

const summaryOf = (run) => JSON.parse(readFileSync(join(folder, run, "summary.json"), "utf8"));

function writePages() {
  strut("run", crawler, "--accuracy", "0.5%", "-o", "crawler", "-q");
  strut("view", "crawler", "--live", "-o", "crawler.html", "-q");
  const text = readFileSync(crawler, "utf8").replace("periods: 1100", "periods: 20")
    .replace("last: 100}}", "last: 5}}");
  writeFileSync(join(folder, "short.yaml"), text);
  strut("run", "short.yaml", "--set", "friction=0.12", "-o", "short", "-q");
  strut("view", "short", "--live", "-o", "short.html", "-q");
  strut("view", crawler, "--live", "-o", "model.html", "-q");
  writeFileSync(join(folder, "long.yaml"), text.replace("step: 0.1 ms", "step: 1 us")
    .replace("name: Nine-member", "name: </script><b id=injected>"));
  strut("view", "long.yaml", "--live", "--equilibria", "none", "-o", "hostile.html", "-q");
}

/* ---- a page, watched ---- */

async function openPage(browser, name, { width = 1280, height = 1000, dark = false } = {}) {
  const context = await browser.createBrowserContext(), page = await context.newPage(), faults = [];
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }]);
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) faults.push("console: " + message.text());
  });
  page.on("pageerror", (error) => faults.push("error: " + error.message));
  page.on("request", (request) => {
    if (!/^(file|blob|data):/.test(request.url())) faults.push("request: " + request.url());
  });
  await page.goto(pathToFileURL(join(folder, name)).href);
  await page.waitForFunction(() => window.strutLive, { timeout: LONG });
  return { page, context, faults };
}

/** Sets a control as a person does: by its value and its event. */
const set = (page, label, kind, value) => page.evaluate((l, k, v) => {
  const control = document.querySelector(`#live ${k}[aria-label="${l}"]`);
  control.value = v;
  control.dispatchEvent(new Event(k === "input[type=range]" ? "input" : "change"));
}, label, kind, value);

async function idle(page) {
  await page.waitForFunction(() => !window.strutLive.busy, { timeout: LONG });
  await page.evaluate(() => window.strut.ready);
}

const textOf = (page, selector) => page.$eval(selector, (e) => e.textContent);
const velocityRow = (page) => page.$$eval("#summary tr", (rows) => rows
  .map((row) => [...row.cells].map((cell) => cell.textContent))
  .find((cells) => cells[0].startsWith("mean velocity")));

async function picture(page, name) {
  if (pictures) await page.screenshot({ path: join(pictures, name + ".png"), fullPage: true });
}

async function fits(page) {
  const [inside, outside] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
  assert.ok(inside <= outside, `the page is ${inside} px wide on ${outside}`);
}

/* ---- the tests ---- */

for (const width of [1280, 400])
  test(`moving a slider changes velocity and motion, ${width} px`, async (browser) => {
    const { page, context, faults } = await openPage(browser, "crawler.html", { width, dark: width === 400 });
    await fits(page);
    const before = await velocityRow(page), places = await page.evaluate(() => {
      window.strut.seek(50);
      return window.strut.positions();
    });
    await set(page, "friction", "input[type=range]", "100");
    await idle(page);
    assert.equal(await textOf(page, "#live-trouble"), "");
    const after = await velocityRow(page);
    assert.equal(after[3], before[1], "the original is in the second column");
    assert.notEqual(after[1], before[1]);
    const moved = await page.evaluate(() => ({ places: window.strut.positions(), ghost: window.strut.ghost() }));
    assert.notDeepEqual(moved.places, places);
    assert.equal(moved.ghost.length, places.length);
    assert.match(await textOf(page, "#live-status"), /accuracy: right within .*%.*computed in/);
    assert.match(await textOf(page, "#beside"), /original/);
    await fits(page);
    await picture(page, "live-" + width);
    await page.evaluate(() => {
      [...document.querySelectorAll("#live-buttons button")].find((b) => b.textContent === "Reset").click();
    });
    await idle(page);
    assert.deepEqual(await velocityRow(page), before);
    assert.equal(await page.evaluate(() => window.strut.ghost()), null);
    assert.deepEqual(faults, []);
    await context.close();
  });

test("the answer of the crawler at 0.5 % follows the slider", async (browser) => {
  const { page, context, faults } = await openPage(browser, "crawler.html");
  for (let at = 20; at <= 140; at += 20) {
    await set(page, "friction", "input[type=range]", String(at));
    await idle(page);
  }
  const times = await page.evaluate(() => window.strutLive.times);
  assert.equal(times.length, 7);
  console.log("  from slider to picture [ms]: " + times.map((t) => t.toFixed(0)).join(" ") + "; page: " +
    (1e-6 * statSync(join(folder, "crawler.html")).size).toFixed(2) + " MB");
  assert.deepEqual(faults, []);
  await context.close();
});

test("fast moves of a slider end at the last one", async (browser) => {
  const { page, context, faults } = await openPage(browser, "crawler.html");
  for (let at = 1; at <= 60; at++) await set(page, "friction", "input[type=range]", String(at));
  await idle(page);
  const field = await page.$eval('#live input[type=text][aria-label^="friction"]', (e) => e.value);
  assert.equal(await page.$eval("#parameters tr:nth-child(4) td:nth-child(2)", (e) => e.textContent), field);
  assert.equal(await textOf(page, "#live-trouble"), "");
  assert.deepEqual(faults, []);
  await context.close();
});

test("nothing moved: the same bits as the run", async (browser) => {
  const { page, context } = await openPage(browser, "short.html");
  const { json } = await page.evaluate(() => window.strutLive.ask({}));
  const run = summaryOf("short");
  assert.equal(json.method, run.method);
  assert.equal(json.steps, run.steps);
  assert.equal(json.velocity, run.velocity);
  assert.deepEqual(json.nodes, run.nodes);
  await context.close();
});

test("the run's accuracy is asked again, and moved settings are as by --set", async (browser) => {
  const { page, context } = await openPage(browser, "crawler.html");
  const { json } = await page.evaluate(() => window.strutLive.ask({ friction: "0.2" }));
  const native = JSON.parse(strut("run", crawler, "--accuracy", "0.5%", "--set", "friction=0.2", "--json"));
  assert.equal(json.accuracy.wanted, 0.005);
  assert.ok(Math.abs(json.velocity / native.velocity - 1) < 0.01, `${json.velocity} ${native.velocity}`);
  await context.close();
});

test("a long run is stopped, a wrong value is refused, and the last result stays", async (browser) => {
  const { page, context, faults } = await openPage(browser, "short.html");
  await set(page, "friction", "input[type=range]", "50");
  await idle(page);
  const good = await velocityRow(page);
  await set(page, "step in ms", "input[type=text]", "0.0001");
  await page.waitForFunction(() => window.strutLive.busy && document.querySelector("#live progress").value > 0,
    { timeout: LONG });
  await page.evaluate(() => {
    [...document.querySelectorAll("#live-buttons button")].find((b) => b.textContent === "Stop").click();
  });
  await idle(page);
  assert.match(await textOf(page, "#live-status"), /Stopped/);
  assert.deepEqual(await velocityRow(page), good);
  await set(page, "step in ms", "input[type=text]", "abc");
  await idle(page);
  assert.match(await textOf(page, "#live-trouble"), /last result is still shown/);
  assert.deepEqual(await velocityRow(page), good);
  await set(page, "step in ms", "input[type=text]", "0.1");
  await idle(page);
  assert.equal(await textOf(page, "#live-trouble"), "");
  assert.deepEqual(faults, []);
  await context.close();
});

for (const width of [1280, 400])
  test(`a model: another configuration, other equilibria, ${width} px`, async (browser) => {
    const { page, context, faults } = await openPage(browser, "model.html", { width });
    const places = await page.evaluate(() => window.strut.positions());
    await set(page, "start", "select", "II");
    await idle(page);
    assert.equal(await textOf(page, "#live-trouble"), "");
    assert.match(await textOf(page, "#live-status"), /equilibria: \d+ \(before: \d+\)/);
    assert.ok((await page.$$("#cards .card")).length > 1);
    const now = await page.evaluate(() => window.strut.positions());
    assert.ok(Math.abs(now[1] - places[1]) > 0.02, "state II has n1 high up");
    await fits(page);
    await picture(page, "live-model-" + width);
    assert.deepEqual(faults, []);
    await context.close();
  });

test("a hostile name stays text, the policy strict", async (browser) => {
  const { page, context, faults } = await openPage(browser, "hostile.html");
  await set(page, "start", "select", "II");
  await idle(page);
  assert.equal(await page.$("#injected"), null);
  assert.match(await textOf(page, "#name"), /<\/script><b id=injected>/);
  assert.deepEqual(faults, []);
  const policy = await page.$eval("meta[http-equiv]", (e) => e.content);
  assert.doesNotMatch(policy, /'unsafe-eval'|https?:/);
  await context.close();
});

/* ---- one after the other ---- */

if (pictures) mkdirSync(pictures, { recursive: true });
writePages();
const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox"], protocolTimeout: 2 * LONG });
let failures = 0;
for (const { name, run } of tests) {
  if (wanted && !name.includes(wanted)) continue;
  try {
    await run(browser);
    console.log("ok   " + name);
  } catch (error) {
    failures++;
    console.log("FAIL " + name + "\n" + error.stack);
  }
}
await browser.close();
rmSync(folder, { recursive: true });
process.exitCode = failures ? 1 : 0;

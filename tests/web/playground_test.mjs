/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a person does on the playground, in headless Chromium: node playground_test.mjs PLAYGROUND.html [PICTURES].
 * PICTURES: a folder that receives screenshots. The exit code is 0 if everything holds.
 */
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const [file, pictures] = process.argv.slice(2);
const address = pathToFileURL(resolve(file)).href, LONG = 60000;
const tests = [], wanted = process.env.ONLY;
const test = (name, run, options = {}) => tests.push({ name, run, options });

/* ---- a page, watched ---- */

async function openPage(browser, { hash = "", width = 1280, height = 900, dark = false, files = null }) {
  const context = await browser.createBrowserContext(), page = await context.newPage(), faults = [];
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" },
    { name: "prefers-reduced-motion", value: "reduce" }]);
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) faults.push("console: " + message.text());
  });
  page.on("pageerror", (error) => faults.push("error: " + error.message));
  await page.setRequestInterception(true);
  page.on("request", (request) => {
    const good = /^(file|blob|data):/.test(request.url());
    if (!good) faults.push("request: " + request.url());
    if (good) request.continue();
    else request.abort();
  });
  await page.goto(address + hash);
  await idle(page);
  if (files) await drop(page, files);
  return { page, context, faults };
}

/** Waits until a scene is open and nothing is computed. */
async function idle(page) {
  await page.waitForFunction(() => document.getElementById("file-name").textContent && !window.strutPlayground.busy, { timeout: LONG });
  await page.evaluate(() => window.strut.ready);
}

const textOf = (page, selector) => page.$eval(selector, (e) => e.textContent);
const scene = (page) => page.evaluate(() => window.strutPlayground.editor.text);
const velocity = (page) => page.evaluate(() =>
  (window.strut.data.summary.find((row) => row.label.startsWith("mean velocity")) || {}).value);

async function pick(page, model) {
  await page.$eval(`[data-model="${model}"]`, (button) => button.click());
  await idle(page);
}

/** Replaces the text as a person who types would: with the editor's events. */
async function rewrite(page, from, to) {
  await page.evaluate((a, b) => {
    const { view } = window.strutPlayground.editor, at = view.state.doc.toString().indexOf(a);
    if (at < 0) throw new Error("the text lacks " + a);
    view.dispatch({ changes: { from: at, to: at + a.length, insert: b }, selection: { anchor: at + b.length } });
    view.focus();
  }, from, to);
  await new Promise((done) => { setTimeout(done, 400); });
  await idle(page);
}

async function slide(page, name, place) {
  await page.$eval(`input[type=range][aria-label="${name}"]`, (slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }, place);
  await idle(page);
}

async function drop(page, files) {
  await page.evaluate((given) => {
    const transfer = new DataTransfer();
    for (const [name, text] of Object.entries(given)) transfer.items.add(new File([text], name));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, files);
  await new Promise((done) => { setTimeout(done, 200); });
  await idle(page);
}

const fragmentOf = (page, state) => page.evaluate(async (given) => {
  const stream = new Blob([JSON.stringify(given)]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return "#s=" + btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}, state);

async function photograph(page, name) {
  if (pictures) await page.screenshot({ path: join(pictures, name + ".png") });
}

/* ---- what a person does ---- */

test("starts with the crawler, moving", async ({ page, browser }) => {
  const times = [];
  for (let i = 0; i < 5; i++) {
    const other = await openPage(browser, {});
    times.push(await other.page.evaluate(() => performance.getEntriesByName("strut-first-picture")[0].startTime));
    await other.context.close();
  }
  times.sort((a, b) => a - b);
  console.log("  first picture after " + times.map(Math.round).join(", ") + " ms");
  assert.match(await velocity(page), /^10\.03 mm\/s/);
  assert.ok(await page.evaluate(() => window.strut.frames) > 100);
  assert.match(await textOf(page, "#status"), /accurate to within .* %/);
  await photograph(page, "start");
});

test("picks a model", async ({ page }) => {
  await pick(page, "basics/pendulum.yaml");
  assert.match(await scene(page), /name: Pinned rod/);
  assert.equal(await page.$eval('[data-model="basics/pendulum.yaml"]', (b) => b.getAttribute("aria-pressed")), "true");
  assert.ok(await page.evaluate(() => window.strut.frames) > 1);
  await photograph(page, "pendulum");
});

test("shows the message for a mistyped key at its line", async ({ page }) => {
  await rewrite(page, "gravity:", "gravty:");
  const line = (await scene(page)).split("\n").findIndex((text) => text.startsWith("gravty:"));
  const note = await textOf(page, ".code-note");
  assert.match(note, /gravty/);
  const before = await page.$eval(".code-note", (n) => n.previousElementSibling.textContent);
  assert.equal(before, (await scene(page)).split("\n")[line]);
  assert.ok(await page.$(".cm-lintRange-error"));
  assert.match(await velocity(page), /^10\.03 mm\/s/, "the last good result stays");
  assert.ok(await page.$eval("#old-mark", (mark) => !mark.hidden));
  await photograph(page, "mistyped");
  await rewrite(page, "gravty:", "gravity:");
  assert.equal(await page.$(".code-note"), null);
});

test("completes keys and explains them", async ({ page }) => {
  await rewrite(page, "gravity:", "gravity: [0, -9.81]\nrayleigh: {ma}\ngravity_:");
  await page.evaluate(() => {
    const { view } = window.strutPlayground.editor, at = view.state.doc.toString().indexOf("{ma}") + 3;
    view.dispatch({ selection: { anchor: at } });
    view.focus();
  });
  await page.keyboard.type("s");
  await page.waitForSelector(".cm-tooltip-autocomplete", { timeout: 3000 });
  assert.match(await textOf(page, ".cm-tooltip-autocomplete"), /mass/);
  await page.keyboard.press("Escape");
  const at = await page.evaluate(() => {
    const { view } = window.strutPlayground.editor, offset = view.state.doc.toString().indexOf("stiffness: 1e6");
    view.dispatch({ selection: { anchor: offset }, scrollIntoView: true });
    const box = view.coordsAtPos(offset + 3);
    return { x: box.left, y: (box.top + box.bottom) / 2 };
  });
  await page.mouse.move(at.x, at.y);
  await page.mouse.move(at.x + 2, at.y);
  await page.waitForSelector(".code-help", { timeout: 3000 });
  assert.match(await textOf(page, ".code-help"), /Force per elongation.*N\/m/s);
});

test("a slider changes velocity and motion", async ({ page }) => {
  const motion = () => page.evaluate(() => {
    window.strut.seek(50);
    return window.strut.positions();
  });
  const before = [await velocity(page), await motion()];
  await slide(page, "friction", 700);
  const times = [];
  for (let place = 560; place < 700; place += 20) {
    await slide(page, "friction", place);
    times.push(await page.evaluate(() => 1000 * window.strutPlayground.seconds));
  }
  times.sort((a, b) => a - b);
  console.log("  a slider's answer after " + times.map(Math.round).join(", ") + " ms");
  assert.notEqual(await velocity(page), before[0]);
  assert.notDeepEqual(await motion(), before[1]);
  assert.match(await textOf(page, "#command"), /--set friction=0\.\d+ --accuracy 0\.5%/);
  await photograph(page, "slider");
  const value = await page.evaluate(() => window.strutPlayground.settings.friction);
  await page.click("#write");
  assert.match(await scene(page), new RegExp("friction: " + value.replace(".", "\\.")));
  assert.deepEqual(await page.evaluate(() => window.strutPlayground.settings), {});
});

test("stops a long run and goes on", async ({ page }) => {
  await rewrite(page, "periods: 1100", "periods: 90000000");
  await page.select("#accuracy", "");
  await page.waitForFunction(() => !document.getElementById("stop").disabled);
  await new Promise((done) => { setTimeout(done, 300); });
  await page.keyboard.press("Escape");
  await idle(page);
  assert.match(await textOf(page, "#status"), /Stopped/);
  await pick(page, "basics/pendulum.yaml");
  assert.ok(await page.evaluate(() => window.strut.frames) > 1);
});

/* The scene by its link in a browser of its own: the same velocity and text. */
async function followLink(page, browser) {
  await page.click("#link");
  await page.waitForFunction(() => document.getElementById("link").dataset.link);
  const link = await page.$eval("#link", (button) => button.dataset.link), result = await velocity(page);
  const other = await openPage(browser, { hash: link.slice(link.indexOf("#")) });
  assert.equal(await velocity(other.page), result);
  assert.equal(await scene(other.page), await scene(page));
  assert.deepEqual(other.faults, []);
  await other.context.close();
}

test("copies a link that a fresh browser opens", async ({ page, browser }) => {
  await slide(page, "friction", 600);
  await followLink(page, browser);
});

test("shows equilibria, and starts from one", async ({ page }) => {
  await page.click("#equilibria");
  await idle(page);
  assert.ok((await page.$$(".card")).length > 3);
  await page.evaluate(() => [...document.querySelectorAll(".card")]
    .find((card) => card.querySelector("b").textContent === "II").click());
  await photograph(page, "equilibria");
  await page.click("#start-here");
  await idle(page);
  assert.deepEqual(await page.evaluate(() => window.strutPlayground.settings), { start: "II" });
  assert.match(await velocity(page), /^-/);
});

test("animates modes", async ({ page }) => {
  await page.click("#modes");
  await idle(page);
  const modes = await page.$$(".mode-list button");
  assert.equal(modes.length, 10);
  await modes[4].click();
  await page.waitForFunction(() => document.getElementById("clock").textContent.startsWith("mode 5"));
  const shapes = await page.evaluate(() => [10, 30].map((frame) => {
    window.strut.seek(frame);
    return window.strut.positions();
  }));
  assert.notDeepEqual(shapes[0], shapes[1]);
  await photograph(page, "modes");
});

test("follows a path with a cursor", async ({ page }) => {
  await pick(page, "gallery/von-mises.yaml");
  await page.click("#path");
  await idle(page);
  assert.ok(await page.$("#over"), "what varies can be chosen where there is no load");
  await rewrite(page, "load: 0 N", "load: 1 N");
  await page.click("#path");
  await idle(page);
  assert.ok((await page.$$(".path-chart polyline")).length >= 3);
  const before = await page.$eval(".path-chart circle", (c) => c.getAttribute("cx"));
  await page.evaluate(() => window.strut.seek(12));
  assert.notEqual(await page.$eval(".path-chart circle", (c) => c.getAttribute("cx")), before);
  assert.match(await textOf(page, "#clock"), /^factor /);
  await photograph(page, "path");
});

test("shows rigidity and form as tables", async ({ page }) => {
  await pick(page, "gallery/von-mises.yaml");
  await page.click("#rigidity");
  await idle(page);
  assert.match(await textOf(page, "#found"), /self-stress/);
  await pick(page, "gallery/x-frame.yaml");
  await page.click("#form");
  await idle(page);
  assert.match(await textOf(page, "#found"), /^Form[^]*force density/);
  assert.match(await textOf(page, "#status"), /^Computed/);
  await photograph(page, "form");
});

/* What a button may answer of some model: that the question does not fit it. */
const REASONS = [/^Stopped/, /no constant load to follow/, /the load (is zero|acts on)/, /neither a duration nor periods/,
  /does not come to rest/, /no free node has mass/, /hold(s)? the (structure|drawn shape)/, /no equilibrium was found/,
  /form finding by \w+ knows straight members/, /the nearest densities/];

test("answers every button on every model, or says why not", async ({ page }) => {
  const models = await page.$$eval("[data-model]", (buttons) => buttons.map((b) => b.dataset.model)), odd = [];
  const answered = Object.fromEntries(["run", "equilibria", "modes", "rigidity", "path", "form"].map((c) => [c, 0]));
  for (const model of models) {
    await pick(page, model);
    for (const call of Object.keys(answered)) {
      await page.click("#" + call);
      const stop = setTimeout(() => page.keyboard.press("Escape"), 15000);
      await idle(page);
      clearTimeout(stop);
      const bad = await page.$eval("#status", (e) => e.classList.contains("bad")), text = await textOf(page, "#status");
      if (!bad) answered[call]++;
      else if (!REASONS.some((reason) => reason.test(text))) odd.push(model + " " + call + ": " + text);
    }
  }
  console.log("  answers on " + models.length + " models: " + JSON.stringify(answered));
  assert.deepEqual(odd, []);
  for (const [call, count] of Object.entries(answered)) assert.ok(count >= 5, call + " answers " + count);
});

test("forgets values that were tried when another scene is pasted", async ({ page }) => {
  await slide(page, "friction", 700);
  const whole = await scene(page);
  await rewrite(page, whole, whole.replace("name: Nine", "name: Pasted nine"));
  assert.deepEqual(await page.evaluate(() => window.strutPlayground.settings), {});
  assert.match(await velocity(page), /^10\.03 mm\/s/);
});

test("shows where a person writes an error that lies out of view", async ({ page }) => {
  await rewrite(page, "frequency: 10 Hz", "frequency: 10 mm");
  const notes = await page.$$eval(".code-note", (all) => all.map((note) => note.textContent));
  assert.match(notes[0], /^line 52: expected a frequency .* line 15 gives 'frequency'/);
  const place = await page.$eval(".code-note", (note) => note.getBoundingClientRect().right -
    document.getElementById("editor").getBoundingClientRect().right);
  assert.ok(place <= 0, "the note is cut");
  const apart = await page.evaluate(() => document.getElementById("old-mark").getBoundingClientRect().top -
    document.getElementById("clock").getBoundingClientRect().bottom);
  assert.ok(apart >= 0, "the mark covers the clock");
});

test("opens several files that are dropped, and shares them by a link", async ({ page, browser }) => {
  const text = await scene(page);
  await drop(page, { "crawler.yaml": text, "mine.yaml": "strut: 1\nbase: crawler.yaml\nname: Mine\n" });
  assert.equal(await textOf(page, "#file-name"), "mine.yaml");
  assert.equal(await page.evaluate(() => window.strut.data.name), "Mine");
  assert.match(await textOf(page, "#file-others"), /crawler\.yaml/);
  await followLink(page, browser);
});

test("a hostile name stays text", async ({ page, browser }) => {
  const name = "</script><b id=bad>x</b><img src=x onerror=alert(1)>";
  const text = (await scene(page)).replace(/^name: .*$/m, () => "name: " + JSON.stringify(name));
  const other = await openPage(browser, { hash: await fragmentOf(page, { text, name: name + ".yaml", settings: {} }) });
  assert.equal(await textOf(other.page, "#name"), name);
  assert.equal(await other.page.$("#bad"), null);
  await rewrite(other.page, "  m9:", "  \"<b id=bad>9</b>\":");
  assert.match(await textOf(other.page, ".code-note"), /<b id=bad>/);
  assert.equal(await other.page.$("#bad"), null);
  assert.deepEqual(other.faults, []);
  await other.context.close();
});

test("survives a damaged link and a huge scene", async ({ page, browser }) => {
  const damaged = await openPage(browser, { hash: "#s=abc" });
  assert.match(await textOf(damaged.page, "#status"), /./);
  assert.ok(await damaged.page.evaluate(() => window.strut.data));
  await damaged.context.close();
  await drop(page, { "huge.yaml": "strut: 1\nname: huge\nnodes: {" + Array.from({ length: 60000 },
    (_, i) => "n" + i + ": [" + i + ", 0]").join(", ") + "}\nmembers: {" + Array.from({ length: 59999 },
    (_, i) => "m" + i + ": {kind: bar, nodes: [n" + i + ", n" + (i + 1) + "], stiffness: 1}").join(", ") + "}\n" });
  console.log("  huge: " + (await textOf(page, "#status")).slice(0, 120));
  await pick(page, "basics/pendulum.yaml");
  assert.ok(await page.evaluate(() => window.strut.frames) > 1);
});

test("is embedded without the list", async ({ page }) => {
  assert.equal(await page.$eval("#models", (e) => getComputedStyle(e).display), "none");
  await photograph(page, "embed");
}, { embed: true, width: 720, height: 700 });

test("fits 400 pixels", async ({ page }) => {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 400, "the page is " + wide + " pixels wide");
  await page.evaluate(() => { document.getElementById("models").open = true; });
  await slide(page, "friction", 700);
  assert.match(await velocity(page), /mm\/s/);
  if (pictures) await page.screenshot({ path: join(pictures, "narrow.png"), fullPage: true });
}, { width: 400, height: 800 });

test("is dark where the reader wants it", async ({ page }) => {
  const paper = await page.$eval("#scene-editor", (e) => getComputedStyle(e).backgroundColor);
  assert.match(paper, /^rgb\(\d?\d, \d?\d, \d?\d\)$/);
  await photograph(page, "dark");
}, { dark: true });

test("is reached by Tab, with names for all controls", async ({ page }) => {
  const reached = new Set();
  for (let i = 0; i < 14; i++) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id));
  }
  for (const id of ["run", "accuracy", "equilibria", "modes", "rigidity", "path", "form", "open", "save", "link"])
    assert.ok(reached.has(id), "Tab does not reach " + id);
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, textarea")]
    .filter((e) => e.checkVisibility() && e.type !== "file" && !e.textContent.trim() && !e.getAttribute("aria-label") &&
      !(e.labels && e.labels.length)).map((e) => e.outerHTML));
  assert.deepEqual(nameless, []);
});

/* ---- all of them ---- */

async function perform(browser, { name, run, options }) {
  const start = performance.now();
  let fault = null;
  const { page, context, faults } = await openPage(browser, { ...options, hash: options.embed ? "#embed=1" : "" });
  try {
    await run({ page, browser });
    assert.deepEqual(faults, [], "errors, warnings or requests");
  } catch (error) {
    fault = error;
    await photograph(page, "failed-" + name.replace(/\W+/g, "-"));
  }
  await context.close();
  console.log((fault ? "FAILED " : "ok     ") + name + " (" + Math.round(performance.now() - start) + " ms)");
  if (fault) console.log("  " + String(fault.stack || fault).replaceAll("\n", "\n  "));
  return !fault;
}

if (pictures) mkdirSync(pictures, { recursive: true });
const browser = await puppeteer.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
let good = true;
try {
  for (const one of tests) if (!wanted || one.name.includes(wanted)) good = await perform(browser, one) && good;
} finally {
  await browser.close();
}
process.exit(good ? 0 : 1);

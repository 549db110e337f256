/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The playground: the scene that is open, what is computed of it, and what the page shows. */
import { Engine, Stopped } from "../client/engine.js";
import { decodeLink, encodeLink } from "../client/link.js";
import { createEditor, useSchema } from "./editor.js";
import { commandFor, copyText, make, sceneAmong, wireOpening } from "./files.js";
import { valueAt } from "./language.js";
import { createModelList } from "./models.js";
import { createFound } from "./results.js";
import { createSettings, parametersOf, writeSettings } from "./settings.js";

const page = window.strutPage, element = (id) => document.getElementById(id);
const PAUSE = 300; /* [ms] after an edit */
const QUICK = 1; /* [s]: what took less is computed again by itself */
const LIMIT = 60; /* [s] of a request */
const PATIENCE = 700; /* [ms] that a request may go on when a newer one waits */
const CALLS = ["run", "equilibria", "modes", "rigidity", "path", "form"];

const state = {
  name: "scene.yaml", files: {}, /* what is open, beside the editor's text and the settings */
  last: { call: "run", options: {} }, seconds: 0, /* what was computed last, and how long it took */
  shown: null, base: null, names: {}, /* data on the page; of the scene at rest; names of its things */
  hasRun: false, fresh: true /* nothing of this scene was computed yet */
};
let engine = null, editor = null, settings = null, found = null, models = null;

/* ---- parts of the page that are packed ---- */

function unpack(id) {
  const text = element(id).textContent;
  element(id).remove();
  return page.inflate(text);
}

/* ---- status ---- */

function say(text, bad = false) {
  element("status").textContent = page.micro(text);
  element("status").classList.toggle("bad", bad);
}

const oldMark = make("div", { id: "old-mark", hidden: true });

/* Whether what is shown belongs to another text or other settings than the present ones. */
function markOld(why) {
  document.body.classList.toggle("old", Boolean(why));
  oldMark.hidden = !why;
  oldMark.textContent = why || "";
}

function setBusy(busy) {
  element("stop").disabled = !busy;
  element("progress").hidden = !busy;
  if (busy) element("progress").removeAttribute("value");
  document.body.setAttribute("aria-busy", String(busy));
}

function showFailure(failure) {
  const messages = failure.messages || [];
  const here = messages.filter((m) => m.file === state.name || m.file === "" || !m.file);
  const elsewhere = messages.length === 0 || here.length < messages.length || messages.some((m) => m.line === 0);
  editor.showMessages(here);
  element("report").hidden = !elsewhere;
  element("report").textContent = elsewhere ? failure.report || failure.message || String(failure) : "";
  say(failure.message || String(failure), true);
}

function clearFailure() {
  editor.showMessages([]);
  element("report").hidden = true;
}

/* ---- computing: one job at a time, of those that wait the newest ---- */

let running = null, waiting = null;

function enqueue(job) {
  waiting = job;
  if (!running) startNext();
  else if (performance.now() - running.begin > PATIENCE) engine.stop("a newer request");
  else setTimeout(() => {
    if (waiting === job && running) engine.stop("a newer request");
  }, PATIENCE);
}

async function startNext() {
  const job = running = waiting;
  waiting = null;
  if (!job) return;
  job.begin = performance.now();
  try {
    await perform(job);
  } catch (error) {
    if (!(error instanceof Stopped)) showFailure(error);
    else if (!waiting) say("Stopped: " + error.message + ".", true);
    if (!waiting) markOld("not computed");
  } finally {
    running = null;
    if (waiting) startNext();
    else setBusy(false);
  }
}

const sceneNow = () => ({ text: editor.text, name: state.name, files: state.files, settings: settings.settings });

async function perform(job) {
  setBusy(true);
  markOld(state.shown ? "computing" : "");
  const reading = setTimeout(() => say("Reading the scene\u2026"), PATIENCE);
  const want = ["page", "names", "resolved", "warnings"];
  const checked = await engine.ask({ scene: sceneNow(), limit: LIMIT, want }).finally(() => clearTimeout(reading));
  clearFailure();
  takeScene(checked);
  if (!state.schema) {
    state.schema = true;
    useSchema(await engine.ask({ call: "schema" }));
  }
  if (!job.call) job.call = wantedCall(job);
  if (!job.call) return showUncomputed(checked);
  if (!state.shown) await show(checked.page);
  await compute(job, checked.warnings);
}

/* What to compute where only the scene was changed: what was computed last, of another text if that was quick. */
function wantedCall(job) {
  if (!job.opened && !job.settings && state.seconds >= QUICK) return null;
  return state.last.call === "run" ? (state.hasRun ? { call: "run" } : null) : state.last;
}

/* A scene without a run at its start; of another the last result, which is old now. */
async function showUncomputed({ page: data, warnings }) {
  const still = !state.hasRun && state.last.call === "run";
  if (still || !state.shown) await show(data);
  else markOld("of an earlier text");
  say(warnings.join(" ") || (still ? "The scene is valid; it has no run."
    : "The scene is valid; compute it again by its button."));
}

/* Computes the run again, or shows the scene at rest where it has none. */
function showRun() {
  Object.assign(state, { last: { call: "run" }, shown: null });
  enqueue({ settings: true });
}

function takeScene({ page: data, names, resolved }) {
  state.base = data;
  state.names = names;
  state.hasRun = Boolean(resolved.run);
  settings.load(parametersOf(editor.state, names, resolved), names.configurations || []);
}

async function compute(job, warnings) {
  const { call } = job.call, accuracy = element("accuracy").value;
  const options = job.call.options || (call === "run" && accuracy ? { accuracy } : {});
  const begin = performance.now();
  say("Computing " + (call === "run" ? "the run" : call) + "\u2026");
  element("command").textContent = commandFor(state.name, settings.settings, { call, options });
  try {
    const answer = await engine.ask({ scene: sceneNow(), call, options, limit: LIMIT,
      want: ["page", "json", "table", "warnings"] }, (fraction) => { element("progress").value = fraction; });
    state.seconds = (performance.now() - begin) / 1000;
    state.last = { call, options: call === "run" ? undefined : options };
    await showAnswer(call, options, answer);
    sayDone(call, answer, warnings);
  } catch (error) {
    if (!(error instanceof Stopped) && call === "path")
      found.showPath(state.base, null, "", pathChoices(), options.over || "");
    throw error;
  }
}

function sayDone(call, { failure, warnings: own, page: data }, warnings) {
  const time = state.seconds < 1 ? Math.round(1000 * state.seconds) + " ms" : state.seconds.toFixed(1) + " s";
  const velocity = (data.summary || []).find((row) => /^mean velocity/.test(row.label));
  const accuracy = (data.summary || []).find((row) => row.label === "accuracy");
  const known = accuracy ? " (" + accuracy.value.split(";")[0] + ")" : "";
  const number = velocity ? velocity.value.split(",")[0] + known + "; c" : "C";
  const text = [number + "omputed in " + time + ".", ...warnings, ...own].join(" ");
  if (failure) showFailure(failure);
  else say(text);
}

/* ---- what the page shows ---- */

async function show(given) {
  const data = given.equilibria ? given : { ...given, equilibria_remark: "" };
  await page.show(data);
  state.shown = data;
  document.body.classList.remove("waiting");
  markOld("");
}

const pathChoices = () => [["", "all loads"],
  ...(state.names.parameters || []).map((name) => [name, "parameter " + name]),
  ...(state.names.actuators || []).map((name) => [name, "actuator " + name])];

async function showAnswer(call, options, answer) {
  const { page: data, json, table } = answer, first = state.fresh;
  state.fresh = false;
  if (call === "run") {
    found.close();
    await show(data);
    if (first && data.motion && !matchMedia("(prefers-reduced-motion: reduce)").matches) window.strut.play();
    return;
  }
  if (call === "modes") return found.showModes(state.base, json, table);
  if (call === "path") return found.showPath(state.base, json, table, pathChoices(), options.over || "");
  if (call === "equilibria") {
    found.showHint("Equilibria found", "Choose a shape below to see it on the stage, and to start there.", table);
    return show({ ...(state.shown || state.base), equilibria: data.equilibria, barriers: data.barriers,
      equilibria_remark: data.equilibria_remark, equilibria_left_out: data.equilibria_left_out,
      motion: state.shown && state.shown.motion && !state.shown.motion.made ? state.shown.motion : null });
  }
  found.showTable(call === "form" ? "Form" : "Rigidity", table);
  return show(data);
}

/* ---- starting from an equilibrium ---- */

const number = (x) => String(Number(x.toPrecision(12)));
const nodeName = (name) => (/^[A-Za-z_][\w.-]*$/.test(name) ? name : JSON.stringify(name));

/* The parameter by which the scene chooses its start, if it does. */
function startParameter() {
  for (const key of ["equilibrium", "configuration"]) {
    const value = valueAt(editor.state, ["initial", key]);
    if (value && (state.names.parameters || []).includes(value.text)) return value.text;
  }
  return null;
}

/* By a setting where a parameter names the start, else by positions in the text. */
function startFrom(equilibrium) {
  const parameter = startParameter();
  found.close();
  if (parameter && (state.names.configurations || []).includes(equilibrium.name)) {
    settings.set({ ...settings.settings, [parameter]: equilibrium.name });
  } else {
    const { nodes } = state.base, at = equilibrium.position;
    const places = nodes.map(({ name }, i) =>
      nodeName(name) + ": [" + number(at[2 * i]) + ", " + number(at[2 * i + 1]) + "]");
    const insert = "{positions: {" + places.join(", ") + "}}", old = valueAt(editor.state, ["initial"]);
    const end = editor.text.length, line = (editor.text.endsWith("\n") ? "" : "\n") + "initial: " + insert + "\n";
    editor.replace(old ? { from: old.pair.from, to: old.pair.to, insert: "initial: " + insert }
      : { from: end, to: end, insert: line });
  }
  clearTimeout(edited);
  showRun();
}

function wireStart() {
  const button = make("button", { type: "button", id: "start-here", textContent: "Start here" });
  element("shown").append(button);
  button.addEventListener("click", () => startFrom(window.strut.data.equilibria[window.strut.picked]));
}

/* ---- opening ---- */

let edited = 0;

function openScene({ text, name, files = {}, settings: given = {}, model = null, accuracy = "" }) {
  engine.stop("another scene");
  Object.assign(state, { name, files, last: { call: "run" }, seconds: 0, shown: null, fresh: true });
  editor.setText(text);
  found.close();
  settings.set(given);
  models.mark(model);
  element("accuracy").value = accuracy;
  element("file-name").textContent = name;
  const others = Object.keys(files);
  element("file-others").textContent = others.length ? "with " + others.join(", ") : "";
  element("command").textContent = commandFor(name, given, { call: "run", options: accuracy ? { accuracy } : {} });
  clearTimeout(edited);
  enqueue({ opened: true });
}

/* Runs of the crawler measure a velocity, which can be asked for to an accuracy. */
const accuracyFor = (model) => (model.group === "crawler" ? "0.5 %" : "");

function openModel(model) {
  document.body.classList.remove("waiting");
  page.show(model.data); /* at once; the engine follows */
  openScene({ text: model.text, name: model.name, files: model.files, model, accuracy: accuracyFor(model) });
  state.shown = model.data;
}

function openFiles(files) {
  const name = sceneAmong(files);
  if (!name) {
    Object.assign(state.files, files);
    element("file-others").textContent = "with " + Object.keys(state.files).join(", ");
    return enqueue({ opened: true });
  }
  const { [name]: text, ...others } = files;
  return openScene({ text, name, files: others });
}

/* The scene of the address, or null. */
async function openLink() {
  const fragment = location.hash, options = new URLSearchParams(fragment.slice(1));
  document.body.classList.toggle("embed", options.get("embed") === "1");
  if (options.get("embed") === "1") element("models").open = false;
  try {
    const linked = await decodeLink(fragment);
    if (linked) openScene({ ...linked, accuracy: options.get("accuracy") || "" });
    return linked;
  } catch (error) {
    say(error.message, true);
    return null;
  }
}

/* ---- buttons and keys ---- */

async function copyLink() {
  const accuracy = element("accuracy").value, fragment = await encodeLink(sceneNow());
  const link = location.href.replace(/#.*$/, "") + fragment +
    (accuracy ? "&accuracy=" + encodeURIComponent(accuracy) : "");
  element("link").dataset.link = link;
  copyText(link, element("link"));
}

function saveScene() {
  page.save(new Blob([editor.text], { type: "application/yaml" }),
    page.fileName(state.name.replace(/\.\w+$/, ""), ".yaml"));
}

const stop = () => {
  waiting = null;
  engine.stop();
};

function wire() {
  for (const call of CALLS)
    element(call).addEventListener("click", () => enqueue({ call: { call } }));
  element("accuracy").addEventListener("change", () => enqueue({ call: { call: "run" } }));
  element("stop").addEventListener("click", stop);
  element("link").addEventListener("click", copyLink);
  element("save").addEventListener("click", saveScene);
  element("copy-command").addEventListener("click", () =>
    copyText(element("command").textContent, element("copy-command")));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
      event.preventDefault();
      enqueue({ call: { call: "run" } });
    } else if (event.key === "Escape" && running && !event.defaultPrevented) stop();
  });
  window.addEventListener("hashchange", openLink);
  wireOpening(openFiles, (error) => say(error.message, true));
  wireStart();
}

/* Values that were tried, and what was computed, belong to the text before. */
function onEdit(replaced) {
  if (replaced) {
    Object.assign(state, { last: { call: "run" }, seconds: 0 });
    settings.set({});
    models.mark(null);
    found.close();
  }
  markOld(state.shown ? "of an earlier text" : "");
  clearTimeout(edited);
  edited = setTimeout(() => enqueue({}), PAUSE);
}

function writeIntoFile() {
  editor.replace(writeSettings(editor.state, settings.settings));
  settings.set({});
}

/* ---- start ---- */

function addLicences(text) {
  const licences = "strut is free software under the GNU General Public License, version 3 or later; so are " +
    "the parts of GSL and GLPK in it. Besides these and libyaml, cJSON, zlib and SuiteSparse the page has:\n\n" + text;
  element("sampling").parentElement.append(
    make("details", {}, make("summary", { textContent: "Licences" }), make("pre", { textContent: licences })));
}

function createEngine(assets) {
  const script = new Blob([assets.worker], { type: "text/javascript" });
  const wasm = new Promise((resolve) => { setTimeout(resolve, 0); }) /* after the first picture */
    .then(() => unpack("strut-wasm")).then((bytes) => WebAssembly.compile(bytes));
  return new Engine(wasm, () => {
    const url = URL.createObjectURL(script), worker = new Worker(url);
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    return worker;
  });
}

/* The page shows the first model by itself, before this script runs; not so where a link has another scene. */
async function firstPicture() {
  document.body.classList.toggle("waiting", /[#&]s=/.test(location.hash));
  await window.strut.ready;
  await new Promise((resolve) => { requestAnimationFrame(() => setTimeout(resolve, 0)); });
}

async function start() {
  await firstPicture();
  const assets = JSON.parse(new TextDecoder().decode(await unpack("strut-assets")));
  element("stage").append(oldMark);
  if (innerWidth <= 900) element("models").open = false;
  engine = createEngine(assets);
  editor = createEditor(element("editor"), onEdit);
  settings = createSettings({ onChange: () => enqueue({ settings: true }), onWrite: writeIntoFile });
  found = createFound({ onShow: show, onBack: showRun,
    onOver: (over) => enqueue({ call: { call: "path", options: over ? { over } : {} } }) });
  models = createModelList(assets.models, openModel);
  addLicences(assets.licences);
  wire();
  const linked = await openLink();
  if (!linked) openModel(assets.models.find((model) => model.name === "crawler.yaml"));
}

/* For tests. */
window.strutPlayground = {
  get busy() { return running !== null || waiting !== null; },
  get seconds() { return state.seconds; },
  get editor() { return editor; },
  get settings() { return settings.settings; }
};
start().catch((error) => say("The playground does not start: " + error.message, true));

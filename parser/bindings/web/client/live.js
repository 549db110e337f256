/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The script of a live page: controls for the parameters of its scene. Moving one computes the scene again in a Worker
 * and shows the result beside the original, by strutPage.show. The key `live` of the page's data (page.h) says what to
 * compute. The engine is inside this script, deflated, and is unpacked when it is first needed.
 */
import { Engine, Stopped } from "./engine.js";
import { STEPS, quantityOf, scaleOf } from "./scale.js";
import deflated from "./strut.wasm.deflated"; /* base64 */
import worker from "./worker.bundle"; /* its text */

const page = window.strutPage;
const PATIENCE = 300; /* [ms] that an answer under way is still waited for once there are newer settings */

/* ---- small elements ---- */

function make(kind, properties = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/* ---- the engine ---- */

async function compile() {
  return WebAssembly.compile(await page.inflate(deflated));
}

function startWorker() {
  const address = URL.createObjectURL(new Blob([worker], { type: "text/javascript" }));
  const started = new Worker(address);
  URL.revokeObjectURL(address);
  return started;
}

/* ---- parameters ---- */

/* A parameter that is an expression of others follows them and has no control. */
function isDerived(parameter, all) {
  const words = parameter.value === null ? [] : parameter.text.match(/[A-Za-z_]\w*/g) || [];
  return !quantityOf(parameter.text) &&
    words.some((word) => all.some((other) => other.name === word && other !== parameter));
}

/* A slider around the value, and a field for any value. get() is a text for the scene, or null where nothing was
   changed. An expression is a number in SI units. */
function numberControl(parameter, changed) {
  const quantity = quantityOf(parameter.text) || { value: parameter.value, unit: "", whole: false };
  const { unit } = quantity, scale = scaleOf(quantity), initial = String(quantity.value);
  const slider = make("input", { type: "range", min: 0, max: STEPS, step: 1, value: STEPS / 2,
    "aria-label": parameter.name, "aria-valuetext": parameter.text });
  const field = make("input", { type: "text", inputMode: "decimal", value: initial, size: 9,
    "aria-label": parameter.name + (unit ? " in " + unit : "") });
  const show = (text) => {
    field.value = text;
    slider.setAttribute("aria-valuetext", text + (unit ? " " + unit : ""));
  };
  slider.addEventListener("input", () => {
    show(scale.number(Number(slider.value)));
    changed();
  });
  field.addEventListener("change", () => {
    slider.value = scale.place(Number(field.value));
    show(field.value);
    changed();
  });
  return {
    parts: [slider, make("span", { className: "amount" }, field, unit && make("bdi", {}, page.micro(unit)))],
    get: () => (field.value.trim() === initial ? null : field.value.trim() + (unit ? " " + unit : "")),
    reset() {
      slider.value = STEPS / 2;
      show(initial);
    }
  };
}

/* A text parameter: a choice where it names a configuration, else a field. */
function wordControl(parameter, choices, changed) {
  const known = choices.includes(parameter.text);
  const control = known
    ? make("select", {}, ...choices.map((name) => make("option", { value: name, textContent: name })))
    : make("input", { type: "text", size: 14 });
  control.setAttribute("aria-label", parameter.name);
  control.value = parameter.text;
  control.addEventListener("change", changed);
  return {
    parts: [control, make("span")],
    get: () => (control.value === parameter.text ? null : control.value),
    reset() { control.value = parameter.text; }
  };
}

/* ---- what is computed and shown ---- */

/* The rows of the summary that are said beside the controls, by their labels. */
function headlineOf(data) {
  const of = (pattern) => (data.summary || []).find((row) => pattern.test(row.label));
  if (data.motion) return { main: of(/velocity/) || of(/^duration$/), accuracy: of(/^accuracy$/) };
  const found = data.equilibria && data.equilibria.length + (data.equilibria_left_out || 0);
  return { main: found ? { label: "equilibria", value: String(found) } : null };
}

function resultText(data, original, seconds) {
  const now = headlineOf(data), before = headlineOf(original), parts = [];
  if (now.main) {
    const same = before.main && before.main.label === now.main.label;
    parts.push(now.main.label + ": " + now.main.value + (same ? " (before: " + before.main.value + ")" : ""));
  }
  if (now.accuracy) parts.push("accuracy: " + now.accuracy.value);
  parts.push("computed in " + seconds.toPrecision(2) + " s");
  return page.micro(parts.join("; ")) + ".";
}

class LiveControls {
  constructor(original) {
    this.original = original;
    this.live = original.live;
    this.engine = new Engine(compile(), startWorker);
    this.wanted = null; /* settings to compute next */
    this.busy = false;
    this.times = []; /* [ms] from a change to the new picture */
    this.build();
    this.warm();
  }

  build() {
    const { parameters, configurations } = this.live, changed = () => this.change();
    this.controls = new Map();
    const rows = make("div", { id: "live-rows" });
    for (const parameter of parameters) {
      if (isDerived(parameter, parameters)) continue;
      const control = parameter.value === null ? wordControl(parameter, configurations, changed)
        : numberControl(parameter, changed);
      this.controls.set(parameter.name, control);
      rows.append(make("label", {}, make("bdi", { textContent: parameter.name })), ...control.parts);
    }
    this.progress = make("progress", { max: 1, "aria-label": "Progress", hidden: true });
    this.stopButton = make("button", { type: "button", textContent: "Stop", disabled: true,
      onclick: () => this.stop() });
    this.resetButton = make("button", { type: "button", textContent: "Reset", disabled: true,
      onclick: () => this.reset() });
    this.status = make("p", { id: "live-status", className: "hint", role: "status", dir: "auto" });
    this.trouble = make("p", { id: "live-trouble", role: "alert", dir: "auto", hidden: true });
    const host = document.getElementById("live");
    host.setAttribute("aria-label", "Change parameters");
    host.replaceChildren(
      make("div", { className: "bar" }, make("h2", { textContent: "Change parameters" }),
        make("span", { id: "live-buttons" }, this.progress, this.stopButton, this.resetButton)),
      rows, this.trouble, this.status);
    host.hidden = false;
    this.say(this.controls.size ? "" : "The scene has no parameters.");
  }

  say(text, trouble = "") {
    this.status.textContent = text;
    this.trouble.textContent = trouble;
    this.trouble.hidden = !trouble;
  }

  settings() {
    const given = {};
    for (const [name, control] of this.controls) {
      const value = control.get();
      if (value !== null) given[name] = value;
    }
    return given;
  }

  change() {
    this.wanted = { settings: this.settings(), since: performance.now() };
    this.resetButton.disabled = false;
    if (!this.busy) this.computeAll();
    else if (!this.warming) this.patience ||= setTimeout(() => {
      this.patience = 0;
      if (this.wanted) this.engine.stop("newer settings");
    }, PATIENCE);
  }

  /* Starts the Worker and reads the scene, so that the first answer is as fast as the others. */
  async warm() {
    const { scene, name } = this.live;
    this.busy = this.warming = true;
    try {
      await this.engine.ask({ scene: { text: scene, name }, want: [] });
    } catch (error) {
      this.complain(error);
    }
    this.warming = this.busy = false;
    if (this.wanted) this.computeAll();
  }

  async computeAll() {
    this.busy = true;
    this.stopButton.disabled = false;
    while (this.wanted) {
      const { settings, since } = this.wanted;
      this.wanted = null;
      try {
        await this.compute(settings, since);
      } catch (error) {
        if (!(error instanceof Stopped && this.wanted)) this.complain(error);
      }
      clearTimeout(this.patience);
      this.patience = 0;
    }
    this.busy = false;
    this.stopButton.disabled = true;
    this.progress.hidden = true;
  }

  /* The page's data for these settings. */
  async ask(settings) {
    const { scene, name, call, options } = this.live;
    const request = { scene: { text: scene, name, settings }, want: ["page"] };
    if (call === "run") Object.assign(request, { call, options, want: ["page", "json"] });
    else request.options = { equilibria: call === "equilibria" };
    const answer = await this.engine.ask(request, (fraction) => { this.progress.value = fraction; });
    if (answer.failure) throw answer.failure;
    return answer;
  }

  async compute(settings, since) {
    if (Object.keys(settings).length === 0) {
      await page.show(this.original);
      this.resetButton.disabled = true;
      this.say("");
      return;
    }
    this.progress.hidden = false;
    this.progress.removeAttribute("value");
    this.say("Computing \u2026");
    const { page: data } = await this.ask(settings);
    const seconds = (performance.now() - since) / 1000;
    await page.show({ ...data, label: "changed" }, { ...this.original, label: "original" });
    this.times.push(performance.now() - since);
    this.say(resultText(data, this.original, seconds));
  }

  complain(error) {
    const stopped = error instanceof Stopped;
    this.say(stopped ? "Stopped. The last result is still shown." : "",
      stopped ? "" : error.message + ". The last result is still shown.");
  }

  stop() {
    this.wanted = null;
    this.engine.stop();
  }

  reset() {
    for (const control of this.controls.values()) control.reset();
    this.stop();
    this.change();
  }
}

/* The page has shown its own data by now, or will soon. */
window.strut.ready.then(() => {
  const { data } = window.strut;
  if (data && data.live) window.strutLive = new LiveControls(data);
});

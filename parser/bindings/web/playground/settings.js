/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Controls of a scene's parameters above the charts: sliders for numbers, a choice for the name of a configuration,
 * a field for anything else. They change settings, as --set does, and not the text until it is asked for.
 */
import { make } from "./files.js";
import { keysIn, unquoted, valueAt } from "./language.js";

/* ---- what a slider means: the number and the unit of its text, and the values around it ---- */

/** Places of a slider: from 0 to STEPS; the value of the file is in the middle. */
const STEPS = 400;
const DIGITS = 4;
const NUMBER = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;
const UNIT = /^[A-Za-z%\u00b0\u00b5][A-Za-z0-9%\u00b0\u00b5^/* .-]*$/;

/** {value, unit, whole} of a text such as "10 Hz"; null where it is no number with a unit. */
function quantityOf(text) {
  const match = NUMBER.exec(text.trim());
  if (!match || (match[2] && !UNIT.test(match[2]))) return null;
  const value = Number(match[1]);
  return { value, unit: match[2], whole: !match[2] && /^\d+$/.test(match[1]) && value >= 2 };
}

/**
 * The scale of a slider: a decade around the value, logarithmic, or from -1 to 1 around zero. number(place) is the
 * text of a number, place(number) the nearest place.
 */
function scaleOf({ value, whole }) {
  const write = (x) => String(Number(x.toPrecision(DIGITS)));
  const within = (place) => Math.round(Math.min(STEPS, Math.max(0, place)));
  if (value === 0)
    return { number: (place) => write(2 * place / STEPS - 1), place: (x) => within((x + 1) / 2 * STEPS) };
  return {
    number(place) {
      if (place === STEPS / 2) return String(value);
      const x = value * Math.pow(10, place / STEPS - 0.5);
      return whole ? String(Math.max(1, Math.round(x))) : write(x);
    },
    place: (x) => (x / value > 0 ? within((Math.log10(x / value) + 0.5) * STEPS) : 0)
  };
}

/* ---- the controls ---- */

/** The parameters of a scene: [{name, text}], with the text of the file, or the value in SI units. */
export function parametersOf(state, names, resolved) {
  const own = new Set(keysIn(state, ["parameters"]));
  return (names.parameters || []).map((name) => {
    const value = own.has(name) ? valueAt(state, ["parameters", name]) : null;
    const known = (resolved.parameters || {})[name];
    return { name, text: value ? unquoted(value.text) : known === undefined ? "" : String(known) };
  });
}

/** Controls in #live. onChange(settings) when a person has changed one; onWrite() to put them into the text. */
export function createSettings({ onChange, onWrite }) {
  const host = document.getElementById("live");
  const head = make("div", { className: "bar" }), grid = make("div", { className: "sliders" });
  const write = make("button", { type: "button", id: "write", textContent: "Write into the file", disabled: true });
  let settings = {}, shown = "", rows = [];
  head.append(make("h2", { textContent: "Try values" }), write);
  host.append(head, grid);
  host.setAttribute("aria-label", "Parameters to change");
  write.addEventListener("click", () => onWrite());

  function mark() {
    for (const row of rows) {
      const changed = row.name in settings;
      row.box.classList.toggle("changed", changed);
      row.reset.disabled = !changed;
    }
    write.disabled = Object.keys(settings).length === 0;
  }

  function change(row, text) {
    settings = { ...settings };
    if (text === row.text || text === "") delete settings[row.name];
    else settings[row.name] = text;
    mark();
    onChange(settings);
  }

  function addSlider(row, quantity, box) {
    const scale = scaleOf(quantity), unit = quantity.unit ? " " + quantity.unit : "";
    const slider = make("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": row.name });
    slider.addEventListener("input", () => {
      row.field.value = scale.number(Number(slider.value)) + unit;
      change(row, row.field.value);
    });
    row.follow = (text) => {
      const given = quantityOf(text);
      if (given && given.unit === quantity.unit) slider.value = scale.place(given.value);
      slider.setAttribute("aria-valuetext", text);
    };
    box.append(slider);
  }

  function createRow({ name, text }, words) {
    const row = { name, text, box: make("div", { className: "slider" }), follow() {} };
    const label = make("label", { textContent: name, title: name, htmlFor: "set-" + name });
    const quantity = quantityOf(text), choice = !quantity && words.includes(text);
    row.field = choice ? make("select") : make("input", { type: "text", spellcheck: false });
    if (choice) row.field.append(...words.map((word) => make("option", { value: word, textContent: word })));
    row.field.id = "set-" + name;
    row.field.className = quantity ? "" : "wide";
    row.field.addEventListener("change", () => {
      row.follow(row.field.value);
      change(row, row.field.value.trim());
    });
    row.reset = make("button", { type: "button", textContent: "\u21ba", title: "As in the file",
      "aria-label": name + " as in the file" });
    row.reset.addEventListener("click", () => {
      show(row, text);
      change(row, text);
    });
    row.box.append(label);
    if (quantity) addSlider(row, quantity, row.box);
    row.box.append(row.field, row.reset);
    return row;
  }

  function show(row, text) {
    row.field.value = text;
    row.follow(text);
  }

  return {
    get settings() { return settings; },
    /** Shows parameters [{name, text}]; `words`: names that a parameter may choose among. */
    load(parameters, words) {
      const key = JSON.stringify([parameters, words]);
      if (key === shown) return;
      shown = key;
      settings = Object.fromEntries(Object.entries(settings)
        .filter(([name, text]) => parameters.some((p) => p.name === name && p.text !== text)));
      rows = parameters.map((parameter) => createRow(parameter, words));
      grid.replaceChildren(...rows.map((row) => row.box));
      for (const row of rows) show(row, settings[row.name] ?? row.text);
      host.hidden = rows.length === 0;
      mark();
    },
    /** Other settings, without onChange. */
    set(given) {
      settings = { ...given };
      for (const row of rows) show(row, settings[row.name] ?? row.text);
      mark();
    }
  };
}

/* ---- into the text ---- */

const bare = (text) => /^[-+A-Za-z0-9_.][^:#{}[\],"'&*!|>%@`]*$/.test(text) && !/\s$/.test(text);
const quoted = (text) => (bare(text) ? text : JSON.stringify(text));

/** The changes {from, to, insert} that put settings into the parameters of the text. */
export function writeSettings(state, settings) {
  const changes = [], missing = [];
  for (const [name, text] of Object.entries(settings)) {
    const value = valueAt(state, ["parameters", name]);
    if (!value) missing.push("  " + quoted(name) + ": " + quoted(text) + "\n");
    else {
      const wasQuoted = /^["']/.test(value.text);
      changes.push({ from: value.from, to: value.to, insert: wasQuoted ? JSON.stringify(text) : quoted(text) });
    }
  }
  if (missing.length) changes.push(additionOf(state, missing));
  return changes;
}

function additionOf(state, lines) {
  const all = valueAt(state, ["parameters"]), end = state.doc.length;
  if (all && !all.text.startsWith("{")) {
    const line = state.doc.lineAt(all.from);
    return { from: line.from, insert: lines.join("") };
  }
  const before = end > 0 && state.sliceDoc(end - 1) !== "\n" ? "\n" : "";
  return { from: end, insert: before + "parameters:\n" + lines.join("") };
}

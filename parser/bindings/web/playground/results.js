/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the page itself does not show: modes, paths and tables, in a section of their own; motions made of them. */
import { make } from "./files.js";

const page = window.strutPage;
const PERIODS = 6, FRAMES = 40, LASTS = 12; /* of a mode: periods, frames of each, playing time [s] */
const SWING = 0.08; /* largest displacement of a mode, of the structure's size */

const valueText = (value, unit, digits) =>
  (unit ? page.quantity(value, unit, digits) : String(Number(value.toPrecision(digits))).replace("-", "\u2212"));
const block = (columns, values) => ({ columns, values });
const flat = (data, nodes) => data.nodes.flatMap((node, i) => nodes[node.name] ||
  [data.start[2 * i], data.start[2 * i + 1]]);

/* A motion of given shapes, for the page's player; times in s. */
function motionOf(data, { times, position, force, clock, note }) {
  const nodes = data.nodes.length, frames = times.length;
  return { frames, recorded: frames, every: 1, status: "completed", track: null, energy_names: [],
    weights: data.nodes.map(() => 1), made: { note, clock }, time: block(1, times),
    position: block(2 * nodes, position.flat()),
    force: force ? block(data.members.length, force.flat()) : null, contact: null };
}

const withMotion = (data, motion) => ({ ...data, motion, equilibria: null, equilibria_remark: "", summary: [] });

/* ---- modes ---- */

/** The data of a page on which a mode of the result swings. */
export function modeData(data, json, index) {
  const mode = json.modes[index], rest = flat(data, json.nodes), shape = flat(data, mode.shape);
  data.nodes.forEach((node, i) => {
    if (!mode.shape[node.name]) shape[2 * i] = shape[2 * i + 1] = 0;
  });
  const most = shape.reduce((a, b) => Math.max(a, Math.abs(b)), 0) || 1, scale = SWING * data.size / most;
  const count = PERIODS * FRAMES + 1, times = [], position = [];
  for (let f = 0; f < count; f++) {
    const part = scale * Math.sin(2 * Math.PI * f / FRAMES);
    times.push(LASTS * f / (count - 1));
    position.push(rest.map((x, i) => x + part * shape[i]));
  }
  const text = "mode " + (index + 1) + ": " + page.quantity(mode.frequency, "Hz", 5);
  return withMotion(data, motionOf(data, { times, position, clock: times.map(() => text),
    note: "A mode of vibration, its amplitude enlarged and its time slowed down." }));
}

function modeButton(mode, index, onPick) {
  const damping = mode.damping_ratio === null || mode.damping_ratio === undefined ? ""
    : ", damping ratio " + Number(mode.damping_ratio.toPrecision(3));
  const button = make("button", { type: "button", "aria-pressed": "false" }, make("span", { textContent: String(index + 1) }),
    make("span", { textContent: page.quantity(mode.frequency, "Hz", 5) }),
    make("span", { textContent: mode.kind + damping + ": " + (mode.description || "") }));
  button.addEventListener("click", () => onPick(index));
  return button;
}

/* ---- paths ---- */

/* What varies along a path: a load factor, or the value of what was asked for. */
const valueOf = (json, point) => (json.over && point.value !== undefined ? point.value : point.factor);

/** The data of a page whose frames are the points of a path. */
export function pathData(data, json) {
  const points = json.points, what = json.over || "factor", unit = json.unit || "";
  const force = points.map((p) => data.members.map((m) => (p.forces || {})[m.name] || 0));
  const times = points.map((_, i) => LASTS * i / Math.max(1, points.length - 1));
  return withMotion(data, motionOf(data, { times, position: points.map((p) => flat(data, p.nodes)), force,
    clock: points.map((p) => what + " " + valueText(valueOf(json, p), unit, 5) +
      (p.stable === null || p.stable === undefined ? "" : p.stable ? ", stable" : ", unstable")),
    note: "The points of a path of equilibria, one a frame." }));
}

/* Coordinates of nodes as displacements along the path, those that move most first. */
function coordinatesOf(data, json) {
  const found = data.nodes.flatMap(({ name }) => ["x", "y"].map((axis, d) => {
    const values = json.points.map((p) => (p.nodes[name] ? p.nodes[name][d] - json.points[0].nodes[name][d] : 0));
    return { name: name + " " + axis, values, range: Math.max(...values) - Math.min(...values) };
  }));
  return found.filter((c) => c.range > 0).sort((a, b) => b.range - a.range);
}

const SVG = "http://www.w3.org/2000/svg";
function draw(tag, attributes, text) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

function axisOf(values, from, to) {
  const low = Math.min(0, ...values), high = Math.max(0, ...values), span = high - low || 1;
  return { low, high, at: (value) => from + (value - low) / span * (to - from) };
}

/* Pieces of the line that are alike in stability, as points of polylines. */
function piecesOf(points, at) {
  const pieces = [];
  points.forEach((point, i) => {
    const kind = point.stable === false ? "unstable" : "stable", last = pieces[pieces.length - 1];
    if (last && last.kind === kind) last.points.push(at(i));
    else pieces.push({ kind, points: last ? [last.points[last.points.length - 1], at(i)] : [at(i)] });
  });
  return pieces;
}

/* A chart of factor over displacement; its cursor is the frame shown. */
function fillChart(svg, json, coordinate) {
  const width = svg.clientWidth || 600, height = 260, points = json.points;
  const factors = points.map((p) => valueOf(json, p));
  const x = axisOf(coordinate.values, 58, width - 14), y = axisOf(factors, height - 34, 12);
  const at = (i) => [x.at(coordinate.values[i]), y.at(factors[i])];
  const label = (x_, y_, anchor, text) => draw("text", { x: x_, y: y_, "text-anchor": anchor }, text);
  const dot = draw("circle", { r: 5 });
  svg.setAttribute("viewBox", "0 0 " + width + " " + height);
  svg.replaceChildren(
    draw("path", { class: "axis", d: `M58 ${y.at(0)}H${width - 14}M${x.at(0)} 12V${height - 34}` }),
    ...piecesOf(points, at).map((piece) =>
      draw("polyline", { class: piece.kind, points: piece.points.map((p) => p.join()).join(" ") })),
    label(54, height - 34, "end", valueText(y.low, json.unit, 3)),
    label(54, 20, "end", valueText(y.high, json.unit, 3)),
    label(58, height - 18, "start", page.quantity(x.low, "m", 3)),
    label(width - 14, height - 18, "end", page.quantity(x.high, "m", 3)),
    label(width / 2, height - 4, "middle",
      (json.over || "factor") + " over the displacement of " + coordinate.name), dot);
  return { at,
    show(frame) {
      const [cx, cy] = at(Math.min(frame, points.length - 1));
      dot.setAttribute("cx", cx);
      dot.setAttribute("cy", cy);
    } };
}

function nearest(count, at, x, y) {
  let best = 0, least = Infinity;
  for (let i = 0; i < count; i++) {
    const [px, py] = at(i), away = Math.hypot(px - x, py - y);
    if (away < least) least = away, best = i;
  }
  return best;
}

function createPathChart(data, json) {
  const coordinates = coordinatesOf(data, json), 
    select = make("select", { "aria-label": "Displacement that the chart shows" });
  select.append(...coordinates.map((c, i) => make("option", { value: i, textContent: c.name })));
  const svg = draw("svg", { class: "path-chart", role: "img", "aria-label": "The path; drag to move along it" });
  let chart = null;
  const redraw = () => {
    if (!coordinates.length) return;
    chart = fillChart(svg, json, coordinates[Number(select.value)]);
    chart.show(window.strut.frame);
  };
  const seek = (event) => {
    const box = svg.getBoundingClientRect();
    if (chart && event.buttons)
      page.seek(nearest(json.points.length, chart.at, event.clientX - box.left, event.clientY - box.top));
  };
  select.addEventListener("change", redraw);
  svg.addEventListener("pointerdown", seek);
  svg.addEventListener("pointermove", seek);
  new ResizeObserver(redraw).observe(svg);
  const label = make("label", {}, "Displacement of ", select);
  return { label, svg, show: (frame) => chart && chart.show(frame) };
}

/* ---- the section ---- */

/**
 * The section #found below the stage, with the cards of equilibria behind it. onShow(data) shows data on the page,
 * onBack() what was there before; onOver(what) follows another path: "" all loads, else a parameter or an actuator.
 */
export function createFound({ onShow, onBack, onOver }) {
  const host = make("section", { id: "found", hidden: true, "aria-label": "Result" });
  document.getElementById("live").before(host, document.getElementById("cards-section"));
  let onFrame = null, chosen = -1; /* mode */
  page.onFrame = (frame) => { if (onFrame) onFrame(frame); };

  function open(title, ...parts) {
    const back = make("button", { type: "button", className: "save", textContent: "Close" });
    back.addEventListener("click", () => {
      close();
      onBack();
    });
    host.replaceChildren(make("div", { className: "bar" }, make("h2", { textContent: title }), back), ...parts);
    host.hidden = false;
  }
  function close() {
    onFrame = null;
    host.hidden = true;
    host.replaceChildren();
  }
  const tableOf = (table) => make("details", {}, make("summary", { textContent: "As a table" }),
    make("pre", { textContent: page.micro(table) }));

  function overChoice(choices, over) {
    const select = make("select", { id: "over" });
    select.append(...choices.map(([value, text]) => make("option", { value, textContent: text })));
    select.value = over;
    select.addEventListener("change", () => onOver(select.value));
    return make("label", {}, "Vary ", select);
  }

  return { close,
    showTable: (title, table) => open(title, make("pre", { textContent: page.micro(table) })),
    /** A table folded under a hint, where the page shows the result itself. */
    showHint: (title, hint, table) => open(title, make("p", { className: "hint", textContent: hint }), tableOf(table)),
    showModes(data, json, table) {
      const list = make("div", { className: "mode-list" });
      const pick = async (index) => {
        chosen = index;
        [...list.children].forEach((b, i) => b.setAttribute("aria-pressed", String(i === index)));
        await onShow(modeData(data, json, index));
        window.strut.play();
      };
      list.append(...json.modes.map((mode, i) => modeButton(mode, i, pick)));
      open("Modes of vibration at " + json.at, list, tableOf(table));
      const first = json.modes.findIndex((mode) => mode.frequency > 0);
      if (json.modes.length) pick(chosen >= 0 && chosen < json.modes.length ? chosen : Math.max(first, 0));
    },
    /** The choice of what varies alone where json is null. */
    async showPath(data, json, table, choices, over) {
      const choice = overChoice(choices, over);
      if (!json) return open("Path", choice);
      const chart = createPathChart(data, json);
      const events = json.events.map((e) => make("p", { className: "hint",
        textContent: e.kind + " at " + valueText(valueOf(json, e), json.unit, 5) + ": " + (e.detail || "") }));
      const bar = make("div", { className: "bar" }, choice, chart.label);
      open("Path of equilibria", bar, chart.svg, ...events, tableOf(table));
      onFrame = chart.show;
      await onShow(pathData(data, json));
      chart.show(window.strut.frame);
    }
  };
}

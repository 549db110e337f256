/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of models: each with its picture, drawn as on the stage when it comes into view. */
import { make } from "./files.js";

const page = window.strutPage;

function drawPicture(canvas, data) {
  const structure = page.structureOf(data), surface = page.prepareCanvas(canvas);
  const camera = page.fit(page.boundsOf(data.start), surface.width, surface.height, 8, data.size);
  page.drawStructure(surface, structure, { position: data.start, force: null, contact: null }, camera,
    { theme: page.theme(), colour: false, arrows: false, small: true });
}

function createEntry(model) {
  const place = model.group + "/" + model.name, canvas = make("canvas");
  const title = [place, model.data.description].filter(Boolean).join(": ");
  const button = make("button", { type: "button", className: "model", title, "aria-pressed": "false" }, canvas,
    make("span", { textContent: model.data.name || model.name }));
  button.dataset.model = place;
  return { button, canvas, model };
}

/** Fills the list with models {group, name, text, files, data}; onPick(model) when one is chosen. */
export function createModelList(models, onPick) {
  const host = document.getElementById("model-list"), filter = document.getElementById("model-filter");
  const entries = models.map(createEntry), seen = new Set();
  const watcher = new IntersectionObserver((changes) => {
    for (const { target, isIntersecting } of changes) {
      const entry = entries.find((e) => e.button === target);
      if (!isIntersecting || seen.has(entry)) continue;
      seen.add(entry);
      drawPicture(entry.canvas, entry.model.data);
    }
  });
  for (const entry of entries) {
    entry.button.addEventListener("click", () => onPick(entry.model));
    watcher.observe(entry.button);
  }
  host.append(...entries.map((e) => e.button));
  filter.addEventListener("input", () => {
    const wanted = filter.value.toLowerCase();
    for (const { button, model } of entries)
      button.hidden = !(model.name + " " + model.data.name + " " + model.data.description).toLowerCase()
        .includes(wanted);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    for (const entry of seen) drawPicture(entry.canvas, entry.model.data);
  });
  return {
    /** Marks the model that is open; null: none is. */
    mark(model) {
      for (const entry of entries) entry.button.setAttribute("aria-pressed", String(entry.model === model));
    }
  };
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The engine's side of a Worker: one request after the other, each answered with what the page asked for.
 *
 * Received: {wasm: WebAssembly.Module} first; then {id, scene, call, ...} as Engine.ask sends it. Sent: {ready: true},
 * {id, progress}, {id, answer} or {id, failure}.
 */
import { StrutError, load, open, schema } from "../package/index.js";

/* The scene that was opened last: a slider changes settings, not the text. */
let last = { key: null, scene: null };

async function sceneOf({ text, name, files, settings }) {
  const key = JSON.stringify([text, name, files]);
  if (last.key !== key) {
    if (last.scene) last.scene.close();
    last = { key: null, scene: null };
    last = { key, scene: await open(text, { name, files }) };
  }
  const given = Object.entries(settings || {});
  return given.length ? last.scene.with(settings) : last.scene;
}

/* What can be asked of a scene and of a result, by name. */
const OF_SCENE = {
  page: (scene, options) => JSON.parse(scene.pageData(options)),
  warnings: (scene) => scene.warnings,
  names: (scene) => Object.fromEntries(scene.names("kinds").map((kind) => [kind, scene.names(kind)])),
  resolved: (scene) => scene.json(),
  yaml: (scene) => scene.yaml({ parts: true })
};
const OF_RESULT = {
  page: (result) => JSON.parse(result.pageData()),
  json: (result) => result.json,
  text: (result) => result.jsonText,
  table: (result) => result.table,
  warnings: (result) => result.warnings,
  yaml: (result) => result.yaml()
};

function pick(from, thing, wanted, options) {
  return Object.fromEntries((wanted || []).map((name) => [name, from[name](thing, options)]));
}

/* A failure as plain data, which a Worker can send. */
function failureOf(error) {
  if (!(error instanceof StrutError))
    return { status: -1, message: String(error), report: String(error), messages: [] };
  const { status, message, report, messages } = error;
  return { status, message, report, messages };
}

async function answer({ id, scene: asked, call, options, axes, points, limit, want }) {
  if (call === "schema") return schema();
  const scene = await sceneOf(asked);
  const control = { limit, progress: (fraction) => { self.postMessage({ id, progress: fraction }); } };
  if (!call) return pick(OF_SCENE, scene, want, options);
  const result = call === "sweep" ? scene.sweep(axes, points, options, control) : scene[call](options, control);
  try {
    return {
      status: result.status,
      failure: result.error && failureOf(result.error),
      ...pick(OF_RESULT, result, want)
    };
  } finally {
    result.close();
    if (scene !== last.scene) scene.close();
  }
}

let queue = Promise.resolve();

self.onmessage = ({ data }) => {
  if (data.wasm) {
    queue = load({ wasm: data.wasm }).then(() => self.postMessage({ ready: true }));
    return;
  }
  queue = queue.then(() => answer(data)).then(
    (found) => self.postMessage({ id: data.id, answer: found }),
    (error) => self.postMessage({ id: data.id, failure: failureOf(error) }));
};

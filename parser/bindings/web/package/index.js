/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut in WebAssembly: the program's computations, with the same names, messages and bits.
 *
 *   import { open } from "strut-wasm";
 *   const scene = await open(yaml);
 *   console.log(scene.run({ accuracy: "0.5 %" }).number("velocity"));
 *
 * It is the interface of strut's library (abi.h) with JavaScript's objects: see index.d.ts.
 */
import createModule from "./strut.mjs";
import {
  StrutError, arrayOf, attempt, flagOf, list, module, must, numberOf, pairs, taken, textAt, use, withMemory
} from "./memory.js";

export { StrutError };

/* ---- the module ---- */

let loading = null;

/* The module's file, beside this one: read in node, fetched elsewhere. */
async function ownFile() {
  const url = new URL("./strut.wasm", import.meta.url);
  if (url.protocol !== "file:") return (await fetch(url)).arrayBuffer();
  return (await import("node:fs/promises")).readFile(url);
}

async function start(wasm) {
  const compiled = wasm instanceof WebAssembly.Module ? wasm
    : await WebAssembly.compile(wasm || await ownFile());
  use(await createModule({
    locateFile: (name) => name, /* nothing is fetched */
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(compiled, imports).then(done);
      return {};
    }
  }));
}

/** Loads the module once. `wasm`: its bytes or a WebAssembly.Module, where its file is not beside this one. */
export function load({ wasm } = {}) {
  loading ||= start(wasm);
  return loading;
}

/** Opens a scene's text, in YAML or JSON; see Scene. */
export async function open(text, options) {
  await load();
  return openScene(text, options);
}

export const version = () => textAt(module()._strutlib_version());
export const statusName = (status) => textAt(module()._strutlib_status_name(status));
export const statusText = (status) => textAt(module()._strutlib_status_text(status));

/** The language as a JSON Schema, an object; with `study` that of studies. */
export function schema({ study = false } = {}) {
  return JSON.parse(taken(must((_, error) => module()._strutlib_schema(study ? 1 : 0, error))));
}

/** {name: help} of the options that a call has. */
export function optionsOf(call) {
  return withMemory((place) => {
    const name = place.text(call), found = {};
    list((i) => module()._strutlib_option_name(name, i)).forEach((option, i) => {
      found[option] = textAt(module()._strutlib_option_help(name, i));
    });
    return found;
  });
}

/** All channels: [{name, kind, components, columns}]. */
export function channels() {
  return list((i) => module()._strutlib_channel(i)).map((name) => withMemory((place) => {
    const at = place.text(name);
    return {
      name,
      kind: textAt(module()._strutlib_channel_kind(at)),
      components: list((i) => module()._strutlib_channel_component(at, i)),
      columns: list((i) => module()._strutlib_channel_column(at, i))
    };
  }));
}

/* ---- what owns memory of the module ---- */

const forgotten = new FinalizationRegistry(({ free, handle }) => free(handle));

class Owner {
  #handle;
  #free;
  constructor(handle, free) {
    this.#handle = handle;
    this.#free = free;
    forgotten.register(this, { free, handle }, this);
  }
  /** Of the module; an error once it is closed. */
  get handle() {
    if (!this.#handle) throw new Error("this " + this.constructor.name.toLowerCase() + " is closed");
    return this.#handle;
  }
  /** Releases its memory now rather than when JavaScript collects it. */
  close() {
    if (!this.#handle) return;
    forgotten.unregister(this);
    this.#free(this.#handle);
    this.#handle = 0;
  }
}

/* ---- scenes ---- */

/* Folders of files that scenes name, below /scenes. */
let folders = 0;

function openScene(text, { name = "scene.yaml", settings = {}, files = {} } = {}) {
  const folder = "/scenes/" + folders++, fs = module().FS;
  fs.mkdirTree(folder);
  for (const [path, content] of Object.entries(files)) {
    const whole = folder + "/" + path;
    fs.mkdirTree(whole.slice(0, whole.lastIndexOf("/")));
    fs.writeFile(whole, content);
  }
  fs.chdir(folder);
  const bytes = new TextEncoder().encode(text).length;
  return new Scene(must((place, error) => {
    const p = pairs(place, settings);
    return module()._strutlib_open_text(place.text(name), place.text(text), bytes, p.count, p.names,
      p.values, error);
  }), folder);
}

/** A scene as it was opened, with its settings: constant. */
export class Scene extends Owner {
  #folder;
  constructor(handle, folder) {
    super(handle, (scene) => module()._strutlib_close(scene));
    this.#folder = folder;
  }
  /** The scene's handle, with the files that it names in their place. */
  get ready() {
    module().FS.chdir(this.#folder);
    return this.handle;
  }
  with(settings) {
    const scene = this.ready;
    return new Scene(must((place, error) => {
      const p = pairs(place, settings);
      return module()._strutlib_scene_with(scene, p.count, p.names, p.values, error);
    }), this.#folder);
  }
  get warnings() { return list((i) => module()._strutlib_scene_warning(this.handle, i)); }
  names(kind) {
    return withMemory((place) => {
      const at = place.text(kind);
      return list((i) => module()._strutlib_name(this.handle, at, i));
    });
  }
  number(name) {
    return numberOf((place, at) => module()._strutlib_scene_number(this.handle, place.text(name), at));
  }
  flag(name) {
    return flagOf((place, at) => module()._strutlib_scene_flag(this.handle, place.text(name), at));
  }
  text(name) {
    return withMemory((place) => textAt(module()._strutlib_scene_text(this.handle, place.text(name))));
  }
  array(name) {
    return arrayOf((place, ...to) =>
      module()._strutlib_scene_array(this.handle, place.text(name), ...to));
  }
  yaml({ parts = false } = {}) {
    return taken(must((_, error) => module()._strutlib_scene_yaml(this.ready, parts ? 1 : 0, error)));
  }
  json() {
    return JSON.parse(taken(must((_, error) => module()._strutlib_scene_json(this.ready, error))));
  }
  svg() { return taken(must((_, error) => module()._strutlib_scene_svg(this.ready, error))); }
  pageData({ equilibria = false } = {}) {
    return taken(must((_, error) =>
      module()._strutlib_scene_page_data(this.ready, equilibria ? 1 : 0, 0, error)));
  }
  simulate(options) {
    return new Simulation(must((place, error) => {
      const p = pairs(place, options);
      return module()._strutlib_simulation_open(this.ready, p.count, p.names, p.values, 0, error);
    }));
  }
  /**
   * Points of a parameter study: axes are names, points rows of values, in SI units or words. `keep`: columns;
   * the other options as of `strut sweep`.
   */
  sweep(axes, points, { keep = [], ...options } = {}, control) {
    return compute(control, (place, handle, error) => {
      const p = pairs(place, options), flat = points.flat();
      const numbers = flat.map((value) => (typeof value === "number" ? value : NaN));
      const words = flat.map((value) => (typeof value === "number" ? null : String(value)));
      return module()._strutlib_sweep(
        this.ready, axes.length, place.texts(axes), axes.length ? points.length : 1,
        place.numbers(numbers), words.some((w) => w !== null) ? place.texts(words) : 0, keep.length,
        place.texts(keep), p.count, p.names, p.values, 0, 0, handle, error);
    });
  }
}

/* ---- computing ---- */

/* The functions of abi.h that are called alike (STRUTLIB_CALLS). */
export const CALLS = ["run", "equilibria", "modes", "rigidity", "form", "path", "matrices"];

for (const call of CALLS)
  Scene.prototype[call] = function (options, control) {
    return compute(control, (place, handle, error) => {
      const p = pairs(place, options);
      return module()["_strutlib_" + call](this.ready, p.count, p.names, p.values, handle, error);
    });
  };

/* The progress of the call under way: of one at a time, since it lasts until the call is done. */
let onProgress = null, progressAt = 0;

/* `control`: {progress(fraction): true to stop, limit: seconds after which it stops}. What was computed until then is
   the result, with its status and its error. */
function compute({ progress, limit } = {}, call) {
  const engine = module(), control = engine._strutlib_control_create();
  const end = limit ? performance.now() + 1000 * limit : Infinity, before = onProgress;
  onProgress = (fraction) =>
    ((progress && progress(fraction)) || performance.now() > end ? 1 : 0);
  progressAt ||= engine.addFunction((_, fraction) => onProgress(fraction), "iid");
  engine._strutlib_control_on_progress(control, progressAt, 0);
  try {
    const { value, error } = attempt((place, at) => call(place, control, at));
    if (!value) throw error;
    return new Result(value, error);
  } finally {
    onProgress = before;
    engine._strutlib_control_free(control);
  }
}

/** What a call computed: constant. */
export class Result extends Owner {
  #json;
  constructor(handle, error) {
    super(handle, (result) => module()._strutlib_result_free(result));
    this.error = error; /* why it is not whole, or null */
  }
  get status() { return module()._strutlib_result_status(this.handle); }
  get command() { return textAt(module()._strutlib_result_command(this.handle)); }
  /** The program's --json, byte for byte, and the same as an object. */
  get jsonText() { return textAt(module()._strutlib_result_json(this.handle)); }
  get json() { return (this.#json ||= JSON.parse(this.jsonText)); }
  get table() { return textAt(module()._strutlib_result_table(this.handle)); }
  get warnings() { return list((i) => module()._strutlib_result_warning(this.handle, i)); }
  number(name) {
    return numberOf((place, at) => module()._strutlib_result_number(this.handle, place.text(name), at));
  }
  flag(name) {
    return flagOf((place, at) => module()._strutlib_result_flag(this.handle, place.text(name), at));
  }
  text(name) {
    return withMemory((place) => textAt(module()._strutlib_result_text(this.handle, place.text(name))));
  }
  array(name) {
    return arrayOf((place, ...to) =>
      module()._strutlib_result_array(this.handle, place.text(name), ...to));
  }
  get arrays() { return list((i) => module()._strutlib_result_array_name(this.handle, i)); }
  unit(name) {
    return withMemory((place) =>
      textAt(module()._strutlib_result_array_unit(this.handle, place.text(name))));
  }
  get columns() { return list((i) => module()._strutlib_result_column(this.handle, i)); }
  cell(column, point) {
    return withMemory((place) =>
      textAt(module()._strutlib_result_cell(this.handle, place.text(column), point)));
  }
  yaml() { return taken(must((_, error) => module()._strutlib_result_yaml(this.handle, error))); }
  svg(options) {
    return taken(must((place, error) => {
      const p = pairs(place, options);
      return module()._strutlib_result_svg(this.handle, p.count, p.names, p.values, error);
    }));
  }
  pageData() {
    return taken(must((_, error) => module()._strutlib_result_page_data(this.handle, error)));
  }
}

/** A run that is advanced from outside. */
export class Simulation extends Owner {
  constructor(handle) {
    super(handle, (simulation) => module()._strutlib_simulation_close(simulation));
  }
  advance(steps = 1) {
    must((_, error) => module()._strutlib_simulation_advance(this.handle, steps, error));
    return this;
  }
  get time() { return module()._strutlib_simulation_time(this.handle); }
  get step() { return module()._strutlib_simulation_step(this.handle); }
  get inputWork() { return module()._strutlib_simulation_input_work(this.handle); }
  array(name) {
    return arrayOf((place, ...to) =>
      module()._strutlib_simulation_array(this.handle, place.text(name), ...to));
  }
  /** set("rest", "m8", 0.12); set("load", "n1.x", 3). */
  set(input, name, value) {
    must((place, error) =>
      module()._strutlib_simulation_set(this.handle, place.text(input), place.text(name), value, error));
    return this;
  }
  snapshot() {
    return new Snapshot(must((_, error) =>
      module()._strutlib_simulation_snapshot(this.handle, error)));
  }
  restore(snapshot) {
    must((_, error) =>
      module()._strutlib_simulation_restore(this.handle, snapshot.handle, error));
    return this;
  }
}

/** A stored state of a simulation. */
export class Snapshot extends Owner {
  constructor(handle) {
    super(handle, (snapshot) => module()._strutlib_snapshot_free(snapshot));
  }
}

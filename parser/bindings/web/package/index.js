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
  STATUS, StrutError, arrayOf, attempt, failed, flagOf, list, module, must, numberOf, pairs, taken, textAt, use,
  withMemory, writeArray, wrongUse
} from "./memory.js";

export { StrutError };

/* ---- the module ---- */

let loading = null, compiled = null;

/* The module's file, beside this one: read in node, fetched elsewhere. */
async function ownFile() {
  const url = new URL("./strut.wasm", import.meta.url);
  if (url.protocol !== "file:") return (await fetch(url)).arrayBuffer();
  return (await import("node:fs/promises")).readFile(url);
}

async function start(wasm) {
  if (wasm instanceof WebAssembly.Module) compiled = wasm;
  else compiled ||= await WebAssembly.compile(wasm || await ownFile());
  use(await createModule({
    locateFile: (name) => name, /* nothing is fetched */
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(compiled, imports).then(done);
      return {};
    }
  }));
}

/**
 * Loads the module once, and again where it failed. `wasm`: its bytes or a WebAssembly.Module, where its file is not
 * beside this one.
 */
export function load({ wasm } = {}) {
  if (failed()) loading = null;
  loading ||= start(wasm).catch((error) => {
    loading = null;
    throw error;
  });
  return loading;
}

/** Opens a scene's text, in YAML or JSON; see Scene. */
export async function open(text, options) {
  await load();
  return openScene(text, options);
}

/* ---- functions of the module ---- */

/* Arguments that need memory while a call lasts: a text, or options as an object, which are three. */
const text = (value) => (place) => [place.text(value)];
const options = (given) => (place) => pairs(place, given);
const put = (place, given) => given.flatMap((one) => (typeof one === "function" ? one(place) : one));

/* What strutlib_NAME returns; of one that may fail, whose error is thrown; of one that counts, all its texts. */
const call = (name, ...given) => withMemory((place) => module()["_strutlib_" + name](...put(place, given)));
const ask = (name, ...given) =>
  must((place, error) => module()["_strutlib_" + name](...put(place, given), error));
const all = (name, ...given) => withMemory((place) => {
  const pointers = put(place, given);
  return list((i) => module()["_strutlib_" + name](...pointers, i));
});

export const version = () => textAt(call("version"));
export const statusName = (status) => textAt(call("status_name", status));
export const exitCode = (status) => call("exit_code", status);
export const statusText = (status) => textAt(call("status_text", status));

/** The language as a JSON Schema, an object; with `study` that of studies. */
export const schema = ({ study = false } = {}) => JSON.parse(taken(ask("schema", study ? 1 : 0)));

/** {name: help} of the options that a call has: one of CALLS, "sweep" or "simulate". */
export function optionsOf(of) {
  const command = text(of === "simulate" ? "simulation_open" : of), helps = all("option_help", command);
  return Object.fromEntries(all("option_name", command).map((name, i) => [name, helps[i]]));
}

/** All channels: [{name, kind, components, columns}]. */
export const channels = () => all("channel").map((name) => ({
  name,
  kind: textAt(call("channel_kind", text(name))),
  components: all("channel_component", text(name)),
  columns: all("channel_column", text(name))
}));

/* ---- what owns memory of the module ---- */

const forgotten = new FinalizationRegistry((owned) => release(owned));

/* Of a module that failed nothing is released: it goes as a whole. */
function release({ engine, handle, free }) {
  if (!engine.failure) free(engine, handle);
}

class Owner {
  #owned;
  constructor(handle, free) {
    this.#owned = { engine: module(), handle, free };
    forgotten.register(this, this.#owned, this);
  }
  /** Of the module; an error once it is closed, or its module failed. */
  get handle() {
    if (!this.#owned) throw wrongUse("this " + this.constructor.name.toLowerCase() + " is closed");
    if (this.#owned.engine.failure) throw this.#owned.engine.failure;
    return this.#owned.handle;
  }
  /** Releases its memory now rather than when JavaScript collects it. */
  close() {
    if (!this.#owned) return;
    forgotten.unregister(this);
    release(this.#owned);
    this.#owned = null;
  }
}
if (Symbol.dispose) Owner.prototype[Symbol.dispose] = Owner.prototype.close;

/* Values and arrays by dotted name of what the module's functions strutlib_OF_... know. */
class Values extends Owner {
  #of;
  constructor(handle, free, of) {
    super(handle, free);
    this.#of = of;
  }
  #find(what, place, name, ...to) {
    return module()["_strutlib_" + this.#of + "_" + what](this.handle, place.text(name), ...to);
  }
  number(name) { return numberOf((place, at) => this.#find("number", place, name, at)); }
  flag(name) { return flagOf((place, at) => this.#find("flag", place, name, at)); }
  text(name) { return textAt(call(this.#of + "_text", this.handle, text(name))); }
  array(name) { return arrayOf((place, ...to) => this.#find("array", place, name, ...to)); }
}

/* ---- scenes ---- */

/* The folder in which a scene's files are, below /scenes; gone with the last scene that has it. */
let folders = 0;

class Folder {
  #users = 0;
  constructor(files) {
    this.fs = module().FS;
    this.path = Object.keys(files).length ? "/scenes/" + folders++ : "/scenes";
    this.#make(this.path);
    for (const [name, content] of Object.entries(files)) this.#write(name, content);
  }
  #make(path) {
    if (!this.fs.analyzePath(path).exists) this.fs.mkdirTree(path);
  }
  #write(name, content) {
    const whole = this.path + "/" + name;
    try {
      this.#make(whole.slice(0, whole.lastIndexOf("/")));
      this.fs.writeFile(whole, content);
    } catch (error) {
      throw new StrutError({
        status: STATUS.FILE_TROUBLE, message: "cannot store the file '" + name + "': " + (error.message || error)
      });
    }
  }
  enter() { this.fs.chdir(this.path); }
  join() { this.#users++; }
  leave() {
    if (--this.#users || this.path === "/scenes") return;
    this.fs.chdir("/scenes");
    this.#remove(this.path);
  }
  #remove(path) {
    for (const name of this.fs.readdir(path)) {
      if (name === "." || name === "..") continue;
      const whole = path + "/" + name;
      if (this.fs.isDir(this.fs.stat(whole).mode)) this.#remove(whole);
      else this.fs.unlink(whole);
    }
    this.fs.rmdir(path);
  }
}

function openScene(text, { name = "scene.yaml", settings = {}, files = {} } = {}) {
  const folder = new Folder(files);
  folder.join();
  try {
    folder.enter();
    const source = (place) => [place.text(name), ...place.whole(text)];
    return new Scene(ask("open_text", source, options(settings)), folder);
  } finally {
    if (!failed()) folder.leave();
  }
}

/** A scene as it was opened, with its settings: constant. */
export class Scene extends Values {
  #folder;
  constructor(handle, folder) {
    super(handle, (engine, scene) => {
      engine._strutlib_close(scene);
      folder.leave();
    }, "scene");
    folder.join();
    this.#folder = folder;
  }
  /** The scene's handle, with the files that it names in their place. */
  get ready() {
    const handle = this.handle;
    this.#folder.enter();
    return handle;
  }
  with(settings) { return new Scene(ask("scene_with", this.ready, options(settings)), this.#folder); }
  get warnings() { return all("scene_warning", this.handle); }
  names(kind) { return all("name", this.handle, text(kind)); }
  index(kind, name) { return call("index", this.handle, text(kind), text(name)); }
  yaml({ parts = false } = {}) { return taken(ask("scene_yaml", this.ready, parts ? 1 : 0)); }
  json() { return JSON.parse(taken(ask("scene_json", this.ready))); }
  svg() { return taken(ask("scene_svg", this.ready)); }
  pageData({ equilibria = false } = {}) {
    return taken(ask("scene_page_data", this.ready, equilibria ? 1 : 0, 0));
  }
  simulate(given) { return new Simulation(ask("simulation_open", this.ready, options(given), 0)); }
  /**
   * Points of a parameter study: axes are names, points rows of values, in SI units or words. `keep`: columns;
   * the other options as of `strut sweep`. `control` may have row(point, status): true to stop.
   */
  sweep(axes, points, { keep = [], ...given } = {}, control = {}) {
    for (const each of [axes, points, keep]) if (!Array.isArray(each)) throw wrongUse("expected a list");
    if (points.some((point) => !Array.isArray(point) || point.length !== axes.length))
      throw wrongUse("every point needs " + axes.length + " values, one of each axis");
    return compute(control, (place, handle, error) => {
      const flat = points.flat();
      const numbers = flat.map((value) => (typeof value === "number" ? value : NaN));
      const words = flat.map((value) => (typeof value === "number" ? null : String(value)));
      return module()._strutlib_sweep(
        this.ready, axes.length, place.texts(axes), axes.length ? points.length : 1, place.numbers(numbers),
        words.some((word) => word !== null) ? place.texts(words) : 0, keep.length, place.texts(keep),
        ...pairs(place, given), control.row ? callbacks().row : 0, 0, handle, error);
    });
  }
}

/* ---- computing ---- */

/* The functions of abi.h that are called alike (STRUTLIB_CALLS). */
export const CALLS = ["run", "equilibria", "modes", "rigidity", "form", "path", "matrices"];

for (const name of CALLS)
  Scene.prototype[name] = function (given, control) {
    return compute(control, (place, handle, error) =>
      module()["_strutlib_" + name](this.ready, ...pairs(place, given), handle, error));
  };

/* Who hears of the call under way: of one at a time, since it lasts until the call is done. */
let listener = null;

/* What a listener throws is thrown once the call has ended: C must not be left by an exception. */
function heard(tell) {
  if (!listener) return 0;
  try {
    return tell(listener) ? 1 : 0;
  } catch (error) {
    listener.thrown ||= { error };
    return 1;
  }
}

/* The functions that the module calls, once for each module. */
function callbacks() {
  const engine = module();
  engine.callbacks ||= {
    progress: engine.addFunction((_, fraction) => heard((l) => l.progress(fraction)), "iid"),
    row: engine.addFunction((_, point, status) => heard((l) => l.row(point, status)), "iiii")
  };
  return engine.callbacks;
}

/* `control`: {progress(fraction): true to stop, limit: seconds after which it stops}. What was computed until then is
   the result, with its status and its error. */
function compute({ progress, row, limit } = {}, work) {
  const engine = module(), control = engine._strutlib_control_create(), before = listener;
  if (!control) throw new StrutError({ status: STATUS.NO_MEMORY, message: "out of memory" });
  const end = limit ? performance.now() + 1000 * limit : Infinity;
  const own = listener = {
    thrown: null,
    progress: (fraction) => (progress && progress(fraction) === true) || performance.now() > end,
    row: (point, status) => row(point, status) === true
  };
  try {
    engine._strutlib_control_on_progress(control, callbacks().progress, 0);
    const { value, error } = attempt((place, at) => work(place, control, at));
    if (value && own.thrown) engine._strutlib_result_free(value);
    if (own.thrown) throw own.thrown.error;
    if (!value) throw error;
    return new Result(value, error);
  } finally {
    listener = before;
    if (!engine.failure) engine._strutlib_control_free(control);
  }
}

/** What a call computed: constant. */
export class Result extends Values {
  #json;
  constructor(handle, error) {
    super(handle, (engine, result) => engine._strutlib_result_free(result), "result");
    this.error = error; /* why it is not whole, or null */
  }
  get status() { return call("result_status", this.handle); }
  get command() { return textAt(call("result_command", this.handle)); }
  /** The program's --json, byte for byte, and the same as an object. */
  get jsonText() { return textAt(call("result_json", this.handle)); }
  get json() { return (this.#json ||= JSON.parse(this.jsonText)); }
  get table() { return textAt(call("result_table", this.handle)); }
  get warnings() { return all("result_warning", this.handle); }
  get arrays() { return all("result_array_name", this.handle); }
  unit(name) { return textAt(call("result_array_unit", this.handle, text(name))); }
  get columns() { return all("result_column", this.handle); }
  cell(column, point) { return textAt(call("result_cell", this.handle, text(column), point)); }
  yaml() { return taken(ask("result_yaml", this.handle)); }
  svg(given) { return taken(ask("result_svg", this.handle, options(given))); }
  pageData() { return taken(ask("result_page_data", this.handle)); }
}

/** A run that is advanced from outside. */
export class Simulation extends Owner {
  constructor(handle) {
    super(handle, (engine, simulation) => engine._strutlib_simulation_close(simulation));
  }
  advance(steps = 1) {
    if (!Number.isInteger(steps) || steps < 0 || steps > 0x7fffffff)
      throw wrongUse("expected a number of steps, not " + String(steps));
    ask("simulation_advance", this.handle, steps);
    return this;
  }
  get time() { return call("simulation_time", this.handle); }
  get step() { return call("simulation_step", this.handle); }
  get inputWork() { return call("simulation_input_work", this.handle); }
  #find(what, name) {
    return (place, ...to) => module()["_strutlib_simulation_" + what](this.handle, place.text(name), ...to);
  }
  array(name) { return arrayOf(this.#find("array", name)); }
  /** What is written into an input, "rest", "actuators", "load" or "rates", as array() has it. */
  input(name) { return arrayOf(this.#find("input", name)); }
  /** All numbers of an input, in the order of C. */
  write(name, numbers) {
    const known = writeArray(numbers, this.#find("input", name));
    if (!known) throw wrongUse("there is no input '" + name + "'");
    return this;
  }
  /** set("rest", "m8", 0.12); set("load", "n1.x", 3). */
  set(input, name, value) {
    if (typeof value !== "number") throw wrongUse("the value of '" + name + "' is no number");
    ask("simulation_set", this.handle, text(input), text(name), value);
    return this;
  }
  snapshot() {
    return new Snapshot(ask("simulation_snapshot", this.handle));
  }
  restore(snapshot) {
    if (!(snapshot instanceof Snapshot)) throw wrongUse("expected a snapshot");
    ask("simulation_restore", this.handle, snapshot.handle);
    return this;
  }
}

/** A stored state of a simulation. */
class Snapshot extends Owner {
  constructor(handle) {
    super(handle, (engine, snapshot) => engine._strutlib_snapshot_free(snapshot));
  }
}

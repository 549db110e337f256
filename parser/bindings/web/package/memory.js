/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts, arrays and errors across the border of the WebAssembly module. */

let engine = null; /* the module, once it is there */

/** A call that failed: what the program would say. */
export class StrutError extends Error {
  constructor({ status, message, report, messages }) {
    super(message);
    this.name = "StrutError";
    this.status = status;
    this.report = report || message + "\n";
    this.messages = messages || [];
  }
}

/** The statuses that this side gives itself; FAILED is none of abi.h's: the engine is gone. */
export const STATUS = { USAGE: 1, FILE_TROUBLE: 8, NO_MEMORY: 9, FAILED: -1 };

export const wrongUse = (message) => new StrutError({ status: STATUS.USAGE, message });

/*
 * A trap (a stack that is too deep, an assertion, an abort) leaves the module's memory half changed: nothing of it is
 * used again, and load() starts another.
 */
function guarded(owner, call) {
  return (...given) => {
    if (owner.failure) throw owner.failure;
    try {
      return call(...given);
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError || error instanceof RangeError)) throw error;
      owner.failure = new StrutError({
        status: STATUS.FAILED,
        message: "strut's engine failed (" + error.message + "); load() starts another, and scenes are opened again"
      });
      throw owner.failure;
    }
  };
}

/** Makes this module the one that every call uses. */
export function use(module) {
  engine = Object.create(module, { failure: { value: null, writable: true } });
  for (const name of Object.keys(module))
    if (name.startsWith("_strutlib_") || name === "_malloc" || name === "_free")
      engine[name] = guarded(engine, module[name]);
}

/** The module; an error where nobody has loaded it, or it failed. */
export function module() {
  if (!engine) throw wrongUse("strut is not loaded: await load() first");
  if (engine.failure) throw engine.failure;
  return engine;
}

/** Did it fail? */
export const failed = () => engine !== null && engine.failure !== null;

/** A text that belongs to the module, or null. */
export const textAt = (pointer) => (pointer ? engine.UTF8ToString(pointer) : null);

/** A text that the caller releases: taken and released. */
export function taken(pointer) {
  const text = textAt(pointer);
  engine._strutlib_release(pointer);
  return text;
}

const encoder = new TextEncoder();

/* Bytes of a text as the module has them. Half a character of two becomes U+FFFD. */
function bytesOf(value) {
  if (typeof value !== "string") throw wrongUse("expected a text, not " + nameOf(value));
  return encoder.encode(value);
}

const nameOf = (value) => (value === null ? "null" : Array.isArray(value) ? "a list" : "a value of type " + typeof value);

/**
 * Calls work(place), in which place.text(t), place.bytes(t), place.texts(list), place.numbers(list) and
 * place.room(bytes) give pointers that are good until work returns.
 */
export function withMemory(work) {
  const blocks = [], used = module();
  const room = (bytes) => {
    const pointer = used._malloc(Math.max(8, bytes));
    if (!pointer) throw new StrutError({ status: STATUS.NO_MEMORY, message: "out of memory" });
    blocks.push(pointer);
    return pointer;
  };
  /* Its bytes and a zero behind them. */
  const put = (bytes) => {
    const pointer = room(bytes.length + 1), heap = used.HEAPU8;
    heap.set(bytes, pointer);
    heap[pointer + bytes.length] = 0;
    return pointer;
  };
  const place = {
    room,
    /** A text that may have zeros inside: pointer and length. */
    whole(value) {
      const bytes = bytesOf(value);
      return [put(bytes), bytes.length];
    },
    text(value) {
      if (value === null || value === undefined) return 0;
      const bytes = bytesOf(value);
      if (bytes.includes(0)) throw wrongUse("a name or value has a zero character");
      return put(bytes);
    },
    texts(list) {
      const pointers = list.map(place.text), at = room(4 * list.length);
      used.HEAPU32.set(pointers, at >>> 2);
      return at;
    },
    numbers(list) {
      const at = room(8 * list.length);
      used.HEAPF64.set(list, at >>> 3);
      return at;
    }
  };
  try {
    return work(place);
  } finally {
    if (!used.failure) for (const pointer of blocks) used._free(pointer);
  }
}

/** The error at a pointer, which is released; null where there is none. */
function errorAt(error) {
  if (!error) return null;
  const messages = [], count = engine._strutlib_error_count(error);
  const part = (name, i) => engine["_strutlib_error_" + name](error, i);
  for (let i = 0; i < count; i++) {
    const texts = ["text", "file", "source", "hint", "key"].map((name) => [name, textAt(part(name, i))]);
    const numbers = ["line", "column", "length"].map((name) => [name, part(name, i)]);
    messages.push(Object.fromEntries([...texts, ...numbers]));
  }
  const found = new StrutError({
    status: engine._strutlib_error_status(error),
    message: textAt(engine._strutlib_error_message(error)),
    report: textAt(engine._strutlib_error_report(error)),
    messages
  });
  engine._strutlib_error_free(error);
  return found;
}

/** {value, error} of call(place, pointer to the error). */
export function attempt(call) {
  return withMemory((place) => {
    const error = place.room(4);
    engine.HEAPU32[error >>> 2] = 0;
    const value = call(place, error);
    return { value, error: errorAt(engine.HEAPU32[error >>> 2]) };
  });
}

/** The value of that call; its error is thrown. */
export function must(call) {
  const { value, error } = attempt(call);
  if (error) throw error;
  return value;
}

/** What read(pointer) makes of what call(place, pointer to a double or an int) finds, or null. */
const found = (call, read) => withMemory((place) => {
  const at = place.room(8);
  return call(place, at) ? read(at) : null;
});
export const numberOf = (call) => found(call, (at) => engine.HEAPF64[at >>> 3]);
export const flagOf = (call) => found(call, (at) => engine.HEAPU32[at >>> 2] !== 0);

const DIMENSIONS = 4;

/* {first, shape, stride} in doubles of the array that call(place, &data, &dimensions, shape, stride) finds, or null. */
function placeOf(call) {
  return withMemory((place) => {
    const data = place.room(4), dimensions = place.room(4);
    const shapes = place.room(4 * DIMENSIONS), strides = place.room(4 * DIMENSIONS);
    if (!call(place, data, dimensions, shapes, strides)) return null;
    const heap = engine.HEAPU32, count = heap[dimensions >>> 2];
    const numbersAt = (at) => Array.from(heap.subarray(at >>> 2, (at >>> 2) + count));
    return { first: heap[data >>> 2] >>> 3, shape: numbersAt(shapes), stride: numbersAt(strides) };
  });
}

/* Calls each(place in the module, index in the order of C) for every number of an array. */
function forNumbers({ first, shape, stride }, each) {
  const size = shape.reduce((a, b) => a * b, 1), index = shape.map(() => 0);
  for (let i = 0, at = first; i < size; i++) {
    each(at, i);
    for (let d = shape.length - 1; d >= 0; d--) {
      at += stride[d];
      if (++index[d] < shape[d]) break;
      at -= stride[d] * shape[d];
      index[d] = 0;
    }
  }
}

/** {data, shape} of that array, copied in the order of C, or null. */
export function arrayOf(call) {
  const found = placeOf(call);
  if (!found) return null;
  const data = new Float64Array(found.shape.reduce((a, b) => a * b, 1)), heap = engine.HEAPF64;
  forNumbers(found, (at, i) => { data[i] = heap[at]; });
  return { data, shape: found.shape };
}

/** Writes as many numbers, in the order of C, into that array; false where there is none. */
export function writeArray(numbers, call) {
  const found = placeOf(call);
  if (!found) return false;
  const size = found.shape.reduce((a, b) => a * b, 1), heap = engine.HEAPF64;
  if (numbers.length !== size) throw wrongUse("expected " + size + " numbers, not " + numbers.length);
  forNumbers(found, (at, i) => { heap[at] = Number(numbers[i]); });
  return true;
}

/** The texts call(0), call(1), ... up to the first that is none. */
export function list(call) {
  const found = [];
  for (let text; (text = textAt(call(found.length))) !== null;) found.push(text);
  return found;
}

/* A setting as the program reads it: numbers as digits that keep every bit, yes and no, lists with commas. */
function written(name, value) {
  if (value === true) return "yes";
  if (value === false) return "no";
  if (typeof value === "number" || typeof value === "string") return String(value);
  if (Array.isArray(value)) return value.map((part) => written(name, part)).join(",");
  throw wrongUse("'" + name + "' is " + nameOf(value) + ", expected a number, a text, true or false");
}

/** Count, names and values of pairs given as an object. */
export function pairs(place, given = {}) {
  if (typeof given !== "object" || given === null || Array.isArray(given))
    throw wrongUse("expected an object of names and values, not " + nameOf(given));
  const entries = Object.entries(given).filter(([, value]) => value !== undefined);
  const values = entries.map(([name, value]) => written(name, value));
  return [entries.length, place.texts(entries.map(([name]) => name)), place.texts(values)];
}

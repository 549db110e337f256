/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts, arrays and errors across the border of the WebAssembly module. */

let engine = null; /* the module, once it is there */

/** Makes this module the one that every call uses. */
export function use(module) { engine = module; }

/** The module; an error where nobody has loaded it. */
export function module() {
  if (!engine) throw new Error("strut is not loaded: await load() first");
  return engine;
}

/** A text that belongs to the module, or null. */
export const textAt = (pointer) => (pointer ? engine.UTF8ToString(pointer) : null);

/** A text that the caller releases: taken and released. */
export function taken(pointer) {
  const text = textAt(pointer);
  engine._strutlib_release(pointer);
  return text;
}

/**
 * Calls work(place), in which place.text(t), place.texts(list), place.numbers(list) and place.room(bytes) give
 * pointers that are good until work returns.
 */
export function withMemory(work) {
  const blocks = [];
  const room = (bytes) => {
    const pointer = engine._malloc(Math.max(8, bytes));
    if (!pointer) throw new StrutError({ status: 9, message: "out of memory" });
    blocks.push(pointer);
    return pointer;
  };
  const place = {
    room,
    text(value) {
      if (value === null || value === undefined) return 0;
      const bytes = engine.lengthBytesUTF8(value) + 1, pointer = room(bytes);
      engine.stringToUTF8(value, pointer, bytes);
      return pointer;
    },
    texts(list) {
      const pointers = list.map(place.text), at = room(4 * list.length);
      engine.HEAPU32.set(pointers, at >> 2);
      return at;
    },
    numbers(list) {
      const at = room(8 * list.length);
      engine.HEAPF64.set(list, at >> 3);
      return at;
    }
  };
  try {
    return work(place);
  } finally {
    for (const pointer of blocks) engine._free(pointer);
  }
}

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

/** The error at a pointer, which is released; null where there is none. */
function errorAt(error) {
  if (!error) return null;
  const messages = [], count = engine._strutlib_error_count(error);
  for (let i = 0; i < count; i++)
    messages.push({
      text: textAt(engine._strutlib_error_text(error, i)),
      file: textAt(engine._strutlib_error_file(error, i)),
      line: engine._strutlib_error_line(error, i),
      column: engine._strutlib_error_column(error, i),
      length: engine._strutlib_error_length(error, i),
      source: textAt(engine._strutlib_error_source(error, i)),
      hint: textAt(engine._strutlib_error_hint(error, i)),
      key: textAt(engine._strutlib_error_key(error, i))
    });
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
    engine.HEAPU32[error >> 2] = 0;
    const value = call(place, error);
    return { value, error: errorAt(engine.HEAPU32[error >> 2]) };
  });
}

/** The value of that call; its error is thrown. */
export function must(call) {
  const { value, error } = attempt(call);
  if (error) throw error;
  return value;
}

/** The number that call(place, pointer to a double) finds, or null. */
export function numberOf(call) {
  return withMemory((place) => {
    const at = place.room(8);
    return call(place, at) ? engine.HEAPF64[at >> 3] : null;
  });
}

/** The yes or no that call(place, pointer to an int) finds, or null. */
export function flagOf(call) {
  return withMemory((place) => {
    const at = place.room(4);
    return call(place, at) ? engine.HEAPU32[at >> 2] !== 0 : null;
  });
}

const DIMENSIONS = 4;

/** {data, shape} of the array that call(place, &data, &dimensions, shape, stride) finds, or null. */
export function arrayOf(call) {
  return withMemory((place) => {
    const data = place.room(4), dimensions = place.room(4);
    const shapes = place.room(4 * DIMENSIONS), strides = place.room(4 * DIMENSIONS);
    if (!call(place, data, dimensions, shapes, strides)) return null;
    const heap = engine.HEAPU32, count = heap[dimensions >> 2];
    const shape = Array.from(heap.subarray(shapes >> 2, (shapes >> 2) + count));
    const stride = Array.from(heap.subarray(strides >> 2, (strides >> 2) + count));
    return { data: gather(heap[data >> 2] >> 3, shape, stride), shape };
  });
}

/* The numbers in the order of C, copied. */
function gather(first, shape, stride) {
  const size = shape.reduce((a, b) => a * b, 1), numbers = new Float64Array(size);
  const index = shape.map(() => 0);
  for (let i = 0, at = first; i < size; i++) {
    numbers[i] = engine.HEAPF64[at];
    for (let d = shape.length - 1; d >= 0; d--) {
      at += stride[d];
      if (++index[d] < shape[d]) break;
      at -= stride[d] * shape[d];
      index[d] = 0;
    }
  }
  return numbers;
}

/** The texts call(0), call(1), ... up to the first that is none. */
export function list(call) {
  const found = [];
  for (let text; (text = textAt(call(found.length))) !== null;) found.push(text);
  return found;
}

/** {count, names, values} of pairs given as an object: numbers as digits that keep every bit, booleans as yes or no. */
export function pairs(place, given = {}) {
  const entries = Object.entries(given).filter(([, value]) => value !== undefined);
  const write = (value) => (value === true ? "yes" : value === false ? "no" : String(value));
  return {
    count: entries.length,
    names: place.texts(entries.map(([name]) => name)),
    values: place.texts(entries.map(([, value]) => write(value)))
  };
}

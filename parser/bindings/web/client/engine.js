/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page's side: an engine in a Worker that answers one request at a time, and can be stopped in any. */

/** A request that was stopped, or that a newer one replaced. */
export class Stopped extends Error {
  constructor(why) {
    super(why);
    this.name = "Stopped";
  }
}

const GRACE = 2000; /* [ms] after its limit until a request that does not look at the clock is ended with its Worker */

export class Engine {
  #wasm;
  #makeWorker;
  #worker = null;
  #asked = null; /* {id, resolve, reject, progress, timer} */
  #next = 0;

  /** wasm: a promise of a WebAssembly.Module, compiled once; makeWorker() starts worker.js. */
  constructor(wasm, makeWorker) {
    this.#wasm = wasm;
    this.#makeWorker = makeWorker;
  }

  async #ready() {
    if (this.#worker) return this.#worker;
    const wasm = await this.#wasm;
    if (this.#worker) return this.#worker;
    const worker = this.#worker = this.#makeWorker();
    worker.onmessage = ({ data }) => this.#hear(data);
    worker.onerror = (event) => this.#end(new Error(event.message || "the engine failed"));
    worker.postMessage({ wasm });
    return worker;
  }

  /**
   * Asks for an answer: {scene: {text, name, files, settings}, call, options, limit [s], want}. `call`: one of run,
   * equilibria, modes, rigidity, form, path, sweep (with axes, points), or none for the scene alone, whose page has
   * the equilibria with options {equilibria: true}; "schema", without a scene, for the language. `want`: names in
   * worker.js, such as ["page", "json", "table"]. A request under way is stopped. The promise is broken with the
   * failure {status, message, report, messages}, or with Stopped.
   */
  async ask(request, progress) {
    this.stop("a newer request");
    const id = this.#next++;
    const promise = new Promise((resolve, reject) => {
      const timer = request.limit && setTimeout(
        () => this.stop("it took longer than " + request.limit + " s"), 1000 * request.limit + GRACE);
      this.#asked = { id, resolve, reject, progress, timer };
    });
    this.#ready().then((worker) => {
      if (this.#asked && this.#asked.id === id) worker.postMessage({ id, ...request });
    }, (error) => this.#end(error));
    return promise;
  }

  #hear(data) {
    const asked = this.#asked;
    if (!asked || data.id !== asked.id) return;
    if ("progress" in data) {
      if (asked.progress) asked.progress(data.progress);
      return;
    }
    clearTimeout(asked.timer);
    this.#asked = null;
    if (data.failure && data.failure.status < 0) this.#drop(); /* the module itself failed: memory, or a defect */
    if (data.failure) asked.reject(data.failure);
    else asked.resolve(data.answer);
  }

  /* Ends the Worker; the next request starts another. */
  #drop() {
    if (this.#worker) this.#worker.terminate();
    this.#worker = null;
  }

  #end(error) {
    const asked = this.#asked;
    this.#drop();
    this.#asked = null;
    if (!asked) return;
    clearTimeout(asked.timer);
    asked.reject(error);
  }

  /** Ends the request under way with its Worker; the next one starts another. */
  stop(why = "stopped") {
    if (this.#asked) this.#end(new Stopped(why));
  }
}

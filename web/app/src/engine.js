// Runs the program's command lines, one at a time, in a worker that can be ended.
import workerText from "inline:worker.js";
import { unpacked } from "./packed.js";

/** Why a run has no result: it was ended. */
export class Ended extends Error {}

/** The program's module. */
async function compiled() {
  try {
    return await WebAssembly.compile(await unpacked("engine"));
  } catch (error) {
    throw new Error(`the program cannot start in this browser (${error.message}): use one of 2023 or newer, or the program on a terminal`);
  }
}

/** The program: `run(words, files)` gives its exit code, standard output and error, and the files that it wrote. */
export class Engine {
  #module = compiled();
  #address = URL.createObjectURL(new Blob([workerText], { type: "text/javascript" }));
  #worker;
  #waiting;

  constructor() {
    this.#start();
  }

  /** A worker with an instance of its own, made before it is asked for anything. */
  #start() {
    const worker = new Worker(this.#address);
    this.#worker = worker;
    this.#module.then((module) => worker === this.#worker && worker.postMessage({ module }), () => {});
    worker.onmessage = ({ data }) => this.#settle(data.done, data.failed);
    worker.onerror = (event) => this.#settle(undefined, event.message || "the worker ended");
  }

  #settle(done, failed) {
    const waiting = this.#waiting;
    if (!waiting) return;
    this.#waiting = undefined;
    if (done) return waiting.resolve(done);
    // After a defect nothing of the instance is trusted.
    this.#restart();
    waiting.reject(new Error(failed));
  }

  #restart() {
    this.#worker.terminate();
    this.#start();
  }

  /** Whether something runs. */
  get runs() {
    return this.#waiting !== undefined;
  }

  /** Ends what runs. */
  end() {
    if (!this.#waiting) return;
    const { reject } = this.#waiting;
    this.#waiting = undefined;
    this.#restart();
    reject(new Ended("ended"));
  }

  /** Runs a command line on files `{ name, bytes }`; what ran before is ended. */
  async run(words, files) {
    this.end();
    const worker = this.#worker;
    const result = new Promise((resolve, reject) => (this.#waiting = { resolve, reject }));
    const waiting = this.#waiting;
    const given = { words, files: Object.fromEntries(files.map(({ name, bytes }) => [name, bytes])) };
    // A run that was ended meanwhile has another worker. Files may be too large to be handed over.
    this.#module
      .then(() => this.#waiting === waiting && worker.postMessage({ run: given }))
      .catch((error) => this.#waiting === waiting && this.#settle(undefined, error.message));
    return result;
  }
}

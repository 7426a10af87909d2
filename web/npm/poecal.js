// The program poecal in WebAssembly, for browsers and Node. The module gets words and files, and gives back what the program says and writes.

/** Bytes of a message's length. */
const HEAD = 4;
/** Memory that is given back by a new instance, bytes: an instance never gives any back. */
const LARGE = 256 << 20;

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** What poecal refuses, or cannot do. */
export class PoecalError extends Error {
  constructor(message, place = {}) {
    super(message);
    this.name = "PoecalError";
    Object.assign(this, place);
  }
}

/** Writes numbers and texts one after the other. */
class Message {
  parts = [];
  length = 0;

  number(value) {
    const bytes = new Uint8Array(4);
    new DataView(bytes.buffer).setUint32(0, value, true);
    this.add(bytes);
  }

  block(value) {
    const bytes = typeof value === "string" ? encoder.encode(value) : value;
    this.number(bytes.length);
    this.add(bytes);
  }

  add(bytes) {
    this.parts.push(bytes);
    this.length += bytes.length;
  }
}

/** Reads numbers and texts one after the other. */
class Rest {
  at = 0;

  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  }

  number() {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }

  block() {
    const length = this.number();
    this.at += length;
    return this.bytes.slice(this.at - length, this.at);
  }

  text() {
    return decoder.decode(this.block());
  }
}

/** Bytes of a file that is given as a text, an array of bytes or a buffer. */
export function bytesOf(path, content) {
  if (typeof content === "string") return encoder.encode(content);
  if (content instanceof Uint8Array) return content;
  if (ArrayBuffer.isView(content)) return new Uint8Array(content.buffer, content.byteOffset, content.byteLength);
  if (content instanceof ArrayBuffer) return new Uint8Array(content);
  throw new PoecalError(`${path}: found ${content === null ? "null" : typeof content}, expected a string or a Uint8Array`);
}

/** Paths and bytes of files that are given as an object or a Map. */
function entriesOf(files) {
  const entries = files instanceof Map ? [...files] : Object.entries(files);
  return entries.map(([path, content]) => [path, bytesOf(path, content)]);
}

/** The program. `load` makes one. */
export class Poecal {
  #module;
  #instance;

  constructor(module, instance) {
    this.#module = module;
    this.#instance = instance;
  }

  /** Runs the program with the words that would be typed after `poecal`. */
  run(words, files = {}, { input = "" } = {}) {
    const request = new Message();
    request.number(words.length);
    words.forEach((word) => request.block(String(word)));
    request.block(bytesOf("-", input));
    const entries = entriesOf(files);
    request.number(entries.length);
    for (const [path, bytes] of entries) {
      request.block(path);
      request.block(bytes);
    }
    const answer = new Rest(this.#answer(request));
    const code = answer.number();
    const out = answer.text();
    const err = answer.text();
    const written = {};
    for (let left = answer.number(); left > 0; left--) {
      const path = answer.text();
      written[path] = answer.block();
    }
    const removed = Array.from({ length: answer.number() }, () => answer.text());
    return { code, out, err, files: written, removed };
  }

  /** The bytes that the module answers to a request. */
  #answer(request) {
    this.#instance ??= new WebAssembly.Instance(this.#module);
    const { memory, allocate, release, run } = this.#instance.exports;
    try {
      const place = allocate(request.length);
      if (place === 0) throw new PoecalError(`found no memory for ${request.length} bytes of files, expected some: give fewer or smaller files`);
      let at = place >>> 0;
      for (const part of request.parts) {
        new Uint8Array(memory.buffer, at, part.length).set(part);
        at += part.length;
      }
      const answered = run(place, request.length) >>> 0;
      release(place, request.length);
      if (answered === 0) throw new PoecalError("found a request that the module cannot read, expected module and script of one version");
      const length = new DataView(memory.buffer).getUint32(answered, true);
      const answer = new Uint8Array(memory.buffer, answered + HEAD, length).slice();
      release(answered, HEAD + length);
      return answer;
    } catch (error) {
      const instance = this.#instance;
      this.#instance = undefined;
      if (error instanceof PoecalError) throw error;
      throw stopped(instance, error);
    } finally {
      if (memory.buffer.byteLength > LARGE) this.#instance = undefined;
    }
  }
}

/** The error for a run that did not end: what the panic said, if the memory still has it. */
function stopped(instance, cause) {
  let words = String(cause.message ?? cause);
  try {
    const place = instance.exports.last_words() >>> 0;
    const { buffer } = instance.exports.memory;
    if (place !== 0) words = decoder.decode(new Uint8Array(buffer, place + HEAD, new DataView(buffer).getUint32(place, true)).slice());
  } catch {
    // The trap's own words have to do.
  }
  return new PoecalError(`poecal has stopped by a defect of its own, or for want of memory (${words.replace(/\s+/g, " ")}): please report it with the files`, { cause });
}

/** A compiled module of what `load` is given. */
async function compiled(source) {
  const given = await source;
  if (given instanceof WebAssembly.Module) return given;
  if (typeof Response !== "undefined" && given instanceof Response) {
    if (!given.ok) throw new PoecalError(`${given.url}: found status ${given.status}, expected the module`);
    return WebAssembly.compile(await given.arrayBuffer());
  }
  return WebAssembly.compile(bytesOf("the module", given));
}

/** The bytes of the module beside this script. */
async function beside() {
  const url = new URL("./poecal.wasm", import.meta.url);
  if (url.protocol !== "file:") return fetch(url);
  const { readFile } = await import("node:fs/promises");
  return readFile(url);
}

/** Loads the program: from bytes, a compiled module or a response, or without an argument from poecal.wasm beside this script. */
export async function load(source, Kind = Poecal) {
  const module = await compiled(source ?? beside());
  return new Kind(module, await WebAssembly.instantiate(module));
}

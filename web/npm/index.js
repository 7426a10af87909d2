// Calibration of robot arms: the commands of the program poecal as functions, on `run` of poecal.js.
import { load as loadAs, Poecal, PoecalError } from "./poecal.js";

export { PoecalError };

const decoder = new TextDecoder();
const OUT = "calibration";

/** Files of an input: one without a name gets that; a model without one is known by its text. */
function named(given, name) {
  if (given === undefined) return {};
  const isFile = typeof given === "string" || ArrayBuffer.isView(given) || given instanceof ArrayBuffer;
  return isFile ? { [name]: given } : given instanceof Map ? Object.fromEntries(given) : given;
}

/** Files of several inputs as one; two of one name that differ would be one file. */
function together(...inputs) {
  const all = {};
  for (const [path, content] of inputs.flatMap((files) => Object.entries(files))) {
    if (Object.hasOwn(all, path) && all[path] !== content) {
      throw new PoecalError(`found two files named ${path}, expected another name for one of them`, { code: 2, file: path });
    }
    all[path] = content;
  }
  return all;
}

/** The words of options: `heldOut: 0.2` is `--held-out=0.2`. */
function words(options = {}) {
  return Object.entries(options).flatMap(([key, value]) => {
    const option = `--${key.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`)}`;
    if (value === undefined || value === false) return [];
    if (value === true) return [option];
    return (Array.isArray(value) ? value : [value]).map((one) => `${option}=${one}`);
  });
}

/** Sentences of standard error that begin with a word. */
function sentences(err, word) {
  return err.split("\n").flatMap((line) => (line.startsWith(word) ? [line.slice(word.length)] : []));
}

/** The error that a run ended with. */
function refused({ code, err }, files) {
  const sentence = sentences(err, "error: ")[0] ?? err.trim();
  const file = Object.keys(files).find((path) => sentence.startsWith(`${path}:`));
  const [, line, column] = (file !== undefined && /^:(\d+)(?::(\d+))?: /.exec(sentence.slice(file.length))) || [];
  const number = (text) => (text === undefined ? undefined : Number(text));
  return new PoecalError(sentence, { code, file, line: number(line), column: number(column) });
}

/** Results of `poecal calibrate`. */
class Calibration {
  #json;

  constructor({ code, out, err, files }) {
    this.code = code;
    this.table = out;
    this.warnings = sentences(err, "warning: ");
    this.files = files;
  }

  #text(name) {
    const bytes = this.files[`${OUT}/${name}`];
    return bytes && decoder.decode(bytes);
  }

  get jsonText() {
    return this.#text("calibration.json");
  }

  get json() {
    this.#json ??= JSON.parse(this.jsonText);
    return this.#json;
  }

  get urdf() {
    return this.#text("calibrated.urdf");
  }

  get residualsCsv() {
    return this.#text("residuals.csv");
  }

  get report() {
    return this.#text("report.html");
  }

  get verdict() {
    return this.json.verdict ?? undefined;
  }
}

/** The program, with its commands as functions. */
class Api extends Poecal {
  /** Runs a command; an error if it gives no result. */
  #called(command, inputs, files, options, mapping, more = []) {
    const map = named(mapping, "columns.toml");
    const columns = Object.keys(map).map((path) => `--columns=${path}`);
    const all = together(files, map);
    // After --, a name is no option.
    const answer = this.run([command, ...more, ...columns, ...words(options), "--", ...inputs], all);
    if (answer.code >= 2) throw refused(answer, all);
    return answer;
  }

  calibrate({ model, measurements, validate, mapping, files = {}, options }) {
    const robot = named(model, "model");
    const measured = named(measurements, "measurements.csv");
    const judged = named(validate, "validation.csv");
    const more = [`--out=${OUT}`, ...Object.keys(judged).map((path) => `--validate=${path}`)];
    const inputs = [...Object.keys(robot).slice(0, 1), ...Object.keys(measured)];
    return new Calibration(this.#called("calibrate", inputs, together(files, robot, measured, judged), options, mapping, more));
  }

  validate({ calibration, measurements, mapping, options }) {
    const robot = named(calibration, "calibration.json");
    const measured = named(measurements, "measurements.csv");
    const inputs = [...Object.keys(robot), ...Object.keys(measured)];
    return JSON.parse(this.#called("validate", inputs, together(robot, measured), options, mapping, ["--json"]).out);
  }

  predict({ model, joints, mapping, options }) {
    const robot = named(model, "model");
    const readings = named(joints, "joints.csv");
    return this.#called("predict", [...Object.keys(robot), ...Object.keys(readings)], together(robot, readings), options, mapping).out;
  }

  check({ model, measurements, mapping, options }) {
    const robot = named(model, "model");
    const measured = named(measurements, "measurements.csv");
    const inputs = [...Object.keys(robot), ...Object.keys(measured)];
    const { code, out, err } = this.#called("check", inputs, together(robot, measured), options, mapping);
    return { code, table: out, warnings: sentences(err, "warning: ") };
  }

  identify({ model, joints, options }) {
    const robot = named(model, "model");
    const readings = named(joints, "joints.csv");
    const rows = Object.keys(readings).map((path) => `--rows=${path}`);
    return JSON.parse(this.#called("plan", Object.keys(robot), together(robot, readings), options, undefined, [...rows, "--json"]).out);
  }

  exportAs(format, { model, onto, motors, options }) {
    const robot = named(model, "model");
    const urdf = named(onto, "onto.urdf");
    const servos = named(motors, "motors.json");
    const more = [
      `--format=${format}`,
      ...Object.keys(urdf).map((path) => `--onto=${path}`),
      ...Object.keys(servos).map((path) => `--motors=${path}`),
    ];
    return this.#called("export", Object.keys(robot), together(robot, urdf, servos), options, undefined, more).out;
  }

  simulate({ model, options }) {
    const robot = named(model, "model");
    const { files } = this.#called("simulate", Object.keys(robot), robot, options, undefined, ["--out=session"]);
    return Object.fromEntries(Object.entries(files).map(([path, bytes]) => [path.slice("session/".length), decoder.decode(bytes)]));
  }
}

/** Loads the program. */
export async function load(source) {
  return loadAs(source, Api);
}

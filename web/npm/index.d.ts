// Types of the package. Those of calibration.json and of the options are in types.d.ts.
import type { CalibrateOptions, CalibrationFile, CheckOptions, ExportOptions, PlanOptions, PredictOptions, SimulateOptions, ValidateOptions, Verdict } from "./types.js";

export * from "./types.js";

/** Contents of a file: text, or bytes. */
export type Content = string | Uint8Array | ArrayBuffer;
/** Files by their paths. */
export type Files = Record<string, Content> | Map<string, Content>;
/**
 * An input: the contents of one file, or files by their names, which messages then say. The form of a model is known by the extension of
 * its name, else by its text.
 *
 * @example
 * const one: Input = "joint1[deg],joint2[deg],x[mm],y[mm],z[mm]\n…";
 * const two: Input = { "monday.csv": one, "tuesday.csv": one };
 */
export type Input = Content | Files;

/**
 * What the program refuses, as one sentence: file, line and column, what was found, what was expected, what to do. Or that it has stopped
 * by a defect of its own; the next call works again.
 *
 * @example
 * try {
 *   poecal.calibrate({ model, measurements });
 * } catch (error) {
 *   if (error instanceof PoecalError) console.log(error.file, error.line, error.message);
 * }
 */
export class PoecalError extends Error {
  constructor(message: string, place?: { code?: number; file?: string; line?: number; column?: number; cause?: unknown });
  /** Exit code of the program: 2 refused, 3 no result. Undefined where it did not come to an end. */
  readonly code?: number;
  /** The input that the sentence is about. */
  readonly file?: string;
  /** Line in the file, from 1. */
  readonly line?: number;
  /** Column in the file, from 1: of the character, or in a table of the cell. */
  readonly column?: number;
}

/**
 * What a run of the program came to.
 *
 * @example
 * const { code, out, err, files } = poecal.run(["calibrate", "robot.urdf", "points.csv", "--out", "result"], inputs);
 * if (code <= 1) show(files["result/report.html"]);
 */
export interface Answer {
  /** Exit code: 0 done, 1 done but not to be used, 2 refused, 3 no result. */
  code: number;
  /** Standard output. */
  out: string;
  /** Standard error. */
  err: string;
  /** Files that the run wrote, new or in place of others, by their paths. */
  files: Record<string, Uint8Array>;
  /** Paths of files that were given and are no longer there. */
  removed: string[];
}

/**
 * A finished calibration.
 *
 * @example
 * const { json, urdf, verdict } = poecal.calibrate({ model, measurements });
 * console.log(verdict?.level, json.accuracy.held_out?.calibrated.position_mm);
 */
export interface Calibration {
  /** calibration.json, read. */
  readonly json: CalibrationFile;
  /** calibration.json as it is written: the model of later calls. */
  readonly jsonText: string;
  /** calibrated.urdf; undefined if the model was no URDF. */
  readonly urdf: string | undefined;
  /** residuals.csv: every row with its residuals. */
  readonly residualsCsv: string;
  /** report.html, one page that needs no network; undefined with `report: "none"`. */
  readonly report: string | undefined;
  /** Whether the calibration is good to use, and where. */
  readonly verdict: Verdict | undefined;
  /** Sentences about the input, and about what to look at. */
  readonly warnings: string[];
  /** The table that the program prints. */
  readonly table: string;
  /** Exit code: 1 if the calibration is not to be used, or is worse than `require` asks. */
  readonly code: 0 | 1;
  /** All files, by paths that begin with `calibration/`. */
  readonly files: Record<string, Uint8Array>;
}

/**
 * The program. Every call is on its own, and works on the thread that it is called on: in a page, a worker is the place for long ones.
 *
 * @example
 * import { load } from "poecal";
 * const poecal = await load();
 * const { urdf } = poecal.calibrate({ model: urdfText, measurements: csvText });
 */
export interface Poecal {
  /**
   * Runs any command of the program, on a disk in memory that holds the files. The current folder is the root of the disk; a path that
   * ends in `/` makes a folder.
   *
   * @param words What would be typed after `poecal`.
   * @param files Files by their paths.
   * @param more `input` is what the path `-` reads.
   * @throws {PoecalError} If the run does not come to an end. A refusal is an exit code.
   * @example
   * const { out } = poecal.run(["export", "robot.urdf", "--format", "toml"], { "robot.urdf": text });
   */
  run(words: readonly string[], files?: Files, more?: { input?: Content }): Answer;

  /**
   * Calibrates a robot: `poecal calibrate`.
   *
   * @param call `model` is the nominal robot, `measurements` are joined, `validate` are rows to judge by, `mapping` is a mapping file
   * (TOML) for tables with other column names, and `files` are others that options name.
   * @throws {PoecalError} If the input is refused, or there is no result.
   * @example
   * const result = poecal.calibrate({ model, measurements: { "points.csv": text }, options: { heldOut: 0.2, sigmaPosition: "0.05mm" } });
   */
  calibrate(call: { model: Input; measurements: Input; validate?: Input; mapping?: Input; files?: Record<string, Content>; options?: CalibrateOptions }): Calibration;

  /**
   * Judges a calibration by other measurements: `poecal validate --json`.
   *
   * @throws {PoecalError} If the input is refused.
   * @example
   * const judged = poecal.validate({ calibration: result.jsonText, measurements: secondDay });
   */
  validate(call: { calibration: Input; measurements: Input; mapping?: Input; options?: ValidateOptions }): Record<string, unknown>;

  /**
   * Poses for joint readings, as CSV: `poecal predict`.
   *
   * @throws {PoecalError} If the input is refused.
   * @example
   * const csv = poecal.predict({ model: result.jsonText, joints: "joint1[deg],joint2[deg]\n10,20\n", options: { withUncertainty: true } });
   */
  predict(call: { model: Input; joints: Input; mapping?: Input; options?: PredictOptions }): string;

  /**
   * How a model and measurements are understood: `poecal check`.
   *
   * @throws {PoecalError} If the input is refused.
   * @example
   * const { table, warnings } = poecal.check({ model, measurements });
   */
  check(call: { model: Input; measurements?: Input; mapping?: Input; options?: CheckOptions }): { code: number; table: string; warnings: string[] };

  /**
   * What planned configurations would determine, before anything is measured: `poecal plan --rows --json`.
   *
   * @throws {PoecalError} If the input is refused.
   * @example
   * const planned = poecal.identify({ model, joints, options: { kind: "point" } });
   */
  identify(call: { model: Input; joints: Input; options?: PlanOptions }): Record<string, unknown>;

  /**
   * A calibrated robot in the form of a controller, a driver or a simulator: `poecal export`.
   *
   * @param format As `poecal export --format` names it.
   * @param call `onto` is a URDF that the numbers are written into, `motors` LeRobot's calibration of motors.
   * @throws {PoecalError} If the input is refused, or the robot has no such form.
   * @example
   * const yaml = poecal.exportAs("origins", { model: result.jsonText });
   */
  exportAs(format: string, call: { model: Input; onto?: Input; motors?: Input; options?: ExportOptions }): string;

  /**
   * A robot with known errors and its measurements: `poecal simulate`.
   *
   * @returns Texts of the files by their names.
   * @throws {PoecalError} If the input is refused.
   * @example
   * const { "measurements.csv": table } = poecal.simulate({ model, options: { kind: "pose", count: 60 } });
   */
  simulate(call: { model: Input; options?: SimulateOptions }): Record<string, string>;
}

/**
 * Loads the program.
 *
 * @param source The module: its bytes, what `fetch` gives, or a compiled one. Without it, `poecal.wasm` beside the script.
 * @throws {PoecalError} If there is no module.
 * @example
 * const poecal = await load();
 */
export function load(source?: BufferSource | Response | WebAssembly.Module | Promise<Response>): Promise<Poecal>;

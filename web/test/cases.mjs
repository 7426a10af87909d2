// Calibrations whose reports are opened: the paper's elbow, a broken one, poses of seven axes, repeated rows, and real robots if their data are
// available.
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { complete } from "../src/data.js";
import { PROGRAM, ROOT } from "./program.mjs";

export { PROGRAM, ROOT };
const ELBOW = join(ROOT, "examples/elbow");

export const folder = mkdtempSync(join(tmpdir(), "poecal-report-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/** Standard output of the program, which must succeed. */
export function poecal(...words) {
  return execFileSync(PROGRAM, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"], cwd: ROOT });
}

/** Input of the script of a folder's report. */
export function dataOf(out) {
  const page = readFileSync(join(out, "report.html"), "utf8");
  return complete(JSON.parse(page.split('id="report-data">')[1].split("</script>")[0]));
}

/** A calibration's folder. */
export function calibrate(name, ...words) {
  const out = join(folder, name);
  try {
    poecal("calibrate", ...words, "--out", out, "--quiet");
  } catch (error) {
    // Written, but not to be used.
    if (error.status !== 1) throw error;
  }
  return out;
}

/** The terminal's output for the example. */
export function printed() {
  return poecal("calibrate", join(ELBOW, "robot.urdf"), join(ELBOW, "points.csv"), "--out", join(folder, "printed"), "--force", "--verbose");
}

/** The example's points with joint 4 counted the other way. */
function broken() {
  const path = join(folder, "broken.csv");
  const lines = readFileSync(join(ELBOW, "points.csv"), "utf8").split("\n").filter((line) => line && !line.startsWith("#"));
  const turned = lines[0].split(",").findIndex((column) => column.startsWith("joint4"));
  const row = (line) => line.split(",").map((cell, k) => (k === turned ? String(-Number(cell)) : cell)).join(",");
  writeFileSync(path, `${[lines[0], ...lines.slice(1).map(row)].join("\n")}\n`);
  return path;
}

/** The example's points, six of them measured five times more. */
function repeated() {
  const path = join(folder, "repeated.csv");
  const lines = readFileSync(join(ELBOW, "points.csv"), "utf8").split("\n").filter((line) => line && !line.startsWith("#"));
  const x = lines[0].split(",").findIndex((column) => column.startsWith("x["));
  const near = (line, k) => line.split(",").map((cell, column) => (column === x ? String(Number(cell) + 0.01 * (k - 2)) : cell)).join(",");
  const again = [0, 1, 2, 3, 4].flatMap((k) => lines.slice(1, 7).map((line) => near(line, k)));
  writeFileSync(path, `${[...lines, ...again].join("\n")}\n`);
  return path;
}

function simulated(name, ...words) {
  const out = join(folder, `${name}-session`);
  poecal("simulate", ...words, "--out", out, "--quiet");
  return join(out, "measurements.csv");
}

/** Position of the tip in the program's prediction, or of the named object, by the calibrated axes with which the arm is drawn. */
export function predicted(out, readings, values, ...words) {
  const table = join(folder, "joints.csv");
  const columns = readings.map(({ name, unit }) => `"${name}[${unit === "mm" ? "mm" : "deg"}]"`);
  writeFileSync(table, `${columns.join(",")}\n${values.join(",")}\n`);
  const [, row] = poecal("predict", join(out, "calibration.json"), table, "--model", "calibrated", ...words, "--quiet").split("\n");
  return row.split(",").slice(0, 3).map(Number);
}

/** A session of a robot with named links, calibrated: noise shows the axes of a residual. */
function mounted(name, named, ...words) {
  const model = join(ROOT, "crates/poecal-testing/data/torso.urdf");
  return calibrate(name, model, simulated(name, model, ...named, ...words, "--noise", "2mm,0.1deg"), ...named);
}

/** The example's points in the frames of two trackers, in turn. */
function fromTwoPlaces() {
  const path = join(folder, "two.csv");
  const session = simulated("two", join(ELBOW, "robot.urdf"), "--kind", "point", "--device-frame", "base", "--noise", "0.1mm,0.01deg");
  const lines = readFileSync(session, "utf8").split("\n").filter((line) => line && !line.startsWith("#"));
  const x = lines[0].split(",").findIndex((column) => column.startsWith("x["));
  const moved = (line, k) => {
    const cells = line.split(",");
    const [px, py, pz] = cells.slice(x, x + 3).map(Number);
    const place = k % 2 ? [py - 1500, 1000 - px, pz - 900] : [px - 1600, py + 1200, pz - 600];
    return [...cells.slice(0, x), ...place, ...cells.slice(x + 3), k % 2 ? "B" : "A"].join(",");
  };
  writeFileSync(path, `${lines[0]},instrument\n${lines.slice(1).map(moved).join("\n")}\n`);
  return calibrate("two", join(ELBOW, "robot.urdf"), path);
}

/** Robots with branches, or with several instruments: a function that returns the folder with the results of each. */
export const TREES = {
  "a torso with two arms": () => {
    const named = ["--instrument", "eyes=head_camera", "--instrument", "chest=torso", "--target", "left=left_hand", "--target", "right=right_hand"];
    return mounted("torso", named, "--count", "300", "--errors", "0.5deg,2mm");
  },
  "a camera in the hand": () => mounted("hand", ["--instrument", "camera=right_hand", "--target", "board=base_link"], "--count", "120"),
  "two trackers": fromTwoPlaces,
};

/** A simulated session of a kind that has no device frame, calibrated, with noise that shows the direction of a residual. */
export function ofKind(kind, ...words) {
  const model = join(ELBOW, "robot.urdf");
  return calibrate(kind, model, simulated(kind, model, "--kind", kind, "--count", "120", "--noise", "1mm,0.1deg"), ...words);
}

/** Every case: its name, and a function that returns the folder with its results. */
export const CASES = [
  ["the paper's elbow", () => calibrate("elbow", join(ELBOW, "robot.urdf"), join(ELBOW, "points.csv"))],
  ["a broken calibration", () => calibrate("broken", join(ELBOW, "robot.urdf"), broken())],
  ["repeated rows", () => calibrate("repeated", join(ELBOW, "robot.urdf"), repeated())],
  [
    "seven axes, poses",
    () => {
      const model = join(ROOT, "crates/poecal-testing/data/urdf/seven_axis.urdf");
      return calibrate("seven", model, simulated("seven", model, "--kind", "pose", "--count", "80"));
    },
  ],
];

/** Two checks of a calibration by other rows; the folder of the second. */
export function checked(out) {
  const rows = simulated("checked", join(ELBOW, "robot.urdf"), "--kind", "point", "--count", "60");
  const check = (name, ...words) => poecal("validate", join(out, "calibration.json"), ...words, "--refit", "device", "--out", join(folder, name), "--quiet");
  check("first check", join(ELBOW, "points.csv"));
  check("second check", rows, "--accept", "1mm", "--record", "operator=Mia", "--record", "serial=4711");
  return join(folder, "second check");
}

/** A session of 50,000 rows. */
export function long() {
  const model = join(ELBOW, "robot.urdf");
  return calibrate("long", model, simulated("long", model, "--kind", "pose", "--count", "50000"));
}

const datasets = process.env.POECAL_DATASETS ?? join(ROOT, "../shared/datasets");
if (existsSync(datasets)) {
  const { cases } = JSON.parse(readFileSync(join(ROOT, "validation/expected.json"), "utf8"));
  // The same rows from another file make the same report.
  const real = cases.filter((it) => !it.name.startsWith("the same"));
  // Every third for each change, all with POECAL_REPORTS=all, as ./test packages requests.
  const looked = process.env.POECAL_REPORTS === "all" ? real : real.filter((_, k) => k % 3 === 0);
  console.log(`real robots: ${looked.length} of ${real.length}`);
  for (const { name, model, measurements, options } of looked) {
    const words = options.map((word) => (word.startsWith("validation/") ? join(ROOT, word) : word));
    CASES.push([name, () => calibrate(name.replace(/\W+/g, "-"), join(datasets, model), join(datasets, measurements), ...words)]);
  }
} else {
  console.log(`real robots skipped: no folder of data sets at ${datasets}; set POECAL_DATASETS`);
}

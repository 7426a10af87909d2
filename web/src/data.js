// The page's data, with quantities that follow from them: each row's predicted target, and its residual in the base frame.
import { CALIBRATED, act, configure, invert, poseOf, rotate, scale, subtract } from "./kinematics.js";
import { patchOf } from "./places.js";

export function readData() {
  return complete(JSON.parse(document.getElementById("report-data").textContent));
}

/** Numbers of three bytes each, in steps from the least of them, or null. */
function unpacked({ low, step, bytes }) {
  const text = atob(bytes);
  return Array.from({ length: text.length / 3 }, (_, k) => {
    const whole = [0, 1, 2].reduce((sum, at) => 256 * sum + text.charCodeAt(3 * k + at), 0);
    return whole === 0xffffff ? null : low + step * whole;
  });
}

/** The columns of the rows as numbers. */
function readRows(rows) {
  const lines = unpacked(rows.line);
  rows.count = lines.length;
  rows.number = rows.number ? unpacked(rows.number) : lines.map((_, row) => row + 1);
  rows.place = lines.map((line, row) => `${rows.files[rows.file?.[row] ?? 0]}${line}`);
  rows.sets = [...rows.sets].map(Number);
  rows.target ??= lines.map(() => 0);
  rows.instrument ??= lines.map(() => 0);
  rows.error_mm = unpacked(rows.error_mm);
  rows.values = rows.values.map(unpacked);
  rows.columns = {};
  rows.residuals.forEach(({ components }, at) =>
    components.forEach((component, k) => {
      rows.columns[`${at}.${k}`] = component.values = unpacked(component.values);
    }),
  );
}

/** Adds to each row its position and its residual in the base frame, and to the robot the frames at the ends of its arms. */
export function complete(data) {
  data.factors = data.readings.map((reading) => (reading.unit === "mm" ? 1e-3 : Math.PI / 180));
  const { rows, tip, targets, instruments } = data;
  for (const frame of [tip, ...targets, ...instruments, ...(data.shapes ?? [])]) {
    frame.pose = poseOf(frame.pose);
    frame.nominal_pose = frame.nominal_pose && poseOf(frame.nominal_pose);
  }
  // Targets in the tip frame are not among these.
  data.mounted = targets.filter((target) => target.nominal_pose);
  const ends = [...data.mounted, ...instruments].filter((frame) => frame.on !== null);
  const atTip = ({ on, pose }) => on === tip.on && Math.hypot(...subtract(pose.t, tip.pose.t)) < 1e-6;
  data.ends = ends.length && (tip.on === null || ends.some(atTip)) ? ends : [tip, ...ends];
  const reaching = new Map();
  readRows(rows);
  rows.predicted = [];
  rows.reached = [];
  rows.residual = [];
  const touched = instruments.map(() => []);
  for (let row = 0; row < rows.count; row++) {
    const found = configure(data, readingsOf(data, row), CALIBRATED);
    const [target, instrument] = [targets[rows.target[row]], instruments[rows.instrument[row]]];
    const place = found.at(target).t;
    const device = found.at(instrument);
    const seen = act(invert(device), place);
    // The axes of a pair are those of the target in another configuration, which the page does not know.
    const shift = instrument.kind === "pair" ? undefined : shiftOf(rows, row, seen);
    const residual = shift && rotate(device.r, shift);
    rows.predicted.push(place);
    touched[rows.instrument[row]].push(seen);
    // If a camera observes a target beside the robot, the camera itself moves.
    const moving = target.on === null ? instrument : target;
    if (!reaching.has(moving.on)) reaching.set(moving.on, moving);
    rows.reached.push(found.at(moving).t);
    rows.residual.push(residual ?? null);
  }
  for (const [k, it] of instruments.entries()) if (it.kind === "plane") it.patch = patchOf(touched[k]);
  data.reaching = [...reaching.values()];
  return data;
}

/** The residual of a quantity in a row, by component, null for one that was not measured. */
function componentsOf({ residuals }, row, quantity) {
  return residuals.find(({ name }) => name === quantity)?.components.map(({ values }) => values[row]) ?? [];
}

/** The same residual with zero for a component that was not measured; undefined if the row did not measure the quantity. */
function residualOf(rows, row, quantity) {
  const found = componentsOf(rows, row, quantity);
  return found.some((value) => value !== null) ? found.map((value) => value ?? 0) : undefined;
}

/**
 * The residual of a row as a shift in the axes of the device, millimetres, with the target at the position `seen`: for a distance along the line to
 * it, for a height along the plane's normal. Undefined for angles.
 */
function shiftOf(rows, row, seen) {
  const vector = residualOf(rows, row, "position") ?? residualOf(rows, row, "contact");
  if (vector) return vector;
  const [height] = residualOf(rows, row, "height") ?? [];
  if (height !== undefined) return [0, 0, height];
  const [distance] = residualOf(rows, row, "distance") ?? [];
  const far = Math.hypot(...seen);
  return distance === undefined || far === 0 ? undefined : scale(seen, distance / far);
}

/** Error of a row in each quantity, in words. */
export function offBy(rows, row) {
  const parts = rows.residuals.flatMap(({ name, unit }) => {
    const found = residualOf(rows, row, name);
    return found ? [[name, withUnit(Math.hypot(...found), unit)]] : [];
  });
  // The unit of a position and of a rotation identifies the quantity.
  const isOfPose = parts.every(([name]) => name === "position" || name === "rotation");
  return parts.map(([name, words]) => (isOfPose ? words : `${words} of ${name}`)).join(" and ");
}

/** The readings of a row, radians or metres. */
export function readingsOf(data, row) {
  return data.rows.values.map((column, reading) => column[row] * data.factors[reading]);
}

/** A number with a few significant digits. */
export function shown(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(1) : value.toFixed(decimals(size, digits));
  return text.replace("-", "−");
}

/** Text with a number and its unit. */
export function withUnit(value, unit) {
  return unit === "°" ? `${shown(value)}°` : `${shown(value)} ${unit}`;
}

function decimals(size, digits) {
  const before = size > 0 ? Math.floor(Math.log10(size)) + 1 : 1;
  return Math.min(Math.max(digits - before, 0), 4);
}

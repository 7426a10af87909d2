// The page's data, with what follows from them: where each row's target was predicted, and how its residual lies in the base frame.
import { chain, poseOf, rotate } from "./kinematics.js";

/** Reads the data, and adds to each row its place and its residual in the base frame. */
export function readData() {
  const data = JSON.parse(document.getElementById("report-data").textContent);
  data.factors = data.readings.map((reading) => (reading.unit === "mm" ? 1e-3 : Math.PI / 180));
  data.home = poseOf(data.home);
  data.nominal_home = poseOf(data.nominal_home);
  data.base_from_device = poseOf(data.base_from_device);
  const rows = data.rows;
  rows.count = rows.number.length;
  rows.predicted = [];
  rows.residual = [];
  rows.motion = data.readings.map(() => []);
  for (let row = 0; row < rows.count; row++) {
    const found = chain(data, readingsOf(data, row), "screw", data.targets[rows.target[row]][1]);
    const shift = shiftOf(rows, row);
    const residual = shift && rotate(data.base_from_device.r, shift);
    rows.predicted.push(found.target);
    rows.residual.push(residual ?? [0, 0, 0]);
    found.motion.forEach((motion, reading) => rows.motion[reading].push(along(residual, motion)));
  }
  return data;
}

/** The residual of a row's position in the axes of the device, millimetres; none if no position was measured. */
function shiftOf({ residuals }, row) {
  const position = residuals.find(({ name }) => name === "position");
  const shift = position?.components.map(({ values }) => values[row]);
  return shift?.includes(null) ? undefined : shift;
}

/** The readings of a row, radians or metres. */
export function readingsOf(data, row) {
  return data.rows.values.map((column, reading) => column[row] * data.factors[reading]);
}

/** The part of a residual along a direction; none where that is no direction, or there is no residual. */
function along(residual, motion) {
  const length = Math.hypot(...motion);
  return residual && length > 1e-3 ? residual.reduce((sum, part, k) => sum + part * motion[k], 0) / length : null;
}

/** A number with a few digits that matter. */
export function shown(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(1) : value.toFixed(decimals(size, digits));
  return text.replace("-", "−");
}

function decimals(size, digits) {
  const before = size > 0 ? Math.floor(Math.log10(size)) + 1 : 1;
  return Math.min(Math.max(digits - before, 0), 4);
}

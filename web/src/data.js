// The page's data, with what follows from them: where each row's target was predicted, and how its residual lies in the base frame.
import { CALIBRATED, configure, motions, poseOf, rotate, subtract } from "./kinematics.js";

export function readData() {
  return complete(JSON.parse(document.getElementById("report-data").textContent));
}

/** Adds to each row its place and its residual in the base frame, and to the robot the frames where its arms end. */
export function complete(data) {
  data.factors = data.readings.map((reading) => (reading.unit === "mm" ? 1e-3 : Math.PI / 180));
  const { rows, tip, targets, instruments } = data;
  for (const frame of [tip, ...targets, ...instruments]) {
    frame.pose = poseOf(frame.pose);
    frame.nominal_pose = frame.nominal_pose && poseOf(frame.nominal_pose);
  }
  // Targets in the tip frame are none of these.
  data.mounted = targets.filter((target) => target.nominal_pose);
  const ends = [...data.mounted, ...instruments].filter((frame) => frame.on !== null);
  const atTip = ({ on, pose }) => on === tip.on && Math.hypot(...subtract(pose.t, tip.pose.t)) < 1e-6;
  data.ends = ends.length && (tip.on === null || ends.some(atTip)) ? ends : [tip, ...ends];
  const reaching = new Map();
  rows.count = rows.number.length;
  rows.instrument ??= rows.number.map(() => 0);
  rows.predicted = [];
  rows.reached = [];
  rows.residual = [];
  rows.motion = data.readings.map(() => []);
  for (let row = 0; row < rows.count; row++) {
    const found = configure(data, readingsOf(data, row), CALIBRATED);
    const [target, instrument] = [targets[rows.target[row]], instruments[rows.instrument[row]]];
    const place = found.at(target).t;
    const shift = shiftOf(rows, row);
    const residual = shift && rotate(found.at(instrument).r, shift);
    rows.predicted.push(place);
    // A camera that looks at a target beside the robot is itself what moves.
    const moving = target.on === null ? instrument : target;
    if (!reaching.has(moving.on)) reaching.set(moving.on, moving);
    rows.reached.push(found.at(moving).t);
    rows.residual.push(residual ?? [0, 0, 0]);
    motions(data, found, place, target, instrument).forEach((motion, reading) => rows.motion[reading].push(along(residual, motion)));
  }
  data.reaching = [...reaching.values()];
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

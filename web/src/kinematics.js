// Forward kinematics by the product of exponentials. A pose is { r, t }: a rotation by rows and a translation in metres.

/** The models: the keys of a joint's screw and of a frame's pose at zero joint values. */
export const CALIBRATED = { screw: "screw", pose: "pose", terms: "terms" };
export const NOMINAL = { screw: "nominal_screw", pose: "nominal_pose", terms: "nominal_terms" };

const STILL = { r: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], t: [0, 0, 0] };

/** A pose from a position and a quaternion x, y, z, w. */
export function poseOf({ position_m, quaternion_xyzw: [x, y, z, w] }) {
  const r = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
  ];
  return { r, t: position_m };
}

export function rotate(r, [x, y, z]) {
  return r.map((row) => row[0] * x + row[1] * y + row[2] * z);
}

export function add(a, b) {
  return a.map((value, k) => value + b[k]);
}

export function subtract(a, b) {
  return a.map((value, k) => value - b[k]);
}

export function scale(a, factor) {
  return a.map((value) => value * factor);
}

export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function act({ r, t }, point) {
  return add(rotate(r, point), t);
}

export function invert({ r, t }) {
  const inverse = [0, 1, 2].map((k) => r.map((row) => row[k]));
  return { r: inverse, t: rotate(inverse, t).map((value) => -value) };
}

export function compose(a, b) {
  const column = (k) => rotate(a.r, b.r.map((row) => row[k]));
  const columns = [column(0), column(1), column(2)];
  return { r: [0, 1, 2].map((row) => columns.map((it) => it[row])), t: act(a, b.t) };
}

/** The motion of a screw through a joint value. */
export function exponential({ v_m: v, w }, value) {
  if (dot(w, w) < 0.5) return { r: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], t: scale(v, value) };
  const [x, y, z] = w;
  const s = Math.sin(value);
  const c = 2 * Math.sin(value / 2) ** 2;
  const r = [
    [1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
    [c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x],
    [c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)],
  ];
  // The axis passes through w × v, which does not move.
  const q = cross(w, v);
  return { r, t: add(subtract(q, rotate(r, q)), scale(w, dot(w, v) * value)) };
}

/** The point of a screw's axis nearest to another point; for a slide, that point. */
function pointOn({ v_m: v, w }, near) {
  if (dot(w, w) < 0.5) return near;
  const q = cross(w, v);
  return add(q, scale(w, dot(w, subtract(near, q))));
}

/** Axes of a model at some readings, and the pose of a frame `at` a body. A joint's body moves with the one that carries it. */
export function configure(data, readings, model) {
  const bodies = [];
  const motionOf = (body) => (body === null ? STILL : bodies[body]);
  const axes = data.joints.map((joint) => {
    const screw = joint[model.screw];
    const before = motionOf(joint.on);
    const [factor, shift] = joint[model.terms] ?? [1, 0];
    const value = factor * (joint.multiplier * readings[joint.reading] + joint.offset) + shift;
    bodies.push(compose(before, exponential(screw, value)));
    return {
      point: act(before, pointOn(screw, joint.origin_m)),
      direction: rotate(before.r, joint.kind === "revolute" ? screw.w : screw.v_m),
    };
  });
  return { axes, at: (frame) => compose(motionOf(frame.on), frame[model.pose]) };
}

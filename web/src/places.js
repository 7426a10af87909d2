// Anchors, sockets, planes, spheres and directions by their kinds: each a group in the axes of its device.
import { ConeGeometry, CylinderGeometry, Group, LineSegments, Matrix4, Mesh, PlaneGeometry, SphereGeometry } from "three";
import { act, invert } from "./kinematics.js";
import { linesOf, roleOf } from "./optics.js";

/** Words for several of a kind. */
const PLURALS = { camera: "cameras", board: "boards", instrument: "instruments", anchor: "anchors", socket: "sockets", plane: "planes", sphere: "spheres", direction: "directions" };
/** Most lines from an anchor to positions that it measured. */
const WIRES = 8;

/** Kind of an instrument, in a word. */
export function wordOf(it) {
  return roleOf(it) ?? it.kind ?? "instrument";
}

/** Kinds of the objects drawn beside the robot, in words: `anchors and planes`. */
export function kindWords({ instruments, targets }) {
  const drawn = [...instruments.filter((it) => it.kind !== "pair"), ...targets.filter(roleOf)].map(wordOf);
  const words = [...new Set(drawn)].map((kind) => (drawn.filter((it) => it === kind).length > 1 || kind === "instrument" ? PLURALS[kind] : kind));
  return words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]}` : words.join("");
}

/** True if a target is at some distance from it, so that a line between the two has a meaning. */
export function isSeenFromAfar({ kind }) {
  return kind === undefined || kind === "anchor";
}

/** True if it has a position, and not a direction alone. */
export function hasPlace({ kind }) {
  return kind !== "direction" && kind !== "pair";
}

/** Room for arrows of residuals, metres: if all targets are in one spot they would hide it. */
export function roomForArrows(it, size) {
  if (it.kind === "socket") return 0.03 * size;
  return it.kind === "sphere" ? Math.min(0.05 * size, it.radius_m ?? Infinity) : Infinity;
}

/** Part of it that the picture must show, in its own axes. */
export function extent(it) {
  if (it.kind === "plane") return cornersOf(it.patch);
  if (it.kind === "sphere" && it.radius_m) return [-1, 1].flatMap((s) => [[s, 0, 0], [0, s, 0], [0, 0, s]]).map((v) => v.map((x) => x * it.radius_m));
  return [[0, 0, 0]];
}

/** The rectangle of a plane under the positions that touched it, in the plane's axes: middle, half sides and turn about the normal. */
export function patchOf(places) {
  if (!places.length) return { x: 0, y: 0, turn: 0, width: 0, height: 0 };
  const mean = (k) => places.reduce((sum, place) => sum + place[k], 0) / places.length;
  const [mx, my] = [mean(0), mean(1)];
  const sum = (of) => places.reduce((all, [x, y]) => all + of(x - mx, y - my), 0);
  const turn = 0.5 * Math.atan2(2 * sum((x, y) => x * y), sum((x, y) => x * x - y * y));
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const range = (values) => [Math.min(...values), Math.max(...values)];
  const [u0, u1] = range(places.map(([x, y]) => c * x + s * y));
  const [v0, v1] = range(places.map(([x, y]) => c * y - s * x));
  const [u, v] = [(u0 + u1) / 2, (v0 + v1) / 2];
  return { x: c * u - s * v, y: s * u + c * v, turn, width: (u1 - u0) / 2, height: (v1 - v0) / 2 };
}

function cornersOf({ x, y, turn, width, height }) {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => [x + a * width * c - b * height * s, y + a * width * s + b * height * c, 0]);
}

/** The drawing of one reference, in its own axes; empty for a pair. */
export function drawingOf(it, data, size, materials) {
  const draw = { anchor, socket, plane, sphere, direction }[it.kind];
  const group = new Group();
  group.matrixAutoUpdate = false;
  draw?.(group, it, size, materials, data);
  return group;
}

function anchor(group, it, size, { body, wire }, { instruments, rows }) {
  group.add(new Mesh(new SphereGeometry(size * 0.02, 16, 12), body));
  if (it.on !== null) return;
  const own = rows.predicted.filter((_, row) => instruments[rows.instrument[row]] === it);
  const step = Math.max(1, Math.ceil(own.length / WIRES));
  const ends = own.filter((_, k) => k % step === step >> 1).map((place) => act(invert(it.pose), place));
  group.add(new LineSegments(linesOf(ends.flatMap((end) => [[0, 0, 0], end])), wire));
}

function socket(group, _, size, { body, sheet }) {
  // The lower half of a ball is the nest; the ball in it is no larger than its apparent size.
  group.add(new Mesh(new SphereGeometry(size * 0.045, 24, 10, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2).rotateX(Math.PI / 2), sheet));
  group.add(new Mesh(new SphereGeometry(size * 0.014, 16, 12), body));
}

function plane(group, it, size, { body, sheet, edge }) {
  const least = size * 0.05;
  const { x, y, turn } = it.patch;
  const [width, height] = [it.patch.width, it.patch.height].map((side) => Math.max(side * 1.1, least));
  const place = new Matrix4().makeTranslation(x, y, 0).multiply(new Matrix4().makeRotationZ(turn));
  group.add(new Mesh(new PlaneGeometry(2 * width, 2 * height).applyMatrix4(place), sheet));
  const corners = cornersOf({ x, y, turn, width, height });
  group.add(new LineSegments(linesOf(corners.flatMap((corner, k) => [corner, corners[(k + 1) % 4]])), edge));
  arrow(group, 1.4 * size, body, [x, y, 0]);
}

function sphere(group, it, size, { body, sheet }) {
  group.add(new Mesh(new SphereGeometry(it.radius_m ?? size * 0.02, 32, 24), sheet));
  group.add(new Mesh(new SphereGeometry(size * 0.004, 12, 8), body));
}

function direction(group, _, size, { body }) {
  arrow(group, 1.6 * size, body, [0, 0, 0]);
}

/** An arrow along z. */
function arrow(group, size, material, [x, y, z]) {
  const [length, head] = [size * 0.08, size * 0.03];
  const turn = new Matrix4().makeTranslation(x, y, z).multiply(new Matrix4().makeRotationX(Math.PI / 2));
  group.add(new Mesh(new CylinderGeometry(size * 0.004, size * 0.004, length, 8).translate(0, length / 2, 0).applyMatrix4(turn), material));
  group.add(new Mesh(new ConeGeometry(size * 0.011, head, 12).translate(0, length + head / 2, 0).applyMatrix4(turn), material));
}

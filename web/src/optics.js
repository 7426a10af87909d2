// Cameras as pyramids of their field of view, boards as sheets with their points, and the rays of the selected picture from one to the other.
import { BufferGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, SphereGeometry } from "three";
import { act } from "./kinematics.js";

/** Length of a camera's pyramid, and radius of a board's points, in sizes of the robot. */
const PYRAMID = 0.14;
const POINT = 0.0035;
/** Points of a board that are drawn. */
const MOST_POINTS = 400;

/** Role of a target or an instrument in pictures: `camera`, `board`, or undefined. */
export function roleOf({ camera, board }) {
  return camera ? "camera" : board && "board";
}

/** The drawing of a camera or a board in its own axes; undefined for other objects. */
export function opticsOf(it, size, materials) {
  if (!roleOf(it)) return null;
  const group = new Group();
  group.matrixAutoUpdate = false;
  if (it.camera) drawCamera(group, it.camera, size, materials);
  if (it.board) drawBoard(group, it.board, size, materials);
  return group;
}

function drawCamera(group, rays, size, { edge }) {
  const ends = rays.map((ray) => ray.map((part) => PYRAMID * size * part));
  const lines = ends.flatMap((end, k) => [[0, 0, 0], end, end, ends[(k + 1) % 4]]);
  group.add(new LineSegments(linesOf(lines), edge));
}

function drawBoard(group, points, size, { sheet, edge, body }) {
  const outline = outlineOf(points);
  if (outline) {
    const corners = [0, 1, 2, 0, 2, 3].flatMap((k) => outline[k]);
    const face = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(corners, 3));
    face.computeVertexNormals();
    group.add(new Mesh(face, sheet), new LineSegments(linesOf(outline.flatMap((corner, k) => [corner, outline[(k + 1) % 4]])), edge));
  }
  const ball = new SphereGeometry(POINT * size, 8, 6);
  const step = Math.ceil(points.length / MOST_POINTS);
  for (const [x, y, z] of points.filter((_, k) => k % step === 0)) group.add(new Mesh(ball.clone().translate(x, y, z), body));
}

/** The rectangle around the points of a flat board; undefined for a solid. */
function outlineOf(points) {
  const range = (k) => points.reduce(([a, b], point) => [Math.min(a, point[k]), Math.max(b, point[k])], [Infinity, -Infinity]);
  const [[x0, x1], [y0, y1], [z0, z1]] = [0, 1, 2].map(range);
  if (z1 - z0 > 0.2 * Math.min(x1 - x0, y1 - y0)) return null;
  return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(([x, y]) => [x, y, (z0 + z1) / 2]);
}

/** The rays from a camera to the corners of a board, each at its pose, as ends of lines; empty if they are no such pair. */
export function raysOf([one, pose], [other, otherPose]) {
  const [camera, from, board, to] = one.camera ? [one, pose, other, otherPose] : [other, otherPose, one, pose];
  if (!camera.camera || !board.board) return [];
  const corners = outlineOf(board.board) ?? board.board.slice(0, 4);
  return corners.flatMap((corner) => [from.t, act(to, corner)]);
}

export function linesOf(ends) {
  return new BufferGeometry().setAttribute("position", new Float32BufferAttribute(ends.flat(), 3));
}

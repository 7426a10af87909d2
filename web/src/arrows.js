// Residuals of the rows as arrows, or as dots if they are no shift in the picture.
import { ConeGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, Quaternion, SphereGeometry, Vector3 } from "three";
import { scale } from "./kinematics.js";
import { roomForArrows } from "./places.js";

const UP = new Vector3(0, 1, 0);
const NOTHING = new Matrix4().makeScale(0, 0, 0);

/** Number of residuals that the picture shows first: the largest. */
const WORST = 100;

/** Room for each arrow, metres. */
export function roomOf({ instruments }, size) {
  return Math.min(0.06 * size, ...instruments.map((it) => roomForArrows(it, size)));
}

/** The rows of the largest errors. */
function worstOf({ error_mm }) {
  const order = error_mm.map((_, row) => row).sort((a, b) => error_mm[b] - error_mm[a] || a - b);
  return new Set(order.slice(0, WORST));
}

export class Arrows {
  constructor({ rows }, size, room, material) {
    const isArrow = (shift) => shift !== null;
    this.rows = rows;
    this.worst = worstOf(rows);
    // True if all are drawn, and not the worst alone.
    this.all = false;
    this.has = { arrows: rows.residual.some(isArrow), dots: !rows.residual.every(isArrow) };
    const width = Math.min(size * (rows.count > 800 ? 0.0013 : 0.0024), room / 30);
    this.dots = new InstancedMesh(new SphereGeometry(size * (rows.count > 800 ? 0.004 : 0.0075), 10, 8), material, rows.count);
    this.shafts = new InstancedMesh(new CylinderGeometry(width, width, 1, 5), material, rows.count);
    this.heads = new InstancedMesh(new ConeGeometry(width * 3, 1, 8), material, rows.count);
    this.headLength = width * 8;
    this.group = new Group();
    this.group.add(this.shafts, this.heads);
    if (this.has.dots) this.group.add(this.dots);
  }

  /** Puts every arrow at its target's predicted position, with its length multiplied by `factor`. */
  place(factor) {
    const placed = `${factor} ${this.all}`;
    if (this.placed === placed) return;
    this.placed = placed;
    const { rows } = this;
    rows.predicted.forEach((from, row) => {
      const shift = rows.residual[row];
      if (!this.all && !this.worst.has(row)) {
        for (const mesh of [this.dots, this.shafts, this.heads]) mesh.setMatrixAt(row, NOTHING);
        return;
      }
      this.dots.setMatrixAt(row, shift ? NOTHING : new Matrix4().makeTranslation(...from));
      const arrow = scale(shift ?? [0, 0, 0], 1e-3 * factor);
      const length = Math.max(Math.hypot(...arrow), 1e-6);
      const direction = new Vector3(...arrow).divideScalar(length);
      const turn = new Quaternion().setFromUnitVectors(UP, direction);
      const head = Math.min(this.headLength, 0.5 * length);
      const at = (share) => new Vector3(...from).addScaledVector(direction, share);
      this.shafts.setMatrixAt(row, new Matrix4().compose(at((length - head) / 2), turn, new Vector3(1, length - head, 1)));
      this.heads.setMatrixAt(row, new Matrix4().compose(at(length - head / 2), turn, new Vector3(head / this.headLength, head, head / this.headLength)));
    });
    for (const mesh of [this.shafts, this.heads, this.dots]) {
      mesh.instanceMatrix.needsUpdate = true;
      mesh.computeBoundingSphere();
    }
  }

  /** Colours from `least` to `most`: the larger the error, up to `largest`, the stronger. */
  recolour(least, most, largest) {
    this.rows.error_mm.forEach((error, row) => {
      const shade = least.clone().lerp(most, Math.min(error / largest, 1));
      for (const mesh of [this.shafts, this.heads, this.dots]) mesh.setColorAt(row, shade);
    });
    for (const mesh of [this.shafts, this.heads, this.dots]) mesh.instanceColor.needsUpdate = true;
  }
}

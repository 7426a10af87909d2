// The robot's links: the shapes of its URDF, and for a link without shapes, a rod from axis to axis as thick as an arm.
import { BoxGeometry, BufferAttribute, BufferGeometry, CylinderGeometry, Group, Matrix4, Mesh, Quaternion, SphereGeometry, Vector3 } from "three";
import { add, compose, invert, scale, subtract } from "./kinematics.js";

const UP = new Vector3(0, 1, 0);
const ROUND = 24;
/** Parts of the picture's size: radius of the first link's rod, and of the last one's as a share of it; half length and radius of an axis. */
const THICK = 0.024;
const THIN = 0.5;
const AXIS = { half: 0.085, radius: 0.0035 };

/** The geometry of a mesh: vertices in whole steps, and the three of each triangle. */
function meshOf({ least, step, places, corners, wide }) {
  const whole = new Uint16Array(bytesOf(places));
  const position = new Float32Array(whole.length);
  for (let k = 0; k < whole.length; k++) position[k] = least[k % 3] + step * whole[k];
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setIndex(new BufferAttribute(wide ? new Uint32Array(bytesOf(corners)) : new Uint16Array(bytesOf(corners)), 1));
  return geometry;
}

function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) bytes[k] = letters.charCodeAt(k);
  return bytes.buffer;
}

/** The geometry of a shape; the cylinders of a URDF are along z. */
function geometryOf(shape, meshes) {
  if (shape.box) return new BoxGeometry(...shape.box);
  if (shape.cylinder) return new CylinderGeometry(shape.cylinder[0], shape.cylinder[0], shape.cylinder[1], ROUND).rotateX(Math.PI / 2);
  if (shape.sphere !== undefined) return new SphereGeometry(shape.sphere, ROUND, ROUND / 2);
  return meshes[shape.mesh];
}

/** The corners of the box about a geometry. */
function cornersOf(geometry) {
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox;
  const corner = (k) => [k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z];
  return [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
}

/** Common elements of both models: geometries, corners of boxes about them, and thickness of the rods. */
export class Looks {
  constructor(data, size) {
    this.data = data;
    this.size = size;
    const meshes = (data.meshes ?? []).map(meshOf);
    this.shapes = (data.shapes ?? []).map((shape) => {
      const geometry = geometryOf(shape, meshes);
      return { shape, geometry, corners: geometry.attributes.position.count ? cornersOf(geometry) : [] };
    });
    this.covered = new Set(this.shapes.filter((it) => it.corners.length).map(({ shape }) => shape.on));
    this.rod = new CylinderGeometry(1, 1, 1, ROUND, 1, true);
    this.barrel = new CylinderGeometry(1, 1, 1, ROUND);
    this.ball = new SphereGeometry(1, ROUND, ROUND / 2);
    const depths = [];
    data.joints.forEach((joint, k) => (depths[k] = joint.on === null ? 1 : depths[joint.on] + 1));
    this.depths = depths;
    this.deepest = Math.max(...depths, 1);
  }

  /** Thickness of a body's rod: the farther from the base, the thinner. */
  thickness(on) {
    const depth = on === null ? 0 : this.depths[on];
    return this.size * THICK * (1 - ((1 - THIN) * depth) / this.deepest);
  }
}

/** The drawing of one model. */
export class Figure {
  /** `materials`: of rods, of shapes (flat), of axes; one `before` shapes, if they are not solid. */
  constructor(looks, { rods, shapes, axes, before }) {
    this.looks = looks;
    this.materials = { rods, axes, before };
    this.group = new Group();
    this.moving = new Group();
    this.group.add(this.moving);
    this.shapes = looks.shapes.map(({ geometry }) => {
      const layers = (before ? [before, shapes] : [shapes]).map((material, layer) => {
        const mesh = new Mesh(geometry, material);
        mesh.matrixAutoUpdate = false;
        mesh.renderOrder = layer + 1;
        return mesh;
      });
      this.group.add(...layers);
      return layers;
    });
  }

  /** Puts axes, links (each with its body) and shapes to their poses; returns positions that the picture must show. */
  pose({ axes, links, poses }) {
    const { looks, materials } = this;
    const { data, size, covered } = looks;
    this.moving.clear();
    const shown = [];
    for (const { on, from, to, thick } of links) {
      shown.push(from, to);
      if (covered.has(on) && !thick) continue;
      const radius = thick ? size * thick : looks.thickness(on);
      this.rod(looks.rod, from, to, radius, materials.rods);
      for (const end of [from, to]) this.ball(end, radius, materials.rods);
    }
    axes.forEach(({ point, direction }, k) => {
      const { on, kind } = data.joints[k];
      const half = scale(direction, size * AXIS.half);
      this.rod(looks.barrel, subtract(point, half), add(point, half), size * AXIS.radius, materials.axes);
      if (kind !== "revolute" || (covered.has(on) && covered.has(k))) return;
      const radius = 1.25 * looks.thickness(on);
      const side = scale(direction, 1.3 * radius);
      this.rod(looks.barrel, subtract(point, side), add(point, side), radius, materials.rods);
    });
    poses.forEach(({ r, t }, k) => {
      const matrix = new Matrix4().set(...r[0], t[0], ...r[1], t[1], ...r[2], t[2], 0, 0, 0, 1);
      for (const mesh of this.shapes[k]) mesh.matrix.copy(matrix);
      for (const corner of looks.shapes[k].corners) shown.push(new Vector3(...corner).applyMatrix4(matrix).toArray());
    });
    return shown;
  }

  rod(geometry, from, to, radius, material) {
    const [a, b] = [new Vector3(...from), new Vector3(...to)];
    const length = a.distanceTo(b);
    if (length < 1e-6) return;
    const turn = new Quaternion().setFromUnitVectors(UP, b.clone().sub(a).divideScalar(length));
    this.put(geometry, material, new Matrix4().compose(a.lerp(b, 0.5), turn, new Vector3(radius, length, radius)));
  }

  ball(at, radius, material) {
    this.put(this.looks.ball, material, new Matrix4().makeScale(radius, radius, radius).setPosition(...at));
  }

  /** Rods that are not solid are one surface: the invisible surface that hides objects behind it comes first. */
  put(geometry, material, matrix) {
    const { rods, before } = this.materials;
    const layers = before && material === rods ? [before, material] : [material];
    layers.forEach((it, layer) => {
      const mesh = new Mesh(geometry, it);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrix);
      mesh.renderOrder = layer + 1;
      this.moving.add(mesh);
    });
  }
}

/** A pose whose deviation from another is magnified by a factor, about its own origin. */
export function farther(pose, from, factor) {
  const { r } = compose(invert(from), pose);
  const turn = new Quaternion().setFromRotationMatrix(new Matrix4().set(...r[0], 0, ...r[1], 0, ...r[2], 0, 0, 0, 0, 1));
  const half = Math.acos(Math.min(Math.abs(turn.w), 1));
  const axis = new Vector3(turn.x, turn.y, turn.z).multiplyScalar(Math.sign(turn.w) || 1);
  const angle = Math.min(2 * half * factor, Math.PI);
  const turned = new Matrix4();
  if (axis.lengthSq() > 0) turned.makeRotationAxis(axis.normalize(), angle);
  const e = turned.elements;
  const rows = [[e[0], e[4], e[8]], [e[1], e[5], e[9]], [e[2], e[6], e[10]]];
  return { r: compose({ r: from.r, t: [0, 0, 0] }, { r: rows, t: [0, 0, 0] }).r, t: add(from.t, scale(subtract(pose.t, from.t), factor)) };
}

// Instruments as their frames, references by their kinds, the line of sight of the selected measurement, and names on the picture.
import { BufferAttribute, BufferGeometry, CylinderGeometry, Group, LineSegments, Matrix4, Mesh, SphereGeometry, Vector3 } from "three";
import { act } from "./kinematics.js";
import { flat, solid } from "./materials.js";
import { linesOf, opticsOf, raysOf } from "./optics.js";
import { drawingOf, hasPlace, isSeenFromAfar } from "./places.js";

const DASHES = 24;
/** Most names that are shown at once; with more, only that of the selected measurement's instrument. */
const MOST_NAMES = 12;
/** A device whose frame is the base's, metres, has measured in it: its own position is not known. */
const IN_BASE = 1e-6;

export class Instruments {
  constructor(data, size, labels) {
    const { instruments, targets, mounted, draws_instruments } = data;
    this.materials = { body: solid(), x: solid(), y: solid(), z: solid(), sight: flat(), plumb: flat(), wire: flat(), sheet: solid(0.22, true), edge: flat() };
    this.group = new Group();
    this.kinds = instruments;
    this.isUnknown = instruments.map(({ on, pose: { t } }) => !draws_instruments && on === null && Math.hypot(...t) < IN_BASE);
    this.frames = instruments.map((it) => (it.kind ? drawingOf(it, data, size, this.materials) : frame(this.materials, size)));
    this.frames.forEach((it, k) => (it.visible = !this.isUnknown[k]));
    // Cameras and boards by their kinds, whichever of the two measures the other.
    instruments.forEach((it, k) => {
      const drawn = opticsOf(it, size, this.materials);
      if (drawn) this.frames[k].add(drawn);
    });
    this.seen = targets;
    this.held = targets.map((it) => opticsOf(it, size, this.materials));
    this.rays = new LineSegments(linesOf([]), this.materials.sight);
    this.rays.frustumCulled = false;
    const dashes = new BufferGeometry();
    dashes.setAttribute("position", new BufferAttribute(new Float32Array(6 * DASHES), 3));
    this.sight = new LineSegments(dashes, this.materials.sight);
    this.sight.frustumCulled = false;
    this.group.add(...this.frames, this.sight, this.rays, ...this.held.filter(Boolean));
    // Instruments beside the robot are above or below a position on the grid.
    const stand = (it, k) => it.on === null && hasPlace(it) && it.kind !== "plane" && !this.isUnknown[k];
    const beside = instruments.filter(stand).flatMap(({ pose: { t: [x, y, z] } }) => [x, y, z, x, y, 0]);
    const plumb = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(beside), 3));
    this.group.add(new LineSegments(plumb, this.materials.plumb));
    this.labels = labels;
    this.instruments = instruments.map(({ name }) => labels.add("instrument", name || (draws_instruments ? "instrument" : "measuring device"), true));
    this.targets = mounted.map(({ name }) => labels.add("target", name, true));
  }

  /** Puts instruments and names to their positions, and the line of sight from the selected instrument to the target at `seen`, if there is one. */
  pose(poses, places, chosen, { seen, tip, held, target }) {
    const chosenPlace = seen ?? tip;
    this.held.forEach((it, k) => it?.matrix.copy(matrixOf(held[k])));
    const pair = seen !== null && [[this.kinds[chosen], poses[chosen]], [this.seen[target], held[target]]];
    this.rays.geometry.dispose();
    this.rays.geometry = linesOf(pair ? raysOf(...pair) : []);
    poses.forEach((pose, k) => {
      const it = this.kinds[k];
      // A direction has no position: it is drawn at the target that shows it.
      const { r, t } = it.kind === "direction" ? { r: pose.r, t: chosenPlace } : pose;
      this.frames[k].matrix.copy(matrixOf({ r, t }));
      this.instruments[k].place.set(...(it.kind === "plane" ? act({ r, t }, [it.patch.x, it.patch.y, 0]) : t));
      this.instruments[k].isOff = this.isUnknown[k] || it.kind === "pair" || (poses.length > MOST_NAMES && k !== chosen);
    });
    places.forEach((place, k) => this.targets[k].place.set(...place));
    const hasRays = this.rays.geometry.attributes.position.count > 0;
    this.sight.visible = seen !== null && !hasRays && !this.isUnknown[chosen] && isSeenFromAfar(this.kinds[chosen]);
    if (!this.sight.visible) return;
    const from = this.instruments[chosen].place;
    const points = this.sight.geometry.attributes.position;
    for (let k = 0; k < 2 * DASHES; k++) {
      const at = from.clone().lerp(new Vector3(...seen), (k + 0.25) / (2 * DASHES - 0.5));
      points.setXYZ(k, at.x, at.y, at.z);
    }
    points.needsUpdate = true;
  }

  show(on) {
    this.group.visible = on;
    this.labels.element.hidden = !on;
  }
}

function matrixOf({ r, t }) {
  return new Matrix4().set(...r[0], t[0], ...r[1], t[1], ...r[2], t[2], 0, 0, 0, 1);
}

/** Axes of a frame, with a ball at its origin. */
function frame(materials, size) {
  const group = new Group();
  group.matrixAutoUpdate = false;
  group.add(new Mesh(new SphereGeometry(size * 0.02, 16, 12), materials.body));
  const length = size * 0.09;
  const rod = new CylinderGeometry(size * 0.005, size * 0.005, length, 8).translate(0, length / 2, 0);
  const turns = { x: new Matrix4().makeRotationZ(-Math.PI / 2), y: new Matrix4(), z: new Matrix4().makeRotationX(Math.PI / 2) };
  for (const [name, turn] of Object.entries(turns)) group.add(new Mesh(rod.clone().applyMatrix4(turn), materials[name]));
  return group;
}

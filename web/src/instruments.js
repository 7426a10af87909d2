// Instruments as their frames, places as what they are, the line of sight of the chosen measurement, and names on the picture.
import { BufferAttribute, BufferGeometry, CylinderGeometry, Group, LineSegments, Matrix4, Mesh, SphereGeometry, Vector3 } from "three";
import { act } from "./kinematics.js";
import { flat, solid } from "./materials.js";
import { drawingOf, hasPlace, isSeenFromAfar } from "./places.js";

const DASHES = 24;
/** Names that are shown at once; of more, only that of the chosen measurement's instrument. */
const MOST_NAMES = 12;
const ARROWS = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
const MARGIN = 6;

export class Instruments {
  constructor(data, size) {
    const { instruments, mounted } = data;
    this.materials = { body: solid(), x: solid(), y: solid(), z: solid(), sight: flat(), plumb: flat(), wire: flat(), sheet: solid(0.22, true), edge: flat() };
    this.group = new Group();
    this.kinds = instruments;
    this.frames = instruments.map((it) => (it.kind ? drawingOf(it, data, size, this.materials) : frame(this.materials, size)));
    const dashes = new BufferGeometry();
    dashes.setAttribute("position", new BufferAttribute(new Float32Array(6 * DASHES), 3));
    this.sight = new LineSegments(dashes, this.materials.sight);
    this.sight.frustumCulled = false;
    this.group.add(...this.frames, this.sight);
    // Those beside the robot stand above or below a place on the grid.
    const stand = (it) => it.on === null && hasPlace(it) && it.kind !== "plane";
    const beside = instruments.filter(stand).flatMap(({ pose: { t: [x, y, z] } }) => [x, y, z, x, y, 0]);
    const plumb = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(beside), 3));
    this.group.add(new LineSegments(plumb, this.materials.plumb));
    this.names = document.createElement("div");
    this.names.className = "names";
    this.names.setAttribute("aria-hidden", "true");
    const tag = (className) => ({ name }) => {
      const text = document.createElement("span");
      text.className = className;
      text.textContent = text.dataset.name = name || "instrument";
      this.names.append(text);
      return { text, place: new Vector3() };
    };
    this.instruments = instruments.map(tag("instrument"));
    this.targets = mounted.map(tag("target"));
  }

  /** Puts instruments and names to their places, and the line of sight from the chosen instrument to the target's place `seen`, if there is one. */
  pose(poses, places, chosen, { seen, tip }) {
    const chosenPlace = seen ?? tip;
    poses.forEach((pose, k) => {
      const it = this.kinds[k];
      // A direction has no place: it stands at what shows it.
      const { r, t } = it.kind === "direction" ? { r: pose.r, t: chosenPlace } : pose;
      this.frames[k].matrix.copy(new Matrix4().set(...r[0], t[0], ...r[1], t[1], ...r[2], t[2], 0, 0, 0, 1));
      this.instruments[k].place.set(...(it.kind === "plane" ? act({ r, t }, [it.patch.x, it.patch.y, 0]) : t));
      this.instruments[k].text.hidden = it.kind === "pair" || (poses.length > MOST_NAMES && k !== chosen);
    });
    places.forEach((place, k) => this.targets[k].place.set(...place));
    this.sight.visible = seen !== null && isSeenFromAfar(this.kinds[chosen]);
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
    this.names.hidden = !on;
  }

  /** Writes the names beside their places: at the edge, with an arrow, if these are out of the picture; below others in the way. */
  write(camera, width, height) {
    const taken = [];
    for (const { text, place } of [...this.instruments, ...this.targets]) {
      if (text.hidden) continue;
      const at = place.clone().project(camera);
      const behind = place.clone().applyMatrix4(camera.matrixWorldInverse).z > 0;
      if (behind) at.multiplyScalar(-1e3);
      const outside = Math.max(Math.abs(at.x), Math.abs(at.y)) > 1;
      const arrow = ARROWS[(Math.round(Math.atan2(at.y * height, at.x * width) / (Math.PI / 4)) + 8) % 8];
      const words = outside ? `${text.dataset.name} ${arrow}` : text.dataset.name;
      if (text.textContent !== words) text.textContent = words;
      const [w, h] = [text.offsetWidth, text.offsetHeight];
      const x = clamp(((at.x + 1) / 2) * width + MARGIN, MARGIN, width - w - MARGIN);
      let y = clamp(((1 - at.y) / 2) * height - h - 2, MARGIN, height - h - MARGIN);
      const covers = (it) => x < it.x + it.w && it.x < x + w && y < it.y + it.h && it.y < y + h;
      for (let other = taken.find(covers); other && y < height; other = taken.find(covers)) y = other.y + other.h + 1;
      taken.push({ x, y, w, h });
      // In parts of the picture, since paper has another size.
      text.style.left = `${(100 * x) / width}%`;
      text.style.top = `${(100 * y) / height}%`;
    }
  }
}

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

function clamp(value, least, most) {
  return Math.max(least, Math.min(value, most));
}

// What is drawn of the arm: axes, links, arrows, and where it could reach.
import {
  BufferGeometry, Color, ColorManagement, ConeGeometry, CylinderGeometry, Float32BufferAttribute, Group, InstancedMesh, LinearSRGBColorSpace,
  LineSegments, Matrix4, Mesh, PerspectiveCamera, Points, Quaternion, Scene as World, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { readingsOf } from "./data.js";
import { Instruments } from "./instruments.js";
import { CALIBRATED, NOMINAL, act, add, configure, scale, subtract } from "./kinematics.js";
import { dot, flat, solid } from "./materials.js";
import { extent, hasPlace, roomForArrows } from "./places.js";
import { quantile } from "./statistics.js";
import { colour } from "./theme.js";

const REACH_POINTS = 2500;
const ASPECT = 0.72;
const UP = new Vector3(0, 1, 0);

// Colours are those of the style sheet, as they are.
ColorManagement.enabled = false;

/** The picture: knows data and readings, not controls. */
export class Scene {
  constructor(data) {
    this.data = data;
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The arm in three dimensions, nominal and calibrated, with residual arrows. The text beside says where its tip is.");
    // What is printed: paper takes the last picture that was on the screen, which may be in other colours.
    this.paper = document.createElement("canvas");
    this.paper.className = "paper";
    this.paper.setAttribute("aria-hidden", "true");
    addEventListener("beforeprint", () => this.copyForPrint());
    this.world = new World();
    this.camera = new PerspectiveCamera(35, 1 / ASPECT, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.measure();
    this.build();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.render());
    this.look("oblique");
    // The text and the charts come first: shaders take their time where a processor has to draw.
    setTimeout(() => {
      this.begun = true;
      this.renderNow();
      this.canvas.dataset.drawn = "true";
    });
  }

  /** Sizes that everything else follows. */
  measure() {
    const { rows } = this.data;
    const { count } = rows;
    const errors = rows.error_mm.filter((error) => error !== null).sort((a, b) => a - b);
    const isArrow = (shift) => shift !== null;
    this.has = { arrows: rows.residual.some(isArrow), dots: !rows.residual.every(isArrow) };
    const ends = [[0, 0, 0], ...rows.predicted, ...elbows(this.data)];
    const bounds = boundsOf(ends);
    this.size = Math.max(Math.hypot(...bounds.map(([a, b]) => b - a)) * 0.6, 0.1);
    this.centre = middleOf(bounds);
    const [xs, ys, zs] = bounds;
    // What the views show: all of this, and the robot as it is drawn.
    this.drawn = [];
    this.fitted = xs.flatMap((x) => ys.flatMap((y) => zs.map((z) => [x, y, z])));
    if (this.data.draws_instruments) {
      this.fitted = [...ends, ...nearInstruments(this.data, this.centre, this.size)];
      this.centre = middleOf(boundsOf(this.fitted));
    }
    this.legend = { least: 0, most: quantile(errors, 0.95) || 1e-9, square: 0 };
    this.legend.square = 1e3 * [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].find((it) => it <= this.size / 3 || it === 0.01);
    // Many arrows are shorter, so that they stay apart.
    this.room = Math.min(0.09 * this.size * Math.min(1, Math.sqrt(300 / count)), ...this.data.instruments.map((it) => roomForArrows(it, this.size)));
    const length = this.room;
    this.arrowScale = round(length / (this.legend.most * 1e-3));
    this.axisScale = round((0.05 * this.size) / this.deviation());
  }

  /** How far the axes of both models are apart, metres. */
  deviation() {
    const zero = this.data.readings.map(() => 0);
    const [a, b] = [CALIBRATED, NOMINAL].map((model) => configure(this.data, zero, model));
    const apart = a.axes.map((axis, k) => {
      const tilt = Math.hypot(...subtract(axis.direction, b.axes[k].direction)) * this.size * 0.12;
      return Math.max(tilt, Math.hypot(...subtract(axis.point, b.axes[k].point)));
    });
    return Math.max(...apart, 1e-6);
  }

  build() {
    this.materials = { calibrated: solid(), nominal: solid(0.55), axis: solid(), chosen: solid(), arrow: solid(), grid: flat(), reach: dot(this.size * 0.012) };
    this.parts = { calibrated: new Group(), nominal: new Group() };
    this.buildArrows();
    this.buildReach();
    this.buildGrid();
    this.buildInstruments();
    this.chosen = new Mesh(new SphereGeometry(this.size * 0.013, 16, 12), this.materials.chosen);
    this.world.add(this.parts.calibrated, this.parts.nominal, this.chosen);
    this.recolour();
  }

  buildArrows() {
    const { rows } = this.data;
    const width = Math.min(this.size * (rows.count > 800 ? 0.0016 : 0.003), this.room / 30);
    this.dots = new InstancedMesh(new SphereGeometry(this.size * (rows.count > 800 ? 0.004 : 0.0075), 10, 8), this.materials.arrow, rows.count);
    const shaft = new CylinderGeometry(width, width, 1, 5);
    const head = new ConeGeometry(width * 3, 1, 8);
    this.shafts = new InstancedMesh(shaft, this.materials.arrow, rows.count);
    this.heads = new InstancedMesh(head, this.materials.arrow, rows.count);
    this.parts.arrows = new Group();
    this.parts.arrows.add(this.shafts, this.heads);
    if (this.has.dots) this.parts.arrows.add(this.dots);
    this.headLength = width * 8;
    this.world.add(this.parts.arrows);
  }

  buildInstruments() {
    if (!this.data.draws_instruments) return;
    this.instruments = new Instruments(this.data, this.size);
    this.parts.instruments = this.instruments.group;
    this.world.add(this.parts.instruments);
  }

  /** Puts every arrow where its target was predicted, or a dot where the residual is no shift in the picture. */
  placeArrows() {
    const { rows } = this.data;
    rows.predicted.forEach((from, row) => {
      const shift = rows.residual[row];
      this.dots.setMatrixAt(row, shift ? new Matrix4().makeScale(0, 0, 0) : new Matrix4().makeTranslation(...from));
      const arrow = scale(shift ?? [0, 0, 0], 1e-3 * this.arrowScale);
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
    this.placedScale = this.arrowScale;
  }

  /** Random places within the limits that are farther from every measurement than those are from each other. */
  buildReach() {
    const places = unsampled(this.data, this.size);
    this.reachShare = places.length / REACH_POINTS;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(places.flat(), 3));
    this.parts.reach = new Points(geometry, this.materials.reach);
    this.world.add(this.parts.reach);
  }

  recolour() {
    const of = (name) => new Color(colour(name));
    this.renderer.setClearColor(of("card"));
    const colours = { calibrated: "s0", nominal: "soft", axis: "s2", chosen: "alarm", grid: "rule", reach: "soft" };
    for (const [material, name] of Object.entries(colours)) this.materials[material].uniforms.tint.value = of(name);
    const ofInstruments = { body: "s3", x: "alarm", y: "s2", z: "s0", sight: "alarm", plumb: "soft", wire: "rule", sheet: "s3", edge: "s3" };
    for (const [material, name] of Object.entries(ofInstruments)) if (this.instruments) this.instruments.materials[material].uniforms.tint.value = of(name);
    // One hue, from near the page's colour to full: the larger the residual, the stronger.
    const [least, most] = [of("s1").lerp(of("card"), 0.7), of("s1").lerp(of("ink"), 0.15)];
    const root = document.documentElement.style;
    root.setProperty("--arrow-least", `#${least.getHexString()}`);
    root.setProperty("--arrow-most", `#${most.getHexString()}`);
    this.data.rows.error_mm.forEach((error, row) => {
      const shade = least.clone().lerp(most, Math.min(error / this.legend.most, 1));
      this.shafts.setColorAt(row, shade);
      this.heads.setColorAt(row, shade);
      this.dots.setColorAt(row, shade);
    });
    for (const mesh of [this.shafts, this.heads, this.dots]) mesh.instanceColor.needsUpdate = true;
    this.render();
  }

  buildGrid() {
    const square = this.legend.square / 1e3;
    const half = Math.max(3, Math.ceil((0.8 * this.size) / square)) * square;
    const places = [];
    for (let at = -half; at < half + square / 2; at += square) places.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
    this.world.add(new LineSegments(geometry, this.materials.grid));
  }

  /** Shows both arms at these readings (radians, metres), and the measurement that was chosen. */
  pose(readings, row) {
    const { rows, targets, instruments, mounted, tip } = this.data;
    const nominal = configure(this.data, readings, NOMINAL);
    const calibrated = configure(this.data, readings, CALIBRATED);
    // The calibrated robot stands where it is, at what it touched; the nominal one is moved away from it.
    const apart = (a, b) => add(b, scale(subtract(a, b), this.axisScale));
    const axes = nominal.axes.map((axis, k) => {
      const direction = new Vector3(...apart(axis.direction, calibrated.axes[k].direction)).normalize().toArray();
      return { point: apart(axis.point, calibrated.axes[k].point), direction };
    });
    const placeOf = (frame) => calibrated.at(frame).t;
    // Tools and instruments are no error of the arm: they stand at the last axis as it is.
    const nominalPlace = (frame) => (frame.on === null ? nominal.at(frame).t : add(nominal.at(frame).t, subtract(axes[frame.on].point, nominal.axes[frame.on].point)));
    const links = this.links(calibrated.axes, placeOf);
    const target = targets[rows.target[row]];
    if (target && !target.nominal_pose) links.push([placeOf(tip), placeOf(target)]);
    for (const { on, pose } of mounted) if (on === null) links.push([pose.t, pose.t]);
    const nominalLinks = this.links(axes, nominalPlace);
    if (this.data.draws_instruments) this.drawn = [...links, ...nominalLinks].flat();
    this.fill(this.parts.calibrated, calibrated.axes, links, this.materials.calibrated, this.materials.axis);
    this.fill(this.parts.nominal, axes, nominalLinks, this.materials.nominal, this.materials.nominal);
    const seen = row === null ? null : rows.predicted[row];
    this.chosen.visible = row !== null;
    if (seen) this.chosen.position.set(...seen);
    this.instruments?.pose(instruments.map(calibrated.at), mounted.map(placeOf), rows.instrument[row], { seen, tip: placeOf(tip) });
    if (this.placedScale !== this.arrowScale) this.placeArrows();
    this.render();
  }

  /** Links from the axis of each body to those of the joints that stand on it, and to where its arm ends. */
  links(axes, placeOf) {
    const from = (on) => (on === null ? [0, 0, 0] : axes[on].point);
    const { joints, ends } = this.data;
    return [...joints.map((joint, k) => [from(joint.on), axes[k].point]), ...ends.map((end) => [from(end.on), placeOf(end)])];
  }

  /** Links and the axes as rods, in place of what was there. */
  fill(group, axes, links, linkMaterial, axisMaterial) {
    for (const child of group.children) child.geometry.dispose();
    group.clear();
    for (const [from, to] of links) {
      rod(group, from, to, this.size * 0.009, linkMaterial);
      const joint = new Mesh(new SphereGeometry(this.size * 0.0125, 12, 8), linkMaterial);
      joint.position.set(...to);
      group.add(joint);
    }
    for (const { point, direction } of axes) {
      const half = scale(direction, this.size * 0.075);
      rod(group, subtract(point, half), add(point, half), this.size * 0.0035, axisMaterial);
    }
  }

  show(part, on) {
    if (part === "instruments") this.instruments.show(on);
    else this.parts[part].visible = on;
    this.render();
  }

  look(name) {
    const directions = { oblique: [1, -1.25, 0.75], front: [0, -1.7, 0.02], side: [1.7, 0, 0.02], top: [0.001, -0.02, 1.7] };
    const direction = new Vector3(...directions[name]).normalize();
    const { centre, distance } = this.fit(direction);
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.controls.target.copy(centre);
    this.controls.update();
    this.render();
  }

  /** From how far away, and about which centre, everything is seen from a direction. */
  fit(direction) {
    const right = new Vector3(0, 0, 1).cross(direction).normalize();
    const up = direction.clone().cross(right);
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const centre = new Vector3(...this.centre);
    const places = [...this.fitted, ...this.drawn].map((place) => new Vector3(...place).sub(centre));
    const room = this.data.draws_instruments ? 1.15 : 1.02;
    const distance = () => room * Math.max(...places.map((at) => at.dot(direction) + Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) * ASPECT) / half));
    if (!this.data.draws_instruments) return { centre, distance: distance() };
    // As much room on the left as on the right, and below as above.
    for (const side of [right, up, right, up, right, up]) {
      const from = distance();
      const parts = places.map((at) => at.dot(side) / (from - at.dot(direction)));
      const shift = side.clone().multiplyScalar((from * (Math.min(...parts) + Math.max(...parts))) / 2);
      centre.add(shift);
      for (const at of places) at.sub(shift);
    }
    return { centre, distance: distance() };
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.render();
  }

  /** Fills the width of a place, also when that changes. */
  follow(place) {
    const fit = () => {
      const width = Math.max(place.clientWidth, 120);
      this.renderer.setSize(width, Math.round(width * ASPECT), false);
      this.materials.reach.uniforms.height.value = this.canvas.height;
      this.canvas.style.aspectRatio = `1 / ${ASPECT}`;
      // Resizing empties the picture, which must not be seen.
      this.renderNow();
    };
    new ResizeObserver(fit).observe(place);
    fit();
  }

  /** Calls `choose` with the row whose place is clicked. */
  onChoice(choose) {
    let down;
    this.canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    this.canvas.addEventListener("click", (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const box = this.canvas.getBoundingClientRect();
      let best = [14, null];
      this.data.rows.predicted.forEach((place, row) => {
        const at = new Vector3(...place).project(this.camera);
        const x = box.left + ((at.x + 1) / 2) * box.width;
        const y = box.top + ((1 - at.y) / 2) * box.height;
        const distance = Math.hypot(x - event.clientX, y - event.clientY);
        if (distance < best[0]) best = [distance, row];
      });
      if (best[1] !== null) choose(best[1]);
    });
  }

  /** Draws once, however many changes there are before the next frame. */
  render() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderNow();
    });
  }

  copyForPrint() {
    this.recolour();
    this.renderNow();
    [this.paper.width, this.paper.height] = [this.canvas.width, this.canvas.height];
    this.paper.getContext("2d").drawImage(this.canvas, 0, 0);
  }

  /** Draws at once. */
  renderNow() {
    if (!this.begun) return;
    this.renderer.render(this.world, this.camera);
    this.instruments?.write(this.camera, this.canvas.clientWidth, this.canvas.clientHeight);
  }
}

/** The least and the largest coordinate of places and the origin, by axis. */
function boundsOf(places) {
  return [0, 1, 2].map((k) => places.reduce(([a, b], it) => [Math.min(a, it[k]), Math.max(b, it[k])], [0, 0]));
}

function middleOf(bounds) {
  return bounds.map(([a, b]) => (a + b) / 2);
}

/** Where joints, and what is mounted on them, are in some of the rows. */
function elbows(data) {
  const step = Math.ceil(data.rows.count / 60);
  const rows = data.rows.number.map((_, row) => row).filter((row) => row % step === 0);
  const mounted = data.ends.filter((end) => end !== data.tip);
  return rows.flatMap((row) => {
    const found = configure(data, readingsOf(data, row), CALIBRATED);
    return [...found.axes.map((axis) => axis.point), ...mounted.map((end) => found.at(end).t)];
  });
}

/** Instruments beside the robot that the picture has room for: of those farther away, it shows the direction. */
function nearInstruments({ draws_instruments, instruments }, centre, size) {
  const beside = instruments.filter((it) => draws_instruments && it.on === null && hasPlace(it));
  const places = beside.flatMap((it) => extent(it).map((place) => act(it.pose, place)));
  return places.filter((place) => Math.hypot(...subtract(place, centre)) < 2.5 * size);
}

function rod(group, from, to, radius, material) {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  const length = a.distanceTo(b);
  if (length < 1e-6) return;
  const mesh = new Mesh(new CylinderGeometry(radius, radius, length, 10), material);
  mesh.position.copy(a).lerp(b, 0.5);
  mesh.quaternion.setFromUnitVectors(UP, b.sub(a).divideScalar(length));
  group.add(mesh);
}

/** Two digits of a scale that is at least 1. */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1)));
  return Math.max(1, Math.min(Math.round((value / power) * 2) / 2, 10) * power);
}

/** Numbers from 0 to 1 that are the same each time the page is opened (mulberry32). */
function generator(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let value = Math.imul(state ^ (state >>> 15), 1 | state);
    value = (value + Math.imul(value ^ (value >>> 7), 61 | value)) ^ value;
    return ((value ^ (value >>> 14)) >>> 0) / 4294967296;
  };
}

/** Places of what moves in random configurations within the limits, without those near to where it was measured. */
function unsampled(data, size) {
  const next = generator(1);
  const cell = size / 7;
  const key = (place) => place.map((value) => Math.floor(value / cell)).join(",");
  const sampled = new Set();
  for (const place of data.rows.reached) {
    for (const dx of [-1, 0, 1]) for (const dy of [-1, 0, 1]) for (const dz of [-1, 0, 1]) sampled.add(key(add(place, [dx * cell, dy * cell, dz * cell])));
  }
  const ranges = data.readings.map((_, k) => {
    const joint = data.joints.find((it) => it.reading === k);
    const limits = joint.limits && joint.limits[1] - joint.limits[0] < 100 ? joint.limits : joint.sampled ?? [0, 0];
    return limits.map((limit) => (limit - joint.offset) / joint.multiplier);
  });
  const places = Array.from({ length: REACH_POINTS }, (_, k) => {
    const readings = ranges.map(([a, b]) => a + (b - a) * next());
    return configure(data, readings, CALIBRATED).at(data.reaching[k % data.reaching.length]).t;
  });
  return places.filter((place) => !sampled.has(key(place)));
}

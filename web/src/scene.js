// The drawing of the robot: both models, arrows, the base with its grid, and its reach.
import {
  BufferGeometry, Color, ColorManagement, CylinderGeometry, Float32BufferAttribute, Group, LinearSRGBColorSpace, LineSegments, Matrix4, Mesh,
  PerspectiveCamera, Points, Scene as World, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Arrows, roomOf } from "./arrows.js";
import { readingsOf } from "./data.js";
import { Instruments } from "./instruments.js";
import { CALIBRATED, NOMINAL, act, add, configure, scale, subtract } from "./kinematics.js";
import { Labels } from "./labels.js";
import { dot, faceted, flat, solid, veil } from "./materials.js";
import { extent, hasPlace } from "./places.js";
import { REACH_POINTS, unsampled } from "./reach.js";
import { Figure, Looks, farther } from "./shapes.js";
import { colour } from "./theme.js";
import { DIRECTIONS, framed, middlePlaces } from "./view.js";

const ASPECT = 0.72;
/** Angle (radians) and share of the distance that a key moves the eye. */
const TURN = Math.PI / 24;
const NEARER = 0.8;
/** Radius of a tool's rod as a part of the picture's size. */
const TOOL = 0.006;

// Colours are those of the style sheet, unchanged.
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
    this.canvas.setAttribute("aria-label", "The robot in three dimensions, nominal and calibrated, with residual arrows. The text beside says where its tip is. Arrow keys turn it, plus and minus come nearer and go farther.");
    // For printing: paper takes the last picture that was on the screen, which may be in other colours.
    this.paper = document.createElement("canvas");
    this.paper.className = "paper";
    this.paper.setAttribute("aria-hidden", "true");
    addEventListener("beforeprint", () => this.copyForPrint());
    this.world = new World();
    this.camera = new PerspectiveCamera(35, 1 / ASPECT, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.labels = new Labels();
    this.measure();
    this.build();
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.render());
    this.listenToKeys();
    this.look("oblique");
    // The text and the charts come first: shaders take time if a processor has to draw.
    setTimeout(() => {
      this.begun = true;
      this.renderNow();
      this.canvas.dataset.drawn = "true";
      this.onDrawn?.();
    });
  }

  /** Sizes that determine all others. */
  measure() {
    const { rows } = this.data;
    const errors = rows.error_mm.filter((error) => error !== null).sort((a, b) => a - b);
    const ends = [[0, 0, 0], ...rows.predicted, ...elbows(this.data)];
    const bounds = boundsOf(ends);
    this.size = Math.max(Math.hypot(...bounds.map(([a, b]) => b - a)) * 0.6, 0.1);
    this.centre = middleOf(bounds);
    // Objects of the views: the drawn robot with the nearby measurements, or all of this.
    this.drawn = [];
    this.near = middlePlaces(rows.predicted);
    this.all = ends;
    if (this.data.draws_instruments) this.near = this.all = [...ends, ...nearInstruments(this.data, this.centre, this.size)];
    this.legend = { least: 0, most: errors[Math.round(0.95 * (errors.length - 1))] || 1e-9, square: 0 };
    this.legend.square = 1e3 * [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].find((it) => it <= this.size / 3 || it === 0.01);
    this.room = roomOf(this.data, this.size);
    this.arrowScale = round(this.room / (this.legend.most * 1e-3));
    this.axisScale = round((0.05 * this.size) / this.deviation());
  }

  /** Largest deviation between the axes of both models, metres; a tilt counts at 0.12 of the picture's size. */
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
    this.materials = {
      calibrated: solid(), nominal: faceted(0.3), axis: solid(), thin: solid(0.55), chosen: solid(), arrow: solid(), grid: flat(), mark: solid(),
      shape: faceted(), x: solid(), y: solid(), z: solid(), reach: dot(this.size * 0.012),
    };
    const { calibrated, shape, axis, nominal, thin } = this.materials;
    const looks = new Looks(this.data, this.size);
    const hides = veil();
    this.figures = [new Figure(looks, { rods: calibrated, shapes: shape, axes: axis }), new Figure(looks, { rods: nominal, shapes: nominal, axes: thin, before: hides })];
    this.parts = { calibrated: this.figures[0].group, nominal: this.figures[1].group };
    this.arrows = new Arrows(this.data, this.size, this.room, this.materials.arrow);
    this.has = this.arrows.has;
    this.parts.arrows = this.arrows.group;
    this.chosen = new Mesh(new SphereGeometry(this.size * 0.013, 16, 12), this.materials.chosen);
    this.world.add(this.parts.calibrated, this.parts.nominal, this.parts.arrows, this.chosen);
    this.buildReach();
    this.buildGrid();
    this.buildBase();
    this.buildInstruments();
    this.names = this.data.joints.map((joint) => this.labels.add("joint", joint.name));
    this.recolour();
  }

  buildInstruments() {
    this.instruments = new Instruments(this.data, this.size, this.labels);
    this.parts.instruments = this.instruments.group;
    this.world.add(this.parts.instruments);
  }

  /** Random positions within the limits that are farther from every measurement than those are from each other. */
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
    const colours = {
      calibrated: "s0", shape: "s0", nominal: "soft", axis: "s2", thin: "soft", chosen: "alarm", grid: "rule", mark: "soft", reach: "soft", x: "alarm", y: "s2", z: "s0",
    };
    for (const [material, name] of Object.entries(colours)) this.materials[material].uniforms.tint.value = of(name);
    const ofInstruments = { body: "s3", x: "alarm", y: "s2", z: "s0", sight: "alarm", plumb: "soft", wire: "rule", sheet: "s3", edge: "s3" };
    for (const [material, name] of Object.entries(ofInstruments)) this.instruments.materials[material].uniforms.tint.value = of(name);
    // One hue, from near the page's colour to full: the larger the residual, the stronger.
    const [least, most] = [of("s1").lerp(of("card"), 0.7), of("s1").lerp(of("ink"), 0.15)];
    const root = document.documentElement.style;
    root.setProperty("--arrow-least", `#${least.getHexString()}`);
    root.setProperty("--arrow-most", `#${most.getHexString()}`);
    this.arrows.recolour(least, most, this.legend.most);
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
    // The size of a square is written at the side of one near the base.
    const side = new CylinderGeometry(this.size * 0.003, this.size * 0.003, square, 8).rotateZ(Math.PI / 2).translate(1.5 * square, -square, 0);
    this.world.add(new Mesh(side, this.materials.mark));
    this.labels.add("grid", `${this.legend.square} mm`).place.set(1.5 * square, -square, 0);
  }

  /** The axes of the base's frame, with their names. */
  buildBase() {
    const length = this.size * 0.16;
    const rod = new CylinderGeometry(this.size * 0.005, this.size * 0.005, length, 8).translate(0, length / 2, 0);
    const turns = { x: new Matrix4().makeRotationZ(-Math.PI / 2), y: new Matrix4(), z: new Matrix4().makeRotationX(Math.PI / 2) };
    for (const [name, turn] of Object.entries(turns)) {
      this.world.add(new Mesh(rod.clone().applyMatrix4(turn), this.materials[name]));
      this.labels.add(`axis ${name}`, name).place.set(0, length, 0).applyMatrix4(turn);
    }
  }

  /** Shows both arms at these readings (radians, metres), and the selected measurement. */
  pose(readings, row) {
    const { rows, targets, instruments, mounted, tip } = this.data;
    const nominal = configure(this.data, readings, NOMINAL);
    const calibrated = configure(this.data, readings, CALIBRATED);
    // The calibrated robot is at its true position, in contact with its targets; the deviation of the nominal one is magnified.
    const apart = (a, b) => add(b, scale(subtract(a, b), this.axisScale));
    const axes = nominal.axes.map((axis, k) => {
      const direction = new Vector3(...apart(axis.direction, calibrated.axes[k].direction)).normalize().toArray();
      return { point: apart(axis.point, calibrated.axes[k].point), direction };
    });
    const placeOf = (frame) => calibrated.at(frame).t;
    // Tools and instruments are no error of the arm: they are attached to the last axis unchanged.
    const nominalPlace = (frame) => (frame.on === null ? nominal.at(frame).t : add(nominal.at(frame).t, subtract(axes[frame.on].point, nominal.axes[frame.on].point)));
    const links = this.links(calibrated.axes, placeOf);
    const target = targets[rows.target[row]];
    if (target && !target.nominal_pose) links.push({ on: tip.on, from: placeOf(tip), to: placeOf(target), thick: TOOL });
    for (const { on, pose } of mounted) if (on === null) links.push({ on, from: pose.t, to: pose.t, thick: 2 * TOOL });
    const [own, other] = [calibrated, nominal].map((model) => (this.data.shapes ?? []).map(model.at));
    const shown = this.figures[0].pose({ axes: calibrated.axes, links, poses: own });
    const away = this.figures[1].pose({ axes, links: this.links(axes, nominalPlace), poses: other.map((pose, k) => farther(pose, own[k], this.axisScale)) });
    this.drawn = this.data.draws_instruments ? [...shown, ...away] : shown;
    calibrated.axes.forEach(({ point, direction }, k) => this.names[k].place.set(...add(point, scale(direction, this.size * 0.09))));
    const seen = row === null ? null : rows.predicted[row];
    this.chosen.visible = row !== null;
    if (seen) this.chosen.position.set(...seen);
    const shownAs = { seen, tip: placeOf(tip), held: targets.map(calibrated.at), target: rows.target[row] };
    this.instruments.pose(instruments.map(calibrated.at), mounted.map(placeOf), rows.instrument[row], shownAs);
    this.arrows.place(this.arrowScale);
    this.render();
  }

  /** Links of each body from its axis to those of the joints that it carries, and to the end of its arm. */
  links(axes, placeOf) {
    const from = (on) => (on === null ? [0, 0, 0] : axes[on].point);
    const { joints, ends } = this.data;
    const toJoints = joints.map(({ on }, k) => ({ on, from: from(on), to: axes[k].point }));
    return [...toJoints, ...ends.map((end) => ({ on: end.on, from: from(end.on), to: placeOf(end) })).filter(({ on }) => on !== null)];
  }

  show(part, on) {
    if (part === "instruments") this.instruments.show(on);
    else if (part === "all arrows") {
      this.arrows.all = on;
      this.arrows.place(this.arrowScale);
    }
    else this.parts[part].visible = on;
    this.render();
  }

  /** Points the view from a direction at the robot and nearby objects, or at `all`. */
  look(name, all = this.looksAtAll) {
    this.looksAtAll = all;
    this.direction = name;
    const direction = new Vector3(...DIRECTIONS[name]).normalize();
    const places = [...this.drawn, ...(all ? this.all : this.near)];
    const { centre, distance } = framed(places.length ? places : this.all, direction, { half: Math.tan((this.camera.fov * Math.PI) / 360), aspect: ASPECT });
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.controls.target.copy(centre);
    this.controls.update();
    this.render();
  }

  /** Arrow keys turn the view, plus and minus move it nearer and farther. */
  listenToKeys() {
    this.canvas.tabIndex = 0;
    const turns = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, -TURN], ArrowDown: [0, TURN] };
    this.canvas.addEventListener("keydown", (event) => {
      if (turns[event.key]) this.turn(...turns[event.key]);
      else if (event.key === "+" || event.key === "-") this.zoom(event.key === "+" ? NEARER : 1 / NEARER);
      else return;
      event.preventDefault();
    });
  }

  /** Moves the eye about its target: around, and away from the vertical. */
  turn(around, down) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const [length, tilt, about] = [offset.length(), Math.acos(offset.z / offset.length()), Math.atan2(offset.y, offset.x)];
    const polar = Math.min(Math.max(tilt + down, 0.01), Math.PI - 0.01);
    offset.set(Math.sin(polar) * Math.cos(about + around), Math.sin(polar) * Math.sin(about + around), Math.cos(polar)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.render();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.render();
  }

  /** Fills the width of an element, also when that changes. */
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

  /** Calls `choose` with the row that is clicked. */
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

  /** Draws once, for any number of changes before the next frame. */
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
    this.labels.write(this.camera, this.canvas.clientWidth, this.canvas.clientHeight);
  }
}

/** The least and the largest coordinate of positions and the origin, by axis. */
function boundsOf(places) {
  return [0, 1, 2].map((k) => places.reduce(([a, b], it) => [Math.min(a, it[k]), Math.max(b, it[k])], [0, 0]));
}

function middleOf(bounds) {
  return bounds.map(([a, b]) => (a + b) / 2);
}

/** Positions of joints, and of objects mounted on them, in some of the rows. */
function elbows(data) {
  const step = Math.ceil(data.rows.count / 60);
  const rows = data.rows.number.map((_, row) => row).filter((row) => row % step === 0);
  const mounted = data.ends.filter((end) => end !== data.tip);
  return rows.flatMap((row) => {
    const found = configure(data, readingsOf(data, row), CALIBRATED);
    return [...found.axes.map((axis) => axis.point), ...mounted.map((end) => found.at(end).t)];
  });
}

/** Instruments beside the robot for which the picture has room: for those farther away, it shows the direction. */
function nearInstruments({ draws_instruments, instruments }, centre, size) {
  const beside = instruments.filter((it) => draws_instruments && it.on === null && hasPlace(it));
  const places = beside.flatMap((it) => extent(it).map((place) => act(it.pose, place)));
  return places.filter((place) => Math.hypot(...subtract(place, centre)) < 2.5 * size);
}

/** Two digits of a scale that is at least 1. */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1)));
  return Math.max(1, Math.min(Math.round((value / power) * 2) / 2, 10) * power);
}

// The arm as soon as the model is there: its links and axes, turned by dragging, moved by a slider for each reading.
import { add, configure, scale } from "../../src/kinematics.js";
import { colour } from "../../src/theme.js";
import { element } from "./dom.js";

const ASPECT = 0.6;
/** Angle (radians) that a key turns the eye. */
const TURN = Math.PI / 24;
/** Placeholders for "no limits" would leave a slider without a use. */
const WIDEST = 100;
const TURNS = [-Math.PI, Math.PI];
const SLIDES = [-0.5, 0.5];

let watched;

const MODEL = { screw: "screw", pose: "pose" };

/** The robot of `poecal check --json` as the kinematics have it. */
export function robotOf({ joints, base_from_tip_at_zero: home, mounted = [], instruments = [] }) {
  const names = joints.map(({ name }) => name);
  const readings = [...new Set(joints.map(({ reading }) => reading))];
  const at = (body, before) => (body === undefined ? before : body.link_of === undefined ? null : names.indexOf(body.link_of));
  let near = [0, 0, 0];
  const made = joints.map(({ direction, point_m: point, limits, kind, reading, multiplier, offset, on }, k) => {
    const [x, y, z] = direction;
    const slides = point === null;
    // A slide has no place of its own: it is drawn where the joint before is.
    near = point ?? near;
    const v = slides ? direction : [point[1] * z - point[2] * y, point[2] * x - point[0] * z, point[0] * y - point[1] * x];
    const screw = { v_m: v, w: slides ? [0, 0, 0] : direction };
    return { kind, limits, multiplier, offset, reading: readings.indexOf(reading), on: at(on, k ? k - 1 : null), screw, origin_m: near };
  });
  const ranges = readings.map((_, k) => {
    const own = made.find((joint) => joint.reading === k && joint.multiplier === 1 && joint.offset === 0) ?? made.find((joint) => joint.reading === k);
    const usual = own.kind === "prismatic" ? SLIDES : TURNS;
    return own.limits && own.limits[1] - own.limits[0] < WIDEST ? own.limits : usual;
  });
  const frame = (on, { position_m: t }) => ({ on, pose: { r: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], t } });
  const named = [...mounted, ...instruments].map((it) => frame(at(it.on), it.base_from_frame_at_zero));
  const ends = named.length ? named : [frame(joints.length - 1, home)];
  return { joints: made, readings, ranges, ends, slides: readings.map((_, k) => made.find((joint) => joint.reading === k).kind === "prismatic") };
}

/** Lines to draw at some readings, each with its kind, and where the first arm ends. */
export function linesOf(robot, readings) {
  const { axes, at } = configure(robot, readings, MODEL);
  const tips = robot.ends.map((end) => at(end).t);
  const of = (on) => (on === null ? [0, 0, 0] : axes[on].point);
  const links = axes.map(({ point }, k) => ["link", of(robot.joints[k].on), point]);
  const ends = [...links.map(([, , to]) => to), ...tips];
  const size = Math.max(0.1, ...ends.map((it) => Math.hypot(...it)));
  const rods = axes.map(({ point, direction }) => ["axis", add(point, scale(direction, -0.06 * size)), add(point, scale(direction, 0.06 * size))]);
  return { lines: [...links, ...robot.ends.map(({ on }, k) => ["link", of(on), tips[k]]), ...rods], tip: tips[0], size };
}

/** The eye: from around and above. */
class Eye {
  around = -Math.PI / 3.2;
  above = Math.PI / 7;

  /** A place on the picture, right and up. */
  see([x, y, z]) {
    const [c, s] = [Math.cos(this.around), Math.sin(this.around)];
    const [right, back] = [-x * s + y * c, x * c + y * s];
    return [right, z * Math.cos(this.above) - back * Math.sin(this.above)];
  }
}

function draw(canvas, robot, readings, eye) {
  const width = Math.max(canvas.clientWidth, 120);
  const ratio = Math.min(devicePixelRatio, 2);
  [canvas.width, canvas.height] = [width * ratio, width * ASPECT * ratio];
  const pen = canvas.getContext("2d");
  const { lines } = linesOf(robot, readings);
  const reach = Math.max(0.1, robot.reach);
  // The floor is seen from above, the arm goes up from it.
  const unit = (0.46 * Math.min(canvas.width, canvas.height * 1.1)) / reach;
  const middle = [0, 0, 0.3 * reach];
  const on = (place) => {
    const [right, up] = eye.see(add(place, scale(middle, -1)));
    return [canvas.width / 2 + right * unit, canvas.height / 2 - up * unit];
  };
  const line = (from, to, name, thick) => {
    pen.beginPath();
    pen.moveTo(...on(from));
    pen.lineTo(...on(to));
    pen.strokeStyle = colour(name);
    pen.lineWidth = thick * ratio;
    pen.stroke();
  };
  pen.lineCap = "round";
  pen.lineJoin = "round";
  const half = 0.5 * reach;
  for (let k = -2; k <= 2; k += 1) {
    line([(k * half) / 2, -half, 0], [(k * half) / 2, half, 0], "rule", 1);
    line([-half, (k * half) / 2, 0], [half, (k * half) / 2, 0], "rule", 1);
  }
  for (const [axis, name] of [[[1, 0, 0], "alarm"], [[0, 1, 0], "s2"], [[0, 0, 1], "s0"]]) line([0, 0, 0], scale(axis, 0.15 * reach), name, 1.5);
  for (const [kind, from, to] of lines) line(from, to, kind === "link" ? "s0" : "s2", kind === "link" ? 6 : 3);
  canvas.dataset.drawn = "true";
}

const shown = (value, slides) => (slides ? `${(1e3 * value).toFixed(0)} mm` : `${((180 * value) / Math.PI).toFixed(0)}°`).replace("-", "−");

/** Shows the model of a check in `place`; the result draws anew, in other colours. */
export function showRobot(place, model) {
  const robot = robotOf(model);
  const readings = robot.ranges.map(([least, most]) => (least <= 0 && most >= 0 ? 0 : (least + most) / 2));
  robot.reach = Math.max(...[readings, robot.ranges.map(([a, b]) => (a + b) / 2), robot.ranges.map(([, b]) => b)].map((it) => linesOf(robot, it).size));
  const eye = new Eye();
  const canvas = element("canvas", { tabIndex: 0, role: "img", "aria-label": `The arm of ${model.name} in three dimensions. Arrow keys turn it.` });
  const tip = element("p", { class: "note", role: "status" });
  const redraw = () => {
    draw(canvas, robot, readings, eye);
    tip.textContent = `Tip (${model.tip}) at ${linesOf(robot, readings).tip.map((it) => (1e3 * it).toFixed(1)).join(", ").replaceAll("-", "−")} mm in ${model.base}. Drag or arrow keys turn the picture.`;
  };
  const turn = (around, above) => {
    eye.around += around;
    eye.above = Math.min(Math.max(eye.above + above, -Math.PI / 2), Math.PI / 2);
    redraw();
  };
  let last;
  canvas.addEventListener("pointerdown", (event) => {
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!last) return;
    turn((last[0] - event.clientX) / 120, (event.clientY - last[1]) / 120);
    last = [event.clientX, event.clientY];
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, () => (last = undefined));
  const keys = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, TURN], ArrowDown: [0, -TURN] };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    turn(...keys[event.key]);
  });
  const sliders = robot.readings.map((name, k) => {
    const [min, max] = robot.ranges[k];
    const output = element("output", { textContent: shown(readings[k], robot.slides[k]) });
    const input = element("input", { type: "range", id: `reading-${k}`, min, max, step: "any", value: readings[k], oninput: () => {
      readings[k] = Number(input.value);
      output.textContent = shown(readings[k], robot.slides[k]);
      input.setAttribute("aria-valuetext", output.textContent);
      redraw();
    } });
    return element("div", { class: "slider" }, element("label", { htmlFor: input.id, textContent: name }), input, output);
  });
  place.replaceChildren(element("div", { class: "stage" }, canvas, tip), element("div", { class: "sliders" }, sliders));
  watched?.disconnect();
  watched = new ResizeObserver(redraw);
  watched.observe(place);
  redraw();
  return redraw;
}

// The arm in three dimensions with its controls.
import { offBy, readingsOf, shown, withUnit } from "./data.js";
import { CALIBRATED, NOMINAL, configure, subtract } from "./kinematics.js";
import { kindWords, wordOf } from "./places.js";
import { Scene } from "./scene.js";
import { onColours } from "./theme.js";

/** Fills `place` with the picture and its controls; returns the function that moves the arm to a row, if it is drawn. */
export function showArm(place, data) {
  let scene;
  try {
    scene = new Scene(data);
  } catch {
    place.innerHTML = '<p class="note">This browser has no WebGL, which the picture that turns needs: it is drawn from two sides.</p>';
    place.parentElement.classList.add("no-webgl");
    return;
  }
  const still = document.getElementById("still");
  still?.classList.add("waiting");
  const stage = element("div", data.draws_instruments ? "stage stays" : "stage");
  const frame = element("div", "scene");
  frame.append(scene.canvas, scene.paper, scene.labels.element);
  const panel = element("div", "panel");
  place.append(stage, panel);
  scene.follow(frame);
  const state = { readings: data.readings.map((_, k) => middle(data, k)), row: null };
  const view = { data, scene, state, listeners: [] };
  stage.append(frame, viewControls(view), colourLine(view), scaleLine(scene));
  panel.append(measurementControls(view), jointControls(view), sizeControls(view), shownControls(view), stateText(view));
  scene.onChoice((row) => choose(view, row));
  onColours(() => {
    scene.recolour();
    scene.renderNow();
  });
  choose(view, 0);
  scene.look("oblique");
  // Until the picture is drawn, the print has the still.
  scene.onDrawn = () => {
    place.dataset.drawn = "true";
    still?.setAttribute("hidden", "");
  };
  return (row) => choose(view, row);
}

function element(name, className, text) {
  const found = document.createElement(name);
  if (className) found.className = className;
  if (text) found.textContent = text;
  return found;
}

/** The middle of a reading's measured range. */
function middle(data, reading) {
  const column = data.rows.values[reading];
  return ((Math.min(...column) + Math.max(...column)) / 2) * data.factors[reading];
}

function changed(view) {
  view.scene.pose(view.state.readings, view.state.row);
  for (const listener of view.listeners) listener();
}

/** Moves the arm to a row that is drawn. */
function choose(view, row) {
  view.state.row = row;
  view.state.readings = readingsOf(view.data, row);
  changed(view);
}

function group(title) {
  const set = element("fieldset");
  set.append(element("legend", "", title));
  return set;
}

function button(text, action) {
  const found = element("button", "", text);
  found.type = "button";
  found.addEventListener("click", action);
  return found;
}

/** The drawn row whose number is nearest to the requested one. */
function rowOfNumber({ rows }, number) {
  const distance = (row) => Math.abs(rows.number[row] - number);
  return rows.number.reduce((best, _, row) => (distance(row) < distance(best) ? row : best), 0);
}

function measurementControls(view) {
  const { data, state } = view;
  const { rows } = data;
  const set = group("Measurement");
  const line = element("div", "row");
  const label = element("label", "", "row");
  const input = element("input");
  Object.assign(input, { type: "number", min: 1, max: data.count, step: 1 });
  label.append(input);
  input.addEventListener("change", () => choose(view, rowOfNumber(data, Number(input.value) || 1)));
  const step = (by) => () => choose(view, ((state.row ?? 0) + by + rows.count) % rows.count);
  const worst = () => rows.error_mm.reduce((best, error, row) => (error > rows.error_mm[best] ? row : best), 0);
  line.append(label, button("previous", step(-1)), button("next", step(1)), button("worst", () => choose(view, worst())));
  const text = element("p", "state");
  view.listeners.push(() => {
    input.value = state.row === null ? "" : rows.number[state.row];
    text.textContent = state.row === null ? "none: the arm stands as the sliders say" : describe(data, state.row);
  });
  set.append(line, text);
  return set;
}

function describe({ rows, targets, instruments, draws_instruments }, row) {
  const set = rows.sets[row] & 1 ? "held out" : "fitted";
  const target = targets[rows.target[row]].name;
  const instrument = instruments[rows.instrument[row]];
  const kind = wordOf(instrument);
  const from = draws_instruments && kind !== "pair" && instrument.name && (instrument.name === kind ? `the ${kind}` : `${kind} ${instrument.name}`);
  return `${rows.place[row]}, ${set}${target ? `, target ${target}` : ""}${from ? `, ${from}` : ""}: off by ${offBy(rows, row)}`;
}

function slider(label, { min, max, step, value, spoken }, changedTo) {
  const line = element("div", "slider");
  const input = element("input");
  Object.assign(input, { type: "range", min, max, step, value, id: `slider-${label.replace(/[^a-z0-9]+/gi, "-")}-${counter++}` });
  const name = element("label", "", label);
  name.htmlFor = input.id;
  const output = element("output");
  output.htmlFor = input.id;
  const tell = () => {
    const text = spoken(Number(input.value));
    output.textContent = text;
    input.setAttribute("aria-valuetext", text);
  };
  input.addEventListener("input", () => {
    changedTo(Number(input.value));
    tell();
  });
  tell();
  line.append(name, input, output);
  return { line, input, output, tell };
}

let counter = 0;

function jointControls(view) {
  const { data, state } = view;
  const set = group("Joints");
  data.readings.forEach((reading, k) => {
    const factor = data.factors[k];
    const column = data.rows.values[k];
    const sampled = [Math.min(...column), Math.max(...column)];
    const joint = data.joints.find((it) => it.reading === k && it.multiplier === 1 && it.offset === 0 && it.limits);
    // With placeholders for "no limits" a slider would be of no use.
    const limits = joint && joint.limits[1] - joint.limits[0] < 100 ? joint.limits.map((limit) => limit / factor) : sampled;
    const range = [Math.min(limits[0], sampled[0]), Math.max(limits[1], sampled[1])];
    if (range[0] === range[1]) range[1] = range[0] + 1;
    const { line, input, output, tell } = slider(
      reading.name,
      { min: range[0], max: range[1], step: "any", value: state.readings[k] / factor, spoken: (value) => `${shown(value, 4)} ${reading.unit}` },
      (value) => {
        state.readings[k] = value * factor;
        state.row = null;
        changed(view);
      },
    );
    view.listeners.push(() => {
      const value = state.readings[k] / factor;
      if (state.row !== null) input.value = value;
      tell();
      const outside = value < sampled[0] - 1e-3 || value > sampled[1] + 1e-3;
      output.classList.toggle("outside", outside);
      line.title = outside ? "not sampled" : "";
      if (outside) input.setAttribute("aria-valuetext", `${output.textContent}, not sampled`);
    });
    set.append(line);
  });
  return set;
}

function sizeControls(view) {
  const set = group("Exaggeration");
  const { scene } = view;
  const add = (label, value, most, apply) => {
    const { line } = slider(
      label,
      { min: 0, max: Math.log10(most), step: 0.01, value: Math.log10(value), spoken: (power) => `× ${shown(10 ** power, 2)}` },
      (power) => {
        apply(10 ** power);
        changed(view);
      },
    );
    set.append(line);
  };
  add("nominal arm", scene.axisScale, 1000, (value) => (scene.axisScale = value));
  if (scene.has.arrows) add("arrows", scene.arrowScale, 1e5, (value) => (scene.arrowScale = value));
  return set;
}

function shownControls(view) {
  const set = group("Shown");
  const add = (text, part, on) => {
    const label = element("label");
    const box = element("input");
    Object.assign(box, { type: "checkbox", checked: on });
    box.addEventListener("change", () => {
      view.scene.show(part, box.checked);
    });
    view.scene.show(part, on);
    label.append(box, text);
    const line = element("div", "row");
    line.append(label);
    set.append(line);
    return box;
  };
  add("nominal arm", "nominal", true);
  add(residualWords(view.scene), "arrows", true);
  const { worst, rows } = view.scene.arrows;
  if (worst.size < rows.count) add(`all ${rows.count} residuals, not only the ${worst.size} largest`, "all arrows", false);
  const reach = view.scene.reachShare > 0 && add("reachable, but not measured", "reach", false);
  const kinds = deviceWords(view);
  add(kinds ? `${kinds} and names` : "names", "instruments", true);
  if (reach) reach.addEventListener("change", () => (view.keyOfReach.hidden = !reach.checked));
  return set;
}

/** Words on the buttons of the views. */
const VIEWS = [["oblique", "from the corner"], ["front", "front"], ["side", "side"], ["top", "top"]];

function viewControls({ scene }) {
  const line = element("div", "row views");
  line.setAttribute("role", "group");
  line.setAttribute("aria-label", "View");
  for (const [name, words] of VIEWS) line.append(button(words, () => scene.look(name)));
  const all = button("all measurements", () => {
    scene.look(scene.direction, !scene.looksAtAll);
    all.setAttribute("aria-pressed", String(scene.looksAtAll));
  });
  all.setAttribute("aria-pressed", "false");
  if (scene.near !== scene.all) line.append(all);
  line.append(button("nearer", () => scene.zoom(0.8)), button("farther", () => scene.zoom(1.25)));
  return line;
}

/** Poses of the arms' ends, in words that a screen reader speaks when they are at rest. */
function stateText(view) {
  const { data, state } = view;
  const text = element("p", "state");
  text.setAttribute("role", "status");
  text.id = "tip";
  view.listeners.push(() => {
    const [calibrated, nominal] = [CALIBRATED, NOMINAL].map((model) => configure(data, state.readings, model));
    const ends = data.ends.map((end) => {
      const [place, other] = [calibrated, nominal].map((model) => model.at(end).t);
      return { name: end.name, place, words: place.map((value) => shown(1e3 * value, 5)).join(", "), apart: shown(1e3 * Math.hypot(...subtract(place, other))) };
    });
    text.dataset.tip = calibrated.at(data.tip).t.join(",");
    text.dataset.shapes = JSON.stringify((data.shapes ?? []).map((shape) => calibrated.at(shape).t));
    text.dataset.ends = JSON.stringify(ends.map(({ name, place }) => [name, place]));
    const [{ words, apart }] = ends;
    const isTip = data.ends.length === 1 && data.ends[0] === data.tip;
    text.textContent = isTip
      ? `Tip at ${words} mm in the base; the tip of the nominal model is ${apart} mm away.`
      : `In the base: ${ends.map((end) => `${end.name} at ${end.words} mm, by the nominal model ${end.apart} mm away`).join("; ")}.`;
  });
  return text;
}

/** Objects that are drawn beside the robot, in words. */
function deviceWords({ data, scene }) {
  if (data.draws_instruments) return kindWords(data);
  return scene.instruments.isUnknown[0] || data.instruments[0]?.kind === "pair" ? "" : "measuring device";
}

function colourLine(view) {
  const { data } = view;
  const line = element("ul", "keys");
  const keys = [["calibrated", "s0"], ["nominal", "soft"], ["axes of the joints", "s2"], ["chosen measurement", "alarm"]];
  const devices = deviceWords(view);
  if (devices) keys.push([devices, "s3"]);
  const add = (text, name, className = "") => {
    const item = element("li");
    const sign = element("i", className);
    sign.style.setProperty("--key", `var(--${name})`);
    item.append(sign, text);
    line.append(item);
    return item;
  };
  for (const [text, name] of keys) add(text, name);
  view.keyOfReach = add("reachable, but not measured", "soft", "ring");
  view.keyOfReach.hidden = true;
  return line;
}

/** Words for the symbols of the rows' residuals. */
function residualWords({ has }, arrows = "residual arrows", dots = "measured places") {
  if (has.arrows && has.dots) return `${arrows} and ${dots}`;
  return has.dots ? dots : arrows;
}

function scaleLine(scene) {
  const line = element("p", "scale");
  const { least, most, square } = scene.legend;
  const ramp = element("span", "ramp");
  ramp.style.setProperty("--from", "var(--arrow-least)");
  ramp.style.setProperty("--to", "var(--arrow-most)");
  const { name, unit } = scene.data.lead;
  const what = residualWords(scene, "arrows", "dots");
  const of = name === "position" ? "" : ` of ${name}`;
  line.append(`${what[0].toUpperCase()}${what.slice(1)}: ${least}`, ramp, `${withUnit(most, unit)}${of} and more. Squares of the grid: ${square} mm.`);
  const how = element("span", "on-screen");
  how.textContent = " Drag or arrow keys turn it, the wheel or + and − come nearer and go farther.";
  line.append(how);
  return line;
}

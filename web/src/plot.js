// One chart: dots, lines and bars over two axes, by uPlot, in the page's colours and as wide as its place.
import uPlot from "uplot";
import { shown } from "./data.js";
import { colour, onColours } from "./theme.js";

const FONT = '12px system-ui, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif';

function axis(label, size) {
  return {
    label,
    labelSize: 18,
    labelGap: 2,
    size,
    gap: 4,
    font: FONT,
    labelFont: FONT,
    stroke: () => colour("soft"),
    grid: { stroke: () => colour("rule"), width: 1 },
    ticks: { show: false },
    values: (_, splits) => splits.map((value) => ticked(value, splits)),
  };
}

/** A tick's label, with as many decimals as the steps need. */
function ticked(value, splits) {
  if (value === null) return "";
  const step = splits.length > 1 ? Math.abs(splits[1] - splits[0]) : 1;
  if (step < 1e-4 || Math.abs(value) >= 1e6) return value === 0 ? "0" : value.toExponential(0).replace("-", "−");
  const text = value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  return text.replace("-", "−");
}

/** Series of dots that follow the colour of `name`. */
export function dots(label, name, options = {}) {
  const { size = 5, ring = false } = options;
  return {
    label,
    key: name,
    ring,
    paths: () => null,
    points: {
      show: true,
      size,
      width: ring ? 2 : 0,
      stroke: () => colour(name),
      fill: () => (ring ? "transparent" : `color-mix(in srgb, ${colour(name)} 75%, transparent)`),
    },
  };
}

/** A line that follows the colour of `name`. */
export function line(label, name, options = {}) {
  const { width = 2, dash, paths } = options;
  return { label, key: name, isLine: true, stroke: () => colour(name), width, dash, paths, points: { show: false }, spanGaps: true };
}

/** Bars that follow the colour of `name`. */
export function bars(label, name) {
  return {
    label,
    key: name,
    stroke: () => colour(name),
    width: 1,
    fill: () => `color-mix(in srgb, ${colour(name)} 35%, transparent)`,
    paths: uPlot.paths.bars({ size: [1, Infinity], align: 1 }),
    points: { show: false },
  };
}

/** Steps that begin at each x. */
export function steps(label, name) {
  return line(label, name, { paths: uPlot.paths.stepped({ align: 1 }) });
}

/**
 * Draws a chart into `place`. `spoken` is what a screen reader says instead of the picture, `tell(index)` what stands below when the
 * cursor is near a point.
 */
export function plot(place, { x, y, series, values, height = 260, range, spoken, readout, tell, logX = false }) {
  const target = document.createElement("div");
  place.append(target);
  const width = () => Math.max(target.clientWidth, 120);
  const chart = new uPlot(
    {
      width: width(),
      height,
      legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false }, focus: { prox: 30 } },
      scales: { x: { time: false, distr: logX ? 3 : 1 }, y: range ? { range } : {} },
      axes: [axis(x, 38), axis(y, 62)],
      series: [{}, ...series],
      hooks: readout ? { setCursor: [(it) => say(it, readout, tell)] } : {},
    },
    values,
    target,
  );
  const canvas = target.querySelector("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", spoken);
  new ResizeObserver(() => {
    if (width() !== chart.width) chart.setSize({ width: width(), height });
  }).observe(target);
  onColours(() => chart.redraw(false));
  return chart;
}

function say(chart, readout, tell) {
  const index = chart.cursor.idx;
  const at = index === null || index === undefined ? null : tell(index);
  readout.textContent = at ?? "";
}

/** What colours mean. */
export function keys(place, series) {
  const list = document.createElement("ul");
  list.className = "keys";
  for (const { label, key, ring, isLine } of series) {
    const item = document.createElement("li");
    const sign = document.createElement("i");
    sign.style.setProperty("--key", `var(--${key})`);
    sign.className = ring ? "ring" : isLine ? "line" : "";
    item.append(sign, label);
    list.append(item);
  }
  place.append(list);
}

/** A line of text below a chart, where what the cursor is on is said. */
export function readoutLine(place) {
  const text = document.createElement("p");
  text.className = "readout";
  text.setAttribute("aria-hidden", "true");
  place.append(text);
  return text;
}

/** Text with a number and its unit. */
export function withUnit(value, unit) {
  return `${shown(value)} ${unit}`;
}

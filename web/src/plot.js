// One chart: dots, lines and bars over two axes, by uPlot, in the page's colours and as wide as its place.
import uPlot from "uplot";
import { colour, onColours } from "./theme.js";

const FONT = '12px system-ui, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif';

function axis(label, size, gap) {
  return {
    label,
    labelSize: 16,
    labelGap: 0,
    size,
    gap,
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
  if (step < 1e-5 || Math.abs(value) >= 1e6) return value === 0 ? "0" : value.toExponential(0).replaceAll("-", "−");
  let decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  // Steps of 2.5 need one more.
  if (Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return value.toFixed(decimals).replace("-", "−");
}

function padded(_, least, most) {
  const room = 0.02 * (most - least) || 0.5;
  return [least - room, most + room];
}

/** Series of dots that follow the colour of `name`: discs, open ones that hide nothing, or rings around what is suspected. */
export function dots(label, name, options = {}) {
  const { size = 5, ring = false, open = false } = options;
  return { label, key: name, ring, open, size, paths: () => null, points: { show: false } };
}

/** Draws a series of dots. Small ones are squares, which thousands of take no time. */
function drawDots(chart, index) {
  const { key, ring, open, size } = chart.series[index];
  if (!size) return;
  const { ctx, bbox } = chart;
  const [xs, ys] = [chart.data[0], chart.data[index]];
  const side = size * devicePixelRatio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.fillStyle = ctx.strokeStyle = colour(key);
  ctx.globalAlpha = ring ? 1 : 0.75;
  ctx.lineWidth = (ring ? 2 : 1.25) * devicePixelRatio;
  ys.forEach((value, k) => {
    if (value === null || value === undefined) return;
    const [x, y] = [chart.valToPos(xs[k], "x", true), chart.valToPos(value, "y", true)];
    if (!ring && size < 5 - !open) {
      if (open) ctx.strokeRect(x - side / 2, y - side / 2, side, side);
      else ctx.fillRect(x - side / 2, y - side / 2, side, side);
      return;
    }
    ctx.beginPath();
    ctx.arc(x, y, side / 2, 0, 2 * Math.PI);
    if (ring || open) ctx.stroke();
    else ctx.fill();
  });
  ctx.restore();
}

/** A line that follows the colour of `name`. */
export function line(label, name, options = {}) {
  const { width = 2, dash, paths } = options;
  return { label, key: name, isLine: true, stroke: () => colour(name), width, dash, paths, points: { show: false } };
}

/** An edge of a band, which is not drawn itself. */
export function edge() {
  return { label: "", stroke: "transparent", width: 0, points: { show: false } };
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

/** What draws each chart anew at the width of its place. */
const fits = [];

// Paper is as wide as its style says, before anything is printed: charts keep the width that they have then.
addEventListener("beforeprint", () => {
  document.documentElement.classList.add("on-paper");
  fits.forEach((fit) => fit());
});
addEventListener("afterprint", () => {
  document.documentElement.classList.remove("on-paper");
  fits.forEach((fit) => fit());
});

/**
 * Draws a chart into `place`. `spoken` is what a screen reader says instead of the picture, `tell(index)` what stands below when the
 * cursor is near a point.
 */
export function plot(place, { x, y, series, values, height = 260, range, spoken, readout, tell, wide = false, band }) {
  const target = document.createElement("div");
  place.append(target);
  const width = () => Math.max(target.clientWidth, 120);
  const chart = new uPlot(
    {
      width: width(),
      height,
      legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false }, focus: { prox: 30 } },
      // Dots at the ends lie whole on the plot.
      scales: { x: { time: false, range: wide ? undefined : padded }, y: range ? { range } : {} },
      axes: [axis(x, 27, 8), axis(y, 52, 4)],
      series: [{}, ...series],
      bands: band ? [{ series: band.series, fill: () => `color-mix(in srgb, ${colour(band.key)} 15%, transparent)` }] : [],
      hooks: { drawSeries: [drawDots], setCursor: readout ? [(it) => say(it, readout, tell)] : [] },
    },
    values,
    target,
  );
  const canvas = target.querySelector("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", spoken);
  const fit = () => {
    if (width() !== chart.width) chart.setSize({ width: width(), height });
  };
  new ResizeObserver(fit).observe(target);
  fits.push(fit);
  onColours(() => chart.redraw(false));
  return chart;
}

/** How far (px) a dot may be from the cursor to be meant. */
const NEAR = 30;

/** The index of the dot nearest to the cursor, and where it is drawn; none if there is none near. */
function nearestDot(chart) {
  const { left, top } = chart.cursor;
  let best = null;
  let least = NEAR * NEAR;
  if (left < 0 || top < 0) return best;
  const xs = chart.data[0];
  chart.series.forEach(({ key, size }, series) => {
    if (!key || !size) return;
    chart.data[series].forEach((value, index) => {
      if (value === null || value === undefined) return;
      const [x, y] = [chart.valToPos(xs[index], "x"), chart.valToPos(value, "y")];
      const far = (x - left) ** 2 + (y - top) ** 2;
      if (far < least) [least, best] = [far, { index, x, y }];
    });
  });
  return best;
}

/** Says what the dot nearest to the cursor is, and marks it. */
function say(chart, readout, tell) {
  const found = nearestDot(chart);
  readout.textContent = found ? tell(found.index) : "";
  let mark = chart.over.querySelector(".meant");
  if (!mark) {
    mark = document.createElement("i");
    mark.className = "meant";
    chart.over.append(mark);
  }
  mark.hidden = !found;
  if (found) Object.assign(mark.style, { left: `${found.x}px`, top: `${found.y}px` });
}

/** What colours mean. */
export function keys(place, series) {
  const list = document.createElement("ul");
  list.className = "keys";
  for (const { label, key, ring, open, isLine } of series) {
    const item = document.createElement("li");
    const sign = document.createElement("i");
    sign.style.setProperty("--key", `var(--${key})`);
    sign.className = ring ? "ring" : open ? "open" : isLine ? "line" : "";
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

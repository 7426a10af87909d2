// The charts of the rows.
import { shown, withUnit } from "./data.js";
import { bars, dots, edge, keys, line, plot, readoutLine, steps } from "./plot.js";
import { interpolate, normalQuantile, quantile, smooth } from "./statistics.js";

/** Residuals by component: name, values, unit. */
function componentsOf({ rows }) {
  return rows.residuals.flatMap(({ unit, components }) => components.map(({ name, values }) => [name, values, unit]));
}

/** Draws the chart that a figure is the place for. */
export function drawChart(figure, data) {
  const charts = { rows, components, joints, histogram, normal, leverage };
  charts[figure.dataset.chart](figure.querySelector(".drawing"), data);
}

const SETS = [
  ["fitted", "s0"],
  ["held out", "s1"],
];

/** Fitted, held-out and suspected rows as three series of some values, in this order of rows. */
function bySet({ rows }, order, values, size) {
  const { held_out, suspected } = rows;
  const of = (keep) => order.map((row) => (keep(row) ? values[row] : null));
  const series = [
    [dots("fitted", "s0", { size }), of((row) => !held_out[row])],
    [dots("held out", "s1", { size: size + 1, open: true }), of((row) => held_out[row])],
    [dots("suspected", "alarm", { size: size + 5, ring: true }), of((row) => suspected[row])],
  ];
  const present = series.filter(([, column]) => column.some((value) => value !== null));
  return { series: present.map(([it]) => it), columns: present.map(([, column]) => column) };
}

/** All rows in order, or only those that stand for all. */
function inOrder({ rows }, keep = () => true) {
  return rows.number.map((_, row) => row).filter(keep);
}

function sized(data) {
  return data.rows.count > 800 ? 3 : 5;
}

/** What is said of a row under the cursor. */
function name({ rows, lead }, row) {
  const set = rows.held_out[row] ? "held out" : "fitted";
  const suspected = rows.suspected[row] ? ", suspected" : "";
  return `${rows.place[row]}, ${set}${suspected}: ${withUnit(rows.error_mm[row], lead.unit)}`;
}

function rows(place, data) {
  const order = inOrder(data);
  const { series, columns } = bySet(data, order, data.rows.error_mm, sized(data));
  keys(place, series);
  const largest = order.reduce((a, b) => (data.rows.error_mm[b] > data.rows.error_mm[a] ? b : a), 0);
  const chart = document.createElement("div");
  place.append(chart);
  plot(chart, {
    x: "row, in the order read",
    y: `${data.lead.name} error, ${data.lead.unit}`,
    series,
    values: [data.rows.number, ...columns],
    range: (_, __, most) => [0, most > 0 ? most * 1.05 : 1],
    spoken: `Error of ${data.lead.name} in ${order.length} rows in the order read; the largest is ${name(data, largest)}.`,
    readout: readoutLine(place),
    tell: (index) => name(data, order[index]),
  });
}

function components(place, data) {
  const order = inOrder(data);
  keys(place, bySet(data, order, data.rows.number, 5).series);
  const grid = gridIn(place);
  const readout = readoutLine(place);
  for (const [part, values, unit] of componentsOf(data)) {
    const cell = cellIn(grid, part);
    const { series, columns } = bySet(data, order, values, sized(data) - 1);
    plot(cell, {
      x: "row",
      y: `residual, ${unit}`,
      height: 190,
      series,
      values: [data.rows.number, ...columns],
      spoken: `Residuals of ${part} of each row in the order read; the table below has their means and spreads.`,
      readout,
      tell: (index) => name(data, order[index]),
    });
  }
}

function gridIn(place) {
  const grid = document.createElement("div");
  grid.className = "grid";
  place.append(grid);
  return grid;
}

function cellIn(grid, title) {
  const cell = document.createElement("div");
  cell.className = "cell";
  const text = document.createElement("p");
  text.className = "name";
  text.textContent = title;
  cell.append(text);
  grid.append(cell);
  return cell;
}

/** What can be drawn over joint values. */
function quantities(data) {
  const { rows, lead } = data;
  const moves = rows.motion.some((column) => column.some((value) => value !== null));
  return [
    ...(moves ? [["along the joint's own motion", (reading) => rows.motion[reading], "mm"]] : []),
    [`${lead.name} error`, () => rows.error_mm, lead.unit],
    ...componentsOf(data).map(([part, values, unit]) => [part, () => values, unit]),
  ];
}

function joints(place, data) {
  const choice = document.createElement("label");
  choice.className = "choice";
  const select = document.createElement("select");
  const offered = quantities(data);
  for (const [text] of offered) select.append(new Option(text));
  choice.append("Residual", select);
  place.append(choice);
  const believed = inOrder(data, (row) => !data.rows.suspected[row]);
  keys(place, [...bySet(data, believed, data.rows.error_mm, 5).series, line("smoothed, with one standard deviation to each side", "ink")]);
  const grid = gridIn(place);
  const readout = readoutLine(place);
  const draw = () => {
    grid.replaceChildren();
    const [text, valuesOf, unit] = offered[select.selectedIndex];
    const range = commonRange(data.readings.flatMap((_, k) => believed.map((row) => valuesOf(k)[row])));
    data.readings.forEach((reading, k) => {
      joint(cellIn(grid, reading.name), data, { believed, reading, k, text, values: valuesOf(k), unit, range, readout });
    });
  };
  select.addEventListener("change", draw);
  draw();
}

/** One range for all joints, so that they compare: a few rows far off are left out of sight. */
function commonRange(values) {
  const sizes = values.filter((value) => value !== null).map(Math.abs);
  sizes.sort((a, b) => a - b);
  const most = 1.3 * quantile(sizes, 0.995) || 1;
  return values.some((value) => value < 0) ? [-most, most] : [0, most];
}

/** The curve at sorted places, broken where nothing was measured for a good part of its range. */
function curveAt({ places, values }, xs) {
  const curve = { places, values };
  const [first, last] = [curve.places[0], curve.places[curve.places.length - 1]];
  const gap = (last - first) * Math.max(1 / 20, 8 / xs.length);
  const apart = (k) => k > 0 && xs[k] - xs[k - 1] > gap;
  return xs.map((x, k) => (x < first || x > last || apart(k) ? null : interpolate(curve, x)));
}

function joint(cell, data, { believed, reading, k, text, values, unit, range, readout }) {
  const column = data.rows.values[k];
  const order = believed.filter((row) => values[row] !== null).sort((a, b) => column[a] - column[b]);
  if (!order.length) {
    const text = document.createElement("p");
    text.className = "note";
    text.textContent = "What was measured does not move with this joint, or lies on its axis.";
    cell.append(text);
    return;
  }
  const { series, columns } = bySet(data, order, values, sized(data) - 1);
  const even = order.filter((row) => data.rows.even[row]);
  let band;
  const curve = smooth(even.map((row) => column[row]), even.map((row) => values[row]));
  if (curve) {
    const xs = order.map((row) => column[row]);
    const beside = (factor) => curveAt({ places: curve.places, values: curve.values.map((value, at) => value + factor * curve.spreads[at]) }, xs);
    band = { series: [series.length + 2, series.length + 3], key: "ink" };
    series.push(line("smoothed", "ink"), edge(), edge());
    columns.push(curveAt(curve, xs), beside(1), beside(-1));
  }
  const swing = curve ? Math.max(...curve.values) - Math.min(...curve.values) : NaN;
  plot(cell, {
    x: `${reading.name}, ${reading.unit}`,
    y: `residual, ${unit}`,
    height: 190,
    range: () => range,
    series,
    band,
    values: [order.map((row) => column[row]), ...columns],
    spoken: `Residual ${text} over ${reading.name}; the smoothed curve swings by ${withUnit(swing, unit)}, with a standard deviation of ${withUnit(curve ? quantile([...curve.spreads].sort((a, b) => a - b), 0.5) : NaN, unit)}.`,
    readout,
    tell: (index) => name(data, order[index]),
  });
}

/** Errors of fitted and of held-out rows that stand for all. */
function errorsOfSets({ rows }) {
  const of = (held) => rows.error_mm.filter((error, row) => error !== null && rows.even[row] && Boolean(rows.held_out[row]) === held);
  return [of(false), of(true)];
}

function histogram(place, data) {
  const { lead } = data;
  const sets = errorsOfSets(data);
  const sorted = sets.flat().sort((a, b) => a - b);
  // A few rows far off would leave all others in one bar.
  const most = Math.min(sorted[sorted.length - 1], 1.6 * quantile(sorted, 0.97)) || 1;
  const count = Math.max(8, Math.min(40, Math.round(Math.sqrt(sorted.length))));
  const width = most / count;
  const beyond = sorted.filter((value) => value > most).length;
  const shares = sets.map((values) => {
    const bins = new Array(count + 1).fill(0);
    for (const value of values) if (value <= most) bins[Math.min(Math.floor(value / width), count - 1)] += 100 / values.length;
    bins[count] = null;
    return values.length ? bins : null;
  });
  const series = [];
  const columns = [];
  shares.forEach((bins, k) => {
    if (!bins) return;
    series.push(k === 0 ? bars(...SETS[0]) : steps(...SETS[1]));
    columns.push(k === 0 ? bins : bins.map((value, i) => value ?? bins[i - 1]));
  });
  keys(place, series);
  const chart = document.createElement("div");
  place.append(chart);
  plot(chart, {
    x: `${lead.name} error, ${lead.unit}${beyond ? ` (${beyond} rows beyond are not drawn)` : ""}`,
    y: "share of the rows, %",
    height: 240,
    wide: true,
    series,
    values: [Array.from({ length: count + 1 }, (_, k) => k * width), ...columns],
    range: (_, __, highest) => [0, highest * 1.08],
    spoken: `Histogram of errors of ${lead.name} in steps of ${withUnit(width, lead.unit)}; the tables of errors have mean, RMS, 95 % and largest.`,
  });
}

const NORMAL_POINTS = 1500;

function normal(place, data) {
  const { rows, lead } = data;
  const own = componentsOf(data).filter(([, , unit]) => unit === lead.unit);
  const values = own.flatMap(([, column]) => column.filter((value, row) => value !== null && rows.even[row]));
  values.sort((a, b) => a - b);
  const count = Math.min(values.length, NORMAL_POINTS);
  // Both ends whole, and the middle thinned if there are many.
  const ranks = Array.from({ length: count }, (_, k) => Math.round((k * (values.length - 1)) / Math.max(count - 1, 1)));
  const xs = ranks.map((rank) => normalQuantile((rank + 0.5) / values.length));
  const [low, high] = [quantile(values, 0.25), quantile(values, 0.75)];
  const slope = (high - low) / (2 * normalQuantile(0.75));
  const series = [dots("components of all rows", "s0", { size: 4 }), line("normal, through the quartiles", "soft", { width: 1.5 })];
  keys(place, series);
  const chart = document.createElement("div");
  place.append(chart);
  plot(chart, {
    x: "quantile of the normal distribution, standard deviations",
    y: `component, ${lead.unit}`,
    height: 240,
    series,
    values: [xs, ranks.map((rank) => values[rank]), xs.map((x) => (low + high) / 2 + slope * x)],
    spoken: `Normal plot of ${values.length} components of ${lead.name}; a normal distribution through their quartiles has a standard deviation of ${withUnit(slope, lead.unit)}.`,
  });
}

function leverage(place, data) {
  const { rows } = data;
  const order = inOrder(data, (row) => !rows.held_out[row] && rows.leverage[row] !== null && rows.studentized[row] !== null);
  if (!order.length) {
    place.textContent = "The rows were not judged.";
    return;
  }
  order.sort((a, b) => rows.leverage[a] - rows.leverage[b]);
  const { series, columns } = bySet(data, order, rows.studentized, sized(data));
  keys(place, series);
  const largest = order[order.length - 1];
  const chart = document.createElement("div");
  place.append(chart);
  plot(chart, {
    x: "leverage",
    y: "studentised residual",
    series,
    values: [order.map((row) => rows.leverage[row]), ...columns],
    range: (_, __, most) => [0, most * 1.05],
    spoken: `Studentised residual over leverage of ${order.length} fitted rows; the largest leverage, ${shown(rows.leverage[largest])}, is that of ${name(data, largest)}.`,
    readout: readoutLine(place),
    tell: (index) => `${name(data, order[index])}, leverage ${shown(rows.leverage[order[index]])}`,
  });
}

// The element under the cursor in the charts, which the page already contains: the row of a dot by counting, its position by adding up the steps of
// its path.
import { shown, withUnit } from "./data.js";

/** Largest distance (px) of a selected dot from the cursor. */
const NEAR = 30;
const SVG = "http://www.w3.org/2000/svg";

/** Makes a chart's dots report their rows; `choose(row)` is called with the row of a dot that is clicked. */
export function followChart(figure, dataOf, choose) {
  const select = figure.querySelector("select");
  if (select) {
    select.parentElement.hidden = false;
    select.addEventListener("change", () => figure.querySelectorAll(".graph").forEach((graph) => showSide(graph, dataOf(), select)));
  }
  const readout = figure.querySelector(".readout");
  if (!readout) return;
  for (const graph of figure.querySelectorAll(".graph")) {
    const mark = graph.appendChild(document.createElementNS(SVG, "circle"));
    mark.classList.add("meant");
    const follow = (event) => {
      const found = event.type === "pointerleave" ? undefined : nearest(graph, dataOf(), event);
      mark.setAttribute("r", found ? 7 : 0);
      readout.textContent = found ? tell(figure, graph, dataOf(), found) : "";
      if (found) for (const [name, at, whole] of [["cx", found.x, found.width], ["cy", found.y, found.height]]) mark.setAttribute(name, `${(100 * at) / whole}%`);
      return found;
    };
    for (const type of ["pointermove", "pointerleave"]) graph.addEventListener(type, follow);
    graph.addEventListener("click", (event) => {
      const found = follow(event);
      if (found) choose(found.row);
    });
  }
}

/** The rows of a series. */
function rowsOf({ sets }, path) {
  const isOf = { s0: (it) => !(it & 1), s1: (it) => it & 1, alarm: (it) => it & 2 }[path.classList[1]];
  const few = path.closest("[data-few]") ? 4 : 0;
  return sets.flatMap((it, row) => (isOf(it) && (it & few) === few ? [row] : []));
}

/** The dots of a series in the view of the chart. */
function dotsOf(path, rows) {
  if (path.dots) return path.dots;
  let [x, y] = [0, 0];
  const steps = [...path.getAttribute("d").matchAll(/m(-?\d+) ?(-?\d+)(?:h(\d))?/g)];
  path.dots = rowsOf(rows, path).map((row, k) => {
    const [, across, down, length] = steps[k] ?? [0, 0, 0];
    const dot = { row, x: x + Number(across), y: y + Number(down), drawn: length !== undefined };
    [x, y] = [dot.x + Number(length ?? 0), dot.y];
    return dot;
  });
  return path.dots;
}

/** The dot nearest to the cursor, if one is near. */
function nearest(graph, { rows }, { clientX, clientY }) {
  const { width, height } = graph.querySelector("svg").viewBox.baseVal;
  const [box, style] = [graph.getBoundingClientRect(), getComputedStyle(graph)];
  // Text is in the padding.
  const [top, right, bottom, left] = ["Top", "Right", "Bottom", "Left"].map((side) => parseFloat(style[`padding${side}`]));
  const [across, down] = [(box.width - left - right) / width, (box.height - top - bottom) / height];
  let [least, found] = [NEAR, undefined];
  for (const path of graph.querySelectorAll(".dots")) {
    for (const dot of dotsOf(path, rows)) {
      const far = Math.hypot(box.left + left + dot.x * across - clientX, box.top + top + dot.y * down - clientY);
      if (dot.drawn && far < least) [least, found] = [far, { ...dot, width, height }];
    }
  }
  return found;
}

/** Description of a row under the cursor. */
function tell({ dataset }, graph, { rows, lead }, { row, x, width }) {
  const set = rows.sets[row] & 1 ? "held out" : "fitted";
  const { low, high } = graph.querySelector(".x").dataset;
  const more = dataset.chart === "leverage" ? `, leverage ${shown(Number(low) + (high - low) * (x / width))}` : "";
  return `${rows.place[row]}, ${set}${rows.sets[row] & 2 ? ", suspected" : ""}: ${withUnit(rows.error_mm[row], lead.unit)}${more}`;
}

/** Shows the selected residual: its axis and its curve are on the page, and its dots follow from the data. */
function showSide(graph, { rows }, { selectedIndex, selectedOptions: [{ dataset }] }) {
  const cell = graph.closest(".cell");
  for (const it of cell.querySelectorAll("[data-side]")) it.toggleAttribute("hidden", Number(it.dataset.side) !== selectedIndex);
  const [across, up] = [graph.querySelector(".x"), graph.querySelector(".y:not([hidden])")].map((it) => it.dataset);
  graph.setAttribute("aria-label", up.spoken);
  const { width, height } = graph.querySelector("svg").viewBox.baseVal;
  const along = ({ low, high }, value) => (value - low) / (high - low);
  const values = dataset.column === "error" ? rows.error_mm : rows.columns[dataset.column];
  for (const path of graph.querySelectorAll(".dots")) {
    path.first ??= dotsOf(path, rows);
    path.dots = path.first.map((first) => {
      if (!values) return first;
      const [value, y] = [values[first.row], 1 - along(up, values[first.row])];
      const drawn = value !== null && y >= 0 && y <= 1 && !(rows.sets[first.row] & 2);
      return { row: first.row, x: Math.round(width * along(across, rows.values[cell.dataset.reading][first.row])), y: Math.round(height * y), drawn };
    });
    const length = Number(path.getAttribute("stroke-linecap") === "square");
    path.setAttribute("d", path.dots.map(({ x, y, drawn }) => (drawn ? `M${x} ${y}h${length}` : "")).join(""));
  }
}

// The list of files: what each is taken for, and what the program found in it.
import { counted, element, size } from "./dom.js";
import { ROLES } from "./roles.js";

/** SI units in a unit that a file states. */
const FACTORS = { rad: 1, mrad: 1e-3, deg: Math.PI / 180, arcmin: Math.PI / 10800, arcsec: Math.PI / 648000, m: 1, cm: 1e-2, mm: 1e-3, um: 1e-6, nm: 1e-9, in: 0.0254 };

/** A number with as many digits as are of use in a list. */
const short = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

/** A range in a unit. */
function range(min, max, unit) {
  const factor = FACTORS[unit] ?? 1;
  return `${short(min / factor)} to ${short(max / factor)}${unit ? ` ${unit}` : ""}`;
}

function table(heads, rows) {
  const head = element("tr", {}, heads.map((text) => element("th", { scope: "col", textContent: text })));
  const body = rows.map((cells) => element("tr", {}, cells.map((text) => element("td", { textContent: text }))));
  return element("div", { class: "scroll", tabIndex: 0, role: "group", "aria-label": "table" }, element("table", {}, element("thead", {}, head), element("tbody", {}, body)));
}

function ofModel(model) {
  const kinds = [...new Set(model.joints.map((joint) => joint.kind))].map((kind) => counted(model.joints.filter((joint) => joint.kind === kind).length, `${kind} joint`));
  const line = `${model.name}: ${kinds.join(", ")}, from ${model.base} to ${model.tip} (${model.form})`;
  const rows = model.joints.map(({ name, kind, direction, point_m: point, limits }) => [
    name,
    kind,
    direction.map(short).join(", "),
    point ? point.map((it) => short(1000 * it)).join(", ") : "",
    limits ? range(...limits, kind === "prismatic" ? "mm" : "deg") : "none",
  ]);
  return { line, details: ["Joints", table(["joint", "kind", "axis", "through, mm", "limits"], rows)] };
}

function ofTable(file) {
  const { rows, points, poses, columns, lost, ignored } = file;
  const others = rows - points - poses;
  const kinds = [points && counted(points, "point"), poses && counted(poses, "pose"), others > 0 && `${others} of other kinds`].filter(Boolean);
  const line = [`${counted(rows, "row")}: ${kinds.join(", ")}`, lost?.count ? `${counted(lost.count, "lost beam")} skipped` : "", ignored?.length ? `ignored: ${ignored.map((it) => it.column ?? it.name ?? it).join(", ")}` : ""];
  const body = columns.map(({ name, column, unit, unit_from: from, min, max }) => [
    name,
    column ?? "",
    unit ? `${unit}${from ? `, ${from}` : ""}` : "",
    typeof min === "number" ? range(min, max, unit) : "",
  ]);
  return { line: line.filter(Boolean).join("; "), details: ["Columns", table(["column", "read from", "unit", "values"], body)] };
}

/** What `poecal check --json` says of each file, by the file's name: a line, and details. */
export function findings(check) {
  const found = new Map();
  if (check?.model) found.set(check.model.path, ofModel(check.model));
  for (const file of check?.files ?? []) found.set(file.path, ofTable(file));
  return found;
}

/** What each list shows. */
const shownNow = new WeakMap();

/** Shows the files in `place`; `change` is called with a file and its new role, or with none to remove it. */
export function showFiles(place, files, found, change) {
  // What is shown already stays, so that nobody's click meets a list that is being made.
  const content = JSON.stringify(files.map((file) => [file.name, file.role, file.bytes.length, found.get(file.name)?.line, found.get(file.name)?.details[1].textContent]));
  if (shownNow.get(place)?.content === content && shownNow.get(place).files.every((file, k) => file === files[k])) return;
  shownNow.set(place, { content, files: [...files] });
  const focused = document.activeElement?.closest("li") && document.activeElement.getAttribute("aria-label");
  const opened = new Set([...place.querySelectorAll("details[open]")].map((it) => it.dataset.of));
  place.replaceChildren(
    ...files.map((file) => {
      const { line, details } = found.get(file.name) ?? {};
      const role = element("select", { "aria-label": `Role of ${file.name}`, onchange: () => change(file, role.value) }, Object.entries(ROLES).map(([value, text]) => element("option", { value, textContent: text, selected: value === file.role })));
      const remove = element("button", { type: "button", class: "remove", "aria-label": `Remove ${file.name}`, title: `Remove ${file.name}`, textContent: "✕", onclick: () => change(file, undefined) });
      const more = details && element("details", {}, element("summary", { textContent: details[0] }), details[1]);
      if (more) {
        more.dataset.of = file.name;
        more.open = opened.has(file.name);
      }
      return element(
        "li",
        { class: file.role },
        element("div", { class: "file" }, element("span", { class: "name" }, element("b", { textContent: file.name }), " ", element("small", { textContent: size(file.bytes.length) })), role, remove),
        element("p", { class: "found", textContent: line ?? "" }),
        more,
      );
    }),
  );
  if (focused) [...place.querySelectorAll("select, button")].find((it) => it.getAttribute("aria-label") === focused)?.focus();
}

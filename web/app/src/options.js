// The options that matter as controls, and a line for all others. A control that is left empty says nothing, so that the settings or
// the program's own default decide.
import { wordsOf } from "./command.js";
import { element } from "./dom.js";

const CONTROLS = [
  { flag: "--device-frame", label: "Device frame", note: "where the measuring device stands", values: { "": "unknown: found by the fit", base: "the robot's base frame" } },
  { flag: "--device-frames", label: "Device moved", note: "between the measurement files", values: { "": "no: one frame for all", "per-file": "yes: a frame for each file" } },
  { flag: "--held-out", label: "Held out", note: "share of configurations kept for validation", hint: "0.3" },
  { flag: "--tolerance", label: "Tolerance", note: "deviation of an axis from nominal", hint: "0.5deg,5mm", offers: ["auto", "none", "0.2deg,2mm", "3deg,10mm"] },
  { flag: "--corrections", label: "Corrections", note: "what joints do beyond geometry", values: { "": "auto: those that predict better", all: "all: look among more", off: "off: geometry alone" } },
  { flag: "--robust", label: "Outliers", note: "and how they are treated", values: { "": "auto: detected and reported", off: "off: every row counts in full", huber: "huber", cauchy: "cauchy", tukey: "tukey" } },
  { flag: "--accept", label: "Limits to keep", note: "errors of rows that were not fitted", hint: "none, or 0.2mm,max:0.5mm" },
  { flag: "--sigma-position", label: "Noise of a position", note: "standard deviation of each component", hint: "from the rows, or 0.05mm" },
  { flag: "--sigma-rotation", label: "Noise of an orientation", note: "likewise", hint: "from the rows, or 0.01deg" },
  { flag: "--base-link", label: "First link", note: "of the chain, where a URDF has several", hint: "as the model has it" },
  { flag: "--tip-link", label: "Last link", note: "likewise", hint: "as the model has it" },
];

/** A flag with its value, in one word where a value would be taken for a flag. */
function wordsFor(flag, value) {
  if (!value) return [];
  return value.startsWith("-") ? [`${flag}=${value}`] : [flag, value];
}

/** Puts the controls into `place`; `changed` is called after a change, and the result gives the words of the command line. */
export function options(place, changed) {
  const fields = CONTROLS.map(({ flag, label, note, values, hint, offers }) => {
    const id = `option${flag}`;
    const field = values
      ? element("select", { id }, Object.entries(values).map(([value, text]) => element("option", { value, textContent: text })))
      : element("input", { id, type: "text", placeholder: hint, autocomplete: "off", spellcheck: false });
    field.setAttribute("aria-describedby", `${id}-note`);
    if (offers) {
      field.setAttribute("list", `${id}-offers`);
      place.append(element("datalist", { id: `${id}-offers` }, offers.map((value) => element("option", { value }))));
    }
    place.append(element("div", { class: "option" }, element("label", { htmlFor: id, textContent: label }), field, element("span", { class: "note", id: `${id}-note`, textContent: note })));
    return [flag, field];
  });
  const further = element("input", { id: "further", type: "text", placeholder: "--free joint2.offset --seed 2", autocomplete: "off", spellcheck: false, "aria-describedby": "further-note" });
  place.append(
    element(
      "div",
      { class: "option wide" },
      element("label", { htmlFor: "further", textContent: "Further options" }),
      further,
      element("span", { class: "note", id: "further-note", textContent: "as on the command line of poecal calibrate" }),
    ),
  );
  for (const field of [...fields.map(([, field]) => field), further]) field.addEventListener("change", changed);
  return () => [...fields.flatMap(([flag, field]) => wordsFor(flag, field.value.trim())), ...wordsOf(further.value)];
}

// Which column of a foreign file is which: what the program guesses is preset, each choice is a pull-down, and the program writes the mapping.
import { element } from "./dom.js";
import { download } from "./results.js";

/** The name of the mapping that the page makes. */
export const MAPPING = "columns.toml";
const GROUPS = { joints: "Joints", position: "Position", orientation: "Orientation", rows: "Rows" };

/** The program's words for the guess of a file's columns, with what was chosen in place of it. */
export function guessWords(model, table, chosen, chain) {
  return ["init", model, "--columns-from", table, ...chosen.map(([key, value]) => `--column=${key}=${value}`), ...chain, "--json"];
}

/** Choices with a further one; a form of orientations has columns of its own. */
export function choose(chosen, key, value) {
  const kept = chosen.filter(([other]) => other !== key && !(key === "orientation" && other.startsWith("orientation.")));
  return [...kept, [key, value]];
}

/** The first cells of a column, short. */
function sample(cells) {
  const text = cells.slice(0, 2).join("; ");
  return text.length > 32 ? `${text.slice(0, 31)}…` : text;
}

function pullDown(field, columns, chosen) {
  const ofColumns = () => [["", field.required ? "choose a column" : "none"], ...columns.map(({ name, cells }) => [name, cells.length ? `${name}  (${sample(cells)})` : name])];
  const offered = field.choices ? field.choices.map(({ value, text }) => [value, text]) : ofColumns();
  const select = element("select", { id: `column-${field.key}`, onchange: () => chosen(field.key, select.value) }, offered.map(([value, textContent]) => element("option", { value, textContent, selected: value === field.chosen })));
  if (field.required && !field.chosen) select.setAttribute("aria-invalid", "true");
  // Words are longer than names.
  const long = field.choices?.some(({ text }) => text.length > 30);
  return element("div", { class: long ? "option long" : "option" }, element("label", { htmlFor: select.id, textContent: field.label }), select);
}

/** Shows a guess in `place`: `chosen` is called with a field and its column, `use` to read the file like this. */
export function showColumns(place, { file, guess, used, open }, chosen, use) {
  const focused = document.activeElement?.id;
  const groups = Object.entries(GROUPS).map(([group, title]) => {
    const fields = guess.fields.filter((field) => field.group === group);
    return element("fieldset", {}, element("legend", { textContent: title }), element("div", { class: "options" }, fields.map((field) => pullDown(field, guess.columns, chosen))));
  });
  const missing = guess.missing.length ? `Still without a column: ${guess.missing.join(", ")}.` : "";
  const ignored = guess.ignored.length ? `Not read: ${guess.ignored.join(", ")}.` : "";
  const mapping = new TextEncoder().encode(guess.mapping);
  place.querySelector("summary").textContent = `Columns of ${file}`;
  place.querySelector("div").replaceChildren(
    element("p", { textContent: "What poecal guessed is chosen already. Correct it where it is wrong; the first cells of each column are beside its name." }),
    ...groups,
    element("p", { class: "note", textContent: [missing, ignored].filter(Boolean).join(" ") }),
    element(
      "div",
      { class: "row" },
      element("button", { type: "button", class: "main", id: "use-columns", disabled: used, textContent: used ? "The file is read like this" : "Read the file like this", onclick: use }),
      element("ul", { class: "downloads", "aria-label": "Mapping to save" }, download(MAPPING, mapping)),
      element("span", { class: "note", textContent: `The mapping for the program: --columns ${MAPPING}` }),
    ),
  );
  if (open) place.open = true;
  place.hidden = false;
  if (focused?.startsWith("column-")) document.getElementById(focused)?.focus();
}

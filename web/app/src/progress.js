// What goes on: the status line, the bar while something runs, and the program's messages with the lines that they mean.
import { byId, element } from "./dom.js";
import { placeOf } from "./sentences.js";

let clock;

/** Says how things are, also to screen readers. */
export function say(text) {
  byId("status").textContent = text;
}

/** Shows that something runs, and how long already; without `doing`, that nothing does. */
export function busy(doing) {
  clearInterval(clock);
  for (const id of ["bar", "cancel"]) byId(id).classList.toggle("idle", !doing);
  byId("cancel").disabled = !doing;
  byId("elapsed").textContent = "";
  document.documentElement.toggleAttribute("data-busy", Boolean(doing));
  if (!doing) return;
  say(`${doing[0].toUpperCase()}${doing.slice(1)} …`);
  const started = performance.now();
  clock = setInterval(() => (byId("elapsed").textContent = `${((performance.now() - started) / 1000).toFixed(0)} s`), 1000);
}

const SIGNS = { error: "✕", warning: "△", note: "·" };

/** Shows messages, each with the line of the file that it names. */
export function showMessages(told, files, place = byId("messages")) {
  place.replaceChildren(
    ...told.map(({ kind, text }) => {
      const found = placeOf(text, files);
      return element(
        "div",
        { class: `message ${kind}` },
        element("p", {}, element("span", { class: "sign", "aria-hidden": "true", textContent: SIGNS[kind] }), element("b", { textContent: `${kind}: ` }), text),
        found && element("pre", { tabIndex: 0, "aria-label": `line ${found.line} of ${found.file.name}` }, ...quotation(found)),
      );
    }),
  );
}

/** The line with its number, and a marker below the place. */
function quotation({ line, shown, before }) {
  const number = `${line} │ `;
  if (before === undefined) return [number + shown];
  const space = [...shown].slice(0, before).map((it) => (it === "\t" ? "\t" : " ")).join("");
  return [`${number}${shown}\n${" ".repeat(number.length)}${space}`, element("b", { class: "marker", textContent: "^" })];
}

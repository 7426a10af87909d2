// Colours: those of the system, or light or dark by choice. Drawings request them by name and are notified when they change.

const listeners = [];

/** A colour of the style sheet by its name. */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Calls `listener` whenever the colours have changed. */
export function onColours(listener) {
  listeners.push(listener);
}

function changed() {
  for (const listener of listeners) listener();
}

/** The choice: system, light or dark. */
export function themeOf() {
  return document.documentElement.dataset.theme ?? "system";
}

/** The buttons. */
export function themeSwitch(place) {
  const root = document.documentElement;
  const buttons = ["system", "light", "dark"].map((name) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.addEventListener("click", () => choose(name));
    place.append(button);
    return button;
  });
  function choose(name) {
    if (name === "system") delete root.dataset.theme;
    else root.dataset.theme = name;
    for (const button of buttons) button.setAttribute("aria-pressed", String(button.textContent === name));
    changed();
  }
  choose("system");
  place.hidden = false;
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  printOnPaper(root);
}

/** Paper is white, for any colours of the screen. */
function printOnPaper(root) {
  let before;
  addEventListener("beforeprint", () => {
    before = root.dataset.theme;
    root.dataset.theme = "light";
    changed();
  });
  addEventListener("afterprint", () => {
    if (before === undefined) delete root.dataset.theme;
    else root.dataset.theme = before;
    changed();
  });
}

// The time of drawing, and the section in view.

/** Calls `draw()` once the page has nothing else to do, or is printed. */
export function whenIdle(draw) {
  let isDrawn = false;
  const show = () => {
    if (!isDrawn) draw();
    isDrawn = true;
  };
  addEventListener("beforeprint", show);
  if (window.requestIdleCallback) requestIdleCallback(show, { timeout: 500 });
  else setTimeout(show, 200);
}

/** Marks in a list of contents the section in view: the last one that begins above the middle of the window. */
export function followSections(nav) {
  const links = [...nav.querySelectorAll("a")];
  const sections = links.map((link) => document.getElementById(link.hash.slice(1)));
  links.forEach((link, k) => link.addEventListener("click", () => sections[k]?.matches("details") && (sections[k].open = true)));
  let asked = false;
  const mark = () => {
    asked = false;
    const tops = sections.map((section) => section?.getBoundingClientRect().top ?? Infinity);
    const current = tops.findLastIndex((top) => top < innerHeight / 3);
    links.forEach((link, k) => (k === current ? link.setAttribute("aria-current", "true") : link.removeAttribute("aria-current")));
  };
  addEventListener(
    "scroll",
    () => {
      if (!asked) requestAnimationFrame(mark);
      asked = true;
    },
    { passive: true },
  );
  mark();
}

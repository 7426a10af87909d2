// What of the page is in sight.

/** Distance (px) below and above the window from which on something is drawn. */
const NEAR = 500;

const waiting = new Map();

/** Calls `draw(element)` once the element is near the window, or the page is printed. */
export function whenNear(element, draw) {
  waiting.set(element, draw);
  watcher.observe(element);
}

const watcher = new IntersectionObserver(
  (entries) => {
    for (const { target, isIntersecting } of entries) if (isIntersecting) show(target);
  },
  { rootMargin: `${NEAR}px 0px` },
);

function show(element) {
  const draw = waiting.get(element);
  waiting.delete(element);
  watcher.unobserve(element);
  draw?.(element);
}

// Before any other listener: what is drawn now must be drawn in the colours of paper.
addEventListener("beforeprint", () => {
  for (const element of [...waiting.keys()]) show(element);
});

/** Marks in a list of contents the section that is read: the last one that begins above the middle of the window. */
export function followSections(nav) {
  const links = [...nav.querySelectorAll("a")];
  const sections = links.map((link) => document.getElementById(link.hash.slice(1)));
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

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

/** What waits outside of folded parts, which are neither seen nor printed. */
function unfolded() {
  return [...waiting.keys()].filter((element) => !element.closest("details:not([open])"));
}

// Before any other listener: what is drawn now must be drawn in the colours of paper.
addEventListener("beforeprint", () => unfolded().forEach(show));

const whenIdle = window.requestIdleCallback ?? ((action) => setTimeout(action, 200));

/** Draws what is far below while there is nothing else to do, so that it is there when it is come to. */
export function drawAhead() {
  whenIdle(() => {
    const [next] = unfolded();
    if (!next) return;
    show(next);
    drawAhead();
  });
}

// What is in a folded part waits until it is opened.
addEventListener("toggle", drawAhead, true);

/** Marks in a list of contents the section that is read: the last one that begins above the middle of the window. */
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

// Names on the picture, beside their positions.
import { Vector3 } from "three";

const ARROWS = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
const MARGIN = 6;

export class Labels {
  constructor() {
    this.element = document.createElement("div");
    this.element.className = "names";
    this.element.setAttribute("aria-hidden", "true");
    this.all = [];
  }

  /**
   * Adds a name. One that `stays` is moved to a free position, and to the edge, with an arrow, if its own position is out of the picture; others are
   * left out there.
   */
  add(className, name, stays = false) {
    const text = document.createElement("span");
    text.className = className;
    text.textContent = text.dataset.name = name;
    this.element.append(text);
    const label = { text, place: new Vector3(), stays, isOff: false };
    this.all.push(label);
    return label;
  }

  /** Writes the names beside their positions: first those that stay, then those of joints and axes that cover none of them. */
  write(camera, width, height) {
    const taken = [];
    for (const label of [...this.all.filter((it) => it.stays), ...this.all.filter((it) => !it.stays)]) {
      const { text, place, stays, isOff } = label;
      if (isOff) {
        text.hidden = true;
        continue;
      }
      const at = place.clone().project(camera);
      const behind = place.clone().applyMatrix4(camera.matrixWorldInverse).z > 0;
      if (behind) at.multiplyScalar(-1e3);
      const outside = Math.max(Math.abs(at.x), Math.abs(at.y)) > 1;
      const arrow = ARROWS[(Math.round(Math.atan2(at.y * height, at.x * width) / (Math.PI / 4)) + 8) % 8];
      const words = outside && stays ? `${text.dataset.name} ${arrow}` : text.dataset.name;
      text.hidden = false;
      if (text.textContent !== words || !label.size?.[0]) {
        text.textContent = words;
        label.size = [text.offsetWidth, text.offsetHeight];
      }
      const [w, h] = label.size;
      const x = clamp(((at.x + 1) / 2) * width + MARGIN, MARGIN, width - w - MARGIN);
      let y = clamp(((1 - at.y) / 2) * height - h - 2, MARGIN, height - h - MARGIN);
      const covers = (it) => x < it.x + it.w && it.x < x + w && y < it.y + it.h && it.y < y + h;
      if (!stays && (outside || taken.some(covers))) {
        text.hidden = true;
        continue;
      }
      for (let other = taken.find(covers); other && y < height; other = taken.find(covers)) y = other.y + other.h + 1;
      taken.push({ x, y, w, h });
      // In parts of the picture, since paper has another size.
      text.style.left = `${(100 * x) / width}%`;
      text.style.top = `${(100 * y) / height}%`;
    }
  }
}

function clamp(value, least, most) {
  return Math.max(least, Math.min(value, most));
}

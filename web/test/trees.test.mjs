// The picture of robots with branches and of several instruments: everything is at the program's poses, and residuals are as measured.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { readingsOf } from "../src/data.js";
import { CALIBRATED, add, configure, rotate, scale, subtract } from "../src/kinematics.js";
import { launch, open, skip } from "./browser.mjs";
import { CASES, TREES, dataOf, folder, predicted } from "./cases.mjs";

/** The browser and the program round differently. */
const SAME_M = 1e-9;
/** The page has readings and residuals in steps. */
const ROUNDED_MM = 0.05;

let browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(() => browser?.close());

/** Positions as they were measured, millimetres, by line of the file. */
function measured(path) {
  const lines = readFileSync(path, "utf8").split("\n");
  const header = lines.findIndex((line) => !line.startsWith("#"));
  const x = lines[header].split(",").indexOf("x[mm]");
  return (place) => lines[Number(place.split(":")[1]) - 1].split(",").slice(x, x + 3).map(Number);
}

/** Moves a slider to a share of its range; returns all poses afterwards. */
function slide(page, share, only) {
  return page.evaluate(
    ([share, only]) => {
      const legend = [...document.querySelectorAll(".panel legend")].find((it) => it.textContent === "Joints");
      const sliders = [...legend.parentElement.querySelectorAll(".slider")];
      for (const [k, line] of sliders.entries()) {
        if (only && line.querySelector("label").textContent !== only) continue;
        const input = line.querySelector("input");
        const [least, most] = [Number(input.min), Number(input.max)];
        input.value = least + (most - least) * (only ? share : (share + 0.37 * k) % 1);
        input.dispatchEvent(new Event("input", { bubbles: true }));
      }
      const { dataset } = document.getElementById("tip");
      return { values: sliders.map((it) => Number(it.querySelector("input").value)), ends: Object.fromEntries(JSON.parse(dataset.ends)) };
    },
    [share, only],
  );
}

const EXPECTED = {
  "a torso with two arms": { instruments: ["eyes", "chest"], targets: ["left", "right"], moving: ["chest", "eyes", "left", "right"], session: "torso-session/measurements.csv" },
  "a camera in the hand": { instruments: ["camera"], targets: ["board"], moving: ["camera"], session: "hand-session/measurements.csv" },
  "two trackers": { instruments: ["A", "B"], targets: [], moving: ["tip"], session: "two.csv" },
};

for (const [name, make] of Object.entries(TREES)) {
  describe(`the picture of ${name}`, { skip }, () => {
    const { instruments, targets, moving, session } = EXPECTED[name];
    let out, data;
    before(() => {
      out = make();
      data = dataOf(out);
    });

    test("has every instrument and target by name, and a line of sight", async () => {
      const page = await open(browser, join(out, "report.html"));
      const names = (kind) => page.$$eval(`.names .${kind}`, (all) => all.map((it) => it.dataset.name));
      assert.deepEqual([await names("instrument"), await names("target")], [instruments, targets]);
      assert.doesNotMatch(await page.locator("#view").textContent(), /There is no picture/);
      const inside = await page.$$eval(".names span", (all) => {
        const { width, height } = document.querySelector(".scene").getBoundingClientRect();
        return all.every((it) => it.offsetLeft >= 0 && it.offsetTop >= 0 && it.offsetLeft + it.offsetWidth <= width && it.offsetTop + it.offsetHeight <= height);
      });
      assert.ok(inside, "a name is cut off");
      const picture = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(document.querySelector(".scene canvas").toDataURL())))));
      const before = await picture();
      await page.getByLabel("instruments and names").uncheck();
      assert.notEqual(await picture(), before);
      assert.equal(await page.locator(".names").isVisible(), false);
      assert.match(await page.locator(".panel .state").first().textContent(), new RegExp(`instrument ${data.instruments[data.rows.instrument[0]].name}`));
      assert.deepEqual(page.complaints, []);
      await page.close();
    });

    test("has every end of the robot where the program says", async () => {
      const page = await open(browser, join(out, "report.html"));
      for (const share of [0.11, 0.42, 0.83]) {
        const { values, ends } = await slide(page, share);
        assert.deepEqual(Object.keys(ends).sort(), moving);
        for (const target of targets.filter((it) => it in ends)) {
          const expected = predicted(out, data.readings, values, "--target", target);
          const apart = Math.hypot(...subtract(ends[target], expected));
          assert.ok(apart < SAME_M, `${target} is ${apart} m from where the program says`);
        }
      }
      await page.close();
    });

    test("has residuals where they were measured", () => {
      const { rows } = data;
      const seen = measured(join(folder, session));
      const device = new Set(rows.instrument);
      assert.deepEqual([...device].sort(), instruments.map((_, k) => k));
      for (let row = 0; row < rows.count; row++) {
        const { r, t } = configure(data, readingsOf(data, row), CALIBRATED).at(data.instruments[rows.instrument[row]]);
        const place = subtract(add(rows.predicted[row], scale(rows.residual[row], 1e-3)), t);
        const inDevice = rotate([0, 1, 2].map((k) => r.map((line) => line[k])), scale(place, 1e3));
        const apart = Math.hypot(...subtract(inDevice, seen(rows.place[row])));
        assert.ok(apart < ROUNDED_MM, `${rows.place[row]}: ${apart} mm from where it was measured`);
      }
      const largest = Math.max(...rows.error_mm);
      assert.ok(largest > 5 * ROUNDED_MM, `${largest} mm`);
    });
  });
}

// The cases above have written it.
describe("a slider", { skip }, () => {
  test("moves what stands on its joint, and nothing else", async () => {
    const page = await open(browser, join(folder, "torso", "report.html"));
    await slide(page, 0.3);
    for (const [joint, moved] of [
      ["torso1", ["chest", "eyes", "left", "right"]],
      ["head_yaw", ["eyes"]],
      ["left2", ["left"]],
      ["right1", ["right"]],
      ["right4", ["right"]],
    ]) {
      const earlier = (await slide(page, 0.3, joint)).ends;
      const later = (await slide(page, 0.6, joint)).ends;
      const apart = Object.keys(later).filter((end) => Math.hypot(...subtract(later[end], earlier[end])) > 1e-4);
      assert.deepEqual(apart.sort(), moved, joint);
      const same = Object.keys(later).filter((end) => !moved.includes(end));
      for (const end of same) assert.deepEqual(later[end], earlier[end], `${joint} moves ${end}`);
    }
    await page.close();
  });
});

describe("the picture of a robot without branches", { skip }, () => {
  test("names its joints and its measuring device", async () => {
    const [, make] = CASES[0];
    const page = await open(browser, join(make(), "report.html"));
    const names = (kind) => page.$$eval(`.names .${kind}`, (all) => all.map((it) => it.dataset.name));
    assert.deepEqual([await names("instrument"), await names("target")], [["measuring device"], []]);
    assert.deepEqual(await names("joint"), [1, 2, 3, 4, 5, 6].map((k) => `joint${k}`));
    assert.match(await page.locator("#tip").textContent(), /^Tip at /);
    await page.close();
  });
});

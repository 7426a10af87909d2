// The picture of anchors, sockets, planes, spheres and directions: each is drawn by its kind, and residuals are along it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { dot, rotate, subtract } from "../src/kinematics.js";
import { patchOf } from "../src/places.js";
import { launch, open, skip } from "./browser.mjs";
import { dataOf, ofKind } from "./cases.mjs";

/** The page has six digits of each reading: up to 0.0005° of each of six joints, at a metre or less. */
const ROUNDED_M = 5e-5;

let browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(() => browser?.close());

const length = (v) => Math.hypot(...v);

/** Effect of a row's residual, metres, on a predicted position: for each kind, with its names and its word in the panel. */
const KINDS = {
  distance: { names: ["wall", "floor", "door"], label: "anchors and names", row: /anchor wall: off by .* mm of distance/ },
  socket: { names: ["left", "right"], label: "sockets and names", row: /socket left: off by .* mm of contact/, at: (it, place) => length(subtract(place, it.pose.t)) },
  sphere: { names: ["ball"], label: "sphere and names", row: /sphere ball: off by .* mm of distance/, at: (it, place) => length(subtract(place, it.pose.t)) - it.radius_m },
  plane: { names: ["table", "side", "front"], label: "planes and names", row: /plane table: off by .* mm of height/, at: (it, place) => dot(subtract(place, it.pose.t), rotate(it.pose.r, [0, 0, 1])) },
  flush: { names: ["table", "side", "front"], label: "planes and names", row: /plane table: off by .* mm of height and .*° of tilt/, at: (it, place) => dot(subtract(place, it.pose.t), rotate(it.pose.r, [0, 0, 1])) },
  direction: { names: ["gravity"], label: "direction and names", row: /direction gravity: off by .*° of tilt/ },
};

for (const [kind, { names, label, row, at }] of Object.entries(KINDS)) {
  describe(`the picture of a session of kind ${kind}`, { skip }, () => {
    let out, data;
    before(() => {
      out = ofKind(kind);
      data = dataOf(out);
    });

    test("names what is drawn, and says by how much a row is off", async () => {
      const page = await open(browser, join(out, "report.html"));
      assert.deepEqual(await page.$$eval(".names .instrument", (all) => all.map((it) => it.dataset.name)), names);
      assert.match(await page.locator(".panel .state").first().textContent(), row);
      const picture = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(document.querySelector(".scene canvas").toDataURL())))));
      const earlier = await picture();
      await page.getByLabel(label).uncheck();
      assert.notEqual(await picture(), earlier);
      assert.deepEqual(page.complaints, []);
      await page.close();
    });

    test("has residuals that end where the place says", () => {
      const { rows, instruments } = data;
      const shifts = rows.residual.filter((shift) => shift !== null);
      assert.equal(shifts.length, kind === "direction" ? 0 : rows.count);
      if (!at) return;
      rows.predicted.forEach((place, k) => {
        const end = place.map((value, axis) => value + 1e-3 * rows.residual[k][axis]);
        const off = Math.abs(at(instruments[rows.instrument[k]], end));
        assert.ok(off < ROUNDED_M, `${rows.place[k]} ends ${off} m beside ${instruments[rows.instrument[k]].name}`);
      });
      const largest = Math.max(...shifts.map(length));
      assert.ok(1e-3 * largest > 5 * ROUNDED_M, `${largest} mm: residuals are no larger than rounding`);
    });
  });
}

describe("the picture of pairs of configurations", { skip }, () => {
  test("has dots, and no arrows, names or device", async () => {
    const out = ofKind("relative");
    assert.ok(dataOf(out).rows.residual.every((shift) => shift === null));
    const page = await open(browser, join(out, "report.html"));
    assert.deepEqual(await page.$$eval(".names .instrument:not([hidden])", (all) => all.map((it) => it.textContent)), []);
    assert.match(await page.locator(".scale").textContent(), /^Dots: /);
    assert.equal(await page.getByText("residual arrows").count(), 0);
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
});

test("a sheet lies under all places that touched it, along their longest direction", () => {
  const [c, s] = [Math.cos(0.3), Math.sin(0.3)];
  const places = [[-2, 0], [2, 0], [0, 0.5], [0, -0.5], [1, 0.2], [-1, -0.2]].map(([u, v]) => [3 + c * u - s * v, 1 + s * u + c * v, 0]);
  const { x, y, turn, width, height } = patchOf(places);
  for (const [x0, y0] of places) {
    const [u, v] = [Math.cos(turn) * (x0 - x) + Math.sin(turn) * (y0 - y), Math.cos(turn) * (y0 - y) - Math.sin(turn) * (x0 - x)];
    assert.ok(Math.abs(u) <= width + 1e-12 && Math.abs(v) <= height + 1e-12);
  }
  assert.ok(width > 1.8 && height < 0.8, `${width}, ${height}`);
});

// The picture of robots with shapes of their own: boxes, cylinders, balls and meshes of a URDF, at the poses of the program; and without any.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { Matrix4, MeshBasicMaterial } from "three";
import { Arrows } from "../src/arrows.js";
import { compose, invert, poseOf, subtract } from "../src/kinematics.js";
import { launch, open, skip } from "./browser.mjs";
import { ROOT, calibrate, dataOf, folder, poecal } from "./cases.mjs";

const ELBOW = join(ROOT, "examples/elbow");
/** The browser and the program round differently. */
const SAME_M = 1e-9;
/** Largest part of a page for meshes, and for the text around their numbers. */
const MOST_CHARACTERS = 1_000_000;
const AROUND = 5_000;

let browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(() => browser?.close());

test("the picture begins with the hundred largest residuals", () => {
  const count = 300;
  const each = (value) => Array.from({ length: count }, (_, row) => value(row));
  // Every third row is one of the largest errors; rows of dots have no shift.
  const errors = each((row) => (row % 3 === 1 ? 2 : 1) + row / count / 10);
  const rows = { count, error_mm: errors, predicted: each((row) => [row, 0, 0]), residual: each((row) => (row % 2 ? null : [0, 0, errors[row]])) };
  const arrows = new Arrows({ rows }, 1, 0.06, new MeshBasicMaterial());
  const drawn = () => {
    const has = (mesh, row) => {
      const matrix = new Matrix4();
      mesh.getMatrixAt(row, matrix);
      return matrix.determinant() !== 0;
    };
    return each((row) => has(arrows.dots, row) || (has(arrows.shafts, row) && has(arrows.heads, row)));
  };
  arrows.place(10);
  assert.deepEqual(drawn(), each((row) => row % 3 === 1));
  arrows.all = true;
  arrows.place(10);
  assert.deepEqual(drawn(), each(() => true));
});

/** A binary STL of a surface about z: radius and height of its rings. */
function stl(rings, around) {
  const place = ([radius, height], k) => [radius * Math.cos((2 * Math.PI * k) / around), radius * Math.sin((2 * Math.PI * k) / around), height];
  const triangles = rings.slice(1).flatMap((ring, i) =>
    Array.from({ length: around }, (_, k) => [place(rings[i], k), place(ring, k), place(ring, k + 1), place(rings[i], k + 1)]).flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]),
  );
  const bytes = Buffer.alloc(84 + 50 * triangles.length);
  bytes.writeUInt32LE(triangles.length, 80);
  triangles.forEach((corners, k) => corners.flat().forEach((value, j) => bytes.writeFloatLE(value, 84 + 50 * k + 12 + 4 * j)));
  return { bytes, count: triangles.length };
}

/** The example's robot with shapes of its links, in a folder of its own. */
function shaped(name, shapes, files = {}) {
  const place = join(folder, name);
  mkdirSync(join(place, "meshes"), { recursive: true });
  let text = readFileSync(join(ELBOW, "robot.urdf"), "utf8");
  for (const [link, visual] of Object.entries(shapes)) text = text.replace(`<link name="${link}"/>`, `<link name="${link}">${visual}</link>`);
  writeFileSync(join(place, "robot.urdf"), text);
  for (const [file, bytes] of Object.entries(files)) writeFileSync(join(place, "meshes", file), bytes);
  copyFileSync(join(ELBOW, "points.csv"), join(place, "points.csv"));
  return calibrate(`${name}-out`, join(place, "robot.urdf"), join(place, "points.csv"));
}

const visual = (geometry, origin = "") => `<visual>${origin}<geometry>${geometry}</geometry></visual>`;

const PRIMITIVES = {
  base_link: visual('<cylinder radius="0.12" length="0.3"/>', '<origin xyz="0 0 -0.15"/>'),
  link1: visual('<box size="0.2 0.14 0.12"/>', '<origin xyz="0.07 0 0"/>'),
  link2: visual('<cylinder radius="0.06" length="0.57"/>', '<origin xyz="0 0 0.285"/>'),
  link3: visual('<sphere radius="0.09"/>') + visual('<box size="0.1 0.1 0.12"/>', '<origin xyz="0 0 0.09" rpy="0 0 0.3"/>'),
  link4: visual('<cylinder radius="0.05" length="0.634"/>', '<origin xyz="0.317 0 0" rpy="0 1.5707963267948966 0"/>'),
  link6: visual('<box size="0.04 0.08 0.02"/>', '<origin xyz="0.03 0.01 0.02"/>'),
};

/** Pose of a frame of the last link by the program, at values of the sliders. */
function lastLink(out, readings, values, offset) {
  const table = join(folder, "joints.csv");
  writeFileSync(table, `${readings.map(({ name }) => `"${name}[deg]"`).join(",")}\n${values.join(",")}\n`);
  const [header, row] = poecal("predict", join(out, "calibration.json"), table, "--model", "calibrated", "--quiet").split("\n");
  const names = header.split(",").map((name) => name.replace(/\W.*/, ""));
  const cell = (name) => Number(row.split(",")[names.indexOf(name)]);
  const tip = poseOf({ position_m: ["x", "y", "z"].map(cell), quaternion_xyzw: ["qx", "qy", "qz", "qw"].map(cell) });
  const { tool } = JSON.parse(readFileSync(join(out, "calibration.json"), "utf8"));
  return compose(compose(tip, invert(poseOf(tool))), { r: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], t: offset }).t;
}

/** Moves all sliders of joints; returns their values and the poses of the shapes on the page. */
function slide(page, share) {
  return page.evaluate((share) => {
    const legend = [...document.querySelectorAll(".panel legend")].find((it) => it.textContent === "Joints");
    const inputs = [...legend.parentElement.querySelectorAll("input")];
    inputs.forEach((input, k) => {
      input.value = Number(input.min) + (Number(input.max) - Number(input.min)) * ((share + 0.37 * k) % 1);
      input.dispatchEvent(new Event("input", { bubbles: true }));
    });
    return { values: inputs.map((it) => Number(it.value)), shapes: JSON.parse(document.getElementById("tip").dataset.shapes) };
  }, share);
}

/** The picture after the next frames. */
const picture = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(document.querySelector(".scene canvas").toDataURL())))));

/** The share of the picture's height and width over which the calibrated robot's hue is. */
function extent(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector(".scene canvas");
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let [left, right, top, bottom] = [copy.width, 0, copy.height, 0];
    for (let k = 0; k < data.length; k += 4) {
      // Blue, unlike everything else.
      if (data[k + 2] < data[k] + 70 || data[k + 1] < data[k] + 30) continue;
      const [x, y] = [(k / 4) % copy.width, Math.floor(k / 4 / copy.width)];
      [left, right, top, bottom] = [Math.min(left, x), Math.max(right, x), Math.min(top, y), Math.max(bottom, y)];
    }
    return { width: (right - left) / copy.width, height: (bottom - top) / copy.height };
  });
}

describe("shapes of a URDF", { skip }, () => {
  let out, data;
  before(() => {
    out = shaped("primitives", PRIMITIVES);
    data = dataOf(out);
  });

  test("are all on the page, in metres, on their bodies", () => {
    assert.deepEqual(data.shapes.map(({ link, on }) => [link, on]), [["base_link", null], ["link1", 0], ["link2", 1], ["link3", 2], ["link3", 2], ["link4", 3], ["link6", 5]]);
    assert.deepEqual(data.shapes[1].box, [0.2, 0.14, 0.12]);
    assert.deepEqual([data.shapes[0].cylinder, data.shapes[3].sphere], [[0.12, 0.3], 0.09]);
  });

  test("move with the sliders to where the program says", async () => {
    const page = await open(browser, join(out, "report.html"));
    let earlier = await picture(page);
    for (const share of [0.12, 0.43, 0.81]) {
      const { values, shapes } = await slide(page, share);
      const apart = Math.hypot(...subtract(shapes[6], lastLink(out, data.readings, values, [0.03, 0.01, 0.02])));
      console.log(`the last link's box is ${apart} m from where the program says`);
      assert.ok(apart < SAME_M, `${apart} m`);
      assert.deepEqual(shapes[0], data.shapes[0].pose.t, "the base does not move");
      const now = await picture(page);
      assert.notEqual(now, earlier);
      earlier = now;
    }
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
});

describe("meshes of a URDF", { skip }, () => {
  const arm = stl([[0, -0.08], [0.07, -0.06], [0.08, 0], [0.06, 0.12], [0.05, 0.45], [0.07, 0.57], [0, 0.64]], 48);
  const named = (file, scale = "") => visual(`<mesh filename="${file}"${scale}/>`);

  test("are in the page, and the report is made again byte for byte", async () => {
    const scaled = stl([[0, 0], [90, 0], [60, 200], [0, 200]], 24);
    const out = shaped("meshes", { link2: named("package://meshes/meshes/arm.stl"), link4: named("meshes/tube.stl", ' scale="0.001 0.001 0.001"') }, { "arm.stl": arm.bytes, "tube.stl": scaled.bytes });
    const data = dataOf(out);
    assert.deepEqual(data.shapes.map(({ link, mesh }) => [link, mesh]), [["link2", 0], ["link4", 1]]);
    const [, tube] = data.meshes;
    const bytes = Buffer.from(tube.places, "base64");
    const heights = Array.from({ length: bytes.length / 6 }, (_, k) => tube.least[2] + tube.step * bytes.readUInt16LE(6 * k + 4));
    assert.ok(Math.abs(Math.max(...heights) - 0.2) < 1e-5, `${Math.max(...heights)} m high`);
    const first = readFileSync(join(out, "report.html"));
    poecal("report", join(out, "calibration.json"), "--quiet");
    assert.ok(first.equals(readFileSync(join(out, "report.html"))), "the page differs");
    const page = await open(browser, join(out, "report.html"));
    assert.equal(await page.getByText("not drawn").count(), 0);
    assert.deepEqual(page.complaints, []);
    await page.close();
  });

  test("that are missing or broken are told of, and the robot is drawn without", async () => {
    const out = shaped("broken-mesh", { link2: named("meshes/no.stl"), link4: named("meshes/arm.stl") }, { "arm.stl": arm.bytes.subarray(0, 300) });
    assert.equal(dataOf(out).shapes, undefined);
    const page = await open(browser, join(out, "report.html"));
    const note = await page.locator("#view .note", { hasText: "meshes/" }).textContent();
    assert.match(note, /meshes\/no\.stl was not found beside the URDF/);
    assert.match(note, /meshes\/arm\.stl is not drawn: found 216 bytes of triangles in it/);
    assert.ok((await extent(page)).height > 0.3);
    assert.deepEqual(page.complaints, []);
    await page.close();
  });

  test("that are very fine are made coarser", async () => {
    const fine = stl(Array.from({ length: 400 }, (_, k) => [0.06 + 0.02 * Math.sin(k / 9), k * 0.0014]), 360);
    const plain = readFileSync(join(shaped("no-mesh", {}), "report.html")).length;
    const out = shaped("fine", { link2: named("meshes/fine.stl") }, { "fine.stl": fine.bytes });
    const own = readFileSync(join(out, "report.html")).length;
    const [{ corners, wide }] = dataOf(out).meshes;
    const kept = (corners.length * 3) / 4 / (wide ? 12 : 6);
    console.log(`${fine.count} triangles of ${fine.bytes.length} bytes: ${Math.round(kept)} kept, ${own - plain} bytes more than without, ${own} in all`);
    assert.ok(own - plain < MOST_CHARACTERS + AROUND && kept > 20_000);
    const page = await open(browser, join(out, "report.html"));
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
});

describe("a robot without shapes", { skip }, () => {
  let page;
  before(async () => {
    const out = calibrate("toml", join(ELBOW, "robot.toml"), join(ELBOW, "points.csv"));
    assert.equal(dataOf(out).shapes, undefined);
    page = await open(browser, join(out, "report.html"));
  });
  after(() => page?.close());

  test("is drawn by its axes, and fills the picture", async () => {
    const { width, height } = await extent(page);
    console.log(`the robot takes ${Math.round(100 * height)} % of the picture's height and ${Math.round(100 * width)} % of its width`);
    assert.ok(height > 0.5);
  });

  test("stands in its base, with a scale and names that are not on each other", async () => {
    const names = await page.$$eval(".names span:not([hidden])", (all) => all.map((it) => [it.textContent, it.offsetLeft, it.offsetTop, it.offsetWidth, it.offsetHeight]));
    const words = names.map(([text]) => text);
    for (const name of ["x", "y", "z", "joint1"]) assert.ok(words.includes(name), `${name} is not among ${words}`);
    for (const [k, [a, x, y, w, h]] of names.entries()) {
      for (const [b, u, v, w2, h2] of names.slice(k + 1)) assert.ok(x >= u + w2 || u >= x + w || y >= v + h2 || v >= y + h, `${a} is on ${b}`);
    }
    await page.getByRole("button", { name: "all measurements" }).click();
    await picture(page);
    assert.ok(await page.locator(".names .grid").isVisible());
    await page.getByRole("button", { name: "all measurements" }).click();
  });

  test("has controls no higher than the picture with its legend", async () => {
    const [stage, panel] = [await page.locator(".stage").boundingBox(), await page.locator(".panel").boundingBox()];
    console.log(`controls ${Math.round(panel.height)} px, picture with legend ${Math.round(stage.height)} px`);
    assert.ok(panel.height <= stage.height + 40);
  });

  test("is turned by keys, and looked at from each side", async () => {
    await page.locator(".scene canvas:not(.paper)").focus();
    const seen = [await picture(page)];
    for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) {
      await page.keyboard.press(key);
      seen.push(await picture(page));
    }
    for (const name of ["front", "side", "top"]) {
      await page.getByRole("button", { name, exact: true }).click();
      seen.push(await picture(page));
    }
    seen.forEach((it, k) => assert.notEqual(it, seen[k - 1]));
  });

  test("tells places that were not measured from data", async () => {
    const key = page.locator(".keys .ring");
    assert.equal(await key.isVisible(), false);
    const before = await picture(page);
    await page.getByLabel("reachable, but not measured").check();
    assert.equal(await key.isVisible(), true);
    assert.notEqual(await picture(page), before);
    assert.deepEqual(page.complaints, []);
  });
});

after(() => rmSync(join(folder, "fine"), { recursive: true, force: true }));

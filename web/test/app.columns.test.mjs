// The page that calibrates as the first step: columns of a foreign file by pull-downs, a fork of links as a list, files that are named, the arm
// before any measurement, one verdict and one switch of colours.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { linesOf, robotOf } from "../app/src/arm.js";
import { choose } from "../app/src/columns.js";
import { clear, drop, messages, open, saved, skipped, status } from "./app.mjs";
import { launch } from "./browser.mjs";
import { PROGRAM, ROOT, folder, poecal } from "./cases.mjs";
import { difference } from "./numbers.mjs";

const DATASETS = process.env.POECAL_DATASETS ?? join(ROOT, "../shared/datasets");
const UR10 = join(DATASETS, "ur10_tmac");
/** Program and page differ in vector instructions, hence in last digits. */
const SAME = 1e-9;
const MODEL = readFileSync(join(ROOT, "examples/elbow/robot.urdf"), "utf8");
const POINTS = readFileSync(join(ROOT, "examples/elbow/points.csv"), "utf8");
const FORK = MODEL.replace(
  "</robot>",
  `${["gripper", "camera"].map((name) => `<link name="${name}"/><joint name="to_${name}" type="fixed"><parent link="tool"/><child link="${name}"/><origin xyz="0 0 0.1"/></joint>`).join("")}</robot>`,
);

let browser;
before(async () => {
  if (!skipped) browser = await launch();
});
after(() => browser?.close());

/** The example's points as another program writes them: its own names, no units, `;` and decimal commas, and columns without information. */
function foreign() {
  const [head, ...rows] = POINTS.trim().split("\n").slice(1);
  const names = { "x[mm]": "Leica East", "y[mm]": "Leica North", "z[mm]": "Leica Up" };
  const cells = head.split(",").map((name) => names[name] ?? name.replace(/^joint(\d).*/, (_, k) => `M${k}_pos`));
  const row = (line, k) => [`P ${k + 1}`, ...line.split(","), "0"].map((it) => it.replace(".", ",")).join(";");
  return `Station 3\n${["No.", ...cells, "Spare"].join(";")}\n${rows.map(row).join("\n")}\n`;
}

const status0 = (page) => page.locator("#status").innerText();
const chosen = (page) => page.$$eval("#columns select", (all) => Object.fromEntries(all.map((it) => [it.id.replace("column-", ""), it.value])));

/** Chooses in a pull-down, and waits until the program has answered. */
async function pick(page, key, value) {
  await page.locator(`[id="column-${key}"]`).selectOption(value);
  await page.waitForFunction(([key, value]) => !document.documentElement.hasAttribute("data-busy") && document.getElementById(`column-${key}`)?.value === value, [key, value]);
}

/** Saves the mapping of the page, and returns its text. */
const mapping = async (page) => (await saved(page, page.locator("#columns .downloads a"))).toString();

async function calibration(page) {
  return (await saved(page, page.locator("#downloads a", { hasText: "calibration.json" }))).toString();
}

/** The accuracy of a calibration, as a text to compare. */
const accuracy = (text) => JSON.stringify(JSON.parse(text).accuracy);

test("a new form of an orientation takes the columns of the one before away", () => {
  const before = [["x", "a"], ["orientation", "rotation_vector"], ["orientation.1", "b"]];
  assert.deepEqual(choose(before, "orientation", ""), [["x", "a"], ["orientation", ""]]);
  assert.deepEqual(choose(before, "x", "c").at(-1), ["x", "c"]);
});

test("the arm that is drawn is where the program says", () => {
  const model = join(ROOT, "examples/elbow/robot.urdf");
  const robot = robotOf(JSON.parse(poecal("check", model, "--json")).model);
  const table = join(folder, "arm.csv");
  const readings = [0.3, -1.1, 0.7, 1.9, -0.4, 0.2];
  writeFileSync(table, `${robot.readings.map((name) => `${name}[rad]`).join(",")}\n${readings.join(",")}\n`);
  const [, row] = poecal("predict", model, table, "--quiet").split("\n");
  const expected = row.split(",").slice(0, 3).map(Number);
  const { tip } = linesOf(robot, readings);
  assert.ok(Math.hypot(...tip.map((value, k) => value - expected[k])) < 1e-6, `${tip} is not ${expected}`);
});

describe("the page as the first step", { skip: skipped }, () => {
  test("columns with names of their own are chosen by pull-downs, and the program takes the mapping", async () => {
    const page = await open(browser);
    await drop(page, { "robot.urdf": MODEL, "session.txt": foreign() });
    assert.match(await status(page, /choose which column is which/), /not understood yet/);
    const guess = await chosen(page);
    assert.deepEqual([guess.x, guess.y, guess.z, guess["unit.position"], guess.orientation], ["Leica East", "Leica North", "Leica Up", "mm", ""]);
    assert.deepEqual([guess.joint1, await page.locator('[id="column-joint1"]').getAttribute("aria-invalid")], ["M1_pos", null]);
    // A joint without a column is marked, until it has one.
    await pick(page, "joint3", "");
    assert.equal(await page.locator('[id="column-joint3"]').getAttribute("aria-invalid"), "true");
    await pick(page, "joint3", "M3_pos");
    assert.equal((await chosen(page))["unit.angle"], "deg");
    await pick(page, "id", "No.");
    const text = await mapping(page);
    await page.click("#use-columns");
    await status(page, /^Calibrated/);
    assert.match(await page.locator("#line").innerText(), /--columns columns\.toml/);

    const there = join(folder, "foreign");
    mkdirSync(there, { recursive: true });
    for (const [name, content] of Object.entries({ "robot.urdf": MODEL, "session.txt": foreign(), "columns.toml": text, "points.csv": POINTS })) writeFileSync(join(there, name), content);
    const run = (...words) => spawnSync(PROGRAM, words, { cwd: there, encoding: "utf8" });
    const check = run("check", "robot.urdf", "session.txt", "--columns", "columns.toml", "--json");
    assert.equal(check.status, 0, check.stderr);
    assert.deepEqual(JSON.parse(check.stdout).files[0].ignored, ["Spare"]);
    run("calibrate", "robot.urdf", "points.csv", "--out", "as-it-is");
    const most = difference(accuracy(await calibration(page)), accuracy(readFileSync(join(there, "as-it-is/calibration.json"), "utf8")), "accuracy");
    console.log(`a foreign file: figures differ by up to ${most.toExponential(1)} from those of the table as it is`);
    assert.ok(most < SAME);

    // Another choice removes the mapping until it is confirmed again.
    await pick(page, "id", "");
    assert.equal(await page.locator("#result").isVisible(), false);
    assert.equal(await page.locator("#use-columns").isDisabled(), false);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test("the raw file of a UR10 with a laser tracker, by pull-downs alone", { skip: existsSync(UR10) ? false : `found no data sets at ${DATASETS}; set POECAL_DATASETS` }, async () => {
    const raw = join(UR10, "raw_series_C/measurements_random_poses.csv");
    const model = join(UR10, "robot.urdf");
    const page = await open(browser);
    await drop(page, { "robot.urdf": readFileSync(model), "raw.csv": readFileSync(raw) });
    await status(page, /choose which column is which/);
    const wanted = {
      ...Object.fromEntries(["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"].map((name, k) => [`joint${k + 1}`, `${name}_joint`])),
      ...Object.fromEntries(["x", "y", "z"].map((axis) => [axis, `measurement_${axis}`])),
      orientation: "intrinsic_xyz",
      ...Object.fromEntries(["rx", "ry", "rz"].map((part, k) => [`orientation.${k + 1}`, `measurement_${part}`])),
      "unit.angle": "rad", "unit.position": "mm", "unit.orientation": "deg",
    };
    const guess = await chosen(page);
    const guessed = Object.entries(wanted).filter(([key, value]) => guess[key] === value).length;
    console.log(`UR10: ${guessed} of ${Object.keys(wanted).length} choices are preset`);
    // Mistakes are corrected by the same pull-downs.
    for (const [key, value] of [["orientation", "rotation_vector"], ["joint4", ""], ["unit.position", "m"]]) await pick(page, key, value);
    for (const [key, value] of Object.entries(wanted)) if ((await chosen(page))[key] !== value) await pick(page, key, value);
    await page.click("#use-columns");
    await status(page, /^Calibrated/, 120_000);
    const out = join(folder, "ur10-raw");
    spawnSync(PROGRAM, ["calibrate", model, raw, "--columns", join(ROOT, "validation/ur10_raw_columns.toml"), "--out", out]);
    const most = difference(accuracy(await calibration(page)), accuracy(readFileSync(join(out, "calibration.json"), "utf8")), "accuracy");
    const { accuracy: found } = JSON.parse(await calibration(page));
    console.log(`UR10 by pull-downs: ${found.held_out.calibrated.position_mm.mean} mm on rows held out; figures differ by up to ${most.toExponential(1)}`);
    assert.ok(most < 1e-6, `${most}`);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test("a fork of links is a list, with the link before it", async () => {
    const page = await open(browser);
    await drop(page, { "robot.urdf": FORK, "points.csv": POINTS });
    await status(page, /^The model ends in several links/);
    assert.deepEqual(await page.$$eval("#tips option", (all) => all.map((it) => it.value)), ["", "tool", "gripper", "camera"]);
    await page.getByLabel("Last link of the arm").selectOption("tool");
    await status(page, /^Understood/);
    await page.click("#calibrate");
    await status(page, /^Calibrated/);
    assert.match(await page.locator("#line").innerText(), /--tip-link tool/);
    // The choice is kept, and another model does not ask again.
    assert.equal(await page.locator("#tips").inputValue(), "tool");
    await clear(page);
    await drop(page, { "other.urdf": MODEL });
    await status(page, /^The robot model is there/);
    assert.equal(await page.locator("#tip").isVisible(), false);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test("what is read in no way is named as the program names it", async () => {
    const cases = [
      ["r.pdf", "%PDF-1.7\n", /^r\.pdf: found a PDF, expected a robot model/],
      ["arm.step", "ISO-10303-21;\nHEADER;\n", /^arm\.step: found a STEP file, which has shapes and no joints, expected a robot model/],
      ["arm.igs", `${" ".repeat(72)}S      1\n`, /^arm\.igs: found an IGES file/],
      ["arm.stl", "solid x\nendsolid x\n", /^arm\.stl: found a mesh/],
      ["arm.dae", '<?xml version="1.0"?><COLLADA/>', /^arm\.dae: found a mesh/],
      ["cell.SLDASM", Buffer.from("\xd0\xcf\x11\xe0", "latin1"), /^cell\.SLDASM: found a drawing of a CAD program/],
      ["cell.jpg", Buffer.from("\xff\xd8\xff\xe0", "latin1"), /^cell\.jpg: found a picture/],
      ["notes.docx", Buffer.from("PK\x03\x04", "latin1"), /^notes\.docx: found a document of an office program/],
      ["take.zip", Buffer.from("\x1f\x8b\x08\x00", "latin1"), /^take\.zip: found a file compressed by gzip/],
    ];
    const page = await open(browser);
    for (const [name, content, sentence] of cases) {
      await drop(page, { [name]: content });
      await page.getByLabel(`Role of ${name}`).waitFor();
      const told = (await messages(page)).map(({ kind, text }) => [kind, text.replace(/^error: /, "")]);
      assert.equal(told.length, 1, `${name}: ${JSON.stringify(told)}`);
      assert.equal(told[0][0], "error", name);
      assert.match(told[0][1], sentence);
      await clear(page);
    }
    // Beside a session it is named, and nothing else changes.
    await drop(page, { "robot.urdf": MODEL, "points.csv": POINTS, "r.pdf": "%PDF-1.7\n", "notes.md": "# notes\n" });
    await status(page, /^Calibrated/);
    assert.deepEqual((await messages(page)).map(({ kind }) => kind), ["warning"]);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test("the arm is drawn before anything is measured, and turns and moves", async () => {
    const page = await open(browser);
    await drop(page, { "robot.urdf": MODEL });
    await status(page, /^The robot model is there/);
    const picture = () => page.locator("#drawn canvas").evaluate((it) => it.toDataURL());
    await page.waitForSelector("#drawn canvas[data-drawn]");
    const before = await picture();
    const blank = await page.locator("#drawn canvas").evaluate((it) => {
      const empty = document.createElement("canvas");
      [empty.width, empty.height] = [it.width, it.height];
      return empty.toDataURL();
    });
    assert.notEqual(before, blank);
    await page.locator("#drawn canvas").focus();
    await page.keyboard.press("ArrowLeft");
    const turned = await picture();
    assert.notEqual(turned, before);
    const tip = page.locator("#drawn .note");
    const place = await tip.innerText();
    await page.getByLabel("joint2").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    assert.notEqual(await picture(), turned);
    assert.notEqual(await tip.innerText(), place);
    await drop(page, { "points.csv": POINTS });
    await status(page, /^Calibrated/);
    assert.equal(await page.locator("#robot").isVisible(), false, "the report has the arm");
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test("one verdict and one switch of colours", async () => {
    const page = await open(browser);
    await drop(page, { "robot.urdf": MODEL, "points.csv": POINTS });
    await status(page, /^Calibrated/);
    const printed = /^verdict +([^:\n]+)/m.exec(await page.locator("#printed-text").textContent())[1];
    assert.equal((await status0(page)).replace(/^.*the verdict: /, ""), `${printed}.`);
    const frame = await (await page.waitForSelector("#report iframe")).contentFrame();
    await frame.waitForSelector(":root[data-ready]", { state: "attached" });
    assert.equal(await frame.locator(".theme").isVisible(), false);
    for (const name of ["dark", "light", "system"]) {
      await page.locator("header .theme button", { hasText: name }).click();
      const shown = await frame.evaluate(() => document.documentElement.dataset.theme ?? "system");
      assert.equal(shown, name);
    }
    // A report that comes later has the colours that are already selected.
    await page.locator("header .theme button", { hasText: "dark" }).click();
    await page.click("#calibrate");
    await status(page, /^Calibrated/);
    const next = await (await page.waitForSelector("#report iframe")).contentFrame();
    await next.waitForSelector(':root[data-theme="dark"]', { state: "attached" });
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });
});

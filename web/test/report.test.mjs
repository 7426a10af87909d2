// Opens reports in headless Chromium: nothing is loaded or complained of, everything is drawn, the arm moves, the text is that of
// calibration.json, and axe finds no serious fault.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, open, skip } from "./browser.mjs";
import { CASES, TREES, checked, folder, long, predicted, printed } from "./cases.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** Share of a picture's pixels that must differ from its background: axes alone are less. */
const DRAWN = 0.002;
/** The browser and the program round differently. */
const TIP_M = 1e-9;

let browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(() => browser?.close());

/** The share of a picture's pixels that differ from its corner. */
async function drawnShare(page, place) {
  const png = (await place.screenshot()).toString("base64");
  return page.evaluate(async (png) => {
    const bytes = Uint8Array.from(atob(png), (letter) => letter.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [picture.width, picture.height];
    const context = copy.getContext("2d");
    context.drawImage(picture, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
    return pixels.filter((pixel) => pixel !== pixels[0]).length / pixels.length;
  }, png);
}

/** The shares that are drawn of the arm and of each chart. */
async function drawnShares(page) {
  const places = [["arm", page.locator(".scene")]];
  for (const chart of await page.locator("[data-chart]").all()) {
    const name = await chart.getAttribute("data-chart");
    for (const graph of await chart.locator(".graph:visible > svg").all()) places.push([name, graph]);
  }
  const shares = [];
  for (const [name, place] of places) shares.push({ name, share: await drawnShare(page, place) });
  return shares;
}

/** Charts that lack dots, or for histograms bars, and the number of those that do not. */
function emptyCharts() {
  const graphs = [...document.querySelectorAll(".graph")].filter((it) => it.checkVisibility());
  const marks = (it) => [...it.querySelectorAll(".dots, .bars, .line")].filter((path) => !path.closest("[hidden]")).reduce((sum, path) => sum + (path.getAttribute("d").match(/h[01]|l/g) ?? []).length, 0);
  const empty = graphs.filter((it) => marks(it) < 2 || it.clientWidth < 100 || !it.getAttribute("aria-label"));
  return { empty: empty.map((it) => it.getAttribute("aria-label")), count: graphs.length };
}

function valueOf(file, key) {
  return key.split(".").reduce((value, part) => value?.[part], file);
}

/** True if a text shows this value to its digits. */
function shows(text, value) {
  const plain = text.replaceAll("−", "-");
  const [mantissa, power = "0"] = plain.split("e");
  const decimals = mantissa.split(".")[1]?.length ?? 0;
  return plain.trim() !== "" && Math.abs(Number(plain) - value) <= 0.5001 * 10 ** (Number(power) - decimals);
}

function checkText(figures, file) {
  for (const { key, factor, text } of figures) {
    const value = valueOf(file, key);
    if (typeof value === "number") assert.ok(shows(text, value * factor), `${key} is shown as ${text}, expected ${value * factor}`);
    else assert.equal(text, String(value).replaceAll("`", ""), key);
  }
  return figures.length;
}

async function faults(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  return serious.map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join("; ")}`);
}

/** Moves every joint's slider, and returns the tip's position on the page at random values. */
async function moveArm(page) {
  return page.evaluate(async () => {
    const tip = () => document.getElementById("tip").dataset.tip;
    const picture = () => document.querySelector(".scene canvas").toDataURL();
    const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const sliders = [...document.querySelectorAll(".panel fieldset")].find((it) => it.querySelector("legend").textContent === "Joints").querySelectorAll("input");
    const still = [];
    for (const [k, slider] of sliders.entries()) {
      const earlier = [tip(), picture()];
      const [least, most] = [Number(slider.min), Number(slider.max)];
      slider.value = Number(slider.value) > (least + most) / 2 ? least + 0.2 * (most - least) : most - 0.3 * (most - least);
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      await frame();
      if (tip() === earlier[0] && picture() === earlier[1]) still.push(k);
    }
    return { still, values: [...sliders].map((slider) => Number(slider.value)), tip: tip().split(",").map(Number) };
  });
}

/** Elements wider than their box, except for boxes that scroll, names in the picture, and drawings. */
function cutOff() {
  const scrolls = ".scroll, pre, select, .names, svg";
  const all = [...document.querySelectorAll("main *")].filter((it) => it.checkVisibility() && !it.matches(scrolls) && !it.parentElement.closest(scrolls));
  const cut = all.filter((it) => it.clientWidth > 0 && it.scrollWidth > it.clientWidth + 1);
  return cut.map((it) => `${it.tagName}.${it.className} ${it.scrollWidth} in ${it.clientWidth}: ${it.textContent.slice(0, 60)}`);
}

/** Tables that show some of their cells only when they are scrolled, except for those that are folded on opening. */
function cutCells() {
  const tables = [...document.querySelectorAll(".scroll")].filter((it) => it.checkVisibility() && !it.closest("details"));
  return tables.filter((it) => it.scrollWidth > it.clientWidth).map((it) => `${it.getAttribute("aria-label")}: ${it.scrollWidth} in ${it.clientWidth}`);
}

const LOOKS = [[400, "dark"], [900, "dark"], [1300, "light"], [400, "light"]];

for (const [k, [name, make]] of [...CASES, ...Object.entries(TREES)].entries()) {
  describe(name, { skip }, () => {
    // One page for everything that is read of it: to open and draw it takes longer than to look. Its sliders are moved last.
    let out, file, report, page;
    before(async () => {
      out = make();
      report = join(out, "report.html");
      file = JSON.parse(readFileSync(join(out, "calibration.json"), "utf8"));
      page = await open(browser, report);
    });
    after(() => page?.close());

    test("is drawn, quiet, and says what calibration.json says", async () => {
      const figures = await page.$$eval("[data-key]", (all) =>
        all.map((it) => ({ key: it.dataset.key, factor: Number(it.dataset.factor ?? 1), text: it.textContent })),
      );
      const count = checkText(figures, file);
      const shares = await drawnShares(page);
      const charts = new Set(shares.map((it) => it.name));
      assert.deepEqual([...charts].sort(), ["arm", "components", "histogram", "joints", "leverage", "normal", "rows"]);
      for (const { name, share } of shares) assert.ok(share > DRAWN, `${name}: ${share} of the pixels are drawn`);
      const { empty, count: graphs } = await page.evaluate(emptyCharts);
      assert.deepEqual(empty, []);
      // The still is for paper, and for browsers that do not draw the arm.
      const plots = await page.$$eval("svg.plot", (all) => all.filter((it) => it.checkVisibility()).map((it) => [it.querySelectorAll("circle, rect, polyline").length, it.clientWidth]));
      for (const [marks, width] of plots) assert.ok(marks > 1 && width > 100, `a plot has ${marks} marks, ${width} px wide`);
      assert.deepEqual(page.complaints, []);
      console.log(`${name}: ${count} figures, ${graphs} charts, ${plots.length} plots, ${readFileSync(report).length} bytes`);
    });

    test("says each joint's correction in words, and which unknowns are correlated", async () => {
      const shown = (key) => page.$$eval(`[data-key^="${key}"]`, (all) => all.map((it) => it.textContent));
      const words = await shown("corrections.");
      const told = file.corrections.filter((it) => it.change);
      for (const { change } of told) assert.ok(words.includes(change.words), change.words);
      // One definition: no other figure of a correction, tilt or shift, is on the page.
      const parts = await page.$$eval("[data-key^='corrections.']", (all) => [...new Set(all.map((it) => it.dataset.key.split(".").slice(2).join(".")))]);
      const known = ["joint", "change.words", "left_nominal_rms_mm", "suspicious", "tilt_from_data", "shift_from_data"];
      assert.deepEqual(parts.filter((it) => !known.includes(it)), []);
      assert.ok(told.length > 0 && told.every(({ change }) => /(mm|deg|noise|determined|no )/.test(change.words)));
      const common = await shown("common.");
      assert.deepEqual(common, (file.common ?? []).map((it) => it.words));
      const correlations = file.uncertainty?.correlations;
      const cells = await shown("uncertainty.correlations.largest");
      const blocks = correlations?.blocks.length ?? 0;
      assert.equal(cells.length, (blocks * (blocks + 1)) / 2);
      const legend = await page.$eval(".first svg.plot", (it) => it.textContent);
      const hasTerms = Object.values(file.corrected?.sizes ?? {}).some((size) => size > 0);
      if (!hasTerms) assert.ok(!legend.includes("corrected"), "a corrected model without terms is none");
      console.log(`${name}: ${told.length} corrections, ${common.length} common directions, ${correlations?.strong ?? 0} strong pairs of ${blocks} blocks`);
    });

    test("the sliders move the arm to where the program says", async () => {
      const { still, values, tip } = await moveArm(page);
      assert.deepEqual(still, [], "these sliders move nothing");
      const readings = await page.evaluate(() => JSON.parse(document.getElementById("report-data").textContent).readings);
      const expected = predicted(out, readings, values);
      const apart = Math.hypot(...tip.map((value, k) => value - expected[k]));
      assert.ok(apart < TIP_M, `the tip is ${apart} m from where the program says`);
      await page.getByRole("button", { name: "worst" }).click();
      // Residuals are those of the delivered model.
      const delivered = file.verdict?.model ?? "calibrated";
      const most = (set) => set?.[delivered]?.position_mm.max ?? 0;
      const worst = Math.max(most(file.accuracy.training), most(file.accuracy.held_out));
      const told = await page.locator(".panel .state").first().textContent();
      const shown = Number(told.match(/off by ([\d.]+) mm/)?.[1]);
      assert.ok(Math.abs(shown / worst - 1) < 5e-3 || Math.abs(shown - worst) < 5e-4, `${told}; the worst is ${worst}`);
      assert.deepEqual(page.complaints, []);
    });

    // Each opened as a reader does; for reports of the same form, the open one gets another width and other colours.
    for (const [width, colours] of k === 0 ? LOOKS : [LOOKS[k % LOOKS.length]]) {
      test(`axe finds nothing serious, and nothing is cut off, at ${width} px in ${colours}`, async () => {
        const looked = k === 0 ? await open(browser, report, { width, colours }) : page;
        await looked.setViewportSize({ width, height: 900 });
        await looked.emulateMedia({ colorScheme: colours });
        await looked.$$eval("details", (all) => all.forEach((it) => (it.open = true)));
        assert.deepEqual(await faults(looked), []);
        for (const [width, colours] of LOOKS) {
          await looked.setViewportSize({ width, height: 900 });
          await looked.emulateMedia({ colorScheme: colours });
          const cut = await looked.evaluate(() => document.documentElement.scrollWidth - innerWidth);
          assert.ok(cut <= 0, `the page is ${cut} px too wide at ${width} px`);
          assert.deepEqual(await looked.evaluate(cutOff), [], `at ${width} px`);
          if (width === 400) assert.deepEqual(await looked.evaluate(cutCells), [], `cells at ${width} px`);
        }
        if (looked !== page) await looked.close();
      });
    }
  });
}

/** The width of A4 without its margins (182 mm, 96 to the inch). */
const PAPER_PX = (182 / 25.4) * 96;

describe("the page", { skip }, () => {
  let report;
  before(() => {
    // The first case has written it.
    report = join(folder, "elbow", "report.html");
  });

  test("a check has a page of its own, without a script, which says what validation.json says", async () => {
    const out = checked(join(folder, "elbow"));
    const file = JSON.parse(readFileSync(join(out, "validation.json"), "utf8"));
    const page = await browser.newPage();
    const asked = [];
    page.on("request", (request) => asked.push(request.url()));
    await page.goto(`file://${join(out, "report.html")}`);
    assert.equal(asked.length, 1);
    assert.equal(await page.locator("script").count(), 0);
    const figures = await page.$$eval("[data-key]", (all) =>
      all.map((it) => ({ key: it.dataset.key, factor: Number(it.dataset.factor ?? 1), text: it.textContent })),
    );
    const count = checkText(figures, file);
    const text = await page.locator("main").innerText();
    for (const words of ["Check of the calibration of", "Mia", "4711", "Checks of this calibration", "this one"]) assert.ok(text.includes(words), words);
    for (const [width, colorScheme] of LOOKS) {
      await page.setViewportSize({ width, height: 900 });
      await page.emulateMedia({ colorScheme });
      assert.deepEqual(await faults(page), []);
      const cut = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(cut <= 0, `the page is ${cut} px too wide at ${width} px`);
    }
    console.log(`${count} figures of a check`);
    await page.close();
  });

  test("colours can be chosen, and are redrawn", async () => {
    const page = await open(browser, report);
    const look = () => page.evaluate(() => [getComputedStyle(document.body).backgroundColor, document.querySelector(".scene canvas").toDataURL().length]);
    const light = await look();
    await page.getByRole("button", { name: "dark" }).click();
    const dark = await look();
    assert.notEqual(light[0], dark[0]);
    assert.notEqual(light[1], dark[1]);
    await page.close();
  });

  test("prints charts as wide as paper", async () => {
    const page = await open(browser, report, { width: Math.floor(PAPER_PX), colours: "dark" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    await page.emulateMedia({ media: "print" });
    const places = await page.$$eval("main svg.plot, main svg.graph, main table", (all) =>
      all.filter((it) => it.checkVisibility()).map((it) => [it.tagName, it.getBoundingClientRect().right - document.querySelector("main").getBoundingClientRect().left]));
    const wide = places.filter(([, right]) => right > PAPER_PX + 1);
    assert.ok(places.length > 10);
    assert.deepEqual(wide, []);
    await page.close();
  });

  test("says everything without scripts", async () => {
    const context = await browser.newContext({ javaScriptEnabled: false });
    const page = await context.newPage();
    await page.goto(`file://${report}`);
    assert.ok((await page.locator("table").count()) > 8);
    assert.ok(await page.locator(".first svg.plot").isVisible());
    await page.locator("#metrologist > summary").click();
    assert.equal(await page.getByRole("combobox").count(), 0, "nothing is offered that needs a script");
    for (const name of ["rows", "components", "joints", "histogram", "normal", "leverage"]) assert.ok(await page.locator(`[data-chart=${name}] .graph`).first().isVisible(), name);
    await context.close();
  });

  test("says before and after first, without an unknown tool's nominal model", async () => {
    const page = await open(browser, report, { whole: false });
    const steps = await page.$$eval(".steps [data-key]", (all) => all.map((it) => it.dataset.key));
    assert.deepEqual(steps, ["accuracy.held_out.registered.position_mm.rms", "accuracy.held_out.calibrated.position_mm.rms", "verdict.expected_error_mm", "verdict.bound95_mm", "verdict.sampled_range_error_mm", "verdict.nominal_error_mm"]);
    const places = await page.$$eval(".steps li", (all) => all.map((it) => it.getBoundingClientRect().top));
    assert.equal(new Set(places).size, 1, "the steps are in a line");
    assert.ok(places[0] < 300, `the gain is ${places[0]} px below the top`);
    assert.match(await page.textContent(".holds"), /^It holds anywhere within the limits of the joints, with [\d.]+ mm \(RMS\) expected there\.$/);
    // The robot is on the first screen, most of it.
    await page.waitForSelector(".scene canvas[data-drawn]", { state: "attached" });
    const { y, height } = await page.locator(".scene").boundingBox();
    assert.ok(y + 0.7 * height < 900, `the robot is from ${y} px on, ${height} px high`);
    assert.equal(await page.locator(".first").getByText(/^nominal$/).count(), 0);
    await page.close();
  });

  test("has no words of a command line but the command that makes it again", async () => {
    const page = await open(browser, report, { whole: false });
    await page.$$eval("pre", (all) => all.forEach((it) => it.remove()));
    const text = await page.locator("main").innerText();
    assert.doesNotMatch(text, /(^|\s)--[a-z]|calibration\.json|\.md\b|levenberg-marquardt/);
    await page.close();
  });

  test("the contents stand beside the text where there is room, and follow it", async () => {
    const page = await open(browser, report, { whole: false });
    const [nav, main] = [await page.locator("nav").boundingBox(), await page.locator("header").boundingBox()];
    assert.ok(nav.x + nav.width <= main.x, `contents to ${nav.x + nav.width}, text from ${main.x}`);
    await page.locator("nav a[href='#trust']").click();
    await page.waitForSelector("nav a[href='#trust'][aria-current]");
    assert.equal(await page.locator("nav a[aria-current]").count(), 1);
    assert.equal((await page.locator("nav").boundingBox()).y, nav.y);
    await page.close();
    const narrow = await open(browser, report, { width: 900, whole: false });
    assert.ok((await narrow.locator("nav").boundingBox()).y > 300);
    await narrow.close();
  });

  test("folds what only a metrologist needs", async () => {
    const page = await open(browser, report, { whole: false });
    const terms = /sizes were tried|O1|O5|iterations|correlated|[Ll]everage|condition number|Not observable/g;
    const seen = await page.locator("main").innerText();
    // The heading of a folded part names its contents.
    assert.deepEqual(seen.match(terms), null);
    await page.$eval("#metrologist", (it) => (it.open = true));
    const found = new Set((await page.locator("#metrologist").innerText()).match(terms));
    console.log(`folded: ${[...found].join(", ")}`);
    assert.ok(found.size >= 6, [...found].join());
    await page.close();
  });

  test("counts the weakly determined unknowns alike in its sentences, on the terminal and in the file", async () => {
    const file = JSON.parse(readFileSync(join(folder, "elbow", "calibration.json"), "utf8"));
    const weak = file.identifiability.weak.reduce((sum, it) => sum + it.directions, 0);
    assert.ok(weak > 0, "the point of the example is on the last axis");
    const sum = (text, words) => [...text.replace(/\s+/g, " ").matchAll(words)].reduce((sum, [, count = 1]) => sum + Number(count), 0);
    const page = await open(browser, report, { whole: false });
    const told = printed();
    const counted = {
      "look at": sum(await page.locator(".doubts").innerText(), /weakly determined: .*?\((\d+) unknowns\)/g),
      "the report's count": sum(await page.locator("#trust").innerText(), /(\d+) of them weakly/g),
      "the report's list": sum(await page.locator("#trust").innerText(), /Weakly determined.*?\((\d+) unknowns?\)/g),
      verdict: sum(file.verdict.reasons.join(), /all unknowns are determined \((\d+) weakly\)/g),
      "the terminal's count": sum(told, /unknowns \((\d+) weakly\)/g),
      "the terminal's sentence": sum(told, /weakly determined: .*?\((\d+) unknowns?\)/g),
    };
    console.log(`${weak} weakly determined: ${JSON.stringify(counted)}`);
    for (const [where, count] of Object.entries(counted)) assert.equal(count, weak, where);
    await page.close();
  });

  test("of 50,000 rows opens with less than 2 s of work", async () => {
    const path = join(long(), "report.html");
    const [times, worked] = [[], []];
    for (let round = 0; round < 3; round++) {
      const begin = Date.now();
      const page = await open(browser, path, { whole: false });
      times.push(((Date.now() - begin) / 1e3).toFixed(1));
      worked.push(await page.processorTime());
      assert.deepEqual(page.complaints, []);
      assert.match(await page.locator("#errors").textContent(), /Charts draw \d+ of 50000 rows/);
      await page.close();
    }
    const seconds = Math.min(...worked);
    console.log(`50,000 rows: ${readFileSync(path).length} bytes, opened in ${times.join(", ")} s, ${seconds.toFixed(1)} s of them at work`);
    // Processor time, since a busy machine takes longer by the clock.
    assert.ok(seconds < 2, `${worked} s`);
  });
});

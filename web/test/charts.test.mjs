// Effect of the page's script on the charts, which are on the page without it: it reports dots, moves the arm to their rows, and draws another
// residual.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, open, skip } from "./browser.mjs";
import { CASES, dataOf } from "./cases.mjs";

describe("charts", { skip }, () => {
  let browser, out, report;
  before(async () => {
    browser = await launch();
    const [, make] = CASES[0];
    out = make();
    report = join(out, "report.html");
  });
  after(() => browser?.close());

  test("has its charts from the beginning, and in a part that is opened by its link", async () => {
    const page = await open(browser, report, { whole: false });
    const drawn = () => page.$$eval("[data-chart]", (all) => all.filter((it) => it.querySelector(".graph").checkVisibility()).map((it) => it.dataset.chart));
    const seen = ["components", "histogram", "joints", "rows"];
    assert.deepEqual((await drawn()).sort(), seen);
    assert.equal(await page.evaluate(() => scrollY), 0);
    await page.waitForSelector(".scene canvas[data-drawn]", { state: "attached" });
    await page.locator("nav a[href='#metrologist']").click();
    await page.waitForSelector("[data-chart=leverage] .graph");
    await page.waitForSelector("[data-chart=normal] .graph");
    assert.deepEqual(page.complaints, []);
    await page.close();
  });

  test("the cursor tells of the dot nearest to it, not of the row, and a click takes the arm there", async () => {
    const page = await open(browser, report);
    const chart = page.locator("[data-chart=rows]");
    await chart.scrollIntoViewIfNeeded();
    const { rows } = dataOf(out);
    const worst = rows.error_mm.indexOf(Math.max(...rows.error_mm));
    const box = await chart.locator(".graph").evaluate((it) => {
      const [{ left, top }, style] = [it.getBoundingClientRect(), getComputedStyle(it)];
      return { x: left + parseFloat(style.paddingLeft), y: top + parseFloat(style.paddingTop), width: parseFloat(style.width), height: parseFloat(style.height) };
    });
    // The axes of the dots, by the labels of their ticks.
    const place = (axis, share, value) =>
      chart.locator(`.graph ${axis} text:not(.title)`).evaluateAll(
        (all, [share, value]) => {
          const ticks = all.map((it) => [Number(it.textContent), parseFloat(it.getAttribute(share)) / 100]);
          const [[a, from], [b, to]] = [ticks[0], ticks.at(-1)];
          return from + ((to - from) * (value - a)) / (b - a);
        },
        [share, value],
      );
    const x = box.x + box.width * (await place(".x", "x", rows.number[worst]));
    const y = box.y + box.height * (await place(".y", "y", rows.error_mm[worst]));
    // A dozen pixels beside it, other rows are nearer by their number.
    await page.mouse.move(x + 12, y + 5);
    const told = await chart.locator(".readout").textContent();
    assert.ok(told.startsWith(`${rows.place[worst]}, `), `told of ${told}, expected ${rows.place[worst]}`);
    const mark = await chart.locator(".meant").boundingBox();
    assert.ok(Math.hypot(mark.x + mark.width / 2 - x, mark.y + mark.height / 2 - y) < 2, `marked at ${mark.x}, ${mark.y}`);
    await page.mouse.click(x, y);
    assert.ok((await page.locator(".panel .state").first().textContent()).startsWith(`${rows.place[worst]}, `));
    await page.mouse.move(x, box.y + box.height / 4);
    const away = await chart.locator(".readout").textContent();
    console.log(`near the worst: ${told}; between the dots: "${away}"`);
    await chart.locator("h3").hover();
    assert.equal(await chart.locator(".readout").textContent(), "", "the cursor is on no chart");
    await page.close();
  });

  test("the residual that is chosen is drawn over the joints, with its axis and its curve", async () => {
    const page = await open(browser, report);
    const chart = page.locator("[data-chart=joints]");
    const { rows, joints } = dataOf(out);
    const cell = chart.locator(".cell").nth(2);
    const dots = () => cell.locator(".dots").evaluateAll((all) => all.map((it) => it.getAttribute("d")).join());
    const spoken = () => cell.locator(".graph").getAttribute("aria-label");
    const before = [await dots(), await spoken()];
    await chart.getByRole("combobox").selectOption("position x");
    assert.match(await spoken(), /^Residual position x over joint3; the smoothed curve swings by [\d.]+ mm, with a standard deviation of [\d.]+ mm\.$/);
    assert.equal(await cell.locator(".graph .y:not([hidden])").count(), 1);
    const drawn = (await dots()).match(/M\d+ \d+h[01]/g).length;
    const believed = rows.sets.filter((it) => !(it & 2)).length;
    assert.ok(drawn > 0.95 * believed && drawn <= believed, `${drawn} dots of ${believed} rows`);
    // Along the vertical axis a dot is at its residual.
    const { low, high } = await cell.locator(".y:not([hidden])").evaluate((it) => ({ ...it.dataset }));
    const first = rows.sets.findIndex((it) => it === 4);
    const [, across, down] = (await cell.locator(".dots.s0").getAttribute("d")).match(/M(\d+) (\d+)h0/).map(Number);
    const view = await cell.locator(".graph > svg").evaluate((it) => [it.viewBox.baseVal.width, it.viewBox.baseVal.height]);
    assert.ok(Math.abs(down / view[1] - (high - rows.columns["0.0"][first]) / (high - low)) < 0.01);
    const reading = await cell.locator(".x").evaluate((it) => ({ ...it.dataset }));
    assert.ok(Math.abs(across / view[0] - (rows.values[joints[2].reading][first] - reading.low) / (reading.high - reading.low)) < 0.01);
    // A joint that moves no target has no dots for the part along its motion.
    const last = chart.locator(".cell").nth(5);
    assert.equal(await last.locator(".note").isVisible(), false);
    assert.ok((await last.locator(".dots.s0").getAttribute("d")).match(/M\d+ \d+h0/g).length > 20);
    await chart.getByRole("combobox").selectOption({ index: 0 });
    assert.ok(await last.locator(".note").isVisible());
    assert.equal(await spoken(), before[1]);
    assert.equal((await dots()).match(/h[01]/g).length, before[0].match(/h[01]/g).length);
    assert.deepEqual(page.complaints, []);
    await page.close();
  });
});

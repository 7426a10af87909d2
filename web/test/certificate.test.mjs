// The report as a certificate: decisions, statements about the session, folded advice, and paper.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { launch, open, skip } from "./browser.mjs";
import { ROOT, folder, poecal } from "./cases.mjs";

const ELBOW = join(ROOT, "examples/elbow");

let browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(() => browser?.close());

/** A calibration of the example with these words; results that do not keep a limit are written too. */
function certificate(name, ...words) {
  const out = join(folder, name);
  try {
    poecal("calibrate", join(ELBOW, "robot.urdf"), join(ELBOW, "points.csv"), ...words, "--out", out, "--quiet");
  } catch (error) {
    if (error.status !== 1) throw error;
  }
  return { page: join(out, "report.html"), file: JSON.parse(readFileSync(join(out, "calibration.json"), "utf8")) };
}

describe("certificate", { skip }, () => {
  for (const [decision, limit, words] of [
    ["pass", "10mm", /^\s*PASS: the limit is kept/],
    ["fail", "1um", /^\s*FAIL: the limit is exceeded/],
    ["not_shown", "p95:10mm", /^\s*NOT SHOWN/],
  ]) {
    test(`says first that a limit is ${decision}`, async () => {
      const { page: path, file } = certificate(decision, "--accept", limit);
      assert.equal(file.acceptance.decision, decision);
      const page = await open(browser, path);
      for (const width of [400, 1300]) {
        await page.setViewportSize({ width, height: 900 });
        assert.match(await page.textContent("#verdict-title"), words);
        const { y } = await page.locator(`.verdict.${decision}`).boundingBox();
        assert.ok(y < 300, `the answer begins ${y} px down at ${width} px`);
        assert.equal(await page.locator(".verdict").count(), 1, "one answer, in one colour");
        const scrollWidth = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(scrollWidth <= width, `the page is ${scrollWidth} px wide at ${width} px`);
      }
      await page.close();
    });
  }

  test("states what was recorded, and on paper has lines to sign", async () => {
    const record = { serial: "4711 <i>", operator: "A. Example", date: "2026-03-02", certificate: 'K "1"' };
    const words = Object.entries(record).flatMap(([key, text]) => ["--record", `${key}=${text}`]);
    const { page: path } = certificate("stated", "--accept", "1mm", ...words);
    const page = await open(browser, path);
    const shown = await page.$$eval(".record dd", (all) => all.map((it) => it.textContent));
    assert.deepEqual(new Set(shown), new Set(Object.values(record)));
    assert.equal(await page.isVisible(".attested"), false);
    await page.emulateMedia({ media: "print" });
    assert.ok(await page.isVisible(".attested .hands"));
    assert.match(await page.textContent(".attested"), /SHA-256.*points\.csv/s);
    const pdf = join(folder, "stated.pdf");
    await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: false });
    await page.close();
    assert.equal(readFileSync(pdf).subarray(0, 5).toString(), "%PDF-");
    try {
      const text = execFileSync("pdftotext", ["-layout", pdf, "-"], { encoding: "utf8" });
      const pages = text.split("\f").length - 1;
      assert.match(text, /Calibration of .* · K "1"/);
      assert.match(text, new RegExp(`\\b${pages} ?/ ?${pages}\\b`), "pages are numbered");
    } catch (error) {
      // Without the tool the text of the paper is not read.
      if (error.code !== "ENOENT") throw error;
    }
  });

  test("folds what is for whoever runs the program", async () => {
    const { page: path } = certificate("plain");
    const page = await open(browser, path);
    const told = await page.$$eval(".verdict, .doubts", (all) =>
      all.map((it) => {
        const copy = it.cloneNode(true);
        copy.querySelectorAll(".runs").forEach((runs) => runs.remove());
        return copy.textContent;
      }),
    );
    assert.ok(told.length > 0 && told.every((text) => !/(^|[\s(`])--[a-z]/.test(text)), told.join("\n"));
    await page.close();
  });
});

// The printed report, by its PDF: the certificate on one page, an annex of few pages, nothing cut, with and without WebGL.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch, open, skip } from "./browser.mjs";
import { ROOT, calibrate, folder, poecal } from "./cases.mjs";

/** Most pages of the annex. */
const MOST_ANNEX = 10;
/** Least margin of A4 on each side that stays white, mm, and dots to the inch of the pictures of pages. */
const MARGIN_MM = 12;
const DPI = 50;
/** Share of a page's height that is printed at least, on each page but the last, so that paper is not wasted. */
const FILLED = 0.35;

const noPaper = skip || (spawnSync("pdftotext", ["-v"]).error ? "found no pdftotext; install poppler-utils" : false);

const ELBOW = join(ROOT, "examples/elbow");
const SEVEN = join(ROOT, "crates/poecal-testing/data/urdf/seven_axis.urdf");
const IRB = join(process.env.POECAL_DATASETS ?? join(ROOT, "../shared/datasets"), "irb120_faro");

function sevenPoses() {
  const out = join(folder, "paper-seven");
  poecal("simulate", SEVEN, "--kind", "pose", "--count", "150", "--errors", "0.3deg,1mm", "--noise", "0.05mm,0.01deg", "--out", out, "--quiet");
  return calibrate("paper-seven-out", SEVEN, join(out, "measurements.csv"));
}

const stated = ["certificate=K 1", "customer=Line 4", "serial=4711", "instrument=AT960 772", "operator=A. Example", "date=2026-03-02"];
/** Real and simulated sessions. */
const SESSIONS = [
  ["points with limits", () => calibrate("paper-elbow", join(ELBOW, "robot.urdf"), join(ELBOW, "points.csv"), "--accept", "1mm", ...stated.flatMap((it) => ["--record", it]))],
  ["poses of seven axes", sevenPoses],
  existsSync(IRB)
    ? ["a real robot that sags", () => calibrate("paper-irb", join(IRB, "robot.urdf"), join(IRB, "points.csv"))]
    : ["more points", () => calibrate("paper-more", join(ELBOW, "robot.urdf"), join(ELBOW, "points.csv"), "--held-out", "0.5")],
];

/** The words of each page with their boxes, and its size, in points. */
function wordsOf(pdf) {
  const text = execFileSync("pdftotext", ["-bbox", pdf, "-"], { encoding: "utf8", maxBuffer: 1e8 });
  return text.split("<page ").slice(1).map((page) => {
    const [width, height] = page.match(/width="([\d.]+)" height="([\d.]+)"/).slice(1).map(Number);
    const words = [...page.matchAll(/<word xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" yMax="([-\d.]+)">(.*?)<\/word>/g)];
    return { width, height, words: words.map(([, left, top, right, bottom, word]) => ({ box: [left, top, right, bottom].map(Number), word })) };
  });
}

/** Each page as a picture in grey. */
function picturesOf(pdf, count) {
  return Array.from({ length: count }, (_, k) => {
    const bytes = execFileSync("pdftoppm", ["-r", String(DPI), "-gray", "-f", String(k + 1), "-l", String(k + 1), pdf], { maxBuffer: 1e8 });
    const [, width, height] = bytes.subarray(0, 40).toString("latin1").match(/^P5\s+(\d+)\s+(\d+)\s+255\s/).map(Number);
    return { width, height, dots: bytes.subarray(bytes.length - width * height) };
  });
}

/** Share of the dots of a part of a page that are not white. */
function ink({ width, height, dots }, [left, right], [top, bottom] = [0, 1]) {
  let dark = 0;
  let all = 0;
  for (let y = Math.floor(top * height); y < bottom * height; y++) {
    for (let x = Math.floor(left * width); x < right * width; x++) {
      all += 1;
      if (dots[y * width + x] < 230) dark += 1;
    }
  }
  return dark / all;
}

/** Lowest printed position of a page, from 0 to 1, without its foot. */
function reach({ width, height, dots }) {
  for (let y = Math.floor(0.94 * height); y > 0; y--) for (let x = 0; x < width; x++) if (dots[y * width + x] < 230) return y / height;
  return 0;
}

describe("paper", { skip: noPaper }, () => {
  let browser;
  let flat;
  before(async () => {
    browser = await launch();
    flat = await launch("--disable-3d-apis");
  });
  after(() => Promise.all([browser.close(), flat.close()]));

  for (const [name, make] of SESSIONS) {
    test(`${name}: the certificate on one page, and an annex of few`, async () => {
      const out = make();
      for (const [how, by] of [["with WebGL", browser], ["without WebGL", flat]]) {
        const page = await open(by, join(out, "report.html"), { colours: "dark", whole: false });
        if (by === browser) await page.waitForSelector(".scene canvas[data-drawn]", { state: "attached" });
        const pdf = join(folder, `${name}.pdf`);
        await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: true });
        await page.close();
        const pages = wordsOf(pdf);
        const text = pages.map((it) => it.words.map(({ word }) => word).join(" "));
        const at = (words) => text.flatMap((page, k) => (page.includes(words) ? [k] : []));
        assert.deepEqual(at("Where it is valid"), [0], "the certificate is the first page");
        assert.deepEqual(at("Calibrated by: name, date, signature"), [0], "and ends on it");
        assert.ok(text[1].includes("Calibration of") && text[1].includes("before, on rows held out: your model"), "the annex begins on the second page");
        assert.ok(pages.length - 1 <= MOST_ANNEX, `${pages.length - 1} pages of annex`);
        // A4, and every word inside of its margins, heads and feet in them.
        for (const [k, { width, height, words }] of pages.entries()) {
          assert.ok(Math.abs(width - 595.3) < 1 && Math.abs(height - 841.9) < 1, `page ${k + 1} has ${width} x ${height} points`);
          const edge = (MARGIN_MM / 25.4) * 72;
          const cut = words.filter(({ box: [left, top, right, bottom] }) => left < edge || right > width - edge || top < 0 || bottom > height);
          assert.deepEqual(cut, [], `page ${k + 1}`);
        }
        const pictures = picturesOf(pdf, pages.length);
        for (const [k, picture] of pictures.entries()) {
          const edge = MARGIN_MM / 210;
          assert.equal(ink(picture, [0, edge]) + ink(picture, [1 - edge, 1]), 0, `page ${k + 1} is printed on to its edge`);
        }
        const reaches = pictures.map(reach);
        reaches.slice(0, -1).forEach((it, k) => assert.ok(it > FILLED, `page ${k + 1} ends at ${it} of its height`));
        // The robot is on the second page, drawn by WebGL or as lines.
        assert.equal(text[1].includes("From the side"), how === "without WebGL", how);
        // The caption of the drawing is printed only with it.
        assert.equal(text[1].includes("nominal in grey, calibrated in colour"), how === "with WebGL", how);
        console.log(`${name}, ${how}: 1 + ${pages.length - 1} pages, printed to ${reaches.map((it) => `${Math.round(100 * it)} %`).join(", ")}`);
      }
    });
  }

  test("a visit, with all that it can say, on one page", async () => {
    // The session of poses of seven axes, from above.
    const out = join(folder, "paper-seven-out");
    const visit = join(folder, "paper-visit.html");
    const long = ["note", "tool", "place", "payload"].flatMap((key) => ["--record", `${key}=${"long words ".repeat(18)}`]);
    const said = [...stated.flatMap((it) => ["--record", it]), ...long];
    poecal("track", join(out, "calibration.json"), join(folder, "paper-seven/measurements.csv"), "--report", visit, "--history", "none", ...said);
    const page = await browser.newPage();
    await page.goto(pathToFileURL(visit).href);
    const pdf = join(folder, "visit.pdf");
    await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: true });
    await page.close();
    const pages = wordsOf(pdf);
    assert.equal(pages.length, 1);
    const text = pages[0].words.map(({ word }) => word).join(" ");
    for (const words of ["4711", "then now", "A. Example", "smallest visible shift", "To do", "Approved by: name, date, signature"]) assert.ok(text.includes(words), words);
    const [picture] = picturesOf(pdf, 1);
    assert.equal(ink(picture, [0, MARGIN_MM / 210]) + ink(picture, [1 - MARGIN_MM / 210, 1]), 0, "it is printed on to its edge");
    console.log(`a visit: printed to ${Math.round(100 * reach(picture))} %`);
  });
});

// Opens the pages of the documentation site in headless Chromium: nothing is loaded from elsewhere or complained of, pages fit narrow and
// wide windows, axe finds no serious fault, and search finds, also in a folder.
import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join, normalize, resolve } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch, skip } from "./browser.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const TARGET = process.env.CARGO_TARGET_DIR ?? resolve(import.meta.dirname, "../../target");
const SITE = join(TARGET, "site");
const KINDS = { ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".json": "application/json", ".svg": "image/svg+xml", ".png": "image/png" };
const WIDTHS = [400, 1300];

function skipped() {
  if (skip) return skip;
  return existsSync(join(SITE, "index.html")) ? false : `found no site in ${SITE}; build it: scripts/build-docs`;
}

/** Names of the site's own pages. */
function pages(folder = "") {
  return readdirSync(join(SITE, folder), { withFileTypes: true }).flatMap((entry) => {
    const name = join(folder, entry.name);
    // The page that calibrates has tests of its own.
    if (entry.isDirectory()) return ["rust", "assets", "app"].includes(name) ? [] : pages(name);
    return entry.name.endsWith(".html") ? [name] : [];
  });
}

function serve() {
  const server = createServer((request, response) => {
    const path = join(SITE, normalize(decodeURIComponent(new URL(request.url, "http://site").pathname)));
    if (!existsSync(path)) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": KINDS[extname(path)] ?? "application/octet-stream" }).end(readFileSync(path));
  });
  return new Promise((ready) => server.listen(0, "127.0.0.1", () => ready(server)));
}

describe("documentation site", { skip: skipped() }, () => {
  let browser, server, served;
  before(async () => {
    [browser, server] = [await launch(), await serve()];
    served = `http://127.0.0.1:${server.address().port}/`;
  });
  after(async () => {
    await browser?.close();
    server?.close();
  });

  async function open(name, width, colours, address = served) {
    const page = await browser.newPage({ viewport: { width, height: 900 }, colorScheme: colours });
    page.complaints = [];
    page.on("console", (message) => message.type() === "error" && page.complaints.push(message.text()));
    page.on("pageerror", (error) => page.complaints.push(error.message));
    page.on("request", (request) => {
      if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(address)) page.complaints.push(`request: ${request.url()}`);
    });
    await page.goto(address + name);
    return page;
  }

  for (const [k, name] of (skipped() ? [] : pages()).entries()) {
    test(name, async () => {
      const page = await open(name, WIDTHS[0], k % 2 ? "dark" : "light");
      for (const width of WIDTHS) {
        await page.setViewportSize({ width, height: 900 });
        // Sidebars take a moment to disappear.
        const fits = () => document.documentElement.scrollWidth <= document.documentElement.clientWidth;
        await page.waitForFunction(fits, null, { timeout: 10_000 }).catch(() => assert.fail(`wider than ${width} px`));
      }
      await page.evaluate(AXE);
      // Browsers let the keyboard reach elements that scroll; axe requires an attribute, with which every wide formula would be a stop.
      const rules = { "scrollable-region-focusable": { enabled: false } };
      // Colours change at once, and not during the test.
      await page.addStyleTag({ content: "* { transition: none !important; animation: none !important; }" });
      for (const colours of ["default", "slate"]) {
        await page.evaluate((colours) => (document.body.dataset.mdColorScheme = colours), colours);
        const { violations } = await page.evaluate((rules) => window.axe.run("article", { resultTypes: ["violations"], rules }), rules);
        const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
        assert.deepEqual(serious.map(({ id, nodes }) => `${colours}: ${id}: ${nodes[0].html}`), []);
      }
      assert.deepEqual(page.complaints, []);
      await page.close();
    });
  }

  for (const [place, start] of [["a server", () => served], ["a folder", () => `${pathToFileURL(SITE).href}/`]]) {
    for (const name of ["index.html", "lou2009/report.html"]) {
      test(`search finds the reflector from ${name} of ${place}`, async () => {
        const page = await open(name, 1300, "light", start());
        await page.locator(".md-search__input").click();
        await page.locator(".md-search__input").pressSequentially("reflector");
        await page.locator(".md-search-result__list").filter({ hasText: /laser tracker/i }).waitFor();
        assert.deepEqual(page.complaints, []);
        await page.close();
      });
    }
  }

  // Typical first questions in people's words: the first result is the page that answers it, and shows the heading.
  for (const question of ["How many poses do I need", "what accuracy can I expect", "my tracker is not level", "how do I get the numbers into a KUKA"]) {
    test(`search answers: ${question}`, async () => {
      const page = await open("index.html", 1300, "light", served);
      await page.locator(".md-search__input").click();
      await page.locator(".md-search__input").pressSequentially(question);
      // Results change with every letter, so the test waits for those of the whole question.
      const first = page.locator(".md-search-result__item").first();
      const shown = async () => (await first.innerText()).split("\n").slice(0, 3).join(" | ");
      await first.filter({ hasText: question }).waitFor().catch(async () => assert.fail(`the first result is: ${await shown()}`));
      console.log(`# ${question}: ${await shown()}`);
      await page.close();
    });
  }
});

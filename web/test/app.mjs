// The page that calibrates: its address, files dropped on it, and its contents afterwards.
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { skip } from "./browser.mjs";
import { ROOT } from "./cases.mjs";

const PAGE = process.env.POECAL_APP ?? join(ROOT, "web/app/dist/poecal.html");

/** Reason why tests of the page are left out; false if they are not. */
export const skipped = skip || (existsSync(PAGE) ? false : `found no page at ${PAGE}; build it: node web/app/build.mjs`);

/** A module with the exports of the program, whose every run is a trap. */
function trapping() {
  const section = (id, ...bytes) => [id, bytes.length, ...bytes];
  const named = (name, kind, index) => [name.length, ...Buffer.from(name), kind, index];
  return Uint8Array.from([
    0, 0x61, 0x73, 0x6d, 1, 0, 0, 0,
    ...section(1, 4, 0x60, 1, 0x7f, 1, 0x7f, 0x60, 2, 0x7f, 0x7f, 0, 0x60, 2, 0x7f, 0x7f, 1, 0x7f, 0x60, 0, 1, 0x7f),
    ...section(3, 4, 0, 1, 2, 3),
    ...section(5, 1, 0, 1),
    ...section(7, 5, ...named("memory", 2, 0), ...named("allocate", 0, 0), ...named("release", 0, 1), ...named("run", 0, 2), ...named("last_words", 0, 3)),
    // allocate returns 1024, run is `unreachable`, and there is no message of the trap.
    ...section(10, 4, 5, 0, 0x41, 0x80, 8, 0x0b, 2, 0, 0x0b, 3, 0, 0, 0x0b, 4, 0, 0x41, 0, 0x0b),
  ]);
}

/** The page with another module. */
function around(module) {
  return readFileSync(PAGE, "utf8").replace(/(<script type="text\/plain" id="engine">)[^<]*/, (_, tag) => tag + gzipSync(module).toString("base64"));
}

/** Serves the page, and the same with a module that traps and with one that is invalid; everything else is 404. */
export function serve() {
  const pages = { "/poecal.html": () => readFileSync(PAGE), "/traps.html": () => around(trapping()), "/none.html": () => around(Buffer.from("none")) };
  const server = createServer((request, response) => {
    if (!pages[request.url]) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": "text/html" }).end(pages[request.url]());
  });
  return new Promise((ready) => server.listen(0, "127.0.0.1", () => ready(server)));
}

/** Address of the page as a file. */
export const FILE = pathToFileURL(PAGE).href;

/** Opens the page; `page.complaints` are errors on the console, broken rules of its policy, and requests for anything but the page. */
export async function open(browser, { address = FILE, width = 1300, colours = "light" } = {}) {
  const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme: colours, acceptDownloads: true });
  const page = await context.newPage();
  page.complaints = [];
  await page.exposeFunction("complain", (text) => page.complaints.push(text));
  await page.addInitScript(() => {
    addEventListener("securitypolicyviolation", (event) => globalThis.complain?.(`policy: ${event.violatedDirective} ${event.blockedURI}`));
  });
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) page.complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => page.complaints.push(`error: ${error.message}`));
  context.on("request", (request) => {
    if (request.url() !== address && !request.url().startsWith("blob:")) page.complaints.push(`request: ${request.url().slice(0, 100)}`);
  });
  await page.goto(address);
  await page.waitForSelector(":root[data-ready]", { state: "attached" });
  return page;
}

/** Drops files, pairs of a name and a text or bytes, on the page. */
export async function drop(page, files) {
  const given = Object.entries(files).map(([name, content]) => [name, Buffer.from(content).toString("base64")]);
  const transfer = await page.evaluateHandle((given) => {
    const transfer = new DataTransfer();
    for (const [name, content] of given) transfer.items.add(new File([Uint8Array.from(atob(content), (it) => it.charCodeAt(0))], name));
    return transfer;
  }, given);
  for (const type of ["dragenter", "dragover", "drop"]) await page.dispatchEvent("main", type, { dataTransfer: transfer });
}

/** Drops files and folders of the machine on the page, or on the middle of an element, as a user does. */
export async function dropPaths(page, paths, selector) {
  let [x, y] = [200, 200];
  if (selector) {
    await page.locator(selector).scrollIntoViewIfNeeded();
    const box = await page.locator(selector).boundingBox();
    const { height } = page.viewportSize();
    [x, y] = [box.x + box.width / 2, (Math.max(box.y, 0) + Math.min(box.y + box.height, height)) / 2];
  }
  const session = await page.context().newCDPSession(page);
  for (const type of ["dragEnter", "dragOver", "drop"]) {
    await session.send("Input.dispatchDragEvent", { type, x, y, data: { items: [], files: paths, dragOperationsMask: 1 } });
  }
  await session.detach();
}

/** Waits until nothing runs and the status matches. */
export async function status(page, pattern, timeout = 60_000) {
  const is = ({ source }) => !document.documentElement.hasAttribute("data-busy") && new RegExp(source).test(document.getElementById("status").textContent);
  const place = page.locator("#status");
  await page.waitForFunction(is, { source: pattern.source }, { timeout }).catch(async () => {
    throw new Error(`the status is \`${await place.innerText()}\` after ${timeout / 1000} s, expected ${pattern}`);
  });
  return place.innerText();
}

/** The messages that are shown: kind and text, and the quoted line. */
export function messages(page) {
  return page.$$eval("#messages .message", (all) =>
    all.map((it) => ({
      kind: it.classList[1],
      text: it.querySelector("p").textContent.replace(/^[✕△·]/, ""),
      quoted: it.querySelector("pre")?.textContent,
    })),
  );
}

/** Resets the page to no files. */
export async function clear(page) {
  for (;;) {
    // The list is rebuilt if files are interpreted differently.
    const buttons = page.locator("#list .remove");
    const count = await buttons.count();
    if (!count) return;
    await buttons.first().click();
    await page.waitForFunction((count) => document.querySelectorAll("#list .remove").length < count, count);
  }
}

/** Saves the file of a link, and returns its bytes. */
export async function saved(page, link) {
  const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
  return readFileSync(await download.path());
}

// Headless Chromium, and pages in it that report every request and every complaint.
import { existsSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const NAMES = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome", "/usr/bin/google-chrome-stable"];
/** The browser's program; undefined if there is none. */
const CHROMIUM = process.env.CHROMIUM ?? NAMES.find((name) => existsSync(name));
/** Reason why tests in a browser are left out; false if they are not. */
export const skip = CHROMIUM ? false : "found no Chromium; install it (Debian: apt install chromium), or name it: CHROMIUM=/path";

// WebGL by the processor, so that it is available on any machine, and canvases without it, which is faster then.
const ARGUMENTS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
  "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-accelerated-2d-canvas",
];

export async function launch(...more) {
  return chromium.launch({ executablePath: CHROMIUM, args: [...ARGUMENTS, ...more] });
}

/**
 * Opens a report; `page.complaints` are errors on the console, and requests for anything but the report itself. `whole` states whether all of it is
 * viewed, from top to bottom; `page.processorTime()` returns the seconds that its main thread worked, independent of the machine's other work.
 */
export async function open(browser, path, { width = 1300, colours = "light", whole = true } = {}) {
  const page = await browser.newPage({ viewport: { width, height: 900 }, colorScheme: colours });
  const address = pathToFileURL(path).href;
  page.complaints = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) page.complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => page.complaints.push(`error: ${error.message}`));
  page.on("request", (request) => {
    if (request.url() !== address) page.complaints.push(`request: ${request.url().slice(0, 100)}`);
  });
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  page.processorTime = async () => {
    const { metrics } = await session.send("Performance.getMetrics");
    return metrics.find((metric) => metric.name === "TaskDuration").value;
  };
  await page.goto(address);
  await page.waitForSelector(":root[data-ready]", { state: "attached" });
  // The arm is drawn after the text.
  if (whole) {
    await page.$$eval("#metrologist", (all) => all.forEach((it) => (it.open = true)));
    await page.waitForSelector("#arm > *", { state: "attached" });
    await page.evaluate(() => scrollTo(0, 0));
  }
  if (whole) await page.waitForSelector(".scene canvas[data-drawn]", { state: "attached" });
  return page;
}

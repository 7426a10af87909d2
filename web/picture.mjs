// Takes the README's picture of a report: node web/picture.mjs REPORT.html PICTURE.png
import { launch, open } from "./test/browser.mjs";

const [report, picture] = process.argv.slice(2);
const browser = await launch();
const page = await open(browser, report);
await page.setViewportSize({ width: 1100, height: 760 });
await page.screenshot({ path: picture });
await browser.close();

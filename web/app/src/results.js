// What a run wrote: the report, the files to download, and the forms for controllers, drivers and simulators.
import { byId, element, size } from "./dom.js";
import { onColours, themeOf } from "../../src/theme.js";
import { zip } from "./zip.js";

const KINDS = { html: "text/html", json: "application/json", csv: "text/csv", urdf: "application/xml" };
const addresses = new Map();

/** The address of a file's bytes in this page; the earlier one of the same name is given back. */
function addressOf(name, content) {
  if (addresses.has(name)) URL.revokeObjectURL(addresses.get(name));
  const kind = KINDS[name.split(".").at(-1)] ?? "application/octet-stream";
  addresses.set(name, URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type: kind })));
  return addresses.get(name);
}

const last = (path) => path.split("/").at(-1);

/** A link that saves a file. */
export function download(path, content) {
  const name = last(path);
  return element("li", {}, element("a", { href: addressOf(name, content), download: name, textContent: name }), " ", element("small", { textContent: size(content.size ?? content.length) }));
}

/** The files in the order of their use. */
const ORDER = ["calibrated.urdf", "calibration.json", "report.html", "residuals.csv"];
const place = (path) => (ORDER.includes(last(path)) ? ORDER.indexOf(last(path)) : ORDER.length);

/** The report has the colours of the page, whose switch is the only one. */
function follow(report) {
  const own = report.querySelector(".theme");
  if (!own) return;
  own.hidden = true;
  const take = () => [...own.querySelectorAll("button")].find((it) => it.textContent === themeOf())?.click();
  take();
  followed = take;
}

let followed;
onColours(() => followed?.());

/** The report in a frame. Its links to its own sections would lead to those of this page; what is dropped on it is dropped on this page. */
function frame(text) {
  const made = element("iframe", { title: "Report of the calibration", srcdoc: text });
  made.addEventListener("load", () => {
    const report = made.contentDocument;
    follow(report);
    for (const type of ["dragenter", "dragleave", "dragover", "drop"]) {
      report.addEventListener(type, (event) => {
        event.preventDefault();
        made.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer: event.dataTransfer }));
      });
    }
    report.addEventListener("click", (event) => {
      const link = event.target.closest?.('a[href^="#"]');
      if (!link) return;
      event.preventDefault();
      const target = report.getElementById(decodeURIComponent(link.hash.slice(1)));
      target?.scrollIntoView();
      target?.setAttribute("tabindex", "-1");
      target?.focus({ preventScroll: true });
    });
  });
  return made;
}

/** Shows what `poecal calibrate` wrote: pairs of path and bytes. */
export function showCalibration(files) {
  const sorted = [...files].sort((a, b) => place(a[0]) - place(b[0]));
  const report = sorted.find(([path]) => path.endsWith(".html"));
  byId("downloads").replaceChildren(...sorted.map(([path, bytes]) => download(path, bytes)), download("poecal.zip", zip(sorted.map(([path, bytes]) => [last(path), bytes]))));
  byId("exported").replaceChildren();
  byId("export-messages").replaceChildren();
  byId("exports").hidden = false;
  byId("saved").hidden = false;
  byId("whole").hidden = !report;
  byId("report").hidden = !report;
  if (report) {
    byId("whole").href = addresses.get(last(report[0]));
    byId("report").replaceChildren(frame(new TextDecoder().decode(report[1])));
  }
  byId("result").hidden = false;
}

/** Shows a text alone, as the program prints it. */
export function showText(title, text) {
  byId("exports").hidden = true;
  byId("saved").hidden = true;
  byId("whole").hidden = true;
  byId("report").hidden = true;
  showPrinted(title, text, true);
  byId("result").hidden = false;
}

/** What the program printed, folded or not. */
export function showPrinted(title, text, open = false) {
  byId("printed").hidden = !text;
  byId("printed").open = open;
  byId("printed-title").textContent = title;
  byId("printed-text").textContent = text;
}

/** Takes away what an earlier run showed. */
export function clearResult() {
  byId("result").hidden = true;
  byId("report").replaceChildren();
  followed = undefined;
}

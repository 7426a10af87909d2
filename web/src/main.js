// Additions of the script: the arm in three dimensions, a readout under the cursor in charts, and the choice of colours. All text and every chart are
// on the page without it.
import { showArm } from "./arm.js";
import { followChart } from "./charts.js";
import { readData } from "./data.js";
import { followSections, whenIdle } from "./sight.js";
import { themeSwitch } from "./theme.js";

let read;
let choose;
const data = () => (read ??= readData());
themeSwitch(document.querySelector(".theme"));
// The text is shown at once.
whenIdle(() => (choose = showArm(document.getElementById("arm"), data())));
for (const figure of document.querySelectorAll("[data-chart]")) followChart(figure, data, (row) => choose?.(row));
followSections(document.querySelector("nav"));
document.documentElement.dataset.ready = "true";

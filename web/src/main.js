// What the page adds where scripts run: charts of the rows, the arm in three dimensions, and the choice of colours. All text is there
// without it.
import { showArm } from "./arm.js";
import { drawChart } from "./charts.js";
import { readData } from "./data.js";
import { drawAhead, followSections, whenNear } from "./sight.js";
import { themeSwitch } from "./theme.js";

let read;
const data = () => (read ??= readData());
themeSwitch(document.querySelector(".theme"));
// What is far below is drawn later, so that the first screen is there at once.
whenNear(document.getElementById("arm"), (place) => showArm(place, data()));
for (const figure of document.querySelectorAll("[data-chart]")) whenNear(figure, () => drawChart(figure, data()));
followSections(document.querySelector("nav"));
document.documentElement.dataset.ready = "true";
drawAhead();

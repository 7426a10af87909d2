// What the page adds where scripts run: charts of the rows, the arm in three dimensions, and the choice of colours. All text is there
// without it.
import { showArm } from "./arm.js";
import { drawCharts } from "./charts.js";
import { readData } from "./data.js";
import { themeSwitch } from "./theme.js";

const data = readData();
themeSwitch(document.querySelector(".theme"));
drawCharts(data);
showArm(document.getElementById("arm"), data);
document.documentElement.dataset.ready = "true";

// The calibration in the forms of `poecal export`.
import { wordsOf } from "./command.js";
import { byId, element } from "./dom.js";
import { download } from "./results.js";

/** The forms, and how the files are called. */
const FORMS = {
  toml: ["poecal's table of screws", "toml"],
  poe: ["screws of a product of exponentials", "json"],
  dh: ["Denavit and Hartenberg's table", "json"],
  mdh: ["Craig's table", "json"],
  hayati: ["Denavit and Hartenberg's, with Hayati's rows", "json"],
  origins: ["origins of the joints, for xacro", "yaml"],
  ur: ["Universal Robots' driver", "yaml"],
  xarm: ["uFactory's description", "yaml"],
  franka: ["Franka's description", "yaml"],
  pal: ["PAL Robotics' master calibration", "yaml"],
  lerobot: ["LeRobot's calibration of motors", "json"],
  mjcf: ["MuJoCo's model", "xml"],
  sdf: ["Gazebo's model", "sdf"],
  usd: ["USD physics", "usda"],
  csv: ["origins of the joints, a row each", "csv"],
  offsets: ["joint offsets that come nearest", "json"],
  tf: ["what was located, as transforms", "txt"],
  c: ["arrays of C for a controller", "h"],
  urdf: ["the URDF again, of the model below", "urdf"],
};

/** Lets forms be written: `run` runs words on the calibration's bytes and shows messages, and gives the files, or none. */
export function offerExports(run) {
  const form = byId("form");
  form.append(...Object.entries(FORMS).map(([value, [text]]) => element("option", { value, textContent: `${value}: ${text}` })));
  byId("export").addEventListener("click", async () => {
    const name = `${form.value === "csv" ? "origins" : `calibrated-${form.value}`}.${FORMS[form.value][1]}`;
    const words = ["export", "calibration.json", "--format", form.value, "--model", byId("of").value, "--out", name, ...wordsOf(byId("export-options").value)];
    const files = await run(words);
    if (!files) return;
    const made = files.map(([path, bytes]) => download(path, bytes));
    const names = made.map((it) => it.querySelector("a").download);
    for (const earlier of [...byId("exported").children]) if (names.includes(earlier.querySelector("a").download)) earlier.remove();
    byId("exported").append(...made);
  });
}

// What a user of the types may write, and may not: checked by tsc, never run.
import { load, PoecalError, type CalibrationFile, type Level } from "./index.js";

const poecal = await load();
const result = poecal.calibrate({ model: "<robot/>", measurements: { "a.csv": new Uint8Array() }, options: { heldOut: 0.3, fix: ["joint1", "joint2"], deviceFrame: "base", strict: true } });
const file: CalibrationFile = result.json;
const level: Level | undefined = result.verdict?.level;
const rms: number | undefined = file.accuracy.held_out?.calibrated.position_mm?.rms;
const axis: number = file.joints[0].name.length;
const bytes: Uint8Array = poecal.run(["--version"]).files["a"];
const csv: string = poecal.predict({ model: result.jsonText, joints: "", options: { outputFrame: "device", withUncertainty: true } });
const text: string = poecal.simulate({ model: "", options: { kind: "pose", count: 60 } })["measurements.csv"];
const place: number | undefined = new PoecalError("", { line: 3 }).line;

// @ts-expect-error no such frame
poecal.calibrate({ model: "", measurements: "", options: { deviceFrame: "tool" } });
// @ts-expect-error no such option
poecal.calibrate({ model: "", measurements: "", options: { heldout: 0.3 } });
// @ts-expect-error measurements are missing
poecal.calibrate({ model: "" });
// @ts-expect-error no such key of calibration.json
result.json.acuracy;
// @ts-expect-error no such level
const wrong: Level = "perfect";

export { axis, bytes, csv, level, place, rms, text, wrong };

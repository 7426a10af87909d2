// Parts of the page that calibrates which need no browser: words of a command line, roles of files, positions in messages, archives.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import { calibrateWords, checkWords, shown, validateWords, wordsOf } from "../app/src/command.js";
import { distinct } from "../app/src/intake.js";
import { besideUrdf, bySettings, guess } from "../app/src/roles.js";
import { foreign, messages, placeOf, verdictOf } from "../app/src/sentences.js";
import { crc32 } from "../app/src/zip.js";

const file = (name, text = "", role = guess(name, new TextEncoder().encode(text))) => ({ name, bytes: new TextEncoder().encode(text), role });

test("words are those of a shell, and are shown so that it takes them apart again", () => {
  const lines = ["--seed 2", "--train-where 'day=first one'", '--record "customer=A \\"B\\" C"', "a\\ b  c", "'it'\"'\"'s'", "", "--free 'joint2.*'"];
  for (const line of lines) {
    const bySh = execFileSync("bash", ["-c", `for word in ${line}; do printf '%s\\n' "$word"; done`], { encoding: "utf8" }).split("\n").slice(0, -1);
    assert.deepEqual(wordsOf(line), bySh, line);
    assert.deepEqual(wordsOf(shown(bySh)).slice(1), bySh, line);
  }
});

test("each command gets the options that it takes", () => {
  const files = [file("robot.urdf", "<robot/>"), file("a.csv", "x"), file("b.csv", "x", "validate"), file("map.toml", "[position]"), file("calibration/old.csv", "x", "unused")];
  const options = ["--device-frame", "base", "--seed", "2", "--device-frames=per-file", "--accept", "0.2mm", "--accept-model", "calibrated"];
  assert.equal(calibrateWords(files, options).join(" "), "calibrate robot.urdf a.csv --columns map.toml --validate b.csv --device-frame base --seed 2 --device-frames=per-file --accept 0.2mm --accept-model calibrated --out calibration-2");
  assert.equal(checkWords(files, options).join(" "), "check robot.urdf a.csv b.csv --columns map.toml --device-frame base --device-frames=per-file");
  const withSettings = [...files, file("cell/poecal.toml", "poecal_settings = 1", "settings")];
  assert.equal(checkWords(withSettings, []).join(" "), "check robot.urdf a.csv b.csv --settings cell/poecal.toml --columns map.toml");
  // Tables that settings name may still be missing.
  assert.equal(checkWords(withSettings.filter((it) => it.role === "model" || it.role === "settings"), []).join(" "), "check robot.urdf");
  assert.equal(validateWords(files, options).join(" "), "validate robot.urdf a.csv b.csv --columns map.toml --device-frames=per-file --accept 0.2mm --accept-model calibrated");
});

test("files have the roles that their names and first lines say", () => {
  const cases = [
    ["r.urdf", "<robot/>", "model"], ["r.txt", "<robot/>", "model"], ["r.toml", "# a\npoecal_robot = 1\n", "model"], ["s.toml", "poecal_settings = 1", "settings"],
    ["map.toml", "[joints]", "columns"], ["calibration.json", "{}", "model"], ["default.yaml", "kinematics:", "model"], ["p.csv", "a,b", "measurements"],
    ["p.TXT", "a b", "measurements"], ["noname", "a b", "measurements"], ["bom.csv", "\uFEFF<robot/>", "model"],
    ["theta.xlsx", "PK", "measurements"], ["take_6D.tsv", "NO_OF_FRAMES", "measurements"], ["calib.mod", "MODULE", "measurements"], ["session.mcap", "", "measurements"],
  ];
  for (const [name, text, role] of cases) assert.equal(file(name, text).role, role, name);
  for (const name of ["README.md", "arm.stl", "report.html", "run.log"]) assert.equal(file(name, "<html>").role, "unused", name);
  for (const name of ["manual.pdf", "README.md", "arm.stl", "joints.csv", "out/residuals.csv", "out/.hidden"]) assert.equal(guess(name, new Uint8Array(), true), "unused", name);
  const models = [file("r.toml", "poecal_robot = 1"), file("r.urdf", "<robot/>")];
  assert.deepEqual(besideUrdf(models), [models[0]]);
});

test("files of one drop have a name each", () => {
  const names = ["a.csv", "b/a.csv", "a.csv", "-a.csv", "_a.csv", "a.csv", "noend", "noend"];
  assert.deepEqual(distinct(names.map((path) => ({ path }))).map((it) => it.name), ["a.csv", "b/a.csv", "a-2.csv", "_a.csv", "_a-2.csv", "a-3.csv", "noend", "noend-2"]);
});

test("settings in a folder name files beside them", () => {
  const settings = file("cell/poecal.toml", "poecal_settings = 1\nmodel = 'robot.urdf'\nmeasurements = [\n  \"./a.csv\", # the first\n  \"b.csv\",\n]\nvalidate = [\"c.csv\"]\n");
  const files = [settings, file("cell/robot.urdf", "<robot/>"), file("other.urdf", "<robot/>"), ...["a", "b", "c", "d"].map((name) => file(`cell/${name}.csv`, "x"))];
  const roles = Object.fromEntries([...bySettings(settings, files)].map(([it, role]) => [it.name, role]));
  assert.deepEqual(roles, {
    "cell/robot.urdf": "model", "other.urdf": "unused", "cell/a.csv": "measurements", "cell/b.csv": "measurements", "cell/c.csv": "validate", "cell/d.csv": "unused",
  });
});

test("messages have their kinds, and places their lines", () => {
  const err = "warning: a.csv:2: odd\nerror: unexpected argument '--foo' found\n\n  tip: other\n\nUsage: poecal\n\nFor more information, try '--help'.\n";
  assert.deepEqual(messages(err), [{ kind: "warning", text: "a.csv:2: odd" }, { kind: "error", text: "unexpected argument '--foo' found tip: other" }]);
  const files = [file("a.csv", "first\r\nsécond,line\r\n"), file("long.csv", `${"1,".repeat(500)}x`)];
  const { line, column, shown: text, before } = placeOf("a.csv:2:8: odd", files);
  assert.deepEqual([line, column, text, before], [2, 8, "sécond,line", 7]);
  const long = placeOf("long.csv:1:1001: odd", files);
  assert.equal([...long.shown][long.before], "x");
  assert.ok(long.shown.length < 130 && long.shown.startsWith("…"));
  for (const text of ["a.csv: none", "b.csv:2: none", "a.csv:9: beyond"]) assert.equal(placeOf(text, files), undefined, text);
});

test("a file is foreign where the program says the same of it as a model and as measurements", () => {
  const said = (what, expected) => `error: r.x: found ${what}, expected ${expected}\n`;
  const [model, table] = ["a robot model (URDF)", "a measurement file (CSV)"];
  assert.equal(foreign("r.x", said("a PDF", model), said("a PDF", table)), "r.x: found a PDF, expected a robot model (URDF)");
  assert.equal(foreign("r.x", said("a workbook", model), "error: r.x: sheet `a`, row 1: found no column\n"), undefined);
  assert.equal(foreign("r+x", said("a PDF", model), said("a PDF", table)), undefined);
});

test("the verdict is in the program's words", () => {
  assert.equal(verdictOf("verdict       do not use: mirroring the positions\nbefore 1\n"), "do not use");
  assert.equal(verdictOf("before   1\nverdict       use inside the sampled range\n"), "use inside the sampled range");
  assert.equal(verdictOf("{}"), undefined);
});

test("the checksum is that of ZIP", () => {
  // The check value of CRC-32/ISO-HDLC in the catalogue of CRC algorithms.
  assert.equal(crc32(new TextEncoder().encode("123456789")), 0xcbf43926);
});

// Wrong inputs of the page that calibrates: dropped files, typed options, and the required content of its one sentence. If `place` is stated, that
// line is quoted.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { ROOT } from "./cases.mjs";

const MODEL = readFileSync(join(ROOT, "examples/elbow/robot.urdf"), "utf8");
const POINTS = readFileSync(join(ROOT, "examples/elbow/points.csv"), "utf8");
const LINES = POINTS.split("\n");

const table = (text) => ({ "robot.urdf": MODEL, "points.csv": text });
const model = (text) => ({ "robot.urdf": text, "points.csv": POINTS });
const cell = (text) => table(POINTS.replace("-143.98048", text));
const settings = (text) => ({ "robot.urdf": MODEL, "points.csv": POINTS, "poecal.toml": text });
const latin1 = (text) => Buffer.from(text, "latin1");

export const WRONG = [
  ["an empty table", table(""), /^points\.csv: found no line with text/],
  ["a PDF", table("%PDF-1.7\n1 0 obj\n<</Type/Catalog>>\nendobj\n"), /^points\.csv: found a PDF, expected/],
  ["a workbook", table(latin1("PK\x03\x04\x14\x00\x06\x00\x08\x00")), /\.xlsx/],
  ["a compressed table", table(latin1("\x1f\x8b\x08\x00\x00\x00\x00\x00")), /gzip/],
  ["a text without numbers", table("hello\nworld\n"), /^points\.csv:1: found no column `joint1`/, "1"],
  ["a header alone", table(`${LINES[1]}\n`), /found a header and no rows/, "1"],
  ["a column that no joint has", table(POINTS.replace("joint4[deg]", "axis4[deg]")), /found no column `joint4`/, "2"],
  ["NaN", cell("NaN"), /^points\.csv:3:64: found `NaN` in column `y`/, "3"],
  ["a word for a number", cell("n/a"), /found `n\/a` in column `y`/, "3"],
  ["a decimal comma among points", cell('"-143,98048"'), /expected a number with a decimal point/, "3"],
  ["a number beyond all", cell("1e300"), /expected at most 1e6 m/, "3"],
  ["a cut line", table([...LINES.slice(0, 40), LINES[40].slice(0, 30)].join("\n")), /^points\.csv:41:31: found 4 cells, expected 9/, "41"],
  ["a column twice", table(POINTS.replace("y[mm]", "x[mm]")), /found a second column `x`/, "2"],
  ["UTF-16 that is cut", table(Buffer.from(`\uFEFF${POINTS}`, "utf16le").subarray(0, -1)), /found an odd number of bytes, expected UTF-16/],
  ["bytes that are no letters", table(latin1(POINTS.replace("joint1[deg]", "joint1[\x81]"))), /found the byte 0x81, expected text/, "2"],
  ["an unknown unit", table(POINTS.replaceAll("[mm]", "[furlong]")), /found the unit `furlong`/, "2"],
  ["another unit than stated", table(POINTS.replaceAll("[mm]", "[m]")), /expected another unit, most likely mm/],
  ["a line of 17 MiB", table(`${LINES[1]}\n${"1".repeat(17 << 20)}`), /longer than 16 MiB/, "2"],
  ["a standard deviation below zero", table(LINES.slice(1).filter(Boolean).map((line, k) => line + (k ? ",-0.1" : ",sigma_position")).join("\n")), /expected a standard deviation above 0/, "2"],
  ["beams that are all lost", table(LINES.slice(1).filter(Boolean).map((line, k) => (k ? `${line.split(",").slice(0, 6)},0,0,0` : line)).join("\n")), /found no position in any row/],
  ["too few rows", table(LINES.slice(0, 6).join("\n")), /measure more configurations/],
  ["broken XML", model(MODEL.slice(0, 900)), /^robot\.urdf:1:1: found broken XML/, "1"],
  ["macros", model(MODEL.replace('name="elbow">', 'name="elbow" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="a"/>')), /^robot\.urdf:3:\d+: found a xacro element beside joints/, "3"],
  ["an expression for a number", model(MODEL.replace('xyz="0 0 1"', 'xyz="0 0 ${one}"')), /found `\$\{one\}`/, "16"],
  ["a web page as a model", model("<!DOCTYPE html><html></html>"), /document type definition/, "1"],
  ["a robot without joints", model('<robot name="x"><link name="a"/></robot>'), /^robot\.urdf: found no end link/],
  ["two models", { "a.urdf": MODEL, "b.urdf": MODEL, "points.csv": POINTS }, /^found 2 robot models, a\.urdf and b\.urdf, expected one/],
  ["two mappings", { ...table(POINTS), "a.toml": "", "b.toml": "" }, /^found a\.toml and b\.toml as mapping of columns, expected one/],
  ["a mapping with an unknown key", { ...table(POINTS), "map.toml": "colour = 1\n" }, /^map\.toml:1/, "1"],
  ["settings with an unknown key", settings("poecal_settings = 1\ncolour = 1\n"), /^poecal\.toml:2/, "2"],
  ["settings that are no TOML", settings("poecal_settings = 1\nframe = \n"), /^poecal\.toml:2/, "2"],
  ["an unknown option", table(POINTS), /^unexpected argument '--colour'/, undefined, "--colour red"],
  ["a unit that is none", table(POINTS), /^--tolerance: found the unit `parsec`/, undefined, "--tolerance 3parsec"],
  ["a share above one", table(POINTS), /^--held-out: found `1\.5`/, undefined, "--held-out 1.5"],
  ["a link that is not there", table(POINTS), /found no (link|chain)|`elbow9`/, undefined, "--tip-link elbow9"],
];

#!/usr/bin/env bash
# Holes of a plate that were drawn on its lower side, read from a DXF file by dxf-parser.
#
# Expected: the centre of a circle is where the hole is, in the drawing's coordinates, as the points of lines are; or
# the circle says that its numbers are in another frame.
# What happens: the format states circles, arcs and flat polylines in a frame of their own by the direction of extrusion.
# For one that is extruded downwards, 0 0 -1, as after turning a sketch over, that frame's x points to the left,
# and the hole is at (40, 20) where the numbers are (-40, 20). dxf-parser returns the numbers, and drops the
# direction of circles, so that nobody can put them right; of arcs and polylines it hands it on. The package dxf
# hands on all, and its toPolylines() applies it.
# Whom it hurts: whoever takes the nests of a plate, of a fixture or of a grid of targets from its drawing: some
# holes are on the other side of the origin, by twice their distance from it. Check against a picture of the plate.
# poecal: reads no drawings; targets are tables of x, y, z.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
cd "$here"
npm install --silent --no-audit --no-fund --no-package-lock dxf-parser@1.1.2 dxf@5.3.1 > log 2>&1 || { cat log; exit 1; }
cat > holes.mjs <<'JS'
import { readFileSync } from "node:fs";
import { Helper } from "dxf";
import DxfParser from "dxf-parser";

const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8")).version;
console.log("dxf-parser", version("dxf-parser"), "and dxf", version("dxf"));
const down = "\n210\n0.0\n220\n0.0\n230\n-1.0";
const circle = (x, y, direction) => `\n0\nCIRCLE\n8\nholes\n10\n${x}\n20\n${y}\n30\n0.0\n40\n5.0${direction}`;
const arc = (x, y, direction) => `\n0\nARC\n8\nholes\n10\n${x}\n20\n${y}\n30\n0.0\n40\n5.0${direction}\n50\n0.0\n51\n180.0`;
// Circles of one hole at (40, 20), and an arc around it.
const text = `0\nSECTION\n2\nENTITIES${circle(40, 20, "")}${circle(-40, 20, down)}${arc(-40, 20, down)}\n0\nENDSEC\n0\nEOF\n`;

let unchanged = true;
const parser = new (DxfParser.default ?? DxfParser)();
const [up, under, bow] = parser.parseSync(text).entities;
for (const [name, entity] of [["drawn from above", up], ["drawn from below", under], ["arc from below", bow]]) {
  const said = Object.keys(entity).filter((key) => /extrusion|normal/i.test(key));
  console.log(`  dxf-parser, ${name}: centre ${entity.center.x} ${entity.center.y}; of a direction it says ${said.join(", ") || "nothing"}`);
  unchanged &&= (said.length === 0) === (entity !== bow) && entity.center.x === (entity === up ? 40 : -40);
}
const helper = new Helper(text);
const middles = helper.toPolylines().polylines.map(({ vertices }) => {
  const sides = vertices.map(([x]) => x);
  return (Math.min(...sides) + Math.max(...sides)) / 2;
});
console.log(`  dxf, polylines: middles at x of ${middles.map((value) => value.toFixed(3)).join(", ")}; extrusionZ ${helper.denormalised.map((entity) => entity.extrusionZ ?? "none").join(", ")}`);
unchanged &&= middles.every((value) => Math.abs(value - 40) < 0.1) && helper.denormalised[1].extrusionZ === -1;
console.log(unchanged ? "as described" : "CHANGED: the behaviour is not what this file describes");
process.exit(unchanged ? 0 : 1);
JS
node holes.mjs

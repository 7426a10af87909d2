#!/usr/bin/env bash
# Origins of a URDF whose numbers are in columns, read by roslib (roslibjs).
#
# Expected: numbers of xyz and rpy are separated by any blanks, as in urdfdom, and as in urdf-loader, which like roslib
# reads the robot_description of a running robot in a browser. What cannot be read is an error, as it is for
# an axis here.
# What happens: the text is cut at each single space. With two spaces between numbers, or one before the first,
# one of the pieces is empty, and the whole origin stays what it is without one: the position is 0 0 0, the
# rotation none. Nothing is said. An axis with two spaces is refused. Tabs and single spaces are read.
# Whom it hurts: whoever shows or computes in a browser a robot whose numbers were aligned by hand or by a printf
# with a width, as tables of calibrated origins often are: joints lie in one another.
# poecal: reads any blanks, and writes one space between the numbers that it changes; origins that it leaves
# alone keep the spaces of their author.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
cd "$here"
npm install --silent --no-audit --no-fund --no-package-lock roslib@2.1.0 urdf-loader@0.13.1 three@0.187.0 linkedom@0.18.15 > log 2>&1 || { cat log; exit 1; }
cat > origins.mjs <<'JS'
import { readFileSync } from "node:fs";
import { DOMParser } from "linkedom";
import { UrdfModel } from "roslib";

const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8")).version;
console.log("roslib", version("roslib"));
const robot = (xyz, rpy, axis) => `<robot name="arm"><link name="base"/><link name="one"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="${xyz}" rpy="${rpy}"/><axis xyz="${axis}"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>`;
const TEXTS = [
  ["one space", "0.4 -0.05 1.2", "0.1 0 1.57", true],
  ["a tab", "0.4\t-0.05\t1.2", "0.1\t0\t1.57", true],
  ["two spaces", "0.4  -0.05 1.2", "0.1  0 1.57", false],
  ["columns", "  0.4  -0.05   1.2", "  0.1   0.00   1.57", false],
];
let unchanged = true;
for (const [name, xyz, rpy, read] of TEXTS) {
  const { position, orientation } = new UrdfModel({ string: robot(xyz, rpy, "0 0 1") }).joints.turn.origin;
  const off = 1000 * Math.hypot(position.x - 0.4, position.y + 0.05, position.z - 1.2);
  const turned = (2 * Math.acos(Math.min(1, Math.abs(orientation.w)))) / Math.PI * 180;
  console.log(`  ${name.padEnd(11)} position ${position.x} ${position.y} ${position.z}, off by ${off.toFixed(0)} mm; turned by ${turned.toFixed(1)} deg`);
  unchanged &&= read ? off < 1e-9 && turned > 80 : off > 1000 && turned === 0;
}
let refused = "";
try {
  new UrdfModel({ string: robot("0 0 0", "0 0 0", "0  0 1") });
} catch (error) {
  refused = error.message;
}
console.log(`  an axis with two spaces: ${refused || "read"}`);
unchanged &&= refused !== "";

Object.assign(globalThis, { DOMParser, Document: class {}, Element: class {} }); // parts of a browser
const { default: URDFLoader } = await import("urdf-loader");
const beside = new URDFLoader().parse(robot(TEXTS[3][1], TEXTS[3][2], "0  0 1")).joints.turn.position.toArray();
console.log(`urdf-loader ${version("urdf-loader")}`);
console.log(`  columns     position ${beside.join(" ")}`);
unchanged &&= Math.hypot(beside[0] - 0.4, beside[1] + 0.05, beside[2] - 1.2) < 1e-9;
console.log(unchanged ? "as described" : "CHANGED: the behaviour is not what this file describes");
process.exit(unchanged ? 0 : 1);
JS
node origins.mjs

#!/usr/bin/env bash
# A URDF joint that follows another with an offset, in urdf-loader for three.js.
#
# Expected: a follower stands at multiplier times its leader plus offset, from the start.
# What happens: so it does once its leader has been set. Until then it stands at zero, without its offset: a
# robot that was just loaded has another pose than after setJointValue("lead", 0),
# after which the leader still says zero. Nothing is said.
# Whom it hurts: whoever shows a robot, takes poses of a tool at zero, or registers a model with a camera
# before joints move: a gripper or a linkage is off by its offset, 39 mm here. Set all leaders once.
# poecal: adds the offset at any value of the leader.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
cd "$here"
npm install --silent --no-audit --no-fund --no-package-lock urdf-loader@0.13.1 three@0.187.0 linkedom@0.18.15 > log 2>&1 || { cat log; exit 1; }
cat > load.mjs <<'JS'
import { readFileSync } from "node:fs";
import { DOMParser } from "linkedom";

Object.assign(globalThis, { DOMParser, Document: class {}, Element: class {} }); // what a browser has
const { default: URDFLoader } = await import("urdf-loader");
const { version } = JSON.parse(readFileSync("node_modules/urdf-loader/package.json", "utf8"));
console.log("urdf-loader", version);

function load() {
  const limit = '<limit lower="-2" upper="2" effort="1" velocity="1"/>';
  return new URDFLoader().parse(`<robot name="one"><link name="base"/><link name="upper"/><link name="fore"/><link name="tool"/>
    <joint name="lead" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.1 0 0.2"/><axis xyz="0 1 0"/>${limit}</joint>
    <joint name="follow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>${limit}
     <mimic joint="lead" multiplier="-1" offset="0.1"/></joint>
    <joint name="mount" type="fixed"><parent link="fore"/><child link="tool"/><origin xyz="0.39 0 0"/></joint></robot>`);
}

function state(robot, when) {
  robot.updateMatrixWorld(true);
  const at = [12, 13, 14].map((index) => robot.links.tool.matrixWorld.elements[index]);
  const joints = ["lead", "follow"].map((name) => robot.joints[name].angle);
  console.log(`  ${when.padEnd(30)} lead ${joints[0].toFixed(3)}, follow ${joints[1].toFixed(3)}, tool at ${at.map((value) => (1000 * value).toFixed(1)).join(" ")} mm`);
  return { at, follow: joints[1] };
}

const robot = load();
const loaded = state(robot, "loaded");
robot.setJointValue("lead", 0.3);
const moved = state(robot, "lead set to 0.3");
robot.setJointValue("lead", 0);
const back = state(robot, "lead set to 0 again");
const apart = Math.hypot(...back.at.map((value, index) => value - loaded.at[index]));
console.log(`  tool at lead 0: ${(1000 * apart).toFixed(1)} mm apart`);
const unchanged =
  loaded.follow === 0 && Math.abs(moved.follow + 0.2) < 1e-12 && Math.abs(back.follow - 0.1) < 1e-12 && apart > 0.038;
console.log(unchanged ? "as described" : "CHANGED: the behaviour is not what this file describes");
process.exit(unchanged ? 0 : 1);
JS
node load.mjs

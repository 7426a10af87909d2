#!/usr/bin/env bash
# A parameter that is held fixed in a fit, in ml-levenberg-marquardt.
#
# Expected: as the documentation says, a parameter whose `gradientDifference` is zero keeps its initial value,
# and the others are fitted.
# What happens: the rows of the derivatives of all parameters after it move up by one. Of three parameters with
# the first held, the first and second move, along derivatives of the second and third, and the third stays
# as it was. Only the last parameter can be held. The result is returned like any other, after
# `maxIterations` steps of which none led to the optimum.
# Whom it hurts: whoever fits an arm, a scale or a camera in a browser or in Node, with what is known held
# fixed: what was known is changed, and what is sought keeps its guess. `minValues` and `maxValues` that are
# equal hold a parameter; derivatives of one's own have no such shift.
# poecal: what is held ("fix") has no column in its problem, and stands in the result as it was given.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
cd "$here"
npm install --silent --no-audit --no-fund --no-package-lock ml-levenberg-marquardt@5.1.0 ml-matrix@6.13.0 > log 2>&1 || { cat log; exit 1; }
cat > fit.mjs <<'JS'
import { readFileSync } from "node:fs";
import { levenbergMarquardt } from "ml-levenberg-marquardt";

const { version } = JSON.parse(readFileSync("node_modules/ml-levenberg-marquardt/package.json", "utf8"));
console.log("ml-levenberg-marquardt", version);
const NAMES = ["zero", "length", "height"];
const TRUE = [0.1, 0.5, 0.2]; // of a joint, an arm, and where the arm is mounted
const START = [0.1, 0.4, 0.1]; // the zero is known
const x = Array.from({ length: 40 }, (_, index) => index / 20);
const reach = ([zero, length, height]) => (value) => height + length * Math.sin(value + zero);
const y = x.map(reach(TRUE));

let unchanged = true;
for (const held of [null, 0, 1, 2]) {
  const initialValues = START.map((value, index) => (index === held ? TRUE[index] : value));
  const gradientDifference = START.map((_, index) => (index === held ? 0 : 1e-4));
  const fit = levenbergMarquardt({ x, y }, reach, { initialValues, gradientDifference, errorTolerance: 1e-14 });
  const moved = fit.parameterValues.map((value, index) => value - initialValues[index]);
  const off = Math.sqrt(fit.parameterError / x.length);
  console.log(
    `  ${held === null ? "nothing held" : NAMES[held] + " held at its true value"}:`.padEnd(34),
    NAMES.map((name, index) => `${name} moved ${moved[index].toFixed(6)}`).join(", "),
    `  rms ${(1000 * off).toFixed(3)} mm, ${fit.iterations} iterations`,
  );
  const still = moved.map((value) => Math.abs(value) < 1e-12);
  if (held === null || held === 2) unchanged &&= off < 1e-6 && still[2] === (held === 2);
  else unchanged &&= off > 1e-3 && still[2] && !still[held] && fit.iterations === 100;
}
console.log(unchanged ? "as described" : "CHANGED: the behaviour is not what this file describes");
process.exit(unchanged ? 0 : 1);
JS
node fit.mjs

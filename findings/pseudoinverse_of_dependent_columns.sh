#!/usr/bin/env bash
# The pseudoinverse of a matrix with dependent columns, by mathjs and by ml-matrix.
#
# Expected: the Moore-Penrose inverse, as both say: where columns depend on each other but for rounding, as in
# NumPy, MATLAB and Eigen, the solution of least length, which is what a pseudoinverse is taken for.
# What happens: independent columns are fine in both. ml-matrix counts all singular values above 2.2e-16,
# whatever the matrix, and so takes rounding for another direction in up to nine of ten cases. mathjs finds
# the rank by elimination without pivots: it is right unless the first row begins with a small number, as a
# row of a Jacobian does at a joint near zero; then nine of ten are wrong, or end with an error that speaks
# of a determinant. Such a result is no inverse of any kind: A pinv(A) A is not A, and least squares by it
# misses equations that agree with each other. Of columns that differ by 1 part in a million mathjs loses
# all but four digits besides, since it squares the condition. A threshold in ml-matrix, of 1e-12 times the
# matrix, helps.
# Whom it hurts: whoever solves for offsets, frames or joint velocities in a browser or in Node: a base and a
# first joint, parallel joints and redundant arms have dependent columns.
# poecal: decides what is determined by singular values relative to the largest, and names what is not.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
cd "$here"
npm install --silent --no-audit --no-fund --no-package-lock mathjs@15.2.0 ml-matrix@6.13.0 > log 2>&1 || { cat log; exit 1; }
cat > inverses.mjs <<'JS'
import { readFileSync } from "node:fs";
import { pinv } from "mathjs";
import { Matrix, pseudoInverse } from "ml-matrix";

for (const name of ["mathjs", "ml-matrix"]) console.log(name, JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8")).version);
let seed = 7;
const number = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
const digit = () => 1 + Math.floor(9 * number());
const COUNT = 200;
const columns = (draw, third) => Array.from({ length: 8 }, () => { const [a, b] = [draw(), draw()]; return [a, b, third(a, b)]; });
const CASES = {
  "independent": () => columns(number, number),
  "third = first + second, digits": () => columns(digit, (a, b) => a + b),
  "third = first + second": () => columns(number, (a, b) => a + b),
  "third = 0.3 first + 0.7 second": () => columns(number, (a, b) => 0.3 * a + 0.7 * b),
  "the same, first number 1e-5": () => { const rows = columns(number, () => 0); rows[0][0] *= 1e-5; return rows.map(([a, b]) => [a, b, 0.3 * a + 0.7 * b]); },
  "third = first, but for 1e-6": () => columns(number, (a) => a + 1e-6 * number()),
};
const INVERSES = {
  "mathjs": (rows) => new Matrix(pinv(rows)),
  "ml-matrix": (rows) => pseudoInverse(new Matrix(rows)),
  "ml-matrix, 1e-12": (rows) => pseudoInverse(new Matrix(rows), 1e-12 * new Matrix(rows).norm()),
};

const wrong = {}, typical = {};
console.log(`of ${COUNT} matrices with 8 rows and 3 columns, those with A pinv(A) A off by more than 0.01, and the median:`);
for (const [name, made] of Object.entries(CASES)) {
  const matrices = Array.from({ length: COUNT }, made);
  const shown = [];
  for (const [library, inverse] of Object.entries(INVERSES)) {
    const misses = matrices.map((rows) => {
      const a = new Matrix(rows);
      try {
        return Matrix.sub(a.mmul(inverse(rows)).mmul(a), a).abs().max();
      } catch {
        return Infinity; // "determinant is zero"
      }
    });
    misses.sort((one, other) => one - other);
    const key = `${name} ${library}`;
    wrong[key] = misses.filter((miss) => !(miss < 0.01)).length;
    typical[key] = misses[COUNT / 2];
    shown.push(`${library} ${String(wrong[key]).padStart(3)} (${typical[key].toExponential(0)})`);
  }
  console.log(`  ${name.padEnd(31)} ${shown.join("   ")}`);
}
const parts = (name, library) => wrong[`${name} ${library}`] / COUNT;
let unchanged = Object.keys(CASES).every((name) => parts(name, "ml-matrix, 1e-12") === 0);
unchanged &&= ["mathjs", "ml-matrix"].every((library) => parts("independent", library) === 0);
unchanged &&= parts("third = 0.3 first + 0.7 second", "mathjs") === 0 && parts("the same, first number 1e-5", "mathjs") > 0.3 && parts("third = 0.3 first + 0.7 second", "ml-matrix") > 0.1;
unchanged &&= parts("third = first + second, digits", "mathjs") === 0 && parts("third = first + second, digits", "ml-matrix") > 0.1;
unchanged &&= typical["third = first, but for 1e-6 mathjs"] > 1e-6 && typical["third = first, but for 1e-6 ml-matrix"] < 1e-8;
console.log(unchanged ? "as described" : "CHANGED: the behaviour is not what this file describes");
process.exit(unchanged ? 0 : 1);
JS
node inverses.mjs

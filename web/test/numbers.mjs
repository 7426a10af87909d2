// Texts with numbers, compared.
import assert from "node:assert/strict";

/** Numbers of a text, and the text without them. */
function split(words) {
  const numbers = [];
  const rest = words.replace(/(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])/g, (number) => {
    numbers.push(Number(number));
    return "#";
  });
  return { numbers, rest };
}

/**
 * Numbers of a calibration that are written with six decimals (poecal-results/src/calibration_file/corrected_model.rs), the last of which may be
 * rounded differently.
 */
const COARSE = /("(?:left_out|score)": )(-?[\d.e-]+)/g;
const LAST_DECIMAL = 1.0001e-6;

/** The figures with six decimals, and the text without them. */
function coarse(words) {
  const figures = [];
  const rest = words.replace(COARSE, (_, key, figure) => {
    figures.push(Number(figure));
    return key;
  });
  return { figures, rest };
}

/** The largest difference of the numbers of two texts, relative or, for numbers below 1, absolute; the texts must otherwise be equal. */
export function difference(one, other, about) {
  const [coarseOne, coarseOther] = [coarse(one), coarse(other)];
  coarseOne.figures.forEach((figure, k) => {
    const [found, expected] = [figure, coarseOther.figures[k]];
    assert.ok(Math.abs(found - expected) <= LAST_DECIMAL, `${about}: found a score of ${found}, expected ${expected}`);
  });
  const [a, b] = [split(coarseOne.rest), split(coarseOther.rest)];
  if (a.rest !== b.rest) {
    const at = [...a.rest].findIndex((letter, k) => letter !== b.rest[k]);
    assert.fail(`${about}: found the words …${a.rest.slice(at - 60, at + 60)}…, expected …${b.rest.slice(at - 60, at + 60)}…`);
  }
  return a.numbers.reduce((most, number, k) => Math.max(most, Math.abs(number - b.numbers[k]) / Math.max(1, Math.abs(number))), 0);
}

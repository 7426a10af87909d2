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

/** The largest difference of the numbers of two texts, which must be alike but for these. */
export function difference(one, other, about) {
  const [a, b] = [split(one), split(other)];
  if (a.rest !== b.rest) {
    const at = [...a.rest].findIndex((letter, k) => letter !== b.rest[k]);
    assert.fail(`${about}: found the words …${a.rest.slice(at - 60, at + 60)}…, expected …${b.rest.slice(at - 60, at + 60)}…`);
  }
  return a.numbers.reduce((most, number, k) => Math.max(most, Math.abs(number - b.numbers[k]) / Math.max(1, Math.abs(number))), 0);
}

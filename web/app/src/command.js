// The program's command line, from files with their roles and from options.

/** Options of `poecal calibrate` that `poecal check` and `poecal validate` take too. */
const READING = ["--columns", "--strict", "--device-frames", "--join", "--socket-distance", "--contact", "--instrument-noise"];
const CHECKING = [...READING, "--base-link", "--tip-link", "--instrument", "--target", "--train-where", "--device-frame"];
const JUDGING = [...READING, "--refit", "--require", "--accept", "--accept-model"];

/** Words as a shell takes them apart: blanks separate, quotes and backslashes keep together. */
export function wordsOf(line) {
  const words = [];
  for (const [word] of line.matchAll(/(?:"(?:\\.|[^"\\])*"?|'[^']*'?|\\.|[^\s"'\\])+/gs)) {
    words.push(word.replace(/"((?:\\.|[^"\\])*)"?|'([^']*)'?|\\(.)/gs, (_, double, single, one) => double?.replace(/\\(["\\$`])/g, "$1") ?? single ?? one ?? ""));
  }
  return words;
}

/** A word as a shell needs it. */
function quoted(word) {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

/** A command line as text to copy. */
export function shown(words) {
  return ["poecal", ...words].map(quoted).join(" ");
}

/** Those of the options, with their values, that another command takes. */
function among(options, allowed) {
  const kept = [];
  let keeps = false;
  for (const word of options) {
    if (word.startsWith("--")) keeps = allowed.includes(word.split("=")[0]);
    if (keeps) kept.push(word);
  }
  return kept;
}

/** Those of the options that choose the chain. */
export const chainOf = (options) => among(options, ["--base-link", "--tip-link"]);

const names = (files, role) => files.filter((file) => file.role === role).map((file) => file.name);

/** A folder for the results that no file of the input is in. */
function folder(files) {
  for (let k = 1; ; k += 1) {
    const name = k === 1 ? "calibration" : `calibration-${k}`;
    if (!files.some((file) => file.name === name || file.name.startsWith(`${name}/`))) return name;
  }
}

const settings = (files) => names(files, "settings").flatMap((name) => ["--settings", name]);
const mapping = (files) => names(files, "columns").flatMap((name) => ["--columns", name]);

/** `poecal check`: how model and measurements are understood. */
export function checkWords(files, options) {
  const tables = [...names(files, "measurements"), ...names(files, "validate")];
  return ["check", ...names(files, "model"), ...tables, ...(tables.length ? [...settings(files), ...mapping(files)] : []), ...among(options, CHECKING)];
}

/** `poecal calibrate`. */
export function calibrateWords(files, options) {
  return [
    "calibrate",
    ...names(files, "model"),
    ...names(files, "measurements"),
    ...settings(files),
    ...mapping(files),
    ...names(files, "validate").flatMap((name) => ["--validate", name]),
    ...options,
    ...(options.some((word) => word === "--out" || word.startsWith("--out=")) ? [] : ["--out", folder(files)]),
  ];
}

/** `poecal validate`, of a calibration by measurements. */
export function validateWords(files, options) {
  return ["validate", ...names(files, "model"), ...names(files, "measurements"), ...names(files, "validate"), ...mapping(files), ...among(options, JUDGING)];
}

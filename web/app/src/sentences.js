// The program's messages: errors, warnings and notes, the place that each names, and the line there.

/** How much of a long line is shown on each side of a place. */
const AROUND = 60;

/** The messages on standard error: `{ kind, text }`, kind being error, warning or note. */
export function messages(err) {
  const found = [];
  for (const line of err.split("\n")) {
    const begins = /^(error|warning|note): (.*)$/.exec(line);
    if (begins) found.push({ kind: begins[1], text: begins[2], more: [] });
    // How the command is called on a terminal says nothing here.
    else if (/^(Usage:|For more information)/.test(line)) continue;
    else if (line.trim() && found.length) found.at(-1).more.push(line.trim());
  }
  return found.map(({ kind, text, more }) => ({ kind, text: [text, ...more].join(" ") }));
}

/** The place that a message begins with, of one of these files: file, line, column and the line's text; none if there is none. */
export function placeOf(text, files) {
  const file = files.filter(({ name }) => text.startsWith(`${name}:`)).sort((a, b) => b.name.length - a.name.length)[0];
  const numbers = file && /^:(\d+)(?::(\d+))?:/.exec(text.slice(file.name.length));
  if (!numbers) return undefined;
  const [line, column] = [Number(numbers[1]), numbers[2] && Number(numbers[2])];
  const content = lineOf(file.bytes, line);
  return content === undefined ? undefined : { file, line, column, ...cut(content, column) };
}

/** One line of a file. */
function lineOf(bytes, wanted) {
  let start = 0;
  for (let line = 1; line < wanted; line += 1) {
    start = bytes.indexOf(10, start) + 1;
    if (start === 0) return undefined;
  }
  const end = bytes.indexOf(10, start);
  return new TextDecoder().decode(bytes.subarray(start, end < 0 ? undefined : end)).replace(/^\uFEFF|\r$/g, "");
}

/** The part of a line about a column, and how many characters stand before the place in it. */
function cut(content, column) {
  const characters = [...content.replace(/[\u0000-\u001F\u007F-\u009F\u200B-\u200F\u202A-\u202E\u2066-\u2069]/g, (it) => (it === "\t" ? "\t" : "\uFFFD"))];
  const at = (column ?? 1) - 1;
  const from = at > 2 * AROUND ? at - AROUND : 0;
  const to = Math.min(characters.length, Math.max(at, from) + 2 * AROUND);
  return {
    shown: (from ? "…" : "") + characters.slice(from, to).join("") + (to < characters.length ? "…" : ""),
    before: column === undefined ? undefined : at - from + (from ? 1 : 0),
  };
}

/** The verdict in the words that the program prints. */
export function verdictOf(out) {
  return /^verdict +([^:\n]+)/m.exec(out)?.[1].trim();
}

/** What a file is that the program reads neither as a model nor as measurements: its sentence; none of others. */
export function foreign(name, asModel, asTable) {
  const what = (err) => messages(err).filter(({ kind }) => kind === "error").map(({ text }) => [text, new RegExp(`^${escaped(name)}: found (.*), expected `).exec(text)?.[1]])[0] ?? [];
  const [[text, found], [, other]] = [what(asModel), what(asTable)];
  return found && found === other ? text : undefined;
}

const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

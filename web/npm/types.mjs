// Writes the types of calibration.json and of the program's options, from docs/calibration.schema.json and docs/commands.md, into
// web/npm/types.d.ts. With --check it compares instead.
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const OUT = here("types.d.ts");
const LENGTH = 140;
/** Commands whose options are types: those that poecal.js has a function for. */
const COMMANDS = ["calibrate", "validate", "predict", "check", "plan", "export", "simulate"];
/** Options that the functions set themselves, or that mean nothing in memory. */
const OWN = ["out", "force", "settings", "columns", "validate", "json", "quiet", "threads", "timings", "verbose", "format", "onto", "motors", "rows"];

/** Words as lines of a comment. */
function comment(words, indent) {
  const text = words.replace(/\[`(?:super::)?([^`\]]+)`\]/g, "`$1`").replace(/\*\//g, "* /").replace(/\s+/g, " ").trim();
  if (text === "") return "";
  const lines = [""];
  for (const word of text.split(" ")) {
    const last = lines.length - 1;
    if (lines[last] !== "" && `${indent} * ${lines[last]} ${word}`.length > LENGTH) lines.push(word);
    else lines[last] = lines[last] === "" ? word : `${lines[last]} ${word}`;
  }
  if (lines.length === 1) return `${indent}/** ${lines[0]} */\n`;
  return `${indent}/**\n${lines.map((line) => `${indent} * ${line}\n`).join("")}${indent} */\n`;
}

/** A name as a key of a type. */
const key = (name) => (/^[A-Za-z_$][\w$]*$/.test(name) ? name : JSON.stringify(name));

/** What a schema says that makes no difference to the type. */
const SILENT = new Set(["$schema", "title", "description", "default", "format", "minimum", "minItems", "maxItems", "$defs"]);
const KNOWN = new Set([...SILENT, "$ref", "anyOf", "oneOf", "const", "type", "properties", "required", "additionalProperties", "patternProperties", "items", "prefixItems"]);

/** The type that a schema describes. */
function typeOf(schema, indent) {
  if (schema === true) return "unknown";
  const strange = Object.keys(schema).filter((word) => !KNOWN.has(word));
  if (strange.length > 0) throw new Error(`docs/calibration.schema.json: found ${strange}, expected words that web/npm/types.mjs knows`);
  if (schema.$ref) return schema.$ref.replace("#/$defs/", "").replace(/double$/, "Number");
  const any = schema.anyOf ?? schema.oneOf;
  if (any) return [...new Set(any.map((one) => typeOf(one, indent)))].join(" | ");
  if ("const" in schema) return JSON.stringify(schema.const);
  if (Array.isArray(schema.type)) return schema.type.map((type) => typeOf({ ...schema, type }, indent)).join(" | ");
  switch (schema.type) {
    case "string":
      return "string";
    case "number":
    case "integer":
      return "number";
    case "boolean":
      return "boolean";
    case "null":
      return "null";
    case "array":
      return arrayOf(schema, indent);
    case "object":
      return objectOf(schema, indent);
    default:
      return "unknown";
  }
}

function arrayOf({ items, prefixItems, minItems, maxItems }, indent) {
  if (prefixItems) return `[${prefixItems.map((one) => typeOf(one, indent)).join(", ")}]`;
  const item = typeOf(items ?? true, indent);
  if (minItems !== undefined && minItems === maxItems && minItems <= 6) return `[${Array(minItems).fill(item).join(", ")}]`;
  return /[ {]/.test(item) ? `Array<${item}>` : `${item}[]`;
}

function objectOf({ properties = {}, required = [], additionalProperties, patternProperties }, indent) {
  const inner = `${indent}  `;
  const lines = Object.entries(properties).map(([name, schema]) => {
    const mark = required.includes(name) ? "" : "?";
    return `${comment(schema.description ?? "", inner)}${inner}${key(name)}${mark}: ${typeOf(schema, inner)};\n`;
  });
  const others = [...Object.values(patternProperties ?? {}), ...(additionalProperties ? [additionalProperties] : [])];
  if (others.length > 0 && lines.length === 0) return `{ [name: string]: ${others.map((one) => typeOf(one, indent)).join(" | ")} }`;
  if (others.length > 0) lines.push(`${inner}[name: string]: unknown;\n`);
  return lines.length === 0 ? "{ [name: string]: never }" : `{\n${lines.join("")}${indent}}`;
}

/** Types of calibration.json. */
function ofSchema() {
  const schema = JSON.parse(readFileSync(here("../../docs/calibration.schema.json"), "utf8"));
  const named = [["CalibrationFile", schema], ...Object.entries(schema.$defs)];
  return named.map(([name, it]) => `${comment(it.description ?? "", "")}export type ${name.replace(/double$/, "Number")} = ${typeOf(it, "")};\n`);
}

/** The options of a command in docs/commands.md: name, whether it takes a value, what it may be, and words about it. */
function optionsOf(command) {
  const text = readFileSync(here("../../docs/commands.md"), "utf8");
  const part = text.split(`\n## poecal ${command}\n`)[1]?.split("\n```\n")[0] ?? "";
  const help = part.split("\nOptions:\n")[1];
  if (help === undefined) throw new Error(`docs/commands.md: found no options of \`poecal ${command}\`, expected some`);
  return help.replace(/^\S.*:$/gm, "").split(/\n(?=\s{2,6}-)/).flatMap((block) => {
    const head = /^\s*(?:-\w, )?--([\w-]+)(?: <(.+)>)?\n/.exec(`${block}\n`);
    if (!head || head[1] === "help") return [];
    const [words, values = ""] = block.slice(head[0].length).split(/Possible values:\s*\n/);
    const possible = [...values.matchAll(/^ {10}- ([\w-]+)(?::|$)/gm)].map((match) => match[1]);
    return [{ name: head[1], value: head[2], words, possible }];
  });
}

/** Types of the options of a command. */
function ofOptions(command) {
  const name = `${command[0].toUpperCase()}${command.slice(1)}Options`;
  const lines = optionsOf(command)
    .filter((option) => !OWN.includes(option.name))
    .map(({ name, value, words, possible }) => {
      const one = possible.length > 0 ? possible.map((word) => JSON.stringify(word)).join(" | ") : "Value";
      const type = value === undefined ? "boolean" : possible.length > 0 ? one : "Value | readonly Value[]";
      return `${comment(words, "  ")}  ${key(name.replace(/-(\w)/g, (_, letter) => letter.toUpperCase()))}?: ${type};\n`;
    });
  return `/** Options of \`poecal ${command}\`, by their long names. */\nexport interface ${name} {\n${lines.join("")}}\n`;
}

const text = [
  "// Written by web/npm/types.mjs from docs/calibration.schema.json and docs/commands.md.\n",
  "/** A value of an option, as it would be typed; of an option that may be given again, an array of them. */\nexport type Value = string | number;\n",
  ...COMMANDS.map(ofOptions),
  ...ofSchema(),
].join("\n");

if (process.argv[2] === "--check") {
  if (readFileSync(OUT, "utf8") !== text) throw new Error("web/npm/types.d.ts: found other types, expected those of the schema and the options: run `node web/npm/types.mjs`");
  console.log("types.d.ts: as written");
} else {
  writeFileSync(OUT, text);
  console.log(`types.d.ts: ${text.split("\n").length} lines`);
}

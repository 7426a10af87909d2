// Builds the page that calibrates: program, style, script, an example and licences in one HTML file, which loads nothing.
//
//   node web/app/build.mjs               writes web/app/dist/poecal.html
//   node web/app/build.mjs --no-module   the same around the module that is in web/npm/dist already
//
// POECAL_WEB_PROFILE is that of web/npm/build.mjs; the limit of size is for what is shipped.
// Exit code 4, as of web/npm/build.mjs: Rust lacks the standard library of WebAssembly.
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const HERE = new URL("./", import.meta.url);
const ROOT = new URL("../../", HERE);
const profile = process.env.POECAL_WEB_PROFILE ?? "web";
const FOLDER = profile === "web" ? "dist" : `dist-${profile}`;
const MODULE = new URL(`../npm/${FOLDER}/poecal.wasm`, HERE);
const OUT = new URL(`${FOLDER}/poecal.html`, HERE);
const TARGETS = ["chrome103", "firefox113", "safari16.4"];
/** Beyond this something is wrong: a page is mailed, and kept on sticks. 6.05 MB with the files of other tools, before the test of ISO 9283. */
const MOST_BYTES = 6.3e6;
const EXAMPLE = ["robot.urdf", "points.csv"];

/** `inline:FILE` is the bundled script of that file, as a text. */
const inlined = {
  name: "inline",
  setup(builder) {
    builder.onResolve({ filter: /^inline:/ }, ({ path }) => ({ path: path.slice("inline:".length), namespace: "inline" }));
    builder.onLoad({ filter: /.*/, namespace: "inline" }, async ({ path }) => ({ contents: await bundle(path), loader: "text" }));
  },
};

async function bundle(entry) {
  const { outputFiles } = await build({
    entryPoints: [fileURLToPath(new URL(`src/${entry}`, HERE))],
    bundle: true,
    minify: true,
    write: false,
    charset: "utf8",
    format: "iife",
    target: TARGETS,
    legalComments: "none",
    // What Node alone needs, and a module beside the script, is never reached: the page hands the module over.
    external: ["node:*"],
    define: { "import.meta.url": '"about:blank"' },
    plugins: [inlined],
  });
  return outputFiles[0].text;
}

/** As the page holds it. */
const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString("base64");

async function licences() {
  const names = ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"];
  return (await Promise.all(names.map((name) => readFile(new URL(name, ROOT), "utf8")))).join(`\n\n${"=".repeat(80)}\n\n`);
}

/** A module without its custom sections (number 0), which are names for people and nothing that is run. */
function withoutNames(module) {
  const kept = [module.subarray(0, 8)];
  for (let at = 8; at < module.length; ) {
    const start = at;
    let [length, shift, byte] = [0, 0, 0x80];
    for (at += 1; byte & 0x80; at += 1, shift += 7) {
      byte = module[at];
      length += (byte & 0x7f) * 2 ** shift;
    }
    at += length;
    if (module[start] !== 0) kept.push(module.subarray(start, at));
  }
  return Buffer.concat(kept);
}

/** The page around a module. */
async function page(module) {
  const example = Object.fromEntries(await Promise.all(EXAMPLE.map(async (name) => [name, await readFile(new URL(`examples/elbow/${name}`, ROOT), "utf8")])));
  const parts = {
    VERSION: /^version = "(.*)"$/m.exec(await readFile(new URL("Cargo.toml", ROOT), "utf8"))[1],
    STYLE: await bundle("app.css"),
    ENGINE: packed(withoutNames(module)),
    EXAMPLES: packed(Buffer.from(JSON.stringify(example))),
    LICENCES: packed(Buffer.from(await licences())),
    // A script ends at the first such tag, also within a text.
    SCRIPT: (await bundle("main.js")).replaceAll("</script", "<\\/script"),
  };
  const text = await readFile(new URL("src/page.html", HERE), "utf8");
  return text.replace(/@([A-Z]+)@/g, (_, name) => parts[name]);
}

if (!process.argv.includes("--no-module")) {
  const { status } = spawnSync(process.execPath, [fileURLToPath(new URL("../npm/build.mjs", HERE))], { stdio: "inherit" });
  if (status !== 0) process.exit(status ?? 1);
}
const module = existsSync(MODULE) ? await readFile(MODULE) : undefined;
if (!module) {
  console.error(`found no web/npm/${FOLDER}/poecal.wasm, expected what web/npm/build.mjs writes`);
  process.exit(1);
}
const text = await page(module);
await mkdir(new URL("./", OUT), { recursive: true });
await writeFile(OUT, text);
const bytes = Buffer.byteLength(text);
console.log(`poecal.html: ${(bytes / 1e6).toFixed(2)} MB`);
if (bytes > MOST_BYTES && profile === "web") {
  console.error(`poecal.html: found ${bytes} bytes, expected at most ${MOST_BYTES}`);
  process.exit(1);
}

// Builds the report's script and style into the library, or checks that what is there is what would be built.
//
//   node build.mjs            writes
//   node build.mjs --check    compares, and ends with 1 if they differ
import { build } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";

const ASSETS = new URL("../crates/poecal-report/src/page/assets/", import.meta.url);
const BUNDLED = ["three"];
/** The one piece of a shader that three.js adds to every program. Those of its own materials are never compiled: ours have shaders of their own. */
const ADDED = "colorspace_pars_fragment";

/** three.js without what its own materials alone need, shaders and a table: a fifth of the script. */
const withoutMaterials = {
  name: "without materials",
  setup(builder) {
    builder.onLoad({ filter: /three\.module\.js$/ }, async ({ path }) => {
      const text = await readFile(path, "utf8");
      const shaders = /^(?:var|const) ([\w$]+) = "(?:[^"\\]|\\.)*";$/gm;
      const emptied = text.replace(shaders, (whole, name) => (whole.includes("\\n") && name !== ADDED ? `const ${name} = "";` : whole));
      return { contents: emptied.replace(/^(const DATA = new Uint16Array\( \[)[^\]]*/m, "$1") };
    });
  },
};

/** The licences of what is bundled, as a comment that stays in every report. */
async function licences() {
  const texts = [];
  for (const name of BUNDLED) {
    const folder = new URL(`node_modules/${name}/`, import.meta.url);
    const { version } = JSON.parse(await readFile(new URL("package.json", folder), "utf8"));
    texts.push(`${name} ${version}\n\n${(await readFile(new URL("LICENSE", folder), "utf8")).trim()}`);
  }
  return `/*! This script contains:\n\n${texts.join("\n\n\n")}\n*/\n`.replaceAll("\r\n", "\n");
}

async function bundle(entry, options) {
  const { outputFiles } = await build({
    entryPoints: [new URL(`src/${entry}`, import.meta.url).pathname],
    bundle: true,
    minify: true,
    write: false,
    legalComments: "none",
    charset: "utf8",
    plugins: [withoutMaterials],
    ...options,
  });
  return outputFiles[0].text;
}

const script = (await licences()) + (await bundle("main.js", { format: "iife", target: "es2020" }));
const style = await bundle("report.css", { target: ["chrome90", "firefox90", "safari15"] });
let differ = false;
for (const [name, text] of [["report.js", script], ["report.css", style]]) {
  const place = new URL(name, ASSETS);
  if (process.argv.includes("--check")) {
    const same = (await readFile(place, "utf8")) === text;
    console.log(`${name}: ${same ? "as built" : "differs from what web/ builds; run `npm run build` there"}`);
    differ ||= !same;
  } else {
    await writeFile(place, text);
    console.log(`${name}: ${Math.round(text.length / 1024)} KiB`);
  }
}
process.exit(differ ? 1 : 0);

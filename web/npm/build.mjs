// Builds the WebAssembly module and the npm package around it into web/npm/dist (of another profile, dist-PROFILE).
//
//   node web/npm/build.mjs                 with vector instructions
//   node web/npm/build.mjs --plain FILE    the module without them, to that file: for comparisons
//
// POECAL_WEB_PROFILE is the profile of cargo: `web`, what is shipped, or another one.
//
// Exit code 4: Rust lacks the standard library of the target.
import { execFileSync, spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const TARGET = "wasm32-unknown-unknown";
const LACKING = 4;
const HERE = fileURLToPath(new URL(".", import.meta.url));
const ROOT = join(HERE, "../..");
const profile = process.env.POECAL_WEB_PROFILE ?? "web";
/** What is not shipped has another folder, so that nobody hands it out. */
const DIST = join(HERE, profile === "web" ? "dist" : `dist-${profile}`);
// Fits with many unknowns and the command line need more than the linker's megabyte.
const STACK = 8 << 20;

const plain = process.argv[2] === "--plain" ? process.argv[3] : undefined;

const sysroot = execFileSync("rustc", ["--print", "sysroot"], { encoding: "utf8", cwd: ROOT }).trim();
if (!existsSync(join(sysroot, "lib/rustlib", TARGET, "lib"))) {
  console.error(
    `found no standard library of ${TARGET} in ${sysroot}, expected one: \`rustup target add ${TARGET}\`, or the distribution's package ` +
      "(libstd-rust-dev-wasm32 of Debian and Ubuntu, rust-std-static-wasm32-unknown-unknown of Fedora)",
  );
  process.exit(LACKING);
}

const flags = [...(plain ? [] : ["-Ctarget-feature=+simd128"]), `-Clink-arg=-zstack-size=${STACK}`];
const words = ["rustc", "--locked", "--profile", profile, "--target", TARGET, "-p", "poecal-wasm", "--lib", "--crate-type", "cdylib"];
// As a cdylib alone: with a library of Rust beside it, cargo would not optimise across crates.
const config = `target.${TARGET}.rustflags=${JSON.stringify(flags)}`;
const built = spawnSync("cargo", [...words, "--config", config], { stdio: ["ignore", "inherit", "inherit"], cwd: ROOT });
if (built.status !== 0) process.exit(1);

const folder = process.env.CARGO_TARGET_DIR ?? join(ROOT, "target");
const bytes = readFileSync(join(folder, TARGET, profile, "poecal_wasm.wasm"));
const imports = WebAssembly.Module.imports(new WebAssembly.Module(bytes));
if (imports.length > 0) {
  const names = imports.map(({ module, name }) => `${module}.${name}`).join(", ");
  throw new Error(`the module asks for ${names}, expected that it imports nothing`);
}
const size = `${(bytes.length / 1e6).toFixed(2)} MB, ${(gzipSync(bytes, { level: 9 }).length / 1e6).toFixed(2)} MB as gzip`;
if (plain) {
  writeFileSync(plain, bytes);
  console.log(`${plain}: ${size}, without vector instructions`);
} else {
  rmSync(DIST, { recursive: true, force: true });
  mkdirSync(DIST, { recursive: true });
  writeFileSync(join(DIST, "poecal.wasm"), bytes);
  for (const name of ["poecal.js", "index.js", "index.d.ts", "types.d.ts", "package.json", "README.md"]) copyFileSync(join(HERE, name), join(DIST, name));
  for (const name of ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"]) copyFileSync(join(ROOT, name), join(DIST, name));
  console.log(`${join(DIST, "poecal.wasm")}: ${size}`);
}

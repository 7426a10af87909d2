// The program that tests run.
import { existsSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

export const ROOT = fileURLToPath(new URL("../..", import.meta.url));
export const PROGRAM = process.env.POECAL_PROGRAM ?? join(ROOT, "target/release/poecal");

if (!existsSync(PROGRAM)) throw new Error(`found no program at ${PROGRAM}; build it (cargo build --release -p poecal-cli), or name it: POECAL_PROGRAM=/path`);

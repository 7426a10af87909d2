// The program with the vector instructions of other machines.
import { spawnSync } from "node:child_process";
import { PROGRAM } from "./program.mjs";

/** Levels of this machine, the best first; the program refuses others. */
export const LEVELS = ["avx512", "avx2", "neon", "plain"].filter((level) => spawnSync(PROGRAM, ["schema"], { env: limited(level) }).status === 0);

/** The environment of a program that is limited to a level. */
export function limited(level) {
  return { ...process.env, POECAL_SIMD: level };
}

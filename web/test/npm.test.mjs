// The npm package against the program: the same numbers, sentences and exit codes, a disk that behaves, its types, and the contents of the package.
//
// web/npm/build.mjs makes web/npm/dist first.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { LEVELS, limited } from "./levels.mjs";
import { difference } from "./numbers.mjs";
import { PROGRAM, ROOT } from "./program.mjs";

const NPM = join(ROOT, "web/npm");
const DIST = join(NPM, "dist");
if (!existsSync(join(DIST, "poecal.wasm"))) throw new Error("found no web/npm/dist/poecal.wasm; build it: node web/npm/build.mjs");
const { load, PoecalError } = await import(join(DIST, "index.js"));
const poecal = await load();

/**
 * Largest difference of a number of the two, relative to its size or, if that is smaller, absolute in the file's units. The module has no fused
 * products, so that sums differ in their last digits, and quotients by small eigenvalues in more.
 */
const NEAR = 1e-9;

/**
 * Largest size of the module, MB: raw, and compressed as servers send it. It has the whole program, with a megabyte of the report's script and
 * texts.
 */
const MOST_RAW = 12.5;
const MOST_SMALL = 4.7;

const folder = mkdtempSync(join(tmpdir(), "poecal-npm-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
let runs = 0;

/** The same run by the program at a level of vector instructions, in a folder of its own. */
function native(words, files, level = LEVELS[0]) {
  const cwd = join(folder, String(runs++));
  mkdirSync(cwd);
  for (const [path, content] of Object.entries(files)) {
    mkdirSync(dirname(join(cwd, path)), { recursive: true });
    if (!path.endsWith("/")) writeFileSync(join(cwd, path), content);
    else mkdirSync(join(cwd, path), { recursive: true });
  }
  const { status, stdout, stderr } = spawnSync(PROGRAM, words, { cwd, encoding: "utf8", maxBuffer: 1 << 28, env: limited(level) });
  return { code: status, out: stdout, err: stderr, read: (path) => readFileSync(join(cwd, path), "utf8") };
}

const example = (path) => readFileSync(join(ROOT, "examples", path), "utf8");
const text = (bytes) => new TextDecoder().decode(bytes);
const robot = example("elbow/robot.urdf");
const simulated = (...words) => text(poecal.run(["simulate", "robot.urdf", ...words, "--out", "s"], { "robot.urdf": robot }).files["s/measurements.csv"]);

/** The mapping file that a page shows. */
const shown = (page) => readFileSync(join(ROOT, "docs/howto", page), "utf8").split("```toml\n")[1].split("```")[0];
const cases = {
  points: [["points.csv"], { "points.csv": example("elbow/points.csv") }],
  poses: [["poses.csv"], { "poses.csv": simulated("--kind", "pose", "--count", "60") }],
  reflectors: [["reflectors.csv", "--columns", "map.toml"], { "reflectors.csv": example("howto/reflectors.csv"), "map.toml": shown("several-reflectors.md") }],
  "a camera, by a mapping": [["camera.csv", "--columns", "camera.toml"], { "camera.csv": example("howto/camera.csv"), "camera.toml": shown("camera-poses.md") }],
  "points and poses": [["mixed.csv"], { "mixed.csv": simulated("--kind", "mixed", "--count", "120") }],
};

for (const [name, [words, inputs]] of Object.entries(cases)) {
  test(`${name}: the numbers of the program`, (t) => {
    const files = { "robot.urdf": robot, ...inputs };
    const all = ["calibrate", "robot.urdf", ...words, "--out", "out", "--threads", "1"];
    const here = poecal.run(all, files);
    assert.equal(here.code, 0, here.err);
    assert.deepEqual(Object.keys(here.files).sort(), ["out/calibrated.urdf", "out/calibration.json", "out/report.html", "out/residuals.csv"]);
    for (const level of LEVELS) {
      const there = native(all, files, level);
      assert.equal(there.code, 0, there.err);
      for (const file of ["calibration.json", "calibrated.urdf", "residuals.csv"]) {
        const most = difference(text(here.files[`out/${file}`]), there.read(`out/${file}`), `${name}, ${file}, ${level}`);
        t.diagnostic(`${name}: ${file} differs by ${most.toExponential(1)} from ${level}`);
        assert.ok(most <= NEAR, `${file}, ${level}: ${most}`);
      }
      assert.equal(here.err, there.err);
    }
  });
}

test("every file is understood as the program understands it", (t) => {
  const folders = ["fuzz/seeds/measurements", "fuzz/seeds/recorded", "fuzz/seeds/messages", "examples/elbow", "examples/howto"];
  const paths = folders.flatMap((name) => readdirSync(join(ROOT, name)).map((file) => join(ROOT, name, file))).filter((path) => statSync(path).isFile());
  let taken = 0;
  for (const path of paths) {
    const files = { "robot.urdf": robot, [basename(path)]: readFileSync(path) };
    const all = ["check", "robot.urdf", basename(path)];
    const here = poecal.run(all, files);
    const there = native(all, files);
    assert.deepEqual([here.code, here.out, here.err], [there.code, there.out, there.err], path);
    taken += here.code === 0;
  }
  t.diagnostic(`${paths.length} files, ${taken} of them taken`);
  // Most others are of other robots, or have one half of a session.
  assert.ok(taken >= 5, `${taken} files were taken`);
});

test("distances: the errors of the program", (t) => {
  // Directions that distances determine weakly let a fit end anywhere within the noise, from one of many starts: the last digits of sums choose.
  // Uncertainties of such directions differ in their fourth digit; errors, which all these fits share, agree.
  const files = { "robot.urdf": robot, "distances.csv": simulated("--kind", "distance", "--count", "120") };
  const words = ["calibrate", "robot.urdf", "distances.csv", "--out", "out", "--report", "none"];
  const here = poecal.run(words, files);
  const errors = (json) => JSON.stringify(JSON.parse(json).accuracy);
  for (const level of LEVELS) {
    const there = native(words, files, level);
    const most = difference(errors(text(here.files["out/calibration.json"])), errors(there.read("out/calibration.json")), `accuracy, ${level}`);
    t.diagnostic(`distances: errors differ by ${most.toExponential(1)} from ${level}`);
    assert.ok(most <= 1e-6, `${level}: ${most}`);
    assert.deepEqual([here.code, here.err], [there.code, there.err]);
  }
});

test("50,000 poses: the numbers of the program, and the time", (t) => {
  const files = { "robot.urdf": robot, "poses.csv": simulated("--kind", "pose", "--count", "50000") };
  const all = ["calibrate", "robot.urdf", "poses.csv", "--out", "out", "--report", "none"];
  const begin = process.cpuUsage();
  const here = poecal.run(all, files);
  const { user, system } = process.cpuUsage(begin);
  t.diagnostic(`50,000 poses: ${((user + system) / 1e6).toFixed(2)} s of processor time, files included`);
  for (const level of LEVELS) {
    const there = native(all, files, level);
    for (const file of ["calibration.json", "calibrated.urdf", "residuals.csv"]) {
      const most = difference(text(here.files[`out/${file}`]), there.read(`out/${file}`), `${file}, ${level}`);
      t.diagnostic(`50,000 poses: ${file} differs by ${most.toExponential(1)} from ${level}`);
      assert.ok(most <= NEAR, `${file}, ${level}: ${most}`);
    }
  }
});

test("60 poses: the time", (t) => {
  const files = { "robot.urdf": robot, ...cases.poses[1] };
  const times = [1, 2, 3].map(() => {
    const begin = process.cpuUsage();
    assert.equal(poecal.run(["calibrate", "robot.urdf", "poses.csv", "--out", "out"], files).code, 0);
    const { user, system } = process.cpuUsage(begin);
    return (user + system) / 1e3;
  });
  t.diagnostic(`60 poses: ${Math.min(...times).toFixed(0)} ms of processor time, files and report included`);
});

const good = example("elbow/points.csv");
const [header, ...rows] = good.split("\n").filter((line) => line && !line.startsWith("#"));
const bad = {
  "no such model": [["check", "other.urdf", "a.csv"], {}],
  "no such measurements": [["calibrate", "robot.urdf", "a.csv"], {}],
  "no words at all": [[], {}],
  "no such command": [["calibrat", "robot.urdf"], {}],
  "no such option": [["calibrate", "robot.urdf", "a.csv", "--held", "0.3"], { "a.csv": good }],
  "a wrong value": [["calibrate", "robot.urdf", "a.csv", "--held-out", "1.5"], { "a.csv": good }],
  "a wrong tolerance": [["calibrate", "robot.urdf", "a.csv", "--tolerance", "0.5deg"], { "a.csv": good }],
  "an empty file": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": "" }],
  "a header alone": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": `${header}\n` }],
  "a word for a number": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": [header, rows[0], rows[1].replace(/^[^,]*/, "many"), ...rows.slice(2)].join("\n") }],
  "a cell too few": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": [header, rows[0].replace(/,[^,]*$/, ""), ...rows.slice(1)].join("\n") }],
  "a joint that is not there": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": good.replace("joint4", "joint7") }],
  "a unit that is none": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": good.replace(/\[mm\]/, "[furlong]") }],
  "a workbook": [["calibrate", "robot.urdf", "a.csv"], { "a.csv": "PK\x03\x04 and so on" }],
  "no XML": [["check", "broken.urdf", "a.csv"], { "broken.urdf": "<robot><link</robot>", "a.csv": good }],
  "no robot": [["check", "broken.urdf", "a.csv"], { "broken.urdf": "<world/>", "a.csv": good }],
  "a folder as a file": [["check", "robot.urdf", "a"], { "a/": "" }],
  "a file on the way": [["calibrate", "robot.urdf", "a.csv", "--out", "robot.urdf/out"], { "a.csv": good }],
  "a folder that is missing": [["calibrate", "robot.urdf", "a.csv", "--out", "not/there"], { "a.csv": good }],
  "a file in the way": [["calibrate", "robot.urdf", "a.csv", "--out", "out"], { "a.csv": good, out: "mine" }],
  "a folder in the way": [["calibrate", "robot.urdf", "a.csv", "--out", "out"], { "a.csv": good, "out/notes.txt": "mine" }],
  "text that is no settings": [["calibrate"], { "poecal.toml": "model = 3" }],
  "a table for a calibration": [["validate", "a.csv", "a.csv"], { "a.csv": good }],
  "an export that is not public": [["export", "robot.urdf", "--format", "kuka"], {}],
};

test("wrong input: sentence and exit code of the program, and nothing written", () => {
  for (const [name, [words, inputs]] of Object.entries(bad)) {
    const files = { "robot.urdf": robot, ...inputs };
    const [here, there] = [poecal.run(words, files), native(words, files)];
    assert.equal(there.code, 2, `${name}: ${there.err}`);
    // A system adds the number of its error, and begins with a capital; the module has no commands of pictures, of drawings and of folders full of robots.
    const err = there.err
      .replace(/\((\w)([^()]*) \(os error \d+\)\)/g, (_, first, rest) => `(${first.toLowerCase()}${rest})`)
      .replace(/^ {2}(detect|board|fleet) .*\n( {10,}.*\n)*/gm, "");
    assert.deepEqual([here.code, here.out, here.err], [there.code, there.out, err], name);
    assert.deepEqual([here.files, here.removed], [{}, []], name);
  }
});

test("files: earlier results are exchanged, others' files stay, standard input is read", () => {
  const files = { "robot.urdf": robot, "a.csv": good };
  const words = ["calibrate", "robot.urdf", "a.csv", "--out", "out", "--force"];
  const first = poecal.run(words, files);
  assert.equal(first.code, 0);
  // Results of earlier runs that this one does not write are removed.
  const again = poecal.run([...words, "--report", "none"], { ...files, ...first.files });
  assert.deepEqual([again.code, again.removed], [0, ["out/report.html"]], again.err);
  assert.deepEqual(Object.keys(again.files), ["out/calibrated.urdf", "out/calibration.json", "out/residuals.csv"]);
  const mixed = poecal.run([...words, "--report", "none"], { ...files, ...first.files, "out/notes.txt": "mine" });
  assert.deepEqual([mixed.code, mixed.removed], [0, ["out/report.html"]], mixed.err);
  assert.ok(!("out/notes.txt" in mixed.files));
  const piped = poecal.run(["predict", "robot.urdf", "-"], new Map([["robot.urdf", robot]]), { input: "joint1,joint2,joint3,joint4,joint5,joint6\n0,0,0,0,0,0\n" });
  assert.equal(piped.code, 0, piped.err);
  assert.equal(piped.out.split("\n").length, 3);
  assert.throws(() => poecal.run(["check"], { "a.csv": 3 }), /a\.csv: found number, expected a string or a Uint8Array/);
});

test("--timings is refused where there is no clock", () => {
  const { code, err } = poecal.run(["calibrate", "robot.urdf", "a.csv", "--timings"], { "robot.urdf": robot, "a.csv": good });
  assert.equal(code, 2);
  assert.match(err, /^error: found --timings where the program has no clock/);
});

test("commands that need an operating system are refused", () => {
  for (const command of ["detect", "fleet"]) {
    const { code, err } = poecal.run([command, "a.png"], {});
    assert.equal(code, 2);
    assert.match(err, new RegExp(`^error: found ${command}, which this build of the program does not have`));
  }
});

test("the functions give what the commands give", () => {
  const result = poecal.calibrate({ model: robot, measurements: { "points.csv": good }, options: { heldOut: 0.2, fix: ["joint1", "joint2"] } });
  const { files } = poecal.run(["calibrate", "model", "points.csv", "--held-out", "0.2", "--fix", "joint1", "--fix", "joint2"], { model: robot, "points.csv": good });
  assert.equal(result.urdf, text(files["poecal-out/calibrated.urdf"]));
  assert.equal(result.residualsCsv, text(files["poecal-out/residuals.csv"]));
  assert.equal(result.json.verdict.level, result.verdict.level);
  assert.match(result.report, /^<!DOCTYPE html>/i);
  const joints = "joint1,joint2,joint3,joint4,joint5,joint6\n0.1,0.2,0.3,0.4,0.5,0.6\n";
  assert.equal(poecal.predict({ model: result.jsonText, joints }).split("\n").length, 3);
  assert.equal(typeof poecal.validate({ calibration: result.jsonText, measurements: good }), "object");
  assert.match(poecal.check({ model: robot, measurements: good }).table, /joint1/);
  assert.equal(typeof poecal.identify({ model: robot, joints }), "object");
  assert.match(poecal.exportAs("origins", { model: result.jsonText }), /joint1/);
  assert.deepEqual(Object.keys(poecal.simulate({ model: robot, options: { count: 5 } })).sort(), ["actual.urdf", "measurements.csv", "nominal.urdf", "truth.json"]);
});

test("an error has its place", () => {
  const call = { model: robot, measurements: { "points.csv": [header, rows[0].replace(/^[^,]*/, "many")].join("\n") } };
  assert.throws(
    () => poecal.calibrate(call),
    (error) => {
      assert.ok(error instanceof PoecalError);
      assert.deepEqual([error.code, error.file, error.line, error.column], [2, "points.csv", 2, 1], error.message);
      return true;
    },
  );
});

test("two files of one name are refused, not one of them taken", () => {
  const call = { model: robot, measurements: { "points.csv": good }, validate: { "points.csv": header } };
  assert.throws(
    () => poecal.calibrate(call),
    (error) => error instanceof PoecalError && error.code === 2 && error.message === "found two files named points.csv, expected another name for one of them",
  );
});

test("after a stop, the next call works; what is no module is refused", async () => {
  await assert.rejects(load(new Uint8Array([1, 2, 3])), WebAssembly.CompileError);
  const program = await load(readFileSync(join(DIST, "poecal.wasm")));
  const long = "a".repeat(1 << 20);
  assert.equal(program.run(["check", "robot.urdf"], { "robot.urdf": `<robot>${"<a>".repeat(200_000)}` }).code, 2);
  assert.equal(program.run([long]).code, 2);
  assert.equal(program.run(["--version"]).code, 0);
});

test("types: what users write passes, what is wrong does not", () => {
  execFileSync(process.execPath, [join(NPM, "types.mjs"), "--check"], { encoding: "utf8" });
  const tsc = join(ROOT, "web/node_modules/typescript/bin/tsc");
  execFileSync(process.execPath, [tsc, "--noEmit", "--strict", "--module", "nodenext", "--target", "es2022", "--lib", "es2022,dom", join(NPM, "types-test.ts")], { encoding: "utf8" });
});

test("the example of the README runs as it stands, from the package as it is packed", () => {
  const place = join(folder, "user");
  cpSync(DIST, join(place, "node_modules/poecal"), { recursive: true });
  writeFileSync(join(place, "robot.urdf"), robot);
  writeFileSync(join(place, "points.csv"), good);
  writeFileSync(join(place, "example.mjs"), readFileSync(join(NPM, "README.md"), "utf8").split("```js\n")[1].split("```")[0]);
  const said = execFileSync(process.execPath, ["example.mjs"], { cwd: place, encoding: "utf8" });
  assert.match(said, /^good 0\.\d+\n<\?xml|^good 0\.\d+\n<robot/);
});

test("the package: version, contents and size", (t) => {
  const manifest = JSON.parse(readFileSync(join(DIST, "package.json"), "utf8"));
  assert.equal(`poecal ${manifest.version}\n`, poecal.run(["--version"]).out);
  const [packed] = JSON.parse(execFileSync("npm", ["pack", "--dry-run", "--json"], { cwd: DIST, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }));
  const expected = ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "THIRD-PARTY.txt", "index.d.ts", "index.js", "package.json", "poecal.js", "poecal.wasm", "types.d.ts"];
  assert.deepEqual(packed.files.map(({ path }) => path).sort(), expected);
  const bytes = readFileSync(join(DIST, "poecal.wasm"));
  const [raw, small] = [bytes.length / 1e6, gzipSync(bytes, { level: 9 }).length / 1e6];
  t.diagnostic(`poecal.wasm: ${raw.toFixed(2)} MB, ${small.toFixed(2)} MB as gzip`);
  assert.ok(raw < MOST_RAW && small < MOST_SMALL, `${raw} MB, ${small} MB`);
});

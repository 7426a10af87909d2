// The page: files in, the program's words about them, a calibration, and its files out.
import { onColours, themeSwitch } from "../../src/theme.js";
import { showRobot } from "./arm.js";
import { MAPPING, choose, guessWords, showColumns } from "./columns.js";
import { calibrateWords, chainOf, checkWords, shown, validateWords } from "./command.js";
import { byId, counted, element } from "./dom.js";
import { Ended, Engine } from "./engine.js";
import { offerExports } from "./exports.js";
import { named } from "./foreign.js";
import { fromInput, fromText, fromTransfer } from "./intake.js";
import { messages, verdictOf } from "./sentences.js";
import { options } from "./options.js";
import { unpacked } from "./packed.js";
import { busy, say, showMessages } from "./progress.js";
import { clearResult, showCalibration, showPrinted, showText } from "./results.js";
import { besideUrdf, bySettings, guess } from "./roles.js";
import { findings, showFiles } from "./understood.js";

const engine = new Engine();
/** The files of the session: name, bytes and role. */
let files = [];
let calibration;
/** What the program found in the files when it was last asked. */
let found = new Map();
/** Sentences of files that are read in no way, by their names. */
let foreign = new Map();
/** What was chosen of the columns of a file. */
let columns = { file: undefined, chosen: [] };
/** Last links that the model's chain can have, and of which model. */
let tips = { of: undefined, links: [] };
let redrawRobot;
onColours(() => redrawRobot?.());
const words = options(byId("controls"), () => {
  clearResult();
  look();
});

/** Larger files that are not used are not handed to the program; smaller ones may be a robot's meshes, or named by an option. */
const MOST_UNUSED_BYTES = 64e6;
const read = () => files.filter((file) => file.role !== "unused" || file.bytes.length <= MOST_UNUSED_BYTES);

const having = (role) => files.filter((file) => file.role === role);
/** Whether the model is a calibration, which other measurements can judge. */
const judges = () => having("model").some(({ name, bytes }) => /\.json$/i.test(name) && /"schema"\s*:\s*"poecal-calibration/.test(new TextDecoder().decode(bytes.subarray(0, 1000))));

/** Messages of files that are named only, since they are read in no way. */
const naming = () => having("unused").flatMap(({ name }) => (foreign.has(name) ? [{ kind: having("model").length ? "warning" : "error", text: foreign.get(name) }] : []));

/** Runs a command line; none if it was ended, or if the program had a defect, which is then told. */
async function run(line, given, doing) {
  busy(doing);
  try {
    const result = await engine.run(line, given);
    return { ...result, files: Object.entries(result.files instanceof Map ? Object.fromEntries(result.files) : result.files) };
  } catch (error) {
    if (error instanceof Ended) return undefined;
    showMessages([{ kind: "error", text: error.message }], given);
    say("Stopped by an internal error of poecal.");
    return undefined;
  } finally {
    if (!engine.runs) busy(undefined);
  }
}

/** What is missing before anything can be calibrated, in a sentence; none if nothing is. */
function missing() {
  const [models, tables] = [having("model"), [...having("measurements"), ...having("validate")]];
  if (models.length > 1) return `found ${models.length} robot models, ${models.map((it) => it.name).join(" and ")}, expected one: remove the others, or choose “not used” for them`;
  for (const role of ["columns", "settings"]) {
    if (having(role).length > 1) return `found ${having(role).map((it) => it.name).join(" and ")} as ${role === "columns" ? "mapping of columns" : "settings"}, expected one file: remove the others, or choose “not used” for them`;
  }
  if (!models.length) return tables.length ? "Measurements are there; add a robot model: URDF, MJCF, SDF, TOML, or a calibration.json." : "Add a robot model and measurements.";
  if (!tables.length) return "The robot model is there; add measurements: a CSV with a row for each configuration.";
  const fitted = having("measurements").length || having("settings").length || judges();
  return fitted ? undefined : "Only validation measurements are there; add measurements to fit.";
}

/** Asks the program how the files are understood, and calibrates if `onwards` says so and nothing is missing. */
async function look(onwards = false) {
  engine.end();
  const lacking = missing();
  const refused = lacking?.startsWith("found");
  byId("calibrate").disabled = Boolean(lacking);
  byId("judge").hidden = !judges();
  byId("judge").disabled = Boolean(lacking);
  byId("files").hidden = !files.length;
  document.documentElement.toggleAttribute("data-files", files.length > 0);
  byId("line").textContent = lacking ? "" : shown(calibrateWords(files, words()));
  if (refused || !having("model").length) {
    showFiles(byId("list"), files, new Map(), change);
    showMessages([...(refused ? [{ kind: "error", text: lacking }] : []), ...naming()], files);
    say(refused ? "This cannot be calibrated yet." : lacking);
    for (const id of ["robot", "columns", "tip"]) byId(id).hidden = true;
    busy(undefined);
    return;
  }
  // Until it is understood anew.
  showFiles(byId("list"), files, found, change);
  const result = await run([...checkWords(files, words()), "--json"], read(), "reading");
  if (!result) return;
  const check = result.code === 0 ? JSON.parse(result.out) : undefined;
  // A model is shown also where the tables beside it are refused.
  const alone = check ? undefined : await run([...checkWords(having("model"), words()), "--json"], having("model"), "reading");
  const understood = check ?? (alone?.code === 0 ? JSON.parse(alone.out) : undefined);
  found = findings(understood);
  showFiles(byId("list"), files, found, change);
  offerTips(alone?.code && alone.out ? JSON.parse(alone.out).choices.of : undefined);
  drawRobot(understood?.model);
  const told = messages(result.err);
  const isOfColumns = told.some(({ kind, text }) => kind === "error" && /--columns|no column|\bunit\b/.test(text));
  const asks = (await offerColumns(Boolean(understood), told, isOfColumns)) && isOfColumns;
  for (const text of check?.warnings ?? []) if (!told.some((it) => it.text === text)) told.push({ kind: "warning", text });
  showMessages([...told, ...naming()], files);
  if (tips.links.length && result.code !== 0 && !understood) say("The model ends in several links: choose the last one.");
  else if (result.code !== 0) say(asks ? "The files are not understood yet: choose which column is which." : "The files are not understood yet.");
  else if (lacking) say(lacking);
  else if (onwards && !judges()) await calibrate();
  else say(`Understood: ${counted(check.files.reduce((sum, file) => sum + file.rows, 0), "row")}. Ready to ${judges() ? "judge the calibration, or to calibrate again" : "calibrate"}.`);
}

/** Shows the arm of a model that is understood. */
function drawRobot(model) {
  byId("robot").hidden = !model || !byId("result").hidden;
  redrawRobot = undefined;
  if (model) redrawRobot = showRobot(byId("drawn"), model);
}

/** Offers the last links that the chain can have, as long as the model is the same. */
function offerTips(links) {
  const [model] = having("model");
  if (links) tips = { of: model.bytes, links };
  if (tips.of !== model.bytes) tips = { of: undefined, links: [] };
  byId("tip").hidden = !tips.links.length;
  const field = byId("option--tip-link");
  byId("tips").replaceChildren(...["", ...tips.links].map((value) => element("option", { value, textContent: value || "choose a link", selected: value === field.value.trim() })));
}

/** The mapping that this page made, if it is used. */
const made = () => having("columns").find((file) => file.made);

/** Offers pull-downs for the columns of the first table, unless a mapping was dropped; whether they are there. */
async function offerColumns(understood, told, open) {
  const place = byId("columns");
  const tables = [...having("measurements"), ...having("validate")];
  const table = tables.find(({ name }) => told.some(({ text }) => text.startsWith(`${name}:`))) ?? tables[0];
  const [model] = having("model");
  place.hidden = true;
  if (!understood || !table || (having("columns").length && !made())) return false;
  if (columns.file !== table.name) columns = { file: table.name, chosen: [] };
  const result = await run(guessWords(model.name, table.name, columns.chosen, chainOf(words())), [model, table], "reading");
  // What has no columns of its own has none to choose.
  if (result?.code !== 0) return false;
  const guess = JSON.parse(result.out);
  const read = () => {
    const bytes = new TextEncoder().encode(guess.mapping);
    files = [...files.filter((file) => file.name !== MAPPING), { name: MAPPING, bytes, role: "columns", made: true }];
    clearResult();
    look(true);
  };
  const take = async (key, value) => {
    columns.chosen = choose(columns.chosen, key, value);
    // What was read otherwise counts no longer.
    if (made()) files = files.filter((file) => file !== made());
    clearResult();
    look();
  };
  const used = Boolean(made()) && new TextDecoder().decode(made().bytes) === guess.mapping;
  showColumns(place, { file: table.name, guess, used, open: open || (columns.chosen.length > 0 && !used) }, take, read);
  return true;
}

async function calibrate(asked = false) {
  clearResult();
  const line = calibrateWords(files, words());
  byId("line").textContent = shown(line);
  const started = performance.now();
  const result = await run(line, read(), "calibrating");
  if (!result) return;
  showMessages([...messages(result.err), ...naming()], files);
  calibration = result.files.find(([path]) => path.endsWith("calibration.json"))?.[1];
  if (!calibration) {
    if (result.out) showText("What the program prints", result.out);
    say("There is no result.");
    if (asked) byId("messages").focus();
    return;
  }
  showPrinted("What the program prints", result.out, result.code !== 0);
  showCalibration(result.files);
  byId("robot").hidden = true;
  const verdict = verdictOf(result.out);
  say(`Calibrated in ${((performance.now() - started) / 1000).toFixed(1)} s${verdict ? `; the verdict: ${verdict}` : ""}.`);
  if (asked) byId("result-title").focus();
}

async function judge() {
  clearResult();
  const line = validateWords(files, words());
  byId("line").textContent = shown(line);
  const result = await run(line, read(), "judging");
  if (!result) return;
  showMessages([...messages(result.err), ...naming()], files);
  if (!result.out) return say("There is no result.");
  showText("The calibration on these measurements", result.out);
  say("Judged.");
  byId("result-title").focus();
}

/** Takes files in, in place of those of the same names. */
async function add(taken) {
  if (!taken.length) return;
  const sentences = await nameForeign(taken);
  for (const { name } of taken) foreign.delete(name);
  for (const [name, text] of sentences) foreign.set(name, text);
  // A file that comes again keeps its role.
  const roles = new Map(files.map((file) => [file.name, file.role]));
  const added = taken.map(({ name, bytes, whole }) => ({ name, bytes, role: roles.get(name) ?? (sentences.has(name) ? "unused" : guess(name, bytes, whole)) }));
  files = [...files.filter((file) => !added.some((it) => it.name === file.name)), ...added];
  for (const file of besideUrdf(added.filter((it) => it.role === "model"))) file.role = "unused";
  // A new model takes the place of the one before, and with measurements of its own that of all measurements.
  const fresh = (role) => added.filter((it) => it.role === role && !roles.has(it.name)).length;
  const replaced = fresh("model") === 1 ? ["model", ...(fresh("measurements") ? ["measurements", "validate"] : [])] : [];
  for (const role of replaced) for (const file of having(role)) if (!added.includes(file)) file.role = "unused";
  for (const settings of having("settings")) for (const [file, role] of bySettings(settings, files)) file.role = role;
  clearResult();
  return look(true);
}

/** What the program says of files that it reads in no way. */
async function nameForeign(taken) {
  try {
    return await named(engine, taken);
  } catch {
    // A run was ended, or the program cannot start, which is told when it is asked next.
    return new Map();
  }
}

function change(file, role) {
  if (role) file.role = role;
  else files = files.filter((it) => it !== file);
  clearResult();
  look();
  if (!role) byId("choose").focus();
}

/** Reads what `reading` promises, and says so if it cannot be read. */
async function take(reading) {
  let taken;
  busy("reading");
  try {
    taken = await reading;
  } catch (error) {
    showMessages([{ kind: "error", text: `a file could not be read (${error.message}): choose it again` }], files);
    return;
  } finally {
    if (!engine.runs) busy(undefined);
  }
  await add(taken);
}

function wire() {
  for (const [button, input] of [["choose", "chosen"], ["choose-folder", "chosen-folder"]]) {
    byId(button).addEventListener("click", () => byId(input).click());
    byId(input).addEventListener("change", async ({ target }) => {
      await take(fromInput(target));
      target.value = "";
    });
  }
  let inside = 0;
  const over = (step) => (event) => {
    event.preventDefault();
    inside = Math.max(0, inside + step);
    document.documentElement.toggleAttribute("data-over", inside > 0);
  };
  addEventListener("dragenter", over(1));
  addEventListener("dragleave", over(-1));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    over(-Infinity)(event);
    take(fromTransfer(event.dataTransfer));
  });
  addEventListener("paste", (event) => {
    if (event.target.closest?.("input, textarea")) return;
    const text = event.clipboardData.getData("text/plain");
    if (event.clipboardData.files.length) take(fromTransfer(event.clipboardData));
    else if (text.trim()) add([fromText(text)]);
  });
  byId("use-pasted").addEventListener("click", () => byId("pasted").value.trim() && add([fromText(byId("pasted").value)]));
  byId("example").addEventListener("click", async () => {
    const example = JSON.parse(new TextDecoder().decode(await unpacked("examples")));
    files = [];
    add(Object.entries(example).map(([name, text]) => ({ name, bytes: new TextEncoder().encode(text), whole: false })));
  });
  byId("tips").addEventListener("change", ({ target }) => {
    byId("option--tip-link").value = target.value;
    byId("option--tip-link").dispatchEvent(new Event("change"));
  });
  byId("calibrate").addEventListener("click", () => calibrate(true));
  byId("judge").addEventListener("click", judge);
  byId("cancel").addEventListener("click", () => {
    engine.end();
    busy(undefined);
    say("Cancelled.");
    byId("calibrate").focus();
  });
  byId("licences").addEventListener("toggle", async ({ target }) => {
    const place = target.querySelector("pre");
    if (target.open && !place.textContent) place.textContent = new TextDecoder().decode(await unpacked("licence-texts"));
  });
}

offerExports(async (line) => {
  const others = read().filter((file) => file.name !== "calibration.json");
  const result = await run(line, [...others, { name: "calibration.json", bytes: calibration }], "writing");
  if (!result) return undefined;
  showMessages(messages(result.err), files, byId("export-messages"));
  say(result.code === 0 ? "Written: it is in the list." : "This form was not written.");
  return result.files;
});
wire();
themeSwitch(document.querySelector(".theme"));
busy(undefined);
say(missing());
document.documentElement.dataset.ready = "true";

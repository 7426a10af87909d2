// What a file is that is neither a model nor measurements: a PDF, a drawing, a picture. The program names it.
import { isOpen } from "./roles.js";
import { foreign } from "./sentences.js";

/** A robot, so that the program reads a file as measurements. */
const ROBOT = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>';
/** As many bytes tell enough. */
const HEAD = 1 << 16;

/** The program's sentences for those of the files that it reads in no way, by their names. */
export async function named(engine, files) {
  const found = new Map();
  for (const { name, bytes, whole } of files) {
    // What comes with a folder is not all meant.
    if (whole || !isOpen(name, bytes)) continue;
    const given = [{ name, bytes: bytes.slice(0, HEAD) }, { name: "model of the page.urdf", bytes: new TextEncoder().encode(ROBOT) }];
    const asModel = await engine.run(["check", name], given);
    const asTable = asModel.code && (await engine.run(["check", given[1].name, name], given));
    const sentence = asTable && foreign(name, asModel.err, asTable.err);
    if (sentence) found.set(name, sentence);
  }
  return found;
}

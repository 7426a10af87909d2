// The program in a worker, so that the page stays alive and a run can be ended.
import { load } from "../../npm/poecal.js";

let program;
self.onmessage = async ({ data: { module, run } }) => {
  try {
    if (module) program = load(module);
    const poecal = await program;
    if (run) self.postMessage({ done: poecal.run(run.words, run.files) });
  } catch (error) {
    self.postMessage({ failed: String(error?.message ?? error) });
  }
};

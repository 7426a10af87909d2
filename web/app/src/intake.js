// Files from a drop, a choice or the clipboard, with the paths that they have within what was dropped.

/** Every file of a folder, or the file itself. */
async function within(entry, path) {
  if (entry.isFile) {
    const file = await new Promise((done, failed) => entry.file(done, failed));
    return [{ path: path + entry.name, file }];
  }
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    // A reader gives a hundred at a time.
    const some = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!some.length) break;
    for (const it of some) found.push(...(await within(it, `${path}${entry.name}/`)));
  }
  return found;
}

/** What was dropped or pasted: names and bytes, and whether it was a folder. Must be called within the event. */
export async function fromTransfer(transfer) {
  const entries = [...transfer.items].filter((item) => item.kind === "file").map((item) => item.webkitGetAsEntry?.() ?? item.getAsFile());
  const found = [];
  for (const entry of entries) {
    if (entry instanceof File) found.push({ path: entry.name, file: entry });
    else if (entry) found.push(...(await within(entry, "")));
  }
  return read(found);
}

/** What was chosen by a file button. */
export function fromInput(input) {
  return read([...input.files].map((file) => ({ path: file.webkitRelativePath || file.name, file })));
}

async function read(found) {
  const whole = found.some(({ path }) => path.includes("/"));
  // A folder's own name is not a part of what its settings call their files.
  const top = /^[^/]+\//.exec(found[0]?.path ?? "")?.[0];
  const common = top && found.every(({ path }) => path.startsWith(top)) ? top.length : 0;
  return Promise.all(
    found.map(async ({ path, file }) => ({ name: plain(path.slice(common)), bytes: new Uint8Array(await file.arrayBuffer()), whole })),
  );
}

/** A name that is not taken for an option, or for standard input. */
export function plain(name) {
  return name.replace(/^-/, "_");
}

/** Pasted text as a file. */
export function fromText(text) {
  return { name: /^\s*</.test(text) ? "pasted.urdf" : "pasted.csv", bytes: new TextEncoder().encode(text), whole: false };
}

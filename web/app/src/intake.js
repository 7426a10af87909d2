// Files from a drop, a choice or the clipboard, with the paths that they have within what was dropped.

/** The files of a folder, by its handle. */
async function withinHandle(folder, path) {
  const found = [];
  for await (const [name, it] of folder.entries()) {
    if (it.kind === "directory") found.push(...(await withinHandle(it, `${path}${name}/`)));
    else found.push({ path: path + name, file: await it.getFile() });
  }
  return found;
}

/** The same by its entry, where a browser has no handles. */
async function withinEntry(entry, path) {
  if (entry.isFile) return [{ path: path + entry.name, file: await new Promise((done, failed) => entry.file(done, failed)) }];
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    // A reader gives a hundred at a time.
    const some = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (!some.length) break;
    for (const it of some) found.push(...(await withinEntry(it, `${path}${entry.name}/`)));
  }
  return found;
}

/** What was dropped or pasted: names and bytes, and whether it was a folder. Must be called within the event. */
export async function fromTransfer(transfer) {
  // All is asked for at once: after the event the items are gone. Chromium reads entries on a server only, and handles everywhere.
  const items = [...transfer.items].filter((item) => item.kind === "file");
  const asked = items.map((item) => {
    const entry = item.webkitGetAsEntry?.();
    if (!entry?.isDirectory) return [{ path: item.getAsFile().name, file: item.getAsFile() }];
    return item.getAsFileSystemHandle ? item.getAsFileSystemHandle().then((folder) => withinHandle(folder, `${folder.name}/`)) : withinEntry(entry, "");
  });
  return read((await Promise.all(asked)).flat());
}

/** What was chosen by a file button. */
export function fromInput(input) {
  return read([...input.files].map((file) => ({ path: file.webkitRelativePath || file.name, file })));
}

/** The bytes of files. A folder's own name stays in their paths, since a URDF may call its meshes by it. */
async function read(found) {
  const whole = found.some(({ path }) => path.includes("/"));
  const named = distinct(found.filter(({ path }) => !whole || !/(^|\/)\.[^/]+\//.test(path)));
  return Promise.all(named.map(async ({ name, file }) => ({ name, bytes: await bytesOf(name, file), whole })));
}

/** The bytes of a file. */
async function bytesOf(name, file) {
  try {
    return new Uint8Array(await file.arrayBuffer());
  } catch (error) {
    throw new Error(`${name}: ${error.message}`);
  }
}

/** Files of one drop with a name each: a second `a.csv` is `a-2.csv`. */
export function distinct(found) {
  const taken = new Set();
  return found.map(({ path, file }) => {
    const [, stem, end] = /^(.*?)(\.[^./]*)?$/s.exec(plain(path));
    let name = plain(path);
    for (let k = 2; taken.has(name); k += 1) name = `${stem}-${k}${end ?? ""}`;
    taken.add(name);
    return { name, file };
  });
}

/** A name that is not taken for an option, or for standard input. */
export function plain(name) {
  return name.replace(/^-/, "_");
}

/** Pasted text as a file. */
export function fromText(text) {
  return { name: /^\s*</.test(text) ? "pasted.urdf" : "pasted.csv", bytes: new TextEncoder().encode(text), whole: false };
}

// What a file is for. The first guess is by its name and first characters; the program then says what it finds in it.

/** The roles, and what they are called on the page. */
export const ROLES = {
  model: "robot model",
  measurements: "measurements",
  validate: "measurements to judge by",
  columns: "mapping of columns",
  settings: "settings",
  unused: "not used",
};

const TABLES = /\.(csv|tsv|txt|dat|asc)$/i;
const MODELS = /\.(urdf|xacro|xml|sdf|mjcf|world|json|ya?ml|conf)$/i;
/** Files that are neither, wherever they come from. */
const OTHERS = /\.(md|html?|stl|dae|obj|ply|png|jpe?g|svg|gif|py|sh|rs|js|log|bag|db3)$/i;
/** What lies in folders beside a session and is neither: these, other documents, and results. */
const BESIDE = /\.(pdf|docx?|xlsx?|zip|gz)$|(^|\/)(residuals|joints)\.csv$|(^|\/)\./i;
/** As many characters tell enough. */
const HEAD = 4096;

/** The guess for one file of a drop; `whole` says that it came with a folder, in which not everything is meant. */
export function guess(name, bytes, whole = false) {
  if (OTHERS.test(name) || (whole && BESIDE.test(name))) return "unused";
  const head = new TextDecoder().decode(bytes.subarray(0, HEAD)).replace(/^\uFEFF/, "");
  if (/\.toml$/i.test(name)) {
    if (/^\s*poecal_robot\s*=/m.test(head)) return "model";
    return /^\s*poecal_settings\s*=/m.test(head) || /(^|\/)poecal\.toml$/i.test(name) ? "settings" : "columns";
  }
  if (/^\s*</.test(head)) return "model";
  if (TABLES.test(name)) return "measurements";
  return MODELS.test(name) ? "model" : "measurements";
}

/** Whether the name and the beginning of a file leave open what it is. */
export function isOpen(name, bytes) {
  return OTHERS.test(name) || (!TABLES.test(name) && !MODELS.test(name) && !/\.toml$/i.test(name) && bytes[0] !== 0x3c);
}

/** Of several models in one folder, those that are not used because one of them is the URDF. */
export function besideUrdf(models) {
  const urdf = models.filter(({ name }) => /\.urdf$/i.test(name));
  return urdf.length === 1 ? models.filter((it) => it !== urdf[0]) : [];
}

/** Texts of a key at the top of a settings file: those of `key = "…"` or `key = ["…", …]`. */
function named(text, key) {
  const found = new RegExp(`^\\s*${key}\\s*=\\s*("[^"]*"|'[^']*'|\\[[^\\]]*\\])`, "m").exec(text);
  return found ? [...found[1].matchAll(/"([^"]*)"|'([^']*)'/g)].map((it) => it[1] ?? it[2]) : undefined;
}

/** The roles that a settings file gives: each named file has its own, and other tables and models are not used. */
export function bySettings(settings, files) {
  const text = new TextDecoder().decode(settings.bytes);
  const folder = settings.name.replace(/[^/]*$/, "");
  const asked = { model: "model", columns: "columns", measurements: "measurements", validate: "validate" };
  const roles = new Map();
  for (const [key, role] of Object.entries(asked)) {
    const names = named(text, key)?.map((name) => folder + name.replace(/^\.\//, ""));
    if (!names) continue;
    for (const file of files) {
      if (names.includes(file.name)) roles.set(file, role);
      else if (file.role === role && files.some((other) => names.includes(other.name))) roles.set(file, "unused");
    }
  }
  return roles;
}

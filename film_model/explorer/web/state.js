// Scenes: from the data, from and to the fragment of the address, as scene files.

const CHOICES = ["auto", "true", "false"];

/** @param {any} base @returns {Scene} */
function sceneOf(base) {
  /** @type {Record<string, any>} */
  const values = {};
  /** @type {Record<string, string>} */
  const materials = {};
  for (const input of base.inputs) values[input.path] = input.value;
  for (const body of ["impactor", "target"]) {
    const material = base.table[body].material;
    if (material) materials[body] = typeof material === "string" ? material : (material.name ?? "");
  }
  const { title, law, effects, tolerance, solver } = base;
  const scene = { base, values, materials, title, edges: edgesOfTable(base.table.target), law, effects: { ...effects }, tolerance, solver: { ...solver } };
  chooseLaw(scene, law);
  return scene;
}

/** The edges of a plate at x = 0, x = a, y = 0, y = b. @param {any} target @returns {string[]} */
function edgesOfTable({ edges = DATA.edges[0] }) {
  return typeof edges === "string" ? [edges, edges, edges, edges] : [...edges];
}

/** One word, if all edges are alike. @param {Scene} scene */
const edgesForTable = ({ edges }) => (new Set(edges).size === 1 ? edges[0] : edges);

/** The law of that name among those that the page has for a scene. @param {Scene} scene @param {string} name */
function lawNamed(scene, name) {
  return scene.base.laws.map((/** @type {number} */ index) => DATA.laws[index]).find((/** @type {any} */ law) => law.name === name);
}

/** The entries of a scene: those of its bodies, and those of its law. @param {Scene} scene @returns {any[]} */
function inputsOf(scene) {
  return [...scene.base.inputs, ...(lawNamed(scene, scene.law)?.live ?? [])];
}

/** Give the scene another law, with the parameters that it starts from. @param {Scene} scene @param {string} name */
function chooseLaw(scene, name) {
  for (const input of lawNamed(scene, scene.law)?.live ?? []) delete scene.values[input.path];
  scene.law = name;
  for (const input of lawNamed(scene, name)?.live ?? []) scene.values[input.path] = input.value;
}

/** A copy. @param {Scene} scene @returns {Scene} */
function copyOf(scene) {
  const { values, materials, edges, effects, solver } = scene;
  return { ...scene, edges: [...edges], values: { ...values }, materials: { ...materials }, effects: { ...effects }, solver: { ...solver } };
}

/** Whether a value is in the range of its entry. @param {any} input @param {number} value */
function inRange(input, value) {
  if (!Number.isFinite(value)) return false;
  return input.open ? value > input.low && value < input.high : value >= input.low && value <= input.high;
}

/** @param {any} input */
function rangeText(input) {
  return `from ${shown(input.low, input.dimension, 3)} to ${shown(input.high, input.dimension, 3)}`;
}

/** Whether a scene is as given, but for its title. @param {Scene} scene */
function unchanged(scene) {
  return fragmentOf({ ...scene, title: scene.base.title }) === fragmentOf(sceneOf(scene.base));
}

/** The scene as a fragment: its name, and what differs from it. @param {Scene} scene */
function fragmentOf(scene) {
  const start = sceneOf(scene.base);
  const found = new URLSearchParams({ scene: scene.base.name });
  if (scene.law !== start.law) found.set("law", scene.law);
  chooseLaw(start, scene.law);
  for (const [path, value] of Object.entries(scene.values)) {
    if (String(value) !== String(start.values[path])) found.set(path, Array.isArray(value) ? tableText(value) : String(value));
  }
  for (const [body, name] of Object.entries(scene.materials)) {
    if (name !== start.materials[body]) found.set(`${body}.material`, name);
  }
  if (scene.edges.join() !== start.edges.join()) found.set("target.edges", String(edgesForTable(scene)));
  if (scene.title !== start.title) found.set("title", scene.title);
  for (const [name, value] of Object.entries(scene.effects)) {
    if (value !== start.effects[name]) found.set(name, String(value));
  }
  for (const name of /** @type {const} */ (["accuracy", "segments", "linearisation"])) {
    if (scene.solver[name] !== start.solver[name]) found.set(name, String(scene.solver[name]));
  }
  if (scene.tolerance !== start.tolerance) found.set("tolerance", String(scene.tolerance));
  return found.toString();
}

/**
 * The scene of a fragment; entries that are not understood are left out and named.
 * @param {string} fragment @returns {{scene: Scene, ignored: string[]}}
 */
function sceneOfFragment(fragment) {
  const given = new URLSearchParams(fragment);
  const name = given.get("scene");
  const base = DATA.scenes.find((/** @type {any} */ entry) => entry.name === name) ?? DATA.scenes[0];
  const scene = sceneOf(base);
  const ignored = name !== null && base.name !== name ? ["scene"] : [];
  for (const [key, text] of given) {
    if (key !== "scene" && key !== "compare" && !applied(scene, key, text)) ignored.push(key);
  }
  return { scene, ignored };
}

/** The pairs of a table of friction as in a scene file. @param {number[]} table @returns {[string, number][]} */
const pairsOf = (table) => table.flatMap((speed, k) => (k % 2 ? [] : [[`${speed} m/s`, table[k + 1]]]));

/** A table of friction in words, as it is typed too. @param {number[]} table */
const tableText = (table) => pairsOf(table).map(([speed, friction]) => `${friction} at ${speed}`).join(", ");

/** The table of friction of words; null of others. @param {any} input @param {string} text @returns {number[]|null} */
function tableOfText(input, text) {
  if (input.path !== "contact.friction") return null;
  const table = text.split(",").flatMap((pair) => {
    const [friction, speed = ""] = pair.split(" at ");
    return [parseValue(speed, "velocity", "m/s").value ?? NaN, parseValue(friction, "dimensionless", "").value ?? NaN];
  });
  const fits = table.every((x, k) => (k % 2 ? inRange(input, x) : x >= 0 && x <= DATA.constants.friction.fastest && !(x <= table[k - 2])));
  return fits && table.length > 2 ? table : null;
}

/** Put one entry of a fragment into a scene; whether it is understood. @param {Scene} scene @param {string} key @param {string} text */
function applied(scene, key, text) {
  const input = inputsOf(scene).find((/** @type {any} */ entry) => entry.path === key);
  const number = Number(text);
  const between = (/** @type {number} */ low, /** @type {number} */ high) => number >= low && number <= high;
  if (input) {
    const none = text === "null" && input.optional;
    const table = tableOfText(input, text);
    if (!none && !table && (text.trim() === "" || !inRange(input, number))) return false;
    scene.values[key] = none ? null : (table ?? number);
  } else if (key.endsWith(".material") && key.slice(0, -9) in scene.materials) {
    scene.materials[key.slice(0, -9)] = text.slice(0, 200);
  } else if (key === "target.edges" && scene.base.plate) {
    const edges = edgesOfTable({ edges: text.includes(",") ? text.split(",") : text });
    if (edges.length !== 4 || !edges.every((edge) => DATA.edges.includes(edge))) return false;
    scene.edges = edges;
  } else if (key === "title") {
    scene.title = text.slice(0, 500);
  } else if (key === "law" && lawNames(scene).includes(text)) {
    chooseLaw(scene, text);
  } else if (key in scene.effects && CHOICES.includes(text)) {
    scene.effects[key] = text === "auto" ? text : text === "true";
  } else if (key === "accuracy" && between(1e-14, 0.1)) {
    Object.assign(scene.solver, { accuracy: number, segments: null });
  } else if (key === "segments" && between(1, 1e5) && Number.isInteger(number)) {
    Object.assign(scene.solver, { accuracy: null, segments: number });
  } else if (key === "linearisation" && ["work-preserving", "chord"].includes(text)) {
    scene.solver.linearisation = text;
  } else if (key === "tolerance" && between(1e-12, 1)) {
    scene.tolerance = number;
  } else {
    return text === "null" && (key === "accuracy" || key === "segments" || key === "tolerance");
  }
  return true;
}

/** Names of the laws that the page has for a scene. @param {Scene} scene @returns {string[]} */
function lawNames(scene) {
  const names = scene.base.laws.map((/** @type {number} */ index) => DATA.laws[index].name);
  return [...new Set(["auto", .../** @type {string[]} */ (names), scene.base.law])];
}

/** The scene as nested tables, as in a scene file. @param {Scene} scene */
function tableOf(scene) {
  const table = structuredClone(scene.base.table);
  table.title = scene.title;
  for (const [body, name] of Object.entries(scene.materials)) {
    if (name === sceneOf(scene.base).materials[body] && typeof table[body].material !== "string") continue;
    if (typeof table[body].material !== "string" || name !== table[body].material) table[body].material = { name };
  }
  const sided = scene.base.plate ? ["size", "position"] : [];
  for (const name of sided) table.target[name] = [];
  for (const input of scene.base.inputs) {
    const path = input.path.split(".");
    const last = path.pop();
    const owner = path.reduce((/** @type {any} */ at, /** @type {string} */ key) => materialTable(at, key), table);
    const value = scene.values[input.path];
    if (value === null) delete owner[last];
    else if (Array.isArray(value)) owner[last] = pairsOf(value);
    else owner[last] = input.unit ? `${value} ${input.unit}` : value;
  }
  for (const name of sided) { // without the values that are missing
    table.target[name] = table.target[name].filter(() => true);
    if (!table.target[name].length) delete table.target[name];
  }
  if (scene.base.plate) table.target.edges = edgesForTable(scene);
  setLaw(scene, (table.contact ??= {}));
  table.effects = { ...table.effects, ...scene.effects };
  if (scene.tolerance !== null) table.effects.tolerance = scene.tolerance;
  table.solver = Object.fromEntries(Object.entries(scene.solver).filter(([, value]) => value !== null));
  return table;
}

/** The table of an entry; a material's name becomes a table. @param {any} owner @param {string} key */
function materialTable(owner, key) {
  if (typeof owner[key] === "string") owner[key] = { name: owner[key] };
  return (owner[key] ??= {});
}

/** Write the scene's law and its own parameters into the table [contact]. @param {Scene} scene @param {any} contact */
function setLaw(scene, contact) {
  if (scene.law !== scene.base.law) {
    for (const index of scene.base.laws) for (const key of Object.keys(DATA.laws[index].own)) delete contact[key];
    if (scene.base.law !== "auto" || lawNamed(scene, scene.law)?.family === "damped") delete contact.unloading;
  }
  contact.law = scene.law;
  const n = numbersOf(scene);
  const { law } = scene.law === "auto" ? { law: null } : lawOf(scene, n, scene.law);
  if (!law) return;
  const own = withOwn(law, n);
  for (const { path, unit } of law.live) {
    const value = own[path.replace("contact.", "own_")];
    contact[path.replace("contact.", "")] = unit ? `${value} ${unit}` : value;
  }
}

/** A text or another value as TOML writes it. @param {any} value @returns {string} */
function tomlValue(value) {
  if (typeof value === "string") {
    const wellFormed = value.replace(/[\ud800-\udbff](?![\udc00-\udfff])|(?<![\ud800-\udbff])[\udc00-\udfff]/gu, "\ufffd");
    return JSON.stringify(wellFormed).replaceAll("\u007f", "\\u007f");
  }
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(", ")}]`;
  return String(value);
}

/** @param {string} key */
function tomlKey(key) {
  return /^[A-Za-z0-9_-]+$/u.test(key) ? key : tomlValue(key);
}

/** @param {any} table @param {string} path @returns {string[]} */
function tomlLines(table, path) {
  const entries = Object.entries(table).filter(([, value]) => value !== null && value !== undefined);
  const isTable = (/** @type {any} */ value) => typeof value === "object" && !Array.isArray(value);
  const lines = entries.filter(([, value]) => !isTable(value)).map(([key, value]) => `${tomlKey(key)} = ${tomlValue(value)}`);
  for (const [key, value] of entries.filter(([, value]) => isTable(value))) {
    const name = path ? `${path}.${tomlKey(key)}` : tomlKey(key);
    lines.push("", `[${name}]`, ...tomlLines(value, name));
  }
  return lines;
}

/** The text of a scene file. @param {Scene} scene */
function sceneFile(scene) {
  return `${tomlLines(tableOf(scene), "").join("\n")}\n`;
}

/** A Python script that simulates the scene. @param {Scene} scene */
function pythonScript(scene) {
  const text = sceneFile(scene).replaceAll("\\", "\\\\").replaceAll('"""', '\\"\\"\\"');
  return `import film_model as fm\n\nscene = fm.Scene.from_text("""\n${text}""")\nhistory = fm.simulate(scene)\nprint(history.summary)\n`;
}

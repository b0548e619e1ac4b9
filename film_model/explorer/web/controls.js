// The form: fields with units, sliders, choices.

const STEPS = 1000;

const SCALED_TARGET = "Size, edges and place of the target cannot change here; its vibrations scale with the numbers below.";
const FIXED_TARGET = "What the target is made of cannot change here: how it moves was computed when this page was written.";

/** @param {string} id */
function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`no element ${id}`);
  return found;
}

/** @param {string} text */
function say(text) {
  byId("said").textContent = text;
}

/** @template {keyof HTMLElementTagNameMap} K @param {K} name @param {Record<string, string>} attributes @param {(Node|string)[]} children */
function made(name, attributes, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** The units in which the reader writes the entries. @type {Record<string, string>} */
const UNITS = {};

/** @param {any} input @param {any} value */
function fieldText(input, value) {
  if (value === null) return "";
  if (Array.isArray(value)) return tableText(value);
  if (input.dimension === "dimensionless") return String(value);
  const unit = (UNITS[input.path] ??= readableUnit(value, input.dimension));
  return `${shortNumber(value / sizeOf(unit), 12)} ${unit.replaceAll("*", "·")}`;
}

/** @param {any} input @param {number[]} range of the slider @param {number} place of the slider @returns {number} */
function sliderValue(input, [low, high], place) {
  const share = place / STEPS;
  const value = input.logarithmic ? low * (high / low) ** share : low + (high - low) * share;
  const unit = input.dimension === "angle" ? sizeOf("deg") : 1;
  return Math.min(Math.max(Number((value / unit).toPrecision(3)) * unit, low), high);
}

/** @param {any} input @param {number[]} range of the slider @param {number} value */
function sliderPlace(input, [low, high], value) {
  if (!Number.isFinite(value)) return 0;
  const share = input.logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return Math.round(STEPS * Math.min(Math.max(share, 0), 1));
}

/**
 * One entry: a field for a value with a unit and, outside of materials, a slider.
 * @param {Scene} scene @param {any} input @param {() => void} changed
 */
function entryRow(scene, input, changed) {
  const id = `entry-${input.path.replaceAll(".", "-")}`;
  const field = made("input", { id, type: "text", autocomplete: "off", spellcheck: "false", "data-path": input.path });
  const error = made("span", { id: `${id}-error`, class: "error", role: "alert" });
  field.setAttribute("aria-describedby", error.id);
  const row = made("div", { class: "entry" }, made("label", { for: id }, input.label), field);
  if (input.optional) field.placeholder = input.empty;
  const slider = made("input", { type: "range", min: "0", max: String(STEPS), "aria-label": `${input.label}, slider` });
  let range = input.slider;
  const present = () => { // a missing mass follows the radius, and so does its slider
    const value = entriesOf(scene)[input.path];
    if (input.path.startsWith("target.position.")) range = [0, scene.values[input.path.replace("position", "size")] ?? input.slider[1]];
    const middle = Math.sqrt(input.slider[0] * input.slider[1]);
    if (scene.values[input.path] === null && input.logarithmic && Number.isFinite(value)) range = input.slider.map((/** @type {number} */ end) => (end * value) / middle);
    return value;
  };
  const show = () => {
    field.title = field.value = fieldText(input, scene.values[input.path]);
    slider.value = String(sliderPlace(input, range, present()));
    slider.setAttribute("aria-valuetext", field.value || field.placeholder);
    field.removeAttribute("aria-invalid");
    error.textContent = "";
  };
  field.addEventListener("change", () => {
    const problem = typed(scene, input, field.value);
    if (problem) {
      field.setAttribute("aria-invalid", "true");
      error.textContent = problem;
      return;
    }
    show();
    changed();
  });
  slider.addEventListener("input", () => {
    present();
    scene.values[input.path] = sliderValue(input, range, Number(slider.value));
    show();
    changed();
  });
  if (!input.path.includes(".material.")) row.append(slider);
  row.append(error);
  show();
  return { row, show };
}

/** Take a typed text as the value of an entry; returns what is wrong with it. @param {Scene} scene @param {any} input @param {string} text */
function typed(scene, input, text) {
  if (!text.trim()) {
    if (!input.optional) return "a value is needed";
    scene.values[input.path] = null;
    return "";
  }
  const table = tableOfText(input, text);
  if (table) {
    scene.values[input.path] = table;
    return "";
  }
  const unit = UNITS[input.path] || input.unit;
  const found = parseValue(text, input.dimension, unit);
  if (found.value === undefined) {
    return input.path === "contact.friction" ? "write a number, or pairs of a number and a rising speed, as in 0.5 at 0 m/s, 0.2 at 1 m/s" : found.error;
  }
  if (!inRange(input, found.value)) return `out of range: ${rangeText(input)}`;
  const [body, part] = input.path.split(".");
  if (part === "material" && found.value !== scene.values[input.path]) {
    scene.materials[body] = `${scene.materials[body].replace(/, changed$/u, "")}, changed`;
  }
  scene.values[input.path] = found.value;
  const other = scene.base.replaced[input.path];
  if (other) scene.values[other] = null;
  if (found.unit) UNITS[input.path] = found.unit;
  return "";
}

/** @param {string} id @param {string} label @param {[string, string][]} options value and text @param {string} value @param {(value: string) => void} changed */
function choiceRow(id, label, options, value, changed) {
  const select = made("select", { id }, ...options.map(([key, text]) => made("option", { value: key }, text)));
  select.value = value;
  select.addEventListener("change", () => changed(select.value));
  return made("div", { class: "entry" }, made("label", { for: id }, label), select);
}

/** A picker of catalogue materials for a body. @param {Scene} scene @param {string} body @param {() => void} changed */
function materialRow(scene, body, changed) {
  const own = scene.materials[body];
  const names = Object.keys(DATA.materials);
  /** @type {[string, string][]} */
  const options = names.map((name) => [name, name]);
  if (!names.includes(own)) options.unshift([own, own || "own values"]);
  return choiceRow(`material-${body}`, "material", options, own, (name) => {
    const material = DATA.materials[name];
    if (!material) return;
    scene.materials[body] = name;
    for (const path of Object.keys(scene.values)) {
      const [owner, part, key] = path.split(".");
      if (owner === body && part === "material") scene.values[path] = material[key] ?? null;
    }
    changed();
  });
}

/**
 * The whole form of a scene. @param {Scene} scene @param {() => void} changed a value @param {() => void} replaced what entries there are
 */
function buildForm(scene, changed, replaced) {
  const titles = { impactor: "Impactor", target: `Target: ${scene.base.kind}`, contact: "Contact" };
  const rows = /** @type {{show: () => void}[]} */ ([]);
  const refresh = () => rows.forEach((row) => row.show());
  const parts = Object.entries(titles).map(([body, title]) => {
    const group = made("fieldset", {}, made("legend", {}, title));
    const material = made("details", {}, made("summary", {}, "material values"));
    const fixed = body === "target" && scene.base.support !== null;
    if (fixed) group.append(made("p", {}, Object.keys(scene.base.support.scales).length > 0 ? SCALED_TARGET : FIXED_TARGET));
    if (body in scene.materials && !fixed) {
      group.append(materialRow(scene, body, () => (refresh(), changed())));
    }
    for (const input of inputsOf(scene)) {
      if (!input.path.startsWith(`${body}.`)) continue;
      const entry = entryRow(scene, input, input.path in scene.base.replaced ? () => (refresh(), changed()) : changed);
      rows.push(entry);
      (input.path.includes(".material.") ? material : group).append(entry.row);
    }
    if (body === "target" && scene.base.plate) group.append(...edgeRows(scene, changed));
    if (material.childElementCount > 1) group.append(material);
    if (body === "target") group.insertBefore(kindRow(scene, replaced), group.children[1] ?? null);
    if (body === "contact") group.insertBefore(lawRow(scene, replaced), group.children[1] ?? null);
    return group;
  });
  byId("form").replaceChildren(...parts, effectsGroup(scene, changed), solverGroup(scene, changed));
}

/** @param {Scene} scene @param {() => void} replaced */
function kindRow(scene, replaced) {
  const kinds = [...new Set(DATA.scenes.map((/** @type {any} */ base) => base.kind))];
  return choiceRow("kind", "kind", kinds.map((kind) => [kind, kind]), scene.base.kind, (kind) => {
    const bases = DATA.scenes.filter((/** @type {any} */ entry) => entry.kind === kind);
    const base = bases.find((/** @type {any} */ entry) => entry.table.target.material && entry.table.impactor.velocity);
    const next = sceneOf(base ?? bases[0]);
    if (lawNames(next).includes(scene.law)) chooseLaw(next, scene.law);
    const kept = ["impactor.", "contact.", ...(next.base.support ? [] : ["target.material."])];
    for (const [path, value] of Object.entries(scene.values)) {
      if (path in next.values && kept.some((start) => path.startsWith(start))) next.values[path] = value;
    }
    for (const body of next.base.support ? ["impactor"] : ["impactor", "target"]) {
      if (scene.materials[body] && next.materials[body] !== undefined) next.materials[body] = scene.materials[body];
    }
    const titles = [scene.base.title, `Impact on a ${scene.base.kind}`]; // which the reader has not written
    next.title = titles.includes(scene.title) ? `Impact on a ${kind}` : scene.title;
    Object.assign(scene, next);
    replaced();
  });
}

/** @param {Scene} scene @param {() => void} changed */
function edgeRows(scene, changed) {
  /** @type {[string, string][]} */
  const options = DATA.edges.map((/** @type {string} */ name) => [name, name]);
  return ["x = 0", "x = a", "y = 0", "y = b"].map((place, k) =>
    choiceRow(`edge-${k}`, `edge ${place}`, options, scene.edges[k], (name) => {
      scene.edges[k] = name;
      changed();
    }),
  );
}

/** @param {Scene} scene @param {() => void} replaced */
function lawRow(scene, replaced) {
  /** @type {[string, string][]} */
  const options = lawNames(scene).map((name) => [name, name === "auto" ? "auto" : name]);
  return choiceRow("law", "law", options, scene.law, (name) => {
    chooseLaw(scene, name);
    replaced();
  });
}

/** @param {Scene} scene @param {() => void} changed */
function effectsGroup(scene, changed) {
  /** @type {[string, string][]} */
  const options = [["auto", "if it matters"], ["true", "always"], ["false", "never"]];
  const rows = Object.keys(scene.effects).map((name) =>
    choiceRow(`effect-${name}`, name.replaceAll("_", " "), options, String(scene.effects[name]), (value) => {
      scene.effects[name] = value === "auto" ? value : value === "true";
      changed();
    }),
  );
  return made("fieldset", {}, made("legend", {}, "Effects"), ...rows);
}

/** @param {Scene} scene @param {() => void} changed */
function solverGroup(scene, changed) {
  const { solver } = scene;
  const how = solver.segments === null ? `1e${Math.round(Math.log10(solver.accuracy ?? 1e-4))}` : "segments";
  /** @type {[string, string][]} */
  const options = [2, 3, 4, 5, 6, 8, 10, 12].map((power) => [`1e-${power}`, `relative error 1e-${power}`]);
  if (solver.segments !== null) options.unshift(["segments", `${solver.segments} segments per stage`]);
  const accuracy = choiceRow("accuracy", "accuracy", options, how, (value) => {
    if (value !== "segments") Object.assign(solver, { accuracy: Number(value), segments: null });
    changed();
  });
  const lines = /** @type {[string, string][]} */ (["work-preserving", "chord"].map((name) => [name, name]));
  const line = choiceRow("linearisation", "segments are", lines, solver.linearisation, (value) => {
    solver.linearisation = value;
    changed();
  });
  return made("fieldset", {}, made("legend", {}, "Accuracy"), accuracy, line);
}

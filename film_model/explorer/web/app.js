// The page: what is shown for a scene, and when.

const SAMPLES = 201;
const PENDING = 200; // ms without a change after which studies and the address follow
const SLOW = 300; // ms of a plate's results, above which they follow after a pause
/** @type {{scene: Scene, reference: Scene|null, result: Result|null, other: Result|null, cursor: number, timer: number, took: number}} */
const APP = { scene: /** @type {any} */ (null), reference: null, result: null, other: null, cursor: 0.5, timer: 0, took: 0 };

/** The charts of the page by the id of their figure. @type {Map<string, Chart>} */
const CHARTS = new Map();

/** @returns {"light"|"dark"} */
function theme() {
  const chosen = document.documentElement.dataset.theme;
  if (chosen === "light" || chosen === "dark") return chosen;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

/** Widths of figures in pixels; asking for one after every change would lay out the page each time. @type {Map<string, number>} */
const WIDTHS = new Map();

/** @param {string} id @param {HTMLElement} figure */
function widthOf(id, figure) {
  const known = WIDTHS.get(id);
  if (known) return known;
  const width = figure.clientWidth;
  if (width) WIDTHS.set(id, width);
  return Math.max(280, width);
}

/** Draw a chart in its figure. @param {string} id @param {Chart} chart @param {string} [words] what it shows */
function showChart(id, chart, words) {
  CHARTS.set(id, chart);
  const figure = byId(id);
  const root = /** @type {SVGSVGElement} */ (figure.querySelector("svg"));
  const width = widthOf(id, figure);
  drawChart(root, chart, width, Math.round(Math.min(300, Math.max(220, width * 0.55))), theme());
  root.setAttribute("aria-label", words ?? chart.title);
}

/** The scene's result, or what is wrong with it. @param {Scene} scene @returns {{result: Result|null, reason: string}} */
function attempt(scene) {
  try {
    if (scene.base.given && unchanged(scene)) return { result: givenResult(scene), reason: "" };
    return { result: simulate(scene, SAMPLES), reason: "" };
  } catch (error) {
    return { result: null, reason: reasonOf(error) };
  }
}

/** Simulate and show at once, or after a pause where the vibrations of a plate take long. */
function render() {
  clearTimeout(APP.timer);
  if (!CORE.plate.limited || APP.took < SLOW) {
    renderNow();
    return;
  }
  say(`the results follow after a pause: the vibrations of this plate take ${(APP.took / 1000).toFixed(1)} s`);
  APP.timer = setTimeout(() => {
    renderNow();
    say("");
  }, PENDING);
}

/** Simulate and show numbers, charts, and what must be known of them. */
function renderNow() {
  const { scene, reference } = APP;
  const start = performance.now();
  const { result, reason } = attempt(scene);
  APP.took = performance.now() - start;
  APP.result = result;
  APP.other = reference ? attempt(reference).result : null;
  byId("heading").textContent = scene.title;
  byId("results").hidden = result === null;
  for (const id of ["csv", "netcdf", "svg", "png"]) /** @type {HTMLButtonElement} */ (byId(id)).disabled = result === null;
  byId("bar").hidden = result === null;
  const failure = byId("failure");
  failure.hidden = result !== null;
  failure.textContent = reason ? `Not simulated: ${reason}` : "";
  syncMaterials(scene);
  if (result) {
    showSummary(scene, result, APP.other);
    showMotion(result, APP.other);
    showOblique(scene, result);
    showBanner(scene, result);
  }
  APP.timer = setTimeout(settle, PENDING);
}

/** What follows when the scene has stopped changing: effects, studies, the address. */
function settle() {
  const compare = APP.reference ? `&compare=${encodeURIComponent(fragmentOf(APP.reference))}` : "";
  history.replaceState(null, "", `#${fragmentOf(APP.scene)}${compare}`);
  document.title = `${APP.scene.title} – film-model`;
  const { result } = APP;
  if (!result) return;
  showEffects(APP.scene, result);
  const { problem } = result.choice;
  for (const [id, study] of Object.entries(STUDIES)) {
    const hidden = problem === null || (problem.vibrates && id === "part-accuracy");
    byId(id).hidden = hidden;
    if (problem && !hidden && /** @type {HTMLDetailsElement} */ (byId(id)).open) study(result, problem);
  }
}

/** @param {Scene} scene */
function syncMaterials(scene) {
  for (const [body, name] of Object.entries(scene.materials)) {
    const select = /** @type {HTMLSelectElement|null} */ (document.getElementById(`material-${body}`));
    if (!select || select.value === name) continue;
    if (![...select.options].some((option) => option.value === name)) select.add(new Option(name, name));
    select.value = name;
  }
}

/** A row of a table. @param {string} head @param {string[]} cells */
function tableRow(head, cells) {
  return made("tr", {}, made("th", { scope: "row" }, head), ...cells.map((cell) => made("td", {}, cell)));
}

/** @param {Scene} scene @param {Result} result @param {Result|null} other */
function showSummary(scene, result, other) {
  const rows = Object.entries(DATA.summary).map(([name, [dimension, text]]) => {
    const value = result.summary[name];
    const cells = [shown(value, dimension, 6)];
    if (other) {
      const before = other.summary[name];
      const change = Math.abs(before) > 0 && Number.isFinite(value) ? `${(100 * (value / before - 1)).toPrecision(3)} %` : "–";
      cells.push(shown(before, dimension, 6), change);
    }
    const row = tableRow(name.replaceAll("_", " "), cells);
    row.title = text;
    return row;
  });
  const heads = ["", "this scene", ...(other ? ["kept scene", "change"] : [])];
  const top = heads.map((text) => (text ? made("th", { scope: "col" }, text) : made("td", {})));
  byId("summary").replaceChildren(made("thead", {}, made("tr", {}, ...top)), made("tbody", {}, ...rows));
  const short = ["maximum_force", "maximum_indentation", "contact_duration", "coefficient_of_restitution"];
  const words = ["force", "indentation", "contact", "restitution"];
  byId("bar").replaceChildren(
    ...short.map((name, k) => made("span", {}, `${words[k]} `, made("b", {}, shown(result.summary[name], DATA.summary[name][0], 4)))),
  );
  const ended = result.status === EVENT ? "" : " Contact does not end: the impactor stays on the target.";
  const error = result.error.toExponential(1);
  const means = result.modes > 0 ? ` with ${result.modes} natural vibrations` : result.segments > 0 ? ` with ${result.segments} segments` : "";
  const measured = intervalsOf(scene, result).map(({ name, low, high, covered, evidence }) => {
    if (low === undefined || high === undefined || covered === undefined) return `${name.replaceAll("_", " ")}: ${evidence}`;
    const [from, to] = [low, high].map((value) => shown(value, DATA.summary[name][0], 3));
    return `${name.replaceAll("_", " ")}: ${from} to ${to} (${100 * covered} % of ${evidence})`;
  });
  byId("intervals").hidden = measured.length === 0;
  byId("intervals").textContent = `Where measured values would lie: ${measured.join("; ")}.`;
  byId("error").textContent = `Law ${result.law.name}. Estimated relative error of every value ≤ ${error}${means}.${ended}`;
}

/** Results and pictures of the motion along the surface. @param {Scene} scene @param {Result} result */
function showOblique(scene, result) {
  const { oblique, summary, motion } = result;
  byId("along").hidden = oblique === null;
  if (!oblique) return;
  const rows = Object.entries(DATA.oblique).filter(([name]) => name in oblique.summary).map(([name, [dimension, text]]) => {
    const row = tableRow(name.replaceAll("_", " "), [shown(oblique.summary[name], dimension, 6)]);
    row.title = text;
    return row;
  });
  byId("oblique").replaceChildren(made("tbody", {}, tableRow("sliding regime", [oblique.sliding_regime]), ...rows));
  const friction = shown(oblique.summary.maximum_friction_force, "force");
  showChart("chart-friction", frictionChart(motion.motion, oblique), `Friction over time: largest ${friction}`);
  const angle = shown(oblique.summary.rebound_angle, "angle", 4);
  showChart("chart-strobe", strobeChart(entriesOf(scene)["impactor.radius"], oblique, summary.rebound_velocity), `Path of the ball: it leaves at ${angle} to the normal`);
}

/** @param {Result} result @param {Result|null} other */
function showMotion(result, other) {
  const { motion } = result.motion;
  const end = motion.time.at(-1) ?? 0;
  const cursor = APP.cursor * end;
  const time = { label: "time", dimension: "time" };
  /** @param {string} title @param {string} dimension @param {[string, string][]} names */
  const overTime = (title, dimension, names) => {
    /** @type {Series[]} */
    const series = names.map(([name, label], colour) => ({ name: label, x: motion.time, y: motion[name], colour }));
    if (other) {
      const kept = other.motion.motion;
      series.push(...names.map(([name], colour) => ({ name: colour ? "" : "kept", x: kept.time, y: kept[name], colour, dashed: true })));
    }
    return { title, x: time, y: { label: title.toLowerCase(), dimension }, series, cursor };
  };
  const { summary } = result;
  const peak = `largest force ${shown(summary.maximum_force, "force")}`;
  showChart("chart-force", overTime("Force", "force", [["contact_force", "contact force"]]), `Force over time: ${peak}`);
  const depth = `largest indentation ${shown(summary.maximum_indentation, "length")}`;
  showChart("chart-indentation", overTime("Indentation", "length", [["indentation", "indentation"]]), `Indentation over time: ${depth}`);
  const bodies = /** @type {[string, string][]} */ ([["impactor_velocity", "impactor"]]);
  if (motion.target_velocity.some((value) => value !== 0)) bodies.push(["target_velocity", "target"]);
  showChart("chart-velocity", overTime("Velocity", "velocity", bodies), `Velocities over time: rebound at ${shown(summary.rebound_velocity, "velocity")}`);
  showChart("chart-energy", energyChart(result, time, cursor), `Energies over time: absorbed ${shown(summary.energy_absorbed, "energy")}`);
  const loop = { name: "this scene", ...loopOf(result), colour: 0 };
  const kept = other && { name: "kept", ...loopOf(other), colour: 0, dashed: true };
  const at = indexAt(motion.time, cursor);
  showChart("chart-loop", {
    title: "Force against indentation",
    x: { label: "indentation", dimension: "length" },
    y: { label: "force", dimension: "force" },
    series: kept ? [loop, kept] : [loop],
    point: result.motion.stage[at] ? [motion.indentation[at], motion.contact_force[at]] : undefined,
  }, `Force against indentation: ${peak}, ${depth}`);
  const values = ["contact_force", "indentation", "impactor_velocity"].map((name) => shown(motion[name][at], DATA.motion[name][0]));
  const text = `at ${shown(motion.time[at], "time", 4)}: force ${values[0]}, indentation ${values[1]}, velocity ${values[2]}, ${result.motion.stage[at] || "no contact"}`;
  byId("readout").textContent = text;
  byId("cursor").setAttribute("aria-valuetext", text);
}

/** @param {Result} result @param {Chart["x"]} time @param {number} cursor @returns {Chart} */
function energyChart(result, time, cursor) {
  const x = result.motion.motion.time;
  const all = Object.entries(energiesOf(APP.scene, result));
  const parts = all.filter(([, y]) => y.some((value) => value > 1e-6 * result.n.energy));
  const series = parts.map(([name, y], colour) => ({ name, x, y, colour }));
  return { title: "Energy", x: time, y: { label: "energy", dimension: "energy" }, series, cursor };
}

/** What a reader must know before believing the result. @param {Scene} scene @param {Result} result */
function showBanner(scene, result) {
  const { given } = scene.base;
  const { edges } = result.choice;
  const texts = [];
  if (given && result.choice.problem === null) {
    texts.push(`Computed by film-model when this page was written: ${given.reason}, which the page itself cannot simulate.`);
  } else if (given) {
    texts.push(`Not the scene as given: there ${given.reason}, which this page cannot simulate.${scene.base.plate ? "" : " Here the target has no edges."}`);
  }
  if (edges?.matter) {
    texts.push(`Waves from the edges would change the result by about ${percent(edges.change)}: here the target has no edges. Use film-model run.`);
  }
  if (result.choice.problem) texts.push(...examplesOf(result.choice.problem.law, result.n).map((text) => `${text}: give yours.`));
  if (scene.base.along && scene.values["contact.friction"] === null && FORMULAS[scene.base.along.sliding](entriesOf(scene), result.choice.problem?.p ?? {}).velocity !== 0) {
    texts.push("Only the normal motion is simulated: give friction for the motion along the surface.");
  }
  if (!unchanged(scene)) {
    texts.push("Plasticity, rate hardening, gravity, damping of the materials, waves in a half-space, edges of a plate and target motion were decided again for your changes; the other effects below were not.");
  }
  byId("banner").hidden = texts.length === 0;
  byId("banner").textContent = texts.join(" ");
}

/** The last sample that is not after a time. @param {Float64Array} times @param {number} time */
function indexAt(times, time) {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** @param {number|null} change */
function percent(change) {
  if (change === null || Number.isNaN(change)) return "unknown";
  return change < 0.995 ? `${Number((100 * change).toPrecision(2))} %` : "100 % or more";
}

/** Effects: those decided here, then those that Python judged for the scene as given. @param {Scene} scene @param {Result} result */
function showEffects(scene, result) {
  const { effects, edges } = result.choice;
  const same = unchanged(scene);
  const here = Object.entries(effects).map(([name, { simulated, change }]) =>
    tableRow(name.replaceAll("_", " "), [simulated ? "simulated" : "not simulated", percent(change), "decided for this scene"]),
  );
  const rest = scene.base.judged.filter((/** @type {any} */ effect) => !(effect.name in effects));
  const judged = rest.map((/** @type {any} */ effect) => {
    const when = same ? "judged for this scene" : "judged for the scene as given, not for your changes";
    const row = tableRow(effect.name.replaceAll("_", " "), [effect.state, percent(effect.change), `${when}: ${effect.reason}`]);
    if (!same) row.className = "stale";
    return row;
  });
  const head = ["effect", "state", "error if neglected", "basis"].map((text) => made("th", { scope: "col" }, text));
  byId("effects").replaceChildren(made("thead", {}, made("tr", {}, ...head)), made("tbody", {}, ...here, ...judged));
  const notes = [...result.warnings, ...warningsOf(result.oblique, scene.solver.accuracy)];
  if (!scene.base.free && result.n.impedance < Infinity) notes.push(`Zener's number λ = ${shortNumber(result.n.zener, 3)}`);
  if (result.n.yield_velocity > 0 && result.n.yield_velocity < Infinity) {
    notes.push(`the contact yields above ${shown(result.n.yield_velocity, "velocity", 4)} on a target that does not move`);
  }
  notes.push(...scene.base.warnings.map((/** @type {string} */ text) => (same ? text : `for the scene as given: ${text}`)));
  if (edges && !edges.matter) {
    notes.push(edges.change > 0 ? `waves from the edges change the result by less than ${percent(edges.change)}` : "waves from the edges return after contact has ended");
  }
  byId("notes").replaceChildren(...notes.map((text) => made("li", {}, text)));
}

/** Show another scene. @param {Scene} scene */
function openScene(scene) {
  APP.scene = scene;
  for (const path of Object.keys(UNITS)) delete UNITS[path];
  rebuild();
}

/** Build the form again; the control that was in use stays in use. */
function rebuild() {
  const used = document.activeElement?.id;
  buildForm(APP.scene, render, rebuild);
  if (used) document.getElementById(used)?.focus();
  /** @type {HTMLInputElement} */ (byId("title")).value = APP.scene.title;
  render();
}

/** The scene of the address. */
function openAddress() {
  const fragment = location.hash.slice(1);
  const { scene, ignored } = sceneOfFragment(fragment);
  const compare = new URLSearchParams(fragment).get("compare");
  APP.reference = compare === null ? null : sceneOfFragment(compare).scene;
  byId("forget").hidden = APP.reference === null;
  say(ignored.length ? `not understood in the address: ${ignored.join(", ")}` : "");
  openScene(scene);
}

/** @param {string} id @param {(event: Event) => void} action */
function onClick(id, action) {
  byId(id).addEventListener("click", action);
}

/** The chart that is to be downloaded; that of a study opens its part, which draws it. */
function picked() {
  const id = /** @type {HTMLSelectElement} */ (byId("picture")).value;
  const part = document.getElementById(id.replace("chart", "part"));
  if (part instanceof HTMLDetailsElement && !part.open) {
    part.open = true;
    settle();
  }
  if (part?.hidden || !CHARTS.has(id)) say("there is no such picture for this scene");
  return part?.hidden ? undefined : CHARTS.get(id);
}

function connect() {
  onClick("keep", () => {
    APP.reference = copyOf(APP.scene);
    byId("forget").hidden = false;
    render();
    say("this scene is kept; changes are shown against it");
  });
  onClick("forget", () => {
    APP.reference = null;
    byId("forget").hidden = true;
    byId("keep").focus();
    render();
  });
  onClick("theme", () => {
    document.documentElement.dataset.theme = theme() === "dark" ? "light" : "dark";
    redraw();
  });
  onClick("copy-link", () => {
    settle();
    copyText(location.href, "address");
  });
  onClick("copy-scene", () => copyText(sceneFile(APP.scene), "scene file"));
  onClick("copy-python", () => copyText(pythonScript(APP.scene), "Python script"));
  onClick("csv", () => {
    if (APP.result) download(new Blob([csvText(APP.scene, APP.result)], { type: "text/csv" }), "impact.csv");
  });
  onClick("netcdf", () => {
    if (APP.result) download(new Blob([netcdfOf(APP.scene, APP.result)], { type: "application/x-netcdf" }), "impact.nc");
  });
  onClick("svg", () => {
    const chart = picked();
    if (chart) download(new Blob([chartFile(chart)], { type: "image/svg+xml" }), "impact.svg");
  });
  onClick("png", async () => {
    const chart = picked();
    if (chart) download(await pngOf(chart), "impact.png");
  });
  const cursor = /** @type {HTMLInputElement} */ (byId("cursor"));
  cursor.addEventListener("input", () => {
    APP.cursor = Number(cursor.value) / 1000;
    if (APP.result) showMotion(APP.result, APP.other);
  });
  const title = /** @type {HTMLInputElement} */ (byId("title"));
  title.addEventListener("change", () => {
    APP.scene.title = title.value;
    render();
  });
  for (const id of Object.keys(STUDIES)) byId(id).addEventListener("toggle", settle);
  addEventListener("hashchange", openAddress);
  addEventListener("resize", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

/**
 * The impact of an address, for other scripts of the page in which this one is embedded.
 * @param {string} fragment
 */
function impact(fragment) {
  const { scene, ignored } = sceneOfFragment(fragment);
  const { result, reason } = attempt(scene);
  if (!result) return { reason, ignored };
  const { summary, error, segments, modes, law, warnings, choice, oblique } = result;
  const strength = choice.n?.strength_factor ?? null;
  return { summary: { ...summary }, error, segments, modes, law: law.name, warnings, effects: choice.effects, edges: choice.edges, intervals: intervalsOf(scene, result), oblique, strength_factor: strength, ignored };
}

/** Draw everything again, in another size or theme. */
function redraw() {
  WIDTHS.clear();
  render();
}

async function main() {
  const links = DATA.scenes.map((/** @type {any} */ base) => made("li", {}, made("a", { href: `#scene=${base.name}` }, base.title)));
  byId("examples").replaceChildren(...links);
  byId("version").textContent = DATA.version;
  try {
    await startCore();
  } catch (error) {
    byId("failure").textContent = `This browser cannot run the page: ${error}`;
    byId("failure").hidden = false;
    return;
  }
  connect();
  openAddress();
  Object.assign(globalThis, { filmModel: { impact, sceneFile: (/** @type {string} */ text) => sceneFile(sceneOfFragment(text).scene) } });
  document.documentElement.dataset.ready = "true";
}

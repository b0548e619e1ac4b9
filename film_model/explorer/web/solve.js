// One impact: which effects are simulated, the mesh, the march, the summary. The formulas are the recorded ones.

/**
 * A scene on the page. base: the scene of DATA from which it comes; values: its entries by path, SI, null if missing;
 * a table of friction has speeds and coefficients in turn.
 * @typedef {{base: any, values: Record<string, any>, title: string, materials: Record<string, string>,
 *   edges: string[], law: string, effects: Record<string, string|boolean>, tolerance: number|null,
 *   solver: {accuracy: number|null, segments: number|null, linearisation: string}}} Scene
 */

class Unsupported extends Error {}

/** The entries of a scene for the recorded formulas. @param {Scene} scene */
function entriesOf(scene) {
  /** @type {Record<string, number>} */
  const entries = {};
  const missing = Object.fromEntries(scene.base.inputs.map((/** @type {any} */ input) => [input.path, input.missing]));
  for (const [path, value] of Object.entries(scene.values)) entries[path] = value ?? missing[path] ?? Infinity;
  for (const side of scene.base.plate ? [0, 1] : []) {
    if (!Number.isFinite(entries[`target.position.${side}`])) entries[`target.position.${side}`] = entries[`target.size.${side}`] / 2;
  }
  for (const body of ["impactor", "target"]) {
    if (`${body}.mass` in scene.values && scene.values[`${body}.mass`] === null) {
      const radius = entries[`${body}.radius`];
      entries[`${body}.mass`] = FORMULAS.sphereMass(radius, entries[`${body}.material.density`]).mass;
    }
    const [modulus, hardness, exponent] = ["youngs_modulus", "hardness", "strain_hardening_exponent"].map((name) => entries[`${body}.material.${name}`]);
    if (Number.isFinite(hardness)) entries[`${body}.material.yield_strength`] = FORMULAS.firstYield(hardness, exponent, modulus ?? scene.base.moduli[body]).strength;
  }
  return entries;
}

/** The numbers of a scene. @param {Scene} scene @returns {any} */
function numbersOf(scene) {
  const x = entriesOf(scene);
  const [d11, d12, d22] = ["D11", "D12", "D22"].map((name) => x[`target.bending_stiffness.${name}`] ?? 0);
  if (d11 && FORMULAS.unstable(d11, d12, d22).unstable) throw new Unsupported("D12 must be smaller than √(D11 D22): otherwise the plate has negative bending energy");
  for (const body of ["impactor", "target"]) {
    const [hardness, strength] = ["hardness", "yield_strength"].map((name) => scene.values[`${body}.material.${name}`] ?? NaN);
    if (FORMULAS.strengths(hardness, strength).contradict) throw new Unsupported(`hardness and yield strength of the ${body} contradict each other: leave one of them empty`);
  }
  /** @type {any} */
  const n = { ...FORMULAS[scene.base.numbers](x), chosen: scene.law, values: scene.values };
  if (!(n.approach > 0)) throw new Unsupported("the impactor does not approach the target: there is no impact");
  return n;
}

/** What a number of a scene is called in its entries. @param {string} entry */
const nameOf = (entry) => entry.replace("flow", "yield").replaceAll("_", " ");

/** The law of that name, if the scene's values allow it; otherwise the reason. @param {Scene} scene @param {any} n @param {string} name */
function lawOf(scene, n, name) {
  let reason = `law ${name} is not on this page`;
  const { laws, plain, law: own } = scene.base;
  for (const index of scene.law === own ? laws : [...plain, ...laws]) {
    const law = DATA.laws[index];
    if (law.name !== name) continue;
    const missing = law.needs.filter((/** @type {string} */ entry) => Number.isNaN(n[entry]) || n[entry] === Infinity);
    if (missing.length) return { reason: `law ${name} needs a ${nameOf(missing[0])}` };
    const off = Object.entries(law.fixed).filter(([entry, value]) => n[entry] !== value && !(Math.abs(n[entry] / value - 1) <= DATA.constants.agreement));
    if (!off.length) return { law };
    const what = off.map(([entry]) => nameOf(entry)).join(" and ");
    reason = `law ${name} is available here for the ${what} of the scene as given only: its curve depends on it`;
  }
  return { reason };
}

/** @param {Scene} scene @param {any} n @param {string} name */
function lawOrThrow(scene, n, name) {
  const { law, reason } = lawOf(scene, n, name);
  if (!law) throw new Unsupported(reason ?? "");
  return law;
}

/** The numbers of a scene with a law's own parameters: the scene's, or those of the law's example. @param {any} law @param {any} n */
function withOwn(law, n) {
  if (!law.live.length) return n;
  const all = { ...n, ...(law.derived ? FORMULAS[law.example](n) : {}) };
  for (const input of law.live) {
    const value = (n.chosen === law.name ? n.values[input.path] : null) ?? input.value;
    if (value !== null) all[input.path.replace("contact.", "own_")] = value;
  }
  const { damped, steep } = DATA.constants;
  if ([damped, steep[damped]].includes(law.name) && n.chosen === "auto" && n.loss_restitution < 1) all.own_restitution = n.loss_restitution;
  return all;
}

/**
 * Everything that is needed to march one impact under a law. compliance: of a target that follows the force statically.
 * @param {any} law @param {any} n @param {number} impedance @param {number} load @param {number} [compliance] @param {boolean} [vibrates]
 */
function problemOf(law, n, impedance, load, compliance = 0, vibrates = false) {
  const p = FORMULAS[law.function](withOwn(law, n), impedance, load);
  if (!(p.length > 0 && p.length < Infinity && p.force > 0 && p.force < Infinity)) {
    throw new Unsupported(`law ${law.name}: its scales are ${p.length} m and ${p.force} N`);
  }
  if (compliance > 0 && !law.series) throw new Unsupported(`law ${law.name} cannot be in series with a static stiffness`);
  const alone = law.shape ? CORE.curveOfShape(law, n) : CORE.curve(law.curve);
  const curve = compliance > 0 ? CORE.inSeries(alone, (compliance * p.force) / p.length) : alone;
  return { law, p, impedance, load, compliance, vibrates, curve };
}

/** @typedef {ReturnType<typeof problemOf>} Problem */

/** @param {Problem} problem @param {string} linearisation @param {number[]} counts */
function march(problem, linearisation, counts) {
  return CORE.impact(problem.p, problem.curve, CORE.mesh(linearisation, counts[0], counts[1]));
}

/** The impact on a coarse mesh, to decide effects. @param {Problem} problem */
function trial(problem) {
  const n = DATA.constants.trial_segments;
  return march(problem, "work-preserving", [n, problem.law.ratio * n]);
}

/** The change of the summary between a problem with an effect and one without. @param {Problem} full @param {Problem} without */
function changeOf(full, without) {
  return CORE.change(full.p, trial(full), without.p, trial(without));
}

/** The velocity after the trial impact, m/s. @param {Problem} problem */
const reboundOf = (problem) => FORMULAS.rebound(problem.p, trial(problem)).velocity;

/** @param {Scene} scene */
function toleranceOf(scene) {
  return scene.tolerance ?? FORMULAS.toleranceFor(scene.solver.accuracy ?? 0).tolerance;
}

/**
 * Law, strength, load and target motion of a scene, with the change that each effect makes.
 * @param {Scene} scene @param {any} slow numbers with the strength of slow loading
 */
function choose(scene, slow) {
  const { plasticity, target_motion: motion, gravity } = scene.effects;
  const tolerance = toleranceOf(scene);
  const { elastic, yielding, damped, steep: steeper } = DATA.constants;
  const yields = gravity === false ? slow.yields_light : slow.yields;
  const automatic = scene.law === "auto";
  const plastic = plasticity === true || (plasticity !== false && yields === true && slow.able);
  const damping = automatic && slow.loss_restitution < 1 ? scene.effects.material_damping : false;
  if (damping !== false && slow.loss_restitution < DATA.constants.least_restitution) throw new Unsupported("losses of the materials this large are not computed on this page");
  const forced = damping === true && plasticity !== true;
  const usual = forced ? damped : plastic ? yielding : elastic;
  const sloped = scene.effects.small_slope === true && (forced || (damping === false && !plastic));
  const law = lawOrThrow(scene, slow, !automatic ? scene.law : sloped ? steeper[usual] : usual);
  const { impedance: own, compliance, vibrates = false, held = false, edges = null } = supportOf(scene, slow, law);
  const n = hardened(scene, slow, law, own, compliance) ?? slow;
  const light = problemOf(law, n, own, 0, compliance);
  /** @type {Record<string, {simulated: boolean, change: number|null}>} */
  const effects = {};

  let heavy = gravity === true && !scene.base.free;
  if (!scene.base.free) {
    const pressed = problemOf(law, n, own, n.weight, compliance);
    const size = FORMULAS.gravityChange(light.p, trial(light), n, changeOf(pressed, light)).change;
    if (gravity === "auto") heavy = !(size <= tolerance);
    effects.gravity = { simulated: heavy, change: size };
  }
  const moved = heavy ? problemOf(law, n, own, n.weight, compliance) : light;

  let moves = own < Infinity || compliance > 0 || held;
  if (moves) {
    const known = own < Infinity || compliance > 0;
    const size = known ? changeOf(moved, problemOf(law, n, Infinity, moved.load)) : null;
    if (motion === "auto" && !held) moves = !(size !== null && size <= tolerance);
    effects.target_motion = { simulated: moves, change: size };
  }
  for (const [name, effect] of Object.entries(edges ?? {})) effects[name] = { ...effect, simulated: effect.simulated && moves };
  let problem = moves ? moved : problemOf(law, n, Infinity, moved.load);
  let used = n;

  const free = lawOf(scene, n, elastic).law;
  let keeps = true;
  if (!(automatic && law.name !== yielding) && law.dissipates && free) {
    const without = problemOf(free, n, problem.impedance, problem.load, problem.compliance);
    const size = changeOf(problem, without);
    if (automatic && plasticity === "auto") keeps = !(size <= tolerance);
    effects.plasticity = { simulated: keeps, change: size };
    if (!keeps) problem = without;
  } else if (yields === false) {
    effects.plasticity = { simulated: false, change: 0 };
  }
  if (vibrates && moves) problem = problemOf(problem.law, n, Infinity, problem.load, 0, true);
  if (forced && free) {
    effects.material_damping = { simulated: true, change: changeOf(problem, problemOf(free, n, problem.impedance, problem.load)) };
  } else if (damping !== false && !(problem.compliance > 0)) {
    const lossy = problemOf(lawOrThrow(scene, n, damped), n, problem.impedance, problem.load, 0, problem.vibrates);
    const size = changeOf(lossy, problem);
    const known = trial(problem).status >= 0; // a ball deeper than the law's end is an error, not elastic
    const takes = problem.law.name === elastic ? !(size <= tolerance) : plasticity !== true && known && reboundOf(lossy) < reboundOf(problem);
    effects.material_damping = { simulated: takes, change: size };
    if (takes) [problem, used] = [lossy, slow]; // a damped law has no strength
    keeps &&= !takes;
    if (effects.plasticity) effects.plasticity.simulated &&= keeps;
  }
  const steep = automatic && scene.effects.small_slope !== false && lawOf(scene, n, steeper[problem.law.name]).law;
  if (steep) {
    const change = problem.load > 0 ? n.steep1 : n.steep0;
    const simulated = scene.effects.small_slope === true || change > tolerance;
    effects.small_slope = { simulated, change };
    if (simulated) problem = problemOf(steep, used, problem.impedance, problem.load, problem.compliance, problem.vibrates);
  }
  const waves = wavesOf(scene, slow, used, problem);
  if (waves) {
    effects.wave_losses = { simulated: waves.simulated, change: waves.change };
    if (waves.simulated) problem = waves.radiating;
  }
  if (n !== slow) Object.assign(effects, hardeningOf(problemOf(law, slow, own, 0, compliance), light, keeps));
  return { n: used, problem, effects, edges: edgesOf(scene, n, light, tolerance) };
}

/**
 * How the target moves while effects are decided. One that vibrates: by the stiffer of its impedance and its compliance. held: whether
 * its motion is simulated however small. edges: the effects of a plate's.
 * @param {Scene} scene @param {any} n @param {any} law
 * @returns {{impedance: number, compliance: number, vibrates?: boolean, held?: boolean, edges?: ReturnType<typeof choose>["effects"]}}
 */
function supportOf(scene, n, law) {
  const support = supportNow(scene);
  const fixed = { impedance: Infinity, compliance: 0 };
  const { target_motion: motion, boundary_reflections: reflections, target_inertia: inertia } = scene.effects;
  if (motion === false) return fixed;
  const asked = scene.base.plate ? reflections === true || inertia === true : support !== null;
  const still = { impedance: n.impedance, compliance: 0, held: asked };
  if (!support) return still;
  const { moves, effects: edges } = scene.base.plate ? edgesOfPlate(scene, n, law, support) : { moves: support.modes ? "vibrating" : "static", effects: undefined };
  if (moves === "infinite") return { ...still, edges };
  const vibrates = moves === "vibrating";
  const follows = law.series || support.compliance === 0;
  const waves = n.impedance < Infinity;
  const own = vibrates && follows && !waves ? feltCompliance(support, problemOf(law, n, Infinity, 0), n.impactor_mass) : support.compliance;
  const bent = { impedance: Infinity, compliance: follows || !vibrates ? own : 0, vibrates, held: asked, edges };
  if (!vibrates || !waves) return bent;
  const [infinite, sprung] = [problemOf(law, n, n.impedance, 0), problemOf(law, n, Infinity, 0, bent.compliance)];
  const found = FORMULAS.stiffer(infinite.p, trial(infinite), sprung.p, trial(sprung));
  if (found.trusted && (!follows || found.stiffer)) return { ...still, vibrates, edges };
  return { ...bent, held: asked || bent.compliance === 0 };
}

/** Segments of loading and unloading. @param {Problem} problem @param {number} n @returns {number[]} */
function countsFor(problem, n) {
  return [n, problem.law.ratio * n];
}

/** @param {Problem} problem @param {string} linearisation @param {number[]} counts */
function marchOrThrow(problem, linearisation, counts) {
  const found = march(problem, linearisation, counts);
  if (found.status < 0) throw new Failure(found.status);
  return found;
}

/**
 * The contact on the mesh that meets the solver's accuracy, or on its number of segments: counts, error estimate, summary.
 * @param {Problem} problem @param {Scene["solver"]} solver
 */
function solved(problem, { accuracy, segments, linearisation }) {
  const { first_segments: first, accuracy: usual } = DATA.constants;
  const n = segments ?? CORE.firstSegments(problem.p.damping, first / 2);
  const counts = segments === null ? countsFor(problem, n) : [n, n];
  const goal = segments === null ? accuracy ?? usual : null;
  const solution = CORE.solve(problem.p, problem.curve, linearisation, counts, goal, problem.law.clearance);
  if (solution.status < 0) throw new Failure(solution.status);
  const missed = `accuracy ${goal} is not reached: the estimated relative error is ${solution.estimated.toExponential(1)} with ${solution.counts[0]} segments per stage; ask for a looser accuracy`;
  return { ...solution, warning: goal === null || solution.reached ? "" : missed };
}

/** Segments, recorded motion and the core's summary of it. @param {Problem} problem @param {string} line @param {number[]} counts */
function recorded(problem, line, counts) {
  const { p, law } = problem;
  const room = (counts[0] + 2) * (law.stages.length + 1) + 4 * counts[1] + 64;
  const record = CORE.record(p, problem.curve, CORE.mesh(line, counts[0], counts[1]), room);
  if (record.status < 0) {
    CORE.top = record.top;
    throw new Failure(record.status);
  }
  return record;
}

/**
 * The impact of a scene: what film-model run computes. samples: at how many times the motion is sampled.
 * @param {Scene} scene @param {number} samples
 */
function simulate(scene, samples) {
  const n = numbersOf(scene);
  if (scene.base.given && n.impedance === Infinity) {
    throw new Unsupported(`${scene.base.given.reason}, which this page cannot simulate: it shows the scene as given only`);
  }
  const choice = choose(scene, n);
  return { n, choice, ...run(scene, choice.n, choice.problem, samples, true) };
}

/**
 * n: numbers of the scene. choice: what is simulated, n with its strength; null for a result that Python computed.
 * @typedef {ReturnType<typeof run> & {n: any, choice: {n: any, problem: Problem|null, effects: ReturnType<typeof choose>["effects"],
 *   edges: ReturnType<typeof edgesOf>}}} Result
 */

/** Python's result of a scene that the page cannot simulate. @param {Scene} scene @returns {Result} */
function givenResult(scene) {
  const { given } = scene.base;
  /** @type {Record<string, Float64Array>} */
  const motion = {};
  for (const [name, values] of Object.entries(given.motion)) motion[name] = Float64Array.from(/** @type {number[]} */ (values));
  const summary = Object.fromEntries(Object.entries(given.summary).map(([name, value]) => [name, value ?? NaN]));
  const { error, segments, warnings, stage } = given;
  const status = given.ended ? EVENT : 0;
  const choice = { n: null, problem: null, effects: {}, edges: null };
  const oblique = null;
  return { oblique, n: numbersOf(scene), choice, summary, error, segments, modes: 0, warnings, counts: [], status, law: { name: given.law }, motion: { motion, stage } };
}

/** The summary in SI. @param {Scene} scene @param {any} p @param {any} core @param {any} n */
function summaryOf(scene, p, core, n) {
  return FORMULAS[`summary${scene.base.free ? "Free" : "Fixed"}${p.damping > 0 ? "Damped" : ""}`](p, core, n);
}

/**
 * How far measured values lie from those of law "auto", by film_model/problem/model_intervals.py; without `low` why this is not known.
 * @param {Scene} scene @param {Result} result
 * @returns {{name: string, low?: number, high?: number, covered?: number, evidence: string}[]}
 */
function intervalsOf(scene, { n, choice: { problem }, summary }) {
  const decided = scene.law === "auto" && scene.effects.rate_hardening !== false;
  if (!decided || scene.base.free || !problem || problem.vibrates || (problem.p.gamma > 0 && n.impedance < Infinity)) return [];
  const { elastic, steep, yielding } = DATA.constants;
  const { maximum_force: force, contact_radius: radius } = summary;
  const { materials: given } = sceneOf(scene.base); // another material has no entries of brittle ones
  const fails = ["impactor", "target"].some((body) => {
    const { indicator } = FORMULAS.failure(n[`pressing_${body}`], n[`cracking_${body}`], force, radius);
    return indicator > 1 && scene.materials[body] === given[body];
  });
  const { kind } = FORMULAS.kindOf(n.family, [elastic, steep[elastic]].includes(problem.law.name), problem.law.name === yielding, fails);
  const known = (DATA.intervals[kind] ?? []).filter((/** @type {any} */ { name, missing }) => missing || summary[name] > 0);
  return known.map((/** @type {any} */ { name, low, high, most, up_to: reach, largest, covered, evidence, missing }) => {
    if (missing) return { name, evidence: missing };
    const [least, greatest] = [low, high].map((residual) => FORMULAS.residual(summary[name], residual, largest ?? Infinity).value);
    const ratio = n.yield_velocities;
    const beyond = FORMULAS.extrapolated(ratio, most).beyond ? `; extrapolated from ${reach} to ${ratio.toFixed(0)} yield velocities` : "";
    return { name, low: least, high: greatest, covered, evidence: evidence + beyond };
  });
}

/** Warnings of film_model/problem/summary.py: energy that the law gains, and what the weight does. @param {Problem} problem @param {any} summary */
function energyWarnings({ p, law }, { energy_absorbed: absorbed, energy_radiated: radiated, coefficient_of_restitution: restitution }) {
  const impact = 0.5 * p.approach ** 2 * p.energy;
  const warnings = [];
  const gains = FORMULAS.gains(p, { energy_absorbed: absorbed, coefficient_of_restitution: restitution });
  if (gains.law) {
    const share = ((-100 * absorbed) / impact).toPrecision(3);
    warnings.push(`law ${law.name}: its unloading returns more energy than its loading stored (${share} % of the impact energy)`);
  }
  if (gains.weight) {
    const work = impact * (restitution ** 2 - 1) + absorbed + (radiated || 0);
    warnings.push(`restitution is ${restitution.toPrecision(4)}: contact ends below first touch, and on the way down to there the weight does ${work.toPrecision(4)} J of work, ${(work / impact).toPrecision(3)} times the impact energy; it is no property of the contact`);
  }
  return warnings;
}

/** One impact under decided effects. @param {Scene} scene @param {any} n @param {Problem} problem @param {number} samples @param {boolean} [slides] with friction */
function run(scene, n, problem, samples, slides = false) {
  if (problem.vibrates) return runOnModes(scene, n, problem, samples, slides);
  const solver = scene.solver;
  const mesh = solved(problem, solver);
  const record = recorded(problem, solver.linearisation, mesh.counts);
  const { p, law } = problem;
  const summary = summaryOf(scene, p, record.core, n);
  const warnings = [...law.remarks, ...(mesh.warning ? [mesh.warning] : []), ...energyWarnings(problem, summary)];
  const ends = [record.times.at(-1) || record.end, ...record.times];
  const sample = (/** @type {Float64Array} */ times) => CORE.sample(problem.curve, record, times);
  const motion = sampledAt(scene, problem, ends, samples, sample);
  const error = mesh.estimated + law.fit_error;
  const oblique = slides ? obliqueOf(scene, n, problem, summary, { contacts: [[0], [ends[0] * p.time]], error }, sample) : null;
  CORE.top = record.top;
  return { summary, warnings, error, counts: mesh.counts, segments: record.count - 1, modes: 0, motion, oblique, status: record.status, law };
}

/**
 * The motion at evenly spaced times up to the first of `ends`, and at the others, SI.
 * @param {Scene} scene @param {Problem} problem @param {number[]} ends @param {number} samples
 * @param {(times: Float64Array) => {values: Float64Array, branches: Int8Array}} sample
 */
function sampledAt(scene, problem, [last, ...events], samples, sample) {
  const { p, law } = problem;
  const times = Array.from({ length: samples }, (_, k) => (last * k) / (samples - 1));
  const at = Float64Array.from([...times, ...events]).sort();
  const { values, branches } = sample(at);
  const convert = FORMULAS[scene.base.free ? "motionFree" : "motionFixed"];
  /** @type {Record<string, Float64Array>} */
  const motion = { time: at.map((t) => t * p.time) };
  for (const name of Object.keys(DATA.motion)) motion[name] = new Float64Array(at.length);
  for (let k = 0; k < at.length; k++) {
    const row = convert(p, motion.time[k], values, 5 * k);
    for (const name of Object.keys(DATA.motion)) motion[name][k] = row[name];
  }
  const stages = [...law.stages, "", "unloading"];
  const stage = Array.from(branches, (branch) => stages.at(branch));
  return { motion, stage };
}

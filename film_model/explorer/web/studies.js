// Studies of a scene: every law, restitution against velocity, what accuracy costs, the map of regimes.

/** The scene's impact under every law, with the load and target motion of the scene. @param {Scene} scene @param {any} slow numbers with the strength of slow loading @param {Problem} problem */
function everyLaw(scene, slow, problem) {
  const { impedance, load, compliance, vibrates } = problem;
  return lawNames(scene).filter((name) => name !== "auto").map((name) => {
    const { law, reason } = lawOf(scene, slow, name);
    if (!law) return { name, reason: reason ?? "" };
    if (vibrates && !law.series && law !== problem.law) return { name, reason: "takes seconds on a target that vibrates: choose it to see it" };
    try {
      const hard = hardened(scene, slow, law, impedance, compliance) ?? slow;
      return { name, reason: "", found: run(scene, hard, problemOf(law, hard, impedance, load, compliance, vibrates), 200) };
    } catch (error) {
      return { name, reason: reasonOf(error) };
    }
  });
}

/** What the law's own parameters are where the reader gave none. @param {any} law @param {any} n @returns {string[]} */
function examplesOf(law, n) {
  if (!law.derived) return [];
  const own = withOwn(law, n);
  const open = law.live.filter((/** @type {any} */ input) => (n.chosen === law.name ? n.values[input.path] : null) === null);
  return open.map((/** @type {any} */ { path, label, dimension }) => `law ${law.name}: ${label} ${shown(own[path.replace("contact.", "own_")], dimension, 4)} is only an example`);
}

/** @param {unknown} error */
function reasonOf(error) {
  if (error instanceof Failure || error instanceof Unsupported) return error.message;
  throw error;
}

const VELOCITIES = 41;
const VELOCITIES_ON_MODES = 11; // each takes some milliseconds
const LONGEST_STUDY = 1000; // ms, after which it ends below the highest velocities

/** Velocity and restitution of impacts from a tenth to ten times the scene's velocity. @param {Scene} scene @param {boolean} vibrates */
function restitutionCurve(scene, vibrates) {
  const path = "impactor.velocity" in scene.values ? "impactor.velocity" : "impactor.drop_height";
  const power = path === "impactor.velocity" ? 1 : 2;
  const own = /** @type {number} */ (scene.values[path]);
  /** @type {{x: number[], y: number[]}} */
  const curve = { x: [], y: [] };
  const places = vibrates ? VELOCITIES_ON_MODES : VELOCITIES;
  const start = performance.now();
  for (let k = 0; k < places && !(CORE.plate.limited && performance.now() - start > LONGEST_STUDY); k++) {
    const factor = 10 ** ((2 * k) / (places - 1) - 1);
    const other = copyOf(scene);
    other.values[path] = own * factor ** power;
    try {
      const { n, problem } = choose(other, numbersOf(other));
      const summary = problem.vibrates ? vibratingSummary(problem, vibrate(scene, problem), n) : summaryAlone(scene, problem, n);
      if (!(summary.coefficient_of_restitution >= 0)) continue;
      curve.x.push(n.approach);
      curve.y.push(summary.coefficient_of_restitution);
    } catch (error) {
      reasonOf(error);
    }
  }
  return curve;
}

/** The summary of an impact without its motion. @param {Scene} scene @param {Problem} problem @param {any} n */
function summaryAlone(scene, problem, n) {
  return summaryOf(scene, problem.p, solved(problem, scene.solver).summary, n);
}

const COUNTS = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256];
const REFERENCE = 2048;

/** Largest relative error of the summary for numbers of segments, against a fine mesh. @param {Problem} problem */
function accuracyCurve(problem) {
  const best = marchOrThrow(problem, "work-preserving", countsFor(problem, REFERENCE));
  return ["work-preserving", "chord"].map((line) => {
    /** @type {{name: string, x: number[], y: number[]}} */
    const curve = { name: line, x: [], y: [] };
    const found = COUNTS.map((n) => march(problem, line, countsFor(problem, n))).filter(({ status }) => status >= 0);
    for (const each of found.sort((a, b) => a.lines - b.lines)) {
      curve.x.push(each.lines);
      curve.y.push(Math.max(CORE.compare(problem.p, each, best), 1e-15));
    }
    return curve;
  });
}

/** Energies at the samples, J; the work of the contact force by the trapezoidal rule. @param {Scene} scene @param {Result} result */
function energiesOf(scene, result) {
  const { motion } = result.motion;
  const { impactor_mass: mass, target_mass: other } = result.n;
  const force = motion.contact_force;
  /** @param {Float64Array} path */
  const work = (path) => {
    let sum = 0;
    return path.map((x, k) => (sum += k ? 0.5 * (force[k] + force[k - 1]) * (x - path[k - 1]) : 0));
  };
  /** @param {number} m @param {Float64Array} v */
  const kinetic = (m, v) => v.map((x) => 0.5 * m * x * x);
  const target = scene.base.free ? kinetic(other, motion.target_velocity) : work(motion.target_displacement);
  return { impactor: kinetic(mass, motion.impactor_velocity), contact: work(motion.indentation), target };
}

/**
 * The map of regimes with the scene on it, and its place in words. A place beyond the map is drawn at its edge.
 * @param {Scene} scene @param {any} n @returns {{chart: Chart, words: string}}
 */
function regimeMap(scene, n) {
  const value = scene.base.free || !(n.zener > 0) ? 0 : n.zener;
  const ratio = n.yield_velocity > 0 ? n.approach / n.yield_velocity : 0;
  const series = DATA.map.map((/** @type {Series} */ line, /** @type {number} */ colour) => ({ ...line, colour }));
  const [left, right] = extent(series.map((/** @type {Series} */ line) => line.x), true);
  const [low, high] = extent(series.map((/** @type {Series} */ line) => line.y), true);
  const point = /** @type {[number, number]} */ ([Math.min(Math.max(value, left), right), Math.min(Math.max(ratio, low), high)]);
  const beyond = point[0] === value && point[1] === ratio ? "" : "; drawn at the edge of the map";
  return {
    chart: {
      title: "Map of regimes",
      x: { label: "λ", dimension: "dimensionless", log: true },
      y: { label: "V/V_Y", dimension: "dimensionless", log: true },
      series,
      point,
    },
    words: `λ = ${shortNumber(value, 3)}, V/V_Y = ${ratio > 0 ? shortNumber(ratio, 3) : "0: no yield strength is known"}${beyond}`,
  };
}

/** Force over indentation, without values while the bodies do not touch. @param {{motion: {motion: Record<string, Float64Array>, stage: string[]}}} result */
function loopOf({ motion: { motion, stage } }) {
  const touching = (/** @type {string} */ name) => motion[name].map((value, k) => (stage[k] === "" ? NaN : value));
  return { x: touching("indentation"), y: touching("contact_force") };
}

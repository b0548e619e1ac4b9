// Effects of one impact that are decided by trials of it, by the rules of film_model/effects.

/**
 * The numbers of a scene with the law's strength at the strain rate of the impact, without weight; null if it stays that of
 * slow loading, by the rules of film_model/effects/rate_hardening.py.
 * @param {Scene} scene @param {any} n @param {any} law @param {number} impedance @param {number} compliance
 */
function hardened(scene, n, law, impedance, compliance) {
  const wanted = scene.effects.rate_hardening;
  const strengths = ["yield_strength", "flow_strength"];
  const [known, able] = [Number.isFinite(n.rate_coefficient), strengths.some((entry) => law.needs.includes(entry))];
  if (wanted === true && !known) throw new Unsupported("rate hardening needs a strain rate coefficient of the material that yields");
  if (wanted === true && !able && scene.law !== "auto") throw new Unsupported(`law ${law.name} has no yield strength that could rise`);
  if (wanted !== false && known && strengths.some((entry) => entry in law.fixed)) {
    throw new Unsupported(`law ${law.name} is available here without rate hardening only: its curve depends on the yield strength`);
  }
  if (wanted === false || !known || !able) return null;
  const times = (/** @type {number} */ factor) => {
    const [yields, flows] = strengths.map((entry) => n[entry] * factor);
    return { ...n, yield_strength: yields, flow_strength: flows, strength_factor: factor };
  };
  const found = (/** @type {number} */ factor) => {
    const problem = problemOf(law, times(factor), impedance, 0, compliance);
    return FORMULAS.strengthFactor(problem.p, trial(problem), n).factor;
  };
  let [before, factor] = [1, found(1)];
  let [value, open] = [factor, Math.abs(factor - before) > 0];
  for (let k = 0; k < DATA.constants.most_rounds && open; k++) {
    const next = found(factor);
    const { step, moves } = FORMULAS.secant(before, value, factor, next);
    [before, value, factor, open] = [factor, next, factor + step, moves];
  }
  if (open) factor = NaN;
  if (wanted === true && Number.isNaN(factor)) throw new Unsupported("the impact with the higher yield strength cannot be computed");
  return factor > 1 || wanted === true ? times(factor) : null;
}

/** The effect of rate hardening, where it can be judged. @param {Problem} slow @param {Problem} hard @param {boolean} yields */
function hardeningOf(slow, hard, yields) {
  const found = trial(slow);
  if (found.status !== EVENT) return {};
  if (!yields || !FORMULAS.deforms(slow.p, found).yields) return { rate_hardening: { simulated: false, change: 0 } };
  const change = changeOf(hard, slow);
  return Number.isNaN(change) ? {} : { rate_hardening: { simulated: hard !== slow, change } };
}

/**
 * The effect of waves in a half-space, and the impact with them; null if they are not known or not asked for.
 * @param {Scene} scene @param {any} slow numbers with the strength of slow loading @param {any} n @param {Problem} problem
 */
function wavesOf(scene, slow, n, problem) {
  const wanted = scene.effects.wave_losses;
  const yields = problem.law.family === "yields" ? "_yielding" : "";
  const impedance = slow[`waves${yields}`];
  if (wanted === true && !(impedance < Infinity)) throw new Unsupported("only the waves of a half-space of known material are known");
  if (!(impedance < Infinity) || wanted === false || (wanted === "auto" && scene.law !== "auto")) return null;
  const radiating = problemOf(problem.law, n, impedance, problem.load);
  const change = changeOf(radiating, problem);
  const tolerance = toleranceOf(scene);
  const { may } = FORMULAS.wavesMatter(problem.load > slow.heaviest, slow[`waves_most${yields}`], tolerance);
  return { simulated: wanted === true || (may && !(change <= tolerance)), change, radiating };
}

/** The change by waves from the edges of a plate, if the page can judge it; null if the plate has none. @param {Scene} scene @param {any} n @param {Problem} light @param {number} tolerance @returns {any} */
function edgesOf(scene, n, light, tolerance) {
  if (!scene.base.reflections || scene.base.edges === false || scene.effects.target_motion === false) return null;
  return FORMULAS[scene.base.reflections](entriesOf(scene), light.p, trial(light), tolerance);
}

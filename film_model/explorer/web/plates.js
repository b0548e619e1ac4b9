// Plates of finite size: how they move between their edges, by a table of film_model/effects/edge_effects.py.

/** Sides and struck point of a plate, m; null without sides. @param {Scene} scene */
function sidesOf(scene) {
  const of = (/** @type {string} */ name) => [0, 1].map((side) => scene.values[`target.${name}.${side}`] ?? null);
  const [size, position] = [of("size"), of("position")];
  const missing = (/** @type {(number|null)[]} */ values) => values.filter((value) => value === null).length;
  for (const [name, values] of Object.entries({ size, position })) {
    if (missing(values) === 1) throw new Unsupported(`target.${name} needs both values, along x and along y, or neither`);
  }
  const { boundary_reflections: reflections, target_motion: motion } = scene.effects;
  if (missing(size)) {
    const damped = scene.values["target.damping_ratio"] !== null;
    const others = { position: !missing(position), edges: scene.edges.some((edge) => edge !== DATA.edges[0]), damping_ratio: damped };
    const needing = Object.entries(others).find(([, given]) => given);
    if (needing) throw new Unsupported(`target.${needing[0]} needs a size: an infinite plate has neither edges nor vibrations`);
    if (reflections === true && motion !== false) throw new Unsupported("effects.boundary_reflections is true, but the plate has no size");
    return null;
  }
  const [x, y] = position.map((value, side) => value ?? /** @type {number} */ (size[side]) / 2);
  const [a, b] = /** @type {number[]} */ (size);
  const inside = [x, a - x, y, b - y].every((distance, k) => distance > 0 || (distance === 0 && scene.edges[k] === "free"));
  if (!inside) throw new Unsupported("target.position must lie between the edges, or on a free one: a support does not deflect");
  return { size: [a, b], position: [x, y] };
}

/** A plate with sides and its modes; the latest is kept. @param {Scene} scene */
function plateNow(scene) {
  const sides = sidesOf(scene);
  if (!sides) return null;
  const { size: [a, b], position: point } = sides;
  const { part, ...numbers } = FORMULAS[scene.base.plate.numbers](entriesOf(scene));
  const edges = scene.edges.map((edge) => DATA.edges.indexOf(edge));
  const key = [a, b, ...Object.values(numbers), ...point, ...edges].join(" ");
  if (CORE.plate.key === key) return CORE.plate;
  const whole = /** @type {any} */ ({ a, b, edges, ...numbers });
  const plate = edges.some((edge) => edge !== 0) ? ofEdges(whole, point) : ofSimpleEdges(whole, point);
  CORE.plate = Object.assign(plate, { key, part, rate: whole.rate, lacking: 0, modes: {} });
  return CORE.plate;
}

/** A simply supported plate, by the core's closed form. @param {Panel & {thickness: number, softness: number, bulge: number}} plate @param {number[]} point */
function ofSimpleEdges({ a, b, mass, d11, d12, d22, d66, thickness, softness, bulge }, point) {
  const whole = [a, b, ...point, mass, d11, d12 + 2 * d66, d22, 0, thickness, softness, bulge];
  const modes = (/** @type {number} */ highest) => CORE.plateModes(whole, highest);
  const { most_computed: limit, least_frequency: least } = DATA.constants.vibration;
  let [lowest, highest] = [least, 2 ** 60];
  while (CORE.ofPlate(whole, (place) => CORE.c.film_plate_most(place, highest)) > limit) highest /= 2 ** 0.25;
  while (lowest < highest && modes(lowest).frequency.length === 0) lowest *= 2;
  const compliance = CORE.ofPlate(whole, (place) => CORE.c.film_plate_compliance(place));
  const upTo = (/** @type {number} */ limit) => {
    const found = modes(limit);
    return { modes: found, lacking: Math.max(compliance - bentBy(found), 0), error: 0 };
  };
  return { held: true, compliance, lowest: modes(lowest).frequency[0] ?? 0, highest, upTo };
}

/** A plate with other edges, by Ritz's method; what takes long is computed when it is needed. @param {Panel} panel @param {number[]} point */
function ofEdges(panel, point) {
  const { least_frequency: least } = DATA.constants.vibration;
  const { most_work: most, sharpness: [[sharpness]], least: functions } = DATA.constants.ritz;
  /** @type {Map<number, any>} */
  const known = new Map();
  const modes = (/** @type {number} */ limit) => {
    if (!known.has(limit)) known.set(limit, panelModes(panel, point, limit));
    return known.get(limit);
  };
  let [few, highest] = [least, 2 ** 60];
  while (workOfPanel(panel, point, highest) > most) highest /= 2 ** 0.25;
  while (Math.max(...[0, 1].map((along) => halfWaves(panel, along, 16 * sharpness * few))) < functions - 2) few *= 16;
  const bends = () => modes(few).frequency.find((/** @type {number} */ own) => own > 0);
  /** @type {Record<string, number>|undefined} */
  let found;
  const statics = () => (found ??= panelCompliance(panel, point));
  return {
    held: !DATA.constants.ritz.loose_edges.includes(panel.edges.join("")),
    limited: true,
    inexact: simple(panel, 0) || simple(panel, 1) ? null : { cornered: cornered(panel), crossing: crossing(panel) },
    highest,
    upTo: (/** @type {number} */ limit) => ({ modes: modes(limit), ...omittedOf(panel, point, modes(limit), limit, statics()) }),
    get compliance() {
      return statics().compliance;
    },
    get lowest() {
      while (few < highest && !bends()) few *= 16;
      return bends() ?? 0;
    },
  };
}

/**
 * Whether a plate moves as an infinite one, by its static stiffness, or vibrates, and the effects of its edges.
 * @param {Scene} scene @param {any} n @param {any} law @param {any} support of plateNow
 * @returns {{moves: "infinite"|"static"|"vibrating", effects: ReturnType<typeof choose>["effects"]}}
 */
function edgesOfPlate(scene, n, law, support) {
  const { boundary_reflections: wanted, target_inertia: inertia } = scene.effects;
  const { plate } = scene.base;
  const infinite = problemOf(law, n, n.impedance, 0);
  const tried = trial(infinite);
  const sound = tried.status === EVENT && infinite.p.approach > 0 && tried.maximum_indentation > 0;
  let reflections = sound ? FORMULAS[plate.reflections](entriesOf(scene), infinite.p, tried).change : null;
  const near = reflections > toleranceOf(scene);
  const wayIf = (/** @type {boolean} */ quiet) => {
    const { ways, cases } = DATA.plate_ways;
    const [one, other] = [wanted, inertia].map((value) => [true, false, "auto"].indexOf(value));
    const flags = [near, law.series, law.family === "damped", support.held, quiet];
    return ways[cases[flags.reduce((sum, flag) => 2 * sum + Number(flag), 3 * one + other)]];
  };
  /** @type {number|null} */
  let ratio = null;
  let moves = wayIf(false);
  if (moves !== "infinite" && law.series) {
    const bent = problemOf(law, n, Infinity, 0, support.compliance);
    if (support.held) ratio = Number(FORMULAS[plate.inertia](bent.p, trial(bent), n, support.compliance, support.part).ratio);
    moves = wayIf(ratio !== null && ratio <= toleranceOf(scene));
    if (moves === "static") reflections = changeOf(bent, infinite);
  }
  if (moves.includes(" ")) throw new Unsupported(moves.replace("{law}", law.name));
  return {
    moves,
    effects: {
      boundary_reflections: { simulated: moves !== "infinite", change: reflections },
      target_inertia: { simulated: moves === "vibrating", change: moves === "infinite" ? 0 : ratio && Math.min(ratio, 1) },
    },
  };
}

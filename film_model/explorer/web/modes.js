// Impacts on a target that vibrates: as many of its modes as the accuracy needs, by the rules of film_model/solve/vibration.py.

const TOO_MANY = -5; // status of a march with too many segments

/**
 * How the target moves: as Python computed it, scaled with the plate's thickness, modulus and density of now; null if it does not.
 * @param {Scene} scene
 */
function supportNow(scene) {
  const { support, plate } = scene.base;
  if (plate) return plateNow(scene);
  const ratios = Object.entries(support?.scales ?? {}).map(([path, value]) => Number(scene.values[path]) / value);
  if (!ratios.some((ratio) => ratio !== 1)) return support;
  const [thickness, modulus, density] = ratios;
  const [rate, mass] = [thickness * Math.sqrt(modulus / density), thickness * density];
  const scaled = (/** @type {number[]} */ column, /** @type {number} */ factor) => column.map((value) => factor * value);
  const { frequency, share, ratio } = support.modes ?? {};
  return {
    ...support,
    key: `${support.key} ${ratios}`,
    compliance: support.compliance / (modulus * thickness ** 3),
    lacking: support.lacking / (modulus * thickness ** 3),
    lowest: rate * support.lowest,
    rate: rate * support.rate,
    highest: rate * support.highest,
    modes: support.modes && { frequency: scaled(frequency, rate), share: scaled(share, 1 / mass), ratio },
    stiffer: Math.sqrt(modulus * thickness),
  };
}

/** The power of 2^(1/steps) times a unit that is not below a value. @param {number} value */
const rounded = (value, unit = 1, steps = 4) => FORMULAS.onGrid(value, unit, steps).to;

/** Compliance of modes from the one with this number on, m/N, under a force that grows with a rate, 1/s. @param {Record<string, ArrayLike<number>>} modes */
function bentBy({ frequency, share }, from = 0, rate = 0) {
  let sum = 0;
  for (let k = from; k < frequency.length; k++) if (frequency[k] > 0 || rate > 0) sum += share[k] / (frequency[k] ** 2 + rate ** 2);
  return sum;
}

/**
 * The part of a target's static compliance that an impact feels, by film_model/effects/edge_effects.py: its slow modes move as free masses.
 * @param {any} support @param {Problem} fixed on a target that does not move @param {number} mass of the impactor
 */
function feltCompliance(support, fixed, mass) {
  const found = trial(fixed);
  if (!(support.compliance > 0) || found.status !== EVENT) return support.compliance;
  const { top, c } = CORE;
  const { frequency, share } = support.modes;
  const columns = [frequency, share].map((column) => CORE.numbersAt(column));
  const numbers = [support.lacking, mass, found.contact_duration * fixed.p.time, FORMULAS.softness(fixed.p, found).soft];
  const felt = c.film_modal_felt(frequency.length, ...columns, ...numbers, DATA.constants.vibration.slow, CORE.counts);
  CORE.top = top;
  return felt;
}

/**
 * The modes up to a frequency in the core's form, kept; with the omitted ones as one more mode for a law that no spring can follow.
 * @param {Scene} scene @param {number} highest in rad/s @param {number} longest step in s @param {boolean} series
 * @param {number} [softer] compliance that the omitted ones have more, m/N @param {boolean} [few] membrane forces on half as many
 */
function structureOf(scene, highest, longest, series, softer = 0, few = false) {
  const support = supportNow(scene);
  const own = scene.values["target.damping_ratio"];
  const key = `${support.key} ${highest} ${longest} ${series} ${own} ${softer} ${few}`;
  const known = CORE.structures.get(key);
  if (known) return known;
  CORE.tidy();
  const seen = support.upTo ? { ...support, ...support.upTo(highest) } : support;
  const { frequency, share } = seen.modes;
  const ratio = own === undefined ? seen.modes.ratio : frequency.map(() => own ?? 0);
  let count = frequency.length;
  while (count > 0 && frequency[count - 1] > highest) count--;
  const omitted = bentBy(seen.modes, count) + seen.lacking + softer;
  const forms = formsOf(seen, count, few);
  const columns = [frequency, share, ratio].map((/** @type {number[]} */ column) => column.slice(0, count));
  const shares = columns[1].reduce((/** @type {number} */ sum, /** @type {number} */ value) => sum + value, 0);
  if (!series && omitted > 0) {
    Object.values(FORMULAS.modeOf(omitted, highest)).forEach((value, k) => columns[k].push(value));
    count++;
  }
  const places = columns.map((column) => CORE.numbersAt(column));
  const { levels } = DATA.layout;
  const [place, memory] = [CORE.allocate(512), CORE.allocate(8 * CORE.c.film_structure_size(count, levels))];
  const status = CORE.c.film_structure_init(place, count, ...places, longest, levels, memory);
  if (status !== 0) throw new Failure(status);
  CORE.c.film_structure_stretch(place, forms[0]?.length ?? 0, forms.length, CORE.numbersAt(forms.flat(2)));
  const made = { place, count, omitted, error: seen.error ?? 0, shares, damped: columns[2].some((/** @type {number} */ value) => value > 0) };
  CORE.structures.set(key, made);
  return made;
}

/** Forms of the membrane energy of so many modes at most, none without. @param {any} support @param {number} count @param {boolean} few @returns {number[][][]} */
function formsOf({ membrane, stiffer = 1 }, count, few) {
  const size = { length: Math.min(count, few ? membrane?.few : Infinity, membrane?.forms[0].length) };
  const at = (/** @type {number[][]} */ form, /** @type {number} */ i, /** @type {number} */ j) => stiffer * form[Math.max(i, j)][Math.min(i, j)];
  return (membrane?.forms ?? []).map((/** @type {number[][]} */ form) => Array.from(size, (_, i) => Array.from(size, (__, j) => at(form, i, j))));
}

/**
 * The impact on the modes up to a frequency. Its record stays in memory until something else is computed.
 * @param {Scene} scene @param {Problem} problem @param {number} highest @param {number} tolerance of a step @param {number} limit s
 * @param {number} [softer] as of structureOf @param {boolean} [few]
 */
function followed(scene, problem, highest, tolerance, limit, softer = 0, few = false) {
  const { p, law, curve } = problem;
  const structure = structureOf(scene, highest, rounded(p.time), law.series, softer, few);
  const rest = law.series ? (structure.omitted * p.force) / p.length : 0;
  const { layout, top } = CORE;
  const start = CORE.allocate(layout.modal_start.size);
  const values = { nu: p.approach, load: p.load, rest, mass: p.mass, unit: p.time, damping: p.damping, tolerance, limit, stop: 0, stretch: p.length ** 2 };
  let found;
  for (let room = 2048; ; room *= 4) {
    found = marched(structure, curve, start, values, room);
    if (found.status !== FULL || room > 1e5) break;
    CORE.top = start + layout.modal_start.size;
  }
  const end = CORE.top;
  CORE.top = top;
  if (found.status === FULL) throw new Unsupported("the motion has more segments than there is room for on this page: use film-model run");
  if (found.status < 0) throw new Failure(found.status);
  return { ...found, structure, highest, tolerance, end, top };
}

/** One impact, recorded. @param {any} structure @param {number} curve @param {number} start @param {Record<string, number>} values @param {number} room segments */
function marched(structure, curve, start, values, room) {
  const { layout, c } = CORE;
  const { modal, modal_summary: outcome, modal_segment: segment, modal_event: event } = layout;
  const flights = Math.max(room >> 5, 16);
  const [state, waves] = [CORE.allocate(modal.size), CORE.allocate(8 * c.film_waves_size(structure.place))];
  const [result, record, energies] = [outcome.size, 64, 8 * structure.count].map((size) => CORE.allocate(size));
  const arrays = [room * segment.size, room * event.size, flights * 16 * structure.count].map((size) => CORE.allocate(size));
  let view = CORE.view();
  for (const [name, value] of Object.entries(values)) view.setFloat64(start + layout.modal_start[name], value, true);
  [...arrays, room, room, flights, 0, 0, 0].forEach((value, k) => view.setInt32(record + 4 * k, value, true));
  const status = c.film_modal_impact(structure.place, curve, start, state, waves, result, record);
  c.film_modal_energies(structure.place, state, waves, energies);
  view = CORE.view();
  const core = CORE.read("summary", result + outcome.core, ["stage", "lines"]);
  for (const name of ["time_of_maximum_indentation", "time_impactor_stops", "contact_duration"]) core[name] /= values.unit;
  const names = Array.from({ length: view.getInt32(record + 28, true) }, (_, k) => {
    const at = arrays[1] + k * event.size;
    return { name: layout.events[view.getInt32(at + event.event, true)], time: view.getFloat64(at + event.time, true) };
  });
  const whole = new Float64Array(CORE.c.memory.buffer, energies, structure.count);
  return {
    status,
    core: /** @type {Impact} */ (/** @type {unknown} */ ({ ...core, status })),
    contacts: view.getInt32(result + outcome.contacts, true),
    waited: view.getInt32(result + outcome.waited, true) !== 0,
    energy: whole.reduce((sum, value) => sum + value, 0) + c.film_modal_stretching(structure.place, state, waves),
    events: names,
    segments: arrays[0],
    count: view.getInt32(record + 24, true),
    flights: arrays[2],
  };
}

/** Difference of two summaries, value by value. @param {Problem} problem @param {Impact} a @param {Impact} b @returns {Record<string, number>} */
function differencesOf({ p, law }, a, b) {
  const found = Array.from(CORE.differences(p, a, b, 1), (difference, k) => [DATA.constants.compared[k], difference]);
  return Object.fromEntries(found.filter(([name]) => name !== "permanent_indentation" || law.dissipates));
}

/** @param {number} accuracy @param {any} outcome */
function unreached(accuracy, outcome) {
  return `accuracy ${accuracy} is not reached with the ${outcome.structure.count} natural vibrations here`;
}

/**
 * Largest change of the summary by the error of the omitted compliance, as of film_model/solve/vibration.py: _target_error.
 * @param {Scene} scene @param {Problem} problem @param {any} coarse the run before the last @param {number} accuracy @param {number} limit
 */
function errorOfCompliance(scene, problem, { core, highest, tolerance, structure: { omitted, error } }, accuracy, limit) {
  if (FORMULAS.negligible(error, FORMULAS.softness(problem.p, core).soft + omitted, accuracy).small) return 0;
  return Math.max(...Object.values(differencesOf(problem, core, followed(scene, problem, highest, tolerance, limit, error).core)));
}

/** Bound on the error by membrane forces on the lowest modes alone: _membrane_error. @param {Scene} scene @param {Problem} problem @param {any} found @param {number} limit */
function errorOfMembrane(scene, problem, { core, highest, tolerance }, limit) {
  if (!supportNow(scene).membrane) return 0;
  const other = followed(scene, problem, highest, tolerance, limit, 0, true);
  return DATA.constants.vibration.membrane_factor * Math.max(...Object.values(differencesOf(problem, other.core, core)));
}

/** The impact with as many modes as the accuracy needs, and the error estimate. @param {Scene} scene @param {Problem} problem */
function vibrate(scene, problem) {
  const support = supportNow(scene);
  const rule = DATA.constants.vibration;
  const accuracy = scene.solver.accuracy ?? DATA.constants.accuracy;
  const { p, law } = problem;
  CORE.c.film_modal_still(problem.curve, p.approach, CORE.result);
  const still = CORE.read("summary", CORE.result, ["stage", "lines"]);
  const { limit, least } = FORMULAS.following(p, still, support.compliance, support.lowest);
  const shared = rounded(least, support.rate, support.steps ?? 1);
  const first = 4 * shared > support.highest ? rounded(least, support.rate) : shared; // few sets of vibrations, unless they are too many
  const rattles = !law.series && structureOf(scene, Math.min(first, support.highest), rounded(p.time), law.series).omitted > 0;
  let [highest, most] = [first, Math.min(support.highest, rattles ? rule.highest * first : Infinity)];
  const cut = 2 * first > support.highest;
  const refuse = () => {
    if (support.limited) throw new Unsupported(`accuracy ${accuracy} needs more functions for these edges than the page computes in a second: ask for a looser accuracy, or use film-model run`);
  };
  if (4 * first > support.highest) refuse();
  if (cut) highest = support.highest / 4;
  if (highest < rule.unresolved * first) throw new Unsupported("too few natural vibrations of the target are on this page for so short a contact");
  const follow = (/** @type {number} */ tolerance, upTo = highest) => followed(scene, problem, upTo, tolerance, limit);
  const tightened = (/** @type {number} */ from, /** @type {number} */ share) => FORMULAS.tightened(from, share).tolerance;
  let tolerance = tightened(accuracy, rule.step);
  const workOf = (/** @type {any} */ { core, structure }) => core.lines * (structure.count + rule.modes_of_a_step);
  let coarse = follow(rule.refined * tolerance);
  let spent = workOf(coarse);
  /** @type {Record<string, number>|null} */
  let before = null;
  tolerance = tightened(tolerance, FORMULAS.swiftness(p, coarse.core, coarse.structure.shares, coarse.highest).share);
  const shares = () => structureOf(scene, 2 * highest, rounded(p.time), law.series).shares;
  const quick = () => FORMULAS.swiftness(p, coarse.core, shares(), 2 * highest).rate > rule.followed * 2 * highest;
  while (!cut && !rattles && 4 * highest <= most && quick()) highest *= 2;
  /** @type {number|null} */
  let error = null;
  const estimates = [Infinity];
  let [count, same] = [0, false];
  const outOfReach = () => p.damping > 0 && estimates.length > 3 && FORMULAS.falling(estimates.at(-1), estimates.at(same ? -2 : -3), most / highest).later > accuracy;
  for (;;) {
    [count, same] = [coarse.structure.count, coarse.structure.count === count];
    highest = Math.min((same ? rule.stiffer : 2) * highest, most);
    let fine;
    try {
      fine = follow(tolerance);
    } catch (failure) { // a stiff omitted mode rattles between the impactor and the others
      const long = failure instanceof Unsupported || (failure instanceof Failure && failure.status === TOO_MANY);
      if (!long || error === null) throw failure;
      error += errorOfMembrane(scene, problem, coarse, limit);
      return { ...followed(scene, problem, coarse.highest, coarse.tolerance, limit), error, warning: unreached(accuracy, coarse) };
    }
    const changes = differencesOf(problem, coarse.core, fine.core);
    spent += workOf(fine);
    const last = 2 * highest > most || spent + 4 * workOf(fine) > rule.most_work;
    if (before === null && last) { // the difference to fewer modes than those of the first run is known quickly
      before = differencesOf(problem, follow(rule.refined ** 2 * tolerance, highest / 4).core, coarse.core);
      fine = follow(tolerance); // whose record was overwritten
    }
    if (before === null) {
      [coarse, before, tolerance] = [fine, changes, tightened(tolerance, 1 / rule.refined)];
      continue;
    }
    const known = before;
    const errorOf = FORMULAS[p.damping > 0 ? "errorDamped" : "error"];
    const errors = Object.entries(changes).map(([name, change]) => errorOf(known[name], change).bound + tolerance);
    error = Math.max(...errors);
    estimates.push(error);
    if (error > accuracy && 2 * highest > support.highest) refuse();
    if (error <= accuracy || last || outOfReach()) {
      const own = errorOfCompliance(scene, problem, coarse, accuracy, limit) + errorOfMembrane(scene, problem, fine, limit);
      if (own > 0) fine = follow(fine.tolerance);
      return { ...fine, error: error + own, warning: error + own <= accuracy ? "" : unreached(accuracy, fine) };
    }
    [coarse, before, tolerance] = [fine, changes, tightened(tolerance, 1 / rule.refined)];
  }
}

/** One impact on modes, as `run` of others. @param {Scene} scene @param {any} n @param {Problem} problem @param {number} samples @param {boolean} slides with friction */
function runOnModes(scene, n, problem, samples, slides) {
  const outcome = vibrate(scene, problem);
  const { p, law } = problem;
  const separated = outcome.status === EVENT;
  const summary = vibratingSummary(problem, outcome, n);
  const warnings = [...law.remarks];
  if (outcome.warning) warnings.push(outcome.warning);
  if (outcome.contacts > 1) warnings.push(`there are ${outcome.contacts} contacts: the contact duration is that of the first, the rebound that after the last`);
  warnings.push(...energyWarnings(problem, summary));
  if (outcome.waited) warnings.push("the target still vibrates so far that it may touch the impactor again");
  CORE.top = outcome.end;
  const last = (outcome.events.at(-1)?.time ?? 0) / p.time;
  const sample = (/** @type {Float64Array} */ times) => sampleModes(outcome, problem, times);
  const motion = sampledAt(scene, problem, [last, ...outcome.events.map((event) => event.time / p.time)], samples, sample);
  const error = outcome.error + law.fit_error;
  const contacts = ["contact_begins", "contact_ends"].map((kind) => outcome.events.filter(({ name }) => name === kind).map(({ time }) => time));
  const oblique = slides ? obliqueOf(scene, n, problem, summary, { contacts, error }, sample) : null;
  CORE.top = outcome.top;
  return { summary, warnings, error, counts: [], segments: outcome.count, modes: outcome.structure.count, motion, oblique, status: separated ? EVENT : 0, law };
}

/** The summary in SI, with the energy of the modes. @param {Problem} problem @param {any} outcome @param {any} n */
function vibratingSummary({ p, law }, outcome, n) {
  const core = { ...outcome.core, status: outcome.status === EVENT ? EVENT : 0 };
  const summary = FORMULAS[`summaryVibrating${p.damping > 0 ? "Damped" : ""}`](p, core, n);
  if (outcome.status !== EVENT) return summary;
  summary.energy_radiated = (outcome.structure.damped ? FORMULAS.radiated(p, core).energy : outcome.energy) * p.energy;
  if (!law.dissipates && !(law.family === "damped")) summary.energy_absorbed = 0;
  return summary;
}

/** Values and branches at times of the march. @param {any} outcome @param {Problem} problem @param {Float64Array} times */
function sampleModes(outcome, problem, times) {
  const { c } = CORE;
  const at = CORE.numbersAt(Array.from(times, (t) => t * problem.p.time));
  const [values, branches] = [CORE.allocate(40 * times.length), CORE.allocate(times.length)];
  c.film_modal_sample(outcome.structure.place, problem.curve, outcome.segments, outcome.count, outcome.flights, at, BigInt(times.length), values, branches);
  const { buffer } = c.memory;
  return {
    values: new Float64Array(buffer, values, 5 * times.length).slice(),
    branches: new Int8Array(buffer, branches, times.length).slice(),
  };
}

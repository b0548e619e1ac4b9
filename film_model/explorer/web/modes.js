// Impacts on a target that vibrates: as many of its modes as the accuracy needs, by the rules of film_model/solve/vibration.py.

const TOO_MANY = -5; // status of a march with too many segments
const [ENOUGH, RUN, SHARES, SOFTER, FEWER, FAILED] = DATA.layout.asks;

/**
 * How the target moves: as Python computed it, scaled with the plate's thickness, modulus and density of now; null if it does not.
 * @param {Scene} scene
 */
function supportNow(scene) {
  const { support, plate } = scene.base;
  if (plate) return plateNow(scene);
  const ratios = Object.entries(support?.scales ?? {}).map(([path, value]) => Number(scene.values[path]) / value);
  if (!ratios.some((ratio) => ratio !== 1)) return support;
  const { rate, share: lighter, compliance, stiffer } = FORMULAS.scaled(...ratios);
  const scaled = (/** @type {number[]} */ column, /** @type {number} */ factor) => column.map((value) => factor * value);
  const { frequency, share, ratio } = support.modes ?? {};
  return {
    ...support,
    key: `${support.key} ${ratios}`,
    compliance: support.compliance * compliance,
    lacking: support.lacking * compliance,
    lowest: rate * support.lowest,
    rate: rate * support.rate,
    highest: rate * support.highest,
    inexact: support.inexact && { ...support.inexact, crossing: rate * support.inexact.crossing },
    modes: support.modes && { frequency: scaled(frequency, rate), share: scaled(share, lighter), ratio },
    stiffer,
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
 * @param {boolean} soft with the errors of frequencies and of the omitted compliance @param {boolean} few membrane forces on half as many
 */
function structureOf(scene, highest, longest, series, soft, few) {
  const support = supportNow(scene);
  const own = scene.values["target.damping_ratio"];
  const key = `${support.key} ${highest} ${longest} ${series} ${own} ${soft} ${few}`;
  const known = CORE.structures.get(key);
  if (known) return known;
  CORE.tidy();
  const seen = support.upTo ? { ...support, ...support.upTo(highest) } : support;
  const { frequency, share } = seen.modes;
  const ratio = own === undefined ? seen.modes.ratio : frequency.map(() => own ?? 0);
  let count = frequency.length;
  while (count > 0 && frequency[count - 1] > highest) count--;
  const forms = formsOf(seen, count, few);
  const columns = [frequency, share, ratio].map((/** @type {number[]} */ column) => column.slice(0, count));
  const raised = columns[0].map((/** @type {number} */ own) => own * (1 + (seen.inexact ? FORMULAS.missed(0.5 * own / highest, seen.inexact.cornered).part : 0)));
  const [stiff, bent] = [raised, columns[0]].map((own) => bentBy({ frequency: own, share: columns[1] }, 0, seen.inexact?.crossing));
  const doubt = (seen.error ?? 0) + bent - stiff;
  if (soft) columns[0] = raised;
  const omitted = bentBy(seen.modes, count) + seen.lacking + (soft ? doubt : 0);
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
  const made = { place, count, omitted, error: doubt, shares, damped: columns[2].some((/** @type {number} */ value) => value > 0) };
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
 * The impact on modes. Its record stays in memory until something else is computed.
 * @param {Problem} problem @param {any} structure @param {number} tolerance of a step @param {number} limit s
 */
function followed({ p, law, curve }, structure, tolerance, limit) {
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
  return { ...found, structure, end, top };
}

/** One impact, recorded. @param {any} structure @param {number} curve @param {number} start @param {Record<string, number>} values @param {number} room segments */
function marched(structure, curve, start, values, room) {
  const { layout, c } = CORE;
  const { modal, modal_summary: outcome, modal_segment: segment, modal_event: event } = layout;
  const flights = Math.max(room >> 5, 16);
  const [state, waves] = [CORE.allocate(modal.size), CORE.allocate(8 * c.film_waves_size(structure.place))];
  const [result, record, energies] = [outcome.size, 64, 8 * structure.count].map((size) => CORE.allocate(size));
  const arrays = [room * segment.size, room * event.size, flights * 16 * structure.count].map((size) => CORE.allocate(size));
  CORE.write("modal_start", start, values);
  let view = CORE.view();
  [...arrays, room, room, flights, 0, 0, 0].forEach((value, k) => view.setInt32(record + 4 * k, value, true));
  const status = c.film_modal_impact(structure.place, curve, start, state, waves, result, record);
  c.film_modal_energies(structure.place, state, waves, energies);
  view = CORE.view();
  const core = CORE.read("summary", result + outcome.core);
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

/** The impact with as many modes as the accuracy needs, and the error estimate: film_refine asks for the runs. @param {Scene} scene @param {Problem} problem */
function vibrate(scene, problem) {
  const { c, layout, plan, run } = CORE;
  const support = supportNow(scene);
  const rule = DATA.constants.vibration;
  const accuracy = scene.solver.accuracy ?? DATA.constants.accuracy;
  const { p, law } = problem;
  c.film_modal_still(problem.curve, p.approach, CORE.result);
  const { limit, least } = FORMULAS.following(p, CORE.read("summary", CORE.result), support.compliance, support.lowest);
  const shared = rounded(least, support.rate, support.steps ?? 1);
  const first = 4 * shared > support.highest ? rounded(least, support.rate) : shared; // few sets of vibrations, unless they are too many
  const structure = (/** @type {number} */ highest, soft = false, few = false) => structureOf(scene, highest, rounded(p.time), law.series, soft, few);
  const rattles = !law.series && structure(Math.min(first, support.highest)).omitted > 0;
  const refuse = (/** @type {number} */ highest) => {
    if (support.limited && highest > support.highest) throw new Unsupported(`accuracy ${accuracy} needs more functions for these edges than the page computes in a second: ask for a looser accuracy, or use film-model run`);
  };
  refuse(4 * first);
  const cut = 2 * first > support.highest;
  const begin = cut ? support.highest / 4 : first;
  if (begin < rule.unresolved * first) throw new Unsupported("too few natural vibrations of the target are on this page for so short a contact");
  const most = Math.min(support.highest, rattles ? rule.highest * first : Infinity);
  const flags = { damped: +(p.damping > 0), reversible: +!law.dissipates, skips: +(!cut && !rattles), carried: +Boolean(support.membrane) };
  CORE.writeStart(p, plan + layout.refine.start);
  CORE.write("refine", plan, { ...flags, length: p.length, force: p.force, time: p.time, accuracy, most, most_work: rule.most_work });
  c.film_refine_begin(plan, begin);
  /** @type {any} */
  let found = null;
  let recorded = NaN;
  for (;;) {
    const { ask, highest, tolerance, estimated, own } = CORE.read("refine", plan);
    const follow = (soft = false, few = false) => followed(problem, structure(highest, soft, few), tolerance, limit);
    if (ask === ENOUGH) {
      if (recorded !== highest) found = follow();
      const error = estimated + own;
      if (estimated > accuracy) refuse(2 * highest);
      return { ...found, error, warning: error <= accuracy ? "" : `accuracy ${accuracy} is not reached with the ${found.structure.count} natural vibrations here` };
    }
    let [taken, failure] = [/** @type {Record<string, number>} */ ({}), /** @type {unknown} */ (null)];
    try {
      if (ask === SHARES) {
        taken = { status: 0, shares: structure(highest).shares };
      } else {
        [found, recorded] = [follow(ask === SOFTER, ask === FEWER), ask === RUN ? highest : NaN];
        const { shares, omitted, error, count } = found.structure;
        taken = { status: 0, shares, omitted, error, modes: count };
        CORE.write("summary", run + layout.run.core, found.core);
      }
    } catch (error) { // a stiff omitted mode rattles between the impactor and the others
      [recorded, failure] = [NaN, error];
      taken = { status: error instanceof Failure ? error.status : TOO_MANY };
    }
    CORE.write("run", run, taken);
    c.film_refine_next(plan, run);
    if (failure && CORE.read("refine", plan).ask === FAILED) throw failure;
  }
}

/** One impact on modes, as `run` of others. @param {Scene} scene @param {any} n @param {Problem} problem @param {number} samples @param {boolean} slides with friction */
function runOnModes(scene, n, problem, samples, slides) {
  const outcome = /** @type {ReturnType<typeof followed> & {error: number, warning: string}} */ (vibrate(scene, problem));
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
  summary.energy_radiated = FORMULAS.transferred(p, core, outcome.structure.damped, outcome.energy).energy * p.energy;
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

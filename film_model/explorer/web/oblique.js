// The motion along the surface of an impact with friction: film_model/oblique, by the same C and the recorded formulas.

/**
 * What friction did. motion: columns over time, SI. low, high: of the sliding velocity after under two models of a contact that yields, less and plus their errors.
 * table: of friction, speeds and coefficients in turn.
 * @typedef {{table: number[], summary: Record<string, number>, sliding_regime: string, events: {name: string, time: number}[], estimated_error: number,
 *   motion: {time: Float64Array, sliding_velocity: Float64Array, friction_force: Float64Array}, low: number, high: number,
 *   before: {along: number, away: number, spin: number}}} Oblique
 */

/** The coefficient at a speed, m/s. @param {number[]} table @param {number} speed */
function frictionAt(table, speed) {
  const { top, c } = CORE;
  const found = c.film_friction_at(CORE.numbersAt(table), table.length / 2, speed);
  CORE.top = top;
  return found;
}

/**
 * The motion along the surface; null without friction, or if nothing slides.
 * @param {Scene} scene @param {any} n @param {Problem} problem @param {Record<string, number>} summary
 * @param {{contacts: number[][], error: number}} own of the normal motion, begins and ends, s, and relative @param {(times: Float64Array) => {values: Float64Array}} sample it, at times of the march @returns {Oblique|null}
 */
function obliqueOf(scene, n, problem, summary, own, sample) {
  const { along } = scene.base;
  const friction = scene.values["contact.friction"];
  if (!along || friction === null) return null;
  const x = entriesOf(scene);
  const { velocity } = FORMULAS[along.sliding](x, problem.p);
  if (velocity === 0) return null;
  const table = Array.isArray(friction) ? friction : [0, friction];
  x["contact.friction"] = frictionAt(table, Math.abs(velocity));
  const given = /** @type {any} */ ({ ...FORMULAS[along.sliding](x, problem.p), table });
  if (Number.isNaN(summary.rebound_velocity)) throw new Unsupported("friction needs a contact that ends");
  const found =
    table.length === 2 && given.friction === 0 ? frictionless(given)
    : exactFriction(given, problem) || frictionOfSprings(scene, n, problem, given, summary.rebound_velocity, own, sample);
  const { regimes } = DATA.constants.friction;
  return {
    table,
    summary: FORMULAS[along.oblique](x, summary.rebound_velocity, found.after, ...found.peak),
    sliding_regime: regimes[found.regime],
    events: found.events,
    estimated_error: found.error,
    motion: found.motion,
    low: found.low ?? found.after,
    high: found.high ?? found.after,
    before: { along: given.along, away: -n.speed, spin: given.spin },
  };
}

/** @param {any} given */
function frictionless({ velocity }) {
  const motion = { time: Float64Array.of(0), sliding_velocity: Float64Array.of(velocity), friction_force: Float64Array.of(0) };
  return { after: velocity, peak: [0, 0], regime: 2, events: [{ name: "slides", time: 0 }], error: 0, motion, low: velocity, high: velocity };
}

/** Exact between events, for a law that is one convex power; null for others. @param {any} given @param {Problem} problem */
function exactFriction(given, { law, p, vibrates, compliance }) {
  if (!law.power || FORMULAS.bySprings(given.table.length > 2, vibrates, compliance).springs) return null;
  const { layout, c, top } = CORE;
  const { normal, friction: outcome } = layout;
  const [start, result, count] = [CORE.allocate(normal.size), CORE.allocate(outcome.size), CORE.allocate(8)];
  const [slope, coefficient, exponent] = law.power;
  const values = { slope, coefficient, exponent, approach: p.approach, gamma: p.gamma, load: p.load };
  CORE.write("normal", start, values);
  let [room, status, rows] = [4096, FULL, 0];
  for (const above = CORE.top; status === FULL && room < 1e5; room *= 4) {
    CORE.top = above;
    rows = CORE.allocate(48 * room);
    status = c.film_friction(start, given.rate, given.before, 0, result, rows, 64, room, count); // 64 rows a step: lines between them are within 2e-5
  }
  CORE.top = top;
  const view = CORE.view();
  const number = (/** @type {string} */ name) => view.getFloat64(result + outcome[name], true);
  const { closed } = DATA.constants.friction;
  if (status !== 0 || number("closure") > closed) return null;
  const columns = new Float64Array(c.memory.buffer, rows, 6 * view.getInt32(count, true)).slice();
  const column = (/** @type {number} */ which, /** @type {number} */ unit) => Float64Array.from({ length: columns.length / 6 }, (_, k) => columns[6 * k + which] * unit);
  const unit = given.friction * given.ratio;
  const events = phasesAt(view, result, outcome, outcome.phases, p.time);
  return {
    after: number("velocity") * unit * p.velocity,
    peak: [number("force") * given.friction * p.force, number("time_of_force") * p.time],
    regime: view.getInt32(result + outcome.regime, true),
    events,
    error: given.error,
    motion: { time: column(0, p.time), sliding_velocity: column(3, unit * p.velocity), friction_force: column(4, given.friction * p.force) },
    low: undefined,
    high: undefined,
  };
}

/** Phases that a structure of the core lists. @param {DataView} view @param {number} at @param {Record<string, number>} layout @param {number} count its place @param {number} unit of time */
function phasesAt(view, at, layout, count, unit) {
  const { phases } = DATA.constants.friction;
  return Array.from({ length: view.getInt32(at + count, true) }, (_, k) => ({
    name: phases[view.getInt32(at + layout.kinds + 4 * k, true)],
    time: view.getFloat64(at + layout.begins + 8 * k, true) * unit,
  }));
}

/**
 * By springs beside each other that slip, under two models of the stiffness along the surface if the law yields.
 * @param {Scene} scene @param {any} n @param {Problem} problem @param {any} given
 * @param {number} rebound m/s @param {{contacts: number[][], error: number}} own @param {(times: Float64Array) => {values: Float64Array}} sample
 */
function frictionOfSprings(scene, n, problem, given, rebound, own, sample) {
  const { p, law, curve } = problem;
  const [begins, stops] = own.contacts;
  const { steps } = FORMULAS.stepsOf(begins.length); // of each contact
  const time = Float64Array.from(begins.flatMap((begin, i) => Array.from({ length: steps + 1 }, (_, k) => (k === steps ? stops[i] : begin + k * ((stops[i] - begin) / steps)))));
  const { values } = sample(time.map((t) => t / p.time));
  const convert = FORMULAS[scene.base.free ? "motionFree" : "motionFixed"];
  const normal = Array.from(time, (t, k) => convert(p, t, values, 5 * k));
  const force = Float64Array.from(normal, (row) => Math.max(row.contact_force, 0));
  const depth = Float64Array.from(normal, (row) => row.indentation);
  let left = false; // Hertz's force, as where the first stage of the law ends; it is met again by chance alone
  const radiusAt = (/** @type {number} */ F, /** @type {number} */ k) => {
    const found = FORMULAS.contactRadius(p, n, F, depth[k]);
    left ||= FORMULAS.leaves(found.elastic, depth[k], (law.first_end ?? Infinity) * p.length).left;
    return (left && found.elastic ? FORMULAS.contactRadius(p, n, Infinity, depth[k]) : found).radius;
  };
  const radii = law.dissipates ? radiiBeyondYield(begins.length, force, depth, force.map(radiusAt), n.effective_modulus)
    : [elasticRadii(curve, p, force, depth, n.effective_modulus)];
  const power = CORE.c.film_springs_power(curve);
  const runs = radii.map((radius) => followSprings(DATA.constants.friction.springs, { ...given, power }, begins, steps, time, force, radius));
  const [{ velocity, friction, largest, step, regime, events }] = runs;
  const seen = force.reduce((sum, F, k) => sum + (k > 0 ? 0.5 * (F + force[k - 1]) * (time[k] - time[k - 1]) : 0), 0);
  const { impulse } = FORMULAS.impulseOf(p, n, rebound, stops.at(-1));
  const slid = CORE.c.film_friction_slid(CORE.numbersAt(given.table), given.table.length / 2, given.velocity, impulse / given.mass);
  const ends = runs.map((run) => FORMULAS.ended(run.slack, slid, run.velocity.at(-1)).velocity);
  const { low, high, error } = FORMULAS.judged(ends, runs.map((run) => run.error), steps, Math.abs(given.velocity), FORMULAS.normalError(own.error, seen, impulse).error);
  return {
    after: ends[0],
    peak: [largest, time[step]],
    regime,
    events,
    error,
    motion: { time, sliding_velocity: velocity, friction_force: friction },
    low: runs.length > 1 ? low : undefined,
    high: runs.length > 1 ? high : undefined,
  };
}

/** Contact radii of a reversible law, F′/(2 E*). @param {number} curve @param {any} p @param {Float64Array} force @param {Float64Array} depth @param {number} modulus */
function elasticRadii(curve, p, force, depth, modulus) {
  const { top, c } = CORE;
  const given = [force.map((F) => F / p.force), depth.map((d) => d / p.length)].map((column) => CORE.numbersAt(Array.from(column)));
  const found = CORE.allocate(8 * force.length);
  c.film_springs_slopes(curve, BigInt(force.length), ...given, found);
  const radii = new Float64Array(c.memory.buffer, found, force.length).map((slope) => (slope * (p.force / p.length)) / (2 * modulus));
  CORE.top = top;
  return radii;
}

/** Contact radii of contacts that yield and follow each other, by two models. @param {number} contacts @param {Float64Array} force @param {Float64Array} depth @param {Float64Array} law @param {number} modulus */
function radiiBeyondYield(contacts, force, depth, law, modulus) {
  const { top, c } = CORE;
  const given = [force, depth, law].map((column) => CORE.numbersAt(Array.from(column)));
  const found = [0, 1].map(() => CORE.allocate(8 * force.length));
  c.film_springs_radii(1n, BigInt(contacts), BigInt(force.length / contacts), ...given, modulus, ...found);
  const radii = found.map((place) => new Float64Array(c.memory.buffer, place, force.length).slice());
  CORE.top = top;
  return radii;
}

/** Sliding velocity and friction force at the times, and what the core says of them. @param {number} count @param {any} given @param {number[]} begins of contacts @param {number} steps of each @param {Float64Array} time @param {Float64Array} force @param {Float64Array} radius */
function followSprings(count, { modulus, power, table, mass, velocity }, begins, steps, time, force, radius) {
  const { layout: { springs, watch }, top, c } = CORE;
  const result = CORE.allocate(springs.size);
  const each = begins.map((begin, k) => time[k * (steps + 1) + 1] - begin);
  const [starts, step, ...columns] = [begins, each, force, radius].map((column) => CORE.numbersAt(Array.from(column)));
  const found = CORE.allocate(24 * time.length);
  const status = c.film_springs_impact(count, modulus, power, mass, velocity, CORE.numbersAt(table), table.length / 2, BigInt(begins.length), starts, step, BigInt(steps), ...columns, result, found);
  if (status !== 0) throw new Failure(status);
  const rows = new Float64Array(c.memory.buffer, found, 3 * time.length);
  const [v, q] = [0, 1].map((which) => time.map((_, k) => rows[3 * k + which]));
  const view = CORE.view();
  const [largest, error, slack] = ["force", "error", "slack"].map((name) => view.getFloat64(result + springs[name], true));
  const [regime, events] = [view.getInt32(result + springs.regime, true), phasesAt(view, result + springs.watch, watch, watch.events, 1)];
  const run = { velocity: v, friction: q, largest, error, slack, regime, events, step: Number(view.getBigInt64(result + springs.step, true)) };
  CORE.top = top;
  return run;
}

/** Sliding velocity, m/s, and friction force, N, at ascending times, with lines between the computed ones; none without friction. @param {ArrayLike<number>} times @param {Oblique|null} oblique @returns {Record<string, Float64Array>} */
function alongAt(times, oblique) {
  if (!oblique) return {};
  const { time, sliding_velocity, friction_force } = oblique.motion;
  const at = (/** @type {Float64Array} */ column) => {
    let k = 1;
    return Float64Array.from(times, (t) => {
      while (k < time.length - 1 && time[k] < t) k++;
      const part = k < time.length ? Math.min(Math.max((t - time[k - 1]) / (time[k] - time[k - 1]), 0), 1) : 0;
      return part > 0 ? column[k - 1] + part * (column[k] - column[k - 1]) : column[k - 1];
    });
  };
  return { sliding_velocity: at(sliding_velocity), friction_force: at(friction_force) };
}

/** What must be known of the results. @param {Oblique|null} oblique @param {number|null} accuracy that was asked for @returns {string[]} */
function warningsOf(oblique, accuracy) {
  if (!oblique) return [];
  const { low, high, motion, estimated_error: error } = oblique;
  const { inexact, apart } = FORMULAS.doubted(error, accuracy ?? NaN, low, high, Math.abs(motion.sliding_velocity[0]));
  const texts = inexact ? [`friction: the sliding velocity is known to ${percent(error)} of that before only`] : [];
  if (apart) {
    const [from, to] = [low, high].map((value) => shown(value, "velocity", 3));
    texts.push(`friction: how stiff a contact that yields is along the surface is not known; two models give a sliding velocity after the impact of ${from} and ${to}`);
  }
  return texts;
}

/** Friction over time between its limits. @param {Record<string, Float64Array>} normal motion @param {Oblique} oblique @returns {Chart} */
function frictionChart(normal, oblique) {
  const { motion, table } = oblique;
  const { sliding_velocity } = alongAt(normal.time, oblique);
  const limit = normal.contact_force.map((force, k) => frictionAt(table, Math.abs(sliding_velocity[k])) * Math.max(force, 0));
  return {
    title: "Friction",
    x: { label: "time", dimension: "time" },
    y: { label: "friction", dimension: "force" },
    series: [
      { name: "friction", x: motion.time, y: motion.friction_force, colour: 0 },
      { name: "limits ±µF", x: normal.time, y: limit, colour: 1, dashed: true },
      { name: "", x: normal.time, y: limit.map((value) => -value), colour: 1, dashed: true },
    ],
  };
}

/**
 * The ball as a strobe sees it, at even times before and after the impact; a radius shows how far it has turned.
 * @param {number} radius @param {Oblique} oblique @param {number} rebound @returns {Chart}
 */
function strobeChart(radius, { before, summary }, rebound) {
  const { balls, spacing } = DATA.constants.friction;
  const after = { along: summary.tangential_rebound_velocity, away: -rebound, spin: summary.rebound_spin };
  const interval = (spacing * radius) / Math.max(...[before, after].map(({ along, away }) => Math.hypot(along, away)));
  const places = Array.from({ length: 2 * balls + 1 }, (_, k) => {
    const [time, path] = [(k - balls) * interval, k > balls ? after : before];
    return { x: path.along * time, z: radius + path.away * time, turn: path.spin * time };
  });
  /** @type {Series[]} */
  const series = places.map(({ x, z, turn }, k) => {
    const angles = Array.from({ length: 65 }, (_, j) => turn + (Math.PI * j) / 32);
    const name = k === 0 ? "before" : k === balls + 1 ? "after" : "";
    return { name, x: [x, ...angles.map((a) => x + radius * Math.sin(a))], y: [z, ...angles.map((a) => z - radius * Math.cos(a))], colour: k > balls ? 1 : 0 };
  });
  series.push({ name: "centre", x: places.map(({ x }) => x), y: places.map(({ z }) => z), colour: 2, dashed: true });
  return { title: `Path, one picture every ${shown(interval, "time", 3)}`, x: { label: "along the surface", dimension: "length" }, y: { label: "height", dimension: "length" }, series, equal: true };
}

// The core in WebAssembly: its memory, and its functions with JavaScript's numbers.

const EVENT = 1;
const BAD_NUMBER = -1;
const FULL = -7;
const FEW_MESHES = 6; // that nearly all contacts need
const MOST_MEMORY = 256e6; // bytes of meshes and modes that are kept
const KEPT = 8; // curves of shapes that are kept
const SPRUNG = 16; // curves in series with a spring that one impact may need at a time

/**
 * The core's summary of one contact, with its status.
 * @typedef {Record<string, number>} Impact
 */

class Core {
  /**
   * @param {WebAssembly.Instance} instance
   * @param {any} layout
   * @param {Uint8Array} curves
   */
  constructor(instance, layout, curves) {
    this.c = /** @type {any} */ (instance.exports);
    this.layout = layout;
    /** @type {Map<string, number>} */
    this.meshes = new Map();
    this.c._initialize();
    this.top = Number(this.c.__heap_base.value);
    this.top += (8 - (this.top % 8)) % 8;
    this.curves = this.allocate(curves.length);
    new Uint8Array(this.c.memory.buffer).set(curves, this.curves);
    this.start = this.allocate(layout.start.size);
    this.result = this.allocate(layout.summary.size);
    this.other = this.allocate(layout.summary.size);
    this.state = this.allocate(layout.state.size);
    this.counts = this.allocate(8);
    this.plan = this.allocate(layout.refine.size);
    this.run = this.allocate(layout.run.size);
    /** The shapes of curves, and where the curves are. @type {Map<string, number>} */
    this.shapes = new Map();
    this.family = this.allocate(32);
    this.numbers = this.allocate(65536);
    this.c.film_sizes(this.numbers);
    this.meshSize = Number(this.view().getBigInt64(this.numbers + 8, true));
    /** Modes in the core's form. @type {Map<string, {place: number, count: number, omitted: number, shares: number, damped: boolean}>} */
    this.structures = new Map();
    /** Functions on a line for Ritz's method. @type {Map<string, number>} */
    this.lines = new Map();
    /** The latest plate whose modes were computed here. @type {any} */
    this.plate = {};
    this.sprung = Array.from({ length: SPRUNG }, () => this.allocate(layout.curve));
    this.shaped = Array.from({ length: KEPT }, () => this.allocate(layout.curve));
    this.fixedTop = this.top;
  }

  /** The address of new memory. @param {number} size in bytes */
  allocate(size) {
    const place = this.top;
    this.top += size + ((8 - (size % 8)) % 8);
    const missing = this.top - this.c.memory.buffer.byteLength;
    if (missing > 0) this.c.memory.grow(Math.ceil(missing / 65536));
    return place;
  }

  /** The address of a copy of numbers. @param {number[]} values */
  numbersAt(values) {
    const place = this.allocate(8 * values.length);
    new Float64Array(this.c.memory.buffer, place, values.length).set(values);
    return place;
  }

  /** What the core says of a plate. @template T @param {number[]} numbers of film_plate @param {(place: number) => T} ask */
  ofPlate(numbers, ask) {
    const { top } = this;
    const found = ask(this.numbersAt(numbers));
    this.top = top;
    return found;
  }

  /**
   * The modes of a simply supported plate up to a frequency.
   * @param {number[]} numbers of film_plate @param {number} highest
   */
  plateModes(numbers, highest) {
    const [frequencies, shapes] = this.ofPlate(numbers, (place) => {
      const room = Math.floor(this.c.film_plate_most(place, highest));
      const columns = [0, 1].map(() => this.allocate(8 * room));
      const count = Number(this.c.film_plate_modes(place, highest, 0, 0, BigInt(room), ...columns));
      return columns.map((column) => new Float64Array(this.c.memory.buffer, column, count).slice());
    });
    return sortedModes(frequencies, Array.from(shapes, (shape) => shape ** 2), highest);
  }

  /** Give up what is kept if it fills too much memory. */
  tidy() {
    if (this.top - this.fixedTop < MOST_MEMORY) return;
    this.meshes.clear();
    this.structures.clear();
    this.lines.clear();
    this.top = this.fixedTop;
  }

  view() {
    return new DataView(this.c.memory.buffer);
  }

  /** The address of a curve. @param {number} index */
  curve(index) {
    return this.curves + index * this.layout.curve;
  }

  /** The address of a curve in series with a spring; it is the oldest of these that is overwritten. @param {number} curve @param {number} compliance */
  inSeries(curve, compliance) {
    const place = /** @type {number} */ (this.sprung.shift());
    this.sprung.push(place);
    new Uint8Array(this.c.memory.buffer).copyWithin(place, curve, curve + this.layout.curve);
    const status = this.c.film_spring(place, compliance);
    if (status !== 0) throw new Failure(status);
    return place;
  }

  /**
   * The address of the curve of a law with a shape: the functions of its last stage, from the law's own formulas, in series.
   * @param {any} law @param {any} n numbers of the scene
   */
  curveOfShape(law, n) {
    const { shape, end } = FORMULAS[law.shape.function](n);
    const [low, high] = law.shape.range;
    if (!(shape >= low && shape < high)) throw new Unsupported(`law ${law.name} is not on this page for a shape of ${shape}`);
    const key = `${law.curve} ${law.shape.values} ${shape} ${end}`;
    const known = this.shapes.get(key);
    if (known !== undefined) return known;
    const place = this.shapes.size < KEPT ? this.shaped[this.shapes.size] : this.forget();
    const numbers = [...lastStage(law, n, end), shape];
    const view = this.view();
    new Float64Array(this.c.memory.buffer, this.numbers, numbers.length).set(numbers);
    view.setFloat64(this.family, low, true);
    view.setFloat64(this.family + 8, high, true);
    view.setInt32(this.family + 16, 2, true);
    view.setInt32(this.family + 20, law.shape.places.length, true);
    view.setUint32(this.family + 24, this.numbers, true);
    const whole = this.curve(law.curve);
    new Uint8Array(this.c.memory.buffer).copyWithin(place, whole, whole + this.layout.curve);
    const status = this.c.film_shape(this.family, whole, this.numbers + 8 * (numbers.length - 1), place);
    if (status !== 0) throw new Failure(status);
    this.shapes.set(key, place);
    return place;
  }

  /** Give up the oldest of the shapes; the place of its curve. */
  forget() {
    const [[key, place]] = this.shapes;
    this.shapes.delete(key);
    return place;
  }

  /**
   * The mesh for these numbers of segments; meshes are kept until they fill too much memory.
   * @param {string} linearisation @param {number} loading @param {number} unloading
   */
  mesh(linearisation, loading, unloading) {
    return this.doubled(linearisation, [loading, unloading], 1);
  }

  /** @param {any} p problem @param {number} curve address @param {number} mesh address @returns {Impact} */
  impact(p, curve, mesh) {
    this.writeStart(p);
    const status = this.c.film_marched(curve, mesh, this.start, this.result);
    return { status, ...this.read("summary", this.result) };
  }

  /** @param {any} p problem @param {number} [place] */
  writeStart(p, place = this.start) {
    const { approach: nu, gamma, load, stop_velocity, limit: time_limit, damping } = p;
    this.write("start", place, { nu, gamma, load, stop_velocity, time_limit, damping });
  }

  /** Numbers of a structure, those that it has. @param {string} kind @param {number} place @param {Record<string, number>} values */
  write(kind, place, values) {
    const view = this.view();
    for (const [name, offset] of Object.entries(this.layout[kind])) {
      if (!(name in values)) continue;
      if (this.layout.whole.includes(name)) view.setInt32(place + offset, values[name], true);
      else view.setFloat64(place + offset, values[name], true);
    }
  }

  /** The largest relative difference of two summaries of a problem, relative to the second. @param {any} p @param {Impact} a @param {Impact} b */
  compare(p, a, b) {
    this.writeStart(p);
    this.write("summary", this.result, a);
    this.write("summary", this.other, b);
    this.c.film_compare(1n, this.start, this.result, this.other, 0, this.numbers);
    return this.view().getFloat64(this.numbers, true);
  }

  /** The change of the summary between impacts with an effect, p, and without. @param {any} p @param {Impact} a @param {any} q @param {Impact} b */
  change(p, a, q, b) {
    const { top } = this;
    const trials = [[p, a], [q, b]].map(([problem, found]) => {
      const place = this.allocate(this.layout.start.size);
      this.writeStart(problem, place);
      const [summary, status] = [this.allocate(this.layout.summary.size), this.allocate(8)];
      this.write("summary", summary, found);
      this.view().setInt32(status, found.status, true);
      return [status, place, summary];
    });
    const units = this.numbersAt(["length", "force", "time", "velocity"].map((unit) => q[unit] / p[unit]));
    this.c.film_change(1n, ...trials.flat(), units, this.counts);
    this.top = top;
    return this.view().getFloat64(this.counts, true);
  }

  /** Segments of the first trial, at least so many. @param {number} damping @param {number} least */
  firstSegments(damping, least) {
    this.view().setFloat64(this.counts, damping, true);
    this.c.film_first_segments(1n, this.counts, least, this.start);
    return this.view().getInt32(this.start, true);
  }

  /**
   * One contact on the first of meshes, each of twice the segments of the one before, that meets an accuracy; null: on the first.
   * @param {any} p problem @param {number} curve @param {string} line @param {number[]} counts of the first mesh
   * @param {number|null} accuracy @param {number} clearance where the law's force begins
   */
  solve(p, curve, line, counts, accuracy, clearance) {
    const { size, estimated, level, reached } = this.layout.solution;
    const found = this.numbers;
    this.writeStart(p);
    let status = FULL;
    const most = accuracy === null ? 2 : Math.ceil(Math.log2(this.layout.most_segments / counts[0])) + 1;
    for (const count of [Math.min(FEW_MESHES, most), most]) {
      if (status !== FULL) break;
      const meshes = this.doubled(line, counts, count);
      status = accuracy === null ? this.c.film_estimate(curve, this.start, meshes, clearance, found)
        : this.c.film_solve(curve, this.start, meshes, count, accuracy, clearance, found);
    }
    const view = this.view();
    const doublings = 2 ** view.getInt32(found + level, true);
    return {
      status,
      counts: counts.map((n) => n * doublings),
      estimated: view.getFloat64(found + estimated, true),
      reached: view.getInt32(found + reached, true) === 1,
      summary: /** @type {Impact} */ ({ status, ...this.read("summary", found) }),
    };
  }

  /** The address of meshes side by side, each of twice the segments of the one before. @param {string} line @param {number[]} counts @param {number} count */
  doubled(line, counts, count) {
    const key = `${line} ${counts} ${count}`;
    const known = this.meshes.get(key);
    if (known !== undefined) return known;
    this.tidy();
    const size = this.meshSize;
    const place = this.allocate(count * size);
    for (let k = 0; k < count; k++) {
      const [loading, unloading] = counts.map((n) => n * 2 ** k);
      const nodes = this.allocate(8 * this.c.film_mesh_size(loading, unloading));
      const status = this.c.film_mesh_init(place + k * size, line === "chord" ? 0 : 1, loading, unloading, nodes);
      if (status !== 0) throw new Failure(status);
    }
    this.meshes.set(key, place);
    return place;
  }

  /** The numbers of a structure. @param {string} kind @param {number} place */
  read(kind, place) {
    const view = this.view();
    /** @type {Record<string, number>} */
    const found = {};
    for (const [name, offset] of Object.entries(this.layout[kind])) {
      if (name === "size") continue;
      found[name] = this.layout.whole.includes(name) ? view.getInt32(place + offset, true) : view.getFloat64(place + offset, true);
    }
    return found;
  }

  /** Put the start of a contact into the state. @param {any} p @param {number} curve */
  begin(p, curve) {
    let status = this.c.film_init(curve, this.state, -0, p.approach, p.gamma, p.load, p.stop_velocity);
    if (status === 0) status = this.c.film_damp(this.state, p.damping);
    if (status !== 0) throw new Failure(BAD_NUMBER);
  }

  /**
   * Every segment of a contact, the times of its events and of its end, and the core's summary.
   * @param {any} p @param {number} curve @param {number} mesh @param {number} room segments that there may be
   * @returns {any}
   */
  record(p, curve, mesh, room) {
    const { line, state, summary } = this.layout;
    const top = this.top;
    this.begin(p, curve);
    const [lines, events, found] = [room * line.size, 4096 * state.size, summary.size].map((size) => this.allocate(size));
    const [count, met] = [this.counts, this.counts + 4];
    const status = this.c.film_record(curve, mesh, this.state, p.limit, lines, room, count, events, 4096, met, found);
    const view = this.view();
    const timeOf = (/** @type {number} */ place) => view.getFloat64(place + state.time, true);
    const times = Array.from({ length: view.getInt32(met, true) }, (_, k) => timeOf(events + k * state.size));
    if (status === FULL && room <= 4e6 && times.length < 4096) {
      this.top = top;
      return this.record(p, curve, mesh, 4 * room);
    }
    const core = { status, ...this.read("summary", found) };
    return { status, lines, count: view.getInt32(count, true), top, end: timeOf(this.state), times, core };
  }

  /**
   * Indentation, its rate, force, velocity and displacement of the target at ascending times: five numbers for each.
   * @param {number} curve @param {any} recorded @param {Float64Array} times
   */
  sample(curve, recorded, times) {
    const top = this.top;
    const at = this.allocate(8 * times.length);
    const values = this.allocate(40 * times.length);
    const branches = this.allocate(2 * times.length);
    new Float64Array(this.c.memory.buffer, at, times.length).set(times);
    const { lines, count } = recorded;
    const phases = branches + times.length;
    this.c.film_sample(curve, lines, count, at, BigInt(times.length), values, branches, phases);
    const found = {
      values: new Float64Array(this.c.memory.buffer, values, 5 * times.length).slice(),
      branches: new Int8Array(this.c.memory.buffer, branches, times.length).slice(),
    };
    this.top = top;
    return found;
  }
}

/**
 * The numbers of a law's last stage for the core: a family of one shape, whose series over shapes are constant.
 * @param {any} law @param {any} n @param {number} end
 */
function lastStage(law, n, end) {
  const { edges, terms, places, names, values } = law.shape;
  const { points, force: toSeries, mean: toMean } = DATA.series;
  const row = new Float64Array(places.length);
  let [at, work] = [0, 0];
  for (let k = 0; k < terms.length; k++) {
    const [a, b] = [edges[k], edges[k + 1]];
    const inside = k === 0 || a < end;
    const found = points.map((/** @type {number} */ x) => (inside ? FORMULAS[values](n, a + (b - a) * 0.5 * (1 + x)) : null));
    const series = names.map((/** @type {string} */ name) => product(toSeries, found.map((/** @type {any} */ one) => (one ? one[name] : 0))));
    const mean = product(toMean, series[0]);
    row[at++] = -work;
    [series[0], mean, ...series.slice(1)].forEach((numbers, which) => {
      row.set(numbers.slice(0, terms[k][which]), at);
      at += terms[k][which];
    });
    work += (b - a) * mean.reduce((sum, value) => sum + value, 0);
  }
  return Float64Array.from([Math.log(end), 0, ...places, ...row, ...new Float64Array(places.length)]);
}

/** A matrix times a vector. @param {number[][]} matrix @param {number[]} vector */
function product(matrix, vector) {
  return matrix.map((row) => row.reduce((sum, factor, k) => sum + factor * vector[k], 0));
}

/** A contact that the core cannot march. */
class Failure extends Error {
  /** @param {number} status */
  constructor(status) {
    super(DATA.statuses[String(status)] ?? `the core failed with status ${status}`);
    this.status = status;
  }
}

/**
 * Modes by ascending frequency, those of equal frequency as one, as film_model/targets/modes.py sorts them.
 * @param {ArrayLike<number>} frequencies @param {number[]} shares @param {number} highest
 */
function sortedModes(frequencies, shares, highest) {
  /** @type {Record<string, number[]>} */
  const modes = { frequency: [], share: [], ratio: [] };
  const { equal, unseen } = DATA.constants.vibration;
  const largest = shares.reduce((most, share) => Math.max(most, share), 0);
  let last = -1;
  for (const k of Array.from(shares.keys()).sort((i, j) => frequencies[i] - frequencies[j])) {
    const [own, share] = [frequencies[k], shares[k]];
    if (own > highest || !(share > unseen * largest)) continue;
    if (own - last > equal * own) {
      modes.frequency.push(own);
      modes.share.push(share);
      modes.ratio.push(0);
    } else {
      modes.share[modes.share.length - 1] += share;
    }
    last = own;
  }
  return modes;
}

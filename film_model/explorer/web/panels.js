// Plates with clamped or free edges: vibrations and static deflection, by the rules of film_model/targets/ritz.py and panel_statics.py.

/**
 * A plate for the core. edges: their numbers at x = 0, x = a, y = 0, y = b. bed: stiffness per area; none without.
 * @typedef {{mass: number, d11: number, d12: number, d22: number, d66: number, a: number, b: number, edges: number[], bed?: number}} Panel
 */

const SINES = 0; // degree of functions without a series

/** What the core says of a panel. @template T @param {Panel} panel @param {(place: number) => T} ask */
function ofPanel(panel, ask) {
  const { mass, d11, d12, d22, d66, a, b, edges, bed = 0 } = panel;
  const { top } = CORE;
  const place = CORE.numbersAt([mass, d11, d12, d22, d66, a, b, 0, 0, 0, 0, bed, 0, 0]);
  new Int32Array(CORE.c.memory.buffer, place + 96, 4).set(edges);
  const found = ask(place);
  CORE.top = top;
  return found;
}

/** Half-waves along x (0) or y (1) up to a frequency. @param {Panel} panel @param {number} along @param {number} highest */
const halfWaves = (panel, along, highest) => ofPanel(panel, (place) => CORE.c.film_panel_waves(place, along, highest));

/** The same plate with its sides exchanged. @param {Panel} panel @returns {Panel} */
function turned({ d11, d22, a, b, edges: [one, two, three, four], ...others }) {
  return { ...others, d11: d22, d22: d11, a: b, b: a, edges: [three, four, one, two] };
}

/** The edges that bound x (0) or y (1). @param {Panel} panel @param {number} along */
const endsOf = (panel, along) => panel.edges.slice(2 * along, 2 * along + 2);

/** @param {Panel} panel @param {number} along */
const simple = (panel, along) => endsOf(panel, along).every((edge) => edge === 0);

/** About the rate at which bending crosses the shorter side, 1/s. @param {Panel} panel */
const crossing = ({ a, b, d11, d22, mass }) => Math.PI * Math.max(Math.sqrt(d11 / mass) / a ** 2, Math.sqrt(d22 / mass) / b ** 2);

/** Whether a clamped edge meets a free one. @param {Panel} panel */
const cornered = (panel) => endsOf(panel, 0).some((one) => endsOf(panel, 1).some((other) => one * other === 2));

/** How many groups the functions along a side fall into, which do not interact. @param {Panel} panel @param {number} along @returns {number} */
const halvesOf = (panel, along) => (panel.edges[2 * along] === panel.edges[2 * along + 1] ? 2 : 1);

/** Functions on a line, kept: the address. @param {number[]} ends @param {number} degree @param {number} count of shapes, or 0 */
function lineOf(ends, degree, count) {
  const key = `${ends} ${degree} ${count}`;
  const known = CORE.lines.get(key);
  if (known !== undefined) return known;
  const place = CORE.allocate(40);
  new Int32Array(CORE.c.memory.buffer, place, 10).set([count, count, degree, 0, 0, 0, 0, 0, 0, 0]);
  if (degree !== SINES) {
    const kinds = CORE.counts;
    new Int32Array(CORE.c.memory.buffer, kinds, 2).set(ends);
    const memory = CORE.allocate(8 * Number(CORE.c.film_ritz_size(degree)));
    const status = CORE.c.film_ritz_make(place, kinds, degree, count, memory);
    if (status !== 0) throw new Failure(status);
    CORE.top = memory + 8 * Number(CORE.c.film_ritz_kept(degree));
  }
  CORE.lines.set(key, place);
  return place;
}

/** The shapes along a side that resolve all waves up to a frequency. @param {Panel} panel @param {number} along @param {number} highest */
function shapesAlong(panel, along, highest) {
  const { least, beyond } = DATA.constants.ritz;
  const count = Math.max(least, Math.trunc(halfWaves(panel, along, highest)) + 2);
  return lineOf(endsOf(panel, along), 2 * count + beyond, count);
}

/** The values of all functions of a line. @param {number} line @param {number} place between its ends @param {number} side */
function valuesAt(line, place, side) {
  const count = CORE.view().getInt32(line, true);
  return Float64Array.from({ length: count }, (_, k) => CORE.c.film_ritz_at(line, k, (2 * place) / side - 1));
}

/**
 * What `use` makes of each group of products that the struck point sees: of their number, the addresses of their energies and of their
 * values there, and free memory. Null if a group has more than `most` products. from, to: numbers of the groups.
 * @template T @param {Panel} panel @param {number[]} lines @param {number[]} point @param {{highest: number, most: number, sharpness?: number, from?: number, to?: number}} limits
 * @param {(count: number, energy: number, seen: number, memory: number) => T} use @returns {T[]|null}
 */
function groupsOf(panel, lines, point, { highest, most, sharpness = 1, from = 0, to }, use) {
  const { a, b } = panel;
  const { least, node } = DATA.constants.ritz;
  const [x, y] = lines.map((line, along) => valuesAt(line, point[along], [a, b][along]));
  const scale = 2 / Math.sqrt(a * b);
  return ofPanel(panel, (place) => {
    const { c } = CORE;
    const groups = [];
    const [p, q] = [0, 1].map(() => CORE.allocate(4 * x.length * y.length));
    for (let group = from; group < (to ?? c.film_panel_groups(place, ...lines)); group++) {
      const count = c.film_panel_group(place, ...lines, highest, sharpness, least, group, p, q);
      const [rows, columns] = [p, q].map((at) => new Int32Array(c.memory.buffer, at, count).slice());
      const values = Array.from(rows, (row, k) => x[row] * y[columns[k]] * scale);
      if (values.some((value) => Math.abs(value) > node)) groups.push({ rows, columns, values });
    }
    if (groups.some(({ rows }) => rows.length > most)) return null;
    const { top } = CORE;
    return groups.map(({ rows, columns, values }) => {
      const count = rows.length;
      new Int32Array(c.memory.buffer, p, count).set(rows);
      new Int32Array(c.memory.buffer, q, count).set(columns);
      const seen = CORE.numbersAt(values);
      const [energy, memory] = [count * count, 7 * count].map((size) => CORE.allocate(8 * size));
      c.film_panel_energy(place, ...lines, count, p, q, energy);
      const found = use(count, energy, seen, memory);
      CORE.top = top;
      return found;
    });
  });
}

/** Numbers of the products of a group that move without energy. @param {Panel} panel @param {number} count @param {number} energy */
function looseOf({ d11, d22, a, b, bed }, count, energy) {
  if (bed) return [];
  const matrix = new Float64Array(CORE.c.memory.buffer, energy, count * count);
  const least = (DATA.constants.ritz.loose * Math.max(d11, d22)) / (a * b) ** 2;
  return Array.from({ length: count }, (_, k) => k).filter((k) => matrix[k * (count + 1)] < least);
}

/** The modes up to a frequency. @param {Panel} panel @param {number[]} point @param {number} highest in rad/s */
function panelModes(panel, point, highest) {
  const { ritz } = DATA.constants;
  /** @type {[number[], number[]]} */
  const [frequencies, shares] = [[], []];
  const least = Math.min(panel.d11 / panel.a ** 4, panel.d22 / panel.b ** 4);
  const take = (/** @type {number} */ count, /** @type {number} */ energy, /** @type {number} */ seen, /** @type {number} */ memory) => {
    const rigid = looseOf(panel, count, energy).length;
    const [square, moved] = [memory, memory + 8 * count];
    const many = CORE.c.film_spectrum(count, energy, seen, least, memory + 16 * count, square, moved);
    if (many < 0) throw new Failure(many);
    const [squares, components] = [square, moved].map((at) => new Float64Array(CORE.c.memory.buffer, at, many));
    for (let k = 0; k < many; k++) {
      frequencies.push(k < rigid ? 0 : Math.sqrt(Math.max(squares[k], 0) / panel.mass));
      shares.push(components[k] ** 2 / panel.mass);
    }
  };
  if (simple(panel, 0) || simple(panel, 1)) {
    const [own, at] = simple(panel, 0) ? [panel, point] : [turned(panel), [point[1], point[0]]];
    const strips = stripsOf(own, at[0], highest);
    const sines = lineOf([0, 0], SINES, strips.at(-1)?.wave ?? 1);
    for (const { wave, degree } of strips) {
      const across = lineOf(endsOf(own, 1), degree, 0);
      const halves = halvesOf(own, 1);
      groupsOf(own, [sines, across], at, { highest: Infinity, most: Infinity, from: (wave - 1) * halves, to: wave * halves }, take);
    }
  } else {
    for (const [sharpness, most] of ritz.sharpness) {
      const lines = [0, 1].map((along) => shapesAlong(panel, along, sharpness * highest));
      if (groupsOf(panel, lines, point, { highest, sharpness, most }, take)) break;
    }
  }
  return sortedModes(frequencies, shares, highest);
}

/** The half-waves between simply supported edges that the struck point sees, with the degree across. @param {Panel} panel @param {number} x @param {number} highest */
function stripsOf(panel, x, highest) {
  const { least, node, spare } = DATA.constants.ritz;
  const { d11, d12, d22, a } = panel;
  const waves = halfWaves(panel, 0, highest) * (1 - d12 ** 2 / (d11 * d22)) ** -0.25;
  return ofPanel(panel, (place) => Array.from({ length: Math.max(least, Math.trunc(waves)) }, (_, k) => {
    const number = ((k + 1) * Math.PI) / a;
    return { wave: k + 1, seen: Math.abs(Math.sin(number * x)) > node, degree: CORE.c.film_panel_degree(place, number, highest, spare) };
  })).filter(({ seen }) => seen);
}

/** About how much the modes up to a frequency take: the sum of the cubes of the numbers of functions that interact. @param {Panel} panel @param {number[]} point @param {number} highest */
function workOfPanel(panel, point, highest) {
  const { ritz } = DATA.constants;
  if (simple(panel, 0) || simple(panel, 1)) {
    const own = simple(panel, 0) ? panel : turned(panel);
    if (halfWaves(own, 0, highest) > ritz.most_waves) return Infinity;
    const degrees = stripsOf(own, own.a / Math.PI, highest).map(({ degree }) => degree);
    if (Math.max(...degrees) > ritz.most_degree) return Infinity;
    return degrees.reduce((sum, degree) => sum + (degree / halvesOf(own, 1)) ** 3 + ritz.work_of_a_strip, 0);
  }
  const [one, two] = [0, 1].map((along) => halfWaves(panel, along, highest));
  const halves = [0, 1].map((along) => halvesOf(panel, along));
  if (Math.max(one / halves[0], two / halves[1]) > ritz.most_waves / 2) return Infinity;
  const groups = halves[0] * halves[1];
  const products = Math.max(one * two, ritz.least * Math.max(one, two)) / groups;
  const [[sharpness]] = ritz.sharpness;
  const seen = halves.reduce((product, half, along) => product * (2 * point[along] === [panel.a, panel.b][along] ? 1 : half), 1);
  return seen * (products * sharpness * ritz.fewest) ** 3;
}

/** Static deflection over force by polynomials up to a degree. @param {Panel} panel @param {number[]} point @param {number} degree */
function ritzCompliance(panel, point, degree) {
  const degrees = FORMULAS.degrees((panel.a / panel.b) * (panel.d22 / panel.d11) ** 0.25, degree);
  const lines = Object.values(degrees).map((own, along) => lineOf(endsOf(panel, along), own, 0));
  const parts = groupsOf(panel, lines, point, { highest: Infinity, most: Infinity }, (count, energy, seen, memory) => {
    const { buffer } = CORE.c.memory;
    const [matrix, values] = [new Float64Array(buffer, energy, count * count), new Float64Array(buffer, seen, count)];
    let trace = 0;
    for (let k = 0; k < count; k++) trace += matrix[k * (count + 1)];
    for (const k of looseOf(panel, count, energy)) {
      matrix[k * (count + 1)] += trace / count;
      values[k] = 0;
    }
    return CORE.c.film_compliance(count, energy, seen, memory);
  });
  return /** @type {number[]} */ (parts).reduce((sum, part) => sum + part, 0);
}

/** The static deflection over force, m/N, and a bound on its error. @param {Panel} given @param {number[]} place @param {number} far */
function panelCompliance(given, place, far = DATA.constants.ritz.far) {
  const { lower_degrees: lower, static_degree: degree } = DATA.constants.ritz;
  let [panel, [x, y]] = feltOf(given, place, far);
  const { a, b, d11, d22, bed = 0 } = panel;
  if (FORMULAS.turns(Math.min(x, a - x), Math.min(y, b - y), d11, d22, simple(panel, 0), simple(panel, 1)).turns) [panel, x, y] = [turned(panel), y, x];
  const known = ofPanel(panel, (at) => CORE.c.film_panel_levy(at, x, y));
  const like = { ...panel, edges: [...endsOf(panel, 0), 0, 0] };
  const more = [...lower, degree].map((each) => (simple(panel, 1) ? 0 : ritzCompliance(panel, [x, y], each) - ritzCompliance(like, [x, y], each)));
  return FORMULAS.corrected(known, ...more, far, bed);
}

/** The part of a plate on a bed that the force feels, and the place in it. @param {Panel} panel @param {number[]} place @param {number} far @returns {[Panel, number[]]} */
function feltOf(panel, place, far) {
  const { a, b, d11, d22, d66, bed, edges } = panel;
  if (!bed) return [panel, place];
  const felt = [[a, b, d11], [b, a, d22]].map(([side, other, bending], along) => FORMULAS.feltAlong(place[along], side, other, bending, d66, bed, far));
  const cut = felt.flatMap(({ cut, ends }) => [cut, ends]);
  const [one, two] = felt.map(({ near, beyond }) => near + beyond);
  return [{ ...panel, a: one, b: two, edges: edges.map((edge, k) => (cut[k] ? 0 : edge)) }, felt.map(({ near }) => near)];
}

/**
 * Static deflection over force of the vibrations above a frequency, m/N, and a bound on its error: omitted_compliance.
 * @param {Panel} panel @param {number[]} place @param {Record<string, ArrayLike<number>>} modes
 * @param {number} highest @param {Record<string, number>} statics of panelCompliance
 */
function omittedOf(panel, place, modes, highest, { compliance, error }) {
  const { slower, seen } = DATA.constants.ritz;
  let { found, vague } = FORMULAS.lacking(compliance, error, bentBy(modes));
  if (vague) {
    const rate = highest / slower;
    const on = panelCompliance({ ...panel, bed: panel.mass * rate ** 2 }, place, seen);
    ({ found, error } = FORMULAS.grown(found, error, on.compliance, on.error, bentBy(modes, 0, rate)));
  }
  return { lacking: Math.max(found, 0), error };
}

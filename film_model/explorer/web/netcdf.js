// The sampled motion as a netCDF file in the classic format (NetCDF Users' Guide, "File format specifications").

const [NC_CHAR, NC_DOUBLE, NC_DIMENSION, NC_VARIABLE, NC_ATTRIBUTE] = [2, 6, 10, 11, 12];

/** A whole number of 4 bytes. @param {number} value */
function ncNumber(value) {
  return [value >>> 24, (value >>> 16) & 255, (value >>> 8) & 255, value & 255];
}

/** The length of a text and its bytes, filled up to a multiple of 4. @param {string} text */
function ncText(text) {
  const bytes = [...new TextEncoder().encode(text)];
  return [...ncNumber(bytes.length), ...bytes, ...Array(-bytes.length & 3).fill(0)];
}

/** @param {Record<string, string>} texts by name */
function ncAttributes(texts) {
  const parts = Object.entries(texts).map(([name, text]) => [...ncText(name), ...ncNumber(NC_CHAR), ...ncText(text)]);
  return [...ncNumber(NC_ATTRIBUTE), ...ncNumber(parts.length), ...parts.flat()];
}

/**
 * A file of columns over one dimension, of which the first is the coordinate.
 * @param {Record<string, string>} about attributes of the file
 * @param {{name: string, values: ArrayLike<number>, attributes: Record<string, string>}[]} columns
 */
function ncFile(about, columns) {
  const count = columns[0].values.length;
  /** @param {number} first place of the first column in the file */
  const header = (first) => [
    ...new TextEncoder().encode("CDF\x01"),
    ...ncNumber(0),
    ...[NC_DIMENSION, 1].flatMap(ncNumber), ...ncText(columns[0].name), ...ncNumber(count),
    ...ncAttributes(about),
    ...[NC_VARIABLE, columns.length].flatMap(ncNumber),
    ...columns.flatMap(({ name, attributes }, k) => [
      ...ncText(name), ...[1, 0].flatMap(ncNumber), ...ncAttributes(attributes),
      ...[NC_DOUBLE, 8 * count, first + 8 * count * k].flatMap(ncNumber),
    ]),
  ];
  const start = header(0).length;
  const file = new Uint8Array(start + 8 * count * columns.length);
  file.set(header(start));
  const numbers = new DataView(file.buffer);
  columns.forEach(({ values }, k) => {
    for (let row = 0; row < count; row++) numbers.setFloat64(start + 8 * (count * k + row), values[row]);
  });
  return file;
}

/** The sampled motion with energies and friction, SI. @param {Scene} scene @param {Result} result */
function netcdfOf(scene, result) {
  const { motion } = result.motion;
  const columns = [{ name: "t", values: /** @type {ArrayLike<number>} */ (motion.time), attributes: { long_name: "time since first touch", units: "s" } }];
  for (const [name, [dimension, text]] of Object.entries(DATA.motion)) {
    const attributes = { long_name: name.replaceAll("_", " "), units: DATA.dimensions[dimension].cf, comment: text };
    columns.push({ name, values: motion[name], attributes });
  }
  for (const [name, values] of Object.entries(energiesOf(scene, result))) {
    columns.push({ name: `energy_${name}`, values, attributes: { long_name: `energy of ${name}`, units: "J" } });
  }
  for (const [name, values] of Object.entries(alongAt(motion.time, result.oblique))) {
    columns.push({ name, values, attributes: { long_name: name.replace("_", " "), units: DATA.dimensions[OF_FRICTION[name]].cf } });
  }
  const source = `film-model ${DATA.version}, explorer; law ${result.law.name}`;
  return ncFile({ Conventions: "CF-1.11", title: scene.title, source, scene_toml: sceneFile(scene) }, columns);
}

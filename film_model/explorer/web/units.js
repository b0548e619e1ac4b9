// Values with units: the same symbols as in scene files.

/** @type {Record<string, string>} */
const SPELLINGS = { "µ": "u", "μ": "u", "·": "*", "⋅": "*", "²": "^2", "³": "^3", "−": "-" };
const NUMBER = /^\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*)$/su;

/**
 * A unit as factor times a power of ten, so that "60.74 g" and "0.06074 kg" are the same number.
 * @param {string} text @returns {{factor: number, ten: number, powers: number[]}|null}
 */
function parseUnit(text) {
  const plain = text.replace(/[µμ·⋅²³−]/gu, (sign) => SPELLINGS[sign]);
  const found = { factor: 1, ten: 0, powers: [0, 0, 0] };
  let rest = plain.trim();
  let sign = 1;
  for (;;) {
    const match = /^([A-Za-z_]+)(?:(?:\^|\*\*)?([+-]?[0-9]{1,3}(?:\.[0-9]{1,17})?))?/u.exec(rest);
    const unit = match && Object.hasOwn(DATA.units, match[1]) ? DATA.units[match[1]] : null;
    if (!match || !unit) return null;
    const power = sign * Number(match[2] ?? 1);
    const ten = Math.round(Math.log10(unit[0]));
    if (Number(`1e${ten}`) === unit[0]) found.ten += ten * power;
    else found.factor *= unit[0] ** power;
    found.powers = found.powers.map((p, k) => p + power * unit[1][k]);
    rest = rest.slice(match[0].length);
    if (!rest) return found;
    const separator = /^(\s*[*/]\s*|\s+)/u.exec(rest);
    if (!separator || (sign < 0 && !separator[0].trim())) return null;
    sign = separator[0].includes("/") ? -1 : 1;
    rest = rest.slice(separator[0].length);
  }
}

/**
 * A text such as "10 mm" in SI units. unit: of a number that has none.
 * @param {string} text @param {string} dimension @param {string} unit
 * @returns {{value: number, unit: string, error?: undefined}|{error: string, value?: undefined, unit?: undefined}}
 */
function parseValue(text, dimension, unit) {
  const match = NUMBER.exec(text.replace("−", "-"));
  if (!match) return { error: "write a number and a unit, as in 10 mm" };
  const written = match[2].trim() || unit;
  if (dimension === "dimensionless") {
    return match[2].trim() ? { error: "this is a plain number" } : { value: Number(match[1]), unit: "" };
  }
  const found = parseUnit(written);
  if (!found) return { error: `no unit reads ${written}` };
  const { powers } = DATA.dimensions[dimension];
  if (found.powers.some((p, k) => Math.abs(p - powers[k]) > 1e-9)) {
    return { error: `${written} is not a unit of this quantity: ${DATA.dimensions[dimension].unit}` };
  }
  const [digits, exponent] = match[1].toLowerCase().split("e");
  const value = Number(`${digits}e${Number(exponent ?? 0) + found.ten}`) * found.factor;
  return Number.isFinite(value) ? { value, unit: written } : { error: "the value is not finite" };
}

/** The size of a unit in SI. @param {string} unit */
function sizeOf(unit) {
  const found = unit ? parseUnit(unit) : null;
  return found ? found.factor * Number(`1e${found.ten}`) : 1;
}

const PREFIXES = new Map([[-15, "f"], [-12, "p"], [-9, "n"], [-6, "µ"], [-3, "m"], [0, ""], [3, "k"], [6, "M"], [9, "G"], [12, "T"]]);

/** A unit in which a value of a dimension is easy to read. @param {number} value @param {string} dimension */
function readableUnit(value, dimension) {
  const { unit, prefixed } = DATA.dimensions[dimension];
  const size = Math.abs(value);
  if (dimension === "angle") return "deg";
  if (dimension === "mass" && size > 0 && size < 1) return size < 1e-3 ? "mg" : "g";
  if (!(prefixed || dimension === "velocity") || !size || !Number.isFinite(size)) return unit;
  const power = Math.floor((Math.log10(size) + (dimension === "velocity" ? 1 : 1e-9)) / 3) * 3;
  if (dimension === "velocity" && power >= 0) return unit;
  return PREFIXES.has(power) ? PREFIXES.get(power) + unit : unit;
}

/** A number without needless zeros. @param {number} value @param {number} digits */
function shortNumber(value, digits) {
  if (!Number.isFinite(value)) return String(value);
  return String(Number(value.toPrecision(digits)));
}

/** An SI value with a unit, for reading. @param {number|null} value @param {string} dimension @param {number} digits */
function shown(value, dimension, digits = 5) {
  if (value === null || Number.isNaN(value)) return "–";
  const unit = readableUnit(value, dimension);
  return `${shortNumber(value / sizeOf(unit), digits)} ${unit.replaceAll("*", "·")}`.trim();
}

// Charts as SVG: one drawing for the screen and for files, with texts as texts.

const SVG = "http://www.w3.org/2000/svg";
const THEMES = {
  light: { paper: "#ffffff", ink: "#1c2226", soft: "#59636b", grid: "#dde3e8" },
  dark: { paper: "#181d21", ink: "#e9eef2", soft: "#a4afb8", grid: "#343c43" },
};

/**
 * @typedef {{name: string, x: ArrayLike<number>, y: ArrayLike<number>, colour: number, dashed?: boolean, marks?: boolean}} Series
 * @typedef {{title: string, x: {label: string, dimension: string, log?: boolean}, y: {label: string, dimension: string,
 *   log?: boolean}, series: Series[], point?: [number, number], cursor?: number, equal?: boolean}} Chart equal: lengths along both
 *   axes are drawn alike
 */

/** @param {string} name @param {Record<string, string|number>} attributes @param {string} [text] */
function svg(name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}

const FLAT = 1e-4; // differences that are drawn as none, relative

/** Least and largest of the values. @param {ArrayLike<number>[]} columns @param {boolean} log */
function extent(columns, log) {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) {
    for (let k = 0; k < column.length; k++) {
      const value = column[k];
      if (!Number.isFinite(value) || (log && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return log ? [0.1, 1] : [0, 1];
  if (low === high && log) return [low / 2, high * 2];
  if (!log && high - low <= FLAT * Math.max(Math.abs(low), Math.abs(high))) return [Math.min(0, low), Math.max(0, high) || 1];
  return [low, high];
}

/** A round distance of about `count` ticks. @param {number} low @param {number} high @param {number} count */
function stepOf(low, high, count) {
  const rough = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((k) => k * size).find((step) => step >= rough) ?? rough;
}

/** Positions of ticks on a logarithmic axis. @param {number} low @param {number} high @param {number} count */
function decadeTicks(low, high, count) {
  /** @type {number[]} */
  const ticks = [];
  const decades = Math.log10(high / low);
  const steps = decades < 2.5 ? [1, 2, 5] : [1];
  const skip = Math.max(1, Math.ceil(decades / count));
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    if (steps.length === 1 && power % skip) continue;
    for (const step of steps) {
      const value = Number(`${step}e${power}`);
      if (value >= low * 0.999 && value <= high * 1.001) ticks.push(value);
    }
  }
  return ticks;
}

/**
 * The scale of one axis: values to pixels, and labelled ticks. A linear axis ends at a round value, so that it stays as it
 * is while a slider moves a little. @param {Chart["x"]} axis @param {ArrayLike<number>[]} columns @param {number} from
 * @param {number} to @param {number} count @param {[number, number]} [ends] of the axis
 */
function axisOf(axis, columns, from, to, count, ends) {
  const log = axis.log === true;
  let [low, high] = ends ?? extent(columns, log);
  const unit = log ? DATA.dimensions[axis.dimension].unit : readableUnit(Math.max(Math.abs(low), Math.abs(high)), axis.dimension);
  const size = sizeOf(unit);
  /** @type {number[]} */
  let ticks = [];
  if (log) {
    ticks = decadeTicks(low / size, high / size, count);
  } else {
    if (!ends && low > 0 && low < 0.5 * high) low = 0;
    const step = stepOf(low / size, high / size, count);
    const part = step / (from > to ? 2 : 4);
    if (!ends) {
      low = Math.floor(low / size / part + 1e-9) * part * size;
      high = Math.ceil(high / size / part - 1e-9) * part * size;
    }
    for (let k = Math.ceil(low / size / step - 1e-9); k * step <= high / size + 1e-9 * step; k++) ticks.push(Number((k * step).toPrecision(12)));
  }
  const width = log ? Math.log(high / low) : high - low;
  /** @param {number} value */
  const place = (value) => from + ((to - from) * (log ? Math.log(Math.max(value, low * 1e-3) / low) : value - low)) / width;
  const marks = ticks.map((tick) => ({
    at: Math.round(10 * place(tick * size)) / 10,
    text: log && (tick < 1e-2 || tick >= 1e4) ? tick.toExponential(0) : shortNumber(tick, 6),
  }));
  return { place, ticks: marks, label: unit ? `${axis.label} (${unit.replaceAll("*", "·")})` : axis.label };
}

/** Ends of both axes with the values in their middle, at one scale. @param {ArrayLike<number>[][]} columns @param {number} wide pixels @param {number} high pixels @returns {[number, number][]} */
function alike(columns, wide, high) {
  const ranges = columns.map((each) => extent(each, false));
  const scale = 1.04 * Math.max((ranges[0][1] - ranges[0][0]) / wide, (ranges[1][1] - ranges[1][0]) / high);
  return ranges.map(([from, to], k) => {
    const [middle, half] = [(from + to) / 2, (scale * (k ? high : wide)) / 2];
    return [middle - half, middle + half];
  });
}

/** The layers of the charts on the screen, and what each shows: a layer that stays the same is not drawn again. @type {WeakMap<Element, {keys: string[], layers: Element[]}>} */
const LAYERS = new WeakMap();

/** Put a layer into a chart unless it is there. @param {Element} root @param {number} index @param {string} key @param {() => Element[]} parts */
function setLayer(root, index, key, parts) {
  let known = LAYERS.get(root);
  if (!known) {
    known = { keys: [], layers: [0, 1, 2].map(() => svg("g", {})) };
    root.replaceChildren(...known.layers);
    LAYERS.set(root, known);
  }
  if (key && known.keys[index] === key) return;
  known.keys[index] = key;
  known.layers[index].replaceChildren(...parts());
}

/** @param {Record<string, string|number>} at @param {string} text */
function label(at, text) {
  return svg("text", { "font-size": 12, "font-family": "sans-serif", ...at }, text);
}

/**
 * Draw a chart into an SVG element. @param {SVGSVGElement} root @param {Chart} chart @param {number} width
 * @param {number} height @param {"light"|"dark"} theme
 */
function drawChart(root, chart, width, height, theme) {
  const { paper, ink, soft, grid } = THEMES[theme];
  const [left, right, bottom] = [56, width - 12, height - 40];
  const legend = legendOf(chart, left, right);
  const top = 24 + 18 * legend.rows;
  const columns = [chart.series.map((s) => s.x), chart.series.map((s) => s.y)];
  const ends = chart.equal ? alike(columns, right - left, bottom - top) : [];
  const x = axisOf(chart.x, columns[0], left, right, width < 420 ? 4 : 6, ends[0]);
  const y = axisOf(chart.y, columns[1], bottom, top, 5, ends[1]);
  const frame = [chart.title, width, height, theme, top, chart.series.map((s) => [s.name, s.colour, s.dashed])];
  const middle = (top + bottom) / 2;
  root.setAttribute("viewBox", `0 0 ${width} ${height}`);
  setLayer(root, 0, JSON.stringify([frame, y.ticks, y.label]), () => [
    svg("rect", { width, height, fill: paper }),
    label({ x: left, y: 16, "font-weight": "bold", "font-size": 13, fill: ink }, chart.title),
    ...y.ticks.flatMap((tick) => [
      svg("line", { x1: left, x2: right, y1: tick.at, y2: tick.at, stroke: grid }),
      label({ x: left - 6, y: tick.at + 4, "text-anchor": "end", fill: soft }, tick.text),
    ]),
    label({ x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})`, fill: soft }, y.label),
    ...legendParts(legend.entries, theme),
  ]);
  setLayer(root, 1, JSON.stringify([width, height, theme, top, x.ticks, x.label]), () => [
    ...x.ticks.flatMap((tick) => [
      svg("line", { x1: tick.at, x2: tick.at, y1: top, y2: bottom, stroke: grid }),
      label({ x: tick.at, y: bottom + 15, "text-anchor": "middle", fill: soft }, tick.text),
    ]),
    label({ x: (left + right) / 2, y: height - 6, "text-anchor": "middle", fill: soft }, x.label),
  ]);
  setLayer(root, 2, "", () => {
    const parts = chart.series.flatMap((series) => curveParts(series, x.place, y.place, theme));
    const dot = { r: 5, fill: ink, stroke: paper, "stroke-width": 1.5 };
    if (chart.point) parts.push(svg("circle", { ...dot, cx: x.place(chart.point[0]), cy: y.place(chart.point[1]) }));
    if (chart.cursor !== undefined) {
      const at = x.place(chart.cursor);
      parts.push(svg("line", { x1: at, x2: at, y1: top, y2: bottom, stroke: ink, "stroke-dasharray": "2 3" }));
    }
    return parts;
  });
}

/** The line of a series, and its marks. @param {Series} series @param {(value: number) => number} x @param {(value: number) => number} y @param {"light"|"dark"} theme */
function curveParts(series, x, y, theme) {
  const stroke = colourOf(series.colour, theme === "dark" ? 0.25 : 0);
  const line = { d: pathOf(series, x, y), fill: "none", stroke, "stroke-width": 2, "stroke-linejoin": "round" };
  const parts = [svg("path", series.dashed ? { ...line, "stroke-dasharray": "6 4" } : line)];
  for (let k = 0; series.marks && k < series.x.length; k++) {
    parts.push(svg("circle", { cx: x(series.x[k]), cy: y(series.y[k]), r: 3, fill: stroke }));
  }
  return parts;
}

/** A colour of the palette, mixed with white. @param {number} index @param {number} share */
function colourOf(index, share) {
  const code = Number.parseInt(DATA.colours[index % DATA.colours.length].slice(1), 16);
  const mixed = [code >> 16, (code >> 8) & 255, code & 255].map((part) => Math.round(part + (255 - part) * share));
  return `#${mixed.map((part) => part.toString(16).padStart(2, "0")).join("")}`;
}

/** The places of the names of the series, in as many rows as they need. @param {Chart} chart @param {number} left @param {number} right */
function legendOf(chart, left, right) {
  let [at, row] = [left, 0];
  const entries = chart.series.filter((series) => series.name).map((series) => {
    const wide = 34 + 6.6 * series.name.length;
    if (at > left && at + wide > right + 20) [at, row] = [left, row + 1];
    at += wide;
    return { series, x: at - wide, y: 29 + 18 * row };
  });
  return { entries, rows: row + 1 };
}

/** @param {ReturnType<typeof legendOf>["entries"]} entries @param {"light"|"dark"} theme */
function legendParts(entries, theme) {
  return entries.flatMap(({ series, x, y }) => {
    const stroke = colourOf(series.colour, theme === "dark" ? 0.25 : 0);
    const line = { x1: x, x2: x + 18, y1: y, y2: y, stroke, "stroke-width": 2.5 };
    const key = svg("line", series.dashed ? { ...line, "stroke-dasharray": "6 4" } : line);
    return [key, label({ x: x + 22, y: y + 4, fill: THEMES[theme].ink }, series.name)];
  });
}

/** @param {Series} series @param {(value: number) => number} x @param {(value: number) => number} y */
function pathOf(series, x, y) {
  let [path, next] = ["", "M"];
  for (let k = 0; k < series.x.length; k++) {
    const drawn = Number.isFinite(series.y[k]); // the line is broken where it is not
    if (drawn) path += `${next}${Math.round(10 * x(series.x[k])) / 10} ${Math.round(10 * y(series.y[k])) / 10}`;
    next = drawn ? "L" : "M";
  }
  return path;
}

/** A chart as the text of an SVG file. @param {Chart} chart */
function chartFile(chart) {
  const root = /** @type {SVGSVGElement} */ (svg("svg", { xmlns: SVG, width: 720, height: 420 }));
  drawChart(root, chart, 720, 420, "light");
  return new XMLSerializer().serializeToString(root);
}

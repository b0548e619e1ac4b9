// The parts of the page that compute only while they are open.

/** The studies by the id of their part, which computes only while it is open. @type {Record<string, (result: Result, problem: Problem) => void>} */
const STUDIES = {
  "part-laws": (result, problem) => {
    const laws = everyLaw(APP.scene, result.n, problem);
    const rows = laws.map(({ name, found, reason }) =>
      found
        ? tableRow([name, ...examplesOf(found.law, result.n).map((text) => text.replace(`law ${name}: `, ""))].join(", "), [shown(found.summary.maximum_force, "force"), shown(found.summary.maximum_indentation, "length"), shown(found.summary.contact_duration, "time"), shown(found.summary.coefficient_of_restitution, "dimensionless", 4)])
        : made("tr", {}, made("th", { scope: "row" }, name), made("td", { colspan: "4" }, reason)),
    );
    const head = ["law", "largest force", "largest indentation", "contact", "restitution"].map((text) => made("th", { scope: "col" }, text));
    byId("laws").replaceChildren(made("thead", {}, made("tr", {}, ...head)), made("tbody", {}, ...rows));
    const series = laws.flatMap(({ name, found }, colour) =>
      found ? [{ name, ...loopOf(found), colour, dashed: colour >= DATA.colours.length }] : [],
    );
    const axes = { x: { label: "indentation", dimension: "length" }, y: { label: "force", dimension: "force" } };
    showChart("chart-laws", { title: "Every law", ...axes, series }, "Force against indentation under every law; the table has the numbers");
  },
  "part-restitution": (result, problem) => {
    const curve = restitutionCurve(APP.scene, problem.vibrates);
    const own = result.summary.coefficient_of_restitution;
    showChart("chart-restitution", {
      title: "Restitution against velocity",
      x: { label: "approach velocity", dimension: "velocity", log: true },
      y: { label: "coefficient of restitution", dimension: "dimensionless" },
      series: [{ name: "restitution", ...curve, colour: 0 }],
      ...(own >= 0 ? { point: /** @type {[number, number]} */ ([result.n.approach, own]) } : {}),
    }, `Coefficient of restitution against velocity; ${shown(own, "dimensionless", 4)} for this scene`);
  },
  "part-accuracy": (_, problem) => {
    const curves = accuracyCurve(problem);
    showChart("chart-accuracy", {
      title: "Segments against error",
      x: { label: "segments", dimension: "dimensionless", log: true },
      y: { label: "largest relative error", dimension: "dimensionless", log: true },
      series: curves.map((curve, colour) => ({ ...curve, colour, marks: true })),
    }, "Largest relative error of the summary against the number of segments");
  },
  "part-map": (result) => {
    const { chart, words } = regimeMap(APP.scene, result.n);
    showChart("chart-map", chart, `Map of regimes: this scene at ${words}`);
    byId("place").textContent = `This scene: ${words}.`;
  },
};

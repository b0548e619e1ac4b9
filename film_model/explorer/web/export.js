// Files and texts that leave the page, all made here: nothing is sent anywhere.

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Dimensions of the columns of friction. @type {Record<string, string>} */
const OF_FRICTION = { sliding_velocity: "velocity", friction_force: "force" };

/** The sampled motion with energies and friction, SI. @param {Scene} scene @param {Result} result */
function csvText(scene, result) {
  const { motion, stage } = result.motion;
  const energies = energiesOf(scene, result);
  const names = Object.keys(DATA.motion);
  const units = names.map((name) => DATA.dimensions[DATA.motion[name][0]].unit);
  const head = ["time (s)", ...names.map((name, k) => `${name} (${units[k]})`)];
  const parts = Object.entries(energies);
  const along = Object.entries(alongAt(motion.time, result.oblique));
  const heads = [...parts.map(([name]) => `energy_${name} (J)`), ...along.map(([name]) => `${name} (${DATA.dimensions[OF_FRICTION[name]].unit})`)];
  const rows = [[...head, ...heads, "stage"].join(",")];
  for (let k = 0; k < motion.time.length; k++) {
    const numbers = [motion.time, ...names.map((name) => motion[name]), ...[...parts, ...along].map(([, values]) => values)];
    rows.push([...numbers.map((column) => String(column[k])), stage[k]].join(","));
  }
  return `${rows.join("\n")}\n`;
}

/** A chart as a PNG file. @param {Chart} chart @returns {Promise<Blob>} */
async function pngOf(chart) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(chartFile(chart))}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [1440, 840];
  canvas.getContext("2d")?.drawImage(image, 0, 0, 1440, 840);
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture cannot be written"))), "image/png");
  });
}

/** Put a text on the clipboard, or show it for copying by hand. @param {string} text @param {string} what */
async function copyText(text, what) {
  const area = /** @type {HTMLTextAreaElement} */ (byId("copied"));
  area.value = text;
  byId("copied-part").hidden = false;
  try {
    await navigator.clipboard.writeText(text);
    say(`${what} copied`);
  } catch {
    area.focus();
    area.select();
    say(`${what}: select and copy the text below`);
  }
}

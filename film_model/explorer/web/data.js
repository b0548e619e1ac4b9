// The data that Python wrote into the page, and the start of the core.

/** @param {string} id */
function embedded(id) {
  return document.getElementById(id)?.textContent ?? "";
}

/** @type {any} */
const DATA = JSON.parse(embedded("data"));

/** @param {string} id of an element with deflated bytes in base64 */
async function unpacked(id) {
  const bytes = Uint8Array.from(atob(embedded(id).trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** @type {Core} */
let CORE;

async function startCore() {
  const [code, curves] = await Promise.all([unpacked("core"), unpacked("curves")]);
  const { instance } = /** @type {any} */ (await WebAssembly.instantiate(code, {}));
  CORE = new Core(instance, DATA.layout, curves);
}

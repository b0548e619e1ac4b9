// Runs an FMU for FMI 3.0, Co-Simulation, that was exported for the platform wasm32-wasi (docs/fmus.md), in a browser:
//
//     const impact = await load(new Uint8Array(await (await fetch("impact.fmu")).arrayBuffer()));
//     impact.start({ initial_velocity: 0.5 });
//     impact.step(0, 1e-4);
//     impact.get("contact_force");
//
// The module exports the C functions of FMI, which take addresses in its memory. Of the system it uses the files in the FMU.

const OK = 0, BAD_FILE = 8, NO_FILE = 44; // of WASI, preview 1
const ROOT = 3; // file descriptor of the folder /
const text = bytes => new TextDecoder().decode(bytes);

/** Content of the files of a ZIP archive, by name. */
async function unzip(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), files = {};
    let end = bytes.length - 22;
    while (end > 0 && view.getUint32(end, true) !== 0x06054b50) end--;
    let at = view.getUint32(end + 16, true);
    for (let count = view.getUint16(end + 10, true); count > 0; count--) {
        const [name, extra, comment] = [28, 30, 32].map(place => view.getUint16(at + place, true));
        const local = view.getUint32(at + 42, true), size = view.getUint32(at + 20, true);
        const from = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
        const stored = new Blob([bytes.subarray(from, from + size)]);
        const plain = view.getUint16(at + 10, true) === 0 ? stored.stream()
            : stored.stream().pipeThrough(new DecompressionStream("deflate-raw"));
        files[text(bytes.subarray(at + 46, at + 46 + name))] = new Uint8Array(await new Response(plain).arrayBuffer());
        at += 46 + name + extra + comment;
    }
    return files;
}

/** What the module imports: files that can be read, and nothing else. memory: a function that gives its memory. */
function system(files, memory) {
    const opened = new Map(), view = () => new DataView(memory().buffer), bytes = () => new Uint8Array(memory().buffer);
    return {
        fd_prestat_get: (fd, to) => fd === ROOT ? (view().setUint32(to, 0, true), view().setUint32(to + 4, 1, true), OK) : BAD_FILE,
        fd_prestat_dir_name: (fd, to) => (bytes()[to] = 47, OK),
        fd_fdstat_get: (fd, to) => {
            bytes().fill(255, to, to + 24); // all rights
            view().setUint32(to, fd === ROOT ? 3 : 4, true); // a folder or a file
            return OK;
        },
        fd_fdstat_set_flags: () => OK,
        path_open: (folder, follow, path, length, create, base, inherited, flags, to) => {
            const content = files[text(bytes().slice(path, path + length))];
            if (!content) return NO_FILE;
            const fd = ROOT + 1 + opened.size;
            opened.set(fd, { content, at: 0 });
            view().setUint32(to, fd, true);
            return OK;
        },
        fd_read: (fd, parts, count, to) => {
            const file = opened.get(fd), begun = file.at;
            for (let k = 0; k < count; k++) {
                const address = view().getUint32(parts + 8 * k, true), length = view().getUint32(parts + 8 * k + 4, true);
                const part = file.content.subarray(file.at, file.at + length);
                bytes().set(part, address);
                file.at += part.length;
            }
            view().setUint32(to, file.at - begun, true);
            return OK;
        },
        fd_seek: (fd, offset, whence, to) => {
            const file = opened.get(fd);
            if (!file) return BAD_FILE;
            file.at = Number(offset) + [0, file.at, file.content.length][whence];
            view().setBigUint64(to, BigInt(file.at), true);
            return OK;
        },
        fd_write: () => BAD_FILE,
        fd_close: fd => opened.has(fd) ? (opened.get(fd).content = new Uint8Array(), OK) : BAD_FILE,
        proc_exit: status => { throw new Error(`the FMU ended with status ${status}`); },
    };
}

/** An instance of the FMU, from the content of the file. */
export async function load(fmu) {
    const files = await unzip(fmu);
    const description = new DOMParser().parseFromString(text(files["modelDescription.xml"]), "text/xml");
    const identifier = description.querySelector("CoSimulation").getAttribute("modelIdentifier");
    const imports = { wasi_snapshot_preview1: system(files, () => fmi.memory) };
    const { instance } = await WebAssembly.instantiate(files[`binaries/wasm32-wasi/${identifier}.wasm`], imports);
    const fmi = instance.exports;
    fmi._initialize();
    const references = {};
    for (const variable of description.querySelectorAll("ModelVariables > *"))
        references[variable.getAttribute("name")] = [Number(variable.getAttribute("valueReference")), variable.tagName];
    const string = value => {
        const content = new TextEncoder().encode(`${value}\0`), address = fmi.malloc(content.length);
        new Uint8Array(fmi.memory.buffer).set(content, address);
        return address;
    };
    const token = description.documentElement.getAttribute("instantiationToken");
    const self = fmi.fmi3InstantiateCoSimulation(string(identifier), string(token), string("/resources/"), 0, 0, 0, 0, 0, 0, 0, 0, 0);
    if (!self) throw new Error("the FMU cannot be instantiated");
    const room = fmi.malloc(32), view = () => new DataView(fmi.memory.buffer);
    const checked = (what, status) => { if (status > 1) throw new Error(`${what}: status ${status}`); };
    const place = name => {
        if (!references[name]) throw new Error(`the FMU has no variable ${name}`);
        view().setUint32(room, references[name][0], true);
        return references[name][1];
    };
    const set = (name, value) => {
        if (place(name) !== "Float64") throw new Error(`${name} is not a real number`);
        view().setFloat64(room + 8, value, true);
        checked(name, fmi.fmi3SetFloat64(self, room, 1, room + 8, 1));
    };
    return {
        set,
        get: name => {
            const type = place(name);
            if (type === "Float64") checked(name, fmi.fmi3GetFloat64(self, room, 1, room + 8, 1));
            else if (type === "Int32") checked(name, fmi.fmi3GetInt32(self, room, 1, room + 8, 1));
            else checked(name, fmi.fmi3GetInt64(self, room, 1, room + 8, 1));
            return type === "Float64" ? view().getFloat64(room + 8, true) : view().getInt32(room + 8, true);
        },
        start: (values = {}) => {
            for (const [name, value] of Object.entries(values)) set(name, value);
            checked("initialization", fmi.fmi3EnterInitializationMode(self, 0, 0, 0, 0, 0));
            checked("initialization", fmi.fmi3ExitInitializationMode(self));
        },
        step: (time, size) => checked("step", fmi.fmi3DoStep(self, time, size, 0, room, room + 1, room + 2, room + 8)),
        free: () => fmi.fmi3FreeInstance(self),
    };
}

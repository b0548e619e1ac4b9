"""The FMU's binary: its sources, the platforms, and the compiler commands.

Imports the standard library only, because the build of film-model imports this file.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from platform import machine
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
CORE, RUNTIME = "film_model/core", "fmu_wrapper/runtime"


def core(folder: str, *names: str) -> tuple[str, ...]:
    """C files of a folder of the core, from the root of the project."""
    return tuple(f"{CORE}/{folder}/film_{name}.c" for name in names)


MARCH = (  # one impact; the core's batches are not in FMUs
    *core("curve", "curve", "series", "unload"),
    *core("march", "setup", "energy", "damping", "branch", "follow", "draw", "turn", "next", "release", "aim", "march"),
    *core("march", "integrator"),
)
MODES = (
    *core("lanes", "instructions"),
    *core("modal", "modal", "modal_table", "modal_loops", "modal_avx2", "modal_avx512", "modal_root", "modal_force"),
    *core("modal", "modal_stretch", "modal_contact", "modal_flight"),
)
RELAXING = core("relax", "relax", "relax_step")
SLIDING = (*core("oblique", "radii", "springs"), *core("modal", "slide"))
SOURCES = (
    *MARCH,
    *MODES,
    *RELAXING,
    *SLIDING,
    *(
        f"{RUNTIME}/model{part}.c"
        for part in (
            *("", "_events", "_contact", "_curve", "_outputs", "_validity", "_exchange", "_modes", "_beside"),
            *("_stresses", "_slopes", "_sliding"),
        )
    ),
    *(f"{RUNTIME}/{name}.c" for name in ("resource", "instance", "instance_step", "fmi2", "fmi3")),
)
HEADERS = (
    f"{CORE}/film_core.h",
    *(f"{CORE}/{name}.h" for name in ("curve/film_law", "march/film_line", "march/film_march", "lanes/film_wide")),
    *(f"{CORE}/{name}.h" for name in ("modal/film_modal", "modal/film_modal_parts", "modal/film_slide")),
    *(f"{CORE}/{name}.h" for name in ("relax/film_relax", "relax/film_relax_parts")),
    *(f"{CORE}/oblique/film_{name}.h" for name in ("friction", "springs")),
    *(
        f"{RUNTIME}/{name}.h"
        for name in ("model", "model_parts", "instance", "instance_parts", "fmi_calls", "variables", "failures")
    ),
)
INCLUDES = (CORE, RUNTIME)
WINDOWS_START = f"{RUNTIME}/windows_start.c"
WINDOWS_PARTS = (
    "kernel32",
    *(f"api-ms-win-crt-{one}-l1-1-0" for one in ("math", "heap", "stdio", "string", "private")),
)
"""Parts of Windows that its binary imports; zig makes import libraries of them without compiling C."""
_OWN = b"film|model|instance|contact|modes|relaxing|sliding"  # how the names of all functions begin that are not static
DEFINITIONS = {"FILM_API": ""}  # not exported: one process may load FMUs of several versions

# No fused multiply-adds, so that every compiler gives the same bits; the last two flags allow loops to vectorise.
FLAGS = ("-std=c99", "-O3", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")


class Platform(NamedTuple):
    """A platform: folders in FMUs of FMI 2.0 and 3.0, zig's target name, suffix of shared libraries.

    FMI 2.0 defines no folders for ARM processors; importers use a name of their own there.
    """

    fmi2: str
    fmi3: str
    target: str
    suffix: str


PLATFORMS: dict[str, Platform] = {
    "x86_64-linux": Platform("linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    "aarch64-linux": Platform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    "x86_64-windows": Platform("win64", "x86_64-windows", "x86_64-windows-gnu", ".dll"),
    "x86_64-darwin": Platform("darwin64", "x86_64-darwin", "x86_64-macos.11.0", ".dylib"),
    "aarch64-darwin": Platform("aarch64-darwin", "aarch64-darwin", "aarch64-macos.11.0", ".dylib"),
    "wasm32-wasi": Platform("wasm32-wasi", "wasm32-wasi", "wasm32-wasi", ".wasm"),
}
EVERYWHERE = tuple(name for name in PLATFORMS if name != "wasm32-wasi")
"""Those that importers load: all but WebAssembly, which is for browsers."""
FOR_BROWSERS = ("-mexec-model=reactor", *(f"-Wl,--export{what}" for what in ("-dynamic", "=malloc", "=free")))


def this_platform() -> str:
    """Name of the platform this runs on, which may be missing in `PLATFORMS`."""
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine().lower(), machine().lower())
    return f"{processor}-{system}"


def folder(name: str, fmi_version: int) -> str:
    """Folder of a platform's binary inside an FMU: the platform's own name if it is not in `PLATFORMS`."""
    if name not in PLATFORMS:
        return name
    return PLATFORMS[name].fmi2 if fmi_version == 2 else PLATFORMS[name].fmi3


def built_library() -> str:
    """Path of the binary that the build of film-model makes for this platform, from the root of the project."""
    return f"{RUNTIME}/_film_fmu" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def prefixed_sources(identifier: str, fmi_version: int) -> dict[str, bytes]:
    """The C sources of one FMI version by file name; names begin with the model identifier, to link FMUs together.

    All are in one folder, so includes lose theirs. The names of FMI's own functions are changed by FMI2_FUNCTION_PREFIX
    or FMI3_FUNCTION_PREFIX, as the standards say.
    """
    sources = {Path(name).name: (ROOT / name).read_bytes() for name in (*SOURCES, *HEADERS)}
    texts = {name: re.sub(rb'#include "\w+/', b'#include "', source) for name, source in sources.items()}
    del texts["fmi3.c" if fmi_version == 2 else "fmi2.c"]
    together = b"\n".join(texts.values())
    tables = b", ".join(re.findall(rb"\bextern const \w+ ([\w, ]+);", together)).split(b", ")
    names = sorted({*re.findall(rb"\b(?:%s)_\w+(?=\()" % _OWN, together), *tables})
    made = {name: b'#include "prefix.h"\n' + text if name.endswith(".c") else text for name, text in texts.items()}
    lines = [b"#define %s %s_%s\n" % (one, identifier.encode(), one) for one in names]
    return {**made, "prefix.h": b"/* Names of functions and tables in this FMU. */\n" + b"".join(lines)}


def license_text() -> bytes:
    """film-model's licence, from the installed package or from the project's folder."""
    places = (ROOT / "fmu_wrapper" / "LICENSE", ROOT / "LICENSE")
    return next(place for place in places if place.exists()).read_bytes()


def fmi_headers() -> Path:
    """Folder of the FMI headers, which are part of FMPy. Raises ImportError without FMPy."""
    return package_folder("fmpy") / "c-code"


def package_folder(name: str) -> Path:
    """Folder of an installed package that compiling needs. Raises ImportError without it."""
    found = importlib.util.find_spec(name)
    if found is None or found.origin is None:
        raise ImportError(f'compiling FMUs needs {name}: pip install "film-model[cross-compile]"')
    return Path(found.origin).parent


def can_cross_compile() -> bool:
    """Whether ziglang and FMPy, which has the headers, are installed."""
    return all(importlib.util.find_spec(name) is not None for name in ("ziglang", "fmpy"))


def arguments(root: Path) -> list[str]:
    """Compiler arguments for the binary, with sources under `root`."""
    return [
        *(f"-D{name}={value}" for name, value in DEFINITIONS.items()),
        *(f"-I{root / folder}" for folder in INCLUDES),
        f"-I{fmi_headers()}",
        *(str(root / source) for source in SOURCES),
    ]


def cross_compiled(names: Sequence[str]) -> dict[str, bytes]:
    """Binaries by platform, compiled side by side; from the cache if these sources were compiled before."""
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        return dict(zip(names, pool.map(_cached, names), strict=True))


@lru_cache(maxsize=16)
def _cached(name: str) -> bytes:
    """A platform's binary from the user's cache folder, or compiled and put there."""
    if importlib.util.find_spec("ziglang") is None:
        return cross_compile(name)
    inputs = [version("ziglang")]
    files = (*SOURCES, *HEADERS, WINDOWS_START, Path(__file__))  # the last contains the compiler's arguments
    inputs += [hashlib.sha256((ROOT / one).read_bytes()).hexdigest() for one in files]
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    kept = home / "film-model" / f"{name}-{hashlib.sha256(' '.join(inputs).encode()).hexdigest()[:32]}"
    try:
        return kept.read_bytes()
    except OSError:
        binary = cross_compile(name)
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        beside = kept.with_name(f"{kept.name}.{os.getpid()}")
        beside.write_bytes(binary)
        beside.replace(kept)
    except OSError:  # a cache is not needed
        pass
    return binary


def cross_compile(name: str) -> bytes:
    """The binary for a platform of `PLATFORMS`, compiled by zig.

    Raises ImportError without ziglang, RuntimeError with the compiler's output if it fails.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise ImportError(f'a binary for {name} needs ziglang: pip install "film-model[cross-compile]"')
    platform = PLATFORMS[name]
    with tempfile.TemporaryDirectory() as folder:
        built = Path(folder, "film_fmu" + platform.suffix)
        command = [sys.executable, "-m", "ziglang", "cc", *FLAGS, "-s", "-target", platform.target]
        link = FOR_BROWSERS if name not in EVERYWHERE else ("-shared", *linked(built.name))
        run(name, [*command, *link, *arguments(ROOT), "-o", str(built)])
        return built.read_bytes()


def linked(library: str) -> list[str]:
    """Arguments that link a library of this name with the system, and compile no other, of which zig has sources only.

    Linux and macOS need no functions of the compiler's own library. Windows takes what its C library lacks from there
    (sincos), and is spared that of mingw-w64, a minute of work: `WINDOWS_START` contains what this binary needs of it.
    """
    if library.endswith(".so"):
        return ["-fPIC", "-rtlib=none", "-lm"]
    if library.endswith(".dylib"):
        return ["-fPIC", "-rtlib=none", "-install_name", f"@rpath/{library}"]
    headers = package_folder("ziglang") / "lib" / "libc" / "include" / "any-windows-any"
    return [
        *("-nostdlib", "-rtlib=compiler-rt", "-Wl,-e,DllMainCRTStartup", *(f"-l{name}" for name in WINDOWS_PARTS)),
        *("-isystem", str(headers), "-D__MSVCRT_VERSION__=0xE00", "-D_WIN32_WINNT=0x0a00"),  # as zig has them
        str(ROOT / WINDOWS_START),
    ]


def run(what: str, command: Sequence[str]) -> None:
    """Run a compiler. Raises RuntimeError with its output if it fails."""
    done = subprocess.run(command, env=dict(os.environ), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"the binary for {what} does not compile:\n{done.stdout}{done.stderr}")

"""Build hook: compiles the C core, and with it the binary of FMUs, into shared libraries beside their sources."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import re
import shlex
import struct
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

sys.path.insert(0, str(Path(__file__).parent))
from fmu_wrapper import platforms

CORE = platforms.CORE
ONE_IMPACT = (
    *platforms.core("march", "marched", "compare", "solve"),
    *platforms.core("modal", "modal_impact", "refine"),
)
PLATES = platforms.core("plate", "plate", "panel", "ritz", "levy", "spectrum")
SOURCES = (
    *platforms.MARCH,
    *platforms.core("tables", "tables", "cubics", "gauss", "way_in", "way_out"),
    *platforms.core("lanes", "lanes", "avx2", "avx512"),
    *platforms.core("batch", "batch", "batch_shape", "curves", "impact", "many", "motions", "single"),
    *platforms.MODES,
    *PLATES,
    *ONE_IMPACT,
    *platforms.RELAXING,
    *platforms.core("oblique", "friction", "friction_step", "friction_quick", "friction_many"),
    *platforms.SLIDING,
    *platforms.core("chain", "chain", "chain_step", "chain_events"),
)
LIBRARY = f"{CORE}/_film_core" + Path(platforms.built_library()).suffix
FLAGS = platforms.FLAGS
SHARED = ("-shared",) if sys.platform == "win32" else ("-shared", "-fPIC")
LINK = () if sys.platform == "win32" else ("-lm",)
WASM = "film_model/explorer/_film_core.wasm"
FRICTION = platforms.core("oblique", "friction", "friction_step", "springs", "radii")
WASM_SOURCES = (*platforms.MARCH, *platforms.MODES, *PLATES, *ONE_IMPACT, *FRICTION)
CALLED = {  # functions of the core that the page calls
    name
    for script in Path(__file__).parent.glob("film_model/explorer/web/*.js")
    for name in re.findall(r"\bc\.(film_\w+)", script.read_text("utf-8"))
}
WASM_FLAGS = (
    *("-target", "wasm32-wasi", "-mexec-model=reactor", *FLAGS, "-Os", "-s", "-DFILM_API=", f"-I{CORE}"),
    *(f"-Wl,--export={name}" for name in ("__heap_base", *sorted(CALLED))),
)
OLDEST_GLIBC = (2, 17)  # the oldest that Python's package index serves on all processors (manylinux2014)
OLDEST_MACOS = "11.0"  # the first on ARM processors; nothing in the C sources needs a newer one
TARGETS = {  # systems that zig compiles for from any other, if FILM_TARGET names one: its name there, tag of its wheel
    "x86_64-linux-gnu.2.17": "manylinux_2_17_x86_64",
    "aarch64-linux-gnu.2.17": "manylinux_2_17_aarch64",
    "x86_64-linux-musl": "musllinux_1_2_x86_64",
    "aarch64-linux-musl": "musllinux_1_2_aarch64",
    "x86_64-macos.11.0": "macosx_11_0_x86_64",
    "aarch64-macos.11.0": "macosx_11_0_arm64",
    "x86_64-windows-gnu": "win_amd64",
}
PROBE = "#include <math.h>\ndouble probe(double x) { return sqrt(x); }\n"


def has_zig() -> bool:
    """Whether Python's package index has zig for this system and processor."""
    processors = {"linux": ("x86_64", "aarch64"), "darwin": ("x86_64", "arm64"), "win32": ("AMD64", "ARM64", "x86")}
    return platform.machine() in processors.get(sys.platform, ())


def platform_tag() -> str:
    """The wheel tag of this system and processor, as in linux_x86_64."""
    if sys.platform == "darwin":  # Python's own tag may be of an older system or of two processors
        return next(platform_tags())
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")


def wheel_tag(libraries: list[bytes]) -> str:
    """The platform tag of a wheel: the oldest system on which all its libraries load; if unknown, this system.

    The processor is this Python's: `works` accepts only compilers whose libraries this Python loads.
    """
    processor = platform.machine()
    if sys.platform == "darwin" and all(needed := [macos_needed(library) for library in libraries]):
        return f"macosx_{max(needed)}_0_{processor}"
    if sys.platform == "linux" and all(needed := [glibc_needed(library) for library in libraries]):
        return "manylinux_{}_{}".format(*max(needed)) + platform_tag().removeprefix("linux")
    return platform_tag()


def glibc_needed(library: bytes) -> tuple[int, int] | None:
    """The oldest glibc that an ELF library loads with; None if it needs more than numbered symbols of glibc.

    Needed libraries and versions are strings that end with a zero byte, so that none is missed; a string that looks
    like one by chance can only make the answer more cautious.
    """
    names = set(re.findall(rb"([^\0]*\.so(?:\.[\d.]+)?)\0", library))
    versions = re.findall(rb"GLIBC_([^\0]+)\0", library)
    numbers = [re.match(rb"(\d+)\.(\d+)", version) for version in versions]
    if not names <= {b"libc.so.6", b"libm.so.6"} or not numbers or None in numbers:
        return None
    return max(OLDEST_GLIBC, *((int(number[1]), int(number[2])) for number in numbers if number))


def macos_needed(library: bytes) -> int | None:
    """The first version of macOS, from 11, of which every release loads a Mach-O library of one processor."""
    magic, _, _, _, commands = struct.unpack_from("<5I", library)
    if magic != 0xFEEDFACF:
        return None
    at = 32
    for _ in range(commands):
        command, size = struct.unpack_from("<2I", library, at)
        if command in (0x24, 0x32):  # LC_VERSION_MIN_MACOSX, LC_BUILD_VERSION: 16 bits of major version, 8 of minor
            (version,) = struct.unpack_from("<I", library, at + (8 if command == 0x24 else 12))
            return max(11, (version + 0xFFFF) >> 16)
        at += size
    return None


def works(compiler: list[str]) -> bool:
    """Whether a compiler is there and, with these flags and the standard headers, builds what this Python can load."""
    with tempfile.TemporaryDirectory() as folder:
        library = str(Path(folder, "probe" + Path(LIBRARY).suffix))
        command = [*compiler, *FLAGS, *SHARED, "-x", "c", "-", "-o", library, *LINK]
        load = [sys.executable, "-c", "import ctypes, sys; ctypes.CDLL(sys.argv[1])", library]
        try:
            built = subprocess.run(command, input=PROBE, capture_output=True, text=True).returncode == 0
            return built and subprocess.run(load, capture_output=True).returncode == 0
        except OSError:
            return False


def digest(file: Path) -> str:
    """A hash of a file's content."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def system_compiler() -> list[str] | None:
    """The first that works of: the environment's CC, cc, gcc, clang."""
    chosen = shlex.split(os.environ.get("CC", ""), posix=os.name != "nt")
    return next((c for c in (chosen, ["cc"], ["gcc"], ["clang"]) if c and works(c)), None)


def suffix_for(target: str) -> str:
    """The suffix of shared libraries of a target of `TARGETS`."""
    return next((suffix for word, suffix in (("windows", ".dll"), ("macos", ".dylib")) if word in target), ".so")


def zig_compiler() -> list[str]:
    """Zig's C compiler, for any processor of this kind and for old systems where that is one of glibc or macOS."""
    processor, target = platforms.this_platform().split("-")[0], None
    if sys.platform == "darwin":
        target = f"{processor}-macos.{OLDEST_MACOS}"
    elif platform.libc_ver()[0] == "glibc" and processor in ("x86_64", "aarch64"):
        target = "{}-linux-gnu.{}.{}".format(processor, *OLDEST_GLIBC)
    return [sys.executable, "-m", "ziglang", "cc", *(["-target", target] if target else ["-mcpu=baseline"])]


class CustomBuildHook(BuildHookInterface):
    def dependencies(self) -> list[str]:
        return ["fmpy>=0.3.20", "ziglang"] if has_zig() or not system_compiler() else ["fmpy>=0.3.20"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        jobs: list[tuple[list[str], str, tuple[str, ...]]]
        if target := os.environ.get("FILM_TARGET"):
            tag, suffix = TARGETS[target], suffix_for(target)
            core, fmu = (str(Path(name).with_suffix(suffix)) for name in (LIBRARY, platforms.built_library()))
            zig = [sys.executable, "-m", "ziglang", "cc", *FLAGS, "-s", "-shared", "-target", target]
            made = ((core, [f"-I{CORE}", *SOURCES]), (fmu, platforms.arguments(Path(self.root))))
            jobs = [([*zig, *platforms.linked(Path(name).name), *arguments], name, ()) for name, arguments in made]
        else:
            own, core, fmu = system_compiler(), LIBRARY, platforms.built_library()
            compiler = own or zig_compiler()
            old = ["-include", str(Path(self.root, platforms.RUNTIME, "old_glibc.h"))] if own else []
            made = ((core, [f"-I{CORE}", *SOURCES]), (fmu, platforms.arguments(Path(self.root))))
            jobs = [([*compiler, *FLAGS, *SHARED, *old, *arguments], name, LINK) for name, arguments in made]
            tag = None
        build_data["artifacts"] += [f"/{core}", f"/{fmu}"]
        if importlib.util.find_spec("ziglang"):
            build_data["artifacts"] += [f"/{WASM}"]
            jobs.append(([sys.executable, "-m", "ziglang", "cc", *WASM_FLAGS, *WASM_SOURCES], WASM, ()))
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda job: self.run(*job), jobs))
        tag = tag or wheel_tag([Path(self.root, name).read_bytes() for name in (core, fmu)])
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{tag}"

    def made_of(self, command: list[str]) -> str:
        """A hash of the compiler, its arguments, and all that is compiled.

        Folders of headers are left out, and all of the compiler's version but its first line: those of FMPy and zig are
        others in each isolated build.
        """
        compiler = [*command[: command.index(FLAGS[0])], "--version"]
        flags = [one for one in command[1:] if not one.startswith("-I")]
        made_by = subprocess.run(compiler, cwd=self.root, capture_output=True, text=True).stdout.partition("\n")[0]
        whole = hashlib.sha256(repr((made_by, flags, os.environ.get("MACOSX_DEPLOYMENT_TARGET"))).encode())
        sources = [Path(self.root, one) for one in command if one.endswith(".c")]
        headers = [sorted(Path(self.root, folder).rglob("*.h")) for folder in (CORE, platforms.RUNTIME)]
        for file in (*sources, *headers[0], *headers[1]):
            whole.update(file.read_bytes())
        return whole.hexdigest()

    def run(self, command: list[str], name: str, last: tuple[str, ...]) -> None:
        """Compile beside the library and rename, so that no half-written library is ever in its place.

        Nothing is compiled where the library is the one of these sources and this compiler.
        """
        library = Path(self.root, name)
        sealed = Path(self.root, "build", "compiled", library.name + ".sha256")
        made_of = self.made_of(command)
        if sealed.exists() and library.exists() and sealed.read_text("utf-8") == f"{made_of} {digest(library)}":
            return
        with tempfile.TemporaryDirectory(dir=library.parent, prefix=".build-") as folder:
            built = Path(folder, library.name)
            whole = [*command, "-o", str(built), *last]
            caches = {"ZIG_LOCAL_CACHE_DIR": folder}
            if not any(name in os.environ for name in ("HOME", "LOCALAPPDATA")):
                caches["ZIG_GLOBAL_CACHE_DIR"] = folder  # zig fails otherwise
            environment = {**caches, "MACOSX_DEPLOYMENT_TARGET": OLDEST_MACOS, **os.environ}
            done = subprocess.run(whole, cwd=self.root, env=environment, capture_output=True, text=True)
            if done.returncode != 0:
                self.app.abort(f"{library.name} does not compile:\n$ {shlex.join(whole)}\n{done.stdout}{done.stderr}")
            os.replace(built, library)
        sealed.parent.mkdir(parents=True, exist_ok=True)
        sealed.write_text(f"{made_of} {digest(library)}", encoding="utf-8")

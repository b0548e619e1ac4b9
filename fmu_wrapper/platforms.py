"""The FMU's binary: its sources, the platforms it can be made for, and how.

Nothing but the standard library is imported here: the build of film-model itself uses it.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from platform import machine
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
CORE, RUNTIME = "film_model/core", "fmu_wrapper/runtime"
SOURCES = (
    f"{CORE}/film_core.c",
    *(f"{RUNTIME}/{name}.c" for name in ("model", "resource", "instance", "fmi2", "fmi3")),
)
HEADERS = (
    *(f"{CORE}/{name}.h" for name in ("film_core", "film_law", "film_line")),
    *(f"{RUNTIME}/{name}.h" for name in ("model", "instance", "variables")),
)
INCLUDES = (CORE, RUNTIME)
DEFINITIONS = {"FILM_API": ""}  # the core's functions stay inside: FMUs of other versions may be in the same process

# Without contraction into fused multiply-adds every compiler gives the same bits; the last two let loops vectorise.
FLAGS = ("-std=c99", "-O3", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")


class Platform(NamedTuple):
    """A platform: its folders in an FMU of FMI 2.0 and 3.0, zig's name for it, and how its shared libraries end.

    FMI 2.0 names no folder for ARM processors; importers that run there look in the one of their system.
    """

    fmi2: str
    fmi3: str
    target: str
    suffix: str


PLATFORMS: dict[str, Platform] = {
    "x86_64-linux": Platform("linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    "aarch64-linux": Platform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    "x86_64-windows": Platform("win64", "x86_64-windows", "x86_64-windows-gnu", ".dll"),
    "x86_64-darwin": Platform("darwin64", "x86_64-darwin", "x86_64-macos", ".dylib"),
    "aarch64-darwin": Platform("aarch64-darwin", "aarch64-darwin", "aarch64-macos", ".dylib"),
}


def this_platform() -> str:
    """The name of the platform we run on; it need not be in `PLATFORMS`."""
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine().lower(), machine().lower())
    return f"{processor}-{system}"


def folder(name: str, fmi_version: int) -> str:
    """The folder of a platform's binary inside an FMU; a platform that is not in `PLATFORMS` has its own name."""
    if name not in PLATFORMS:
        return name
    return PLATFORMS[name].fmi2 if fmi_version == 2 else PLATFORMS[name].fmi3


def built_library() -> str:
    """Where the build of film-model puts this platform's binary, from the root of the project."""
    return f"{RUNTIME}/_film_fmu" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def license_text() -> bytes:
    """film-model's licence, from the installed package or the project it is run in."""
    places = (ROOT / "fmu_wrapper" / "LICENSE", ROOT / "LICENSE")
    return next(place for place in places if place.exists()).read_bytes()


def fmi_headers() -> Path:
    """The folder of the FMI headers, which FMPy brings along. Raises ImportError without it."""
    found = importlib.util.find_spec("fmpy")
    if found is None or found.origin is None:
        raise ImportError('compiling FMUs needs FMPy\'s headers: pip install "film-model[cross-compile]"')
    return Path(found.origin).parent / "c-code"


def arguments(root: Path) -> list[str]:
    """What any compiler needs to make the binary from the sources under `root`."""
    return [
        *(f"-D{name}={value}" for name, value in DEFINITIONS.items()),
        *(f"-I{root / folder}" for folder in INCLUDES),
        f"-I{fmi_headers()}",
        *(str(root / source) for source in SOURCES),
    ]


def cross_compile(name: str) -> bytes:
    """The binary for a platform of `PLATFORMS`, made by zig.

    Raises ImportError without ziglang, RuntimeError with the compiler's words when it fails.
    """
    if importlib.util.find_spec("ziglang") is None:
        raise ImportError(f'a binary for {name} needs ziglang: pip install "film-model[cross-compile]"')
    platform = PLATFORMS[name]
    with tempfile.TemporaryDirectory() as folder:
        built = Path(folder, "film_fmu" + platform.suffix)
        command = [sys.executable, "-m", "ziglang", "cc", *FLAGS, "-s", "-shared", "-target", platform.target]
        if platform.suffix != ".dll":
            command += ["-fPIC"]
        if platform.suffix == ".dylib":
            command += ["-install_name", f"@rpath/{built.name}"]
        if platform.suffix == ".so":
            command += ["-lm"]
        run(name, [*command, *arguments(ROOT), "-o", str(built)])
        return built.read_bytes()


def run(what: str, command: Sequence[str]) -> None:
    """Run a compiler. Raises RuntimeError with its words when it fails."""
    done = subprocess.run(command, env=dict(os.environ), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"the binary for {what} does not compile:\n{done.stdout}{done.stderr}")

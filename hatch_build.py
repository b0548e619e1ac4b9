"""Build hook: compiles the C core, and with it the binary of FMUs, into shared libraries beside their sources."""

from __future__ import annotations

import os
import platform
import shlex
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

sys.path.insert(0, str(Path(__file__).parent))
from fmu_wrapper import platforms

CORE = platforms.CORE
SOURCES = tuple(f"{CORE}/film_{name}.c" for name in ("core", "batch", "lanes", "avx2", "avx512"))
LIBRARY = f"{CORE}/_film_core" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
FLAGS = platforms.FLAGS
SHARED = ("-shared",) if sys.platform == "win32" else ("-shared", "-fPIC")
LINK = () if sys.platform == "win32" else ("-lm",)
PROBE = "#include <math.h>\ndouble probe(double x) { return sqrt(x); }\n"


def platform_tag() -> str:
    """The wheel tag of what the compilers make: this system and processor, as in linux_x86_64."""
    if sys.platform == "darwin":  # Python's own tag may be of an older system or of two processors
        return next(platform_tags())
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")


def works(compiler: list[str]) -> bool:
    """Whether a compiler is there and builds a shared library with these flags and the standard headers."""
    with tempfile.TemporaryDirectory() as folder:
        command = [*compiler, *FLAGS, *SHARED, "-x", "c", "-", "-o", str(Path(folder) / "probe"), *LINK]
        try:
            return subprocess.run(command, input=PROBE, capture_output=True, text=True).returncode == 0
        except OSError:
            return False


def system_compiler() -> list[str] | None:
    """The first that works of: the environment's CC, cc, gcc, clang."""
    chosen = shlex.split(os.environ.get("CC", ""), posix=os.name != "nt")
    return next((c for c in (chosen, ["cc"], ["gcc"], ["clang"]) if c and works(c)), None)


def zig_compiler() -> list[str]:
    """Zig's C compiler, for any processor of this kind and, where the system has glibc, for any glibc since 2.17."""
    machine = platform_tag().removeprefix("linux_")
    glibc = platform.libc_ver()[0] == "glibc" and machine in ("x86_64", "aarch64")
    portable = ["-target", f"{machine}-linux-gnu.2.17"] if glibc else ["-mcpu=baseline"]
    return [sys.executable, "-m", "ziglang", "cc", *portable]


class CustomBuildHook(BuildHookInterface):
    def dependencies(self) -> list[str]:
        return ["fmpy>=0.3.20"] if system_compiler() else ["fmpy>=0.3.20", "ziglang"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        own = system_compiler()
        compiler, fmu = own or zig_compiler(), platforms.built_library()
        self.compile(compiler, LIBRARY, list(SOURCES))
        old = ["-include", str(Path(self.root, platforms.RUNTIME, "old_glibc.h"))] if own else []
        self.compile(compiler, fmu, [*old, *platforms.arguments(Path(self.root))])
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform_tag()}"
        build_data["artifacts"] += [f"/{LIBRARY}", f"/{fmu}"]

    def compile(self, compiler: list[str], name: str, arguments: list[str]) -> None:
        """Compile beside the library and rename, so that no half-written library is ever in its place."""
        library = Path(self.root, name)
        with tempfile.TemporaryDirectory(dir=library.parent, prefix=".build-") as folder:
            built = Path(folder, library.name)
            command = [*compiler, *FLAGS, *SHARED, *arguments, "-o", str(built), *LINK]
            caches = {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}  # zig fails without HOME otherwise
            run = subprocess.run(command, cwd=self.root, env={**caches, **os.environ}, capture_output=True, text=True)
            if run.returncode != 0:
                self.app.abort(f"{library.name} does not compile:\n$ {shlex.join(command)}\n{run.stdout}{run.stderr}")
            os.replace(built, library)

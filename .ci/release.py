"""Build and check what a release publishes: .venv/bin/python .ci/release.py dist

Into the folder go the sources, a wheel for each system of `hatch_build.TARGETS`, all compiled here by zig, a bill of
materials (CycloneDX), a conda recipe and the checksums. The libraries in each wheel are checked: processor, exported
functions, oldest system; on Linux by auditwheel too. Where this machine runs them (apt-get install musl qemu-user wine)
the core of the wheel passes tests/core_check.c. Each CPython on PATH installs this system's wheel in a new environment
and runs a scene, and so does Debian's Python for ARM in QEMU.
"""

import argparse
import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

import lief

import hatch_build
from film_model.version import __version__
from fmu_wrapper import platforms

ROOT = Path(__file__).resolve().parent.parent
TOOLS = ("auditwheel>=6.5", "cyclonedx-bom>=7", "py-rattler-build>=0.60", "twine>=6.1")
PYTHONS = ("python3.11", "python3.12", "python3.13", "python3.14")
OWN = (hatch_build.LIBRARY, platforms.built_library())
SCENE = ROOT / "examples" / "scenes" / "steel_ball_on_steel.toml"
RUNNERS = {  # by target: what runs its programs here, and a file that must be there
    "x86_64-linux-gnu.2.17": ((), "/lib64/ld-linux-x86-64.so.2"),
    "x86_64-linux-musl": ((), "/lib/ld-musl-x86_64.so.1"),
    "x86_64-windows-gnu": (("wine",), "/usr/bin/wine"),
}
QEMU = "qemu-aarch64"
RENDER = """
import sys, rattler_build as r
recipe, pins = r.Stage0Recipe.from_file(sys.argv[1]), {"c_stdlib": ["sysroot"], "m2w64_c_stdlib": ["m2w64-toolchain"]}
for name in ("linux-64", "linux-aarch64", "osx-64", "osx-arm64", "win-64"):
    platform = r.PlatformConfig(target_platform=name, build_platform=name, host_platform=name)
    (variant,) = recipe.render(r.VariantConfig(pins), r.RenderConfig(platform))
    print(name, *variant.recipe.requirements.to_dict()["run"], sep=", ")
"""


def runs(python: str) -> bool:
    """Whether a Python is on PATH and runs: version managers have names for those that are not in use."""
    return bool(shutil.which(python)) and subprocess.run([python, "-c", ""], capture_output=True).returncode == 0


def run(*command: object, cwd: Path | None = None, **environment: str) -> str:
    """What a command prints; with all of it, the end of this program if it fails."""
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env={**os.environ, **environment}, capture_output=True, text=True
    )
    if done.returncode != 0:
        sys.exit(f"$ {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def environment(folder: Path, python: str, *packages: object) -> Path:
    """The folder of commands of a new environment with these packages."""
    run(python, "-m", "venv", folder)
    run(folder / "bin" / "pip", "install", "-q", *packages)
    return folder / "bin"


def libraries(wheel: Path, target: str, folder: Path) -> tuple[Path, Path]:
    """The wheel's core and binary of FMUs."""
    names = [str(Path(one).with_suffix(hatch_build.suffix_for(target))) for one in OWN]
    with zipfile.ZipFile(wheel) as archive:
        compiled = {name for name in archive.namelist() if Path(name).suffix in (".so", ".dll", ".dylib")}
        assert compiled == {*names}, f"{wheel.name} has {sorted(compiled)}"
        core, fmu = (Path(archive.extract(name, folder)) for name in names)
    return core, fmu


def exported(binary: lief.Binary) -> set[str]:
    """Names of the functions that a library offers, without those that compilers add to every library."""
    names = {str(getattr(symbol, "name", symbol)) for symbol in binary.exported_functions}
    if isinstance(binary, lief.MachO.Binary):
        names = {name.removeprefix("_") for name in names} - {"_mh_dylib_header", "__dso_handle"}
    return names


def check(library: Path, target: str, functions: set[str]) -> str:
    """Check a library against its target; what it needs, in words."""
    binary, content = lief.parse(str(library)), library.read_bytes()
    kind = next(
        str(getattr(binary.header, n)) for n in ("machine_type", "machine", "cpu_type") if hasattr(binary.header, n)
    )
    processor = {"x86_64": "X86_64|AMD64", "aarch64": "AARCH64|ARM64"}[target.partition("-")[0]]
    assert re.search(processor, kind), f"{library}: {kind}"
    assert exported(binary) == functions, f"{library}: {sorted(exported(binary) ^ functions)}"
    needed = {str(getattr(one, "name", one)).lower() for one in binary.libraries}
    if isinstance(binary, lief.PE.Binary):
        assert all(re.fullmatch(r"kernel32\.dll|api-ms-win-crt-\w+-l1-1-0\.dll", one) for one in needed), needed
    elif isinstance(binary, lief.MachO.Binary):
        assert {one for one in needed if one[0] != "@"} == {"/usr/lib/libsystem.b.dylib"}, needed
        assert hatch_build.macos_needed(content) == 11 and (binary.has_code_signature or "x86_64" in target)
    elif "musl" in target:
        assert needed <= {"libc.so"}, needed
    else:
        assert hatch_build.glibc_needed(content) == hatch_build.OLDEST_GLIBC, needed
    return f"{len(functions)} functions; needs {', '.join(sorted(one for one in needed if one[0] != '@'))}"


def arm_root(folder: Path) -> Path | None:
    """A folder with what Python and musl of Debian for ARM consist of; None on other systems and without QEMU."""
    if not shutil.which(QEMU) or platform.freedesktop_os_release()["ID"] != "debian":
        return None
    for name in ("lists/partial", "archives/partial", "root"):
        (folder / name).mkdir(parents=True)
    (folder / "status").touch()  # nothing is installed
    own = {"State::status": "status", "State::lists": "lists", "Cache::archives": "archives"}
    options = [f"Dir::{key}={folder / name}" for key, name in own.items()]
    options += ["APT::Architecture=arm64", "APT::Architectures=arm64", "APT::Install-Recommends=false"]
    options += ["APT::Sandbox::User=root", "Dir::Cache::pkgcache=", "Dir::Cache::srcpkgcache="]
    apt = ["apt-get", *(word for option in options for word in ("-o", option))]
    run(*apt, "update")
    run(*apt, "install", "-y", "--download-only", "python3", "libstdc++6", "musl")
    for package in sorted((folder / "archives").glob("*.deb")):
        run("dpkg", "-x", package, folder / "root")
    return folder / "root"


def try_on_arm(wheel: Path, root: Path, folder: Path) -> str:
    """Install a wheel with its dependencies for Debian's Python for ARM, and run a scene."""
    python = (QEMU, "-L", root, root / "usr/bin/python3")
    version = run(*python, "-c", "import platform; print(platform.python_version())").strip()
    tags = [f"--platform=manylinux_2_{glibc}_aarch64" for glibc in (17, 27, 28)]
    place = ("--target", folder, "--only-binary=:all:", f"--python-version={version}", *tags)
    run(sys.executable, "-m", "pip", "install", "-q", *place, f"{wheel}[plot]")
    command = ("-m", "film_model", "run", SCENE, "--plot", folder / "impact.png")
    return f"ARM, Python {version}: {largest_force(run(*python, *command, cwd=folder, PYTHONPATH=str(folder)))}"


def largest_force(report: str) -> str:
    """The line of a report that has it."""
    return next(line for line in report.splitlines() if "maximum force" in line)


def check_core(core: Path, target: str, arm: Path | None) -> str:
    """Run tests/core_check.c with a wheel's core, if this machine can; what it prints."""
    before, there = RUNNERS.get(target, ((), ""))
    if arm is not None and target.startswith("aarch64-linux"):
        before, there = (QEMU, "-L", arm), arm
    if not there or not Path(there).exists():
        return "not tried here"
    program = core.with_name("core_check" + (".exe" if core.suffix == ".dll" else ""))
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", target, "-std=c99", "-O1", "-ffp-contract=off")
    link = ["-lm", f"-Wl,-rpath,{core.parent}"] if core.suffix == ".so" else []
    run(*zig, f"-I{platforms.CORE}", "tests/core_check.c", core, *link, "-o", program, cwd=ROOT)
    return run(*before, program, cwd=core.parent, WINEDEBUG="-all").strip()


def write_recipe(output: Path, sources: Path, tools: Path) -> str:
    """Write the recipe of these sources; what rattler-build makes of it on each system."""
    pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project = pyproject["project"]
    conda = [line.lower().replace(">=", " >=") for line in project["dependencies"]]
    text = (ROOT / ".ci" / "recipe.yaml").read_text(encoding="utf-8").partition("\n")[2]
    for name, value in {
        "version": __version__,
        "sha256": hashlib.sha256(sources.read_bytes()).hexdigest(),
        "oldest": project["requires-python"].removeprefix(">="),
        "hatchling": pyproject["build-system"]["requires"][0].replace(">=", " >="),
        "fmpy": project["optional-dependencies"]["fmu"][0].replace(">=", " >="),
        "dependencies": "\n".join(f"    - {line}" for line in conda),
        "summary": project["description"],
    }.items():
        text = text.replace(f"@{name}@", value)
    (output / "recipe.yaml").write_text(text, encoding="utf-8")
    return run(tools / "python", "-c", RENDER, output / "recipe.yaml")


def main() -> None:
    """Build, check and write everything."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("output", type=Path, help="folder, which must not exist")
    output: Path = parser.parse_args().output.resolve()
    if run("git", "status", "--porcelain", cwd=ROOT):
        sys.exit("commit first: a release is made of what git has")
    if not (pythons := [*filter(runs, PYTHONS)]):
        sys.exit(f"none of {', '.join(PYTHONS)} on PATH runs")
    os.environ.pop("PYTHONPATH", None)  # so that new environments find the wheels, not this folder
    output.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as made:
        tmp = Path(made)
        build = (sys.executable, "-m", "hatchling", "build", "-d", output, "-t")
        run(*build, "sdist", cwd=ROOT)
        (sources,) = output.glob("*.tar.gz")
        with tarfile.open(sources) as archive:
            archive.extractall(tmp, filter="data")
        (tree,) = tmp.iterdir()
        tools = environment(tmp / "tools", sys.executable, *TOOLS)
        functions, cores = [exported(lief.parse(str(ROOT / one))) for one in OWN], {}
        for target, tag in hatch_build.TARGETS.items():
            run(*build, "wheel", cwd=tree, FILM_TARGET=target)
            wheel = output / f"film_model-{__version__}-py3-none-{tag}.whl"
            cores[target], fmu = libraries(wheel, target, tmp / tag)
            print(
                f"{tag}: core", check(cores[target], target, functions[0]) + "; FMU", check(fmu, target, functions[1])
            )
            if "gnu" in target and "linux" in target:  # auditwheel judges musl on musl only
                said = run(tools / "auditwheel", "show", wheel)
                assert f'"{tag}"' in said.split("constrains the platform tag to")[-1], said
        run(tools / "twine", "check", "--strict", *output.iterdir())
        print(write_recipe(output, sources, tools))
        for python in pythons:
            bin_ = environment(tmp / python, python, "--find-links", output, f"film-model[plot]=={__version__}")
            force = run(bin_ / "film-model", "run", SCENE, "--plot", tmp / "impact.png", "--force", cwd=tmp)
            print(f"{python}: {largest_force(force)}", flush=True)
        bill = output / f"film-model-{__version__}.cdx.json"
        run(tools / "cyclonedx-py", "environment", bin_ / "python", "--output-reproducible", "-o", bill)
        if (arm := arm_root(tmp / "arm")) is not None:
            wheel = output / f"film_model-{__version__}-py3-none-{hatch_build.TARGETS['aarch64-linux-gnu.2.17']}.whl"
            print(try_on_arm(wheel, arm, tmp / "on_arm"), flush=True)
        for target, core in cores.items():
            print(f"{target}: {check_core(core, target, arm)}", flush=True)
    sums = [f"{hashlib.sha256(one.read_bytes()).hexdigest()}  {one.name}" for one in sorted(output.iterdir())]
    (output / "SHA256SUMS").write_text("\n".join(sums) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

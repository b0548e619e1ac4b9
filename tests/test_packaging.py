"""What is built and published: the tag of a wheel, its typed packages, the citation, the written list of checks."""

import platform
import re
import shutil
import struct
import subprocess
import sys
import tomllib
from pathlib import Path

import lief
import pytest

import hatch_build
from film_model import __version__
from fmu_wrapper import platforms

lief.logging.disable()

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LIBRARIES = [ROOT / hatch_build.LIBRARY, ROOT / platforms.built_library()]
WORKFLOW = ROOT / ".github" / "workflows" / "checks.yml"
linux = pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="needs glibc")
with_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


def newest_glibc(library):
    """The newest version of glibc that an ELF library names, by its table of needed versions."""
    needs = [version for need in library.symbols_version_requirement for version in need.get_auxiliary_symbols()]
    return max(tuple(map(int, need.name.removeprefix("GLIBC_").split("."))) for need in needs)[:2]


def compiled(tmp_path, source, *arguments, name="probe"):
    library = tmp_path / f"lib{name}.so"
    command = ["cc", "-shared", "-fPIC", "-x", "c", "-", "-x", "none", "-o", library, *arguments]
    subprocess.run(command, input=source, text=True, check=True)
    return library


@linux
def test_a_linux_wheel_promises_what_its_libraries_keep():
    tag = hatch_build.wheel_tag([path.read_bytes() for path in LIBRARIES])
    promised = re.fullmatch(r"manylinux_2_(\d+)_(\w+)", tag)
    assert promised, tag
    for path in LIBRARIES:
        library = lief.parse(str(path))
        assert newest_glibc(library) <= (2, int(promised[1]))
        assert set(library.libraries) <= {"libc.so.6", "libm.so.6"}
        assert library.header.machine_type.name.lower() == promised[2]


def test_wheels_of_other_systems_promise_what_they_are_compiled_for():
    """.ci/release.py compares the libraries with their tags; FMUs are compiled for the same systems."""
    glibc, macos = ("_".join(map(str, hatch_build.OLDEST_GLIBC)), hatch_build.OLDEST_MACOS.replace(".", "_"))
    for target, tag in hatch_build.TARGETS.items():
        processor, system, *_ = target.split("-")
        named = {"x86_64": "x86_64|amd64", "aarch64": "aarch64|arm64"}[processor]
        libc = "musllinux_1_2" if target.endswith("musl") else f"manylinux_{glibc}"
        oldest = {"linux": libc, "windows": "win"}.get(system.partition(".")[0], f"macosx_{macos}")
        assert re.fullmatch(f"{oldest}_({named})", tag), target
    assert {platforms.PLATFORMS[name].target for name in platforms.EVERYWHERE} <= hatch_build.TARGETS.keys()


@linux
@pytest.mark.skipif(platforms.this_platform() not in platforms.PLATFORMS, reason="old versions are named for these")
def test_libraries_load_with_the_oldest_glibc():
    assert hatch_build.wheel_tag([path.read_bytes() for path in LIBRARIES]).startswith("manylinux_2_17_")


@linux
@with_compiler
def test_a_newer_function_asks_for_a_newer_glibc(tmp_path):
    library = compiled(tmp_path, "#include <math.h>\ndouble f(double x) { return pow(x, x); }\n", "-lm")
    newest = newest_glibc(lief.parse(str(library)))
    assert hatch_build.glibc_needed(library.read_bytes()) == max(newest, hatch_build.OLDEST_GLIBC)
    tag = hatch_build.wheel_tag([LIBRARIES[0].read_bytes(), library.read_bytes()])
    assert tag.startswith("manylinux_{}_{}_".format(*max(newest, hatch_build.OLDEST_GLIBC)))


@linux
@with_compiler
def test_a_library_of_another_package_is_not_promised(tmp_path):
    other = compiled(tmp_path, "int g(void) { return 1; }\n", name="other")
    library = compiled(tmp_path, "int g(void);\nint f(void) { return g(); }\n", other)
    assert hatch_build.glibc_needed(library.read_bytes()) is None
    assert hatch_build.wheel_tag([LIBRARIES[0].read_bytes(), library.read_bytes()]) == hatch_build.platform_tag()


LC_VERSION_MIN_MACOSX, LC_UUID, LC_BUILD_VERSION = 0x24, 0x1B, 0x32
MACOS = 1


@pytest.mark.parametrize(
    ("major", "minor", "expected"), [(10, 9, 11), (10, 15, 11), (11, 0, 11), (12, 0, 12), (12, 3, 13), (14, 0, 14)]
)
def test_the_oldest_macos_is_read_from_the_library(major, minor, expected):
    version = major << 16 | minor << 8
    first = struct.pack("<2I16x", LC_UUID, 24)
    for command in (
        struct.pack("<6I", LC_BUILD_VERSION, 24, MACOS, version, 20 << 16, 0),
        struct.pack("<4I", LC_VERSION_MIN_MACOSX, 16, version, 20 << 16),
    ):
        header = struct.pack("<8I", 0xFEEDFACF, 0x0100000C, 0, 6, 2, len(first) + len(command), 0, 0)
        assert hatch_build.macos_needed(header + first + command) == expected
    assert hatch_build.macos_needed(struct.pack(">8I", 0xCAFEBABE, 2, 0, 0, 0, 0, 0, 0)) is None  # two processors


def test_a_compiler_for_another_processor_is_not_used(tmp_path):
    assert not hatch_build.works([str(tmp_path / "missing")])
    assert not hatch_build.works([sys.executable, "-c", "pass"])  # ends well, and has built nothing that loads


def test_every_installed_package_is_typed():
    for package in PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]:
        assert (ROOT / package / "py.typed").is_file(), package


def test_the_extra_all_names_extras_that_exist():
    """All that users want, without `engines`, 500 MB for comparisons in other engines, and `ansys`, 800 MB."""
    extras = PROJECT["project"]["optional-dependencies"]
    (everything,) = extras["all"]
    named = re.fullmatch(r"film-model\[([\w,-]+)\]", everything)[1].split(",")
    assert set(named) == extras.keys() - {
        "all",
        "ansys",
        "docs",
        "engines",
        "interop",
        "jax",
        "test",
        "benchmark",
        "dev",
    }


def test_the_citation_is_of_this_version():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    released = re.search(r'^version: (.*)\ndate-released: "(.*)"$', citation, re.MULTILINE).groups()
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert released == re.search(r"^## \[([0-9.]+)\] - (\S+)$", changelog, re.MULTILINE).groups()
    bibliography = (ROOT / "docs" / "paper" / "paper.bib").read_text(encoding="utf-8")
    assert released[0] == __version__ == re.search(r"version = \{(.*)\}", bibliography)[1]
    assert "10.1177/0954406216628556" in citation


def test_the_workflow_runs_every_python_that_is_promised():
    promised = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["project"]["classifiers"]))
    tested = re.search(r"python: \[(.*)\]", WORKFLOW.read_text(encoding="utf-8"))[1]
    assert re.findall(r"3\.\d+", tested) == promised


def test_checks_that_are_written_down_are_those_that_are_run():
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    runs = (ROOT / ".ci" / "run").read_text(encoding="utf-8") + (ROOT / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"^\$ (.*?)(?:\s+#.*)?$", guide, re.MULTILINE)
    assert len(commands) > 5
    assert not [c for c in commands if c not in runs and c not in (".ci/run", ".venv/bin/pre-commit install")]


@with_compiler
def test_what_is_up_to_date_is_not_compiled_again(tmp_path):
    """Another compiler option, a changed source, header or library is; the same ones are not."""
    hook = hatch_build.CustomBuildHook(str(tmp_path), {}, None, None, str(tmp_path), "wheel")
    core = tmp_path / hatch_build.CORE
    core.mkdir(parents=True)
    source, header, library = core / "film_one.c", core / "film_one.h", core / "_film_one.so"
    header.write_text("int film_one(void);\n")

    def built(number, *options):
        """Whether it was compiled."""
        source.write_text(f'#include "film_one.h"\nint film_one(void) {{ return {number}; }}\n')
        before = library.stat().st_ino if library.exists() else None
        command = ["cc", *hatch_build.FLAGS, *hatch_build.SHARED, *options, f"{hatch_build.CORE}/film_one.c"]
        hook.run(command, f"{hatch_build.CORE}/_film_one.so", ())
        return library.stat().st_ino != before

    assert built(1) and not built(1)
    assert built(2) and not built(2)
    assert built(2, "-g1") and not built(2, "-g1")
    header.write_text("int film_one(void);  /* one */\n")
    assert built(2, "-g1") and not built(2, "-g1")
    library.write_bytes(library.read_bytes() + b"\0")
    assert built(2, "-g1") and not built(2, "-g1")
    library.unlink()
    assert built(2, "-g1")

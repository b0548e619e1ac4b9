"""The binary of FMUs: its functions and dependencies, its sources, and other platforms."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from cases import scene

import hatch_build
from film_model.cli.main import main
from fmu_wrapper import export, platforms, resource
from fmu_wrapper.layout import DAMPING, MODEL, SCALING, SHAPED, Data
from fmu_wrapper.variables import NORMAL_STATES, STATES, VARIABLES, settable

lief = pytest.importorskip("lief")
lief.logging.disable()

ROOT = Path(__file__).resolve().parent.parent
FOUND = platforms.can_cross_compile  # before conftest.py replaces it
LIBRARY = platforms.ROOT / platforms.built_library()
HOST = ROOT / "tests" / "fmu_host.c"
OLDEST_GLIBC = (2, 17)
WRITABLE = (".data", ".bss", ".tdata", ".tbss", "COMMON")
STEPS, STOP = 24, 1.2e-4  # s; the contact takes 82 microseconds
FOLDER = "résultats d'été %20"


def fmi_functions():
    """The names of all functions that the headers of FMI 2.0 and 3.0 declare."""
    names = []
    for version in (2, 3):
        text = (platforms.fmi_headers() / f"fmi{version}Functions.h").read_text()
        names += re.findall(rf"^\s*FMI{version}_Export\s+\w+TYPE\s+(\w+);", text, re.MULTILINE)
    assert len(names) > 110
    return set(names)


def exported(binary):
    """Names of the functions that a library offers, without those that compilers add to every library."""
    names = {str(getattr(symbol, "name", symbol)) for symbol in binary.exported_functions}
    if isinstance(binary, lief.MachO.Binary):
        names = {name.removeprefix("_") for name in names} - {"_mh_dylib_header", "__dso_handle"}
    return names


def needs(binary):
    """Libraries, and on Linux the newest version of glibc."""
    libraries = {str(getattr(library, "name", library)).lower() for library in binary.libraries}
    newest = (0,)
    if isinstance(binary, lief.ELF.Binary):
        for symbol in binary.imported_symbols:
            if symbol.has_version and symbol.symbol_version.has_auxiliary_version:
                name = str(symbol.symbol_version.symbol_version_auxiliary.name)
                assert name.startswith("GLIBC_"), name
                newest = max(newest, tuple(map(int, name.removeprefix("GLIBC_").split("."))))
    return libraries, newest


def check_library(path):
    """Assert that a library exports the functions of FMI alone and needs the system's C library alone."""
    binary = lief.parse(str(path))
    assert exported(binary) == fmi_functions()
    libraries, newest = needs(binary)
    if isinstance(binary, lief.ELF.Binary):
        assert libraries <= {"libc.so.6", "libm.so.6"}
        assert (2, 2) <= newest <= OLDEST_GLIBC
    elif isinstance(binary, lief.PE.Binary):
        assert all(name == "kernel32.dll" or name.startswith("api-ms-win-crt-") for name in libraries), libraries
    else:
        assert {name for name in libraries if not name.startswith("@rpath/")} == {"/usr/lib/libsystem.b.dylib"}


def test_the_binary_has_all_functions_and_needs_an_old_c_library_only():
    check_library(LIBRARY)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_the_runtime_has_no_global_variables(tmp_path):
    for source in platforms.SOURCES:
        includes = [f"-I{ROOT / folder}" for folder in platforms.INCLUDES]
        built = tmp_path / "object.o"
        headers = f"-I{platforms.fmi_headers()}"
        subprocess.run(["cc", *platforms.FLAGS, *includes, headers, "-c", ROOT / source, "-o", built], check=True)
        binary = lief.parse(str(built))
        writable = [s for s in binary.sections if s.name.startswith(WRITABLE) and ".rel.ro" not in s.name]
        assert writable and not any(section.size for section in writable), source


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "version"), [("impact", 3), ("contact", 2)])
def test_compiled_sources_equal_the_shipped_binary(kind, version, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    if shutil.which("cmake") is None or shutil.which("cc") is None:
        pytest.skip("needs CMake and a C compiler")
    fmpy = pytest.importorskip("fmpy")
    build = pytest.importorskip("fmpy.build")
    fmu = export(scene("stronge", "plate"), tmp_path / "case.fmu", version, kind=kind, with_sources=True)
    shipped, compiled = tmp_path / "shipped", tmp_path / "compiled"
    fmpy.extract(fmu, shipped)
    fmpy.extract(fmu, compiled)
    (binary,) = (compiled / "binaries").glob("*/*")
    before = binary.read_bytes()
    (tmp_path / "build").mkdir()
    build.build_platform_binary(compiled, tmp_path / "build")
    assert binary.read_bytes() != before
    results = [simulated(fmpy, folder, kind) for folder in (shipped, compiled)]
    assert results[0].dtype.names == results[1].dtype.names
    for name in results[0].dtype.names:
        np.testing.assert_allclose(results[1][name], results[0][name], rtol=1e-13, atol=0.0)
    assert results[0]["contact_force"].max() > 100.0


def simulated(fmpy, folder, kind):
    """Outputs over one contact; kind contact follows a prescribed indentation."""
    given = None
    if kind == "contact":
        time = np.linspace(0.0, STOP, 5 * STEPS + 1)
        depth, rate = 1e-5 * np.sin(np.pi * time / STOP), 1e-5 * np.pi / STOP * np.cos(np.pi * time / STOP)
        names = [("time", float), ("indentation", float), ("relative_velocity", float)]
        given = np.array(list(zip(time, depth, rate, strict=True)), dtype=names)
    return fmpy.simulate_fmu(
        str(folder), stop_time=STOP, output_interval=STOP / STEPS, fmi_type="CoSimulation", input=given
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with resources in a subfolder with special characters in its name, and their token."""
    where = tmp_path_factory.mktemp("host")
    fmu = export(scene("stronge", "plate"), where / "case.fmu")
    (where / FOLDER).mkdir()
    with zipfile.ZipFile(fmu) as archive:
        content = archive.read(f"resources/{resource.NAME}")
    (where / FOLDER / resource.NAME).write_bytes(content)
    (where / resource.NAME).write_bytes(content)
    return where, resource.read(content).token.decode()


def run_host(name, compiler, library, folder, before=(), drive=""):
    """Outputs at each step that the host prints; it runs FMI 3.0 and FMI 2.0, each twice, with equal results."""
    where, token = folder
    suffix = ".exe" if library.suffix == ".dll" else ""
    program, extra = where / f"host-{name}{suffix}", () if suffix else ("-ldl",)
    headers = [f"-I{platforms.fmi_headers()}", f"-I{ROOT / platforms.RUNTIME}"]
    subprocess.run([*compiler, "-std=gnu99", "-O1", *headers, HOST, "-o", program, *extra], check=True)
    uri = f"file://{drive}{where}"
    command = [*before, program, f"./{library.name}", token, uri, str(STOP), str(STEPS)]
    done = subprocess.run(command, cwd=where, capture_output=True, text=True, errors="replace")
    assert done.returncode == 0, done.stdout + done.stderr
    lines = [line for line in done.stdout.splitlines() if "{none}" not in line]
    assert done.stdout.count('token "{none}" must be') == 2
    rows = np.array([line.split() for line in lines], dtype=float).reshape(4, STEPS, -1)
    for other in rows[1:]:
        np.testing.assert_array_equal(other, rows[0])
    return rows[0]


@pytest.fixture(scope="module")
def native(folder):
    if shutil.which("cc") is None:
        pytest.skip("needs a C compiler")
    library = folder[0] / f"native{LIBRARY.suffix}"
    shutil.copy(LIBRARY, library)
    return run_host("native", ["cc"], library, folder)


@pytest.mark.slow
def test_an_importer_in_c_gets_the_results(native):
    names = [v.name for v in VARIABLES]
    shown = names[names.index("indentation") : names.index("contact_force") + 1]
    shown += names[names.index("time_of_last_event") : names.index("permanent_indentation") + 1]
    column = dict(zip(shown, native.T, strict=True))
    assert column["contact_force"].max() > 100.0 and column["contact_force"][-1] == 0.0
    assert 5e-5 < column["time_contact_ends"][-1] < STOP and column["rebound_velocity"][-1] < 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", platforms.EVERYWHERE)
def test_every_platform(name, folder, native):
    pytest.importorskip("ziglang")
    where = folder[0]
    platform = platforms.PLATFORMS[name]
    library = where / f"{name}{platform.suffix}"
    library.write_bytes(platforms.cross_compile(name))
    check_library(library)
    binary = lief.parse(str(library))
    processor = {"x86_64": "X86_64|AMD64", "aarch64": "AARCH64|ARM64"}[name.split("-")[0]]
    kinds = (getattr(binary.header, name, "") for name in ("machine_type", "machine", "cpu_type"))
    assert re.search(processor, " ".join(map(str, kinds)))
    if isinstance(binary, lief.MachO.Binary):
        major, minor, _ = binary.build_version.minos
        assert (major, minor) == (11, 0) and hatch_build.macos_needed(library.read_bytes()) == 11
    runners = {
        "x86_64-linux": ([], ""),
        "aarch64-linux": (["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], ""),
        "x86_64-windows": (["wine"], "/Z:"),
    }
    if name not in runners:  # macOS: nothing emulates it
        return
    before, drive = runners[name] if name != platforms.this_platform() else ([], "")
    if platforms.this_platform() != "x86_64-linux" or (before and shutil.which(before[0]) is None):
        pytest.skip("the library is right, but nothing here runs it")
    if "-L" in before and not Path(before[-1]).exists():
        pytest.skip(f"the library is right, but {before[-1]} is missing")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", platform.target]
    found = run_host(name, zig, library, folder, before, drive)
    assert np.all(np.abs(found - native) <= 1e-12 * np.abs(native).max(axis=0))


@pytest.mark.slow
@pytest.mark.parametrize("options", [{}, {"platform": "all"}], ids=["default", "all"])
def test_one_fmu_for_all_platforms(options, tmp_path, monkeypatch):
    """By default too, where zig is installed; this machine's binary is the package's."""
    pytest.importorskip("ziglang")
    monkeypatch.setattr(platforms, "can_cross_compile", FOUND)
    assert platforms.can_cross_compile()
    for version in (2, 3):
        fmu = export(scene("hertz"), tmp_path / f"all{version}.fmu", version, **options)
        with zipfile.ZipFile(fmu) as archive:
            binaries = {name: archive.read(name) for name in archive.namelist() if name.startswith("binaries/")}
        expected = {
            f"binaries/{platforms.folder(name, version)}/impact{platform.suffix}": name
            for name, platform in platforms.PLATFORMS.items()
            if name in platforms.EVERYWHERE
        }
        assert sorted(binaries) == sorted(expected)
        own = next(at for at, name in expected.items() if name == platforms.this_platform())
        assert binaries[own] == LIBRARY.read_bytes()


def test_without_zig_an_fmu_has_one_binary_and_says_so(tmp_path, monkeypatch, capsys, export_undrawn):
    monkeypatch.setattr("fmu_wrapper.export", export_undrawn)
    path, own = tmp_path / "case.fmu", platforms.this_platform()
    arguments = ["export-fmu", str(ROOT / "examples/scenes/tungsten_carbide_on_steel.toml"), "--output", str(path)]
    assert main(arguments) == 0
    said = f"its binary is for {own} only: those for four other systems need pip install"
    assert said in capsys.readouterr().err
    with zipfile.ZipFile(path) as archive:
        (binary,) = (name for name in archive.namelist() if name.startswith("binaries/"))
    assert f"/{platforms.folder(own, 3)}/" in binary
    assert main([*arguments, "--force", "--platform", own]) == 0
    assert said not in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("name", ["x86_64-linux", "x86_64-windows", "aarch64-darwin"])
def test_zig_compiles_hardly_more_than_our_sources(name, tmp_path, monkeypatch):
    """A first export takes seconds: zig assembles lists of Linux's functions, and compiles one library for Windows.

    With the startup code of mingw-w64 zig would compile hundreds of files.
    """
    pytest.importorskip("ziglang")
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("ZIG_LOCAL_CACHE_DIR", str(tmp_path / "local"))
    platforms.cross_compile(name)
    compiled = [path.name for path in (tmp_path / "cache").rglob("*") if path.suffix in (".o", ".obj")]
    assert any("compiler_rt" in one for one in compiled) == name.endswith("windows")
    assert len(compiled) <= {"linux": 40, "windows": 1, "darwin": 0}[name.split("-")[1]]


def test_lists_of_parameters_are_as_long_as_the_arrays_of_the_runtime():
    lists = {
        "SCALINGS": SCALING,
        "DAMPINGS": DAMPING,
        "SHAPE_POWERS": SHAPED,
        "STATES": STATES,
        "NORMAL_STATES": NORMAL_STATES,
    }
    assert {name: MODEL.numbers[name] for name in lists} == {name: len(names) for name, names in lists.items()}
    assert len(Data().start) == settable()

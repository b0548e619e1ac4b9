"""The order of the house: imports go down the ladder of packages, no file imports itself in a circle, and files and
functions are short enough to read."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LADDER = (
    *("version", "base", "core", "laws", "targets", "scene", "problem", "effects", "oblique", "solve"),
    *("jax", "studies", "translate"),
    *("plot", "film_datasets", "methods", "fmu_wrapper", "explorer", "cli"),
)
"""Every package, from the bottom; each imports only from itself and from those before it."""

FACES = {"film_model": "methods", "film_model.face": "methods"}
"""`import film_model`, the public face, counts as an import of the last package that it shows."""

CORE = "film_model/core/"
CORE_LADDER = ("curve", "march", "tables", "oblique", "lanes", "batch", "modal", "plate", "relax", "chain")
"""Folders of the core, from the bottom; a file includes and calls what is in its own folder and in those before it."""

LONGEST_FILE, LONGEST_FUNCTION, MOST_FILES = 400, 60, 20

EXCEPTIONS = {
    "film_model/studies/modal_reference.py integrate": "events and restarts of the integrator share its local state",
}
"""A file, or a file and a function as in "film_model/core/march/film_march.c plan" → why it is longer. At most six."""

SOURCES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for folder in ("film_model", "datasets/film_datasets", "fmu_wrapper")
    for pattern in ("*.py", "*.c", "*.h")
    for path in sorted((ROOT / folder).rglob(pattern))
}
MODULES = {
    file.removeprefix("datasets/").removesuffix(".py").removesuffix("/__init__").replace("/", "."): ast.parse(text)
    for file, text in SOURCES.items()
    if file.endswith(".py")
}


def imported(module):
    """Our own modules that a module imports anywhere in it: in functions and under TYPE_CHECKING too."""
    for node in ast.walk(MODULES[module]):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{module}: a relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found = [name if name in MODULES else node.module for name in names]
        else:
            continue
        yield from (name for name in found if name in MODULES)


def package(module):
    """The rung of a module: a package of film_model, or another package."""
    if module in FACES:
        return FACES[module]
    first, *rest = module.split(".")
    return rest[0] if first == "film_model" else first


def test_every_package_is_on_the_ladder():
    assert {package(m) for m in MODULES if m not in ("film_model", "film_model.__main__")} == set(LADDER)


@pytest.mark.parametrize("module", [m for m in MODULES if m not in ("film_model", "film_model.__main__")])
def test_imports_go_down_the_ladder(module):
    above = [name for name in imported(module) if LADDER.index(package(name)) > LADDER.index(package(module))]
    assert not above, f"{module} imports {', '.join(above)}"


def test_a_class_names_what_is_above_it_only_through_methods():
    """The strings of `Late` are the one way up the ladder, and `film_model.methods` the one place they lead to."""
    calls = [node for tree in MODULES.values() for node in ast.walk(tree) if isinstance(node, ast.Call)]
    places = [ast.literal_eval(node.args[0]) for node in calls if getattr(node.func, "id", "") == "Late"]
    written = {node.name for node in MODULES["film_model.methods"].body if isinstance(node, ast.FunctionDef)}
    assert places
    assert {place.removeprefix("film_model.methods:") for place in places} <= written


def test_no_file_imports_itself_in_a_circle():
    """Files are peeled off from below: what is left when nothing can be peeled imports itself."""
    left = {module: set(imported(module)) - {module} for module in MODULES}
    while ready := [module for module, needs in left.items() if not needs & left.keys()]:
        for module in ready:
            del left[module]
    assert not left, f"circles among {', '.join(sorted(left))}"


@pytest.mark.slow
def test_the_export_of_fmus_does_not_need_datasets():
    needed, found = ["fmu_wrapper.exporting"], set()
    while needed:
        module = needed.pop()
        if module not in found:
            found.add(module)
            needed += imported(module)
    assert not [module for module in found if module.startswith("film_datasets")]


C_SOURCES = {
    file.removeprefix(CORE): re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    for file, text in SOURCES.items()
    if file.startswith(CORE) and file.endswith((".c", ".h")) and file != f"{CORE}film_core.h"
}
DEFINITION = re.compile(r"^(?!static)[a-zA-Z][^;{}#=()]*?\b(film_\w+)\([^;{}]*\)\s*\{.*$", re.MULTILINE)
DEFINED = {name: file for file, text in C_SOURCES.items() for name in DEFINITION.findall(text)}


def called(file):
    """Functions of other files of the core that a C file calls, by name: bodies only, not declarations."""
    bodies = re.findall(r"^[^\s#/}][^\n]*\{$(.*?)^\}", C_SOURCES[file], re.MULTILINE | re.DOTALL)
    names = re.findall(r"\b(film_\w+)(?=\()", "".join(bodies))
    return {name for name in names if DEFINED.get(name, file) != file}


def floor(file):
    return CORE_LADDER.index(file.split("/")[0])


def test_every_folder_of_the_core_is_on_its_ladder():
    assert {file.split("/")[0] for file in C_SOURCES} == set(CORE_LADDER)
    for folder in CORE_LADDER:
        assert sum(file.startswith(f"{folder}/") for file in C_SOURCES) <= MOST_FILES, folder


@pytest.mark.parametrize("file", C_SOURCES)
def test_includes_and_calls_of_the_core_go_down(file):
    included = re.findall(r'^#include "(.+)"', C_SOURCES[file], re.MULTILINE)
    above = [name for name in included if name != "film_core.h" and floor(name) > floor(file)]
    above += [name for name in called(file) if floor(DEFINED[name]) > floor(file)]
    assert not above, f"{file} includes or calls {', '.join(above)}"


def test_no_file_of_the_core_calls_itself_in_a_circle():
    left = {file: {DEFINED[name] for name in called(file)} for file in C_SOURCES}
    while ready := [file for file, needs in left.items() if not needs & left.keys()]:
        for file in ready:
            del left[file]
    assert not left, f"circles among {', '.join(sorted(left))}"


def test_calls_of_the_core_are_seen():
    """Or the patterns above would find no call that goes up."""
    assert {"film_next_line", "film_follow", "film_turning_point"} <= called("march/film_aim.c")
    assert "film_law_in_series" in called("curve/film_law.h") and "film_marched" in called("lanes/film_lanes.h")


def long_files():
    return {file for file, text in SOURCES.items() if text.count("\n") > LONGEST_FILE}


def long_functions():
    found = set()
    for file, text in SOURCES.items():
        if file.endswith(".py"):
            spans = [
                (node.name, node.end_lineno - node.lineno + 1)
                for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.FunctionDef)
            ]
        else:  # a definition begins at the margin and ends with a brace at the margin
            whole = re.finditer(r"^[a-zA-Z][^;{}#=]*?(\w+)\([^;{}]*\)\s*\{$.*?^\}", text, re.MULTILINE | re.DOTALL)
            spans = [(match[1], match[0].count("\n") + 1) for match in whole]
        found |= {f"{file} {name}" for name, length in spans if length > LONGEST_FUNCTION}
    return found


def test_files_and_functions_are_short():
    assert long_files() | long_functions() == set(EXCEPTIONS)
    assert len(EXCEPTIONS) <= 6


def test_functions_of_c_are_seen():
    """Or the pattern above would find no function too long."""
    text = SOURCES["film_model/core/march/film_march.c"]
    names = re.findall(r"^[a-zA-Z][^;{}#=]*?(\w+)\([^;{}]*\)\s*\{$", text, re.MULTILINE)
    assert {"film_step", "film_record"} <= set(names)


def test_only_native_loads_the_core():
    for file, text in SOURCES.items():
        assert "CDLL" not in text or file.startswith(("film_model/core/native", "fmu_wrapper/")), file


def test_pint_is_found_in_one_place():
    found = [m for m, tree in MODULES.items() if any(name.split(".")[0] == "pint" for name in all_imports(tree))]
    assert set(found) <= {"film_model.base.units", "film_model.base.unit_symbols"}


def all_imports(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def test_the_datasets_folder_is_not_a_package():
    assert not (ROOT / "datasets" / "__init__.py").exists()

"""Rules of the project's own structure."""

import ast
from pathlib import Path

ROOT = Path(__file__).parent.parent


def imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def test_the_library_does_not_import_what_is_built_on_it():
    for path in (ROOT / "film_model").rglob("*.py"):
        if path.name not in ("cli.py", "commands.py"):
            assert not [name for name in imports(path) if name.split(".")[0] in ("film_datasets", "fmu_wrapper")], path


def test_only_native_loads_the_core():
    for path in (ROOT / "film_model").rglob("*.py"):
        if path.name != "native.py" and "ctypes" in set(imports(path)):
            text = path.read_text(encoding="utf-8")
            assert "CDLL" not in text, path


def test_the_datasets_folder_is_not_a_package():
    assert not (ROOT / "datasets" / "__init__.py").exists()


def test_pint_is_found_in_one_place():
    found = [p.name for p in (ROOT / "film_model").rglob("*.py") if any(n.split(".")[0] == "pint" for n in imports(p))]
    assert set(found) <= {"units.py", "unit_symbols.py"}

"""docs/architecture.md names files, functions and tables that exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ("architecture", "adding_a_target", "adding_a_result")


@pytest.mark.parametrize("page", PAGES)
def test_files_and_functions_exist(page):
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    named = re.findall(r"`([a-z_]+(?:/[a-z_]+)+(?:\.[a-z]+)?)(?:: ([A-Za-z_.]+))?`", text)
    assert named
    for path, member in named:
        own = [root / path for root in (ROOT, ROOT / "film_model") if (root / path).exists()]
        assert own or path == "film_model/targets/mount.py", path
        for name in member.split(".") if member else ():
            assert re.search(rf"^ *(?:def|class) {name}\b", own[0].read_text(encoding="utf-8"), re.MULTILINE), member


def test_every_package_is_listed():
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    packages = [path.parent.relative_to(ROOT).as_posix() for path in (ROOT / "film_model").glob("*/__init__.py")]
    packages += [path.name for path in (ROOT / "film_model/core").iterdir() if any(path.glob("*.c"))]
    listed = re.findall(r"^\| `([a-z_/]+)` \|", text, re.MULTILINE)
    assert set(listed) == {*packages, "film_datasets", "fmu_wrapper"}

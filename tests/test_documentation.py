"""The examples in public docstrings, and the links between pages."""

import doctest
import inspect
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import film_datasets as fd
import film_model as fm
import fmu_wrapper

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md"))]
FACES = (fm, fd, fmu_wrapper)
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def documented():
    """The public classes and functions whose docstrings have examples, and public methods of those classes."""
    for face in FACES:
        for name in face.__all__:
            thing = getattr(face, name)
            if inspect.isclass(thing) or inspect.isfunction(thing):
                members = vars(thing).values() if inspect.isclass(thing) else ()
                for each in (thing, *(m for m in members if inspect.isfunction(m))):
                    if ">>>" in (each.__doc__ or ""):
                        yield pytest.param(each, id=f"{face.__name__}.{each.__qualname__}")


@pytest.mark.slow
@pytest.mark.parametrize("thing", list(documented()))
def test_examples_in_docstrings(thing, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    (tmp_path / "measured.csv").write_text("velocity [m/s], restitution\n0.2, 0.61\n0.5, 0.50\n1, 0.42\n")
    (tmp_path / "hertz-half-space-0.4.csv").write_text("time [us], contact_force [N]\n0, 0\n10, 50\n20, 90\n")
    known = {"fm": fm, "fd": fd, "fmu_wrapper": fmu_wrapper, "scene": scene}
    runner, said = doctest.DocTestRunner(optionflags=FLAGS), []
    for test in doctest.DocTestFinder(recurse=False).find(thing, globs=known):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fm.ImpactWarning)
            runner.run(test, out=said.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)
    assert runner.tries > 0


def test_public_functions_have_examples():
    named = {parameter.id for parameter in documented()}
    functions = [f"{face.__name__}.{n}" for face in FACES for n in face.__all__ if inspect.isfunction(getattr(face, n))]
    without = {name.rpartition(".")[2] for name in functions} - {name.rpartition(".")[2] for name in named}
    shown_with_others = {"compare_laws", "export", "export_ssp", "lines_of", "open", "published", "read"}
    assert without == shown_with_others


@pytest.mark.slow
def test_functions_are_not_hidden_by_the_files_of_their_name():
    """A new process: importing fmu_wrapper/check.py for `Report` would set `fmu_wrapper.check` to the file."""
    code = "import fmu_wrapper; fmu_wrapper.Report; print(callable(fmu_wrapper.check), callable(fmu_wrapper.export))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "True"]


def anchors(page):
    """The anchors of a page's headings, as GitHub and MyST make them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if not link.startswith(("http://", "https://")):
            path, _, anchor = link.partition("#")
            target = page.parent / path if path else page
            assert target.exists(), link
            assert not anchor or anchor in anchors(target), link


def test_fractions_have_braces():
    """The site's formulas are by docutils, which reads \\frac12 x as 12/x."""
    for page in PAGES:
        assert not re.findall(r"\\[dt]?frac\d\d", page.read_text(encoding="utf-8")), page

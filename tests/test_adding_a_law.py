"""The law of docs/adding_a_law.md, registered: pictures, pages, scenes, lists and FMUs contain it."""

import importlib.util
import json
import re
import sys
from pathlib import Path

import pytest

import film_model as fm
import fmu_wrapper
from film_model.cli.main import main
from film_model.laws import LAWS
from film_model.studies import quadrature
from film_model.studies.law_gallery import gallery_loops, gallery_scene

ROOT = Path(__file__).parents[1]
BALL = str(ROOT / "examples" / "scenes" / "tungsten_carbide_on_steel.toml")
CONTACT = {"contact.law": "bilinear", "contact.stiffness": "50 N/um", "contact.yield_force": "300 N"}


def loaded(name, path, monkeypatch):
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def bilinear(tmp_path, monkeypatch):
    """The law, as if its name stood in the list."""
    guide = (ROOT / "docs" / "adding_a_law.md").read_text(encoding="utf-8")
    code = re.findall(r"```python\n(.*?)```", guide, re.DOTALL)[0]
    (tmp_path / "bilinear.py").write_text(code, encoding="utf-8")
    law = loaded("bilinear", tmp_path / "bilinear.py", monkeypatch).Bilinear
    monkeypatch.setitem(LAWS, law.name, law)
    return law


@pytest.mark.slow
def test_it_is_simulated_and_exact(bilinear):
    scene = gallery_scene("bilinear")
    history = fm.simulate(scene, accuracy=1e-9)
    exact = quadrature.quadrature(scene.contact.law, scene.mass, scene.approach_velocity)
    for name in ("maximum_force", "contact_duration", "permanent_indentation", "rebound_velocity"):
        assert history.summary[name] == pytest.approx(exact[name], rel=1e-9), name
    assert gallery_loops()["bilinear"].restitution == pytest.approx(exact["coefficient_of_restitution"], rel=1e-5)


@pytest.mark.slow
def test_pages_and_pictures_contain_it(bilinear, tmp_path, monkeypatch, capsys):
    pages = loaded("reference_pages", ROOT / "examples" / "reference_pages.py", monkeypatch)
    assert "- springs: `walton-braun`, `luding`, `bilinear`\n" in pages.families()
    assert "| `yield_force` | F_y (force) |" in pages.laws_page()
    plot = pytest.importorskip("film_model.plot")
    pytest.importorskip("matplotlib")
    figure = plot.plot_laws(tmp_path / "laws.png", dpi=30)
    assert [panel.get_title(loc="left") for panel in figure.axes if panel.axison] == list(LAWS)
    assert main(["laws", "--json"]) == 0
    assert "bilinear" in [row["name"] for row in json.loads(capsys.readouterr().out)["laws"]]


def test_scenes_and_comparisons_contain_it(bilinear, capsys):
    scene = fm.Scene.from_toml(BALL).replace(CONTACT)
    assert scene.contact.law_name == "bilinear"
    with pytest.raises(fm.SceneError, match="hardening: 2 must be < 1"):
        scene.replace({"contact.hardening": 2.0})
    assert main(["explain", BALL, "--law", "all"]) == 0
    assert "bilinear (stiffness, yield_force)" in capsys.readouterr().out


@pytest.mark.slow
def test_an_fmu_agrees_with_the_library(bilinear, tmp_path):
    pytest.importorskip("fmpy")
    path = fmu_wrapper.export(fm.Scene.from_toml(BALL).replace(CONTACT), tmp_path / "impact.fmu")
    report = fmu_wrapper.check(path)
    assert report.good, report

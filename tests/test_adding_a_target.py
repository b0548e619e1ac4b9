"""The target of docs/adding_a_target.md, registered: scene files, batches, sweeps and explanations take it."""

import importlib.util
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import film_model as fm
from film_model.cli.main import main
from film_model.solve.batch import STATUSES, simulate_many
from film_model.targets import TARGETS

GUIDE = (Path(__file__).parents[1] / "docs" / "adding_a_target.md").read_text(encoding="utf-8")
BALL = '[impactor]\nradius = "5 mm"\nvelocity = "0.2 m/s"\nmaterial = "bearing steel"\n'
LAW = '[contact]\nlaw = "hertz"\n'


@pytest.fixture
def mount(tmp_path, monkeypatch):
    """The class, as if its name stood in the list."""
    path = tmp_path / "mount.py"
    path.write_text(re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)[0], encoding="utf-8")
    spec = importlib.util.spec_from_file_location("mount", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "mount", module)
    spec.loader.exec_module(module)
    monkeypatch.setitem(TARGETS, module.Mount.kind, module.Mount)
    return module.Mount


def on_mount(mass, stiffness):
    target = f'[target]\nkind = "mount"\nmaterial = "mild steel"\nmass = "{mass}"\nstiffness = "{stiffness}"\n'
    return fm.Scene.from_text(BALL + target + LAW).replace({"effects.gravity": False})


def test_scene_files_read_and_write_it(mount):
    section = re.findall(r"```toml\n(.*?)```", GUIDE, re.DOTALL)[0]
    scene = fm.Scene.from_text(BALL + section + LAW)
    assert scene.target == mount("mild steel", "2 kg", "50 kN/m")
    assert fm.Scene.from_text(scene.to_toml()) == scene
    with pytest.raises(fm.SceneError, match=r"target\.stiffness: missing: a stiffness is needed"):
        fm.Scene.from_text(BALL + '[target]\nkind = "mount"\nmass = "2 kg"\n' + LAW)


def test_on_a_soft_spring_it_is_a_free_body(mount):
    history = fm.simulate(on_mount("20 g", "1 N/m"), accuracy=1e-6)
    body = fm.Body("mild steel", radius="100 m", mass="20 g")
    free = fm.simulate(fm.Scene(on_mount("20 g", "1 N/m").impactor, body, fm.Contact("hertz")), accuracy=1e-6)
    for name in ("maximum_force", "contact_duration", "rebound_velocity", "energy_radiated"):
        assert history.summary[name] == pytest.approx(free.summary[name], rel=1e-3), name
    assert history.accuracy.modes == 1


def test_a_light_block_follows_statically(mount):
    scene = on_mount("1 ug", "1 MN/m")
    history = fm.simulate(scene, accuracy=1e-8)
    force, depth = history.summary["maximum_force"], history.summary["maximum_indentation"]
    assert history.vibration is None
    assert 0.4 * force * depth + 0.5 * force**2 / 1e6 == pytest.approx(scene.kinetic_energy, rel=1e-8)


def test_batches_take_it_or_say_why_not(mount):
    columns = {"impactor.velocity": np.array([0.1, 0.2]), "target.stiffness": np.array([1e6, 2e6])}
    many = simulate_many(on_mount("1 ug", "1 MN/m"), columns)
    for row, (velocity, stiffness) in enumerate(zip(*columns.values(), strict=True)):
        scene = on_mount("1 ug", f"{stiffness} N/m").replace({"impactor.velocity": f"{velocity} m/s"})
        alone = fm.simulate(scene).summary["maximum_force"]
        assert many.summary["maximum_force"][row] == pytest.approx(alone, rel=1e-4)
    heavy = simulate_many(on_mount("20 g", "1 N/m"), {"impactor.velocity": np.array([0.1, 0.2])})
    assert [STATUSES[code][0] for code in heavy.status.tolist()] == ["separated", "separated"]
    alone = fm.simulate(on_mount("20 g", "1 N/m").replace({"impactor.velocity": "0.2 m/s"})).summary
    assert heavy.summary["maximum_force"][1] == pytest.approx(alone["maximum_force"], rel=1e-4)


def test_explain_describes_it(mount, tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(on_mount("20 g", "1 N/m").to_toml(), encoding="utf-8")
    assert main(["explain", str(path), "--verbose"]) == 0
    told = capsys.readouterr().out
    assert "the mount moves by its natural vibrations" in told and "a mount has no wave impedance" in told


@pytest.mark.slow
def test_datasets_keep_it(mount, tmp_path):
    fd = pytest.importorskip("film_datasets")
    history = fm.simulate(on_mount("1 ug", "1 MN/m"))
    again = fd.open(fd.write(fd.to_dataset(history), tmp_path / "impact.nc")).film.scene()
    assert again.target == history.scene.target

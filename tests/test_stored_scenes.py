"""Datasets and FMUs made elsewhere: what is read out of them opens no other file and is refused with one sentence."""

import os
import threading
import tomllib
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import read_sweep, run_sweep
from film_model.cli.main import main
from fmu_wrapper.instance import Fmu

BALL = fm.Sphere("10 mm", velocity="0.25 m/s", material="mild steel")
TABLE = "indentation (um), force (N)\n0, 0\n5, 100\n10, 300\n20, 900\n"
SCENE = fm.Scene(BALL, fm.HalfSpace("mild steel"), fm.Contact("hertz"))
SPEEDS = {"impactor.velocity": ["0.1 m/s", "0.2 m/s"]}


@pytest.fixture
def trap(tmp_path):
    """A named pipe: whoever opens it waits, until the test ends."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    opened = threading.Event()

    def feed():
        with open(path, "w", encoding="utf-8") as pipe:
            if not done.is_set():
                opened.set()
            pipe.write(TABLE)

    done = threading.Event()
    thread = threading.Thread(target=feed, daemon=True)
    thread.start()
    yield path, opened
    done.set()
    with open(path, encoding="utf-8"):
        thread.join(5)


def with_file(ds, path):
    """The dataset with the path of a table in its scene."""
    text = ds.attrs["scene_toml"].replace('law = "hertz"', f'law = "tabulated"\nfile = "{path}"')
    assert text != ds.attrs["scene_toml"]
    return ds.assign_attrs(scene_toml=text)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_path_in_a_stored_scene_is_refused_and_not_opened(trap):
    path, opened = trap
    history = with_file(fd.to_dataset(fm.simulate(SCENE)), path)
    sweep = with_file(fd.sweep(SCENE, SPEEDS, keep="segments"), path)
    where = {"impactor_velocity": 0.1}
    for call in (
        history.film.scene,
        lambda: history.film.sample([0.0]),
        lambda: sweep.film.scene(**where),
        lambda: sweep.film.sample([0.0], **where),
        lambda: sweep.film.history(**where),
    ):
        with pytest.raises(
            ValueError, match=r"contact\.file: a scene that is stored with results has its tables inside"
        ):
            call()
    assert not opened.is_set()


def test_a_path_in_a_stored_sweep_is_refused(tmp_path):
    (tmp_path / "curve.csv").write_text(TABLE, "utf-8")
    sections = [{"law": "hertz"}, {"law": "tabulated", "file": str(tmp_path / "curve.csv")}]
    ds = fd.sweep(SCENE, {"contact": sections})
    assert "curve.csv" not in ds.attrs["sweep_toml"]
    (tmp_path / "curve.csv").unlink()
    assert ds.isel(contact=1).film.scene().contact.law == "tabulated"  # the table is inside
    text = ds.attrs["sweep_toml"].partition("[over]")[0]
    text += '[over]\n"contact" = [{ law = "hertz" }, { law = "tabulated", file = "/etc/hostname" }]\n'
    with pytest.raises(ValueError, match="no other file is read"):
        ds.assign_attrs(sweep_toml=text).isel(contact=1).film.scene()


MODES = "frequency [Hz], modal_mass [kg], shape\n182, 0.91, 1\n417, 1.40, 0.6\n"


def test_the_vibrations_of_a_structure_are_inside_too(tmp_path, monkeypatch):
    """Found beside the scene and the sweep, and kept; a stored path is refused without a word of what it holds."""
    (tmp_path / "modes.csv").write_text(MODES, "utf-8")
    given = '{ kind = "structure", file = "modes.csv", material = "mild steel" }'
    text = SCENE.to_toml().partition("[target]")[0]
    (tmp_path / "scene.toml").write_text(f"target = {given}\n{text}", "utf-8")
    sweep = f'scene = "scene.toml"\n[over]\n"target" = [{given}, {{ kind = "half-space", material = "mild steel" }}]\n'
    (tmp_path / "sweep.toml").write_text(sweep, "utf-8")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    scene = fm.Scene.from_toml(tmp_path / "scene.toml")
    ds = run_sweep(read_sweep(tmp_path / "sweep.toml"), command="test")
    (tmp_path / "modes.csv").write_text("a secret", "utf-8")
    assert ds.isel(target=0).film.scene().target == scene.target and fd.validate(ds) == []
    path = (tmp_path / "modes.csv").as_posix()
    stored = scene.to_toml().partition("[target]")[0] + f'[target]\nkind = "structure"\nfile = "{path}"\n'
    for other in (fd.sweep(SCENE, SPEEDS), fd.to_dataset(fm.simulate(SCENE))):
        with pytest.raises(fm.SceneError, match=r"target\.file: a scene that is stored .* no other file is read$"):
            other.assign_attrs(scene_toml=stored).film.scene()


@pytest.mark.slow
def test_plots_and_fmus_read_no_other_file(tmp_path, capsys):
    ds = with_file(fd.to_dataset(fm.simulate(SCENE)), tmp_path / "curve.csv")
    (tmp_path / "curve.csv").write_text("no table", "utf-8")
    ds.to_netcdf(tmp_path / "impact.nc")
    main(["plot", str(tmp_path / "impact.nc"), "--output", str(tmp_path / "impact.png")])
    assert "no table" not in capsys.readouterr().err
    (tmp_path / "resources").mkdir()
    (tmp_path / "resources" / "scene.toml").write_text(ds.attrs["scene_toml"], "utf-8")
    nothing: Any = None
    with pytest.raises(ValueError, match="no other file is read"):
        Fmu(tmp_path / "impact.fmu", str(tmp_path), nothing, nothing).scene()


def test_a_scene_file_of_your_own_still_names_its_table(tmp_path):
    (tmp_path / "curve.csv").write_text(TABLE, "utf-8")
    text = SCENE.to_toml().replace('law = "hertz"', 'law = "tabulated"\nfile = "curve.csv"')
    (tmp_path / "scene.toml").write_text(text, "utf-8")
    scene = fm.Scene.from_toml(tmp_path / "scene.toml")
    assert scene.contact.parameters["force"][-1] == 900.0
    assert fd.to_dataset(fm.simulate(scene)).film.scene() == scene


BOMBS = {
    "a key of 20,000 parts": ".".join(["a"] * 20_000) + " = 1",
    "20,000 keys with dots": "\n".join(f"a.b{k} = 1" for k in range(20_000)),
    "a heading of 100,000 parts": "[" + ".".join(["a"] * 100_000) + "]",
    "20,000 headings": "\n".join(f"[s{k}]" for k in range(20_000)),
    "100,000 brackets": "x = " + "[" * 100_000 + "]" * 100_000,
    "50,000 tables in tables": "x = " + "{a=" * 50_000 + "1" + "}" * 50_000,
}

NESTED = ("100,000 brackets", "50,000 tables in tables")
"""These tomllib itself refuses; it is not called for the others, as its time grows with the square of their length."""


@pytest.mark.parametrize("name", list(BOMBS))
def test_a_scene_that_would_take_long_to_read_is_refused_before_it_is_parsed(name):
    with (
        patch("film_model.scene.toml.tomllib.loads", wraps=tomllib.loads) as parse,
        pytest.raises(fm.SceneError) as raised,
    ):
        fm.Scene.from_text(SCENE.to_toml() + "\n" + BOMBS[name] + "\n")
    assert parse.called == (name in NESTED)
    assert len(raised.value.mistakes) == 1 and len(str(raised.value)) < 100


def test_the_examples_are_far_below_the_limits():
    folder = Path(__file__).parents[1] / "examples"
    for path in [*folder.glob("scenes/*.toml"), *folder.glob("**/*sweep*.toml")]:
        assert path.read_text("utf-8").count("=") < 100

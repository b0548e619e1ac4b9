"""Histories as datasets and netCDF files: complete, written whole or not at all, valid by CF."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import film_datasets as fd
import film_datasets.files
import film_model as fm
from film_datasets.cost_dataset import study_of
from film_datasets.schema.tables import ADDED
from film_model.base.units import si_unit
from film_model.cli.main import main
from film_model.core import native
from film_model.effects.choose import problem_of
from film_model.solve.history import MOTION, SUMMARY
from film_model.studies.cost import CostRun, Study
from film_model.studies.reference import COMPARED
from film_model.studies.timing import Timing

SCENES = sorted((Path(__file__).parents[1] / "examples" / "scenes").glob("*.toml"))
EVERY_SCENE = pytest.mark.parametrize(
    "path",
    [pytest.param(p, id=p.stem, marks=pytest.mark.slow if p.stem == "olsson_plate" else ()) for p in SCENES],
)
TUNGSTEN = SCENES[0].with_name("tungsten_carbide_on_steel.toml")


@pytest.fixture(scope="module")
def history() -> fm.History:
    return fm.simulate(fm.Scene.from_toml(TUNGSTEN))


@pytest.fixture
def dataset(history: fm.History) -> xr.Dataset:
    return fd.to_dataset(history)


@pytest.mark.slow
@EVERY_SCENE
def test_dataset_has_what_the_history_has(path: Path) -> None:
    history = fm.simulate(fm.Scene.from_toml(path))
    ds = fd.to_dataset(history, samples=11)
    assert fd.validate(ds) == []
    for event, t in zip(history.events, ds["event_time"].values, strict=True):
        assert t == event.time
        at = ds.sel(t=t)  # exact: raises KeyError if t is not on the grid
        row = ds.isel(event=list(ds["event_time"].values).index(t))
        for name in MOTION:
            assert at[name] == row[f"event_{name}"]
    samples = history.sample_si(ds["t"].values)
    for name in MOTION:
        scale = np.abs(ds[name].values).max()
        np.testing.assert_allclose(ds[name].values, getattr(samples, name), rtol=0, atol=1e-9 * scale)
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        assert ds[name].attrs["units"] == si_unit(dimension)
        assert np.isnan(ds[name]) if value is None else float(ds[name]) == value


def test_equal_histories_compare_equal(history: fm.History) -> None:
    again = fm.simulate(history.scene)
    other = fm.simulate(history.scene, accuracy=1e-6)
    assert again == history and hash(again) == hash(history)
    assert other != history and len({history, again, other}) == 2


@pytest.mark.slow
@EVERY_SCENE
def test_a_history_is_written_as_its_dataset(path: Path, tmp_path: Path) -> None:
    """To netCDF without xarray: the same bytes."""
    history = fm.simulate(fm.Scene.from_toml(path))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOURCE_DATE_EPOCH", "0")
        one = fd.write(fd.to_dataset(history), tmp_path / "one.nc")
        patch.setattr(xr.Dataset, "to_netcdf", None)
        other = fd.write(history, tmp_path / "other.nc")
    assert one.read_bytes() == other.read_bytes()


def test_times_are_read_with_their_unit(history: fm.History) -> None:
    quantity = history.maximum_force.__class__
    expected = history.sample_si(20e-6)
    assert expected.contact_force > 0.0
    for time in ("20 us", quantity(20, "us"), quantity(np.array(0.02), "ms")):
        assert history.sample_si(time).contact_force == pytest.approx(expected.contact_force, rel=1e-14)
    with pytest.raises(ValueError, match="a time is needed"):
        history.sample_si(quantity(20, "mm"))


def test_a_wrong_type_is_named_in_the_error(history: fm.History, tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="not a Scene"):
        fd.to_dataset(history.scene)
    with pytest.raises(TypeError, match="takes a dataset or a history, not a Scene"):
        fd.write(history.scene, tmp_path / "x.nc")  # pyright: ignore[reportArgumentType]
    with pytest.raises(TypeError, match=r'not "scene\.toml": Scene'):
        fm.simulate("scene.toml")  # pyright: ignore[reportArgumentType]


def test_a_selection_of_segments_cannot_be_sampled(dataset: xr.Dataset) -> None:
    for part in (slice(0, 5), slice(5, None)):
        with pytest.raises(ValueError, match="segments of this history are missing"):
            dataset.isel(segment=part).film.sample(["100 us"])
    with pytest.raises(ValueError, match=r"one list, not of shape \(1, 2\)"):
        dataset.film.sample([["1 us", "2 us"]])
    early = dataset.isel(t=slice(0, 5), event=slice(0, 1)).film.sample(["100 us"])
    assert early.identical(dataset.film.sample(["100 us"]))


def test_even_samples_come_with_the_events(history: fm.History) -> None:
    t = fd.to_dataset(history, samples=5)["t"].values
    even = np.linspace(0.0, history.duration, 5)
    assert set(t) == {*even.tolist(), *(event.time for event in history.events)}


@pytest.mark.parametrize("samples", [1, 0, -3, 2.5, True, "5"])
def test_too_few_samples_are_refused(history: fm.History, samples: object) -> None:
    with pytest.raises(ValueError, match=r"samples: .* must be a whole number, 2 or more"):
        fd.to_dataset(history, samples=samples)  # type: ignore[arg-type]


def test_flags_read_as_stages_and_events(dataset: xr.Dataset, history: fm.History) -> None:
    stage = dataset["stage"]
    words = dict(zip(stage.attrs["flag_values"].tolist(), stage.attrs["flag_meanings"].split(), strict=True))
    assert words[0] == "elastic"
    assert words[2] == "linear_elastoplastic"
    names = [words[value].replace("_", " ") for value in stage.values.tolist()]
    plain = ["no contact" if name == "" else name for name in history.sample_si(dataset["t"].values).stage]
    events = set(dataset["event_time"].values)
    inside = [k for k, t in enumerate(dataset["t"].values) if t not in events]
    assert [names[k] for k in inside] == [plain[k] for k in inside]
    kind = dataset["event_kind"]
    words = dict(zip(kind.attrs["flag_values"].tolist(), kind.attrs["flag_meanings"].split(), strict=True))
    assert [words[value] for value in kind.values.tolist()] == [event.name for event in history.events]


@pytest.mark.parametrize(
    ("stem", "changes", "count"),
    [
        ("two_steel_balls", {"impactor.mass": "1 kg", "impactor.velocity": "3 m/s"}, 5),
        ("olsson_plate", {"impactor.mass": "8 g", "impactor.velocity": "1 mm/s", "target.size": None}, 11),
    ],
)
def test_missing_summary_values_are_nan(stem: str, changes: dict[str, str], count: int) -> None:
    scene = fm.Scene.from_toml(TUNGSTEN.with_stem(stem)).replace(changes)
    history = fm.simulate(scene)
    missing = [name for name, value in history.summary.items() if value is None]
    assert len(missing) == count
    ds = fd.to_dataset(history)
    assert fd.validate(ds) == []
    assert missing == [name for name in SUMMARY if np.isnan(ds[name])]


@pytest.mark.slow
def test_netcdf_gives_back_the_dataset(dataset: xr.Dataset, tmp_path: Path) -> None:
    back = fd.read(fd.write(dataset, tmp_path / "impact.nc"))
    assert back.identical(dataset)
    assert fd.validate(back) == []
    assert all(back[name].dtype == dataset[name].dtype for name in dataset.variables)
    assert "_FillValue" not in back["t"].encoding


def test_a_file_contains_its_scene(dataset: xr.Dataset, history: fm.History, tmp_path: Path) -> None:
    back = fd.read(fd.write(dataset, tmp_path / "impact.nc"))
    again = fm.simulate(fm.Scene.from_text(back.attrs["scene_toml"]))
    assert again.summary == history.summary
    assert fd.to_dataset(again).attrs["content_sha256"] == back.attrs["content_sha256"]


@pytest.mark.slow
@EVERY_SCENE
def test_segments_give_the_state_at_any_time(path: Path, tmp_path: Path) -> None:
    history = fm.simulate(fm.Scene.from_toml(path).replace({"effects.boundary_reflections": False}))
    back = fd.read(fd.write(fd.to_dataset(history, samples=2), tmp_path / "impact.nc"))
    times = np.linspace(0.0, 1.1 * history.duration, 37)
    problem = problem_of(fm.Scene.from_text(back.attrs["scene_toml"]))
    values, _, _ = native.sample(problem.curve.native, fd.lines_of(back), times / float(back["scale_time"]))
    motion = problem.motion(times, values.T)
    expected = history.sample_si(times)
    for name in MOTION:
        np.testing.assert_array_equal(motion[name], getattr(expected, name))
    speed = float(back["drift_velocity"]) + float(back["impactor_share"]) * values[:, 3] * float(back["scale_velocity"])
    np.testing.assert_allclose(speed, expected.impactor_velocity, rtol=0, atol=1e-12 * np.abs(speed).max())


@pytest.mark.slow
def test_a_custom_law_is_named_in_the_dataset(tmp_path: Path) -> None:
    scene = fm.Scene.from_toml(TUNGSTEN)
    law = fm.Hertz(effective_modulus=1e11, radius=0.01)
    own = fm.Scene(scene.impactor, scene.target, fm.Contact(law=law))
    ds = fd.to_dataset(fm.simulate(own))
    assert fd.validate(fd.read(fd.write(ds, tmp_path / "own.nc"))) == []
    assert 'law = "hertz"' in ds.attrs["scene_toml"]
    assert "100000000000.0" in ds.attrs["contact_law"]


@pytest.mark.slow
def test_same_input_gives_the_same_bytes(history: fm.History, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    contents = set()
    for name, epoch in (("a", "1000000000"), ("b", "1000000000"), ("c", "1000000001")):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        contents.add(fd.write(fd.to_dataset(history), tmp_path / f"{name}.nc").read_bytes())
    assert len(contents) == 2
    assert fd.read(tmp_path / "a.nc").attrs["date_created"] == "2001-09-09T01:46:40Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(ValueError, match="SOURCE_DATE_EPOCH: 'yesterday' must be a whole number"):
        fd.to_dataset(history)


def test_overwriting_must_be_asked_for(dataset: xr.Dataset, tmp_path: Path) -> None:
    path = tmp_path / "impact.nc"
    path.write_bytes(b"precious")
    with pytest.raises(FileExistsError, match=r"impact\.nc: exists"):
        fd.write(dataset, path)
    assert path.read_bytes() == b"precious"
    fd.write(dataset, path, overwrite=True)
    assert fd.read(path).identical(dataset)
    assert list(tmp_path.iterdir()) == [path]


def _fails_late(ds: xr.Dataset, path: Path, **_: object) -> None:
    path.write_bytes(b"half a file")
    raise RuntimeError("NetCDF: HDF error")


def _disk_full(*_: object) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("before", [None, b"precious"])
@pytest.mark.parametrize("fault", ["library", "flush", "rename"])
def test_a_failed_write_leaves_the_old_file(
    dataset: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str, before: bytes | None
) -> None:
    path = tmp_path / "impact.nc"
    if before is not None:
        path.write_bytes(before)
    if fault == "library":
        monkeypatch.setattr(xr.Dataset, "to_netcdf", _fails_late)
    else:
        monkeypatch.setattr(film_datasets.files.os, {"flush": "fsync", "rename": "replace"}[fault], _disk_full)
    with pytest.raises(OSError, match=r"impact\.nc: cannot be written.*(disk full|No space)"):
        fd.write(dataset, path, overwrite=True)
    assert [p.read_bytes() for p in tmp_path.iterdir()] == ([] if before is None else [before])


def test_unwritable_paths_are_refused(dataset: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "folder.nc").mkdir()
    with pytest.raises(IsADirectoryError, match=r"folder\.nc: is a folder"):
        fd.write(dataset, tmp_path / "folder.nc")
    with pytest.raises(FileNotFoundError, match=r"impact\.nc: there is no folder"):
        fd.write(dataset, tmp_path / "missing" / "impact.nc")
    with pytest.raises(ValueError, match=r'impact\.txt: .* must end in "\.nc"'):
        fd.write(dataset, tmp_path / "impact.txt")

    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(film_datasets.files.os, "open", refuse)
    with pytest.raises(PermissionError, match=r"impact\.nc: cannot be written: Permission denied"):
        fd.write(dataset, tmp_path / "impact.nc")


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda ds: ds["contact_force"].attrs.update(units="kN"), "variable contact_force: units 'kN', not 'N'"),
        (lambda ds: ds["t"].attrs.update(long_name="date"), "variable t: long_name 'date'"),
        (lambda ds: ds["event_kind"].attrs.update(flag_meanings="bang"), "variable event_kind: flags"),
        (lambda ds: ds["stage"].values.fill(99), "variable stage: values that are not in flag_values"),
        (lambda ds: ds["indentation"].values.fill(np.nan), "variable indentation: values that are not finite"),
        (lambda ds: ds["indentation"].values.fill(1.0), "content_sha256 does not match the variables"),
        (lambda ds: ds["event_time"].values.__setitem__(1, 1e-6), "an event_time is not on t"),
        (lambda ds: ds.attrs.update(scene_toml="x"), "scene_sha256 does not match scene_toml"),
        (lambda ds: ds.attrs.pop("references"), "attribute references is missing"),
        (lambda ds: ds.attrs.update(film_model_schema_version="0"), "attribute film_model_schema_version is '0'"),
        (lambda ds: ds.update({"colour": 3}), "variable colour is not in the schema"),
        (lambda ds: ds.__delitem__("maximum_force"), "variable maximum_force is missing"),
        (lambda ds: ds.update({"drift_velocity": ds["drift_velocity"].astype("f4")}), "type 'float32', not 'float64'"),
        (lambda ds: ds.update({"drift_velocity": ds["indentation"]}), "variable drift_velocity: dimensions ('t',)"),
    ],
)
def test_validate_finds_defects(dataset: xr.Dataset, spoil: object, complaint: str) -> None:
    assert fd.validate(dataset) == []
    spoil(dataset)  # type: ignore[operator]
    found = fd.validate(dataset)
    assert any(complaint in line for line in found), found


def test_all_differences_are_listed(dataset: xr.Dataset) -> None:
    dataset["contact_force"].attrs["units"] = "kN"
    del dataset["maximum_force"], dataset.attrs["title"]
    assert len(fd.validate(dataset)) == 3


def test_a_file_from_before_a_summary_value_is_valid(
    dataset: xr.Dataset, history: fm.History, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    current = fd.VERSIONS["impact_history"]
    monkeypatch.setitem(ADDED, "impact_history", {current: (), "later": ("maximum_force",)})
    old = dataset.drop_vars("maximum_force")
    old.attrs["content_sha256"] = fd.content_sha256(old)
    back = fd.read(fd.write(old, tmp_path / "old.nc"))
    assert fd.validate(back) == []
    assert back.film.history().summary == {**history.summary, "maximum_force": None}
    old.attrs["film_model_schema_version"] = "later"
    assert fd.validate(old) == ["variable maximum_force is missing"]


@pytest.mark.slow
def test_a_cost_study_is_a_dataset(tmp_path: Path) -> None:
    """A cost study of two methods, one without a batch and with one failed run."""
    timing = Timing(median=2e-6, spread=1e-7)
    values = dict.fromkeys(COMPARED, 0.5)
    runs = tuple(
        CostRun(
            method=method, setting=setting, time_single=timing, time_batch=batch, force_evaluations=count,
            errors=dict.fromkeys(COMPARED, 1e-5) if count else {}, outcome="done" if count else "stopped\nearly",
        )
        for method, setting, batch, count in (
            ("FILM, chords", "8 segments", timing, 24), ("solve_ivp RK45", "rtol 1e-3", None, 90),
            ("solve_ivp RK45", "rtol 1e-9", None, None),
        )
    )  # fmt: skip
    reference = {"method": "quadrature", "values": values, "error": 1e-15}
    study = Study(
        scene=fm.Scene.from_toml(TUNGSTEN), law="big-alabo", reference=reference, runs=runs, machine={"python": "3"}
    )
    ds = fd.to_dataset(study)
    assert fd.validate(ds) == []
    assert ds["method"].attrs["flag_meanings"] == "FILM__chords solve_ivp_RK45"
    assert ds["outcome"].values.tolist() == [0, 0, 1]
    assert np.isnan(ds["median_time_batch"].values).tolist() == [False, True, True]
    back = fd.read(fd.write(ds, tmp_path / "cost.nc"))
    assert back.identical(ds)
    assert fd.validate(back) == []
    again = study_of(back)
    for run, one in zip(again.runs, runs, strict=True):
        assert (run.method, run.setting, run.errors) == (one.method, one.setting, one.errors)
        assert (run.time_single, run.time_batch) == tuple(
            time if time is None else Timing(time.median, time.spread) for time in (one.time_single, one.time_batch)
        )
        assert (run.force_evaluations, run.outcome) == (one.force_evaluations, " ".join(one.outcome.split()))
    assert (again.law, again.reference, again.machine) == ("big-alabo", reference, study.machine)
    assert again.scene == study.scene
    if importlib.util.find_spec("matplotlib"):
        single, batch = back.film.plot(tmp_path / "cost.svg").axes
        assert [line.get_xydata().tolist() for line in single.lines] == [[[1e-5, 2e-6]]] * 2
        assert len(batch.lines) == 1
    if importlib.util.find_spec("compliance_checker"):
        checker = Path(sys.executable).with_name("compliance-checker")
        command = [checker, "--test=cf:1.11", "--criteria=strict", tmp_path / "cost.nc"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert "All tests passed!" in run.stdout, run.stdout + run.stderr


def test_film_model_does_not_import_film_datasets() -> None:
    code = "import sys, film_model, film_model.plot.history; assert 'film_datasets' not in sys.modules; print('ok')"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ, check=False)
    assert run.stdout == "ok\n", run.stderr


@pytest.mark.slow
def test_the_accessor_exists_where_xarray_is_imported_later():
    code = (
        "import film_datasets, importlib.util as util; util.find_spec('xarray'); import xarray; "
        "print(isinstance(xarray.Dataset().film, film_datasets.Film))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


@pytest.mark.slow
@EVERY_SCENE
def test_cf_checker_finds_nothing(path: Path, tmp_path: Path) -> None:
    pytest.importorskip("compliance_checker")
    file = fd.write(fd.to_dataset(fm.simulate(fm.Scene.from_toml(path))), tmp_path / "impact.nc")
    checker = Path(sys.executable).with_name("compliance-checker")
    run = subprocess.run(
        [checker, "--test=cf:1.11", "--criteria=strict", file], capture_output=True, text=True, check=False
    )
    assert "All tests passed!" in run.stdout, run.stdout + run.stderr
    assert run.returncode == 0


@pytest.mark.slow  # the import of zarr
def test_a_history_in_a_zarr_folder_is_complete(dataset: xr.Dataset, tmp_path: Path) -> None:
    pytest.importorskip("zarr")
    path = fd.write(dataset, tmp_path / "impact.zarr")
    assert fd.read(path).identical(dataset) and fd.validate(fd.read(path)) == []
    assert [file.name for file in tmp_path.iterdir()] == ["impact.zarr"]
    with pytest.raises(FileExistsError, match="overwrite=True"):
        fd.write(dataset, path)
    assert fd.read(fd.write(dataset, path, overwrite=True)).identical(dataset)
    assert main(["run", str(TUNGSTEN), "--output", str(path), "--force"]) == 0


def test_events_are_found_by_name(history: fm.History, dataset: xr.Dataset) -> None:
    assert dataset.film.events() == history.events
    (deepest,) = dataset.film.events("maximum_indentation")
    assert deepest.indentation == history.summary["maximum_indentation"]
    with pytest.raises(ValueError, match='"turn" is no event: there are contact_begins, stage_changes'):
        dataset.film.events("turn")


def test_energies_add_up_at_any_time() -> None:
    scene = fm.Scene.from_toml(TUNGSTEN.with_name("steel_ball_on_rod.toml")).replace({"effects.gravity": False})
    history = fm.simulate(scene, accuracy=1e-8)
    found = fd.to_dataset(history).film.energies(["0 s", "100 us", history.summary["contact_duration"]])
    total = (found["impactor"] + found["contact"] + found["target"]).values
    assert total == pytest.approx(scene.kinetic_energy, rel=1e-6)
    assert float(found["target"][-1]) == pytest.approx(history.summary["energy_radiated"], rel=1e-5)
    assert float(found["contact"][-1]) == pytest.approx(history.summary["energy_absorbed"], abs=1e-6 * total[0])
    assert found["contact"].attrs["units"] == "J"


def test_a_missing_variable_is_named_by_the_hash(dataset: xr.Dataset) -> None:
    with pytest.raises(ValueError, match="variable maximum_force missing: dropped or renamed"):
        fd.content_sha256(dataset.drop_vars("maximum_force"))

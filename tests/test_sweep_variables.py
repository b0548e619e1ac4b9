"""Sweeps that keep some of the summary values."""

import pytest

import film_datasets as fd
from film_datasets.sweeps import Sweep, finish_shards, read_sweep, run_shard, run_sweep
from film_model.base.errors import SceneError
from tests.sweep_cases import BALL, SPEEDS

KEPT = ["coefficient_of_restitution", "maximum_force"]


def test_only_the_chosen_values_are_kept_and_they_are_those_of_all():
    every, some = fd.sweep(BALL, SPEEDS), fd.sweep(BALL, SPEEDS, variables=KEPT, derivatives=["impactor.mass"])
    assert fd.validate(some) == []
    assert some.attrs["variables"].split() == sorted(KEPT, reverse=True)  # in the order of the schema
    for name in (*KEPT, "status", "law", "scene_key"):
        assert some[name].equals(every[name]), name
    rows = {name for name, array in some.data_vars.items() if array.dims}
    slopes = {f"d_{name}_d_impactor_mass" for name in KEPT}
    assert rows == {*KEPT, "status", "law", "scene_key", *slopes} | {
        f"derivative_{what}_impactor_mass" for what in ("accuracy", "side")
    }
    assert some.attrs["estimated_accuracy"] == every.attrs["estimated_accuracy"]
    assert list(some.film.summary()) == sorted(KEPT, reverse=True)
    one = some.film.history(impactor_velocity=float(some.impactor_velocity[3]))
    assert one.summary["maximum_force"] == pytest.approx(float(every.maximum_force[3]), rel=1e-4)
    fd.plot(fd.sweep(BALL, SPEEDS, variables=["impulse"]), kind="histogram")


def test_files_shards_and_sweep_files_carry_the_choice(tmp_path, monkeypatch):
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 2)
    (tmp_path / "scene.toml").write_text(BALL.to_toml())
    text = 'scene = "scene.toml"\nvariables = ["maximum_force"]\n\n[over]\n'
    text += '"impactor.velocity" = { from = "0.1 m/s", to = "5 m/s", count = 40 }\n'
    (tmp_path / "sweep.toml").write_text(text)
    asked = read_sweep(tmp_path / "sweep.toml", variables=KEPT)
    assert read_sweep(tmp_path / "sweep.toml").chosen == ("maximum_force",)
    for number in (1, 2):
        run_shard(asked, tmp_path / "shards.zarr", f"{number}/2")
    whole = run_sweep(asked, tmp_path / "whole.zarr", command="test")
    with finish_shards(asked, tmp_path / "shards.zarr", command="test") as ds, whole:
        assert fd.validate(ds) == []
        assert ds.attrs["content_sha256"] == whole.attrs["content_sha256"]
        assert Sweep.of_dataset(ds) == asked
    with pytest.raises(FileExistsError, match="not the finished output of this sweep"):
        run_sweep(read_sweep(tmp_path / "sweep.toml"), tmp_path / "whole.zarr", command="test", resume=True)


def test_mistakes_are_said():
    for given, said in (
        (["maximum_forc"], '"maximum_forc" is not a variable that can be chosen; did you mean "maximum_force"?'),
        (["restitution"], '; did you mean "coefficient_of_restitution"?'),
        (["status"], "can be chosen: maximum_force, maximum_indentation, "),
        ("impulse", '"impulse" is not a list of names of variables'),
    ):
        with pytest.raises(SceneError) as failed:
            fd.sweep(BALL, SPEEDS, variables=given)
        assert said in str(failed.value)

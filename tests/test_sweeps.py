"""Sweeps: files and their mistakes, designs, content, workers, interruption and provenance."""

from __future__ import annotations

import io
import json
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import combinations

import film_datasets as fd
import film_model as fm
from film_datasets.schema import OUT_OF_RANGE, pieces
from film_datasets.sweeps import Interrupted, ProgressBar, Sweep, available_cores, read_sweep, run_sweep
from film_datasets.sweeps.block_columns import Columns, compute_block
from film_datasets.sweeps.blocks import Block, Blocks
from film_model.cli.main import main
from film_model.solve.history import MOTION, SUMMARY

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
BALL = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
PLATE = fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace({"effects.boundary_reflections": False})
SPEEDS = {"impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 40, "spacing": "log"}}
STRENGTHS = {"target.material.yield_strength": {"normal": ["1 GPa", "0.15 GPa"]}}

RANGE = {"from": "1 m/s", "to": "2 m/s", "count": 3}

FILE = f"""scene = "{SCENES.as_posix()}/tungsten_carbide_on_steel.toml"
design = "grid"                     # random/sobol/latin-hypercube take samples = 1000000 and seed = 1
[over]
"impactor.velocity" = {{ from = "0.1 m/s", to = "5 m/s", count = 30, spacing = "log" }}
"target.material.yield_strength" = ["250 MPa", "310 MPa"]
"""


def same(one: xr.Dataset, other: xr.Dataset) -> None:
    assert one.attrs["content_sha256"] == other.attrs["content_sha256"]
    for name in one.variables:
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "sweep.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def cli(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    status = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


# ------------------------------------------------------------------------------------------------ content


def test_laws_switches_and_numbers_are_swept() -> None:
    """Parameters of a law that are words, switches, and numbers with open ranges."""
    scene = BALL.replace({"contact.law": "big-alabo", "effects.gravity": False})
    ds = fd.sweep(scene, {"contact.constants": ["continuous", "printed"], "effects.gravity": [True, False]})
    for constants in ("continuous", "printed"):
        for gravity in (True, False):
            row = ds.film.summary(contact_constants=constants, effects_gravity=str(gravity).lower())
            one = fm.simulate(scene.replace({"contact.constants": constants, "effects.gravity": gravity})).summary
            assert row["permanent_indentation"] == pytest.approx(one["permanent_indentation"], rel=2e-4)
            assert row["maximum_force"] == pytest.approx(one["maximum_force"], rel=2e-4)
    assert '"effects.gravity" = [true, false]' in ds.attrs["sweep_toml"]
    ratios = {"target.material.poissons_ratio": {"normal": [0.45, 0.1]}}
    drawn = fd.sweep(BALL, ratios, "random", samples=200)
    bad = drawn["target_material_poissons_ratio"] >= 0.5
    refused = (drawn["status"] >= OUT_OF_RANGE).values
    assert 20 < int(bad.sum()) < 120 and np.array_equal(refused, bad.values)


def test_reading_in_pieces_gives_the_whole_array(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hash, statistics and validation of a dataset are independent of the size of the pieces read."""
    scene = BALL.replace({"effects.gravity": False})
    over = {
        "impactor.mass": ["50 g", "60 g", "70 g"],
        "impactor.velocity": {"from": "0.1 m/s", "to": "2 m/s", "count": 11},
    }
    ds = fd.sweep(scene, over, keep="samples=5")
    whole = ds.film.summary()
    for piece in (4, 7, 12, 30):
        monkeypatch.setattr("film_datasets.schema.content_hash.PIECE", piece)
        for name in ("maximum_force", "sampled_indentation"):
            parts = list(pieces(ds[name]))
            assert len(parts) > 1 and max(np.size(part) for part in parts) <= max(piece, 5)
            assert np.array_equal(np.concatenate([np.ravel(part) for part in parts]), ds[name].values.ravel())
        assert fd.content_sha256(ds) == ds.attrs["content_sha256"] and fd.validate(ds) == []
        for name, row in ds.film.summary().items():
            assert row == whole[name] or row == pytest.approx(whole[name], rel=1e-13)


def test_a_sweep_of_failed_impacts_has_no_statistics() -> None:
    short = {"law": "tabulated", "indentation": ["0 um", "1 um"], "force": ["0 N", "1 N"]}
    ds = fd.sweep(BALL.replace({"contact": short}), {"impactor.velocity": ["1 m/s", "2 m/s"]})
    assert (ds["status"] < 0).all()
    empty = {"count": 0, "least": None, "mean": None, "standard_deviation": None, "greatest": None}
    assert ds.film.summary()["maximum_force"] == empty


@pytest.mark.parametrize("exponent", [{}, {"exponent": 1.4}])
def test_a_stiffness_is_swept_in_the_unit_of_the_laws_exponent(exponent: dict[str, float]) -> None:
    """Without an exponent in the scene, the default of the law gives the unit."""
    unit = f"N/m^{exponent.get('exponent', 1.5)}"
    given = {"law": "tan-sun", "stiffness": f"1e10 {unit}", "critical_indentation": "5 um", **exponent}
    scene = BALL.replace({"contact": given})
    ds = fd.sweep(scene, {"contact.stiffness": [f"1e9 {unit}", f"2e9 {unit}"]})
    forces = [
        fm.simulate(scene.replace({"contact.stiffness": f"{k} {unit}"})).summary["maximum_force"] for k in (1e9, 2e9)
    ]
    assert ds["maximum_force"].values == pytest.approx(forces, rel=2e-4)
    assert f"1000000000.0 {unit}" in ds.attrs["sweep_toml"]


def test_a_grid_equals_the_single_impacts() -> None:
    ds = fd.sweep(PLATE, {"impactor.velocity": ["1 m/s", "3 m/s"], "impactor.radius": ["5 mm", "6 mm", "7 mm"]})
    assert fd.validate(ds) == []
    assert ds["maximum_force"].dims == ("impactor_velocity", "impactor_radius")
    assert ds["impactor_radius"].attrs["units"] == "m"
    for v in (1.0, 3.0):
        for r in (0.005, 0.006, 0.007):
            own = PLATE.replace({"impactor.velocity": f"{v} m/s", "impactor.radius": f"{r} m"})
            row = ds.film.summary(impactor_velocity=v, impactor_radius=r)
            history = fm.simulate(own, accuracy=1e-8)
            for name in SUMMARY:
                value = np.nan if history.summary[name] is None else history.summary[name]
                close = pytest.approx(value, rel=1e-4, abs=1e-4 * own.kinetic_energy, nan_ok=True)
                assert (np.nan if row[name] is None else row[name]) == close, name
            assert ds.film.scene(impactor_velocity=v, impactor_radius=r) == own


@pytest.mark.slow
@combinations(suffix=["nc", "zarr"], keep=["summary", "segments", "samples=7"])
def test_a_file_equals_the_dataset_in_memory(keep: str, suffix: str, tmp_path: Path) -> None:
    if suffix == "zarr":
        pytest.importorskip("zarr")
    over = {**SPEEDS, "contact.law": ["stronge", "hertz", "auto"]}
    memory = fd.sweep(BALL, over, keep=keep)
    path = tmp_path / f"sweep.{suffix}"
    with fd.sweep(BALL, over, keep=keep, output=path) as ds:
        assert fd.validate(ds) == fd.validate(memory) == []
        same(ds, memory)
        assert ds["contact_law"].values.tolist() == ["stronge", "hertz", "auto"]
        assert ds.attrs["warnings"].startswith("law stronge: in 3 impacts its unloading returns more energy")
        assert set(ds.coords) == set(memory.coords)
    with xr.open_dataset(path) as plain:  # plain xarray
        assert plain["maximum_force"].shape == (40, 3)
        same(fd.sweep(**_again(plain), keep=keep), memory)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def _again(ds: xr.Dataset) -> dict:
    table = tomllib.loads(ds.attrs["sweep_toml"])
    return {"scene": fm.Scene.from_text(ds.attrs["scene_toml"]), **table}


@pytest.mark.slow
def test_segments_are_the_exact_histories() -> None:
    over = {"impactor.velocity": {"uniform": ["1 m/s", "4 m/s"]}, "impactor.mass": {"uniform": ["5 g", "20 g"]}}
    ds = fd.sweep(PLATE, over, "random", samples=9, keep="segments")
    for k in range(9):
        row = ds.isel(impact=k)
        times = np.linspace(0, float(row["contact_duration"]), 13)
        ours = ds.film.sample(times[::-1], impact=k)
        exact = fm.simulate(ds.film.scene(impact=k), accuracy=1e-9).sample_si(times[::-1])
        for name in MOTION:
            scale = np.abs(getattr(exact, name)).max()
            np.testing.assert_allclose(ours[name].values, getattr(exact, name), rtol=0, atol=3e-4 * scale)
    dense = fd.sweep(PLATE, over, "random", samples=9, keep="samples=13")
    np.testing.assert_allclose(dense["sampled_contact_force"][8], ours["contact_force"][::-1], rtol=1e-9, atol=1e-9)


def test_free_bodies_and_falls_are_swept_too() -> None:
    balls = fm.Scene.from_toml(SCENES / "two_steel_balls.toml")
    ds = fd.sweep(balls, {"target.velocity": ["-0.2 m/s", "0 m/s", "0.3 m/s"]}, keep="samples=5")
    for v in (-0.2, 0.0, 0.3):
        history = ds.film.history(target_velocity=v)
        assert ds.film.summary(target_velocity=v)["rebound_velocity"] == pytest.approx(
            history.summary["rebound_velocity"], rel=1e-4
        )
        end = ds["sampled_impactor_velocity"].sel(target_velocity=v)[-1]
        assert float(end) == pytest.approx(history.summary["rebound_velocity"], rel=1e-4)
    fall = fm.Scene.from_toml(SCENES / "steel_ball_on_rod.toml")
    ds = fd.sweep(fall, {"impactor.drop_height": ["10 mm", "50 mm"]})
    force = fm.simulate(fall).summary["maximum_force"]
    assert float(ds["maximum_force"][1]) == pytest.approx(force, rel=1e-4)


@pytest.mark.slow
def test_the_estimate_bounds_the_errors() -> None:
    """At least 99 % of 300 random impacts are within the estimated accuracy of the sweep."""
    over = {
        "impactor.velocity": {"from": "0.02 m/s", "to": "5 m/s", "spacing": "log"},
        "impactor.radius": {"lognormal": ["10 mm", "3 mm"]},
        "target.thickness": {"uniform": ["3 mm", "60 mm"]},
        "target.material.yield_strength": {"normal": ["400 MPa", "50 MPa"]},
    }
    base = fm.Scene(fm.Sphere("10 mm", velocity="1 m/s", material="bearing steel"), fm.Plate("mild steel", "20 mm"))
    coarse = fd.sweep(base, over, "sobol", samples=300)
    fine = fd.sweep(base.replace({"solver.accuracy": 1e-9}), over, "sobol", samples=300)
    worst = np.zeros(300)
    for name in ("maximum_force", "maximum_indentation", "contact_duration", "time_of_maximum_indentation"):
        worst = np.maximum(worst, np.abs(coarse[name].values / fine[name].values - 1))
    assert (worst <= coarse.attrs["estimated_accuracy"]).mean() >= 0.99
    assert coarse.attrs["estimated_accuracy"] <= 1e-4


@pytest.mark.slow
def test_an_accuracy_that_is_swept_is_the_one_that_was_asked_for() -> None:
    """Swept accuracies replace that of the scene; the impacts of each meet it."""
    base = BALL.replace({"solver.accuracy": 1e-12})
    ds = fd.sweep(base, {**SPEEDS, "solver.accuracy": [1e-3, 1e-5]})
    assert ds.attrs["requested_accuracy"] == 1e-3
    assert 1e-5 < ds.attrs["estimated_accuracy"] <= 1e-3
    assert "was not reached" not in ds.attrs["warnings"]
    out = fd.sweep(BALL, {**SPEEDS, "solver.accuracy": [1e-4, 1e-14]})
    assert out.attrs["requested_accuracy"] == 1e-4
    (told,) = (line for line in out.attrs["warnings"].split("\n") if "was not reached" in line)
    assert told.startswith("accuracy 1e-14 was not reached in 40 impacts")
    estimated = float(told.rpartition(" ")[2])
    assert 1e-14 < estimated < 1e-10
    mixed = fd.sweep(BALL, {**SPEEDS, "solver": [{"accuracy": 1e-4}, {"segments": 9}]})
    assert "requested_accuracy" not in mixed.attrs and fd.validate(mixed) == []


# ------------------------------------------------------------------------------------------------ designs


def test_designs_draw_from_their_distributions() -> None:
    over = {
        "impactor.velocity": {"from": "0.1 m/s", "to": "10 m/s", "spacing": "log"},
        "target.material.yield_strength": {"normal": ["1 GPa", "0.1 GPa"]},
        "impactor.radius": {"lognormal": ["10 mm", "2 mm"]},
        "impactor.mass": {"uniform": ["10 g", "30 g"]},
        "contact.law": ["hertz", "stronge"],
    }
    for design in ("random", "sobol", "latin-hypercube"):
        sweep = Sweep.of(BALL, over, design, samples=4096, seed=5)
        v, s, r, m, law = sweep.values(0, 4096)
        assert np.log10(v).mean() == pytest.approx(0.0, abs=0.03)
        assert (s.mean(), s.std()) == pytest.approx((1e9, 1e8), rel=0.04)
        assert (r.mean(), r.std()) == pytest.approx((0.01, 0.002), rel=0.04)
        assert (m.min(), m.max()) == pytest.approx((0.01, 0.03), rel=0.01)
        assert law.mean() == pytest.approx(0.5, abs=0.03)
        pieces = [sweep.values(first, count) for first, count in ((0, 1), (1, 1000), (1001, 3095))]
        backwards = [sweep.values(first, 7) for first in (4000, 3)]
        for k, whole in enumerate((v, s, r, m, law)):
            assert np.array_equal(np.concatenate([piece[k] for piece in pieces]), whole)
            assert np.array_equal(backwards[0][k], whole[4000:4007])
            assert np.array_equal(backwards[1][k], whole[3:10])
        other = Sweep.of(BALL, over, design, samples=4096, seed=6).values(0, 4096)
        assert not np.array_equal(other[0], v)


def test_no_probability_is_an_infinite_value() -> None:
    over = {"impactor.velocity": {"normal": ["10 m/s", "1 m/s"]}, "impactor.radius": {"lognormal": ["1 mm", "1 mm"]}}
    for axis in Sweep.of(BALL, over, "random", samples=1).axes:
        values = axis.quantile(np.array([0.0, 0.5, 1.0 - 2.0**-53]))
        assert np.isfinite(values).all() and (np.diff(values) > 0).all() and values[0] > 0


def test_zip_pairs_the_lists() -> None:
    over = {"impactor.velocity": ["3 m/s", "1 m/s"], "contact.law": ["hertz", "stronge"]}
    ds = fd.sweep(BALL, over, "zip")
    assert fd.validate(ds) == []
    assert ds["maximum_force"].dims == ("impact",)
    assert ds["impactor_velocity"].values.tolist() == [3.0, 1.0]
    assert ds["coefficient_of_restitution"].values[0] == pytest.approx(1.0, rel=1e-9)


def test_a_very_long_coordinate_is_not_held_in_memory(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fd.sweep(BALL, SPEEDS, output=tmp_path / "x.nc").close()
    for most, indexed in ((40, True), (39, False)):
        monkeypatch.setattr("film_datasets.files.MOST_INDEXED", most)
        with fd.open(tmp_path / "x.nc") as ds:
            assert ("impactor_velocity" in ds.indexes) == indexed
            assert fd.validate(ds) == []
            assert ds.film.scene(impactor_velocity=5.0).impactor.velocity == 5.0


def test_ends_of_a_range_are_exact() -> None:
    for spacing in ("linear", "log"):
        axis = {"from": "0.1 m/s", "to": "0.7 m/s", "count": 7, "spacing": spacing}
        (values,) = Sweep.of(BALL, {"impactor.velocity": axis}).values(0, 7)
        assert (values[0], values[-1]) == (0.1, 0.7)
        steps = np.diff(np.log(values) if spacing == "log" else values)
        np.testing.assert_allclose(steps, steps[0], rtol=1e-9)


@pytest.mark.parametrize("shape", [(1,), (70_000,), (3, 70_000), (70_000, 3), (300, 2, 400), (5, 66_000, 2), (2, 3, 4)])
def test_blocks_cover_the_sweep_in_order(shape: tuple[int, ...]) -> None:
    paths = ("impactor.velocity", "impactor.radius", "impactor.mass")
    ranges = (("0.1 m/s", "5 m/s"), ("1 mm", "9 mm"), ("1 g", "2 g"))
    over = {
        path: {"from": low, "to": high, "count": count} if count > 1 else [low]
        for path, (low, high), count in zip(paths, ranges, shape, strict=False)
    }
    sweep = Sweep.of(BALL, over)
    flat, first = np.arange(sweep.size).reshape(sweep.shape), 0
    blocks = Blocks(sweep)
    for number in range(len(blocks)):
        block = blocks[number]
        assert block.first == first
        assert np.array_equal(flat[block.region].ravel(), np.arange(first, first + block.count))
        assert block.count <= 65_536
        assert all(part.indices(n)[0] % c == 0 for part, n, c in zip(block.region, shape, blocks.shape, strict=True))
        first += block.count
    assert first == sweep.size


# ------------------------------------------------------------------------------------------------ rows that fail


def test_failed_impacts_have_a_status_and_nan() -> None:
    over = {"impactor.velocity": ["1 m/s", "2 m/s"], "target.velocity": ["0.5 m/s", "1.5 m/s"]}
    ds = fd.sweep(fm.Scene.from_toml(SCENES / "two_steel_balls.toml"), over)
    assert fd.validate(ds) == []
    word = dict(
        zip(ds["status"].attrs["flag_values"].tolist(), ds["status"].attrs["flag_meanings"].split(), strict=True)
    )
    assert [word[code] for code in ds["status"].values.ravel().tolist()] == [
        *("separated", "no_velocity", "separated", "separated")
    ]
    assert np.isnan(ds["maximum_force"].values).tolist() == [[False, True], [False, False]]
    assert "-100 no_velocity: the impactor does not approach the target" in ds.attrs["statuses"].split("\n")
    failed, sentence = ds.attrs["warnings"].splitlines()[0], "the impactor does not approach the target"
    assert failed == f"1 of 4 impacts failed: 1 no_velocity ({sentence})"


def test_values_drawn_out_of_range_are_named() -> None:
    over = {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}, "impactor.radius": {"normal": ["10 mm", "6 mm"]}}
    ds = fd.sweep(BALL, over, "random", samples=2000)
    assert fd.validate(ds) == []
    bad = ds["impactor_radius"].values <= 1e-10
    assert bad.mean() == pytest.approx(0.048, abs=0.02)
    meanings = ds["status"].attrs["flag_meanings"].split()
    code = ds["status"].attrs["flag_values"][meanings.index("impactor_radius_out_of_range")]
    assert np.array_equal(ds["status"].values == code, bad)
    assert np.array_equal(np.isnan(ds["maximum_force"].values), bad)
    assert "out of range: 1e-10 to 1000 m is allowed" in ds.attrs["statuses"]


# ------------------------------------------------------------------------------------------------ mistakes


@pytest.mark.parametrize(
    ("before", "after", "line", "says"),
    [
        ('"0.1 m/s"', '"0.1 kg"', 4, '"0.1 kg" is a mass, a velocity is needed'),
        ('"0.1 m/s"', "0.1", 4, "0.1 has no unit, a velocity is needed"),
        ('"5 m/s"', '"-5 m/s"', 4, "must be >"),
        ('"impactor.velocity"', '"impactor.velocty"', 4, 'unknown key; did you mean "velocity"?'),
        ('"impactor.velocity"', '"impacter.velocity"', 4, 'unknown key; did you mean "impactor.velocity"?'),
        ("count = 30", "cuont = 30", 4, 'unknown key "cuont"; did you mean "count"?'),
        ("count = 30, ", "", 4, "missing: count"),
        ("count = 30", "count = 1.5", 4, "count 1.5 is not allowed"),
        ('"log"', '"lgo"', 4, 'spacing "lgo" is not allowed'),
        ('["250 MPa", "310 MPa"]', '"250 MPa"', 5, "is one value: a list of values"),
        ('["250 MPa", "310 MPa"]', "[]", 5, "an empty list"),
        ('["250 MPa", "310 MPa"]', '["250 MPa", "310 mm"]', 5, '"310 mm" is a length'),
        ('["250 MPa", "310 MPa"]', '["310 MPa", "250 MPa", "300 MPa"]', 5, "increase or decrease"),
        ('["250 MPa", "310 MPa"]', '{ normal = ["310 MPa", "15 MPa"] }', 5, "a distribution needs design"),
        ('"target.material.yield_strength"', '"target.thickness"', 5, "unknown key"),
        ('["250 MPa"', '["soft"', 5, '"soft" is not a number and a unit'),
        ('"grid"', '"gird"', 2, 'did you mean "grid"?'),
        ('"grid"', '"sobol"', 2, "needs the number of impacts"),
        ("design =", "desing =", 2, 'unknown key; did you mean "design"?'),
        ("steel.toml", "steal.toml", None, "cannot be read"),
        ("[over]", "[over", 3, "not TOML"),
    ],
)
def test_an_invalid_sweep_file_gives_one_message(
    capsys: pytest.CaptureFixture[str], file: Path, before: str, after: str, line: int | None, says: str
) -> None:
    assert before in FILE
    file.write_text(FILE.replace(before, after, 1), encoding="utf-8")
    status, out, err = cli(capsys, "sweep", file, "--output", file.with_name("out.nc"))
    assert (status, out) == (2, "")
    assert says in err
    assert "Traceback" not in err
    if line is not None and "samples" not in err:
        assert f"sweep.toml:{line}: " in err
    assert [path.name for path in file.parent.iterdir()] == ["sweep.toml"]


def test_all_mistakes_of_a_sweep_are_reported_together(file: Path) -> None:
    file.write_text(FILE.replace("velocity", "velocty").replace("310 MPa", "310 m"), encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        read_sweep(file)
    assert [mistake.line for mistake in caught.value.mistakes] == [4, 5]


@pytest.mark.parametrize(
    ("changes", "lines"),
    [
        ({"design =": "desing =", "0.1 m/s": "0.1 kg", "310 MPa": "310 m"}, [2, 4, 5]),
        ({"design =": 'colour = "red"\ndesign =', '"grid"': '"gird"', "310 MPa": "310 m"}, [2, 3, 6]),
        ({"steel.toml": "steal.toml", '"grid"': '"gird"'}, [2, None]),  # without the scene, [over] cannot be checked
        ({"scene =": "scen =", '"grid"': '"sobol"', "0.1 m/s": "0.1 kg"}, [None, 1, 4]),
        ({"[over]": "[ovr]", '"grid"': '"gird"', "0.1 m/s": "0.1 kg"}, [None, 2, 3]),
        ({FILE[FILE.index("[over]") :]: "over = 3\n", '"grid"': "7"}, [2, 3]),
        ({FILE[FILE.index("[over]") :]: "[over]\n", '"grid"': "7"}, [2, 3]),
    ],
)
def test_mistakes_of_scene_and_sweep_are_reported_together(
    file: Path, changes: dict[str, str], lines: list[int | None]
) -> None:
    text = FILE
    for before, after in changes.items():
        assert before in text
        text = text.replace(before, after, 1)
    file.write_text(text, encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        read_sweep(file)
    assert [mistake.line for mistake in caught.value.mistakes] == lines, str(caught.value)


@pytest.mark.parametrize(
    ("over", "options", "says"),
    [
        ({}, {}, "at least one swept quantity"),
        ({"impactor.drop_height": ["1 m", "2 m"]}, {}, "not both"),
        ({"impactor.velocity": ["1 m/s"], "impactor": [BALL.to_table()["impactor"]]}, {}, "swept too"),
        ({"contact.law": ["hertz", "hertz"]}, {}, "given 2 times"),
        ({"contact.law": ["hertz", "hurtz"]}, {}, 'did you mean "hertz"?'),
        ({"contact.law": {"from": "hertz", "to": "meyer"}}, {}, "is not a number"),
        ({"impactor.velocity": {"normal": ["1 m/s"]}}, {"design": "random", "samples": 3}, "two values: mean and"),
        ({"impactor.velocity": {"normal": ["1 m/s", "0 m/s"]}}, {"design": "random", "samples": 3}, "must be > 0"),
        (
            {"impactor.velocity": {"uniform": ["2 m/s", "1 m/s"]}},
            {"design": "sobol", "samples": 3},
            "least value first",
        ),
        (
            {"impactor.velocity": {"from": "2 m/s", "to": "1 m/s", "count": 3}},
            {"design": "sobol", "samples": 3},
            "count",
        ),
        ({"impactor.velocity": ["1 m/s"]}, {"design": "sobol", "samples": 0}, "a whole number from 1"),
        (
            {"impactor.velocity": ["1 m/s"]},
            {"design": "sobol", "samples": 2**31},
            "from 1 to 1073741824",
        ),
        ({"impactor.velocity": ["1 m/s"]}, {"samples": 3}, 'is not for design "grid"'),
        ({"impactor.velocity": ["1 m/s"]}, {"design": "random", "samples": 3, "seed": -1}, "seed"),
        ({"impactor.velocity": ["1 m/s", "2 m/s"], "impactor.mass": ["1 g"]}, {"design": "zip"}, "of one length"),
        pytest.param(
            {"solver": [{"segments": k} for k in range(1, 10_102)]}, {}, "at most 10000", marks=pytest.mark.slow
        ),
        ({"impactor.velocity": {**RANGE, "to": "1 m/s"}}, {}, "from and to are the same"),
        ({"impactor.velocity": {**RANGE, "from": "0 m/s", "spacing": "log"}}, {}, "spacing log needs from and to > 0"),
        ({"impactor.velocity": {**RANGE, "normal": ["1 m/s", "0.1 m/s"]}}, {}, "give normal alone"),
        (
            {"target.material.poissons_ratio": {"lognormal": [-0.1, 0.1]}},
            {"design": "random", "samples": 3},
            "the mean -0.1 of a lognormal distribution must be > 0",
        ),
        ({"contact.law": []}, {}, "an empty list"),
        ({"impactor.velocity": []}, {}, "an empty list"),
        ({"target.bending_stiffness.D11": ["1 N*m"]}, {}, "bending_stiffness is not in the scene: give it there first"),
        ({"impactor.velocity.x": ["1 m"]}, {}, "velocity has no entries of its own"),
    ],
)
def test_wrong_sweeps_are_refused(over: dict, options: dict, says: str) -> None:
    with pytest.raises(fm.SceneError, match=says):
        fd.sweep(BALL, over, **options)


@pytest.mark.parametrize(
    ("base", "path", "words", "wrong", "design"),
    [
        (PLATE, "target.kind", ["plate", "half-space"], "over.target.size: unknown key", "grid"),
        (BALL, "target.kind", ["half-space", "plate"], "over.target.thickness: missing", "grid"),
        (BALL, "contact.law", ["hertz", "hunt-crossley"], "give restitution or", "grid"),
        (BALL, "contact.law", ["hunt-crossley", "hertz"], "give restitution or", "grid"),
        (BALL, "contact.law", ["hertz", "hunt-crossley"], "give restitution or", "zip"),
    ],
)
def test_words_that_need_other_keys_can_be_sections(
    base: fm.Scene, path: str, words: list[str], wrong: str, design: str
) -> None:
    with pytest.raises(fm.SceneError) as caught:
        fd.sweep(base, {path: words}, design)
    told = str(caught.value)
    assert wrong in told
    section, key = path.split(".")
    hint = told.partition("list whole sections, e.g. ")[2]
    assert hint.startswith(f'"{section}" = [{{ {key} = ')
    with pytest.raises(fm.SceneError) as plain:  # an unknown word needs no other keys
        fd.sweep(base, {path: [words[0], "hurtz"]})
    assert words[0] == "hunt-crossley" or "sections" not in str(plain.value)
    (again,) = tomllib.loads(hint.splitlines()[0]).values()  # the example itself is a sweep
    assert fd.sweep(BALL, {section: again})["maximum_force"].shape == (2,)


def test_other_wrong_arguments(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="keep: "):
        fd.sweep(BALL, SPEEDS, keep="everything")
    with pytest.raises(ValueError, match="workers: 0"):
        fd.sweep(BALL, SPEEDS, workers=0)
    with pytest.raises(ValueError, match=r'must end in "\.nc", "\.zarr"'):
        fd.sweep(BALL, SPEEDS, output=tmp_path / "out.txt")
    with pytest.raises(FileNotFoundError, match="no folder"):
        fd.sweep(BALL, SPEEDS, output=tmp_path / "no" / "out.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_larger_than_the_memory_or_disk_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    many = {"impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 10**9}}
    with pytest.raises(MemoryError, match="1000000000 impacts take about 174 GB, at most 4 GB go into memory"):
        fd.sweep(BALL, many)
    usage = shutil.disk_usage(tmp_path)._replace(free=75 * 10**9)
    monkeypatch.setattr("film_datasets.sweeps.runner.shutil.disk_usage", lambda _: usage)
    with pytest.raises(OSError, match=r"1000000000 impacts need about 2.. GB of disk.* GB in the end; 75 GB are free"):
        fd.sweep(BALL, many, output=tmp_path / "out.nc")
    assert list(tmp_path.iterdir()) == []


# ------------------------------------------------------------------------------------------------ workers, interruption

SMALL_BLOCKS = ("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 7)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["grid", "sobol"])
def test_any_number_of_workers_gives_the_same_data(
    monkeypatch: pytest.MonkeyPatch, design: str, tmp_path: Path
) -> None:
    monkeypatch.setattr(*SMALL_BLOCKS)
    over = {**SPEEDS, "impactor.mass": ["30 g", "60 g"]} if design == "grid" else {**STRENGTHS}
    options = {} if design == "grid" else {"design": design, "samples": 80}
    found = [fd.sweep(BALL, over, workers=n, keep="segments", **options) for n in (1, 2, 5)]
    for ds in found[1:]:
        same(ds, found[0])
    with fd.sweep(BALL, over, keep="segments", output=tmp_path / "x.nc", **options) as ds:
        same(ds, found[0])


class _StopAfter:
    def __init__(self, rows: int, error: type[BaseException]) -> None:
        self.rows, self.error = rows, error

    def __call__(self, done: int, size: int) -> None:
        if done >= self.rows:
            raise self.error


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_an_interrupted_sweep_is_resumed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, suffix: str) -> None:
    monkeypatch.setattr(*SMALL_BLOCKS)
    made, path = Sweep.of(BALL, SPEEDS), tmp_path / f"out.{suffix}"
    with pytest.raises(Interrupted, match=r"interrupted: \d+ of 6 blocks in .*use resume=True to continue$"):
        run_sweep(made, path, command="test", workers=1, progress=_StopAfter(20, KeyboardInterrupt))
    blocks = tmp_path / f".out.{suffix}.blocks"
    assert [p.name for p in tmp_path.iterdir()] == [blocks.name]
    kept = sorted(blocks.glob("*.npz"))
    assert len(kept) >= 3
    with pytest.raises(FileExistsError, match="an interrupted run left"):
        run_sweep(made, path, command="test")
    with pytest.raises(FileExistsError, match="of another sweep"):
        run_sweep(Sweep.of(PLATE, SPEEDS), path, command="test", resume=True)
    kept[0].write_bytes(kept[0].read_bytes()[:-100])  # a damaged block is computed again
    computed: list[int] = []

    def counted(sweep: Sweep, block: Block) -> Columns:
        computed.append(block.first)
        return compute_block(sweep, block)

    monkeypatch.setattr("film_datasets.sweeps.runner.compute_block", counted)
    with run_sweep(made, path, command="test", resume=True) as ds:
        same(ds, run_sweep(made, command="test"))
    assert len(computed) == 6 + (6 - len(kept)) + 1
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    computed.clear()
    run_sweep(made, path, command="test", resume=True).close()  # the output is complete
    assert computed == []
    with pytest.raises(FileExistsError, match="exists"):
        run_sweep(made, path, command="test")


def test_one_process_at_a_time_writes_an_output(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    monkeypatch.setattr(*SMALL_BLOCKS)
    made, path = Sweep.of(BALL, SPEEDS), tmp_path / "out.nc"

    def again(done: int, size: int) -> None:
        with pytest.raises(FileExistsError, match="another process"):
            run_sweep(made, path, command="test", resume=True)

    run_sweep(made, path, command="test", progress=again).close()


SCRIPT = """
import sys, signal, resource, film_model as fm, film_datasets as fd
import film_datasets.sweeps.blocks
film_datasets.sweeps.blocks.BLOCK_IMPACTS = 2000
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
limit = int(sys.argv[3])
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
scene = fm.Scene.from_toml(sys.argv[1])
over = {"impactor.velocity": {"uniform": ["0.1 m/s", "5 m/s"]}, "impactor.mass": {"normal": ["60 g", "5 g"]}}
try:
    fd.sweep(scene, over, "sobol", samples=int(sys.argv[4]), output=sys.argv[2], resume=True)
except OSError as error:
    sys.exit(str(error))
"""


def script(output: Path, limit: int = 0, samples: int = 60_000) -> list[str]:
    scene = SCENES / "tungsten_carbide_on_steel.toml"
    return [sys.executable, "-c", SCRIPT, str(scene), str(output), str(limit), str(samples)]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="needs a limit on the size of files")
@pytest.mark.parametrize("limit", [50_000, 1_000_000])
def test_a_full_disk_gives_one_message_and_loses_no_block(tmp_path: Path, limit: int) -> None:
    """A small limit on the file size fails the blocks, a larger one the output."""
    path = tmp_path / "out.nc"
    stopped = subprocess.run(script(path, limit), capture_output=True, text=True, check=False)
    assert stopped.returncode == 1
    assert "out.nc: cannot be written: " in stopped.stderr
    assert len(stopped.stderr.strip().splitlines()) == 1
    blocks = list((tmp_path / ".out.nc.blocks").glob("*.npz"))
    assert not path.exists() and not (tmp_path / ".out.nc.part").exists()
    assert bool(blocks) == (limit > 100_000)
    subprocess.run(script(path), check=True)
    assert fd.validate(fd.read(path)) == []


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_killed_at_any_moment_and_resumed(tmp_path: Path, suffix: str) -> None:
    begin = time.monotonic()
    subprocess.run(script(tmp_path / f"whole.{suffix}", samples=200_000), check=True)
    duration = time.monotonic() - begin
    whole = fd.read(tmp_path / f"whole.{suffix}")
    rng = random.Random(4)
    for number in range(20):
        path = tmp_path / f"out{number}.{suffix}"
        process = subprocess.Popen(script(path, samples=200_000))
        time.sleep(rng.uniform(0.3, 1.0) * duration)
        process.kill()
        process.wait()
        subprocess.run(script(path, samples=200_000), check=True)
        same(fd.read(path), whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        [f"whole.{suffix}", *(f"out{number}.{suffix}" for number in range(20))]
    )


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_data(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(*SMALL_BLOCKS)
    options = {"design": "sobol", "samples": 60, "keep": "segments"}
    whole = fd.sweep(BALL, STRENGTHS, **options)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        same(fd.sweep(BALL, STRENGTHS, scheduler=client, **options), whole)
        with fd.sweep(BALL, STRENGTHS, scheduler=cluster.scheduler_address, output=tmp_path / "x.nc", **options) as ds:
            same(ds, whole)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupt_from_the_keyboard(tmp_path: Path) -> None:
    file, output = tmp_path / "sweep.toml", tmp_path / "out.nc"
    file.write_text(FILE.replace("count = 30", "count = 1000000"), encoding="utf-8")
    code = "import sys; from film_model.cli.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "sweep", str(file), "--output", str(output)]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    )  # fmt: skip  # the tests themselves may run where the keyboard is ignored
    while process.poll() is None and not list(tmp_path.glob(".out.nc.blocks/*.npz")):
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert len(err.splitlines()) == 1
    assert "blocks in" in err and err.endswith("use --resume to continue\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".out.nc.blocks", "sweep.toml"]


def test_progress_is_shown() -> None:
    stream = io.StringIO()
    bar = ProgressBar(stream)
    bar(500, 1000)
    assert stream.getvalue() == ""  # not a terminal: no output for the first ten seconds
    bar(1000, 1000)
    assert stream.getvalue().startswith("1000 of 1000 impacts, 100 %, ")

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    bar = ProgressBar(stream)
    bar(500, 1000)
    assert "[##########..........] 500 of 1000 impacts, 50 %" in stream.getvalue()
    assert " s left" in stream.getvalue()


# ------------------------------------------------------------------------------------------------ files and commands


def test_command_writes_and_reports(capsys: pytest.CaptureFixture[str], file: Path) -> None:
    output = file.with_name("out.nc")
    status, out, err = cli(capsys, "sweep", file, "--output", output, "--json")
    assert status == 0
    table = json.loads(out)
    assert table["impacts"] == 60
    assert table["statuses"] == {"separated": 60}
    assert list(table["summary"]) == list(SUMMARY)
    assert "60 of 60 impacts, 100 %" in err
    ds = fd.read(output)
    assert fd.validate(ds) == []
    force = table["summary"]["maximum_force"]
    assert force["greatest"] == ds["maximum_force"].values.max()
    assert force["mean"] == pytest.approx(ds["maximum_force"].values.mean())
    assert force["standard_deviation"] == pytest.approx(ds["maximum_force"].values.std(ddof=1))
    assert ds.film.summary()["maximum_force"] == {k: v for k, v in force.items() if k != "units"}
    assert f"film-model sweep {file}" in ds.attrs["history"]
    status, out, err = cli(capsys, "sweep", file, "--output", output)
    assert (status, out) == (3, "")
    assert "--force" in err
    assert cli(capsys, "sweep", file, "--output", output, "--resume")[0] == 0
    assert cli(capsys, "sweep", file, "--output", output, "--force", "--keep", "samples=11", "--workers", 1)[0] == 0
    assert fd.read(output)["sampled_contact_force"].shape == (30, 2, 11)


def test_dotted_keys_need_no_quotes(file: Path) -> None:
    quoted = read_sweep(file)
    file.write_text(FILE.replace('"impactor.velocity"', "impactor.velocity"), encoding="utf-8")
    assert read_sweep(file).text() == quoted.text()


def test_same_input_gives_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    contents = set()
    for workers in (1, 2):
        fd.sweep(BALL, SPEEDS, output=tmp_path / f"{workers}.nc", workers=workers).close()
        contents.add((tmp_path / f"{workers}.nc").read_bytes())
    assert len(contents) == 1


@pytest.mark.parametrize("spoil", ["status", "content", "segments", "unit"])
def test_validate_finds_defects_of_a_sweep(spoil: str) -> None:
    ds = fd.sweep(BALL, SPEEDS, keep="segments")
    if spoil == "status":
        ds["status"].values[3] = 99
    elif spoil == "content":
        ds["maximum_force"].values[3] *= 1.0 + 1e-15
    elif spoil == "segments":
        ds["segment_count"].values[3] += 1
    else:
        ds["impactor_velocity"].attrs["long_name"] = "speed"
    assert len(fd.validate(ds)) >= 1


@pytest.mark.parametrize("content", [b"", b"rubbish", b"\x89HDF\r\n\x1a\n" + bytes(200)])
def test_a_damaged_file_gives_one_message(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.nc"
    path.write_bytes(content)
    with pytest.raises(OSError, match=r"x\.nc: is not a netCDF file, or is damaged"):
        fd.open(path)
    with pytest.raises(FileNotFoundError, match="there is no such file"):
        fd.open(tmp_path / "y.nc")


def test_a_foreign_file_gives_one_message(tmp_path: Path) -> None:
    path = tmp_path / "x.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path)
    with pytest.raises(ValueError, match=r"x\.nc: not a dataset of film-model"):
        fd.open(path)
    assert fd.validate(xr.open_dataset(path)) == [
        "not a dataset of film-model: the attribute film_model_schema does not name a kind"
    ]


@pytest.mark.parametrize("name", ["grid", "samples", "segments", "dense"])
def test_cf_checker_finds_nothing_in_sweeps(name: str, tmp_path: Path) -> None:
    pytest.importorskip("compliance_checker")
    over = {**SPEEDS, "contact.law": ["hertz", "big-alabo"]}
    drawn = {
        **STRENGTHS,
        "impactor.material": ["mild steel", "tungsten carbide"],
        "impactor.radius": {"normal": ["10 mm", "8 mm"]},
    }
    options = {
        "grid": {"over": over},
        "samples": {"over": drawn, "design": "sobol", "samples": 32},
        "segments": {"over": over, "keep": "segments"},
        "dense": {"over": drawn, "design": "random", "samples": 32, "keep": "samples=9"},
    }[name]
    fd.sweep(BALL, output=tmp_path / "x.nc", **options).close()
    checker = Path(sys.executable).with_name("compliance-checker")
    found = subprocess.run(
        [checker, "--test=cf:1.11", "--criteria=strict", tmp_path / "x.nc"], capture_output=True, text=True, check=False
    )
    assert "All tests passed!" in found.stdout, found.stdout + found.stderr


def test_ncdump_reads_them(tmp_path: Path) -> None:
    if shutil.which("ncdump") is None:
        pytest.skip("ncdump is not there")
    fd.sweep(BALL, SPEEDS, output=tmp_path / "x.nc").close()
    found = subprocess.run(["ncdump", "-h", tmp_path / "x.nc"], capture_output=True, text=True, check=True)
    assert 'maximum_force:units = "N"' in found.stdout


# ------------------------------------------------------------------------------------------------ ds.film


def test_film_of_a_history(tmp_path: Path) -> None:
    history = fm.simulate(PLATE)
    ds = fd.open(fd.write(fd.to_dataset(history), tmp_path / "x.nc"))
    assert ds.film.summary() == history.summary
    assert ds.film.scene() == history.scene
    samples, exact = ds.film.sample(["20 us", "0 us"]), history.sample_si([20e-6, 0.0])
    for name in MOTION:
        assert np.array_equal(samples[name].values, getattr(exact, name))
    assert samples["contact_force"].attrs["units"] == "N"
    assert ds.film.history().events == history.events
    with pytest.raises(KeyError, match="no impacts to select"):
        ds.film.scene(impact=3)


def test_the_accessor_names_missing_selections() -> None:
    ds = fd.sweep(BALL, {**SPEEDS, "contact.law": ["hertz", "stronge"]})
    assert ds.film.scene() == BALL
    assert ds.film.history(impactor_velocity=0.1, contact_law="stronge").problem.law.name == "stronge"
    with pytest.raises(KeyError, match="impactor_velocity is missing"):
        ds.film.scene(contact_law="stronge")
    with pytest.raises(KeyError, match="speed is not one of these"):
        ds.film.scene(speed=3.0)
    with pytest.raises(KeyError, match="there are hertz, stronge"):
        ds.film.scene(impactor_velocity=0.1, contact_law="meyer")
    with pytest.raises(ValueError, match="no segments were kept"):
        ds.film.sample([0.0], impactor_velocity=0.1, contact_law="hertz")


def test_segments_are_swept_over_a_scene_that_gives_none() -> None:
    ds = fd.sweep(BALL, {"solver.segments": [1, 2, 4]})
    found = [fm.simulate(BALL, segments=n).summary["contact_duration"] for n in (1, 2, 4)]
    assert ds["contact_duration"].values == pytest.approx(found, rel=1e-5)
    assert abs(found[0] - found[2]) > 1e-3 * found[2]
    assert ds.film.scene(solver_segments="2").solver == fm.Solver(segments=2)


def test_a_selected_impact_keeps_its_scene() -> None:
    ds = fd.sweep(BALL, {**SPEEDS, "contact.law": ["hertz", "stronge"]}, keep="segments")
    with pytest.raises(KeyError, match="impactor_velocity is missing"):
        ds.film.history()
    one = ds.isel(impactor_velocity=-1, contact_law=1)
    where = {"impactor_velocity": float(ds["impactor_velocity"][-1]), "contact_law": "stronge"}
    assert one.film.scene() == ds.film.scene(**where) != ds.film.scene() == BALL
    assert one.film.history() == ds.film.history(**where)
    for part in (one, ds.isel(impactor_velocity=[-1], contact_law=[1])):
        assert part.film.sample([5e-6]).identical(ds.film.sample([5e-6], **where))
    assert one.film.summary() == ds.film.summary(**where)


@pytest.mark.slow
@combinations(interop=[True, False], fast=1)
def test_quantities(interop: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    if interop:
        pytest.importorskip("pint_xarray")
    else:
        monkeypatch.setitem(sys.modules, "pint_xarray", None)
    quantities = fd.to_dataset(fm.simulate(BALL)).film.quantify()
    force = quantities["maximum_force"].data
    assert force.to("kN").magnitude == pytest.approx(0.5160877, rel=1e-6)
    assert str(quantities["segment_kappa"].data).startswith("[")
    assert math.isclose(float(quantities["energy_absorbed"].data.to("mJ").magnitude), 0.3023315, rel_tol=1e-6)
    adhesion = BALL.replace({"contact.work_of_adhesion": "0.1 J/m^2"})
    words = {"impactor.velocity": ["1 m/s", "2 m/s"], "target.material.yield_strength": ["1 GPa"]}
    for k, ds in enumerate((
        fd.to_dataset(fm.simulate(BALL)),
        fd.sweep(BALL, {**words, "contact.law": ["hertz", "stronge"]}, keep="segments"),
        fd.sweep(adhesion, {**words, "contact.work_of_adhesion": ["0.1 J/m^2"]}, "random", samples=9),
    )):  # fmt: skip
        plain, given = fd.write(ds, tmp_path / f"{k}.nc"), ds.film.quantify()
        assert fd.write(given, tmp_path / f"{k}q.nc").read_bytes() == plain.read_bytes()
        given["maximum_force"].data = given["maximum_force"].data.to("kN")
        back = fd.read(fd.write(given, tmp_path / f"{k}q.nc", overwrite=True))
        np.testing.assert_allclose(back["maximum_force"], ds["maximum_force"], rtol=1e-15)
        assert back["maximum_force"].attrs == ds["maximum_force"].attrs


def test_a_law_of_python_is_swept_and_named() -> None:
    own = fm.Scene(BALL.impactor, BALL.target, fm.Contact(law=fm.Hertz(effective_modulus=1e11, radius=0.01)))
    ds = fd.sweep(own, SPEEDS)
    assert fd.validate(ds) == []
    with pytest.raises(ValueError, match="an object of Python"):
        ds.film.scene()


def test_quantity_arrays_are_values() -> None:
    pint = pytest.importorskip("pint")
    speeds = pint.get_application_registry().Quantity(np.linspace(100, 200, 5), "mm/s")
    ds = fd.sweep(BALL, {"impactor.velocity": speeds})
    np.testing.assert_allclose(ds["impactor_velocity"].values, np.linspace(0.1, 0.2, 5), rtol=1e-15)
    long = pint.get_application_registry().Quantity(np.linspace(100, 200, 1500), "mm/s")
    ds = fd.sweep(BALL, {"impactor.velocity": long})
    assert "listed = 1500" in ds.attrs["sweep_toml"]
    assert ds.film.scene(impactor_velocity=0.1503).impactor.velocity == float(ds["impactor_velocity"].sel(
        impactor_velocity=0.1503, method="nearest"))  # fmt: skip


def test_cores_are_found() -> None:
    assert 1 <= available_cores() <= (os.cpu_count() or 1)


@pytest.mark.parametrize(("values", "options", "looked"), [
    ({"from": "1 mm/s", "to": "1 m/s", "count": 4, "spacing": "log"}, {}, 2),
    ({"uniform": ["1 mm/s", "5 mm/s"]}, {"design": "sobol", "samples": 64}, 8),
])  # fmt: skip
def test_unmodelled_effects_are_listed(values: dict, options: dict, looked: int) -> None:
    sticky = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml").replace(
        {"contact.work_of_adhesion": "50 J/m^2"}
    )
    said = fd.sweep(sticky, {"impactor.velocity": values}, **options).attrs["warnings"]
    assert said.startswith("not modelled: adhesion, which would change the summary by up to ")
    assert f" of the {looked} impacts that were looked at" in said
    assert fd.sweep(sticky, {"impactor.velocity": ["0.5 m/s", "1 m/s"]}).attrs["warnings"] == "none"


def test_selections_keep_the_segments_of_their_impacts() -> None:
    over = {"impactor.velocity": ["0.5 m/s", "1 m/s", "2 m/s"], "contact.law": ["hertz", "big-alabo", "stronge"]}
    ds = fd.sweep(BALL, over, keep="segments")
    where = {"impactor_velocity": "1 m/s", "contact_law": "stronge"}
    expected = ds.film.sample(["20 us"], **where)["contact_force"].item()
    assert ds.film.sample(["20 us"], impactor_velocity=1.0, contact_law="big-alabo")["contact_force"].item() != expected
    for part in (
        ds.isel(impactor_velocity=slice(1, 3)),
        ds.isel(impactor_velocity=slice(None, None, -1), contact_law=[2, 0]),
        ds.transpose("contact_law", ...),
        ds.isel(contact_law=2),
    ):
        picked = {name: value for name, value in where.items() if name in part.sizes}
        assert part.film.sample(["20 us"], **picked)["contact_force"].item() == expected
        assert part.film.scene(**picked) == ds.film.scene(**where)
        assert part.film.summary(**picked) == ds.film.summary(**where)
    with pytest.raises(KeyError, match="contact_law big-alabo: there are stronge, hertz"):
        ds.isel(contact_law=[2, 0]).film.scene(impactor_velocity=1.0, contact_law="big-alabo")
    with pytest.raises(ValueError, match="the dimension segment must be complete"):
        ds.isel(segment=slice(3, None)).film.sample(["20 us"], **where)
    with pytest.raises(ValueError, match="before first touch"):
        ds.film.sample([-1e-6], **where)
    with pytest.raises(ValueError, match="a velocity is needed"):
        ds.film.scene(impactor_velocity="1 kg", contact_law="hertz")
    one = ds[["maximum_force", "status"]]
    assert set(one.film.summary()) == {"maximum_force"}
    assert one.film.quantify()["maximum_force"].data.units == "newton"


TABLE = "indentation (um), force (N)\n0, 0\n10, 400\n50, 4000\n200, 30000\n"


def test_tables_are_found_beside_the_sweep_and_kept_in_the_dataset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = f"{SCENES.as_posix()}/tungsten_carbide_on_steel.toml"
    (tmp_path / "table.csv").write_text(TABLE, encoding="utf-8")
    laws = ", ".join(f'{{ law = "tabulated", file = "table.csv"{more} }}' for more in ("", ', unloading = "retrace"'))
    text = f'scene = "{scene}"\n[over]\n"contact" = [{laws}]\n"impactor.velocity" = ["0.1 m/s", "0.2 m/s"]\n'
    (tmp_path / "sweep.toml").write_text(text, encoding="utf-8")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    ds = run_sweep(read_sweep(tmp_path / "sweep.toml", "segments"), command="test")
    assert (ds["status"] == 1).all() and fd.validate(ds) == []
    assert ds["contact"].values.tolist() == ["tabulated", "tabulated_unloading_retrace"]
    where = {"impactor_velocity": 0.2, "contact": "tabulated"}
    assert ds["coefficient_of_restitution"].sel(impactor_velocity=0.2).values[1] == pytest.approx(1.0)
    other = TABLE.replace("4000", "9000")
    (tmp_path / "table.csv").write_text(other, encoding="utf-8")  # the dataset contains the table
    assert ds.film.scene(**where).contact.parameters["force"][2] == 4000.0
    found = ds.film.history(**where).maximum_force.magnitude
    assert found == pytest.approx(ds.film.summary(**where)["maximum_force"], rel=1e-4)


@pytest.mark.slow
def test_zipped_words_may_repeat_and_are_checked_row_by_row() -> None:
    soft = {"name": "soft", "youngs_modulus": "5 MPa", "poissons_ratio": 0.49, "density": "1000 kg/m^3"}
    over = {
        "target.material": ["mild steel", soft, "mild steel", "mild steel"],
        "contact.law": ["big-alabo", "hertz", "hertz", "big-alabo"],  # the soft material has no yield strength
        "impactor.velocity": ["0.2 m/s", "0.3 m/s", "0.2 m/s", "0.3 m/s"],
    }
    ds = fd.sweep(BALL, over, "zip")
    assert fd.validate(ds) == []
    assert ds["contact_law"].values.tolist() == [0, 1, 1, 0] and ds["target_material"].values.tolist() == [0, 1, 0, 0]
    for k in range(4):
        one = fm.simulate(BALL.replace({path: values[k] for path, values in over.items()}))
        assert ds["maximum_force"].values[k] == pytest.approx(one.maximum_force.magnitude, rel=1e-4)
        assert ds.film.scene(impact=k) == one.scene
    many = {
        "impactor.material.name": [f"a{k}" for k in range(200)],
        "target.material.name": [f"b{k}" for k in range(200)],
    }
    assert fd.sweep(BALL, many, "zip").sizes["impact"] == 200  # the 200 rows, not the 40000 combinations
    drawn = fd.sweep(BALL, {"contact.law": ["hertz", "hertz", "hertz", "big-alabo"]}, "latin-hypercube", samples=400)
    assert int((drawn["contact_law"] == 0).sum()) == 300
    with pytest.raises(fm.SceneError, match=r"over\.contact\.law: no contact law is called"):
        fd.sweep(BALL, {"contact.law": ["hertz", "hurtz"]}, "zip")


def test_a_dataset_has_the_constants_of_its_scenes() -> None:
    """Mass, radius, velocity, modulus, strength, energy and law as scalars, if no swept quantity changes them."""
    history = fm.simulate(BALL)
    one = fd.to_dataset(history)
    expected = {"mass": BALL.mass, "radius": BALL.impactor.radius, "approach_velocity": BALL.approach_velocity}
    expected |= {"effective_modulus": BALL.effective_modulus, "yield_strength": BALL.yield_strength}
    expected |= {"impact_energy": 0.5 * BALL.mass * BALL.approach_velocity**2}
    assert {name: one[name].item() for name in expected} == expected
    assert one["contact_law_name"].item() == history.problem.law.name
    ds = fd.sweep(BALL, {"impactor.velocity": ["1 m/s", "2 m/s"], "contact.law": ["hertz", "stronge"]})
    kept = {name for name in (*expected, "contact_law_name") if name in ds}
    assert kept == {"mass", "radius", "effective_modulus", "yield_strength"}
    assert all(ds[name].dims == () and ds[name].item() == expected[name] for name in kept)
    even = {"from": -0.4, "to": 0.4, "count": 3}  # 1 - ν² is the same at both ends
    assert "effective_modulus" not in fd.sweep(BALL, {"target.material.poissons_ratio": even})
    assert "mass" not in fd.sweep(BALL, {"impactor.mass": {"normal": ["50 g", "1 g"]}}, "sobol", samples=2)
    line = ds["maximum_force"].sel(contact_law="stronge")
    assert line.values == pytest.approx(
        [fm.simulate(BALL.replace({"contact.law": "stronge", "impactor.velocity": v})).summary["maximum_force"]
         for v in ("1 m/s", "2 m/s")], rel=1e-4,
    )  # fmt: skip


@pytest.mark.parametrize("how", [{"data_vars": "minimal", "compat": "override"}, {"data_vars": "all"}])
def test_an_impact_of_joined_sweeps_is_never_run_with_another_scene(how: dict) -> None:
    heavy = BALL.replace({"impactor.mass": "500 g"})
    over = {"impactor.velocity": ["1 m/s", "2 m/s"]}
    with xr.set_options(use_new_combine_kwarg_defaults=True):
        joined = xr.concat([fd.sweep(scene, over, "zip") for scene in (BALL, heavy)], "impact", **how)
    assert joined.film.scene(impact=1).mass == BALL.mass
    for call in (joined.film.scene, joined.film.history):
        with pytest.raises(ValueError, match="datasets of different scenes were joined"):
            call(impact=2)
    with pytest.raises(ValueError, match="datasets of different scenes were joined"):
        joined.film.scene()
    laws = [fd.sweep(BALL, {"contact.law": words}, "zip") for words in (["hertz", "stronge"], ["big-alabo", "hertz"])]
    with pytest.raises(ValueError, match="datasets of different scenes were joined"):
        xr.concat(laws, "impact", data_vars="all").film.scene(impact=2)
    runs = xr.concat(
        [fd.to_dataset(fm.simulate(scene)) for scene in (BALL, heavy)],
        "run",
        join="outer",
        data_vars="all",
        coords="minimal",
        compat="override",
    )
    with pytest.raises(ValueError, match="datasets of different scenes were joined"):
        runs.isel(run=1).film.history()
    same_scene = [fd.sweep(BALL, {"impactor.velocity": [v]}, "zip") for v in ("1 m/s", "2 m/s")]
    assert xr.concat(same_scene, "impact", data_vars="all").film.scene(impact=1).impactor.velocity == 2.0


def test_sections_of_one_law_have_different_labels() -> None:
    over = {"contact": [{"law": "hunt-crossley", "restitution": e} for e in (0.7, 0.8)]}
    ds = fd.sweep(BALL, over)
    assert ds["contact"].values.tolist() == ["hunt-crossley_restitution_0.7", "hunt-crossley_restitution_0.8"]
    assert ds["coefficient_of_restitution"].values == pytest.approx([0.7, 0.8], rel=1e-4)


def test_validate_finds_any_damage() -> None:
    ds = fd.sweep(BALL, SPEEDS, keep="segments")
    assert fd.validate(ds.isel(impactor_velocity=slice(0, 0)))
    begun = ds.copy(deep=True)
    begun["segment_begin"].values[5] += 1
    begun.attrs["content_sha256"] = fd.content_sha256(begun)
    assert fd.validate(begun) == ["segment_begin is not the sum of the segment_count before"]
    foreign = xr.Dataset(attrs={"film_model_schema": "impact_measurement", "measured": "nothing"})
    assert fd.validate(foreign) == ["attribute measured is 'nothing', not 'history', 'impacts' or 'values'"]


def test_a_damped_contact_that_does_not_end_has_no_dent() -> None:
    plate = {"kind": "plate", "material": "mild steel", "thickness": "2 mm"}
    thin = BALL.replace({"target": plate, "contact": {"law": "hunt-crossley", "restitution": 0.8}})
    ds = fd.sweep(thin, {"impactor.velocity": ["0.1 m/s"]})
    assert ds["status"].item() == 0 and np.isnan(ds["permanent_indentation"].item())
    assert fm.simulate(thin).summary["permanent_indentation"] is None


@pytest.mark.slow
def test_a_zarr_folder_is_drawn_and_takes_the_place_of_a_file(tmp_path: Path, file: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("zarr")
    (tmp_path / "out.zarr").write_text("an old file", encoding="utf-8")
    assert main(["sweep", str(file), "--output", str(tmp_path / "out.zarr"), "--force"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.zarr", "sweep.toml"]
    over = "impactor_velocity, target_material_yield_strength"
    assert main(["plot", f"{tmp_path / 'out.zarr'}/", "--over", over]) == 0
    assert (tmp_path / "out.png").is_file()
    assert main(["plot", str(tmp_path / "out.zarr"), "--force", "--over", "impactor_velocity,impactor_velocity"]) == 3


@pytest.mark.slow
def test_a_folder_that_is_no_store_is_not_replaced(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, file: Path
) -> None:
    pytest.importorskip("zarr")
    output = tmp_path / "out.zarr"
    output.mkdir()
    (output / "thesis.tex").write_text("precious", encoding="utf-8")
    for force in ([], ["--force"]):
        status, _, err = cli(capsys, "sweep", file, "--output", output, *force)
        assert status == 3 and "is a folder but not a Zarr store, and is not replaced" in err
    assert [path.name for path in output.iterdir()] == ["thesis.tex"]
    (output / "thesis.tex").unlink()
    output.rmdir()
    assert cli(capsys, "sweep", file, "--output", output)[0] == 0
    assert cli(capsys, "sweep", file, "--output", output)[2] == f"{output}: exists; use --force to replace it\n"
    assert cli(capsys, "sweep", file, "--output", output, "--force")[0] == 0
    with pytest.raises(FileExistsError, match=r"exists; use overwrite=True to replace it$"):
        fd.sweep(BALL, SPEEDS, output=output)


def test_a_finished_output_of_another_sweep_is_not_reused(tmp_path: Path) -> None:
    target = tmp_path / "s.nc"
    fd.sweep(BALL, SPEEDS, keep="samples=11", output=target).close()
    with pytest.raises(FileExistsError, match="is not the finished output of this sweep"):
        fd.sweep(BALL, SPEEDS, keep="samples=21", output=target, resume=True)
    with fd.sweep(BALL, SPEEDS, keep="samples=11", output=target, resume=True) as ds:
        assert ds.sizes["normalised_time"] == 11
        for place in (1.5, -1, 40):
            with pytest.raises(KeyError, match="impactor_velocity is missing"):
                ds.film.scene(impact=place)
    drawn = fd.sweep(BALL, {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}}, "random", samples=4)
    for place in (1.5, -1, 4, "1"):
        with pytest.raises(KeyError, match="must be from 0 to 3"):
            drawn.film.scene(impact=place)

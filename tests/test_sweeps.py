"""Sweeps: what they contain, rows that fail, and `ds.film`."""

from __future__ import annotations

import math
import os
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import combinations
from sweep_cases import BALL, PLATE, SCENES, SPEEDS, same

import film_datasets as fd
import film_model as fm
from film_datasets.schema import OUT_OF_RANGE, pieces
from film_datasets.sweeps import read_sweep, run_sweep
from film_model.base.threads import available_cores
from film_model.solve.history import MOTION, SUMMARY


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


@pytest.mark.slow
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
    assert 1e-9 < ds.attrs["estimated_accuracy"] <= 1e-3
    assert "was not reached" not in ds.attrs["warnings"]
    out = fd.sweep(BALL, {**SPEEDS, "solver.accuracy": [1e-4, 1e-14]})
    assert out.attrs["requested_accuracy"] == 1e-4
    (told,) = (line for line in out.attrs["warnings"].split("\n") if "was not reached" in line)
    assert told.startswith("accuracy 1e-14 was not reached in 40 impacts")
    estimated = float(told.rpartition(" ")[2])
    assert 1e-14 < estimated < 1e-10
    mixed = fd.sweep(BALL, {**SPEEDS, "solver": [{"accuracy": 1e-4}, {"segments": 9}]})
    assert "requested_accuracy" not in mixed.attrs and fd.validate(mixed) == []


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
    with pytest.raises(KeyError, match='"speed" is not one of these'):
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
    with pytest.raises(KeyError, match='contact_law "big-alabo": there are stronge, hertz'):
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
    kinds = "'history', 'impacts', 'values', 'finite_elements' or 'finite_element_pairs'"
    assert fd.validate(foreign) == [f"attribute measured is 'nothing', not {kinds}"]


def test_a_damped_contact_that_does_not_end_has_no_dent() -> None:
    plate = {"kind": "plate", "material": "mild steel", "thickness": "2 mm"}
    thin = BALL.replace({"target": plate, "contact": {"law": "hunt-crossley", "restitution": 0.8}})
    ds = fd.sweep(thin, {"impactor.velocity": ["0.1 m/s"]})
    assert ds["status"].item() == 0 and np.isnan(ds["permanent_indentation"].item())
    assert fm.simulate(thin).summary["permanent_indentation"] is None


@pytest.mark.slow
def test_all_impacts_are_sampled_at_once() -> None:
    """As each by itself from its segments; of a selection, of zipped and of failed impacts too."""
    ds = fd.sweep(BALL, {**SPEEDS, "contact.law": ["hertz", "stronge"]}, keep="segments")
    times = ["20 us", "0 s", "2 ms"]
    together = ds.film.sample(times)
    assert ds["segment_count"].attrs["sample_dimension"] == "segment" and "indentation" in ds.attrs["keywords"]
    for law in ("hertz", "stronge"):
        for speed in ds["impactor_velocity"].values.tolist():
            where = {"impactor_velocity": speed, "contact_law": law}
            alone = ds.film.sample(times, **where)
            for name in ("contact_force", "indentation", "impactor_velocity"):
                assert together[f"sampled_{name}"].sel(where).values.tolist() == alone[name].values.tolist()
    some = ds.sel(contact_law="stronge").isel(impactor_velocity=[1, 2]).film.sample(times)
    assert some["sampled_contact_force"].dims == ("impactor_velocity", "t")
    assert float(some["sampled_contact_force"][0, 0]) == float(together["sampled_contact_force"][1, 1, 0])
    over = {"impactor.velocity": ["1 m/s", "1 m/s"], "impactor.mass": ["1 kg", "2 kg"]}
    zipped = fd.sweep(BALL, over, design="zip").film.sample(["20 us"])["sampled_indentation"].values
    assert zipped[0, 0] < zipped[1, 0]
    drawn = fd.sweep(BALL, {"impactor.velocity": {"normal": ["1 m/s", "2 m/s"]}}, design="random", samples=40)
    force = drawn.film.sample(["5 us"])["sampled_contact_force"]
    assert (np.isnan(force[:, 0]) == (drawn["status"] != 1)).all() and np.isnan(force).any()
    plate = BALL.replace(
        {"target": {"kind": "plate", "material": "mild steel", "thickness": "5 mm", "size": ["9 cm"] * 2}}
    )
    ringing = fd.sweep(plate, {"impactor.velocity": ["0.5 m/s", "1 m/s"]})
    one = ringing.film.history(impactor_velocity=float(ringing.impactor_velocity[1])).sample("5 us")
    assert float(ringing.film.sample(["5 us"])["sampled_contact_force"][1, 0]) == one.contact_force.magnitude
    with pytest.raises(ValueError, match="variable segment_phi missing"):
        ds.drop_vars("segment_phi").film.sample(times, impactor_velocity=0.1, contact_law="hertz")

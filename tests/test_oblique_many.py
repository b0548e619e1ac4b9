"""Oblique impacts in batches, sweeps and datasets: the numbers of `simulate`, and the files that hold them."""

import json
import math
import warnings

import numpy as np
import pytest
from cases import knots_of
from scipy.integrate import trapezoid

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main
from film_model.core import springs
from film_model.oblique.result import MOTION, OBLIQUE, REGIMES
from film_model.oblique.springs import STEPS, TURN
from film_model.scene import Solver
from film_model.solve.batch import simulate_many
from film_model.solve.simulate import simulate_quietly

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}


def slanted(angle="30 deg", law="hertz", mu=0.2, target=None, **ball):
    sphere = fm.Sphere("5 mm", "3 m/s", material=STEEL, angle=angle, **ball)
    return fm.Scene(sphere, target or fm.HalfSpace(STEEL), fm.Contact(law, friction=mu), fm.Effects(gravity=False))


TARGETS = {
    "half-space": {},
    "body": {"target": fm.Body(STEEL, radius="8 mm", velocity="-1 m/s", spin="-90 rad/s")},
    "rod": {"target": fm.Rod(STEEL, diameter="12 mm")},
    "spin": {"spin": "-300 rad/s", "shape": "shell"},
}


def speeds(values):
    return [f"{value!r} m/s" for value in values]


@pytest.mark.parametrize("case", TARGETS)
def test_a_batch_has_the_numbers_of_single_impacts(case):
    scene, values = slanted(**TARGETS[case]), np.geomspace(0.05, 20.0, 7).tolist()
    many = fm.simulate_batch(scene, velocity=speeds(values), accuracy=1e-8)
    for row, text in enumerate(speeds(values)):
        one = fm.simulate(scene.replace({"impactor.velocity": text})).oblique
        assert many.oblique["sliding_regime"][row] == one.sliding_regime
        assert many.oblique["estimated_error"][row] == pytest.approx(one.estimated, rel=1e-12)
        for name, value in one.summary.items():
            close = 1e-5 if name == "rebound_angle" else 1e-14  # that of the normal motion on another mesh
            assert many.oblique[name][row] == pytest.approx(value, rel=close), name


def test_at_usual_accuracies_a_table_serves_within_its_error():
    rng, count = np.random.default_rng(8), 1500
    scene = slanted(shape="shell")
    columns = {"impactor.velocity": rng.uniform(0.1, 5.0, count), "impactor.angle": rng.uniform(1e-3, 1.2, count)}
    quick, exact = (simulate_many(scene, columns, Solver(accuracy)).oblique for accuracy in (1e-4, 1e-8))
    before = columns["impactor.velocity"] * np.sin(columns["impactor.angle"])
    off = quick.summary["contact_point_rebound_velocity"] - exact.summary["contact_point_rebound_velocity"]
    assert (np.abs(off) <= quick.estimated * before).all() and (quick.regime == exact.regime).all()
    for name in ("maximum_friction_force", "time_of_maximum_friction_force"):
        assert quick.summary[name] == pytest.approx(exact.summary[name], rel=3e-8)
    rows = [5, 700]  # bits do not depend on the neighbours
    few = simulate_many(scene, {name: values[rows] for name, values in columns.items()}, Solver(1e-4)).oblique
    assert all(np.array_equal(few.summary[name], quick.summary[name][rows], equal_nan=True) for name in few.summary)


def test_a_batch_without_friction_has_no_tangential_part():
    assert fm.simulate_batch(slanted(mu=None), velocity=["1 m/s"]).oblique == {}


@pytest.mark.parametrize("angle", ["3 deg", "15 deg", "70 deg"])
def test_impacts_that_yield_are_solved_by_springs_in_a_batch_too(angle):
    """Within the estimates; by fewer springs than one impact alone, whatever the neighbours."""
    scene, values = slanted(angle, law="auto", target=fm.HalfSpace("mild steel")), [0.005, 0.3, 2.0]
    many = fm.simulate_batch(scene, velocity=speeds(values)).oblique
    assert many["estimated_error"][0] <= 1e-8 < many["estimated_error"][1]
    for row, value in enumerate(values):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            one = fm.simulate(scene.replace({"impactor.velocity": f"{value} m/s"})).oblique
        assert many["sliding_regime"][row] == one.sliding_regime
        before, error = one.motion["sliding_velocity"][0], many["estimated_error"][row] + one.estimated
        after = one.summary["contact_point_rebound_velocity"]
        assert many["contact_point_rebound_velocity"][row] == pytest.approx(after, abs=error * before) and error < 2e-3
        assert many["maximum_friction_force"][row] == pytest.approx(one.summary["maximum_friction_force"], rel=5e-3)
    fewer = fm.simulate_batch(scene, velocity=speeds(values[1:])).oblique["tangential_impulse"]
    assert fewer.tolist() == many["tangential_impulse"][1:].tolist()
    finer = fm.simulate_batch(scene, velocity=speeds(values[1:]), accuracy=1e-5).oblique["tangential_impulse"]
    assert finer == pytest.approx(fewer, rel=1e-3)


@pytest.mark.parametrize("angle", ["10 deg", "25 deg", "80 deg"])
def test_batches_and_sweeps_have_the_bounds_of_contacts_that_yield(angle):
    """At the accuracy of most springs they lie within those of single impacts, but for the error of the turn in even
    steps; by fewer both models of these lie within."""
    scene = slanted(angle, law="elastoplastic", target=fm.HalfSpace("mild steel"))
    values, names = [0.5, 3.0, 8.0], ["sliding_after_low", "sliding_after_high"]
    coarse, fine = (fm.simulate_batch(scene, velocity=speeds(values), accuracy=a).oblique for a in (1e-4, 1e-8))
    for row, text in enumerate(speeds(values)):
        one = simulate_quietly(scene.replace({"impactor.velocity": text}), accuracy=1e-8).oblique
        before, error = one.motion["sliding_velocity"][0], coarse["estimated_error"][row]
        low, high = (coarse[name][row] for name in names)
        turn, (least, most) = TURN / STEPS * before, (fine[name][row] for name in names)
        assert one.low - turn <= least < most <= one.high + turn and most - least > one.high - one.low - 4.0 * turn
        assert low <= coarse["contact_point_rebound_velocity"][row] <= high
        assert low - error * before <= one.low < one.high <= high + error * before
    ds = fd.sweep(scene.replace({"solver.accuracy": 1e-4}), {"impactor.velocity": speeds(values)})
    assert fd.validate(ds) == [] and all(ds[name].values.tolist() == coarse[name].tolist() for name in names)
    plain = fm.simulate_batch(slanted(), velocity=["1 m/s"]).oblique
    assert all(np.isnan(plain[name][0]) and plain[name].shape == (1,) for name in names)


WALTON = {"loading_stiffness": "40 MN/m", "unloading_stiffness": "80 MN/m"}
ON_BEAM = fm.Beam("mild steel", "300 mm", "30 mm", "10 mm", static_stiffness="20 MN/m")
OWN_CURVES = {
    "numbers": (fm.Contact("walton-braun", friction=0.2, **WALTON), "contact.unloading_stiffness", [5e7, 7e7, 9e7]),
    "shape": (fm.Contact("elastoplastic", friction=0.2), "impactor.radius", [4e-3, 5e-3]),
    "spring": (fm.Contact("elastoplastic", friction=0.2), "impactor.radius", [4e-3, 5e-3], ON_BEAM),
}


@pytest.mark.parametrize("differ", OWN_CURVES)
def test_springs_beside_curves_of_their_own_have_the_results_of_single_impacts(differ):
    contact, path, values, *target = OWN_CURVES[differ]
    ball = fm.Sphere("5 mm", "1 m/s", material="mild steel", angle="15 deg")
    scene = fm.Scene(ball, *(target or [fm.HalfSpace("mild steel")]), contact, fm.Effects(gravity=False))
    many = simulate_many(scene, {path: np.array(values)}, Solver(1e-4))
    for row, value in enumerate(values):
        unit = "N/m" if "stiffness" in path else "m"
        one = simulate_quietly(scene.replace({path: f"{value!r} {unit}"})).oblique
        error = (one.estimated + many.oblique.estimated[row]) * one.motion["sliding_velocity"][0]
        after = one.summary["contact_point_rebound_velocity"]
        found = many.oblique.summary["contact_point_rebound_velocity"][row]
        assert found == pytest.approx(after, rel=0.0, abs=error)
        # springs are refined to 1e-3 where a law yields; of the normal force's error of up to 1e-4 twice comes on top
        assert many.oblique.estimated[row] < 1.2e-3


@pytest.mark.parametrize("power", [0.0, 2.0, 3.0])
def test_neighbours_that_slip_longer_change_no_bit(power):
    """Springs of contacts that slide side by side are skipped until the first of these sticks."""
    count, knots = 40, 31
    legs = np.array([[1.0, 2.0, 0.0]]) * np.geomspace(0.5, 2.0, count)[:, None]
    half = np.sin(0.5 * np.pi * knots_of(knots, legs) / legs[:, :1])
    half = np.maximum(half, 0.0)
    force, radius = half**1.5, half ** (0.5 if power > 0.0 else 0.0)
    numbers = np.stack(
        [*np.full((3, count), [[1.0], [power], [0.3]]), np.geomspace(0.01, 20.0, count), *legs.T], axis=1
    )
    friction = np.stack([np.zeros(count), np.full(count, 0.3)], axis=1)[:, None]
    given = 32, 64, friction, numbers, force, radius
    many = springs.many(np.arange(count), *given)
    assert len({*many["regime"]}) > 1 and many["regime"][-1] == 2
    for row in range(count):
        assert springs.many(np.array([row]), *given)[0] == many[row]
    slides = many["regime"] == 2
    after = numbers[:, 3] - 0.3 * trapezoid(force, knots_of(knots, legs), axis=1) / 0.3
    assert many["velocity"][slides] == pytest.approx(after[slides], abs=1e-3)


def test_friction_that_is_not_known_is_refused_in_a_batch():
    sticky = fm.Contact("jkr", work_of_adhesion="0.1 J/m^2", friction=0.2)
    scene = slanted()
    with pytest.raises(fm.SimulationError, match="friction under adhesion that pulls is not supported"):
        fm.simulate_batch(fm.Scene(scene.impactor, scene.target, sticky), velocity=["1 m/s"])


def test_nothing_slides_in_some_impacts():
    many = fm.simulate_batch(slanted("0 deg"), velocity=["1 m/s", "2 m/s"])
    assert np.isnan(many.oblique["rebound_spin"]).all() and (many.oblique["sliding_regime"] == "").all()


OVER = {"impactor.angle": ["0 deg", "10 deg", "40 deg", "80 deg"], "contact.friction": ["0", "0.1", "0.3"]}


def test_a_sweep_has_the_results_of_single_impacts():
    scene = slanted(spin="100 rad/s").replace({"solver.accuracy": 1e-8})
    ds = fd.sweep(scene, OVER)
    assert fd.validate(ds) == []
    for i, angle in enumerate(OVER["impactor.angle"]):
        for k, mu in enumerate(OVER["contact.friction"]):
            one = fm.simulate(scene.replace({"impactor.angle": angle, "contact.friction": mu})).oblique
            found = ds.isel(impactor_angle=i, contact_friction=k)
            assert REGIMES[int(found["sliding_regime"])] == one.sliding_regime
            assert float(found["estimated_friction_error"]) == pytest.approx(one.estimated, rel=1e-9)
            for name, value in one.summary.items():
                close = 1e-5 if name == "rebound_angle" else 1e-13
                assert float(found[name]) == pytest.approx(value, rel=close, abs=1e-18, nan_ok=True), name


def test_a_sweep_where_nothing_slides_or_not_at_all_and_its_choice_of_variables():
    ds = fd.sweep(slanted(), {"impactor.angle": ["0 deg", "10 deg"]}, keep="segments", variables=["rebound_spin"])
    assert np.isnan(ds["rebound_spin"][0]) and ds["sliding_regime"].values.tolist() == [-1, 0]
    assert "friction_work" not in ds and fd.validate(ds) == []
    plain = fd.sweep(slanted(mu=None), {"impactor.velocity": ["1 m/s", "2 m/s"]})
    assert "sliding_regime" not in plain and plain.attrs["kept"] == "summary"


@pytest.mark.slow
def test_the_command_prints_and_writes_the_results_of_a_sweep(tmp_path, capsys):
    (tmp_path / "ball.toml").write_text(slanted().to_toml(), encoding="utf-8")
    over = '[over]\n"impactor.angle" = ["10 deg", "40 deg", "80 deg"]\n'
    (tmp_path / "sweep.toml").write_text('scene = "ball.toml"\ndesign = "grid"\n' + over, encoding="utf-8")
    assert main(["sweep", str(tmp_path / "sweep.toml"), "--output", str(tmp_path / "out.nc")]) == 0
    printed = capsys.readouterr().out
    assert "rebound spin" in printed and "friction work" in printed
    with fd.open(tmp_path / "out.nc") as ds:
        assert fd.validate(ds) == []
        mean = float(ds["friction_work"].mean())
    assert main(["summarise", str(tmp_path / "out.nc"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["summary"]["friction_work"]["mean"] == pytest.approx(mean, rel=1e-12)
    assert main(["convert", str(tmp_path / "out.nc"), str(tmp_path / "out.csv")]) == 0
    heads = (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "friction_work [J]" in heads and "sliding_regime" in heads


@pytest.mark.slow
@pytest.mark.parametrize("scene", [slanted(), slanted("5 deg", law="elastoplastic", target=fm.HalfSpace("mild steel"))])
def test_the_dataset_of_a_history_holds_its_friction(scene, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        history = fm.simulate(scene)
    ds = history.to_dataset()
    assert fd.validate(ds) == [] and ds.attrs["film_model_schema_version"] == "1.7"
    assert set(OBLIQUE) <= set(ds.variables) and ds["friction_time"].size == history.oblique.motion["time"].size
    fd.write(ds, tmp_path / "oblique.nc")
    with fd.open(tmp_path / "oblique.nc") as stored:
        assert fd.validate(stored) == []
        read = fd.history_of(stored).oblique
    assert read == history.oblique and read.events == history.oblique.events
    for name in MOTION:
        assert np.array_equal(read.motion[name], history.oblique.motion[name], equal_nan=True)
    assert fd.validate(ds.drop_vars("friction_work")) == ["variable friction_work is missing"]


def test_a_history_without_friction_has_none_in_its_dataset():
    ds = fm.simulate(slanted(mu=None)).to_dataset()
    assert "sliding_regime" not in ds and fd.history_of(ds).oblique is None and fd.validate(ds) == []


def test_balances_over_the_recorded_motion():
    """Momentum and displacement are the integrals of force and velocity; the area that sticks lies in the contact."""
    history = fm.simulate(slanted("20 deg"))
    motion, found = history.oblique.motion, history.oblique.summary
    impulse = np.trapezoid(motion["friction_force"], motion["time"])
    assert impulse == pytest.approx(found["tangential_impulse"], rel=1e-3)
    moved = np.trapezoid(motion["sliding_velocity"], motion["time"])
    assert motion["sliding_displacement"][-1] == pytest.approx(
        moved, abs=3e-3 * abs(motion["sliding_displacement"]).max()
    )
    radius = math.sqrt(history.scene.effective_radius * history.summary["maximum_indentation"])
    assert 0.9 * radius < motion["stick_radius"].max() <= radius * (1.0 + 1e-6)

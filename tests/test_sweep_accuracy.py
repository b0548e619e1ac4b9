"""What a sweep's `estimated_accuracy` promises: a bound of each impact's own error, which hard impacts do not share."""

import dataclasses

import numpy as np
import pytest
from scipy.stats import qmc

import film_datasets as fd
import film_model as fm
from film_model.problem.summary import SUMMARY
from film_model.solve.batch import simulate_many

BALL = fm.Sphere("10 mm", velocity="0.25 m/s", mass="60.74 g", material="WC, Big-Alabo 2017")
PLATE = fm.Plate("mild steel", "5 mm")
RELATIVE = ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "contact_duration")


def drawn(count, *ranges):
    """Sobol points, log-uniform between the ends of each range."""
    u = qmc.Sobol(len(ranges), rng=1).random(count)
    return [low * (high / low) ** u[:, k] for k, (low, high) in enumerate(ranges)]


def errors(result, exact):
    """Largest relative error of each impact: of the values that are not small differences, and of the restitution."""
    worst = np.zeros(result.status.size)
    for name in (*RELATIVE, "coefficient_of_restitution"):
        value, true = result.summary[name], exact.summary[name]
        scale = np.maximum(np.abs(true), 1e-3) if name == "coefficient_of_restitution" else np.abs(true)
        off = np.where(np.isnan(value) != np.isnan(true), 1.0, np.nan_to_num(np.abs(value - true) / scale))
        worst = np.maximum(worst, off)
    return worst


def speeds_and_masses(count):
    velocity, mass = drawn(count, (0.05, 20.0), (5e-3, 0.5))
    return {"impactor.velocity": velocity, "impactor.mass": mass}


@pytest.mark.parametrize("law", ["kogut-etsion", "hertz", "stronge", "big-alabo"])
def test_the_estimate_of_an_impact_bounds_its_error(law):
    """On a plate, where a few impacts need many times the segments of the others."""
    given = {"hardness": "2.8 GPa"} if law == "kogut-etsion" else {}
    scene = fm.Scene(BALL, PLATE, fm.Contact(law, **given), fm.Effects(gravity=False, boundary_reflections=False))
    columns = speeds_and_masses(4096)
    found, exact = (simulate_many(scene, columns, fm.Solver(accuracy=a)) for a in (1e-4, 1e-6))
    assert np.nanmax(found.estimated) <= 1e-4
    assert np.mean(errors(found, exact) > found.estimated + 1e-6) <= 1e-3
    assert len(np.unique(found.segments[:, 0])) > 1 or law == "hertz"  # refined only where it is needed


@pytest.mark.parametrize("law", ["stronge", "hertz"])
def test_the_estimate_bounds_the_error_under_a_weight(law):
    """A leg that was aimed at a turn which the motion passes once took one line to the end of contact on any mesh."""
    scene = fm.Scene(BALL, PLATE, fm.Contact(law), fm.Effects(gravity=True, boundary_reflections=False))
    columns = speeds_and_masses(512)
    found, exact = (simulate_many(scene, columns, fm.Solver(accuracy=a)) for a in (1e-4, 1e-6))
    assert np.mean(errors(found, exact) > found.estimated + 1e-6) <= 2e-3
    least = int(np.nanargmin(found.summary["coefficient_of_restitution"]))
    values = {
        path: f"{float(column[least])!r} {unit}"
        for (path, column), unit in zip(columns.items(), ("m/s", "kg"), strict=True)
    }
    alone = fm.simulate(scene.replace(values), accuracy=1e-6).summary["coefficient_of_restitution"]
    assert found.summary["coefficient_of_restitution"][least] == pytest.approx(alone, rel=1e-3)


def test_the_estimate_bounds_what_is_reported_of_impacts_that_rest():
    """They swing on their weight until the time limit. The work at that moment, which has no meaning and is not part of
    the summary, is wrong by four times the estimate, on meshes of 6 and 11 segments alike."""
    ball = fm.Sphere("0.45872 mm", velocity="60 um/s", mass="50.48 mg", material="bearing steel")
    effects = fm.Effects(gravity=True, boundary_reflections=False, rate_hardening=False)
    law = fm.Contact("stronge", yield_strength="0.6 GPa")
    scene = fm.Scene(ball, fm.Rod("mild steel", "1.73918 mm"), law, effects)
    columns = {"impactor.velocity": np.geomspace(5.5e-5, 7e-5, 10)}
    found, exact = (simulate_many(scene, columns, fm.Solver(accuracy=a)) for a in (1e-4, 1e-6))
    for name in ("energy_absorbed", "coefficient_of_restitution"):
        assert np.isnan(found.summary[name]).all() and np.isnan(exact.summary[name]).all()
    for name in ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "time_impactor_stops"):
        off = np.abs(found.summary[name] / exact.summary[name] - 1.0)
        assert (off <= found.estimated + 1e-6).all()


def test_one_hard_impact_does_not_set_the_mesh_of_all():
    """Impacts from 0.1 mm/s to 100 m/s, 1 mg to 100 kg, on balls of 0.1 mm to 1 m."""
    velocity, mass, radius = drawn(512, (1e-4, 100.0), (1e-6, 100.0), (1e-4, 1.0))
    scene = fm.Scene(BALL, PLATE, fm.Contact("hertz"), fm.Effects(boundary_reflections=False))
    columns = {"impactor.velocity": velocity, "impactor.mass": mass, "impactor.radius": radius}
    found = simulate_many(scene, columns)
    assert np.median(found.segments[:, 0]) * 4 <= found.segments[:, 0].max()


def test_a_sweep_holds_the_estimate_of_each_impact():
    scene = fm.Scene(BALL, PLATE, fm.Contact("big-alabo"), fm.Effects(boundary_reflections=False))
    ds = fd.sweep(scene, {"impactor.velocity": {"from": "0.05 m/s", "to": "20 m/s", "count": 50}})
    each = ds["estimated_accuracy"]
    assert each.dims == ds["maximum_force"].dims and fd.validate(ds) == []
    assert 0.0 < float(each.min()) < float(each.max()) == ds.attrs["estimated_accuracy"] <= 1e-4


def test_segments_of_impacts_on_different_meshes_are_recorded():
    """The slowest have their weight: lanes find their depth, recorded lines differ by less than the accuracy."""
    law = fm.Contact("big-alabo", yield_strength="250 MPa")
    scene = fm.Scene(BALL, PLATE, law, fm.Effects(boundary_reflections=False))
    values = {"impactor.velocity": {"from": "0.05 m/s", "to": "20 m/s", "count": 200, "spacing": "log"}}
    ds = fd.sweep(scene, values, keep="segments")
    assert len(np.unique(ds["segment_count"])) > 3
    for k in (0, 61, 199):
        time = float(ds["time_of_maximum_indentation"][k])
        at = ds.film.sample([time], impactor_velocity=float(ds["impactor_velocity"][k]))
        assert float(at["indentation"][0]) == pytest.approx(
            float(ds["maximum_indentation"][k]), rel=1e-5 if k == 0 else 1e-9
        )


@pytest.mark.parametrize("law", ["big-alabo", "stronge"])
def test_recorded_lines_are_as_accurate_as_the_summary_on_a_half_space(law):
    """The summary there comes from quadrature: on as few segments, recorded lines would be 100 times less accurate."""
    scene = fm.Scene(BALL, fm.HalfSpace("S235"), fm.Contact(law), fm.Effects(boundary_reflections=False))
    scene = dataclasses.replace(scene, solver=fm.Solver(accuracy=1e-7))
    values = {"impactor.velocity": {"from": "0.05 m/s", "to": "20 m/s", "count": 8, "spacing": "log"}}
    ds = fd.sweep(scene, values, keep="segments")
    for time, speed in zip(ds["time_of_maximum_indentation"].values, ds["impactor_velocity"].values, strict=True):
        at = ds.film.sample([float(time)], impactor_velocity=float(speed))
        assert abs(float(at["impactor_velocity"][0])) < 2e-7 * speed


def test_rounding_is_part_of_the_estimate():
    """An elastic contact gives its energy back. Where the weight does 1e10 times the work of the impact, or a clearance
    is 3e7 times as deep as the contact, the restitution is only rounding, and the estimate says so."""
    heavy = fm.Sphere("10 mm", velocity="0.1 um/s", mass="600 kg", material="WC, Big-Alabo 2017")
    law = fm.Contact("meyer", stiffness="1e9 N/m^1.5", exponent=1.5, initial_indentation="1 km")
    free = fm.Effects(gravity=False, target_motion=False)
    weighed = fm.Scene(heavy, fm.HalfSpace("mild steel"), fm.Contact("hertz"), fm.Effects(gravity=True))
    for scene in (weighed, fm.Scene(BALL, fm.HalfSpace("mild steel"), law, free)):
        history = fm.simulate(scene, accuracy=1e-6)
        off = abs(history.summary["coefficient_of_restitution"] - 1.0)
        assert 1e-6 < off <= history.accuracy.estimated
        assert any("is not reached" in warning for warning in history.warnings)
        many = fm.simulate_batch(scene, velocity=[f"{scene.impactor.speed!r} m/s"], accuracy=1e-6)
        assert many.estimated_accuracy[0] > 1e-6


def test_rounding_is_small_in_usual_impacts():
    for law in ("hertz", "big-alabo", "stronge"):
        for target in (PLATE, fm.HalfSpace("mild steel")):
            history = fm.simulate(fm.Scene(BALL, target, fm.Contact(law)), accuracy=1e-11)
            assert history.accuracy.estimated <= 1e-11


def test_every_summary_value_of_a_failed_impact_is_nan():
    scene = fm.Scene(BALL, fm.HalfSpace("mild steel"), fm.Contact("jackson-green", yield_strength="250 MPa"))
    found = simulate_many(scene, {"impactor.velocity": np.array([0.1, 1e4, 5.0])})
    failed = found.status < 0
    assert failed.any()
    for name in SUMMARY:
        assert np.isnan(found.summary[name][failed]).all()
    assert np.isnan(found.estimated[failed]).all() and (found.estimated[~failed] <= 1e-4).all()

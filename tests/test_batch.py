"""Batches give what single runs give."""

import math
import threading

import numpy as np
import pytest
from cases import LAWS, scene, zener_scene

import film_model as fm
from film_model.core import native
from film_model.curve import curve_of
from film_model.history import SUMMARY


@pytest.mark.parametrize("target", ["half-space", "plate", "thin plate"])
@pytest.mark.parametrize("law", list(LAWS))
def test_batch_keeps_its_accuracy_for_every_impact(law, target):
    speeds = np.geomspace(0.02, 1.5, 37)
    batch = fm.simulate_batch(scene(law, target), velocity=[f"{v!r} m/s" for v in speeds.tolist()], accuracy=1e-5)
    assert batch.estimated <= 1e-5
    assert not batch.failed.any()
    for index, speed in enumerate(speeds.tolist()):
        case = scene(law, target, velocity=speed, accuracy=1e-10)
        exact = fm.simulate(case).summary
        for name in SUMMARY:
            scale = abs(exact[name])
            if "energy" in name:
                scale = case.kinetic_energy
            if name in ("rebound_velocity", "coefficient_of_restitution"):
                scale = max(scale, 1e-3 * (speed if name == "rebound_velocity" else 1))
            if name == "permanent_indentation":
                scale = max(scale, 1e-3 * exact["maximum_indentation"])
            assert abs(batch.summary[name][index] - exact[name]) <= 1.01e-5 * scale, (name, speed)


def test_masses_and_velocities_broadcast():
    case = scene("big-alabo", "plate")
    speeds, masses = np.array([0.1, 0.2, 0.4]), np.array([[0.03], [0.12]])
    ureg = pytest.importorskip("pint").get_application_registry()
    batch = fm.simulate_batch(case, velocity=speeds * ureg("m/s"), mass=masses * ureg.kg, accuracy=1e-7)
    assert batch.summary["maximum_force"].shape == (2, 3)
    for row, mass in enumerate(masses[:, 0].tolist()):
        for column, speed in enumerate(speeds.tolist()):
            ball = fm.Sphere("10 mm", velocity=f"{speed} m/s", mass=f"{mass} kg", material="tungsten carbide")
            one = fm.simulate(fm.Scene(ball, case.target, contact=case.contact), accuracy=1e-9).summary
            for name in ("maximum_force", "contact_duration", "rebound_velocity", "time_impactor_stops"):
                assert batch.summary[name][row, column] == pytest.approx(one[name], rel=1e-7)


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"velocity": [0.1, 0.2]}, ValueError, "no unit"),
        ({"velocity": ["0 m/s"]}, ValueError, "must be > 0"),
        ({"velocity": ["-1 m/s"]}, ValueError, "must be > 0"),
        ({"velocity": ["1 kg"]}, ValueError, "a velocity is needed"),
        ({"velocity": ["1 m/s"], "mass": ["1 m"]}, ValueError, "a mass is needed"),
        ({"velocity": ["1 m/s"], "accuracy": 7.0}, fm.SceneError, "accuracy"),
    ],
)
def test_bad_batches_are_refused(arguments, error, says):
    with pytest.raises(error, match=says):
        fm.simulate_batch(scene("hertz"), **arguments)


def test_a_free_body_is_refused():
    with pytest.raises(fm.SimulationError, match="free body"):
        fm.simulate_batch(scene("hertz", "body"), velocity=["1 m/s"])


def starts(nu, gamma):
    start = np.zeros(nu.size, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = nu, gamma, math.inf
    return start


@pytest.mark.parametrize("law", list(LAWS))
def test_the_short_way_on_a_half_space_is_the_march(law):
    """film_impact sums energies and arctangents; film_record marches: the same lines, so the same numbers."""
    curve, mesh = curve_of(LAWS[law]).native, native.mesh(native.WORK_PRESERVING, 7, 9)
    for nu in np.geomspace(0.3, 60.0, 23).tolist():
        start = native.Start(nu, 0.0, 0.0, 0.0, math.inf)
        status, summary = native.impact(curve, mesh, start)
        marched, _, states = native.record(curve, mesh, native.initial_state(curve, start), math.inf, 400)
        if status == native.BEYOND_LAW:
            assert marched == native.BEYOND_LAW
            continue
        assert status == marched == native.EVENT
        last = states[-1]
        assert summary.contact_duration == pytest.approx(last["time"], rel=1e-12)
        assert summary.final_velocity == pytest.approx(last["nu"], rel=1e-12)
        assert summary.maximum_indentation == pytest.approx(last["xi_max"], rel=1e-12)
        assert summary.maximum_force == pytest.approx(last["force_peak"], rel=1e-12)


@pytest.mark.parametrize("law", ["hertz", "big-alabo", "stronge", "saturating", "yigit-christoforou", "tan-sun"])
def test_lanes_agree_with_the_march(law):
    """Side by side or alone, the difference is of the order of what the segments leave."""
    rng = np.random.default_rng(3)
    curve = curve_of(LAWS[law]).native
    nu, gamma = np.exp(rng.uniform(-1.5, 3, 400)), np.exp(rng.uniform(-4, 0.7, 400))
    mesh = native.mesh(native.WORK_PRESERVING, 40, 120)
    status, batch = native.batch(curve, mesh, starts(nu, gamma))
    assert (status == native.EVENT).mean() > 0.9
    for index in np.flatnonzero(status == native.EVENT):
        start = native.Start(nu[index], gamma[index], 0.0, 0.0, math.inf)
        _, one = native.impact(curve, mesh, start)
        row = batch[index]
        for name in ("maximum_force", "maximum_indentation", "time_of_maximum_indentation"):
            assert row[name] == pytest.approx(getattr(one, name), rel=3e-7)
        assert row["final_velocity"] == pytest.approx(one.final_velocity, rel=2e-6, abs=2e-7 * nu[index])
        assert row["contact_duration"] == pytest.approx(one.contact_duration, rel=3e-6)
        assert row["time_impactor_stops"] == pytest.approx(one.time_impactor_stops, rel=3e-6, nan_ok=True)


def test_an_impact_does_not_depend_on_its_neighbours():
    rng = np.random.default_rng(5)
    curve, mesh = curve_of(LAWS["big-alabo"]).native, native.mesh(native.WORK_PRESERVING, 9, 21)
    start = starts(np.exp(rng.uniform(-1.5, 3, 101)), np.exp(rng.uniform(-4, 1.2, 101)))
    _, whole = native.batch(curve, mesh, start)
    order = rng.permutation(start.size)
    _, shuffled = native.batch(curve, mesh, start[order])
    alone = np.concatenate([native.batch(curve, mesh, start[k : k + 1])[1] for k in range(start.size)])
    for name in native.SUMMARY:
        assert np.array_equal(whole[name][order], shuffled[name], equal_nan=True), name
        assert np.array_equal(whole[name], alone[name], equal_nan=True), name


def test_threads_give_the_same_bytes():
    curve, mesh = curve_of(LAWS["hertz"]).native, native.mesh(native.WORK_PRESERVING, 12, 24)
    start = starts(np.geomspace(0.5, 2, 500), np.geomspace(0.01, 3, 500))
    expected = native.batch(curve, mesh, start)[1]
    found = []
    threads = [threading.Thread(target=lambda: found.append(native.batch(curve, mesh, start)[1])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    for name in native.SUMMARY:
        assert all(np.array_equal(one[name], expected[name], equal_nan=True) for one in found)


def test_segments_can_be_given():
    batch = fm.simulate_batch(zener_scene(0.5), velocity=["1 m/s", "2 m/s"], segments=10)
    assert batch.segments == (10, 10)
    assert 1e-7 < batch.estimated < 1e-3

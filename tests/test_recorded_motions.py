"""Normal motions of many impacts at the knots of their legs, from which friction takes its forces."""

import numpy as np
import pytest

import film_model as fm
from film_model.core import families, native
from film_model.core import springs as core
from film_model.oblique.friction import normal_impulse
from film_model.scene import Solver
from film_model.solve.batch import simulate_many

LAWS = {
    "big-alabo": {},
    "elastoplastic": {},
    "hunt-crossley": {"restitution": 0.8},
    "jackson-green": {},
    "kogut-etsion": {},
    "linear-dashpot": {"stiffness": "40 MN/m", "restitution": 0.7},
    "stronge": {},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "tsuji": {"restitution": 0.8},
    "walton-braun": {"loading_stiffness": "40 MN/m", "unloading_stiffness": "80 MN/m"},
}
TARGETS = {"half-space": fm.HalfSpace("mild steel"), "plate": fm.Plate("mild steel", thickness="10 mm")}


def scene_of(law, target):
    ball = fm.Sphere("5 mm", "1 m/s", material="bearing steel", angle="30 deg")
    contact = fm.Contact(law, yield_strength="0.6 GPa", friction=0.3, **LAWS[law])
    return fm.Scene(ball, TARGETS[target], contact, fm.Effects(gravity=False))


def made(law, target="half-space", count=400):
    """Impacts, their problem, and the times of their turns and ends over the scale, (impacts, 2)."""
    speeds = 10.0 ** np.random.default_rng(7).uniform(-1.0, 1.0, count)
    many = simulate_many(scene_of(law, target), {"impactor.velocity": speeds}, Solver(1e-6))
    (problem,) = many.problems
    ends = many.summary["time_of_maximum_indentation"], many.summary["contact_duration"]
    return many, problem, np.stack(ends, axis=1) / np.broadcast_to(problem.scales.time, count)[:, None]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("law", LAWS)
def test_recorded_motions_have_the_impulse_of_their_impacts(law, target):
    many, problem, legs = made(law, target)
    found, scales = problem.motions(legs, 32), problem.scales.part((slice(None), None))
    impulse = normal_impulse(problem.impacts.scene, problem, many.summary["rebound_velocity"], legs[:, 1])
    seen = core.impulses(np.maximum(found.force, 0.0) * scales.force, found.legs * scales.time)
    assert abs(seen / impulse - 1.0).max() < 4e-5
    deepest = (found.depth * scales.length).max(axis=1)
    assert deepest == pytest.approx(many.summary["maximum_indentation"], rel=1e-4)


@pytest.mark.parametrize("law", ["elastoplastic", "stronge", "tsuji"])
def test_a_motion_depends_on_its_impact_alone(law, monkeypatch):
    _, problem, legs = made(law, count=100)
    whole, mixed = problem.motions(legs, 24), np.random.default_rng(8).permutation(100)
    for rows in (mixed, mixed[:7], mixed[:1]):
        some = problem.part(rows).motions(legs[rows], 24)
        for mine, all_of_them in zip(some, whole, strict=True):
            assert mine is None or np.array_equal(mine, all_of_them[rows])
    monkeypatch.setattr(native, "instructions", lambda: 0)
    assert np.array_equal(problem.motions(legs, 24).force, whole.force)


@pytest.mark.parametrize("law", ["big-alabo", "kogut-etsion", "stronge", "tsuji"])
def test_a_motion_on_a_curve_of_its_own_is_that_on_the_curve_of_all(law):
    """Which lanes have in cubics."""
    _, problem, legs = made(law, count=50)
    shared, curve = problem.motions(legs, 32), problem.curve.native
    first = np.frombuffer(bytes(curve), np.float64, 1)
    rows = families.Rows(curve, values=np.full((50, 1), first), places=np.zeros(1, np.int32))
    own = families.motions(rows, problem.start, legs, 32, problem.curve.reversible)
    largest = shared.force.max(axis=1)
    assert (abs(own.force - shared.force)[:, 1:].max(axis=1) < 5e-6 * largest).all()  # at touch they are 2e-4 off
    assert own.legs == pytest.approx(shared.legs, rel=1e-5)


def test_a_contact_that_does_not_turn_or_end_when_it_should_has_no_motion():
    _, problem, legs = made("elastoplastic", count=40)
    for factor in ([0.8, 1.0], [1.0, 0.8], [1.0, np.nan]):
        assert np.isnan(problem.motions(legs * factor, 24).force).all()

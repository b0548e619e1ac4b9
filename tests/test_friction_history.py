"""Phases of friction and the area that sticks, where springs compute them: against the exact motion and steps."""

import numpy as np
import pytest
from test_stepped_friction import scene

import film_model as fm
from film_model.core.springs import radii
from film_model.oblique import springs
from film_model.oblique.result import REGIMES
from film_model.solve.simulate import simulate_quietly

ALIKE = [["0 m/s", 0.2], ["1 m/s", 0.2]]
"""A table of friction, which is followed by springs, with one coefficient."""

COMPARED = ("stick_radius", "sliding_displacement")

LAWS = (
    ("hertz", {}),
    ("elastoplastic", {}),
    ("thornton", {}),
    ("tsuji", {"restitution": 0.8}),
    ("tsuji", {"restitution": 0.3}),
)


@pytest.mark.parametrize("psi", [0.3, 0.9, 0.99, 1.01, 1.5, 3.0, 4.7, 8.0])
def test_springs_have_the_phases_of_the_exact_motion(psi):
    """Their times within 0.5 % of the duration; the radius inside which all sticks to 1 % of the largest one."""
    exact = simulate_quietly(scene(psi=psi)).oblique
    found = simulate_quietly(scene(psi=psi).replace({"contact.friction": ALIKE})).oblique
    assert found.sliding_regime == exact.sliding_regime
    assert [name for _, name in found.events] == [name for _, name in exact.events]
    duration, times = exact.motion["time"][-1], [[time for time, _ in one.events] for one in (found, exact)]
    assert times[0] == pytest.approx(times[1], abs=5e-3 * duration)
    at = exact.motion["time"]
    radius, moved = (np.interp(at, found.motion["time"], found.motion[name]) for name in COMPARED)
    calm = np.abs(at[:, None] - np.array(times[1])).min(axis=1) > 5e-3 * duration  # it jumps where slip ends
    assert np.abs(radius - exact.motion["stick_radius"])[calm].max() <= 1e-2 * largest_radius(psi)
    assert moved == pytest.approx(exact.motion["sliding_displacement"], abs=1e-4 * np.abs(moved).max())


def largest_radius(psi):
    history = simulate_quietly(scene(psi=psi))
    return (history.scene.effective_radius * history.summary["maximum_indentation"]) ** 0.5


@pytest.mark.parametrize(("law", "entries"), LAWS)
@pytest.mark.parametrize("psi", [0.3, 1.5, 4.7, 8.0])
def test_histories_have_the_phases_of_steps(law, entries, psi):
    """Within 1 % of the duration, without those that last less."""
    history = simulate_quietly(on := scene(law, psi, **entries))
    found, begun = history.oblique, list(fm.ImpactComponent(on).step(1.02 * history.duration).sliding)
    long = 0.01 * history.duration
    phases = [lasting(events, history.duration, long) for events in (found.events, begun)]
    assert [name for name, _ in phases[0]] == [name for name, _ in phases[1]]
    assert [time for _, time in phases[0]] == pytest.approx([time for _, time in phases[1]], abs=long)


def lasting(events, end, least):
    """Names and times of the phases that last for a time."""
    ends = [time for time, _ in events[1:]] + [end]
    return [(name, time) for (time, name), after in zip(events, ends, strict=True) if after - time > least]


@pytest.mark.parametrize(("law", "entries"), LAWS)
def test_regimes_are_those_of_the_phases(law, entries):
    """In single impacts and batches; a damping force lets a contact stick at first touch whatever its ψ₁."""
    seen = set()
    for psi in (0.3, 1.5, 4.7, 8.0):
        on = scene(law, psi, **entries)
        found = simulate_quietly(on).oblique
        kinds = [name for _, name in found.events]
        first = 0 if kinds[0] != "slides" else 2 if set(kinds) == {"slides"} else 1
        assert found.sliding_regime == REGIMES[first] and found.events[0][0] == 0.0
        many = fm.simulate_batch(on, velocity=[f"{on.impactor.path_speed!r} m/s"]).oblique
        assert many["sliding_regime"][0] == found.sliding_regime
        seen.add(found.sliding_regime)
    assert seen == ({"sticks first"} if law == "tsuji" else set(REGIMES))


@pytest.mark.parametrize(("law", "entries"), LAWS)
def test_how_a_contact_slides_is_not_said_of_damped_laws_before(law, entries):
    (effect,) = [one for one in simulate_quietly(scene(law, 1.5, **entries)).effects if one.name == "obliqueness"]
    assert ("the contact slides first" in effect.reason) is (law != "tsuji")


YIELDING = {
    **{name: {} for name in ("elastoplastic", "big-alabo", "stronge", "kogut-etsion")},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "walton-braun": {"loading_stiffness": "40 MN/m", "unloading_stiffness": "80 MN/m"},
}


@pytest.mark.parametrize("law", YIELDING)
def test_brackets_of_contacts_that_yield(law, monkeypatch):
    """Whatever the steps, each has the other's models within its errors, and the component, which has the second."""
    rng = np.random.default_rng(4)
    for _ in range(6):
        angle, speed = rng.uniform(0.03, 1.1), 10.0 ** rng.uniform(-0.5, 1.0)
        on = scene(law, target=fm.HalfSpace("mild steel"), **YIELDING[law])
        on = on.replace({"impactor.angle": f"{angle!r} rad", "impactor.velocity": f"{speed!r} m/s"})
        found = []
        for steps in (512, 2048):
            monkeypatch.setattr(springs, "STEPS", steps)
            found.append(simulate_quietly(on).oblique)
        (coarse, fine), before = found, abs(found[0].motion["sliding_velocity"][0])
        error = 2.0 * springs.TURN / 512 * before
        assert fine.low == pytest.approx(coarse.low, abs=error) and fine.high == pytest.approx(coarse.high, abs=error)
        component = fm.ImpactComponent(on)
        component.step(1.01 * fine.motion["time"][-1])
        for one in found:
            assert one.low <= component.sliding.sliding_velocity <= one.high
            assert one.low <= one.summary["contact_point_rebound_velocity"] <= one.high


def test_a_radius_does_not_shrink_while_the_depth_grows():
    depth = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 4.5, 4.4, 4.0, 3.0])
    force = np.array([0.0, 1.0, 3.0, 4.0, 5.0, 4.9, 4.0, 2.0, 0.0])
    for radius in radii(force, depth, np.sqrt(force), 0.5):
        assert np.all(np.diff(radius[:6]) >= 0.0) and np.all(radius[:-1] >= 0.0) and radius[-1] == 0.0


@pytest.mark.slow
def test_regimes_of_batches_are_those_of_single_impacts():
    """Between sticking first and sliding throughout 32 springs in 128 steps decide as 256 in 2048."""
    rng = np.random.default_rng(3)
    for _ in range(150):
        friction, angle, speed = 10.0 ** rng.uniform(-2.0, 0.0), rng.uniform(0.02, 1.5), 10.0 ** rng.uniform(-2.0, 1.3)
        ball = fm.Sphere("5 mm", f"{speed!r} m/s", material="bearing steel", angle=f"{angle!r} rad")
        contact = fm.Contact("walton-braun", friction=friction, **YIELDING["walton-braun"])
        on = fm.Scene(ball, fm.HalfSpace("mild steel"), contact, fm.Effects(gravity=False))
        many = fm.simulate_batch(on, velocity=[f"{speed!r} m/s"], accuracy=1e-3).oblique
        assert many["sliding_regime"][0] == simulate_quietly(on).oblique.sliding_regime

"""Laws of springs and laminates against their closed forms."""

import math

import numpy as np
import pytest
from cases import MASS, RADIUS, scene
from law_cases import scene_of, velocity_of

import film_model as fm
from film_model.core import native
from film_model.effects.choose import problem_of


@pytest.mark.parametrize("target", ["half-space", "plate", "rod"])
@pytest.mark.parametrize("law", ["walton-braun", "luding"])
def test_piecewise_linear_laws_are_exact_with_two_segments(law, target):
    few, many = (fm.simulate(scene(law, target), segments=n).summary for n in (2, 500))
    for name, value in many.items():
        assert few[name] == value or few[name] == pytest.approx(value, rel=2e-12, abs=1e-18), name


@pytest.mark.parametrize("velocity", [0.01, 2.0])
def test_walton_braun_in_closed_form(velocity):
    k1, k2 = 4e7, 9e7
    got = fm.simulate(scene_of(fm.WaltonBraun(k1, k2), velocity)).summary
    e = math.sqrt(k1 / k2)
    assert got["coefficient_of_restitution"] == pytest.approx(e, rel=1e-13)
    assert got["contact_duration"] == pytest.approx(math.pi / 2 * math.sqrt(MASS / k1) * (1 + e), rel=1e-13)
    assert got["permanent_indentation"] == pytest.approx((1 - k1 / k2) * got["maximum_indentation"], rel=1e-13)


def test_luding_stiffens_up_to_its_limit():
    k1, kp, depth = 4e7, 1e8, 1e-3
    law = fm.Luding(RADIUS, k1, kp, depth)
    limit = kp / (kp - k1) * depth * 2 * RADIUS
    assert law.scales(1.0)[0] == pytest.approx(limit, rel=1e-15)
    for share in (0.1, 0.5, 0.99):
        got = fm.simulate(scene_of(law, math.sqrt(k1 / MASS) * share * limit)).summary
        stiffness = k1 + (kp - k1) * share
        assert got["maximum_indentation"] == pytest.approx(share * limit, rel=1e-12)
        assert got["coefficient_of_restitution"] == pytest.approx(math.sqrt(k1 / stiffness), rel=1e-12)
    beyond = fm.simulate(scene_of(law, 3 * math.sqrt(k1 / MASS) * limit)).summary
    assert beyond["permanent_indentation"] == pytest.approx(depth * 2 * RADIUS, rel=1e-12)
    assert beyond["maximum_force"] == pytest.approx(
        k1 * limit + kp * (beyond["maximum_indentation"] - limit), rel=1e-12
    )


@pytest.mark.parametrize(("fraction", "depth"), [(None, 0.4), (None, 3.0), (0.3, 3.0)])
def test_tan_sun_restitution(fraction, depth):
    """e² = (q + 1)/(q_u + 1) (δ_m − δ_f)/δ_m."""
    critical = 5e-6
    law = fm.TanSun(1e10, critical, permanent_fraction=fraction)
    got = fm.simulate(scene_of(law, velocity_of(law, depth))).summary
    dent = 0.0
    if depth > 1.0:
        dent = depth * (1 - depth**-0.4) if fraction is None else fraction * (depth - 1)
    assert got["permanent_indentation"] == pytest.approx(dent * critical, rel=1e-11, abs=1e-18)
    assert got["coefficient_of_restitution"] ** 2 == pytest.approx(2.5 / 3.5 * (depth - dent) / depth, rel=1e-11)


def laminate_forces(component, times, **inputs):
    found = [component.step(dt, **inputs).outputs for dt in times]
    return np.array([[o.indentation, o.contact_force] for o in found])


def test_tan_sun_closes_again_along_its_reloading_curve():
    """A second impact reloads with exponent 1.5 to the old maximum, then along the loading curve; unloads with 2.5."""
    law = fm.TanSun(stiffness=1e10, critical_indentation=5e-6)
    component = fm.ImpactComponent(scene_of(law, 0.25), segments=200)
    first = component.step("1 ms", stop_at_events=True)
    while first.events[-1].name != "maximum_indentation":
        first = component.step("1 ms", stop_at_events=True)
    deep, top = first.outputs.indentation, first.outputs.contact_force
    while component.phase != "separated":
        last = component.step("1 ms", stop_at_events=True)
    dent = last.outputs.indentation
    assert dent == pytest.approx(deep * (1 - (5e-6 / deep) ** 0.4), rel=1e-10)

    def branch(indentation, exponent, at=deep, force=top):
        return force * np.maximum((indentation - dent) / (at - dent), 0.0) ** exponent

    component.step("1 us")
    # the target follows the ball, at a lower velocity than that of the impact
    closing = component.step("1 ms", support_velocity="-0.35 m/s", stop_at_events=True)
    assert closing.events[-1].name == "contact_begins"
    found = laminate_forces(component, [2e-6] * 8, support_velocity="-0.35 m/s")
    assert (found[:, 0] > dent).all() and (np.diff(found[:, 0]) > 0).all()
    assert found[:, 1] == pytest.approx(branch(found[:, 0], 1.5), rel=1e-12)
    while component.phase == "reloading":
        closing = component.step("1 us", support_velocity="-0.35 m/s")
    turned = closing.events[-1]
    assert turned.name == "maximum_indentation" and turned.indentation < deep
    found = laminate_forces(component, [2e-6] * 8, support_velocity="-0.35 m/s")
    assert (np.diff(found[:, 0]) < 0).all()
    expected = branch(found[:, 0], 2.5, turned.indentation, turned.contact_force)
    assert found[:, 1] == pytest.approx(expected, rel=1e-12)


def test_tan_sun_pushed_back_before_it_has_opened():
    """It reloads along the part of the reloading curve that passes through the turning point."""
    law = fm.TanSun(stiffness=1e10, critical_indentation=5e-6)
    component = fm.ImpactComponent(scene_of(law, 0.25), segments=100)
    outputs = component.step("1 ms", stop_at_events=True).outputs
    while component.phase != "unloading":
        outputs = component.step("1 ms", stop_at_events=True).outputs
    deep, top = outputs.indentation, outputs.contact_force
    dent = deep * (1 - (5e-6 / deep) ** 0.4)
    while outputs.contact_force > 0.4 * top:
        outputs = component.step("0.2 us").outputs
    events = []
    while not events:
        result = component.step("0.1 us", external_force="3 kN")
        events = [event for event in result.events if event.name == "reloading_begins"]
    back, low = events[0].indentation, events[0].contact_force
    assert low == pytest.approx(top * ((back - dent) / (deep - dent)) ** 2.5, rel=1e-12)
    found, seen = [], []
    while not seen:
        result = component.step("0.1 us", external_force="3 kN")
        seen = [event for event in result.events if event.name == "stage_changes"]
        found.append((result.outputs.indentation, result.outputs.contact_force))
    assert seen[0].indentation == pytest.approx(deep, rel=1e-12)
    indentation, force = np.array([point for point in found if point[0] < deep]).T
    share = lambda x: ((x - dent) / (deep - dent)) ** 1.5  # noqa: E731
    expected = low + (top - low) * (share(indentation) - share(back)) / (1.0 - share(back))
    assert force == pytest.approx(expected, rel=1e-12)


def last_slope(law, summary):
    """Of the branch out where it ends, over the scales: Yigit and Christoforou's is Hertz's curve moved down."""
    if law == "walton-braun":
        return 2.0
    left = summary.maximum_indentation**1.5 - summary.maximum_force
    return 1.5 * max(left, 0.0) ** (1 / 3)  # 0: it has not yielded


@pytest.mark.parametrize("law", ["walton-braun", "yigit-christoforou"])
def test_a_contact_that_creeps_out_never_ends(law):
    """It is over-damped where the branch ends with a slope k: γ² k ≥ 4. Rounding of short lines decided before."""
    problem = problem_of(scene(law, "plate", velocity=1.0))
    for gamma in (0.5, 1.0, 1.05, 1.4142, 1.4143, 2.0, 4.0, 9.0, 40.0):
        start = native.Start.from_buffer_copy(problem.start)
        start.gamma = gamma
        for n in (3, 8, 20, 50, 200, 1000):
            for line in (native.CHORD, native.WORK_PRESERVING):
                status, summary = native.impact(problem.curve.native, native.mesh(line, n, n), start)
                never = gamma**2 * last_slope(law, summary) >= 4.0
                assert status == (native.ENDLESS if never else native.EVENT), (gamma, n, line)
                assert math.isnan(summary.contact_duration) == never

"""Loss factors of materials: the restitution that they leave, when it is simulated, and by whom."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import gamma

import film_model as fm
import fmu_wrapper
from film_model.base.materials import catalogue
from film_model.core import native
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_MODELLED, SIMULATED
from film_model.effects.material_damping import MARGIN, MOST_GAMMA, change_of
from film_model.effects.trial import change
from film_model.laws.damping import LOSS_SLOPE, loss_restitution
from film_model.solve.batch import simulate_many

LOSSY = sorted(name for name, m in catalogue().items() if m.loss_factor)


def scene(material="nylon", velocity="0.1 m/s", target="bearing steel", **effects):
    ball = fm.Sphere("5 mm", velocity=velocity, material=material)
    return fm.Scene(ball, fm.HalfSpace(target), effects=fm.Effects(gravity=False, **effects))


def rebound(of):
    return fm.simulate(of).summary["coefficient_of_restitution"]


def damping(of):
    return next(effect for effect in choose(of).effects if effect.name == "material_damping")


def springpot(loss_factor, steps):
    """e of a unit mass that strikes F = ∫ (t − s)^−β/Γ(1 − β) d(δ^{3/2}) at unit velocity: Ting's rule on the way out.

    Newmark's rule with linear acceleration; δ and δ^{3/2} are linear within a step, and the kernel is integrated.
    """
    beta = 2 / math.pi * math.atan(loss_factor)
    dt, x, v, force, turn = 3.6 / steps, 0.0, 1.0, 0.0, None
    depth = np.zeros(1)
    while len(depth) < 3 * steps:
        now = len(depth)
        ages = dt * np.arange(now, -1, -1)
        weights = -np.diff(ages ** (1 - beta)) / gamma(2 - beta) / dt
        guess = force
        for _ in range(4):
            deeper = x + v * dt - dt**2 * (2 * force + guess) / 6
            faster = v - dt * (force + guess) / 2
            if deeper <= 0.0:
                return -faster
            path = np.append(depth, deeper)
            parts = weights * np.diff(path**1.5)
            guess = parts.sum()
            if turn is not None:
                left = np.cumsum((weights * np.diff(path))[::-1])[::-1]  # ∫ E dδ from each time until now
                before = np.flatnonzero(left[: turn + 1] > 0.0)
                if not before.size:
                    return -faster
                k = before[-1]
                share = left[k] / (left[k] - left[k + 1])
                kernel = (ages[k] ** (1 - beta) - (ages[k] - share * dt) ** (1 - beta)) / gamma(2 - beta) / dt
                guess = parts[:k].sum() + kernel * (path[k + 1] ** 1.5 - path[k] ** 1.5)
        turn = now - 1 if turn is None and faster < 0.0 else turn
        depth, x, v, force = path, deeper, faster, guess
    raise AssertionError("contact does not end")


@pytest.mark.slow
@pytest.mark.parametrize("loss_factor", [0.01, 0.03, 0.1, 0.3, 1.0, 5.0])
def test_restitution_is_that_of_an_integration(loss_factor):
    found = springpot(loss_factor, 800)
    assert abs(springpot(loss_factor, 400) - found) < 1e-4  # of the integration itself
    assert loss_restitution(loss_factor) == pytest.approx(found, abs=5e-4)


def test_where_the_first_order_ends():
    assert (1 - springpot(0.01, 400)) / 0.01 == pytest.approx(LOSS_SLOPE, rel=0.01)
    assert abs(1 - LOSS_SLOPE * 0.12 - loss_restitution(0.12)) < 0.01 * loss_restitution(0.12)
    assert abs(1 - LOSS_SLOPE * 0.14 - loss_restitution(0.14)) > 0.01 * loss_restitution(0.14)
    assert 1 - 0.5 * math.pi * 0.1 < loss_restitution(0.1) - 0.04  # half a cycle of hysteresis is too much


@pytest.mark.parametrize("name", LOSSY)
def test_no_material_with_losses_rebounds_without_loss(name):
    one = scene(name)
    expected = loss_restitution(one.loss_factor)
    effect = damping(one)
    if effect.state == SIMULATED:
        law = choose(one).problem.law.name
        assert law in ("tsuji", "damped-large-slope")
        assert 1 - rebound(one) == pytest.approx(1 - expected, rel=1e-4 if law == "tsuji" else 0.02)
    else:
        assert effect.change < 0.02 and effect.state != NOT_MODELLED
    elastic = name.startswith(("natural rubber", "polyurethane"))
    assert effect.simulated or not (elastic or name in ("nylon 6/6", "polycarbonate", "PMMA"))


@pytest.mark.parametrize("loss_factor", [1e-5, 3e-4, 0.003, 0.008, 0.01, 0.03, 0.3, 1.0])
def test_marches_show_the_change_in_closed_form_and_less_on_a_moving_target(loss_factor):
    """By which most impacts are decided without a march of the damped law."""
    impact = choose(scene(material_damping=False))
    elastic = impact.problem.again(law="hertz", impedance=math.inf)
    ball = impact.scene.effective_modulus, impact.scene.effective_radius
    found = change(elastic.again(law=fm.Tsuji(*ball, loss_restitution(loss_factor))), elastic)
    assert elastic.trial.ends and change_of(loss_restitution(loss_factor)) / found == pytest.approx(
        1.0, abs=0.4 * (MARGIN - 1.0)
    )
    for motion in np.geomspace(1e-3, MOST_GAMMA, 12):
        moving = elastic.again(impedance=elastic.scales.force / elastic.scales.velocity / motion)
        damped = moving.again(law=fm.Tsuji(*ball, loss_restitution(loss_factor)))
        assert change(damped, moving) < found


def test_restitution_never_rises_through_first_yield():
    speeds = np.geomspace(0.1, 8.0, 25)
    found = [rebound(scene("PMMA", f"{speed} m/s")) for speed in speeds]
    assert np.diff(found).max() < 1e-4
    assert found[0] == pytest.approx(0.965, abs=0.001) and found[-1] < 0.8
    laws = [choose(scene("PMMA", f"{speed} m/s")).problem.law.name for speed in (0.3, 1.0, 5.0)]
    assert laws == ["damped-large-slope", "damped-large-slope", "elastoplastic"]


def test_what_is_left_out_is_said():
    off = damping(scene(material_damping=False))
    assert rebound(scene(material_damping=False)) == pytest.approx(1.0, abs=1e-6)
    assert "material_damping = false" in off.warning
    fast = scene("PMMA", "5 m/s")
    assert "the law elastoplastic has no damping" in damping(fast).warning
    forced = scene("PMMA", "5 m/s", material_damping=True)
    assert 1 - rebound(forced) == pytest.approx(1 - loss_restitution(forced.loss_factor), rel=0.02)
    assert any("plasticity" in text for text in fm.simulate(forced).warnings)
    held = replace(scene("PMMA"), target=fm.Plate("mild steel", thickness="2 mm", static_stiffness="1e7 N/m"))
    assert "static stiffness" in damping(held).warning


def test_loss_factors_of_both_bodies_count_by_their_compliance():
    one = scene("nylon", target="polycarbonate")
    parts = [
        (m.loss_factor, (1 - m.poissons_ratio**2) / m.youngs_modulus)
        for m in (one.impactor.material, one.target.material)
    ]
    mean = sum(loss * soft for loss, soft in parts) / sum(soft for _, soft in parts)
    assert one.loss_factor == pytest.approx(mean, rel=1e-12)
    assert rebound(one) == pytest.approx(loss_restitution(mean), rel=1e-4)


def test_batches_sweeps_and_components_decide_alike():
    speeds = np.array([0.1, 0.6, 1.0, 3.0, 6.0])
    alone = [rebound(scene("PMMA", f"{speed} m/s")) for speed in speeds]
    many = simulate_many(scene("PMMA"), {"impactor.velocity": speeds})
    assert many.summary["coefficient_of_restitution"] == pytest.approx(alone, rel=1e-4)
    component = fm.ImpactComponent(scene("PMMA"), initial_gap="1 um")
    component.step("1 s")
    assert -component.outputs.impactor_velocity == pytest.approx(0.1 * alone[0], rel=1e-4)
    losses = np.array([0.0, 0.02, 0.05])
    varied = simulate_many(scene("PMMA"), {"impactor.material.loss_factor": losses})
    expected = loss_restitution(losses * scene("PMMA").loss_factor / 0.03)
    assert 1 - varied.summary["coefficient_of_restitution"] == pytest.approx(1 - expected, rel=0.02, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["lead", "aluminium"])
def test_a_ball_deeper_than_the_end_of_the_law_is_an_error_not_elastic(target, made):
    speeds = np.array([30.0, 200.0, 300.0, 600.0])
    one = scene("bearing steel", "30 m/s", target)
    many = simulate_many(one, {"impactor.velocity": speeds})
    assert many.status.tolist() == [native.EVENT, *[native.BEYOND_LAW] * 3]
    assert many.summary["coefficient_of_restitution"][0] == pytest.approx(rebound(one), rel=1e-4)
    assert np.isnan(many.summary["coefficient_of_restitution"][1:]).all()
    for speed in speeds[1:]:
        with pytest.raises(fm.SimulationError, match="passed the end of the law's last stage"):
            fm.simulate(scene("bearing steel", f"{speed} m/s", target))
    with pytest.raises(fm.SimulationError, match="passed the end of the law's last stage"):
        fm.ImpactComponent(scene("bearing steel", "200 m/s", target), initial_gap="1 um")
    with pytest.raises(fm.SimulationError, match="passed the end of the law's last stage"):
        fmu_wrapper.run(made(one), start_values={"initial_velocity": "200 m/s"})


def test_fmus_contain_the_damped_law():
    served = fmu_wrapper.served(scene("PMMA"))
    assert served.contact.law_name == "damped-large-slope"
    assert rebound(served) == pytest.approx(rebound(scene("PMMA")), rel=1e-9)
    assert fmu_wrapper.served(scene("PMMA", "5 m/s")).contact.law_name == "elastoplastic"


def test_derivatives_keep_the_damping():
    history = fm.simulate(scene("PMMA"), derivatives=["impactor.velocity"])
    assert history.derivatives is not None
    slower, faster = (fm.simulate(scene("PMMA", f"{v} m/s")).summary["maximum_force"] for v in (0.099, 0.101))
    found = history.derivatives.values["maximum_force"]["impactor.velocity"]
    assert found == pytest.approx((faster - slower) / 0.002, rel=1e-3)

"""The yield strength at the strain rate of the impact: iteration, decision, one and many, components and FMUs."""

import math
import re

import numpy as np
import pytest

import film_model as fm
from film_model.base.materials import catalogue
from film_model.base.rate_law import RateHardening
from film_model.effects.choose import choose, problem_of
from film_model.effects.effect import NOT_JUDGED, NOT_MODELLED, NOT_NEEDED, SIMULATED, SWITCHED_OFF
from film_model.effects.many import problems_of
from film_model.effects.rate_hardening import LEAST, MOST, TYPICAL, settled
from fmu_wrapper.assumptions import served, validity_of

SOFT = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3", "yield_strength": "250 MPa"}
STEEL = {**SOFT, "strain_rate_coefficient": 0.022}
LAWS = ("auto", "big-alabo", "stronge", "yigit-christoforou")


def scene(law="auto", velocity="1 m/s", target=None, material=STEEL, **effects):
    ball = fm.Sphere("5 mm", velocity=velocity, material="WC, Big-Alabo 2017")
    target = target or fm.HalfSpace(material)
    return fm.Scene(ball, target, fm.Contact(law), fm.Effects(**{"gravity": False, **effects}))


def effect_of(case):
    return {effect.name: effect for effect in choose(case).effects}["rate_hardening"]


def rate_of(summary, radius=5e-3):
    """Tabor's 0.2 a/R over the time to the maximum indentation."""
    depth, turn = summary["maximum_indentation"], summary["time_of_maximum_indentation"]
    return 0.2 * math.sqrt(depth / radius) / turn


@pytest.mark.parametrize("law", LAWS)
def test_the_strength_belongs_to_the_impact_s_own_rate(law):
    history = fm.simulate(scene(law), accuracy=1e-8)
    effect = effect_of(scene(law))
    strength = choose(scene(law)).problem.law.yield_strength
    assert effect.state == SIMULATED and effect.change > 0.01
    assert strength == pytest.approx(250e6 * (1 + 0.022 * math.log(rate_of(history.summary))), rel=1e-6)
    assert strength == pytest.approx(250e6 * (1 + 0.022 * math.log(effect.value)), rel=1e-8)
    slow = scene(law, material={**SOFT, "yield_strength": f"{strength!r} Pa"})
    assert history.summary == fm.simulate(slow, accuracy=1e-8).summary  # also the dent's radius and the pressures


@pytest.mark.parametrize("coefficient", [1e-3, 0.1, 1.0])
@pytest.mark.parametrize("velocity", [0.05, 1.0, 20.0])
def test_the_iteration_converges(coefficient, velocity):
    choice = choose(scene("big-alabo", f"{velocity} m/s", material={**STEEL, "strain_rate_coefficient": coefficient}))
    effect = effect_of(choice.scene)
    strength = 250e6 * (1 + coefficient * max(0.0, math.log(effect.value)))
    assert choice.hard is None or choice.hard.law.yield_strength == pytest.approx(strength, rel=2e-9)


def test_an_iteration_that_does_not_settle_is_unknown():
    assert math.isnan(settled(lambda factor: math.e**3 if factor < 2.0 else 1.0, RateHardening(1.0, 0.0, 1.0)))
    for of in (math.exp, lambda factor: np.exp(np.array([factor, factor]).max(axis=0))):  # the slope is 1
        assert np.isnan(settled(of, RateHardening(1.0, 0.0, 1.0))).all()


def test_a_rise_is_simulated_however_small_so_that_restitution_has_no_step():
    weak = {**STEEL, "strain_rate_coefficient": 1e-4}
    assert effect_of(scene(material=weak)).state == SIMULATED
    assert choose(scene(material=weak)).problem.law.yield_strength > 250e6
    speeds = np.geomspace(1e-3, 10.0, 400)
    batch = fm.simulate_batch(scene("elastoplastic"), velocity=[f"{v!r} m/s" for v in speeds.tolist()], accuracy=1e-7)
    restitution = batch.summary["coefficient_of_restitution"]
    yielded = restitution[restitution < 0.99]
    assert yielded.size > 200 and abs(np.diff(yielded, 2)).max() < 3e-4  # a step of 0.003 before


def test_switched_off_it_warns_with_the_number():
    off = scene(rate_hardening=False)
    effect = effect_of(off)
    assert effect.state == NOT_MODELLED and effect.change == effect_of(scene()).change
    assert "rate_hardening = false" in effect.warning and f"{100 * effect.change:.2g} %" in effect.warning
    assert fm.simulate(off).summary == fm.simulate(scene(material=SOFT)).summary
    weak = {**STEEL, "strain_rate_coefficient": 1e-4}
    assert effect_of(scene(material=weak, rate_hardening=False)).state == SWITCHED_OFF


def test_where_it_cannot_be_computed():
    thornton = scene().replace({"contact.law": "thornton", "contact.yield_pressure": "400 MPa"})
    assert effect_of(thornton).state == NOT_MODELLED and "no yield_strength" in effect_of(thornton).warning
    assert effect_of(scene(material=SOFT)).state == NOT_JUDGED
    assert effect_of(scene(velocity="1 um/s")).state == NOT_NEEDED
    refused = {
        "no yield_strength": {"contact.law": "hertz"},
        "strain_rate_coefficient": {"target.material": SOFT},
        "yield strength": {"target.material": {k: v for k, v in STEEL.items() if k != "yield_strength"}},
    }
    for said, changes in refused.items():
        with pytest.raises(fm.SceneError, match=f"effects.rate_hardening: .*{said}"):
            scene(rate_hardening=True).replace(changes)
    strong = {**STEEL, "youngs_modulus": "1 GPa", "yield_strength": "150 MPa", "strain_rate_coefficient": 1.0}
    assert effect_of(scene(velocity="20 m/s", material=strong)).state == NOT_JUDGED
    with pytest.raises(fm.SimulationError, match="cannot be marched"):
        fm.simulate(scene(velocity="20 m/s", material=strong, rate_hardening=True))


@pytest.mark.parametrize("law", ["auto", "big-alabo", "thornton"])
def test_without_a_rate_law_it_says_how_far_the_result_is_open(law):
    """By the impact with the strength at C = 0.014: restitution 3 to 5 % higher at 1 m/s."""
    own = {"contact.law": law} | ({"contact.yield_pressure": "400 MPa"} if law == "thornton" else {})
    slow, hard = (scene(material={**SOFT, **more}).replace(own) for more in ({}, {"strain_rate_coefficient": TYPICAL}))
    effect = effect_of(slow)
    assert effect.state == NOT_JUDGED and effect.warning is None
    assert effect.change == pytest.approx(effect_of(hard).change, rel=0.02)
    (percent,) = re.findall(r"restitution would be ([0-9.]+) % higher; C of metals is 0.006 to 0.06", effect.reason)
    assert 3.0 <= float(percent) <= 5.0
    if law != "thornton":
        e, more = (fm.simulate(case).summary["coefficient_of_restitution"] for case in (slow, hard))
        assert float(percent) == pytest.approx(100.0 * (more / e - 1.0), abs=0.1)


def test_the_least_and_the_largest_coefficient_of_metals_bracket_those_of_the_catalogue():
    known = [one.strain_rate_coefficient for one in catalogue().values() if one.strain_rate_coefficient]
    assert LEAST < TYPICAL < MOST and MOST in known and LEAST in known


def test_a_polymer_has_no_rate_coefficient_of_a_metal():
    soft = {"youngs_modulus": "3 GPa", "poissons_ratio": 0.4, "density": "1200 kg/m^3", "yield_strength": "60 MPa"}
    effect = effect_of(scene(velocity="5 m/s", material=soft))
    assert (effect.state, effect.change) == (NOT_JUDGED, None) and "4340" not in effect.reason


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_many_impacts_settle_as_one_does(law, target):
    place = fm.Plate(STEEL, thickness="5 mm") if target == "plate" else None
    case = scene(law, target=place)
    speeds = np.geomspace(2e-3, 10.0, 40).tolist()
    batch = fm.simulate_batch(case, velocity=[f"{speed!r} m/s" for speed in speeds], accuracy=1e-6)
    for k in (0, 13, 27, 39):
        alone = fm.simulate(case.replace({"impactor.velocity": f"{speeds[k]!r} m/s"}), accuracy=1e-6).summary
        for name in ("maximum_force", "contact_duration", "coefficient_of_restitution", "contact_radius"):
            assert batch.summary[name][k] == pytest.approx(alone[name], rel=2e-6), (name, speeds[k])


@pytest.mark.parametrize("law", LAWS)
def test_rows_and_one_impact_take_the_strength_of_the_same_march(law):
    """On targets that move: with one by lines and the other by tables strengths differed by 2e-10."""
    case, speeds = scene(law, target=fm.Plate(STEEL, thickness="5 mm")), np.geomspace(0.2, 10.0, 4)
    for problem in problems_of(case, {"impactor.velocity": speeds}, speeds.size):
        strengths = np.broadcast_to(problem.impacts.law.strength, problem.approach.shape)
        for row, strength in zip(problem.impacts.index, strengths, strict=True):
            one = problem_of(case.replace({"impactor.velocity": f"{float(speeds[row])!r} m/s"}))
            assert one.impacts.law.strength == pytest.approx(strength, rel=2e-13)


def test_each_row_of_a_sweep_has_its_own_strength():
    from film_model.solve.batch import simulate_many

    columns = {
        "target.material.yield_strength": np.array([150e6, 250e6, 400e6] * 4),
        "target.material.strain_rate_coefficient": np.repeat([0.01, 0.02, 0.05], 4),
    }
    for law in ("auto", "stronge"):
        result = simulate_many(scene(law), columns)
        for k in (0, 4, 11):
            own = {path: float(values[k]) for path, values in columns.items()}
            own["target.material.yield_strength"] = f"{own['target.material.yield_strength']!r} Pa"
            alone = fm.simulate(scene(law).replace(own)).summary
            assert result.summary["maximum_force"][k] == pytest.approx(alone["maximum_force"], rel=1e-4)
            assert result.summary["mean_pressure"][k] == pytest.approx(alone["mean_pressure"], rel=1e-4)


def test_a_component_has_the_strength_of_its_scene_s_impact():
    component = fm.ImpactComponent(scene())
    assert component.problem.law == choose(scene()).problem.law
    assert component.problem.law.yield_strength > 1.1 * 250e6


def test_an_fmu_serves_the_strength_of_the_export_and_says_for_which_velocities():
    on = served(scene(velocity="1 m/s"))
    law = choose(on).problem.law
    found = validity_of(on).ranges["initial_velocity"]
    assert law.yield_strength == pytest.approx(choose(scene()).problem.law.yield_strength, rel=1e-4)
    assert "rate hardening" in found.above and 1.0 < found.high < 30.0
    from film_model.effects.trial import change

    faster = choose(served(scene(velocity=f"{found.high!r} m/s"))).problem
    assert change(faster, faster.again(law=law)) <= 0.01


def test_a_law_that_does_not_yield_has_no_notice_of_a_missing_coefficient():
    """A damped law absorbs energy where nothing yields: a coefficient would change nothing."""
    struck = fm.Scene(
        fm.Sphere("2.2 mm", "5 m/s", material="bearing steel"),
        fm.HalfSpace("soda-lime glass"),
        fm.Contact("tsuji", restitution=0.8),
    )
    effect = effect_of(struck)
    assert effect.state == NOT_NEEDED and effect.change < 1e-9
    assert effect_of(struck.replace({"target.material": "bearing steel"})).state == NOT_MODELLED

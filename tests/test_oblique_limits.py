"""An impact at an angle whose friction is not known: the bounds of its rebound, against impacts with friction."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.effects.oblique_limits import REVERSED, reversed_share, unknown
from film_model.solve.simulate import simulate_quietly
from film_model.studies.tangential_models import theory

FRICTIONS = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 12)])


def material(ratio):
    return {"youngs_modulus": "210 GPa", "poissons_ratio": ratio, "density": "7850 kg/m^3"}


def slanted(angle="40 deg", ratio=0.3, target=None, law="hertz", **ball):
    sphere = fm.Sphere("5 mm", "3 m/s", material=material(ratio), angle=angle, **ball)
    return fm.Scene(sphere, target or fm.HalfSpace(material(ratio)), fm.Contact(law), fm.Effects(gravity=False))


SCENES = {
    "20 deg": slanted("20 deg"),
    "40 deg": slanted(),
    "80 deg": slanted("80 deg"),
    "back spin": slanted(spin="-4000 rpm"),
    "spin only": slanted("0 deg", spin="3000 rpm"),
    "shell, no Poisson's ratio": slanted(ratio=0.0, shape="shell"),
    "two balls": slanted(target=fm.Body(material(0.4), radius="8 mm", velocity="-1 m/s")),
    "yields": slanted(target=fm.HalfSpace("mild steel"), law="elastoplastic"),
}


def effect_of(scene):
    return next(effect for effect in simulate_quietly(scene).effects if effect.name == "obliqueness")


@pytest.mark.parametrize(
    "name", [name if name == "40 deg" else pytest.param(name, marks=pytest.mark.slow) for name in SCENES]
)
def test_impacts_with_any_friction_lie_within_the_bounds(name):
    """And span at least 85 % of them."""
    scene = SCENES[name]
    summary = simulate_quietly(scene).summary
    bounds, seen = unknown(scene, summary["coefficient_of_restitution"]), []
    for friction in FRICTIONS.tolist():
        found = simulate_quietly(scene.replace({"contact.friction": friction})).oblique.summary
        speed = math.hypot(found["tangential_rebound_velocity"], summary["rebound_velocity"])
        seen.append((speed, found["rebound_angle"], found["rebound_spin"]))
    for values, ends in zip(np.array(seen).T, bounds[:3], strict=True):
        room = 1e-6 * max(map(abs, ends))
        assert ends[0] - room <= values.min() and values.max() <= ends[1] + room
        assert values.max() - values.min() > 0.85 * (ends[1] - ends[0])


@pytest.mark.slow
def test_the_table_of_what_comes_back():
    """ψ₂/ψ₁ of alike bodies at its least, against the table; between its χ the chord lies above."""
    for ratio, at in ((0.0, 3.68), (0.1, 3.35), (0.3, 2.68), (0.499, 1.89)):
        scene = slanted(ratio=ratio)
        share = reversed_share(scene, 3.5 / scene.mass)
        before = np.linspace(0.9, 1.1, 5) * at
        found = -float((theory(scene, before) / before).min())
        assert found - 1e-4 <= share < found + 5e-3
    assert reversed_share(slanted(), 100.0 / slanted().mass) == 1.0
    assert all(0.0 < share <= 1.0 for _, share in REVERSED)


def test_the_warning_says_how_far_the_rebound_is_open():
    effect = effect_of(slanted())
    bounds = unknown(slanted(), 1.0)
    assert f"{bounds.speed[0]:.3g} m/s to 3 m/s at {math.degrees(bounds.angle[0]):.3g}° to 40°" in effect.warning
    assert "coefficients from 0 to 1" in effect.warning and "rad/s" in effect.warning
    assert effect.change == pytest.approx(bounds.change) and effect.change > 0.2
    assert effect_of(slanted("0.2 deg")).state == "not needed"
    assert effect_of(slanted().replace({"contact.friction": 0.1})).state == "simulated"
    plate = effect_of(slanted(target=fm.Plate("mild steel", thickness="5 mm")).replace({"contact.friction": 0.1}))
    assert plate.reason.endswith("; the plate is immovable along its surface")


@pytest.mark.parametrize("angle", [5.0, 30.0, 75.0])
@pytest.mark.parametrize("law", ["hertz", "elastoplastic"])
def test_how_the_contact_will_slide_is_said_before_it_is_computed(angle, law):
    target = fm.HalfSpace("mild steel") if law == "elastoplastic" else None
    history = simulate_quietly(slanted(f"{angle} deg", target=target, law=law).replace({"contact.friction": 0.2}))
    (effect,) = [effect for effect in history.effects if effect.name == "obliqueness"]
    assert f"the contact {history.oblique.sliding_regime}: impact number " in effect.reason
    number = abs(history.oblique.summary["impact_number"])
    assert f"impact number {number:.3g}" in effect.reason
    if law == "hertz":
        chi = history.oblique.summary["tangential_parameter"]
        assert f"limits 1 and {4.0 * chi - 1.0:.3g}" in effect.reason

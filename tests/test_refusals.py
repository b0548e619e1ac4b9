"""Scenes that no law or target can serve: each is refused with a sentence, and none ends in another error."""

import pytest

import film_model as fm

BALL = fm.Sphere("10 mm", velocity="0.25 m/s", mass="60.74 g", material="WC, Big-Alabo 2017")
STEEL = fm.HalfSpace("mild steel")
BEAM = fm.Beam("mild steel", "300 mm", "30 mm", "10 mm")
SOFT = {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3, "density": "1000 kg/m^3", "yield_strength": "0.25 GPa"}


def test_too_large_a_yield_strain_is_a_mistake_of_the_scene():
    scene = fm.Scene(BALL, fm.HalfSpace(SOFT), fm.Contact("jackson-green", effective_modulus="0.5 GPa"))
    for call in (lambda: fm.simulate(scene), lambda: fm.simulate_batch(scene, velocity=["1 m/s", "2 m/s"])):
        with pytest.raises(fm.SceneError, match=r"contact\.law: law jackson-green: S_y/E is 0\.5; it must be"):
            call()


def test_points_of_a_table_that_nearly_coincide_are_refused():
    with pytest.raises(fm.SceneError, match="point 2, 1e-300 m, is too close to the one before, 0 m: leave one out"):
        fm.Contact("tabulated", indentation=["0 m", "1e-300 m", "1 mm"], force=["0 N", "1e-300 N", "1 kN"])


@pytest.mark.parametrize("points", [0, 1])
def test_a_table_of_less_than_two_points_is_refused(points):
    values = {"indentation": ["0 m"] * points, "force": ["0 N"] * points}
    with pytest.raises(fm.SceneError, match="2 to 5000 are allowed"):
        fm.Contact("tabulated", **values)


@pytest.mark.parametrize("target", [STEEL, BEAM], ids=["half-space", "beam"])
@pytest.mark.parametrize("speed", ["1 mm/s", "5 m/s"])
def test_law_auto_unloads_by_brakes_rule_below_and_above_yield(target, speed):
    ball = fm.Sphere("10 mm", velocity=speed, mass="60.74 g", material="WC, Big-Alabo 2017")
    fixed = fm.Effects(target_motion=False)
    history = fm.simulate(fm.Scene(ball, target, fm.Contact("auto", unloading="brake"), fixed))
    assert 0.0 < history.summary["coefficient_of_restitution"] <= 1.0 + 1e-9
    assert isinstance(history.warnings, tuple)


CANNOT = {
    "tsuji": ({"restitution": 0.6}, "a damped law"),
    "hunt-crossley": ({"restitution": 0.6}, "a damped law"),
    "meyer": ({"stiffness": "1e9 N/m^1.5", "exponent": 1.5, "initial_force": "10 N"}, "must not jump"),
}


@pytest.mark.parametrize("law", list(CANNOT))
def test_laws_that_a_beam_cannot_serve_are_refused(law):
    """On the static stiffness alone; with its vibrations a beam serves every law."""
    values, reason = CANNOT[law]
    scene = fm.Scene(BALL, BEAM, fm.Contact(law, **values))
    with pytest.raises(fm.SimulationError, match=reason):
        fm.simulate(scene.replace({"effects.target_inertia": False}))
    assert fm.simulate(scene, accuracy=1e-2).summary["maximum_force"] > 0.0

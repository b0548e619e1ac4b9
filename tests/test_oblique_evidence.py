"""Oblique impacts of published test cases: Chung & Ooi's tests 3 to 5, with the numbers of codes that run them."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.solve.simulate import simulate_quietly

ALUMINA = {"youngs_modulus": "380 GPa", "poissons_ratio": 0.23, "density": "4000 kg/m^3"}
CAST_IRON = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.25, "density": "7000 kg/m^3"}
ALLOY = {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33, "density": "2700 kg/m^3"}
STEEL = {"youngs_modulus": "208 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
RIGID = {"youngs_modulus": "1e5 GPa", "poissons_ratio": 0.23, "density": "7850 kg/m^3"}
"""The stiffest that is allowed; its Poisson's ratio is that of alumina, so that κ is that of a rigid wall."""


def impact(material, angle, friction, radius="2.5 mm", speed="3.9 m/s", target=RIGID, law="hertz", **contact):
    ball = fm.Sphere(radius, speed, material=material, angle=f"{angle} deg")
    given = fm.Contact(law, friction=friction, **contact)
    return simulate_quietly(fm.Scene(ball, fm.HalfSpace(target), given, fm.Effects(gravity=False, wave_losses=False)))


@pytest.mark.parametrize("material", [ALUMINA, CAST_IRON])
@pytest.mark.parametrize("given", [0.2, 0.4, 0.6, 0.8, 0.98])
def test_3_the_restitution_that_is_given_comes_back(material, given):
    """Normal impacts under a damped law: the ratio of the velocities is the coefficient asked for."""
    history = impact(material, 0.0, None, law="tsuji", restitution=given)
    assert history.summary["coefficient_of_restitution"] == pytest.approx(given, rel=2e-3)


RIGID_WALL = {
    **{5.0: (0.7416, 87.8), 10.0: (0.6399, 243.8), 20.0: (0.5936, 542.1)},
    **{30.0: (0.6813, 621.5), 50.0: (0.8456, 461.3)},
}
"""Angle, °: tangential restitution and spin, rad/s, by an integration elsewhere, of alumina on a rigid wall."""


@pytest.mark.parametrize("angle", RIGID_WALL)
def test_4_alumina_on_a_rigid_wall(angle):
    found = impact(ALUMINA, angle, 0.092).oblique.summary
    restitution, spin = RIGID_WALL[angle]
    assert found["tangential_restitution"] == pytest.approx(restitution, abs=1e-4)
    assert -found["rebound_spin"] == pytest.approx(spin, abs=0.1)


@pytest.mark.parametrize("material", [ALUMINA, ALLOY])
def test_4_where_the_contact_slides_throughout(material):
    """e_t = 1 − 2µ/tan θ and R ω' = −5 µ V_n, for the alloy as for alumina."""
    for angle in (40.0, 60.0, 85.0):
        history = impact(material, angle, 0.092)
        found, turn = history.oblique.summary, math.radians(angle)
        assert history.oblique.sliding_regime == "slides throughout"
        assert found["tangential_restitution"] == pytest.approx(1.0 - 2.0 * 0.092 / math.tan(turn), rel=1e-9)
        assert 2.5e-3 * found["rebound_spin"] == pytest.approx(-5.0 * 0.092 * 3.9 * math.cos(turn), rel=1e-9)


WU = (
    *((1.190, -0.213), (1.553, -0.373), (1.915, -0.627), (2.314, -0.947), (2.786, -1.253), (3.317, -1.520)),
    *((3.970, -1.720), (4.755, -1.707), (5.758, -1.200), (7.124, 0.133), (9.118, 2.147)),
)
"""tan θ/µ, and the rebound of the contact point over µ V_n, by the finite elements of Wu for an elastic steel ball."""


def test_5_the_finite_elements_of_wu():
    """V_n = 5 m/s, R = 10 µm, µ = 0.3: within 0.06 from tan θ/µ = 1.9 on, 0.15 below."""
    off = []
    for tangent, measured in WU:
        angle = math.degrees(math.atan(0.3 * tangent))
        speed = f"{5.0 / math.cos(math.radians(angle))!r} m/s"
        found = impact(STEEL, angle, 0.3, "10 um", speed, STEEL).oblique.summary
        off.append(abs(found["contact_point_rebound_velocity"] / (0.3 * 5.0) - measured))
    assert max(off[2:]) < 0.06 and max(off) < 0.15
    assert np.median(off) < 0.04

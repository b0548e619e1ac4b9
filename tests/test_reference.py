"""The two references against each other, closed forms and published numbers; neither uses the core."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from film_model.laws import AbstractLaw, BigAlabo, Hertz, Meyer, Power, Stage, Stronge, Unloading
from film_model.studies.quadrature import REFERENCE_VALUES, integrate, quadrature
from film_model.targets.plate_waves import paper_plate_impedance

MODULUS = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)  # tungsten carbide on steel, Pa
BALL = (MODULUS, 0.010, 1.0e9)  # and the radius, m, and yield strength, Pa
MASS, VELOCITY = 0.06074, 0.25  # kg, m/s

# The same ball: δ_m, F_m, t_m, t_c, δ_f, restitution; µm, N, µs
TUNGSTEN_CARBIDE = [
    (BigAlabo(*BALL), (9.48384056, 516.087743, 55.627347, 105.255496, 1.75359744, 0.91690838)),
    (Stronge(*BALL), (7.44980725, 658.120753, 43.249558, 79.85774, 2.08597306, 0.86249792)),
]

# Zener's λ: restitution, t_c/T, t_c, F_m and δ_m over Hertz's on a half-space
ZENER = [
    (0.05, 0.917772, 3.24709, 1.00902, 0.950608, 0.966795),
    (0.5, 0.436895, 3.62444, 1.12628, 0.656220, 0.755149),
    (1.0, 0.184123, 4.38761, 1.36343, 0.486468, 0.618543),
    (2.0, 0.020683, 8.48322, 2.63613, 0.318963, 0.466831),
    (3.0, 0.002795, 16.9340, 5.26218, 0.236473, 0.382403),
    (5.0, 0.000217, 39.4893, 12.2711, 0.155253, 0.288864),
]


@dataclass(frozen=True)
class Softening(AbstractLaw):
    """f = sin ξ, then constant; residual ξ_m²/8, unloading exponent 1.2: a peak within a stage, no closed form."""

    def scales(self, energy):
        return 1e-5, 100.0

    def stages(self):
        unloading = Unloading(residual=lambda xi: xi**2 / 8, exponent=1.2)
        return (
            Stage("sine", 0.0, 2.0, np.sin, unloading),
            Stage("flat", 2.0, math.inf, Power(constant=math.sin(2.0)), Unloading(residual=Power(0.5, 0.9))),
        )


LAWS = [
    *(law for law, _ in TUNGSTEN_CARBIDE),
    BigAlabo(*BALL, constants="printed"),
    Hertz(MODULUS, 0.010),
    Meyer(1e6, 1.0),
    Meyer(1e9, 1.7),
    Meyer(1e9, 1.7, initial_force=10.0, initial_indentation=1e-6),
    Meyer(1e9, 1.5, initial_indentation=3e-6),
    Softening(),
]


@pytest.mark.parametrize(("law", "expected"), TUNGSTEN_CARBIDE, ids=lambda value: getattr(value, "name", ""))
@pytest.mark.parametrize("reference", [quadrature, integrate])
def test_tungsten_carbide_ball(law, expected, reference):
    got = reference(law, MASS, VELOCITY)
    values = (
        got["maximum_indentation"] * 1e6,
        got["maximum_force"],
        got["time_of_maximum_indentation"] * 1e6,
        got["contact_duration"] * 1e6,
        got["permanent_indentation"] * 1e6,
        got["coefficient_of_restitution"],
    )
    assert values == pytest.approx(expected, rel=1.2e-8)  # the digits given
    assert got["time_impactor_stops"] == got["time_of_maximum_indentation"]
    assert got["energy_absorbed"] == pytest.approx(0.5 * MASS * VELOCITY**2 * (1 - expected[-1] ** 2), rel=1e-6)
    assert got["energy_radiated"] == 0.0


def test_hertz_closed_form():
    law = Hertz(MODULUS, 0.010)
    stiffness = 4 / 3 * MODULUS * math.sqrt(0.010)
    depth = (5 * MASS * VELOCITY**2 / (4 * stiffness)) ** 0.4
    got = quadrature(law, MASS, VELOCITY)
    assert got["maximum_indentation"] == pytest.approx(depth, rel=1e-14)
    assert got["maximum_force"] == pytest.approx(stiffness * depth**1.5, rel=1e-14)
    assert got["contact_duration"] * VELOCITY / depth == pytest.approx(2.9432751843247, rel=1e-13)
    assert got["rebound_velocity"] == pytest.approx(-VELOCITY, rel=1e-15)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.3, 2.0, 2.5])
def test_meyer_closed_form(exponent):
    """t_m = √π Γ(1 + 1/(q + 1))/Γ(1/2 + 1/(q + 1)) δ_m/V_0."""
    n = exponent + 1
    depth = (n * MASS * VELOCITY**2 / (2 * 1e8)) ** (1 / n)
    time = math.sqrt(math.pi) * math.gamma(1 + 1 / n) / math.gamma(0.5 + 1 / n) * depth / VELOCITY
    got = quadrature(Meyer(1e8, exponent), MASS, VELOCITY)
    assert got["maximum_indentation"] == pytest.approx(depth, rel=1e-13)
    assert got["time_of_maximum_indentation"] == pytest.approx(time, rel=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("velocity", [0.004, 0.05, 0.25, 2.0])
def test_quadrature_and_integration_agree(law, velocity):
    exact, got = quadrature(law, MASS, velocity), integrate(law, MASS, velocity)
    energy = 0.5 * MASS * velocity**2
    for name in REFERENCE_VALUES:
        small = 1e-11 * energy if name.startswith("energy") else 1e-15
        assert got[name] == pytest.approx(exact[name], rel=1e-11, abs=small), name


def test_just_beyond_yield():
    """Passing the yield point slowly makes the integrand nearly singular."""
    law = BigAlabo(*BALL)
    scale, force = law.scales(0.0)
    velocity = math.sqrt(0.8 * force * scale / MASS) * (1 + 1e-9)
    exact, got = quadrature(law, MASS, velocity), integrate(law, MASS, velocity)
    assert exact["maximum_indentation"] == pytest.approx(scale, rel=1e-10)
    assert got["contact_duration"] == pytest.approx(exact["contact_duration"], rel=1e-10)


def test_peak_inside_a_stage():
    got = quadrature(Softening(), MASS, 0.25)
    assert got["maximum_force"] == pytest.approx(100.0, rel=1e-14)
    assert got["maximum_indentation"] > 2e-5


def test_law_that_ends_too_soon():
    @dataclass(frozen=True)
    class Short(Softening):
        def stages(self):
            return (Stage("sine", 0.0, 2.0, np.sin),)

    for reference in (quadrature, integrate):
        with pytest.raises(ValueError, match="the law ends at 2e-05 m"):
            reference(Short(), MASS, 2.0)


@pytest.mark.parametrize(("method", "rtol", "within"), [("DOP853", 1e-12, 2e-9), ("LSODA", 1e-11, 2e-9)])
def test_the_published_plate(method, rtol, within):
    impedance = paper_plate_impedance(4.132, 154.9, 4.76, 91.4, 8.97)
    got = integrate(Hertz(9.72e9, 6.35e-3), 8.3e-3, 3.0, impedance, method=method, rtol=rtol)
    expected = {
        "maximum_force": 302.639062,
        "maximum_indentation": 44.1186361e-6,
        "time_of_maximum_indentation": 33.8187787e-6,
        "time_impactor_stops": 181.842976e-6,
        "contact_duration": 262.590378e-6,
        "rebound_velocity": -0.0526358620,
    }
    for name, value in expected.items():
        assert got[name] == pytest.approx(value, rel=within), name
    assert got["energy_absorbed"] == pytest.approx(0.0, abs=1e-15)
    assert got["force_evaluations"] > 100


@pytest.mark.parametrize("row", ZENER, ids=lambda row: f"λ = {row[0]}")
def test_zener(row):
    λ, restitution, duration, *ratios = row
    modulus, radius, mass, velocity = 10e9, 0.01, 0.01, 2.0
    law = Hertz(modulus, radius)
    clock = (mass / (4 / 3 * modulus * math.sqrt(radius * velocity))) ** 0.4
    got, hertz = integrate(law, mass, velocity, mass / (λ * clock)), quadrature(law, mass, velocity)
    assert got["coefficient_of_restitution"] == pytest.approx(restitution, abs=6e-7)
    assert got["contact_duration"] / clock == pytest.approx(duration, rel=3e-6, abs=1.1e-6)
    names = ("contact_duration", "maximum_force", "maximum_indentation")
    assert [got[name] / hertz[name] for name in names] == pytest.approx(ratios, rel=3e-5, abs=6e-7)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=repr)
@pytest.mark.parametrize("share", [0.02, 0.5])
def test_energy_balance_on_a_moving_target(law, share):
    """½m(V_0² − v²) = work absorbed + ∫F²/Z dt, which is integrated separately."""
    still = quadrature(law, MASS, VELOCITY)
    impedance = still["maximum_force"] / VELOCITY / share
    got = integrate(law, MASS, VELOCITY, impedance)
    lost = 0.5 * MASS * (VELOCITY**2 - got["rebound_velocity"] ** 2)
    assert lost == pytest.approx(got["energy_absorbed"] + got["energy_radiated"], rel=1e-10)
    assert got["time_of_maximum_indentation"] < got["time_impactor_stops"] < got["contact_duration"]
    assert got["maximum_force"] <= impedance * VELOCITY


def test_a_stiff_target_is_a_half_space():
    law = BigAlabo(*BALL)
    still, moving = quadrature(law, MASS, VELOCITY), integrate(law, MASS, VELOCITY, 1e12)
    for name in REFERENCE_VALUES[:-2]:
        assert moving[name] == pytest.approx(still[name], rel=1e-7), name

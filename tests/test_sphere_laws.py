"""Laws of spheres that yield against their closed forms, printed tables and asymptotes."""

import math

import numpy as np
import pytest
from cases import EFFECTIVE_MODULUS, MASS, RADIUS, SPHERE, YIELD
from law_cases import restitution, scene_of, scene_text, velocity_of, yield_velocity

import film_model as fm
from film_model.laws.thornton import limit_point
from film_model.problem.curve import curve_of
from film_model.studies import quadrature


@pytest.mark.parametrize("ratio", [1.0, 1.01, 1.5, 4.0, 30.0, 1000.0])
def test_thornton_restitution_in_closed_form(ratio):
    law = fm.Thornton(*SPHERE, 1.6 * YIELD)
    r = 1.0 / ratio
    expected = math.sqrt(6 * math.sqrt(3) / 5) * math.sqrt(1 - r * r / 6)
    expected *= (r / (r + 2 * math.sqrt(6 / 5 - r * r / 5))) ** 0.25
    speed = ratio * yield_velocity(law)
    assert restitution(law, speed) == pytest.approx(expected, rel=1e-11)
    case = fm.Scene(fm.Sphere(velocity=f"{speed!r} m/s", radius="10 mm", mass=f"{MASS} kg"), fm.HalfSpace(),
                    contact=fm.Contact(law), effects=fm.Effects(gravity=False))  # fmt: skip
    assert fm.simulate(case, accuracy=1e-9).summary["coefficient_of_restitution"] == pytest.approx(expected, rel=1e-12)
    if ratio >= 1000.0:
        assert expected == pytest.approx(1.18499 * r**0.25, rel=3e-4)


def test_thornton_yield_velocity_of_a_solid_sphere():
    """V_Y = 1.5605 (p_y⁵/(E⁴ ρ))^{1/2}, and a contact radius that is continuous at the turn."""
    law, density = fm.Thornton(*SPHERE, 1.6e9), 7850.0
    mass = density * 4 / 3 * math.pi * RADIUS**3
    assert yield_velocity(law, mass) == pytest.approx(
        1.5605 * math.sqrt(1.6e9**5 / (EFFECTIVE_MODULUS**4 * density)), rel=2e-5
    )
    got = quadrature.quadrature(law, mass, 20 * yield_velocity(law, mass))
    depth, force = got["maximum_indentation"], got["maximum_force"]
    hertz = 4 / 3 * EFFECTIVE_MODULUS * math.sqrt(RADIUS) * depth**1.5
    recovered_radius = RADIUS * hertz / force
    assert recovered_radius * (depth - got["permanent_indentation"]) == pytest.approx(RADIUS * depth, rel=1e-11)


def test_kogut_etsion_as_printed():
    law = fm.KogutEtsion(*SPHERE, poissons_ratio=0.3, hardness=2.8e9, constants="printed")
    length, force = law.scales(1.0)
    assert force == pytest.approx(2 / 3 * law.pressure_factor * 2.8e9 * math.pi * RADIUS * length, rel=1e-13)
    curve = curve_of(law)
    for w, e in ((2.0, 0.963), (6.0, 0.851), (20.0, 0.697), (110.0, 0.542)):
        assert restitution(law, velocity_of(law, w * (1 - 1e-9))) == pytest.approx(e, abs=6e-4)  # below the jump
    for edge, jump in ((1.0, 3.00), (6.0, 1.68), (110.0, 7.88)):
        assert 100 * (curve.force(edge * (1 + 1e-12)) / curve.force(edge) - 1) == pytest.approx(jump, abs=0.006)
    assert len(curve.warnings) == 3
    just_above = fm.simulate(scene_of(law, velocity_of(law, 1.001)))
    assert just_above.summary["coefficient_of_restitution"] == pytest.approx(1.015, abs=1e-3)
    assert any("more than its loading stored" in warning for warning in just_above.warnings)


def test_kogut_etsion_continuous_is_near_the_printed_law():
    printed = fm.KogutEtsion(*SPHERE, poissons_ratio=0.3, hardness=2.8e9, constants="printed")
    mended = fm.KogutEtsion(*SPHERE, poissons_ratio=0.3, hardness=2.8e9)
    assert curve_of(mended).warnings == ()
    for w in (1.5, 5.0, 20.0, 100.0):
        assert curve_of(mended).force(w) == pytest.approx(curve_of(printed).force(w), rel=0.05)
    law = curve_of(mended)
    slope = (law.force(300.0) - law.force(200.0)) / 100.0
    assert slope == pytest.approx(3.0 / mended.pressure_factor, rel=1e-12)  # the pressure H: 2 π R H δ


def test_jackson_green_restitution():
    """Against values of the law and its residual, and the published fit, which it follows within 2 %."""
    strain = 0.003
    law = fm.JacksonGreen(2e11, 0.01, 2e11 * strain, poissons_ratio=0.3, constants="printed")
    known = {2: 0.9723, 5: 0.8991, 10: 0.8295, 30: 0.6949, 60: 0.6029, 100: 0.5355, 300: 0.4018}
    for ratio, e in known.items():
        got = restitution(law, ratio * yield_velocity(law))
        assert got == pytest.approx(e, abs=5e-4)
        if ratio <= 60:
            fit = 1 - 0.1 * math.log(ratio) * ((ratio - 1) / 59) ** 0.156
        else:
            fit = 1 - 0.1 * math.log(60) - 0.11 * math.log(ratio / 60) * (ratio - 60) ** (2.36 * strain)
        assert got == pytest.approx(fit, rel=0.025)


@pytest.mark.parametrize(("ratio", "jump"), [(0.3, 0.47), (0.45, -2.49)])
def test_jackson_green_force_jump_and_its_correction(ratio, jump):
    printed = fm.JacksonGreen(2e11, 0.01, 1e9, ratio, "printed")
    mended = fm.JacksonGreen(2e11, 0.01, 1e9, ratio)
    a, b = curve_of(printed), curve_of(mended)
    assert 100 * (a.force(1.9 * (1 + 1e-12)) / a.force(1.9) - 1) == pytest.approx(jump, abs=0.01)
    assert len(a.warnings) == 1 and b.warnings == ()
    assert b.force(20.0) == pytest.approx(a.force(20.0), rel=1e-4 * abs(jump))
    w = np.linspace(1.0, 40.0, 400)
    assert (np.diff([b.force(x) for x in w]) > 0).all()


def test_jackson_green_refuses_values_outside_metals():
    with pytest.raises(ValueError, match=r"S_y/E is 0.5; it must be below 0.2"):
        fm.JacksonGreen(2e9, 0.01, 1e9, 0.3)
    assert curve_of(fm.JacksonGreen(2e11, 0.01, 3e10, 0.3)).fit_error < 1e-11


def test_jackson_green_laws_of_equal_shape_share_a_curve():
    assert curve_of(fm.JacksonGreen(2e11, 0.01, 1e9, 0.3)) is curve_of(fm.JacksonGreen(2e11, 0.02, 1e9, 0.3))
    assert curve_of(fm.JacksonGreen(2e11, 0.01, 1e9, 0.3)) is not curve_of(fm.JacksonGreen(2e11, 0.01, 1e9, 0.31))


@pytest.mark.parametrize(("depth", "e"), [(1.5, 0.950), (3.0, 0.800), (10.0, 0.579), (50.0, 0.381)])
def test_yigit_christoforou_restitution(depth, e):
    law = fm.YigitChristoforou(*SPHERE, YIELD)
    got = quadrature.quadrature(law, MASS, velocity_of(law, depth))
    assert got["coefficient_of_restitution"] == pytest.approx(e, abs=6e-4)
    force = 1 + 1.5 * (depth - 1)
    dent = (depth**1.5 - force) ** (2 / 3)
    assert got["permanent_indentation"] / law.scales(1.0)[0] == pytest.approx(dent, rel=1e-11)


def test_rigid_plastic_follows_johnson():
    pressure = 0.6e9
    law = fm.RigidPlastic(*SPHERE, pressure)
    for velocity in (1.0, 10.0):
        energy = 0.5 * MASS * velocity**2
        expected = 1.884 * math.sqrt(pressure / EFFECTIVE_MODULUS) * (energy / (pressure * RADIUS**3)) ** -0.125
        assert restitution(law, velocity) == pytest.approx(expected, rel=3e-4)
        depth = quadrature.quadrature(law, MASS, velocity)["maximum_indentation"]
        assert math.pi * RADIUS * pressure * depth**2 == pytest.approx(energy, rel=1e-12)
    assert restitution(law, 1e-4) == pytest.approx(math.sqrt(0.8), rel=1e-10)  # recovery would exceed indentation


def test_brake_unloading_keeps_the_contact_radius():
    """δ_f = δ_m (1 − F_m/F_Hertz), and e = 0.781 for Big-Alabo's law at 1.605 δ_y."""
    law = fm.BrakeUnloading(fm.BigAlabo(*SPHERE, YIELD), *SPHERE)
    got = quadrature.quadrature(law, MASS, velocity_of(law, 1.605))
    depth, force = got["maximum_indentation"], got["maximum_force"]
    hertz = 4 / 3 * EFFECTIVE_MODULUS * math.sqrt(RADIUS) * depth**1.5
    assert got["permanent_indentation"] == pytest.approx(depth * (1 - force / hertz), rel=1e-10)
    assert got["coefficient_of_restitution"] == pytest.approx(0.781, abs=5e-4)
    thornton = fm.Thornton(*SPHERE, 1.6e9)
    again = fm.BrakeUnloading(thornton, *SPHERE)
    assert restitution(again, 0.5) == pytest.approx(restitution(thornton, 0.5), rel=1e-13)


def test_brake_unloading_of_a_scene_is_of_its_own_sphere():
    case = fm.Scene.from_text(scene_text("hertz"))
    assert fm.simulate(case).summary["coefficient_of_restitution"] == pytest.approx(1.0, rel=1e-12)
    softer = case.replace({"contact.effective_modulus": "20 GPa", "contact.law": "big-alabo"})
    assert softer.contact.unloading == "brake"
    law = fm.simulate(softer).problem.law
    assert (law.name, law.effective_modulus, law.radius) == ("big-alabo", 2e10, 0.01)


def test_retrace_is_reversible():
    case = fm.Scene.from_text(scene_text("stronge"))
    summary = fm.simulate(case).summary
    assert summary["coefficient_of_restitution"] == pytest.approx(1.0, rel=1e-12)
    assert summary["permanent_indentation"] == 0.0


def test_poissons_ratio_is_that_of_the_body_that_yields():
    case = fm.Scene.from_text(scene_text("jackson-green"))
    assert case.poissons_ratio == 0.3
    assert case.replace({"impactor.material": "mild steel", "contact.law": "hertz"}).poissons_ratio == 0.3
    assert case.replace({"contact.poissons_ratio": 0.1}).poissons_ratio == 0.1
    assert fm.simulate(case).problem.law.poissons_ratio == 0.3


def test_pressures_set_the_point_where_thornton_yields():
    """At yield the largest Hertz pressure, 2Ea/(πR), is the given pressure."""
    depth, force = limit_point(EFFECTIVE_MODULUS, RADIUS, 1.6e9)
    contact = math.sqrt(RADIUS * depth)
    assert 2 * EFFECTIVE_MODULUS * contact / (math.pi * RADIUS) == pytest.approx(1.6e9, rel=1e-14)
    assert 1.5 * force / (math.pi * contact**2) == pytest.approx(1.6e9, rel=1e-14)


def test_an_unloading_that_ends_with_a_slope_can_creep_for_ever():
    """Yigit and Christoforou's unloading ends with a slope: on a thin plate it is over-damped and never ends."""
    changes = {"impactor.velocity": "1.5 m/s", "effects.gravity": False}
    case = fm.Scene.from_text(scene_text("yigit-christoforou", "plate")).replace(changes)
    assert fm.simulate(case.replace({"target.thickness": "4 mm"})).outcome is fm.Outcome.SEPARATED
    creeping = fm.simulate(case.replace({"target.thickness": "3 mm"}))
    assert creeping.outcome is fm.Outcome.RESTING
    assert creeping.summary["contact_duration"] is None
    assert creeping.summary["maximum_force"] > 0

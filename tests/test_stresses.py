"""Impulse, contact radius, dent, pressures and stresses of an impact, each against an independent calculation."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.effects.choose import choose
from film_model.problem.stresses import contact_radius, edge_tension, shear_below

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3", "yield_strength": "1 GPa"}
ELASTIC = {"peak_pressure", "maximum_shear_stress", "maximum_von_mises_stress", "depth_of_maximum_stress"}


def scene(law="hertz", velocity="1 m/s", target=None, gravity="auto", **parameters):
    ball = fm.Sphere("5 mm", velocity=velocity, material=STEEL)
    return fm.Scene(ball, target or fm.HalfSpace(STEEL), fm.Contact(law, **parameters), fm.Effects(gravity=gravity))


def on_axis(ratio, depth):
    """σ_r − σ_z on the axis below Hertz's pressure (p0 = a = 1), by summing Boussinesq's point loads."""
    x, w = np.polynomial.legendre.leggauss(200)
    phi, w = (x + 1) * math.pi / 4, w * math.pi / 4
    s, load = np.sin(phi), 2 * math.pi * np.cos(phi) * np.sin(phi) * np.cos(phi) * w
    far = np.sqrt(s * s + depth * depth)
    axial = -3 / (2 * math.pi) * depth**3 / far**5
    radial = ((1 - 2 * ratio) * depth / far**3 - 3 * depth * s * s / far**5) / (4 * math.pi)
    return float((load * (radial - axial)).sum())


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.3, 0.4, 0.499])
def test_the_largest_shear_stress_against_boussinesq(ratio):
    shear, depth = shear_below(ratio)
    assert shear == pytest.approx(on_axis(ratio, depth) / 2, rel=1e-9)
    for other in (0.9 * depth, 0.99 * depth, 1.01 * depth, 1.1 * depth):
        assert on_axis(ratio, other) / 2 < shear
    many = shear_below(np.array([ratio, 0.25]))
    assert (many[0][0], many[1][0]) == (shear, depth)


def test_values_of_the_textbook():
    shear, depth = shear_below(0.3)  # Johnson 1985, section 3.4: 0.31 p0 at 0.48 a
    assert (round(shear, 3), round(depth, 2)) == (0.310, 0.48)
    assert edge_tension(0.3, 3e9) == pytest.approx(0.4e9)  # 0.133 p0


def test_the_shear_stress_is_that_of_the_body_where_it_is_larger():
    glass = fm.HalfSpace({"youngs_modulus": "70 GPa", "poissons_ratio": 0.22, "density": "2500 kg/m^3"})
    summary = fm.simulate(scene(velocity="0.01 m/s", target=glass)).summary
    ratio = summary["maximum_shear_stress"] / summary["peak_pressure"]
    assert ratio == pytest.approx(on_axis(0.22, summary["depth_of_maximum_stress"] / summary["contact_radius"]) / 2)
    assert round(ratio, 3) == 0.329  # in the glass; 0.310 in the steel, which alone has a yield strength
    many = fm.simulate_batch(scene(velocity="0.01 m/s", target=glass), velocity=["0.01 m/s", "0.02 m/s"])
    assert many.summary["maximum_shear_stress"][0] == pytest.approx(summary["maximum_shear_stress"])
    given = fm.simulate(scene(velocity="0.01 m/s", target=glass, poissons_ratio=0.3)).summary
    assert given["maximum_shear_stress"] == pytest.approx(0.31002 * given["peak_pressure"], rel=1e-4)


def test_an_elastic_contact():
    summary = fm.simulate(scene(velocity="0.01 m/s")).summary
    force, depth = summary["maximum_force"], summary["maximum_indentation"]
    radius = (3 * force * 5e-3 / (4 * 210e9 / (2 * (1 - 0.3**2)))) ** (1 / 3)
    assert summary["contact_radius"] == pytest.approx(radius, rel=1e-6)
    assert summary["contact_radius"] == pytest.approx(math.sqrt(5e-3 * depth), rel=1e-12)
    assert summary["mean_pressure"] == pytest.approx(force / (math.pi * radius**2), rel=1e-5)
    assert summary["peak_pressure"] == pytest.approx(1.5 * summary["mean_pressure"], rel=1e-14)
    assert summary["maximum_shear_stress"] == pytest.approx(0.3100205 * summary["peak_pressure"], rel=1e-6)
    assert summary["maximum_von_mises_stress"] == 2 * summary["maximum_shear_stress"]
    assert summary["depth_of_maximum_stress"] == pytest.approx(0.4808645 * radius, rel=1e-5)
    assert summary["dent_diameter"] == 0.0


@pytest.mark.parametrize("law", ["big-alabo", "jackson-green", "kogut-etsion", "stronge"])
def test_a_contact_beyond_yield(law):
    history = fm.simulate(scene(law, **({"hardness": "2.8 GPa"} if law == "kogut-etsion" else {})))
    summary = history.summary
    pressure = 1.295 * math.exp(0.736 * 0.3) * 1e9
    first = (0.5 * math.pi * pressure / history.scene.effective_modulus) ** 2 * 5e-3
    w = summary["maximum_indentation"] / first
    radius = math.sqrt(5e-3 * first * w * (1 + 0.09639 * math.log(1 + ((w - 1) / 1.762) ** 2)))  # n = 0
    assert w > 4
    assert summary["contact_radius"] == pytest.approx(radius, rel=1e-12)
    assert summary["dent_diameter"] == 2 * summary["contact_radius"]
    pressure = summary["maximum_force"] / (math.pi * radius**2)
    assert summary["mean_pressure"] == pytest.approx(pressure, rel=1e-12)
    assert {name for name in ELASTIC if summary[name] is None} == ELASTIC


@pytest.mark.parametrize(("law", "widening", "over"), [("thornton", 1.0, 1.6), ("rigid-plastic", 2.0, 3.0)])
def test_laws_with_a_contact_radius_of_their_own(law, widening, over):
    alone = fm.simulate(scene(law, "20 m/s"))
    summary, pressure = alone.summary, over * alone.scene.flow_strength
    radius = math.sqrt(widening * 5e-3 * summary["maximum_indentation"])
    assert summary["contact_radius"] == pytest.approx(radius, rel=1e-12)
    assert summary["dent_diameter"] == 2 * summary["contact_radius"]
    if law == "rigid-plastic":  # the pressure is p_d throughout
        assert summary["mean_pressure"] == pytest.approx(pressure, rel=1e-6)
    else:  # p_y at the centre, and less outside
        assert 2 / 3 * pressure < summary["mean_pressure"] < pressure
    many = fm.simulate_batch(scene(law), velocity=["20 m/s", "30 m/s"])
    assert many.summary["contact_radius"][0] == pytest.approx(radius, rel=1e-4)
    given = fm.simulate(scene(law, yield_pressure="2 GPa")).summary
    own = math.sqrt(widening * 5e-3 * given["maximum_indentation"])
    assert given["contact_radius"] == pytest.approx(own, rel=1e-12)


def test_a_rigid_plastic_force_may_be_hertzs_by_chance():
    """Its line crosses Hertz's curve: the radius and pressure there are its own, and no elastic stress is known."""
    given = scene("rigid-plastic")
    modulus, pressure = given.effective_modulus, 3.0 * given.yield_strength
    depth = given.effective_radius * (1.5 * math.pi * pressure / modulus) ** 2  # 4/3 E √R δ^1.5 = 2 π R p δ
    at = depth * np.array([0.5, 0.999, 1.0, 1.001, 2.0])
    force = 2.0 * math.pi * given.effective_radius * pressure * at
    radius, elastic = contact_radius(choose(given).problem.impacts, force, at)
    np.testing.assert_allclose(radius, np.sqrt(2.0 * given.effective_radius * at), rtol=1e-12)
    assert not np.any(elastic)


def test_the_contact_is_at_most_as_wide_as_the_ball():
    radius, elastic = contact_radius(choose(scene("auto", "50 m/s")).problem.impacts, 1e4, 4e-3)
    assert not elastic
    assert radius == pytest.approx(5e-3, rel=1e-12)


def test_what_is_unknown_is_none():
    ball = fm.Sphere("5 mm", velocity="1 m/s", mass="4 g")
    by_modulus = fm.simulate(fm.Scene(ball, fm.HalfSpace(), fm.Contact("hertz", effective_modulus="100 GPa"))).summary
    assert by_modulus["peak_pressure"] > 0 and by_modulus["maximum_shear_stress"] is None
    given = fm.Contact("meyer", stiffness="1e9 N/m^1.2", exponent=1.2)
    foreign = fm.simulate(fm.Scene(ball, fm.HalfSpace(), given)).summary
    assert foreign["contact_radius"] is None and foreign["mean_pressure"] is None and foreign["impulse"] > 0
    damped = fm.Contact("hunt-crossley", restitution=0.8)
    lossy = fm.simulate(fm.Scene(fm.Sphere("5 mm", velocity="0.01 m/s", material=STEEL), fm.HalfSpace(STEEL), damped))
    assert lossy.summary["mean_pressure"] is None and lossy.summary["dent_diameter"] == 0.0
    almost = fm.simulate(lossy.scene.replace({"contact.restitution": 0.9999})).summary  # its largest force is Hertz's
    assert almost["depth_of_maximum_stress"] is None and almost["peak_pressure"] is None


@pytest.mark.parametrize(
    ("target", "gravity", "velocity"),
    [
        (fm.HalfSpace(STEEL), False, "1 m/s"),
        (fm.HalfSpace(STEEL), True, "0.02 m/s"),
        (fm.Plate(STEEL, thickness="4 mm"), True, "0.5 m/s"),
        (fm.Body(STEEL, radius="8 mm", velocity="0.2 m/s"), False, "1 m/s"),
    ],
)
def test_the_impulse_against_the_sampled_force(target, gravity, velocity):
    history = fm.simulate(scene("auto", velocity, target, gravity=gravity), accuracy=1e-8)
    times = np.linspace(0.0, history.summary["contact_duration"], 4001)
    impulse = np.trapezoid(history.sample_si(times).contact_force, times)
    assert history.summary["impulse"] == pytest.approx(impulse, rel=1e-5)
    assert history.impulse.to("N s").magnitude == history.summary["impulse"]

"""Numbers known from elsewhere: quadrature, the literature, and the paper."""

import math
from pathlib import Path

import pytest
from cases import zener_scene

import film_model as fm

SCENES = Path(__file__).parent.parent / "examples" / "scenes"

BIG_ALABO = {
    "maximum_indentation": 9.48384056e-6,
    "maximum_force": 516.087744,
    "time_of_maximum_indentation": 55.627347e-6,
    "contact_duration": 105.255496e-6,
    "permanent_indentation": 1.75359744e-6,
    "coefficient_of_restitution": 0.91690838,
}
STRONGE = {
    "maximum_indentation": 7.44980725e-6,
    "maximum_force": 658.120753,
    "time_of_maximum_indentation": 43.249558e-6,
    "contact_duration": 79.85774e-6,
    "permanent_indentation": 2.08597306e-6,
    "coefficient_of_restitution": 0.86249792,
}
PLATE_PAPER = {
    "maximum_force": 302.639062,
    "maximum_indentation": 44.1186361e-6,
    "time_of_maximum_indentation": 33.8187787e-6,
    "time_impactor_stops": 181.842976e-6,
    "contact_duration": 262.590378e-6,
    "rebound_velocity": -0.0526358620,
}
ROUNDED = 1e-8  # the values above are known to nine digits


def load(name, changes=None):
    scene = fm.Scene.from_toml(SCENES / f"{name}.toml")
    return scene.replace(changes) if changes else scene


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
@pytest.mark.parametrize(
    ("name", "changes", "exact"),
    [
        ("tungsten_carbide_on_steel", None, BIG_ALABO),
        ("tungsten_carbide_on_steel_stronge", None, STRONGE),
        ("olsson_plate", {"target.impedance_formula": "paper", "effects.boundary_reflections": False}, PLATE_PAPER),
    ],
)
def test_paper_cases_within_the_accuracy_asked_for(name, changes, exact, accuracy):
    history = fm.simulate(load(name, changes), accuracy=accuracy)
    assert history.accuracy.estimated <= accuracy
    for key, value in exact.items():
        assert history.summary[key] == pytest.approx(value, rel=accuracy + ROUNDED), key


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("tungsten_carbide_on_steel", (9.4546e-6, 513.42, 55.574e-6, 105.15e-6)),
        ("tungsten_carbide_on_steel_stronge", (7.4438e-6, 657.37, 43.238e-6, 79.79e-6)),
    ],
)
def test_table_3(name, values):
    """Table 3 of the paper: five chords a stage."""
    summary = fm.simulate(load(name), segments=5, linearisation="chord").summary
    keys = ("maximum_indentation", "maximum_force", "time_of_maximum_indentation", "contact_duration")
    for key, value in zip(keys, values, strict=True):
        assert summary[key] == pytest.approx(value, rel=1e-4), key


def test_table_3_permanent_indentation_comes_out_with_the_printed_constants():
    scene = load("tungsten_carbide_on_steel", {"contact.law": "big-alabo", "contact.constants": "printed"})
    summary = fm.simulate(scene, segments=5, linearisation="chord").summary
    assert summary["permanent_indentation"] == pytest.approx(1.78e-6, abs=0.005e-6)


def test_olsson_plate_with_the_exact_impedance():
    scene = load("olsson_plate", {"effects.boundary_reflections": False})
    summary = fm.simulate(scene, accuracy=1e-6).summary
    assert summary["maximum_force"] == pytest.approx(331.76, abs=0.005)
    assert summary["maximum_indentation"] == pytest.approx(46.905e-6, abs=0.0005e-6)
    assert summary["time_of_maximum_indentation"] == pytest.approx(34.80e-6, abs=0.005e-6)
    assert summary["time_impactor_stops"] == pytest.approx(142.7e-6, abs=0.05e-6)
    assert summary["contact_duration"] == pytest.approx(214.4e-6, abs=0.05e-6)


ZENER = [  # λ, e, t_c/T, F_m/F_Hertz, δ_m/δ_Hertz: Zener's equation by Runge–Kutta of order 8, six digits
    (0.01, 0.982876, 3.22368, 0.989724, 0.993137),
    (0.05, 0.917772, 3.24709, 0.950608, 0.966795),
    (0.1, 0.843339, 3.27849, 0.905781, 0.936157),
    (0.2, 0.714045, 3.34866, 0.827513, 0.881421),
    (0.3, 0.605947, 3.42911, 0.761476, 0.833881),
    (0.5, 0.436895, 3.62444, 0.656220, 0.755149),
    (0.8, 0.263590, 4.02462, 0.542848, 0.665455),
    (1.0, 0.184123, 4.38761, 0.486468, 0.618543),
    (1.5, 0.066404, 5.83625, 0.385625, 0.529798),
    (2.0, 0.020683, 8.48322, 0.318963, 0.466831),
    (3.0, 0.002795, 16.9340, 0.236473, 0.382403),
    (5.0, 0.000217, 39.489, 0.155253, 0.288864),
]


@pytest.mark.parametrize(("value", "restitution", "duration", "force", "depth"), ZENER)
def test_zener(value, restitution, duration, force, depth):
    scene = zener_scene(value, accuracy=1e-7)
    summary = fm.simulate(scene).summary
    mass, modulus = scene.mass, scene.effective_modulus
    stiffness = 4 / 3 * modulus * math.sqrt(scene.effective_radius)
    clock = (mass / stiffness) ** 0.4  # T at 1 m/s
    hertz_depth = (1.25 * mass / stiffness) ** 0.4
    hertz_force = stiffness * hertz_depth**1.5
    last_digit = 0.6e-6
    assert summary["coefficient_of_restitution"] == pytest.approx(restitution, abs=last_digit)
    assert summary["contact_duration"] / clock == pytest.approx(duration, rel=1e-5)
    assert summary["maximum_force"] / hertz_force == pytest.approx(force, abs=last_digit)
    assert summary["maximum_indentation"] / hertz_depth == pytest.approx(depth, abs=last_digit)


@pytest.mark.parametrize(
    ("target", "modulus", "ratio", "density", "radius", "speed", "depth", "force", "duration"),
    [  # Chung & Ooi 2011, tests 1 (two equal spheres) and 2 (rigid wall)
        ("body", "48 GPa", 0.20, "2800 kg/m^3", "10 mm", "20 m/s", 274.113e-6, 10.69689e3, 40.3395e-6),
        ("body", "20 GPa", 0.25, "2500 kg/m^3", "10 mm", "20 m/s", 368.304e-6, 7.10824e3, 54.2010e-6),
        ("wall", "70 GPa", 0.30, "2699 kg/m^3", "100 mm", "0.2 m/s", 49.7172e-6, 11.36986e3, 731.657e-6),
        ("wall", "40 GPa", 0.35, "1800 kg/m^3", "100 mm", "0.2 m/s", 52.1233e-6, 7.23268e3, 767.066e-6),
    ],
)
def test_chung_and_ooi(target, modulus, ratio, density, radius, speed, depth, force, duration):
    own = fm.Material("own", modulus, ratio, density)
    if target == "body":
        contact, against = fm.Contact(law="hertz"), fm.Body(own, radius=radius)
    else:
        value = float(modulus.split()[0]) * 1e9 / (1 - ratio**2)
        contact, against = fm.Contact(law="hertz", effective_modulus=f"{value!r} Pa"), fm.HalfSpace()
    scene = fm.Scene(
        fm.Sphere(radius, velocity=speed, material=own), against, contact=contact, effects=fm.Effects(gravity=False)
    )
    summary = fm.simulate(scene, accuracy=1e-8).summary
    assert summary["maximum_indentation"] == pytest.approx(depth, rel=2e-6)
    assert summary["maximum_force"] == pytest.approx(force, rel=1e-6)
    assert summary["contact_duration"] == pytest.approx(duration, rel=2e-6)
    assert summary["coefficient_of_restitution"] == pytest.approx(1, abs=1e-12)


def test_a_ball_at_rest_under_its_weight():
    """A sudden weight gives 5/2 of itself on a spring of power 3/2; on a soft target the force creeps up to it."""
    ball = fm.Sphere(radius="10 mm", velocity="0 m/s", material="WC, Big-Alabo 2017")
    hertz, heavy = fm.Contact(law="hertz"), fm.Effects(gravity=True)
    on = fm.Scene(ball, fm.HalfSpace("mild steel"), contact=hertz, effects=heavy)
    weight = on.mass * 9.80665
    found = fm.simulate(on, accuracy=1e-8)
    assert found.summary["maximum_force"] == pytest.approx(2.5 * weight, rel=1e-12)
    assert found.summary["contact_duration"] is None and found.summary["coefficient_of_restitution"] is None
    for law in ("hertz", "big-alabo", "stronge"):
        laid = fm.simulate(fm.Scene(ball, fm.HalfSpace("mild steel"), contact=fm.Contact(law=law), effects=heavy))
        assert laid.accuracy.estimated <= 1e-4 and laid.accuracy.segments <= 100
    soft = fm.simulate(fm.Scene(ball, fm.Plate("mild steel", thickness="1 mm"), contact=hertz, effects=heavy))
    assert (
        soft.summary["maximum_force"] == pytest.approx(weight, rel=1e-12)
        and soft.summary["maximum_indentation"] is None
    )
    assert soft.outcome in (fm.Outcome.TIME_LIMIT, fm.Outcome.RESTING)

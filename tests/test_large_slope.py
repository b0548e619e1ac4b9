"""Elastic contacts of large slope: the finite elements against theory, and law large-slope against them."""

import csv
import math
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

import film_model as fm
from film_model.laws.large_slope import BALL, HALF_SPACE

FOLDER = Path(__file__).parent.parent / "examples" / "finite_elements"
sys.path.insert(0, str(FOLDER))

import ball  # noqa: E402
import elastic  # noqa: E402

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")

COEFFICIENTS = {"ball": BALL, "half-space": HALF_SPACE}


def table(kind):
    """√(δ/R) and force over Hertz's of one body."""
    with elastic.TABLE.open() as file:
        rows = [row for row in csv.DictReader(file) if row["body"] == kind]
    assert max(float(row["mesh_error"]) for row in rows) < 0.015
    return np.array([(float(row["slope"]), float(row["force_ratio"])) for row in rows]).T


def whole_ball(ratio, slope, terms=400):
    """Fraction by which an elastic sphere under Hertz's pressure and inertia approaches less than a half-space.

    Unit radius and modulus. Surface displacements by Legendre series (Lur'e, Three-Dimensional Problems of the Theory
    of Elasticity): degree 0 is uniform compression, degree 1 is balanced by inertia, relative to the centre of mass.
    """
    shear, lame = 1 / (2 * (1 + ratio)), ratio / ((1 + ratio) * (1 - 2 * ratio))
    n = np.arange(2.0, terms)
    b = -(n * n + 2 * n - 1 + 2 * ratio) / (n - 1)
    stress = 2 * shear * ((n + 1) * (n * n - n - 2 - 2 * ratio) + b * n * (n - 1))
    soft = np.concatenate(
        [[1 - 2 * ratio, 1.2 / (4 * shear + 6 * lame)], ((n + 1) * (n - 2 + 4 * ratio) + b * n) / stress]
    )

    def excess(a):
        """Elastic energy over that of the half-space, over the square of the load."""
        x, w = np.polynomial.legendre.leggauss(100)
        s, pressure = a * np.sin((x + 1) * math.pi / 4), np.cos((x + 1) * math.pi / 4)
        c = np.sqrt(1 - s * s)
        weight = pressure * s * a * pressure / c * w * math.pi / 4  # pressure on rings, over 2π
        polynomials = np.polynomial.legendre.legvander(c, terms - 1)
        degree = np.arange(terms)
        parts = (2 * degree + 1) / 2 * (weight @ polynomials)
        energy = 0.5 * (parts**2 * soft * 4 * math.pi / (2 * degree + 1)).sum()
        load, flat = 2 * math.pi * (weight * c).sum(), 2 * math.pi * a * a / 3
        return energy / load**2 - 2 * math.pi**2 * (1 - ratio**2) / (8 * a) * (8 / 15) * a**4 / flat**2

    gradient = (excess(slope * 1.05) - excess(slope / 1.05)) / math.log(1.05**2)
    return -(2 * excess(slope) + gradient / 3) * 4 * slope / (3 * (1 - ratio**2))


def linear(gradient, shear, lame):
    """Stress of small strains."""
    a, b, c, d, t = gradient
    mean = lame * (a + d + t - 3)
    return np.array(
        [mean + 2 * shear * (a - 1), shear * (b + c), shear * (b + c), *(mean + 2 * shear * (x - 1) for x in (d, t))]
    )


def flat(ratio, slope):
    """The fraction in flat contact. The series has pressure along the radius; in flat contact it is along the axis.

    The difference, a traction p r/R, raises the surface by (1 + ν) (1 − 2ν)/E ∫ p r/R dr from r to a, in the mean under
    Hertz's pressure by (1 − 2ν)/(1 − ν) (a/R)/(3 π) of δ. It counts twice: the approach, too, is along the axis.
    """
    return whole_ball(ratio, slope) + 2 / (3 * math.pi) * (1 - 2 * ratio) / (1 - ratio) * slope


@pytest.mark.slow
def test_finite_elements_of_small_strains_against_the_series_of_a_sphere():
    (row,) = elastic.Contact("ball", 0.3, law=linear).rows((0.1,))
    less = flat(0.3, row.slope * row.force_ratio ** (1 / 3))
    assert 1 - row.force_ratio ** (-2 / 3) == pytest.approx(less, rel=0.05)


@pytest.mark.parametrize("ratio", [0.2, 0.3, 0.45])
def test_the_coefficient_against_the_series_of_a_sphere(ratio):
    less = flat(ratio, 0.1)  # by the force
    assert pytest.approx(((1 - less) ** -1.5 - 1) / (0.1 * (1 - less) ** 0.5), rel=0.1) == BALL


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(COEFFICIENTS))
def test_the_published_contacts_on_a_coarse_mesh(kind):
    slopes, forces = table(kind)
    rows = list(elastic.Contact(kind, 0.3, elastic.MESHES[2]).rows(tuple(slopes[:2])))
    assert [row.force_ratio for row in rows] == pytest.approx(forces[:2], rel=0.02)


@pytest.mark.parametrize(("kind", "terms"), [("ball", 3), ("half-space", 1)])
def test_the_coefficients_are_the_first_terms_of_the_published_contacts(kind, terms):
    slopes, forces = table(kind)
    assert slopes[-1] >= 0.44
    assert elastic.fitted(slopes, forces, terms)[0] == pytest.approx(COEFFICIENTS[kind], abs=2e-3)


def energetic(slopes, forces, hertz):
    """δ over Hertz's of an impact that reaches √(δ/R) = hertz by Hertz's law, from a table of forces."""
    x, ratio = np.append(0.0, slopes), np.append(1.0, forces)

    def lacking(y):
        u = np.linspace(0.0, hertz * y**0.5, 2001)
        return np.trapezoid(2 * u**4 * np.interp(u, x, ratio), u) / (0.4 * hertz**5) - 1

    return optimize.brentq(lacking, 0.3, 1.5)


def struck(slope, large=True, **material):
    """An elastic ball on a rigid plane that reaches √(δ/R) = slope by Hertz's law."""
    soft = {"youngs_modulus": "5 MPa", "poissons_ratio": 0.3, "density": "1000 kg/m^3"} | material
    rigid = {"youngs_modulus": "9e4 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
    velocity = math.sqrt(0.8 / math.pi * 5e6 / (1 - 0.3**2) / 1000) * slope**2.5
    effects = fm.Effects(gravity=False, small_slope=large)
    return fm.Scene(fm.Sphere("20 mm", f"{velocity!r} m/s", material=soft), fm.HalfSpace(rigid), effects=effects)


IMPACTS = (  # ν, √(δ/R) by Hertz's law; force, indentation and time over Hertz's, as ball.py prints
    (0.2, 0.27, 1.110, 0.927, 0.934),
    (0.3, 0.13, 1.057, 0.962, 0.960),
    (0.3, 0.2, 1.073, 0.941, 0.946),
    (0.3, 0.27, 1.121, 0.919, 0.924),
    (0.3, 0.35, 1.154, 0.889, 0.915),
    (0.3, 0.42, 1.171, 0.864, 0.893),
    (0.3, 0.5, 1.164, 0.827, 0.863),
    (0.45, 0.13, 1.056, 0.958, 0.959),
    (0.45, 0.27, 1.109, 0.912, 0.933),
    (0.49, 0.27, 1.106, 0.908, 0.940),
)


@pytest.mark.parametrize("impact", IMPACTS)
def test_the_law_against_impacts_of_a_ball_with_its_inertia(impact):
    """Which the coefficient was not fitted to; Hertz's own errors are 5 to 17 %."""
    _, slope, force, depth, time = impact
    steep, hertz = (fm.simulate(struck(slope, large), accuracy=1e-6).summary for large in (True, False))
    names = ("maximum_force", "maximum_indentation", "contact_duration")
    off = [steep[name] / hertz[name] / value - 1 for name, value in zip(names, (force, depth, time), strict=True)]
    most = (0.017, 0.023, 0.025) if slope < 0.4 else (0.037, 0.065, 0.015)
    assert [abs(each) < allowed for each, allowed in zip(off, most, strict=True)] == [True] * 3, off


@needs_gcc
@pytest.mark.slow
@pytest.mark.parametrize(("impact", "elements"), [(IMPACTS[3], 8), (IMPACTS[5], 8), (IMPACTS[8], 8)])
def test_the_impacts_of_a_ball_with_its_inertia(impact, elements):
    found = ball.strike(*impact[:2], elements)
    assert found.energy == pytest.approx(1.0, abs=5e-3)
    assert 0.97 < found.restitution < 1.0
    assert found[:3] == pytest.approx(impact[2:], rel=0.03)


def test_a_static_law_would_raise_the_force_of_an_impact_too_much():
    """By 30 % where that of a ball with its inertia rises by 17 %: contact is too short for equilibrium."""
    slopes, forces = table("ball")
    depth, ratio = energetic(slopes, forces, 0.42), 0.3
    static = depth**1.5 * np.interp(0.42 * depth**0.5, slopes, forces)
    assert static == pytest.approx(1.30, abs=0.01)
    velocity = math.sqrt(0.8 / math.pi) * 0.42**2.5  # over √(E*/ρ), lengths in R
    lasting = 0.893 * ball.HERTZ_TIME * 0.42**2 / velocity
    wave = math.sqrt((1 - ratio**2) * (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio)))
    assert lasting / (4.0 / wave) == pytest.approx(2.2, abs=0.05)


@pytest.mark.parametrize("slope", [0.02, 0.13, 0.27, 0.5])
def test_the_change_that_is_judged_is_that_of_the_law(slope):
    steep, hertz = (fm.simulate(struck(slope, large)) for large in (True, False))
    change = next(effect.change for effect in hertz.effects if effect.name == "small_slope")
    assert change == pytest.approx(steep.maximum_force.m / hertz.maximum_force.m - 1, rel=0.025)


def test_each_body_counts_by_its_share_of_the_compliance():
    soft = {"youngs_modulus": "5 MPa", "poissons_ratio": 0.3, "density": "1000 kg/m^3"}
    hard = soft | {"youngs_modulus": "9e4 GPa"}
    ball = fm.Sphere("20 mm", "1 m/s", material=soft)

    def coefficient(impactor, target):
        return fm.Scene(impactor, target).slope_coefficient

    assert coefficient(ball, fm.HalfSpace(hard)) == pytest.approx(BALL, rel=1e-6)
    assert coefficient(fm.Sphere("20 mm", "1 m/s", material=hard), fm.HalfSpace(soft)) == pytest.approx(HALF_SPACE)
    assert coefficient(ball, fm.HalfSpace(soft)) == pytest.approx(0.5 * (BALL + HALF_SPACE))
    assert coefficient(ball, fm.Body(soft, radius="20 mm")) == pytest.approx(BALL / 2)
    assert coefficient(ball, fm.Body(hard, radius="60 mm")) == pytest.approx(0.75 * BALL)
    given = fm.Contact("hertz", effective_modulus="5 MPa")
    assert fm.Scene(fm.Sphere("20 mm", "1 m/s", mass="4 g"), fm.HalfSpace(), given).slope_coefficient is None


def test_the_law_against_an_independent_integration():
    from scipy.integrate import solve_ivp

    history = fm.simulate(struck(0.42, loss_factor=0.1), accuracy=1e-8)
    law, scene = history.problem.law, history.scene
    stiff, radius, mass = 4 / 3 * scene.effective_modulus * 0.02**0.5, 0.02, scene.mass
    assert law.name == "damped-large-slope" and 0.88 < law.restitution < 0.89
    factor, scale = law.damping_factor(mass, 1.0, 1.0), radius / BALL**2

    def motion(_, y):
        depth = max(y[0], 0.0)
        force = (
            stiff * depth**1.5 * (1 + BALL * (depth / radius) ** 0.5)
            + factor * (depth**0.25 + 1.2 * scale**-0.75 * depth) * y[1]
        )
        return [y[1], -force / mass]

    def ends(t, y):
        return motion(t, y)[1] if t > 1e-4 else -1.0

    ends.terminal = True
    done = solve_ivp(motion, (0, 1), [0, scene.approach_velocity], "DOP853", rtol=1e-12, atol=1e-16, events=ends)
    assert history.summary["contact_duration"] == pytest.approx(done.t[-1], rel=1e-7)
    assert history.summary["rebound_velocity"] == pytest.approx(done.y[1, -1], rel=1e-7)


@pytest.mark.parametrize("restitution", [0.98, 0.75, 0.4])
def test_the_restitution_is_the_same_for_all_velocities(restitution):
    for slope in (0.05, 0.13, 0.27, 0.42, 0.5):
        scene = struck(slope).replace({"contact.law": "damped-large-slope", "contact.restitution": restitution})
        lost = 1 - fm.simulate(scene).summary["coefficient_of_restitution"]
        assert lost == pytest.approx(1 - restitution, rel=0.02 if slope < 0.5 else 0.04)


def test_one_impact_and_many_agree():
    scene = struck(0.1, "auto", loss_factor=0.05)
    speeds = [0.002, 0.02, 0.2, 1.0, 3.0]
    batch = fm.simulate_batch(scene, velocity=[f"{speed} m/s" for speed in speeds])
    laws = set()
    for place, speed in enumerate(speeds):
        history = fm.simulate(scene.replace({"impactor.velocity": f"{speed} m/s"}))
        laws.add(history.problem.law.name)
        assert batch.summary["maximum_force"][place] == pytest.approx(history.summary["maximum_force"], rel=1e-6)
    assert laws == {"tsuji", "damped-large-slope"}


def test_a_scene_chooses_the_law():
    assert fm.simulate(struck(0.005, "auto")).problem.law.name == "hertz"
    assert fm.simulate(struck(0.005, True)).problem.law.name == "large-slope"
    off = fm.simulate(struck(0.27, False))
    assert off.problem.law.name == "hertz" and any("small slope" in warning for warning in off.warnings)
    auto = fm.simulate(struck(0.27, "auto"))
    assert auto.problem.law.name == "large-slope"
    assert not any("small slope" in warning for warning in auto.warnings)
    unloaded = fm.simulate(struck(0.27, "auto").replace({"contact.unloading": "brake", "effects.plasticity": False}))
    assert unloaded.problem.law.name == "large-slope"
    assert next(effect.simulated for effect in unloaded.effects if effect.name == "small_slope")
    named = fm.simulate(struck(0.27, "auto").replace({"contact.law": "large-slope"}))
    assert named.summary["maximum_force"] == auto.summary["maximum_force"]
    for law, large in (("large-slope", "auto"), ("auto", True)):
        contact, effects = fm.Contact(law, effective_modulus="1 GPa"), fm.Effects(small_slope=large)
        with pytest.raises(fm.SceneError, match="need the material of a body"):
            fm.Scene(fm.Sphere("5 mm", "1 m/s", mass="4 g"), fm.HalfSpace(), contact, effects)
    with pytest.raises(ValueError, match=r"slope_coefficient.*must be > 0"):
        fm.LargeSlope(1e6, 0.01, slope_coefficient=0.0)


@pytest.mark.parametrize(
    ("ball", "target", "speed", "fall"),
    [("bearing steel", "bearing steel", 1.8, 0.019), ("nylon 6/6", "bearing steel", 1.2, 0.031)],
)
def test_the_force_falls_where_yield_begins_to_matter(ball, target, speed, fall):
    """Law elastoplastic has Hertz's elastic stage."""
    below, beyond = (
        fm.simulate(fm.Scene(fm.Sphere("10 mm", f"{factor * speed} m/s", material=ball), fm.HalfSpace(target)))
        for factor in (1.0, 1.2)
    )
    assert (below.problem.law.steep, beyond.problem.law.name) == (True, "elastoplastic")
    named = fm.simulate(below.scene.replace({"contact.law": "elastoplastic"}))
    lower = 1.0 - named.summary["maximum_force"] / below.summary["maximum_force"]
    assert lower == pytest.approx(fall, abs=0.001)

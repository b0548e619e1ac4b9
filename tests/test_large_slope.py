"""Elastic contacts of large slope: the finite elements against theory, and the estimate against the finite elements."""

import csv
import math
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

from film_model.effects.elastic_ball import BALL, Body, change, excess

FOLDER = Path(__file__).parent.parent / "examples" / "finite_elements"
sys.path.insert(0, str(FOLDER))

import ball  # noqa: E402
import elastic  # noqa: E402

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")

BODIES = {"ball": 1.0, "half-space": 0.0}  # R over the radius


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
def test_the_excess_against_the_series_of_a_sphere(ratio):
    for slope in (0.1, 0.2):  # by the force
        less = flat(ratio, slope)
        x = slope * (1 - less) ** 0.5
        fitted = sum(c * x**k for k, c in enumerate(BALL, 1))
        assert fitted == pytest.approx((1 - less) ** -1.5 - 1, rel=0.16)


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(BODIES))
def test_the_published_contacts_on_a_coarse_mesh(kind):
    slopes, forces = table(kind)
    rows = list(elastic.Contact(kind, 0.3, elastic.MESHES[2]).rows(tuple(slopes[:2])))
    assert [row.force_ratio for row in rows] == pytest.approx(forces[:2], rel=0.02)


@pytest.mark.parametrize(("kind", "largest"), [("ball", 0.005), ("half-space", 0.015)])
def test_the_force_against_finite_elements(kind, largest):
    slopes, forces = table(kind)
    terms = excess([Body(1.0, BODIES[kind])])
    fitted = 1 + sum(c * slopes**k for k, c in enumerate(terms, 1))
    assert slopes[-1] >= 0.44
    assert np.abs(fitted / forces - 1).max() < largest
    count = 3 if kind == "ball" else 1
    assert elastic.fitted(slopes, forces, count) == pytest.approx(terms[:count], abs=2e-3)


def energetic(slopes, forces, hertz):
    """δ over Hertz's of an impact that reaches √(δ/R) = hertz by Hertz's law, from a table of forces."""
    x, ratio = np.append(0.0, slopes), np.append(1.0, forces)

    def lacking(y):
        u = np.linspace(0.0, hertz * y**0.5, 2001)
        return np.trapezoid(2 * u**4 * np.interp(u, x, ratio), u) / (0.4 * hertz**5) - 1

    return optimize.brentq(lacking, 0.3, 1.5)


@pytest.mark.parametrize("kind", list(BODIES))
def test_the_estimate_against_finite_elements(kind):
    for hertz in (0.05, 0.13, 0.27, 0.42, 0.5):
        exact = abs(1 / energetic(*table(kind), hertz) - 1)
        assert change(excess([Body(1.0, BODIES[kind])]), hertz) == pytest.approx(exact, rel=0.05, abs=5e-3)


@needs_gcc
@pytest.mark.slow
def test_the_estimate_against_impacts_of_a_ball_with_its_inertia():
    impact = ball.strike(0.3, 0.42, 8)
    assert impact.energy == pytest.approx(1.0, abs=5e-3)
    assert 0.97 < impact.restitution < 1.0
    assert 1.1 < impact.force < 1.2
    assert impact.depth == pytest.approx(0.864, abs=0.02)
    estimate = change(excess([Body(1.0, 1.0)]), 0.42)
    assert 1 / 1.3 < estimate / (1 / impact.depth - 1) < 1.3


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


def test_the_excess_vanishes_with_the_slope_and_is_shared():
    whole, plane = Body(1.0, 1.0), Body(1.0, 0.0)
    assert change(excess([whole]), 0.0) == 0.0
    assert change(excess([whole]), 2e-6) == pytest.approx(2 * change(excess([whole]), 1e-6), rel=1e-5)
    mixed = excess([whole._replace(share=0.25), plane._replace(share=0.75)])
    assert mixed == pytest.approx([0.25 * a + 0.75 * b for a, b in zip(excess([whole]), excess([plane]), strict=True)])
    twin = Body(0.5, 0.5)  # each of two equal balls against the plane between them
    assert change(excess([twin, twin]), 0.2) == pytest.approx(change(excess([whole]), 0.1), rel=1e-12)

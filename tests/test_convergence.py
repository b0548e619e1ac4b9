"""The order of the march: the error of every summary value against the number of segments, for every law."""

import math

import numpy as np
import pytest
from cases import DAMPED, LAWS, scene, straight, zener_scene

import film_model as fm

SEGMENTS = np.array([16, 32, 64, 128])
STRAIGHT = tuple(name for name, law in LAWS.items() if straight(law))  # exact with any number of segments
FLOOR = 3e-12  # smaller errors are rounding


def errors(case, linearisation, segments=SEGMENTS, exact=None):
    """Largest relative error of the summary for each number of segments, against 2,000 work-preserving ones."""
    best = exact or fm.simulate(case, segments=2000).summary
    found = []
    for n in segments:
        summary = fm.simulate(case, segments=int(n), linearisation=linearisation).summary
        names = [name for name, value in best.items() if value and name not in ("energy_absorbed", "energy_radiated")]
        found.append(max(abs(summary[name] / best[name] - 1) for name in names))
    return np.array(found)


def order(segments, found):
    """Slope of log(error) over log(segments), for errors above rounding."""
    seen = found > FLOOR
    assert seen.sum() >= 3
    return -np.polyfit(np.log(segments[seen]), np.log(found[seen]), 1)[0]


@pytest.mark.parametrize("target", ["half-space", "plate"])
@pytest.mark.parametrize("law", [name for name in LAWS if name not in ("meyer-shifted", *STRAIGHT)])
def test_work_preserving_lines_are_of_fourth_order(law, target):
    found = errors(scene(law, target), "work-preserving")
    assert found[0] < 3e-5
    # damped laws on a plate: between second and fourth order
    assert order(SEGMENTS, found) > (3.7 if target == "half-space" or law not in DAMPED else 2.4)


def test_a_force_with_a_singular_start_keeps_nearly_fourth_order():
    """(δ − δ0)^1.2: the curvature is singular as x^-0.8 where the force begins."""
    assert order(SEGMENTS, errors(scene("meyer-shifted"), "work-preserving")) > 3.2


@pytest.mark.parametrize("law", [name for name in LAWS if name not in STRAIGHT])
def test_chords_are_of_second_order(law):
    assert 1.8 < order(SEGMENTS, errors(scene(law), "chord")) < 2.3


@pytest.mark.parametrize("value", [0.05, 0.5, 1.5, 2.5])
def test_fourth_order_on_plates_of_any_zener_number(value):
    assert order(SEGMENTS, errors(zener_scene(value), "work-preserving")) > 3.7


def test_ten_segments_on_a_half_space():
    """Errors of five, ten and twenty graded work-preserving segments for Hertz's law on a half-space."""
    case = scene("hertz")
    ball, modulus = case.impactor, case.effective_modulus
    stiffness = 4 / 3 * modulus * math.sqrt(case.effective_radius)
    depth = (1.25 * case.mass * ball.speed**2 / stiffness) ** 0.4
    duration = 2 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9) * depth / ball.speed
    exact = {"contact_duration": duration, "time_of_maximum_indentation": duration / 2, "maximum_indentation": depth}
    found = errors(case, "work-preserving", np.array([5, 10, 20]), exact)
    assert (found < [1e-4, 6e-6, 4e-7]).all(), found
    assert (errors(case, "chord", np.array([10]), exact) > 1e-3).all()

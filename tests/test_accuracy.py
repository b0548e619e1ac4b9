"""What `accuracy` promises: the estimate bounds the true error, and does not exaggerate it much."""

import numpy as np
import pytest
from cases import zener_scene

import film_model as fm

SCALES = {  # values smaller than a thousandth of these are judged against that thousandth
    "rebound_velocity": "velocity",
    "coefficient_of_restitution": "restitution",
    "permanent_indentation": "depth",
}


def true_error(history, exact):
    """Largest relative error of the summary, as `Accuracy` defines it."""
    ball = history.scene.impactor.speed
    floors = {"velocity": 1e-3 * ball, "restitution": 1e-3, "depth": 1e-3 * exact["maximum_indentation"]}
    worst = 0.0
    for name, value in exact.items():
        other = history.summary[name]
        if value is None or other is None:  # an impactor that barely stops, or barely does not
            worst = max(worst, 0.0 if value is other else 1.0)
            continue
        scale = abs(value)
        if name in SCALES:
            scale = max(scale, floors[SCALES[name]])
        if name.startswith("energy"):
            scale = history.scene.kinetic_energy
        worst = max(worst, abs(other - value) / scale)
    return worst


def random_scene(rng):
    """A ball, a target and a law from the wide middle of what people simulate."""
    steel = fm.Material(
        "m", f"{10 ** rng.uniform(9.5, 11.6)!r} Pa", 0.3, "7850 kg/m^3", f"{10 ** rng.uniform(8, 9.3)!r} Pa"
    )
    radius = 10 ** rng.uniform(-4, -1)
    ball = fm.Sphere(f"{radius!r} m", velocity=f"{10 ** rng.uniform(-2, 1.5)!r} m/s", material=steel)
    target = [
        lambda: fm.HalfSpace(steel),
        lambda: fm.Plate(steel, thickness=f"{radius * rng.uniform(0.4, 4)!r} m"),
        lambda: fm.Rod(steel, diameter=f"{radius * rng.uniform(2, 6)!r} m"),
        lambda: fm.Body(steel, radius=f"{radius * rng.uniform(0.5, 3)!r} m"),
    ][rng.integers(4)]()
    law = ["hertz", "big-alabo", "stronge", "auto"][rng.integers(4)]
    return fm.Scene(ball, target, contact=fm.Contact(law=law))


def check_estimates(count, seed):
    rng = np.random.default_rng(seed)
    bounded, ratios, kept = [], [], []
    for _ in range(count):
        case = random_scene(rng)
        exact = fm.simulate(case, accuracy=1e-11).summary
        accuracy = 10 ** rng.uniform(-7, -3)
        history = fm.simulate(case, accuracy=accuracy)
        error = true_error(history, exact)
        bounded.append(error <= history.accuracy.estimated)
        kept.append(error <= accuracy)
        ratios.append(history.accuracy.estimated / max(error, 1e-13))
    assert np.mean(bounded) >= 0.99
    assert np.mean(kept) >= 0.99
    assert np.median(ratios) <= 30


def test_the_estimate_bounds_the_error_of_random_scenes():
    check_estimates(250, seed=2017)


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_many_random_scenes():
    check_estimates(4000, seed=1941)


@pytest.mark.parametrize("segments", [3, 5, 10, 30])
@pytest.mark.parametrize("linearisation", ["chord", "work-preserving"])
def test_the_estimate_for_a_number_of_segments(segments, linearisation):
    rng = np.random.default_rng(segments)
    bounded = []
    for _ in range(100):
        case = random_scene(rng)
        history = fm.simulate(case, segments=segments, linearisation=linearisation)
        bounded.append(true_error(history, fm.simulate(case, accuracy=1e-10).summary) <= history.accuracy.estimated)
    assert np.mean(bounded) >= 0.97


def test_accuracy_that_cannot_be_had_is_said():
    history = fm.simulate(zener_scene(1.0), accuracy=2e-14)
    assert history.accuracy.estimated > 2e-14
    assert any("cannot be had" in warning for warning in history.warnings)


def test_tight_accuracy_is_kept():
    exact = fm.simulate(zener_scene(1.0), accuracy=1e-12)
    assert true_error(fm.simulate(zener_scene(1.0), accuracy=1e-10), exact.summary) <= 1e-10

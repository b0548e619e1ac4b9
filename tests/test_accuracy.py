"""What `accuracy` promises: the estimate bounds the true error, and does not exaggerate it much."""

from dataclasses import replace

import numpy as np
import pytest
from cases import combinations, scene, zener_scene

import film_model as fm
from film_model.core import native
from film_model.core.solving import compare
from film_model.effects.choose import problem_of
from film_model.problem.summary import difference

SCALES = {  # errors of smaller values are relative to a thousandth of these
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
        if value is None or other is None:  # one of the two runs has no stop of the impactor: a limiting case
            worst = max(worst, 0.0 if value is other else 1.0)
            continue
        if value == other:
            continue
        scale = abs(value)
        if name in SCALES:
            scale = max(scale, floors[SCALES[name]])
        if name.startswith("energy"):
            scale = history.scene.kinetic_energy
        worst = max(worst, abs(other - value) / scale)
    return worst


def random_scene(rng):
    """A ball, a target and a law within the range of usual simulations."""
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


def random_law_scene(rng):
    """A random scene under any other law of the catalogue, with parameters of the size of a Hertz contact."""
    case = random_scene(rng)
    modulus, radius, strength = case.effective_modulus, case.effective_radius, case.yield_strength
    energy, hertz = case.kinetic_energy, fm.Hertz(modulus, radius)
    depth, force = hertz.scales(2.5 * energy)  # of Hertz's law
    ball, stiffness, e = (modulus, radius), force / depth, rng.uniform(0.2, 0.98)
    made = {
        "thornton": lambda: fm.Thornton(*ball, 1.6 * strength),
        "kogut-etsion": lambda: fm.KogutEtsion(*ball, 0.3, 2.8 * strength),
        "jackson-green": lambda: fm.JacksonGreen(*ball, min(strength, 0.1 * modulus), 0.3),
        "yigit-christoforou": lambda: fm.YigitChristoforou(*ball, strength),
        "rigid-plastic": lambda: fm.RigidPlastic(*ball, 3 * strength),
        "walton-braun": lambda: fm.WaltonBraun(stiffness, stiffness / e**2),
        "luding": lambda: fm.Luding(radius, stiffness, stiffness / e**2, depth / radius * rng.uniform(0.1, 2)),
        "tan-sun": lambda: fm.TanSun(force / depth**1.5, depth * rng.uniform(0.1, 2)),
        "brake": lambda: fm.BrakeUnloading(fm.BigAlabo(*ball, strength), *ball),
        "linear-dashpot": lambda: fm.LinearDashpot(stiffness, restitution=e),
        "tsuji": lambda: fm.Tsuji(*ball, e),
        "hunt-crossley": lambda: fm.HuntCrossley(*ball, restitution=e),
        "kuwabara-kono": lambda: fm.KuwabaraKono(*ball, rng.uniform(0, 0.5) * depth / case.approach_velocity),
    }
    law = made[list(made)[rng.integers(len(made))]]()
    return fm.Scene(case.impactor, case.target, contact=fm.Contact(law=law))


def check_estimates(count, seed, make=random_scene, finest=1e-11):
    rng = np.random.default_rng(seed)
    bounded, ratios, kept = [], [], []
    for _ in range(count):
        case = make(rng)
        exact = fm.simulate(case, accuracy=finest).summary
        accuracy = 10 ** rng.uniform(-7, -3)
        history = fm.simulate(case, accuracy=accuracy)
        error = true_error(history, exact)
        bounded.append(error <= history.accuracy.estimated)
        kept.append(error <= accuracy)
        ratios.append(history.accuracy.estimated / max(error, 1e-13))
    assert np.mean(bounded) >= 0.99
    assert np.mean(kept) >= 0.99
    assert np.median(ratios) <= 30


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_random_scenes():
    check_estimates(250, seed=2017)


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_every_law():
    check_estimates(130, seed=7, make=random_law_scene, finest=1e-10)


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_every_law_in_many_scenes():
    check_estimates(800, seed=11, make=random_law_scene, finest=1e-10)


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_many_random_scenes():
    check_estimates(1500, seed=1941)


def test_an_empty_linearisation_is_refused():
    with pytest.raises(fm.SceneError, match='linearisation: "" is not allowed'):
        fm.simulate(zener_scene(1.0), linearisation="")


@pytest.mark.slow
@combinations(linearisation=["chord", "work-preserving"], segments=[3, 5, 10, 30], fast=2)
def test_the_estimate_for_a_number_of_segments(segments, linearisation):
    rng = np.random.default_rng(segments)
    bounded = []
    for _ in range(100):
        case = random_scene(rng)
        history = fm.simulate(case, segments=segments, linearisation=linearisation)
        bounded.append(true_error(history, fm.simulate(case, accuracy=1e-10).summary) <= history.accuracy.estimated)
    assert np.mean(bounded) >= 0.97


def test_unreachable_accuracy_gives_a_warning():
    history = fm.simulate(zener_scene(1.0), accuracy=2e-14)
    assert history.accuracy.estimated > 2e-14
    assert any("is not reached" in warning for warning in history.warnings)


def test_tight_accuracy_is_kept():
    exact = fm.simulate(zener_scene(1.0), accuracy=1e-12)
    assert true_error(fm.simulate(zener_scene(1.0), accuracy=1e-10), exact.summary) <= 1e-10


@pytest.mark.parametrize("target", ["half-space", "plate", "body"])
def test_two_summaries_differ_as_much_alone_as_in_a_batch(target):
    """A value that is missing in one summary counts as a difference of 1; one missing in both as 0."""
    problem = problem_of(scene("big-alabo", target))
    problem = replace(problem, approach=0.7)
    rng = np.random.default_rng(5)
    first = np.zeros(400, native.SUMMARY_DTYPE)
    for name in native.SUMMARY:
        first[name] = rng.uniform(0.5, 1.5, first.size)
    first["final_velocity"] *= -0.7
    second = first.copy()
    for name in native.SUMMARY:
        second[name] *= 1.0 + rng.normal(0.0, 10.0 ** rng.uniform(-6, -1, first.size))
    for column in (first, second):
        for name in ("time_impactor_stops", "contact_duration", "permanent_indentation", "final_velocity"):
            column[name][rng.random(first.size) < 0.1] = np.nan
        column["permanent_indentation"][rng.random(first.size) < 0.1] = 0.0
    many = compare(np.frombuffer(bytes(problem.start) * first.size, native.START_DTYPE), first, second)
    rows = [[native.Summary.from_buffer_copy(row.tobytes()) for row in column] for column in (first, second)]
    alone = [difference(problem, a, b) for a, b in zip(*rows, strict=True)]
    assert many == pytest.approx(alone, rel=1e-13)
    assert 0.1 < np.mean(many == 1.0) < 0.9

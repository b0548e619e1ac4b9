"""Momentum and energy of a history, integrated from its samples, for every law on every target."""

import math

import numpy as np
import pytest
from cases import LAWS, TARGETS, scene

import film_model as fm

BALANCE = 1e-10


def quadrature(history, points=6):
    """Times and weights of Gauss's rule on every line of a history, SI."""
    scale = history.problem.scales.time
    edges = np.append(history.lines["time"][:-1], history.lines["time"][-1]) * scale
    edges = np.unique(edges)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    half = 0.5 * np.diff(edges)
    times = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    return times.ravel(), (half[:, None] * weights).ravel()


@pytest.mark.parametrize("target", list(TARGETS))
@pytest.mark.parametrize("law", list(LAWS))
def test_momentum_and_energy_balance(law, target):
    case = scene(law, target, segments=700)
    history = fm.simulate(case)
    times, weights = quadrature(history)
    motion = history.sample_si(times)
    force, mass, speed = motion.contact_force, case.mass, case.impactor.speed
    last = history.events[-1]
    momentum = mass * (speed - last.impactor_velocity)
    assert np.sum(weights * force) == pytest.approx(momentum, rel=BALANCE)
    energy = 0.5 * mass * speed**2
    absorbed = np.sum(weights * force * motion.relative_velocity)
    # Tsuji's force is ∝ t^{1/4} at first touch, which Gauss's rule integrates less accurately.
    within = BALANCE if law != "tsuji" else 10 * BALANCE
    assert history.summary["energy_absorbed"] == pytest.approx(absorbed, abs=within * energy)
    if target == "body":
        other, before = case.target.own_mass, case.target.velocity
        radiated = 0.5 * other * (last.target_velocity**2 - before**2)
        assert mass * speed + other * before == pytest.approx(
            mass * last.impactor_velocity + other * last.target_velocity, rel=1e-13
        )
    else:
        radiated = np.sum(weights * force**2) / case.target_impedance if math.isfinite(case.target_impedance) else 0.0
    assert history.summary["energy_radiated"] == pytest.approx(radiated, abs=BALANCE * energy)
    left = 0.5 * mass * last.impactor_velocity**2
    assert left + absorbed + radiated == pytest.approx(energy, rel=within)


@pytest.mark.parametrize("law", list(LAWS))
def test_displacement_of_a_plate_is_the_impulse_over_its_impedance(law):
    """Equation (27) of Big-Alabo et al. 2017."""
    case = scene(law, "plate", segments=100)
    history = fm.simulate(case)
    last = history.events[-1]
    momentum = case.mass * (case.impactor.speed - last.impactor_velocity)
    assert last.target_displacement == pytest.approx(momentum / case.target_impedance, rel=1e-12)
    assert last.target_velocity == 0.0


@pytest.mark.parametrize("law", list(LAWS))
def test_lines_balance_energy_to_rounding_with_few_segments(law):
    """On a fixed target, kinetic energy plus the law's work is constant at every node, however few the segments."""
    history = fm.simulate(scene(law, segments=4))
    lines, problem = history.lines, history.problem
    kinetic = 0.5 * lines["nu"] ** 2 + lines["spent"]
    assert kinetic == pytest.approx(0.5 * problem.approach**2, rel=1e-13)

"""One impact marched in one call, in irregular steps, in a batch and on chords, and compared with a reference."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from film_model.core import native
from film_model.laws import AbstractLaw
from film_model.problem.curve import curve_of
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.numbers import Numbers
from film_model.problem.problem import Given, Impacts, Problem
from film_model.problem.scales import scales_of
from film_model.problem.summary import difference
from film_model.scene import Solver
from film_model.solve.accuracy import mesh_of, refine
from film_model.studies import high_precision, quadrature
from film_model.studies.hard_cases.case import ACCURACY, ALLOWED, STEPPED, Finding


def problem_for(
    law: AbstractLaw, mass: float, velocity: float, impedance: float = math.inf, load: float = 0.0
) -> Problem:
    """The dimensionless problem of a law, for values outside a scene's ranges too. load: external force, N."""
    energy = 0.5 * mass * velocity**2
    scales = scales_of(law, max(energy, 1e-300), mass)
    gamma = 0.0 if math.isinf(impedance) else scales.force / (impedance * scales.velocity)
    approach = velocity / scales.velocity
    damping = float(law.damping_factor(mass, velocity, scales.length)) * scales.velocity / scales.force
    numbers = Numbers(mass, math.nan, velocity, impedance, drift=0.0, share=1.0, energy=energy)
    scene: Any = None  # never read: effects are not computed here
    return Problem(
        impacts=Impacts(scene, SceneLaw(law, {}, None, {}), numbers, scene),
        law=law,
        curve=curve_of(law),
        scales=scales,
        gamma=gamma,
        load=load / scales.force,
        damping=damping,
        approach=approach,
        drift=0.0,
        share=1.0,
        mass=mass,
        given=Given(impedance, load, 0.0),
        loaded=load > 0.0,
    )


def examine(
    law: AbstractLaw, mass: float, velocity: float, impedance: float = math.inf, allowed: float = ALLOWED
) -> Finding:
    """One impact without load: in one call, in steps, in a batch and on chords, each compared with a reference."""
    problem = problem_for(law, mass, velocity, impedance)
    counts, _ = refine(problem, Solver(accuracy=ACCURACY), [])
    mesh = mesh_of(Solver(accuracy=ACCURACY), counts)
    status, whole = native.impact(problem.curve.native, mesh, problem.start)
    if status != native.EVENT:
        return Finding(f"status {status}", math.inf, allowed, counts[0])
    exact = exact_summary(problem, velocity, impedance)
    exact.work = whole.work  # checked by the balance
    balance = balance_error(problem, whole)
    worst = {
        "against the reference": difference(problem, whole, exact),
        "in steps": in_steps(problem, mesh, whole) * allowed / STEPPED,
        "in a batch": in_a_batch(problem, mesh, whole) * allowed / STEPPED,
        "balance": balance * allowed / STEPPED,
    }
    chords = native.mesh(native.CHORD, 60, 60)
    status, rough = native.impact(problem.curve.native, chords, problem.start)
    values = [getattr(rough, name) for name in native.SUMMARY]  # inaccurate in a long tail, but finite
    if status != native.EVENT or not all(map(math.isfinite, values)) or rough.maximum_force > 2.0 * exact.maximum_force:
        return Finding(f"chords: status {status}", math.inf, allowed, counts[0])
    name = max(worst, key=lambda key: worst[key])
    return Finding(f"separated; largest {name}", worst[name], allowed, counts[0], balance)


def exact_summary(problem: Problem, velocity: float, impedance: float) -> native.Summary:
    """The reference: extended precision if the law allows it, else quadrature or a tight integration.

    Raises ImportError without mpmath: the other references are not exact enough for what is allowed.
    """
    law, mass, s = problem.law, problem.mass, problem.scales
    try:
        # Zener's λ, about: beyond, extended precision takes more than a few seconds
        if problem.gamma * problem.approach**0.2 > 4.0:
            raise ValueError("extrapolation of the slow end of contact would take too long")
        found = high_precision.impact(law, mass, velocity, impedance)
    except ValueError:
        found = (
            quadrature.quadrature(law, mass, velocity)
            if math.isinf(impedance)
            else quadrature.integrate(law, mass, velocity, impedance, rtol=3e-14)
        )
    made = native.Summary()
    made.maximum_force = found["maximum_force"] / s.force
    made.maximum_indentation = found["maximum_indentation"] / s.length
    for name in ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration"):
        setattr(made, name, found[name] / s.time)
    made.permanent_indentation = found["permanent_indentation"] / s.length
    made.final_velocity = found["rebound_velocity"] / s.velocity
    return made


def in_steps(problem: Problem, mesh: native.Mesh, whole: native.Summary) -> float:
    """The largest difference between irregular steps and one call."""
    chance = random.Random(1)
    state = native.initial_state(problem.curve.native, problem.start)
    stepped = native.Summary()
    stepped.time_impactor_stops = stepped.contact_duration = math.nan
    for _ in range(400):
        left = chance.expovariate(40.0 / whole.contact_duration)
        while True:
            before = state.time
            status = native.step(problem.curve.native, mesh, state, left)
            if status < 0:
                return math.inf
            left = max(left - (state.time - before), 0.0)
            if status != native.EVENT:
                break
            name = native.EVENTS[state.event]
            if name == "maximum_indentation":
                stepped.maximum_indentation, stepped.time_of_maximum_indentation = state.xi, state.time
            elif name == "impactor_stops":
                stepped.time_impactor_stops = state.time
            elif name == "contact_ends":
                stepped.maximum_force, stepped.contact_duration = state.force_peak, state.time
                stepped.permanent_indentation, stepped.final_velocity = state.xi, state.nu
                stepped.work = state.spent
                return difference(problem, stepped, whole)
    return math.inf


def in_a_batch(problem: Problem, mesh: native.Mesh, whole: native.Summary) -> float:
    """The largest difference between a batch of equal impacts and one call."""
    starts: Any = np.zeros(11, native.START_DTYPE)
    for name in native.START_DTYPE.names or ():
        starts[name] = getattr(problem.start, name)
    status, found = native.batch(problem.curve.native, mesh, starts)
    if (status != native.EVENT).any():
        return math.inf
    rows = [native.Summary.from_buffer_copy(row.tobytes()) for row in found]
    return max(difference(problem, row, whole) for row in rows)


def balance_error(problem: Problem, whole: native.Summary) -> float:
    """Relative error of the balance: of momentum if the target moves, else of energy."""
    before, after = problem.approach, whole.final_velocity
    if problem.gamma > 0.0:
        return abs(whole.shift / problem.gamma - (before - after)) / (before - after)
    return abs(0.5 * (before**2 - after**2) - whole.work) / (0.5 * before**2)

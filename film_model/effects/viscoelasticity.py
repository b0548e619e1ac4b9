"""Viscoelasticity: the modulus E(t) of a material with a prony series relaxes while the bodies are in contact.

    F = (4/3) √R ∫ E(t − s) d(δ^{3/2})                        on the way in (Lee & Radok 1960)
    the same up to t₁(t),  ∫ E(t − s) dδ from t₁ to t = 0     on the way out, until t₁ = 0 (Ting 1966)

Exact for quasi-static contact of a sphere, constant Poisson's ratios, one approach and one parting; no dent is left.
Refused: a contact that closes again before it ends, or begins while more than 1 % of its depth has still to
recover. Only law hertz relaxes, without vibrations.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from film_model.base.arrays import any_of
from film_model.base.errors import SimulationError
from film_model.effects.effect import ABSENT, NOT_MODELLED, NOT_NEEDED, SIMULATED, SWITCHED_OFF, Effect
from film_model.effects.judged import Rule, effect_of
from film_model.effects.trial import beyond, change
from film_model.problem.law_of_scene import ELASTIC
from film_model.problem.problem import Problem
from film_model.problem.relaxation import Relaxation, relaxation_of
from film_model.targets import Estimate

COST = "10 to 20 times the time"
"""Against the same impact on lines; measured by `benchmarks/effects.py`."""

RULE = Rule("viscoelasticity", "mean τ/t_c", "Lee & Radok 1960; Ting 1966; marched with and without relaxation")


def hindered(problem: Problem) -> str:
    """Why the relaxation of a problem cannot be simulated; empty if it can."""
    if problem.law.name != ELASTIC:
        return f"only law {ELASTIC} relaxes, not {problem.law.name}"
    if problem.scene.contact.effective_modulus is not None:
        return "the effective_modulus in [contact] replaces the moduli that relax"
    if problem.vibrates:
        return "the target vibrates between its edges"
    if problem.curve.native.compliance > 0.0:
        return "the target follows the force by its static stiffness"
    return ""


def relaxing(problem: Problem) -> tuple[Problem, Any]:
    """Impacts with the relaxation of their materials, and for which of them it is simulated; if for none, the impacts
    as they are. Raises TypeError if each of many relaxes differently."""
    wanted = problem.scene.effects.viscoelasticity
    relaxation = None if wanted is False else relaxation_of(problem.impacts.scene)
    why = "" if relaxation is None else hindered(problem)
    if why and wanted is True:
        raise SimulationError(f"viscoelasticity = true in [effects] is not supported: {why}")
    if relaxation is None or why:
        return problem, False
    relaxed = replace(problem, relaxation=relaxation)
    if wanted is True or not any_of(problem.approach > 0.0):
        return relaxed, True
    return relaxed, beyond(change(relaxed, problem), problem.scene.effect_tolerance)


def describe(problem: Problem) -> Effect:
    """The effect on one impact. problem: what is simulated."""
    scene, relaxation = problem.scene, relaxation_of(problem.scene)
    if relaxation is None:
        return effect_of(RULE, Estimate("no material has a prony series", applies=False), scene.effect_tolerance)
    elastic = replace(problem, relaxation=None)
    why = hindered(elastic)
    if scene.effective_modulus is None or not problem.approach > 0.0:
        missing = "the impactor has no velocity" if not problem.approach > 0.0 else "missing: moduli"
        return effect_of(RULE, Estimate(missing), scene.effect_tolerance)
    tried = problem.again(law=ELASTIC, impedance=math.inf, load=0.0, compliance=0.0) if why else elastic
    value, size = _indicator(tried, relaxation), change(replace(tried, relaxation=relaxation), tried)
    known = None if math.isnan(size) else min(size, 1.0)
    reason = f"the modulus falls to {100.0 * relaxation.rest:.3g} % of the instantaneous one in slow loading"
    state, cost = NOT_NEEDED, ABSENT if why else COST
    if problem.relaxation is not None:
        state = SIMULATED
    elif known is None or known > scene.effect_tolerance:
        state = NOT_MODELLED
        off = "the scene has viscoelasticity = false"
        reason += f"; {off if scene.effects.viscoelasticity is False else why}"
    elif scene.effects.viscoelasticity is False:
        state = SWITCHED_OFF
    return Effect(RULE.name, RULE.indicator, value, None, known, state, reason, RULE.source, cost)


def _indicator(elastic: Problem, relaxation: Relaxation) -> float | None:
    """Deborah's number: mean relaxation time over the time of the elastic contact; None if that does not end."""
    if not elastic.trial.ends:
        return None
    return relaxation.mean_time / (elastic.trial.summary.contact_duration * elastic.scales.time)

"""Plasticity: whether the contact yields, and whether it reaches full plasticity."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from film_model.base.arrays import any_of, either
from film_model.effects.effect import (
    FREE,
    NOT_JUDGED,
    NOT_MODELLED,
    NOT_NEEDED,
    SIMULATED,
    SWITCHED_OFF,
    Effect,
    off_state,
)
from film_model.effects.trial import change, matters
from film_model.laws.law import AbstractLaw, Stage
from film_model.laws.yielding import LEAST_YIELD_STRAIN, MOST_YIELD_STRAIN, YIELD_PRESSURE_RATIO, yield_velocity
from film_model.problem.law_of_scene import ASSUMED_POISSONS_RATIO, ELASTIC, YIELDING
from film_model.problem.model_intervals import STIFFEST_POLYMER
from film_model.problem.problem import Problem
from film_model.scene.noses import elastic_radius

FULLY_PLASTIC_RATIO = 200.0
"""V/V_Y at which an impact on a half-space reaches full plasticity: 200.6 by Stronge's law, 201.3 by Big-Alabo's."""


BY_YIELD_STRENGTH = (
    "; the strength is a yield strength: contact strains metals by some per cent and hardens them, so that the "
    "restitution is 4 to 43 % too low for 30 metals of the catalogue at 2 m/s (median 21 %): give hardness"
)
"""Measured with the body of a Leeb tester, by tests/test_hardness.py."""

OF_POLYMER = (
    "; the yield strength of a polymer rises with the rate: one of slow loading makes the restitution too low, a "
    "hardness of ISO 2039-1 more so"
)


@dataclass(frozen=True)
class Shortened(AbstractLaw):
    """A law without its last stage: the stage before is extended to `end`."""

    name: ClassVar[str] = "shortened"
    summary: ClassVar[str] = "another law without its last stage"
    source: ClassVar[str] = ""

    law: AbstractLaw
    end: float

    def scales(self, energy: float) -> tuple[float, float]:
        return self.law.scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        *_, last, _ = stages = self.law.stages()
        return (*stages[:-2], replace(last, end=self.end))


def needed(problem: Problem) -> Any:
    """Whether an impact keeps its law: not, if law "auto" took the one that yields, and Hertz's does as well."""
    scene = problem.scene
    chosen = scene.contact.law == "auto" and scene.effects.plasticity == "auto"
    if not (chosen and problem.law.name == YIELDING):
        return True
    return matters(problem, elastic(problem))


def elastic(problem: Problem) -> Problem:
    """The problem under Hertz's law."""
    return problem.again(law=ELASTIC)


def left_out(problem: Problem) -> Any:
    """Change of the summary of many impacts whose law does not yield because the scene says so; 0 for the others."""
    scene, impacts = problem.scene, problem.impacts
    fixed, yields = scene.contact.law != "auto" or scene.effects.plasticity is False, impacts.scene.reaches_yield
    if not fixed or yields is None or not any_of(yields & impacts.scene.can_yield) or not problem.curve.reversible:
        return impacts.column(0.0)
    return either(yields, change(problem.again(law=YIELDING), problem), 0.0)


def describe(problem: Problem, kept: bool, damps: bool = False) -> tuple[Effect, Effect]:
    """The effects on one impact: plasticity, and full plasticity. problem: before Hertz's law may replace its law.

    kept: whether the problem's law, which yields, matters. damps: whether a damped law replaces it even so.
    """
    if not problem.scene.is_round:
        last = _fully_plastic(problem, False, None)
        return _of_pressure(problem), last._replace(reason="the law does not yield")
    scene, law, yields = problem.scene, problem.law, problem.scene.reaches_yield
    wanted, tolerance, auto = scene.effects.plasticity, scene.effect_tolerance, scene.contact.law == "auto"
    modulus, strength, yielding = scene.effective_modulus, problem.impacts.yield_strength, not problem.curve.reversible
    size, ratio, limit, cost = 0.0 if yields is False else None, None, 0.0, FREE
    able = scene.can_yield
    if modulus is not None and able and (yields or (yielding and yields is not False)):
        plastic = problem if yielding else problem.again(law=YIELDING)
        without = elastic(problem) if yielding else problem
        found = change(plastic, without)
        size = None if math.isnan(found) else found
        if 0 < without.trial.summary.lines < plastic.trial.summary.lines:
            cost = f"{plastic.trial.summary.lines / without.trial.summary.lines:.2g} × the segments"
    if strength is not None and modulus is not None:
        limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
        ratio = scene.approach_velocity / limit
    if not auto and yielding:
        state, reason = SIMULATED, f"the scene asks for the law {law.name}"
    elif yields is None:
        state, reason = NOT_JUDGED, "missing: a yield strength; the law does not yield"
    elif yields and not able and strength is not None and modulus is not None:
        state = NOT_JUDGED
        allowed = f"{LEAST_YIELD_STRAIN:g} to {MOST_YIELD_STRAIN}"
        reason = f"S_y/E is {strength / modulus:.3g}, not from {allowed}: no law for it; law {law.name}"
    elif not auto or wanted is False:
        given = "has plasticity = false: law hertz" if auto else f"asks for the law {law.name}"
        state, reason = off_state(size, tolerance), f"the scene {given}, which does not yield"
        state = NOT_NEEDED if size == 0.0 and not auto else state
    elif damps and yields:
        state = NOT_MODELLED if kept else NOT_NEEDED
        reason = f"the yield velocity is {limit:.4g} m/s, but losses of the materials (material_damping) matter more"
    elif not kept:
        state = NOT_NEEDED
        reason = f"beyond the yield velocity {limit:.4g} m/s, but by less than the tolerance: law hertz"
    elif law.name == YIELDING:
        assumed = f", with an assumed Poisson's ratio of {ASSUMED_POISSONS_RATIO}: the scene gives none"
        state, reason = SIMULATED, f"the yield velocity is {limit:.4g} m/s: law {YIELDING}"
        reason += assumed if scene.poissons_ratio is None else ""
    else:
        state, reason = NOT_NEEDED, f"the impact stays below the yield velocity {limit:.4g} m/s: law hertz"
    soft = scene.first_to_yield
    if yielding and state == SIMULATED and scene.contact.yield_strength is None and soft is not None:
        polymer = soft.youngs_modulus < STIFFEST_POLYMER
        reason += OF_POLYMER if polymer else "" if soft.flow_known else BY_YIELD_STRENGTH
    source = "Big-Alabo, Cartmell & Harrison 2017, after (19): p_m = 1.1 S_y; marched with the law and with Hertz's"
    found = Effect("plasticity", "V/V_Y", ratio, 1.0, size, state, reason, source, cost)
    return found, _fully_plastic(problem, yielding, ratio)


def _of_pressure(problem: Problem) -> Effect:
    """Of a contact that is not a ball's, whose law does not yield: its mean pressure at the largest force."""
    scene, core = problem.scene, problem.trial.summary

    def effect(state: str, reason: str, value: float | None = None, size: float | None = None) -> Effect:
        source = "mean pressure at the first yield of a ball: Big-Alabo, Cartmell & Harrison 2017, after (19)"
        return Effect("plasticity", "p_m/(1.1 S_y)", value, 1.0, size, state, reason, source)

    if scene.yield_strength is None:
        return effect(NOT_JUDGED, "missing: a yield strength; the law does not yield")
    radius = elastic_radius(scene, core.maximum_indentation * problem.scales.length)
    pressure = core.maximum_force * problem.scales.force / (math.pi * max(radius, 1e-300) ** 2)
    value = pressure / (YIELD_PRESSURE_RATIO * scene.yield_strength)
    if value > 1.0:
        said = f"the mean pressure is {value:.3g} times that at which a ball yields, but laws that yield are of balls"
        return effect(NOT_MODELLED, f"{said}: the largest force is an upper bound", value)
    if scene.nose is None:
        return effect(NOT_NEEDED, "the contact stays below the mean pressure of yield", value, 0.0)
    return effect(NOT_JUDGED, "its tip or edge yields at any force; the mean pressure is below that of yield", value)


def _fully_plastic(problem: Problem, yielding: bool, ratio: float | None) -> Effect:
    """Whether the contact reaches the law's last stage, and the change if the stage before were extended."""
    curve, core = problem.curve, problem.trial.summary

    def effect(state: str, size: float | None, reason: str) -> Effect:
        source = "Stronge 2000: V/V_Y = 200.6; Big-Alabo's law: 201.3; marched with the last stage and without"
        return Effect("fully_plastic", "V/V_Y", ratio, FULLY_PLASTIC_RATIO, size, state, reason, source)

    if not yielding and ratio is None:
        return effect(NOT_JUDGED, None, "missing: a yield strength")
    if not yielding:
        late = ratio is not None and ratio > FULLY_PLASTIC_RATIO
        return effect(SWITCHED_OFF if late else NOT_NEEDED, None if late else 0.0, "the law does not yield")
    if curve.stage_names[-1] != "fully plastic":
        return effect(NOT_JUDGED, None, f"the law {problem.law.name} has no fully plastic stage of its own")
    if core.stage != curve.native.stages - 1:
        return effect(NOT_NEEDED, 0.0, "the contact does not reach the last stage of the law")
    depth, size = core.maximum_indentation, None
    # up to 3000 times the yield indentation the last stage is compared with an extension of the one before
    if depth < 3000.0:
        end = 10.0 ** math.ceil(math.log10(depth) + 0.5)  # a power of ten: few curves have to be made
        found = change(problem, problem.again(law=Shortened(problem.law, end)))
        size = None if math.isnan(found) else found
    return effect(SIMULATED, size, "it is a stage of the law")

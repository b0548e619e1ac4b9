"""Rate hardening: the yield strength at the strain rate of the impact, of the body that yields first.

    S = S_y (1 + C ln ε̇)              strain_rate_coefficient C, ε̇ in 1/s, at least 1 (Johnson & Cook 1983)
    S = S_y (1 + (ε̇/D)^(1/q))         rate_multiplier D, rate_exponent q (Cowper & Symonds 1957)
    ε̇ = 0.2 (a/R)/t_m,  a² = R δ_m    mean strain of Tabor (1951) over the time to the maximum indentation, with S

From 1/s on S (to 1e-9, without weight) replaces S_y in laws with a yield_strength; others are judged by Big-Alabo's. A
metal without C is judged with 0.014 (4340 steel; twelve metals: 0.006 to 0.06), one of the catalogue from 100 1/s on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

from film_model.base.arrays import all_of, any_of, either, greater, ratio, root
from film_model.base.errors import SimulationError
from film_model.base.materials import named
from film_model.base.rate_law import RateHardening
from film_model.base.units import format_si
from film_model.effects.case import deforms
from film_model.effects.effect import ABSENT, FREE, NOT_MODELLED, NOT_NEEDED, SIMULATED, SWITCHED_OFF, Effect
from film_model.effects.judged import Rule, effect_of
from film_model.effects.trial import change
from film_model.laws import LAWS, AbstractLaw
from film_model.problem.model_intervals import STIFFEST_POLYMER
from film_model.problem.problem import Impacts, Problem
from film_model.targets import Estimate

TYPICAL, LEAST, MOST = 0.014, 0.006, 0.06
"""C of 4340 steel, near the median of the metals of Johnson & Cook 1983, and the least and the largest of them."""

SETTLED, LEAST_SLOPE, MOST_ROUNDS = 1e-9, 1e-3, 60
"""Relative change of the strength that would follow, at which the iteration ends; three rounds nearly always. It is the
last change times the slope, which is 1/4 at most, as the rate varies as S^{1/4} at most, the strength as C ln ε̇, C ≤ 1,
or as a power 1/q ≤ 1 of ε̇; a slope that is less by chance counts as `LEAST_SLOPE` (tests/test_rate_hardening.py)."""

SWITCHED_OFF_BECAUSE = "the scene has rate_hardening = false"

RULE = Rule(
    "rate_hardening",
    "strain rate, 1/s",
    "Tabor 1951; Johnson & Cook 1983; Cowper & Symonds 1957; marched with S and with S_y",
)


def strain_rate(problem: Problem) -> Any:
    """0.2 (a/R)/t_m of one impact or of many, 1/s; nan where the march failed."""
    return _rate(problem, *problem.trial[:2])


def factor_at(problem: Problem, status: Any, core: Any) -> Any:
    """S/S_y at the strain rate of impacts whose trial march had this status and summary."""
    return _law(problem).factor(_rate(problem, status, core))


def _law(problem: Problem) -> RateHardening:
    law = problem.impacts.scene.rate_hardening
    assert law is not None
    return law


def _rate(problem: Problem, status: Any, core: Any) -> Any:
    scales = problem.scales
    depth, turn = core.maximum_indentation * scales.length, core.time_of_maximum_indentation * scales.time
    known = (status >= 0) & (turn > 0.0)
    return either(known, 0.2 * root(depth / problem.impacts.numbers.radius) / either(known, turn, 1.0), math.nan)


def settled(rate_of: Callable[[Any], Any], law: RateHardening, factor: Any = 1.0) -> Any:
    """S/S_y from the strain rate as a function of it, by secants; nan if unknown. Each of many impacts settles by
    itself."""
    before, factor = factor, law.factor(rate_of(factor))
    value, open_ = factor, abs(factor - before) > 0.0
    for _ in range(MOST_ROUNDS):
        if not any_of(open_):
            return factor
        found = law.factor(rate_of(factor))
        step, moves = secant(before, value, factor, found)
        before, value, factor = factor, found, either(open_, factor + step, factor)
        open_ = open_ & moves
    return either(open_, math.nan, factor)


def secant(before: Any, value: Any, factor: Any, found: Any) -> tuple[Any, Any]:
    """The step from a factor to the next, and whether it has not settled. value, found: S/S_y at the rates with the
    factor before and with this one."""
    slope = ratio(found - value, factor - before)
    step = ratio(found - factor, 1.0 - slope)
    return step, abs(step) * greater(abs(slope), LEAST_SLOPE) > SETTLED * (factor + step)


def strengthened(static: Problem, factor: Any) -> Problem:
    """The problem with `factor` times the yield strength."""
    if all_of(factor == 1.0):
        return static  # whose marches are made
    impacts = static.impacts
    return impacts.under(impacts.law.strengthened(factor)).problem(*static.given)


def factor_of(impacts: Impacts, rates: Callable[[Any], Any], first: Any = 1.0) -> Any:
    """S/S_y at the rates of one impact or of many, from the rates as a function of it; nan if the rate law is unknown,
    the law has no yield strength, the impactor has no velocity, or the impact cannot be marched."""
    law = impacts.scene.rate_hardening
    if law is None or impacts.law.strength is None or not any_of(impacts.numbers.approach > 0.0):
        return math.nan
    return settled(rates, law, first)


def used(impacts: Impacts, rates: Callable[[Any], Any], first: Any = 1.0) -> Any:
    """The S/S_y with which impacts are simulated; None if all have the strength of slow loading."""
    wanted = impacts.base.effects.rate_hardening
    if wanted is False or impacts.law.strength is None:
        return None
    factor = factor_of(impacts, rates, first)
    unknown = factor != factor
    if wanted is True and any_of(unknown & (impacts.numbers.approach > 0.0)):
        raise SimulationError(
            "effects.rate_hardening is true, but the impact with the higher strength cannot be marched"
        )
    if any_of(factor > 1.0) or (wanted is True and not any_of(unknown)):
        return either(factor > 1.0, factor, 1.0)
    return None


def hardened(static: Problem) -> Problem | None:
    """One impact with the strength at its own rate; None if :func:`factor_of` is unknown. static: without weight."""
    return _strong(static, factor_of)


def applied(static: Problem) -> Problem | None:
    """One impact with the strength at its own rate if this is simulated, else None."""
    return _strong(static, used)


def _strong(static: Problem, rule: Callable[..., Any]) -> Problem | None:
    def rate(factor: float) -> float:
        try:
            return strain_rate(strengthened(static, factor))
        except ValueError:  # the higher strength is beyond the law's range
            return math.nan

    factor = rule(static.impacts, rate)
    return None if factor is None or math.isnan(factor) else strengthened(static, factor)


def describe(static: Problem, used: Problem | None, yields: bool) -> Effect:
    """The effect on one impact. used: what is simulated in place of `static`. yields: whether its law may yield."""
    scene, missing = static.scene, ""
    if scene.yield_strength is None or scene.effective_modulus is None:
        missing = "missing: a yield strength"
    elif not static.approach > 0.0:
        missing = "the impactor has no velocity"
    elif not static.trial.ends:
        missing = "contact did not end"
    if missing or not yields or not deforms(static):
        found = Estimate(missing) if missing else Estimate("nothing yields", applies=False)
        return effect_of(RULE, found, scene.effect_tolerance)
    if scene.rate_hardening is None:
        return _without_coefficient(static)
    own = static.impacts.law.strength is not None
    slow = static if own else static.again(law=_substitute(static))
    hard = used or hardened(slow)
    size = math.nan if hard is None else change(hard, slow)
    if hard is None or math.isnan(size):
        missing = "the impact with the higher yield strength cannot be marched"
        return effect_of(RULE, Estimate(missing, strain_rate(slow)), scene.effect_tolerance)
    rate = strain_rate(hard)
    raised = scene.rate_hardening.factor(rate) - 1.0
    why = (
        f"at {rate:.3g} 1/s the yield strength is {format_si(hard.impacts.yield_strength, 'pressure', 3)}, "
        f"{100.0 * raised:.2g} % higher than in slow loading"
    )
    matters, cost = size > static.scene.effect_tolerance, FREE
    state = SIMULATED if used is not None else NOT_NEEDED
    if used is None and scene.effects.rate_hardening is False:
        state, why = NOT_MODELLED if matters else SWITCHED_OFF, f"{SWITCHED_OFF_BECAUSE}; {why}"
    elif used is None and matters:
        state, cost = NOT_MODELLED, ABSENT
        why += f"; the law {static.law.name} has no yield_strength: raise its own parameters"
    return Effect(RULE.name, RULE.indicator, rate, None, min(size, 1.0), state, why, RULE.source, cost)


def _substitute(static: Problem) -> AbstractLaw:
    """The law with which rate hardening is judged for a law without a yield strength."""
    scene, law = static.scene, cast("Any", LAWS["big-alabo"])
    return law(scene.effective_modulus, scene.effective_radius, scene.flow_strength)


def _without_coefficient(static: Problem) -> Effect:
    """The effect for a material without C: important if its strength is the catalogue's, that of slow loading."""
    rate_sensitive = 100.0  # 1/s: the strength of slow loading may then be too low by more than a few per cent
    rate, soft = strain_rate(static), static.scene.first_to_yield
    size, opened = _open(static)
    if soft is None or rate < rate_sensitive or named(soft.name) != soft:
        why = "missing: strain_rate_coefficient or rate_multiplier of the material that yields"
        found = Estimate(why + opened, rate)
    elif size is not None and size * MOST / TYPICAL <= static.scene.effect_tolerance:
        found = Estimate("too little yields", applies=False)
    else:
        why = f"at {rate:.3g} 1/s {soft.name} is stronger than in slow loading"
        why += f", and the catalogue has no coefficient for it{opened}"
        found = Estimate(why, rate, rate_sensitive, fails=True)
    return effect_of(RULE, found, static.scene.effect_tolerance)._replace(change=size)


def _open(static: Problem) -> tuple[float | None, str]:
    """The change of the summary if a metal without a rate law had C = `TYPICAL`, and what this does to the
    restitution, in words; nothing for a polymer, or if the impact with the higher strength cannot be marched."""
    modulus = static.scene.effective_modulus
    if modulus is None or modulus < STIFFEST_POLYMER:
        return None, ""
    slow = static if static.impacts.law.strength is not None else static.again(law=_substitute(static))
    factor = RateHardening(TYPICAL, 0.0, 1.0).factor(strain_rate(slow))  # not iterated: it changes by C/4 of its rise
    if math.isnan(factor):
        return None, ""
    try:
        hard = strengthened(slow, factor)
    except ValueError:  # the higher strength is beyond the law's range
        return None, ""
    size = change(hard, slow)
    if math.isnan(size) or not (hard.trial.ends and slow.trial.ends):
        return None, ""
    after, before = (problem.trial.summary.final_velocity / problem.approach for problem in (hard, slow))
    if before == 0.0:
        return min(size, 1.0), ""
    more = after / before - 1.0
    return min(size, 1.0), (
        f"; with C = {TYPICAL} of 4340 steel the coefficient of restitution would be {100.0 * more:.2g} % higher; C of "
        f"metals is {LEAST} to {MOST}"
    )

"""Which of many impacts have a law that is sure to be accepted in series with a spring; others are tried one by one."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from film_model.base.arrays import Array, Mask
from film_model.base.errors import SimulationError
from film_model.laws.law import AbstractLaw, Power, Stage, origin_of
from film_model.problem.curve import steepest_fall
from film_model.problem.families import ANY_SHAPE, EDGES, Page, page_number
from film_model.problem.fit import values_of
from film_model.problem.problem import Impacts


def sure_in_series(impacts: Impacts, compliance: Array) -> Mask:
    """Whether the law of each impact is sure to be accepted in series with a target of its compliance [m/N].

    The impacts share a curve, a page of a family, or pieces.
    """
    scales, own = impacts.problem(impacts.numbers.impedance, impacts.column(0.0)).scales, impacts.own
    try:
        fall = steepest_fall(impacts.one_law) if own.page is None else _fall_of_page(impacts.one_law, own.page)
    except SimulationError:
        return np.zeros(compliance.shape, np.bool_)
    # half the compliance of a snap through, because the slope is known at some points only
    followed = compliance * scales.force / scales.length * fall < 0.5
    if own.varied is None:
        return followed
    stages = impacts.law.at(slice(None)).stages()
    return followed & _never_fall(stages, compliance.shape)


@lru_cache(maxsize=64)
def _fall_of(law: AbstractLaw, low: float, high: float) -> float:
    return max(steepest_fall(law.of_shape(low * (high / low) ** x)) for x in (0.0, 0.25, 0.5, 0.75, 1.0))


def _fall_of_page(law: AbstractLaw, page: Page) -> float:
    """The steepest fall of the laws of a page, of which one is given."""
    number, laws = int(page_number(law.shape)), [law.of_shape(ANY_SHAPE)]
    if page.marks is not None:
        ends = (np.linspace(*ends, 3).tolist() for ends in law.shaped_beside.values())
        numbers = (dict(zip(law.shaped_beside, values, strict=True)) for values in product(*ends))
        laws = [replace(laws[0], **each) for each in numbers]  # type: ignore[type-var]
    return max(_fall_of(each, float(EDGES[number]), float(EDGES[number + 1])) for each in laws)


def _never_fall(stages: tuple[Stage, ...], shape: tuple[int, ...]) -> Mask:
    """For stages of powers whose numbers are arrays: none has a term that falls, and none begins with a jump."""
    found, before = np.ones(shape, np.bool_), 0.0
    for stage in stages:
        power: Any = stage.force
        if isinstance(power, Power):
            for number in (power.slope, power.square, power.coefficient):
                found &= np.asarray(number) >= 0.0
        begins = _force(stage, stage.begin)
        found &= abs(begins - before) <= 1e-9 * abs(begins)
        before = _force(stage, stage.end) if np.isfinite(stage.end) else before
    return found


def _force(stage: Stage, xi: float) -> Any:
    """The force of a stage at one indentation; an array if the numbers of a power are arrays."""
    power = stage.force
    if not isinstance(power, Power):
        return float(values_of(power, np.array([xi]), stage)[0])
    return power.at(max(xi - origin_of(power, stage), 0.0))

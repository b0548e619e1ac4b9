"""A scene without units: the dimensionless numbers and the curve for the core, and the way back to a summary in SI."""

from __future__ import annotations

from film_model.problem.curve import Curve, curve_of
from film_model.problem.numbers import Numbers, zener
from film_model.problem.problem import Impacts, Problem, Trial
from film_model.problem.scales import Scales, scales_of
from film_model.problem.summary import SUMMARY, difference, summary_of

__all__ = [
    "SUMMARY",
    "Curve",
    "Impacts",
    "Numbers",
    "Problem",
    "Scales",
    "Trial",
    "curve_of",
    "difference",
    "scales_of",
    "summary_of",
    "zener",
]

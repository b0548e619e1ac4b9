"""The loading curve of an FMU's data, with damping: the law's own force, without the march."""

from __future__ import annotations

import math

from numpy.polynomial.chebyshev import chebval

from film_model.core import native
from fmu_wrapper.resource import Data


def loading_force(data: Data, indentation: float, rate: float) -> float:
    """Force of the loading curve with damping, N, at an indentation ≥ 0 m."""
    xi, curve = indentation / data.length_scale, data.curve
    stage = sum(curve.stage[k].end < xi for k in range(curve.stages - 1))
    force = native.stage_law(curve, stage, xi)[0] * data.force_scale
    return force + data.damping * _damping(curve, xi) * rate if curve.stage[0].damped else force


def _damping(curve: native.Curve, xi: float) -> float:
    """The damping coefficient of a damped law, divided by its factor."""
    piece = next(piece for piece in curve.piece if xi <= piece.end)
    c: native.Function = piece.damping
    x = (xi - c.origin) * c.per_span
    if c.form == native.POWER:
        return float(c.constant + c.slope * x + c.coefficient * x**c.exponent)
    return float(chebval(2.0 * (math.sqrt(x) if c.form == native.ROOT_SERIES else x) - 1.0, c.series[: c.terms]))

"""Newmark's method for contact on modes, as a solver for SciPy's `solve_ivp` with fixed steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver
from scipy.optimize import brentq

from film_model.base.arrays import Array
from film_model.studies.modal_reference import System


class Newmark(OdeSolver):
    """Mean acceleration (β = 1/4, γ = 1/2) of impactor and modes, y = (x, ν, work, w_n, ẇ_n); second order.

    A step is linear in the force at its end, so that the indentation there solves one equation, ξ = a − b f(ξ). Events
    and sampling use the cubic through both ends. step: length of all steps but the last of a run.
    """

    def __init__(self, fun: Any, t0: float, y0: Array, t_bound: float, vectorized: bool, **options: Any) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)
        self.system: System = options["system"]
        self.step_length: float = options["step"]
        self.slope = fun(t0, y0)

    def _step_impl(self) -> tuple[bool, None]:
        s, n = self.system, self.system.square.size
        h = min(self.step_length, self.t_bound - self.t)
        quarter, force = 0.25 * h * h, s.load - float(self.slope[1])
        w, u, a = self.y[3 : 3 + n], self.y[3 + n :], self.slope[3 + n :]
        yields = 1.0 / (1.0 + quarter * s.square + 0.5 * h * s.drag)
        guess = (w + h * u + quarter * a + s.drag * (0.5 * h * w + quarter * u)) * yields
        ahead = float(self.y[0] + h * self.y[1] + quarter * (2.0 * s.load - force) - guess.sum())
        soft = quarter * (1.0 + float((s.share * yields).sum()))
        new = s.force(self._indentation(ahead, soft))
        y, slope = np.empty_like(self.y), np.empty_like(self.y)
        y[3 : 3 + n] = guess + quarter * s.share * yields * new
        y[3 + n :] = 2.0 / h * (y[3 : 3 + n] - w) - u
        y[0] = self.y[0] + h * self.y[1] + quarter * (2.0 * s.load - force - new)
        y[1] = self.y[1] + 0.5 * h * (2.0 * s.load - force - new)
        slope[0], slope[1], slope[2] = y[1], s.load - new, new * (y[1] - y[3 + n :].sum())
        slope[3 : 3 + n] = y[3 + n :]
        slope[3 + n :] = s.share * new - s.square * y[3 : 3 + n] - s.drag * y[3 + n :]
        y[2] = self.y[2] + 0.5 * h * (self.slope[2] + slope[2])
        self.before = self.t, self.y, self.slope
        self.t, self.y, self.slope = self.t + h, y, slope
        return True, None

    def _indentation(self, ahead: float, soft: float) -> float:
        """ξ + soft f(ξ) = ahead, for a force that rises with ξ."""
        least = ahead - soft * self.system.force(ahead)
        if least == ahead:
            return ahead
        return float(brentq(lambda xi: xi + soft * self.system.force(xi) - ahead, least, ahead, xtol=1e-16, rtol=1e-14))  # pyright: ignore[reportArgumentType]

    def _dense_output_impl(self) -> DenseOutput:
        return _Cubic(self.before, (self.t, self.y, self.slope))


class _Cubic(DenseOutput):
    """The cubic with given values and slopes at both ends of a step."""

    def __init__(self, begin: Any, end: Any) -> None:
        super().__init__(begin[0], end[0])
        self.begin, self.end = begin, end

    def _call_impl(self, t: Any) -> Any:
        (begin, y, slope), (end, y1, slope1) = self.begin, self.end
        h, many = end - begin, np.ndim(t) > 0
        s, rise = (np.asarray(t) - begin) / h, y1 - y
        y, slope, slope1, rise = (each[:, None] if many else each for each in (y, h * slope, h * slope1, rise))
        return y + s * (slope + s * (3.0 * rise - 2.0 * slope - slope1 + s * (slope + slope1 - 2.0 * rise)))

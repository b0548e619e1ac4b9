"""The reference for viscoelastic contact: Ting's solution by SciPy's DOP853, which shares nothing with the core.

In the units of the march: ẍ = p − f, ξ' = ẋ − γ f. While the contact grows f = ∫ e(t − s) d(ξ^{3/2}), by one internal
variable for each relaxation time; while it shrinks f is that of the time t₁ on the way in at which the contact had the
same radius: ∫ e(t − s) dξ from t₁ to t is 0 (Ting 1966, J. Appl. Mech. 33:845).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from film_model.base.arrays import Array

TOLERANCES = 1e-12, 1e-10
"""rtol on the way in, and on the way out, where every evaluation finds t₁ on the interpolation of the way in."""


class Ting:
    """One contact from first touch to its end.

    terms: pairs of a relative modulus g and a relaxation time. way_in, way_out: solutions of `solve_ivp` over time:
    ξ, ẋ, and of each term ∫ exp(−r (t − s)) d(ξ^{3/2}), on the way in only, and the same with dξ. turn, end: times.
    deepest: largest ξ. left, final: ξ and velocity at the end.
    """

    def __init__(
        self, terms: Sequence[tuple[float, float]], approach: float, gamma: float = 0.0, load: float = 0.0
    ) -> None:
        from scipy.integrate import solve_ivp

        self.share, self.rate = np.array([g for g, _ in terms]), np.array([1.0 / time for _, time in terms])
        self.rest, self.gamma, self.load, n = 1.0 - self.share.sum(), gamma, load, len(terms)

        def turns(_: float, y: Array) -> float:
            return y[1] - gamma * self.force_in(y)

        def ends(_: float, y: Array) -> float:
            return self.rest * y[0] + self.share @ y[2:]

        for event in (turns, ends):
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        (tight, loose), start = TOLERANCES, np.concatenate([[0.0, approach], np.zeros(2 * n)])
        options: Any = {"method": "DOP853", "dense_output": True}
        self.way_in: Any = solve_ivp(
            self._in, (0.0, 1e3), start, events=turns, first_step=1e-4, rtol=tight, atol=1e-2 * tight, **options
        )
        self.turn, self.deepest = float(self.way_in.t[-1]), float(self.way_in.y[0, -1])
        out = np.concatenate([self.way_in.y[:2, -1], self.way_in.y[2 + n :, -1]])
        self.way_out: Any = solve_ivp(
            self._out, (self.turn, 1e3), out, events=ends, rtol=loose, atol=1e-2 * loose, **options
        )
        self.end, (self.left, self.final) = float(self.way_out.t[-1]), map(float, self.way_out.y[:2, -1])

    @property
    def largest(self) -> float:
        """The largest force, which is on the way in."""
        from scipy.optimize import minimize_scalar

        found: Any = minimize_scalar(
            lambda t: -self.force_in(self.way_in.sol(t)), bounds=(0.3 * self.turn, self.turn), method="bounded"
        )
        return -float(found.fun)

    def force_in(self, y: Array) -> float:
        """Force while the contact grows."""
        return self.rest * max(y[0], 0.0) ** 1.5 + self.share @ y[2 : 2 + self.share.size]

    def _in(self, _: float, y: Array) -> Array:
        n, force = self.share.size, self.force_in(y)
        speed = y[1] - self.gamma * force
        grows = 1.5 * math.sqrt(max(y[0], 0.0)) * speed
        return np.concatenate(
            [[speed, self.load - force], grows - self.rate * y[2 : 2 + n], speed - self.rate * y[2 + n :]]
        )

    def force_out(self, t: float, y: Array) -> float:
        """Force while the contact shrinks."""
        from scipy.optimize import brentq

        n = self.share.size
        push = self.rest * y[0] + self.share @ y[2:]

        def more(t1: float) -> float:
            then = self.way_in.sol(t1)
            return self.rest * then[0] + (self.share * np.exp(-self.rate * (t - t1))) @ then[2 + n :] - push

        if push <= 0.0:
            return 0.0
        root: Any = self.turn if more(self.turn) <= 0.0 else brentq(more, 0.0, self.turn, xtol=1e-15, rtol=1e-14)  # type: ignore[arg-type]
        then = self.way_in.sol(root)
        return self.rest * max(then[0], 0.0) ** 1.5 + (self.share * np.exp(-self.rate * (t - root))) @ then[2 : 2 + n]

    def _out(self, t: float, y: Array) -> Array:
        force = self.force_out(t, y)
        speed = y[1] - self.gamma * force
        return np.concatenate([[speed, self.load - force], speed - self.rate * y[2:]])

"""Conventional integrators: scipy's `solve_ivp`, one impact at a time, with events."""

from __future__ import annotations

import numpy as np

from benchmarks.cases import Array, Case
from film_model.studies.impact_ode import INTEGRATED_VALUES, impact_of
from film_model.studies.integrators import solve_ivp

METHODS = ("RK45", "DOP853", "LSODA", "Radau")


def run(case: Case, method: str, rtol: float) -> Array:
    """(impacts, 6) summaries in the law's units; NaN where the method failed."""
    rows = []
    for nu, gamma in zip(case.nu, case.gamma, strict=True):
        try:
            rows.append(solve_ivp(method, rtol, impact_of(case.law, float(nu), float(gamma))))
        except RuntimeError:
            rows.append((np.nan,) * len(INTEGRATED_VALUES))
    return np.array(rows)

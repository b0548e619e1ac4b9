"""Run a case beside conventional integrators, and write the reports as a page."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from film_model.studies import fixed_steps, integrators
from film_model.studies.hard_cases.case import ALLOWED, STEPPED, Finding, HardCase
from film_model.studies.hard_cases.single_impact import exact_summary, problem_for
from film_model.studies.impact_ode import Impact, impact_of


@dataclass(frozen=True)
class Report:
    """A case with its finding, its time [s], and the results of conventional integrators for the same impact."""

    case: HardCase
    finding: Finding
    seconds: float
    others: dict[str, str]

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        f = self.finding
        return {
            "case": self.case.name,
            "why": self.case.why,
            "outcome": f.outcome,
            "error": f.error if math.isfinite(f.error) else None,
            "allowed": f.allowed,
            "good": f.good,
            "segments": f.segments,
            "balance": f.balance,
            "seconds": self.seconds,
            "others": self.others,
        }


def report(case: HardCase, others: bool = True) -> Report:
    """Run a case, and the conventional integrators on the same impact unless `others` is False."""
    begun = time.perf_counter()
    finding = case.run()
    seconds = time.perf_counter() - begun
    return Report(case, finding, seconds, _others(case) if others and case.impact is not None else {})


def page(reports: Sequence[Report]) -> str:
    """The reports as a Markdown page."""
    names = list(dict.fromkeys(name for r in reports for name in r.others))
    balances = [r.finding.balance for r in reports if r.finding.balance is not None]
    heads = ["what is hard", "case", "outcome", "error", "allowed", "balance", "segments", "time", *names]
    lines = [
        "# Hard cases",
        "",
        "<!-- written by film-model hard-cases --markdown docs/hard_cases.md -->",
        "",
        "The largest relative error of any summary value, against extended precision, quadrature or a tight",
        f"integration of the law. Differences of steps, batches and balances may be {STEPPED:g} and are shown times",
        f"{ALLOWED / STEPPED:g}. The time covers all of these. The last columns are usual integrators of the same law.",
        "",
        f"{sum(r.finding.good for r in reports)} of {len(reports)} cases passed; the largest relative error of a",
        f"balance of momentum or energy is {max(balances, default=0.0):.1e}.",
        "",
        f"| {' | '.join(heads)} |",
        "|" + "---|" * len(heads),
    ]
    for before, r in zip((None, *reports), reports, strict=False):
        f = r.finding
        balance = "" if f.balance is None else f"{f.balance:.0e}"
        numbers = [f"{f.error:.1e}", f"{f.allowed:.0e}", balance, str(f.segments or ""), f"{r.seconds:.2f} s"]
        cells = [
            "" if before is not None and before.case.why == r.case.why else r.case.why,
            r.case.name,
            f.outcome if f.good else f"**{f.outcome}**",
            *numbers,
            *(r.others.get(n, "") for n in names),
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _others(case: HardCase) -> dict[str, str]:
    """Error and time of conventional integrators at usual settings, or their error message."""
    assert case.impact is not None
    law, mass, velocity, impedance = case.impact
    problem = problem_for(law, mass, velocity, impedance)
    exact = exact_summary(problem, velocity, impedance)
    names = ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "time_impactor_stops")
    values = np.array([*(getattr(exact, n) for n in names), exact.contact_duration, exact.final_velocity])
    found: dict[str, str] = {}
    methods: dict[str, Callable[[Impact], Any]] = {
        "solve_ivp RK45, rtol 1e-6": lambda impact: integrators.solve_ivp("RK45", 1e-6, impact),
        "solve_ivp LSODA, rtol 1e-6": lambda impact: integrators.solve_ivp("LSODA", 1e-6, impact),
        "Newmark, 400 steps": lambda impact: fixed_steps.newmark(400, impact),
    }
    import_module("scipy.integrate")  # keep the import out of the first timing
    for name, method in methods.items():
        impact = impact_of(law, problem.approach, problem.gamma)
        begun = time.perf_counter()
        try:
            with np.errstate(all="ignore"):
                off = float(np.max(np.abs(np.array(method(impact)) / values - 1.0)))
            said = "no end of contact" if math.isnan(off) else f"error {off:.0e}"
        except Exception as error:  # any failure of another method is an outcome
            said = " ".join(str(error).split())[:60] or type(error).__name__
        found[name] = f"{said}, {1e3 * (time.perf_counter() - begun):.0f} ms"
    return found

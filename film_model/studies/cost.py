"""Error against computing time for one scene: FILM and the methods that could be used instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from film_model.base.errors import SimulationError
from film_model.base.units import format_si
from film_model.effects.choose import problem_of
from film_model.problem.problem import refuse_relaxation
from film_model.scene import Scene
from film_model.studies import modal_methods
from film_model.studies.impact_ode import INTEGRATED_VALUES
from film_model.studies.methods import FILM, FILM_ON_MODES, Prepared, methods_for
from film_model.studies.reference import COMPARED, QUADRATURE, reference
from film_model.studies.timing import Timing, machine, timed

NOT_INSTALLED = "not installed"
"""The outcome of a method whose library cannot be imported."""


@dataclass(frozen=True)
class CostRun:
    """One method at one setting. Times in s per impact, for a single call from Python and in a batch, or None.

    force_evaluations: for FILM the number of segments, at whose ends the law is evaluated. errors: relative, by the
    names of `COMPARED`; empty if the method failed. outcome: "done", or the method's error message.
    """

    method: str
    setting: str
    time_single: Timing | None
    time_batch: Timing | None
    force_evaluations: int | None
    errors: dict[str, float]
    outcome: str

    @property
    def error(self) -> float:
        """The largest of the errors; infinite if the method failed."""
        return max(self.errors.values(), default=math.inf)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""

        def seconds(timing: Timing | None) -> dict[str, float] | None:
            return None if timing is None else timing._asdict()

        return {
            "method": self.method,
            "setting": self.setting,
            "time_single": None if self.time_single is None else self.time_single.median,
            "time_batch": None if self.time_batch is None else self.time_batch.median,
            "spread": {"time_single": seconds(self.time_single), "time_batch": seconds(self.time_batch)},
            "force_evaluations": self.force_evaluations,
            "errors": self.errors,
            "outcome": self.outcome,
        }


@dataclass(frozen=True)
class Study:
    """The work-precision study of a scene. reference: SI values of `COMPARED`, their relative error, and the method."""

    scene: Scene
    law: str
    reference: dict[str, Any]
    runs: tuple[CostRun, ...]
    machine: dict[str, str]

    def cheapest(self, error: float, method: str | None = None, timing: str = "time_single") -> CostRun | None:
        """The fastest run whose largest error is at most `error`, of one method or of all."""
        good = [
            run
            for run in self.runs
            if run.error <= error and getattr(run, timing) is not None and (method is None or run.method == method)
        ]
        return min(good, key=lambda run: getattr(run, timing).median, default=None)

    def front(self, timing: str = "time_single") -> tuple[CostRun, ...]:
        """The Pareto-optimal runs in error and time, fastest first."""
        timed = [run for run in self.runs if getattr(run, timing) is not None and run.errors]
        best, front = math.inf, []
        for run in sorted(timed, key=lambda run: (getattr(run, timing).median, run.error)):
            if run.error < best:
                best = run.error
                front.append(run)
        return tuple(front)

    @property
    def film(self) -> str:
        """The name of FILM's own method, by work-preserving lines or on modes; empty if it was not timed."""
        return next((run.method for run in self.runs if run.method in (FILM[0], FILM_ON_MODES)), "")

    def sentence(self, error: float = 1e-4) -> str:
        """FILM's time for an error, compared with the fastest solve_ivp method."""
        ours = self.cheapest(error, self.film)
        theirs = [self.cheapest(error, f"solve_ivp {method}") for method in ("RK45", "DOP853", "LSODA", "Radau")]
        best = min((run for run in theirs if run is not None), key=lambda run: _median(run.time_single), default=None)
        if not self.film:
            other = "" if best is None else f"; error {error:g}: {best.method} takes {_shown(best.time_single)}"
            return f"FILM was not timed{other}."
        if ours is None:
            finest = next(run.setting for run in reversed(self.runs) if run.method == self.film)
            return f"Error {error:g}: not reached with {finest}."
        takes = "take" if ours.setting.endswith("s") else "takes"  # "12 segments", "tolerance 0.001"
        text = f"Error {error:g}: {ours.setting} {takes} {_shown(ours.time_single)}"
        if ours.time_batch is not None:
            text += f" ({_shown(ours.time_batch)} per impact in a batch)"
        return text + (f"; {best.method} takes {_shown(best.time_single)}." if best is not None else ".")

    def beaten(self, errors: Sequence[float] = (1e-3, 1e-4, 1e-6)) -> list[str]:
        """Errors that another method reaches faster than FILM's own, with the ratio of speeds."""
        found: list[str] = []
        if not self.film:
            return found
        for timing, where in (("time_single", "single impact"), ("time_batch", "in a batch")):
            for error in errors:
                ours, best = self.cheapest(error, self.film, timing), self.cheapest(error, None, timing)
                if best is not None and ours is None:
                    found.append(f"Error {error:g}, {where}: reached by {best.method}, not by {self.film}")
                elif best is not None and best.method not in (*FILM, FILM_ON_MODES):
                    ratio = _median(getattr(ours, timing, None)) / getattr(best, timing).median
                    found.append(f"Error {error:g}, {where}: {best.method} is {ratio:.2g} times as fast")
        return found

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "title": self.scene.title,
            "law": self.law,
            "reference": self.reference,
            "runs": [run.to_dict() for run in self.runs],
            "machine": self.machine,
            "summary": self.sentence(),
            "beaten": self.beaten(),
        }


def study(
    scene: Scene, *, methods: Sequence[str] | None = None, progress: Callable[[str], None] | None = None
) -> Study:
    """Error against time for one scene, by all installed methods or by those whose names begin with one of `methods`.

    Timings use one thread: the median over repeated loops after a warm-up. The reference is extended precision if the
    law allows it and mpmath is installed, else quadrature (half-space without load) or DOP853 near rounding; none of
    them uses the core's march, and `reference` states the error of each. On a target that vibrates all methods and the
    reference follow the modes that `simulate` takes at the scene's accuracy, which is ignored elsewhere; computing them
    is not timed. The rebound velocity is relative to a free body. Raises SimulationError if there is no reference: for
    a load that prevents the end of contact, damping that is not made of powers, damped laws on modes, a static
    stiffness, or a law that pulls; ValueError if no method begins with one of `methods`.
    """
    problem = problem_of(scene)
    refuse_relaxation(problem, "a study")
    if problem.curve.pulls:
        raise SimulationError(f"a study is not supported for the law {problem.law.name}, which pulls")
    if problem.approach <= 0.0:
        raise SimulationError("a study needs an impact: the approach velocity is 0")
    if problem.given.compliance > 0.0:
        raise SimulationError(f"a study is not supported for a {scene.target.kind} with a static stiffness")
    offered = dict(modal_methods.methods_for(problem, scene) if problem.vibrates else methods_for(problem, scene))
    wanted = [name for name in offered if methods is None or any(name.startswith(begin) for begin in methods)]
    if not wanted:
        raise ValueError(f"no method begins with {' or '.join(methods or ())}; there are {'; '.join(offered)}")
    try:
        exact, stated = (modal_methods.reference if problem.vibrates else reference)(scene, problem)
    except (ImportError, ValueError, RuntimeError) as error:
        raise SimulationError(f"a study needs a reference, which failed: {error}") from error
    runs: list[CostRun] = []
    for name in wanted:
        if name == "quadrature" and stated["method"] == QUADRATURE:
            continue  # it would be compared with itself
        if progress is not None:
            progress(name)
        runs += [_run(name, setting, make, exact) for setting, make in offered[name]]
    return Study(scene, problem.law.name, stated, tuple(runs), machine())


def _run(method: str, setting: str, make: Callable[[], Prepared], exact: Any) -> CostRun:
    try:
        prepared = make()
        values, evaluations = prepared.single()
    except Exception as error:  # any failure of another library is an outcome
        missing = isinstance(error, ImportError)
        said = NOT_INSTALLED if missing else " ".join(str(error).split()) or type(error).__name__
        return CostRun(method, setting, None, None, None, {}, said[:200])
    off = np.abs(np.array(values) / exact - 1.0)
    errors = {name: float(off[INTEGRATED_VALUES.index(name)]) for name in COMPARED}
    if not all(map(math.isfinite, errors.values())):
        return CostRun(method, setting, None, None, evaluations, {}, "found no end of contact")
    alone = timed(prepared.single)
    together = None
    if prepared.batch is not None:
        whole = timed(prepared.batch)
        together = Timing(whole.median / prepared.batch_size, whole.spread / prepared.batch_size)
    return CostRun(method, setting, alone, together, evaluations, errors, "done")


def _median(timing: Timing | None) -> float:
    return math.inf if timing is None else timing.median


def _shown(timing: Timing | None) -> str:
    return "-" if timing is None else format_si(timing.median, "time", 3)

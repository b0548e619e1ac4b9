"""What accuracy costs in time: one scene, by FILM and by the methods one would use instead."""

from __future__ import annotations

import math
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

import numpy as np

from film_model import conventional, extended, reference
from film_model.accuracy import unloading_ratio
from film_model.core import native
from film_model.errors import SimulationError
from film_model.problem import Array, Problem, problem_of, refuse_vibrations
from film_model.scene import Scene

COMPARED = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "contact_duration",
    "rebound_velocity",
)
"""Summary values whose errors are given."""

SEGMENTS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 500)
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
STEPS = (50, 200, 800, 3200, 12800)
HEYOKA_TOLERANCES = (1e-8, 1e-12, 1e-15)

FILM = ("FILM, work-preserving", "FILM, chords")
BATCH = 2048
"""Impacts in a batch, over velocities within 5 % of the scene's."""

SHORTEST, MOST_TIME, MOST_REPEATS = 2e-3, 0.15, 25
"""Of one timing loop, of all loops of a setting, s; and how many loops."""

PACKAGES = ("film-model", "numpy", "scipy", "numba", "scikit-sundae", "heyoka")


class Timing(NamedTuple):
    """Median, and half the distance between the quartiles, of seconds a call."""

    median: float
    spread: float


@dataclass(frozen=True)
class CostRun:
    """One method at one setting. Times in s an impact: alone, called from Python, and in a batch; None: not available.

    force_evaluations: for FILM the number of lines, at whose ends the law is evaluated. errors: relative, by the names
    of `COMPARED`; empty if it gave no answer. outcome: "done", or what the method said.
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
        """The largest of the errors; infinite without an answer."""
        return max(self.errors.values(), default=math.inf)

    def to_json(self) -> dict[str, Any]:
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
    """A scene's work-precision study. reference: values of `COMPARED` in SI, its own relative error, and its method."""

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
        """The Pareto front: runs that no other beats in both error and time, fastest first."""
        timed = [run for run in self.runs if getattr(run, timing) is not None and run.errors]
        best, front = math.inf, []
        for run in sorted(timed, key=lambda run: (getattr(run, timing).median, run.error)):
            if run.error < best:
                best = run.error
                front.append(run)
        return tuple(front)

    def sentence(self, error: float = 1e-4) -> str:
        """What this accuracy costs, beside scipy's best."""
        ours = self.cheapest(error, FILM[0])
        theirs = [self.cheapest(error, f"solve_ivp {method}") for method in ("RK45", "DOP853", "LSODA", "Radau")]
        best = min((run for run in theirs if run is not None), key=lambda run: _median(run.time_single), default=None)
        if not any(run.method == FILM[0] for run in self.runs):
            other = "" if best is None else f"; {best.method} needs {_shown(best.time_single)} for {error:g}"
            return f"{FILM[0]}, was not timed{other}."
        if ours is None:
            return f"{error:g} is not reached with {SEGMENTS[-1]} segments."
        text = f"{error:g} costs {ours.setting} and {_shown(ours.time_single)} here"
        if ours.time_batch is not None:
            text += f" ({_shown(ours.time_batch)} in a batch)"
        return text + (f"; {best.method} needs {_shown(best.time_single)}." if best is not None else ".")

    def beaten(self, errors: Sequence[float] = (1e-3, 1e-4, 1e-6)) -> list[str]:
        """Where another method reaches an error faster than FILM's work-preserving lines, and by how much."""
        found: list[str] = []
        if not any(run.method == FILM[0] for run in self.runs):
            return found
        for timing, where in (("time_single", "one impact"), ("time_batch", "in a batch")):
            for error in errors:
                ours, best = self.cheapest(error, FILM[0], timing), self.cheapest(error, None, timing)
                if best is not None and ours is None:
                    found.append(f"{error:g}, {where}: {best.method} reaches it, {FILM[0]}, does not")
                elif best is not None and best.method not in FILM:
                    ratio = _median(getattr(ours, timing, None)) / getattr(best, timing).median
                    found.append(f"{error:g}, {where}: {best.method} is {ratio:.2g} times as fast")
        return found

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "title": self.scene.title,
            "law": self.law,
            "reference": self.reference,
            "runs": [run.to_json() for run in self.runs],
            "machine": self.machine,
            "summary": self.sentence(),
            "beaten": self.beaten(),
        }


def study(
    scene: Scene, *, methods: Sequence[str] | None = None, progress: Callable[[str], None] | None = None
) -> Study:
    """Error against time for one scene, by every method that is installed, or by those whose names begin as given.

    Timings are of one thread: the median over repeated loops after a warm-up. Errors are against
    extended precision where the law allows it and mpmath is installed, else quadrature (half-space without load) or
    DOP853 near rounding; none of them uses the march, and `reference` states the error of each. The rebound velocity is
    that relative to a free body. The scene's own accuracy does not matter. Raises SimulationError for a contact that a
    load does not let end, a law of another kind of damping than powers, a static stiffness, or a target whose edges
    matter: their reference is missing.
    """
    problem = problem_of(scene)
    refuse_vibrations(problem, "a study")
    if problem.approach <= 0.0:
        raise SimulationError("a study needs an impact: the approach velocity is 0")
    if problem.compliance > 0.0:
        raise SimulationError(f"a study is not to be had for a {scene.target.kind} of a static stiffness")
    try:
        exact, stated = _exact(scene, problem)
    except (ImportError, ValueError, RuntimeError) as error:
        raise SimulationError(f"a study needs a reference, and there is none: {error}") from error
    runs: list[CostRun] = []
    for name, settings in _methods(problem, scene):
        if methods is not None and not any(name.startswith(wanted) for wanted in methods):
            continue
        if name == "quadrature" and stated["method"] == _GAUSS:
            continue  # it would be held against itself
        if progress is not None:
            progress(name)
        runs += [_run(name, setting, make, exact) for setting, make in settings]
    return Study(scene, problem.law.name, stated, tuple(runs), machine())


def machine() -> dict[str, str]:
    """What the timings were made on."""
    found = {"machine": platform.machine(), "system": platform.system(), "python": platform.python_version()}
    found["processor"] = _processor()
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown")
    except OSError:
        return platform.processor() or "unknown"


# ---------------------------------------------------------------- the reference

_GAUSS = "adaptive Gauss-Legendre quadrature"
_EXACT = (*COMPARED[:3], "time_impactor_stops", *COMPARED[3:])


def _exact(scene: Scene, problem: Problem) -> tuple[Array, dict[str, Any]]:
    """Values of conventional.SUMMARY in the law's units, and what is said of them."""
    law, mass, velocity = problem.law, problem.mass, scene.approach_velocity
    impedance = math.inf if problem.gamma == 0.0 else scene.target_impedance
    load = problem.load * problem.scales.force
    # first, as it soon tells of a contact without an end; it knows no damping
    tight = None if law.damped else reference.integrate(law, mass, velocity, impedance, rtol=3e-14, load=load)
    try:
        found, method, error = (
            extended.impact(law, mass, velocity, impedance, load),
            "extrapolation in extended precision",
            1e-15,
        )
    except (ImportError, ValueError):
        if tight is None:
            raise
        if math.isinf(impedance) and load == 0.0:
            found, method, other = reference.quadrature(law, mass, velocity), _GAUSS, tight
        else:
            found, method = tight, "DOP853 in √ξ at rtol 3e-14"
            other = reference.integrate(law, mass, velocity, impedance, rtol=1e-12, load=load)
        error = max(1e-15, *(abs(other[name] / found[name] - 1.0) for name in COMPARED))
    s = problem.scales
    sizes = np.array([s.force, s.length, s.time, s.time, s.time, s.velocity])
    values = {name: found[name] for name in COMPARED}
    stated = {"method": method, "values": values, "error": error}
    return np.array([found[name] for name in _EXACT]) / sizes, stated


# ---------------------------------------------------------------- the methods

Result = tuple[Sequence[float], int | None]
"""Values of conventional.SUMMARY, and force evaluations."""


class Prepared(NamedTuple):
    """A setting ready to run: one impact, and a batch (None: the method has none)."""

    single: Callable[[], Result]
    batch: Callable[[], Any] | None = None


Setting = tuple[str, Callable[[], Prepared]]


def _methods(problem: Problem, scene: Scene) -> Iterator[tuple[str, list[Setting]]]:
    for kind, name in zip((native.WORK_PRESERVING, native.CHORD), FILM, strict=True):
        yield name, [(f"{n} segments", partial(_film, problem, kind, n)) for n in SEGMENTS]
    for method in ("RK45", "DOP853", "LSODA", "Radau"):
        yield (
            f"solve_ivp {method}",
            [(f"rtol {r:g}", partial(_one, problem, conventional.solve_ivp, method, r)) for r in TOLERANCES],
        )
    for method in ("Adams", "BDF"):
        yield (
            f"CVODE {method}",
            [(f"rtol {r:g}", partial(_one, problem, conventional.cvode, method, r)) for r in TOLERANCES],
        )
    yield "heyoka", [(f"tol {r:g}", partial(_heyoka, problem, r)) for r in HEYOKA_TOLERANCES]
    yield "Dormand-Prince, numba", _numba(problem)
    for name, function in (("Newmark", conventional.newmark), ("small increments", conventional.small_increments)):
        yield name, [(f"{n} steps", partial(_one, problem, function, n)) for n in STEPS]
    if problem.gamma == problem.load == problem.damping == 0.0:
        yield "quadrature", [("adaptive", partial(_quadrature, problem, scene))]


def _film(problem: Problem, kind: int, n: int) -> Prepared:
    ratio = unloading_ratio(problem.curve) if kind == native.WORK_PRESERVING else 1
    curve, mesh, start = problem.curve.native, native.mesh(kind, n, ratio * n), problem.start

    def single() -> Result:
        status, s = native.impact(curve, mesh, start)
        if status != native.EVENT:
            raise RuntimeError(f"status {status}")
        times = s.time_of_maximum_indentation, s.time_impactor_stops, s.contact_duration
        return (s.maximum_force, s.maximum_indentation, *times, s.final_velocity), s.lines

    starts: Any = np.zeros(BATCH, native.START_DTYPE)
    for name in native.START_DTYPE.names or ():
        starts[name] = getattr(start, name)
    starts["nu"] *= np.linspace(0.95, 1.05, BATCH)
    return Prepared(single, lambda: native.batch(curve, mesh, starts))


def _one(problem: Problem, function: Callable[..., Sequence[float]], *setting: Any) -> Prepared:
    def single() -> Result:
        impact = _impact(problem)
        return function(*setting, impact), impact.evaluations

    return Prepared(single)


def _impact(problem: Problem) -> conventional.Impact:
    return conventional.impact_of(problem.law, problem.approach, problem.gamma, problem.load, problem.damping)


def _heyoka(problem: Problem, tolerance: float) -> Prepared:
    compiled = conventional.heyoka(tolerance, _impact(problem))
    return Prepared(lambda: (compiled(), None))


def _numba(problem: Problem) -> list[Setting]:
    compiled: list[Any] = []

    def prepare(tolerance: float) -> Prepared:
        from film_model.dormand_prince import compile_rival, scalar_law

        if not compiled:
            compiled.append(compile_rival(scalar_law(problem.law), "root", problem.load))
        rival, out = compiled[0], np.full((BATCH, 6), np.nan)
        one, gamma = np.array([problem.approach]), np.full(BATCH, problem.gamma)
        many = problem.approach * np.linspace(0.95, 1.05, BATCH)

        def single() -> Result:
            evaluations = rival(one, gamma[:1], tolerance, 0.1, out)
            return tuple(out[0].tolist()), int(evaluations)

        return Prepared(single, lambda: rival(many, gamma, tolerance, 0.1, out))

    return [(f"rtol {r:g}", partial(prepare, r)) for r in TOLERANCES]


def _quadrature(problem: Problem, scene: Scene) -> Prepared:
    s = problem.scales
    sizes = (s.force, s.length, s.time, s.time, s.time, s.velocity)

    def single() -> Result:
        found = reference.quadrature(problem.law, problem.mass, scene.approach_velocity)
        return tuple(found[name] / size for name, size in zip(_EXACT, sizes, strict=True)), None

    return Prepared(single)


# ---------------------------------------------------------------- running and timing


def _run(method: str, setting: str, make: Callable[[], Prepared], exact: Any) -> CostRun:
    try:
        prepared = make()
        values, evaluations = prepared.single()
    except Exception as error:  # whatever another's method says is its outcome
        missing = isinstance(error, ImportError)
        said = "not installed" if missing else " ".join(str(error).split()) or type(error).__name__
        return CostRun(method, setting, None, None, None, {}, said[:200])
    off = np.abs(np.array(values) / exact - 1.0)
    errors = {name: float(off[_EXACT.index(name)]) for name in COMPARED}
    if not all(map(math.isfinite, errors.values())):
        return CostRun(method, setting, None, None, evaluations, {}, "no end of contact was found")
    alone = timed(prepared.single)
    together = None
    if prepared.batch is not None:
        whole = timed(prepared.batch)
        together = Timing(whole.median / BATCH, whole.spread / BATCH)
    return CostRun(method, setting, alone, together, evaluations, errors, "done")


def timed(call: Callable[[], object]) -> Timing:
    """Seconds a call: median of loops after a warm-up."""
    call()
    begun = time.perf_counter()
    call()
    once = max(time.perf_counter() - begun, 1e-9)
    calls = max(1, math.ceil(SHORTEST / once))
    repeats = max(3, min(MOST_REPEATS, int(MOST_TIME / (calls * once))))
    found: list[float] = []
    for _ in range(repeats):
        begun = time.perf_counter()
        for _ in range(calls):
            call()
        found.append((time.perf_counter() - begun) / calls)
    lower, _, upper = statistics.quantiles(found, n=4)
    return Timing(statistics.median(found), 0.5 * (upper - lower))


def one_thread() -> None:
    """Keep this process, and the libraries it calls, to one processor, where the system allows it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def _median(timing: Timing | None) -> float:
    return math.inf if timing is None else timing.median


def _shown(timing: Timing | None) -> str:
    from film_model.units import format_si

    return "-" if timing is None else format_si(timing.median, "time", 3)

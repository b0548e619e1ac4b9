"""Check an FMU against the rules of FMI and against the library's results."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_model.base.units import format_si
from film_model.core import native
from film_model.effects.choose import choose
from film_model.scene import Scene
from film_model.solve.accuracy import mesh_for
from film_model.solve.component import DEFAULT_SEGMENTS, ImpactComponent, Outputs
from film_model.solve.history import MOTION, Event
from fmu_wrapper.assumptions import served
from fmu_wrapper.cosimulation import EXCHANGE_SOLVER, run
from fmu_wrapper.instance import Fmu, opened, started
from fmu_wrapper.loading_curve import loading_force
from fmu_wrapper.variables import KINDS, reference

STEPS_TOLERANCE = 1e-12
"""Allowed difference between Co-Simulation and the library, relative to the largest value of a variable."""

MODES_TOLERANCE = 1e-8
"""The same on a vibrating target: later contacts amplify rounding errors, and where a damped contact ends the force
falls to 0 from a value that is 0 to 1e-9 of the largest."""

RATES_TOLERANCE = 1e-6
"""The same of the rate of indentation there: at the end of a contact it changes with the root of the indentation."""

_RATES = ("relative_velocity", "target_velocity")

EXCHANGE_TOLERANCE = 1e-7
"""Allowed relative difference of Model Exchange, with CVODE at a tolerance of `EXCHANGE_SOLVER`."""

JUMP = 1e-6
"""Fraction of a run's time from a jump of the force within which the values that jump with it are not compared."""

_JUMP = ("contact_force", "relative_velocity", "target_velocity")

_SEGMENTS = ("loading_segments", "unloading_segments")


@dataclass(frozen=True)
class Finding:
    """One comparison: its name, the largest difference, the allowed difference, and the place."""

    what: str
    difference: float
    allowed: float
    where: str = ""

    @property
    def good(self) -> bool:
        """Whether the difference is allowed."""
        return self.difference <= self.allowed


@dataclass(frozen=True)
class Report:
    """Result of `check`. problems: messages of the validation; findings: comparisons with the library."""

    path: str
    problems: tuple[str, ...]
    findings: tuple[Finding, ...]

    @property
    def good(self) -> bool:
        """Whether there are no problems and all differences are allowed."""
        return not self.problems and all(finding.good for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        rows = [
            {"what": f.what, "difference": f.difference, "allowed": f.allowed, "where": f.where, "good": f.good}
            for f in self.findings
        ]
        return {"path": self.path, "good": self.good, "problems": list(self.problems), "findings": rows}


def check(path: str | os.PathLike[str], scene: Scene | None = None) -> Report:
    """Validate an FMU of this package (FMPy's rules and the FMI schemas) and compare its results with the library's.

    scene: needed if the law is not in film-model's list, because the FMU contains only its curve.

    >>> fmu_wrapper.check(fmu_wrapper.export(scene, "impact.fmu")).good
    True
    """
    with opened(path) as fmu:
        from fmpy.validation import validate_fmu

        problems = tuple(str(problem) for problem in validate_fmu(str(path)))
        if KINDS[fmu.data.kind] == "contact":
            return Report(str(path), problems, tuple(_compared_contact(fmu)))
        scene = fmu.scene() if scene is None else scene
        stop, version = float(fmu.description.defaultExperiment.stopTime), fmu.version
        start = {name: fmu.data.start[reference(name)] for name in ("initial_gap", *_SEGMENTS)}
        modes = fmu.data.modes.count
    gap, counts = start["initial_gap"], (int(start[_SEGMENTS[0]]), int(start[_SEGMENTS[1]]))
    on = served(scene)
    if modes > 0:
        component = ImpactComponent(on, initial_gap=gap)
        findings = [Finding("vibrations", abs(component.modes - modes), 0.0, f"the library uses {component.modes}")]
    else:
        component = ImpactComponent(on, initial_gap=gap, segments=counts)
        findings = [_compared_segments(on, counts)]
    allowed = STEPS_TOLERANCE if modes == 0 else MODES_TOLERANCE
    for step in (stop / 200.0, stop / 13.7, stop):
        what = f"steps of {format_si(step, 'time', 3)}"
        findings += _compared(what, run(path, step_size=step), component, step, allowed)
    if version == 3:
        step = stop / 20.0
        ds = run(path, mode="events", step_size=step)
        findings += _compared("event mode", ds, component, step, allowed)
    if modes == 0:
        component = ImpactComponent(on, initial_gap=gap, accuracy=EXCHANGE_SOLVER)
        step = stop / 200.0
        ds = run(path, mode="exchange", step_size=step)
        findings += _compared("Model Exchange", ds, component, step, EXCHANGE_TOLERANCE)
    return Report(str(path), problems, tuple(findings))


def _compared_segments(on: Scene, counts: tuple[int, int]) -> Finding:
    """Whether an FMU has the segments that the library needs."""
    least, _ = mesh_for(on, choose(on).problem, None, None, None, fallback=DEFAULT_SEGMENTS)
    short = max(ours - theirs for ours, theirs in zip(least, counts, strict=True))
    return Finding("segments", max(short, 0), 0.0, f"the library uses {least}")


def _compared(what: str, ds: xr.Dataset, component: ImpactComponent, step: float, allowed: float) -> list[Finding]:
    """Findings from a run of the FMU and the library's component, from its beginning, at the same times."""
    component.reset()
    times = ds["t"].values
    touch = -float(times[0])
    results, events = list[Outputs](), list[Event]()
    for time in (times + touch).tolist():
        result = component.step(max(time - component.time, 0.0))
        results.append(result.outputs)
        events += result.events
    events += component.step(1e-6 * max(touch, step)).events  # those after the last point by rounding
    findings: list[Finding] = []
    motion = {name: np.array([getattr(outputs, name) for outputs in results]) for name in MOTION}
    for name, ours in motion.items():
        # the rounding error of a difference of velocities is relative to the larger one
        size = max(float(np.abs(motion[n]).max()) for n in {name, name.replace("relative", "impactor")})
        off = np.abs(ours - ds[name].values) / (size if size > 0.0 else 1.0)
        if name in _JUMP and component.problem.curve.pulls:
            off[_at_jumps(times + touch, events)] = 0.0
        limit = RATES_TOLERANCE if component.modes > 0 and name in _RATES else allowed
        findings.append(Finding(f"{what}: {name}", float(off.max()), limit, f"t = {times[off.argmax()]:.6g} s"))
    known = _reproducible(events, component) if allowed == EXCHANGE_TOLERANCE else len(events)
    return findings + _compared_events(what, ds, events, known, allowed)


def _at_jumps(times: NDArray[np.float64], events: list[Event]) -> NDArray[np.bool_]:
    """Times, but for rounding, at which a law that pulls begins or ends a contact: its force jumps there."""
    jumps = np.array([event.time for event in events if event.name in ("contact_begins", "contact_ends")])
    return (np.abs(times[:, None] - jumps) <= JUMP * times[-1]).any(axis=1)


def _compared_events(what: str, ds: xr.Dataset, events: list[Event], known: int, allowed: float) -> list[Finding]:
    """Findings from the events of a run and those of the library. known: number of the FMU's events to compare."""
    theirs = [native.EVENTS[kind] for kind in ds["event_kind"].values.tolist()][:known]
    ours = [event.name for event in events[: len(theirs)]]
    if theirs != ours:
        difference = f"{', '.join(theirs)}; the library has {', '.join(ours)}"
        return [Finding(f"{what}: events", math.inf, 0.0, difference)]
    touch, span = -float(ds["t"][0]), max(float(ds["t"][-1]), 1e-300)
    worst: dict[str, Finding] = {}
    for at, name, event in zip(ds["event_time"].values.tolist(), theirs, events, strict=False):
        found = Finding(f"{what}: time of {name}", abs(at + touch - event.time) / span, allowed, f"t = {at:.6g} s")
        worst[name] = max(worst.get(name, found), found, key=lambda finding: finding.difference)
    return list(worst.values())


def _reproducible(events: list[Event], component: ImpactComponent) -> int:
    """Number of events before a ball released at zero gap returns there: whether it lifts off depends on rounding."""
    problem, deepest = component.problem, 0.0
    pull = problem.load * problem.scales.force / problem.mass
    for k, event in enumerate(events):
        deepest = max(deepest, event.indentation)
        left = pull * event.indentation + 0.5 * event.relative_velocity**2
        if event.name in ("contact_ends", "reloading_begins") and left <= EXCHANGE_TOLERANCE * pull * deepest:
            return k
    return len(events)


def _compared_contact(fmu: Fmu) -> list[Finding]:
    """Finding from the force element on a path of increasing indentation, and the law's curve."""
    data = fmu.data
    deepest, count, rate = data.nominal[0], 200, data.speed
    path = deepest * np.sin(np.linspace(0.0, 0.5 * np.pi, count))
    largest, worst, where = loading_force(data, deepest, rate), 0.0, ""
    with started(fmu, False, {"indentation": 0.0, "relative_velocity": rate}) as slave:
        for n, depth in enumerate(path.tolist()):
            slave.set("indentation", depth)
            force = slave.get(("contact_force",))["contact_force"]
            off = abs(force - loading_force(data, depth, rate)) / max(largest, 1e-300)
            if off > worst:
                worst, where = off, f"indentation = {depth:.6g} m"
            slave.step(float(n), 1.0)
    return [Finding("contact: force in loading", worst, STEPS_TOLERANCE, where)]

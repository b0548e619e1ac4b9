"""Check an FMU against the rules of FMI and against the library's results."""

from __future__ import annotations

import math
import os
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from film_model.base.arrays import Array, Mask
from film_model.base.errors import DamagedFile
from film_model.base.units import format_si
from film_model.core import native
from film_model.effects.choose import choose
from film_model.oblique.stepped import SlidingOutputs
from film_model.problem.curve import jumps
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.scene.friction_table import FrictionTable
from film_model.solve.accuracy import mesh_for
from film_model.solve.component import ImpactComponent, Outputs
from film_model.solve.history import MOTION, Event
from film_model.solve.relaxed import tolerance_for
from fmu_wrapper import related
from fmu_wrapper.assumptions import served
from fmu_wrapper.comparisons import STEPS_TOLERANCE, Finding, compared_contact, compared_slopes
from fmu_wrapper.cosimulation import EXCHANGE_SOLVER, run
from fmu_wrapper.free_body import as_structure
from fmu_wrapper.instance import Fmu, opened
from fmu_wrapper.resource import Data, component_of, has_exchange, segments_of, vibrations_of
from fmu_wrapper.stepping import ALONG
from fmu_wrapper.variables import KINDS, reference

ALLOWED = {
    # later contacts amplify rounding errors, and where a damped contact ends the force falls to 0 from a value that is
    # 0 to 1e-9 of the largest
    "vibrating": 1e-8,
    # of natural frequencies, over the highest: their rounding depends on the library of linear algebra and on its
    # threads; the motion is compared on the vibrations of the FMU
    "frequencies": 1e-8,
    # the time at which the contact was as wide before is found to 1e-8 and its force corrected for that, so that
    # rounding of the time moves the force by 3e-11
    "viscoelastic": 1e-9,
    # of the rate of indentation on a vibrating target or a static stiffness: at the end of a contact it changes with
    # the root of the indentation, by 1e-6 over a rounding error of 1e-12
    "rates": 1e-5,
    # of Model Exchange, with CVODE at a tolerance of `EXCHANGE_SOLVER`
    "exchange": 1e-7,
    # along the surface in Model Exchange: springs follow in other steps than the component's; with a table of
    # friction, in which coefficients change with the sliding velocity, errors of both are of the order of their steps
    "exchange friction": 2e-5,
    "exchange table": 1e-3,
}
"""Allowed differences, as `STEPS_TOLERANCE`, where that is not reached."""

_RATES = ("relative_velocity", "target_velocity")


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

    def largest(self) -> list[Finding]:
        """The findings that are not good, and of each run the one that comes closest to what is allowed."""
        runs: dict[str, list[Finding]] = {}
        for finding in self.findings:
            runs.setdefault(finding.what.partition(": ")[0], []).append(finding)
        shown = ([one for one in run if not one.good] or [max(run, key=Finding.share)] for run in runs.values())
        return [finding for run in shown for finding in run]

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
            return Report(str(path), problems, tuple(compared_contact(fmu)))
        scene = fmu.scene() if scene is None else scene
        scene = as_structure(scene) if scene.target.free else scene
        experiment, version = fmu.description.defaultExperiment, fmu.version
        stop, usual = float(experiment.stopTime), float(experiment.stepSize)
        stored = _stored_results(fmu)
        on = served(scene)
        component, counts = component_of(on, fmu.data), segments_of(fmu.data)
        gap = fmu.data.start[reference("initial_gap")]
        data, modes, exchange = fmu.data, fmu.data.modes.count, has_exchange(fmu.data)
        tolerance, slopes = fmu.data.relaxation.tolerance, list(compared_slopes(fmu, stop))
    if modes > 0:
        findings = [_compared_vibrations(component, data)]
        component.follow(vibrations_of(data), data.modes.rest, data.modes.tolerance)
    elif tolerance > 0.0:
        findings = [_compared_tolerance(on, tolerance)]
    else:
        findings = [_compared_segments(on, counts)]
    allowed = ALLOWED["vibrating"] if modes > 0 else ALLOWED["viscoelastic"] if tolerance > 0.0 else STEPS_TOLERANCE
    for step in (usual, stop / 13.7, stop):
        what, ds = f"steps of {format_si(step, 'time', 3)}", run(path, step_size=step)
        findings += _compared(what, ds, component, step, allowed)
        if step == usual and stored is not None:
            findings += _compared_stored(ds, stored, component, allowed)
    if version == 3:
        step = stop / 20.0
        ds = run(path, mode="events", step_size=step)
        findings += _compared("event mode", ds, component, step, allowed)
    if exchange:
        component = ImpactComponent(on, initial_gap=gap, accuracy=EXCHANGE_SOLVER)
        step = stop / 200.0
        ds = run(path, mode="exchange", step_size=step)
        findings += _compared("Model Exchange", ds, component, step, ALLOWED["exchange"])
    return Report(str(path), problems, (*findings, *slopes))


def _compared_vibrations(component: ImpactComponent, data: Data) -> Finding:
    """Whether an FMU has the natural frequencies of the library."""
    ours, theirs = component.vibrations, vibrations_of(data)
    if ours is None or ours.count != theirs.count:
        return Finding("vibrations", math.inf, 0.0, f"{theirs.count}; the library uses {component.modes}")
    off = abs(ours.frequency - theirs.frequency) / max(ours.frequency[-1], 1e-300)
    where = f"frequency {off.argmax() + 1} of {ours.count}"
    return Finding("vibrations", float(off.max()), ALLOWED["frequencies"], where)


def _compared_segments(on: Scene, counts: tuple[int, int]) -> Finding:
    """Whether an FMU has the segments that the library needs."""
    least, _ = mesh_for(choose(on).problem, on.solver)
    short = max(ours - theirs for ours, theirs in zip(least, counts, strict=True))
    return Finding("segments", max(short, 0), 0.0, f"the library uses {least}")


def _compared_tolerance(on: Scene, tolerance: float) -> Finding:
    """Whether the steps of viscoelastic bodies in an FMU are as short as the library's."""
    ours = tolerance_for(choose(on).problem, on.solver.accuracy or DEFAULT_ACCURACY)
    return Finding("steps", max(tolerance / ours - 1.0, 0.0), 0.0, f"the library uses a tolerance of {ours:g}")


def _compared(what: str, ds: xr.Dataset, component: ImpactComponent, step: float, allowed: float) -> list[Finding]:
    """Findings from a run of the FMU and the library's component, from its beginning, at the same times."""
    component.reset()
    times = ds["t"].values
    touch = -float(times[0])
    results, along, events = list[Outputs](), list[SlidingOutputs | None](), list[Event]()
    for time in (times + touch).tolist():
        result = component.step(max(time - component.time, 0.0))
        results.append(result.outputs)
        along.append(component.sliding)
        events += result.events
    events += component.step(1e-6 * max(touch, step)).events  # those after the last point by rounding
    motion = {name: np.array([getattr(outputs, name) for outputs in results]) for name in MOTION}
    if component.sliding is not None:
        motion |= {name: np.array([getattr(outputs, name) for outputs in along]) for name in ALONG}
    of_events = [(event.time, event.name) for event in events]
    theirs = {name: ds[name].values for name in motion}
    findings = _compared_motion(what, times + touch, theirs, motion, of_events, component, allowed)
    known = _reproducible(events, component) if allowed == ALLOWED["exchange"] else len(events)
    return findings + _compared_events(what, ds, events, known, allowed)


def _stored_results(fmu: Fmu) -> dict[str, Array] | None:
    """The reference results inside an FMU; None without them. Raises DamagedFile."""
    path = Path(fmu.folder, related.FOLDER, related.RESULTS)
    if not path.is_file():
        return None
    try:
        return related.reference_results(path.read_text("utf-8"))
    except ValueError as error:
        raise DamagedFile(f"{fmu.path}: {error}") from None


def _compared_stored(
    ds: xr.Dataset, stored: dict[str, Array], component: ImpactComponent, allowed: float
) -> list[Finding]:
    """Findings from a run in the steps of the default experiment and the reference results inside the FMU."""
    times = ds["t"].values - float(ds["t"][0])
    rows = np.abs(times[:, None] - stored["time"]).argmin(axis=0)
    theirs = {name: ds[name].values[rows] for name in MOTION}
    kinds = [native.EVENTS[kind] for kind in ds["event_kind"].values.tolist()]
    events = list(zip((ds["event_time"].values - float(ds["t"][0])).tolist(), kinds, strict=True))
    ours = {name: stored[name] for name in MOTION}
    return _compared_motion("reference results", stored["time"], theirs, ours, events, component, allowed)


def _compared_motion(
    what: str,
    times: Array,
    theirs: dict[str, Array],
    motion: dict[str, Array],
    events: list[tuple[float, str]],
    component: ImpactComponent,
    allowed: float,
) -> list[Finding]:
    """Findings from values of the FMU (`theirs`) and of the library (`motion`) at times from the start of the run."""
    findings: list[Finding] = []
    roots = component.modes > 0 or component.problem.given.compliance > 0.0
    jumping = ("stage_changes",) if any(jumps(component.problem.curve.stages)) else ()
    jumping += ("contact_begins", "contact_ends") if component.problem.curve.pulls or component.modes > 0 else ()
    for name, ours in motion.items():
        # the rounding error of a difference of velocities is relative to the larger one
        larger = "impactor_velocity" if name == "relative_velocity" or (roots and name == "target_velocity") else name
        size = max(float(np.abs(motion[n]).max()) for n in {name, larger})
        off = np.abs(ours - theirs[name]) / (size if size > 0.0 else 1.0)
        if name in ("contact_force", *_RATES):
            off[_near(times, events, jumping)] = 0.0
        if name in _RATES and roots:
            off[_near(times, events, native.EVENTS)] = 0.0
        limit = ALLOWED["rates"] if roots and name in _RATES else allowed
        if name in ALONG and allowed == ALLOWED["exchange"]:
            table = isinstance(component.problem.scene.contact.friction, FrictionTable)
            limit = ALLOWED["exchange table" if table else "exchange friction"]
        findings.append(Finding(f"{what}: {name}", float(off.max()), limit, f"t = {times[off.argmax()]:.6g} s"))
    return findings


def _near(times: Array, events: list[tuple[float, str]], kinds: Collection[str]) -> Mask:
    """Times, but for rounding, of such events. The force of some laws jumps where a stage changes, that of a law that
    pulls, and on vibrating targets, where touch is found to a tolerance, where a contact begins or ends; on a static
    stiffness, also of omitted vibrations, the rate of indentation jumps where that of the contact changes."""
    moments = np.array([time for time, name in events if name in kinds])
    return (np.abs(times[:, None] - moments) <= 1e-6 * times[-1]).any(axis=1)


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
        if event.name in ("contact_ends", "reloading_begins") and left <= ALLOWED["exchange"] * pull * deepest:
            return k
    return len(events)

"""An FMU held against the rules of FMI and against the library."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval

from film_model.component import ImpactComponent
from film_model.core import native
from film_model.history import MOTION
from film_model.scene import Scene
from film_model.units import format_si
from fmu_wrapper import resource
from fmu_wrapper.cosimulation import EXCHANGE_SOLVER, Mode, run
from fmu_wrapper.instance import Fmu, opened, started
from fmu_wrapper.variables import KINDS, reference

STEPS_TOLERANCE = 1e-12
"""How well Co-Simulation must agree with the library, relative to the largest value of a variable."""

EXCHANGE_TOLERANCE = 1e-7
"""How well Model Exchange must, with CVODE at a tolerance of `EXCHANGE_SOLVER`."""


@dataclass(frozen=True)
class Finding:
    """One comparison: what, the largest difference found, what is allowed, and where."""

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
    """What `check` found. problems: what validation says; findings: comparisons with the library."""

    path: str
    problems: tuple[str, ...]
    findings: tuple[Finding, ...]

    @property
    def good(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems and all(finding.good for finding in self.findings)

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        rows = [
            {"what": f.what, "difference": f.difference, "allowed": f.allowed, "where": f.where, "good": f.good}
            for f in self.findings
        ]
        return {"path": self.path, "good": self.good, "problems": list(self.problems), "findings": rows}


def check(path: str | os.PathLike[str], scene: Scene | None = None) -> Report:
    """Validate an FMU of this package (FMPy's rules and the FMI schemas) and compare its runs with the library's.

    scene: needed when the law is not one of film-model's, of which the FMU knows the curve only.
    """
    from fmpy.validation import validate_fmu

    with opened(path) as fmu:
        problems = tuple(str(problem) for problem in validate_fmu(str(path)))
        if KINDS[fmu.data.kind] == "contact":
            return Report(str(path), problems, tuple(_compared_contact(fmu)))
        scene = fmu.scene() if scene is None else scene
        stop, version = float(fmu.description.defaultExperiment.stopTime), fmu.version
    findings: list[Finding] = []
    for step in (stop / 200.0, stop / 13.7, stop):
        findings += _compared(f"steps of {format_si(step, 'time', 3)}", path, scene, "steps", step)
    if version == 3:
        findings += _compared("event mode", path, scene, "events", stop / 20.0)
    findings += _compared("Model Exchange", path, scene, "exchange", stop / 200.0)
    return Report(str(path), problems, tuple(findings))


def _compared(what: str, path: str | os.PathLike[str], scene: Scene, mode: Mode, step: float) -> list[Finding]:
    """An FMU's run beside the library's at the same times."""
    ds = run(path, mode=mode, step_size=step)
    with opened(path) as fmu:
        gap = fmu.data.start[reference("initial_gap")]
        counts = tuple(int(fmu.data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
    allowed = EXCHANGE_TOLERANCE if mode == "exchange" else STEPS_TOLERANCE
    component = ImpactComponent(scene, initial_gap=gap, accuracy=EXCHANGE_SOLVER if mode == "exchange" else None)
    if mode != "exchange" and component.segments != counts:
        return [
            Finding(
                f"{what}: segments",
                abs(component.segments[0] - counts[0]),
                0.0,
                f"the library takes {component.segments}",
            )
        ]
    touch = -float(ds["t"][0])
    results = []
    events: list[Any] = []
    for time in (ds["t"].values + touch).tolist():
        result = component.step(max(time - component.time, 0.0))
        results.append(result.outputs)
        events += result.events
    events += component.step(1e-6 * max(touch, step)).events  # those that rounding put behind the last point
    findings: list[Finding] = []
    motion = {name: np.array([getattr(outputs, name) for outputs in results]) for name in MOTION}
    for name, ours in motion.items():
        theirs = ds[name].values
        # a difference of two velocities has the rounding of the larger one
        size = max(float(np.abs(motion[n]).max()) for n in {name, name.replace("relative", "impactor")})
        off = np.abs(ours - theirs) / (size if size > 0.0 else 1.0)
        findings.append(
            Finding(f"{what}: {name}", float(off.max()), allowed, f"t = {ds['t'].values[off.argmax()]:.6g} s")
        )
    known = _certain(events, component) if mode == "exchange" else len(events)
    theirs = [native.EVENTS[kind] for kind in ds["event_kind"].values.tolist()][:known]
    ours = [event.name for event in events[: len(theirs)]]
    if theirs != ours:
        return [
            *findings,
            Finding(f"{what}: events", math.inf, 0.0, f"{', '.join(theirs)}; the library has {', '.join(ours)}"),
        ]
    span = max(float(ds["t"][-1]), 1e-300)
    worst: dict[str, Finding] = {}
    for at, name, event in zip(ds["event_time"].values.tolist(), theirs, events, strict=False):
        found = Finding(f"{what}: time of {name}", abs(at + touch - event.time) / span, allowed, f"t = {at:.6g} s")
        worst[name] = max(worst.get(name, found), found, key=lambda finding: finding.difference)
    return [*findings, *worst.values()]


def _certain(events: list[Any], component: ImpactComponent) -> int:
    """Number of events before the return of a ball laid down: whether it lifts off there is rounding."""
    problem, deepest = component.problem, 0.0
    pull = problem.load * problem.scales.force / problem.mass
    for k, event in enumerate(events):
        deepest = max(deepest, event.indentation)
        left = pull * event.indentation + 0.5 * event.relative_velocity**2
        if event.name in ("contact_ends", "reloading_begins") and left <= EXCHANGE_TOLERANCE * pull * deepest:
            return k
    return len(events)


def _compared_contact(fmu: Fmu) -> list[Finding]:
    """The force element on a path in and out, beside the law's curve."""
    data = fmu.data
    deepest, count, rate = data.nominal[0], 200, data.speed
    path = deepest * np.sin(np.linspace(0.0, 0.5 * np.pi, count))
    largest, worst, where = _law_force(data, deepest, rate), 0.0, ""
    with started(fmu, False, {"indentation": 0.0, "relative_velocity": rate}) as slave:
        for n, depth in enumerate(path.tolist()):
            slave.set("indentation", depth)
            force = slave.get(("contact_force",))["contact_force"]
            off = abs(force - _law_force(data, depth, rate)) / max(largest, 1e-300)
            if off > worst:
                worst, where = off, f"indentation = {depth:.6g} m"
            slave.step(float(n), 1.0)
    return [Finding("contact: force in loading", worst, STEPS_TOLERANCE, where)]


def _law_force(data: resource.Data, indentation: float, rate: float) -> float:
    """Force of the loading curve at an indentation of 0 m or more, with its damping, N."""
    xi, curve = indentation / data.length_scale, data.curve
    stage = sum(curve.stage[k].end < xi for k in range(curve.stages - 1))
    force = native.stage_law(curve, stage, xi)[0] * data.force_scale
    return force + data.damping * _damping(curve, xi) * rate if curve.stage[0].damped else force


def _damping(curve: native.Curve, xi: float) -> float:
    """A damped law's c, over its factor."""
    piece = next(piece for piece in curve.piece if xi <= piece.end)
    c: native.Function = piece.damping
    x = (xi - c.origin) * c.per_span
    if c.form == native.POWER:
        return float(c.constant + c.slope * x + c.coefficient * x**c.exponent)
    return float(chebval(2.0 * (math.sqrt(x) if c.form == native.ROOT_SERIES else x) - 1.0, c.series[: c.terms]))

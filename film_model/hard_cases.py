"""A catalogue of hard cases, each with a sentence on why it is hard, and what becomes of them.

An impact is marched in one shot, in irregular steps, in a batch and on the paper's chords; it must end as documented,
keep its balances, and agree with a reference that shares nothing with the march: extended precision where the
law allows it, quadrature or a tight integration elsewhere. Histories under loads are checked against what must hold.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

import numpy as np

from film_model import conventional, extended, reference
from film_model.accuracy import MOST_SEGMENTS, difference, mesh_of, refine
from film_model.bodies import HalfSpace, Plate, Sphere
from film_model.component import ImpactComponent
from film_model.contact import Contact
from film_model.core import native
from film_model.curve import curve_of
from film_model.errors import SceneError, SimulationError
from film_model.laws import AbstractLaw, BigAlabo, Hertz, Meyer, Power, Stage, Stronge, Unloading
from film_model.problem import Problem
from film_model.scales import scales_of
from film_model.scene import Effects, Scene, Solver
from film_model.solve import simulate

ACCURACY = 1e-11
"""Asked of every impact's mesh."""

ALLOWED = 1e-9
"""Largest relative error of any summary value, unless a case says why it is more."""

SLOWEST = 4.0
"""Zener's λ, about, beyond which extended precision would take more than a few seconds."""

STEPPED = 1e-11
"""How well steps and batches agree with the impact in one shot, of the largest value of each kind."""


@dataclass(frozen=True)
class Finding:
    """What became of a case: its outcome, the worst relative error and what is allowed, the segments a stage, and how
    far the balance of momentum or energy is off, where the case is one impact."""

    outcome: str
    error: float
    allowed: float = ALLOWED
    segments: int | None = None
    balance: float | None = None

    @property
    def good(self) -> bool:
        """Whether the case passed."""
        return self.error <= self.allowed


@dataclass(frozen=True)
class HardCase:
    """One case. run: does it. impact: the law, mass, velocity and impedance, for cases that are one impact."""

    name: str
    why: str
    run: Callable[[], Finding]
    impact: tuple[AbstractLaw, float, float, float] | None = None


@dataclass(frozen=True)
class Report:
    """A case's finding, the time it took [s], and how conventional integrators fare on the same impact."""

    case: HardCase
    finding: Finding
    seconds: float
    others: dict[str, str]

    def to_json(self) -> dict[str, Any]:
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
    """Run a case; with the conventional integrators beside it unless `others` is False."""
    begun = time.perf_counter()
    finding = case.run()
    seconds = time.perf_counter() - begun
    return Report(case, finding, seconds, _others(case) if others and case.impact is not None else {})


def page(reports: Sequence[Report]) -> str:
    """The reports as a Markdown page."""
    names = list(dict.fromkeys(name for r in reports for name in r.others))
    balances = [r.finding.balance for r in reports if r.finding.balance is not None]
    heads = ["case", "outcome", "error", "allowed", "balance", "segments", "time", *names]
    lines = [
        "# Hard cases",
        "",
        "Written by `film-model hard-cases --markdown docs/hard_cases.md`. Errors are relative, of the worst value of",
        "the summary, against extended precision, quadrature or a tight integration of the true law; for steps,",
        f"batches and balances the number stands for {ALLOWED / STEPPED:g} times their own, of which {STEPPED:g}",
        "is allowed.",
        "Times are of the whole examination: meshes, steps, a batch, chords, the reference. Beside each impact stand",
        "conventional integrators at usual settings, on the same law in the same run.",
        "",
        f"{sum(r.finding.good for r in reports)} of {len(reports)} cases are good; the worst balance of momentum or",
        f"energy is {max(balances, default=0.0):.1e}.",
    ]
    why = ""
    for r in reports:
        if r.case.why != why:
            why = r.case.why
            lines += ["", f"## {why[0].upper()}{why[1:]}", "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
        f = r.finding
        balance = "" if f.balance is None else f"{f.balance:.0e}"
        numbers = [f"{f.error:.1e}", f"{f.allowed:.0e}", balance, str(f.segments or ""), f"{r.seconds:.2f} s"]
        cells = [
            r.case.name,
            f.outcome if f.good else f"**{f.outcome}**",
            *numbers,
            *(r.others.get(n, "") for n in names),
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


# ---------------------------------------------------------------- one impact in all ways


def problem_for(
    law: AbstractLaw, mass: float, velocity: float, impedance: float = math.inf, load: float = 0.0
) -> Problem:
    """The dimensionless problem of a law, without a scene's limits. load: external force, N."""
    scales = scales_of(law, max(0.5 * mass * velocity**2, 1e-300), mass)
    gamma = 0.0 if math.isinf(impedance) else scales.force / (impedance * scales.velocity)
    approach = velocity / scales.velocity
    damping = float(law.damping_factor(mass, velocity, scales.length)) * scales.velocity / scales.force
    scene: Any = None  # there is none: nothing asks for its effects
    return Problem(law, curve_of(law), scales, gamma, load / scales.force, approach, 0.0, 1.0, mass, scene, damping)


def examine(
    law: AbstractLaw, mass: float, velocity: float, impedance: float = math.inf, allowed: float = ALLOWED
) -> Finding:
    """One impact without load, marched in every way."""
    problem = problem_for(law, mass, velocity, impedance)
    counts, _ = refine(problem, Solver(accuracy=ACCURACY), [])
    mesh = mesh_of(Solver(accuracy=ACCURACY), counts)
    status, whole = native.impact(problem.curve.native, mesh, problem.start)
    if status != native.EVENT:
        return Finding(f"status {status}", math.inf, allowed, counts[0])
    exact = _exact(problem, velocity, impedance)
    exact.work = whole.work  # which the balance checks
    balance = _balance(problem, whole)
    worst = {
        "against the reference": difference(problem, whole, exact),
        "in steps": _in_steps(problem, mesh, whole) * allowed / STEPPED,
        "in a batch": _in_a_batch(problem, mesh, whole) * allowed / STEPPED,
        "balance": balance * allowed / STEPPED,
    }
    chords = native.mesh(native.CHORD, 60, 60)
    status, rough = native.impact(problem.curve.native, chords, problem.start)
    values = [getattr(rough, name) for name in native.SUMMARY]  # far from exact in a long tail, but there
    if status != native.EVENT or not all(map(math.isfinite, values)) or rough.maximum_force > 2.0 * exact.maximum_force:
        return Finding(f"chords: status {status}", math.inf, allowed, counts[0])
    name = max(worst, key=lambda key: worst[key])
    return Finding(f"separated; worst {name}", worst[name], allowed, counts[0], balance)


def _exact(problem: Problem, velocity: float, impedance: float) -> native.Summary:
    law, mass, s = problem.law, problem.mass, problem.scales
    try:
        if problem.gamma * problem.approach**0.2 > SLOWEST:
            raise ValueError("its tail takes extrapolation too long")
        found = extended.impact(law, mass, velocity, impedance)
    except (ImportError, ValueError):
        found = (
            reference.quadrature(law, mass, velocity)
            if math.isinf(impedance)
            else reference.integrate(law, mass, velocity, impedance, rtol=3e-14)
        )
    made = native.Summary()
    made.maximum_force = found["maximum_force"] / s.force
    made.maximum_indentation = found["maximum_indentation"] / s.length
    for name in ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration"):
        setattr(made, name, found[name] / s.time)
    made.permanent_indentation = found["permanent_indentation"] / s.length
    made.final_velocity = found["rebound_velocity"] / s.velocity
    return made


def _in_steps(problem: Problem, mesh: native.Mesh, whole: native.Summary) -> float:
    """The largest difference of irregular steps to the impact in one shot."""
    chance = random.Random(1)
    state = native.initial_state(problem.curve.native, problem.start)
    stepped = native.Summary()
    stepped.time_impactor_stops = stepped.contact_duration = math.nan
    for _ in range(400):
        left = chance.expovariate(40.0 / whole.contact_duration)
        while True:
            before = state.time
            status = native.step(problem.curve.native, mesh, state, left)
            if status < 0:
                return math.inf
            left = max(left - (state.time - before), 0.0)
            if status != native.EVENT:
                break
            name = native.EVENTS[state.event]
            if name == "maximum_indentation":
                stepped.maximum_indentation, stepped.time_of_maximum_indentation = state.xi, state.time
            elif name == "impactor_stops":
                stepped.time_impactor_stops = state.time
            elif name == "contact_ends":
                stepped.maximum_force, stepped.contact_duration = state.force_peak, state.time
                stepped.permanent_indentation, stepped.final_velocity = state.xi, state.nu
                stepped.work = state.spent
                return difference(problem, stepped, whole)
    return math.inf


def _in_a_batch(problem: Problem, mesh: native.Mesh, whole: native.Summary) -> float:
    starts: Any = np.zeros(11, native.START_DTYPE)
    for name in native.START_DTYPE.names or ():
        starts[name] = getattr(problem.start, name)
    status, found = native.batch(problem.curve.native, mesh, starts)
    if (status != native.EVENT).any():
        return math.inf
    rows = [native.Summary.from_buffer_copy(row.tobytes()) for row in found]
    return max(difference(problem, row, whole) for row in rows)


def _balance(problem: Problem, whole: native.Summary) -> float:
    """Of momentum where the target moves, of energy where it does not; relative."""
    before, after = problem.approach, whole.final_velocity
    if problem.gamma > 0.0:
        return abs(whole.shift / problem.gamma - (before - after)) / (before - after)
    return abs(0.5 * (before**2 - after**2) - whole.work) / (0.5 * before**2)


def _others(case: HardCase) -> dict[str, str]:
    """How conventional integrators fare at usual settings: error and time, or what they say."""
    assert case.impact is not None
    law, mass, velocity, impedance = case.impact
    problem = problem_for(law, mass, velocity, impedance)
    exact = _exact(problem, velocity, impedance)
    names = ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "time_impactor_stops")
    values = np.array([*(getattr(exact, n) for n in names), exact.contact_duration, exact.final_velocity])
    found: dict[str, str] = {}
    methods: dict[str, Callable[[conventional.Impact], Any]] = {
        "solve_ivp RK45, rtol 1e-6": lambda impact: conventional.solve_ivp("RK45", 1e-6, impact),
        "solve_ivp LSODA, rtol 1e-6": lambda impact: conventional.solve_ivp("LSODA", 1e-6, impact),
        "Newmark, 400 steps": lambda impact: conventional.newmark(400, impact),
    }
    import_module("scipy.integrate")  # or the first of the timings below would pay for it
    for name, method in methods.items():
        impact = conventional.impact_of(law, problem.approach, problem.gamma)
        begun = time.perf_counter()
        try:
            with np.errstate(all="ignore"):
                off = float(np.max(np.abs(np.array(method(impact)) / values - 1.0)))
            said = "no end of contact" if math.isnan(off) else f"error {off:.0e}"
        except Exception as error:  # what another's method says is its outcome
            said = " ".join(str(error).split())[:60] or type(error).__name__
        found[name] = f"{said}, {1e3 * (time.perf_counter() - begun):.0f} ms"
    return found


# ---------------------------------------------------------------- the cases

MODULUS, RADIUS, YIELD, MASS = 1.7e11, 0.01, 1e9, 0.06


def _steel() -> BigAlabo:
    return BigAlabo(MODULUS, RADIUS, YIELD)


def _impact(
    name: str,
    why: str,
    law: AbstractLaw,
    mass: float,
    velocity: float,
    impedance: float = math.inf,
    allowed: float = ALLOWED,
) -> HardCase:
    return HardCase(
        name, why, lambda: examine(law, mass, velocity, impedance, allowed), (law, mass, velocity, impedance)
    )


def _scales() -> Iterator[HardCase]:
    why = "quantities a million million times apart must not lose digits: only their ratios may matter"
    for radius in (1e-9, 10.0):
        for velocity in (1e-6, 1e3):
            for modulus in (1e3, 1e12):
                mass = 8000.0 * 4.19 * radius**3
                what = f"radius {radius:g} m, {velocity:g} m/s, modulus {modulus:g} Pa"
                yield_ = modulus / 200.0
                yield _impact(f"Hertz, {what}", why, Hertz(modulus, radius), mass, velocity)
                yield _impact(f"Big-Alabo, {what}", why, BigAlabo(modulus, radius, yield_), mass, velocity)
    for mass in (1e-18, 1e6):
        yield _impact(f"mass {mass:g} kg", why, _steel(), mass, 0.1)


def _zener(
    value: float, law: AbstractLaw | None = None, velocity: float = 0.1
) -> tuple[AbstractLaw, float, float, float]:
    """An impact with Zener's λ."""
    stiffness = 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS)
    impedance = stiffness**0.4 * MASS**0.6 * velocity**0.2 / value
    return law or Hertz(MODULUS, RADIUS), MASS, velocity, impedance


def _impedances() -> Iterator[HardCase]:
    why = "from a target that hardly moves to one whose contact fades out ten thousand times more slowly than it began"
    for value in (1e-9, 1e-5, 0.3, 1.0, 1.5, 2.0, 3.0, 8.0, 20.0, 50.0):
        yield _impact(f"Hertz, λ = {value:g}", why, *_zener(value))
    for value in (1e-6, 0.5, 2.0, 10.0):
        yield _impact(f"Big-Alabo, λ = {value:g}", why, *_zener(value, _steel(), 1.0))


def _coincidences() -> Iterator[HardCase]:
    law = _steel()
    scales = scales_of(law, 1.0, MASS)
    curve = curve_of(law)
    why = "the motion turns where one stage ends: on which side is decided by rounding"
    for k in range(3):
        exact = math.sqrt(2.0 * curve.work(curve.native.stage[k].end)) * scales.velocity
        for what, velocity in (
            ("", exact),
            (" + 1 ulp", math.nextafter(exact, 1e9)),
            (" - 1 ulp", math.nextafter(exact, 0.0)),
        ):
            yield _impact(f"turns at the end of stage {k + 1}{what}", why, law, MASS, velocity)
    why = (
        "critical damping, where the two rates of the motion merge; contact ends, if ever, in the rounding of the force"
    )
    for what, factor in (("", 1.0), (" + 1e-16", 1.0 + 2.3e-16), (" - 1e-16", 1.0 - 1.2e-16), (" + 1e-8", 1.0 + 1e-8)):
        yield HardCase(f"damping ratio 1{what}", why, _damped(factor))
    why = "the force of a stage does not change: the line has no slope"
    yield _impact("constant force", why, Plateau(0.0), 1.0, 0.1)
    yield _impact("constant force, compliant target", why, Plateau(0.0), 1.0, 0.1, 100.0)
    why = "a slope that is almost none, of either sign"
    for slope in (1e-14, -1e-14, 1e-3, -0.02):
        yield _impact(f"slope {slope:g}", why, Plateau(slope), 1.0, 0.1)
        yield _impact(f"slope {slope:g}, compliant target", why, Plateau(slope), 1.0, 0.1, 100.0)
    why = "exponents at the edge of what a power can be"
    for exponent in (1.0, 1.0 + 1e-12, 0.05, 0.5, 10.0, 50.0):
        yield _impact(f"exponent {exponent!r}", why, Meyer(stiffness=_meyer(exponent), exponent=exponent), MASS, 0.1)
    why = "the force jumps up by 1.9 % inside a stage boundary"
    yield _impact("force that jumps", why, BigAlabo(MODULUS, RADIUS, YIELD, "printed"), MASS, 30.0)
    why = "a logarithmic stage, fitted by series, crossed by slow and fast impacts"
    for velocity in (0.04, 0.3, 20.0):
        yield _impact(f"Stronge, {velocity:g} m/s", why, Stronge(MODULUS, RADIUS, YIELD), MASS, velocity)
        yield _impact(f"Stronge, {velocity:g} m/s, plate", why, Stronge(MODULUS, RADIUS, YIELD), MASS, velocity, 3000.0)
    yield HardCase("stage without length", "a law whose second stage ends where it begins", _empty_stage)


def _meyer(exponent: float) -> float:
    """A stiffness with which the impact is about 10 µm deep, whatever the exponent."""
    return 0.5 * MASS * 0.1**2 * (exponent + 1.0) / 1e-5 ** (exponent + 1.0)


def _damped(ratio: float) -> Callable[[], Finding]:
    """A linear contact on a target that damps it critically or nearly so: δ = V t exp(−ω t) as far as 1e-8 goes."""

    def run() -> Finding:
        stiffness, velocity = 1e7, 0.1
        law, omega = Meyer(stiffness=stiffness, exponent=1.0), math.sqrt(stiffness / MASS)
        problem = problem_for(law, MASS, velocity, 0.5 * math.sqrt(stiffness * MASS) / ratio)
        status, found = native.impact(problem.curve.native, native.mesh(native.WORK_PRESERVING, 48, 96), problem.start)
        depth = found.maximum_indentation * problem.scales.length / (velocity / (math.e * omega))
        at = found.time_of_maximum_indentation * problem.scales.time * omega
        outcome = {native.EVENT: "separated", native.ENDLESS: "never separates"}.get(status, f"status {status}")
        error = max(abs(depth - 1.0), abs(at - 1.0)) if status >= 0 else math.inf
        return Finding(outcome, error, 2e-8 if ratio > 1.0 + 1e-9 else ALLOWED, 48)

    return run


@dataclass(frozen=True)
class Plateau(AbstractLaw):
    """Linear up to 1 N at 1 mm, then a slope of its own up to 40 mm; elastic unloading of the first stiffness."""

    slope: float
    name = "plateau"
    summary = "a spring that gives way"
    source = "this catalogue"

    def scales(self, energy: float) -> tuple[float, float]:
        """Millimetre and newton."""
        return 1e-3, 1.0

    def stages(self) -> tuple[Stage, ...]:
        """Two of them."""
        residual = Power(constant=0.0, slope=1.0 - self.slope, origin=1.0)
        return (
            Stage("elastic", 0.0, 1.0, Power(slope=1.0)),
            Stage(
                "plateau", 1.0, 40.0, Power(constant=1.0, slope=self.slope), Unloading(residual=residual, exponent=1.0)
            ),
        )


def _empty_stage() -> Finding:
    class Empty(Plateau):
        def stages(self) -> tuple[Stage, ...]:
            first, second = super().stages()
            return first, replace(second, end=second.begin), replace(second, begin=second.begin)

    try:
        curve_of(Empty(0.0))
    except ValueError as error:
        return Finding(f"refused: {str(error)[:60]}", 0.0)
    return Finding("taken", math.inf)


# ---------------------------------------------------------------- loads, steps and settings


def _ball(velocity: str, plate: str | None = None, **changes: Any) -> Scene:
    target = HalfSpace("mild steel") if plate is None else Plate("mild steel", thickness=plate)
    return Scene(
        Sphere(radius="10 mm", velocity=velocity, material="tungsten carbide"),
        target,
        contact=Contact(law="big-alabo"),
        effects=Effects(gravity=True),
        **changes,
    )


def _laid_down() -> Finding:
    """A ball laid on a plate sinks in under its weight and rests with it."""
    scene = _ball("0 m/s", "20 mm")
    component = ImpactComponent(scene)
    component.step("10 s")
    weight = component.problem.load * component.problem.scales.force
    return Finding(component.phase, abs(component.outputs.contact_force / weight - 1.0))


def _comes_to_rest() -> Finding:
    """Bounces grow shorter without end; the run must end at rest."""
    component = ImpactComponent(_ball("0.3 m/s", "12 mm"))
    bounces = 0
    for _ in range(2000):
        bounces += sum(event.name == "contact_ends" for event in component.step("10 ms").events)
        if component.phase == "resting":
            break
    component.step("100 s")
    weight = component.problem.load * component.problem.scales.force
    error = abs(component.outputs.contact_force / weight - 1.0)
    return Finding(f"{component.phase} after {bounces} bounces", error if component.phase == "resting" else math.inf)


def _force_that(change: str) -> Callable[[], Finding]:
    def run() -> Finding:
        """Whole steps and half steps give the same, with forces that hold, reverse or balance the contact."""
        values: list[Any] = []
        for parts in (1, 2, 7):
            component = ImpactComponent(_ball("0.25 m/s"), accuracy=1e-8)
            for k in range(60):
                force = {"holds": 200.0, "reverses": 900.0 * (-1) ** k, "balances": 0.0}[change]
                if change == "balances":
                    force = component.outputs.contact_force
                for _ in range(parts):
                    outputs = component.step(5e-6 / parts, external_force=force).outputs
            values.append(outputs)  # type: ignore[reportPossiblyUnbound]
        sizes = (1e-5, 0.25, 600.0)
        names = ("indentation", "impactor_velocity", "contact_force")
        error = max(
            abs(getattr(values[0], n) - getattr(v, n)) / size
            for v in values[1:]
            for n, size in zip(names, sizes, strict=True)
        )
        return Finding(values[0].phase, error)

    return run


def _reloads() -> Finding:
    """A thousand partial unloadings and reloadings on one branch neither gain nor lose energy."""
    component = ImpactComponent(_ball("0.25 m/s"), accuracy=1e-8)
    component.step(60e-6)
    force, start = component.outputs.contact_force, component.problem.scales
    count = 0
    for k in range(20_000):
        events = component.step(2e-6, external_force=force + 150.0 * (-1) ** (k // 8)).events
        count += sum(event.name == "reloading_begins" for event in events)
        if count >= 1000:
            break
    permanent = component._state.xi_free * start.length  # pyright: ignore[reportPrivateUsage]
    again = ImpactComponent(component.scene, accuracy=1e-8)
    again.step(60e-6)
    expected = again._state.xi_free * start.length  # pyright: ignore[reportPrivateUsage]
    deeper = component._state.xi_max > again._state.xi_max * (1.0 + 1e-12)  # pyright: ignore[reportPrivateUsage]
    error = 0.0 if deeper else abs(permanent - expected) / expected
    return Finding(f"{count} reloadings", error if count >= 1000 else math.inf)


def _steps_of(size: float, count: int) -> Callable[[], Finding]:
    def run() -> Finding:
        scene = replace(_ball("0.25 m/s"), effects=Effects(gravity=False))
        component, whole = (ImpactComponent(scene, accuracy=1e-8) for _ in range(2))
        for c in (component, whole):
            c.step(3e-5)
        for _ in range(count):
            outputs = component.step(size).outputs
        expected = whole.step(size * count).outputs
        sizes = {"indentation": 1e-5, "impactor_velocity": 0.25, "contact_force": 516.0}
        if abs(expected.indentation) > 1e-3:  # far away
            sizes = {"impactor_velocity": abs(expected.impactor_velocity), "indentation": abs(expected.indentation)}
        error = max(abs(getattr(outputs, n) - getattr(expected, n)) / s for n, s in sizes.items())  # type: ignore[reportPossiblyUnbound]
        return Finding(component.phase, error, 1e-12 if count > 1 else 1e-11)

    return run


def _segments(count: int) -> Callable[[], Finding]:
    def run() -> Finding:
        scene = _ball("0.25 m/s")
        history = simulate(replace(scene, effects=Effects(gravity=False)), segments=count)
        exact = reference.quadrature(history.problem.law, scene.mass, 0.25)
        error = max(abs(history.summary[n] / exact[n] - 1.0) for n in ("maximum_force", "contact_duration"))  # type: ignore[operator]
        allowed = {1: 0.2, 2: 1e-2}.get(count, 1e-11)
        return Finding(history.outcome.value, error, allowed, count)

    return run


def _accuracy(value: float) -> Callable[[], Finding]:
    def run() -> Finding:
        history = simulate(replace(_ball("0.25 m/s"), effects=Effects(gravity=False)), accuracy=value)
        exact = reference.quadrature(history.problem.law, history.scene.mass, 0.25)
        error = max(abs(history.summary[n] / exact[n] - 1.0) for n in ("maximum_force", "contact_duration"))  # type: ignore[operator]
        said = any("cannot be had" in warning for warning in history.warnings)
        if value <= 1e-14 and not said:
            return Finding("did not say that it cannot be had", math.inf)
        outcome = "said that it cannot be had" if said else history.outcome.value
        return Finding(outcome, error, max(value, 1e-11), history.accuracy.segments)

    return run


def _refused(make: Callable[[], object]) -> Callable[[], Finding]:
    def run() -> Finding:
        try:
            make()
        except (SceneError, SimulationError, ValueError) as error:
            return Finding(f"refused: {' '.join(str(error).split())[:60]}", 0.0)
        return Finding("taken", math.inf)

    return run


def _loads() -> Iterator[HardCase]:
    yield HardCase("ball laid down", "no velocity, only a weight: nothing sets a scale for the motion", _laid_down)
    yield HardCase("ball coming to rest", "infinitely many bounces in a finite time", _comes_to_rest)
    for change, why in (
        ("holds", "a force holds the contact shut"),
        ("reverses", "a force of contact size changes its sign at every step"),
        ("balances", "the force equals the contact force at every step: the motion has no acceleration"),
    ):
        yield HardCase(f"external force {change}", why, _force_that(change))
    yield HardCase("a thousand reloadings", "partial unloading and reloading on one branch, a thousand times", _reloads)
    yield HardCase("no velocity and no force", "nothing happens, for ever", _refused(lambda: simulate(_resting())))
    yield HardCase(
        "steps of 1e-18 s", "a step smaller than the rounding of the time it is added to", _steps_of(1e-18, 1000)
    )
    yield HardCase("a step of one year", "a step a million million times the contact", _steps_of(3.15e7, 1))
    yield HardCase("a million steps", "rounding of a million steps must not add up", _steps_of(4e-11, 1_000_000))
    for count in (1, 2, 1_000_000):
        yield HardCase(f"{count} segments", "the coarsest and the finest mesh", _segments(count))
    yield HardCase("accuracy 1e-14", "below what rounding leaves: must say so", _accuracy(1e-14))
    yield HardCase("accuracy 0.1", "next to nothing is asked", _accuracy(0.1))
    for value in (1e-15, 1.0):
        yield HardCase(
            f"accuracy {value:g}", "no accuracy at all", _refused(lambda value=value: Solver(accuracy=value))
        )
    yield HardCase(
        "too many segments", "beyond the core's limit", _refused(lambda: Solver(segments=MOST_SEGMENTS * 1000))
    )
    yield HardCase("velocity that is no number", "not a number", _refused(lambda: _ball("nan m/s")))
    yield HardCase("mass of zero", "no inertia", _refused(lambda: Sphere(radius="1 mm", velocity="1 m/s", mass="0 kg")))


def _resting() -> Scene:
    return replace(_ball("0 m/s"), effects=Effects(gravity=False))


def all_cases() -> tuple[HardCase, ...]:
    """The catalogue."""
    return (*_scales(), *_impedances(), *_coincidences(), *_loads())

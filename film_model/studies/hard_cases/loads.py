"""The cases of loads, steps and settings, checked against properties that must hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from film_model.base.errors import SceneError, SimulationError
from film_model.core.solving import MOST_SEGMENTS
from film_model.scene import Contact, Effects, Scene, Solver, Sphere
from film_model.solve.component import ImpactComponent
from film_model.solve.simulate import simulate_quietly
from film_model.studies import quadrature
from film_model.studies.hard_cases.case import Finding, HardCase
from film_model.targets import HalfSpace, Plate


def ball_on_steel(velocity: str, plate: str | None = None, **changes: Any) -> Scene:
    """A tungsten-carbide ball on a half-space or on a plate of the given thickness, under gravity."""
    target = HalfSpace("mild steel") if plate is None else Plate("mild steel", thickness=plate)
    return Scene(
        Sphere(radius="10 mm", velocity=velocity, material="WC, Big-Alabo 2017"),
        target,
        contact=Contact(law="big-alabo", yield_strength="250 MPa"),
        effects=Effects(gravity=True),
        **changes,
    )


def _laid_down() -> Finding:
    """A ball laid on a plate indents it under its weight; at rest the contact force is the weight."""
    scene = ball_on_steel("0 m/s", "20 mm")
    component = ImpactComponent(scene)
    component.step("10 s")
    weight = component.problem.load * component.problem.scales.force
    return Finding(component.phase, abs(component.outputs.contact_force / weight - 1.0))


def _comes_to_rest() -> Finding:
    """Infinitely many bounces of decreasing height; the run must reach rest."""
    component = ImpactComponent(ball_on_steel("0.3 m/s", "12 mm"))
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
        """Steps, halves and sevenths of them agree, with forces that hold, reverse or balance the contact."""
        values: list[Any] = []
        for parts in (1, 2, 7):
            component = ImpactComponent(ball_on_steel("0.25 m/s"), accuracy=1e-8)
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
    """A thousand partial unloadings and reloadings on one branch change neither its end nor the energy."""
    component = ImpactComponent(ball_on_steel("0.25 m/s"), accuracy=1e-8)
    component.step(60e-6)
    force, start = component.outputs.contact_force, component.problem.scales
    count = 0
    for k in range(20_000):
        events = component.step(2e-6, external_force=force + 150.0 * (-1) ** (k // 8)).events
        count += sum(event.name == "reloading_begins" for event in events)
        if count >= 1000:
            break
    permanent = component._motion.contact.xi_free * start.length  # pyright: ignore[reportPrivateUsage]
    again = ImpactComponent(component.scene, accuracy=1e-8)
    again.step(60e-6)
    expected = again._motion.contact.xi_free * start.length  # pyright: ignore[reportPrivateUsage]
    deeper = component._motion.contact.xi_max > again._motion.contact.xi_max * (1.0 + 1e-12)  # pyright: ignore[reportPrivateUsage]
    error = 0.0 if deeper else abs(permanent - expected) / expected
    return Finding(f"{count} reloadings", error if count >= 1000 else math.inf)


def _steps_of(size: float, count: int) -> Callable[[], Finding]:
    def run() -> Finding:
        scene = replace(ball_on_steel("0.25 m/s"), effects=Effects(gravity=False))
        component, whole = (ImpactComponent(scene, accuracy=1e-8) for _ in range(2))
        for c in (component, whole):
            c.step(3e-5)
        for _ in range(count):
            outputs = component.step(size).outputs
        expected = whole.step(size * count).outputs
        sizes = {"indentation": 1e-5, "impactor_velocity": 0.25, "contact_force": 516.0}
        if abs(expected.indentation) > 1e-3:  # after separation
            sizes = {"impactor_velocity": abs(expected.impactor_velocity), "indentation": abs(expected.indentation)}
        error = max(abs(getattr(outputs, n) - getattr(expected, n)) / s for n, s in sizes.items())  # type: ignore[reportPossiblyUnbound]
        return Finding(component.phase, error, 1e-12 if count > 1 else 1e-11)

    return run


def _segments(count: int) -> Callable[[], Finding]:
    def run() -> Finding:
        scene = ball_on_steel("0.25 m/s")
        history = simulate_quietly(replace(scene, effects=Effects(gravity=False)), segments=count)
        exact = quadrature.quadrature(history.problem.law, scene.mass, 0.25)
        error = max(abs(history.summary[n] / exact[n] - 1.0) for n in ("maximum_force", "contact_duration"))  # type: ignore[operator]
        allowed = {1: 0.2, 2: 1e-2}.get(count, 1e-11)
        return Finding(history.outcome.value, error, allowed, count)

    return run


def _accuracy(value: float) -> Callable[[], Finding]:
    def run() -> Finding:
        history = simulate_quietly(replace(ball_on_steel("0.25 m/s"), effects=Effects(gravity=False)), accuracy=value)
        exact = quadrature.quadrature(history.problem.law, history.scene.mass, 0.25)
        error = max(abs(history.summary[n] / exact[n] - 1.0) for n in ("maximum_force", "contact_duration"))  # type: ignore[operator]
        said = any(f"accuracy {value:g}" in warning for warning in history.warnings)
        if value <= 1e-14 and not said:
            return Finding("no warning that the accuracy is not reached", math.inf)
        outcome = "warns that the accuracy is not reached" if said else history.outcome.value
        return Finding(outcome, error, max(value, 1e-11), history.accuracy.segments)

    return run


def rejected(make: Callable[[], object]) -> Callable[[], Finding]:
    """An examination that passes if `make` is refused with a message."""

    def run() -> Finding:
        try:
            make()
        except (SceneError, SimulationError, ValueError) as error:
            return Finding(f"rejected: {' '.join(str(error).split())[:60]}", 0.0)
        return Finding("accepted", math.inf)

    return run


def loads() -> Iterator[HardCase]:
    """Weights, forces, reloading, step sizes, settings and invalid values."""
    yield HardCase("ball laid down", "no velocity, only a weight: the motion has no velocity scale", _laid_down)
    yield HardCase("ball coming to rest", "infinitely many bounces in a finite time", _comes_to_rest)
    for change, why in (
        ("holds", "a force keeps the contact closed"),
        ("reverses", "a force of contact size changes its sign at every step"),
        ("balances", "the force equals the contact force at every step: the motion has no acceleration"),
    ):
        yield HardCase(f"external force {change}", why, _force_that(change))
    yield HardCase("a thousand reloadings", "partial unloading and reloading on one branch, a thousand times", _reloads)
    resting = replace(ball_on_steel("0 m/s"), effects=Effects(gravity=False))
    still = rejected(lambda: simulate_quietly(resting))
    yield HardCase("no velocity and no force", "there is no motion to simulate", still)
    yield HardCase(
        "steps of 1e-18 s", "steps smaller than one ulp of the time they are added to", _steps_of(1e-18, 1000)
    )
    yield HardCase("a step of one year", "a step 1e12 times as long as the contact", _steps_of(3.15e7, 1))
    yield HardCase(
        "a million steps", "rounding errors of a million steps must not accumulate", _steps_of(4e-11, 1_000_000)
    )
    for count in (1, 2, 1_000_000):
        yield HardCase(f"{count} segments", "the coarsest and the finest mesh", _segments(count))
    yield HardCase("accuracy 1e-14", "below the rounding error: must warn", _accuracy(1e-14))
    yield HardCase("accuracy 0.1", "a very coarse accuracy", _accuracy(0.1))
    for value in (1e-15, 1.0):
        yield HardCase(
            f"accuracy {value:g}",
            "an accuracy outside the range",
            rejected(lambda value=value: Solver(accuracy=value)),
        )
    yield HardCase(
        "too many segments", "more than the core supports", rejected(lambda: Solver(segments=MOST_SEGMENTS * 1000))
    )
    yield HardCase("velocity that is no number", "not a number", rejected(lambda: ball_on_steel("nan m/s")))
    yield HardCase("mass of zero", "no inertia", rejected(lambda: Sphere(radius="1 mm", velocity="1 m/s", mass="0 kg")))

"""The cases that are one impact: extreme scales, impedances, and coincidences."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from film_model.core import native
from film_model.laws import AbstractLaw, BigAlabo, Hertz, Meyer, Power, Stage, Stronge, Unloading
from film_model.problem.curve import curve_of
from film_model.problem.scales import scales_of
from film_model.studies.hard_cases.case import ALLOWED, Finding, HardCase
from film_model.studies.hard_cases.single_impact import examine, problem_for

MODULUS, RADIUS, YIELD, MASS = 1.7e11, 0.01, 1e9, 0.06


def _steel() -> BigAlabo:
    return BigAlabo(MODULUS, RADIUS, YIELD)


def single(
    name: str,
    why: str,
    law: AbstractLaw,
    mass: float,
    velocity: float,
    impedance: float = math.inf,
    allowed: float = ALLOWED,
) -> HardCase:
    """The case of a single impact."""
    return HardCase(
        name, why, lambda: examine(law, mass, velocity, impedance, allowed), (law, mass, velocity, impedance)
    )


def scales() -> Iterator[HardCase]:
    """Extreme radii, velocities, moduli and masses."""
    why = "quantities that differ by twelve orders of magnitude must not lose digits"
    for radius in (1e-9, 10.0):
        for velocity in (1e-6, 1e3):
            for modulus in (1e3, 1e12):
                mass = 8000.0 * 4.19 * radius**3
                what = f"radius {radius:g} m, {velocity:g} m/s, modulus {modulus:g} Pa"
                yield_ = modulus / 200.0
                yield single(f"Hertz, {what}", why, Hertz(modulus, radius), mass, velocity)
                yield single(f"Big-Alabo, {what}", why, BigAlabo(modulus, radius, yield_), mass, velocity)
    for mass in (1e-18, 1e6):
        yield single(f"mass {mass:g} kg", why, _steel(), mass, 0.1)


def _zener(
    value: float, law: AbstractLaw | None = None, velocity: float = 0.1
) -> tuple[AbstractLaw, float, float, float]:
    """An impact with Zener's λ."""
    stiffness = 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS)
    impedance = stiffness**0.4 * MASS**0.6 * velocity**0.2 / value
    return law or Hertz(MODULUS, RADIUS), MASS, velocity, impedance


def impedances() -> Iterator[HardCase]:
    """Targets from nearly rigid to so compliant that contact ends slowly."""
    why = "from a nearly rigid target to one on which contact ends ten thousand times more slowly than it begins"
    for value in (1e-9, 1e-5, 0.3, 1.0, 1.5, 2.0, 3.0, 8.0, 20.0, 50.0):
        yield single(f"Hertz, λ = {value:g}", why, *_zener(value))
    for value in (1e-6, 0.5, 2.0, 10.0):
        yield single(f"Big-Alabo, λ = {value:g}", why, *_zener(value, _steel(), 1.0))


def coincidences() -> Iterator[HardCase]:
    """Turns at stage ends, critical damping, constant forces, extreme exponents, jumps."""
    law = _steel()
    scales = scales_of(law, 1.0, MASS)
    curve = curve_of(law)
    why = "the motion turns at the end of a stage; rounding decides in which stage"
    for k in range(3):
        exact = math.sqrt(2.0 * curve.work(curve.native.stage[k].end)) * scales.velocity
        for what, velocity in (
            ("", exact),
            (" + 1 ulp", math.nextafter(exact, 1e9)),
            (" - 1 ulp", math.nextafter(exact, 0.0)),
        ):
            yield single(f"turns at the end of stage {k + 1}{what}", why, law, MASS, velocity)
    why = "critical damping: both rates of the motion are equal, and whether contact ends depends on rounding"
    for what, factor in (("", 1.0), (" + 1e-16", 1.0 + 2.3e-16), (" - 1e-16", 1.0 - 1.2e-16), (" + 1e-8", 1.0 + 1e-8)):
        yield HardCase(f"damping ratio 1{what}", why, _damped(factor))
    why = "the force of a stage is constant: the slope of its lines is 0"
    yield single("constant force", why, Plateau(0.0), 1.0, 0.1)
    yield single("constant force, compliant target", why, Plateau(0.0), 1.0, 0.1, 100.0)
    why = "slopes near 0, of either sign"
    for slope in (1e-14, -1e-14, 1e-3, -0.02):
        yield single(f"slope {slope:g}", why, Plateau(slope), 1.0, 0.1)
        yield single(f"slope {slope:g}, compliant target", why, Plateau(slope), 1.0, 0.1, 100.0)
    why = "exponents at the limits of what a power law supports"
    for exponent in (1.0, 1.0 + 1e-12, 0.05, 0.5, 10.0, 50.0):
        yield single(f"exponent {exponent!r}", why, Meyer(stiffness=_meyer(exponent), exponent=exponent), MASS, 0.1)
    why = "the force jumps up by 1.9 % at a stage boundary"
    yield single("force that jumps", why, BigAlabo(MODULUS, RADIUS, YIELD, "printed"), MASS, 30.0)
    why = "a logarithmic stage, approximated by series, for slow and fast impacts"
    for velocity in (0.04, 0.3, 20.0):
        yield single(f"Stronge, {velocity:g} m/s", why, Stronge(MODULUS, RADIUS, YIELD), MASS, velocity)
        yield single(f"Stronge, {velocity:g} m/s, plate", why, Stronge(MODULUS, RADIUS, YIELD), MASS, velocity, 3000.0)
    yield HardCase("stage without length", "a law whose second stage has no length", _empty_stage)


def _meyer(exponent: float) -> float:
    """A stiffness for which the maximum indentation is about 10 µm for any exponent."""
    return 0.5 * MASS * 0.1**2 * (exponent + 1.0) / 1e-5 ** (exponent + 1.0)


def _damped(ratio: float) -> Callable[[], Finding]:
    """A linear contact on a target with critical damping or nearly so: δ = V t exp(−ω t) to within 1e-8."""

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
    """Linear up to 1 N at 1 mm, then of another slope up to 40 mm; unloads with the initial stiffness."""

    slope: float
    name = "plateau"
    summary = "a spring with a plateau"
    source = "this catalogue"

    def scales(self, energy: float) -> tuple[float, float]:
        """Millimetre and newton."""
        return 1e-3, 1.0

    def stages(self) -> tuple[Stage, ...]:
        """Elastic and plateau."""
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
        return Finding(f"rejected: {str(error)[:60]}", 0.0)
    return Finding("accepted", math.inf)

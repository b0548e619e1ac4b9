"""The impacts that every method computes, their exact summaries, and the laws as plain scalar functions.

All methods work in the law's units: indentation δ_s, force F_s, time t_s = √(m δ_s/F_s), velocity δ_s/t_s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from film_model.laws import AbstractLaw, BigAlabo, Hertz, Power, Stronge
from film_model.laws.stronge import FULLY_PLASTIC_PRESSURE
from film_model.laws.yielding import YIELD_PRESSURE_RATIO
from film_model.studies import quadrature
from film_model.studies.dormand_prince import ScalarLaw
from film_model.studies.impact_ode import INTEGRATED_VALUES
from film_model.targets.plate_waves import paper_plate_impedance

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """Impacts of one law: velocity and impedance of each, in the law's units (nu; gamma, 0 for a half-space)."""

    name: str
    law: AbstractLaw
    scalar: ScalarLaw
    mass: float
    velocity: Array
    impedance: Array

    def scales(self) -> tuple[float, float, float, float]:
        """δ_s, F_s, t_s and v_s; for a law without its own, those of the median impact energy."""
        length, force = self.law.scales(0.5 * self.mass * float(np.median(self.velocity)) ** 2)
        time = math.sqrt(self.mass * length / force)
        return length, force, time, length / time

    @property
    def nu(self) -> Array:
        return self.velocity / self.scales()[3]

    @property
    def gamma(self) -> Array:
        _, force, _, speed = self.scales()
        return force / (self.impedance * speed)

    def spread(self, count: int) -> Case:
        """`count` impacts spread over this case's; including the first and the last."""
        picked = np.linspace(0, self.velocity.size - 1, count).round().astype(int)
        return Case(self.name, self.law, self.scalar, self.mass, self.velocity[picked], self.impedance[picked])

    def exact(self) -> Array:
        """(impacts, 6) values of INTEGRATED_VALUES in the law's units, from quadrature or a tight integration."""
        length, force, time, speed = self.scales()
        rows = []
        for velocity, impedance in zip(self.velocity, self.impedance, strict=True):
            still = math.isinf(impedance)
            found = (
                quadrature.quadrature(self.law, self.mass, velocity)
                if still
                else quadrature.integrate(self.law, self.mass, velocity, impedance, rtol=3e-14)
            )
            rows.append([found[name] for name in INTEGRATED_VALUES])
        return np.array(rows) / np.array([force, length, time, time, time, speed])


def worst_error(found: Array, exact: Array) -> float:
    """Largest relative error of any value of any impact; infinite if one is missing."""
    with np.errstate(invalid="ignore"):
        error = float(np.max(np.abs(found / exact - 1.0)))
    return error if math.isfinite(error) else math.inf


def all_cases(count: int) -> tuple[Case, ...]:
    """The five cases, `count` impacts each."""
    modulus = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)
    ball = (modulus, 0.010, 1.0e9)
    fixed = np.full(count, math.inf)
    slow = np.geomspace(0.05, 2.0, count)
    plate = paper_plate_impedance(4.132, 154.9, 4.76, 91.4, 8.97)
    hertz, mass, velocity = Hertz(9.72e9, 6.35e-3), 8.3e-3, 3.0
    stiffness = 4 / 3 * hertz.effective_modulus * math.sqrt(hertz.radius)
    clock = (mass / (stiffness * math.sqrt(velocity))) ** 0.4  # λ = m/(Z T), T = (m/(K √V_0))^(2/5)
    zener = np.geomspace(0.05, 3.0, count)
    return (
        Case("Big-Alabo, half-space, 0.05-2 m/s", BigAlabo(*ball), _big_alabo(), 0.06074, slow, fixed),
        Case("Stronge, half-space, 0.05-2 m/s", Stronge(*ball), _stronge(), 0.06074, slow, fixed),
        Case("Big-Alabo, plate, 0.05-2 m/s", BigAlabo(*ball), _big_alabo(), 0.06074, slow, np.full(count, 2500.0)),
        Case("Hertz, plate, 1-5 m/s", hertz, _hertz(), mass, np.geomspace(1.0, 5.0, count), np.full(count, plate)),
        Case("Hertz, plates, λ 0.05-3", hertz, _hertz(), mass, np.full(count, velocity), mass / (zener * clock)),
    )


def _hertz() -> ScalarLaw:
    return ScalarLaw((math.inf,), lambda k, x: x * math.sqrt(x), lambda k, x, f: 0.0)


def _big_alabo() -> ScalarLaw:
    stages = BigAlabo(1.0, 1.0, 1.0).stages()
    powers = [stage.force for stage in stages]
    assert all(isinstance(power, Power) for power in powers)
    (_, first, second, third), ends = powers, tuple(stage.end for stage in stages)
    yielded, transition, plastic = ends[0], ends[1], ends[2]
    width, spread = transition - yielded, 0.8 / (plastic - transition)
    f_transition, k_transition = second.constant, second.slope
    f_plastic, k_plastic, f_yield = third.constant, third.slope, first.constant

    def force(k: int, x: float) -> float:
        if k == 0:
            return x * math.sqrt(x)
        if k == 1:
            z = max(x - yielded, 0.0)
            return f_yield + z * math.sqrt(z)
        if k == 2:
            return f_transition + k_transition * (x - transition)
        return f_plastic + k_plastic * (x - plastic)

    def free(k: int, x: float, f: float) -> float:
        if k == 0:
            return 0.0
        if k == 1:
            ratio = 1.0 + ((x - yielded) / width) ** 1.5
        elif k == 2:
            ratio = 2.0 + spread * (x - transition)
        else:
            ratio = 2.8
        return x - (f / math.sqrt(ratio)) ** (2.0 / 3.0)

    return ScalarLaw(ends, force, free)


def _stronge() -> ScalarLaw:
    ends = tuple(stage.end for stage in Stronge(1.0, 1.0, 1.0).stages())
    pressure = FULLY_PLASTIC_PRESSURE / YIELD_PRESSURE_RATIO

    def force(k: int, x: float) -> float:
        if k == 0:
            return x * math.sqrt(x)
        z = 2.0 * x - 1.0
        return z * (1.0 + math.log(z) / 3.3) if k == 1 else pressure * z

    def free(k: int, x: float, f: float) -> float:
        return 0.0 if k == 0 else x - (f / math.sqrt(2.0 * x - 1.0)) ** (2.0 / 3.0)

    return ScalarLaw(ends, force, free)

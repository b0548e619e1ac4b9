"""Drag of the air on a ball that falls from `drop_height`, whose velocity √(2 g h) leaves it out."""

from __future__ import annotations

import math

from film_model.base.units import format_si
from film_model.effects.case import Case, Rule
from film_model.effects.effect import Effect
from film_model.scene import STANDARD_GRAVITY

AIR_DENSITY, AIR_VISCOSITY = 1.204, 1.813e-5
"""Of air at 20 °C and 1013 hPa, kg/m³ and Pa s."""

NEWTON = 0.44
"""Drag coefficient of a sphere from a Reynolds number of 1000 up to 200,000."""


def air_drag(case: Case, rule: Rule) -> Effect:
    """Drag of the air on a ball that falls from drop_height.

        v² = v_t² (1 − exp(−2 g h/v_t²)),  v_t² = 2 m g/(ρ C_d π R²)
        C_d = (24/Re) (1 + 0.15 Re^0.687),  at least 0.44    smooth sphere in air at 20 °C (Schiller & Naumann 1933)

    The change is that of the impact energy, against the scene's velocity √(2 g h).
    """
    ball, height = case.scene.impactor, case.scene.impactor.drop_height
    if height is None:
        return rule.absent("the velocity at the impact is given")
    final = terminal_velocity(case.scene.mass, ball.radius)
    value = 2.0 * STANDARD_GRAVITY * height / final**2
    slowed = math.sqrt(-math.expm1(-value) / value)
    why = f"a sphere falls through air at {format_si(final, 'velocity', 2)} at most"
    reached, given = (format_si(speed, "velocity", 2) for speed in (slowed * ball.path_speed, ball.path_speed))
    if reached != given:
        why += f", and from this height reaches {reached}, not {given}: give the velocity"
    return rule.sized(case.tolerance, value, None, 1.0 - slowed**2, why)


def terminal_velocity(mass: float, radius: float) -> float:
    """Velocity at which the drag of air holds the weight of a sphere, m/s."""
    found = math.sqrt(2.0 * mass * STANDARD_GRAVITY / (AIR_DENSITY * NEWTON * math.pi * radius**2))
    weighed = found**2 * NEWTON
    for _ in range(60):  # each halves the error or better, since C_d falls at most as 1/Re
        reynolds = 2.0 * AIR_DENSITY * radius * found / AIR_VISCOSITY
        found = math.sqrt(found * math.sqrt(weighed / _drag_coefficient(reynolds)))
    return found


def _drag_coefficient(reynolds: float) -> float:
    return max(24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687), NEWTON)

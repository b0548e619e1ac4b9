"""How the scales and the damping of a law follow its parameters: as powers, and by a series in the restitution."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from film_model.base.arrays import Array
from film_model.laws.law import AbstractLaw, law_fields
from film_model.problem.curve import curve_of
from film_model.problem.families import EDGES, Page, page_between
from film_model.problem.problem import Problem
from film_model.problem.series import coefficients
from fmu_wrapper.layout import OF_DAMPING, RESTITUTION_TERMS, SCALING
from fmu_wrapper.variables import LEAST_RESTITUTION

AROUND = 4.0
"""Such an FMU serves shapes from a fourth to four times that of the export."""
SMALLER = 0.5

_REFERENCE = 0.5
"""Restitution at which the powers of the damping factor are probed: at 1 it is 0."""
_TRIED = (0.011, 0.07, 0.4, 0.83, 0.97, 0.999)

_PROBES = (2.0, 5.0)
"""Factors on a parameter: if both give the same exponent, the scale is a power of it."""


def own_page(problem: Problem) -> Page | None:
    """The curves of shapes within `AROUND` of the problem's law, if it has a family and they are exact enough."""
    law = problem.law
    if problem.curve.page is None:
        return None
    low, high = max(law.shape / AROUND, float(EDGES[0])), min(law.shape * AROUND, float(EDGES[-1]))
    page = page_between(law.of_shape(1e-3), low, high)
    return page if page.fit_error < 1e-9 else None


def field_of(law: AbstractLaw, name: str) -> str:
    """The field of a law that a parameter sets; the unit of a power law's stiffness depends on its exponent."""
    parameter = getattr(type(law), "parameters", {}).get("stiffness")
    power_law = parameter is not None and parameter.dimension == "meyer_stiffness"
    if name in ("stiffness", "power_stiffness"):
        return "stiffness" if power_law == (name == "power_stiffness") else ""
    return name


def powers_of(law: AbstractLaw, name: str, problem: Problem) -> tuple[float, float] | None:
    """Exponents of a law's parameter in the law's length and force scales.

    None if the law has no such parameter, if its dimensionless stages depend on the parameter (the exported curve would
    become wrong), or if the scales are not powers of it.
    """
    field = field_of(law, name)
    value = getattr(law, field, None)
    if field not in law_fields(type(law)) or value is None:
        return None
    shaped = name in law.shaped_by and own_page(problem) is not None
    energy = 0.5 * problem.mass * max((problem.approach * problem.scales.velocity) ** 2, 1e-300)
    base = law.scales(energy)
    found: list[tuple[float, float]] = []
    for factor in (SMALLER, SMALLER**2) if shaped and name == "yield_strength" else _PROBES:
        other: AbstractLaw = replace(law, **{field: value * factor})  # type: ignore[type-var]
        if not shaped and bytes(curve_of(other).native) != bytes(curve_of(law).native):
            return None
        length, force = (math.log(b / a) / math.log(factor) for a, b in zip(base, other.scales(energy), strict=True))
        found.append((rational(length), rational(force)))
    return found[0] if np.allclose(*found, rtol=0.0, atol=1e-12) else None


def damping_power(law: AbstractLaw, name: str, problem: Problem) -> float | None:
    """Exponent of a parameter in the damping factor; 0 if the law has no damping or no such parameter.

    None if the damping factor is not a power of the parameter: then the FMU does not have the parameter.
    """
    law = with_restitution(law, _REFERENCE)
    base = damping_factor(law, problem)
    if name in OF_DAMPING and getattr(law, name, None) is None:
        return 0.0
    if base == 0.0 or (name in SCALING and powers_of(law, name, problem) is None):
        return 0.0
    found: list[float] = []
    for factor in _PROBES:
        other, length = law, 1.0
        if name in OF_DAMPING:
            other = replace(law, **{name: getattr(law, name) * factor})  # type: ignore[type-var]
        if name in SCALING:
            field = field_of(law, name)
            other = replace(law, **{field: getattr(law, field) * factor})  # type: ignore[type-var]
            length = other.scales(1.0)[0] / law.scales(1.0)[0]
        mass, velocity = (factor if name == one else 1.0 for one in ("mass", "initial_velocity"))
        ratio = damping_factor(other, problem, mass, velocity, length) / base
        found.append(rational(math.log(ratio) / math.log(factor)) if ratio > 0.0 else math.nan)
    return found[0] if found[0] == found[1] else None


def damping_factor(
    law: AbstractLaw, problem: Problem, mass: float = 1.0, velocity: float = 1.0, length: float = 1.0
) -> float:
    """Damping factor, N s/m, for multiples of the problem's mass, velocity and length."""
    speed = problem.scene.approach_velocity
    return float(law.damping_factor(mass * problem.mass, velocity * speed, length * problem.scales.length))


def with_restitution(law: AbstractLaw, restitution: float) -> AbstractLaw:
    """The law with another restitution; the law itself if none is given for it."""
    return law if getattr(law, "restitution", None) is None else replace(law, restitution=restitution)  # type: ignore[type-var]


def restitution_series(law: AbstractLaw, problem: Problem) -> Array | None:
    """c_k of the damping factor [N s/m] over the restitution e: (1 − e) exp(Σ c_k T_k(2 ln e/ln e_0 − 1)).

    e_0 = LEAST_RESTITUTION. The factor of a law whose contact ends at zero force is analytic in ln e, and proportional
    to 1 − e near 1. None if the law has no restitution or a smaller one, if more than its damping factor depends on it,
    or if the series is not exact.
    """
    own = getattr(law, "restitution", None) if law.damped and "restitution" in law_fields(type(law)) else None
    if own is None or own < LEAST_RESTITUTION:
        return None

    def factor(restitution: float) -> float:
        return damping_factor(with_restitution(law, restitution), problem)

    for one in (with_restitution(law, _REFERENCE), with_restitution(law, _TRIED[-1])):
        if one.scales(1.0) != law.scales(1.0) or bytes(curve_of(one).native) != bytes(curve_of(law).native):
            return None
    widest = math.log(LEAST_RESTITUTION)
    at = np.exp(widest * 0.5 * (1.0 + np.polynomial.chebyshev.chebpts1(RESTITUTION_TERMS))).tolist()
    values = [factor(e) / (1.0 - e) for e in at]
    if not all(value > 0.0 for value in values):
        return None
    series = coefficients(np.log(values))
    for e in _TRIED:
        summed = np.polynomial.chebyshev.chebval(2.0 * math.log(e) / widest - 1.0, series)
        if not abs((1.0 - e) * math.exp(summed) - factor(e)) <= 1e-11 * factor(e):
            return None
    return series


def exponent_is_free(law: AbstractLaw) -> bool:
    """Whether a law's force is K δ^q in all its stages, and nothing else in them depends on the field `exponent` q.

    Then the FMU may change q: its curve has another exponent, and its force scale is K δ_s^q with the same δ_s.
    """
    if "exponent" not in law_fields(type(law)):
        return False
    q, own = float(getattr(law, "exponent", 0.0)), curve_of(law).native
    forces = [own.piece[k].force for k in range(own.pieces)]
    if any(force.constant or force.slope or force.square for force in forces):
        return False
    for other in (replace(law, exponent=part * q) for part in (0.9, 0.8)):  # type: ignore[type-var]
        made, scales = curve_of(other).native, [one.scales(1.0) for one in (law, other)]
        changed = type(own).from_buffer_copy(own)
        for k in range(own.pieces):
            changed.piece[k].work_at_begin = made.piece[k].work_at_begin
            if own.piece[k].force.coefficient:
                changed.piece[k].force.exponent = other.exponent  # type: ignore[attr-defined]
        stiffness = [force / length**power for (length, force), power in zip(scales, (q, other.exponent), strict=True)]  # type: ignore[attr-defined]
        same = math.isclose(*stiffness, rel_tol=1e-12) and (own.pieces == 1 or scales[0][0] == scales[1][0])
        if not same or bytes(changed) != bytes(made):
            return False
    return True


def rational(power: float) -> float:
    """An exponent rounded to a multiple of 1/60 if it is within 1e-12 of it, which removes rounding errors."""
    near = round(power * 60.0) / 60.0
    return near if abs(near - power) < 1e-12 else power

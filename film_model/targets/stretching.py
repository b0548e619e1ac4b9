"""Membrane forces of a bent plate or beam whose edges cannot move inwards, by Berger's energy in one term."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from film_model.targets.line_functions import line
from film_model.targets.target import NO_THICKNESS, Estimate, Impact, missing, no_effect

NOT_HELD = "no opposite edges are held, so the structure bends without stretching"

SLIDING = {"simply supported": 0.12, "clamped": 0.4}
"""Membrane energy of a square plate whose edges move inwards freely, over Berger's: by von Kármán's equations, under a
force at the centre, for deflections up to two thicknesses. Of immovable edges it is 0.6 and 0.9 of Berger's."""

LEAST = 0.1
"""Least deflection at the struck point over the largest: closer to a support, the estimate ends."""


def lengthening(ends: tuple[str, ...], length: float, place: float) -> float:
    """Mean of ½ w_x² for the first vibration of a line that deflects by 1 m at `place`, 1/m²; 0 if an end is free."""
    if "free" in ends:
        return 0.0
    return float(line(ends, 8).sloped[0, 0]) / _deflection(ends, place / length) ** 2 / length**2


def mean_square(ends: tuple[str, ...], length: float, place: float) -> float:
    """Mean of w² for that vibration; 1 for a line with a free end, along which the deflection is taken as constant."""
    return 1.0 if "free" in ends else 0.5 / _deflection(ends, place / length) ** 2


def lengthening_of_plate(edges: tuple[str, ...], size: tuple[float, float], place: tuple[float, float]) -> float:
    """Mean of ½ (w_x² + w_y²) for the product of the first vibrations along the sides, which deflects by 1 m at
    `place`, 1/m²."""
    lines = list(zip((edges[:2], edges[2:]), size, place, strict=True))
    longer, flat = ([rule(*line) for line in lines] for rule in (lengthening, mean_square))
    return longer[0] * flat[1] + longer[1] * flat[0]


@lru_cache(maxsize=256)
def _deflection(ends: tuple[str, ...], place: float) -> float:
    """The first vibration at `place`, over the length, or `LEAST` of its largest deflection."""
    first = line(ends, 8).polynomials[0]
    largest = np.abs(np.polynomial.legendre.legval(np.linspace(-1.0, 1.0, 65), first)).max()
    return max(abs(float(np.polynomial.legendre.legval(2.0 * place - 1.0, first))), LEAST * float(largest))


def sliding(edges: tuple[str, ...], size: tuple[float, float]) -> float:
    """Membrane energy of a plate whose edges move inwards freely, over that between immovable ones.

    On a side ratio r it is about r^0.7 of that of a square plate; 0 if an edge is free.
    """
    share = sum(SLIDING.get(edge, 0.0) for edge in edges) / len(edges)
    return 0.0 if "free" in edges else share * (min(size) / max(size)) ** 0.7


def stretching(
    impact: Impact,
    thickness: float | None,
    compliance: float | None,
    part: float,
    strain: float,
    membrane: float,
    loose: float = 0.0,
    in_plane: str | None = None,
) -> Estimate:
    """The force that membrane stiffness adds.

    thickness: m. compliance: m/N. part: mass that moves with the struck point, kg. strain: of the middle surface for a
    deflection of 1 m, 1/m². membrane: ∂²U/∂ε² of the energy of uniform stretching, J. loose: part of it that is left if
    the edges move inwards freely. in_plane: whether they do; None if it is not known, and the change that between
    immovable edges.

    The energy ½ m V² m/(m + part) bends and stretches: U = u²/(2 c) + ½ B (ε u²)². One term, edges immovable (Berger
    1955, J. Appl. Mech. 22:465); the force is compared with that of the same energy without stretching.
    """
    if strain == 0.0:
        return no_effect(NOT_HELD)
    if thickness is None:
        return Estimate(NO_THICKNESS)
    if compliance is None:
        return missing("target.size")
    energy = impact.energy * impact.mass / (impact.mass + part)
    linear = math.sqrt(2.0 * energy * compliance)
    quartic, without = 0.5 * membrane * strain**2, linear / compliance
    deflection, force = _bent(energy, compliance, quartic)
    _, less = _bent(energy, compliance, loose * quartic)
    change = ((less if in_plane == "free" else force) - without) / max(without, impact.force)
    reason = (
        f"as a spring it bends by {linear / thickness:.2g} thicknesses with {without:.4g} N; with membrane "
        f"stiffness it would be {deflection / thickness:.2g} thicknesses with about {force:.4g} N between immovable "
        f"edges, {less:.4g} N if they move inwards"
    )
    return Estimate(reason, linear / thickness, 0.5, change, remedy="needs in_plane, and vibrations")


def _bent(energy: float, compliance: float, quartic: float) -> tuple[float, float]:
    """Deflection and force where u²/(2 c) + quartic u⁴ is the energy: a quadratic equation for u²."""
    bent = 0.5 / compliance
    deflection = math.sqrt(2.0 * energy / (bent + math.sqrt(bent**2 + 4.0 * quartic * energy)))
    return deflection, deflection / compliance + 4.0 * quartic * deflection**3

"""The film of a fluid that is squeezed out of the contact, and drawn in again."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from film_model.base.arrays import greater, lesser, logarithm, ratio
from film_model.base.units import format_si
from film_model.effects.case import Case, Rule
from film_model.effects.effect import Effect

ELASTIC = 0.37
"""Least gap over ((μ V/E)² R³)^{1/5}, in which the pressure of the fluid flattens the bodies: Yang & Hunt 2008, as
Nijssen, Ottens & Padding 2022 (Powder Technol. 413:118017) use it."""


class Film(NamedTuple):
    """Stokes number, least gap in m, and the share of the rebound velocity that the film takes, at most 1."""

    stokes: Any
    gap: Any
    share: Any


def squeezed(
    mass: Any, radius: Any, velocity: Any, viscosity: Any, modulus: Any, height: Any, restitution: Any
) -> Film:
    """The film under a ball, from SI numbers or arrays; equations in :func:`squeeze_film`.

    modulus: the effective one, inf if the bodies are rigid. height: of the roughness, m. One of the two limits the gap.
    """
    stokes = mass * velocity / (6.0 * math.pi * viscosity * radius**2)
    gap = greater(ELASTIC * ((viscosity * velocity / modulus) ** 2 * radius**3) ** 0.2, height)
    ways = logarithm(greater(radius / gap, 1.0)) * (1.0 + ratio(1.0, greater(restitution, 1e-9)))
    return Film(stokes, gap, lesser(ways / stokes, 1.0))


def squeeze_film(case: Case, rule: Rule) -> Effect:
    """The fluid that the ball squeezes out of the contact and draws in again.

        e (1 − (1 + 1/e) ln(R/h)/St),  St = m V/(6 π μ R²)      restitution by lubrication between the gaps R and h
        h = 0.37 ((μ V/E)² R³)^{1/5},  at least the roughness   left by elastic flattening; μ: `fluid_viscosity`
        e (1 − St_c/St),  St_c ≈ 19                             Davis, Serayssol & Hinch 1986, smooth ball in a liquid

    Measurements agree within a factor of two. Left out: cavitation, a film thinner than R, inertia of the fluid, drag
    on the way.
    """
    scene = case.scene
    viscosity, height, modulus = scene.contact.fluid_viscosity, scene.contact.roughness, scene.effective_modulus
    if viscosity is None:
        return rule.unjudged("missing: contact.fluid_viscosity")
    if modulus is None and not height:
        return rule.unjudged("missing: contact.roughness, or an effective modulus")
    stokes, gap, share = squeezed(
        scene.effective_mass,
        scene.effective_radius,
        scene.approach_velocity,
        viscosity,
        math.inf if modulus is None else modulus,
        height or 0.0,
        case.restitution,
    )
    by = "the roughness" if height and gap == height else "elastic flattening"
    why = f"the fluid is squeezed out up to a gap of {format_si(gap, 'length', 3)}, where {by} ends it"
    # Joseph et al. 2001 (J. Fluid Mech.) saw no rebound from a wall in a liquid
    if stokes <= 10.0:
        why += "; no ball has been seen to rebound in a liquid below a Stokes number of about 10"
    threshold = stokes * share / case.tolerance if share < 1.0 else None
    return rule.sized(case.tolerance, stokes, threshold, share, why, below=True)

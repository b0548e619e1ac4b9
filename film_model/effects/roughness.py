"""Rough surfaces, whose asperities touch before the bodies do."""

from __future__ import annotations

from film_model.base.units import format_si
from film_model.effects.case import Case, Rule
from film_model.effects.effect import Effect

HERTZ = 0.05
"""Greenwood, Johnson & Matsubara 1984, Wear 100:47: up to this α Hertz's contact pressure and area are right to 7 %."""


def roughness(case: Case, rule: Rule) -> Effect:
    """Asperities soften a contact whose indentation is not large compared with their height.

    The change of the indentation is α = σ R/a² = σ/δ (Greenwood & Tripp 1967), σ the `roughness` in [contact], rms
    height of both surfaces, δ Hertz's largest indentation: within a factor of two of their model for α from 0.02 to
    0.75 and μ = (8/3) η σ √(2 R β) from 1 to 17, with η asperities per area of the tip radius β; the force changes 0.3
    to 1 times as much.
    """
    height = case.scene.contact.roughness
    if height is None:
        return rule.unjudged("missing: contact.roughness")
    value = height / case.indentation
    why = (
        f"the indentation of {format_si(case.indentation, 'length', 3)} is {1.0 / value:.3g} times the height of the "
        f"roughness; up to α = {HERTZ:g} Hertz's pressure is right to 7 %"
        if height > 0.0
        else "the surfaces are given as smooth"
    )
    return rule.sized(case.tolerance, value, case.tolerance, value, why)

"""What surrounds a contact: the air on the way, a fluid in the gap, and asperities that touch before the bodies do."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from film_model.base.arrays import greater, lesser, logarithm, ratio
from film_model.base.units import format_si
from film_model.effects.case import Case
from film_model.scene import STANDARD_GRAVITY
from film_model.targets import Estimate


def air_drag(case: Case) -> Estimate:
    """Drag of the air on a ball that falls from drop_height.

        v² = v_t² (1 − exp(−2 g h/v_t²)),  v_t² = 2 m g/(ρ C_d π R²)
        C_d = (24/Re) (1 + 0.15 Re^0.687),  at least 0.44    smooth sphere in air at 20 °C (Schiller & Naumann 1933)

    The change is that of the impact energy, against the scene's velocity √(2 g h). C_d is that at v_t on the whole way:
    v is within 4 % of the fall with C_d at each velocity from R = 0.5 mm, and 0.3 % from 2 mm. Rough bodies fall more
    slowly: with C_d = 0.6 a hailstone of 20 mm lands at 18 instead of 21 m/s.
    """
    ball, height = case.scene.impactor, case.scene.impactor.drop_height
    if height is None:
        return Estimate("the velocity at the impact is given", applies=False)
    final = terminal_velocity(case.scene.mass, ball.radius)
    value = 2.0 * STANDARD_GRAVITY * height / final**2
    slowed = math.sqrt(-math.expm1(-value) / value)
    why = f"a sphere falls through air at {format_si(final, 'velocity', 2)} at most"
    reached, given = (format_si(speed, "velocity", 2) for speed in (slowed * ball.path_speed, ball.path_speed))
    if reached != given:
        why += f", and from this height reaches {reached}, not {given}: give the velocity"
    return Estimate(why, value, None, 1.0 - slowed**2)


def terminal_velocity(mass: float, radius: float) -> float:
    """Velocity at which the drag of air holds the weight of a sphere, m/s."""
    newton = 0.44  # drag coefficient of a sphere from a Reynolds number of 1000 up to 200,000
    air_density = 1.204  # of air at 20 °C and 1013 hPa, kg/m³; its viscosity is 1.813e-5 Pa s
    found = math.sqrt(2.0 * mass * STANDARD_GRAVITY / (air_density * newton * math.pi * radius**2))
    weighed = found**2 * newton
    for _ in range(60):  # each halves the error or better, since C_d falls at most as 1/Re
        reynolds = 2.0 * air_density * radius * found / 1.813e-5
        coefficient = max(24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687), newton)
        found = math.sqrt(found * math.sqrt(weighed / coefficient))
    return found


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
    # Yang & Hunt 2008, as Nijssen, Ottens & Padding 2022 (Powder Technol. 413:118017) use it
    gap = greater(0.37 * ((viscosity * velocity / modulus) ** 2 * radius**3) ** 0.2, height)
    ways = logarithm(greater(radius / gap, 1.0)) * (1.0 + ratio(1.0, greater(restitution, 1e-9)))
    return Film(stokes, gap, lesser(ways / stokes, 1.0))


def squeeze_film(case: Case) -> Estimate:
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
        return Estimate("missing: contact.fluid_viscosity")
    if modulus is None and not height:
        return Estimate("missing: contact.roughness, or an effective modulus")
    stokes, gap, share = squeezed(
        scene.effective_mass,
        scene.effective_radius,
        scene.approach_velocity,
        viscosity,
        math.inf if modulus is None else modulus,
        height or 0.0,
        case.seen.restitution,
    )
    by = "the roughness" if height and gap == height else "elastic flattening"
    why = f"the fluid is squeezed out up to a gap of {format_si(gap, 'length', 3)}, where {by} ends it"
    # Joseph et al. 2001 (J. Fluid Mech.) saw no rebound from a wall in a liquid
    if stokes <= 10.0:
        why += "; no ball has been seen to rebound in a liquid below a Stokes number of about 10"
    threshold = stokes * share / case.seen.tolerance if share < 1.0 else None
    return Estimate(why, stokes, threshold, share, below=True)


def roughness(case: Case) -> Estimate:
    """Asperities soften a contact whose indentation is not large compared with their height.

    The change of the indentation is α = σ R/a² = σ/δ (Greenwood & Tripp 1967), σ the `roughness` in [contact], rms
    height of both surfaces, δ Hertz's largest indentation: within a factor of two of their model for α from 0.02 to
    0.75 and μ = (8/3) η σ √(2 R β) from 1 to 17, with η asperities per area of the tip radius β; the force changes 0.3
    to 1 times as much.
    """
    height = case.scene.contact.roughness
    if height is None:
        return Estimate("missing: contact.roughness")
    value, depth = height / case.seen.indentation, format_si(case.seen.indentation, "length", 3)
    why = "the surfaces are given as smooth"
    if height > 0.0:  # Greenwood, Johnson & Matsubara 1984, Wear 100:47
        why = f"the indentation of {depth} is {1.0 / value:.3g} times the height of the roughness; "
        why += "up to α = 0.05 Hertz's pressure is right to 7 %"
    return Estimate(why, value, case.seen.tolerance, value)

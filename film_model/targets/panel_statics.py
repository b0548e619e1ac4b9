"""Static deflection of rectangular plates with any edges, in closed form or by Ritz's method with a bound."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from film_model.base.arrays import either, exponential, greater, lesser, root
from film_model.base.errors import SimulationError
from film_model.base.threads import one_thread
from film_model.core import panels
from film_model.targets.line_functions import SIMPLE, polynomials
from film_model.targets.modes import Modes
from film_model.targets.plate_statics import levy_compliance
from film_model.targets.ritz import TOO_SOFT, Panel, energy_of, loose_motions, shapes_at, split, turned

STATIC_DEGREE, LOWER_DEGREES = 32, (20, 26)
"""Degrees of the polynomials that correct the static compliance, and of those that give a bound on the rest."""

REMAINDER = 3.0
"""Bound on the error of a correction over its largest difference to those of lower degrees. They converge with
oscillations: of 274 random plates, half of them struck beside an edge, 269 are bounded, with degree 22 alone 253."""

LEVY = 1e-7
"""Relative error of Lévy's series."""

LONG, LONGEST, FEWEST_ACROSS = 4.0, 144.0, 12
"""Ratio of the sides from which on the degree along the longer one is higher, up to which it grows as √ratio, and least
degree across. Clamped strips of 100 widths then have errors of 1e-7, with degree 32 both ways 3e-3."""

FAR, SEEN = 10.0, 7.0
"""Distance of an edge over that in which a deflection decays on the bed, from which on it is not felt; and from which
on it does not matter under a force that grows."""

IMAGES = 4.0
"""Bound on what edges beyond `far` change over e^(−2 far): of 70 plates at most 0.7, of images at all four edges 3."""

SLOWER, SPREAD = 16.0, 3e-4
"""Highest frequency over the rate at which a force grows, and relative error of what it shows of the higher vibrations:
measured on plates and strips with from 2 to 1400 vibrations below that frequency."""


def ritz_compliance(panel: Panel, position: tuple[float, float], degree: int = STATIC_DEGREE) -> float:
    """Static deflection over force by Ritz's method alone, m/N: too small, because polynomials smooth the point force.

    Of a plate that nothing holds: the deflection without its motion as a rigid body.
    """
    lines = [polynomials(*line) for line in zip(panel.ends, degrees_along(panel, degree), strict=True)]
    struck, total = shapes_at(panel, lines, position), 0.0
    for block in split(panel, lines, struck):
        seen, energy = struck[block], energy_of(panel, lines, *block)
        if (loose := loose_motions(panel, lines, block)).size:
            energy += float(np.trace(energy)) / energy.shape[0] * loose @ loose.T
            seen = seen - loose @ (loose.T @ seen)
        total += panels.compliance(energy, seen)
    if math.isnan(total):
        raise SimulationError(TOO_SOFT)
    return total


def degrees_along(panel: Panel, degree: int) -> tuple[int, int]:
    """Degrees along both sides: the same, or more along the longer one and less across."""
    x, y = (side / d**0.25 for side, d in zip(panel.size, panel.stiffness[::2], strict=True))
    return degrees(x / y, degree)


def degrees(ratio: Any, degree: Any) -> tuple[Any, Any]:
    """The same from the ratio of the sides, each over the fourth root of its stiffness."""
    more = root(greater(lesser(greater(ratio, 1.0 / ratio), LONGEST) / LONG, 1.0))
    longer, shorter = math.ceil(degree * more - 0.5), greater(math.ceil(degree / more - 0.5), FEWEST_ACROSS)
    return either(ratio > 1.0, longer, shorter), either(ratio > 1.0, shorter, longer)


def panel_compliance(panel: Panel, position: tuple[float, float]) -> float:
    """Static deflection over force of a plate at the point `position` [m], m/N.

    In closed form if two opposite edges are simply supported and no springs hold them (:func:`levy_compliance`).
    Polynomials cannot represent the singularity under the force of other plates. Their error is that of the same plate
    with two opposite edges simply supported, so the difference there corrects it. The edges next to the force, with
    their springs, and the bed stay as they are. Of a plate that nothing holds, this is the deflection without its
    motion as a rigid body.
    """
    return compliance_and_error(panel, position)[0]


def compliance_and_error(panel: Panel, position: tuple[float, float], far: float = FAR) -> tuple[float, float]:
    """The static deflection over force, m/N, as of `panel_compliance`, and a bound on its error. far: as `FAR`."""
    (x, y), a = position, panel.size[0]
    value, error = unit_compliance(panel.unit, (x / a, y / a), far)
    return value * a**2 / panel.stiffness[0], error * a**2 / panel.stiffness[0]


@lru_cache(maxsize=64)
@one_thread
def unit_compliance(panel: Panel, position: tuple[float, float], far: float = FAR) -> tuple[float, float]:
    """The same of any plate, by itself."""
    panel, position = _felt(panel, position, far)
    (x, y), (a, b), (d11, _, d22, _) = position, panel.size, panel.stiffness
    simple = [panel.ends[k] == SIMPLE and not any(panel.springs[2 * k : 2 * k + 2]) for k in (0, 1)]
    if turns(min(x, a - x), min(y, b - y), d11, d22, *simple):
        panel, position = turned(panel), (y, x)
    springs = panel.springs[:2]
    like = replace(panel, edges=panel.ends[0] + SIMPLE, springs=(*springs, 0.0, 0.0))
    known = levy_compliance(panel.stiffness, panel.size, panel.ends[0], position, springs, panel.foundation)
    one, other, last = (
        0.0 if like == panel else ritz_compliance(panel, position, degree) - ritz_compliance(like, position, degree)
        for degree in (*LOWER_DEGREES, STATIC_DEGREE)
    )
    return corrected(known, one, other, last, far, panel.foundation)


def turns(x: Any, y: Any, d11: Any, d22: Any, along: Any, across: Any) -> Any:
    """Whether Lévy's series takes the other pair of edges as simply supported than those along x. x, y: distances from
    the nearest edges; along, across: whether those at the ends of x, and of y, are simply supported."""
    return either(across, False, (y / d22**0.25 < x / d11**0.25) | along)


def corrected(known: Any, one: Any, other: Any, last: Any, far: Any, bed: Any) -> tuple[Any, Any]:
    """Deflection and a bound on its error: of Lévy's series, and corrections by polynomials of three degrees."""
    off = greater(abs(last - one), abs(last - other))
    images = either(bed > 0.0, IMAGES * exponential(-2.0 * far), 0.0)
    return known + last, REMAINDER * off + (LEVY + images) * known


def _felt(panel: Panel, position: tuple[float, float], far: float) -> tuple[Panel, tuple[float, float]]:
    """The part of a plate on a bed k that the force feels, with simple supports where it is cut, and the place in it.

    Bending decays within (4 D/k)^¼, the twist of a strip of width b within √(48 D66/k)/b.
    """
    if not panel.foundation:
        return panel, position
    edges, springs, bed = list(panel.edges), list(panel.springs), panel.foundation
    size, place = list[float](), list[float]()
    for k, (x, side, other) in enumerate(zip(position, panel.size, panel.size[::-1], strict=True)):
        near, beyond, *cut = felt_along(x, side, other, panel.stiffness[2 * k], panel.stiffness[3], bed, far)
        for edge in (2 * k + end for end in (0, 1) if cut[end]):
            edges[edge], springs[edge] = SIMPLE[0], 0.0
        place.append(near)
        size.append(near + beyond)
    (a, b), (one, two, three, four), (s1, s2, s3, s4) = size, edges, springs
    cut = replace(panel, size=(a, b), edges=(one, two, three, four), springs=(s1, s2, s3, s4))
    return cut, (place[0], place[1])


def felt_along(x: Any, side: Any, other: Any, bending: Any, twist: Any, bed: Any, far: Any) -> tuple[Any, ...]:
    """Distances on both sides of x that are felt along a side, and whether the plate is cut there."""
    reach = far * greater((4.0 * bending / bed) ** 0.25, root(48.0 * twist / bed) / other)
    back = side - x
    # if one edge is felt: the other, unlike it, would take more functions that interact
    one = (lesser(x, back) <= reach) & (2.0 * (lesser(x, reach) + lesser(back, reach)) > side)
    reach = either(one, side, reach)
    return lesser(x, reach), lesser(back, reach), x > reach, back > reach


def omitted_compliance(
    panel: Panel, position: tuple[float, float], modes: Modes, highest: float
) -> tuple[float, float]:
    """Static deflection over force of the vibrations above `highest` [rad/s], m/N, and a bound on its error. modes:
    those up to it.

    The static deflection less Σ φ²/ω² of the modes; of long strips all digits cancel. Where its error matters, that
    under a force that grows as exp(s t): of the plate on a bed ρ_A s², which feels only what is around the force, less
    Σ φ²/(ω² + s²). Vibrations above the highest frequency ω_h, evenly spaced as on plates, then show arctan(s/ω_h)
    ω_h/s of their static deflection.
    """
    whole, error = compliance_and_error(panel, position)
    found, vague = lacking(whole, error, modes.compliance)
    if vague:
        rate = highest / SLOWER
        bed = replace(panel, foundation=panel.foundation + panel.mass_per_area * rate**2)
        bent = float(np.sum(modes.share / (modes.frequency**2 + rate**2)))
        found, error = grown(found, error, *compliance_and_error(bed, position, SEEN), bent)
    return max(found, 0.0), error


def lacking(whole: Any, error: Any, bent: Any) -> tuple[Any, Any]:
    """What the static deflections of modes lack to the whole, and whether its error matters."""
    return whole - bent, error > SPREAD * (whole - bent)


def grown(found: Any, error: Any, whole: Any, own: Any, bent: Any) -> tuple[Any, Any]:
    """The same, with its error, from deflections under a force that grows, if they show it better."""
    more = 1.0 / (SLOWER * math.atan(1.0 / SLOWER))
    other = more * (whole - bent)
    better = own + SPREAD * abs(other) < error
    return either(better, other, found), either(better, more * own, error)

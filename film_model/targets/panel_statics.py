"""Static deflection of rectangular plates with any edges, in closed form or by Ritz's method with a bound."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from film_model.base.arrays import either, greater, lesser, root
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
    nearer = min(y, b - y) / d22**0.25 < min(x, a - x) / d11**0.25
    if (nearer and not simple[1]) or (simple[0] and not simple[1]):
        panel, position = turned(panel), (y, x)
    springs = panel.springs[:2]
    like = replace(panel, edges=panel.ends[0] + SIMPLE, springs=(*springs, 0.0, 0.0))
    known = levy_compliance(panel.stiffness, panel.size, panel.ends[0], position, springs, panel.foundation)
    error = (LEVY + (IMAGES * math.exp(-2.0 * far) if panel.foundation else 0.0)) * known
    if like == panel:
        return known, error
    *lower, last = (
        ritz_compliance(panel, position, degree) - ritz_compliance(like, position, degree)
        for degree in (*LOWER_DEGREES, STATIC_DEGREE)
    )
    return known + last, REMAINDER * max(abs(last - each) for each in lower) + error


def _felt(panel: Panel, position: tuple[float, float], far: float) -> tuple[Panel, tuple[float, float]]:
    """The part of a plate on a bed k that the force feels, with simple supports where it is cut, and the place in it.

    Bending decays within (4 D/k)^¼, the twist of a strip of width b within √(48 D66/k)/b.
    """
    if not panel.foundation:
        return panel, position
    edges, springs, bed = list(panel.edges), list(panel.springs), panel.foundation
    size, place = list[float](), list[float]()
    for k, (x, side, other) in enumerate(zip(position, panel.size, panel.size[::-1], strict=True)):
        twist = math.sqrt(48.0 * panel.stiffness[3] / bed) / other
        reach = far * max((4.0 * panel.stiffness[2 * k] / bed) ** 0.25, twist)
        if min(x, side - x) <= reach and 2.0 * (min(x, reach) + min(side - x, reach)) > side:
            reach = side  # one edge is felt: unlike the other, it would take more functions that interact
        for edge, distance in ((2 * k, x), (2 * k + 1, side - x)):
            if distance > reach:
                edges[edge], springs[edge] = SIMPLE[0], 0.0
        place.append(min(x, reach))
        size.append(place[k] + min(side - x, reach))
    (a, b), (one, two, three, four), (s1, s2, s3, s4) = size, edges, springs
    cut = replace(panel, size=(a, b), edges=(one, two, three, four), springs=(s1, s2, s3, s4))
    return cut, (place[0], place[1])


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
    found = whole - modes.compliance
    if error > SPREAD * found:
        rate = highest / SLOWER
        bed = replace(panel, foundation=panel.foundation + panel.mass_per_area * rate**2)
        whole, own = compliance_and_error(bed, position, SEEN)
        more = 1.0 / (SLOWER * math.atan(1.0 / SLOWER))
        grown = more * (whole - float(np.sum(modes.share / (modes.frequency**2 + rate**2))))
        if own + SPREAD * abs(grown) < error:
            found, error = grown, more * own
    return max(found, 0.0), error

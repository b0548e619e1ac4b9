"""Half-space: a target so thick and wide that it does not move but by waves, which do not come back."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, cast

from film_model.base.errors import raise_all
from film_model.base.fields import entry
from film_model.base.materials import MATERIAL, Material, MaterialLike
from film_model.base.units import Value, format_si, to_si
from film_model.targets.plate_waves import plate_impedance, plate_stiffness
from film_model.targets.target import RADIUS, AbstractTarget, Estimate, Impact, fill_target, missing
from film_model.targets.waves import HERTZ_PULSE, HERTZ_SQUARE, radiation


def _read_curved(value: object) -> float:
    size = to_si(value, "length")
    RADIUS.read(f"{abs(size)!r} m")
    return size


CURVED = replace(RADIUS, read=_read_curved, low=-cast("float", RADIUS.high))
"""The radius of a ball's or of a hollow's surface, which is negative."""


@dataclass(frozen=True, init=False, repr=False)
class HalfSpace(AbstractTarget):
    """A target so thick and wide that it does not move but by waves, which do not come back.
    material: name or table. radius: of a curved surface, m; negative: of a hollow, wider than the ball; default flat.
    second_radius: of the surface in the other principal plane, m, alone for a shaft, negative for a groove; default the
    same radius.

    >>> fm.HalfSpace("mild steel").impedance
    inf
    """

    kind: ClassVar[str] = "half-space"
    material: Material | None = entry(MATERIAL)
    radius: float = entry(CURVED)
    second_radius: float | None = entry(CURVED)

    def __init__(
        self, material: MaterialLike | None = None, radius: Value | None = None, second_radius: Value | None = None
    ) -> None:
        raise_all(fill_target(self, locals()))

    @cached_property
    def _radiation(self) -> float | None:
        return None if self.material is None else radiation(self.material)

    def radiation_impedance(self, duration: Any) -> Any:
        """Z with ∫F² dt/Z = :func:`radiation` times ∫Ḟ² dt, N s/m."""
        return math.inf if self._radiation is None else HERTZ_SQUARE / HERTZ_PULSE * duration**2.0 / self._radiation

    def thickness_effect(self, impact: Impact) -> Estimate:
        """Thickness at which a plate takes the tolerated fraction of the energy, ∫F² dt/Z: an upper bound."""
        if self.material is None:
            return missing("a thickness and target.material")
        m = self.material
        unit = plate_impedance(m.density, plate_stiffness(m.youngs_modulus, m.poissons_ratio, 1.0))  # of 1 m
        lost = HERTZ_SQUARE * impact.force**2 * impact.duration / unit
        least = math.sqrt(lost / (impact.tolerance * impact.energy))
        reason = f"a target behaves as a half-space if it is at least {format_si(least, 'length', 3)} thick"
        return Estimate(reason, least, indicator="sufficient thickness, m")

    def wave_losses(self, impact: Impact) -> Estimate:
        """Energy of the waves over the impact energy, as V^{3/5} without weight."""
        if self._radiation is None:
            return missing("target.material")
        share = self._radiation * HERTZ_PULSE * impact.force**2 / impact.duration / impact.energy
        why = f"waves in the half-space carry away {100 * share:.2g} % of the impact energy"
        if share >= 1.0:
            why = "the weight presses so much that waves in the half-space carry away more than the impact energy"
        return Estimate(why, share, impact.tolerance, min(1.0, share))

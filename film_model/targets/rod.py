"""Rods."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, cast

from film_model.base.arrays import either, root
from film_model.base.errors import raise_all, shown
from film_model.base.fields import Field, entry, measure, mistake, one_of
from film_model.base.materials import REQUIRED_MATERIAL, Material, MaterialLike
from film_model.base.units import Value, format_si
from film_model.targets.modes import Modes
from film_model.targets.rod_modes import rod_compliance, rod_modes
from film_model.targets.sensors import SENSORS, Sensor, points_of, sensor_mistakes
from film_model.targets.supports import DAMPING, Damping, DampingLike, damped
from film_model.targets.target import LENGTH, RADIUS, AbstractTarget, Estimate, Impact, fill_target, missing

_IMPEDANCE = measure("impedance", 1e-12, 1e18)


def _read_far_end(value: object) -> Any:
    if value in ("free", "fixed"):
        return value
    try:
        return _IMPEDANCE.read(value)
    except ValueError:
        raise ValueError(
            f'{shown(value)} is not allowed: "free", "fixed" or an impedance (e.g. "150 N*s/m") is needed'
        ) from None


FAR_END = Field(_read_far_end, "free, fixed or an impedance", required=True, dimension="impedance")


@dataclass(frozen=True, init=False, repr=False)
class Rod(AbstractTarget):
    """A long thin rod struck on its end.

    material: name or table. diameter: m; or area: of the cross-section, m². length: m; without it no wave returns.
    far_end: "free", "fixed", or the impedance of what it is joined to, N·s/m. damping_ratio: of the vibrations; one
    number, a list, or pairs with frequencies. sensors: points whose motion is wanted.
    radius: of a rounded end, m.

    >>> round(fm.Rod("mild steel", diameter="20 mm").impedance)  # N·s/m
    12755
    """

    kind: ClassVar[str] = "rod"
    structural: ClassVar[bool] = True
    first_mode_share: ClassVar[float] = 0.5
    extent: ClassVar[str] = "length"
    material: Material = entry(REQUIRED_MATERIAL)
    diameter: float | None = entry(LENGTH)
    area: float | None = entry(measure("area", 1e-20, 1e10))
    length: float | None = entry(LENGTH)
    far_end: Literal["free", "fixed"] | float = entry(FAR_END)
    damping_ratio: Damping = entry(DAMPING)
    sensors: tuple[Sensor, ...] | None = entry(SENSORS)  # pyright: ignore[reportIncompatibleVariableOverride]
    radius: float = entry(RADIUS)

    def __init__(
        self,
        material: MaterialLike | None = None,
        diameter: Value | None = None,
        area: Value | None = None,
        length: Value | None = None,
        radius: Value | None = None,
        far_end: Literal["free", "fixed"] | Value = "free",
        damping_ratio: DampingLike = None,
        sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    ) -> None:
        mistakes = fill_target(self, locals())
        for name, given in (("far_end", far_end != "free"), ("damping_ratio", damping_ratio is not None)):
            if length is None and given:
                mistakes.append(mistake(self, name, "needs a length: no wave returns from an infinite rod"))
        sides = None if self.length is None else (self.length,)
        raise_all(mistakes + sensor_mistakes(self, self.sensors, sides) + one_of(self, diameter=diameter, area=area))

    @property
    def cross_section(self) -> float:
        """Area of the cross-section, m²."""
        return self.area if self.area is not None else math.pi / 4 * cast("float", self.diameter) ** 2

    @property
    def impedance(self) -> float:
        """Wave impedance, N·s/m."""
        return rod_impedance(self.material.youngs_modulus, self.material.density, self.cross_section)

    @property
    def finite(self) -> bool:
        """Whether it has a far end."""
        return self.length is not None

    @property
    def return_time(self) -> float:
        """2L/c, s: travel time of a wave to the far end and back; infinite without a length."""
        if self.length is None:
            return math.inf
        return 2.0 * self.length / root(self.material.youngs_modulus / self.material.density)

    @property
    def longest_time(self) -> float | None:
        """2L/c, s; None without a length."""
        return None if self.length is None else self.return_time

    @property
    def held(self) -> bool:
        """Whether the far end is fixed."""
        return self.length is None or self.far_end == "fixed"

    @property
    def whole_mass(self) -> float | None:
        """Mass, kg; None without a length."""
        return None if self.length is None else self.material.density * self.cross_section * self.length

    @property
    def compliance(self) -> float | None:
        """Static deflection over force, m/N: L/(EA) with a fixed far end; None without a length."""
        if self.length is None:
            return None
        return rod_compliance(self.impedance, self.return_time / 2, self._behind)

    @property
    def modes_missing(self) -> str:
        """Never missing."""
        return ""

    def modes(self, highest: float) -> Modes:
        """Natural vibrations up to a frequency [rad/s]."""
        length = cast("float", self.length)
        places = tuple((x / length,) for (x,) in points_of(self.sensors))
        return damped(
            rod_modes(self.impedance, self.return_time / 2, self._behind, highest, places), self.damping_ratio
        )

    @property
    def _behind(self) -> float:
        """Impedance behind the far end, N·s/m: 0 of a free end, infinite of a fixed one."""
        return {"free": 0.0, "fixed": math.inf}[self.far_end] if isinstance(self.far_end, str) else self.far_end

    def reflection_change(self, motion: Any, restitution: Any, delay: Any) -> Any:
        """0 if contact ends before the wave returns, by a margin; otherwise 1, a bound."""
        return either(delay > 0.3, 1.0, 0.0) + 0.0 * motion

    def reflections(self, impact: Impact) -> Estimate:
        """The wave that returns after 2L/c moves the struck end by 2/Z times the impulse (of a half-sine) given up to
        2L/c earlier: over the indentation."""
        if self.length is None:
            return missing("target.length")
        returns = self.return_time
        late = max(0.0, 1.0 - returns / impact.duration)
        impulse = impact.force * impact.duration / math.pi * (1.0 - math.cos(math.pi * late))
        size = 2.0 * impulse / self.impedance / impact.indentation
        back, lasts = format_si(returns, "time", 3), format_si(impact.duration, "time", 3)
        reason = f"the wave returns from the far end after {back}, the contact lasts {lasts}"
        return Estimate(reason, impact.duration / returns, 1.0, size, remedy="needs the modes of the rod")


def rod_impedance(youngs_modulus: float, density: float, area: float) -> float:
    """Z = ρ c A with c = √(E/ρ) of a long thin rod struck on its end, N·s/m.

    One-dimensional theory: the contact must last longer than a wave needs to cross the rod, and must end before the
    wave returns from the far end, after 2L/c.
    """
    return area * root(youngs_modulus * density)

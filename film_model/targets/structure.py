"""Structures known by their natural vibrations, of a finite-element model or of a measurement."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.fields import Field, entry, measure, mistake, words
from film_model.base.materials import MATERIAL, Material, MaterialLike
from film_model.base.units import Value, array_to_si, needed
from film_model.targets.modes import Modes, pulse_response
from film_model.targets.sensors import SENSORS, Sensor, replaced
from film_model.targets.structure_file import MOST_LISTED, read_structure
from film_model.targets.supports import DAMPING, Damping, DampingLike, damped
from film_model.targets.surface_strain import Rows
from film_model.targets.target import RADIUS, AbstractTarget, Estimate, Impact, fill_target, no_effect

HERTZ = 2.0 * math.pi
"""Angular frequency of 1 Hz, rad/s."""


def _list_of(dimension: str, low: float, high: float, zero: bool) -> Field:
    """A list of quantities from `low` to `high`, or 0 if `zero` allows it."""
    need = f"a list, {needed(dimension)} in each place"

    def read(value: object) -> tuple[float, ...]:
        if isinstance(value, str) or not hasattr(value, "__len__"):
            raise ValueError(f"{shown(value)} is not a list: {need}")
        found = array_to_si(value, dimension)
        if found.ndim != 1 or not 1 <= found.size <= MOST_LISTED:
            raise ValueError(f"{shown(value)} has {found.size} values: 1 to {MOST_LISTED} are allowed")
        for place, number in enumerate(found.tolist(), 1):
            if not (low <= number <= high or (zero and number == 0.0)):
                raise ValueError(f"value {place} is {number:g}: from {low:g} to {high:g} is allowed")
        return tuple(found.tolist())

    return Field(read, need, dimension=dimension)


def _numbers(given: Any, columns: Mapping[str, tuple[float, ...]]) -> Any:
    """A column of a file by its name, or what is given instead."""
    return columns[given.lower()] if isinstance(given, str) else given


def _sorted(values: Any, order: Sequence[int]) -> Any:
    """The values in another order, if there are any."""
    return tuple(values[k] for k in order) if values else values


@dataclass(frozen=True, init=False, repr=False)
class Structure(AbstractTarget):
    """A structure known by its natural vibrations.

    material: of the surface that is struck, name or table. file: of the vibrations, CSV or netCDF (`read_structure`);
    or frequency: of each vibration, Hz; 0 is a motion of the whole structure; and modal_mass: of each vibration, kg, if
    its shape is 1 at the struck point. damping_ratio: one number, a list by ascending frequency, or pairs with
    frequencies; replaces that of the file. static_compliance: deflection over force at the struck point, m/N; default
    that of the vibrations together. A structure that is not held: without its motion as a whole. sensors: points whose
    motion is wanted. radius: of a curved surface, m.

    >>> fm.Structure(frequency=["180 Hz", "410 Hz"], modal_mass=["0.9 kg", "1.4 kg"]).frequency
    (180.0, 410.0)
    """

    kind: ClassVar[str] = "structure"
    structural: ClassVar[bool] = True
    material: Material | None = entry(MATERIAL)
    file: str | None = entry(Field(words("the path of a file").read, "the path of a file is needed"))
    frequency: tuple[float, ...] = entry(_list_of("frequency", 1e-9, 1e12, zero=True))
    modal_mass: tuple[float, ...] = entry(_list_of("mass", 1e-28, 1e60, zero=False))
    damping_ratio: Damping = entry(DAMPING)
    static_compliance: float | None = entry(measure("compliance", 1e-18, 1e12))
    sensors: tuple[Sensor, ...] | None = entry(SENSORS)  # pyright: ignore[reportIncompatibleVariableOverride]
    radius: float = entry(RADIUS)

    def __init__(
        self,
        file: str | None = None,
        material: MaterialLike | None = None,
        frequency: Sequence[Value] | Value | None = None,
        modal_mass: Sequence[Value] | Value | None = None,
        damping_ratio: DampingLike = None,
        static_compliance: Value | None = None,
        radius: Value | None = None,
        sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
    ) -> None:
        mistakes = fill_target(self, locals())
        if self.file is not None:
            mistakes += self._read(frequency is not None or modal_mass is not None)
        elif frequency is None or modal_mass is None:
            missing = "file" if frequency is None and modal_mass is None else "modal_mass"
            missing = "frequency" if frequency is None and modal_mass is not None else missing
            mistakes.append(mistake(self, missing, "missing: give file, or frequency and modal_mass"))
        elif self.frequency and self.modal_mass and len(self.frequency) != len(self.modal_mass):
            wrong = f"{len(self.modal_mass)} values for {len(self.frequency)} frequencies"
            mistakes.append(mistake(self, "modal_mass", wrong))
        mistakes += [] if mistakes else self._sensor_mistakes()
        if not mistakes:
            self._sort()
            least = self._all.compliance
            if self.static_compliance is not None and self.static_compliance < least * (1 - 1e-6):
                wrong = f"{self.static_compliance:g} m/N is less than that of the vibrations together, {least:.6g} m/N"
                mistakes.append(mistake(self, "static_compliance", wrong))
        raise_all(mistakes)

    def _read(self, others: bool) -> list[Mistake]:
        """Replace the file's name by its vibrations, so that the scene is complete without it."""
        if others:
            return [mistake(self, "file", "give file, or frequency and modal_mass, not both")]
        assert self.file is not None
        try:
            words = (word for s in self.sensors or () for word in (s.shape, s.strain))
            named = {word.lower() for word in words if isinstance(word, str)}
            listed = read_structure(self.file, tuple(sorted(named)))
        except (OSError, ValueError) as error:
            reason = (
                f"{shown(self.file)} cannot be read: {error.strerror}" if isinstance(error, OSError) else str(error)
            )
            return [mistake(self, "file", reason)]
        for name in ("frequency", "modal_mass"):
            object.__setattr__(self, name, getattr(listed, name))
        for name in ("damping_ratio", "static_compliance"):
            if getattr(self, name) is None:
                object.__setattr__(self, name, getattr(listed, name))
        if self.sensors:
            found = (
                replaced(s, *(_numbers(part, listed.shapes) for part in (s.shape, s.strain))) for s in self.sensors
            )
            object.__setattr__(self, "sensors", tuple(found))
        object.__setattr__(self, "file", None)
        return []

    def _sensor_mistakes(self) -> list[Mistake]:
        """Mistakes of sensors: each needs a shape with a number for each vibration."""
        for sensor in self.sensors or ():
            wrong = (
                "a shape is needed: the name of a column of the modes file, or a list" if sensor.shape is None else ""
            )
            named = next((part for part in (sensor.shape, sensor.strain) if isinstance(part, str)), None)
            if named is not None:
                wrong = f"{shown(named)} names a column, which needs a file"
            elif sensor.strain is True:
                wrong = "strain needs the name of a column of the modes file, with the strain of the shapes there"
            elif sensor.strain and len(sensor.strain) != len(self.frequency):
                wrong = f"strain has {len(sensor.strain)} values for {len(self.frequency)} frequencies"
            elif sensor.shape is not None and len(sensor.shape) != len(self.frequency):
                wrong = f"the shape has {len(sensor.shape)} values for {len(self.frequency)} frequencies"
            if wrong:
                return [mistake(self, "sensors", f"{shown(sensor.name)}: {wrong}")]
        return []

    def _sort(self) -> None:
        """Sort the lists by ascending frequency."""
        order = sorted(range(len(self.frequency)), key=lambda k: self.frequency[k])
        if self.sensors:
            found = (replaced(s, *(_sorted(part, order) for part in (s.shape, s.strain))) for s in self.sensors)
            object.__setattr__(self, "sensors", tuple(found))
        for name in ("frequency", "modal_mass"):
            object.__setattr__(self, name, tuple(getattr(self, name)[k] for k in order))

    @property
    def _all(self) -> Modes:
        share = 1.0 / np.array(self.modal_mass)
        rows = [s.shape for s in self.sensors or ()], [s.strain for s in self.sensors or () if s.strain]
        factors = (share * np.array(row, dtype=np.float64).reshape(-1, share.size) for row in rows)
        return Modes(np.array(self.frequency) * HERTZ, share, np.zeros(0), *factors)

    @property
    def finite(self) -> bool:
        """Always: no wave leaves it."""
        return True

    @property
    def held(self) -> bool:
        """Whether no frequency is 0."""
        return self.frequency[0] > 0.0

    @property
    def whole_mass(self) -> float:
        """Mass of the first vibration at the struck point, kg."""
        return next((m for f, m in zip(self.frequency, self.modal_mass, strict=True) if f > 0.0), math.inf)

    @property
    def compliance(self) -> float:
        """Static deflection over force, m/N: as given, or that of the vibrations."""
        return self._all.compliance if self.static_compliance is None else self.static_compliance

    @property
    def modes_missing(self) -> str:
        """Never missing."""
        return ""

    def modes(self, highest: float) -> Modes:
        """The given vibrations up to the frequency `highest` [rad/s]."""
        return damped(self._all.below(highest), self.damping_ratio)

    def strains(self, rows: Rows) -> Rows:
        """The strain of each column as strain_x; strain_y and the stresses are not known."""
        return np.stack([rows, *np.full((4, *rows.shape), np.nan)])  # pyright: ignore[reportReturnType]

    def omitted(self, modes: Modes, highest: float) -> tuple[float, float]:
        """Static compliance of the vibrations above `highest` [rad/s], m/N: their sum, and 0.

        The difference of two sums would be rounding where a motion of the whole structure has a frequency of 1e-5 Hz.
        """
        own = self._all
        lacking = 0.0 if self.static_compliance is None else max(self.static_compliance - own.compliance, 0.0)
        above = own.frequency > highest
        return float(np.sum(own.share[above] / own.frequency[above] ** 2)) + lacking, 0.0

    @property
    def return_time(self) -> float:
        """Always 0 s: there is no time before which it would be infinite."""
        return 0.0

    def reflections(self, impact: Impact) -> Estimate:
        """Not estimated: the whole target is simulated, unless it is assumed fixed."""
        return no_effect("the vibrations of the structure are simulated")

    def bending_strength(self, impact: Impact) -> Estimate:
        """Not estimated."""
        return Estimate(f"the bending stress of a {self.kind} is not estimated")

    def omitted_modes(self, impact: Impact) -> Estimate:
        """Without a static compliance they add about Σ φ²/(M Ω²) of the given ones, as on a plate. The part c of a
        given compliance that the modes lack has an inertia: an error of c (π/T)²/Ω², T the contact time on a fixed
        target. Both over indentation plus deflection in the middle of a half-sine of this duration.
        """
        duration, contact = impact.held
        modes, rate = self._all, math.pi / duration
        highest = float(modes.frequency[-1])
        if highest == 0.0:
            return no_effect("the structure has no vibrations: it moves as a rigid body")
        if self.static_compliance is None:
            lacking, reason = float(np.sum(modes.share)) / highest**2, "static_compliance would include them statically"
            remedy = "needs more vibrations, or static_compliance"
        else:
            lacking = (self.static_compliance - modes.compliance) * (rate / highest) ** 2
            reason, remedy = "they follow the force statically", "needs more vibrations"
        moved = pulse_response(self.modes, self.compliance, duration)
        size = min(lacking / (contact + moved), 1.0)
        said = f"the vibrations end at {highest / HERTZ:.4g} Hz, the contact lasts {duration:.3g} s or more; {reason}"
        return Estimate(said, highest / rate, None, size, remedy=remedy)

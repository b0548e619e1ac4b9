"""The motion of an impact on modes in closed form, as the core records it or as it is read from a file."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import modal, modal_steps, native


@dataclass(frozen=True)
class ModalMotion:
    """The motion of an impact on modes, in the units of the march except for times, s.

    unit: the march's unit of time, s. segments: steps in contact, and flights; flights: the modes' state at the
    beginning of each. A step has 320 bytes in memory, a flight 16 bytes per mode. energies: of each mode at the end.
    highest: frequency up to which the target's modes were taken, rad/s. stretching: energy of the membrane forces at
    the end.
    """

    curve: native.Curve = field(repr=False)
    tables: modal.Tables = field(repr=False)
    unit: float
    segments: modal_steps.Table = field(repr=False)
    flights: Array = field(repr=False)
    energies: Array = field(repr=False)
    highest: float
    stretching: float

    @property
    def frequency(self) -> Array:
        """Natural frequencies, rad/s."""
        return self.tables.frequency

    @property
    def modes(self) -> int:
        """Number of modes."""
        return self.tables.count

    @property
    def energy(self) -> float:
        """Energy of all modes and of the membrane forces at the end."""
        return float(self.energies.sum()) + self.stretching

    @property
    def damped(self) -> bool:
        """Whether the modes are damped."""
        return bool(self.tables.ratio.any())

    def sample(self, times: Array) -> tuple[Array, NDArray[np.int8]]:
        """(count, 5) values ξ, ξ', f, ν, displacement of the struck point at ascending times, and branch of each."""
        return modal.sample(self.tables, self.curve, self.segments, self.flights, times * self.unit)

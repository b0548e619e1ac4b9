"""Natural vibrations of a structure, as seen from the struck point."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from film_model.base.errors import TooManyModes

Array = NDArray[np.float64]

Points: TypeAlias = tuple[tuple[float, ...], ...]
"""Points of a structure, m: its sensors."""

EQUAL = 1e-13
"""Relative difference of frequencies that is rounding: square plates have vibrations in pairs."""

UNSEEN = 1e-20
"""Share over the largest, below which the struck point is a node."""

MOST_MODES = 10_000_000
"""Largest number of modes, limited by memory: 240 MB."""


@dataclass(frozen=True)
class Modes:
    """Natural vibrations of a structure as seen from the struck point, by ascending frequency.

    frequency: ω_n, rad/s; 0 for a motion of the whole structure that nothing holds. share: φ_n²/M_n, 1/kg: mode shape
    there squared over modal mass. damping_ratio: ζ_n; default 0. The point's displacement is w = Σ w_n with
    ẅ_n + 2 ζ_n ω_n ẇ_n + ω_n² w_n = (φ_n²/M_n) F. factor: the same of the structure's sensors, one per row:
    φ_n(sensor) φ_n/M_n, 1/kg, in place of the share. strain: the same of what `AbstractTarget.strains` takes.
    """

    frequency: Array
    share: Array
    damping_ratio: Array = field(default_factory=lambda: np.zeros(0))
    factor: Array = field(default_factory=lambda: np.zeros((0, 0)), compare=False)
    strain: Array = field(default_factory=lambda: np.zeros((0, 0)), compare=False)

    def __post_init__(self) -> None:
        if self.damping_ratio.size == 0:
            object.__setattr__(self, "damping_ratio", np.zeros_like(self.frequency))

    def below(self, highest: float) -> Modes:
        """Those up to the frequency `highest`, rad/s."""
        count = int(np.searchsorted(self.frequency, highest, side="right"))
        parts = self.frequency, self.share, self.damping_ratio, self.factor, self.strain
        return Modes(*(part[..., :count] for part in parts))

    def merged(self) -> Modes:
        """The same motion of the struck point and of the sensors: modes of equal frequency and damping become one."""
        if not self.frequency.size:
            return self
        apart = np.diff(self.frequency) > EQUAL * self.frequency[1:]
        first = np.flatnonzero(np.concatenate([[True], apart | (np.diff(self.damping_ratio) != 0.0)]))
        factor = np.add.reduceat(self.factor, first, axis=1) if len(self.factor) else self.factor
        return Modes(self.frequency[first], np.add.reduceat(self.share, first), self.damping_ratio[first], factor)

    @property
    def compliance(self) -> float:
        """Σ φ_n²/(M_n ω_n²), m/N: static deflection over force of these modes, without those of frequency 0."""
        bends = self.frequency > 0.0
        return float(np.sum(self.share[bends] / self.frequency[bends] ** 2))


def pulse_response(modes_up_to: Callable[[float], Modes], compliance: float, duration: float) -> float:
    """Deflection over force in the middle of a half-sine of a given duration [s], m/N.

    modes_up_to: modes below a frequency [rad/s]. compliance: of all modes together, m/N.
    """
    rate = math.pi / duration
    modes = modes_up_to(10.0 * rate)  # those above follow statically
    omega = modes.frequency[modes.frequency > 0.0] / rate
    share = modes.share[modes.frequency > 0.0] / rate**2
    at = np.abs(omega - 1.0) < 1e-6
    omega = np.where(at, 1.0 + 1e-6, omega)
    bent = float(np.sum(share / (omega**2 - 1.0) * (1.0 - np.sin(omega * math.pi / 2) / omega)))
    moved = float(np.sum(modes.share[modes.frequency == 0.0])) / rate**2 * (math.pi / 2 - 1.0)
    return bent + moved + max(compliance - modes.compliance, 0.0)


def check_count(count: float) -> None:
    """TooManyModes if `count` modes would need too much memory."""
    if count > MOST_MODES:
        raise TooManyModes(
            f"about {count:.1e} natural vibrations would be needed: the contact ends long before waves return from the "
            "edges, so set boundary_reflections = false in [effects]"
        )


def without_rounding(components: Array, values: Array, size: Array) -> Array:
    """The components of vectors of a given size along the eigenvectors of a symmetric matrix, or of many; `values`:
    ascending. Those that are rounding become 0.

    An eigenvector is wrong by ε ‖A‖ over the distance to the next eigenvalue (Davis and Kahan 1970). A component that
    is not larger than this error times the size is rounding, which differs between machines. Measured on modes with a
    node at the struck point by symmetry: at most 0.3 of this bound.
    """
    blurred = 1e-5  # largest component, over the norm, that is taken for rounding however close two eigenvalues are
    gaps = np.diff(values, axis=-1, prepend=-math.inf, append=math.inf)
    rounding = np.finfo(np.float64).eps * np.abs(values).max(axis=-1, keepdims=True)
    blur = rounding / np.maximum(np.minimum(gaps[..., 1:], gaps[..., :-1]), rounding / blurred)
    return np.where(np.abs(components) > blur * size, components, 0.0)


def projected(seen: Array, values: Array, vectors: Array) -> Array:
    """The components of `seen` along eigenvectors, one per column, as of :func:`without_rounding`."""
    return without_rounding(seen @ vectors, values, np.linalg.norm(seen, axis=-1, keepdims=True))


def sorted_modes(frequency: Array, share: Array, highest: float, factor: Array | None = None) -> Modes:
    """The modes up to the frequency `highest` [rad/s], except those with a node at the struck point. factor: as of
    `Modes`, one array for each sensor in the shape of the others; default no sensors."""
    order = np.argsort(frequency, axis=None, kind="stable")
    factors = np.zeros((0, order.size)) if factor is None else factor.reshape(len(factor), order.size)
    frequency, share = frequency.ravel()[order], share.ravel()[order]
    kept = (frequency <= highest) & (share > UNSEEN * share.max(initial=0.0))
    return Modes(frequency[kept], share[kept], factor=factors[:, order[kept]])

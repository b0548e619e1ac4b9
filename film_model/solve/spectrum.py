"""An impact over frequency: the spectrum of its force, and how the structure responds at the struck point and sensors.

The force's spectrum is that of a hammer test: a soft tip keeps contact long and excites low frequencies only.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError, TooManyModes
from film_model.base.files import written_whole
from film_model.base.units import array_to_si
from film_model.solve.structures import computable, lowest_frequency
from film_model.targets import AbstractTarget

Complex = NDArray[np.complex128]

SAMPLES = 2**13
"""Even times of the force, between which it is taken as linear: where it is a half-sine, within 1e-7 of the impulse."""

FREQUENCIES, SHOWN = 1000, 2.0
"""Number of frequencies where none are given, and the largest over the bandwidth."""

STRAINS = {
    "strain_x": "1/N",
    "strain_y": "1/N",
    "stress_x": "Pa/N",
    "stress_y": "Pa/N",
    "shear_stress": "Pa/N",
}
"""Responses of sensors with strain, at the face away from the impactor, with units."""


@dataclass(frozen=True)
class Spectrum:
    """frequency: Hz. force: ∫ F e^(−iωt) dt, N·s, complex. bandwidth: lowest frequency at which its amplitude is 10 dB
    below that of frequency 0, Hz. points: the struck point, and the sensors. receptance: complex displacement over
    force at each, m/N, (points, frequencies); empty if the vibrations of the target are not simulated. gauges: the
    sensors with strain. strain: complex strains and stresses over force, names and units as `STRAINS`: each (gauges,
    frequencies); those that are known."""

    frequency: Array
    force: Complex
    bandwidth: float
    points: tuple[str, ...]
    receptance: Complex
    gauges: tuple[str, ...] = ()
    strain: Mapping[str, Complex] = field(default_factory=dict[str, Complex])

    @property
    def accelerance(self) -> Complex:
        """Acceleration over force at each point, 1/kg: −ω² times the receptance."""
        return -((2.0 * math.pi * self.frequency) ** 2) * self.receptance

    @property
    def acceleration(self) -> Complex:
        """Spectrum of the acceleration of each point under this impact, m/s."""
        return self.accelerance * self.force

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI, complex ones as amplitudes in N·s, 1/kg and the units of `STRAINS`."""
        return {
            "bandwidth": self.bandwidth,
            "frequency": self.frequency.tolist(),
            "force": np.abs(self.force).tolist(),
            "accelerance": _amplitudes(self.points, self.accelerance),
            **{name: _amplitudes(self.gauges, rows) for name, rows in self.strain.items()},
        }

    def write(self, path: str | os.PathLike[str]) -> None:
        """As CSV: real and imaginary parts of the force, N·s, and of the responses of each point, over the force."""
        columns = {"frequency [Hz]": self.frequency}
        for name, unit, values in (
            ("force", "N*s", self.force),
            *(
                (f"{what} {name}", unit, row)
                for what, unit, rows in (
                    ("receptance", "m/N", self.receptance),
                    ("accelerance", "1/kg", self.accelerance),
                )
                for name, row in zip(self.points, rows, strict=True)
            ),
            *(
                (f"{what} {name}", STRAINS[what], row)
                for what, rows in self.strain.items()
                for name, row in zip(self.gauges, rows, strict=True)
            ),
        ):
            columns |= {f"{name}, real [{unit}]": values.real, f"{name}, imaginary [{unit}]": values.imag}
        with written_whole(Path(path)) as beside, beside.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(columns)
            table.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))


def spectrum_of(times: Array, force: Array, target: AbstractTarget | None, frequencies: Any = None) -> Spectrum:
    """The spectrum of a force at ascending frequencies, Hz or with units, > 0, and the response of the target if given.

    times: s, even from 0 on. Default: 1000 even frequencies up to twice the bandwidth. The response has the natural
    vibrations up to 30 times the largest frequency, with strains 120 times, or as many as can be computed; of those
    above, the static part at the struck point. Raises ValueError for wrong frequencies.
    """
    bandwidth = _bandwidth(times, force)
    if frequencies is None:
        f = np.linspace(0.0, SHOWN * bandwidth, FREQUENCIES + 1)[1:]
    else:
        f = array_to_si(frequencies, "frequency", bare=True)
        if f.ndim != 1 or f.size == 0 or not (f > 0.0).all() or (np.diff(f) < 0.0).any():
            raise ValueError("frequencies must be a list that ascends from more than 0 Hz")
    pushed = transform(times, force, f)
    if target is None:
        return Spectrum(f, pushed, bandwidth, (), np.zeros((0, f.size), np.complex128))
    sensors, rows = target.sensors or (), responses(target, f)
    points, gauges = ("struck point", *(s.name for s in sensors)), tuple(s.name for s in sensors if s.strain)
    strains = zip(STRAINS, target.strains(rows[len(points) :]) if gauges else (), strict=False)
    known = {name: row for name, row in strains if not np.isnan(row).all()}
    return Spectrum(f, pushed, bandwidth, points, rows[: len(points)], gauges, known)


def _amplitudes(names: tuple[str, ...], rows: Complex) -> dict[str, list[float]]:
    return {name: np.abs(row).tolist() for name, row in zip(names, rows, strict=True)}


def transform(times: Array, force: Array, frequency: Array) -> Complex:
    """∫ F e^(−iωt) dt of a force that is linear between even times from 0 s on, at frequencies, Hz: exact.

    The exponentials of all times are products of those of few.
    """
    dt, side = float(times[1] - times[0]), math.isqrt(force.size - 1) + 1
    rows = np.concatenate([force, np.zeros(side**2 - force.size)]).reshape(side, side)
    turned = np.exp(-2j * math.pi * dt * np.outer(frequency, np.arange(side)))
    sums = np.exp(-2j * math.pi * dt * side * np.outer(frequency, np.arange(side))) * (turned @ rows.T)
    return dt * np.sinc(frequency * dt) ** 2 * sums.sum(axis=1)


def responses(target: AbstractTarget, frequency: Array) -> Complex:
    """Displacement over force of the struck point and each sensor, m/N, at frequencies > 0, Hz: (points, frequencies);
    and below them the rows that :meth:`AbstractTarget.strains` takes.

    Σ φ_n(point) φ_n/(M_n (ω_n² − ω² + 2 i ζ_n ω_n ω)), and the static deflection of the omitted vibrations at the
    struck point. Without damping it is infinite at natural frequencies. Raises SimulationError where the vibrations up
    to the largest frequency cannot be computed.
    """
    omega = 2.0 * math.pi * frequency
    try:
        most = max(float(omega[-1]), lowest_frequency(target))
        # At sensors the static part of higher modes is missing: on plates up to 0.6 % of the static deflection in the
        # other half, 3 % at 1/60 of the side from the force. Strains and stresses at 1.5 times the thickness from the
        # force are within 1.5 % of the largest below the frequency; with 30 times within 3 %.
        reach = 120.0 if any(sensor.strain for sensor in target.sensors or ()) else 30.0
        highest = computable(target, reach * most, 1.0 / most, most)
    except TooManyModes as error:
        raise SimulationError(f"up to {float(frequency[-1]):g} Hz: {error}") from None
    modes = target.modes(highest)
    factors = np.vstack([part for part in (modes.share, modes.factor, modes.strain) if part.size]).astype(np.complex128)
    found = np.empty((len(factors), omega.size), np.complex128)
    step = max(1_000_000 // modes.frequency.size, 10)  # 16 MB at a time, or ten frequencies
    for at in (slice(first, first + step) for first in range(0, omega.size, step)):
        w = omega[at, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            found[:, at] = (
                factors @ (1.0 / (modes.frequency**2 - w**2 + 2j * modes.damping_ratio * modes.frequency * w)).T
            )
    found[0] += target.omitted(modes, highest)[0]
    return found


def _bandwidth(times: Array, force: Array) -> float:
    """The lowest frequency at which the amplitude is `DROP` times that of frequency 0, Hz."""
    import scipy.optimize

    root: Any = scipy.optimize.brentq
    impulse = float(abs(transform(times, force, np.zeros(1))[0]))

    def over(frequency: Any) -> Any:
        return np.abs(transform(times, force, np.atleast_1d(frequency))) / impulse - (10.0**-0.5)  # −10 dB

    # steps in which the bandwidth is looked for, over 1/time from first touch to the last event
    step = 0.05 / float(times[-1])
    for first in range(0, SAMPLES, 64):
        f = step * np.arange(first, first + 65)
        below = np.flatnonzero(over(f) < 0.0)
        if below.size:
            return float(root(lambda x: float(over(x)[0]), f[below[0] - 1], f[below[0]]))
    raise SimulationError("the spectrum of the force does not fall by 10 dB: it jumps")

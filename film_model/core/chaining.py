"""The core's chain of bodies, seen from Python. Nothing else knows its structures (film_chain.h)."""

from __future__ import annotations

import ctypes as c
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import native
from film_model.core.headers import Header

MOST_STEPS = 500_000
MOST_WORK = 100_000_000  # steps times vibrations, half a minute
OTHERS = 200
CHAIN = Header("chain/film_chain.h", native.CORE)


@CHAIN.structure("film_chain_contact")
class Contact(c.Structure):
    """A law with its units, between a body and one behind it or the support."""


@CHAIN.structure("film_chain")
class Chain(c.Structure):
    """The bodies, their contacts and how they are followed."""


@CHAIN.structure("film_chain_summary")
class Summary(c.Structure):
    """What one contact did."""


SUMMARY_DTYPE = np.dtype(Summary)


class Vibrations(NamedTuple):
    """A structure's vibrations in the units of the chain: ω² and 2 ζ ω, (modes,), and their shapes of modal masses of 1
    at its points, (points, modes)."""

    square: Array
    drag: Array
    shapes: Array


RIGID = Vibrations(np.zeros(0), np.zeros(0), np.zeros((0, 0)))
"""No structure."""


@dataclass(frozen=True)
class Run:
    """What a run did, in the units of the chain. status: of the core. indentation: of the contacts, velocity: of the
    bodies. contacts: SUMMARY_DTYPE. structure: energy of the vibrations, and what their damping has taken. samples:
    indentations, velocities and forces at each time, and displacement, velocity and acceleration of each point of the
    structure: (times, 2 contacts + bodies + 3 points). failed: the contact whose law refused the motion."""

    status: int
    time: float
    steps: int
    indentation: Array
    velocity: Array
    contacts: NDArray[Any]
    structure: Array
    samples: Array
    failed: int
    modes: int

    @property
    def work(self) -> int:
        """Steps times vibrations; the bodies take as long as `OTHERS` of these."""
        return self.steps * (self.modes + OTHERS)


_library = native.with_functions(CHAIN, sizes=("film_chain_sizes", Chain, Contact, Summary))


def run(
    mass: Array,
    velocity: Array,
    fall: Array,
    contacts: Sequence[tuple[native.Curve, float, float, float, float, float, float, int, int, int, int]],
    vibrations: Vibrations = RIGID,
    *,
    limit: float,
    tolerance: float,
    times: Any,
) -> Run:
    """Follow a chain. fall: accelerations by weight. contacts: curve, units of indentation and force, depth, factor of
    the damping, gap, cosine between both lines, the bodies in front and behind, and the point and side of the
    structure, -1 and 0 away from it. limit, times: of the end and of the samples, ascending; limit may be infinite."""
    lib, n, m = _library(), mass.size, len(contacts)
    points, modes = vibrations.shapes.shape
    vibrations = Vibrations(*map(np.ascontiguousarray, vibrations))
    given = (Contact * max(m, 1))(*(Contact(c.addressof(curve), *numbers) for curve, *numbers in contacts))
    mass, velocity, fall, times = (np.ascontiguousarray(row, dtype=np.float64) for row in (mass, velocity, fall, times))
    chain = Chain(
        *(n, m, mass.ctypes.data, velocity.ctypes.data, fall.ctypes.data, c.addressof(given)),
        *(limit, tolerance, min(MOST_STEPS, MOST_WORK // (modes + OTHERS)), modes, points, 0),
        *(row.ctypes.data for row in vibrations),
    )
    time, steps, failed = c.c_double(), c.c_int32(), c.c_int32(-1)
    indentation, speeds, found = np.empty(m), np.empty(n), np.zeros(m, SUMMARY_DTYPE)
    structure, samples = np.empty(2), np.empty((times.size, 2 * m + n + 3 * points))
    memory = np.empty(lib.film_chain_size(n, m, modes) // 8 + 1)
    status = lib.film_chain_run(
        *(c.byref(chain), c.byref(time), indentation.ctypes.data, speeds.ctypes.data),
        *(found.ctypes.data, structure.ctypes.data, times.size, times.ctypes.data, samples.ctypes.data),
        *(c.byref(steps), c.byref(failed), memory.ctypes.data),
    )
    ends = indentation, speeds, found, structure, samples
    return Run(status, time.value, steps.value, *ends, failed.value, modes)

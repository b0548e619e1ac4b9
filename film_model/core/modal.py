"""The core's contact on modes, seen from Python. Nothing else calls it or knows its structures (film_modal.h)."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import native
from film_model.core.headers import Header
from film_model.core.native import Curve

MODAL = Header("modal/film_modal.h", native.CORE)
LEVELS, MODES_OF_A_STEP, MOST_WORK = MODAL.film("LEVELS", "MODES_OF_A_STEP", "MOST_WORK")
"""Step sizes; and the limit of an impact: MOST_WORK over modes + MODES_OF_A_STEP is the largest number of steps."""

MOST_MEMORY = 256 * 2**20
"""Limit of a record, bytes: that of an impact within the limit of work on few modes."""

_ROOM, _MOST_ROOM = 512, 1 << 16  # segments that a record has room for at first and at most before it is extended


@MODAL.structure("film_structure")
class Structure(c.Structure):
    """Modes, and tables for the step sizes in use."""


@MODAL.structure("film_modal_start")
class Start(c.Structure):
    """How an impact on a structure starts."""


@MODAL.structure("film_modal")
class Modal(c.Structure):
    """A contact on a structure at one moment; with the modes' array beside it the whole state."""


@MODAL.structure("film_modal_segment")
class Segment(c.Structure):
    """One step in contact, or one flight."""


@MODAL.structure("film_modal_event")
class Event(c.Structure):
    """An event, with the five values of `native.motion`."""


@MODAL.structure("film_modal_summary")
class Summary(c.Structure):
    """What an impact on a structure did."""


@MODAL.structure("film_modal_record")
class Record(c.Structure):
    """Arrays to record in, and how much of each is filled."""


START_DTYPE = np.dtype(Start)
SEGMENT_DTYPE = np.dtype(Segment)
EVENT_DTYPE = np.dtype(Event)
SUMMARY_DTYPE = np.dtype(Summary)


_library = native.with_functions(MODAL, sizes=("film_modal_sizes", Structure, Modal, Start, Segment, Event, Summary))


class Tables:
    """Modes in the core's form, with tables that are made on demand and kept; used by one thread at a time.

    frequency [rad/s], share [1/kg], damping ratio: ascending frequencies. longest: largest step, s. Raises ValueError
    for modes that are no motion of a structure. Memory: 17 floats for each mode and step size in use.
    """

    def __init__(
        self, frequency: Array, share: Array, ratio: Array, longest: float, forms: Array | None = None
    ) -> None:
        self.frequency, self.share, self.ratio = (
            np.ascontiguousarray(column, dtype=np.float64) for column in (frequency, share, ratio)
        )
        self.longest = longest
        if not self.frequency.shape == self.share.shape == self.ratio.shape == (self.frequency.size,):
            raise ValueError("modes need as many shares and damping ratios as frequencies")
        lib = _library()
        self.lock = Lock()
        self.native = Structure()
        self._memory = np.empty(lib.film_structure_size(self.frequency.size, LEVELS))
        columns = [column.ctypes.data for column in (self.frequency, self.share, self.ratio)]
        given = self.frequency.size, *columns, longest, LEVELS, self._memory.ctypes.data
        status = lib.film_structure_init(c.byref(self.native), *given)
        if status != native.OK:
            raise ValueError(_wrong(self.frequency, self.share, self.ratio))
        self.forms = np.zeros((0, 0, 0)) if forms is None else np.ascontiguousarray(forms, dtype=np.float64)
        sizes = self.forms.shape[1], self.forms.shape[0]
        if lib.film_structure_stretch(c.byref(self.native), *sizes, self.forms.ctypes.data) != native.OK:
            raise ValueError(f"forms of the shape {self.forms.shape} do not suit {self.count} modes")
        self.waves = lib.film_waves_size(c.byref(self.native))

    def __reduce__(self) -> tuple[Any, ...]:
        return Tables, (self.frequency, self.share, self.ratio, self.longest, self.forms)

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.frequency.size


def _wrong(frequency: Array, share: Array, ratio: Array) -> str:
    """What is wrong with modes that the core refuses."""
    names = (("frequency", frequency, "finite and >= 0 rad/s"), ("share", share, "finite and > 0 1/kg"))
    for name, column, rule in (*names, ("damping ratio", ratio, "from 0 to 1")):
        good = np.isfinite(column) & (column >= 0.0) & ((name != "share") | (column > 0.0))
        good &= (name != "damping ratio") | (column <= 1.0)
        if not good.all():
            n = int(np.argmin(good))
            return f"mode {n + 1}: {name} {column[n]:g} must be {rule}"
    falls = np.flatnonzero(np.diff(frequency) < 0.0)
    if falls.size:
        n = int(falls[0])
        return f"mode {n + 2}: frequency {frequency[n + 1]:g} rad/s must not be below that of mode {n + 1}"
    return "the modes are outside the solver's range"


@dataclass(frozen=True)
class Impact:
    """A recorded impact. status: as `native.record`. segments (SEGMENT_DTYPE), events (EVENT_DTYPE), flights: modal
    states, one row per flight; energies: of each mode at the end, over F_s δ_s. stretching: that of the
    membrane forces then."""

    status: int
    summary: Summary
    segments: NDArray[Any]
    events: NDArray[Any]
    flights: Array
    energies: Array
    stretching: float = 0.0


class _Room:
    """Arrays for a record."""

    def __init__(self, modes: int, segments: int) -> None:
        self.modes = modes
        flights = min(max(segments // 16, 4), max(MOST_MEMORY // (32 * modes + 1), 4))
        self.segments = np.empty(segments * SEGMENT_DTYPE.itemsize, np.uint8)
        self.events = np.empty(segments * EVENT_DTYPE.itemsize, np.uint8)
        self.flights = np.empty((flights, 2 * modes))
        arrays = (self.segments, self.events, self.flights)
        self.native = Record(*(array.ctypes.data for array in arrays), segments, segments, flights, 0, 0, 0)

    def filled(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8], Array]:
        """What is filled: bytes of segments and events, and flights."""
        at = self.native
        segments = self.segments[: at.segment_count * SEGMENT_DTYPE.itemsize]
        return segments, self.events[: at.event_count * EVENT_DTYPE.itemsize], self.flights[: at.flight_count]


def impact(tables: Tables, curve: Curve, start: Start, expected: int = 0, recorded: bool = True) -> Impact:
    """One impact, with its record or, in less time, without. native.TOO_MANY: its record would need more than
    `MOST_MEMORY`. expected: number of segments for which there is room at once, which saves time if they are many."""
    with tables.lock:
        if recorded:
            return _impact(tables, curve, start, min(max(expected, _ROOM), _MOST_ROOM))
        return _unrecorded(tables, curve, start)


def _unrecorded(tables: Tables, curve: Curve, start: Start) -> Impact:
    state, summary, waves = Modal(), Summary(), np.empty(tables.waves)
    own = c.byref(state), waves.ctypes.data
    status = _library().film_modal_impact(
        c.byref(tables.native), c.byref(curve), c.byref(start), *own, c.byref(summary), None
    )
    none = np.empty(0, SEGMENT_DTYPE), np.empty(0, EVENT_DTYPE), np.empty((0, 2 * tables.count))
    return Impact(status, summary, *none, *_energies(tables, state, waves))


def _energies(tables: Tables, state: Modal, waves: Array) -> tuple[Array, float]:
    """Of each mode, and of the membrane forces."""
    lib, energies = _library(), np.empty(tables.count)
    own = c.byref(tables.native), c.byref(state), waves.ctypes.data
    lib.film_modal_energies(*own, energies.ctypes.data)
    return energies, lib.film_modal_stretching(*own)


def _impact(tables: Tables, curve: Curve, start: Start, expected: int) -> Impact:
    lib, state, summary = _library(), Modal(), Summary()
    waves = np.empty(tables.waves)
    at = c.byref(tables.native), c.byref(curve)
    room, parts, size = _Room(tables.count, expected), list[tuple[Any, Any, Array]](), 0
    own = c.byref(state), waves.ctypes.data, c.byref(summary)
    status = lib.film_modal_impact(*at, c.byref(start), *own, c.byref(room.native))
    while status == native.FULL:
        parts.append(room.filled())
        size += sum(array.nbytes for array in parts[-1])
        if size > MOST_MEMORY:
            status = native.TOO_MANY
            break
        room = _Room(tables.count, min(2 * room.native.segment_room, _MOST_ROOM))
        status = lib.film_modal_go_on(*at, start.limit, *own, c.byref(room.native))
    else:
        parts.append(room.filled())
    kept = 0
    for part in parts:  # flights count from 0 in each part
        flight = part[0].view(SEGMENT_DTYPE)["flight"]
        flight[flight >= 0] += kept
        kept += len(part[2])
    segments, events, flights = (_joined(columns) for columns in zip(*parts, strict=True))
    record = segments.view(SEGMENT_DTYPE), events.view(EVENT_DTYPE), flights
    return Impact(status, summary, *record, *_energies(tables, state, waves))


def _joined(parts: tuple[NDArray[Any], ...]) -> NDArray[Any]:
    """The parts as one array. A large one that is alone stays where it is: memory that is not filled costs nothing."""
    large = 1 << 20  # bytes that are not copied out of their room
    alone = parts[0].nbytes > large and not any(len(part) for part in parts[1:])
    return parts[0] if alone else np.concatenate(parts)


class Motion:
    """A contact on a structure that is advanced in steps; times in the structure's unit. Raises ValueError for a start
    that the core refuses. `tables` may be shared with other motions."""

    def __init__(self, tables: Tables, curve: Curve, start: Start, gap: float = 0.0) -> None:
        self.tables, self.curve, self.state = tables, curve, Modal()
        self._waves, self._values = np.zeros(tables.waves), np.empty(5)
        state = c.byref(self.state)
        status = _library().film_modal_init(
            c.byref(tables.native), c.byref(curve), state, self._waves.ctypes.data, c.byref(start), -gap
        )
        if status != native.OK:
            numbers = ", ".join(f"{name}={getattr(start, name)!r}" for name in (field[0] for field in Start._fields_))
            raise ValueError(f"the core refuses the start {numbers}, gap={gap!r}")

    def pointers(self) -> tuple[Any, ...]:
        """Structure, curve, state and waves, for the core."""
        return c.byref(self.tables.native), c.byref(self.curve), c.byref(self.state), self._waves.ctypes.data

    def set_input(self, load: float, nu_change: float, stop_velocity: float) -> int:
        """As `native.set_input`; the core's status."""
        return _library().film_modal_input(*self.pointers(), load, nu_change, stop_velocity)

    def step(self, dt: float) -> int:
        """Forward by dt or to the next event; the core's status."""
        with self.tables.lock:
            return _library().film_modal_step(*self.pointers(), dt)

    def values(self) -> Array:
        """ξ, ξ', f, ν and displacement of the struck point now."""
        _library().film_modal_motion(*self.pointers(), self._values.ctypes.data)
        return self._values

    def sensed(self, weights: Array) -> Array:
        """Displacement, velocity and acceleration of points of the structure now: (3, points). weights: (points,
        modes), the deflection of each mode there over that at the struck point."""
        found, structure, _, *own = np.empty((len(weights), 3)), *self.pointers()
        _library().film_modal_sensed(structure, *own, len(weights), weights.ctypes.data, found.ctypes.data)
        return found.T

    def save(self) -> bytes:
        """The whole state."""
        return bytes(self.state) + self._waves.tobytes()

    def restore(self, saved: bytes) -> None:
        """Return to a saved state."""
        size = c.sizeof(Modal)
        self.state, self._waves = Modal.from_buffer_copy(saved), np.frombuffer(saved[size:]).copy()


def batch(tables: Tables, curve: Curve, start: NDArray[Any]) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries (SUMMARY_DTYPE) of many impacts (START_DTYPE) on one structure; the GIL is released."""
    start = np.ascontiguousarray(start, dtype=START_DTYPE)
    summary, status = np.zeros(start.size, SUMMARY_DTYPE), np.empty(start.size, np.int32)
    waves = np.empty(tables.waves)
    with tables.lock:
        at = [array.ctypes.data for array in (start, waves, summary, status)]
        _library().film_modal_batch(c.byref(tables.native), c.byref(curve), start.size, *at)
    return status, summary


def sample(
    tables: Tables, curve: Curve, segments: NDArray[Any], flights: Array, times: Array
) -> tuple[Array, NDArray[np.int8]]:
    """(count, 5) values as of `native.sample` at ascending times [s], and branch of each."""
    times = np.ascontiguousarray(times, dtype=np.float64)
    values, branches = np.empty((times.size, 5)), np.empty(times.size, np.int8)
    record = c.byref(tables.native), c.byref(curve), segments.ctypes.data, len(segments), flights.ctypes.data
    found = times.size, values.ctypes.data, branches.ctypes.data
    _library().film_modal_sample(*record, times.ctypes.data, *found)
    return values, branches


def felt(frequency: Array, share: Array, *numbers: float) -> tuple[float, bool]:
    """The part of a structure's compliance that a contact feels, and whether there are slower modes: film_modal.h.
    numbers: rest, mass, shortest contact time, softness of the contact and `slow`."""
    columns = [np.ascontiguousarray(column, np.float64) for column in (frequency, share)]
    free = c.c_int32()
    at = frequency.size, *(column.ctypes.data for column in columns)
    found = _library().film_modal_felt(*at, *numbers, c.byref(free))
    return found, free.value > 0


def still(curve: Curve, approach: float) -> native.Summary:
    """The impact on a target that does not move, as film_modal_still has it."""
    summary = native.Summary()
    _library().film_modal_still(c.byref(curve), approach, c.byref(summary))
    return summary

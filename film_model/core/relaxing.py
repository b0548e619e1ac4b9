"""The core's contact of bodies that relax, seen from Python. Nothing else knows its structures (film_relax.h)."""

from __future__ import annotations

import ctypes as c
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import native
from film_model.core.headers import Header

RELAX = Header("relax/film_relax.h", native.CORE)
MOST_TERMS, MOST_STEPS = RELAX.film("RELAXATIONS", "RELAX_STEPS")


@RELAX.structure("film_relaxation")
class Law(c.Structure):
    """e(t) = rest + Σ share exp(−rate t), rates in 1/t_s."""


@RELAX.structure("film_relax_step")
class Step(c.Structure):
    """A step of a contact."""


@RELAX.structure("film_relax")
class State(c.Structure):
    """A contact at one moment; with the steps beside it the whole state."""


LAW_DTYPE = np.dtype(Law)


_library = native.with_functions(RELAX, sizes=("film_relax_sizes", Law, Step, State))


class _Room(local):
    """State and steps for impacts of which only the summary is kept, one pair for each thread."""

    def __init__(self) -> None:
        self.state, self.steps = State(), (Step * MOST_STEPS)()


_ROOM = _Room()


def impact(law: Law, start: native.Start, tolerance: float) -> tuple[int, native.Summary]:
    """Status and summary of one contact."""
    summary = native.Summary()
    at = c.byref(_ROOM.state), _ROOM.steps
    status = _library().film_relax_impact(c.byref(law), c.byref(start), tolerance, *at, c.byref(summary))
    return status, summary


def batch(laws: NDArray[Any], start: NDArray[Any], tolerance: float) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries (native.SUMMARY_DTYPE) of many contacts (LAW_DTYPE, native.START_DTYPE)."""
    start, laws = np.ascontiguousarray(start, native.START_DTYPE), np.ascontiguousarray(laws, LAW_DTYPE)
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    tables = laws.ctypes.data, start.ctypes.data, tolerance
    _library().film_relax_batch(
        start.size, *tables, c.byref(_ROOM.state), _ROOM.steps, summary.ctypes.data, status.ctypes.data
    )
    return status, summary


class _Stepped:
    """What has steps: its pickle has their bytes."""

    _steps: Any

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_steps": bytes(self._steps)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        content: bytes = state["_steps"]
        self.__dict__.update(state, _steps=(Step * (len(content) // c.sizeof(Step))).from_buffer_copy(content))


class Motion(_Stepped):
    """A contact that is advanced in steps; times in t_s. Raises ValueError for a start that the core refuses."""

    def __init__(self, law: Law, start: native.Start, tolerance: float, gap: float = 0.0) -> None:
        self.state, self._steps, self._values = State(), (Step * MOST_STEPS)(), np.empty(5)
        status = _library().film_relax_init(c.byref(self.state), c.byref(law), c.byref(start), tolerance, -gap)
        if status != native.OK:
            raise ValueError(f"the core refuses nu={start.nu!r}, load={start.load!r}, gap={gap!r}")

    def step(self, dt: float) -> int:
        """Forward by dt or to the next event; the core's status."""
        return _library().film_relax_advance(c.byref(self.state), self._steps, dt)

    def set_input(self, load: float, nu_change: float, stop_velocity: float) -> int:
        """As `native.set_input`; the core's status."""
        return _library().film_relax_input(c.byref(self.state), self._steps, load, nu_change, stop_velocity)

    def values(self) -> Array:
        """ξ, ξ', f, ν and target displacement now."""
        _library().film_relax_motion(c.byref(self.state), self._steps, self._values.ctypes.data)
        return self._values

    @property
    def left(self) -> float:
        """Depth that the surface has not yet recovered from the contacts before; 0 during a contact."""
        return _library().film_relax_left(c.byref(self.state), self._steps)

    @property
    def time(self) -> float:
        """Time since the start."""
        return self.state.time + self.state.tau

    def save(self) -> bytes:
        """The whole state."""
        return bytes(self.state) + bytes(self._steps)[: self.state.steps * c.sizeof(Step)]

    def restore(self, saved: bytes) -> None:
        """Return to a saved state."""
        size = c.sizeof(State)
        self.state = State.from_buffer_copy(saved)
        c.memmove(self._steps, saved[size:], len(saved) - size)


class Record(_Stepped):
    """One contact with its steps. status: as of :func:`impact`."""

    def __init__(self, law: Law, start: native.Start, tolerance: float) -> None:
        self.summary, self._state, steps = native.Summary(), State(), (Step * MOST_STEPS)()
        at = c.byref(self._state), steps, c.byref(self.summary)
        self.status = _library().film_relax_impact(c.byref(law), c.byref(start), tolerance, *at)
        self._steps = (Step * max(self._state.steps, 1)).from_buffer_copy(steps)

    def sample(self, times: Array) -> tuple[Array, NDArray[np.int8]]:
        """(count, 5) values as of `native.sample` at ascending times, and branch of each; free flight after the end."""
        times = np.ascontiguousarray(times, dtype=np.float64)
        values, branches = np.empty((times.size, 5)), np.empty(times.size, np.int8)
        at = times.ctypes.data, times.size, values.ctypes.data, branches.ctypes.data
        _library().film_relax_sample(c.byref(self._state), self._steps, *at)
        return values, branches

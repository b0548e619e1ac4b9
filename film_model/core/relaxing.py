"""The core's contact of bodies that relax, seen from Python. Nothing else knows its structures (film_relax.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native

Array = NDArray[np.float64]

MOST_TERMS, MOST_STEPS = 24, 600
_D, _I = c.c_double, c.c_int32
_TERMS = _D * MOST_TERMS


class Law(c.Structure):
    """film_relaxation: e(t) = rest + Σ share exp(−rate t), rates in 1/t_s."""

    _fields_ = [("terms", _I), ("reserved", _I), ("rest", _D), ("share", _TERMS), ("rate", _TERMS)]


class Step(c.Structure):
    """film_relax_step: a step of a contact."""

    _fields_ = (
        [(name, _D) for name in ("time", "h", "length", "xi", "nu", "shift", "load")]
        + [("force", _D * 4), ("rate", _D * 5), ("grown", _D * 6)]
        + [("q", _TERMS), ("p", _TERMS)]
    )


class State(c.Structure):
    """film_relax: a contact at one moment; with the steps beside it the whole state."""

    _fields_ = (
        [("law", Law)]
        + [(name, _D) for name in ("gamma", "load", "stop_velocity", "tolerance", "speed")]
        + [(name, _D) for name in ("time", "xi", "nu", "shift", "tau", "stop_at")]
        + [("q", _TERMS), ("p", _TERMS), ("old", _TERMS)]
        + [(name, _D) for name in ("next_h", "begun", "turned", "match", "peak", "spent")]
        + [(name, _I) for name in ("approach", "steps", "ends", "moving_in", "has_step")]
        + [(name, _I) for name in ("branch", "phase", "event", "contacts", "reserved")]
    )


LAW_DTYPE = np.dtype(Law)


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_relax.h declared."""
    lib, pointer, i64 = native.library(), c.c_void_p, c.c_int64
    signatures: dict[str, tuple[list[Any], Any]] = {
        "film_relax_init": ([pointer, pointer, pointer, _D, _D], c.c_int),
        "film_relax_input": ([pointer, pointer, _D, _D, _D], c.c_int),
        "film_relax_advance": ([pointer, pointer, _D], c.c_int),
        "film_relax_motion": ([pointer, pointer, pointer], None),
        "film_relax_impact": ([pointer, pointer, _D, pointer, pointer, pointer], c.c_int),
        "film_relax_batch": ([i64, pointer, pointer, _D, pointer, pointer, pointer, pointer], None),
        "film_relax_sample": ([pointer, pointer, pointer, i64, pointer, pointer], None),
        "film_relax_left": ([pointer, pointer], _D),
        "film_relax_sizes": ([pointer], None),
    }
    for name, (arguments, result) in signatures.items():
        function = getattr(lib, name)
        function.argtypes = arguments
        function.restype = result
    sizes = (c.c_int64 * 3)()
    lib.film_relax_sizes(sizes)
    if list(sizes) != [c.sizeof(t) for t in (Law, Step, State)]:
        raise ImportError("the core was built from other sources: install the package again (pip install .)")
    return lib


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

"""The compiled core, seen from Python. Nothing else loads the library or knows its structures (film_core.h)."""

from __future__ import annotations

import ctypes as c
import os
import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAX_STAGES, MAX_PIECES, MAX_TERMS, MAX_SEGMENTS, INDICATORS = 12, 64, 26, 4_000_000, 5
POWER, SERIES, ROOT_SERIES = range(3)
RETRACE, RADIUS, RESIDUAL, SECANT, SHIFTED, SIMILAR = range(6)
CHORD, WORK_PRESERVING = range(2)
ANY_WAY, LINES = range(2)
INSTRUCTIONS = ("plain", "AVX2", "AVX-512")
BRANCH, FREE, STRETCHED = -1, -2, -3
BRANCH_NAMES = {BRANCH: "unloading", FREE: ""}

EVENTS = (
    "",
    "contact_begins",
    "stage_changes",
    "maximum_indentation",
    "impactor_stops",
    "contact_ends",
    "reloading_begins",
)
PHASES = ("approaching", "loading", "unloading", "reloading", "resting", "separated")
OK, EVENT, ENDLESS, TURNS_AGAIN, REMEMBERS = 0, 1, 2, -9, -10
BAD_NUMBER, BAD_CURVE, BAD_MESH, BEYOND_LAW, TOO_MANY, BAD_UNLOADING, FULL, TOO_STIFF = range(-1, -9, -1)

_D, _I, _GRADINGS, _BEGIN = c.c_double, c.c_int32, 6, c.c_char * 0
_MOST_ROOM, _MOST_EVENTS = 4_000_000, 200_000  # lines and events of a recorded contact, beyond which it will not end


class Function(c.Structure):
    """film_function: a function of indentation that the core can evaluate."""

    _fields_ = (
        [("form", _I), ("terms", _I)]
        + [(name, _D) for name in ("origin", "per_span", "constant", "slope", "coefficient", "exponent")]
        + [("series", _D * MAX_TERMS)]
    )


class Piece(c.Structure):
    """film_piece: one piece of a stage, and how a contact that turns in it opens."""

    _fields_ = [
        ("end", _D),
        ("work_at_begin", _D),
        ("force", Function),
        ("mean", Function),
        ("recovery", Function),
        ("damping", Function),
        ("exponent", Function),
    ]


class Stage(c.Structure):
    """film_stage: one loading stage."""

    _fields_ = (
        [("begin", _D), ("end", _D)]
        + [(name, _I) for name in ("first", "count", "unloading", "damped")]
        + [("reload_exponent", _D)]
    )


class Curve(c.Structure):
    """film_curve: a law as the core sees it, in series with a spring if it has a compliance."""

    _fields_ = [
        ("stages", _I),
        ("pieces", _I),
        ("stage", Stage * MAX_STAGES),
        ("piece", Piece * MAX_PIECES),
        *((name, _D) for name in ("compliance", "pull")),
    ]


class Mesh(c.Structure):
    """film_mesh: how legs are cut into lines. `memory` is kept alive by the owner."""

    _fields_ = [
        ("linearisation", _I),
        ("loading", _I),
        ("unloading", _I),
        ("ways", _I),
        ("loading_nodes", c.c_void_p * _GRADINGS),
        ("unloading_nodes", c.c_void_p * _GRADINGS),
    ]

    def __reduce__(self) -> tuple[Any, ...]:
        return mesh, (self.linearisation, self.loading, self.unloading)  # a copy of the pointers would outlive `memory`


_LINE = (
    *((name, _D) for name in ("time", "xi", "nu", "shift", "phi", "kappa", "work", "spent", "load", "gamma")),
    *((name, _D) for name in ("xi_free", "per_recovery", "f_max", "exponent", "xi_origin", "f_shift", "work_free")),
    ("damping", _D),
    ("damper", _D),
    ("branch", _I),
    ("phase", _I),
)


class Line(c.Structure):
    """film_line: one straight piece of the force, on which the motion is closed-form."""

    _fields_ = list(_LINE)


class State(c.Structure):
    """film_state: everything about an impact at one moment; copying it saves it."""

    _fields_ = (
        [(name, _D) for name in ("time", "time_low", "xi", "nu", "shift", "force", "work", "spent", "force_peak")]
        + [(name, _D) for name in ("gamma", "load", "stop_velocity", "damper", "elastic")]
        + [(name, _D) for name in ("xi_max", "f_max", "xi_free", "recovery", "exponent")]
        + [(name, _D) for name in ("xi_origin", "f_scale", "xi_in", "f_in", "xi_out", "f_out")]
        + [("leg_from", _D), ("leg_to", _D)]
        + [(name, _I) for name in ("leg_node", "leg_nodes", "leg_grading", "leg_ends")]
        + [(name, _D) for name in ("tau", "tau_low", "tau_end")]
        + [(name, _D) for name in ("xi_end", "nu_end", "force_end", "work_end")]
        + [("line", Line)]
        + [(name, _I) for name in ("line_ends", "has_line", "has_leg", "from_turn", "direction", "branch")]
        + [
            (name, _I)
            for name in ("stage_max", "moving_in", "loop", "rising", "jumped", "phase", "event", "contacts", "lines")
        ]
    )


SUMMARY = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "time_impactor_stops",
    "contact_duration",
    "permanent_indentation",
    "final_velocity",
    "shift",
    "work",
)


class Start(c.Structure):
    """film_start: how one contact starts."""

    _fields_ = [(name, _D) for name in ("nu", "gamma", "load", "stop_velocity", "time_limit", "damping")]


class Force(c.Structure):
    """film_contact: the contact force, and its partial derivatives by ξ and ν."""

    _fields_ = [(name, _D) for name in ("force", "by_xi", "by_nu")]


class Summary(c.Structure):
    """film_summary: what one contact did."""

    _fields_ = [(name, _D) for name in SUMMARY] + [("stage", _I), ("lines", _I)]


class Solution(c.Structure):
    """film_solution: one contact to an accuracy."""

    _fields_ = [("summary", Summary), ("estimated", _D), ("level", _I), ("reached", _I)]


START_DTYPE, LINE_DTYPE, STATE_DTYPE, SUMMARY_DTYPE = (np.dtype(kind) for kind in (Start, Line, State, Summary))


def _library_path() -> str:
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    return os.path.join(os.path.dirname(__file__), "_film_core" + suffix)


@lru_cache(maxsize=1)
def library() -> Any:
    """The shared library, loaded once; ImportError, with how to build it, if it is missing or of other sources."""
    path = _library_path()
    if not os.path.exists(path):
        raise ImportError(f"{path} is missing: install the package (pip install .), which compiles it")
    lib = c.CDLL(path)
    sizes = (c.c_int64 * 5)()
    lib.film_sizes(sizes)
    if list(sizes) != [c.sizeof(t) for t in (Curve, Mesh, Line, State, Summary)]:
        raise ImportError(f"{path} was built from other sources: install the package again (pip install .)")
    pointer, i64 = c.c_void_p, c.c_int64
    signatures: dict[str, tuple[list[Any], Any]] = {
        "film_check_curve": ([pointer], c.c_int),
        "film_shape_at": ([pointer, pointer, pointer, pointer], c.c_int),
        "film_spring": ([pointer, _D], c.c_int),
        "film_mesh_size": ([_I, _I], c.c_size_t),
        "film_mesh_init": ([pointer, _I, _I, _I, pointer], c.c_int),
        "film_damp": ([pointer, _D], c.c_int),
        "film_init": ([pointer, pointer, _D, _D, _D, _D, _D], c.c_int),
        "film_input": ([pointer, _D, _D, _D], c.c_int),
        "film_step": ([pointer, pointer, pointer, _D], c.c_int),
        "film_record": ([pointer, pointer, pointer, _D, pointer, _I, pointer, pointer, _I, pointer], c.c_int),
        "film_sample": ([pointer, pointer, _I, pointer, i64, pointer, pointer, pointer], None),
        "film_record_many": ([pointer, pointer, i64, pointer, pointer, i64, pointer, pointer, _I], i64),
        "film_sample_many": ([c.c_int, pointer, i64, pointer, pointer, i64, pointer, pointer], None),
        "film_line_columns": ([i64, pointer, i64, pointer, pointer], None),
        "film_motion": ([pointer, pointer, pointer], None),
        "film_force": ([pointer, pointer, _D, _D], Force),
        "film_indicators": ([pointer, pointer, _D, pointer], None),
        "film_switch": ([pointer, pointer], c.c_int),
        "film_law": ([pointer, _I, _D, pointer, pointer], None),
        "film_impact": ([pointer, pointer, pointer, pointer], c.c_int),
        "film_marched": ([pointer, pointer, pointer, pointer], c.c_int),
        "film_instructions": ([], c.c_int),
        "film_batch_shaped": ([c.c_int, pointer, pointer, pointer, i64, pointer, pointer, pointer, pointer], None),
        "film_solve": ([pointer, pointer, pointer, _I, _D, _D, pointer], c.c_int),
        "film_estimate": ([pointer, pointer, pointer, _D, pointer], c.c_int),
        "film_bound_fine": ([pointer, c.c_int, i64, pointer, pointer, pointer, pointer, pointer, pointer], None),
        "film_bound_coarse": ([pointer, i64, pointer, pointer, pointer, pointer], None),
        "film_compare": ([i64, pointer, pointer, pointer, pointer], None),
        "film_rounding": ([pointer, i64, pointer, pointer, _D, pointer], None),
        "film_dents": ([pointer, i64, c.c_int32, pointer, pointer, pointer, pointer, pointer], None),
        "film_batch_with": ([c.c_int, pointer, pointer, i64, pointer, pointer, pointer], None),
    }
    for name, (arguments, result) in signatures.items():
        function = getattr(lib, name)
        function.argtypes = arguments
        function.restype = result
    return lib


@lru_cache(maxsize=64)
def mesh(linearisation: int, loading: int, unloading: int, ways: int = ANY_WAY) -> Mesh:
    """The mesh for these segment counts (1 to MAX_SEGMENTS each). ways: with `LINES`, impacts take its lines only."""
    lib = library()
    made = Mesh()
    memory = np.empty(lib.film_mesh_size(loading, unloading))
    status = lib.film_mesh_init(c.byref(made), linearisation, loading, unloading, memory.ctypes.data)
    if status != OK:
        raise ValueError(f"segments {loading} and {unloading} must be 1 to {MAX_SEGMENTS}")
    made.memory, made.ways = memory, ways
    return made


def at(memory: Any) -> Any:
    """Where a new array begins, for the core; `memory.ctypes` takes three times as long."""
    return c.byref(_BEGIN.from_buffer(memory))


def initial_state(curve: Curve, start: Start, gap: float = 0.0) -> State:
    """The state at `gap` before first touch, on a spot without a dent."""
    state = State()
    status = library().film_init(
        c.byref(curve), c.byref(state), -gap, start.nu, start.gamma, start.load, start.stop_velocity
    )
    if status == OK:
        status = library().film_damp(c.byref(state), start.damping)
    if status != OK:
        raise ValueError(
            f"the core refuses nu={start.nu!r}, gamma={start.gamma!r}, load={start.load!r}, damping={start.damping!r}, "
            f"gap={gap!r}"
        )
    return state


def step(curve: Curve, cut: Mesh, state: State, dt: float) -> int:
    """Advance `state` in place by dt or to the next event; the core's status."""
    return library().film_step(c.byref(curve), c.byref(cut), c.byref(state), dt)


def set_input(state: State, load: float, nu_change: float, stop_velocity: float) -> int:
    """Change load, velocity (by a step of the support) and stop velocity in place; the core's status."""
    return library().film_input(c.byref(state), load, nu_change, stop_velocity)


def record(curve: Curve, cut: Mesh, state: State, limit: float, room: int) -> tuple[int, NDArray[Any], NDArray[Any]]:
    """Status, lines and event states from `state`, which is moved on, to the end of the next contact or to `limit`."""
    most, count, events_count, begun = min(room, _MOST_EVENTS), _I(), _I(), bytes(state)
    lines, events = (np.empty(n * t.itemsize, np.uint8) for n, t in ((room, LINE_DTYPE), (most, STATE_DTYPE)))
    status = library().film_record(
        *(c.byref(curve), c.byref(cut), c.byref(state), limit),
        *(at(lines), room, c.byref(count), at(events), most, c.byref(events_count)),
    )
    if status == FULL and room <= _MOST_ROOM and events_count.value < _MOST_EVENTS:
        c.memmove(c.byref(state), begun, len(begun))
        return record(curve, cut, state, limit, 4 * room)
    tables = _rows(lines, count.value, LINE_DTYPE), _rows(events, events_count.value, STATE_DTYPE)
    return TOO_MANY if status == FULL else status, *tables


def _rows(memory: NDArray[np.uint8], count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """A copy of the first rows of a table; copying an array of structures takes ten times as long."""
    return np.ndarray(count, dtype, memory[: count * dtype.itemsize].copy())


def sample(
    curve: Curve, lines: NDArray[Any], times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int8], NDArray[np.int8]]:
    """(count, 5) values ξ, ξ', f, ν, target displacement at ascending times; branch and phase of each."""
    if len(lines) == 0:
        raise ValueError("there are no lines to sample")
    times = np.ascontiguousarray(times, dtype=np.float64)
    values = np.empty((times.size, 5))
    stages, phases = np.empty(times.size, np.int8), np.empty(times.size, np.int8)
    lib = library()
    lib.film_sample(
        c.byref(curve),
        lines.ctypes.data,
        len(lines),
        times.ctypes.data,
        times.size,
        values.ctypes.data,
        stages.ctypes.data,
        phases.ctypes.data,
    )
    return values, stages, phases


def impact(curve: Curve, cut: Mesh, start: Start) -> tuple[int, Summary]:
    """Status and summary of one contact: those of a batch of one, but for the quadrature's error on fixed targets."""
    return _contact(library().film_impact, curve, cut, start)


def marched(curve: Curve, cut: Mesh, start: Start) -> tuple[int, Summary]:
    """As `impact`, by the lines that `record` records."""
    return _contact(library().film_marched, curve, cut, start)


def _contact(function: Any, curve: Curve, cut: Mesh, start: Start) -> tuple[int, Summary]:
    summary = Summary()
    return function(c.byref(curve), c.byref(cut), c.byref(start), c.byref(summary)), summary


@lru_cache(maxsize=1)
def instructions() -> int:
    """The widest instructions the processor has, an index into INSTRUCTIONS."""
    return library().film_instructions()


def batch(
    curve: Curve, cut: Mesh, start: NDArray[Any], using: int | None = None
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries (SUMMARY_DTYPE) of many contacts on one curve (START_DTYPE); the GIL is released.

    using: instructions, at most `instructions()`, which is the default; the results are the same to the last bit.
    """
    start = np.ascontiguousarray(start, dtype=START_DTYPE)
    memory, status = np.empty(start.size * SUMMARY_DTYPE.itemsize, np.uint8), np.empty(start.size, np.int32)
    own = c.byref(curve), c.byref(cut), start.size, start.ctypes.data, at(memory), at(status)
    library().film_batch_with(instructions() if using is None else using, *own)
    return status, np.ndarray(start.size, SUMMARY_DTYPE, memory)


def force_of(curve: Curve, state: State) -> Callable[[float], float]:
    """f(ξ) as the contact of `state` is at the time of each call."""
    at = c.byref(curve), c.byref(state)
    function = library().film_force
    return lambda xi: function(*at, xi, state.nu).force


def indicators(curve: Curve, state: State, speed: float) -> list[float]:
    """film_indicators: all > 0 while the contact goes on as it is."""
    values = (_D * INDICATORS)()
    library().film_indicators(c.byref(curve), c.byref(state), speed, values)
    return list(values)


def switch(curve: Curve, state: State) -> list[tuple[str, int]]:
    """Names of the events that are due in `state`, made in place, and the branch after each."""
    made: list[tuple[str, int]] = []
    while (status := library().film_switch(c.byref(curve), c.byref(state))) == EVENT:
        made.append((EVENTS[state.event], state.branch))
    if status != OK:
        raise ValueError(f"the core refuses to go on from ξ = {state.xi!r} (status {status})")
    return made


def motion(curve: Curve, state: State) -> NDArray[np.float64]:
    """Indentation, its rate, force, ν and displacement of the struck point, as `sample` has them."""
    values = np.empty(5)
    library().film_motion(c.byref(curve), c.byref(state), values.ctypes.data)
    return values


def stage_law(curve: Curve, stage: int, xi: float) -> tuple[float, float]:
    """Force and work (from the stage's beginning) as the core evaluates them."""
    force, work = _D(), _D()
    library().film_law(c.byref(curve), stage, xi, c.byref(force), c.byref(work))
    return force.value, work.value

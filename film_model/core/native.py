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

from film_model.base.arrays import Array
from film_model.core.headers import Header, check_sizes

CORE = Header("film_core.h")
MAX_STAGES, MAX_PIECES, MAX_TERMS, MAX_SEGMENTS = CORE.film("MAX_STAGES", "MAX_PIECES", "MAX_TERMS", "MAX_SEGMENTS")
INDICATORS, _MOST_EVENTS = CORE.film("INDICATORS", "MAX_EVENTS")
POWER, SERIES, ROOT_SERIES = CORE.film("POWER", "SERIES", "ROOT_SERIES")
RETRACE, RADIUS, RESIDUAL, SECANT, SHIFTED, SIMILAR = CORE.film(
    "RETRACE", "RADIUS", "RESIDUAL", "SECANT", "SHIFTED", "SIMILAR"
)
CHORD, WORK_PRESERVING = CORE.film("CHORD", "WORK_PRESERVING")
ANY_WAY, LINES = CORE.film("ANY_WAY", "LINES")
INSTRUCTIONS = ("plain", "AVX2", "AVX-512")
BRANCH, FREE, STRETCHED = CORE.film("BRANCH", "FREE", "STRETCHED")
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
OK, EVENT, ENDLESS, TURNS_AGAIN, REMEMBERS = CORE.film("OK", "EVENT", "ENDLESS", "TURNS_AGAIN", "REMEMBERS")
BAD_NUMBER, BAD_CURVE, BAD_MESH, BEYOND_LAW = CORE.film("BAD_NUMBER", "BAD_CURVE", "BAD_MESH", "BEYOND_LAW")
TOO_MANY, BAD_UNLOADING, FULL, TOO_STIFF = CORE.film("TOO_MANY", "BAD_UNLOADING", "FULL", "TOO_STIFF")

_BEGIN = c.c_char * 0
_MOST_ROOM = MAX_SEGMENTS  # lines of a recorded contact, beyond which it will not end


@CORE.structure("film_function")
class Function(c.Structure):
    """A function of indentation that the core can evaluate."""


@CORE.structure("film_piece")
class Piece(c.Structure):
    """One piece of a stage, and how a contact that turns in it opens."""


@CORE.structure("film_stage")
class Stage(c.Structure):
    """One loading stage."""


@CORE.structure("film_curve")
class Curve(c.Structure):
    """A law as the core sees it, in series with a spring if it has a compliance."""


@CORE.structure("film_mesh")
class Mesh(c.Structure):
    """How legs are cut into lines. `memory` is kept alive by the owner."""

    def __reduce__(self) -> tuple[Any, ...]:
        return mesh, (self.linearisation, self.loading, self.unloading)  # a copy of the pointers would outlive `memory`


@CORE.structure("film_line")
class Line(c.Structure):
    """One straight piece of the force, on which the motion is closed-form."""


@CORE.structure("film_state")
class State(c.Structure):
    """Everything about an impact at one moment; copying it saves it."""


@CORE.structure("film_start")
class Start(c.Structure):
    """How one contact starts."""


@CORE.structure("film_contact")
class Force(c.Structure):
    """The contact force, and its partial derivatives by ξ and ν."""


@CORE.structure("film_summary")
class Summary(c.Structure):
    """What one contact did."""


SOLVE = Header("march/film_solve.h", CORE)


@SOLVE.structure("film_solution")
class Solution(c.Structure):
    """One contact to an accuracy."""


START_DTYPE, LINE_DTYPE, STATE_DTYPE, SUMMARY_DTYPE = (np.dtype(kind) for kind in (Start, Line, State, Summary))
SUMMARY = tuple(field[0] for field in Summary._fields_ if field[1] is c.c_double)


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
    for header in (CORE, SOLVE, *(Header(f"batch/film_{name}.h", CORE) for name in ("many", "motions"))):
        header.declare(lib)
    check_sizes(lib, "film_sizes", Curve, Mesh, Line, State, Summary)
    return lib


def with_functions(*headers: Header, sizes: tuple[Any, ...] = ()) -> Callable[[], Any]:
    """What gives the library with the functions of further headers declared. sizes: the name of the core's function
    that gives those of structures, and these."""

    @lru_cache(maxsize=1)
    def loaded() -> Any:
        lib = library()
        for header in headers:
            header.declare(lib)
        if sizes:
            check_sizes(lib, *sizes)
        return lib

    return loaded


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


def record(
    curve: Curve, cut: Mesh, state: State, limit: float, room: int
) -> tuple[int, NDArray[Any], NDArray[Any], Summary]:
    """Status, lines, states at events and summary, from `state`, which is moved on, to the end of the next contact or
    to `limit`."""
    most, count, events_count, begun = min(room, _MOST_EVENTS), c.c_int32(), c.c_int32(), bytes(state)
    summary = Summary()
    lines, events = np.empty(room * LINE_DTYPE.itemsize, np.uint8), np.empty(most * STATE_DTYPE.itemsize, np.uint8)
    status = library().film_record(
        *(c.byref(curve), c.byref(cut), c.byref(state), limit),
        *(at(lines), room, c.byref(count), at(events), most, c.byref(events_count), c.byref(summary)),
    )
    if status == FULL and room <= _MOST_ROOM and events_count.value < _MOST_EVENTS:
        c.memmove(c.byref(state), begun, len(begun))
        return record(curve, cut, state, limit, 4 * room)
    tables = _rows(lines, count.value, LINE_DTYPE), _rows(events, events_count.value, STATE_DTYPE)
    return TOO_MANY if status == FULL else status, *tables, summary


def _rows(memory: NDArray[np.uint8], count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """A copy of the first rows of a table; copying an array of structures takes ten times as long."""
    return np.ndarray(count, dtype, memory[: count * dtype.itemsize].copy())


def sample(curve: Curve, lines: NDArray[Any], times: Array) -> tuple[Array, NDArray[np.int8], NDArray[np.int8]]:
    """(count, 5) values ξ, ξ', f, ν, target displacement at ascending times; branch and phase of each."""
    if len(lines) == 0:
        raise ValueError("there are no lines to sample")
    times = np.ascontiguousarray(times, dtype=np.float64)
    values = np.empty((times.size, 5))
    stages, phases = np.empty(times.size, np.int8), np.empty(times.size, np.int8)
    found = values.ctypes.data, stages.ctypes.data, phases.ctypes.data
    library().film_sample(c.byref(curve), lines.ctypes.data, len(lines), times.ctypes.data, times.size, *found)
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
    library().film_batch(instructions() if using is None else using, *own)
    return status, np.ndarray(start.size, SUMMARY_DTYPE, memory)


def force_of(curve: Curve, state: State) -> Callable[[float], float]:
    """f(ξ) as the contact of `state` is at the time of each call."""
    at = c.byref(curve), c.byref(state)
    function = library().film_force
    return lambda xi: function(*at, xi, state.nu).force


def indicators(curve: Curve, state: State, speed: float) -> list[float]:
    """film_indicators: all > 0 while the contact goes on as it is."""
    values = (c.c_double * INDICATORS)()
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


def motion(curve: Curve, state: State) -> Array:
    """Indentation, its rate, force, ν and displacement of the struck point, as `sample` has them."""
    values = np.empty(5)
    library().film_motion(c.byref(curve), c.byref(state), values.ctypes.data)
    return values


def stage_law(curve: Curve, stage: int, xi: float) -> tuple[float, float]:
    """Force and work (from the stage's beginning) as the core evaluates them."""
    force, work = c.c_double(), c.c_double()
    library().film_law(c.byref(curve), stage, xi, c.byref(force), c.byref(work))
    return force.value, work.value

"""The variables of motions in closed form: segments of the march, and steps, flights and modes of impacts on modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

from film_datasets.schema.variable import BYTE, FLOAT, IMPACTS, INTEGER, LONG, Variable
from film_model.base.units import si_unit
from film_model.core.native import PHASES, STRETCHED
from film_model.problem.scales import Scales
from film_model.solve.closed_form import TABLES

_MANY = {"force": "node", "bend": "coefficient"}

WIDE = {dim: TABLES["step"][name].shape[0] for name, dim in _MANY.items()}
"""The further dimensions, with their sizes, of the fields of a step that are several numbers."""

BRANCHES = {-2: "no_contact", -1: "unloading"}
"""Stage numbers below the law's own, which count from 0."""


def spaced(name: str) -> str:
    """A name as words."""
    return name.replace("_", " ")


def number(
    name: str, dims: tuple[str, ...], dimension: str, long_name: str, comment: str = "", optional: bool = False
) -> Variable:
    """A variable of numbers."""
    return Variable(name, dims, FLOAT, si_unit(dimension), long_name, comment, optional=optional)


def stage(name: str, dims: tuple[str, ...], long_name: str, comment: str = "") -> Variable:
    """A variable of stages of the law."""
    return Variable(name, dims, BYTE, None, long_name, comment, tuple(BRANCHES.items()), more="stages")


def branch_words(stages: Sequence[str], stretched: bool) -> dict[int, str]:
    """Meanings of segment_branch beside `BRANCHES`: the stages and, of a law that yields and pulls, stretched ones."""
    along = {STRETCHED - k: f"unloading_along_{word}" for k, word in enumerate(stages)} if stretched else {}
    return dict(enumerate(stages)) | along


_SEGMENT = {
    "time": "time at which the segment begins",
    "xi": "indentation there",
    "nu": "velocity of the impactor there, relative to the target if that is a free body",
    "shift": "target displacement there",
    "phi": "force of the straight line there",
    "kappa": "slope of the straight line",
    "work": "work of the contact law there since its stage began",
    "spent": "work done on the indentation since first touch",
    "load": "external force on the impactor",
    "gamma": "compliance of the target, scale_force/(impedance scale_velocity)",
    "xi_free": "indentation at which the unloading branch ends",
    "per_recovery": "one over the indentation from xi_origin to the turning point",
    "f_max": "scale of the force on it, the force at the turning point where f_shift is 0",
    "exponent": "exponent of the unloading branch, f_shift + f_max ((xi - xi_origin) per_recovery)^exponent",
    "xi_origin": "indentation from which the unloading branch is counted",
    "f_shift": "constant part of the force on the unloading branch",
    "work_free": "work of the unloading branch at xi_free, counted from xi_origin",
    "damping": "damping held on the segment",
    "damper": "factor of the contact law's damping",
}

_LAW = "see attribute comment for the equations of motion on a segment"


def segment_units(dims: tuple[str, ...], optional: bool = False) -> tuple[Variable, ...]:
    """The units of the segments' values; scales are named after their dimensions."""
    table = (
        *((f"scale_{s.name}", s.name, f"unit of {s.name} of the segments", "") for s in fields(Scales)),
        ("drift_velocity", "velocity", "velocity of the centre of mass", "0 unless the target is a free body"),
        ("impactor_share", "dimensionless", "share of the impactor in the motion", "1 unless the target is free"),
        (
            "target_compliance",
            "dimensionless",
            "static compliance of the target, scale_force/(static stiffness scale_length)",
            "0 unless the target follows the force statically",
        ),
    )
    return tuple(number(name, dims, dimension, *what, optional=optional) for name, dimension, *what in table)


SEGMENTS = (
    *(number(f"segment_{key}", ("segment",), "dimensionless", what, _LAW) for key, what in _SEGMENT.items()),
    replace(stage("segment_branch", ("segment",), "stage of the contact law on the segment"), more="branches"),
    Variable("segment_phase", ("segment",), BYTE, None, "phase of the contact", flags=tuple(enumerate(PHASES))),
)

_STEP = {
    "time": ("time", "time since first touch at which the step begins"),
    "h": ("time", "duration of the step"),
    "x": ("dimensionless", "displacement of the impactor there"),
    "v": ("rate", "rate of x"),
    "depth": ("dimensionless", "displacement of the impactor there less that of all modes"),
    "depth_rate": ("rate", "rate of depth"),
    "load": ("dimensionless", "external force on the impactor"),
    "force": ("dimensionless", "contact force at the Gauss nodes of the step"),
    "bend": ("dimensionless", "Bernstein coefficients 2 to 7 of depth less its straight line"),
    **{name: ("dimensionless", _SEGMENT[name]) for name in ("xi_free", "per_recovery", "f_max", "exponent")},
    **{name: ("dimensionless", _SEGMENT[name]) for name in ("xi_origin", "f_shift", "damper")},
}

_ENDLESS = "infinite for a flight, and at rest under a load"

_FLIGHT = {
    "displacement": ("dimensionless", "displacement of the struck point by the mode where the flight begins"),
    "velocity": ("rate", "rate of that displacement"),
}

_MODE = {
    "frequency": ("angular_frequency", "natural frequency"),
    "share": ("inverse_mass", "square of the mode shape at the struck point over the modal mass"),
    "damping_ratio": ("dimensionless", "damping ratio"),
}


def _step_variable(name: str, dimension: str, what: str) -> Variable:
    comment = _ENDLESS if name == "h" else "see attribute comment for the equations of motion on a step"
    dims = ("step", _MANY[name]) if name in _MANY else ("step",)
    return number(f"step_{name}", dims, dimension, what, comment, optional=name == "h")


EQUATIONS_ON_MODES = (
    "lengths and forces are in the units scale_*, times in s. On a step, at theta = (t - time)/h, the contact force F "
    "is the cubic through step_force at the four Gauss nodes on 0 ... 1; the impactor follows "
    "x'' = (load - F)/scale_time^2 from step_x and step_v; depth, x less the displacements of all modes, is the "
    "Bernstein polynomial of degree 7 with coefficients depth + k depth_rate h/7, k = 0 ... 7, plus step_bend from "
    "k = 2 on. The indentation xi solves xi + target_compliance f(xi) = depth, f being the contact law. In flight, F "
    "is 0 and each mode moves freely from flight_mode_displacement and flight_mode_velocity: w'' + "
    "2 mode_damping_ratio mode_frequency w' + mode_frequency^2 w = 0; those of flight n begin n times the number of "
    "modes along flight_mode. The target's displacement is x - xi."
)

STEPS = (
    *(_step_variable(name, *what) for name, what in _STEP.items()),
    replace(stage("step_branch", ("step",), "stage of the contact law on the step"), more="branches"),
    Variable("step_flight", ("step",), INTEGER, "1", "number of the flight", "-1 in contact"),
    *(
        number(f"flight_mode_{name}", ("flight_mode",), dimension, what, "mode by mode, flight after flight")
        for name, (dimension, what) in _FLIGHT.items()
    ),
    *(number(f"mode_{name}", ("mode",), dimension, what) for name, (dimension, what) in _MODE.items()),
)

assert {v.name for v in (*SEGMENTS, *STEPS)} == {
    f"{table}_{name}" for table, dtype in TABLES.items() for name in dtype.names or ()
}

MODE_ENERGY = number("mode_energy", ("mode",), "energy", "energy of the mode at the end of the simulation")


def _places(table: str, what: str, shared: str = "") -> tuple[Variable, Variable]:
    """The numbers of rows of a table that impacts have, and where they begin."""
    name = what.replace("_", " ")
    own = (
        f"{name} of all impacts follow each other in the order of the rows, the last dimension fastest",
        f"place along {table} where those of the impact begin, in a selection of impacts too",
    )
    count, begin = (shared, shared) if shared else own
    return (
        Variable(
            *(f"{table}_count", (IMPACTS,), INTEGER, "1", f"number of {name} of the impact", count),
            sample_dimension="" if shared else table,
        ),
        Variable(
            f"{table}_begin",
            (IMPACTS,),
            LONG,
            "1",
            f"place along {table} of the impact's first" if shared else f"number of {name} of the impacts before",
            begin,
        ),
    )


SEGMENT_PLACES = _places("segment", "segments")
STEP_PLACES = (
    *_places("step", "steps"),
    *_places("flight_mode", "states_of_modes"),
    *_places("mode", "modes", "impacts on the same modes share their rows"),
)

RAGGED = tuple(TABLES)
"""Dimensions along which the rows of all impacts follow each other."""

SHARED = ("mode",)
"""Those along which equal tables of several impacts are stored once."""

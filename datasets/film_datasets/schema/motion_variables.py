"""The variables of motions in closed form: segments of the march, and steps, flights and modes of impacts on modes."""

from __future__ import annotations

from collections.abc import Sequence

from film_datasets.schema.rows import PARTS
from film_model.core.native import STRETCHED
from film_model.solve.closed_form import TABLES

WIDE = {dim: TABLES["step"][name].shape[0] for name, dim in (("force", "node"), ("bend", "coefficient"))}
"""The further dimensions, with their sizes, of the fields of a step that are several numbers."""

(MODE_ENERGY,) = PARTS["mode energy"]

RAGGED = tuple(TABLES)
"""Dimensions along which the rows of all impacts follow each other."""

SHARED = ("mode",)
"""Those along which equal tables of several impacts are stored once."""

assert {v.name for part in ("segments", "steps") for v in PARTS[part]} == {
    f"{table}_{name}" for table, dtype in TABLES.items() for name in dtype.names or ()
}

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


def branch_words(stages: Sequence[str], stretched: bool) -> dict[int, str]:
    """Meanings of segment_branch beside `BRANCHES`: the stages and, of a law that yields and pulls, stretched ones."""
    along = {STRETCHED - k: f"unloading_along_{word}" for k, word in enumerate(stages)} if stretched else {}
    return dict(enumerate(stages)) | along

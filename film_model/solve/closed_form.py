"""The motion of an impact in closed form as tables of plain numbers: what datasets store, and the motion from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import modal, modal_steps, native
from film_model.core.modal_steps import Table
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem
from film_model.solve.modal_motion import ModalMotion

TABLES: dict[str, np.dtype[Any]] = {
    "segment": native.LINE_DTYPE,
    "step": modal_steps.STEP_DTYPE,
    "flight_mode": modal_steps.FLIGHT_DTYPE,
    "mode": modal_steps.MODE_DTYPE,
}
"""The tables by what a row is: a segment of the march; of an impact on modes a step in contact or a flight, a mode
where a flight begins, and a mode."""

ON_MODES = ("step", "flight_mode", "mode")
"""The tables that only impacts on modes have."""


@dataclass(frozen=True)
class ClosedForm:
    """tables: by `TABLES`, those that the motion has. compliance: of the target that follows the force statically, or
    of the modes that are omitted, in units of the march."""

    tables: Mapping[str, Table]
    compliance: float

    @classmethod
    def of_modes(cls, tables: modal.Tables, segments: Table, flights: Array) -> ClosedForm:
        """That of an impact on modes, from its record."""
        found = {
            "segment": np.empty(0, native.LINE_DTYPE),
            "step": modal_steps.steps_of(segments),
            "flight_mode": modal_steps.flights_of(flights),
            "mode": modal_steps.modes_of(tables),
        }
        return cls(found, float(segments["rest"][0]))

    @property
    def on_modes(self) -> bool:
        """Whether the motion is on modes."""
        return "step" in self.tables and self.tables["step"].size > 0

    def modal_motion(self, problem: Problem, unit: float, energies: Array | None = None) -> ModalMotion:
        """The motion on modes; unit: of time in the march, s. energies: of each mode at the end.

        Raises ValueError for tables that are not of one motion.
        """
        steps, states, modes = (self.tables[name] for name in ON_MODES)
        curve = curve_of(problem.law).native
        _check(steps, states, modes.size, curve)
        columns = (np.ascontiguousarray(modes[name]) for name in modes.dtype.names or ())
        flights = np.hstack([states[name].reshape(-1, modes.size) for name in states.dtype.names or ()])
        return ModalMotion(
            curve=curve,
            tables=modal.Tables(*columns, longest=unit),
            unit=unit,
            segments=modal_steps.segments_of(steps, unit, self.compliance),
            flights=flights,
            energies=np.full(modes.size, np.nan) if energies is None else energies,
            highest=float(modes["frequency"][-1]) * (1.0 + 1e-9),
            stretching=np.nan if problem.stretches else 0.0,
        )

    def sample(self, problem: Problem, unit: float, times: Array) -> tuple[Array, NDArray[np.int8]]:
        """(count, 5) values ξ, ξ', f, ν, target displacement at ascending times in units of the march, and branches."""
        if self.on_modes:
            return self.modal_motion(problem, unit).sample(times)
        return native.sample(problem.curve.native, self.tables["segment"], times)[:2]


def _check(steps: Table, states: Table, modes: int, curve: native.Curve) -> None:
    """Raise ValueError unless the steps, with the states of `modes` modes at each flight, can be sampled."""
    branch, own, time = steps["branch"], steps["flight"][steps["flight"] >= 0], steps["time"]
    least, count = native.STRETCHED - curve.stages + 1, own.size
    if time[0] != 0.0 or not (np.diff(time) >= 0.0).all():
        what = "the times of its steps do not increase from 0"
    elif not np.array_equal(own, np.arange(count)) or (steps["flight"] < -1).any():
        what = "its flights are not numbered from 0"
    elif states.size != count * modes or modes == 0:
        what = f"{count} flights of {modes} modes do not have {states.size} states of modes"
    elif ((branch < least) | (branch >= curve.stages)).any():
        what = "a step is on a stage that the contact law does not have"
    else:
        return
    raise ValueError(f"the steps of this motion are damaged: {what}")

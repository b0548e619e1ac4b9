"""The check of an FMU's derivatives by its parameters, after an impact, against runs with other parameters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from fmu_wrapper.findings import Finding
from fmu_wrapper.instance import Fmu, Slave, started
from fmu_wrapper.resource import start_values
from fmu_wrapper.variables import LEFT, VARIABLES, Real, reference

STEP = 5e-4
"""Step of the differences over the parameter. Their points lie between those of the FMU, where it has found no kink."""

_WEIGHTS = np.array([[1.0], [-8.0], [8.0], [-1.0]]) / 12.0


def compared_slopes(fmu: Fmu, stop: float) -> Iterator[Finding]:
    """Findings from the derivatives of what an impact leaves at a time, s, one for each parameter that is not 0.

    A derivative that the FMU refuses, because there is a kink or because other events happen, is not compared. Allowed
    are 1e-6 of the larger of the derivative and the output over the parameter; of energies, of the largest of them.
    Where the end of a segment passes the largest force of a damped law, that jumps by 1e-10 and the differences by
    2e-7; elsewhere they agree to 1e-10.
    """
    if fmu.data.modes.count > 0:
        return
    with started(fmu, False, {}) as slave:
        slave.step(0.0, stop)
        known = ((name, VARIABLES[reference(name)]) for name in start_values(fmu.data))
        parameters = [name for name, v in known if v.type == Real and v.causality.get("impact") == "parameter"]
        values = slave.get(parameters)
        sizes = _sizes(slave.get(LEFT), fmu.data.start[reference("mass")])
        slopes = {
            name: np.array([_slope(slave, of, name) for of in LEFT]) for name in parameters if values[name] != 0.0
        }
    for name, slope in slopes.items():
        h = STEP * (0.1 if name == "exponent" else values[name])  # as the FMU does
        low, high = VARIABLES[reference(name)].low, VARIABLES[reference(name)].high
        points = [values[name] + h * k for k in (-2, -1, 1, 2)]
        known = np.isfinite(slope)
        if not known.any() or (low is not None and min(points) < low) or (high is not None and max(points) > high):
            continue
        try:
            runs = np.array([_left(fmu, name, value, stop) for value in points])
        except SimulationError:  # the law has no such values: the FMU's derivative is one-sided
            fmu.messages.clear()
            continue
        size = np.maximum(abs(slope), sizes / abs(values[name]))
        off = np.where(known, abs((_WEIGHTS * runs).sum(axis=0) / h - slope), 0.0)
        relative = np.divide(off, size, out=np.zeros_like(off), where=known & (size > 0.0))
        worst = int(relative.argmax())
        yield Finding(f"derivatives by {name}", float(relative[worst]), 1e-6, LEFT[worst])


def _sizes(left: dict[str, float], mass: float) -> Array:
    """Size of each output: its value, and of energies the largest, so that rounding of a difference is small in it."""
    energies = ("contact_energy", "target_energy", "external_work")
    most = max(left["contact_impulse"] ** 2 / (8.0 * mass), *(abs(left[name]) for name in energies))
    return np.array([most if name in energies else abs(value) for name, value in left.items()])


def _left(fmu: Fmu, name: str, value: float, stop: float) -> list[float]:
    with started(fmu, False, {name: value}) as slave:
        slave.step(0.0, stop)
        return list(slave.get(LEFT).values())


def _slope(slave: Slave, of: str, by: str) -> float:
    from fmpy.fmi1 import FMICallException

    said = len(slave.fmu.messages)
    try:
        return slave.instance.getDirectionalDerivative([reference(of)], [reference(by)], [1.0])[0]
    except FMICallException:
        del slave.fmu.messages[said:]
        return float("nan")

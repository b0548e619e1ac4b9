"""Nominal values of the variables of an export: the sizes that they have in the scene's impact."""

from __future__ import annotations

import math
from collections.abc import Iterable

from fmu_wrapper.resource import Data, loading_force
from fmu_wrapper.variables import KINDS, RIGID, STATES, VARIABLES, Real, Variable, reference, settable


def nominals(data: Data, stop_time: float, sensed: Iterable[Variable] = ()) -> dict[str, float]:
    """Nominal values > 0 by name, SI, of all real variables but event indicators, whose size has no meaning.

    A parameter's is the size of its start value. stop_time: of the default experiment, s. sensed: variables of sensors.
    """
    sizes, found = _sizes(data, stop_time), dict[str, float]()
    for k, v in enumerate((*VARIABLES, *sensed)):
        if v.type != Real or v.dimension is None:
            continue
        given = abs(data.start[k]) if k < settable() and v.causality.get(KINDS[data.kind]) == "parameter" else 0.0
        if v.name in STATES and data.nominal[STATES.index(v.name)] > 0.0:
            found[v.name] = data.nominal[STATES.index(v.name)]
        elif 0.0 < given < RIGID:
            found[v.name] = given
        elif v.dimension in sizes:
            found[v.name] = sizes[v.dimension]
    return {name: value for name, value in found.items() if value > 0.0}


def _sizes(data: Data, stop_time: float) -> dict[str, float]:
    """Dimension → size in the impact, SI."""
    depth, speed = data.nominal[:2]
    lever = data.friction.lever or math.inf
    mass, force = data.start[reference("mass")], loading_force(data, depth, speed)
    return {
        "time": stop_time,
        "length": depth,
        "velocity": speed,
        "force": force,
        "impedance": force / speed if speed > 0.0 else 0.0,
        "acceleration": force / mass,
        "pressure": force / (math.pi * data.stresses.radius * depth),
        "energy": 0.5 * mass * speed**2,
        "impulse": mass * speed,
        "angular_frequency": speed / lever,
        "angular_acceleration": force / (mass * lever),
        "torque": force * lever,
    }

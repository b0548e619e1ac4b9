"""Restitution of a law over velocity, and where it rises: that of bodies that yield falls."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import native


class Rise(NamedTuple):
    """Restitution rises from `low` to `high` between two velocities, and between the depths they lead to, on a fixed
    target; dimensionless."""

    low: float
    high: float
    slow: float
    fast: float
    shallow: float
    deep: float


def rises(curve: native.Curve, ratio: int) -> tuple[Rise, ...]:
    """Where the restitution of a curve rises with velocity. ratio: unloading segments per loading segment."""
    count = 160
    last = curve.stage[curve.stages - 1]
    if curve.stage[0].damped or curve.compliance > 0.0 or curve.pull > 0.0 or curve.stages == 1:
        return ()
    depths = np.geomspace(curve.stage[0].end, min(last.end, 1e4 * curve.stage[0].end), count)
    start: NDArray[Any] = np.zeros(count, native.START_DTYPE)
    start["nu"], start["stop_velocity"], start["time_limit"] = _speeds(curve, depths), -0.0, math.inf
    mesh = native.mesh(native.WORK_PRESERVING, 24, ratio * 24)
    status, found = native.batch(curve, mesh, start, native.INSTRUCTIONS.index("plain"))
    ended = status == native.EVENT
    nu, depth = start["nu"][ended], found["maximum_indentation"][ended]
    restitution = -found["final_velocity"][ended] / nu
    made: list[Rise] = []
    up = np.flatnonzero(np.diff(restitution) > 1e-9)
    for run in np.split(up, np.flatnonzero(np.diff(up) > 1) + 1) if up.size else []:
        a, b = int(run[0]), int(run[-1]) + 1
        if restitution[b] - restitution[a] > 0.002:  # a smaller rise is not reported
            made.append(Rise(*(float(values[k]) for values in (restitution, nu, depth) for k in (a, b))))
    return tuple(made)


def _speeds(curve: native.Curve, depths: Array) -> Array:
    """The velocities that lead to these depths."""
    before, stage, works = 0.0, 0, list[float]()
    ends = [curve.stage[k].end for k in range(curve.stages - 1)]
    for depth in depths.tolist():
        while stage < len(ends) and depth > ends[stage]:
            before += native.stage_law(curve, stage, ends[stage])[1]
            stage += 1
        works.append(before + native.stage_law(curve, stage, depth)[1])
    return np.sqrt(2.0 * np.array(works))

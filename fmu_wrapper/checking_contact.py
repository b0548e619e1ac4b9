"""The check of a contact FMU: loading, unloading, and a deeper second contact in the dent of the first."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from fmu_wrapper.findings import STEPS_TOLERANCE, Finding
from fmu_wrapper.instance import Fmu, started
from fmu_wrapper.loading_curve import loading_force
from fmu_wrapper.resource import Data

POINTS = 100
"""Communication points in each leg of the path."""

FIRST, APART = 0.7, 0.05
"""Depth of the first contact, and the gap after each, as fractions of the deepest indentation."""

_LEGS = ("loading", "unloading", "reloading in the dent", "second unloading")


class Path(NamedTuple):
    """Indentation [m] and its rate [m/s] over time [s]; leg: place in the names of legs."""

    time: NDArray[np.float64]
    indentation: NDArray[np.float64]
    rate: NDArray[np.float64]
    leg: NDArray[np.int64]


def compared_contact(fmu: Fmu) -> list[Finding]:
    """Findings from the force element on a path of two contacts, in Co-Simulation."""
    path = _path(fmu.data)
    expected = _forces(fmu.data, path)
    force, contacts = _stepped(fmu, path)
    off = np.abs(force - expected) / max(float(np.abs(expected).max()), 1e-300)
    findings: list[Finding] = []
    for leg, name in enumerate(_LEGS):
        place = int(np.where(path.leg == leg, off, -1.0).argmax())
        where = f"indentation = {path.indentation[place]:.6g} m"
        findings.append(Finding(f"contact: force in {name}", float(off[place]), STEPS_TOLERANCE, where))
    return [*findings, Finding("contact: number of contacts", abs(contacts - 2.0), 0.0, f"{contacts:g} instead of 2")]


def _path(data: Data) -> Path:
    """Half-waves between zero, two depths, and gaps; turning points are communication points."""
    deepest, gap = data.nominal[0], -APART * data.nominal[0]
    ends = (0.0, FIRST * deepest, gap, deepest, gap)
    length = 0.5 * math.pi * deepest / data.speed  # s: the rates reach the impact's velocity
    phase = np.linspace(0.0, math.pi, POINTS + 1)[1:]
    parts = [((a + b) / 2.0 + (a - b) / 2.0 * np.cos(phase)) for a, b in itertools.pairwise(ends)]
    rates = [(b - a) / 2.0 * math.pi / length * np.sin(phase) for a, b in itertools.pairwise(ends)]
    for part, rate, end in zip(parts, rates, ends[1:], strict=True):
        part[-1], rate[-1] = end, 0.0
    count = POINTS * len(_LEGS)
    time = np.arange(count + 1) * (length / POINTS)
    start_rate = math.pi / length * FIRST * deepest / 2.0 * math.sin(0.01)  # > 0: the bodies approach
    leg = np.repeat(np.arange(len(_LEGS)), POINTS)
    return Path(time, np.concatenate([[0.0], *parts]), np.concatenate([[start_rate], *rates]), np.append(0, leg))


def _forces(data: Data, path: Path) -> NDArray[np.float64]:
    """The law's force [N] on the path, with its memory of earlier turning points."""
    if data.curve.stage[0].damped:  # no memory, and no tension
        rows = zip(path.indentation.tolist(), path.rate.tolist(), strict=True)
        return np.array([max(loading_force(data, x, v), 0.0) if x >= 0.0 else 0.0 for x, v in rows])
    start = native.Start()
    start.nu = 1.0
    state = native.initial_state(data.curve, start)
    force = native.force_of(data.curve, state)
    found: list[float] = []
    for before, x in itertools.pairwise([0.0, *path.indentation.tolist()]):
        state.nu = -1.0 if x < before else 1.0
        for at in (state.xi, x / data.length_scale):  # a turn, at the last indentation; and the way to the next
            state.xi = at
            while native.switch(data.curve, state):  # which may leave the state at the end of a stage
                state.xi = at
        found.append(force(state.xi) * data.force_scale)
    return np.array(found)


def _stepped(fmu: Fmu, path: Path) -> tuple[NDArray[np.float64], float]:
    """Forces [N] of the FMU on the path, and the number of contacts."""
    force: list[float] = []
    step = float(path.time[1])
    with started(fmu, False, {"indentation": 0.0, "relative_velocity": float(path.rate[0])}) as slave:
        for time, x, v in zip(path.time.tolist(), path.indentation.tolist(), path.rate.tolist(), strict=True):
            slave.set("indentation", x)
            slave.set("relative_velocity", v)
            force.append(slave.get(("contact_force",))["contact_force"])
            slave.step(time, step)
        return np.array(force), slave.get(("contact_count",))["contact_count"]

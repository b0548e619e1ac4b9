"""Comparisons of an FMU with the library beside those of runs: the path of a contact, and derivatives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.core import native
from fmu_wrapper.instance import Fmu, Slave, started
from fmu_wrapper.resource import Data, loading_force, start_values
from fmu_wrapper.variables import LEFT, VARIABLES, Real, reference

STEPS_TOLERANCE = 1e-12
"""Allowed difference between Co-Simulation and the library, relative to the largest value of a variable."""


@dataclass(frozen=True)
class Finding:
    """One comparison: its name, the largest difference, the allowed difference, and the place."""

    what: str
    difference: float
    allowed: float
    where: str = ""

    @property
    def good(self) -> bool:
        """Whether the difference is allowed."""
        return self.difference <= self.allowed

    def share(self) -> float:
        """The difference over what is allowed; 0 where there is none. For findings that are good."""
        return self.difference / self.allowed if self.difference else 0.0


POINTS = 100
"""Communication points in each leg of the path."""

_LEGS = ("loading", "unloading", "reloading in the dent", "second unloading")


class Path(NamedTuple):
    """Half-waves of the indentation between `ends` [m], each of the duration `length` [s]."""

    ends: tuple[float, ...]
    length: float

    @property
    def times(self) -> list[float]:
        """The communication points, s; turning points are among them."""
        return [n * (self.length / POINTS) for n in range(POINTS * len(_LEGS) + 1)]

    def leg(self, n: int) -> int:
        """The leg of a communication point, a place in the names of legs."""
        return max(n - 1, 0) // POINTS

    def at(self, time: float) -> tuple[float, float]:
        """Indentation [m] and its rate [m/s]; at the turning points the rate is 0, at the start above 0."""
        leg = min(math.ceil(time / self.length * (1.0 - 1e-14)) - 1, len(_LEGS) - 1) if time > 0.0 else 0
        (a, b), phase = self.ends[leg : leg + 2], math.pi * (time / self.length - leg) if time > 0.0 else 0.01
        if abs(phase - math.pi) < 1e-9:
            return b, 0.0
        moved = 0.5 * (a + b) + 0.5 * (a - b) * math.cos(phase) if time > 0.0 else 0.0
        return moved, 0.5 * (b - a) * math.pi / self.length * math.sin(phase)


def compared_contact(fmu: Fmu) -> list[Finding]:
    """Findings from the force element on a path of two contacts, in Co-Simulation and Model Exchange."""
    path = _path(fmu.data)
    expected = _forces(fmu.data, path)
    findings: list[Finding] = []
    late = 1e-9  # in Model Exchange an event is handled up to 1e-10 of the way late
    for interface, run, allowed in (("", _stepped, STEPS_TOLERANCE), ("Model Exchange, ", _exchanged, late)):
        force, contacts = run(fmu, path)
        off = np.abs(force - expected) / max(float(np.abs(expected).max()), 1e-300)
        legs = np.array([path.leg(n) for n in range(off.size)])
        for leg, name in enumerate(_LEGS):
            place = int(np.where(legs == leg, off, -1.0).argmax())
            where = f"indentation = {path.at(path.times[place])[0]:.6g} m"
            findings.append(Finding(f"contact: {interface}force in {name}", float(off[place]), allowed, where))
        said = f"{contacts:g} instead of 2"
        findings.append(Finding(f"contact: {interface}number of contacts", abs(contacts - 2.0), 0.0, said))
    return findings


def _path(data: Data) -> Path:
    """Between zero, two depths, and gaps; the rates reach the impact's velocity."""
    deepest, gap = data.nominal[0], -0.05 * data.nominal[0]
    return Path((0.0, 0.7 * deepest, gap, deepest, gap), 0.5 * math.pi * deepest / data.speed)


def _forces(data: Data, path: Path) -> Array:
    """The law's force [N] at the communication points, with its memory of earlier turning points."""
    rows = [path.at(time) for time in path.times]
    if data.curve.stage[0].damped:  # no memory, and no tension
        return np.array([max(loading_force(data, x, v), 0.0) if x >= 0.0 else 0.0 for x, v in rows])
    start = native.Start()
    start.nu = 1.0
    state = native.initial_state(data.curve, start)
    force = native.force_of(data.curve, state)
    found: list[float] = []
    for before, x in itertools.pairwise([0.0, *(x for x, _ in rows)]):
        state.nu = -1.0 if x < before else 1.0
        for at in (state.xi, x / data.length_scale):  # a turn, at the last indentation; and the way to the next
            state.xi = at
            while native.switch(data.curve, state):  # which may leave the state at the end of a stage
                state.xi = at
        found.append(force(state.xi) * data.force_scale)
    return np.array(found)


def _stepped(fmu: Fmu, path: Path) -> tuple[Array, float]:
    """Forces [N] of the FMU at the communication points, and the number of contacts."""
    force: list[float] = []
    with started(fmu, False, _inputs(path, 0.0)) as slave:
        for time in path.times:
            _set(slave, path, time)
            force.append(slave.get(("contact_force",))["contact_force"])
            slave.step(time, path.times[1])
        return np.array(force), slave.get(("contact_count",))["contact_count"]


def _exchanged(fmu: Fmu, path: Path) -> tuple[Array, float]:
    """The same in Model Exchange: events are handled at the first time at which an indicator is not positive."""
    force: list[float] = []

    def due(slave: Slave, time: float) -> bool:
        slave.instance.setTime(time)
        _set(slave, path, time)
        return min(slave.indicators(native.INDICATORS)) <= 0.0

    with started(fmu, False, _inputs(path, 0.0), exchange=True) as slave:
        now = 0.0
        for time in path.times:
            while due(slave, time):
                now = _first(lambda at: due(slave, at), now, time)
                due(slave, now)
                slave.instance.enterEventMode()
                slave.handle()
            now = time
            slave.instance.completedIntegratorStep()
            force.append(slave.get(("contact_force",))["contact_force"])
        return np.array(force), slave.get(("contact_count",))["contact_count"]


def _first(due: Callable[[float], bool], before: float, after: float) -> float:
    """The first time at which an event is due, to rounding: not yet at `before`, but at `after`."""
    while True:
        middle = 0.5 * (before + after)
        if not before < middle < after:
            return after
        before, after = (before, middle) if due(middle) else (middle, after)


def _inputs(path: Path, time: float) -> dict[str, float]:
    return dict(zip(("indentation", "relative_velocity"), path.at(time), strict=True))


def _set(slave: Slave, path: Path, time: float) -> None:
    for name, value in _inputs(path, time).items():
        slave.set(name, value)


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

"""Problems of many impacts at once: `problem.assemble` on arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import STANDARD_GRAVITY, Body
from film_model.core import native
from film_model.curve import Curve
from film_model.effects import law_values
from film_model.elementwise import root
from film_model.laws import AbstractLaw, BrakeUnloading, Retrace
from film_model.laws.hertz import hertz_stiffness
from film_model.problem import Array, contact_limit
from film_model.scales import Scales
from film_model.scene import Scene

Index = NDArray[np.intp]


@dataclass(frozen=True)
class Rows:
    """Impacts that share a curve. The fields are those of :class:`~film_model.problem.Problem`, one value a row.

    index: which rows they are. start: the contacts as the core starts them (native.START_DTYPE). zener:
    λ = K^{2/5} m^{3/5} V^{1/5}/Z of the scene, 0 on a target that cannot move, nan where there is no Hertz stiffness.
    """

    index: Index
    law: str
    curve: Curve
    scales: Scales
    start: NDArray[Any]
    drift: Array
    share: Array
    mass: Array
    zener: Array

    def part(self, places: Any) -> Rows:
        """Some of the rows, by their places among these or by a mask."""
        columns = {name: getattr(self, name)[places] for name in ("index", "start", "drift", "share", "mass", "zener")}
        scales = Scales(*(getattr(self.scales, scale.name)[places] for scale in fields(Scales)))
        return Rows(law=self.law, curve=self.curve, scales=scales, **columns)


class RowLaw(NamedTuple):
    """The law of many rows.

    law: one for all, or the class of theirs. values: of its fields, and sphere: of those of its rule of unloading, if
    it has one; numbers, or arrays with a value for each row.
    """

    law: AbstractLaw | type[AbstractLaw]
    values: Mapping[str, Any]
    rule: str | None
    sphere: Mapping[str, Any]

    @classmethod
    def of(cls, scene: Scene, law: AbstractLaw | type[AbstractLaw]) -> RowLaw:
        """What `effects.choose` makes of the law in a scene of columns."""
        sphere = {"effective_modulus": scene.effective_modulus, "radius": scene.effective_radius}
        values = {} if isinstance(law, AbstractLaw) else law_values(scene, law)
        return cls(law, values, scene.contact.unloading_name, sphere)

    def at(self, rows: Any) -> AbstractLaw:
        """The law of one row, or with arrays in its fields that of several."""
        law = self.law if isinstance(self.law, AbstractLaw) else self.law(**_picked(self.values, rows))
        if self.rule is None:
            return law
        return Retrace(law) if self.rule == "retrace" else BrakeUnloading(law, **_picked(self.sphere, rows))

    def part(self, places: Index) -> RowLaw:
        """The law of some of the rows."""
        return self._replace(values=_picked(self.values, places), sphere=_picked(self.sphere, places))


@dataclass(frozen=True)
class Group:
    """Impacts of one law and curve, of which it is still open what moves the target and what presses.

    scene: with columns for these rows. index: which rows they are.
    """

    scene: Scene
    law: RowLaw
    curve: Curve
    index: Index

    def column(self, value: Any) -> NDArray[Any]:
        """A value of the scene for each row."""
        return column(value, self.index.size)

    @cached_property
    def mass(self) -> Array:
        """Effective, kg."""
        return self.column(self.scene.effective_mass)

    @cached_property
    def speed(self) -> Array:
        """Of approach, m/s."""
        return self.column(self.scene.approach_velocity)

    @property
    def weight(self) -> Array:
        """Of the impactors, N."""
        return self.mass * STANDARD_GRAVITY

    @cached_property
    def zener(self) -> Array:
        """As `Rows` has it."""
        return zener_numbers(self.scene, self.index.size)

    @cached_property
    def _drift_and_share(self) -> tuple[Array, Array]:
        if not isinstance(self.scene.target, Body):
            return np.zeros(self.index.size), np.ones(self.index.size)
        share = self.mass / self.column(self.scene.mass)
        return self.column(self.scene.impactor.speed) - share * self.speed, share

    @cached_property
    def _energy(self) -> Array:
        return 0.5 * self.mass * self.speed**2

    @cached_property
    def _scales(self) -> Scales:
        return self._scales_for(self._energy)

    def assemble(self, impedance: Array, load: Array) -> Rows:
        """The problems for target impedances [N s/m] and loads [N]."""
        count, scales = self.index.size, self._scales
        weighed = load * 1e-3 * self.column(self.scene.effective_radius)
        if (weighed > self._energy).any():
            scales = self._scales_for(np.maximum(self._energy, weighed))
        force, velocity = cast("Any", scales.force), cast("Any", scales.velocity)
        drift, share = self._drift_and_share
        start: Any = np.zeros(count, native.START_DTYPE)
        start["nu"], start["load"] = self.speed / velocity, load / force
        start["time_limit"] = math.inf
        if drift.any():
            start["stop_velocity"] = -drift / (share * velocity)
        if np.isfinite(impedance).any():
            start["gamma"] = force / (impedance * velocity)
        if load.any():
            limit = contact_limit(start["nu"], start["gamma"])
            start["time_limit"] = np.where(load > 0.0, limit, math.inf)
        if self.law.law.damped:
            length = cast("Any", scales.length)
            (factor,) = self._on_arrays(
                lambda law, rows: (law.damping_factor(self.mass[rows], self.speed[rows], length[rows]),), 1
            )
            start["damping"] = factor * velocity / force
        return Rows(self.index, self.law.law.name, self.curve, scales, start, drift, share, self.mass, self.zener)

    def _scales_for(self, energy: Array) -> Scales:
        length, force = self._on_arrays(lambda law, rows: law.scales(cast("Any", energy[rows])), 2)
        time = root(self.mass * length / force)
        return Scales(*cast("Any", (length, force, time, length / time)))

    def _on_arrays(self, formula: Callable[[AbstractLaw, Any], tuple[Any, ...]], results: int) -> list[Array]:
        """A formula of the law for every row: on arrays if that gives what it gives for some rows, else row by row."""
        count = self.index.size
        try:
            found = [self.column(value) for value in formula(self.law.at(slice(None)), slice(None))]
            if all(self._right(found, formula, row) for row in {0, count // 2, count - 1}):
                return found
        except (TypeError, ValueError):
            pass
        table = np.array([formula(self.law.at(row), row) for row in range(count)])
        return [table[:, k] for k in range(results)]

    def _right(self, found: list[Array], formula: Callable[[AbstractLaw, Any], tuple[Any, ...]], row: int) -> bool:
        pairs = zip(found, formula(self.law.at(row), row), strict=True)
        return all(abs(value[row] - alone) <= 1e-13 * abs(alone) for value, alone in pairs)


def zener_numbers(scene: Scene, count: int) -> Array:
    """Zener's λ of every row of a scene of columns, as `Rows` has it."""
    impedance = column(math.inf if scene.effects.target_motion is False else scene.target_impedance, count)
    if not np.isfinite(impedance).any():
        return np.zeros(count)
    modulus = math.nan if scene.effective_modulus is None else scene.effective_modulus
    stiffness = column(hertz_stiffness(modulus, scene.effective_radius), count)
    mass, speed = column(scene.effective_mass, count), column(scene.approach_velocity, count)
    return np.where(np.isfinite(impedance), stiffness**0.4 * mass**0.6 * speed**0.2 / impedance, 0.0)


def column(value: Any, count: int) -> NDArray[Any]:
    """A number, or a number a row, as an array."""
    return np.broadcast_to(np.asarray(value), (count,))


def _picked(values: Mapping[str, Any], rows: Any) -> dict[str, Any]:
    """The values at one row, as floats, or at several."""
    at = {name: value[rows] if isinstance(value, np.ndarray) else value for name, value in values.items()}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in at.items()}

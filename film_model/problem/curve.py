"""Contact law → Curve: the dimensionless stages that the core evaluates, in series with a spring if there is one."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.laws.law import AbstractLaw, Array, Stage
from film_model.problem.families import Page, page_of
from film_model.problem.fit import CHECKS, assemble, checked, values_of
from film_model.problem.restitution import Rise, rises

TRIAL_SEGMENTS = 16
"""Segments per stage of the trial march. Its relative errors, about 1e-5, are similar with and without an effect."""


@dataclass(frozen=True)
class Curve:
    """A law in the form that the core needs.

    native: the core's structure, with its compliance. stage_names: one per stage. fit_error: largest relative
    difference between a fitted function and the law (0 when nothing had to be fitted). steepest: largest exponent of
    an unloading branch. law, stages: from which the warnings are made; a pickle has the warnings, and no stages. page:
    the family of curves that this one belongs to.
    """

    native: native.Curve = field(repr=False, compare=False)
    stage_names: tuple[str, ...]
    fit_error: float
    steepest: float
    law: str
    stages: tuple[Stage, ...] = field(repr=False, compare=False)
    page: Page | None = field(default=None, repr=False, compare=False)

    @cached_property
    def unloading_ratio(self) -> int:
        """Unloading segments per loading segment.

        If the force falls to 0 slowly, the core takes two or four times as many (`film_unloading`).
        """
        # the first segments of unloading then have larger errors than those of loading
        return 2 if self.steepest > 2.0 else 1

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Sentences for the user about jumps of the force and poor fits."""
        return tuple(_remarks(self.law, self.stages, self.fit_error))

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "warnings": self.warnings, "stages": ()}  # the functions of a stage may be local

    @cached_property
    def clearance(self) -> float:
        """ξ at which the force begins: the end of the first stages if they are without force, else 0."""
        reach = 0.0
        for k in range(self.native.stages):
            stage = self.native.stage[k]
            if not math.isfinite(stage.end) or self.work(0.999 * stage.end) != 0.0:
                break
            reach = stage.end
        return reach

    def segments(self, loading: int) -> tuple[int, int]:
        """Segment counts of loading and unloading for a loading count."""
        return loading, self.unloading_ratio * loading

    @cached_property
    def trial_mesh(self) -> native.Mesh:
        """That on which effects are decided."""
        return native.mesh(native.WORK_PRESERVING, *self.segments(TRIAL_SEGMENTS))

    @cached_property
    def rises(self) -> tuple[Rise, ...]:
        """Where the restitution on a fixed target rises with velocity."""
        return rises(self.native, self.unloading_ratio)

    @cached_property
    def pulls(self) -> bool:
        """Whether the force may be negative."""
        return self.native.pull > 0.0

    @cached_property
    def reversible(self) -> bool:
        """Whether unloading retraces every stage, so that no dent is left."""
        return all(stage.unloading == native.RETRACE for stage in self.native.stage[: self.native.stages])

    def force(self, xi: float) -> float:
        """f(ξ) in loading, as evaluated by the core."""
        return native.stage_law(self.native, self._stage_at(xi), xi)[0]

    def work(self, xi: float) -> float:
        """∫f dξ from 0 to ξ in loading, as evaluated by the core."""
        last = self._stage_at(xi)
        ends = [*(self.native.stage[k].end for k in range(last)), xi]
        return sum(native.stage_law(self.native, k, end)[1] for k, end in enumerate(ends))

    def _stage_at(self, xi: float) -> int:
        stages = [self.native.stage[k].end for k in range(self.native.stages)]
        return min(sum(end < xi for end in stages), len(stages) - 1)


def curve_of(law: AbstractLaw, compliance: float = 0.0) -> Curve:
    """The curve of a law; with a `compliance` c [δ_s/F_s] in series with a spring, over ξ + c f.

    Raises ValueError if stages are not contiguous, a force is negative, a function is not finite, a stage that must be
    fitted has no end, a fit is worse than `FIT_LIMIT`, or a stage has damping although the law is not marked as damped;
    SimulationError if, in series with a spring, the law is damped, jumps or would snap through.
    """
    if type(law).__hash__ in (None, object.__hash__):  # it may have changed since the last call
        return _made(law, compliance)
    try:
        return _kept(law, compliance)
    except TypeError:  # a field cannot be hashed
        return _made(law, compliance)


@lru_cache(maxsize=256)
def _kept(law: AbstractLaw, compliance: float) -> Curve:
    return _made(law, compliance)


def _made(law: AbstractLaw, compliance: float) -> Curve:
    if page_of(law) is not None:
        return _shaped(law.of_shape(law.shape), compliance)
    try:
        stages = tuple(law.stages())
        curve = _build(_name(law), stages, compliance)
    except TypeError as error:
        if "unhashable" not in str(error):
            raise
        raise ValueError(f"{_name(law)}: a law must be a frozen dataclass with hashable fields ({error})") from None
    for stage in stages:
        if stage.damping is not None and not law.damped:
            raise ValueError(
                f"{_name(law)}: stage {stage.name!r} has damping, so the law must say damped = True and give its "
                "damping_factor"
            )
    return curve


@lru_cache(maxsize=256)
def _build(law: str, given: tuple[Stage, ...], compliance: float) -> Curve:
    """The curve of these stages; cached, so that laws which differ only in their scales share it."""
    stages, made, error, steepest = _assembled(law, given)
    return _curve(law, stages, native.Curve.from_buffer_copy(made), compliance, error, steepest)


@lru_cache(maxsize=256)
def _assembled(law: str, given: tuple[Stage, ...]) -> tuple[list[Stage], native.Curve, float, float]:
    """The checked stages, and what `assemble` makes of them, which no spring has changed."""
    stages = checked(law, given)
    return stages, *assemble(law, stages)


@lru_cache(maxsize=4096)
def _shaped(law: AbstractLaw, compliance: float) -> Curve:
    """The curve of a law of a family."""
    page = page_of(law)
    assert page is not None and law.shape is not None
    return replace(curve_on(page, law.shape, law, compliance), page=page)


def curve_on(page: Page, shape: float | Array, law: AbstractLaw, compliance: float = 0.0) -> Curve:
    """The curve of a law on a page of its family, as :func:`curve_of`. shape: its own, or its numbers in a mixture."""
    return _curve(_name(law), list(law.stages()), page.at(shape), compliance, page.fit_error, page.steepest)


def _curve(
    law: str, stages: list[Stage], made: native.Curve, compliance: float, error: float, steepest: float
) -> Curve:
    core, own = native.library(), ctypes.byref(made)
    if compliance > 0.0:
        _check_series(law, stages, compliance)
    status = core.film_spring(own, compliance) if compliance > 0.0 else core.film_check_curve(own)
    if status != native.OK:
        raise ValueError(
            f"{law}: the numbers of its stages are outside the solver's range: all must be finite, and their work too"
        )
    return Curve(made, tuple(stage.name for stage in stages), error, steepest, law, tuple(stages))


def can_be_in_series(law: AbstractLaw, compliance: float) -> bool:
    """Whether :func:`curve_of` accepts the law in series with a spring of this compliance [δ_s/F_s]."""
    try:
        return compliance * steepest_fall(law) < 1.0
    except SimulationError:
        return False


def steepest_fall(law: AbstractLaw) -> float:
    """The largest −f′ of the law's stages, at least 0; SimulationError if it cannot be in series with any spring."""
    return _steepest_fall(_name(law), tuple(law.stages()))


@lru_cache(maxsize=256)
def _steepest_fall(law: str, given: tuple[Stage, ...]) -> float:
    return max(fall for _, fall in _falls(law, checked(law, given)))


def _falls(law: str, stages: list[Stage]) -> Iterator[tuple[str, float]]:
    """The same of each stage, and its name."""
    if any(stage.damping is not None for stage in stages):
        raise SimulationError(f"{law}: damped laws are not supported on targets with a static stiffness")
    if any(stage.pulls for stage in stages):
        raise SimulationError(f"{law}: laws that pull are not supported on targets with a static stiffness")
    before = 0.0
    for stage in stages:
        reach = stage.end if math.isfinite(stage.end) else 10.0 * (stage.begin + 1.0)
        xi = np.linspace(stage.begin, reach, CHECKS)
        force = values_of(stage.force, xi, stage)
        if abs(force[0] - before) > 1e-9 * float(np.abs(force).max()):
            raise SimulationError(
                f"{law}: on a target with a static stiffness the force must not jump, but it does where stage "
                f"{stage.name!r} begins, from {before:g} to {force[0]:g}"
            )
        yield stage.name, max(0.0, float((-np.diff(force) / np.diff(xi)).max()))
        before = float(force[-1])


def _check_series(law: str, stages: list[Stage], compliance: float) -> None:
    """Raises SimulationError if the law cannot be in series with a spring."""
    for stage, fall in _falls(law, stages):
        if not compliance * fall < 1.0:
            raise SimulationError(
                f"{law}: the force of stage {stage!r} falls faster with the indentation than the target's static "
                "stiffness: the contact would snap through"
            )


def _name(law: AbstractLaw) -> str:
    return f"law {getattr(law, 'name', type(law).__name__)!r}"


def jumps(stages: Sequence[Stage]) -> Iterator[tuple[str, float, float]]:
    """Names of the stages with which the force jumps, and the force before and after."""
    for before, after in pairwise(stages):
        left, right = (float(values_of(s.force, np.array([after.begin]), s)[0]) for s in (before, after))
        if abs(right - left) > 1e-9 * max(abs(left), abs(right)):
            yield after.name, left, right


def _remarks(law: str, stages: Sequence[Stage], fit_error: float) -> list[str]:
    """Warnings: the force jumps between stages, the given work is not the force's integral, or a fit is poor."""
    said = [
        f"{law}: the force jumps by {100 * (right - left) / max(left, 1e-300):+.2f} % where stage {name!r} begins"
        for name, left, right in jumps(stages)
    ]
    if fit_error > 1e-11:
        said.append(f"{law}: its functions are fitted with a relative error of {fit_error:.1e} only")
    for stage in stages:
        if stage.work is not None and math.isfinite(stage.end):
            difference = _work_difference(stage.work, stage)
            if difference > 1e-9:
                said.append(
                    f"{law}: the work given for stage {stage.name!r} differs from the integral of its force by "
                    f"{difference:.1e}; the integral is used"
                )
    return said


def _work_difference(work: Callable[[Array], Array], stage: Stage) -> float:
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x = 0.5 * (nodes + 1.0)  # integrated over x²: accurate for a force that begins like a square root too
    length = stage.end - stage.begin
    integral = float(np.sum(weights * x * length * values_of(stage.force, stage.begin + length * x * x, stage)))
    given = float(work(np.array([stage.end]))[0])
    return abs(given - integral) / max(abs(integral), 1e-300)

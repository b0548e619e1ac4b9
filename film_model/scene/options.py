"""Options of a scene: which effects are simulated, and how accurately the motion is solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from film_model.base.arrays import greater
from film_model.base.errors import Mistake, raise_all
from film_model.base.fields import InUnits, choice, entry, fill, measure, whole

DEFAULT_ACCURACY = 1e-4
DEFAULT_TOLERANCE = 0.01


def tolerance_for(accuracy: Any) -> Any:
    """Largest relative change of the summary by a neglected effect, unless a scene gives it."""
    return greater(DEFAULT_TOLERANCE, accuracy)


Switch: TypeAlias = Literal["auto"] | bool
SWITCH = choice("auto", True, False)


@dataclass(frozen=True, init=False, repr=False)
class Effects(InUnits):
    """Which effects are simulated: each "auto", True or False.

    plasticity: whether law "auto" yields. target_motion: of a target that is not a half-space; false holds it fixed.
    gravity: the weight of the impactor, towards the target. boundary_reflections: waves reflected from the edges of a
    plate; false makes the plate infinite. target_inertia: of a plate or beam with edges; false makes it follow the
    force by its static stiffness alone. rate_hardening: the yield strength at the strain rate of the impact.
    viscoelasticity: the relaxation of materials with a prony series, under law hertz; false takes their instantaneous
    moduli. material_damping: the loss factors of the materials, of law "auto"; true takes them in place of a law that
    yields. wave_losses: the energy of waves in a half-space, of law "auto"; true also of other laws. small_slope: the
    steep surfaces of soft balls, of law "auto"; false takes them as flat. stretching: membrane forces of a plate or
    beam with in_plane.
    tolerance: "auto" simulates an effect if neglecting it would change a summary value by more than this relative
    amount. An effect that would, but cannot be simulated, causes a warning. Default: 1 %, or the requested accuracy if
    that is larger. A finer accuracy does not lower it, so that refining a mesh does not change the physics.

    >>> fm.Effects(gravity=True, tolerance=0.05).gravity
    True
    """

    plasticity: Switch = entry(SWITCH)
    target_motion: Switch = entry(SWITCH)
    gravity: Switch = entry(SWITCH)
    boundary_reflections: Switch = entry(SWITCH)
    target_inertia: Switch = entry(SWITCH)
    rate_hardening: Switch = entry(SWITCH)
    viscoelasticity: Switch = entry(SWITCH)
    material_damping: Switch = entry(SWITCH)
    wave_losses: Switch = entry(SWITCH)
    small_slope: Switch = entry(SWITCH)
    stretching: Switch = entry(SWITCH)
    tolerance: float | None = entry(measure("dimensionless", 1e-12, 1))

    def __init__(
        self,
        plasticity: Switch = "auto",
        target_motion: Switch = "auto",
        gravity: Switch = "auto",
        tolerance: float | None = None,
        boundary_reflections: Switch = "auto",
        target_inertia: Switch = "auto",
        rate_hardening: Switch = "auto",
        viscoelasticity: Switch = "auto",
        material_damping: Switch = "auto",
        wave_losses: Switch = "auto",
        stretching: Switch = "auto",
        small_slope: Switch = "auto",
    ) -> None:
        raise_all(fill(self, locals()))

    def changed(self, **changes: Any) -> Effects:
        """The effects with some entries changed."""
        return Effects(**{name: getattr(self, name) for name in self.FIELDS} | changes)


@dataclass(frozen=True, init=False, repr=False)
class Solver(InUnits):
    """How accurately the motion is solved.

    accuracy: relative, of every summary value, default 1e-4; or segments: number per stage. linearisation: of the
    force, "work-preserving", or "chord" as in the paper.

    >>> fm.Solver(segments=5, linearisation="chord").segments
    5
    """

    accuracy: float | None = entry(measure("dimensionless", 1e-14, 0.1))
    segments: int | None = entry(whole(1, 1_000_000))
    linearisation: Literal["work-preserving", "chord"] = entry(choice("work-preserving", "chord"))

    def __init__(
        self,
        accuracy: float | None = None,
        segments: int | None = None,
        linearisation: Literal["work-preserving", "chord"] = "work-preserving",
    ) -> None:
        mistakes = fill(self, locals())
        if accuracy is None and segments is None:
            object.__setattr__(self, "accuracy", DEFAULT_ACCURACY)
        if accuracy is not None and segments is not None:
            mistakes.append(Mistake(None, None, "Solver.segments", "give accuracy or segments, not both"))
        raise_all(mistakes)

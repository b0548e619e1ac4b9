"""Options of a scene: which effects are simulated, and how accurately the motion is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias

from film_model.base.errors import Mistake, raise_all
from film_model.base.fields import Field, InUnits, choice, fill, measure, whole

DEFAULT_ACCURACY = 1e-4
DEFAULT_TOLERANCE = 0.01

Switch: TypeAlias = Literal["auto"] | bool


@dataclass(frozen=True, init=False, repr=False)
class Effects(InUnits):
    """Which effects are simulated: each "auto", True or False.

    plasticity: whether law "auto" yields. target_motion: of a target that is not a half-space; false holds it fixed.
    gravity: the weight of the impactor, towards the target. boundary_reflections: waves reflected from the edges of a
    plate; false makes the plate infinite. target_inertia: of a plate or beam with edges; false makes it follow the
    force by its static stiffness alone. rate_hardening: the yield strength at the strain rate of the impact.
    viscoelasticity: the relaxation of materials with a prony series, under law hertz; false takes their instantaneous
    moduli. material_damping: the loss factors of the materials, of law "auto"; true takes them in place of a law that
    yields. wave_losses: the energy of waves in a half-space, of law "auto"; true also of other laws. stretching:
    membrane forces of a plate or beam with in_plane.
    tolerance: "auto" simulates an effect if neglecting it would change a summary value by more than this relative
    amount. An effect that would, but cannot be simulated, causes a warning. Default: 1 %, or the requested accuracy if
    that is larger. A finer accuracy does not lower it, so that refining a mesh does not change the physics.

    >>> fm.Effects(gravity=True, tolerance=0.05).gravity
    True
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        **{
            name: choice("auto", True, False)
            for name in (
                *("plasticity", "target_motion", "gravity", "boundary_reflections", "target_inertia"),
                *("rate_hardening", "viscoelasticity", "material_damping", "wave_losses", "stretching"),
            )
        },
        "tolerance": measure("dimensionless", 1e-12, 1),
    }

    plasticity: Switch
    target_motion: Switch
    gravity: Switch
    boundary_reflections: Switch
    target_inertia: Switch
    rate_hardening: Switch
    viscoelasticity: Switch
    material_damping: Switch
    wave_losses: Switch
    stretching: Switch
    tolerance: float | None

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

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "accuracy": measure("dimensionless", 1e-14, 0.1),
        "segments": whole(1, 1_000_000),
        "linearisation": choice("work-preserving", "chord"),
    }

    accuracy: float | None
    segments: int | None
    linearisation: Literal["work-preserving", "chord"]

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

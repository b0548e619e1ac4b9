"""Rules of unloading for any loading law: [contact] unloading = "brake" or "retrace"."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from film_model.base.errors import shown
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import AbstractLaw, Power, Stage, Unloading


def brake_unloading(stiffness: float = 1.0) -> Unloading:
    """Hertz's unloading with the contact radius a² = R δ_m: δ_m − δ_f = F_m/(K √δ_m). stiffness: K δ_s^{3/2}/F_s."""
    return Unloading(secant=Power(coefficient=stiffness, exponent=0.5, origin=0.0))


@dataclass(frozen=True)
class _Reopened(AbstractLaw):
    """The loading of another law."""

    law: AbstractLaw

    def __post_init__(self) -> None:
        if not isinstance(self.law, AbstractLaw):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ValueError(f"{type(self).__name__}.law: {shown(self.law)} is not a law with its values")

    @property
    def name(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The loading law's."""
        return self.law.name

    @property
    def damped(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The loading law's."""
        return self.law.damped

    @property
    def steep(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The loading law's."""
        return self.law.steep

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        return self.law.damping_factor(mass, velocity, length)

    def outside(self, depth: float) -> str:
        return self.law.outside(depth)

    def remarks(self) -> tuple[str, ...]:
        return self.law.remarks()


@dataclass(frozen=True)
class BrakeUnloading(_Reopened):
    """Any loading law with Brake's unloading (Brake 2015, Int. J. Solids Struct. 62:104):

        δ_f = δ_m (1 − F_m/F_Hertz(δ_m))
        F = (4/3) E √R̄ (δ − δ_f)^{3/2},  R̄ = F_m²/((4E/3)² (δ_m − δ_f)³)

    A law above Hertz's curve leaves no dent and returns 2/5 F_m δ_m. No energy is created if the loading work is at
    least 0.4 F_m² δ_m/F_Hertz(δ_m), as for the laws here; else a run warns.
    """

    summary: ClassVar[str] = "δ_f = δ_m (1 − F_m/F_Hertz(δ_m)), then Hertz's curve through (δ_m, F_m)"
    source: ClassVar[str] = "Brake 2015, Int. J. Solids Struct. 62:104"
    validity: ClassVar[str] = "a sphere, and a law with no more force than Hertz's"

    effective_modulus: float
    radius: float

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.law.damped:
            raise ValueError(f"law {self.law.name} is damped: it takes no rule of unloading")

    def scales(self, energy: float) -> tuple[float, float]:
        return self.law.scales(1.0)  # independent of the impact: the dent depends on the ratio to Hertz's force

    @property
    def ratio(self) -> Any:
        """K δ_s^{3/2}/F_s; exactly 1 for laws scaled by Hertz's curve, so that they share one fitted curve."""
        length, force = self.scales(1.0)
        ratio = hertz_stiffness(self.effective_modulus, self.radius) * length**1.5 / force
        return ratio + (1.0 - ratio) * (abs(ratio - 1.0) < 1e-14)

    def stages(self) -> tuple[Stage, ...]:
        return tuple(replace(stage, unloading=brake_unloading(self.ratio)) for stage in self.law.stages())


@dataclass(frozen=True)
class Retrace(_Reopened):
    """Any loading law made reversible: unloading retraces the loading curve."""

    summary: ClassVar[str] = "unloading retraces the loading curve: reversible"
    source: ClassVar[str] = "elastic contact"
    validity: ClassVar[str] = "a contact without yield"

    def scales(self, energy: float) -> tuple[float, float]:
        return self.law.scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        return tuple(replace(stage, unloading=None) for stage in self.law.stages())


UNLOADINGS: dict[str, type[AbstractLaw]] = {"brake": BrakeUnloading, "retrace": Retrace}
"""The rules by their names in [contact]."""

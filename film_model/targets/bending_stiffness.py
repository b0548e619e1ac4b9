"""Bending stiffnesses of an orthotropic plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from film_model.base.arrays import root
from film_model.base.errors import raise_all
from film_model.base.fields import InUnits, entry, fill, measure, mistake
from film_model.base.units import Value

_STIFFNESS = measure("bending_stiffness", 1e-30, 1e18, required=True)


def anisotropy(d11: float, d12: float, d22: float, d66: float) -> float:
    """A = (D12 + 2 D66)/√(D11 D22): 1 for an isotropic plate; the bending energy is positive only if A > −1."""
    return (d12 + 2 * d66) / root(d11 * d22)


def unstable(D11: Any, D12: Any, D22: Any) -> Any:
    """Whether the bending energy may be negative."""
    return D12 * D12 >= D11 * D22


@dataclass(frozen=True, init=False, repr=False)
class BendingStiffness(InUnits):
    """Bending stiffnesses of an orthotropic plate, N·m.

    D11: along the first side. D12: coupling of both curvatures. D22: along the second side. D66: of twist.

    >>> fm.BendingStiffness(D11="155 N*m", D12="45 N*m", D22="155 N*m", D66="55 N*m").D11
    155.0
    """

    D11: float = entry(_STIFFNESS)
    D12: float = entry(measure("bending_stiffness", -1e18, 1e18, required=True))
    D22: float = entry(_STIFFNESS)
    D66: float = entry(_STIFFNESS)

    def __init__(
        self, D11: Value | None = None, D12: Value | None = None, D22: Value | None = None, D66: Value | None = None
    ) -> None:
        raise_all(fill(self, locals()))
        if unstable(self.D11, self.D12, self.D22):
            raise_all(
                [
                    mistake(
                        self, "D12", "must be smaller than √(D11 D22): otherwise the plate has negative bending energy"
                    )
                ]
            )

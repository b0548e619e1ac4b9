"""One row of the catalogue of materials."""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """One material: modulus in GPa, density in kg/m³, strengths in MPa, surface energy in J/m²,
    toughness in MPa·m^0.5.

    johnson_cook: A, B [MPa] and exponent of their flow stress, of which the strain hardening exponent is taken. words:
    other names. more: sources of the values after the yield strength.
    """

    name: str
    modulus: float
    ratio: float
    density: float
    strength: float | None
    source: str
    rate: float | None = None
    loss: float | None = None
    tensile: float | None = None
    surface: float | None = None
    more: str = ""
    words: tuple[str, ...] = ()
    hardness: str | None = None
    johnson_cook: tuple[float, float, float] | None = None
    toughness: float | None = None
    crushing: float | None = None


DAMPING = "loss factor: within the range of Beranek & Vér 1992, Noise and Vibration Control Engineering"
BRITTLE = "nominal handbook value; breaks before it yields"

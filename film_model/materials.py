"""Materials, and a small catalogue of nominal values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import ClassVar

from film_model.errors import did_you_mean, raise_all, shown
from film_model.fields import Field, fill, measure, words
from film_model.units import Value


@dataclass(frozen=True, init=False)
class Material:
    """An isotropic elastic material. Quantities go in, SI floats are stored.

    youngs_modulus: Pa. poissons_ratio: 1. density: kg/m³. yield_strength: Pa, None for a material that breaks before
    it yields or whose yield does not matter. source: where the values come from.

    Only to judge effects that are not computed: loss_factor, tan δ at the frequency of the contact;
    strain_rate_coefficient, C of Johnson and Cook's 1 + C ln(ε̇/(1/s)), by which the yield strength grows.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "name": words("a name"),
        "youngs_modulus": measure("pressure", 1, 1e14, required=True),
        "poissons_ratio": measure("dimensionless", -1, 0.5, required=True, open_ends=True),
        "density": measure("density", 1e-3, 1e6, required=True),
        "yield_strength": measure("pressure", 1, 1e13),
        "source": words("a source"),
        "loss_factor": measure("dimensionless", 0, 10),
        "strain_rate_coefficient": measure("dimensionless", 0, 1),
    }

    name: str
    youngs_modulus: float
    poissons_ratio: float
    density: float
    yield_strength: float | None
    source: str
    loss_factor: float | None
    strain_rate_coefficient: float | None

    def __init__(
        self,
        name: str = "",
        youngs_modulus: Value | None = None,
        poissons_ratio: float | str | None = None,
        density: Value | None = None,
        yield_strength: Value | None = None,
        source: str = "",
        loss_factor: float | str | None = None,
        strain_rate_coefficient: float | str | None = None,
    ) -> None:
        raise_all(fill(self, locals()))


_PAPER = "Big-Alabo, Cartmell & Harrison 2017, Table 2"
_METAL = "nominal handbook value for the "
_BRITTLE = "nominal handbook value; breaks before it yields"
_POLYMER = "nominal handbook value at room temperature and slow loading"

# name, Young's modulus in GPa, Poisson's ratio, density in kg/m³, yield strength in MPa, source
_ROWS: tuple[tuple[str, float, float, float, float | None, str], ...] = (
    ("mild steel", 210, 0.30, 7850, 250, _METAL + "hot-rolled state"),
    ("bearing steel", 210, 0.30, 7810, 2030, _METAL + "hardened state of AISI 52100"),
    ("stainless steel 304", 193, 0.29, 8000, 215, _METAL + "annealed state"),
    ("aluminium 6061-T6", 68.9, 0.33, 2700, 276, _METAL + "T6 state"),
    ("aluminium 2024-T3", 73.1, 0.33, 2780, 345, _METAL + "T3 state"),
    ("titanium Ti-6Al-4V", 113.8, 0.342, 4430, 880, _METAL + "annealed state"),
    ("copper", 117, 0.34, 8940, 70, _METAL + "annealed state"),
    ("brass", 105, 0.34, 8500, 200, _METAL + "half-hard state of cartridge brass"),
    ("cast iron", 110, 0.26, 7200, None, _BRITTLE + " (grey iron)"),
    ("tungsten carbide", 600, 0.28, 14500, None, _PAPER),
    ("alumina", 370, 0.22, 3900, None, _BRITTLE + " (99 % pure)"),
    ("zirconia", 210, 0.30, 6050, None, _BRITTLE + " (yttria-stabilised)"),
    ("silicon nitride", 310, 0.27, 3200, None, _BRITTLE + " (bearing grade)"),
    ("soda-lime glass", 70, 0.22, 2500, None, _BRITTLE),
    ("PMMA", 3.0, 0.37, 1180, 70, _POLYMER),
    ("polycarbonate", 2.4, 0.37, 1200, 62, _POLYMER),
    ("nylon 6/6", 2.9, 0.40, 1140, 80, _POLYMER + ", dry"),
)


@cache
def catalogue() -> Mapping[str, Material]:
    """The catalogue, by name. Values are nominal: real ones vary with grade, heat treatment, rate and temperature."""
    return {
        name: Material(
            name,
            f"{modulus} GPa",
            ratio,
            f"{density} kg/m^3",
            None if strength is None else f"{strength} MPa",
            source,
        )
        for name, modulus, ratio, density, strength, source in _ROWS
    }


def material(name: str) -> Material:
    """The material of that name in the catalogue; upper and lower case are the same."""
    for known, found in catalogue().items():
        if known.lower() == name.strip().lower():
            return found
    raise ValueError(f"no material of the catalogue is called {shown(name)}{did_you_mean(name, catalogue())}")

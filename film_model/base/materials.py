"""Materials, and a small catalogue of nominal values, each with its source, in `materials.csv`."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, TypeAlias, cast

from film_model.base.arrays import root
from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.fields import Field, InUnits, build, entry, fill, measure, mistake, part, words
from film_model.base.flow_stress import (
    MOST_HARDENING,
    MOST_OVER_YIELD,
    SCATTER,
    contradicts,
    flow_of_hardness,
    flow_of_yield,
    johnson_cook_exponent,
    yield_of_flow,
)
from film_model.base.hardness import HARDNESS
from film_model.base.pairs import Pairs, read_pairs, write_pairs
from film_model.base.units import Value, format_si

MOST_RELAXATIONS = 12
"""Pairs of a Prony series."""

MOST_RELAXED = 0.9999
"""Limit of the sum of a Prony series' relative moduli: a modulus that falls to 0 leaves no solid."""

USUAL = (0.3, 3.0)
"""Mass over density × volume of a ball of the contact's radius, and numbers of a material over those of the catalogue
under its name, beyond which there is a remark."""

_PAIR = (measure("dimensionless", 0, 1, open_ends=True), measure("time", 1e-12, 1e12))


_PRONY_NEEDED = (
    f"a list of 1 to {MOST_RELAXATIONS} pairs of a relative modulus and a relaxation time is needed, e.g. "
    '[[0.3, "1 ms"]]'
)


def _read_prony(value: object) -> Pairs:
    """The pairs of a Prony series, e.g. [[0.3, "1 ms"], [0.2, "10 ms"]]."""
    found = read_pairs(value, _PAIR, MOST_RELAXATIONS, _PRONY_NEEDED)
    total = sum(modulus for modulus, _ in found)
    if not total < MOST_RELAXED:
        raise ValueError(f"the relative moduli add up to {total:g}, which must be < {MOST_RELAXED:g}")
    return found


PRONY = Field(_read_prony, _PRONY_NEEDED, write=lambda pairs: write_pairs(pairs, _PAIR))


@dataclass(frozen=True, init=False, repr=False)
class Material(InUnits):
    """An isotropic elastic material. Quantities go in, SI floats are stored.

    name: in messages. youngs_modulus: Pa. poissons_ratio: dimensionless. density: kg/m³. yield_strength: Pa; none for a
    brittle material or if unknown. source: where the values come from.

    hardness: "600 HV", "200 HB", "60 HRC" or a pressure; stored as the mean pressure over the projected area, Pa. Laws
    then take hardness/2.8, ±15 %, as the strength, instead of the yield strength. HB and HRC are converted as for
    steels, a further ±5 %, which outputs do not repeat, since they have the pressure alone.

    strain_hardening_exponent: n of the flow stress Y (1 + E ε/Y)^n. strength_coefficient: B of Johnson and Cook's flow
    stress A + B ε^m, Pa, whose A is the yield strength, in place of n. strength_exponent: m of this stress.

    strain_rate_coefficient: C of Johnson and Cook's factor 1 + C ln(ε̇/(1/s)) on the yield strength. rate_multiplier: D
    of Cowper and Symonds' factor 1 + (ε̇/D)^(1/q), 1/s, in place of C. rate_exponent: q of this
    factor.

    surface_energy: of one surface, J/m²; those of both bodies give the work of adhesion. loss_factor: tan δ at the
    frequency of the contact, only to estimate damping. tensile_strength: of a brittle material, Pa, only to estimate
    whether it cracks. fracture_toughness: K_Ic of a brittle material, Pa·m^0.5, for the same, instead of the strength.
    crushing_strength: uniaxial compressive strength of a brittle material, Pa, the mean pressure above which a contact
    is taken to crush it, instead of both.

    prony: of a viscoelastic material, pairs of a relative modulus g and a relaxation time τ [s]. The modulus relaxes as
    E(t) = E₀ [1 − Σ g (1 − exp(−t/τ))] at a constant Poisson's ratio; youngs_modulus is then the instantaneous E₀, and
    E₀ (1 − Σ g) > 0 the modulus of slow loading. At most 12 pairs.

    >>> fm.Material("ours", youngs_modulus="205 GPa", poissons_ratio=0.29, density="7.9 g/cm^3").density  # kg/m³
    7900.0
    """

    name: str = entry(words("a name"))
    youngs_modulus: float = entry(measure("pressure", 1, 1e14, required=True))
    poissons_ratio: float = entry(measure("dimensionless", -1, 0.5, required=True, open_ends=True))
    density: float = entry(measure("density", 1e-3, 1e6, required=True))
    yield_strength: float | None = entry(measure("pressure", 1, 1e13))
    hardness: float | None = entry(HARDNESS)
    source: str = entry(words("a source"))
    loss_factor: float | None = entry(measure("dimensionless", 0, 10))
    strain_rate_coefficient: float | None = entry(measure("dimensionless", 0, 1))
    strain_hardening_exponent: float | None = entry(measure("dimensionless", 0, MOST_HARDENING))
    strength_coefficient: float | None = entry(measure("pressure", 1, 1e13))
    strength_exponent: float | None = entry(measure("dimensionless", 0, 1, open_ends=True))
    rate_multiplier: float | None = entry(measure("rate", 1e-9, 1e15))
    rate_exponent: float | None = entry(measure("dimensionless", 1, 100))
    tensile_strength: float | None = entry(measure("pressure", 1, 1e12))
    surface_energy: float | None = entry(measure("surface_energy", 0, 1e3))
    fracture_toughness: float | None = entry(measure("fracture_toughness", 1, 1e12))
    crushing_strength: float | None = entry(measure("pressure", 1, 1e12))
    prony: tuple[tuple[float, float], ...] | None = entry(PRONY)

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
        tensile_strength: Value | None = None,
        surface_energy: Value | None = None,
        prony: Sequence[tuple[float | str, Value]] | None = None,
        strain_hardening_exponent: float | str | None = None,
        hardness: Value | None = None,
        strength_coefficient: Value | None = None,
        strength_exponent: float | str | None = None,
        rate_multiplier: Value | None = None,
        rate_exponent: float | str | None = None,
        fracture_toughness: Value | None = None,
        crushing_strength: Value | None = None,
    ) -> None:
        mistakes = fill(self, locals())
        raise_all(mistakes or self._contradictions())

    def _contradictions(self) -> list[Mistake]:
        """Values that do not fit each other."""
        found: dict[str, str] = {}
        for one, other in (("strength_coefficient", "strength_exponent"), ("rate_multiplier", "rate_exponent")):
            for name, partner in ((one, other), (other, one)):
                if getattr(self, name) is None and getattr(self, partner) is not None:
                    found[name] = f"missing: {partner} needs it"
        if self.strength_coefficient is not None and self.yield_strength is None:
            found["yield_strength"] = "missing: strength_coefficient needs it, Johnson and Cook's A"
        elif self.strength_coefficient is not None and self.strain_hardening_exponent is not None:
            found["strain_hardening_exponent"] = "give it, or strength_coefficient and strength_exponent, not both"
        elif self.strength_coefficient is not None and not found and self.hardening_exponent > MOST_HARDENING:
            found["strength_coefficient"] = (
                f"it hardens as the exponent {self.hardening_exponent:.3g}, which must be <= {MOST_HARDENING:g}"
            )
        if self.rate_multiplier is not None and self.strain_rate_coefficient is not None:
            found["rate_multiplier"] = "give it and rate_exponent, or strain_rate_coefficient, not both"
        known = self.hardness is not None and self.yield_strength is not None
        if known and contradicts(self.hardness, self.yield_strength):
            flow, strength = flow_of_hardness(self.hardness), cast("float", self.yield_strength)
            found["hardness"] = (
                f"it gives a flow stress of {format_si(flow, 'pressure', 3)}, and with the yield strength "
                f"{format_si(strength, 'pressure', 3)} it must be from {1.0 - SCATTER:g} to "
                f"{MOST_OVER_YIELD:g} times that: correct one of them"
            )
        return [mistake(self, name, message) for name, message in found.items()]

    @cached_property
    def shear_velocity(self) -> float:
        """c_T = √(G/ρ) of shear waves, m/s."""
        return root(self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio)) / self.density)

    @cached_property
    def remarks(self) -> list[str]:
        """Sentences about numbers, not of the catalogue, that are possible, but more often a mistake of units."""
        softest = 1e5  # Young's modulus of the softest rubbers, Pa; gels and foams may have less
        heaviest = 23000.0
        lightest = 10.0  # densities of light foams and of osmium, kg/m³
        usual = named(self.name)
        if usual == self:
            return []
        found: list[str] = []
        for name, dimension in (("density", "density"), ("youngs_modulus", "pressure")):
            value = getattr(self, name)
            if usual is not None and not USUAL[0] <= value / getattr(usual, name) <= USUAL[1]:
                known = format_si(getattr(usual, name), dimension)
                found.append(f"{name}: {format_si(value, dimension)}, but {usual.name} has {known}; check units")
        if not found and not lightest <= self.density <= heaviest:
            of = "a light foam" if self.density < lightest else "osmium"
            limit = format_si(lightest if self.density < lightest else heaviest, "density")
            found.append(f"density: {format_si(self.density, 'density')}, but {of} has {limit}; check units")
        if not found and self.youngs_modulus < softest:
            modulus, limit = format_si(self.youngs_modulus, "pressure"), format_si(softest, "pressure")
            found.append(f"youngs_modulus: {modulus}, but a soft rubber has {limit}; check units")
        if self.yield_strength is not None and self.yield_strength > self.youngs_modulus:
            strength, modulus = (format_si(value, "pressure") for value in (self.yield_strength, self.youngs_modulus))
            found.append(f"youngs_modulus: {modulus} is less than the yield strength, {strength}; check units")
        return found

    @cached_property
    def hardening_exponent(self) -> float:
        """n of the flow stress, given or from Johnson and Cook's constants; 0 if neither is known."""
        if self.strain_hardening_exponent is not None:
            return self.strain_hardening_exponent
        if self.strength_coefficient is None:
            return 0.0
        constants = (self.yield_strength, self.strength_coefficient, self.strength_exponent, self.youngs_modulus)
        return johnson_cook_exponent(*constants)

    @cached_property
    def flow_strength(self) -> float | None:
        """Flow stress at 8 % plastic strain, Pa, the strength of laws without hardening: from the hardness, else from
        the yield strength and hardening; None if neither is known."""
        if self.hardness is not None:
            return flow_of_hardness(self.hardness)
        if self.yield_strength is None or not self._hardens:
            return self.yield_strength
        return flow_of_yield(self.yield_strength, self.hardening_exponent, self.youngs_modulus)

    @cached_property
    def initial_strength(self) -> float | None:
        """Strength at first yield, Pa, of laws with hardening: it gives the flow strength with the exponent n."""
        if self.hardness is None or not self._hardens:
            return self.yield_strength if self.hardness is None else self.flow_strength
        return yield_of_flow(self.flow_strength, self.hardening_exponent, self.youngs_modulus)

    @property
    def flow_known(self) -> bool:
        """Whether the strength at the strain of a contact is known, not only that at first yield."""
        return self.hardness is not None or self._hardens

    @property
    def _hardens(self) -> bool:
        return self.strain_hardening_exponent is not None or self.strength_coefficient is not None


AMBIGUOUS = {"steel": ("structural steel S235", "mild steel", "bearing steel", "stainless steel 304")}
"""Words that are too wide for a material, and materials that may be meant."""


@cache
def catalogue() -> Mapping[str, Material]:
    """The catalogue, by name. Values are nominal: real ones vary with grade, heat treatment, rate and temperature."""
    return {name: _of_name(name) for name in _rows()}


@cache
def _of_name(name: str) -> Material:
    return _material(_rows()[name])


@cache
def _rows() -> dict[str, dict[str, str]]:
    """The rows of the table by name: entries of a material, some with their unit, and other names for it."""
    import csv

    with open(f"{os.path.splitext(__file__)[0]}.csv", encoding="utf-8", newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def _material(row: Mapping[str, str]) -> Material:
    given = {heading.partition(" [")[0::2]: cell for heading, cell in row.items() if cell}
    values = {name: f"{cell} {unit.rstrip(']')}".rstrip() for (name, unit), cell in given.items()}
    values.pop("other names", None)
    return build(Material, values)


def _words(row: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(row["other names"].split("; ")) if row["other names"] else ()


@cache
def _names() -> Mapping[str, str]:
    """The name of a material by every word for it, in lower case and British spelling."""
    return {_plain(word): name for name, row in _rows().items() for word in (*_words(row), name)}


def _plain(name: str) -> str:
    return " ".join(name.lower().split()).replace("aluminum", "aluminium")


def named(name: str) -> Material | None:
    """The material of the catalogue with that name or synonym, None if there is none."""
    found = _names().get(_plain(name))
    return None if found is None else _of_name(found)


def material(name: str) -> Material:
    """The material of that name, or of another word for it; case and the American spelling of aluminium are ignored.

    >>> fm.material("aluminum 6061-T6").yield_strength  # Pa
    276000000.0
    """
    if (found := named(name)) is not None:
        return found
    word, names = _plain(name), _names()
    if word in AMBIGUOUS:
        kinds = ", ".join(f'"{kind}"' for kind in AMBIGUOUS[word])
        raise ValueError(f"{shown(name)} yields at 200 to 2500 MPa, depending on the grade: give one, e.g. {kinds}")
    parts = [found.name for found in search(name)][:6]
    if len(parts) > 1:
        hint = "; there are " + ", ".join(f'"{part}"' for part in parts)
    else:
        import difflib

        near = difflib.get_close_matches(word[:100], names, n=1, cutoff=0.75)
        nearest = parts[0] if parts else names[near[0]] if near else None
        hint = f'; did you mean "{nearest}"?' if nearest else '; "film-model materials" lists all'
    raise ValueError(f"no material of the catalogue is called {shown(name)}{hint}")


def synonyms(name: str) -> tuple[str, ...]:
    """Other words for a material of the catalogue."""
    return _words(_rows()[name])


def search(words: str) -> list[Material]:
    """The materials whose name, or one of the other words for it, contains all the words."""
    wanted = _plain(words).split()
    texts = {name: " ".join(map(_plain, (name, *_words(row)))) for name, row in _rows().items()}
    return [_of_name(name) for name, text in texts.items() if wanted and all(word in text for word in wanted)]


MaterialLike: TypeAlias = Material | str | Mapping[str, Any]
"""A material, its name in the catalogue, or a table of its values."""

MATERIAL = part(Material, by_name=material)
REQUIRED_MATERIAL = part(Material, by_name=material, required=True)
MASS = measure("mass", 1e-28, 1e12)


def sphere_mass(mass: float | None, radius: float, of: Material | None) -> float | None:
    """The given mass, or density × sphere volume, kg; None if neither is known."""
    if mass is not None or of is None:
        return mass
    return of.density * 4 / 3 * math.pi * radius**3

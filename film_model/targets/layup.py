"""Plates of layers: bending stiffness by classical lamination theory, and a small catalogue of plies."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any, TypeAlias, cast

import numpy as np

from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.fields import Field, InUnits, build, entry, fill, measure, mistake, part, words
from film_model.base.materials import Material, MaterialLike
from film_model.base.materials import material as plain_material
from film_model.base.units import Value
from film_model.targets.modes import Array

MOST_PLIES = 1000

ALIKE = 1e-9
"""Relative difference up to which two plies count as equal."""


@dataclass(frozen=True, init=False, repr=False)
class PlyMaterial(InUnits):
    """An orthotropic ply, in its axes: 1 along the fibres, 2 across.

    name: in messages. E1: modulus along the fibres, Pa. E2: modulus across, Pa. G12: shear modulus, Pa. nu12: strain
    across over strain along, under stress along. density: kg/m³. source: where the values come from.
    """

    name: str = entry(words("a name"))
    E1: float = entry(measure("pressure", 1, 1e14, required=True))
    E2: float = entry(measure("pressure", 1, 1e14, required=True))
    G12: float = entry(measure("pressure", 1, 1e14, required=True))
    nu12: float = entry(measure("dimensionless", -10, 10, required=True))
    density: float = entry(measure("density", 1e-3, 1e6, required=True))
    source: str = entry(words("a source"))

    def __init__(
        self,
        name: str = "",
        E1: Value | None = None,
        E2: Value | None = None,
        G12: Value | None = None,
        nu12: float | str | None = None,
        density: Value | None = None,
        source: str = "",
    ) -> None:
        raise_all(fill(self, locals()))
        if self.nu12**2 >= self.E1 / self.E2:
            raise_all(
                [mistake(self, "nu12", f"{self.nu12:g} must be below √(E1/E2) = {math.sqrt(self.E1 / self.E2):.4g}")]
            )


_TSAI = "Tsai & Hahn 1980, Introduction to Composite Materials, Table 1.7"
_SODEN = "Soden, Hinton & Kaddour 1998, Compos. Sci. Technol. 58:1011, Table 1"
_DANIEL = "density as given by Daniel & Ishai 2006, Engineering Mechanics of Composite Materials"

# name, E1, E2, G12 in GPa, ν12, density in kg/m³, source
_ROWS = (
    ("carbon/epoxy UD", 181.0, 10.3, 7.17, 0.28, 1600, f"T300/5208: {_TSAI}"),
    ("carbon/epoxy UD AS/3501", 138.0, 8.96, 7.1, 0.30, 1600, _TSAI),
    ("carbon/epoxy UD AS4/3501-6", 126.0, 11.0, 6.6, 0.28, 1600, f"{_SODEN}; {_DANIEL}"),
    ("glass/epoxy UD", 38.6, 8.27, 4.14, 0.26, 1800, f"Scotchply 1002: {_TSAI}"),
    ("aramid/epoxy UD", 76.0, 5.5, 2.3, 0.34, 1460, f"Kevlar 49/epoxy: {_TSAI}"),
    ("boron/epoxy UD", 204.0, 18.5, 5.59, 0.23, 2000, f"B(4)/5505: {_TSAI}"),
)


@cache
def plies() -> Mapping[str, PlyMaterial]:
    """The catalogue of plies, by name. Values are nominal: real ones vary with fibre content and manufacture."""
    return {
        name: PlyMaterial(name, f"{e1} GPa", f"{e2} GPa", f"{g12} GPa", nu12, f"{density} kg/m^3", source)
        for name, e1, e2, g12, nu12, density, source in _ROWS
    }


def ply_material(name: str) -> PlyMaterial:
    """The ply of that name in the catalogue, case is ignored; or the isotropic material of that name."""
    for known, found in plies().items():
        if known.lower() == name.strip().lower():
            return found
    with suppress(ValueError):
        return isotropic(plain_material(name))
    names = ", ".join(plies())
    raise ValueError(
        f"no ply and no material is called {shown(name)}{did_you_mean(name, plies()) or '; there are ' + names}"
    )


def isotropic(material: Material) -> PlyMaterial:
    """A layer of isotropic material, a metal sheet or a core: E1 = E2 = E, G12 = E/(2 (1 + ν))."""
    modulus, ratio = material.youngs_modulus, material.poissons_ratio
    shear = modulus / (2.0 * (1.0 + ratio))
    along, twist, density = f"{modulus!r} Pa", f"{shear!r} Pa", f"{material.density!r} kg/m^3"
    return PlyMaterial(material.name, along, along, twist, ratio, density, material.source)


_ORTHOTROPIC = part(PlyMaterial, required=True, by_name=ply_material)


def _read_material(value: object) -> PlyMaterial:
    """A ply's material; or an isotropic one, as an object or a table with its modulus."""
    if isinstance(value, Material):
        return isotropic(value)
    if isinstance(value, Mapping) and "youngs_modulus" in value:
        return isotropic(build(Material, cast("Mapping[str, object]", value)))
    return _ORTHOTROPIC.read(value)


@dataclass(frozen=True, init=False, repr=False)
class Ply(InUnits):
    """A layer. material: of a ply, or isotropic: name, object or table. thickness: m. angle: from the plate's first
    side to the fibres, degrees; without effect on an isotropic layer."""

    material: PlyMaterial = entry(replace(_ORTHOTROPIC, read=_read_material))
    thickness: float = entry(measure("length", 1e-9, 10, required=True))
    angle: float = entry(measure("dimensionless", -360, 360, required=True))

    def __init__(
        self,
        material: PlyMaterial | MaterialLike | None = None,
        thickness: Value | None = None,
        angle: float | str | None = None,
    ) -> None:
        raise_all(fill(self, locals()))


PlyLike: TypeAlias = Ply | Sequence[Any] | Mapping[str, Any]
"""A ply, a list [material, thickness, angle], or a table of them."""


def _read_layup(value: object) -> tuple[Ply, ...]:
    if isinstance(value, str) or not isinstance(value, Sequence) or not 1 <= len(value) <= MOST_PLIES:
        raise ValueError(f"{shown(value)} is not allowed: {LAYUP.need}")
    found: list[Ply] = []
    mistakes: list[Mistake] = []
    for place, item in enumerate(cast("Sequence[object]", value), 1):
        try:
            found.append(_read_ply(item))
        except SceneError as error:
            for wrong in error.mistakes:
                entry = wrong.key.partition(".")[2]
                mistakes.append(Mistake(None, None, "Plate.layup", f"layer {place}: {entry}: {wrong.message}"))
        except ValueError as error:
            mistakes.append(Mistake(None, None, "Plate.layup", f"layer {place}: {error}"))
    raise_all(mistakes)
    layers = tuple(found)
    for k, (one, other) in enumerate(zip(layers, layers[::-1], strict=True), 1):
        if not _alike(one, other):
            raise ValueError(
                f"layer {k}, counted from one face, differs from layer {k} counted from the other: the layup is not "
                "symmetric, so bending would be coupled with stretching, which is not modelled"
            )
    return layers


def _read_ply(item: object) -> Ply:
    if isinstance(item, Ply):
        return item
    if isinstance(item, Mapping):
        return build(Ply, cast("Mapping[str, object]", item))
    if isinstance(item, str) or not isinstance(item, Sequence) or len(item) != 3:
        raise ValueError(f'{shown(item)} is not a layer, a list such as ["carbon/epoxy UD", "0.125 mm", 45] is needed')
    return Ply(*cast("Sequence[Any]", item))


def _alike(one: Ply, other: Ply) -> bool:
    turn = (one.angle - other.angle) % 180.0
    same = abs(one.thickness - other.thickness) <= ALIKE * one.thickness
    return same and one.material == other.material and (_turnable(one.material) or min(turn, 180.0 - turn) <= 1e-9)


def _turnable(material: PlyMaterial) -> bool:
    """Whether it is isotropic, so that its angle has no effect."""
    shear = material.E1 / (2.0 * (1.0 + material.nu12))
    return material.E1 == material.E2 and abs(material.G12 - shear) <= ALIKE * shear


LAYUP = Field(
    _read_layup,
    f'a list of 1 to {MOST_PLIES} layers such as [["carbon/epoxy UD", "0.125 mm", 0], …] is needed',
    dimension="dimensionless",
)


@lru_cache(maxsize=64)
def laminate(layers: tuple[Ply, ...]) -> tuple[float, float, float, float, float, float]:
    """D11, D12, D22, D66, D16, D26 of a layup, N·m: Σ Q̄ (z₂³ − z₁³)/3 over its layers (classical lamination
    theory)."""
    height = sum(ply.thickness for ply in layers)
    total, bottom = np.zeros((3, 3)), -height / 2
    for ply in layers:
        top = bottom + ply.thickness
        total += _turned(ply) * (top**3 - bottom**3) / 3
        bottom = top
    d = total.tolist()
    return d[0][0], d[0][1], d[1][1], d[2][2], d[0][2], d[1][2]


def _turned(ply: Ply) -> Array:
    """Plane-stress stiffness Q̄ of a ply in the axes of the plate, Pa."""
    m = ply.material
    minor = 1 - m.nu12**2 * m.E2 / m.E1
    own = np.array([[m.E1, m.nu12 * m.E2, 0.0], [m.nu12 * m.E2, m.E2, 0.0], [0.0, 0.0, m.G12 * minor]]) / minor
    c, s = math.cos(math.radians(ply.angle)), math.sin(math.radians(ply.angle))
    # strains in the ply's axes from those of the plate; γ is twice the tensor's shear
    strain = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
    return strain.T @ own @ strain


@lru_cache(maxsize=64)
def coupling(layers: tuple[Ply, ...]) -> tuple[float, float]:
    """(|D16| + |D26|)/√(D11 D22), and the relative change of the impedance of an infinite plate by D16 and D26.

    1/Z is the mean over the directions θ of 1/√D(θ), D(θ) = D11 c⁴ + 4 D16 c³s + 2 (D12 + 2 D66) c²s² + 4 D26 cs³ +
    D22 s⁴.
    """
    d11, d12, d22, d66, d16, d26 = laminate(layers)
    theta = np.linspace(0.0, math.pi, 720, endpoint=False)
    c, s = np.cos(theta), np.sin(theta)
    plain = d11 * c**4 + 2 * (d12 + 2 * d66) * (c * s) ** 2 + d22 * s**4
    full = plain + 4 * c * s * (d16 * c**2 + d26 * s**2)
    size = (abs(d16) + abs(d26)) / math.sqrt(d11 * d22)
    return size, abs(float(np.mean(plain**-0.5) / np.mean(full**-0.5)) - 1.0)

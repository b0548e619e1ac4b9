"""What collides: the impactor and the targets. Quantities go in, SI floats are stored."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, ClassVar, Literal, TypeAlias, cast

from film_model import targets
from film_model.elementwise import lesser, root
from film_model.errors import Mistake, raise_all
from film_model.fields import Field, choice, fill, measure, part, several
from film_model.materials import Material, material
from film_model.units import Value

STANDARD_GRAVITY = 9.80665  # m/s²

SLOWEST = 1e-100  # m/s; the squares of lower speeds in the units of an impact are no numbers

_RADIUS = measure("length", 1e-10, 1e3)
_LENGTH = measure("length", 1e-10, 1e5)
_MASS = measure("mass", 1e-28, 1e12)
_PLACE = measure("length", 0, 1e5)
_STATIC = measure("stiffness", 1e-12, 1e18)
_STIFFNESS = measure("bending_stiffness", 1e-30, 1e18, required=True)
_MATERIAL = part(Material, by_name=material)

MaterialLike: TypeAlias = Material | str | Mapping[str, Any]
"""A material, its name in the catalogue, or a table of its values."""


def _mistake(owner: object, name: str, message: str) -> Mistake:
    return Mistake(None, None, f"{type(owner).__name__}.{name}", message)


def _one_of(owner: object, **values: object) -> list[Mistake]:
    """The mistake of giving neither or both of two values."""
    first, second = values
    given = [name for name, value in values.items() if value is not None]
    if len(given) == 1:
        return []
    message = f"give {first} or {second}, not both" if given else f"missing: {first} or {second} is needed"
    return [_mistake(owner, second if given else first, message)]


def _ball_mass(mass: float | None, radius: float, of: Material | None) -> float | None:
    """The mass given, or else density × sphere volume; None if there is no way to know."""
    if mass is not None or of is None:
        return mass
    return of.density * 4 / 3 * math.pi * radius**3


@dataclass(frozen=True, init=False)
class Sphere:
    """The impactor.

    radius: of the contacting surface, m. velocity: towards the target, m/s; or drop_height: of a fall from rest, m.
    mass: kg; left out, density × sphere volume.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "radius": measure("length", 1e-10, 1e3, required=True),
        "velocity": measure("velocity", 0, 2e4),
        "drop_height": measure("length", 0, 1e5),
        "mass": _MASS,
        "material": _MATERIAL,
    }

    radius: float
    velocity: float | None
    drop_height: float | None
    mass: float | None
    material: Material | None

    def __init__(
        self,
        radius: Value | None = None,
        velocity: Value | None = None,
        drop_height: Value | None = None,
        mass: Value | None = None,
        material: MaterialLike | None = None,
    ) -> None:
        mistakes = fill(self, locals()) + _one_of(self, velocity=velocity, drop_height=drop_height)
        if not mistakes and 0.0 < self.speed < SLOWEST:
            name = "drop_height" if velocity is None else "velocity"
            mistakes.append(_mistake(self, name, f"{self.speed:g} m/s must be 0 or at least {SLOWEST:g} m/s"))
        raise_all(mistakes)

    @property
    def speed(self) -> float:
        """Velocity at the beginning of contact, m/s: as given, or √(2 g h)."""
        if self.velocity is not None:
            return self.velocity
        return root(2 * STANDARD_GRAVITY * cast("float", self.drop_height))

    @property
    def own_mass(self) -> float | None:
        """The mass given, or density × sphere volume, kg; None if there is no way to know."""
        return _ball_mass(self.mass, self.radius, self.material)


@dataclass(frozen=True, init=False)
class HalfSpace:
    """A target too thick and wide to move. radius: of a curved surface, m."""

    kind: ClassVar[str] = "half-space"
    FIELDS: ClassVar[Mapping[str, Field]] = {"material": _MATERIAL, "radius": _RADIUS}

    material: Material | None
    radius: float

    def __init__(self, material: MaterialLike | None = None, radius: Value | None = None) -> None:
        raise_all(_fill_target(self, locals()))


@dataclass(frozen=True, init=False)
class BendingStiffness:
    """Bending stiffnesses of an orthotropic plate, N·m."""

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "D11": _STIFFNESS,
        "D12": measure("bending_stiffness", -1e18, 1e18, required=True),
        "D22": _STIFFNESS,
        "D66": _STIFFNESS,
    }

    D11: float
    D12: float
    D22: float
    D66: float

    def __init__(
        self, D11: Value | None = None, D12: Value | None = None, D22: Value | None = None, D66: Value | None = None
    ) -> None:
        raise_all(fill(self, locals()))
        if self.D12**2 >= self.D11 * self.D22:
            raise_all([_mistake(self, "D12", "must be smaller than √(D11 D22): such a plate would bend by itself")])


@dataclass(frozen=True, init=False)
class Plate:
    """A thin plate: infinite, or rectangular with waves that come back from its edges.

    Isotropic: material and thickness [m]. Otherwise: mass_per_area [kg/m²] and bending_stiffness [N·m]. size: the
    two sides, m; D11 is the stiffness along the first. edges: all four "simply supported" or "clamped". position: of
    the impact, distances from a corner along the two sides, m; left out, the centre. static_stiffness: force over
    deflection at that point, N/m, instead of the one of such a plate. impedance_formula: "exact", or "paper" to
    reproduce published results. radius: of a curved surface, m.
    """

    kind: ClassVar[str] = "plate"
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "material": _MATERIAL,
        "thickness": measure("length", 1e-10, 1e3),
        "mass_per_area": measure("mass_per_area", 1e-9, 1e9),
        "bending_stiffness": part(BendingStiffness),
        "size": several(_LENGTH, 2),
        "edges": choice("simply supported", "clamped"),
        "position": several(_PLACE, 2),
        "static_stiffness": _STATIC,
        "impedance_formula": choice("exact", "paper"),
        "radius": _RADIUS,
    }

    material: Material | None
    thickness: float | None
    mass_per_area: float | None
    bending_stiffness: BendingStiffness | None
    size: tuple[float, float] | None
    edges: Literal["simply supported", "clamped"]
    position: tuple[float, float] | None
    static_stiffness: float | None
    impedance_formula: Literal["exact", "paper"]
    radius: float

    def __init__(
        self,
        material: MaterialLike | None = None,
        thickness: Value | None = None,
        mass_per_area: Value | None = None,
        bending_stiffness: BendingStiffness | Mapping[str, Any] | None = None,
        size: Sequence[Value] | None = None,
        impedance_formula: Literal["exact", "paper"] = "exact",
        radius: Value | None = None,
        edges: Literal["simply supported", "clamped"] = "simply supported",
        position: Sequence[Value] | None = None,
        static_stiffness: Value | None = None,
    ) -> None:
        mistakes = _fill_target(self, locals())
        mistakes += _place_mistakes(self, "size", self.size, self.position)
        if edges == "clamped" and size is None and static_stiffness is None:
            mistakes.append(_mistake(self, "edges", "needs a size: an infinite plate has no edges to clamp"))
        either = "give thickness (isotropic), or mass_per_area and bending_stiffness"
        pair = {"mass_per_area": mass_per_area, "bending_stiffness": bending_stiffness}
        given = [name for name, value in pair.items() if value is not None]
        if thickness is None and len(given) < 2:
            missing = "thickness" if not given else next(name for name in pair if name not in given)
            mistakes.append(_mistake(self, missing, f"missing: {either}"))
        if thickness is not None:
            mistakes += [_mistake(self, name, f"{either}, not both") for name in given]
            if material is None:
                mistakes.append(_mistake(self, "material", f"missing: a plate of given thickness needs it; {either}"))
        raise_all(mistakes)

    @property
    def surface_density(self) -> float:
        """Mass per area, kg/m²."""
        if self.mass_per_area is not None:
            return self.mass_per_area
        return cast("Material", self.material).density * cast("float", self.thickness)

    @property
    def stiffness(self) -> tuple[float, float, float, float]:
        """D11, D12, D22 and D66, N·m."""
        given = self.bending_stiffness
        if given is not None:
            return given.D11, given.D12, given.D22, given.D66
        material, thickness = cast("Material", self.material), cast("float", self.thickness)
        ratio = material.poissons_ratio
        d = targets.plate_stiffness(material.youngs_modulus, ratio, thickness)
        return d, ratio * d, d, (1 - ratio) / 2 * d

    @property
    def impedance(self) -> float:
        """Wave impedance, N·s/m."""
        if self.bending_stiffness is None:
            return targets.plate_impedance(self.surface_density, self.stiffness[0])
        exact = self.impedance_formula == "exact"
        formula = targets.orthotropic_plate_impedance if exact else targets.paper_plate_impedance
        return formula(self.surface_density, *self.stiffness)

    @property
    def whole_mass(self) -> float | None:
        """Mass of a plate with edges, kg."""
        return None if self.size is None else self.surface_density * self.size[0] * self.size[1]

    @property
    def return_time(self) -> float:
        """Time within which no wave that matters has come back from an edge, s; infinite without edges.

        0.08 d² √(ρ_A/D) for an edge at distance d, D the stiffness towards it. A Hertz contact as long, on a square
        plate struck at its centre with Zener's λ up to 1, ends within 1 % of the time that an infinite plate gives
        it, and its peak force differs by 1e-4. A slow rebound (λ above 1.5) is touched again by any plate with edges.
        """
        if self.size is None:
            return math.inf
        d11, _, d22, _ = self.stiffness
        sides = zip(self._struck, self.size, (d11, d22), strict=True)
        times = (0.08 * min(x, side - x) ** 2 * root(self.surface_density / d) for x, side, d in sides)
        return reduce(lesser, times)

    @property
    def compliance(self) -> float | None:
        """Static deflection over force at the struck point, m/N; None if there is no way to know."""
        if self.static_stiffness is not None:
            return 1 / self.static_stiffness
        if self.size is None:
            return None
        formula = targets.plate_compliance if self.edges == "simply supported" else targets.clamped_plate_compliance
        return formula(self.stiffness, self.size, self._struck)

    def modes(self, highest: float) -> targets.Modes:
        """Natural vibrations of the simply supported plate up to a frequency [rad/s]."""
        assert self.size is not None and self.edges == "simply supported"
        return targets.plate_modes(self.surface_density, self.stiffness, self.size, self._struck, highest)

    @property
    def _struck(self) -> tuple[float, float]:
        a, b = cast("tuple[float, float]", self.size)
        return self.position or (a / 2, b / 2)


@dataclass(frozen=True, init=False)
class Beam:
    """A slender beam of rectangular cross-section, struck across its thickness.

    length: between the supports, width and thickness, m. ends: both "simply supported" or "clamped", or "cantilever",
    clamped at the first only. position: of the impact, distance from the first end, m; left out, the middle, or the
    free end of a cantilever. static_stiffness: force over deflection at that point, N/m, instead of the one of such a
    beam. radius: of a curved surface, m.
    """

    kind: ClassVar[str] = "beam"
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "material": part(Material, by_name=material, required=True),
        "length": measure("length", 1e-10, 1e5, required=True),
        "width": measure("length", 1e-10, 1e5, required=True),
        "thickness": measure("length", 1e-10, 1e3, required=True),
        "ends": choice("simply supported", "clamped", "cantilever"),
        "position": _PLACE,
        "static_stiffness": _STATIC,
        "radius": _RADIUS,
    }

    material: Material
    length: float
    width: float
    thickness: float
    ends: Literal["simply supported", "clamped", "cantilever"]
    position: float | None
    static_stiffness: float | None
    radius: float

    def __init__(
        self,
        material: MaterialLike | None = None,
        length: Value | None = None,
        width: Value | None = None,
        thickness: Value | None = None,
        ends: Literal["simply supported", "clamped", "cantilever"] = "simply supported",
        position: Value | None = None,
        static_stiffness: Value | None = None,
        radius: Value | None = None,
    ) -> None:
        mistakes = _fill_target(self, locals())
        size, place = (None if v is None else (v,) for v in (self.length, self.position))
        raise_all(mistakes + _place_mistakes(self, "length", size, place, free_end=self.ends == "cantilever"))

    @property
    def edges(self) -> str:
        """How it is held."""
        return self.ends

    @property
    def whole_mass(self) -> float:
        """Mass, kg."""
        return self._line_density * self.length

    @property
    def return_time(self) -> float:
        """0: bending waves outrun every contact, so no beam is infinite, s."""
        return 0.0

    @property
    def compliance(self) -> float:
        """Static deflection over force at the struck point, m/N."""
        if self.static_stiffness is not None:
            return 1 / self.static_stiffness
        return targets.beam_compliance(self._bending, self.length, self._struck, self.ends)

    @property
    def shear_compliance(self) -> float:
        """What shear adds to the static deflection over force, m/N: a b/(L κ G A), κ = 5/6; a/(κ G A) if cantilever."""
        shear = self.material.youngs_modulus / (2 * (1 + self.material.poissons_ratio))
        lever = self._struck if self.ends == "cantilever" else self._struck * (1 - self._struck / self.length)
        return lever / (5 / 6 * shear * self.width * self.thickness)

    def modes(self, highest: float) -> targets.Modes:
        """Natural vibrations of the simply supported beam up to a frequency [rad/s]."""
        assert self.ends == "simply supported"
        return targets.beam_modes(self._line_density, self._bending, self.length, self._struck, highest)

    @property
    def _line_density(self) -> float:
        return self.material.density * self.width * self.thickness

    @property
    def _bending(self) -> float:
        return self.material.youngs_modulus * self.width * self.thickness**3 / 12

    @property
    def _struck(self) -> float:
        if self.position is not None:
            return self.position
        return self.length if self.ends == "cantilever" else self.length / 2


@dataclass(frozen=True, init=False)
class Rod:
    """A long thin rod struck on its end.

    diameter: m; or area: of the cross-section, m². length: m, by which reflections are judged. radius: of a rounded
    end, m.
    """

    kind: ClassVar[str] = "rod"
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "material": part(Material, by_name=material, required=True),
        "diameter": _LENGTH,
        "area": measure("area", 1e-20, 1e10),
        "length": _LENGTH,
        "radius": _RADIUS,
    }

    material: Material
    diameter: float | None
    area: float | None
    length: float | None
    radius: float

    def __init__(
        self,
        material: MaterialLike | None = None,
        diameter: Value | None = None,
        area: Value | None = None,
        length: Value | None = None,
        radius: Value | None = None,
    ) -> None:
        mistakes = _fill_target(self, locals())
        raise_all(mistakes + _one_of(self, diameter=diameter, area=area))

    @property
    def cross_section(self) -> float:
        """Area of the cross-section, m²."""
        return self.area if self.area is not None else math.pi / 4 * cast("float", self.diameter) ** 2

    @property
    def impedance(self) -> float:
        """Wave impedance, N·s/m."""
        return targets.rod_impedance(self.material.youngs_modulus, self.material.density, self.cross_section)


@dataclass(frozen=True, init=False)
class Body:
    """A free body: a second ball. velocity: m/s, positive in the impactor's direction, at rest if left out."""

    kind: ClassVar[str] = "body"
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "material": _MATERIAL,
        "radius": measure("length", 1e-10, 1e3, required=True),
        "mass": _MASS,
        "velocity": measure("velocity", -2e4, 2e4, required=True),
    }

    material: Material | None
    radius: float
    mass: float | None
    velocity: float

    def __init__(
        self,
        material: MaterialLike | None = None,
        radius: Value | None = None,
        mass: Value | None = None,
        velocity: Value = "0 m/s",
    ) -> None:
        raise_all(fill(self, locals()))

    @property
    def own_mass(self) -> float | None:
        """The mass given, or density × sphere volume, kg; None if there is no way to know."""
        return _ball_mass(self.mass, self.radius, self.material)


Target: TypeAlias = HalfSpace | Plate | Beam | Rod | Body


def _place_mistakes(
    owner: object,
    name: str,
    size: tuple[float, ...] | None,
    position: tuple[float, ...] | None,
    *,
    free_end: bool = False,
) -> list[Mistake]:
    """What is wrong with a point of impact: it must lie between the supports."""
    if position is None:
        return []
    if size is None:
        return [_mistake(owner, "position", f"needs a {name}: it is measured from an edge")]
    for x, side in zip(position, size, strict=True):
        if not (0 < x < side or (free_end and x == side)):
            allowed = f"> 0 m and {'<=' if free_end else '<'} {side:g} m: nothing gives way on a support"
            return [_mistake(owner, "position", f"{x:g} m must be {allowed}")]
    return []


def _fill_target(target: HalfSpace | Plate | Beam | Rod, values: Mapping[str, object]) -> list[Mistake]:
    """As :func:`fill`; a target is flat, of infinite radius, if no radius is given."""
    mistakes = fill(target, values)
    if values["radius"] is None:
        object.__setattr__(target, "radius", math.inf)
    return mistakes

"""Plates."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, ClassVar, Literal, cast

from film_model.base.arrays import greater, lesser, root
from film_model.base.errors import raise_all
from film_model.base.fields import choice, entry, measure, mistake, part, several
from film_model.base.materials import MATERIAL, Material, MaterialLike
from film_model.base.units import Value
from film_model.core import plates
from film_model.targets import plate_waves
from film_model.targets.bending_stiffness import BendingStiffness
from film_model.targets.bending_strength import bending_strength, reach_of
from film_model.targets.layup import LAYUP, Ply, PlyLike, coupling, laminate
from film_model.targets.membrane import plate_membrane
from film_model.targets.modes import Array, Modes, Points
from film_model.targets.panel_statics import compliance_and_error
from film_model.targets.plate_entries import kind_mistakes
from film_model.targets.plate_modes import THIN, Shear, numbers_of, plate_modes
from film_model.targets.plate_shear import reach_of_edges, shear_around, shear_of_bending, shear_of_waves
from film_model.targets.plate_statics import plate_compliance
from film_model.targets.ritz import Panel, loose, panel_modes
from film_model.targets.sensors import SENSORS, Sensor, points_of, sensor_mistakes, with_strains
from film_model.targets.stretching import lengthening_of_plate, sliding, stretching
from film_model.targets.supports import (
    DAMPING,
    EDGE_STIFFNESS,
    EDGES,
    FOUNDATION,
    IN_PLANE,
    Damping,
    DampingLike,
    damped,
    four,
    spring_mistakes,
)
from film_model.targets.target import (
    GIVEN_STIFFNESS,
    HELD,
    LENGTH,
    PLACE,
    RADIUS,
    STATIC_STIFFNESS,
    AbstractTarget,
    Estimate,
    Impact,
    contact_width_over,
    fill_target,
    missing,
    no_effect,
    place_mistakes,
)
from film_model.targets.thick_plate import ThickPanel, shear_of, thick_compliance, thick_modes
from film_model.targets.waves import sheet_losses

Edge = Literal["simply supported", "clamped", "free"]


@dataclass(frozen=True, init=False, repr=False)
class Plate(AbstractTarget):
    """A plate: infinite, or rectangular with waves reflected from its edges.

    Isotropic: give material and thickness; of layers: layup; otherwise: mass_per_area and bending_stiffness.

    material: name or table; of layers, that of the face. thickness: m. mass_per_area: kg/m². bending_stiffness: of an
    orthotropic plate, N·m. layup: layers from one face to the other. size: the two sides, m; D11 is the stiffness along
    the first; without it the plate is infinite. edges: "simply supported", "clamped" or "free"; one word, or four for x
    = 0, x = a, y = 0, y = b. edge_stiffness: of elastic supports of free edges, N/m²; one number or four.
    foundation_stiffness: of an elastic bed, N/m³. damping_ratio: of the vibrations; one number, a list for those that
    move the struck point, or pairs with frequencies. in_plane: "fixed" or "free", whether the edges are held in the
    plane; without, membrane forces are not simulated. position: of the impact, distances from a corner along the two
    sides, m; default the centre. static_stiffness: force over deflection at that point, N/m; default from plate theory.
    impedance_formula: "exact", or "paper" to reproduce published results. theory: "kirchhoff"; "mindlin", with shear
    and rotary inertia, always between its edges; "auto": this where it has a closed form. sensors: points to follow.
    radius: of the surface, m.

    >>> round(fm.Plate("mild steel", "4 mm", size=["150 mm", "100 mm"]).impedance, 1)  # N·s/m
    1572.7
    """

    kind: ClassVar[str] = "plate"
    structural: ClassVar[bool] = True
    first_mode_share: ClassVar[float] = 0.25
    material: Material | None = entry(MATERIAL)
    thickness: float | None = entry(measure("length", 1e-10, 1e3))
    mass_per_area: float | None = entry(measure("mass_per_area", 1e-9, 1e9))
    bending_stiffness: BendingStiffness | None = entry(part(BendingStiffness))
    layup: tuple[Ply, ...] | None = entry(LAYUP)
    size: tuple[float, float] | None = entry(several(LENGTH, 2))
    edges: Edge | tuple[Edge, Edge, Edge, Edge] = entry(EDGES)
    edge_stiffness: float | tuple[float, float, float, float] | None = entry(EDGE_STIFFNESS)
    foundation_stiffness: float | None = entry(FOUNDATION)
    damping_ratio: Damping = entry(DAMPING)
    in_plane: Literal["fixed", "free"] | None = entry(IN_PLANE)  # pyright: ignore[reportIncompatibleVariableOverride]
    position: tuple[float, float] | None = entry(several(PLACE, 2))
    static_stiffness: float | None = entry(STATIC_STIFFNESS)
    impedance_formula: Literal["exact", "paper"] = entry(choice("exact", "paper"))
    theory: Literal["auto", "kirchhoff", "mindlin"] = entry(choice("auto", "kirchhoff", "mindlin"))
    sensors: tuple[Sensor, ...] | None = entry(SENSORS)  # pyright: ignore[reportIncompatibleVariableOverride]
    radius: float = entry(RADIUS)

    def __init__(
        self,
        material: MaterialLike | None = None,
        thickness: Value | None = None,
        mass_per_area: Value | None = None,
        bending_stiffness: BendingStiffness | Mapping[str, Any] | None = None,
        size: Sequence[Value] | None = None,
        impedance_formula: Literal["exact", "paper"] = "exact",
        radius: Value | None = None,
        edges: Edge | Sequence[Edge] = "simply supported",
        position: Sequence[Value] | None = None,
        static_stiffness: Value | None = None,
        layup: Sequence[PlyLike] | None = None,
        edge_stiffness: Value | Sequence[Value] | None = None,
        foundation_stiffness: Value | None = None,
        damping_ratio: DampingLike = None,
        sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
        in_plane: Literal["fixed", "free"] | None = None,
        theory: Literal["auto", "kirchhoff", "mindlin"] = "auto",
    ) -> None:
        mistakes = fill_target(self, locals())
        if self.edges:
            mistakes += place_mistakes(self, "size", self.size, self.position, four(self.edges))
            mistakes += sensor_mistakes(self, self.sensors, self.size, self.struck if self.size else ())
            mistakes += spring_mistakes(self, four(self.edge_stiffness or 0.0), four(self.edges))
        if in_plane is not None and thickness is None:
            mistakes.append(mistake(self, "in_plane", "needs thickness: the membrane stiffness is not known without"))
        for name in ("edges", "edge_stiffness", "foundation_stiffness", "damping_ratio", "in_plane"):
            given = getattr(self, name)
            if given and given != "simply supported" and size is None and static_stiffness is None:
                mistakes.append(mistake(self, name, "needs a size: an infinite plate has neither edges nor vibrations"))
        pair = {"mass_per_area": mass_per_area, "bending_stiffness": bending_stiffness}
        if theory == "mindlin" and not mistakes and self.shear_missing:
            mistakes.append(mistake(self, "theory", f'"mindlin" is not known: {self.shear_missing}'))
        raise_all(mistakes + kind_mistakes(self, self.material, thickness, pair, layup))

    @property
    def whole_thickness(self) -> float | None:
        """Thickness, m; None if unknown."""
        return self.thickness if self.layup is None else sum(ply.thickness for ply in self.layup)

    @property
    def surface_density(self) -> float:
        """Mass per area, kg/m²."""
        if self.mass_per_area is not None:
            return self.mass_per_area
        if self.layup is not None:
            return sum(ply.material.density * ply.thickness for ply in self.layup)
        return cast("Material", self.material).density * cast("float", self.thickness)

    @property
    def stiffness(self) -> tuple[float, float, float, float]:
        """D11, D12, D22 and D66, N·m."""
        given = self.bending_stiffness
        if given is not None:
            return given.D11, given.D12, given.D22, given.D66
        if self.layup is not None:
            return laminate(self.layup)[:4]
        material, thickness = cast("Material", self.material), cast("float", self.thickness)
        ratio = material.poissons_ratio
        d = plate_waves.plate_stiffness(material.youngs_modulus, ratio, thickness)
        return d, ratio * d, d, (1 - ratio) / 2 * d

    @property
    def shear_missing(self) -> str:
        """Why Mindlin's theory cannot be used; empty if it can."""
        if self.thickness is None or self.material is None:
            return "the shear stiffness of a plate of layers, or of given bending_stiffness, is not known"
        if self.size is None or self.stiffness_given:
            return "it needs a plate with a size, without static_stiffness"
        given = self.surface_density, self.stiffness, self.size, self.struck, 0.0, self._mindlin
        if not plates.sheared(plates.Plate(*numbers_of(*given))):
            return "the plate is struck within its thickness of an edge, or thicker than about 1/5 of its sides"
        return "" if self._simple else self._thick.missing

    @property
    def shear(self) -> Shear:
        """What `theory` makes of shear, for the core."""
        if self.theory == "kirchhoff" or self.thickness is None or self.material is None:
            return THIN
        closed = self._simple and not self.foundation_stiffness
        return self._mindlin if closed or self.theory == "mindlin" else THIN

    @property
    def _mindlin(self) -> Shear:
        ratio = cast("Material", self.material).poissons_ratio
        return shear_of(self.stiffness[0], cast("float", self.thickness), ratio)

    @property
    def sheared(self) -> bool:
        """Whether it moves by Mindlin's theory where its edges matter."""
        return self.shear is not THIN and not self.shear_missing

    @property
    def impedance(self) -> float:
        """Wave impedance by Kirchhoff's theory, N·s/m; infinite where `theory` asks for Mindlin's, which has none."""
        if self.theory == "mindlin":
            return math.inf
        if self.bending_stiffness is None and self.layup is None:
            return plate_waves.plate_impedance(self.surface_density, self.stiffness[0])
        exact, paper = plate_waves.orthotropic_plate_impedance, plate_waves.paper_plate_impedance
        return (paper if self.impedance_formula == "paper" else exact)(self.surface_density, *self.stiffness)

    @property
    def finite(self) -> bool:
        """Whether it has edges: a size is given."""
        return self.size is not None

    @property
    def whole_mass(self) -> float | None:
        """Mass of a plate with edges, kg."""
        return None if self.size is None else self.surface_density * self.size[0] * self.size[1]

    @property
    def return_time(self) -> float:
        """Time before waves reflected from an edge matter, s; infinite without edges.

        0.08 d² √(ρ_A/D) for an edge at distance d, D the stiffness towards it. For a Hertz contact of this duration at
        the centre of a square plate, with Zener's λ up to 1, the infinite plate gives the contact time within 1 % and
        the peak force within 1e-4. If the rebound is slow (λ above 1.5), a plate with edges always touches again.
        """
        if self.size is None:
            return math.inf
        sides = zip(self.struck, self.size, self.stiffness[::2], strict=True)
        times = (0.08 * lesser(x, side - x) ** 2 * root(self.surface_density / d) for x, side, d in sides)
        return reduce(lesser, times)

    @property
    def held(self) -> bool:
        """Whether supports hold it."""
        return self.stiffness_given or self.size is None or self._simple or not loose(self._panel)

    @property
    def longest_time(self) -> float | None:
        """First period L² √(ρ_A/D)/π of a square plate with the shorter side and the larger stiffness, s; or None."""
        if self.size is None:
            return None
        rate = root(greater(*self.stiffness[::2]) / self.surface_density)
        return 1.0 / (rate / lesser(*self.size) ** 2.0 * math.pi)

    @property
    def compliance(self) -> float | None:
        """Static deflection over force at the struck point, m/N; None if unknown."""
        return self._static[0]

    @property
    def compliance_error(self) -> float:
        """Bound on the error of Ritz's static deflection over force, m/N."""
        return self._static[1]

    @property
    def _static(self) -> tuple[float | None, float]:
        if self.static_stiffness is not None or self.size is None:
            return (None if self.static_stiffness is None else 1 / self.static_stiffness), 0.0
        if self._simple and not self.foundation_stiffness:
            return plate_compliance(self.stiffness, self.size, self.struck, self.shear), 0.0
        if self.theory == "mindlin":
            return thick_compliance(self._thick, self.struck)
        return compliance_and_error(self._panel, self.struck)

    @property
    def panel(self) -> tuple[Panel, tuple[float, float]] | None:
        """A plate that Kirchhoff's theory gives no closed form."""
        known = self.stiffness_given or not self.finite or (self._simple and not self.foundation_stiffness)
        return None if known or self.theory == "mindlin" else (self._panel, self.struck)

    @property
    def modes_missing(self) -> str:
        """Why the vibrations are unknown: only if the static stiffness is given."""
        return GIVEN_STIFFNESS if self.stiffness_given else ""

    def modes(self, highest: float) -> Modes:
        """Natural vibrations up to a frequency [rad/s]: in closed form if simply supported, or by Ritz's method."""
        return damped(with_strains(self._seen(highest, points_of(self.sensors)), self.sensors), self.damping_ratio)

    def _seen(self, highest: float, others: Points) -> Modes:
        """The undamped vibrations at the struck point and at other points."""
        assert self.size is not None
        if self._simple:
            given = self.surface_density, self.stiffness, self.size, self.struck
            return plate_modes(*given, highest, self.foundation_stiffness or 0.0, others, self.shear)
        if self.theory == "mindlin":
            return thick_modes(self._thick, self.struck, highest, others)
        return panel_modes(self._panel, self.struck, highest, others)

    @property
    def stretches(self) -> bool:
        """Whether `in_plane` is given, the vibrations are known, and two opposite edges are held."""
        known, edges = self.in_plane is not None and self.size is not None, four(self.edges)
        return known and not self.stiffness_given and not ("free" in edges[:2] and "free" in edges[2:])

    def membrane(self, highest: float) -> tuple[Modes, Array]:
        """By von Kármán's theory, with the membrane stiffness 12/h² times the bending stiffness."""
        assert self.size is not None and self.thickness is not None
        held = tuple(self.in_plane == "fixed" and edge != "free" for edge in four(self.edges))
        sheet = points_of(self.sensors), self.size, held, self.thickness, self.stiffness
        modes, forms = plate_membrane(lambda at: self._seen(highest, at), *sheet)
        return damped(with_strains(modes, self.sensors), self.damping_ratio), forms

    @property
    def _simple(self) -> bool:
        """Whether all edges are simply supported, so that the vibrations have a closed form."""
        return self.edges == "simply supported"

    @cached_property
    def _panel(self) -> Panel:
        size, springs = cast("tuple[float, float]", self.size), four(self.edge_stiffness or 0.0)
        bed = self.foundation_stiffness or 0.0
        return Panel(self.surface_density, self.stiffness, size, four(self.edges), springs, bed)

    @property
    def _thick(self) -> ThickPanel:
        return ThickPanel(self._panel, self._mindlin)

    def reflection_change(self, motion: Any, restitution: Any, delay: Any) -> Any:
        """0.03 (t/t_return)^2.2 m (1 + e)/(Z e t_c), t from the centre of the impulse to the end of contact.

        For a half-sine 2 t is the contact time. Reflected waves move the plate by a fraction of its displacement
        m (1 + e) V/Z, and the bodies separate at the velocity e V. The constants are fitted to impacts at the centre of
        simply supported square plates, summed over their modes, for λ from 0.1 to 2. The change oscillates with t; from
        0.003 to 0.3 the formula agrees within a factor of three.
        """
        return plate_waves.change_by_reflections(motion, restitution, delay)

    def reflections(self, impact: Impact) -> Estimate:
        """0.03 (t/t_return)^2.2 m (1 + e)/(Z e t_c), with t from the centre of the impulse to the end of contact;
        fitted for λ from 0.1 to 2, within a factor of three."""
        if self.size is None:
            return missing("target.size")
        if not impact.by_impedance:
            return Estimate(HELD)
        return plate_waves.reflected(impact, self.return_time)

    def thickness_effect(self, impact: Impact) -> Estimate:
        """Shear adds k² h²/5 to the mobility 1/Z and to the energy of bending waves (lowest wave of a layer pressed on
        its face), k² = ω √(ρ_A/D), ω = 0.77 π/t_c, the mean over a half-sine's spectrum.

        Of a plate bent as a whole: ½ c F² over the impact energy, c F the deflection around the load that plate theory
        and contact law neglect (`shear_around` in targets/plate_shear.py).
        """
        thickness, material = self.thickness, self.material
        if thickness is None or material is None:
            return Estimate(self.shear_missing)
        if impact.by_compliance or impact.vibrates:
            if self.sheared:
                return no_effect("Mindlin's theory includes shear and rotary inertia")
            if self.size is None:
                return missing("target.size")
            reach = reach_of_edges(four(self.edges), self.size, self.struck)
            energy = 0.5 * shear_around(material, reach, thickness) * impact.force**2
            found = shear_of_bending(impact, energy, thickness / min(self.size))
        else:
            found = shear_of_waves(impact, material, thickness, math.sqrt(self.surface_density / self.stiffness[0]))
        return found._replace(remedy=None if self.shear_missing else 'theory = "mindlin" has it')

    def wave_losses(self, impact: Impact) -> Estimate:
        """A contact shorter than 2h/c_L radiates as into a half-space; beyond 10 h/c_T bending waves take all. Between,
        a quarter of what a half-space takes, or what it takes more than bending and shear."""
        return sheet_losses(impact, self.material, self.thickness)

    def contact_width(self, impact: Impact) -> Estimate:
        """Half-space laws need a contact that is narrow compared with the thickness."""
        return contact_width_over(impact, self.whole_thickness, self.kind)

    def stretching(self, impact: Impact) -> Estimate:
        """Membrane forces, ½ (12 D/h²) ε² per area with ε the mean of ½ (w_x² + w_y²), between edges that hold."""
        if self.size is None:
            return no_effect("an infinite plate has no edges that hold it")
        edges, thickness, area = four(self.edges), self.whole_thickness, math.prod(self.size)
        strain = lengthening_of_plate(edges, self.size, self.struck)
        bending, part = root(self.stiffness[0] * self.stiffness[2]), self.first_mode_share * self.surface_density * area
        membrane = 0.0 if thickness is None else 12.0 * bending / thickness**2 * area
        loose = sliding(edges, self.size)
        return stretching(impact, thickness, self.compliance, part, strain, membrane, loose, self.in_plane)

    def bending_strength(self, impact: Impact) -> Estimate:
        """6 M/h² on the far face over the strength: `bending_stress` in targets/bending_strength.py."""
        reach = reach_of(impact.turn, self.stiffness[0], self.surface_density)
        return bending_strength(impact, self.material, self.thickness, reach, min(self.size) if self.size else None)

    def cross_bending(self, impact: Impact) -> Estimate:
        """The change of the impedance of an infinite plate by D16 and D26."""
        if self.layup is None:
            return no_effect("the plate has no layers that couple twist with bending")
        value, change = coupling(self.layup)
        reason = "the stiffnesses D16 and D26 of the layup are neglected"
        return Estimate(reason, value, None, change, indicator="(|D16| + |D26|)/√(D11 D22)")

    @property
    def struck(self) -> tuple[float, float]:
        a, b = cast("tuple[float, float]", self.size)
        return self.position or (a / 2, b / 2)

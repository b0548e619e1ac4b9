"""Beams."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Literal

import numpy as np

from film_model.base.arrays import same
from film_model.base.errors import TooManyModes, raise_all
from film_model.base.fields import choice, entry, measure, mistake
from film_model.base.materials import REQUIRED_MATERIAL, Material, MaterialLike
from film_model.base.units import Value
from film_model.targets.beam_theory import Line, beam_shear_coefficient, line_compliance, line_modes
from film_model.targets.membrane import membrane_forms, plate_membrane
from film_model.targets.modes import Array, Modes, Points, pulse_response
from film_model.targets.panel_statics import panel_compliance
from film_model.targets.plate_shear import shear_around
from film_model.targets.plate_waves import plate_stiffness
from film_model.targets.ritz import Panel, panel_modes
from film_model.targets.sensors import SENSORS, Sensor, points_of, sensor_mistakes, with_strains
from film_model.targets.stretching import lengthening, stretching
from film_model.targets.supports import DAMPING, IN_PLANE, SUPPORTS, Damping, DampingLike, damped, one_or
from film_model.targets.target import (
    COMES_BACK,
    GIVEN_STIFFNESS,
    HELD,
    PLACE,
    RADIUS,
    STATIC_STIFFNESS,
    AbstractTarget,
    Estimate,
    Impact,
    contact_width_over,
    fill_target,
    no_effect,
    place_mistakes,
)

End = Literal["simply supported", "clamped", "free", "cantilever"]


@dataclass(frozen=True, init=False, repr=False)
class Beam(AbstractTarget):
    """A beam of rectangular cross-section, struck across its thickness in the middle of its width.

    material: name or table. length: between the ends, m. width: m. thickness: along the impact, m. ends: "simply
    supported", "clamped" or "free"; one word, or two; or "cantilever", clamped at the first end only. theory:
    "timoshenko", with shear and rotary inertia; "euler-bernoulli", without; "plate", which bends across its width too;
    "auto": a plate if at least six times as wide as thick, otherwise Timoshenko's. damping_ratio: of the vibrations;
    one number, a list for those that move the struck point, or pairs with frequencies. in_plane: "fixed" or "free",
    whether the ends are held along the beam; without, the axial force is not simulated. position: of the impact,
    distance from the first end, m; default the middle, or the free end of a cantilever. static_stiffness: force over
    deflection at that point, N/m; default from the theory. sensors: points whose motion is wanted. radius: of a curved
    surface, m.

    >>> fm.Beam("mild steel", length="300 mm", width="20 mm", thickness="10 mm").finite
    True
    """

    kind: ClassVar[str] = "beam"
    structural: ClassVar[bool] = True
    first_mode_share: ClassVar[float] = 0.5
    material: Material = entry(REQUIRED_MATERIAL)
    length: float = entry(measure("length", 1e-10, 1e5, required=True))
    width: float = entry(measure("length", 1e-10, 1e5, required=True))
    thickness: float = entry(measure("length", 1e-10, 1e3, required=True))
    ends: End | tuple[End, End] = entry(one_or(2, choice(*SUPPORTS, "cantilever")))
    theory: Literal["auto", "timoshenko", "euler-bernoulli", "plate"] = entry(
        choice("auto", "timoshenko", "euler-bernoulli", "plate")
    )
    damping_ratio: Damping = entry(DAMPING)
    in_plane: Literal["fixed", "free"] | None = entry(IN_PLANE)  # pyright: ignore[reportIncompatibleVariableOverride]
    position: float | None = entry(PLACE)
    static_stiffness: float | None = entry(STATIC_STIFFNESS)
    sensors: tuple[Sensor, ...] | None = entry(SENSORS)  # pyright: ignore[reportIncompatibleVariableOverride]
    radius: float = entry(RADIUS)

    def __init__(
        self,
        material: MaterialLike | None = None,
        length: Value | None = None,
        width: Value | None = None,
        thickness: Value | None = None,
        ends: End | Sequence[End] = "simply supported",
        position: Value | None = None,
        static_stiffness: Value | None = None,
        radius: Value | None = None,
        theory: Literal["auto", "timoshenko", "euler-bernoulli", "plate"] = "auto",
        damping_ratio: DampingLike = None,
        sensors: Sequence[Sensor | Mapping[str, Any]] | None = None,
        in_plane: Literal["fixed", "free"] | None = None,
    ) -> None:
        mistakes = fill_target(self, locals())
        if isinstance(self.ends, tuple) and "cantilever" in self.ends:
            mistakes.append(mistake(self, "ends", '"cantilever" names both ends: give it alone'))
        elif self.ends:
            size, place = (None if v is None else (v,) for v in (self.length, self.position))
            mistakes += place_mistakes(self, "length", size, place, self._ends)
        singular = (self.struck,) if not mistakes and self.wide else ()
        raise_all(mistakes + sensor_mistakes(self, self.sensors, (self.length,) if self.length else None, singular))

    @property
    def finite(self) -> bool:
        """Always: a beam has two ends."""
        return True

    @property
    def held(self) -> bool:
        """Whether supports hold it."""
        return self.stiffness_given or self._line.held

    @property
    def whole_mass(self) -> float:
        """Mass, kg."""
        return self._line_density * self.length

    @property
    def return_time(self) -> float:
        """Always 0 s: bending waves have no greatest speed, so they reach the ends during any contact."""
        return 0.0

    @property
    def compliance(self) -> float:
        """Static deflection over force at the struck point, m/N."""
        if self.static_stiffness is not None:
            return 1 / self.static_stiffness
        return panel_compliance(*self.panel) if self.panel else line_compliance(self._line, self.struck)

    @property
    def panel(self) -> tuple[Panel, tuple[float, float]] | None:
        """A wide beam as a plate with two free edges."""
        return (self._strip, (self.struck, self.width / 2)) if self.wide and not self.stiffness_given else None

    @property
    def wide(self) -> bool:
        """Whether it is taken for a plate with two free edges."""
        # beyond, bending across the width changes the force more than shear does, in impacts of R = 15 mm at 1 m/s on
        # steel beams of 500 × 5 mm
        return self.theory == "plate" or (self.theory == "auto" and same(self.width >= 6.0 * self.thickness))

    @property
    def sheared(self) -> bool:
        """Whether shear and rotary inertia are included."""
        return not self.wide and self.theory != "euler-bernoulli"

    @property
    def modes_missing(self) -> str:
        """Why the vibrations are unknown: only if the static stiffness is given."""
        return GIVEN_STIFFNESS if self.stiffness_given else ""

    def modes(self, highest: float) -> Modes:
        """Natural vibrations up to a frequency [rad/s]; in the middle of the width."""
        return damped(with_strains(self._seen(highest, self._sensed), self.sensors), self.damping_ratio)

    def _seen(self, highest: float, others: Points) -> Modes:
        """The undamped vibrations at the struck point and at other points."""
        if self.wide:
            return panel_modes(self._strip, (self.struck, self.width / 2), highest, others)
        return line_modes(self._line, self.struck, highest, others)

    @property
    def _sensed(self) -> Points:
        return points_of(self.sensors, (self.width / 2,) if self.wide else ())

    @property
    def stretches(self) -> bool:
        """Whether `in_plane` is given, the vibrations are known, and both ends are held; of a slender beam in its
        direction, too."""
        known = self.in_plane is not None and not self.stiffness_given and "free" not in self._ends
        return known and (self.wide or self.in_plane == "fixed")

    def membrane(self, highest: float) -> tuple[Modes, Array]:
        """By the axial force E A ε of a slender beam, or as a plate with two free edges."""
        held = tuple(self.in_plane == "fixed" and end != "free" for end in self._ends)
        seen, sensed = partial(self._seen, highest), self._sensed
        if self.wide:
            sheet = (self.length, self.width), (*held, False, False), self.thickness, self._strip.stiffness
            modes, forms = plate_membrane(seen, sensed, *sheet)
        else:
            stiffness = np.array([[self.material.youngs_modulus * self.width * self.thickness]])
            modes, forms = membrane_forms(seen, sensed, (self.length,), held, stiffness)
        return damped(with_strains(modes, self.sensors), self.damping_ratio), forms

    def reflections(self, impact: Impact) -> Estimate:
        """Not estimated: the whole target is simulated, unless it is assumed fixed."""
        return Estimate(HELD)

    def thickness_effect(self, impact: Impact) -> Estimate:
        """The energy ½ c F² of shear over the impact energy, if the theory neglects it. c is Timoshenko's static
        compliance less Euler and Bernoulli's, of a wide beam with that around the load of a plate, ℓ = w/(2π). If
        contact comes back, an effect below the tolerance is not judged.
        """
        if self.sheared:
            return no_effect("Timoshenko's theory includes shear and rotary inertia")
        shear, plain = self._timoshenko, self._line_without_shear
        soft = line_compliance(shear, self.struck) - line_compliance(plain, self.struck)
        if self.wide:
            soft += shear_around(self.material, min(self.width, self.length) / (2 * math.pi), self.thickness)
        size = 0.5 * soft * impact.force**2 / impact.energy if impact.by_compliance else 0.0
        slender = self.thickness / self.length
        if impact.vibrates and size <= impact.tolerance:
            return Estimate(COMES_BACK, slender, indicator="h/L")
        reason = "the energy of shear deformation is neglected"
        remedy = None if self.wide else 'theory = "timoshenko" includes it'
        return Estimate(reason, slender, None, min(size, 1.0), indicator="h/L", remedy=remedy)

    def contact_width(self, impact: Impact) -> Estimate:
        """Half-space laws need a contact that is narrow compared with the thickness."""
        return contact_width_over(impact, self.thickness, self.kind)

    def stretching(self, impact: Impact) -> Estimate:
        """The axial force E A ε, with ε the mean of ½ w′², of a beam whose ends cannot move inwards."""
        strain = lengthening(self._ends, self.length, self.struck)
        membrane = self.material.youngs_modulus * self.width * self.thickness * self.length
        part = self.first_mode_share * self.whole_mass
        return stretching(impact, self.thickness, self.compliance, part, strain, membrane, in_plane=self.in_plane)

    def bending_strength(self, impact: Impact) -> Estimate:
        """Not estimated."""
        return Estimate(f"the bending stress of a {self.kind} is not estimated")

    def cross_bending(self, impact: Impact) -> Estimate:
        """Deflection of the plate with two free edges less that of the slender beam, if the theory neglects it, over
        indentation plus deflection in the middle of a half-sine of the contact time on a fixed target.
        """
        if self.wide:
            return no_effect("the beam is taken for a plate, which bends across its width")
        (duration, contact), place, plain = impact.held, (self.struck, self.width / 2), self._line_without_shear
        try:
            strip = pulse_response(
                lambda highest: panel_modes(self._strip, place, highest), panel_compliance(self._strip, place), duration
            )
        except TooManyModes:
            return Estimate("the contact is too short: more vibrations across the width matter than can be computed")
        beam = pulse_response(
            lambda highest: line_modes(plain, place[0], highest), line_compliance(plain, place[0]), duration
        )
        size = min(abs(strip - beam) / (contact + beam), 1.0)
        reason = "bending across the width is neglected"
        return Estimate(
            reason, self.width / self.thickness, None, size, indicator="w/h", remedy='theory = "plate" has it'
        )

    @property
    def _ends(self) -> tuple[str, str]:
        if self.ends == "cantilever":
            return "clamped", "free"
        return self.ends if isinstance(self.ends, tuple) else (self.ends, self.ends)

    @property
    def _line_density(self) -> float:
        return self.material.density * self.width * self.thickness

    @property
    def _line(self) -> Line:
        return self._timoshenko if self.sheared else self._line_without_shear

    @property
    def _line_without_shear(self) -> Line:
        bending = self.material.youngs_modulus * self.width * self.thickness**3 / 12
        return Line(self._line_density, bending, self.length, self._ends)

    @property
    def _timoshenko(self) -> Line:
        ratio, plain = self.material.poissons_ratio, self._line_without_shear
        shear = self.material.youngs_modulus / (2 * (1 + ratio)) * self.width * self.thickness
        turning = self.material.density * self.width * self.thickness**3 / 12
        return Line(plain.mass, plain.bending, self.length, self._ends, beam_shear_coefficient(ratio) * shear, turning)

    @property
    def _strip(self) -> Panel:
        ratio = self.material.poissons_ratio
        d = plate_stiffness(self.material.youngs_modulus, ratio, self.thickness)
        stiffness = d, ratio * d, d, (1 - ratio) / 2 * d
        density, size = self.material.density * self.thickness, (self.length, self.width)
        return Panel(density, stiffness, size, (*self._ends, "free", "free"))

    @property
    def struck(self) -> float:
        if self.position is not None:
            return self.position
        if "clamped" in self._ends and "free" in self._ends:
            return 0.0 if self._ends[0] == "free" else self.length
        return self.length / 2

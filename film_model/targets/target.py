"""The contract of a target: its fields, material and shape, how it moves, and where its model stops being valid.

A target moves in one of four ways, chosen by what its class overrides:

* not at all: nothing is overridden (a half-space);
* as a free body: `free`, `own_mass` and `velocity`;
* by a wave impedance: the force that pushes the struck point at unit velocity while no wave has come back. The point
  moves at F/Z, and the indentation δ obeys δ̈ + Ḟ/Z + F/m = 0 (Zener 1941);
* as a structure with edges: `structural`, with a static `compliance`, by which it follows a contact that is slow
  compared with its vibrations, and with `modes`, which a faster contact excites.

All arguments and results are SI floats. A sweep replaces some fields by arrays, so the formulas of `impedance`,
`own_mass` and `return_time` must accept arrays: :mod:`film_model.base.arrays` has functions that serve both.
"""

from __future__ import annotations

import math
from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from film_model.base.arrays import endless
from film_model.base.errors import Mistake, SimulationError
from film_model.base.fields import InUnits, fill, measure, mistake
from film_model.base.materials import Material
from film_model.targets.modes import Array, Modes
from film_model.targets.sensors import Sensor
from film_model.targets.surface_strain import Rows, surface_strains

if TYPE_CHECKING:
    from film_model.targets.ritz import Panel

RADIUS = measure("length", 1e-10, 1e3)
LENGTH = measure("length", 1e-10, 1e5)
PLACE = measure("length", 0, 1e5)
STATIC_STIFFNESS = measure("stiffness", 1e-12, 1e18)


GIVEN_STIFFNESS = "a given static stiffness does not determine the vibrations"
"""Why a structure of given static stiffness has no modes."""

COMES_BACK = "how shear changes the rebound is unknown on a target that vibrates: contact may be lost and come back"
"""Why shear is not assessed on a target that vibrates."""

NO_THICKNESS = "the thickness of a plate of given bending_stiffness is not known"
"""Why an effect of the thickness is not assessed."""

HELD = "the target is held fixed, so that its waves are not known"
"""Why waves in the target are not assessed."""


class Impact(NamedTuple):
    """An impact, as the rules of a target see it that estimate neglected effects. SI numbers.

    mass: of the impactor. force, indentation: maxima. turn: time of the latter. fraction: absorbed part of the impact
    energy. back: time from the centre of the impulse to the end of contact. motion: the target's displacement over
    V t_c, m (1 + e)/(Z t_c). by_impedance: the target moves by its impedance. by_compliance: it follows the force
    statically. vibrates: it moves by its modes; the other numbers are then those of an impact on its impedance or
    compliance. tolerance: smallest relative change of the summary that matters. held: on a target that does not move,
    the contact time, s, and the indentation over the force at the maximum, m/N.
    """

    mass: float
    force: float
    indentation: float
    contact_radius: float
    duration: float
    turn: float
    restitution: float
    energy: float
    fraction: float
    back: float
    motion: float
    by_impedance: bool
    by_compliance: bool
    vibrates: bool
    tolerance: float
    held: tuple[float, float]


class Estimate(NamedTuple):
    """An estimate of an effect that is not simulated.

    reason: a sentence. value: of the indicator. threshold: value of the indicator from which the effect matters.
    change: relative change of the summary if the effect is neglected; None if unknown. applies: False if the target has
    no such effect. fails: the model is not valid, and the change is unknown. indicator: replaces the rule's own.
    remedy: what a simulation of the effect would need. below: it matters below the threshold, not beyond. simulated: it
    is in the simulation.
    """

    reason: str
    value: float | None = None
    threshold: float | None = None
    change: float | None = None
    applies: bool = True
    fails: bool = False
    indicator: str | None = None
    remedy: str | None = None
    below: bool = False
    simulated: bool = False


def no_effect(reason: str) -> Estimate:
    """The estimate for a target that has no such effect."""
    return Estimate(reason, applies=False)


def missing(what: str) -> Estimate:
    """The estimate for a scene that lacks the entry `what`."""
    return Estimate(f"missing: {what}")


@dataclass(frozen=True, init=False, repr=False)
class AbstractTarget(InUnits, ABC):
    """A target. Implementations are frozen dataclasses; their constructors take quantities and store SI floats.

    kind: the name in scene files. FIELDS: the entries of the section [target], in order. free: the target is a free
    body. structural: it has edges, or may have; reflections and vibrations are then considered. first_mode_share:
    fraction of a structure's mass that moves in its first vibration, referred to the struck point. extent: the entry
    that gives it edges. in_plane: whether its edges are held in its plane, "fixed" or "free"; None if it is
    not known.

    material: None if only its other properties are given. radius: of the contacting surface, m, infinite if flat.
    velocity: when contact begins, m/s, positive in the impactor's direction.
    """

    kind: ClassVar[str]
    free: ClassVar[bool] = False
    structural: ClassVar[bool] = False
    first_mode_share: ClassVar[float] = 1.0
    extent: ClassVar[str] = "size"
    in_plane: ClassVar[str | None] = None

    material: Material | None
    radius: float
    velocity: float = field(default=0.0, init=False, repr=False, compare=False)
    sensors: ClassVar[tuple[Sensor, ...] | None] = None

    @property
    def own_mass(self) -> float | None:
        """Mass of a free body, kg, None if unknown; infinite for a target that is not free."""
        return math.inf

    @property
    def impedance(self) -> float:
        """Wave impedance, N·s/m; infinite for a target that has none."""
        return math.inf

    def radiation_impedance(self, duration: Any) -> Any:
        """The impedance that takes as much energy from an elastic impact of a contact time [s] as its waves, N·s/m;
        infinite for a target whose waves are in `impedance`, or unknown. Floats or arrays."""
        return math.inf

    @property
    def compliance(self) -> float | None:
        """Static deflection over force at the struck point, m/N; None if there is none or it is unknown.

        Of a structure that nothing holds: of its vibrations together, without its motion as a whole.
        """
        return None

    @property
    def compliance_error(self) -> float:
        """Bound on the error of `compliance`, m/N, where it is computed and neither given nor in closed form."""
        if not self.panel:
            return 0.0
        from film_model.targets.panel_statics import compliance_and_error

        return compliance_and_error(*self.panel)[1]

    @property
    def panel(self) -> tuple[Panel, tuple[float, float]] | None:
        """The plate whose static deflection Lévy's series or Ritz's method gives, and the struck point; or None."""
        return None

    @property
    def stiffness_given(self) -> bool:
        """Whether the scene gives the static stiffness, so that it is not computed from the structure."""
        return getattr(self, "static_stiffness", None) is not None

    @property
    def finite(self) -> bool:
        """Whether a structure has edges."""
        return False

    @property
    def held(self) -> bool:
        """Whether supports hold a structure, so that it has a static stiffness; otherwise it also moves as a whole."""
        return True

    @property
    def whole_mass(self) -> float | None:
        """Mass of a structure with edges, kg; None if unknown."""
        return None

    @property
    def return_time(self) -> float:
        """Time before reflected waves matter at the struck point, s; infinite without edges."""
        return math.inf

    @property
    def longest_time(self) -> float | None:
        """The longest time scale of a target with edges, s: first period, or travel time to the far end and back."""
        return None

    @cached_property
    def gives_way(self) -> bool:
        """Whether a target that is not a free body moves under the force."""
        return not self.free and (not endless(self.impedance) or self.compliance is not None)

    @property
    def stretches(self) -> bool:
        """Whether its membrane forces can be simulated."""
        return False

    @property
    def modes_missing(self) -> str:
        """Why the natural vibrations of a structure are unknown, as a clause; empty if they are known."""
        return f"the vibrations of a {self.kind} are not known"

    def modes(self, highest: float) -> Modes:
        """Natural vibrations up to the frequency `highest`, rad/s, at the struck point and at the sensors."""
        raise SimulationError(self.modes_missing)

    @property
    def whole_thickness(self) -> float | None:
        """Thickness, m; None if it has none or it is unknown."""
        return getattr(self, "thickness", None)

    def membrane(self, highest: float) -> tuple[Modes, Array]:
        """The vibrations up to the frequency `highest` [rad/s] with the forms of their membrane energy, as of
        `membrane_forms`."""
        raise SimulationError(f"the membrane forces of a {self.kind} are not known")

    def strains(self, rows: Rows) -> Rows:
        """strain_x, strain_y and the stresses σ_x, σ_y and τ_xy, Pa, (5, sensors, times), of the sensors with strain,
        NaN if unknown. rows: what the rows of `Modes.strain` make of the vibrations, (rows, times); may be complex.
        """
        return surface_strains(self, rows)

    def omitted(self, modes: Modes, highest: float) -> tuple[float, float]:
        """Static compliance of the vibrations above `highest` [rad/s], m/N, and a bound on its error. modes: those up
        to it."""
        if self.panel:
            from film_model.targets.panel_statics import omitted_compliance

            return omitted_compliance(*self.panel, modes, highest)
        return max((self.compliance or 0.0) - modes.compliance, 0.0), self.compliance_error

    @property
    def inexact(self) -> Panel | None:
        """The plate whose frequencies Ritz's method makes too high; None if they are exact or given."""
        panel = self.panel and self.panel[0]
        return panel if panel and not panel.exact else None

    def reflections(self, impact: Impact) -> Estimate:
        """Waves that return from edges or ends before contact ends."""
        what = "a free body" if self.free else f"a {self.kind}"
        return no_effect(f"the model of {what} has no reflected waves")

    def reflection_change(self, motion: Any, restitution: Any, delay: Any) -> Any:
        """Relative change of the summary by reflected waves, or a bound on it; floats or arrays.

        motion: the target's displacement over V t_c. delay: time from the centre of the impulse to the end of contact,
        over `return_time`. The default, infinite, means unknown.
        """
        return math.inf * motion

    def thickness_effect(self, impact: Impact) -> Estimate:
        """A half-space that is too thin; shear of a plate or beam."""
        return no_effect(f"does not apply to a {self.kind}")

    def contact_width(self, impact: Impact) -> Estimate:
        """A half-space law on a plate or beam."""
        return no_effect(f"does not apply to a {self.kind}")

    def wave_losses(self, impact: Impact) -> Estimate:
        """Waves radiated into a target that is simulated without them."""
        return no_effect(f"does not apply to a {self.kind}")

    def stretching(self, impact: Impact) -> Estimate:
        """Membrane forces where the deflection is not small compared with the thickness."""
        return no_effect(f"does not apply to a {self.kind}")

    def bending_strength(self, impact: Impact) -> Estimate:
        """Yield or fracture by bending; only the contact yields in the simulation."""
        return no_effect(f"does not apply to a {self.kind}")

    def omitted_modes(self, impact: Impact) -> Estimate:
        """Vibrations of a structure above the highest that is given, Ω."""
        return no_effect(f"does not apply to a {self.kind}")

    def cross_bending(self, impact: Impact) -> Estimate:
        """Bending across the width of a beam; twist coupled with bending of a layup."""
        return no_effect(f"does not apply to a {self.kind}")


def fill_target(target: AbstractTarget, values: Mapping[str, object]) -> list[Mistake]:
    """As :func:`film_model.base.fields.fill`; without a radius the target is flat (infinite radius)."""
    mistakes = fill(target, values)
    if values["radius"] is None:
        object.__setattr__(target, "radius", math.inf)
    return mistakes


def place_mistakes(
    owner: object,
    name: str,
    size: tuple[float, ...] | None,
    position: tuple[float, ...] | None,
    ends: tuple[str, ...],
) -> list[Mistake]:
    """Mistakes of a point of impact, which must lie between the supports. ends: two for each side; "free" may be
    hit."""
    if position is None:
        return []
    if size is None:
        return [mistake(owner, "position", f"needs a {name}, because it is measured from an edge")]
    for k, (x, side) in enumerate(zip(position, size, strict=True)):
        first, last = (end == "free" for end in ends[2 * k : 2 * k + 2])
        if not (0 < x < side or (first and x == 0) or (last and x == side)):
            allowed = f"{'>=' if first else '>'} 0 m and {'<=' if last else '<'} {side:g} m"
            allowed += "" if first and last else ": a support does not deflect"
            return [mistake(owner, "position", f"{x:g} m must be {allowed}")]
    return []


def contact_width_over(impact: Impact, thickness: float | None, kind: str) -> Estimate:
    """Whether a half-space law is valid on a plate or beam: the contact must be narrow compared with the thickness."""
    if thickness is None:
        return Estimate(NO_THICKNESS)
    value = impact.contact_radius / thickness
    if value > 1.0:
        reason = f"half-space laws fail for contacts wider than the thickness of the {kind}"
        return Estimate(reason, value, 1.0, fails=True)
    reason = f"how much a contact of {value:.2g} times the thickness of the {kind} is stiffened is not known"
    return Estimate(reason, value, 1.0)

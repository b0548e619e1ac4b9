"""Which effects a scene calls for, each with the number that decides.

One row an effect: an indicator with its value and threshold, what is done about it, and why in a sentence.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from film_model.bodies import STANDARD_GRAVITY, Beam, Body, Plate
from film_model.core import native
from film_model.curve import curve_of
from film_model.errors import SimulationError
from film_model.laws import LAWS, AbstractLaw
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import law_fields
from film_model.laws.yielding import yield_velocity
from film_model.scales import scales_of
from film_model.scene import Scene

GRAVITY_THRESHOLD = 0.01
"""m g/F_m above which gravity is simulated: it changes the maximum indentation by as much (linear estimate)."""

MOTION_THRESHOLD = 0.006
"""Zener's λ below which target motion takes less than 1 % of the velocity: e ≈ 1 − 1.73 λ."""


INERTIA_THRESHOLD = 0.01
"""Vibration over quasi-static force below which a plate or beam follows statically: forces then differ by less."""

LARGE_MASS = 2.0
"""Mass of the impactor over that of a plate of unknown modes, above which its static stiffness is simulated."""


@dataclass(frozen=True)
class Effect:
    """One effect: what was measured, against what, and what came of it.

    state: "simulated", "not needed", "switched off" or "not modelled".
    """

    name: str
    indicator: str
    value: float | None
    threshold: float | None
    state: str
    reason: str

    @property
    def simulated(self) -> bool:
        """Whether the run includes it."""
        return self.state == "simulated"

    def to_json(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


@dataclass(frozen=True)
class Choice:
    """What a scene comes down to: law, target impedance [N s/m] and load [N], with the effects behind them.

    compliance: of a target that gives way as to a static force, m/N; else 0. vibrates: the target moves by its modes.
    """

    law: AbstractLaw
    impedance: float
    load: float
    effects: tuple[Effect, ...]
    compliance: float = 0.0
    vibrates: bool = False


def choose(scene: Scene) -> Choice:
    """Law, impedance and load of a scene, with the effects that decided them."""
    law, plasticity = _plasticity(scene)
    impedance, motion = _target_motion(scene)
    load, gravity = _gravity(scene, law)
    if not isinstance(scene.target, Plate | Beam):
        return Choice(law, impedance, load, (plasticity, motion, gravity))
    compliance, vibrates, edges = _edges(scene, law, impedance)
    if compliance > 0.0 or vibrates:
        impedance = math.inf
    return Choice(law, impedance, load, (plasticity, motion, gravity, *edges), compliance, vibrates)


def _law(scene: Scene, name: str) -> AbstractLaw:
    """The named law with its values from the scene."""
    law = LAWS[name]
    known = {
        "effective_modulus": scene.effective_modulus,
        "radius": scene.effective_radius,
        "yield_strength": scene.yield_strength,
    }
    values = {field: known[field] for field in law_fields(law) if field in known}
    return law(**values, **scene.contact.parameters)


def _plasticity(scene: Scene) -> tuple[AbstractLaw, Effect]:
    wanted, law = scene.effects.plasticity, scene.contact.law
    strength, modulus = scene.yield_strength, scene.effective_modulus
    speed, threshold = scene.approach_velocity, None
    if strength is not None and modulus is not None:
        threshold = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
    ratio = None if threshold is None else speed / threshold

    def effect(state: str, reason: str) -> Effect:
        return Effect("plasticity", "V/V_Y", ratio, 1.0, state, reason)

    if law != "auto":
        chosen = law if isinstance(law, AbstractLaw) else _law(scene, law)
        reason = f"the scene asks for the law {chosen.name}"
        yields = any(stage.unloading is not None for stage in chosen.stages())
        return chosen, effect("simulated" if yields else "switched off", reason)
    if wanted is False:
        return _law(scene, "hertz"), effect("switched off", "the scene asks for no plasticity: law hertz")
    if threshold is None or ratio is None:
        if wanted is True:
            raise SimulationError("effects.plasticity is true, but neither material has a yield_strength")
        return _law(scene, "hertz"), effect("not modelled", "no yield strength is given: law hertz")
    if ratio <= 1.0 and wanted is not True:
        reason = f"the impact stays below the yield velocity {threshold:.4g} m/s: law hertz"
        return _law(scene, "hertz"), effect("not needed", reason)
    return _law(scene, "big-alabo"), effect("simulated", f"the yield velocity is {threshold:.4g} m/s: law big-alabo")


def _target_motion(scene: Scene) -> tuple[float, Effect]:
    impedance = scene.target_impedance
    if isinstance(scene.target, Beam):
        moves = scene.effects.target_motion is not False
        state, reason = ("simulated", "a beam bends") if moves else ("switched off", "the scene asks for a rigid beam")
        return math.inf, Effect("target_motion", "Zener's λ", None, MOTION_THRESHOLD, state, reason)
    if math.isinf(impedance):
        free = isinstance(scene.target, Body)
        reason = "the target moves freely: reduced mass" if free else "the target is a half-space"
        return math.inf, Effect("target_motion", "Zener's λ", 0.0, MOTION_THRESHOLD, "not needed", reason)
    value = _zener(scene, impedance)
    if scene.effects.target_motion is False:
        reason = "the scene asks for a target that does not move"
        return math.inf, Effect("target_motion", "Zener's λ", value, MOTION_THRESHOLD, "switched off", reason)
    reason = f"the target has an impedance of {impedance:.4g} N s/m"
    return impedance, Effect("target_motion", "Zener's λ", value, MOTION_THRESHOLD, "simulated", reason)


def _edges(scene: Scene, law: AbstractLaw, impedance: float) -> tuple[float, bool, tuple[Effect, Effect]]:
    """Compliance [m/N] of a plate or beam that follows a force statically, or 0; whether it vibrates; the effects.

    Boundary reflections: contact time against the return time of waves from the edges. Target inertia: the amplitude
    of vibration over the quasi-static force. A contact of stiffness k_c = 1.5 F/δ that closes on a support k_b at
    velocity V asks the target for V k_c/(k_b + k_c) at once, and the part m_e of its mass that is under the impactor
    then oscillates: k_c^{3/2} √(m_e/m)/((k_b + k_c) √k_b), with m_e a quarter of a plate and half of a beam.
    """
    target, wanted, inertia = scene.target, scene.effects.boundary_reflections, scene.effects.target_inertia
    assert isinstance(target, Plate | Beam)
    returns, compliance, beam = target.return_time, target.compliance, isinstance(target, Beam)
    contact = None if math.isinf(impedance) else _duration(scene, law, impedance)
    finite = contact is not None and math.isfinite(contact) and 0.0 < returns < math.inf
    ratio = contact / returns if finite and contact is not None else None

    def effects(state: str, reason: str, then: str, value: float | None, why: str) -> tuple[Effect, Effect]:
        return (
            Effect("boundary_reflections", "t_c/t_return", ratio, 1.0, state, reason),
            Effect("target_inertia", "vibration/static force", value, INERTIA_THRESHOLD, then, why),
        )

    def without(state: str, reason: str) -> tuple[float, bool, tuple[Effect, Effect]]:
        return 0.0, False, effects(state, reason, "not needed", None, "it is in the impedance, if the target moves")

    if scene.effects.target_motion is False:
        return without("switched off", "the scene asks for a target that does not move")
    if wanted is False:
        if beam:
            raise SimulationError("effects.boundary_reflections is false, but a beam without ends has no impedance")
        return without("switched off", "the scene asks for a plate without edges")
    if compliance is None:
        if wanted is True:
            raise SimulationError("effects.boundary_reflections is true, but the plate has no size")
        return without("not needed", "no size is given: the plate is infinite")
    if wanted == "auto" and contact is not None and contact <= returns < math.inf:
        return without("not needed", f"no wave is back from the edges within {returns:.4g} s")
    reason = f"contact lasts longer than waves take to the edges and back, {returns:.4g} s"
    whole = target.whole_mass
    value = None if whole is None else _vibration(scene, law, compliance, whole * (0.5 if beam else 0.25))
    known = target.edges == "simply supported" and target.static_stiffness is None
    small = value is not None and value <= INERTIA_THRESHOLD
    static = f"a static stiffness of {1 / compliance:.4g} N/m"
    if inertia is False or (small and inertia == "auto"):
        state, why = ("switched off", "the scene asks for") if inertia is False else ("not needed", "it follows with")
        return compliance, False, effects("simulated", reason, state, value, f"{why} {static} alone")
    if known:
        return 0.0, True, effects("simulated", reason, "simulated", value, f"by the vibrations of the {target.kind}")
    missing = f"the vibrations of a {target.edges} {target.kind} are not known"
    if target.static_stiffness is not None:
        missing = "a given static stiffness says nothing about vibrations"
    if inertia is True:
        raise SimulationError(f"effects.target_inertia is true, but it cannot be simulated: {missing}")
    if beam or target.static_stiffness is not None or whole is None or scene.mass >= LARGE_MASS * whole:
        return compliance, False, effects("simulated", reason, "not modelled", value, f"{missing}: {static} alone")
    if wanted is True:
        raise SimulationError(
            f"effects.boundary_reflections is true, but the impactor is lighter than {LARGE_MASS:g} plates, whose "
            f"vibrations would be needed, and {missing}"
        )
    return without("not modelled", f"{reason}, but {missing}")


def _vibration(scene: Scene, law: AbstractLaw, compliance: float, part: float) -> float | None:
    """Amplitude of vibration of `part` [kg] of the target over the quasi-static force; None without a velocity."""
    if scene.approach_velocity == 0.0:
        return None
    scales = scales_of(law, scene.kinetic_energy, scene.effective_mass)
    start = native.Start(scene.approach_velocity / scales.velocity, 0.0, 0.0, 0.0, math.inf)
    curve = curve_of(law, compliance * scales.force / scales.length).native
    status, summary = native.impact(curve, native.mesh(native.WORK_PRESERVING, 6, 6), start)
    if status != native.EVENT or summary.maximum_indentation <= 0.0:
        return None
    contact = 1.5 * summary.maximum_force / summary.maximum_indentation * scales.force / scales.length
    return contact**1.5 * math.sqrt(part / scene.mass * compliance) / (1 / compliance + contact)


def _duration(scene: Scene, law: AbstractLaw, impedance: float) -> float:
    """Duration of contact on the infinite plate, s; infinite if it does not end."""
    if scene.approach_velocity == 0.0:
        return math.inf
    scales = scales_of(law, scene.kinetic_energy, scene.effective_mass)
    gamma = scales.force / (impedance * scales.velocity)
    start = native.Start(scene.approach_velocity / scales.velocity, gamma, 0.0, 0.0, math.inf)
    status, summary = native.impact(curve_of(law).native, native.mesh(native.WORK_PRESERVING, 6, 12), start)
    return summary.contact_duration * scales.time if status == native.EVENT else math.inf


def _zener(scene: Scene, impedance: float) -> float | None:
    """λ = K^{2/5} m^{3/5} V^{1/5}/Z (Zener 1941), for the elastic contact; None where there is no Hertz stiffness."""
    if scene.effective_modulus is None:
        return None
    stiffness = hertz_stiffness(scene.effective_modulus, scene.effective_radius)
    return stiffness**0.4 * scene.effective_mass**0.6 * scene.approach_velocity**0.2 / impedance


def _gravity(scene: Scene, law: AbstractLaw) -> tuple[float, Effect]:
    weight = scene.effective_mass * STANDARD_GRAVITY
    name, indicator = "gravity", "m g/F_m"
    if isinstance(scene.target, Body):
        return 0.0, Effect(name, indicator, 0.0, GRAVITY_THRESHOLD, "not needed", "both bodies fall alike")
    force = _elastic_force(scene, law)
    ratio = None if force is None else weight / force
    wanted = scene.effects.gravity
    if wanted is False:
        return 0.0, Effect(name, indicator, ratio, GRAVITY_THRESHOLD, "switched off", "the scene asks for no gravity")
    if wanted is True or ratio is None or ratio > GRAVITY_THRESHOLD:
        reason = "the scene asks for it" if wanted is True else "the weight is not small against the contact force"
        return weight, Effect(name, indicator, ratio, GRAVITY_THRESHOLD, "simulated", reason)
    reason = "the weight is small against the contact force"
    return 0.0, Effect(name, indicator, ratio, GRAVITY_THRESHOLD, "not needed", reason)


def _elastic_force(scene: Scene, law: AbstractLaw) -> float | None:
    """Maximum force [N] of the law on a target that does not move; None without a velocity or beyond the law."""
    energy = 0.5 * scene.effective_mass * scene.approach_velocity**2
    if energy == 0.0:
        return None
    scales = scales_of(law, energy, scene.effective_mass)
    start = native.Start(scene.approach_velocity / scales.velocity, 0.0, 0.0, 0.0, math.inf)
    status, summary = native.impact(curve_of(law).native, native.mesh(native.WORK_PRESERVING, 1, 1), start)
    return summary.maximum_force * scales.force if status == native.EVENT else None

"""Which effects a scene calls for, each with the number that decides.

One row an effect: an indicator with its value and threshold, what is done about it, and why in a sentence.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from film_model.bodies import STANDARD_GRAVITY, Body
from film_model.core import native
from film_model.curve import curve_of
from film_model.errors import SimulationError
from film_model.laws import LAWS, AbstractLaw, BrakeUnloading, Retrace
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import law_fields
from film_model.laws.yielding import yield_velocity
from film_model.scales import scales_of
from film_model.scene import Scene

GRAVITY_THRESHOLD = 0.01
"""m g/F_m above which gravity is simulated: it changes the maximum indentation by as much (linear estimate)."""

MOTION_THRESHOLD = 0.006
"""Zener's λ below which target motion takes less than 1 % of the velocity: e ≈ 1 − 1.73 λ."""


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
    """What a scene comes down to: law, target impedance [N s/m] and load [N], with the effects behind them."""

    law: AbstractLaw
    impedance: float
    load: float
    effects: tuple[Effect, ...]


def choose(scene: Scene) -> Choice:
    """Law, impedance and load of a scene, with the effects that decided them."""
    law, plasticity = _plasticity(scene)
    law = _reopened(scene, law)
    impedance, motion = _target_motion(scene)
    load, gravity = _gravity(scene, law)
    return Choice(law, impedance, load, (plasticity, motion, gravity))


_FROM_SCENE = {
    "effective_modulus": "effective_modulus",
    "radius": "effective_radius",
    "yield_strength": "yield_strength",
    "poissons_ratio": "poissons_ratio",
}
"""Fields of laws that the scene fills, and its properties that do."""


def law_values(scene: Scene, law: type[AbstractLaw]) -> dict[str, Any]:
    """The values a law takes from the scene, by its fields."""
    filled = {field: getattr(scene, _FROM_SCENE[field]) for field in law_fields(law) if field in _FROM_SCENE}
    return filled | dict(scene.contact.parameters)


def _law(scene: Scene, name: str) -> AbstractLaw:
    """The named law with its values from the scene."""
    return LAWS[name](**law_values(scene, LAWS[name]))


def _reopened(scene: Scene, law: AbstractLaw) -> AbstractLaw:
    """The law with the unloading rule of [contact], or its default one."""
    rule, modulus = scene.contact.unloading_name, scene.effective_modulus
    if rule == "retrace":
        return Retrace(law)
    if rule == "brake":
        assert modulus is not None
        return BrakeUnloading(law, modulus, scene.effective_radius)
    return law


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
        yields = any(stage.unloading is not None for stage in _reopened(scene, chosen).stages())
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

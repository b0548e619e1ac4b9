"""Plates and beams with edges: whether waves that come back matter, and how the target then gives way.

A contact that is over before they are back finds an infinite plate. One that is slow against all natural vibrations
finds the static stiffness, in series with the contact law; any other excites the vibrations.
"""

from __future__ import annotations

import math

from film_model.bodies import Beam, Plate
from film_model.effects import (
    FREE,
    INTEGRATED,
    NOT_JUDGED,
    NOT_MODELLED,
    NOT_NEEDED,
    SIMULATED,
    SWITCHED_OFF,
    Effect,
    Support,
    Trial,
    change,
    march,
)
from film_model.errors import SimulationError
from film_model.laws import AbstractLaw
from film_model.limits import judged
from film_model.problem import assemble
from film_model.scene import Scene

REFLECTIONS, INERTIA = "boundary_reflections", "target_inertia"

LARGE_MASS = 2.0
"""Mass of the impactor over that of a plate of unknown modes, above which its static stiffness is simulated."""

TAKES_PART = {Plate: 0.25, Beam: 0.5}
"""Share of the target's mass that is under the impactor in its first vibration."""


def edged(scene: Scene) -> bool:
    """Whether the target is a plate or beam for which there is a choice: with edges, or a static stiffness."""
    target = scene.target
    if scene.effects.target_motion is False:
        return False
    if not isinstance(target, Plate):
        return isinstance(target, Beam)
    asked = scene.effects.boundary_reflections is True
    return target.size is not None or target.static_stiffness is not None or asked


def wide(scene: Scene) -> bool:
    """Whether the target of an :func:`edged` scene is an infinite plate unless its edges matter."""
    target, effects = scene.target, scene.effects
    if effects.boundary_reflections is False:
        return isinstance(target, Plate)
    asked = effects.boundary_reflections is True or effects.target_inertia is True
    return isinstance(target, Plate) and target.size is not None and not asked


def support_of(scene: Scene, law: AbstractLaw) -> tuple[Support, tuple[Effect, ...]]:
    """How the target of an :func:`edged` scene gives way under a law, and the effects that say so.

    Boundary reflections: as :func:`film_model.limits.reflections` judges the impact on the infinite plate. Target
    inertia: :func:`vibration` against the scene's tolerance.
    """
    target, wanted, inertia = scene.target, scene.effects.boundary_reflections, scene.effects.target_inertia
    assert isinstance(target, Plate | Beam)
    beam, given = isinstance(target, Beam), target.static_stiffness is not None
    infinite = Support(scene.target_impedance)
    wide = None if beam else march(assemble(scene, law, infinite.impedance, 0.0))
    endless = isinstance(target, Plate) and target.size is None
    seen = _seen(scene, wide)

    def without(state: str, reason: str) -> tuple[Support, tuple[Effect, ...]]:
        inertial = Effect(INERTIA, _RATIO, None, None, 0.0, NOT_NEEDED, "it is in the impedance", _SOURCE)
        return infinite, (seen._replace(state=state, reason=reason), inertial)

    if wanted is False:
        if beam:
            raise SimulationError("effects.boundary_reflections is false, but a beam without ends has no impedance")
        return without(SWITCHED_OFF, "the scene asks for a plate without edges")
    if wanted == "auto" and not (beam or endless) and seen.state != NOT_MODELLED:
        return without(seen.state, seen.reason)
    damped = any(stage.damping is not None for stage in law.stages())
    if damped and (beam or given or wanted is True or inertia is True):
        otherwise = "target_motion = false in [effects] holds it still"
        if not beam:
            otherwise = "boundary_reflections = false in [effects] makes it infinite"
        raise SimulationError(
            f"law {law.name}: a damped law cannot be simulated on a {target.kind} with edges or a static stiffness; "
            + otherwise
        )
    if damped:
        return without(NOT_MODELLED, f"{seen.reason}; a damped law is simulated on an infinite plate only")
    compliance = target.compliance
    if compliance is None:
        raise SimulationError("effects.boundary_reflections is true, but the plate has no size")
    slow = march(assemble(scene, law, math.inf, 0.0, compliance))
    value = None if target.whole_mass is None else vibration(scene, slow, TAKES_PART[type(target)] * target.whole_mass)
    static = f"a static stiffness of {1 / compliance:.4g} N/m"

    def follows(state: str, reason: str) -> tuple[Support, tuple[Effect, ...]]:
        return Support(math.inf, compliance), _effects(scene, seen, wide, slow, value, state, reason, FREE)

    if endless and given:
        seen = seen._replace(reason="the scene gives a static stiffness")
    if inertia is False:
        return follows(SWITCHED_OFF, f"the scene asks for {static} alone")
    if inertia == "auto" and value is not None and value <= scene.effect_tolerance:
        return follows(NOT_NEEDED, f"it follows with {static} alone")
    if target.edges == "simply supported" and not given:
        stiff = Support(math.inf, compliance, vibrates=True)
        if wide is not None and wide.ends and not _force(wide) < _force(slow):
            stiff = Support(infinite.impedance, vibrates=True)
        why = f"by the natural vibrations of the {target.kind}"
        return stiff, _effects(scene, seen, wide, None, value, SIMULATED, why, INTEGRATED)
    missing = f"the vibrations of a {target.edges} {target.kind} are not known"
    if given:
        missing = "a given static stiffness says nothing about vibrations"
    if inertia is True:
        raise SimulationError(f"effects.target_inertia is true, but it cannot be simulated: {missing}")
    if target.whole_mass is None:
        return follows(NOT_JUDGED, f"missing: target.size, without which no mass is known; {static} alone")
    if beam or given or scene.mass >= LARGE_MASS * target.whole_mass:
        return follows(NOT_MODELLED, f"{missing}: {static} alone")
    if wanted is True:
        raise SimulationError(
            f"effects.boundary_reflections is true, but the impactor is lighter than {LARGE_MASS:g} plates, whose "
            f"vibrations would be needed, and {missing}"
        )
    return without(NOT_MODELLED, f"{seen.reason}; {missing}")


_RATIO = "vibration/static force"
_SOURCE = "a contact that closes on a support in vibration, to first order"


def _seen(scene: Scene, wide: Trial | None) -> Effect:
    """What is to be said of reflections by the trial on the infinite plate."""
    if wide is None:
        reason = "an endless beam has no impedance: its ends always count"
        return Effect(REFLECTIONS, "-", None, None, None, NOT_MODELLED, reason, "bending waves have no greatest speed")
    return judged(scene, wide, REFLECTIONS)


def _effects(
    scene: Scene,
    seen: Effect,
    wide: Trial | None,
    slow: Trial | None,
    value: float | None,
    state: str,
    reason: str,
    cost: str,
) -> tuple[Effect, ...]:
    """The effects of a target whose edges are simulated. slow: the impact on its static stiffness, if that is it."""
    size, source = seen.change, seen.source
    if wide is not None and slow is not None:
        size, source = change(slow, wide), "marched on the static stiffness and on the infinite plate"
    kept = seen._replace(state=SIMULATED, change=size, source=source, cost=cost)
    size = None if value is None else min(value, 1.0)
    return kept, Effect(INERTIA, _RATIO, value, scene.effect_tolerance, size, state, reason, _SOURCE, cost)


def vibration(scene: Scene, slow: Trial, part: float) -> float | None:
    """Amplitude of vibration of `part` [kg] of the target over the quasi-static force; None where that has no end.

    A contact of stiffness k_c = 1.5 F/δ that closes on a support k_b at velocity V asks the target for
    V k_c/(k_b + k_c) at once, and the part m_e of its mass that is under the impactor then oscillates:
    k_c^{3/2} √(m_e/m)/((k_b + k_c) √k_b).
    """
    if not slow.ends or slow.summary.maximum_indentation <= 0.0:
        return None
    depth = slow.summary.maximum_indentation * slow.problem.scales.length
    contact, support = 1.5 * _force(slow) / depth, 1 / slow.problem.compliance
    return contact**1.5 * math.sqrt(part / scene.mass / support) / (support + contact)


def _force(trial: Trial) -> float:
    return trial.summary.maximum_force * trial.problem.scales.force

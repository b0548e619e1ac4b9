"""Plates and beams with edges: whether reflected waves matter, and how the target then moves.

If contact ends before waves return, the plate behaves as an infinite one. If contact is slow compared with all natural
vibrations, the target follows by its static stiffness, in series with the contact law. Otherwise it vibrates.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from film_model.base.arrays import either, endless, root
from film_model.base.errors import SimulationError
from film_model.effects import stretching
from film_model.effects.effect import (
    FREE,
    NOT_JUDGED,
    NOT_MODELLED,
    NOT_NEEDED,
    ON_MODES,
    SIMULATED,
    SWITCHED_OFF,
    Effect,
    off_state,
)
from film_model.effects.judged import judged
from film_model.effects.target_motion import Support
from film_model.effects.trial import change
from film_model.problem.in_series import sure_in_series
from film_model.problem.problem import Impacts, Problem
from film_model.scene import Scene

REFLECTIONS, INERTIA = "boundary_reflections", "target_inertia"

SLOW = 0.1
"""ω t_c of a vibration, t_c being the contact time, below which it does not follow the force."""

_RATIO = "vibration/static force"
_SOURCE = "vibration of a support that a contact loads suddenly, to first order"

Supported = tuple[Support, tuple[Effect, ...]]


def edged(scene: Scene) -> bool:
    """Whether the target may have edge effects: a structure with edges, or with a given static stiffness."""
    target = scene.target
    if scene.effects.target_motion is False:
        return False
    return target.structural and (target.finite or target.stiffness_given or scene.effects.boundary_reflections is True)


def infinite_unless_judged(scene: Scene) -> bool:
    """Whether the target of an :func:`edged` scene is an infinite plate unless its edges matter."""
    target, effects = scene.target, scene.effects
    if not target.structural or endless(target.impedance):
        return False
    asked = effects.boundary_reflections is True or effects.target_inertia is True or stretching.possible(scene)
    return effects.boundary_reflections is False or (target.finite and not asked)


def support_of(impacts: Impacts) -> Supported:
    """How the target of an :func:`edged` scene moves in one impact, and the effects that describe it.

    Boundary reflections: :func:`film_model.effects.judged.reflections` for the impact on the infinite plate. Target
    inertia: :func:`vibration` against the scene's tolerance. Raises SimulationError if the scene asks for an effect
    that cannot be simulated.
    """
    scene, edges = impacts.base, _Edges(impacts)
    found = _without_stretching(edges)
    if found[0].vibrates or not stretching.possible(scene) or scene.effects.boundary_reflections is False:
        return found
    problem = impacts.problem(found[0].impedance, 0.0, found[0].compliance)
    return edges.vibrating() if scene.effects.target_inertia is not False and stretching.needed(problem) else found


def _without_stretching(edges: _Edges) -> Supported:
    """The same where membrane forces do not matter."""
    scene = edges.scene
    target, wanted, inertia = scene.target, scene.effects.boundary_reflections, scene.effects.target_inertia
    if wanted is False:
        if edges.bounded:
            raise SimulationError(
                f"effects.boundary_reflections is false, but an infinite {target.kind} has no impedance"
            )
        state = NOT_MODELLED if edges.reflections.state == NOT_MODELLED else SWITCHED_OFF
        return edges.infinite(state, "the scene has boundary_reflections = false")
    seen = edges.reflections
    if wanted == "auto" and target.finite and not edges.bounded and seen.state != NOT_MODELLED:
        return edges.infinite(seen.state, seen.reason)
    if edges.no_static:
        return _without_static(edges, asked=wanted is True or inertia is True)
    if target.compliance is None and target.finite and not target.modes_missing:
        return edges.vibrating()
    if target.compliance is None:
        raise SimulationError(f"effects.boundary_reflections is true, but the {target.kind} has no {target.extent}")
    static = f"a static stiffness of {1 / target.compliance:.4g} N/m" if target.compliance else "no static stiffness"
    if inertia is False and not target.held:
        raise SimulationError(
            f"effects.target_inertia is false, but nothing holds the {target.kind}: it has no static stiffness"
        )
    if inertia is False:
        state = off_state(edges.inertia or 0.0, scene.effect_tolerance)
        return edges.static(state, f"the scene has target_inertia = false: {static} alone")
    if inertia == "auto" and edges.inertia is not None and edges.inertia <= scene.effect_tolerance:
        return edges.static(NOT_NEEDED, f"the target follows by {static} alone")
    if not target.modes_missing:
        return edges.vibrating()
    return _without_modes(edges, static)


def supports_of(impacts: Impacts) -> Iterator[tuple[Impacts, Support]]:
    """How the target moves in many impacts that share a law and a curve, as :func:`support_of` decides it.

    Omitted are impacts whose target may vibrate, and those whose law may not follow its static stiffness.
    """
    scene, effects = impacts.scene, impacts.base.effects
    if not edged(scene) or infinite_unless_judged(scene):
        yield impacts, Support(impacts.numbers.impedance)
        return
    target = scene.target
    refused = effects.boundary_reflections is False or effects.target_inertia is True or stretching.possible(scene)
    if refused or not target.held or (static := target.compliance) is None:
        return
    compliance = np.array(impacts.column(static))
    follows = (compliance > 0.0) & sure_in_series(impacts, compliance)
    if effects.target_inertia == "auto" and not target.modes_missing and follows.any():
        if target.whole_mass is None:
            return
        mass = impacts.column(target.first_mode_share * target.whole_mass)
        static = impacts.problem(impacts.column(math.inf), impacts.column(0.0), compliance)
        follows &= vibration(static, mass) <= impacts.base.effect_tolerance
    if follows.all():
        yield impacts, Support(impacts.column(math.inf), compliance)
    elif follows.any():
        part = impacts.part(follows)
        yield part, Support(part.column(math.inf), compliance[follows])


def _without_static(edges: _Edges, asked: bool) -> Supported:
    """The support for a law, such as a damped one, that cannot be in series with a static stiffness."""
    scene, target, law = edges.scene, edges.scene.target, edges.impacts.one_law
    if not target.modes_missing and scene.effects.target_inertia is not False:
        return edges.vibrating()
    if not law.damped:
        raise SimulationError(edges.no_static)
    if edges.bounded or target.stiffness_given or asked:
        held = "target_motion = false in [effects] fixes the target"
        otherwise = held if edges.bounded else "boundary_reflections = false in [effects] makes it infinite"
        what = f"a {target.kind} with edges whose vibrations are not known, or with a static stiffness"
        raise SimulationError(f"law {law.name}: a damped law cannot be simulated on {what}; {otherwise}")
    reason = f"{edges.reflections.reason}; a damped law needs an infinite plate or known vibrations"
    return edges.infinite(NOT_MODELLED, reason)


def _without_modes(edges: _Edges, static: str) -> Supported:
    """The support if vibrations matter but the target's modes are unknown."""
    large_mass = 2.0  # plates, from which the static stiffness is simulated
    scene, target, missing = edges.scene, edges.scene.target, edges.scene.target.modes_missing
    if scene.effects.target_inertia is True:
        raise SimulationError(f"effects.target_inertia is true, but it cannot be simulated: {missing}")
    if target.whole_mass is None:
        return edges.static(NOT_JUDGED, f"missing: target.size, needed for the mass; {static} alone")
    if edges.bounded or target.stiffness_given or scene.mass >= large_mass * target.whole_mass:
        return edges.static(NOT_MODELLED, f"{missing}: {static} alone")
    if scene.effects.boundary_reflections is True:
        raise SimulationError(
            f"effects.boundary_reflections is true, but the impactor is lighter than {large_mass:g} plates, whose "
            f"vibrations would be needed, and {missing}"
        )
    return edges.infinite(NOT_MODELLED, f"{edges.reflections.reason}; {missing}")


@dataclass(frozen=True)
class _Edges:
    """One impact on a target with edges, marched on the infinite plate and on the static stiffness."""

    impacts: Impacts

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        return self.impacts.base

    @property
    def bounded(self) -> bool:
        """Whether the target has no wave impedance, so that its boundaries always matter (a beam)."""
        return endless(self.scene.target.impedance)

    @cached_property
    def on_infinite(self) -> Problem | None:
        """The impact on the infinite plate, if there is one."""
        return None if self.bounded else self.impacts.problem(self.scene.target_impedance, 0.0)

    @cached_property
    def on_static(self) -> Problem:
        """The impact on the static stiffness."""
        return self.impacts.problem(math.inf, 0.0, self.scene.target.compliance or 0.0)

    @cached_property
    def no_static(self) -> str:
        """Why the law cannot follow a static stiffness; empty if it can."""
        try:
            _ = self.on_static
        except SimulationError as error:
            return str(error)
        return ""

    @cached_property
    def reflections(self) -> Effect:
        """The effect of reflections, estimated for the impact on the infinite plate."""
        if self.on_infinite is None:
            reason = f"a {self.scene.target.kind} has no wave impedance: its boundaries matter in every impact"
            source = "no target without boundaries to compare with"
            return Effect(REFLECTIONS, "-", None, None, None, NOT_MODELLED, reason, source)
        seen, target = judged(self.on_infinite, REFLECTIONS), self.scene.target
        if not target.finite and target.stiffness_given:
            return seen._replace(reason="the scene gives a static stiffness")
        return seen

    @cached_property
    def inertia(self) -> float | None:
        """Force of vibration over static force; None if a mass or the static impact is unknown, contact stays, or
        nothing holds the target."""
        target = self.scene.target
        if target.whole_mass is None or not target.held or self.no_static:
            return None
        found = vibration(self.on_static, target.first_mode_share * target.whole_mass)
        return None if math.isnan(found) else found

    def infinite(self, state: str, reason: str) -> Supported:
        """The support and effects of the infinite plate."""
        inertial = Effect(INERTIA, _RATIO, None, None, 0.0, NOT_NEEDED, "the impedance includes it", _SOURCE)
        return Support(self.scene.target_impedance), (self.reflections._replace(state=state, reason=reason), inertial)

    def static(self, state: str, reason: str) -> Supported:
        """The support and effects of the static stiffness alone."""
        size, source = self.reflections.change, self.reflections.source
        if self.on_infinite is not None:
            found = change(self.on_static, self.on_infinite)
            size = None if math.isnan(found) else found
            source = "marched on the static stiffness and on the infinite plate"
        kept = self.reflections._replace(state=SIMULATED, change=size, source=source, cost=FREE)
        return Support(math.inf, self.scene.target.compliance or 0.0), (kept, self._inertia(state, reason, FREE))

    def vibrating(self) -> Supported:
        """The support and effects of vibrations; other effects are tried on the stiffer of impedance and stiffness."""
        felt, slow = felt_compliance(self.impacts)
        infinite, compliance = self.on_infinite, 0.0 if self.no_static else felt
        support = Support(math.inf, compliance, vibrates=True, slow=slow)
        trusted = infinite is not None and infinite.trial.ends
        if infinite and trusted and (self.no_static or stiffer(infinite, self.on_static)):
            support = Support(infinite.given.impedance, vibrates=True)
        reason = f"the {self.scene.target.kind} moves by its natural vibrations"
        kept = self.reflections._replace(state=SIMULATED, cost=ON_MODES)
        return support, (kept, self._inertia(SIMULATED, reason, ON_MODES))

    def _inertia(self, state: str, reason: str, cost: str) -> Effect:
        value, tolerance = self.inertia, self.scene.effect_tolerance
        size = None if value is None else min(value, 1.0)
        return Effect(INERTIA, _RATIO, value, tolerance, size, state, reason, _SOURCE, cost)


def felt_compliance(impacts: Impacts) -> tuple[float, bool]:
    """The part of a structure's static compliance [m/N] that the contact feels, and whether there is another part; all
    of it if the structure has waves.

    In a vibration with ω t_c below `SLOW` the struck point moves as with a free mass, though its compliance is that of
    a soft spring: finite-element programs give motions of the whole structure such frequencies. t_c is the contact time
    on a fixed target, lengthened by the compliance felt and shortened by these masses.
    """
    from film_model.core import modal  # most targets do not vibrate

    scene, compliance = impacts.base, impacts.base.target.compliance or 0.0
    fixed = impacts.problem(math.inf, 0.0)
    if not compliance or not endless(scene.target.impedance) or not fixed.trial.ends:
        return compliance, False
    core, scales = fixed.trial.summary, fixed.scales
    shortest = core.contact_duration * scales.time
    highest = 2.0 ** math.ceil(math.log2(SLOW / shortest))  # which many impacts share
    modes = scene.target.modes(highest)
    rest = scene.target.omitted(modes, highest)[0]
    return modal.felt(modes.frequency, modes.share, rest, scene.mass, shortest, softness(fixed), SLOW)


def stiffer(one: Problem, other: Problem) -> Any:
    """Whether an impact has at least the force of another."""
    return either(_force(one) < _force(other), False, True)


def softness(problem: Problem) -> Any:
    """Compliance of the contact, m/N: largest indentation over largest force."""
    return problem.trial.summary.maximum_indentation * problem.scales.length / _force(problem)


def vibration(static: Problem, part: Any) -> Any:
    """Force amplitude of the vibration of `part` [kg] of the target over the quasi-static force; nan if contact stays.

    static: one impact, or many, on the target's static stiffness k_b. A contact of stiffness k_c = 1.5 F/δ that begins
    with the velocity V would move the target suddenly with V k_c/(k_b + k_c). Its inertia resists: the part m_e of its
    mass oscillates with the relative amplitude k_c^{3/2} √(m_e/m)/((k_b + k_c) √k_b).
    """
    depth = static.trial.summary.maximum_indentation * static.scales.length
    known = static.trial.ends & (depth > 0.0)
    contact, support = 1.5 * _force(static) / either(known, depth, 1.0), 1 / static.given.compliance
    found = contact**1.5 * root(part / static.impacts.numbers.mass / support) / (support + contact)
    return either(known, found, math.nan)


def _force(problem: Problem) -> float:
    return problem.trial.summary.maximum_force * problem.scales.force

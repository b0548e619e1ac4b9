"""Plates and beams with edges: whether reflected waves matter, and how the target then moves.

If contact ends before waves return, the plate behaves as an infinite one. If contact is slow compared with all natural
vibrations, the target follows by its static stiffness, in series with the contact law. Otherwise it vibrates.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import either, endless, root
from film_model.base.errors import SimulationError
from film_model.effects import stretching
from film_model.effects.case import Pulse
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


class Way(NamedTuple):
    """How the target moves in some impacts. effects: those that describe it, of one impact."""

    impacts: Impacts
    support: Support
    effects: tuple[Effect, ...] = ()


def edged(scene: Scene) -> bool:
    """Whether the target may have edge effects: a structure with edges, or with a given static stiffness."""
    target = scene.target
    if scene.effects.target_motion is False:
        return False
    return target.structural and (target.finite or target.stiffness_given or scene.effects.boundary_reflections is True)


def may_differ(scene: Scene) -> bool:
    """Whether impacts may differ in how the target moves, and so in their curves: a static stiffness is a part of them.

    Not if it is fixed, or an infinite plate unless waves from its edges matter.
    """
    if not edged(scene):
        return False
    target, wanted = scene.target, scene.effects.boundary_reflections
    asked = wanted is True or scene.effects.target_inertia is True or stretching.possible(scene)
    return endless(target.impedance) or (wanted is not False and (asked or not target.finite))


def ways_of(impacts: Impacts) -> Iterable[Way]:
    """How the target moves in one impact; or in many that share a law and a curve, in parts.

    Boundary reflections: :func:`film_model.effects.judged.reflections` for the impact on the infinite plate. Target
    inertia: :func:`vibration` against the scene's tolerance. Of many impacts those are omitted whose target may vibrate
    or whose law may not follow its static stiffness, and those whose scene asks for an effect that cannot be simulated;
    for one impact this raises SimulationError.
    """
    if not edged(impacts.scene):
        return (Way(impacts, Support(impacts.numbers.impedance)),)
    return _with_edges(impacts)


def _with_edges(impacts: Impacts) -> Iterator[Way]:
    scene = impacts.scene
    stretches = scene.effects.boundary_reflections is not False and stretching.possible(scene)
    try:
        for way in without_stretching(_Edges(impacts)):
            if not impacts.many:
                yield _Edges(impacts).vibrating() if stretches and _stretched(way) else way
            elif not (stretches or way.support.vibrates):
                yield way
    except SimulationError:
        if not impacts.many:
            raise


def _stretched(way: Way) -> bool:
    """Whether membrane forces make the target of one impact vibrate."""
    impacts, support, _ = way
    if support.vibrates or impacts.base.effects.target_inertia is False:
        return False
    return stretching.needed(impacts.problem(support.impedance, 0.0, support.compliance))


def without_stretching(edges: _Edges) -> Iterator[Way]:
    """The same where membrane forces do not matter; the page has a table of it (`film_model.explorer.support`)."""
    target, wanted = edges.scene.target, edges.scene.effects.boundary_reflections
    if wanted is False:
        if edges.bounded:
            raise SimulationError(
                f"effects.boundary_reflections is false, but an infinite {target.kind} has no impedance"
            )
        yield edges.infinite()
    elif wanted == "auto" and target.finite and not edges.bounded:
        for part, near in edges.parts(edges.near):
            if not near:
                yield part.infinite()
            elif not part.impacts.many:  # of which they may matter only
                yield from _on_structure(part)
    else:
        yield from _on_structure(edges)


def _on_structure(edges: _Edges) -> Iterator[Way]:
    """The same where the edges of the target matter, or the scene asks for them."""
    target, inertia = edges.scene.target, edges.scene.effects.target_inertia
    if edges.no_static:
        yield _without_static(edges)
        return
    if target.compliance is None and target.finite and not target.modes_missing:
        yield edges.vibrating()
        return
    if target.compliance is None:
        raise SimulationError(f"effects.boundary_reflections is true, but the {target.kind} has no {target.extent}")
    if inertia is False and not target.held:
        raise SimulationError(
            f"effects.target_inertia is false, but nothing holds the {target.kind}: it has no static stiffness"
        )
    given = target.modes_missing and (target.whole_mass is None or edges.bounded or target.stiffness_given)
    for part, follows in edges.parts(edges.follows):
        if follows and (inertia is False or (inertia == "auto" and given)):
            yield part.static()
        elif follows:
            for own, quiet in part.parts(inertia == "auto" and part.quiet):
                yield from [own.static()] if quiet else _moving(own)


def _moving(edges: _Edges) -> Iterator[Way]:
    """The same where the vibrations of the target matter."""
    large_mass = 2.0  # plates, from which the static stiffness is simulated
    scene, target, missing = edges.scene, edges.scene.target, edges.scene.target.modes_missing
    if not missing:
        yield edges.vibrating()
        return
    if scene.effects.target_inertia is True:
        raise SimulationError(f"effects.target_inertia is true, but it cannot be simulated: {missing}")
    assert target.whole_mass is not None
    for own, heavy in edges.parts(edges.impacts.numbers.mass >= large_mass * target.whole_mass):
        if not heavy and scene.effects.boundary_reflections is True:
            raise SimulationError(
                f"effects.boundary_reflections is true, but the impactor is lighter than {large_mass:g} plates, whose "
                f"vibrations would be needed, and {missing}"
            )
        yield own.static() if heavy else own.infinite(missing)


def _without_static(edges: _Edges) -> Way:
    """The same for one impact whose law, such as a damped one, cannot be in series with a static stiffness."""
    target, law, effects = edges.scene.target, edges.impacts.one_law, edges.scene.effects
    if not target.modes_missing and effects.target_inertia is not False:
        return edges.vibrating()
    if not law.damped:
        raise SimulationError(edges.no_static)
    asked = effects.boundary_reflections is True or effects.target_inertia is True
    if edges.bounded or target.stiffness_given or asked:
        held = "target_motion = false in [effects] fixes the target"
        otherwise = held if edges.bounded else "boundary_reflections = false in [effects] makes it infinite"
        what = f"a {target.kind} with edges whose vibrations are not known, or with a static stiffness"
        raise SimulationError(f"law {law.name}: a damped law cannot be simulated on {what}; {otherwise}")
    return edges.infinite("a damped law needs an infinite plate or known vibrations")


@dataclass(frozen=True)
class _Edges:
    """Impacts, one or many, on a target with edges, marched on the infinite plate and on the static stiffness."""

    impacts: Impacts

    @property
    def scene(self) -> Scene:
        """The scene; of many impacts with arrays."""
        return self.impacts.scene

    def parts(self, condition: Any) -> Iterator[tuple[_Edges, bool]]:
        """The impacts where a condition holds, and those where it does not."""
        if not isinstance(condition, np.ndarray):
            yield self, condition
            return
        for holds, where in ((True, condition), (False, ~condition)):
            if where.any():
                yield self if where.all() else _Edges(self.impacts.part(where)), holds

    @property
    def bounded(self) -> bool:
        """Whether the target has no wave impedance, so that its boundaries always matter (a beam)."""
        return endless(self.scene.target.impedance)

    @cached_property
    def on_infinite(self) -> Problem | None:
        """The impact on the infinite plate, if there is one."""
        if self.bounded:
            return None
        return self.impacts.problem(self.impacts.numbers.impedance, self.impacts.column(0.0))

    @cached_property
    def on_static(self) -> Problem:
        """The impact on the static stiffness."""
        column, compliance = self.impacts.column, self.scene.target.compliance
        return self.impacts.problem(column(math.inf), column(0.0), column(0.0 if compliance is None else compliance))

    @cached_property
    def no_static(self) -> str:
        """Why the law of one impact cannot follow a static stiffness; empty if it can, and of many."""
        try:
            _ = self.impacts.many or self.on_static
        except SimulationError as error:
            return str(error)
        return ""

    @property
    def follows(self) -> Any:
        """Whether the law of many impacts is sure to follow the static stiffness."""
        if not self.impacts.many:
            return True
        compliance = np.array(self.impacts.column(self.scene.target.compliance))
        return (compliance > 0.0) & sure_in_series(self.impacts, compliance)

    @cached_property
    def near(self) -> Any:
        """Whether reflected waves matter to one impact on the infinite plate; of many, whether they may."""
        if not self.impacts.many:
            return self.reflections.state == NOT_MODELLED
        free, target = self.on_infinite, self.scene.target
        assert free is not None
        with np.errstate(divide="ignore", invalid="ignore"):
            pulse = Pulse.of(free.approach, free.gamma, free.trial.summary)
            delay = pulse.back / (self.impacts.column(target.return_time) / free.scales.time)
            off = target.reflection_change(pulse.motion, pulse.restitution, delay)
        return ~free.trial.ends | may_matter(off, self.impacts.base.effect_tolerance)

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
    def inertia(self) -> Any:
        """Force of vibration over static force; None if a mass or the static impact is unknown, contact stays, or
        nothing holds the target; nan where contact stays of many."""
        target = self.scene.target
        if target.whole_mass is None or not target.held or self.no_static:
            return None
        found = vibration(self.on_static, self.impacts.column(target.first_mode_share * target.whole_mass))
        return found if self.impacts.many or found == found else None

    @property
    def quiet(self) -> Any:
        """Whether the force of vibration is within the scene's tolerance."""
        return self.inertia is not None and self.inertia <= self.impacts.base.effect_tolerance

    def infinite(self, why: str = "") -> Way:
        """The way of the infinite plate. why: if edges matter, and are not simulated."""
        support = Support(self.impacts.numbers.impedance)
        if self.impacts.many:
            return Way(self.impacts, support)
        seen = self.reflections
        if self.scene.effects.boundary_reflections is False:
            state = NOT_MODELLED if self.near else SWITCHED_OFF
            seen = seen._replace(state=state, reason="the scene has boundary_reflections = false")
        elif why:
            seen = seen._replace(state=NOT_MODELLED, reason=f"{seen.reason}; {why}")
        inertial = Effect(INERTIA, _RATIO, None, None, 0.0, NOT_NEEDED, "the impedance includes it", _SOURCE)
        return Way(self.impacts, support, (seen, inertial))

    def static(self) -> Way:
        """The way of the static stiffness alone."""
        if self.impacts.many:
            return Way(self.impacts, Support(*self.on_static.given[::2]))
        size, source = self.reflections.change, self.reflections.source
        if self.on_infinite is not None:
            found = change(self.on_static, self.on_infinite)
            size = None if math.isnan(found) else found
            source = "marched on the static stiffness and on the infinite plate"
        kept = self.reflections._replace(state=SIMULATED, change=size, source=source, cost=FREE)
        target, wanted = self.scene.target, self.scene.effects.target_inertia
        soft = target.compliance or 0.0
        static = f"a static stiffness of {1 / soft:.4g} N/m" if soft else "no static stiffness"
        state, reason = NOT_MODELLED, f"{target.modes_missing}: {static} alone"
        if wanted is False:
            state = off_state(self.inertia or 0.0, self.scene.effect_tolerance)
            reason = f"the scene has target_inertia = false: {static} alone"
        elif self.quiet:
            state, reason = NOT_NEEDED, f"the target follows by {static} alone"
        elif target.whole_mass is None:
            state, reason = NOT_JUDGED, f"missing: target.size, needed for the mass; {static} alone"
        effects = kept, self._inertia(state, reason, FREE)
        return Way(self.impacts, Support(math.inf, soft), effects)

    def vibrating(self) -> Way:
        """The way of vibrations; other effects of one impact are tried on the stiffer of impedance and stiffness."""
        if self.impacts.many:
            return Way(self.impacts, Support(math.inf, vibrates=True))
        felt, slow = felt_compliance(self.impacts)
        infinite, compliance = self.on_infinite, 0.0 if self.no_static else felt
        support = Support(math.inf, compliance, vibrates=True, slow=slow)
        trusted = infinite is not None and infinite.trial.ends
        if infinite and trusted and (self.no_static or stiffer(infinite, self.on_static)):
            support = Support(infinite.given.impedance, vibrates=True)
        reason = f"the {self.scene.target.kind} moves by its natural vibrations"
        kept = self.reflections._replace(state=SIMULATED, cost=ON_MODES)
        return Way(self.impacts, support, (kept, self._inertia(SIMULATED, reason, ON_MODES)))

    def _inertia(self, state: str, reason: str, cost: str) -> Effect:
        value, tolerance = self.inertia, self.scene.effect_tolerance
        size = None if value is None else min(value, 1.0)
        return Effect(INERTIA, _RATIO, value, tolerance, size, state, reason, _SOURCE, cost)


def may_matter(off: Any, tolerance: Any) -> Any:
    """Whether reflected waves may matter that change the summary by about so much."""
    # Edges are neglected without further trials if the change by reflections is this many times below the tolerance
    sure = 3.0
    return ~(off < tolerance / sure)


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

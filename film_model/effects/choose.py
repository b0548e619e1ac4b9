"""Which effects a scene calls for. Each is decided by two marches on a coarse mesh, with the effect and without.

"auto" simulates an effect if neglecting it would change the summary by more than the scene's tolerance. Every rule
serves one impact (:func:`choose`) and many that share a law and a curve (:func:`decided`). Effects that cannot be
simulated are estimated by formulas (:mod:`film_model.effects.judged`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from film_model.base.arrays import all_of, any_of, either
from film_model.base.errors import SimulationError
from film_model.effects import (
    gravity,
    large_slope,
    material_damping,
    plasticity,
    rate_hardening,
    stretching,
    target_motion,
    viscoelasticity,
    wave_losses,
)
from film_model.effects.edge_effects import ways_of
from film_model.effects.effect import COMPUTED, FREE, NOT_MODELLED, NOT_NEEDED, Effect
from film_model.effects.judged import judge
from film_model.effects.law_range import law_warnings
from film_model.effects.target_motion import Support
from film_model.problem.law_of_scene import ELASTIC, STEEP, SceneLaw, laws_of
from film_model.problem.problem import Impacts, Problem
from film_model.scene import Scene

_SETTLED = {
    "small_slope": large_slope.settled,
    "material_damping": material_damping.settled,
    "stretching": stretching.settled,
}
"""Estimated effects that may be simulated, and what puts the decision into the estimate."""


@dataclass(frozen=True)
class Choice:
    """The decisions for one scene: what is simulated, and the numbers that decided.

    problem: what is simulated: law, target motion and load. light: without the weight. moved: with target motion,
    unless the scene switches it off. yielding: before Hertz's law may replace the law. static, hard: without weight,
    with the strength of slow loading, and with that at the rate of the impact if this is simulated. support, edges: how
    the target moves, and the effects of its edges. decided: whether gravity and target motion are simulated, and
    whether the law stays.
    """

    problem: Problem
    light: Problem
    moved: Problem
    yielding: Problem
    static: Problem
    hard: Problem | None
    support: Support
    edges: tuple[Effect, ...]
    decided: tuple[bool, bool, bool]

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        return self.problem.scene

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Every effect with the number that decided, in the order of :data:`COMPUTED`; then the estimated ones.

        Nothing is decided here: the additional marches only complete the numbers.
        """
        return _in_order([self._gravity, self._motion, *self._plasticity, *self._judged, self._waves])

    @cached_property
    def _gravity(self) -> Effect:
        return gravity.describe(self.light, self.decided[0])

    @cached_property
    def _motion(self) -> Effect:
        return target_motion.describe(self.moved, self.support, self.decided[1])

    @cached_property
    def _plasticity(self) -> tuple[Effect, Effect]:
        return plasticity.describe(self.yielding, self.decided[2], self._damps)

    @property
    def _damps(self) -> bool:
        """Whether the losses of the materials replace the elastic or the yielding law."""
        return self.problem.law.damped and self.scene.contact.law == "auto"

    @property
    def _neglected(self) -> tuple[Effect, ...]:
        """The effects that the scene's switches or its law may leave out; only these take marches for a warning."""
        wanted, found = self.scene.effects, list[Effect]()
        found += [self._gravity] if wanted.gravity is False else []
        found += [self._motion] if wanted.target_motion is False else []
        fixed = wanted.plasticity is False or self.scene.contact.law != "auto" or self._damps
        fixed = fixed or not self.scene.is_round
        found += self._plasticity if fixed and self.problem.curve.reversible else ()
        found += [] if wave_losses.decided(self.problem) else [self._waves]
        return _in_order([*found, *self._judged])

    @cached_property
    def _judged(self) -> tuple[Effect, ...]:
        """The effects that are decided without the switches and marches of the others, or only estimated."""
        _, moves, keeps_law = self.decided
        found = [
            rate_hardening.describe(self.static, self.hard, keeps_law and not self._damps),
            viscoelasticity.describe(self.problem),
        ]
        held = self.scene.target.gives_way and self.scene.effects.target_motion is not False and not moves
        why = "the target moves too little to matter"
        found += [effect._replace(state=NOT_NEEDED, reason=why, cost=FREE) if held else effect for effect in self.edges]
        known = {"wave_losses", *[effect.name for effect in self.edges]}
        settled = {name: rule(self._estimated[name], self.problem) for name, rule in _SETTLED.items()}
        judged = {**self._estimated, **settled}
        return (*found, *[effect for name, effect in judged.items() if name not in known])

    @cached_property
    def _waves(self) -> Effect:
        return wave_losses.settled(self._estimated["wave_losses"], self.problem)

    @cached_property
    def _estimated(self) -> dict[str, Effect]:
        return judge(self._ending, self.problem.vibrates)

    @property
    def _ending(self) -> Problem:
        """The impact without vibrations; without its weight, if that is small and keeps the impactor on the target."""
        tried = self.yielding if self.decided[2] else plasticity.elastic(self.yielding)
        if self.problem.law.steep and tried.law.name == ELASTIC:
            tried = tried.again(law=STEEP[ELASTIC])
        # an impactor that stays on the target has made an impact first where its weight is far below the largest force
        if tried.trial.ends or not 0.0 < tried.load < 0.1 * tried.trial.summary.maximum_force:
            return tried
        return tried.again(load=0.0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the law, about unlikely numbers, and about effects that matter but are not simulated."""
        said = (effect.warning for effect in self._neglected if effect.state == NOT_MODELLED)
        law = (*self.problem.law.remarks(), *self.problem.curve.warnings, *law_warnings(self.problem))
        law = (*law, *wave_losses.remarks(self.problem), *self.scene.remarks)
        return (*law, *(warning for warning in said if warning is not None))


def _in_order(effects: Iterable[Effect]) -> tuple[Effect, ...]:
    named = {effect.name: effect for effect in effects}
    return (*[named.pop(name) for name in COMPUTED if name in named], *named.values())


def choose(scene: Scene) -> Choice:
    """Law, target motion and load of one impact. Raises SimulationError if the scene asks for an unsupported effect."""
    ((law, _), *_) = laws_of(scene)
    ((impacts, support, edges),) = ways_of(Impacts.one(scene, SceneLaw.of(scene, law)))
    static = impacts.problem(support.impedance, 0.0, support.compliance)
    hard = rate_hardening.applied(static)
    light = hard or static
    ((problem, moved, yielding, decisions),) = decided(light, support)
    return Choice(problem, light, moved, yielding, static, hard, support, edges, decisions)


def problem_of(scene: Scene) -> Problem:
    """The dimensionless problem of a scene, with the effects it calls for."""
    return choose(scene).problem


def decided(light: Problem, support: Support) -> Iterator[tuple[Problem, Problem, Problem, tuple[Any, Any, Any]]]:
    """Problem, moved, yielding and decided, as of :class:`Choice`: of one impact, or of many in parts that share law,
    curve and kind of motion. light: without weight."""
    heavy = gravity.needed(light)
    moved = light if not any_of(heavy) else light.again(load=either(heavy, light.impacts.numbers.weight, 0.0))
    moves = target_motion.needed(moved, support)
    for yielding in _held(moved, moves):
        keeps_law = plasticity.needed(yielding)
        parts = [yielding] if all_of(keeps_law) else _parted(yielding, keeps_law, plasticity.elastic(yielding))
        if support.vibrates and moves:
            parts = [_vibrating(plain) for plain in parts]
        for rule in _REPLACING:
            parts = [each for part in parts for each in _parted(*rule(part), part)]
        for part in parts:
            yield part, moved, yielding, (heavy, moves, keeps_law)


_REPLACING = viscoelasticity.relaxing, material_damping.damped, large_slope.steep, wave_losses.radiating
"""Rules that change impacts where this matters, in the order in which they are asked."""


def _held(moved: Problem, moves: Any) -> list[Problem]:
    """Impacts with a fixed target where its motion does not matter."""
    if all_of(moves) or not moved.scene.target.gives_way:
        return [moved]
    if moved.own.spring is not None or not moved.impacts.many:
        return _parted(moved, moves, target_motion.held(moved))
    if not any_of(np.isfinite(moved.given.impedance)):
        return [moved]
    return [moved.again(impedance=either(moves, moved.given.impedance, math.inf))]


def _parted(one: Problem, where: Any, other: Problem) -> list[Problem]:
    """Impacts of one problem where a condition holds, and elsewhere those of the other."""
    if not isinstance(where, np.ndarray):
        return [one if where else other]
    if all_of(where):
        return [one]
    return [one.part(where), other.part(~where)] if any_of(where) else [other]


def _vibrating(problem: Problem) -> Problem:
    """One impact on a target that moves by its natural vibrations."""
    if problem.curve.pulls:
        raise SimulationError(
            f"law {problem.law.name}: laws that pull are not supported on targets that vibrate; "
            "target_motion = false in [effects] fixes the target"
        )
    vibrating = problem.impacts.problem(math.inf, problem.given.load, vibrates=True)
    return replace(vibrating, stretches=stretching.needed(problem))

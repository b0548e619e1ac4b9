"""The contacts of a chain of bodies: the law of each, its curve and its scales."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from film_model.base.errors import SimulationError
from film_model.laws import LAWS, AbstractLaw
from film_model.problem.curve import Curve, curve_of
from film_model.problem.law_of_scene import ELASTIC, YIELDING, SceneLaw
from film_model.scene import STANDARD_GRAVITY, Scene
from film_model.scene.chain import Chain, Link


class ChainContact(NamedTuple):
    """A contact in SI: the scene of its two bodies, its law and curve, δ_s [m], F_s [N], about its largest indentation
    [δ_s], damping [N s/m], and which bodies it joins."""

    scene: Scene
    law: AbstractLaw
    curve: Curve
    length: float
    force: float
    depth: float
    damping: float
    link: Link


def speed_of(chain: Chain) -> float:
    """The largest velocity of approach at the start, or after the fall of a chain with weight, m/s."""
    velocity, directions = [body.velocity for body in chain.row], chain.directions
    fastest = fall = 0.0
    for link in chain.links:
        before, after = (0.0 if end is None else velocity[end] for end in link[:2])
        fastest = max(fastest, link.along * before - after)
        if chain.gravity and link.behind is None:
            fall = max(fall, 2.0 * STANDARD_GRAVITY * math.cos(directions[link.body]) * link.gap)
    if fastest == fall == 0.0:
        raise SimulationError("no body of the chain approaches the next one: give a velocity, or gravity and a gap")
    return math.sqrt(fastest**2 + fall)


def contacts_of(chain: Chain) -> list[ChainContact]:
    """The contact of each of the chain's links. Raises as `simulate_chain` does."""
    made, speed = dict[int, tuple[AbstractLaw, Curve, float, float, float, float]](), speed_of(chain)
    scenes = chain.pairs(speed)
    for scene in scenes:
        if id(scene) not in made:
            made[id(scene)] = _law_in(scene, speed)
    found = [ChainContact(scene, *made[id(scene)], link) for scene, link in zip(scenes, chain.links, strict=True)]
    for contact in found:
        if contact.damping and chain.row[contact.link.body].fixed:
            name = contact.law.name
            raise SimulationError(f'the damping of contact law "{name}" depends on a mass, and a fixed body has none')
    return found


def _law_in(scene: Scene, speed: float) -> tuple[AbstractLaw, Curve, float, float, float, float]:
    """Law, curve, δ_s, F_s, depth and damping of a contact."""
    given: Any = scene.contact.law
    if given == "auto":
        given = YIELDING if scene.yield_strength is not None and scene.can_yield else ELASTIC
    for part in (scene.impactor, scene.target):
        if part.material is not None and part.material.prony is not None:
            raise SimulationError("the relaxation of a viscoelastic material is not simulated in a chain")
    law = SceneLaw.of(scene, LAWS[given] if isinstance(given, str) else given).at()
    length, force = law.scales(scene.kinetic_energy)
    damping, twice = (law.damping_factor(scene.effective_mass, v, length) for v in (speed, 2.0 * speed))
    if damping != twice:
        raise SimulationError(
            f'the damping of contact law "{law.name}" depends on the velocity of approach, which differs from contact '
            "to contact in a chain: give a law whose damping does not, such as tsuji"
        )
    curve = curve_of(law)
    return law, curve, length, force, _depth(curve, scene.kinetic_energy / (force * length)), damping


def _depth(curve: Curve, energy: float) -> float:
    """ξ at which the work of loading [F_s δ_s] is about the energy, by doubling; at most the end of the law."""
    last, depth = curve.native.stage[curve.native.stages - 1].end, 1.0
    while depth < last and curve.work(depth) < energy:
        depth *= 2.0
    while curve.work(depth) > 4.0 * energy and depth > 1e-9:
        depth *= 0.5
    return min(depth, last)

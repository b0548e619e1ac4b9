"""Wave losses: what a contact radiates into a half-space, as an impedance of the target that takes as much energy.

    E_waves = β/(ρ c_T³) ∫Ḟ² dt        the surface lags behind its static deflection (Lamb's problem)
    Z = 0.0878 t_c² ρ c_T³/β           takes as much, ∫F² dt/Z, in an elastic impact of the contact time t_c

In impacts that yield Z is right within 5 % up to 100 yield velocities and rises as (V/V_Y)^0.07 beyond; the energy is
right within 12 %. Above 15 % of the energy a warning comes. Later contacts at V' lose an energy wrong by the factor
(V'/V)^{2/5}. Law "auto" simulates it, others if the scene asks for it; none where the weight exceeds a tenth of the
largest elastic force, which would move the target at F/Z.
"""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import any_of, column, either, greater, lesser
from film_model.base.errors import SimulationError
from film_model.effects.effect import DAMPED, NOT_MODELLED, NOT_NEEDED, SIMULATED, Effect, off_state, percent
from film_model.effects.judged import agreeing
from film_model.effects.trial import change, matters
from film_model.problem.model_intervals import yield_velocities
from film_model.problem.problem import Impacts, Problem
from film_model.problem.summary import radiated
from film_model.scene import Scene
from film_model.targets.waves import HERTZ_SQUARE


def impedance_of(scene: Scene, yielding: bool) -> Any:
    """The impedance by which a half-space takes up the energy of waves, N s/m; infinite if unknown (a cone). Of one
    impact, or of a scene with arrays. yielding: the law yields."""
    if scene.effective_modulus is None or scene.nose is not None:
        return math.inf
    impedance = scene.target.radiation_impedance(scene.elastic_impact[0])
    ratio = yield_velocities(scene) if yielding else None
    if ratio is not None:
        # Z rises beyond this ratio of approach to yield velocity
        impedance = impedance * greater(ratio / 100.0, 1.0) ** 0.07
    return either(scene.approach_velocity > 0.0, impedance, math.inf)


def felt(impacts: Impacts) -> Any:
    """The target's impedance in a scene that contains a decision, N s/m: its own, or that of its waves."""
    own = impacts.numbers.impedance
    if impacts.base.effects.wave_losses is not True:
        return own
    return lesser(own, impacts.column(impedance_of(impacts.scene, _yields(impacts))))


def _yields(impacts: Impacts) -> bool:
    """Whether the law is one of a ball that yields, by any rule of unloading."""
    law = impacts.law.law
    return getattr(law if isinstance(law, type) else type(law), "family", "") == "yields"


def hindered(problem: Problem) -> str:
    """Why waves from impacts into a half-space are not simulated unless the scene asks for them; empty if they are."""
    if problem.relaxation is not None:
        return "a material relaxes"
    named = problem.scene.contact.law != "auto"
    return f"the law {problem.law.name} is simulated with them by wave_losses = true" if named else ""


def radiating(problem: Problem) -> tuple[Problem, Any]:
    """Impacts with the energy that waves take from them, and for which of them this is simulated; if for none, the
    impacts as they are. Raises SimulationError if the scene asks for it and it cannot be simulated."""
    wanted = problem.scene.effects.wave_losses
    if not any_of(problem.approach > 0.0):
        return problem, False
    made = None if wanted is False or (wanted == "auto" and hindered(problem)) else with_waves(problem)
    if wanted is True:
        if made is None:
            relaxes = hindered(problem) if problem.relaxation is not None else ""
            why = relaxes or "only the waves of a half-space of known material are known"
            raise SimulationError(f"effects.wave_losses is true, but {why}")
        return made, True
    if made is None:
        return problem, False
    most = largest_share(problem.impacts.scene, made.given.impedance)
    doubtful = may_matter(pressed(problem), most, problem.scene.effect_tolerance)
    if not problem.impacts.many:
        return made, doubtful and matters(made, problem)
    return made, matters(made, problem, where=column(doubtful, problem.approach.size))


def largest_share(scene: Scene, impedance: Any) -> Any:
    """Share of the energy of an elastic impact that its waves take. One that yields radiates less, and no other value
    changes as much."""
    duration, force = scene.elastic_impact
    return HERTZ_SQUARE * force**2.0 * duration / (impedance * scene.kinetic_energy)


def may_matter(pressed: Any, most: Any, tolerance: Any) -> Any:
    """Whether waves may change a result by more than the tolerance. most: :func:`largest_share`."""
    return either(pressed, False, most > 0.9 * tolerance)


def with_waves(problem: Problem) -> Problem | None:
    """The impacts with waves in the half-space; None if these are not known."""
    if problem.relaxation is not None or problem.vibrates:
        return None
    impacts = problem.impacts
    impedance = impacts.column(impedance_of(impacts.scene, _yields(impacts)))
    return problem.again(impedance=impedance) if any_of(impedance < math.inf) else None


def pressed(problem: Problem) -> Any:
    """Whether the weight makes impacts last longer than their velocities say."""
    return problem.loaded and problem.load * problem.scales.force > heaviest(problem.impacts.scene)


def heaviest(scene: Scene) -> Any:
    """Weight from which they do, N."""
    # Weight over the largest elastic force, beyond which the impact lasts longer than its velocity says
    most_weight = 0.1
    return most_weight * scene.elastic_impact[1]


def remarks(problem: Problem) -> tuple[str, ...]:
    """A sentence if waves in a half-space take so much of one impact that terms of second order matter."""
    if problem.scene.target.gives_way or problem.free or not problem.gamma > 0.0 or not problem.trial.ends:
        return ()
    share = radiated(problem, problem.trial.summary) / (0.5 * problem.approach**2)
    if share <= 0.15:  # beyond, terms of second order matter
        return ()
    return (f"waves in the half-space carry away {percent(share)} of the impact energy, simulated to first order",)


def decided(problem: Problem) -> bool:
    """Whether the waves from one impact into a half-space are simulated, or were found not to matter. problem: what is
    simulated."""
    scene = problem.scene
    if scene.target.gives_way or scene.nose is not None or not scene.target.radiation_impedance(1.0) < math.inf:
        return False
    asked = scene.effects.wave_losses is not False and not hindered(problem)
    return problem.gamma > 0.0 or (asked and not pressed(problem))


def settled(effect: Effect, problem: Problem) -> Effect:
    """The estimated effect with what was decided about it. problem: what is simulated."""
    scene, simulated = problem.scene, problem.gamma > 0.0
    if scene.target.gives_way or scene.nose is not None or (effect.change is None and not simulated):
        return effect
    if pressed(problem) and not simulated:
        why = "the weight makes the impact last longer than its velocity says"
        return effect._replace(reason=f"{effect.reason}; {why}")
    still = problem.again(impedance=math.inf) if simulated else problem
    moved = problem if simulated else with_waves(problem)
    if moved is None:
        return effect
    found, tolerance = change(moved, still), scene.effect_tolerance
    size, why = effect.change if math.isnan(found) else found, effect.reason
    if simulated:
        state = SIMULATED
        why = why if effect.change is not None else "the half-space takes up their energy by an impedance"
    elif scene.effects.wave_losses is False:
        state, why = off_state(size, tolerance), f"the scene has wave_losses = false; {why}"
    else:
        state = NOT_NEEDED if size is None or size <= tolerance else NOT_MODELLED
        why = why if state == NOT_NEEDED else f"{why}; {hindered(problem)}"
    threshold = agreeing(effect.value, tolerance, size, tolerance)
    return effect._replace(state=state, change=size, threshold=threshold, reason=why, cost=DAMPED)

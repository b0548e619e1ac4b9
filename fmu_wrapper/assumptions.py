"""The scene that an FMU simulates for every value of its parameters, and where the assumptions of the export hold."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

from film_model.base.arrays import endless
from film_model.base.errors import SceneError, SimulationError
from film_model.core.refining import error_of, step_tolerance
from film_model.effects.choose import Choice, choose
from film_model.effects.edge_effects import edged
from film_model.effects.effect import NOT_MODELLED
from film_model.effects.large_slope import COMPUTED
from film_model.effects.trial import change
from film_model.laws.tsuji import Tsuji
from film_model.laws.yielding import yield_point, yield_velocity
from film_model.problem.law_of_scene import ELASTIC, YIELDING, yielding_entries
from film_model.problem.problem import Problem
from film_model.problem.relaxation import relaxation_of
from film_model.problem.summary import differences
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.scene.columns import scene_of_columns
from film_model.solve import structures, vibration
from film_model.solve.accuracy import refine
from film_model.solve.motions import modes_for
from fmu_wrapper.variables import Kind

STRIDE, STRIDES = 3.0, 8
"""The velocity is changed by this factor so often to find where its range of validity ends, another parameter three
times; then the logarithm of the last factor is bisected."""

FEW = "vibrations above those of the export"
"""What fails if the maximum force or indentation needs more natural vibrations than the FMU contains."""

_PATHS = {"initial_velocity": "impactor.velocity", "mass": "impactor.mass", "radius": "impactor.radius"}
"""Parameters whose range of validity is determined → entries of the scene."""


class Range(NamedTuple):
    """Values of a parameter, SI, for which the assumptions hold, and what fails below and above."""

    low: float
    high: float
    below: str
    above: str


@dataclass(frozen=True)
class Validity:
    """Where the assumptions of an export hold.

    ranges: by parameter, the others being as exported; a range ends where an effect that is not simulated begins to
    matter. elastic: indentation [m] at which the materials yield although the law is elastic. narrow: indentation [m]
    from which the contact is too wide for the law. Both are infinite if there is no such limit. also: slower velocities
    at first touch, m/s, for which they hold too: below yield, another strength does not matter. 0 and 0: none.
    """

    ranges: dict[str, Range]
    elastic: float
    narrow: float
    also: tuple[float, float]


def served(scene: Scene, kind: Kind = "impact") -> Scene:
    """The scene as an FMU simulates it: without the decisions that "auto" makes for the velocity of the scene.

    Law "auto" becomes the law that yields, which is elastic below yield; gravity is simulated, and so is the motion of
    the target, unless the scene switches them off. A contact contains neither weight nor target. An impact whose
    viscoelasticity matters at the scene's velocity has it at all velocities, with Hertz's law; where losses of the
    materials or steep surfaces are simulated at that velocity, they are at all, with their law; so are waves in a
    half-space, with the impedance of that velocity.

    >>> fmu_wrapper.served(scene).contact.law_name
    'elastoplastic'
    """
    effects, given = scene.effects, scene
    if kind == "impact" and relaxation_of(scene) is not None and choose(scene).problem.relaxation is not None:
        effects = effects.changed(viscoelasticity=True)
        if scene.contact.law == "auto":
            scene = scene.replace({"contact.law": ELASTIC})
    if scene.contact.law == "auto":
        law, known = choose(scene).problem.law, scene.reaches_yield is not None and scene.can_yield
        if isinstance(law, Tsuji):
            scene = scene.replace({"contact.law": law.name, "contact.restitution": law.restitution})
        elif effects.plasticity is not False and known:
            scene = scene.replace(yielding_entries(scene))
        elif law.steep:
            scene = scene.replace({"contact.law": law.name})
    gravity, motion = effects.gravity, effects.target_motion
    waves = effects.wave_losses is True
    if effects.wave_losses == "auto" and not given.target.gives_way:
        waves = choose(given).problem.given.impedance < math.inf
    if kind == "contact":
        gravity = motion = waves = False
    else:
        gravity = True if gravity == "auto" else gravity
        motion = True if motion == "auto" and scene.target.gives_way and not edged(scene) else motion
    return replace(scene, effects=effects.changed(gravity=gravity, target_motion=motion, wave_losses=waves))


def segments_for_speeds(scene: Scene, problem: Problem, counts: tuple[int, int]) -> tuple[int, int]:
    """Segment counts of an FMU for law "auto": enough at every velocity, below yield and far above. scene: as given."""
    if scene.contact.law != "auto" or problem.law.name != YIELDING or scene.solver.segments is not None:
        return counts
    strength, modulus = problem.impacts.yield_strength, scene.effective_modulus
    assert strength is not None and modulus is not None
    limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
    # multiples of the yield velocity, so that each stage of the law is reached
    for factor in (0.5, 1.5, 5.0, 20.0, 150.0):
        tried = replace(problem, approach=factor * limit / problem.scales.velocity)
        try:
            found, _ = refine(tried, scene.solver, [])
        except SimulationError:  # the velocity is beyond the law, which the FMU reports
            continue
        counts = max(counts[0], found[0]), max(counts[1], found[1])
    return counts


def validity_of(scene: Scene) -> Validity:
    """Where the assumptions of an export hold. scene: as :func:`served`."""
    choice = choose(scene)
    elastic, narrow, law = math.inf, math.inf, choice.problem.law
    if scene.effective_modulus is not None:
        # a² = R δ; of others (a/R)²/10 is the tolerance
        most = COMPUTED**2 if law.steep else 10.0 * scene.effect_tolerance
        narrow = most * scene.effective_radius
    if getattr(type(law), "family", "") in ("elastic", "damped") and scene.reaches_yield is not None:
        assert scene.effective_modulus is not None and scene.yield_strength is not None
        elastic = yield_point(scene.effective_modulus, scene.effective_radius, scene.yield_strength)[0]
    ranges, also = _ranges(scene)
    return Validity(ranges, elastic, narrow, also)


@lru_cache(maxsize=64)
def _ranges(scene: Scene) -> tuple[dict[str, Range], tuple[float, float]]:
    """Ranges of validity, and the slower velocities; none for an impactor at rest, whose effects are not assessed."""
    own, highest = choose(scene), None
    if own.problem.vibrates and own.problem.approach > 0.0:
        highest = modes_for(own.problem, scene.solver.accuracy or DEFAULT_ACCURACY, []).highest
    found: dict[str, Range] = {}
    for name, value in _values(scene).items():
        ends = [_end(scene, name, value, factor, own, highest) for factor in (1.0 / STRIDE, STRIDE)]
        (low, below), (high, above) = ends
        if below or above:
            found[name] = Range(low, high, below, above)
    slow = found.get("initial_velocity")
    return found, (0.0, 0.0) if slow is None or not slow.below else _slower(scene, slow.low, own, highest)


def _slower(scene: Scene, bad: float, own: Choice, highest: float | None) -> tuple[float, float]:
    """The next range of velocities below one that ends at `bad`; 0 and 0 if there is none."""

    def fails(velocity: float) -> str:
        return _new(scene, "initial_velocity", velocity, own, highest)

    good = next((v for v in (bad / STRIDE**k for k in range(1, STRIDES + 1)) if not fails(v)), 0.0)
    if good == 0.0:
        return 0.0, 0.0
    high, _ = _bisected(good, good * STRIDE, "", fails)
    return _end(scene, "initial_velocity", good, 1.0 / STRIDE, own, highest)[0], high


def _values(scene: Scene) -> dict[str, float]:
    """Parameters that can be varied in the scene, with their values."""
    if scene.approach_velocity <= 0.0 or scene.target.free:
        return {}
    values = {"initial_velocity": scene.approach_velocity, "mass": scene.mass}
    if endless(scene.target.radius) and scene.is_round:
        values["radius"] = scene.impactor.radius
    return values


def _end(scene: Scene, name: str, value: float, factor: float, own: Choice, highest: float | None) -> tuple[float, str]:
    """The value up to which nothing more fails than at the export, and what fails beyond; "" if nothing does."""

    def fails(tried: float) -> str:
        return _new(scene, name, tried, own, highest)

    for stride in range(STRIDES if name == "initial_velocity" else 3):
        good, bad = value * factor**stride, value * factor ** (stride + 1)
        if why := fails(bad):
            return _bisected(good, bad, why, fails)
    return (0.0 if factor < 1.0 else math.inf), ""


def _bisected(good: float, bad: float, why: str, fails: Callable[[float], str]) -> tuple[float, str]:
    """The last value from `good` towards `bad` at which nothing fails, and what fails at the next one tried."""
    for _ in range(6):
        middle = math.sqrt(good * bad)
        found = fails(middle)
        good, bad, why = (good, middle, found) if found else (middle, bad, why)
    return good, why


def _new(scene: Scene, name: str, value: float, own: Choice, highest: float | None) -> str:
    """What fails at another value of a parameter but not at the export."""
    changes: dict[str, Any] = {_PATHS[name]: value}
    if name == "initial_velocity":
        changes["impactor.drop_height"] = None
    if name == "radius":
        changes["impactor.mass"] = scene.mass
    try:
        choice = choose(scene_of_columns(scene, changes))
        fails = _failing(choice, highest) - _failing(own, highest)
        fails |= _other_strength(choice.problem, own.problem) | _other_support(choice.problem, own.problem)
        fails |= _other_waves(choice.problem, own.problem)
        return ", ".join(sorted(fails))
    except (SceneError, SimulationError, ValueError, ArithmeticError):
        return "the library cannot simulate it"


def _other_strength(problem: Problem, own: Problem) -> frozenset[str]:
    """Rate hardening, where the strength that an FMU keeps changes a result by more than the tolerance."""
    strengths = [one.impacts.yield_strength for one in (problem, own)]
    if strengths[0] == strengths[1] or own.impacts.law.strength is None:
        return frozenset()
    kept = problem.impacts.law.strengthened(strengths[1] / strengths[0])
    off = change(problem, problem.impacts.under(kept).problem(*problem.given))
    return frozenset() if off <= problem.scene.effect_tolerance else frozenset({"rate hardening"})


def _other_waves(problem: Problem, own: Problem) -> frozenset[str]:
    """Waves in a half-space, where the impedance that an FMU keeps changes a result by more than the tolerance."""
    if problem.scene.effects.wave_losses is not True or problem.scene.target.gives_way:
        return frozenset()
    off = change(problem, problem.again(impedance=own.given.impedance))
    return frozenset() if off <= problem.scene.effect_tolerance else frozenset({"wave losses"})


def _other_support(problem: Problem, own: Problem) -> frozenset[str]:
    """What an FMU on an infinite plate, or on a static stiffness, leaves out where the target moves otherwise."""
    if own.vibrates or (problem.vibrates, problem.given.compliance > 0.0) == (False, own.given.compliance > 0.0):
        return frozenset()
    return frozenset({"vibrations of the target" if own.given.compliance > 0.0 else "boundary reflections"})


def _failing(choice: Choice, highest: float | None) -> frozenset[str]:
    """Effects that matter and are not simulated; plasticity has a limit of its own, `Validity.elastic`.

    highest: frequency up to which the FMU contains vibrations, rad/s; None if it contains none.
    """
    missing = {effect.name.replace("_", " ") for effect in choice.effects if effect.state == NOT_MODELLED}
    missing.discard("plasticity")
    if highest is not None:
        missing.discard("boundary reflections")
        if _needs_more(choice, highest):
            missing.add(FEW)
    return frozenset(missing)


def _needs_more(choice: Choice, highest: float) -> bool:
    """Whether vibrations above `highest` change the maximum force or indentation by more than the scene's tolerance."""
    scene, target = choice.scene, choice.scene.target
    problem = choice.problem.impacts.problem(math.inf, choice.problem.given.load, vibrates=True)
    tolerance = step_tolerance(scene.solver.accuracy or DEFAULT_ACCURACY)
    limit = vibration.time_limit(problem, target)
    half, whole = (
        vibration.run(problem, structures.structure_of(target, part * highest, problem.scales.time), tolerance, limit)
        for part in (0.5, 1.0)
    )
    found = differences(problem, half.summary, whole.summary)
    change = max(float(found[name]) for name in ("maximum_force", "maximum_indentation"))
    return error_of(problem.law.damped, 0.0, change) > scene.effect_tolerance

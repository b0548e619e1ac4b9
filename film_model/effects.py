"""Which effects a scene calls for, each with the number that decides.

An effect that can be computed is tried: the impact is marched on a coarse mesh with it and without it, and the
largest relative difference of the two summaries (:func:`change`) is what leaving it out would change. "auto"
computes it if that is more than the scene's tolerance. Effects that cannot be computed are judged by formulas
(:mod:`film_model.limits`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple, cast

from film_model.accuracy import unloading_ratio
from film_model.bodies import STANDARD_GRAVITY, Beam, Body, HalfSpace, Plate
from film_model.core import native
from film_model.laws import LAWS, AbstractLaw, BrakeUnloading, Retrace
from film_model.laws.hertz import Hertz, hertz_stiffness
from film_model.laws.law import Stage, law_fields
from film_model.laws.yielding import yield_point, yield_velocity
from film_model.problem import Problem, assemble
from film_model.scene import Scene

SIMULATED, NOT_NEEDED, SWITCHED_OFF = "simulated", "not needed", "switched off"
NOT_MODELLED, NOT_JUDGED = "needed but not modelled", "not judged"

FREE = "none"
"""Cost of an effect that takes no lines: what is not computed, and what comes with the contact law."""

DAMPED, PUSHED = "each about 3.5 × as long", "each about 2 × as long"
"""What a line of the core takes with target motion, and with a load, as `benchmarks/effects.py` measures it."""

SPRUNG = "each about 5 × as long"
"""What a line takes in series with a spring, on a target that is otherwise fixed."""

INTEGRATED = "no lines: the modes are integrated, thousands of times as long"

FULLY_PLASTIC_RATIO = 200.0
"""V/V_Y of a half-space impact that reaches full plasticity: 200.6 by Stronge's law, 201.3 by Big-Alabo's."""

COMPUTED = {
    "plasticity": 'the contact yields: for law "auto", big-alabo instead of hertz',
    "fully_plastic": "the contact reaches the last stage of a law that yields",
    "target_motion": "the target moves away: by its impedance, its static stiffness or its vibrations",
    "boundary_reflections": "waves come back from the edges of a plate or beam before contact ends",
    "target_inertia": "a plate or beam with edges vibrates, and does not give way by its static stiffness alone",
    "gravity": "the impactor's weight presses on the contact",
}
"""Effects that are computed, and what they are; they come before those that are judged."""

_ORDER = {name: k for k, name in enumerate(COMPUTED)}

DEEPEST = 3000.0
"""Indentation, in those at yield, beyond which no stage before the last is stretched to compare with."""

TRIAL = 16
"""Segments a stage of the trial marches; their errors, some 1e-5, are alike with and without an effect."""

FIRST_ORDER_LOSS = 2 * 1.730173
"""Energy an elastic impact loses to target motion, over Zener's λ, as λ → 0: e = 1 − 1.730173 λ."""


class Effect(NamedTuple):
    """One effect: what was measured, against what, and what came of it.

    value: of the indicator, threshold: that of it which matters, None where there is none. change: largest relative
    change of the summary if the effect is left out, None if it is not known. state: "simulated", "not needed",
    "switched off" (by the scene), "needed but not modelled" or "not judged" (the scene lacks what it takes; `reason`
    says what). source: of indicator and change. cost: of simulating it.
    """

    name: str
    indicator: str
    value: float | None
    threshold: float | None
    change: float | None
    state: str
    reason: str
    source: str
    cost: str = FREE

    @property
    def simulated(self) -> bool:
        """Whether the run includes it."""
        return self.state == SIMULATED

    @property
    def warning(self) -> str | None:
        """What every output says of an effect that matters and is not computed."""
        if self.state != NOT_MODELLED:
            return None
        size = "by an amount that is not known" if self.change is None else f"by about {percent(self.change)}"
        return f"not modelled: {self.name.replace('_', ' ')}, which would change the summary {size}; {self.reason}"

    def to_json(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return self._asdict()


class Support(NamedTuple):
    """How a target gives way: impedance [N s/m], and compliance [m/N] where it follows the force statically.

    vibrates: by its natural vibrations instead; impedance or compliance are then those it is tried with.
    """

    impedance: float
    compliance: float = 0.0
    vibrates: bool = False

    @property
    def how(self) -> str:
        """In words."""
        if self.vibrates:
            return "vibrates between its edges"
        if self.compliance > 0.0:
            return f"has a static stiffness of {1 / self.compliance:.4g} N/m"
        return f"has an impedance of {self.impedance:.4g} N s/m"


RIGID = Support(math.inf)


class Trial(NamedTuple):
    """One impact on a coarse mesh. status: the core's, negative where it could not follow."""

    problem: Problem
    status: int
    summary: native.Summary

    @property
    def ends(self) -> bool:
        """Whether the contact ends, so that there is a whole impact to judge by."""
        return self.status == native.EVENT


@dataclass(frozen=True)
class Shortened(AbstractLaw):
    """A law whose last stage never begins: the one before goes on, to `end`."""

    name: ClassVar[str] = "shortened"
    summary: ClassVar[str] = "another law without its last stage"
    source: ClassVar[str] = ""

    law: AbstractLaw
    end: float

    def scales(self, energy: float) -> tuple[float, float]:
        return self.law.scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        *_, last, _ = stages = self.law.stages()
        return (*stages[:-2], replace(last, end=self.end))


def percent(change: float) -> str:
    """0.0123 → "1.2 %"."""
    return f"{100 * change:.2g} %" if change < 0.995 else "100 % or more"


def choose(scene: Scene, notes: list[Effect] | None = None) -> Problem:
    """The problem a scene comes down to: law, how the target gives way, and load.

    notes: takes the effects that decided, and those that are only judged; without it nothing is computed that no
    decision hangs on.
    """
    law, yields = _law(scene)
    support, edges = RIGID if scene.effects.target_motion is False else Support(scene.target_impedance), ()
    if isinstance(scene.target, Plate | Beam):
        from film_model.edges import edged, support_of

        if edged(scene):
            support, edges = support_of(scene, law)
    trial = _gravity(scene, assemble(scene, law, support.impedance, 0.0, support.compliance), notes)
    moved = trial
    if support != RIGID or notes is not None:
        trial = _target_motion(scene, trial, support, notes)
    held = trial is not moved
    if (yields and scene.contact.law == "auto" and scene.effects.plasticity == "auto") or notes is not None:
        trial = _plasticity(scene, trial, yields, notes)
    if notes is not None:
        from film_model.limits import judge

        why = "the target hardly gives way"
        notes.extend(effect._replace(state=NOT_NEEDED, reason=why, cost=FREE) if held else effect for effect in edges)
        known = {effect.name for effect in edges}
        notes.extend(effect for effect in judge(scene, trial) if effect.name not in known)
    if support.vibrates and not held:
        problem = trial.problem
        return assemble(scene, problem.law, math.inf, problem.load * problem.scales.force, vibrates=True)
    return trial.problem


def effects_of(scene: Scene) -> tuple[Effect, ...]:
    """The effects of a scene, in the order of :data:`COMPUTED`."""
    notes: list[Effect] = []
    choose(scene, notes)
    return tuple(sorted(notes, key=lambda effect: _ORDER.get(effect.name, len(_ORDER))))


def change(full: Trial, without: Trial) -> float | None:
    """Largest relative difference of two summaries; None where one could not be marched, 1 where one has no end.

    Force, indentation and times count against the values of `full`, dents against its maximum indentation,
    velocities against the approach velocity, energies against the impact energy.
    """
    if full.status < 0 or without.status < 0:
        return None
    if full.ends != without.ends:
        return 1.0
    a, b, p, q = full.summary, without.summary, full.problem, without.problem
    length, force = q.scales.length / p.scales.length, q.scales.force / p.scales.force
    time, speed, energy = q.scales.time / p.scales.time, q.scales.velocity / p.scales.velocity, length * force
    off = [
        _relative(b.maximum_force * force, a.maximum_force),
        _relative(b.maximum_indentation * length, a.maximum_indentation),
        _relative(b.time_of_maximum_indentation * time, a.time_of_maximum_indentation),
    ]
    if full.ends:
        impact = 0.5 * p.approach**2
        off += [
            _relative(b.contact_duration * time, a.contact_duration),
            abs(b.permanent_indentation * length - a.permanent_indentation) / a.maximum_indentation,
            abs(b.final_velocity * speed - a.final_velocity) / p.approach,
            abs(b.work * energy - a.work) / impact,
        ]
        if p.gamma > 0.0 or q.gamma > 0.0:
            off.append(abs(_radiated(without) * energy - _radiated(full)) / impact)
    return max(off)


def _relative(value: float, to: float) -> float:
    """Relative difference; 1 where only one of the two has happened."""
    if value == to:
        return 0.0
    return abs(value / to - 1.0) if to > 0.0 and value >= 0.0 else 1.0


def _radiated(trial: Trial) -> float:
    """Energy that went into target motion, in the core's units."""
    s, p = trial.summary, trial.problem
    weight = p.load * (s.permanent_indentation + s.shift)
    return 0.5 * (p.approach**2 - s.final_velocity**2) - s.work + weight


def march(problem: Problem) -> Trial:
    """The problem on the trial mesh."""
    mesh = native.mesh(native.WORK_PRESERVING, TRIAL, unloading_ratio(problem.curve) * TRIAL)
    return Trial(problem, *native.impact(problem.curve.native, mesh, problem.start))


def _other(scene: Scene, trial: Trial, **changed: Any) -> Trial:
    """The trial again with another law, impedance, load or compliance."""
    problem = trial.problem
    now: dict[str, Any] = {
        "law": problem.law,
        "impedance": problem.impedance,
        "load": problem.load * problem.scales.force,
        "compliance": problem.compliance,
    }
    return march(assemble(scene, **(now | changed)))


_FROM_SCENE = {
    "effective_modulus": "effective_modulus",
    "radius": "effective_radius",
    "yield_strength": "yield_strength",
    "poissons_ratio": "poissons_ratio",
}
"""Fields of laws that the scene fills, and its properties that do."""


def law_values(scene: Scene, law: type[AbstractLaw]) -> dict[str, Any]:
    """The values a law takes from the scene, by its fields; its own parameters, if it is the scene's law."""
    filled = {field: getattr(scene, _FROM_SCENE[field]) for field in law_fields(law) if field in _FROM_SCENE}
    return filled | (dict(scene.contact.parameters) if scene.contact.law == law.name else {})


def _named_law(scene: Scene, name: str) -> AbstractLaw:
    """The named law with its values from the scene."""
    return reopened(scene, LAWS[name](**law_values(scene, LAWS[name])))


def reopened(scene: Scene, law: AbstractLaw) -> AbstractLaw:
    """The law with the unloading rule of [contact], or its default one."""
    rule, modulus = scene.contact.unloading_name, scene.effective_modulus
    if rule == "retrace":
        return Retrace(law)
    if rule == "brake":
        assert modulus is not None
        return BrakeUnloading(law, modulus, scene.effective_radius)
    return law


def reaches_yield(scene: Scene) -> Any:
    """Whether the impact reaches the yield point, for each row of a scene of columns; None where that is not known.

    W(δ_y) = 0.4 F_y δ_y is what an elastic contact has taken up there, of the impact energy and the weight's work.
    """
    strength, modulus = scene.yield_strength, scene.effective_modulus
    if strength is None or modulus is None:
        return None
    indentation, force = yield_point(modulus, scene.effective_radius, strength)
    heavy = scene.effects.gravity is not False and not isinstance(scene.target, Body)
    weight = scene.effective_mass * STANDARD_GRAVITY if heavy else 0.0
    return scene.kinetic_energy + weight * indentation > 0.4 * force * indentation


def _law(scene: Scene) -> tuple[AbstractLaw, bool | None]:
    """The law before its plasticity is judged, and whether its materials yield (None: no yield strength is known)."""
    wanted, law, yields = scene.effects.plasticity, scene.contact.law, reaches_yield(scene)
    if law != "auto":
        return (reopened(scene, law) if isinstance(law, AbstractLaw) else _named_law(scene, law)), yields
    plastic = wanted is True or (wanted is not False and yields is True)
    return _named_law(scene, "big-alabo" if plastic else "hertz"), yields


def _plasticity(scene: Scene, trial: Trial, yields: bool | None, notes: list[Effect] | None) -> Trial:
    """The trial with the law "auto" comes down to."""
    wanted, law, tolerance = scene.effects.plasticity, trial.problem.law, scene.effect_tolerance
    modulus, auto = scene.effective_modulus, scene.contact.law == "auto"
    core = trial.problem.curve.native
    yielding = any(core.stage[k].unloading != native.RETRACE for k in range(core.stages))
    plastic, elastic = (trial, None) if yielding else (None, trial)
    if modulus is not None and yields is not False:
        if elastic is None:
            elastic = _other(scene, trial, law=Hertz(modulus, scene.effective_radius))
        elif yields:
            plastic = _other(scene, trial, law=_named_law(scene, "big-alabo"))
    size = 0.0 if yields is False else None
    if plastic is not None and elastic is not None and yields is not False:
        size = change(plastic, elastic)
    dropped = auto and wanted == "auto" and yielding and size is not None and size <= tolerance
    if notes is not None:
        strength, ratio, limit = scene.yield_strength, None, 0.0
        if strength is not None and modulus is not None:
            limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
            ratio = scene.approach_velocity / limit
        if not auto:
            small = size is not None and size <= tolerance
            state = SIMULATED if yielding else NOT_NEEDED if small else SWITCHED_OFF
            reason = f"the scene asks for the law {law.name}"
        elif wanted is False:
            state, reason = SWITCHED_OFF, "the scene asks for no plasticity: law hertz"
        elif yields is None:
            state, reason = NOT_JUDGED, "missing: a yield strength; law hertz"
        elif dropped:
            state = NOT_NEEDED
            reason = f"beyond the yield velocity {limit:.4g} m/s, but by less than the tolerance: law hertz"
        elif yielding:
            state, reason = SIMULATED, f"the yield velocity is {limit:.4g} m/s: law big-alabo"
        else:
            state, reason = NOT_NEEDED, f"the impact stays below the yield velocity {limit:.4g} m/s: law hertz"
        cost = FREE
        if plastic is not None and elastic is not None and 0 < elastic.summary.lines < plastic.summary.lines:
            cost = f"{plastic.summary.lines / elastic.summary.lines:.2g} × the lines"
        source = "Big-Alabo, Cartmell & Harrison 2017, after (19): p_m = 1.1 S_y; marched with the law and with Hertz's"
        notes.append(Effect("plasticity", "V/V_Y", ratio, 1.0, size, state, reason, source, cost))
        notes.append(_fully_plastic(scene, trial, yielding, ratio))
    return cast("Trial", elastic) if dropped else trial


def _fully_plastic(scene: Scene, trial: Trial, yielding: bool, ratio: float | None) -> Effect:
    """Whether the contact reaches the law's last stage, and what the law would give if the one before went on."""
    curve = trial.problem.curve

    def effect(state: str, size: float | None, reason: str) -> Effect:
        source = "Stronge 2000: V/V_Y = 200.6; Big-Alabo's law: 201.3; marched with the last stage and without"
        return Effect("fully_plastic", "V/V_Y", ratio, FULLY_PLASTIC_RATIO, size, state, reason, source)

    if not yielding and ratio is None:
        return effect(NOT_JUDGED, None, "missing: a yield strength")
    if not yielding:
        late = ratio is not None and ratio > FULLY_PLASTIC_RATIO
        return effect(SWITCHED_OFF if late else NOT_NEEDED, None if late else 0.0, "the law does not yield")
    if curve.stage_names[-1] != "fully plastic":
        return effect(NOT_JUDGED, None, f"the law {trial.problem.law.name} has no fully plastic stage of its own")
    if trial.summary.stage != curve.native.stages - 1:
        return effect(NOT_NEEDED, 0.0, "the contact does not get that far")
    depth, size = trial.summary.maximum_indentation, None
    if depth < DEEPEST:
        end = 10.0 ** math.ceil(math.log10(depth) + 0.5)  # a power of ten: few curves have to be made
        size = change(trial, _other(scene, trial, law=Shortened(trial.problem.law, end)))
    return effect(SIMULATED, size, "it is a stage of the law")


def _target_motion(scene: Scene, trial: Trial, support: Support, notes: list[Effect] | None) -> Trial:
    """The trial with the target's motion, or without where it hardly matters."""
    target, wanted, tolerance = scene.target, scene.effects.target_motion, scene.effect_tolerance
    size, cost, held, value, gives = None, FREE, trial, None, not isinstance(target, Body | HalfSpace)
    if not gives:
        state, size, value = NOT_NEEDED, 0.0, 0.0
        reason = "the target moves freely: reduced mass" if isinstance(target, Body) else "the target is a half-space"
    elif wanted is False:
        state, reason = SWITCHED_OFF, "the scene asks for a target that does not move"
    else:
        state, reason = SIMULATED, f"the target {support.how}"
    if gives and scene.approach_velocity > 0.0 and (wanted == "auto" or notes is not None):
        moved = trial
        if wanted is False:
            own = target.compliance if isinstance(target, Beam) else 0.0
            moved = _other(scene, trial, impedance=scene.target_impedance, compliance=own)
        else:
            held = _other(scene, trial, impedance=math.inf, compliance=0.0)
        size = change(moved, held)
        each = SPRUNG if moved.problem.compliance > 0.0 else DAMPED
        cost = f"{moved.summary.lines / max(held.summary.lines, 1):.2g} × the lines, {each}"
        if support.vibrates:
            cost = INTEGRATED
    asked = scene.effects.boundary_reflections is True or scene.effects.target_inertia is True
    dropped = wanted == "auto" and not asked and gives and size is not None and size <= tolerance
    if notes is not None:
        if dropped:
            state, reason = NOT_NEEDED, f"a target that {support.how} hardly gives way"
        if math.isfinite(scene.target_impedance):
            value = zener(scene, scene.target_impedance)
        source = "Zener 1941, Phys. Rev. 59:669; marched with the target's motion and without"
        threshold = tolerance / FIRST_ORDER_LOSS
        notes.append(Effect("target_motion", "Zener's λ", value, threshold, size, state, reason, source, cost))
    return held if dropped else trial


def zener(scene: Scene, impedance: float) -> float | None:
    """λ = K^{2/5} m^{3/5} V^{1/5}/Z (Zener 1941), for the elastic contact; None where there is no Hertz stiffness."""
    if scene.effective_modulus is None:
        return None
    stiffness = hertz_stiffness(scene.effective_modulus, scene.effective_radius)
    return stiffness**0.4 * scene.effective_mass**0.6 * scene.approach_velocity**0.2 / impedance


def gravity_change(weight: Any, force: Any, indentation: Any, energy: Any) -> Any:
    """Relative change of the summary by a weight [N] on a target that does not move; floats or arrays.

    By the balance of energy, W(δ) = ½ m V² + m g δ, δ_m grows by m g/F_m and F_m by d ln F/d ln δ times that; for a
    power law F ∝ δ^q the exponent is q = F_m δ_m/W − 1. First order in m g/F_m.
    """
    exponent = force * indentation / energy - 1.0
    return weight / force * (exponent + abs(exponent - 1.0) + 1.0) / 2.0  # the larger of 1 and q


def _gravity(scene: Scene, chosen: Problem, notes: list[Effect] | None) -> Trial:
    """The trial of a problem without its weight, or with it if that matters."""
    weight, wanted, tolerance = scene.effective_mass * STANDARD_GRAVITY, scene.effects.gravity, scene.effect_tolerance
    free = isinstance(scene.target, Body)
    trial, pressed = march(chosen), None
    ratio, size, source = None, None, "balance of energy, to first order in m g/F_m"
    if free:
        ratio = size = 0.0
    elif trial.ends:
        force = trial.summary.maximum_force * chosen.scales.force
        ratio = weight / force
        if chosen.gamma == 0.0:
            depth = trial.summary.maximum_indentation * chosen.scales.length + chosen.compliance * force
            size = gravity_change(weight, force, depth, scene.kinetic_energy)
        if (size is None or size > 0.3 * tolerance) and (wanted == "auto" or notes is not None):
            pressed = _other(scene, trial, load=weight)
            size, source = change(pressed, trial), "marched with the weight and without"
    heavy = not free and wanted is not False and (wanted is True or size is None or size > tolerance)
    if heavy and pressed is None:
        pressed = _other(scene, trial, load=weight)
    if notes is not None:
        state = SIMULATED if heavy else SWITCHED_OFF if wanted is False and not free else NOT_NEEDED
        reason = "both bodies fall alike" if free else "the weight is small against the contact force"
        if state == SWITCHED_OFF:
            reason = "the scene asks for no gravity"
        elif heavy:
            reason = "the scene asks for it" if wanted is True else "the weight is not small against the contact force"
        if pressed is not None and pressed.status >= 0 and not pressed.ends:
            reason += "; the ball comes to rest on the target"
        cost = FREE if free else f"1 × the lines, {PUSHED}"
        notes.append(Effect("gravity", "m g/F_m", ratio, tolerance / 1.5, size, state, reason, source, cost))
    return cast("Trial", pressed) if heavy else trial

"""The formulas of the page: recorded from those of :mod:`film_model.problem` and :mod:`film_model.effects`.

`n` are the numbers of a scene, `p` those of a problem (scales, starting values), `a` and `b` the core's summaries.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, ClassVar, cast

import numpy as np
from numpy.polynomial import chebyshev

from film_model.base.arrays import either, logarithm
from film_model.base.rate_law import RateHardening
from film_model.core import native
from film_model.effects import edge_effects, gravity, large_slope, wave_losses
from film_model.effects.case import Pulse, deforms
from film_model.effects.material_damping import rebound
from film_model.effects.rate_hardening import factor_at
from film_model.explorer.inputs import PLATE
from film_model.explorer.trace import Recording
from film_model.laws.example_ball import example_ball
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import AbstractLaw, Stage, law_fields
from film_model.laws.yielding import yield_velocity
from film_model.problem.brittle import factors
from film_model.problem.curve import Curve
from film_model.problem.families import EDGES, varying
from film_model.problem.fit import functions_of
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.model_intervals import family_number, yield_velocities
from film_model.problem.numbers import Numbers, zener
from film_model.problem.problem import Given, Impacts, Problem, Trial
from film_model.problem.scales import Scales, motion_of
from film_model.problem.summary import gains_energy, gains_from_weight, summary_of
from film_model.scene import Effects, Scene
from film_model.scene.columns import scene_of_columns
from film_model.solve import mode_formulas
from film_model.targets import AbstractTarget

FROM_SCENE = (
    *("effective_modulus", "effective_radius", "yield_strength", "flow_strength", "strain_hardening_exponent"),
    *("poissons_ratio", "elastic_share", "softer_curvature", "slope_coefficient", "stressed_poissons_ratio"),
)
"""Properties of a scene, besides its :class:`Numbers`, that laws take."""

RATE_LAW = tuple(f"rate_{name}" for name in RateHardening._fields)
"""Names of the numbers of a :class:`RateHardening`; its coefficient is nan or infinite if it is unknown."""

LEAST_RESTITUTION = 0.1
"""Of a damped law on the page: below it, the series for its damping converges slowly."""

_SCALES = Scales._fields
_OF_LAW = ("widening", "elastic_share", "softer_curvature", "strain_hardening_exponent", "yield_strength")
_PROBLEM = ("gamma", "load", "damping", "approach", "drift", "share", "mass")
_START = ("approach", "gamma", "load", "stop_velocity", "limit", "damping")


@dataclass(frozen=True)
class Scaled(AbstractLaw):
    """The stages of one law with the scales of another: of the same law, with unknown values."""

    name: ClassVar[str] = "scaled"
    summary: ClassVar[str] = "the stages of one law, the scales of another"
    source: ClassVar[str] = ""
    damped: ClassVar[bool] = True

    staged: AbstractLaw
    scaling: AbstractLaw
    damping: Any = 1.0
    """Damping over that of `scaling`."""

    def scales(self, energy: float) -> tuple[float, float]:
        return self.scaling.scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        return self.staged.stages()

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        return self.damping * self.scaling.damping_factor(mass, velocity, length)


def numbers_function(template: Scene, paths: Sequence[str]) -> str:
    """The numbers of a scene from its entries `x`, by path. `template` has the entries that are fixed."""
    recording = Recording()
    scene = changed_scene(template, recording.symbols("x", paths))
    numbers = Numbers.of(replace_effects(scene, Effects()), None)
    outputs: dict[str, Any] = {**numbers._asdict(), "weight": numbers.weight}
    outputs |= {"impactor_mass": scene.mass, "target_mass": scene.target.own_mass, "speed": scene.impactor.speed}
    outputs |= {entry: getattr(scene, entry) for entry in FROM_SCENE}
    outputs["able"] = scene.can_yield
    outputs["yields"] = replace_effects(scene, Effects()).reaches_yield
    outputs["yields_light"] = replace_effects(scene, Effects(gravity=False)).reaches_yield
    outputs["loss_restitution"] = scene.loss_restitution
    outputs["waves"], outputs["waves_yielding"] = (wave_losses.impedance_of(scene, yields) for yields in (False, True))
    outputs["waves_most"] = wave_losses.largest_share(scene, outputs["waves"])
    outputs["waves_most_yielding"] = wave_losses.largest_share(scene, outputs["waves_yielding"])
    outputs |= {"zener": zener(scene, numbers.impedance), "heaviest": wave_losses.heaviest(scene)}
    outputs |= {f"steep{k}": large_slope.change_of(scene, k * numbers.weight) for k in (0, 1)}
    outputs |= {"family": family_number(scene), "yield_velocities": yield_velocities(scene)}
    for body in ("impactor", "target"):
        outputs[f"pressing_{body}"], outputs[f"cracking_{body}"] = factors(getattr(scene, body).material)
    rate = [math.nan] * len(RATE_LAW) if scene.rate_hardening is None else scene.rate_hardening
    outputs |= dict(zip(RATE_LAW, rate, strict=True))
    outputs["yield_velocity"] = math.nan
    if scene.yield_strength is not None and scene.effective_modulus is not None:
        given = scene.effective_modulus, scene.effective_radius, scene.yield_strength, scene.effective_mass
        outputs["yield_velocity"] = yield_velocity(*given)
    known = {entry: math.nan if value is None else value for entry, value in outputs.items()}
    return recording.function("numbers", "x", known)


def changed_scene(template: Scene, x: Mapping[str, Any]) -> Scene:
    """The scene with entries by path. A hardness is that of the yield strength: see `plain_formulas.PLAIN`."""
    return scene_of_columns(template, {path: value for path, value in x.items() if not path.endswith(".hardness")})


def replace_effects(scene: Scene, effects: Effects) -> Scene:
    """The scene, whose numbers may be symbols, with other effects."""
    return scene_of_columns(scene, cast("Any", {"effects": effects}))


def problem_function(template: Scene, law: AbstractLaw, fixed: frozenset[str], live: Sequence[str]) -> str:
    """Scales and starting values under a law, for a target impedance and a load.

    fixed: values that the law does not take from `n`. live: its own parameters that it takes from there.
    """
    recording = Recording()
    unknown = law_symbols(recording, law, fixed, live)
    damping: Any = 1.0
    if "restitution" in live:
        damping = _damping_over(law, recording.symbol(own_entry("restitution")))
    impacts = Impacts(
        template,
        SceneLaw(Scaled(law, unknown, damping), {}, None, {}),
        Numbers(**recording.symbols("n", Numbers._fields)),
        template,
    )
    problem = impacts.problem(recording.symbol("impedance"), recording.symbol("load"))
    outputs = {entry: getattr(problem.scales, entry) for entry in (*_SCALES, "energy")}
    outputs |= {entry: getattr(problem, entry) for entry in (*_PROBLEM, *_START)}
    own: Any = getattr(unknown, "law", unknown)  # the law below a rule of unloading
    outputs |= {entry: getattr(own, entry, 0.0) for entry in _OF_LAW}
    outputs["stop_velocity"] = replace(problem, free=True).stop_velocity  # -0 with the drift 0 of other targets
    return recording.function("problem", "n, impedance, load", outputs)


def example_function(law: type[AbstractLaw]) -> str:
    """The required parameters that a law derives from the values of a scene."""
    recording = Recording()
    names = ("effective_modulus", "effective_radius", "flow_strength", "poissons_ratio", "mass", "approach")
    numbers = recording.symbols("n", names)
    given = law.example(example_ball(*(cast("Any", numbers[name]) for name in names)))
    return recording.function("example", "n", {f"own_{key}": value for key, value in given.items()})


def own_entry(name: str) -> str:
    """The JavaScript of a law's own parameter."""
    return f'n["own_{name}"]'


def shape_functions(law: AbstractLaw, fixed: frozenset[str]) -> tuple[str, str]:
    """Of a law with a shape: the shape and the end of the last stage; the functions of that stage that depend on the
    shape, at the indentation w."""
    recording = Recording()
    unknown = law_symbols(recording, law, fixed)
    last = unknown.stages()[-1]
    shape = recording.function("lastShape", "n", {"shape": unknown.shape, "end": last.end})
    functions: Any = functions_of(last)
    values = {each: functions[each](recording.symbol("w")) for each in varying_of(law)}
    return shape, recording.function("lastValues", "n, w", values)


def varying_of(law: AbstractLaw) -> tuple[str, ...]:
    """The functions of the last stage of a law with a shape that depend on it."""
    one, other = (law.of_shape(shape).stages()[-1] for shape in (EDGES[2], EDGES[3]))
    return varying((one, other))


def law_symbols(recording: Recording, law: AbstractLaw, fixed: frozenset[str], live: Sequence[str] = ()) -> AbstractLaw:
    """The law with symbols in place of the values that it takes from the scene, except the `fixed` ones, and of its own
    `live` parameters, except a restitution: the damping that it gives is found by iteration."""
    made = object.__new__(type(law))
    for name, value in vars(law).items():
        unknown = value
        if isinstance(value, AbstractLaw):
            unknown = law_symbols(recording, value, fixed, live)
        elif name in live and name != "restitution":
            unknown = recording.symbol(own_entry(name))
        elif entry_of(name, type(law)) in FROM_SCENE and name not in fixed:
            unknown = recording.symbol(f'n["{entry_of(name, type(law))}"]')
        object.__setattr__(made, name, unknown)
    return made


def entry_of(name: str, law: type[AbstractLaw]) -> str:
    """The property of a scene from which a field of a law is filled."""
    flows = name == "yield_strength" and "strain_hardening_exponent" not in law_fields(law)
    return {"radius": "effective_radius"}.get(name, "flow_strength" if flows else name)


def _damping_over(law: AbstractLaw, restitution: Any) -> Any:
    """The damping that gives a restitution, over that of the law: a series in its logarithm, with an error of 1e-13."""
    least = math.log(LEAST_RESTITUTION)

    def relative(places: Any) -> Any:
        changed = [replace(cast("Any", law), restitution=math.exp(0.5 * least * (1.0 - x))) for x in places]
        return np.array([each.damping_factor(1.0, 1.0, 1.0) for each in changed]) / law.damping_factor(1.0, 1.0, 1.0)

    factor = chebyshev.chebval(1.0 - 2.0 * logarithm(restitution) / least, chebyshev.chebinterpolate(relative, 31))
    return either(restitution < 1.0, factor, 0.0)


def problem_in(
    recording: Recording, owner: str, template: Scene, damped: bool = False, vibrates: bool = False
) -> Problem:
    """A problem whose numbers are those of the object `owner`. damped: under a damped law. vibrates: on modes."""
    scales = Scales(**cast("Any", recording.symbols(owner, _SCALES)))
    curve = Curve(native.Curve(), (), 0.0, 0.0, "", ())
    numbers = recording.symbols("n", FROM_SCENE)
    varied: Any = SimpleNamespace(**numbers)
    varied.nose = varied.oval = None
    varied.hertz_stiffness = hertz_stiffness(varied.effective_modulus, varied.effective_radius)
    varied.rate_hardening = RateHardening(
        **{name.removeprefix("rate_"): n for name, n in recording.symbols("n", RATE_LAW).items()}
    )
    own = recording.symbols(owner, _OF_LAW)
    strength = either(own["yield_strength"] > 0.0, own["yield_strength"], numbers["yield_strength"])
    own["yield_strength"] = either(strength < math.inf, strength, math.nan)  # a missing entry is infinite in formulas
    law = SceneLaw(cast("Any", None), own, None, {})
    impacts = Impacts(template, law, Numbers(**recording.symbols("n", Numbers._fields)), varied)
    values: dict[str, Any] = {
        **recording.symbols(owner, _PROBLEM),
        "given": Given(1.0, 0.0, 0.0),
        "loaded": True,
        "damping": float(damped),
    }
    return Problem(impacts, cast("Any", None), curve, scales, **values, free=template.target.free, vibrates=vibrates)


class _Core:
    """The core's summary, with symbols."""

    def __init__(self, recording: Recording, owner: str) -> None:
        self.__dict__ |= recording.symbols(owner, native.SUMMARY)


def _tried(recording: Recording, owner: str, core: str, template: Scene) -> Problem:
    """A problem with the result of its trial, which the object `core` has, with a `status`."""
    problem = problem_in(recording, owner, template)
    status = recording.symbol(f"{core}.status")
    problem.__dict__["trial"] = Trial(status, _Core(recording, core), status == native.EVENT)
    return problem


def result_functions(suffix: str, template: Scene) -> list[str]:
    """Summary and motion in SI, for a free target or for the others."""
    r, functions = Recording(), list[str]()
    for damped in (False, True):
        outputs = summary_of(problem_in(r, "p", template, damped), r.symbol("a.status"), _Core(r, "a"))
        functions.append(r.function(f"summary{suffix}{'Damped' * damped}", "p, a, n", outputs))
    p, values = problem_in(r, "p", template), [r.symbol(f"v[i + {k}]") for k in range(5)]
    motion = motion_of(p.scales, p.drift, p.share, p.free, r.symbol("t"), values)
    return [*functions, r.function(f"motion{suffix}", "p, t, v, i", motion)]


def warning_function(template: Scene) -> str:
    """Whether an impact of the summary `s` gains energy, from its law and its weight."""
    r = Recording()
    p, summary = problem_in(r, "p", template), r.symbols("s", ("coefficient_of_restitution", "energy_absorbed"))
    gains = {"law": gains_energy(p, summary["energy_absorbed"]), "weight": gains_from_weight(p, summary)}
    return r.function("gains", "p, s", gains)


def vibrating_functions(template: Scene) -> list[str]:
    """Of an impact on a target that vibrates: the summary, with damping of the law and without, the energy given to it,
    and the formulas of :mod:`film_model.solve.mode_formulas`."""
    r, functions = Recording(), list[str]()
    for damped, word in ((False, ""), (True, "Damped")):
        problem, core = problem_in(r, "p", template, damped, vibrates=True), _Core(r, "a")
        outputs = summary_of(problem, r.symbol("a.status"), core)
        functions.append(r.function(f"summaryVibrating{word}", "p, a, n", outputs))
    problem, core = problem_in(r, "p", template), _Core(r, "a")
    limit, least = mode_formulas.following(problem, core, r.symbol("compliance"), r.symbol("lowest"))
    functions.append(r.function("following", "p, a, compliance, lowest", {"limit": limit, "least": least}))
    energy = mode_formulas.transferred(problem, core, r.symbol("damped"), r.symbol("energy"))
    return [*functions, r.function("transferred", "p, a, damped, energy", {"energy": energy})]


def hardening_functions(template: Scene) -> list[str]:
    """Of the impact `p`, `a`: the strength at its strain rate over that of slow loading, whether something yields,
    the contact's compliance, whether its force is that of the impact `q`, `b` at least, and the velocity after it."""
    r = Recording()
    tried = _tried(r, "p", "a", template)
    factor = r.function("strengthFactor", "p, a, n", {"factor": factor_at(tried, *tried.trial[:2])})
    after = r.function("rebound", "p, a", {"velocity": rebound(tried)})
    soft = r.function("softness", "p, a", {"soft": edge_effects.softness(tried)})
    other = _tried(r, "q", "b", template)
    outputs = {"trusted": tried.trial.ends, "stiffer": edge_effects.stiffer(tried, other)}
    stiffer = r.function("stiffer", "p, a, q, b", outputs)
    yields = r.function("deforms", "p, a", {"yields": deforms(tried)})
    return [factor, yields, soft, stiffer, after]


def gravity_function(template: Scene) -> str:
    """The change of the summary by the weight: `q`, `b` without it. change: that of the marches with it and without."""
    r = Recording()
    size = gravity.sized(_tried(r, "q", "b", template), lambda: r.symbol("change"))
    return r.function("gravityChange", "q, b, n, change", {"change": size})


def plate_functions(template: Scene, paths: Sequence[str]) -> dict[str, str]:
    """Of a plate that may have edges, by what they compute.

    numbers: its mass per area, stiffnesses, those of shear, and the part of its mass [kg] that moves with the struck
    point. reflections: of :func:`reflections_function`. inertia: force of vibration over static force on the static
    `compliance` [m/N].
    """
    r = Recording()
    target: Any = _target(r, template, paths)
    d11, d12, d22, d66 = target.stiffness
    outputs = {"mass": target.surface_density, "d11": d11, "d12": d12, "d22": d22, "d66": d66}
    outputs |= dict(zip(("thickness", "softness", "bulge"), target.shear, strict=True))
    outputs["rate"] = 1.0 / target.longest_time
    outputs |= {"part": target.first_mode_share * target.whole_mass}
    found = {"numbers": r.function("numbers", "x", outputs)}
    found["reflections"] = reflections_function(template, paths)
    r = Recording()
    static = _tried(r, "p", "a", template)
    object.__setattr__(static, "given", Given(math.inf, 0.0, r.symbol("compliance")))
    outputs = {"ratio": edge_effects.vibration(static, r.symbol("part"))}
    return found | {"inertia": r.function("inertia", "p, a, n, compliance, part", outputs)}


def _target(recording: Recording, template: Scene, paths: Sequence[str]) -> AbstractTarget:
    """The target with symbols for its entries `x`, among them the sides and the struck point of a plate."""
    columns: dict[str, Any] = {**recording.symbols("x", [path for path in paths if path not in PLATE])}
    if PLATE[0] in paths:
        x = recording.symbols("x", PLATE)
        columns |= {"target.size": tuple(x[path] for path in PLATE[:2])}
        columns |= {"target.position": tuple(x[path] for path in PLATE[2:])}
    return changed_scene(template, columns).target


def reflections_function(template: Scene, paths: Sequence[str]) -> str:
    """The change by waves reflected from the edges of a plate: `p`, `a` on the infinite plate."""
    r = Recording()
    target = _target(r, template, paths)
    p, core = problem_in(r, "p", template), _Core(r, "a")
    pulse = Pulse.of(p.approach, p.gamma, core)
    delay = pulse.back / (target.return_time / p.scales.time)
    size = cast("Any", target).reflection_change(pulse.motion, pulse.restitution, delay)
    outputs = {"change": size, "matter": edge_effects.may_matter(size, r.symbol("tolerance"))}
    return r.function("reflections", "x, p, a, tolerance", outputs)

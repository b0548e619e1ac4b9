"""contact_for(engine, scene, velocity): the parameters with which an engine's contact law comes closest to our impacts.

The impacts are simulated without gravity at velocities evenly spaced on a logarithmic scale. The fit minimises the sum
of the squared relative errors of largest force, duration and restitution at all of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import STATUSES, VIBRATES, SimulationError
from film_model.effects.choose import choose
from film_model.problem.problem import refuse_relaxation
from film_model.scene import Scene, Sphere
from film_model.solve.batch import ManyResult, simulate_many
from film_model.studies.tangential_models import MODELS, groups, theory
from film_model.translate.law import Engine, EngineLaw, Middle, Pair, Parameter, Values
from film_model.translate.march import march

COMPARED = {"force": "maximum_force", "duration": "contact_duration", "restitution": "coefficient_of_restitution"}
"""What is compared, and its name in the summary of an impact."""

_SPAN = math.log(1e6)
"""A logarithmic parameter stays within this factor of its start."""


@dataclass(frozen=True)
class Error:
    """Relative errors of one compared value over the velocities: root mean square, and the worst and its velocity."""

    rms: float
    worst: float
    velocity: float


@dataclass(frozen=True)
class Tangential:
    """A model of friction beside our impacts: ψ₂ over ψ₁ of elastic impacts, up to where all slide throughout. rms,
    worst: of the difference in ψ₂; before: ψ₁ of the worst."""

    rms: float
    worst: float
    before: float


@dataclass(frozen=True)
class Translation:
    """A fitted law. values: parameters, SI. wanted, found: arrays over `velocities` by the names of `COMPARED`.
    tangential: the engine's models of friction by name, if the scene has friction."""

    engine: Engine
    law: EngineLaw
    pair: Pair
    values: Mapping[str, float]
    velocities: Array
    wanted: Mapping[str, Array]
    found: Mapping[str, Array]
    warnings: tuple[str, ...]
    tangential: Mapping[str, Tangential]

    @property
    def errors(self) -> dict[str, Error]:
        """What remains of each compared value."""
        made: dict[str, Error] = {}
        for name in COMPARED:
            relative = self.found[name] / self.wanted[name] - 1.0
            worst = int(np.abs(relative).argmax())
            made[name] = Error(
                math.sqrt(float(np.mean(relative**2))), float(relative[worst]), float(self.velocities[worst])
            )
        return made

    @property
    def rms(self) -> float:
        """Root mean square of all relative errors."""
        return math.sqrt(sum(error.rms**2 for error in self.errors.values()) / len(COMPARED))

    def paste(self) -> str:
        """Text for the engine's input."""
        return self.law.paste(self.pair, self.values)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, SI."""
        return {
            "engine": self.engine.name,
            "law": self.law.name,
            "formula": self.law.formula,
            "source": self.law.source,
            "parameters": {
                p.name: {"value": self.values[p.name], "units": p.unit or "1", "meaning": p.meaning}
                for p in self.law.parameters
            },
            "rms_error": self.rms,
            "errors": {name: vars(error) for name, error in self.errors.items()},
            "tangential": {name: vars(one) for name, one in self.tangential.items()},
            "velocities": self.velocities.tolist(),
            "wanted": {name: column.tolist() for name, column in self.wanted.items()},
            "found": {name: column.tolist() for name, column in self.found.items()},
            "paste": self.paste(),
            "notes": list(self.law.notes),
            "warnings": list(self.warnings),
        }


def contact_for(
    engine: Engine, scene: Scene, velocity: Sequence[Any] = (), *, law: str | None = None, count: int = 9
) -> list[Translation]:
    """The engine's laws, or one of them, fitted to the scene's impacts; the closest first.

    velocity: lowest and highest approach velocity, texts or quantities, numbers are m/s; default: half and twice the
    scene's. Raises ValueError for a bad range or an unknown law; SimulationError for a scene whose impacts an engine's
    law cannot reproduce: a vibrating target, or an impact that does not end by separation.

    With friction in [contact] the tangential springs have the stiffness K_t = K_n/κ of the scene, and how far each
    model of the engine is off in ψ₂(ψ₁) is computed. Angle and spin of the scene do not matter: velocities are normal.
    """
    laws = engine.laws if law is None else (engine.law(law),)
    velocities = _velocities(scene, velocity, count)
    result = _impacts(scene, velocities)
    wanted = {name: result.summary[key] for name, key in COMPARED.items()}
    middle = _middle(velocities, wanted, result.summary["maximum_indentation"])
    pair = pair_of(scene, math.sqrt(velocities[0] * velocities[-1]), middle.depth)
    warnings = _warnings(scene, velocities, result)
    models = _models(scene, {spring for one in laws for spring in one.tangential.values()})
    made = [_fitted(engine, one, pair, middle, velocities, wanted, warnings, models) for one in laws]
    return sorted(made, key=lambda translation: translation.rms)


def pair_of(scene: Scene, velocity: float, depth: float) -> Pair:
    """The scene's two bodies, as an engine sees them."""
    mass = scene.target.own_mass
    assert mass is not None
    if scene.target.radius < 0.0:
        raise SimulationError(f"target.radius: {scene.target.radius:g} m is a hollow, which engines do not have")
    if not scene.is_round:
        raise SimulationError("the contact is not that of balls, which is what engines have")
    ratio, friction, kappa = scene.poissons_ratio, scene.contact.one_friction("engines take"), 1.0
    if friction is not None:
        kappa = groups(scene).ratio
        ratio = (2.0 * kappa - 2.0) / (2.0 * kappa - 1.0)  # of alike bodies, κ = (2 − ν)/(2 (1 − ν))
    # only the effective modulus matters to an engine
    return Pair(
        mass=scene.effective_mass,
        radius=scene.effective_radius,
        ball_mass=scene.mass,
        ball_radius=scene.impactor.radius,
        target_mass=mass,
        target_radius=scene.target.radius,
        poissons_ratio=0.3 if ratio is None else ratio,
        velocity=velocity,
        depth=depth,
        friction=friction,
        ratio=kappa,
    )


def _models(scene: Scene, springs: set[str]) -> dict[str, Tangential]:
    """How far springs are off for the χ of the scene; none without friction."""
    if scene.contact.friction is None or not springs:
        return {}
    chi = groups(scene).parameter
    before = np.linspace(0.0, 4.0 * chi, 25 + 1)[1:]  # beyond 4χ all models slide
    exact, made = theory(scene, before), dict[str, Tangential]()
    for name in springs:
        off = MODELS[name](chi, before) - exact
        worst = int(np.abs(off).argmax())
        made[name] = Tangential(math.sqrt(float(np.mean(off**2))), float(off[worst]), float(before[worst]))
    return made


def _velocities(scene: Scene, given: Sequence[Any], count: int) -> Array:
    if not given:
        speed = scene.approach_velocity
        if not speed > 0.0:
            raise ValueError("velocity: the scene's is 0; give a range")
        given = (0.5 * speed, 2.0 * speed)
    try:
        low, high = (units.to_si(value, "velocity", bare=True) for value in (given[0], given[-1]))
    except ValueError as error:
        raise ValueError(f"velocity: {error}") from None
    most = Sphere.FIELDS["velocity"].high or math.inf
    if not 0.0 < low <= high <= most:
        raise ValueError(
            f"velocity: {low:g} to {high:g} m/s: must begin above 0, must not fall and must end by {most:g} m/s"
        )
    if not 2 <= count <= 1000:
        raise ValueError(f"count: {count} is out of range: from 2 to 1000")
    return np.geomspace(low, high, 1 if low == high else count)


def _impacts(scene: Scene, velocities: Array) -> ManyResult:
    """Our impacts, without weight: engines apply gravity themselves. Raises SimulationError."""
    least_restitution = 0.05  # near 0 an engine's law separates very late or not at all
    light = scene_at(scene, float(velocities[0]))
    result = simulate_many(light, {"impactor.velocity": velocities + scene.target.velocity})
    for problem in result.problems:
        refuse_relaxation(problem, "a contact law of an engine")
    status = result.status
    on_modes = (status >= 0) & (result.segments[:, 0] == 0)
    if (on_modes | (status == VIBRATES)).any():
        raise SimulationError(
            "the target vibrates between its edges, which no contact law of an engine can reproduce: model the "
            "structure in the engine, or set boundary_reflections = false in [effects]"
        )
    restitution = result.summary["coefficient_of_restitution"]
    bad = np.flatnonzero((status != 1) | ~(restitution >= least_restitution))
    if bad.size:
        first = int(bad[0])
        reason = f"the coefficient of restitution is {restitution[first]:.2g}, below {least_restitution}"
        if status[first] != 1:
            reason = STATUSES[int(status[first])].sentence
        raise SimulationError(f"at {velocities[first]:g} m/s: {reason}; all impacts must end in a rebound")
    return result


def scene_at(scene: Scene, velocity: float) -> Scene:
    """The scene at an approach velocity along the normal, without gravity and friction."""
    speed = f"{velocity + scene.target.velocity!r} m/s"
    normal = {"impactor.angle": None, "impactor.spin": None, "contact.friction": None}
    return scene.replace({**normal, "effects.gravity": False, "impactor.drop_height": None, "impactor.velocity": speed})


def _warnings(scene: Scene, velocities: Array, result: ManyResult) -> tuple[str, ...]:
    """What one set of parameters for a fixed target hides, and the warnings of the impacts at both ends."""
    found: list[str] = []
    if len(result.laws) > 1:
        found.append(f"the range needs several laws ({', '.join(result.laws)}): one set of parameters serves all")
    moved = np.nan_to_num(result.summary["energy_radiated"]).max()
    if moved > 0.0 and not scene.target.free:
        found.append("the target moves: the energy that it takes is put into the engine's contact with a fixed target")
    for velocity in dict.fromkeys((float(velocities[0]), float(velocities[-1]))):
        found += [f"at {velocity:g} m/s: {warning}" for warning in choose(scene_at(scene, velocity)).warnings]
    return tuple(found)


def _middle(velocities: Array, wanted: Mapping[str, Array], depths: Array) -> Middle:
    at = len(velocities) // 2
    force, duration, restitution = (float(wanted[name][at]) for name in COMPARED)
    return Middle(float(velocities[at]), force, duration, restitution, float(depths[at]))


class _Scale:
    """Fitted variables x of a law: ln of a logarithmic parameter, else the value over its size at the start."""

    def __init__(self, parameters: Sequence[Parameter], start: Mapping[str, float], depth: float) -> None:
        scaled = (replace(p, low=p.low * depth, high=p.high * depth) if p.per_depth else p for p in parameters)
        self.parameters = parameters = tuple(scaled)
        sizes = (1.0 if math.isfinite(p.high) else start[p.name] for p in parameters)
        self.sizes = [size if size > 0.0 else 1.0 for size in sizes]
        self.low, self.high = (
            np.array([self._x(p, getattr(p, end), i) for i, p in enumerate(parameters)]) for end in ("low", "high")
        )
        x = np.array([self._x(p, start[p.name], i) for i, p in enumerate(parameters)])
        spans = np.array([_SPAN if p.logarithmic else math.inf for p in parameters])
        self.low, self.high = np.maximum(self.low, x - spans), np.minimum(self.high, x + spans)
        margin = 1e-3 * np.where(np.isfinite(self.high - self.low), self.high - self.low, 1e-3)
        self.start = np.clip(x, self.low + margin, self.high - margin)

    def _x(self, parameter: Parameter, value: float, at: int) -> float:
        return math.log(value) if parameter.logarithmic else value / self.sizes[at]

    def values(self, x: Any) -> dict[str, Any]:
        """Parameters by name; x: one value, or one array, for each."""
        return {
            p.name: np.exp(x[i]) if p.logarithmic else np.clip(x[i] * self.sizes[i], p.low, p.high)
            for i, p in enumerate(self.parameters)
        }


def _fitted(
    engine: Engine,
    law: EngineLaw,
    pair: Pair,
    middle: Middle,
    velocities: Array,
    wanted: Mapping[str, Array],
    warnings: tuple[str, ...],
    models: Mapping[str, Tangential],
) -> Translation:
    """The law with its parameters fitted."""
    most_evaluations = 60  # it needs 5 to 30
    from scipy.optimize import least_squares

    scale = _Scale(law.parameters, law.start(pair, middle), middle.depth)
    count = len(law.parameters)

    def errors(values: Values, speeds: Array, copies: int) -> Array:
        impacts = march(law, pair, values, speeds)
        columns = [getattr(impacts, name) / np.tile(wanted[name], copies) - 1.0 for name in COMPARED]
        return np.array(columns).reshape(len(COMPARED), copies, -1)

    def residuals(x: Array) -> Array:
        return errors(scale.values(x), velocities, 1).ravel()

    def jacobian(x: Array) -> Any:
        """Central differences, all parameters in one march; one-sided at a bound."""
        small = 1e-4
        up, down = np.minimum(x + small, scale.high), np.maximum(x - small, scale.low)
        moved = np.array([np.where(np.arange(count) == i, end, x) for i in range(count) for end in (up, down)])
        rows = np.repeat(moved, len(velocities), axis=0).T
        found = errors(scale.values(rows), np.tile(velocities, 2 * count), 2 * count)
        return ((found[:, ::2] - found[:, 1::2]) / (up - down)[:, None]).swapaxes(1, 2).reshape(-1, count)

    slopes: Any = jacobian
    bounds = scale.low, scale.high
    best: Any = least_squares(
        residuals, scale.start, slopes, bounds, x_scale="jac", ftol=1e-7, max_nfev=most_evaluations
    )
    if best.status == 0:
        warnings = (*warnings, f"law {law.name}: the fit had not converged after {most_evaluations} evaluations")
    values = {name: float(value) for name, value in scale.values(best.x).items()}
    impacts = march(law, pair, values, velocities)
    found = {name: getattr(impacts, name) for name in COMPARED}
    tangential = {name: models[spring] for name, spring in law.tangential.items() if spring in models}
    return Translation(engine, law, pair, values, velocities, wanted, found, warnings, tangential)

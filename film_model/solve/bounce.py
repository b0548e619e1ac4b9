"""bounce(scene) → Bounces: all bounces of a ball that falls onto its target under gravity, until it rests."""

from __future__ import annotations

import math
import os
import warnings as python_warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from film_model.base import units
from film_model.base.errors import ImpactWarning, Mistake, SceneError, SimulationError, shown
from film_model.base.foreign import Dataset, Figure
from film_model.base.late import Late
from film_model.base.units import format_si
from film_model.effects.case import case_of
from film_model.effects.choose import Choice, choose
from film_model.effects.wave_losses import hindered, with_waves
from film_model.problem.summary import dent_of
from film_model.scene import STANDARD_GRAVITY, Scene
from film_model.solve.component import ImpactComponent
from film_model.solve.history import Event
from film_model.solve.simulate import simulate_chosen

MOST_BOUNCES = 5_000
"""Reached where e stays above 0.9986, at the default resolution."""

COLUMNS: dict[str, tuple[str, str]] = {
    "time": ("time", "of first touch; 0 at the release of a ball with a drop height, otherwise at its first contact"),
    "velocity_before": ("velocity", "impactor velocity at first touch, positive into the target"),
    "velocity_after": ("velocity", "impactor velocity at the end of contact; a rebound is negative"),
    "height": ("length", "height that the ball reaches after the bounce, above where contact ended"),
    "maximum_force": ("force", "largest contact force"),
    "contact_duration": ("time", "time from first touch to the end of contact"),
    "permanent_indentation": ("length", "dent after the bounce"),
    "tangential_velocity": ("velocity", "of the ball's centre along the surface after the bounce, with friction"),
    "spin": ("angular_frequency", "of the ball after the bounce, with friction"),
}
"""Values of a bounce, with dimension and meaning."""


class Bounce(NamedTuple):
    """One contact, SI floats, as in `COLUMNS`. If the ball stays on the target its velocity after it and its height are
    0, and there is no duration or dent. tangential_velocity, spin: of a scene with friction."""

    time: float
    velocity_before: float
    velocity_after: float
    height: float
    maximum_force: float
    contact_duration: float | None
    permanent_indentation: float | None
    tangential_velocity: float | None = None
    spin: float | None = None

    @property
    def restitution(self) -> float:
        """Velocity of the rebound over that before; negative if the ball still moves in after the target."""
        return (0.0 - self.velocity_after) / self.velocity_before


@dataclass(frozen=True)
class Bounces:
    """All bounces of a ball, from `bounce`.

    scene: that was simulated, with gravity. law: its name. bounces: SI floats; the names of `COLUMNS` are attributes
    that return arrays with units, nan where a value does not exist. outcome: how it ended, in a sentence. rest_time: of
    the first touch of the last bounce, s; None if the ball does not come to rest.

    >>> bounces = fm.bounce(scene.replace({"contact.law": "tsuji", "contact.restitution": 0.5}))
    >>> print(f"{bounces.height[0].to('mm'):.2f~P}")
    12.74 mm
    >>> [round(bounce.restitution, 3) for bounce in bounces.bounces[:3]]
    [0.5, 0.5, 0.5]
    """

    scene: Scene
    law: str
    bounces: tuple[Bounce, ...]
    outcome: str
    rest_time: float | None
    warnings: tuple[str, ...]

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # the values of `COLUMNS`, added below the class
        def plot(self, path: str | os.PathLike[str] | None = None) -> Figure: ...
        def to_dataset(self) -> Dataset: ...
        def _repr_html_(self) -> str: ...
    else:
        plot = Late("film_model.methods:plot_bounces")
        to_dataset = Late("film_model.methods:bounces_to_dataset")
        _repr_html_ = Late("film_model.methods:bounces_as_html")

    def __repr__(self) -> str:
        return f"Bounces({self.law}: {len(self.bounces)}; {self.outcome})"

    def column(self, name: str) -> Any:
        """A value of all bounces, SI, as an array; nan where it does not exist."""
        return np.array([getattr(bounce, name) for bounce in self.bounces], dtype=np.float64)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI: title, law, outcome, rest_time, bounces and warnings."""
        return {
            "title": self.scene.title,
            "law": self.law,
            "outcome": self.outcome,
            "rest_time": self.rest_time,
            "bounces": [bounce._asdict() for bounce in self.bounces],
            "warnings": list(self.warnings),
        }


units.add_quantities(Bounces, COLUMNS, Bounces.column)


def bounce(scene: Scene, *, resolution: Any = None, accuracy: float | None = None) -> Bounces:
    """All bounces of the scene's ball, which falls onto the target with its velocity or from its drop height.

    Each contact is followed under the weight as `ImpactComponent` does, in the dent that those before it left; flights
    are in closed form. The ball rests when a bounce is lower than `resolution` (m, or with units; default: a millionth
    of the first fall), or when it stays on the target. A plate without edges moves by its impedance, and under law
    "auto" a half-space takes the energy of waves, however little that changes the first impact: where later ones are
    elastic, only this brings the ball to rest. Effects of law "auto" are chosen for the first impact, at V: waves of
    a bounce at V' take (V/V')^{2/5} times too much. A ball that no loss stops, that bounces more than 5000
    times, or whose later contacts cannot be solved does not come to rest: `outcome` and a warning say so.

    >>> fm.bounce(scene.replace({"contact.law": "tsuji", "contact.restitution": 0.5})).outcome
    'at rest after 203.63 ms: the ball stays on the target from contact 10 on'

    Every entry of `warnings` is issued as an ImpactWarning too. Raises SceneError for a scene without gravity,
    SimulationError for a ball without velocity and what `ImpactComponent` refuses, ValueError for a bad resolution.
    """
    done = bounce_quietly(scene, resolution=resolution, accuracy=accuracy)
    for sentence in done.warnings:
        python_warnings.warn(sentence, ImpactWarning, stacklevel=2)
    return done


def bounce_quietly(scene: Scene, *, resolution: Any = None, accuracy: float | None = None) -> Bounces:
    """As :func:`bounce`, without Python warnings."""
    if not isinstance(scene, Scene):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"bounce takes a Scene, not {shown(scene)}: Scene.from_toml reads one from a file")
    if scene.effects.gravity is False:
        raise SceneError([Mistake(None, None, "effects.gravity", "is false: without gravity no ball comes back")])
    if scene.approach_velocity <= 0.0:
        raise SimulationError("the impactor has no velocity: give velocity or drop_height")
    fallen = 0.5 * scene.impactor.speed**2 / STANDARD_GRAVITY
    least = 1e-6 * fallen if resolution is None else units.to_si(resolution, "length", bare=True)
    if not 0.0 < least < fallen:
        raise ValueError(f"resolution: {least:g} m must be above 0 m and below the height of the fall, {fallen:g} m")
    component = ImpactComponent(_falling(scene), accuracy=accuracy)
    released = 0.0 if scene.impactor.drop_height is None else scene.impactor.speed / STANDARD_GRAVITY
    component.initialize(time=released)
    return _Series(component, least).bounces()


def _falling(scene: Scene) -> Scene:
    """The scene with its weight; with the motion of a target without edges, and under law "auto" with waves in a
    half-space, however little they change the first impact."""
    heavy = replace(scene, effects=scene.effects.changed(gravity=True))
    choice, effects = choose(heavy), heavy.effects
    own = effects.target_motion == "auto" and not choice.decided[1] and not choice.support.vibrates
    if own and math.isfinite(choice.support.impedance):
        effects = effects.changed(target_motion=True)
    if effects.wave_losses == "auto" and not hindered(choice.problem) and with_waves(choice.problem) is not None:
        effects = effects.changed(wave_losses=True)
    return replace(heavy, effects=effects)


def _doubts_of_friction(choice: Choice) -> tuple[str, ...]:
    """How far models of the friction differ in the first impact."""
    if choice.scene.contact.friction is None:
        return ()
    try:
        oblique = simulate_chosen(choice, choice.scene.solver).oblique
    except SimulationError:  # a first contact that does not end
        return ()
    return () if oblique is None else oblique.warnings(choice.scene.solver.accuracy)


def _whole(first: Bounce, last: Bounce) -> Bounce:
    """One contact whose force was 0 for a while: the force of a damped law returns before the ball is out of its dent,
    while it still rises."""
    lasted = None if last.contact_duration is None else last.time + last.contact_duration - first.time
    most = max(first.maximum_force, last.maximum_force)
    own = {"time": first.time, "velocity_before": first.velocity_before}
    return last._replace(**own, maximum_force=most, contact_duration=lasted)


class _Series:
    """The bounces of a component, one after the other. least: height that is rest, m."""

    def __init__(self, component: ImpactComponent, least: float) -> None:
        self._component, self._least = component, least
        self._vibrates = component.problem.vibrates
        self._deepest = 0.0
        self._found: list[Bounce] = []

    def bounces(self) -> Bounces:
        """All of them, and how they end."""
        choice = self._component.choice
        outcome, rests, said = self._ended()
        warnings = (*choice.warnings, *_doubts_of_friction(choice), *said)
        rest = self._found[-1].time if rests else None
        return Bounces(choice.scene, choice.problem.law.name, tuple(self._found), outcome, rest, warnings)

    def _ended(self) -> tuple[str, bool, tuple[str, ...]]:
        """Outcome, whether the ball rests, and warnings."""
        low = 0
        while len(self._found) < MOST_BOUNCES:
            try:
                last = self._next()
            except SimulationError as error:
                if not self._found:
                    raise
                outcome = f"followed up to bounce {len(self._found)}: {error}"
                return outcome, False, (outcome,)
            if last.velocity_before < 0.0 and not self._vibrates:
                last = _whole(self._found.pop(), last)
            self._found.append(last)
            count, at = len(self._found), format_si(last.time, "time", 5)
            if last.contact_duration is None:
                return f"at rest after {at}: the ball stays on the target from contact {count} on", True, ()
            low = low + 1 if last.height < self._least else 0
            if low >= (10 if self._vibrates else 1):  # a target that vibrates may throw the ball up after a low bounce
                least = format_si(self._least, "length", 3)
                return f"at rest after {at}: bounce {count} is lower than {least}", True, ()
            # a smaller loss is rounding: rest would take more than 1e9 bounces
            if not self._vibrates and -last.velocity_after >= last.velocity_before * (1.0 - 1e-9):
                outcome = f"never comes to rest: from contact {count} on the law loses no energy"
                return outcome, False, (f"{outcome}{self._waves(last)}",)
        height = format_si(self._found[-1].height, "length", 3)
        outcome = f"not at rest after {MOST_BOUNCES} bounces, the last {height} high"
        return outcome, False, (outcome,)

    def _next(self) -> Bounce:
        """The next contact."""
        component, swings = self._component, 0
        speed = component.outputs.impactor_velocity
        touch, event = self._event(speed), None
        if touch is None:
            raise SimulationError("the target moves away, and the ball does not meet it again")
        before = touch.impactor_velocity
        while event is None or event.name != "contact_ends":
            event = self._event(before)
            swings += event is not None and event.name == "reloading_begins"
            # only a target that vibrates adds energy: on others the ball stays from the first swing on
            if event is None or swings > (1000 if self._vibrates else 0):
                return Bounce(touch.time, before, 0.0, 0.0, component.largest_force, None, None)
            if event.name == "maximum_indentation":
                self._deepest = max(self._deepest, event.indentation)
        after, length = event.impactor_velocity, component.problem.scales.length
        height = 0.5 * min(after, 0.0) ** 2 / STANDARD_GRAVITY
        dent = dent_of(component.problem, self._deepest / length, event.indentation / length) * length
        duration, sliding = event.time - touch.time, component.sliding
        along = (None, None) if sliding is None else (sliding.tangential_velocity, sliding.spin)
        return Bounce(touch.time, before, after, height, component.largest_force, duration, dent, *along)

    def _event(self, speed: float) -> Event | None:
        """The next event; None if contact, or a flight that begins with `speed` [m/s], has none any more."""
        problem = self._component.problem
        wait = 4.0 * abs(speed) / STANDARD_GRAVITY + problem.limit * problem.scales.time
        return next(iter(self._component.step(wait, stop_at_events=True).events), None)

    def _waves(self, last: Bounce) -> str:
        """The end of the warning about a law without losses: the restitution that waves in the target leave."""
        scene, light = self._component.scene, self._component.choice.light
        if not light.trial.ends or last.contact_duration is None:
            return ""
        energy = 0.5 * scene.effective_mass * last.velocity_before**2
        seen = case_of(light, vibrates=False).seen
        seen = seen._replace(energy=energy, force=last.maximum_force, duration=last.contact_duration)
        share = scene.target.wave_losses(seen).change
        if share is None:
            return ""
        left = f"{math.sqrt(1.0 - share):.4g}"
        return f"; waves into the {scene.target.kind}, which are not simulated, leave a restitution of about {left}"

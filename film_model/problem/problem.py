"""Impacts without units: the dimensionless numbers for the core, and the conversion of its results.

Every formula here serves one impact, whose numbers are floats, and many that share a curve, whose numbers are arrays
with one value per impact.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np

from film_model.base.arrays import ALL, Array, Index, Number, any_of, column, either, greater
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.core.columns import Columns
from film_model.core.families import Motions
from film_model.laws.law import AbstractLaw
from film_model.problem.curve import Curve, curve_of, curve_on
from film_model.problem.law_of_scene import SceneLaw, law_named
from film_model.problem.numbers import Numbers, zener
from film_model.problem.own_curves import OwnCurves
from film_model.problem.relaxation import Relaxation
from film_model.problem.scales import Scales, motion_of, scales_from, scales_of
from film_model.scene import Scene
from film_model.scene.columns import scene_of_columns

TRIAL_TOLERANCE = 1e-3
"""Tolerance of a step in the trial of a contact that relaxes; its relative errors are about 1e-5."""


class Trial(NamedTuple):
    """An impact on a coarse mesh. status: the core's, negative where it failed. summary: native.Summary or Columns.
    ends: whether contact ends, so that the trial is a complete impact."""

    status: Any
    summary: Any
    ends: Any


class Given(NamedTuple):
    """What an impact is under. impedance: of the target, N s/m; infinite if it does not move by it. load: N.
    compliance: static, of the target, m/N; 0 if it does not follow the force statically."""

    impedance: Number
    load: Number
    compliance: Number


@dataclass(frozen=True)
class Impacts:
    """One impact, or many that share a law and a curve, before target motion and load are decided.

    base: the scene; of many impacts the one whose numbers they vary. law: with the scene's values. numbers: of the
    scene. scene: with arrays in place of the numbers that vary. index: which rows of a sweep or batch the many are;
    None for one impact. columns: the numbers that vary, path → SI values.
    """

    base: Scene
    law: SceneLaw
    numbers: Numbers
    scene: Scene
    index: Index | None = None
    columns: Mapping[str, Array] = field(default_factory=dict[str, Array])

    @classmethod
    def one(cls, scene: Scene, law: SceneLaw) -> Impacts:
        """One impact."""
        return cls(scene, law, Numbers.of(scene, None), scene)

    @classmethod
    def several(
        cls, scene: Scene, law: SceneLaw, index: Index, columns: Mapping[str, Array], varied: Scene | None = None
    ) -> Impacts:
        """Many impacts. varied: the scene with the columns, if it is made."""
        varied = varied or scene_of_columns(scene, columns)
        return cls(scene, law, Numbers.of(varied, index.size), varied, index, columns)

    @property
    def many(self) -> bool:
        """Whether these are many impacts, and the numbers arrays."""
        return self.index is not None

    def column(self, value: Any) -> Any:
        """A number of the scene: unchanged for one impact, an array with one value per impact for many."""
        return value if self.index is None else column(value, self.index.size)

    def part(self, places: Any) -> Impacts:
        """Some of many impacts, by their indices or by a mask; these impacts for `ALL`."""
        assert self.index is not None
        if places is ALL:
            return self
        numbers = Numbers(*(values[places] for values in self.numbers))
        columns = {path: values[places] for path, values in self.columns.items()}
        varied = scene_of_columns(self.base, columns)
        return Impacts(self.base, self.law.part(places), numbers, varied, self.index[places], columns)

    def under(self, law: SceneLaw) -> Impacts:
        """The same impacts under another law."""
        return Impacts(self.base, law, self.numbers, self.scene, self.index, self.columns)

    def named(self, law: str) -> Impacts:
        """The same impacts under the law of this name, with its values from the scene."""
        return self.under(law_named(self.scene, law))

    @cached_property
    def zener(self) -> Any:
        """λ of the elastic contact (:func:`zener`); 0 on a target without impedance."""
        return either(self.numbers.impedance < math.inf, zener(self.scene, self.numbers.impedance), 0.0)

    @property
    def yield_strength(self) -> Any:
        """That of the law, which may be higher than the scene's (rate hardening); else the scene's, Pa, or None."""
        strength = self.law.strength
        return self.scene.yield_strength if strength is None else strength

    @cached_property
    def one_law(self) -> AbstractLaw:
        """The law of the one impact, or of the first of many."""
        return self.law.first

    @cached_property
    def curve(self) -> Curve:
        """The curve of the one impact, or of the first of many, without a spring."""
        return self._curve(self.own if self.many else OwnCurves())

    def _curve(self, own: OwnCurves, spring: float = 0.0) -> Curve:
        if own.page is not None and own.page.marks is not None and own.shape is not None:
            return curve_on(own.page, own.shape[0], self.one_law, spring)  # the law alone would be fitted again
        return curve_of(self.one_law, spring)

    @cached_property
    def _light_scales(self) -> Scales:
        return self._scales(self.numbers.energy)

    def _scales(self, energy: Any) -> Scales:
        if self.index is None:
            return scales_of(self.one_law, energy, self.numbers.mass)
        length, force = self.law.on_arrays(lambda law, places: law.scales(energy[places]), self.index.size)
        return scales_from(length, force, self.numbers.mass)

    @cached_property
    def own(self) -> OwnCurves:
        """In what the curves of many impacts differ, without springs."""
        assert self.index is not None
        return OwnCurves.of(self.law, self.index.size)

    def _damping(self, scales: Scales) -> Any:
        """The factor of the law's damping, without units."""
        if not self.law.law.damped:
            return self.column(0.0)
        given = self.numbers.mass, self.numbers.approach, scales.length
        if self.index is None:
            found = self.one_law.damping_factor(*given)
        else:
            (found,) = self.law.on_arrays(
                lambda law, at: (law.damping_factor(*(x[at] for x in given)),), self.index.size
            )
        return found * scales.velocity / scales.force

    def problem(
        self, impedance: Any, load: Any, compliance: Any = 0.0, vibrates: bool = False, fitted: bool = True
    ) -> Problem:
        """The dimensionless problem for a target impedance [N s/m] and a load [N], which are arrays for many impacts.

        compliance: of a target that follows the force statically, m/N, for many impacts an array, or 0 of all.
        vibrates: the target moves by its modes instead. fitted: whether curves are fitted that many impacts need.
        """
        numbers, energy, loaded = self.numbers, self.numbers.energy, any_of(load > 0.0)
        weighed = load * 1e-3 * numbers.radius
        if loaded and any_of(weighed > energy):
            scales = self._scales(greater(energy, weighed))
        elif self.index is None and energy == 0.0:  # a ball at rest, for a component: what its weight would do
            scales = self._scales(numbers.weight * 1e-3 * numbers.radius)
        else:
            scales = self._light_scales
        springs = any_of(compliance > 0.0)
        spring: Any = compliance * scales.force / scales.length if springs else 0.0
        own = OwnCurves()
        if self.index is not None:
            own = self.own if fitted else OwnCurves.of(self.law, self.index.size, fitted=False)
        return Problem(
            impacts=self,
            law=self.one_law,
            curve=self._curve(own, np.ravel(spring)[0].item()) if springs or not fitted else self.curve,
            scales=scales,
            gamma=scales.force / (impedance * scales.velocity),
            load=load / scales.force,
            damping=self._damping(scales),
            approach=numbers.approach / scales.velocity,
            drift=numbers.drift,
            share=numbers.share,
            mass=numbers.mass,
            given=Given(impedance, load, compliance),
            loaded=loaded,
            free=self.base.target.free,
            vibrates=vibrates,
            own=own._replace(spring=spring) if springs and self.many else own,
        )


@dataclass(frozen=True)
class Problem:
    """The dimensionless numbers of an impact for the core, and those that convert its results; arrays for many impacts.

    gamma: F_s/(Z v_s). load: external force over F_s. damping: factor of a damped law's c over F_s/v_s. approach:
    relative velocity over v_s. drift, share: the impactor's velocity is drift + share·ν v_s, a free target's
    drift − (1 − share)·ν v_s; drift 0 and share 1 unless the target is a free body. mass: effective, kg. loaded: with a
    load on the contact, or on any of many. free: the target is a free body. vibrates: it moves by its modes, and is
    integrated, not marched by the core. stretches: with membrane forces. relaxation: of the moduli, if it is
    simulated. law: of many impacts, that of the first. own: in what the curves of many impacts differ; then the curve,
    too, is that of the first.
    """

    impacts: Impacts = field(repr=False)
    law: AbstractLaw
    curve: Curve
    scales: Scales
    gamma: Number
    load: Number
    damping: Number
    approach: Number
    drift: Number
    share: Number
    mass: Number
    given: Given = field(repr=False)
    loaded: bool = field(repr=False)
    free: bool = False
    vibrates: bool = False
    stretches: bool = False
    relaxation: Relaxation | None = None
    own: OwnCurves = OwnCurves()
    _others: dict[Any, Problem] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def scene(self) -> Scene:
        """The scene; for many impacts, the scene whose numbers are varied."""
        return self.impacts.base

    def again(
        self,
        law: str | AbstractLaw | None = None,
        impedance: Number = None,
        load: Number = None,
        compliance: Number = None,
    ) -> Problem:
        """The problem with another law, or law name, impedance, load or compliance; it is the same if nothing changes.
        Of one impact these problems are kept, so that each is made and marched once."""
        own, impacts = self.given, self.impacts
        given = Given(
            own.impedance if impedance is None else impedance,
            own.load if load is None else load,
            own.compliance if compliance is None else compliance,
        )
        if not (impacts.many or self.vibrates or law) and given == self.given:
            return self
        if impacts.many or isinstance(law, AbstractLaw):
            other = impacts.under(SceneLaw(law, {}, None, {})) if isinstance(law, AbstractLaw) else impacts
            return (impacts.named(law) if isinstance(law, str) else other).problem(*given)
        if (law, given) not in self._others:
            self._others[law, given] = (impacts.named(law) if law else impacts).problem(*given)
        return self._others[law, given]

    def under(self, law: str) -> Problem:
        """The problem with the law of this name, whose target moves as this one's."""
        if not self.vibrates:
            return self.again(law=law)
        return replace(self.impacts.named(law).problem(*self.given, vibrates=True), stretches=self.stretches)

    def part(self, places: Any) -> Problem:
        """Some of many impacts, by their indices or by a mask."""
        if isinstance(places, np.ndarray) and places.dtype == np.bool_ and places.all():
            return self
        numbers = ("gamma", "load", "damping", "approach", "drift", "share", "mass")
        return replace(
            self,
            impacts=self.impacts.part(places),
            scales=self.scales.part(places),
            given=Given(*(part[places] if isinstance(part, np.ndarray) else part for part in self.given)),
            loaded=any_of(self.load[places] > 0.0),
            own=self.own.part(places),
            **{name: getattr(self, name)[places] for name in numbers},
        )

    @cached_property
    def start(self) -> Any:
        """Start values for the core: native.Start, or for many impacts an array of native.START_DTYPE."""
        numbers = (self.approach, self.gamma, self.load, self.stop_velocity, self.limit, self.damping)
        if not self.impacts.many:
            return native.Start(*numbers)
        start = np.empty(np.shape(self.approach), native.START_DTYPE)
        for name, values in zip(cast("Any", start.dtype.names), numbers, strict=True):
            start[name] = values
        return start

    def march(self, mesh: native.Mesh) -> tuple[Any, Any]:
        """The core's status and summary of the impact on a mesh; of many impacts, an array and :class:`Columns`.

        One impact by the lines that are recorded: the meshes are compared to find the error of its history.
        """
        refuse_relaxation(self, "a march on lines")
        if not self.impacts.many:
            return native.marched(self.curve.native, mesh, self.start)
        status, table = self.own.march(self._shared_curve, mesh, self.start)
        return status, Columns(table)

    def motions(self, legs: Array, knots: int) -> Motions:
        """Of many impacts, at knots of legs over the scales, as `families.motions`."""
        return self.own.motions(self._shared_curve, self.start, legs, knots, self.curve.reversible)

    @property
    def _shared_curve(self) -> Curve:
        return self.impacts.curve if self.own.springs_alone else self.curve

    def relax(self, tolerance: float) -> tuple[Any, Any]:
        """The same for a contact that relaxes. tolerance: of the core's steps."""
        assert self.relaxation is not None
        status, summary = self.relaxation.march(self.scales.time, self.start, tolerance)
        return status, Columns(summary) if self.impacts.many else summary

    def by_curve(self) -> Iterator[Problem]:
        """The problems, of one impact or of many, whose impacts share a curve to the last digit."""
        if self.own.alike:
            yield self
            return
        for places in self.own.groups():
            yield self.part(places).as_first()

    def as_first(self) -> Problem:
        """Many impacts, all with the law and the curve of the first."""
        law, curve, own = self.impacts.one_law, self.curve, self.own
        if not own.alike:
            error, made = max(curve.fit_error, own.fit_error), own.first(lambda: self.impacts.curve.native)
            curve = replace(curve, native=made, stages=tuple(law.stages()), fit_error=error)
        return replace(self, law=law, curve=curve, own=OwnCurves())

    @cached_property
    def trial(self) -> Trial:
        """The impact on a coarse mesh, used to decide effects; one by the way of a batch, so that both decide alike."""
        if self.relaxation is not None:
            status, summary = self.relax(TRIAL_TOLERANCE)
        elif self.impacts.many:
            status, summary = self.march(self.curve.trial_mesh)
        else:
            status, summary = native.impact(self.curve.native, self.curve.trial_mesh, self.start)
        return Trial(status, summary, status == native.EVENT)

    @property
    def stop_velocity(self) -> Any:
        """ν at which the impactor's velocity is zero in the laboratory frame."""
        return -self.drift / (self.share * self.scales.velocity) if self.free else -0.0

    @property
    def limit(self) -> Any:
        """Time after which a contact under a load, or of a law that pulls, is no longer followed."""
        if not (self.loaded or self.curve.pulls):
            return math.inf
        # a hundred elastic contact times of about 3 ν^{-1/5}, and times m/Z
        long = 100.0 * (3.0 * greater(self.approach, 1e-3) ** -0.2 + self.gamma)
        return either((self.load > 0.0) | self.curve.pulls, long, math.inf)

    @cached_property
    def impact_energy(self) -> Any:
        """½ m V², J."""
        return 0.5 * self.approach**2 * self.scales.energy

    @cached_property
    def damps(self) -> bool:
        """Whether the law has damping in the impact, or in any of many."""
        return any_of(self.damping > 0.0)

    def motion(self, t: Any, values: Any) -> dict[str, Any]:
        """As :func:`motion_of`."""
        return motion_of(self.scales, self.drift, self.share, self.free, t, values)


def refuse_relaxation(problem: Problem, what: str) -> None:
    """SimulationError if a material relaxes; `what` does not support that."""
    if problem.relaxation is not None:
        raise SimulationError(
            f"{what} is not supported for a viscoelastic material; use simulate(), or take its instantaneous modulus "
            "by viscoelasticity = false in [effects]"
        )

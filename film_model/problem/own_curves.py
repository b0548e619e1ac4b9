"""In what the curves of many impacts of one problem differ: shape, some numbers, springs in series."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.core import families, native, solving
from film_model.laws.law import AbstractLaw
from film_model.problem.curve import Curve
from film_model.problem.families import Page, page_of
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.mixtures import mixed_numbers, mixture_of
from film_model.problem.varied import Varied, fitted_by, varied_of


class OwnCurves(NamedTuple):
    """page: a family of curves, and shape: the shapes of the laws, or of a mixture their rows of numbers. varied: of
    curves that differ in numbers of their powers. spring: compliances [δ_s/F_s] in series. Each is None where the
    curves do not differ in it, or have none; page and shape are both None, or neither."""

    page: Page | None = None
    shape: Array | None = None
    varied: Varied | None = None
    spring: Array | None = None

    @classmethod
    def of(cls, law: SceneLaw, count: int, fitted: bool = True) -> OwnCurves:
        """Of `count` laws that share a page of their family, or pieces. fitted: whether laws with a shape differ in a
        number beside it; if not, their curves are those of the first law's."""
        kind = law.law
        if isinstance(kind, AbstractLaw) or not law.read:
            return cls()
        shaped = law.rule is None and bool(kind.shaped_by)
        if not shaped:
            return cls(varied=varied_of(law, count))
        if fitted and (beside := fitted_by(law)):
            page = mixture_of(law.at(0), beside)
            return cls(page, mixed_numbers(page, law.at, count))
        return cls(page_of(law.at(0)), law.on_arrays(lambda law, _: (law.shape,), count)[0])

    @property
    def alike(self) -> bool:
        """Whether all have one curve."""
        return all(values is None for values in self)

    @property
    def springs_alone(self) -> bool:
        """Whether the curves differ in springs only."""
        return self.spring is not None and self.page is None and self.varied is None

    def part(self, places: Any) -> OwnCurves:
        """Of some of the impacts."""
        if self.alike:
            return self
        shape, spring = (None if values is None else values[places] for values in (self.shape, self.spring))
        return OwnCurves(self.page, shape, None if self.varied is None else self.varied.part(places), spring)

    def march(self, curve: Curve, mesh: native.Mesh, start: NDArray[Any]) -> tuple[NDArray[np.int32], NDArray[Any]]:
        """The core's statuses and summaries. curve: of the first impact; without its spring if springs differ alone."""
        if self.alike:
            return native.batch(curve.native, mesh, start)
        return families.batch(self._rows(curve), mesh, start)

    def motions(self, curve: Curve, start: NDArray[Any], legs: Array, knots: int, reversible: bool) -> families.Motions:
        """The motions of impacts as `families.motions`. curve: as in `march`."""
        return families.motions(self._rows(curve), start, legs, knots, reversible)

    def _rows(self, curve: Curve) -> families.Rows:
        page, shape, varied, spring = self
        if varied is not None:
            return families.Rows(varied.curve, compliance=spring, values=varied.values, places=varied.places)
        if page is not None:
            return families.Rows(page.whole, page.family, shape, spring)
        return families.Rows(curve.native, compliance=spring)

    def groups(self) -> Iterator[Index]:
        """The impacts of each curve that differs from the others."""
        columns = [values.reshape(len(values), -1) for values in (self.shape, self.spring) if values is not None]
        columns += [] if self.varied is None else [self.varied.values]
        different, group = np.unique(np.concatenate(columns, axis=1), axis=0, return_inverse=True)
        for k in range(len(different)):
            yield np.flatnonzero(group.ravel() == k)

    def first(self, shared: Callable[[], native.Curve]) -> native.Curve:
        """The curve of the first impact to the last digit. shared: without springs, of impacts that share it."""
        if self.varied is not None:
            curve = self.varied.curve_at(0)
        elif self.page is not None and self.shape is not None:
            curve = self.page.at(self.shape[0])
        else:
            curve = shared()
        return curve if self.spring is None else families.in_series(curve, float(self.spring[0]))

    def dents(self, curve: Curve, depth: Any, end: Any) -> Any:
        """What contacts leave that turned at `depth` and ended at `end` [δ_s], laws that pull. curve: of the first."""
        if self.varied is None:
            return solving.dents(curve.native, depth, end)
        return solving.dents(self.varied.curve, depth, end, self.varied.places, self.varied.values)

    @property
    def fit_error(self) -> float:
        """Largest relative difference between the forces of a page and the law's."""
        return 0.0 if self.page is None else self.page.fit_error

"""Derivatives of the results along the surface by numbers of the scene: differences of whole impacts with friction.

The results are as smooth as their solution is exact, so that steps are wider than those of the summary. The error is
estimated from differences with steps of twice the width.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from film_model.base.arrays import Array, Index
from film_model.core import native
from film_model.effects.many import problems_of, rows_of
from film_model.oblique.result import OBLIQUE
from film_model.problem.summary import summary_of
from film_model.scene import Scene, Solver
from film_model.solve.many_friction import ManyOblique, oblique_of_many
from film_model.solve.many_meshes import march_many
from film_model.solve.many_springs import Normal
from film_model.solve.slopes import NO_DERIVATIVE, STENCILS, STEP, Pairs, Slopes

WIDER = 4.0
"""Steps over `STEP`. The sliding velocity is exact to 1e-10 of that before, which differences divide by the step."""

REACH = 200.0 * WIDER * STEP
"""Of the central stencil and that of twice the width, %, as a warning says it."""


def slopes_along(pairs: Pairs) -> Slopes:
    """The derivatives of the values of `OBLIQUE`; one-sided ones where the contact slides otherwise on one side, and
    none where it does on both, nothing slides, or the target vibrates."""
    count = pairs.which.size
    found, left = Slopes.none(count, len(OBLIQUE)), np.arange(count)
    for side, stencil in STENCILS.items():
        tried = left[pairs.part(left).fits(2.0 * WIDER * stencil.offsets)]
        if tried.size:
            _set(found, tried, pairs.part(tried), side)
        left = left[found.side[left] == NO_DERIVATIVE]
    return found


def _set(found: Slopes, places: Index, pairs: Pairs, side: int) -> None:
    """Set the derivatives of the pairs at `places` in whose stencils all contacts slide alike."""
    offsets, weights, base = STENCILS[side]
    moved = [pairs.moved(WIDER * width * offset) for width in (1.0, 2.0) for offset in offsets.tolist()]
    many = _impacts(pairs.scene, {path: np.concatenate([each[path] for each in moved]) for path in moved[0]})
    regime = many.regime.reshape(-1, places.size)
    alike = ((regime == regime[base]) & (regime >= 0)).all(axis=0)
    values = np.stack([many.summary[name] for name in OBLIQUE]).reshape(len(OBLIQUE), 2, -1, places.size)
    values[np.isinf(values)] = np.nan  # the impact number of a contact without friction
    step = WIDER * pairs.step
    slope, wide = (np.einsum("s,nsp->pn", weights, values[:, k]) / (step * (k + 1.0))[:, None] for k in (0, 1))
    own = values[:, 0, base].T
    # estimated error: twice the difference of both widths, for noise of impacts by springs
    found.put(places[alike], slope[alike], (wide - slope)[alike], own[alike], pairs.value[alike], 2.0)
    found.side[places[alike]] = side


def _impacts(scene: Scene, columns: Mapping[str, Array]) -> ManyOblique:
    """The tangential parts of impacts; none of those on targets that vibrate."""
    # below the accuracies from which a table of friction and fewer springs serve
    count, solver = len(next(iter(columns.values()))), Solver(1e-8)
    status = np.full(count, native.BAD_NUMBER, np.int32)
    rebound, turn, end, estimated = np.full((4, count), np.nan)
    problems = problems_of(scene, columns, count, status)
    for problem in problems:
        rows, made = rows_of(problem), march_many(problem, solver)
        values = summary_of(problem, made.status, made.core)
        status[rows], estimated[rows] = made.status, made.estimated
        rebound[rows], end[rows] = values["rebound_velocity"], values["contact_duration"]
        turn[rows] = values["time_of_maximum_indentation"]
    return oblique_of_many(problems, Normal(status, rebound, turn, end, estimated), solver, bounded=False)[0]

"""The march of many contacts whose curves are one, belong to one family, or differ in some numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import families, native
from film_model.problem.curve import Curve
from film_model.problem.families import Page
from film_model.problem.varied import Varied


def march_rows(
    curve: Curve,
    page: Page | None,
    mesh: native.Mesh,
    start: NDArray[Any],
    shape: Array | None,
    varied: Varied | None,
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries (SUMMARY_DTYPE) of many contacts (START_DTYPE). page, shape, varied: see OwnCurves."""
    if varied is not None:
        return families.batch_varied(*varied, mesh, start)
    if shape is not None and page is not None:
        return families.batch(page.family, page.whole, mesh, start, shape)
    return native.batch(curve.native, mesh, start)

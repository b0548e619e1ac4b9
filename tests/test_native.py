"""The compiled core's doors: what it refuses, and libraries that are missing or of other sources."""

import ctypes
import math

import numpy as np
import pytest
from cases import LAWS

from film_model.core import native
from film_model.curve import curve_of

HERTZ = curve_of(LAWS["hertz"]).native


@pytest.mark.parametrize("counts", [(0, 5), (5, 0), (native.MAX_SEGMENTS + 1, 5)])
def test_a_mesh_without_segments_or_with_too_many_is_refused(counts):
    with pytest.raises(ValueError, match=f"segments {counts[0]} and {counts[1]} must be 1 to 4000000"):
        native.mesh(native.CHORD, *counts)


@pytest.mark.parametrize(
    ("start", "gap", "says"),
    [
        (native.Start(math.nan, 0.0, 0.0, 0.0, math.inf), 0.0, "nu=nan"),
        (native.Start(1.0, -1.0, 0.0, 0.0, math.inf), 0.0, r"gamma=-1\.0"),
        (native.Start(1.0, 0.0, 0.0, 0.0, math.inf, -1.0), 0.0, r"damping=-1\.0"),
        (native.Start(1.0, 0.0, 0.0, 0.0, math.inf), math.inf, "gap=inf"),
    ],
)
def test_a_start_that_is_none_is_refused(start, gap, says):
    with pytest.raises(ValueError, match=f"the core refuses .*{says}"):
        native.initial_state(HERTZ, start, gap)


def test_nothing_is_sampled_without_lines():
    with pytest.raises(ValueError, match="no lines to sample"):
        native.sample(HERTZ, np.empty(0, native.LINE_DTYPE), np.zeros(1))


def test_a_library_that_is_missing_or_of_other_sources(monkeypatch, tmp_path):
    load = native.library.__wrapped__  # every time anew
    with monkeypatch.context() as changed:
        changed.setattr(
            native, "Summary", type("Summary", (ctypes.Structure,), {"_fields_": [("force", ctypes.c_double)]})
        )
        with pytest.raises(ImportError, match=r"_film_core.* was built from other sources: install the package again"):
            load()
    monkeypatch.setattr(native, "_library_path", lambda: tmp_path / "_film_core.so")
    with pytest.raises(ImportError, match=r"_film_core\.so is missing: install the package \(pip install \.\)"):
        load()

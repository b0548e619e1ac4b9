"""The interface of the compiled core: invalid arguments, and missing or outdated libraries."""

import ctypes
import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest
from cases import LAWS

from film_model.base.errors import STATUSES
from film_model.core import native
from film_model.laws import BigAlabo, Stronge, Thornton
from film_model.problem.curve import curve_of

HERTZ = curve_of(LAWS["hertz"]).native


def test_the_status_codes_are_those_of_the_core():
    header = (Path(native.__file__).parent / "film_core.h").read_text("utf-8")
    core = {
        "time_limit": "OK",
        "separated": "EVENT",
        "resting": "ENDLESS",
        "too_many_segments": "TOO_MANY",
        **{word: word.upper() for word in ("bad_number", "bad_curve", "bad_mesh", "beyond_law", "bad_unloading")},
        **{word: word.upper() for word in ("full", "too_stiff", "turns_again", "remembers")},
    }
    for code, status in STATUSES.items():
        if code > -100:
            name = core.pop(status.word)
            assert code == getattr(native, name)
            assert re.search(rf"FILM_{name} = {code}\b", header), name
    assert core == {}


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
def test_an_invalid_start_is_refused(start, gap, says):
    with pytest.raises(ValueError, match=f"the core refuses .*{says}"):
        native.initial_state(HERTZ, start, gap)


def test_nothing_is_sampled_without_lines():
    with pytest.raises(ValueError, match="no lines to sample"):
        native.sample(HERTZ, np.empty(0, native.LINE_DTYPE), np.zeros(1))


def test_a_missing_or_outdated_library_is_an_error(monkeypatch, tmp_path):
    load = native.library.__wrapped__  # not cached
    with monkeypatch.context() as changed:
        changed.setattr(
            native, "Summary", type("Summary", (ctypes.Structure,), {"_fields_": [("force", ctypes.c_double)]})
        )
        with pytest.raises(ImportError, match=r"_film_core.* was built from other sources: install the package again"):
            load()
    monkeypatch.setattr(native, "_library_path", lambda: tmp_path / "_film_core.so")
    with pytest.raises(ImportError, match=r"_film_core\.so is missing: install the package \(pip install \.\)"):
        load()


SPHERES = [BigAlabo(1e11, 0.01, 1e9), Stronge(1e11, 0.01, 1e9), Thornton(1e11, 0.01, 1.6e9)]
ROUNDING_PAST = [1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9]


@pytest.mark.parametrize("law", SPHERES, ids=lambda law: law.name)
def test_a_turn_just_inside_a_stage_agrees_with_the_march(law):
    """Energy alone loses the length of the leg there, which is rounding: SHORT_LEG sends such impacts to the march."""
    curve = curve_of(law)
    mesh, stages = native.mesh(native.WORK_PRESERVING, 200, 200), curve.native.stage
    for k, past in itertools.product(range(1, curve.native.stages), ROUNDING_PAST):
        start = native.Start(math.sqrt(2 * curve.work(stages[k].begin) * (1 + past)), 0.0, 0.0, 0.0, math.inf)
        state, turned = native.initial_state(curve.native, start), math.nan
        while native.step(curve.native, mesh, state, math.inf) == native.EVENT:
            if native.EVENTS[state.event] == "maximum_indentation":
                turned = state.time
            elif native.EVENTS[state.event] == "contact_ends":
                break
        _, one = native.impact(curve.native, mesh, start)
        _, many = native.batch(curve.native, mesh, np.frombuffer(bytes(start) * 40, native.START_DTYPE))
        for found in (one.time_of_maximum_indentation, many["time_of_maximum_indentation"][-1]):
            assert found == pytest.approx(turned, rel=1e-10), (k, past)
        for found in (one.contact_duration, many["contact_duration"][-1]):
            assert found == pytest.approx(state.time, rel=1e-10), (k, past)


@pytest.mark.parametrize("law", SPHERES, ids=lambda law: law.name)
def test_no_indicator_is_0_right_after_an_event(law):
    """FMI asks for it; INDICATOR_DELAY moves the sign changes by a ten-billionth of the speed."""
    curve, speed = curve_of(law).native, 5.0
    mesh, seen = native.mesh(native.WORK_PRESERVING, 8, 8), []
    state = native.initial_state(curve, native.Start(speed, 0.3, 0.0, 0.0, math.inf))
    while native.step(curve, mesh, state, math.inf) == native.EVENT:
        seen.append(native.EVENTS[state.event])
        assert min(native.indicators(curve, state, speed)) > 0.0, seen
        if seen[-1] == "contact_ends":
            break
    assert {"contact_begins", "stage_changes", "maximum_indentation", "impactor_stops"} <= set(seen)

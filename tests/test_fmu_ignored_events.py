"""Masters that ignore events: what they get, and the events that the outputs still tell (docs/fmus.md)."""

import numpy as np
import pytest
from cases import scene
from fmpy import simulate_fmu

import fmu_wrapper
from fmu_wrapper.variables import EVENT_TIMES

MOTION = ("indentation", "impactor_velocity", "contact_force")
NAMES = (*MOTION, *EVENT_TIMES, "event_count", "contact_count", "maximum_force", "largest_force")
GAP, BOUNCING = 1e-6, {"gravity": 2e3}


def rows_of(path, steps, stop, **options):
    start = {"initial_gap": GAP, **BOUNCING}
    return simulate_fmu(
        *(str(path), False, 0.0, stop), output_interval=stop / steps, start_values=start, output=NAMES, **options
    )


def told(rows):
    """Events that happened up to each row, from its outputs: (time, name), without stages and reloading."""
    found = set()
    for row in rows:
        for name, event in EVENT_TIMES.items():
            if row[name] > 0.0:
                found.add((float(row[name]), event))
    return sorted(found)


@pytest.fixture
def bouncing(made):
    """FMUs of a ball that falls back at 200 g, bounces twice and stays."""
    return lambda version: made(fmu_wrapper.served(scene("tsuji")), version)


@pytest.mark.parametrize("version", [2, 3])
def test_events_that_a_master_drops_are_in_the_outputs(bouncing, version):
    """In steps that contain one contact at most: the motion is exact, and so are times and values of all events."""
    stop, steps = 1e-3, 20
    full = rows_of(bouncing(3), steps, stop, use_event_mode=True, early_return_allowed=True)
    rows = rows_of(bouncing(version), steps, stop, use_event_mode=False)
    assert len(rows) == steps + 1 < len(full)
    after = {round(row["time"] * steps / stop, 6): row for row in full}  # the last row of each time
    assert rows["contact_count"][-1] == 3 and np.diff(rows["contact_count"]).max() == 1
    for row in rows:
        own = after[round(row["time"] * steps / stop, 6)]
        for name in MOTION:
            assert row[name] == pytest.approx(own[name], abs=1e-12 * float(np.abs(full[name]).max())), name
    times, names = zip(*told(full), strict=True)
    assert [name for _, name in told(rows)] == list(names)
    assert [time for time, _ in told(rows)] == pytest.approx(list(times), rel=1e-12)
    assert np.unique(rows["maximum_force"]) == pytest.approx(np.unique(full["maximum_force"]), rel=1e-12)


def test_a_step_with_several_contacts_keeps_the_latest_and_the_largest(bouncing):
    stop = 1e-3
    full = rows_of(bouncing(3), 20, stop)
    rows = rows_of(bouncing(3), 1, stop)
    assert rows["contact_count"].tolist() == [0, full["contact_count"][-1]]
    assert rows["time_contact_begins"][-1] == pytest.approx(full["time_contact_begins"].max(), rel=1e-12)
    assert len(told(rows)) < len(told(full))
    assert rows["event_count"][-1] == full["event_count"][-1]
    assert rows["largest_force"][-1] == pytest.approx(full["maximum_force"].max(), rel=1e-12)

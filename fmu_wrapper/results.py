"""A run of an FMU as a dataset of the library's schema."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from film_datasets.provenance import PROGRAM, provenance, text_and_hash
from film_datasets.scene_constants import constants_of
from film_datasets.schema import CONSTANTS, HISTORY, TABLE, content_sha256
from film_model.base.errors import SceneError
from film_model.core import native
from film_model.core.solving import dents
from film_model.scene import Scene
from film_model.solve.history import MOTION, SUMMARY
from film_model.solve.sensed import MOTION as SENSED
from fmu_wrapper import resource
from fmu_wrapper.instance import Fmu, Row
from fmu_wrapper.stepping import ALONG
from fmu_wrapper.variables import STRESSES, of_sensors, reference


def dataset(fmu: Fmu, rows: list[Row], events: list[Row], interface: str, starts: Mapping[str, float]) -> xr.Dataset:
    """The dataset of a run. interface: of FMI, in words. starts: parameters that were set, SI."""
    touch = next((event["time"] for event in events if event["kind"] == native.EVENTS.index("contact_begins")), 0.0)
    summary = _summary(events, touch, rows[-1]["largest_force"], fmu.data) | _stresses(rows)
    columns = {
        **_motion(rows, events, touch, fmu.sensors),
        **_contacts(rows, events, touch),
        **{name: math.nan if value is None else value for name, value in summary.items()},
        **_scales(fmu.data),
        "drift_velocity": 0.0,
        "impactor_share": 1.0,
        "target_compliance": 0.0,
        **_constants(fmu, events, starts),
    }
    meanings = {"stages": tuple(f"stage_{k}" for k in range(fmu.data.curve.stages))}
    arrays: dict[str, Any] = {}
    more = (*TABLE[f"{HISTORY} contacts"], *TABLE[f"{HISTORY} sliding"], *TABLE[f"{HISTORY} sensors"], *CONSTANTS)
    for v in (*TABLE[HISTORY], *(v for v in more if v.name in columns)):
        values = np.zeros(0) if "segment" in v.dims else columns[v.name]
        arrays[v.name] = (v.dims, np.asarray(values, dtype=v.dtype), v.attributes(meanings))
    coordinates = {name: arrays.pop(name) for name in ("t", "sensor") if name in arrays}
    ds = xr.Dataset(arrays, coords=coordinates)
    ds.attrs = _attributes(fmu, interface, starts, max(int(row["validity"]) for row in rows))
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def _constants(fmu: Fmu, events: list[Row], starts: Mapping[str, float]) -> dict[str, Any]:
    """The values of `CONSTANTS` of this run, those that were set in place of the scene's; none if the scene cannot be
    made again because its law was an object of Python."""
    try:
        scene = Scene.from_stored_text(_text(fmu, resource.SCENE), "scene.toml")
    except SceneError:
        return {}
    own = constants_of(scene) | {"contact_law_name": json.loads(_text(fmu, resource.NOTES))["contact_law_name"]}
    own |= {name: starts[name] for name in ("mass", "effective_modulus", "yield_strength") if name in starts}
    if "radius" in starts:  # an FMU has the effective radius only
        own["radius"] = 1.0 / (1.0 / starts["radius"] - 1.0 / scene.effective_radius + 1.0 / own["radius"])
    begins = next((event for event in events if event["kind"] == native.EVENTS.index("contact_begins")), None)
    own["approach_velocity"] = starts.get("initial_velocity", own["approach_velocity"])
    if begins is not None:
        own["approach_velocity"] = begins["relative_velocity"]
    return {**own, "impact_energy": 0.5 * own["mass"] * own["approach_velocity"] ** 2}  # no target of an FMU is free


def _text(fmu: Fmu, name: str) -> str:
    return Path(fmu.folder, "resources", name).read_text("utf-8")


def _motion(rows: list[Row], events: list[Row], touch: float, sensors: tuple[str, ...]) -> dict[str, Any]:
    """Columns of motion, sensors and events. Of two rows at one time, before and after an event, the second is used."""
    last = [row for row, following in itertools.pairwise(rows) if following["time"] != row["time"]] + rows[-1:]
    columns: dict[str, Any] = {
        name: np.array([row[name] for row in last]) for name in (*MOTION, "stage", *ALONG) if name in last[0]
    }
    if sensors:
        names = [v.name for v in of_sensors(sensors)]
        columns["sensor"] = sensors
        for k, what in enumerate(SENSED):
            columns[f"sensor_{what}"] = [[row[name] for row in last] for name in names[k :: len(SENSED)]]
            columns[f"sensor_maximum_{what}"] = [math.nan] * len(sensors)  # it may be between the rows
    columns["t"] = np.array([row["time"] for row in last]) - touch
    columns["event_time"] = np.array([event["time"] - touch for event in events])
    columns["event_kind"] = [event["kind"] for event in events]
    return {**columns, **{f"event_{name}": [event[name] for event in events] for name in (*MOTION, "stage")}}


def _scales(data: resource.Data) -> dict[str, float]:
    """Scales of the march as exported."""
    time = math.sqrt(data.start[reference("mass")] * data.length_scale / data.force_scale)
    return {
        "scale_length": data.length_scale,
        "scale_force": data.force_scale,
        "scale_time": time,
        "scale_velocity": data.length_scale / time,
    }


def _contacts(rows: list[Row], events: list[Row], touch: float) -> dict[str, list[float]]:
    """Columns of the contacts, from their events; the largest force is that of the last row before the next contact."""
    begins, ends = (
        [event for event in events if event["kind"] == native.EVENTS.index(f"contact_{which}")]
        for which in ("begins", "ends")
    )
    missing = [math.nan] * (len(begins) - len(ends))
    latest = {int(row["contact_count"]): row for row in rows} | {k: end for k, end in enumerate(ends, 1)}
    of_contact = [latest[k] for k in range(1, len(begins) + 1)]
    return {
        "contact_begin_time": [event["time"] - touch for event in begins],
        "contact_end_time": [event["time"] - touch for event in ends] + missing,
        "contact_approach_velocity": [event["relative_velocity"] for event in begins],
        "contact_rebound_velocity": [event["impactor_velocity"] for event in ends] + missing,
        **{f"contact_{name}": [row[name] for row in of_contact] for name in ("maximum_force", "maximum_indentation")},
    }


def _summary(events: list[Row], touch: float, peak: float, data: resource.Data) -> dict[str, float | None]:
    """Summary of all contacts as one impact, like that of a history on a target that vibrates, from the events and the
    largest force; `contact_duration` is that of the first contact."""
    summary: dict[str, float | None] = dict.fromkeys(SUMMARY)
    names = [native.EVENTS[int(event["kind"])] for event in events]
    ended = [k for k, name in enumerate(names) if name == "contact_ends"]
    end = len(names) if not ended else ended[-1]
    first = dict(zip(reversed(names[: end + 1]), reversed(events[: end + 1]), strict=True))
    turns = [e for e, name in zip(events[: end + 1], names, strict=False) if name == "maximum_indentation"]
    begins, ends = first.get("contact_begins"), events[end] if ended else None
    if turns:
        deepest = max(turns, key=lambda event: event["indentation"])
        summary["maximum_indentation"] = deepest["indentation"]
        summary["time_of_maximum_indentation"] = deepest["time"] - touch
        summary["maximum_force"] = max(peak, *(event["contact_force"] for event in events[: end + 1]))
    if "impactor_stops" in first:
        summary["time_impactor_stops"] = first["impactor_stops"]["time"] - touch
    if begins is not None and ends is not None:
        summary["contact_duration"] = first["contact_ends"]["time"] - touch
        summary["permanent_indentation"] = _dent(data, summary["maximum_indentation"] or 0.0, ends["indentation"])
        summary["rebound_velocity"] = ends["impactor_velocity"]
        # impactor velocities: at first touch the contact force may already move the target
        before, after = (event["impactor_velocity"] - event["support_velocity"] for event in (begins, ends))
        if before > 0.0:
            summary["coefficient_of_restitution"] = -after / before
    return summary


def _dent(data: resource.Data, depth: float, end: float) -> float:
    """The permanent indentation after a contact that turned at `depth` and ended at `end`, m."""
    curve, length = data.curve, data.length_scale
    yields = curve.stage[curve.stages - 1].unloading != native.RETRACE
    if curve.stage[0].damped or (curve.pull > 0.0 and not yields):
        return 0.0  # a damped law's dent closes later
    return length * dents(curve, depth / length, end / length) if curve.pull > 0.0 else end


def _stresses(rows: list[Row]) -> dict[str, float | None]:
    """Radius, dent, pressures and stresses of the impact; an output that stays 0 is unknown, but a dent's."""
    found = {name: max(row[name] for row in rows) for name in STRESSES}
    ended = any(native.PHASES[int(row["phase"])] == "separated" for row in rows)
    known = {name for name, value in found.items() if value > 0.0}
    known |= {"dent_diameter"} if ended and "contact_radius" in known else set()
    return {name: value if name in known else None for name, value in found.items()}


def _attributes(fmu: Fmu, interface: str, starts: Mapping[str, float], validity: int) -> dict[str, Any]:
    text, notes = _text(fmu, resource.SCENE), json.loads(_text(fmu, resource.NOTES))
    names = ("loading_segments", "unloading_segments")
    loading, unloading = (int(starts.get(name, fmu.data.start[reference(name)])) for name in names)
    return {
        **provenance(
            HISTORY,
            title=fmu.description.description or "Impact",
            summary=f"Impact simulated by an FMU (FMI {fmu.description.fmiVersion}), {interface}: motion and events.",
            source=f"{PROGRAM}, FMU under FMPy",
            command="fmu_wrapper.run",
            comment="t is the time in seconds from first touch, not a date. An FMU reports no segments and no "
            "energies. Scene, effects and warnings are those of the export; the attribute start_values has the values "
            "that were set for this run.",
        ),
        **text_and_hash("scene", text),
        "contact_law": notes["contact_law"],
        "outcome": "see events",
        "effects": "\n".join(notes["effects"]),
        "warnings": "\n".join([*notes["warnings"], *dict.fromkeys(fmu.notices)]) or "none",
        "validity": np.int32(validity),
        "estimated_accuracy": math.nan,
        "segments": np.int32(loading),
        "unloading_segments": np.int32(unloading),
    }

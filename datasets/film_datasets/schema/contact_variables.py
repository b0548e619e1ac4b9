"""The variables of each contact of a component that was run in steps."""

from __future__ import annotations

from film_datasets.schema.motion_variables import number

_NOT_YET = "NaN if the run ended before"

_CONTACTS = {
    "contact_begin_time": ("time", "time of the first touch of each contact"),
    "contact_end_time": ("time", f"time of the end of each contact; {_NOT_YET}"),
    "contact_approach_velocity": ("velocity", "relative velocity at the first touch of each contact"),
    "contact_rebound_velocity": ("velocity", f"impactor velocity at the end of each contact; {_NOT_YET}"),
    "contact_maximum_force": ("force", "largest force of each contact"),
    "contact_maximum_indentation": ("length", "largest indentation of each contact"),
}

CONTACTS = tuple(
    number(name, ("contact",), dimension, *what.split("; "), optional="; " in what)
    for name, (dimension, what) in _CONTACTS.items()
)

"""The FMU variables, from the one table `variables.csv`; XML files and the runtime's `variables.h` are made from it."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from film_model.solve.history import SUMMARY
from film_model.solve.sensed import MOTION
from film_model.targets.sensors import sensor_words

Kind = Literal["impact", "contact"]
KINDS: tuple[Kind, ...] = ("impact", "contact")
"""Kinds of FMUs: an impactor with its mass, or the force element between two bodies that the importer models."""

Real, Whole = "Real", "Whole"
"""Types of variables that are numbers; the others are those of `ITEMS`."""

CHANGES = ("any_time", "in_model_exchange", "at_steps", "at_events", "at_contacts")
"""When real variables change: at any time; the same, of variables of Model Exchange only; with the steps of
Co-Simulation; with events; with the events of a contact, at whose beginning they are 0 again."""


@dataclass(frozen=True)
class Variable:
    """One variable. Its index in `VARIABLES` is its value reference; those of sensors follow these.

    type: one of the five. dimension: of `film_model.base.units`, None for whole numbers and enumerations. causality: by
    kind of FMU; kinds that do not have the variable are left out. low, high: range of values that may be set, or that
    an output can have (none for energies that are differences, since rounding may pass it, for forces and ends of
    contacts that adhere, and for times, which the importer may begin below zero). rate_of: the state whose time
    derivative it is. event: the event whose time it is. changes: when, one of
    `CHANGES`. depends: states and inputs that it depends on directly;
    depends_damped: further ones if the law is damped. group: "stress", of summary values that follow from the largest
    force and indentation; "friction", of FMUs with friction only.
    """

    name: str
    type: str
    dimension: str | None
    causality: Mapping[Kind, str]
    variability: str
    description: str
    low: float | None = None
    high: float | None = None
    rate_of: str | None = None
    depends: Mapping[Kind, tuple[str, ...]] = field(default_factory=dict)
    depends_damped: Mapping[Kind, tuple[str, ...]] = field(default_factory=dict)
    event: str | None = None
    changes: str = "any_time"
    group: str = ""


def _rows(name: str) -> list[dict[str, str]]:
    with open(Path(__file__).with_name(name), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _variable(row: dict[str, str]) -> Variable:
    """A row of the table. The dimension of a real number, if it is empty, and the begin of its description are those of
    the summary value of this name; variables that change between steps of the importer are tunable."""
    number = int if row["type"] == Whole else float
    low, high = (number(float(row[end])) if row[end] else None for end in ("low", "high"))
    dimension, text = row["dimension"] or None, row["description"]
    if row["type"] == Real and dimension is None:
        dimension, text = SUMMARY[row["name"]][0], f"{SUMMARY[row['name']][1]}; {text}"
    return Variable(
        name=row["name"],
        type=row["type"],
        dimension=dimension,
        causality={kind: row[kind] for kind in KINDS if row[kind]},
        variability=row["variability"],
        description=text,
        low=low,
        high=high,
        rate_of=row["rate_of"] or None,
        depends={kind: tuple(row[f"depends_{kind}"].split()) for kind in KINDS},
        depends_damped={kind: tuple(row[f"damped_{kind}"].split()) for kind in KINDS},
        event=row["event"] or None,
        changes=row["changes"],
        group=row["group"],
    )


VARIABLES: tuple[Variable, ...] = tuple(map(_variable, _rows("variables.csv")))

ITEMS: dict[str, dict[str, str]] = {}
"""Types that are enumerations: their items in the order of the core's codes, which are their values, with meanings."""
for _row in _rows("enumerations.csv"):
    ITEMS.setdefault(_row["type"], {})[_row["item"]] = _row["description"]

PHASES, EVENT_KINDS, SLIDINGS = ITEMS["Phase"], ITEMS["EventKind"], ITEMS["Sliding"]

NORMAL_STATES = ("indentation", "impactor_velocity", "target_displacement")
STATES = (*NORMAL_STATES, "sliding_displacement", "tangential_velocity", "spin", "tangential_impulse")
"""Continuous states of an impact, in the order of the state vector: without friction, and with it. The contact has
none."""

EVENT_TIMES = {variable.name: variable.event for variable in VARIABLES if variable.event is not None}
"""Outputs that are times of events, and the events, in the order of events at one time."""

STRESSES, OF_FRICTION = (tuple(v.name for v in VARIABLES if v.group == group) for group in ("stress", "friction"))

LEFT = tuple(
    v.name
    for v in VARIABLES
    if v.type == Real
    and v.variability == "discrete"
    and "impact" in v.causality
    and v.name not in ("mean_contact_force", *OF_FRICTION)
)
"""Outputs that events and contacts leave: an impact in Co-Simulation has their derivatives by parameters."""


_REFERENCES = {variable.name: k for k, variable in enumerate(VARIABLES)}


def reference(name: str) -> int:
    """The value reference of a variable."""
    return _REFERENCES[name]


RIGID = float(VARIABLES[reference("target_impedance")].high or 0.0)
"""A target with this impedance [N s/m] or more does not move: a half-space."""

LEAST_RESTITUTION = float(VARIABLES[reference("restitution")].low or 0.0)
"""Smallest coefficient of restitution that can be set after export."""


def settable() -> int:
    """Number of leading variables that include all parameters and inputs."""
    causes = [set(variable.causality.values()) & {"parameter", "input"} for variable in VARIABLES]
    return max(k for k, cause in enumerate(causes) if cause) + 1


def of_sensors(names: Iterable[str]) -> tuple[Variable, ...]:
    """The motion of the sensors that an FMU has: sensor_tip_displacement, …; the value references follow those of
    `VARIABLES`."""
    output: dict[Kind, str] = {"impact": "output"}
    return tuple(
        Variable(
            *(f"sensor_{word}_{what}", Real, of, output, "continuous", f"{what} of the sensor {word}"),
            depends={"impact": ("support_velocity",) if what == "velocity" else ()},
        )
        for word in sensor_words(names)
        for what, (of, _) in MOTION.items()
    )

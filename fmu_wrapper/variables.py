"""The one table of FMU variables: the XML files and the runtime's header `variables.h` are generated from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from film_model.core.native import MAX_STAGES
from film_model.solve.history import SUMMARY

Kind = Literal["impact", "contact"]
KINDS: tuple[Kind, ...] = ("impact", "contact")
"""Kinds of FMUs: an impactor with its mass, or the force element between two bodies that the importer models."""

RIGID = 1e30
"""A target with this impedance [N s/m] or more does not move: a half-space."""

LEAST_RESTITUTION = 0.01
"""Smallest coefficient of restitution that can be set after export."""

Real, Whole, Phase, EventKind, Sliding = "Real", "Whole", "Phase", "EventKind", "Sliding"
"""Types of variables: real number, whole number, and three enumerations."""

PHASES = {
    "approaching": "no contact yet",
    "loading": "indentation increases along the loading curve",
    "unloading": "indentation decreases",
    "reloading": "indentation increases along the unloading branch",
    "resting": "in contact and at rest",
    "separated": "contact has ended",
}
EVENT_KINDS = {
    "none": "no event yet",
    "contact_begins": "first touch",
    "stage_changes": "the next or previous stage of the contact law begins",
    "maximum_indentation": "indentation stops increasing",
    "impactor_stops": "the impactor's velocity decreases to zero",
    "contact_ends": "the contact force decreases to zero and the bodies separate",
    "reloading_begins": "indentation stops decreasing",
}
SLIDINGS = {
    "free": "no contact",
    "sticks": "the whole contact sticks",
    "slips": "its rim slips, its middle sticks",
    "slip_reverses": "it slips with another sign; as an event only, then it slips",
    "slides": "the whole contact slides",
}
"""Items of the enumerations in the order of the core's codes, which are their values."""

TUNABLE = ("gravity", "friction", "damping", "dissipation_time", "hysteresis_damping", "restitution")
"""Parameters that may change between steps; those of damping serve the contacts that begin after that."""

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
    depends_damped: further ones if the law is damped.
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


def _parameter(name: str, dimension: str, low: float, high: float, description: str, *kinds: Kind) -> Variable:
    causality = dict.fromkeys(kinds or ("impact",), "parameter")
    variability = "tunable" if name in TUNABLE else "fixed"
    return Variable(name, Real, dimension, causality, variability, description, low, high)


def _segments(name: str, description: str) -> Variable:
    return Variable(name, Whole, None, {"impact": "parameter"}, "fixed", description, 1, 1_000_000)


def _motion(name: str, dimension: str, description: str, *depends: str, damped: tuple[str, ...] = ()) -> Variable:
    on: dict[Kind, tuple[str, ...]] = {"impact": depends}
    more: dict[Kind, tuple[str, ...]] = {"impact": damped}
    role: dict[Kind, str] = {"impact": "output"}
    return Variable(name, Real, dimension, role, "continuous", description, None, None, None, on, more)


def _of_steps(name: str, dimension: str, description: str) -> Variable:
    """An output that Co-Simulation computes over its steps."""
    text = f"{description}; 0 in Model Exchange"
    return Variable(name, Real, dimension, {"impact": "output"}, "discrete", text, changes="at_steps")


def _discrete(
    name: str,
    of: str,
    dimension: str | None,
    description: str,
    *kinds: Kind,
    low: float | None = None,
    high: float | None = None,
    changes: str = "any_time",
) -> Variable:
    role = dict.fromkeys(kinds or ("impact",), "output")
    return Variable(name, of, dimension, role, "discrete", description, low, high, changes=changes)


def _time_of(event: str, name: str, description: str) -> Variable:
    role: dict[Kind, str] = {"impact": "output"}
    text = f"{description}, latest contact; 0 before it happens"
    return Variable(name, Real, "time", role, "discrete", text, event=event, changes="at_contacts")


def _summary(name: str, *kinds: Kind, low: float | None = None) -> Variable:
    """An output that is a summary value of the latest contact."""
    dimension, description = SUMMARY[name]
    unknown = "before it is known, or if it is not" if name in STRESSES else "before it is known"
    text = f"{description}; latest contact, 0 {unknown}"
    return _discrete(name, Real, dimension, text, *kinds, low=low, changes="at_contacts")


STRESSES = (
    *("contact_radius", "dent_diameter", "mean_pressure", "peak_pressure", "maximum_shear_stress"),
    *("maximum_von_mises_stress", "depth_of_maximum_stress"),
)
"""Summary values that follow from the largest force and indentation."""


def _rate(state: str, dimension: str, depends: tuple[str, ...], damped: tuple[str, ...]) -> Variable:
    """The time derivative of a state."""
    on: dict[Kind, tuple[str, ...]] = {"impact": depends}
    more: dict[Kind, tuple[str, ...]] = {"impact": damped}
    role: dict[Kind, str] = {"impact": "local"}
    text = f"time derivative of {state}"
    found = Variable(f"rate_of_{state}", Real, dimension, role, "continuous", text, None, None, state, on, more)
    return replace(found, changes="in_model_exchange")


_BOTH: tuple[Kind, Kind] = KINDS

VARIABLES: tuple[Variable, ...] = (
    Variable("time", Real, "time", dict.fromkeys(KINDS, "independent"), "continuous", "time"),
    _parameter("mass", "mass", 1e-28, 1e12, "mass of the impactor"),
    _parameter("initial_velocity", "velocity", -2e4, 2e4, "velocity of the impactor at the start"),
    _parameter("initial_gap", "length", 0.0, 1e5, "distance to first touch at the start"),
    _parameter("radius", "length", 1e-10, 1e3, "effective radius of the contact", *_BOTH),
    _parameter("effective_modulus", "pressure", 1.0, 1e14, "effective modulus of the contact", *_BOTH),
    _parameter(
        *("yield_strength", "pressure", 1.0, 1e13),
        *("yield strength of the contact; dynamic, at the rate of the scene's impact, if its material hardens", *_BOTH),
    ),
    _parameter("yield_pressure", "pressure", 1.0, 1e13, "contact pressure at which the law yields", *_BOTH),
    _parameter("hardness", "pressure", 1.0, 1e13, "hardness of the body that yields", *_BOTH),
    _parameter("stiffness", "stiffness", 1e-12, 1e18, "stiffness of the law", *_BOTH),
    _parameter(
        *("power_stiffness", "dimensionless", 1e-30, 1e30),
        *("stiffness K in N/m^q of a law with the force K times indentation to the power of q", *_BOTH),
    ),
    _parameter(
        "exponent", "dimensionless", 0.1, 10.0, "exponent q of a law whose force is a power of indentation", *_BOTH
    ),
    _parameter("damping", "impedance", 1e-30, 1e30, "damping coefficient of the law", *_BOTH),
    _parameter("dissipation_time", "time", 1e-30, 1e10, "dissipation time of the law", *_BOTH),
    _parameter("hysteresis_damping", "inverse_velocity", 1e-30, 1e30, "damping over the elastic force", *_BOTH),
    _parameter(
        *("restitution", "dimensionless", LEAST_RESTITUTION, 1.0),
        *("coefficient of restitution on a fixed target, of a damped law that is given one", *_BOTH),
    ),
    _parameter(
        "target_impedance",
        "impedance",
        1e-30,
        RIGID,
        f"wave impedance of the target; a target with {RIGID:g} or more does not move",
    ),
    _parameter(
        *("target_stiffness", "stiffness", 1e-12, 1e18),
        "static stiffness of the target, which follows the contact force without delay",
    ),
    _parameter("gravity", "acceleration", -1e9, 1e9, "acceleration of free fall towards the target"),
    _parameter("friction", "dimensionless", 0.0, 100.0, "coefficient of friction"),
    _parameter(
        *("initial_tangential_velocity", "velocity", -2e4, 2e4),
        "velocity of the impactor's centre along the surface at the start",
    ),
    _parameter(
        "initial_spin", "angular_frequency", -1e7, 1e7, "spin at the start; positive spin adds to tangential velocity"
    ),
    _parameter(
        *("input_extrapolation", "dimensionless", 0.0, 2.0),
        "after a step, contact_force belongs to the indentation extrapolated by this many steps from its last input",
        "contact",
    ),
    _segments("loading_segments", "linear force segments in each loading stage"),
    _segments("unloading_segments", "linear force segments in unloading; the core uses more if contact ends slowly"),
    *(
        Variable(name, Real, dimension, {"impact": "input"}, "continuous", description)
        for name, dimension, description in (
            ("external_force", "force", "force on the impactor other than gravity and contact force"),
            ("support_velocity", "velocity", "velocity of the target's support"),
            ("tangential_force", "force", "force on the impactor's centre along the surface"),
            ("torque", "torque", "torque on the impactor, in the direction of positive spin"),
            ("tangential_support_velocity", "velocity", "velocity of the target along the surface"),
        )
    ),
    Variable(
        "indentation",
        Real,
        "length",
        {"impact": "output", "contact": "input"},
        "continuous",
        "impactor displacement minus target displacement; negative: a gap",
        depends={"impact": ("indentation",)},
    ),
    Variable(
        "relative_velocity",
        Real,
        "velocity",
        {"impact": "output", "contact": "input"},
        "continuous",
        "rate of indentation",
        depends={"impact": ("indentation", "impactor_velocity", "support_velocity")},
    ),
    _motion("impactor_velocity", "velocity", "velocity of the impactor", "impactor_velocity"),
    _motion(
        "impactor_displacement",
        "length",
        "displacement of the impactor from the point of first touch",
        *("indentation", "target_displacement"),
    ),
    _motion("target_displacement", "length", "displacement of the struck point of the target", "target_displacement"),
    _motion(
        "target_velocity",
        "velocity",
        "velocity of the struck point of the target",
        *("indentation", "support_velocity"),
        damped=("impactor_velocity",),
    ),
    _motion(
        "impactor_acceleration",
        "acceleration",
        "acceleration of the impactor",
        *("indentation", "external_force"),
        damped=("impactor_velocity", "support_velocity"),
    ),
    Variable(
        "contact_force",
        Real,
        "force",
        dict.fromkeys(KINDS, "output"),
        "continuous",
        "force of the contact law; it pushes the bodies apart",
        depends=dict.fromkeys(KINDS, ("indentation",)),
        depends_damped={"impact": ("impactor_velocity", "support_velocity"), "contact": ("relative_velocity",)},
    ),
    replace(_motion("kinetic_energy", "energy", "kinetic energy of the impactor", "impactor_velocity"), low=0.0),
    _of_steps("mean_contact_force", "force", "mean of contact_force over the last communication step"),
    _of_steps("contact_impulse", "impulse", "integral of contact_force over time"),
    _of_steps("contact_energy", "energy", "work done on the indentation: stored and absorbed by the contact"),
    _of_steps("target_energy", "energy", "work done by contact_force on the target and its support"),
    _of_steps("external_work", "energy", "work done by gravity and external_force on the impactor"),
    *(
        _discrete(name, Real, dimension, description, low=low, changes="at_steps")
        for name, dimension, description, low in (
            ("sliding_velocity", "velocity", "velocity of the contacting point relative to the target", None),
            ("tangential_velocity", "velocity", "velocity of the impactor's centre along the surface", None),
            ("spin", "angular_frequency", "spin of the impactor", None),
            ("friction_force", "force", "friction force, against sliding", None),
            ("tangential_impulse", "impulse", "integral of friction_force over time", None),
            ("friction_work", "energy", "energy that friction has dissipated", None),
        )
    ),
    _discrete("sliding", Sliding, None, "how the contact slides", changes="at_steps"),
    _discrete("sliding_event_count", Whole, None, "number of phases of sliding so far", low=0, changes="at_steps"),
    _discrete("last_sliding_event", Sliding, None, "the latest phase of sliding that began", changes="at_steps"),
    _discrete("time_of_last_sliding_event", Real, "time", "when it began; 0 before the first", changes="at_steps"),
    _discrete("phase", Phase, None, "phase of the motion", *_BOTH),
    _discrete(
        *("stage", Whole, None, "stage of the contact law from 0; -1 unloading, -2 no contact", *_BOTH),
        low=-2,
        high=MAX_STAGES - 1,
    ),
    _discrete("contact_count", Whole, None, "number of contacts so far", *_BOTH, low=0),
    _discrete("event_count", Whole, None, "number of events so far", low=0),
    _discrete("last_event", EventKind, None, "the latest event"),
    _discrete("time_of_last_event", Real, "time", "time of the latest event; 0 before the first", changes="at_events"),
    _time_of("contact_begins", "time_contact_begins", "time of first touch"),
    _time_of("maximum_indentation", "time_of_maximum_indentation", "time of maximum indentation"),
    _summary("maximum_indentation", *_BOTH, low=0.0),
    _summary("maximum_force", *_BOTH, low=0.0),
    _time_of("impactor_stops", "time_impactor_stops", "time at which the impactor's velocity is zero"),
    _time_of("contact_ends", "time_contact_ends", "time at which contact ends"),
    _summary("rebound_velocity"),
    _summary("permanent_indentation", *_BOTH),
    *(_summary(name, *_BOTH, low=0.0) for name in STRESSES),
    *(
        _discrete(
            f"largest_{of}", Real, dimension, f"largest {of} of all contacts", *_BOTH, low=0.0, changes="at_events"
        )
        for of, dimension in (("force", "force"), ("indentation", "length"))
    ),
    _discrete("phase_code", Whole, None, "phase as a whole number", *_BOTH, low=0, high=len(PHASES) - 1),
    _discrete("last_event_code", Whole, None, "last_event as a whole number", low=0, high=len(EVENT_KINDS) - 1),
    _discrete(
        *("validity", Whole, None),
        "0: the assumptions of the export hold; otherwise the sum of 1: a parameter, or the velocity at first touch "
        "of a contact, is outside its range of validity, 2: the contact yields but the law is elastic, 4: the contact "
        "is too wide for the law, 8: a contact alone lasted fewer than 20 communication steps",
        *_BOTH,
        low=0,
        high=15,
    ),
    *(
        _rate(state, dimension, depends, damped)
        for state, dimension, depends, damped in (
            ("indentation", "velocity", ("indentation", "impactor_velocity", "support_velocity"), ()),
            (
                *("impactor_velocity", "acceleration", ("indentation", "external_force")),
                ("impactor_velocity", "support_velocity"),
            ),
            ("target_displacement", "velocity", ("indentation", "support_velocity"), ("impactor_velocity",)),
        )
    ),
    *(
        Variable(
            f"event_indicator_{k + 1}",
            Real,
            "dimensionless",
            dict.fromkeys(KINDS, "local"),
            "continuous",
            f"event indicator, positive until an event is due: {what}",
            changes="in_model_exchange",
        )
        for k, what in enumerate(
            (
                "the indentation rate changes sign",
                "end of the stage in the direction of motion, or a damped force falls to zero",
                "end of the stage against the direction of motion",
                "the impactor stops",
                "a damped force has its maximum",
            )
        )
    ),
)

STATES = ("indentation", "impactor_velocity", "target_displacement")
"""Continuous states of the impact, in the order of the state vector. The contact has none."""

EVENT_TIMES = {variable.name: variable.event for variable in VARIABLES if variable.event is not None}
"""Outputs that are times of events, and the events, in the order of events at one time."""

OF_FRICTION = (
    *("friction", "initial_tangential_velocity", "initial_spin"),
    *("tangential_force", "torque", "tangential_support_velocity"),
    *("sliding_velocity", "tangential_velocity", "spin", "friction_force", "tangential_impulse", "friction_work"),
    *("sliding", "sliding_event_count", "last_sliding_event", "time_of_last_sliding_event"),
)
"""Variables of FMUs with friction only."""


LEFT = tuple(
    v.name
    for v in VARIABLES
    if v.type == Real
    and v.variability == "discrete"
    and "impact" in v.causality
    and v.name not in ("mean_contact_force", *OF_FRICTION)
)
"""Outputs that events and contacts leave: an impact in Co-Simulation has their derivatives by parameters."""


def reference(name: str) -> int:
    """The value reference of a variable."""
    return next(k for k, variable in enumerate(VARIABLES) if variable.name == name)


def settable() -> int:
    """Number of leading variables that include all parameters and inputs."""
    causes = [set(variable.causality.values()) & {"parameter", "input"} for variable in VARIABLES]
    return max(k for k, cause in enumerate(causes) if cause) + 1

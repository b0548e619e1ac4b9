"""The one table of FMU variables. The XML files and the runtime's header `runtime/variables.h` are generated from it.

Nothing but the standard library is imported here: the table is needed where film-model is built.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Kind = Literal["impact", "contact"]
KINDS: tuple[Kind, ...] = ("impact", "contact")
"""What an FMU is: an impactor with its mass inside, or the force element between two bodies of the importer's."""

RIGID = 1e30
"""A target impedance [N s/m] from which on the target does not move: a half-space."""

Real, Whole, Phase, EventKind = "Real", "Whole", "Phase", "EventKind"
"""Types: a number, a whole number, and the two enumerations."""

PHASES = {
    "approaching": "no contact yet",
    "loading": "indentation grows along the loading curve",
    "unloading": "indentation shrinks",
    "reloading": "indentation grows along the unloading branch",
    "resting": "in contact, at rest but for the smallest motion",
    "separated": "contact has ended",
}
EVENT_KINDS = {
    "none": "no event yet",
    "contact_begins": "first touch",
    "stage_changes": "the contact law's next or previous stage begins",
    "maximum_indentation": "indentation stops growing",
    "impactor_stops": "the impactor's velocity falls to zero",
    "contact_ends": "the contact force falls to zero and the bodies part",
    "reloading_begins": "indentation stops shrinking",
}
"""Items of the enumerations, in the order of the core's numbers, which are their values."""


@dataclass(frozen=True)
class Variable:
    """One variable; its place in `VARIABLES` is its value reference.

    type: one of the four. dimension: of `film_model.units`, None for whole numbers and enumerations. causality: by
    kind of FMU, absent where the variable does not exist. low, high: the smallest and largest value that may be set.
    rate_of: the state it is the time derivative of. depends: the states and inputs it depends on at the same time;
    depends_damped: those that it depends on besides if the law is damped.
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


def _parameter(name: str, dimension: str, low: float, high: float, description: str, *kinds: Kind) -> Variable:
    causality = dict.fromkeys(kinds or ("impact",), "parameter")
    return Variable(name, Real, dimension, causality, "fixed", description, low, high)


def _segments(name: str, description: str) -> Variable:
    return Variable(name, Whole, None, {"impact": "parameter"}, "fixed", description, 1, 1_000_000)


def _motion(
    name: str,
    dimension: str,
    description: str,
    *depends: str,
    rate_of: str | None = None,
    damped: tuple[str, ...] = (),
) -> Variable:
    on: dict[Kind, tuple[str, ...]] = {"impact": depends}
    more: dict[Kind, tuple[str, ...]] = {"impact": damped}
    role: dict[Kind, str] = {"impact": "output"}
    return Variable(name, Real, dimension, role, "continuous", description, None, None, rate_of, on, more)


def _discrete(name: str, of: str, dimension: str | None, description: str, *kinds: Kind) -> Variable:
    return Variable(name, of, dimension, dict.fromkeys(kinds or ("impact",), "output"), "discrete", description)


_BOTH: tuple[Kind, Kind] = KINDS
_LATEST = "of the latest contact; 0 until it happens"

VARIABLES: tuple[Variable, ...] = (
    Variable("time", Real, "time", dict.fromkeys(KINDS, "independent"), "continuous", "time"),
    _parameter("mass", "mass", 1e-28, 1e12, "mass of the impactor"),
    _parameter("initial_velocity", "velocity", -2e4, 2e4, "velocity of the impactor at the start"),
    _parameter("initial_gap", "length", 0.0, 1e5, "distance to first touch at the start"),
    _parameter("radius", "length", 1e-10, 1e3, "effective radius of the contact", *_BOTH),
    _parameter("effective_modulus", "pressure", 1.0, 1e14, "effective modulus of the contact", *_BOTH),
    _parameter("yield_strength", "pressure", 1.0, 1e13, "yield strength of the contact", *_BOTH),
    _parameter(
        "target_impedance",
        "impedance",
        1e-30,
        RIGID,
        f"wave impedance of the target; from {RIGID:g} on it does not move",
    ),
    _parameter("gravity", "acceleration", -1e9, 1e9, "acceleration of free fall towards the target"),
    _segments("loading_segments", "straight pieces of the force in a loading stage"),
    _segments("unloading_segments", "straight pieces of the force in unloading; more where contact fades out slowly"),
    Variable(
        "external_force",
        Real,
        "force",
        {"impact": "input"},
        "continuous",
        "force on the impactor besides gravity and contact",
    ),
    Variable(
        "support_velocity",
        Real,
        "velocity",
        {"impact": "input"},
        "continuous",
        "velocity of the target as a whole",
    ),
    Variable(
        "indentation",
        Real,
        "length",
        {"impact": "output", "contact": "input"},
        "continuous",
        "impactor displacement less target displacement; negative: a gap",
        depends={"impact": ("indentation",)},
    ),
    Variable(
        "relative_velocity",
        Real,
        "velocity",
        {"impact": "output", "contact": "input"},
        "continuous",
        "rate of indentation",
        rate_of="indentation",
        depends={"impact": ("indentation", "impactor_velocity", "support_velocity")},
    ),
    _motion("impactor_velocity", "velocity", "velocity of the impactor", "impactor_velocity"),
    _motion(
        "impactor_displacement",
        "length",
        "displacement of the impactor from where it would first touch",
        *("indentation", "target_displacement"),
    ),
    _motion("target_displacement", "length", "displacement of the struck point of the target", "target_displacement"),
    _motion(
        "target_velocity",
        "velocity",
        "velocity of the struck point of the target",
        *("indentation", "support_velocity"),
        rate_of="target_displacement",
        damped=("impactor_velocity",),
    ),
    _motion(
        "impactor_acceleration",
        "acceleration",
        "acceleration of the impactor",
        *("indentation", "external_force"),
        rate_of="impactor_velocity",
        damped=("impactor_velocity", "support_velocity"),
    ),
    Variable(
        "contact_force",
        Real,
        "force",
        dict.fromkeys(KINDS, "output"),
        "continuous",
        "force of the contact law, pressing the bodies apart",
        depends=dict.fromkeys(KINDS, ("indentation",)),
        depends_damped={"impact": ("impactor_velocity", "support_velocity"), "contact": ("relative_velocity",)},
    ),
    _discrete("phase", Phase, None, "where the impactor is", *_BOTH),
    _discrete("stage", Whole, None, "stage of the contact law from 0; -1 unloading, -2 no contact", *_BOTH),
    _discrete("contact_count", Whole, None, "number of contacts so far", *_BOTH),
    _discrete("event_count", Whole, None, "number of events so far"),
    _discrete("last_event", EventKind, None, "the latest event"),
    _discrete("time_of_last_event", Real, "time", "time of the latest event; 0 until there is one"),
    _discrete("time_contact_begins", Real, "time", f"first touch {_LATEST}"),
    _discrete("time_of_maximum_indentation", Real, "time", f"time of the largest indentation {_LATEST}"),
    _discrete("maximum_indentation", Real, "length", f"largest indentation {_LATEST}", *_BOTH),
    _discrete("maximum_force", Real, "force", f"largest contact force {_LATEST}", *_BOTH),
    _discrete("time_impactor_stops", Real, "time", f"time at which the impactor's velocity is zero {_LATEST}"),
    _discrete("time_contact_ends", Real, "time", f"end {_LATEST}"),
    _discrete("rebound_velocity", Real, "velocity", f"impactor velocity at the end {_LATEST}"),
    _discrete("permanent_indentation", Real, "length", f"indentation left at the end {_LATEST}", *_BOTH),
    *(
        Variable(
            f"event_indicator_{k + 1}",
            Real,
            "dimensionless",
            dict.fromkeys(KINDS, "local"),
            "continuous",
            f"an event is due when this falls to zero: {what}",
        )
        for k, what in enumerate(
            (
                "indentation turns",
                "the stage ends ahead, or a damped force falls to zero",
                "the stage ends behind",
                "impactor stops",
                "a damped force has its peak",
            )
        )
    ),
)

STATES = ("indentation", "impactor_velocity", "target_displacement")
"""Continuous states of the impact, in the order of the state vector. The contact has none."""

_ROLES = {"independent": "OUTPUT", "parameter": "PARAMETER", "input": "INPUT", "output": "OUTPUT", "local": "OUTPUT"}


def reference(name: str) -> int:
    """The value reference of a variable."""
    return next(k for k, variable in enumerate(VARIABLES) if variable.name == name)


def settable() -> int:
    """Number of leading variables that hold all parameters and inputs."""
    causes = [set(variable.causality.values()) & {"parameter", "input"} for variable in VARIABLES]
    return max(k for k, cause in enumerate(causes) if cause) + 1


def header(units: Mapping[str, str]) -> str:
    """The C header with the same table; `units`: the SI unit of each dimension."""
    rows = [
        "/* The variables, by value reference. Generated from fmu_wrapper/variables.py; do not edit. */",
        "#ifndef FILM_VARIABLES_H",
        "#define FILM_VARIABLES_H",
        "",
        "enum {",
        *(f"    {variable.name.upper()}," for variable in VARIABLES),
        "    VARIABLES,",
        f"    SETTABLE = {settable()} /* parameters and inputs come before this one */",
        "};",
        "",
        "enum { IMPACT, CONTACT, KINDS };",
        "enum { ABSENT, PARAMETER, INPUT, OUTPUT };",
        "enum { REAL, WHOLE, ENUMERATION };",
        "",
        f"static const double RIGID = {RIGID!r}; /* target impedance from which on the target does not move */",
        "",
        "typedef struct {",
        "    const char *name, *unit;",
        "    int type, role[KINDS];",
        "    double low, high;",
        "} film_variable;",
        "",
        "static const film_variable VARIABLE[VARIABLES] = {",
    ]
    types = {Real: "REAL", Whole: "WHOLE"}
    for v in VARIABLES:
        roles = ", ".join(_ROLES[v.causality[kind]] if kind in v.causality else "ABSENT" for kind in KINDS)
        low, high = (
            ("-1e300" if v.low is None else repr(float(v.low))),
            ("1e300" if v.high is None else repr(float(v.high))),
        )
        unit = "" if v.dimension is None else units[v.dimension]
        kind = types.get(v.type, "ENUMERATION")
        rows.append(f'    {{"{v.name}", "{unit}", {kind}, {{{roles}}}, {low}, {high}}},')
    return "\n".join([*rows, "};", "", "#endif", ""])

"""The structure `model_data` of runtime/model.h, in Python."""

from __future__ import annotations

import ctypes as c

from film_model.core import native, relaxing
from fmu_wrapper.variables import STATES, settable

MAGIC = b"FILMFMU4"
SCALING = (
    *("radius", "effective_modulus", "yield_strength", "yield_pressure", "hardness", "stiffness", "power_stiffness"),
)
"""Parameters whose powers make up the length and force scales of the march."""
OF_DAMPING = ("damping", "dissipation_time", "hysteresis_damping")
"""Parameters of damped laws whose powers make up only the damping factor."""
DAMPING = (*SCALING, "mass", "initial_velocity", *OF_DAMPING)
"""Parameters whose powers make up the damping factor of a damped law."""
OF_LAW = (*SCALING, "exponent", *OF_DAMPING, "restitution")
"""The law's own parameters."""
RESTITUTION_TERMS = 48
"""Terms of ln(damping factor/(1 − e)) over ln e."""
LIMITS = 2
REASON = 80  # bytes of the names of effects that end a range of validity
SHAPED = SCALING[:3]
"""Parameters whose powers make up the shape of a law with a family of curves: radius, modulus and strength."""

_SETTABLE = settable()
_D, _I = c.c_double, c.c_int32


class Family(c.Structure):
    """model_family of runtime/model.h."""

    _fields_ = (("shape", _D), ("power", _D * len(SHAPED)), ("low", _D), ("high", _D), ("nodes", _I), ("varying", _I))


class Modes(c.Structure):
    """model_modes of runtime/model.h."""

    _fields_ = (
        *((name, _D) for name in ("longest", "rest", "tolerance")),
        *((name, _I) for name in ("count", "levels", "sensors", "padding")),
    )


class Relaxing(c.Structure):
    """model_relaxation of runtime/model.h."""

    _fields_ = (("law", relaxing.Law), ("tolerance", _D))


class Friction(c.Structure):
    """model_friction of runtime/model.h."""

    _fields_ = (("ratio", _D), ("lever", _D), ("inertia", _D))


class Stresses(c.Structure):
    """model_stresses of runtime/model.h."""

    _fields_ = tuple(
        (name, _D)
        for name in (
            *("radius", "hertz", "first_radius", "onset", "spread", "lateness", "pressure", "pressure_flattened"),
            *("pressure_bend", "strain", "hardens", "share", "flattened", "sunk"),
            *("widening", "hertzian", "shallow", "shear", "depth"),
        )
    )


class Data(c.Structure):
    """model_data of runtime/model.h. tail: what follows it in the file."""

    _fields_ = (
        ("magic", c.c_char * 8),
        ("size", c.c_uint64),
        ("checksum", c.c_uint64),
        ("token", c.c_char * 64),
        ("kind", _I),
        ("linearisation", _I),
        ("available", _I * _SETTABLE),
        ("padding", _I),
        ("start", _D * _SETTABLE),
        ("length_scale", _D),
        ("length_power", _D * len(SCALING)),
        ("force_scale", _D),
        ("force_power", _D * len(SCALING)),
        ("damping", _D),
        ("damping_power", _D * len(DAMPING)),
        ("restitution", _D * RESTITUTION_TERMS),
        ("speed", _D),
        ("nominal", _D * len(STATES)),
        ("valid", (_D * 2) * _SETTABLE),
        ("also", _D * 2),
        ("reason", (c.c_char * REASON) * 2 * _SETTABLE),
        ("limit", _D * LIMITS),
        ("limit_power", (_D * len(SCALING)) * LIMITS),
        ("stresses", Stresses),
        ("curve", native.Curve),
        ("family", Family),
        ("modes", Modes),
        ("relaxation", Relaxing),
        ("friction", Friction),
    )
    tail = b""

"""The structure `model_data` of runtime/model.h."""

from __future__ import annotations

import ctypes as c
from pathlib import Path

from film_model.core import modal, relaxing, sliding
from film_model.core.headers import Header

MAGIC = b"FILMFMU6"
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
SHAPED = SCALING[:3]
"""Parameters whose powers make up the shape of a law with a family of curves: radius, modulus and strength."""

_RUNTIME = Path(__file__).parent / "runtime"
MODEL = Header(
    f"{_RUNTIME}/model.h",
    *(modal.MODAL, sliding.SLIDE, relaxing.RELAX, Header(f"{_RUNTIME}/variables.h")),
)
RESTITUTION_TERMS = MODEL.numbers["RESTITUTION_TERMS"]
"""Terms of ln(damping factor/(1 − e)) over ln e."""
REASON = MODEL.numbers["LONGEST_REASON"]
"""Bytes of the names of effects that end a range of validity."""


@MODEL.structure("model_family")
class Family(c.Structure):
    """Curves of a law with a shape."""


@MODEL.structure("model_modes")
class Modes(c.Structure):
    """Vibrations of a target."""


@MODEL.structure("model_relaxation")
class Relaxing(c.Structure):
    """Viscoelastic bodies."""


@MODEL.structure("model_friction")
class Friction(c.Structure):
    """Numbers of a contact with friction."""


@MODEL.structure("model_stresses")
class Stresses(c.Structure):
    """Numbers of stresses."""


@MODEL.structure("model_data")
class Data(c.Structure):
    """All data of an export. tail: what follows it in the file."""

    tail = b""

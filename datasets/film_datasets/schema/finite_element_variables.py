"""The variables of a dataset of finite-element impacts that yield, in units of first yield."""

from __future__ import annotations

from dataclasses import replace

from film_datasets.schema.motion_variables import number
from film_datasets.schema.variable import BYTE, Variable

_RUN, _WAY_IN, _WAY_OUT = ("run",), ("run", "depth_fraction"), ("run", "recovery_fraction")

_NUMBERS = tuple(
    number(name, dims, "dimensionless", long_name, comment)
    for name, dims, long_name, comment in (
        ("velocity_ratio", _RUN, "velocity over that of first yield", ""),
        ("stiffness_ratio", _RUN, "Young's modulus over yield strength", ""),
        ("hardening_exponent", _RUN, "hardening exponent", "n of the yield stress Y (1 + E eps_p/Y)^n"),
        ("poissons_ratio", _RUN, "Poisson's ratio", ""),
        ("coefficient_of_restitution", _RUN, "coefficient of restitution", ""),
        ("largest_depth", _RUN, "largest depth over that of first yield", ""),
        ("largest_force", _RUN, "force at the largest depth over that of first yield", ""),
        ("largest_radius", _RUN, "contact radius at the largest depth over that of first yield", ""),
        ("residual_depth", _RUN, "depth at which the force vanishes over that of first yield", ""),
        ("energy_balance", _RUN, "energy at the end over that of the approach less 1", ""),
        (
            "mesh_error",
            _RUN,
            "estimated relative error of the restitution from the mesh",
            "difference to a mesh of 20 instead of 32 elements over the contact radius, of the nearest velocity",
        ),
        ("depth_fraction", ("depth_fraction",), "depth over the largest depth", ""),
        ("loading_force", _WAY_IN, "force over that of first yield", ""),
        ("loading_radius", _WAY_IN, "contact radius over that of first yield", ""),
        ("recovery_fraction", ("recovery_fraction",), "depth less residual depth over the recovered depth", ""),
        ("unloading_force", _WAY_OUT, "force over that at the largest depth", ""),
    )
)

_HELD_OUT = Variable(
    *("held_out", _RUN, BYTE, None, "whether the fit of the closed forms leaves it out"),
    flags=((0, "fitted"), (1, "held_out")),
)

FINITE_ELEMENTS = (*_NUMBERS, _HELD_OUT)

_PAIR = {
    "stiffness_ratio": ("effective modulus times 1 - nu^2 over the yield strength", "the lower one of the strengths"),
    "mesh_error": ("relative difference of the restitution on a coarser mesh", "of the run with the nearest velocity"),
}

FINITE_ELEMENT_PAIRS = (
    *(
        replace(
            one,
            long_name=_PAIR.get(one.name, (one.long_name, ""))[0],
            comment=_PAIR.get(one.name, ("", one.comment))[1],
        )
        for one in _NUMBERS
        if one.dims == _RUN
    ),
    number("strength_ratio", _RUN, "dimensionless", "yield strength of the harder body over that of the softer"),
    number("modulus_ratio", _RUN, "dimensionless", "Young's modulus of the harder body over that of the softer"),
    number("harder_share", _RUN, "dimensionless", "part of the plastic work that the harder body takes"),
    Variable("softer", _RUN, BYTE, None, "which body is softer", flags=((0, "half_space"), (1, "ball"))),
    _HELD_OUT,
)
"""Of a ball on a half-space that both yield."""

"""Formulas of numbers alone that the page records."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any, cast

from film_model.base.flow_stress import contradicts, flow_of_hardness, yield_of_flow
from film_model.base.materials import sphere_mass
from film_model.effects import wave_losses
from film_model.effects.rate_hardening import secant
from film_model.explorer.support import scaled
from film_model.explorer.trace import Recording
from film_model.oblique import friction, springs
from film_model.oblique.result import doubted
from film_model.problem.brittle import failure
from film_model.problem.model_intervals import at_residual, extrapolated, kind_of
from film_model.scene.options import tolerance_for
from film_model.solve import structures
from film_model.targets import panel_statics, ritz_errors
from film_model.targets.bending_stiffness import unstable


def mass_of(radius: Any, density: Any) -> Any:
    """Of a sphere."""
    return sphere_mass(None, radius, cast("Any", SimpleNamespace(density=density)))


PLAIN: dict[str, tuple[Callable[..., Any], str]] = {
    "sphereMass": (mass_of, "mass"),
    "firstYield": (lambda h, exponent, modulus: yield_of_flow(flow_of_hardness(h), exponent, modulus), "strength"),
    "strengths": (contradicts, "contradict"),
    "failure": (lambda pressing, cracking, force, radius: failure((pressing, cracking), force, radius), "indicator"),
    "modeOf": (structures.mode_of, "frequency share ratio"),
    "onGrid": (structures.rounded, "to"),
    "secant": (secant, "step moves"),
    "degrees": (panel_statics.degrees, "x y"),
    "turns": (panel_statics.turns, "turns"),
    "corrected": (panel_statics.corrected, "compliance error"),
    "feltAlong": (panel_statics.felt_along, "near beyond cut ends"),
    "lacking": (panel_statics.lacking, "found vague"),
    "grown": (panel_statics.grown, "found error"),
    "missed": (ritz_errors.missed, "part"),
    "toleranceFor": (tolerance_for, "tolerance"),
    "unstable": (unstable, "unstable"),
    "wavesMatter": (wave_losses.may_matter, "may"),
    "kindOf": (kind_of, "kind"),
    "residual": (at_residual, "value"),
    "extrapolated": (extrapolated, "beyond"),
    "leaves": (friction.leaves, "left"),
    "bySprings": (friction.by_springs, "springs"),
    "doubted": (doubted, "inexact apart"),
    "normalError": (springs.normal_error, "error"),
    "scaled": (scaled, "rate share compliance stiffer"),
    "stepsOf": (springs.steps_of, "steps"),
    "ended": (springs.ended, "velocity"),
}
"""Functions of numbers alone, by their names on the page, and the names of what they return."""


def plain_functions() -> Iterator[str]:
    """Those of `PLAIN`."""
    for name, (function, outputs) in PLAIN.items():
        r, inputs = Recording(), tuple(inspect.signature(function).parameters)
        found = function(*map(r.symbol, inputs))
        values = found if isinstance(found, tuple) else (found,)
        yield r.function(name, ", ".join(inputs), dict(zip(outputs.split(), values, strict=True)))

"""LAMMPS, pair_style granular and fix wall/gran granular: Hertz or Hooke with its models of damping."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from film_model.translate import granular
from film_model.translate.law import Engine, EngineLaw, Pair, Parameter, Values

SOURCE = "LAMMPS documentation, pair_style granular"
NOTES = ("the damping force may attract at the end of contact: without limit_damping, as here",)


MINDLIN = {name: name for name in ("mindlin/force", "mindlin_rescale/force", "mindlin", "mindlin_rescale")}
LINEAR = {"linear_history": "hooke"}
"""Models of friction with the springs that they are."""


def _command(pair: Pair, coefficients: str, damping: str, stiffness: float, models: Mapping[str, str]) -> str:
    """stiffness: of the tangential spring, N/m, or Pa times the contact radius."""
    tangential = "linear_nohistory 0.0 0.0"
    if pair.friction is not None:
        tangential = f"{next(iter(models))} {stiffness:.6g} 0.0 {pair.friction:.6g}"
    model = f"{coefficients} tangential {tangential} damping {damping}"
    if not pair.fixed:
        return f"pair_style granular\npair_coeff * * {model}"
    if pair.target_radius < float("inf"):
        return f"pair_style granular\npair_coeff * * {model}\n# the target: a sphere with fix freeze"
    return f"fix target all wall/gran granular {model} zplane 0.0 NULL"


def _paste_restitution(pair: Pair, values: Values) -> str:
    e, nu = values["restitution"], pair.poissons_ratio
    material = f"hertz/material {values['youngs_modulus']:.6g} {e:.6g} {nu:.6g}"
    return _command(pair, material, "coeff_restitution", _mindlin_stiffness(pair, values), MINDLIN)


def _mindlin_stiffness(pair: Pair, values: Values) -> float:
    """8 G* = 2 E*/κ."""
    return 2.0 * pair.effective_modulus(values["youngs_modulus"]) / pair.ratio


def _paste_viscoelastic(pair: Pair, values: Values) -> str:
    material = f"{values['youngs_modulus']:.6g} {values['eta_n']:.6g} {pair.poissons_ratio:.6g}"
    return _command(pair, f"hertz/material {material}", "viscoelastic", _mindlin_stiffness(pair, values), MINDLIN)


def _hooke(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    k = values["k_n"]
    return k * depth + 2.0 * granular.log_decrement(values["restitution"]) * (pair.mass * k) ** 0.5 * rate


def _paste_hooke(pair: Pair, values: Values) -> str:
    material, k = f"hooke {values['k_n']:.6g} {values['restitution']:.6g}", values["k_n"]
    return _command(pair, material, "coeff_restitution", k / pair.ratio, LINEAR)


HERTZ = granular.law_by_restitution(
    "hertz", f"{SOURCE}: hertz/material, damping coeff_restitution", _paste_restitution, True, NOTES, MINDLIN
)

VISCOELASTIC = granular.law_with_viscosity(
    "hertz-viscoelastic",
    "F = √(Rδ) (4/3 E* δ + m η δ')",
    f"{SOURCE}: hertz/material, damping viscoelastic",
    (granular.modulus("youngs_modulus"), Parameter("eta_n", "1/(m s)", "damping")),
    _paste_viscoelastic,
    lambda pair: (pair.effective_modulus(4.0 / 3.0), 1.0),
    pulls=True,
    notes=NOTES,
    tangential=MINDLIN,
)

HOOKE = EngineLaw(
    name="hooke",
    formula="F = k δ + 2 ζ √(m k) δ', ζ from the restitution",
    source=f"{SOURCE}: hooke, damping coeff_restitution",
    parameters=(Parameter("k_n", "N/m", "stiffness", 1e-12, logarithmic=True), granular.RESTITUTION),
    force=_hooke,
    start=lambda pair, middle: {
        "k_n": middle.stiffness(1.0),
        "restitution": granular.start_by_restitution(pair, middle)["restitution"],
    },
    paste=_paste_hooke,
    pulls=True,
    notes=NOTES,
    tangential=LINEAR,
)

LAMMPS = Engine("lammps", "LAMMPS", (HERTZ, VISCOELASTIC, HOOKE))

"""LIGGGHTS: the granular models hertz and hooke by material properties, and hertz/stiffness by coefficients."""

from __future__ import annotations

from functools import partial

from film_model.translate import granular
from film_model.translate.law import Engine, Pair, Parameter, Values

SOURCE = "LIGGGHTS-PUBLIC documentation, gran model"
NOTES = ("the damping force may attract at the end of contact: limitForce is off, as by default",)
HOOKE_NOTES = (*NOTES, "without friction: the tangential stiffness of hooke is kn, whatever the materials")

HISTORY = {"tangential history": "mindlin"}
"""The model of friction and the spring that it is."""


def _property(name: str, value: float, kind: str) -> str:
    return f"fix {name} all property/global {name} {kind} {value:.6g}"


def _model(pair: Pair, model: str) -> str:
    friction = ""
    if pair.friction is not None and model != "hooke":  # there kt is kn
        friction = _property("coefficientFriction", pair.friction, "peratomtypepair 1") + "\n"
        model += " tangential history"
    lines = f"pair_style gran model {model}\npair_coeff * *"
    if pair.fixed and pair.target_radius == float("inf"):
        lines += f"\nfix target all wall/gran model {model} primitive type 1 zplane 0.0"
    return friction + lines


def _paste_material(model: str, pair: Pair, values: Values) -> str:
    lines = [
        _property("youngsModulus", values["youngs_modulus"], "peratomtype"),
        _property("poissonsRatio", pair.poissons_ratio, "peratomtype"),
        _property("coefficientRestitution", values["restitution"], "peratomtypepair 1"),
    ]
    if values["youngs_modulus"] > 1e9:  # LIGGGHTS asks for it above 1 GPa
        lines.insert(0, "hard_particles yes")
    if model == "hooke":
        lines.append(_property("characteristicVelocity", pair.velocity, "scalar"))
    return "\n".join([*lines, _model(pair, model)])


def _paste_coefficients(pair: Pair, values: Values) -> str:
    tangential = 0.0 if pair.friction is None else 1.5 * values["kn"] / pair.ratio  # 8 G* = 2 E*/κ, kn = 4/3 E*
    numbers = {"kn": values["kn"], "kt": tangential, "gamman": values["gamman"], "gammat": 0.0}
    lines = [_property(name, value, "peratomtypepair 1") for name, value in numbers.items()]
    return "\n".join([*lines, _model(pair, "hertz/stiffness")])


HERTZ = granular.law_by_restitution(
    "hertz", f"{SOURCE} hertz; normal_model_hertz.h", partial(_paste_material, "hertz"), True, NOTES, HISTORY
)

HOOKE = granular.law_by_restitution("hooke", f"{SOURCE} hooke", partial(_paste_material, "hooke"), True, HOOKE_NOTES)

STIFFNESS = granular.law_with_viscosity(
    "hertz-stiffness",
    "F = √(Rδ) (kn δ + m γ δ')",
    f"{SOURCE} hertz/stiffness",
    (Parameter("kn", "Pa", "stiffness", 1e-12, logarithmic=True), Parameter("gamman", "1/(m s)", "damping")),
    _paste_coefficients,
    pulls=True,
    notes=NOTES,
    tangential=HISTORY,
)

LIGGGHTS = Engine("liggghts", "LIGGGHTS", (HERTZ, HOOKE, STIFFNESS))

"""The entries of a scene that can be changed on the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, cast

from film_model.base.fields import Field, measure
from film_model.base.flow_stress import MOST_HARDENING
from film_model.base.materials import Material
from film_model.base.units import scene_unit
from film_model.scene import Scene, toml
from film_model.scene.friction_table import FrictionTable
from film_model.scene.impactor import STEEPEST
from film_model.scene.rolling import stiffness_ratio
from film_model.targets import Plate
from film_model.targets.target import LENGTH, PLACE, RADIUS

_POSITIVE = (1.0 / 20.0, 20.0)
"""Least and largest value of a slider over the value of the scene."""

LABELS = {
    **{"youngs_modulus": "Young's modulus", "poissons_ratio": "Poisson's ratio"},
    **{name: f"bending stiffness {name}" for name in ("D11", "D12", "D22", "D66")},
    **{f"target.{what}.{k}": f"{what} along {axis}" for what in ("size", "position") for k, axis in enumerate("xy")},
}

RATE_ENTRIES = ("strain_rate_coefficient", "rate_multiplier", "rate_exponent")
STRENGTH_ENTRIES = ("yield_strength", "hardness", "strain_hardening_exponent")
MATERIAL_ENTRIES = (*("youngs_modulus", "poissons_ratio", "density", *STRENGTH_ENTRIES, "loss_factor"), *RATE_ENTRIES)
OPTIONAL = (*STRENGTH_ENTRIES, "loss_factor", *RATE_ENTRIES)
"""Entries that may be missing: infinite for the formulas, so that the material does not yield, harden or damp; see also
`EMPTY`."""

ALONG = ("impactor.angle", "impactor.spin", "contact.friction")
"""Entries of an impact at an angle or with spin."""

PLATE = tuple(f"target.{name}.{side}" for name in ("size", "position") for side in (0, 1))
"""Entries of a plate that may have edges, beside its damping ratio."""

USUAL_SIDE = 0.3
"""Middle of the slider of the side [m] of a plate that is given without."""

JUDGED = ("work_of_adhesion", "roughness", "fluid_viscosity")
"""Entries of the contact from which effects are estimated that the page does not judge again."""

EMPTY = {
    **{"mass": "from the density", "angle": "0", "spin": "0", "strain_hardening_exponent": "0"},
    **dict.fromkeys(PLATE[:2], "infinite"),
    **dict.fromkeys(PLATE[2:], "centre"),
}
"""What stands in the field of an entry that is missing, if not "none"; "0" for the formulas too."""

MAY_BE_0 = (
    *("drop_height", "velocity", "loss_factor", "angle", "friction", "damping_ratio"),
    "strain_hardening_exponent",
)
"""Entries whose least value is 0, not just above it."""

RANGES = {"hardness": (1e8, 1e10), "strain_hardening_exponent": (0.0, MOST_HARDENING)}
"""Usual values of a material's entries that may be missing or 0."""


@dataclass(frozen=True)
class Input:
    """One entry: its path in the scene, its field, and its value [SI]; None if it is missing and may be. A table of
    friction has speeds and coefficients in turn.

    range: of its slider; by default around the value, or around `present`, which the formulas take if it is missing.
    """

    path: str
    field: Field
    value: float | list[float] | None
    range: tuple[float, float] | None = None
    present: float | None = None

    @property
    def optional(self) -> bool:
        """Whether it may be missing."""
        name = self.path.rpartition(".")[2]
        return name in (*OPTIONAL, "mass", "damping_ratio") or self.path in (*ALONG, *PLATE)

    def to_dict(self) -> dict[str, Any]:
        """What the page needs. slider: its range, and whether it is logarithmic."""
        name, low, high = self.path.rsplit(".", 1)[1], self.field.low, self.field.high
        assert low is not None and high is not None
        value = self.value if isinstance(self.value, float) else self.present
        if name == "radius" and low < 0.0:  # a slider does not pass from a ball through a flat to a hollow
            least = cast("float", RADIUS.low)
            low, high = (least, high) if (value or 0.0) > 0.0 else (low, -least)
        logarithmic = self.range is None and value is not None and 0.0 < value < math.inf and low >= 0.0
        if logarithmic:
            assert value is not None
            slider = [max(low, value * _POSITIVE[0]), min(high, value * _POSITIVE[1])]
        elif self.range is not None:
            slider = list(self.range)
        elif high < 0.0:
            slider = [max(low, (value or 0.0) * _POSITIVE[1]), min(high, (value or 0.0) * _POSITIVE[0])]
        else:
            size = max(abs(value or 0.0), 1.0 if high > 1.0 else high)
            slider = [max(low, -10.0 * size), min(high, 10.0 * size)]
        return {
            "path": self.path,
            "label": LABELS.get(self.path, LABELS.get(name, name.replace("_", " "))),
            "unit": scene_unit(self.field.dimension),
            "dimension": self.field.dimension,
            "low": low,
            "high": high,
            "open": self.field.open_ends or (low == 0.0 and name not in MAY_BE_0),
            "slider": slider,
            "logarithmic": logarithmic,
            "value": None if self.value in (math.inf, -math.inf) else self.value,
            "optional": self.optional,
            "empty": EMPTY.get(self.path, EMPTY.get(name, "none")),
            "missing": 0.0 if EMPTY.get(name) == "0" else None,
        }


def with_exponents(scene: Scene) -> Scene:
    """The scene with strain hardening exponents in place of Johnson and Cook's constants."""
    changes: dict[str, Any] = {}
    for path, body in (("impactor", scene.impactor), ("target", scene.target)):
        if body.material is not None and body.material.strength_coefficient is not None:
            changes |= dict.fromkeys(f"{path}.material.strength_{name}" for name in ("coefficient", "exponent"))
            changes[f"{path}.material.strain_hardening_exponent"] = body.material.hardening_exponent
    return scene.replace(changes) if changes else scene


def in_place_of(entries: Iterable[Input]) -> dict[str, str]:
    """Entries by the path of the one that is set in their place."""
    paths = [entry.path for entry in entries]
    return {path: other for path in paths if (other := toml.in_place_of(path)) in paths}


def inputs_of(scene: Scene) -> tuple[Input, ...]:
    """The entries of a scene, in the order of scene files."""
    sections = (("impactor", scene.impactor), ("target", scene.target), ("contact", scene.contact))
    found = [entry for path, owner in sections for entry in _entries(path, owner)]
    return (*found, *along_of(scene))


def along_of(scene: Scene) -> tuple[Input, ...]:
    """Angle, spin and friction: all of them if friction of these bodies is known, otherwise those that are given."""
    ball, contact = scene.impactor, scene.contact
    rolling = 2.0 * max(scene.impactor.path_speed, scene.approach_velocity) / ball.radius
    friction = contact.friction
    if isinstance(friction, FrictionTable):
        friction = [number for row in friction.rows for number in row]
    entries = (
        Input(ALONG[0], ball.FIELDS["angle"], ball.angle, (0.0, STEEPEST)),
        Input(ALONG[1], ball.FIELDS["spin"], ball.spin, (-rolling, rolling)),
        Input(ALONG[2], contact.FIELDS["friction"], friction, (0.0, 1.0)),
    )
    known = contact.effective_modulus is None and stiffness_ratio(scene) is not None
    return tuple(entry for entry in entries if known or entry.value is not None)


def plate_inputs(target: Plate) -> tuple[Input, ...]:
    """Size, position of the impact and damping ratio of a plate that may have edges."""
    sides = target.size or (None, None)
    found = [Input(path, LENGTH, side, present=USUAL_SIDE) for path, side in zip(PLATE, sides, strict=False)]
    for path, side, place in zip(PLATE[2:], sides, target.position or (None, None), strict=True):
        found.append(Input(path, PLACE, place, (0.0, side or USUAL_SIDE)))
    return (*found, damping_input(cast("float | None", target.damping_ratio)))


def damping_input(ratio: float | None) -> Input:
    """The damping ratio of all vibrations of a target."""
    return Input("target.damping_ratio", measure("dimensionless", 0, 0.999), ratio, (0.0, 0.2))


def _entries(path: str, owner: Any) -> Iterator[Input]:
    for name, field in owner.FIELDS.items():
        value, here = getattr(owner, name), f"{path}.{name}"
        if isinstance(value, Material):
            multiplied = value.rate_multiplier is not None
            others = ("strain_rate_coefficient",) if multiplied else ("rate_multiplier", "rate_exponent")
            for entry in (entry for entry in MATERIAL_ENTRIES if entry not in others):
                yield Input(f"{here}.{entry}", Material.FIELDS[entry], getattr(value, entry), RANGES.get(entry))
        elif hasattr(value, "FIELDS"):
            yield from _entries(here, value)
        elif field.low is not None and not isinstance(value, tuple) and name not in JUDGED and here not in ALONG:
            missing = value is None or (name == "radius" and math.isinf(value))
            if not missing or (name == "mass" and owner.material is not None):
                present = owner.own_mass if name == "mass" else None
                yield Input(here, field, None if value is None else float(value), present=present)

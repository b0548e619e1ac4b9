"""One impact under every named law, to compare them: what `film-model laws --plot` draws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import HalfSpace, Sphere, Target
from film_model.contact import Contact
from film_model.laws import LAWS, AbstractLaw
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import law_fields
from film_model.laws.yielding import yield_velocity
from film_model.scene import Effects, Scene
from film_model.solve import simulate

VELOCITY_RATIO = 50.0
"""Impact velocity over the yield velocity, at which mean pressure is 1.1 yield strengths."""

_SPHERE = {"effective_modulus": 115e9, "radius": 0.01, "yield_strength": 0.5e9, "poissons_ratio": 0.3}  # steel on steel
_MASS = 0.0329  # kg
_STIFFNESS = hertz_stiffness(_SPHERE["effective_modulus"], _SPHERE["radius"])
_VELOCITY = VELOCITY_RATIO * yield_velocity(
    _SPHERE["effective_modulus"], _SPHERE["radius"], _SPHERE["yield_strength"], _MASS
)
ENERGY = 0.5 * _MASS * _VELOCITY**2
"""Kinetic energy of the impact, J."""

_DEPTH = (2.5 * ENERGY / _STIFFNESS) ** 0.4  # of Hertz's law
_SPRING = 0.6 * _STIFFNESS * _DEPTH**0.5  # N/m

_TABLE = np.array([[0.0, 0.1, 0.25, 0.5, 0.8, 1.1, 1.5, 2.0], [0.0, 0.03, 0.1, 0.27, 0.46, 0.62, 0.8, 1.0]])

PARAMETERS: dict[str, dict[str, Any]] = {
    "meyer": {"stiffness": 0.9 * _STIFFNESS / _DEPTH**0.5, "exponent": 2.0},
    "thornton": {"yield_pressure": 1.6 * _SPHERE["yield_strength"]},
    "kogut-etsion": {"hardness": 2.8 * _SPHERE["yield_strength"]},
    "rigid-plastic": {"yield_pressure": 3.0 * _SPHERE["yield_strength"]},
    "walton-braun": {"loading_stiffness": _SPRING, "unloading_stiffness": 2.0 * _SPRING},
    "luding": {
        "loading_stiffness": _SPRING,
        "plastic_stiffness": 5.0 * _SPRING,
        "plasticity_depth": 1.2 * _DEPTH / (2.0 * _SPHERE["radius"]),
    },
    "tan-sun": {"stiffness": 0.7 * _STIFFNESS, "critical_indentation": 0.3 * _DEPTH},
    "linear-dashpot": {"stiffness": _SPRING, "restitution": 0.6},
    "tsuji": {"restitution": 0.6},
    "hunt-crossley": {"restitution": 0.6},
    "kuwabara-kono": {"dissipation_time": 0.2 * _DEPTH / _VELOCITY},
    "tabulated": {
        "indentation": tuple(_TABLE[0] * _DEPTH),
        "force": tuple(_TABLE[1] * _STIFFNESS * _DEPTH**1.5),
    },
}
"""Own parameters of the laws that need some, SI; those of spheres from the yield strength, the others by example."""

FAMILIES = {
    "elastic": ("hertz", "meyer"),
    "damped": ("linear-dashpot", "tsuji", "hunt-crossley", "kuwabara-kono"),
    "spring": ("walton-braun", "luding"),
    "laminate, table": ("tan-sun", "tabulated"),
}
"""Laws by kind; all others are of spheres that yield."""


@dataclass(frozen=True)
class Loop:
    """curve: (2, n) indentation [m] and force [N] over the contact; turn: index of the deepest point."""

    family: str
    curve: NDArray[np.float64]
    turn: int
    restitution: float


def family_law(name: str) -> AbstractLaw:
    """The named law for the ball of the family."""
    law = LAWS[name]
    return law(**{key: _SPHERE[key] for key in law_fields(law) if key in _SPHERE}, **PARAMETERS.get(name, {}))


def family_scene(name: str, target: Target | None = None) -> Scene:
    """The family's impact under the named law, without gravity; on a half-space unless another target is given."""
    ball = Sphere(f"{_SPHERE['radius']!r} m", velocity=f"{_VELOCITY!r} m/s", mass=f"{_MASS!r} kg")
    contact = Contact(family_law(name), effective_modulus=f"{_SPHERE['effective_modulus']!r} Pa")
    return Scene(ball, HalfSpace() if target is None else target, contact, Effects(gravity=False))


def family_loops() -> dict[str, Loop]:
    """The loop of every named law."""
    return {name: _loop(name) for name in LAWS}


def _loop(name: str) -> Loop:
    history = simulate(family_scene(name), accuracy=1e-5)
    deepest = history.summary["time_of_maximum_indentation"] or 0.0
    times = np.concatenate([np.linspace(0.0, deepest, 150), np.linspace(deepest, history.duration, 150)[1:]])
    samples = history.sample_si(times)
    family = next((kind for kind, names in FAMILIES.items() if name in names), "sphere that yields")
    restitution = history.summary["coefficient_of_restitution"] or 0.0
    return Loop(family, np.stack([samples.indentation, samples.contact_force]), 149, restitution)

"""One impact under every named law, for comparison: the data of `film-model laws --plot`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from film_model.base.arrays import Array
from film_model.laws import LAWS
from film_model.laws.example_ball import STEEL_BALL, example_law
from film_model.laws.law import Family
from film_model.scene import Contact, Effects, Scene, Sphere
from film_model.solve.simulate import simulate_quietly
from film_model.targets import AbstractTarget, HalfSpace


@dataclass(frozen=True)
class Loop:
    """curve: (2, n) indentation [m] and force [N] over the contact; turn: index of the maximum indentation."""

    family: Family
    curve: Array
    turn: int
    restitution: float


def gallery_scene(name: str, target: AbstractTarget | None = None) -> Scene:
    """The impact of the gallery under a named law, without gravity; on a half-space unless another target is given."""
    ball, law = STEEL_BALL, example_law(LAWS[name])
    sphere = Sphere(f"{ball.radius!r} m", velocity=f"{ball.velocity!r} m/s", mass=f"{ball.mass!r} kg")
    contact = Contact(law, effective_modulus=f"{ball.effective_modulus!r} Pa")
    return Scene(sphere, HalfSpace() if target is None else target, contact, Effects(gravity=False))


def gallery_loops() -> dict[str, Loop]:
    """Force over indentation of the impact under every named law."""
    return {name: _loop(name) for name in LAWS}


def _loop(name: str) -> Loop:
    history = simulate_quietly(gallery_scene(name), accuracy=1e-5)
    deepest = history.summary["time_of_maximum_indentation"] or 0.0
    times = np.concatenate([np.linspace(0.0, deepest, 150), np.linspace(deepest, history.duration, 150)[1:]])
    samples = history.sample_si(times)
    restitution = history.summary["coefficient_of_restitution"] or 0.0
    return Loop(LAWS[name].family, np.stack([samples.indentation, samples.contact_force]), 149, restitution)

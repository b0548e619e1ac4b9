"""Strains of the face of a bent plate or beam away from the impactor, and the bending stress there.

A point at the distance z behind the middle surface moves by −z ∂w/∂x along x, so that ε_x = −z w_xx, ε_y = −z w_yy and
γ_xy = −2 z w_xy: a plate that is pushed in has tension there. The struck face has the opposite.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from film_model.base.arrays import Array

Rows = TypeVar("Rows", bound=np.ndarray[Any, Any])


def surface_strains(target: Any, curvatures: Rows) -> Rows:
    """strain_x, strain_y and the stresses σ_x, σ_y and τ_xy, Pa, of sensors on a plate or a beam, (5, sensors, times).

    curvatures: w_xx, w_yy and w_xy of each sensor, or of a slender beam one, 1/m, (sensors × these, times), or their
    complex amplitudes. Plane stress, of a slender beam along it only; the stresses of layers are not known: NaN.
    """
    half, material = target.whole_thickness / 2.0, target.material
    modulus, ratio = (material.youngs_modulus, material.poissons_ratio) if target.thickness else (np.nan, np.nan)
    count = sum(bool(sensor.strain) for sensor in target.sensors)
    bent = -half * curvatures.reshape(count, -1, curvatures.shape[-1])
    if bent.shape[1] == 1:
        along, none = bent[:, 0], np.zeros_like(bent[:, 0])
        return np.stack([along, -ratio * along, modulus * along, none, none])  # pyright: ignore[reportReturnType]
    along, across, turned = bent[:, 0], bent[:, 1], 2.0 * bent[:, 2]
    plane = modulus / (1.0 - ratio**2)
    stresses = plane * (along + ratio * across), plane * (across + ratio * along), plane * (1.0 - ratio) / 2.0 * turned
    return np.stack([along, across, *stresses])  # pyright: ignore[reportReturnType]


def bending_stress(x: Array, y: Array, shear: Array) -> Array:
    """The principal stress of the larger magnitude, Pa, which pulls at one face and presses at the other."""
    return np.abs(x + y) / 2.0 + np.hypot((x - y) / 2.0, shear)

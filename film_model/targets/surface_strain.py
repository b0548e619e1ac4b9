"""Strains of the face of a bent plate or beam away from the impactor, and the bending stress there.

A point at the distance z behind the middle surface moves by −z ∂w/∂x along x, so that ε_x = −z w_xx, ε_y = −z w_yy and
γ_xy = −2 z w_xy: a plate that is pushed in has tension there. The struck face has the opposite.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.base.arrays import Array


def surface_strains(target: Any, curvatures: Array) -> Array:
    """strain_x, strain_y and bending stress, Pa, of sensors on a plate or a beam, (3, sensors, times).

    curvatures: w_xx, w_yy and w_xy of each sensor, or of a slender beam one, 1/m, (sensors × these, times). The stress
    is the principal one of the larger magnitude in plane stress, which pulls at one face and presses at the other; of
    layers it is not known.
    """
    half, material = target.whole_thickness / 2.0, target.material
    modulus, ratio = (material.youngs_modulus, material.poissons_ratio) if target.thickness else (np.nan, np.nan)
    count = sum(bool(sensor.strain) for sensor in target.sensors)
    bent = -half * curvatures.reshape(count, -1, curvatures.shape[-1])
    if bent.shape[1] == 1:  # the stress is along the beam
        along = bent[:, 0]
        return np.stack([along, -ratio * along, np.abs(modulus * along)])
    along, across, turned = bent[:, 0], bent[:, 1], 2.0 * bent[:, 2]
    mean = modulus / (2.0 * (1.0 - ratio)) * (along + across)
    radius = modulus / (2.0 * (1.0 + ratio)) * np.hypot(along - across, turned)
    return np.stack([along, across, np.abs(mean) + radius])

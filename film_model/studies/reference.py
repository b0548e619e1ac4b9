"""Reference values of an impact, with their error: from methods that do not use the core."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.problem.problem import Problem
from film_model.scene import Scene
from film_model.studies import high_precision, quadrature
from film_model.studies.impact_ode import INTEGRATED_VALUES

COMPARED = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "contact_duration",
    "rebound_velocity",
)
"""Summary values whose errors a study compares."""

QUADRATURE = "adaptive Gauss-Legendre quadrature"


def reference(scene: Scene, problem: Problem) -> tuple[Array, dict[str, Any]]:
    """`INTEGRATED_VALUES` in the law's units, and a table of SI values, their error and the method."""
    law, mass, velocity = problem.law, problem.mass, scene.approach_velocity
    impedance = problem.given.impedance
    load = problem.load * problem.scales.force
    # first, because it fails soon for a contact that does not end; not for damped laws
    tight = None if law.damped else quadrature.integrate(law, mass, velocity, impedance, rtol=3e-14, load=load)
    try:
        found, method, error = (
            high_precision.impact(law, mass, velocity, impedance, load),
            "extrapolation in extended precision",
            1e-15,
        )
    except (ImportError, ValueError):
        if tight is None:
            raise
        if math.isinf(impedance) and load == 0.0:
            found, method, other = quadrature.quadrature(law, mass, velocity), QUADRATURE, tight
        else:
            found, method = tight, "DOP853 in √ξ at rtol 3e-14"
            other = quadrature.integrate(law, mass, velocity, impedance, rtol=1e-12, load=load)
        error = max(1e-15, *(abs(other[name] / found[name] - 1.0) for name in COMPARED))
    s = problem.scales
    sizes = np.array([s.force, s.length, s.time, s.time, s.time, s.velocity])
    values = {name: found[name] for name in COMPARED}
    stated = {"method": method, "values": values, "error": error}
    return np.array([found[name] for name in INTEGRATED_VALUES]) / sizes, stated

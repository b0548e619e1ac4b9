"""Laws of spheres that yield against finite-element impacts of a rigid ball, all simulated as one batch a law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.materials import Material
from film_model.laws.yielding import limit_point
from film_model.scene import Contact, Effects, Scene, Sphere
from film_model.solve.batch import simulate_many
from film_model.targets import HalfSpace

Values = NDArray[np.float64]

MODULUS, RADIUS, MASS = 1e11, 0.01, 0.01
"""Effective modulus [Pa], radius [m] and mass [kg] of the simulated impacts: results over first yield do not depend on
them."""

FIRST_PRESSURE = (1.295, 0.736)
"""C and c of the largest pressure at first yield over Y, C exp(c ν), in whose units the runs are."""

FASTEST = 1000.5
"""Velocity over yield velocity above which a run is counted apart: few impacts are as fast."""

COMPARED = {
    "coefficient_of_restitution": "coefficient_of_restitution",
    "maximum_force": "largest_force",
    "maximum_indentation": "largest_depth",
    "contact_radius": "largest_radius",
    "permanent_indentation": "residual_depth",
}
"""Summary values → variables of the finite-element dataset."""


class Runs(NamedTuple):
    """Impacts in units of first yield, one value a run; `values` by the names of the finite-element dataset."""

    velocity_ratio: Values
    stiffness_ratio: Values
    hardening_exponent: Values
    poissons_ratio: Values
    held_out: NDArray[np.bool_]
    values: Mapping[str, Values]

    @property
    def fast(self) -> NDArray[np.bool_]:
        """Runs above `FASTEST`."""
        return self.velocity_ratio > FASTEST


def first_pressure(poissons_ratio: Values) -> Values:
    """The largest pressure of the runs' units, over Y."""
    factor, slope = FIRST_PRESSURE
    return factor * np.exp(slope * poissons_ratio)


def runs_of(columns: Mapping[str, Any]) -> Runs:
    """The runs of a dataset of finite-element impacts, whose variables are arrays by name."""
    given = {name: np.asarray(columns[name], float) for name in Runs._fields[:4]}
    values = {name: np.asarray(columns[name], float) for name in COMPARED.values()}
    return Runs(**given, held_out=np.asarray(columns["held_out"]) == 1, values=values)


def simulated(runs: Runs, law: str) -> dict[str, Values]:
    """Summary values of every run under a law, in units of first yield; nan: the law cannot simulate it."""
    strain = (1.0 - runs.poissons_ratio**2) / runs.stiffness_ratio
    pressure: Any = first_pressure(runs.poissons_ratio) * strain * MODULUS
    length, force = limit_point(MODULUS, RADIUS, pressure)
    units = {
        "coefficient_of_restitution": 1.0,
        "maximum_force": force,
        "maximum_indentation": length,
        "contact_radius": np.sqrt(RADIUS * length),
        "permanent_indentation": length,
    }
    columns = {
        "impactor.velocity": runs.velocity_ratio * np.sqrt(0.8 * length * force / MASS),
        "contact.poissons_ratio": runs.poissons_ratio,
        "target.material.yield_strength": strain * MODULUS,
        "target.material.strain_hardening_exponent": runs.hardening_exponent,
    }
    result = simulate_many(_scene(law), columns)
    failed = result.status < 0
    return {name: np.where(failed, math.nan, result.summary[name] / unit) for name, unit in units.items()}


def errors(runs: Runs, law: str) -> dict[str, Values]:
    """Relative errors of a law, by summary value; of the permanent indentation over the largest one."""
    found = simulated(runs, law)
    over = {name: runs.values[entry] for name, entry in COMPARED.items()}
    over["permanent_indentation"] = runs.values["largest_depth"]
    return {name: (found[name] - runs.values[entry]) / over[name] for name, entry in COMPARED.items()}


def _scene(law: str) -> Scene:
    """The scene whose velocity, Poisson's ratio, strength and hardening vary."""
    material = Material("one", "100 GPa", 0.3, "7850 kg/m^3", "1 GPa", strain_hardening_exponent=0.1)
    return Scene(
        Sphere(f"{RADIUS} m", velocity="1 m/s", mass=f"{MASS} kg"),
        HalfSpace(material),
        Contact(law, effective_modulus=f"{MODULUS} Pa", poissons_ratio=0.3),
        Effects(gravity=False, target_motion=False, wave_losses=False),  # the elements have no inertia
    )

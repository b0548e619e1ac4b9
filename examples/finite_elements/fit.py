"""Fit law elastoplastic to the published impacts: `python examples/finite_elements/fit.py`.

Prints the constants of film_model/laws/elastoplastic.py, then the errors of fitted and of held-out runs.
"""

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
import xarray as xr
from against_laws import FASTEST, first_pressure
from scipy.integrate import cumulative_simpson
from scipy.optimize import least_squares

import film_datasets as fd
from film_model.base.flow_stress import flow_of_yield
from film_model.laws.elastoplastic import COMPARED_STRAIN, FITTED, Constants, Plastic, pressure_factor, scaled_strain

Arrays = dict[str, np.ndarray]

TOLERANCES = {
    "coefficient_of_restitution": 0.004,
    "largest_force": 0.005,
    "largest_depth": 0.004,
    "largest_radius": 0.007,
    "residual_depth": 0.006,  # of the largest depth: dents near first yield are small
}
"""Relative errors that weigh the same in the fit."""

DEPTHS = np.geomspace(1.0, 6000.0, 400)
"""w at which the work is known."""

OF_PAIRS = "stays_elastic"
"""The constant that is fitted to pairs of bodies that yield."""

WEIGHT_OF_FAST = 0.3
"""Of runs above `FASTEST`: few impacts are as fast."""


def elastic_shares(ds: xr.Dataset, constants: Constants) -> np.ndarray:
    """h of each run: 0 of a rigid ball."""
    if "strength_ratio" not in ds:
        return np.zeros(ds.sizes["run"])
    strengths, moduli, n = (ds[name].values for name in ("strength_ratio", "modulus_ratio", "hardening_exponent"))
    softer = ds["stiffness_ratio"].values * (1.0 + 1.0 / moduli)  # E/Y
    flows = (flow_of_yield(y, n, e, COMPARED_STRAIN) for y, e in ((strengths, moduli * softer), (1.0, softer)))
    return constants.elastic_share(next(flows) / next(flows), moduli)


def softer_curvatures(ds: xr.Dataset) -> np.ndarray:
    """x of each run: 1 where the softer body is the ball."""
    return ds["softer"].values.astype(float) if "softer" in ds else np.zeros(ds.sizes["run"])


def predicted(ds: xr.Dataset, constants: Constants = FITTED) -> Arrays:
    """What the law says of each run, in the dataset's units: by the energy, since nothing depends on time."""
    ratio, stiffness, n, v = (
        ds[name].values[:, None]
        for name in ("poissons_ratio", "stiffness_ratio", "hardening_exponent", "velocity_ratio")
    )
    factor = pressure_factor(ratio)
    unit = factor / first_pressure(ratio)
    share = elastic_shares(ds, constants)[:, None]
    curvature = softer_curvatures(ds)[:, None]
    law = Plastic(scaled_strain((1 - ratio**2) / stiffness, ratio), n, share, constants, curvature)
    work = 0.4 + cumulative_simpson(law.force(DEPTHS) * DEPTHS, x=np.log(DEPTHS), initial=0.0)
    reached = 0.4 * (v / unit**2.5) ** 2
    log_w = [np.interp(energy, own, np.log(DEPTHS)) for energy, own in zip(reached, work, strict=True)]
    w = np.exp(np.array(log_w))
    peak, secant = law.force(w), law.secant(w)
    returned = peak**2 / (secant * (constants.exponent(w) + 1.0))
    found = {
        "coefficient_of_restitution": np.sqrt(returned / reached),
        "largest_force": peak * unit**3,
        "largest_depth": w * unit**2,
        "largest_radius": law.contact_radius(w) * unit,
        "residual_depth": (w - peak / secant) * unit**2,
    }
    return {name: values[:, 0] for name, values in found.items()}


def errors(ds: xr.Dataset, constants: Constants = FITTED) -> Arrays:
    """Relative errors of the law, by quantity; of the residual depth, over the largest."""
    found = predicted(ds, constants)
    over = {name: ds[name].values for name in found} | {"residual_depth": ds["largest_depth"].values}
    return {name: (found[name] - ds[name].values) / over[name] for name in found}


def fitted(ds: xr.Dataset, names: Sequence[str]) -> Constants:
    """The constants of these names that make the sum of the fourth powers of the errors over their tolerances least."""
    fitted_to = ds.isel(run=ds["held_out"].values == 0)
    start = np.array([getattr(FITTED, name) for name in names])
    weight = np.where(fitted_to["velocity_ratio"].values > FASTEST, WEIGHT_OF_FAST, 1.0)

    def differences(trial: np.ndarray) -> np.ndarray:
        found = errors(fitted_to, replace(FITTED, **dict(zip(names, trial.tolist(), strict=True))))
        over = np.concatenate([weight * found[name] / tolerance for name, tolerance in TOLERANCES.items()])
        return over * np.abs(over)

    best = least_squares(differences, start, x_scale=np.maximum(np.abs(start), 0.1)).x
    return replace(FITTED, **{name: float(f"{value:.4g}") for name, value in zip(names, best.tolist(), strict=True)})


def main() -> tuple[Constants, Arrays]:
    """Print constants and errors; return them."""
    ds = fd.load("finite_element_impacts")
    names = [field.name for field in fields(FITTED) if field.name != OF_PAIRS]
    best = fitted(ds, names)
    for name in names:
        print(f"    {name}: float = {getattr(best, name)}")
    found, held, fast = errors(ds, best), ds["held_out"].values == 1, ds["velocity_ratio"].values > FASTEST
    for title, rows in (("fitted", ~held & ~fast), ("held out", held & ~fast), ("faster", fast)):
        print(f"{title}: {rows.sum()} runs; median, 95th percentile and largest |error|")
        for name, values in found.items():
            size = 100.0 * np.abs(values[rows])
            print(f"  {name:27} {np.median(size):6.2f} % {np.quantile(size, 0.95):6.2f} % {size.max():6.2f} %")
    return best, found


if __name__ == "__main__":
    main()

"""Fit the closed forms of forms.py to the published impacts: `python examples/finite_elements/fit.py`.

Prints the constants, then the errors of fitted and of held-out runs.
"""

from collections.abc import Callable
from typing import Any

import forms
import numpy as np
import xarray as xr
from scipy.optimize import least_squares

import film_datasets as fd

Arrays = dict[str, np.ndarray]
Constants = dict[str, tuple[float, ...]]


def materials(ds: xr.Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """e_y, n and C of each run."""
    nu = ds["poissons_ratio"].values
    return (1 - nu**2) / ds["stiffness_ratio"].values, ds["hardening_exponent"].values, 1.295 * np.exp(0.736 * nu)


def fitted(
    name: str, form: Callable[..., Any], known: Constants, w: Any, of: Any, y: Any, use: Any, weight: Any
) -> Any:
    """The constants `name` that make the weighted relative differences of `form` from y least; the others are known."""

    def differences(trial: np.ndarray) -> np.ndarray:
        return ((form(w, *of, {**known, name: trial}) / y - 1.0) * weight)[use]

    return least_squares(differences, known[name], x_scale=np.maximum(np.abs(known[name]), 0.1)).x


def constants(ds: xr.Dataset) -> Constants:
    """The constants of all forms, from the runs that are not held out. The radius comes first: the others use it."""
    of, held = materials(ds), ds["held_out"].values == 1
    largest, force = ds["largest_depth"].values, ds["largest_force"].values
    w = (largest[:, None] * ds["depth_fraction"].values).ravel()
    points = ds.sizes["depth_fraction"]
    curves_of, use = [np.repeat(values, points) for values in of], ~np.repeat(held, points) & (w > 1.2)
    recovered = largest - ds["residual_depth"].values
    work = 0.4 * (ds["coefficient_of_restitution"].values * ds["velocity_ratio"].values) ** 2
    dent = np.sqrt(1.0 + (0.1 * recovered / ds["residual_depth"].values) ** 2)  # the dent counts near first yield, too
    found = dict(forms.CONSTANTS)
    for name, form, at, materials_of, y, rows, weight in (
        ("radius", forms.radius, w, curves_of, ds["loading_radius"].values.ravel(), use, 1.0),
        ("force", forms.force, w, curves_of, ds["loading_force"].values.ravel(), use, 1.0),
        ("secant", forms.secant, largest, of, force / recovered, ~held, dent),
        ("energy", forms.stored, largest, of, force**2 / work, ~held, 1.0),
    ):
        best = fitted(name, form, found, at, materials_of, y, rows, weight)
        found[name] = tuple(float(f"{value:.4g}") for value in best)
    return found


def predicted(velocity: float, e_y: float, n: float, c: float, known: Constants = forms.CONSTANTS) -> Arrays:
    """What the forms say of an impact at V/V_Y: by the energy, since loading and unloading do not depend on time."""
    w = np.concatenate([np.linspace(0.0, 1.0, 200)[:-1], np.geomspace(1.0, 3000.0, 6000)])
    force = forms.force(w, e_y, n, c, known)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(w))])
    depth = np.interp(0.4 * velocity**2, work, w)
    at = (depth, e_y, n, c, known)
    peak = forms.force(*at)
    return {
        "coefficient_of_restitution": np.sqrt(peak**2 / forms.stored(*at) / 0.4) / velocity,
        "largest_force": peak,
        "largest_depth": depth,
        "largest_radius": forms.radius(*at),
        "residual_depth": depth - peak / forms.secant(*at),
    }


def errors(ds: xr.Dataset, known: Constants) -> Arrays:
    """Relative errors of the forms, by quantity."""
    runs = [predicted(*each, known) for each in zip(ds["velocity_ratio"].values, *materials(ds), strict=True)]
    return {name: np.array([run[name] for run in runs]) / ds[name].values - 1.0 for name in runs[0]}


def main() -> tuple[Constants, Arrays]:
    """Print constants and errors; return them."""
    ds = fd.load("finite_element_impacts")
    best = constants(ds)
    for name, values in best.items():
        print(f"{name} = {values}")
    found, held = errors(ds, best), ds["held_out"].values == 1
    for title, rows in (("fitted", ~held), ("held out", held)):
        print(f"{title}: {rows.sum()} runs; median, 95th percentile and largest |error|")
        for name, values in found.items():
            size = 100.0 * np.abs(values[rows])
            print(f"  {name:27} {np.median(size):6.2f} % {np.quantile(size, 0.95):6.2f} % {size.max():6.2f} %")
    return best, found


if __name__ == "__main__":
    main()

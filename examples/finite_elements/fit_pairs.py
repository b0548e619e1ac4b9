"""Law elastoplastic and the published impacts of two bodies that yield: `python examples/finite_elements/fit_pairs.py`.

Prints the errors of the law, which knows the softer body only, and those of a rule for the harder one, with its
constants: h = (1 − exp(−k (s − 1)^q))/(1 + m) is the harder body's part of the elastic compliance, m the ratio of
moduli, less where it yields, too, at a ratio of strengths s. With h contact is narrower, full plasticity comes earlier,
and unloading is nearer to Hertz's.
"""

from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from fit import TOLERANCES, Arrays, predicted
from scipy.optimize import least_squares

import film_datasets as fd
from film_model.laws.elastoplastic import FITTED


@dataclass(frozen=True)
class Rule:
    """Numbers of h, and by what it changes the constants of the law; the defaults are where the fit starts."""

    yielding: float = 3.6  # k
    power: float = 1.2  # q
    spread: float = 0.1  # ln of a constant, over h
    stiffening: float = 0.9
    rounding: float = 2.5
    bend: float = 0.25  # a constant, over h
    hardening: float = 0.14  # n, over h

    def share(self, ds: xr.Dataset) -> np.ndarray:
        """h of each run."""
        beyond = np.maximum(ds["strength_ratio"].values - 1.0, 0.0)
        return (1.0 - np.exp(-self.yielding * beyond**self.power)) / (1.0 + ds["modulus_ratio"].values)


def by_rule(ds: xr.Dataset, rule: Rule) -> Arrays:
    """What law and rule say of each run, in the dataset's units."""
    h = rule.share(ds)
    part: Any = h[:, None]
    own = replace(
        FITTED,
        spread=FITTED.spread * np.exp(-rule.spread * part),
        stiffening=FITTED.stiffening * np.exp(-rule.stiffening * part),
        rounding=FITTED.rounding * np.exp(-rule.rounding * part),
        pressure_bend=FITTED.pressure_bend + rule.bend * part,
    )
    return predicted(ds.assign(hardening_exponent=ds["hardening_exponent"] + rule.hardening * h), own)


def errors(ds: xr.Dataset, found: Arrays) -> Arrays:
    """Relative errors, by quantity; of the residual depth, over the largest."""
    over = {name: ds[name].values for name in found} | {"residual_depth": ds["largest_depth"].values}
    return {name: (values - ds[name].values) / over[name] for name, values in found.items()}


def fitted(ds: xr.Dataset) -> Rule:
    """The rule that makes the sum of the fourth powers of the errors over their tolerances least."""
    used = ds.isel(run=ds["held_out"].values == 0)

    def differences(trial: np.ndarray) -> np.ndarray:
        found = errors(used, by_rule(used, Rule(*trial)))
        over = np.concatenate([found[name] / tolerance for name, tolerance in TOLERANCES.items()])
        return over * np.abs(over)

    start = np.array(astuple(Rule()))
    low, high = start - 3.0, start + 3.0
    low[:2], high[:2] = (0.5, 0.5), (20.0, 3.0)
    return Rule(*(float(f"{value:.3g}") for value in least_squares(differences, start, bounds=(low, high)).x))


def main() -> tuple[Rule, Arrays, Arrays]:
    """Print errors and constants; return the rule, the errors of the law and those with the rule."""
    ds = fd.load("finite_element_pairs")
    rule, held = fitted(ds), ds["held_out"].values == 1
    print(rule)
    both = errors(ds, predicted(ds)), errors(ds, by_rule(ds, rule))
    for title, found in zip(("law", "with the rule"), both, strict=True):
        for name, values in found.items():
            size = 100.0 * np.abs(values)
            print(
                f"{title:14} {name:27}", *(f"{np.median(size[k]):6.2f} {size[k].max():6.2f} %" for k in (~held, held))
            )
    return rule, *both


if __name__ == "__main__":
    main()

"""Law elastoplastic and the published impacts of two bodies that yield: `python examples/finite_elements/fit_pairs.py`.

Prints the constant by which the harder body yields, too, as these impacts give it, then the errors of the law with that
of film_model/laws/elastoplastic.py, and of the same law with a rigid body in place of the harder one.
"""

import numpy as np
from fit import OF_PAIRS, Arrays, errors, fitted

import film_datasets as fd
from film_model.laws.elastoplastic import Constants


def main() -> tuple[Constants, Arrays, Arrays]:
    """Print constant and errors; return the fitted constants, the errors with a rigid body and those of the law."""
    ds = fd.load("finite_element_pairs")
    best, held = fitted(ds, [OF_PAIRS]), ds["held_out"].values == 1
    print(f"    {OF_PAIRS}: float = {getattr(best, OF_PAIRS)}")
    both = errors(ds.drop_vars("strength_ratio")), errors(ds)
    for title, found in zip(("harder body rigid", "law"), both, strict=True):
        print(f"{title}: median, 90th percentile and largest |error|, fitted and held out")
        for name, values in found.items():
            size = [100.0 * np.abs(values[rows]) for rows in (~held, held)]
            numbers = (f"{np.median(s):6.2f} % {np.quantile(s, 0.9):6.2f} % {s.max():6.2f} %" for s in size)
            print(f"  {name:27}", *numbers)
    return best, *both


if __name__ == "__main__":
    main()

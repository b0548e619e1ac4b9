"""How the strength of a material rises with the strain rate: one law, or the other."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from film_model.base.arrays import any_of, exponential, greater, logarithm
from film_model.base.materials import Material


class RateHardening(NamedTuple):
    """S/S_y = 1 + C ln ε̇ + (ε̇/D)^(1/q), ε̇ in 1/s: Johnson & Cook's C with ε̇ at least 1, or Cowper & Symonds' D, q.

    Numbers, or arrays with one value for each of many impacts. Of a material with one law, the other's part is 0:
    coefficient: C. slowness: 1/D, s. power: 1/q.
    """

    coefficient: Any
    slowness: Any
    power: Any

    def factor(self, rate: Any) -> Any:
        """S/S_y at a strain rate, 1/s."""
        johnson_cook = 1.0 + self.coefficient * logarithm(greater(rate, 1.0))
        if not any_of(self.slowness > 0.0):
            return johnson_cook
        scaled = greater(rate * self.slowness, 1e-300)  # for ε̇/D = 0, whose logarithm is not finite
        return johnson_cook + exponential(self.power * logarithm(scaled)) * (self.slowness > 0.0)


def rate_constants(material: Material) -> tuple[float, float, float]:
    """C, 1/D and 1/q of a material; C is nan if it has no rate law."""
    if material.rate_multiplier is not None and material.rate_exponent is not None:
        return 0.0, 1.0 / material.rate_multiplier, 1.0 / material.rate_exponent
    coefficient = material.strain_rate_coefficient
    return math.nan if coefficient is None else coefficient, 0.0, 1.0

"""Closed forms of a rigid ball on a half-space that yields, fitted to finite elements (fit.py).

w = δ/δ_Y, force F/F_Y, radius a/a_Y in units of first yield: the largest pressure there is C Y, C = 1.295 exp(0.736 ν),
δ_Y = (π C e_y/2)² R, a_Y = √(R δ_Y), F_Y = (4/3) E* √R δ_Y^1.5; e_y = Y/E*; n of σ_y = Y (1 + E ε_p/Y)^n.
Up to w = 1 they are Hertz's, with continuous value and slope.
"""

from typing import Any

import numpy as np

C_STEEL = 1.615  # C at ν = 0.3
CONSTANTS = {
    "radius": (1.231, 1.929, 0.1308, 1.284, 0.6381, -0.4461),
    "force": (0.6491, 0.4946, 1.805, 0.5854, 0.183, -1.374, 3.056, 0.1458),
    "secant": (0.2625, 0.5226, -0.06327, -0.8842, 0.08009),
    "energy": (0.4747, 0.4784, -0.3027, -1.023, 0.4131),
}


def radius(w: Any, e_y: float, n: float, c: float = C_STEEL, constants: Any = CONSTANTS) -> Any:
    """α = √(w (1 + z)^{p/k}), z = ((w − 1)/b)^k, where b and p fall with n as powers of e."""
    b, k, growth, of_n, of_c, b_of_n = constants["radius"]
    z = (np.maximum(w - 1.0, 0.0) / (b * np.exp(b_of_n * n))) ** k
    return np.sqrt(w * (1.0 + z) ** (growth * np.exp(-of_n * n) * (c / C_STEEL) ** of_c / k))


def force(w: Any, e_y: float, n: float, c: float = C_STEEL, constants: Any = CONSTANTS) -> Any:
    """f = α² P: the mean pressure P follows Hertz (α), then a power of α, then the plateau of full plasticity.

    Both of the latter grow as (1 + h (α − 1))^n, which is Tabor's: the strain is in proportion to a/R.
    """
    slope, power, plateau, strain, of_radius, of_c, sharp, of_n = constants["force"]
    alpha = radius(w, e_y, n, c, constants)
    u = np.maximum(alpha - 1.0, 1e-12)
    harder = (1.0 + strain * u) ** n
    part = u / (slope * u**power * harder * np.exp(of_n * n))
    full = u / (plateau * (c / C_STEEL) ** of_c * harder * np.exp(-of_radius * (alpha * np.pi * c * e_y / 2.0) ** 2))
    mean = 1.0 + u * (1.0 + part**sharp + full**sharp) ** (-1.0 / sharp)
    return np.where(w <= 1.0, np.asarray(w) ** 1.5, alpha**2 * mean)


def _beyond_hertz(name: str, hertz: float, w: Any, e_y: float, n: float, c: float, constants: Any) -> Any:
    """α times what is Hertz's up to first yield and rises from there to a plateau."""
    rise, power, of_n, of_c, of_radius = constants[name]
    alpha = radius(w, e_y, n, c, constants)
    above = np.maximum(alpha, 1.0)
    gained = (rise + of_n * n + of_radius * alpha * np.pi * c * e_y / 2.0) * (c / C_STEEL) ** of_c
    return alpha * (hertz + gained * (1.0 - above**-power))


def secant(w: Any, e_y: float, n: float, c: float = C_STEEL, constants: Any = CONSTANTS) -> Any:
    """s = (F_m/F_Y)/(w_m − w_f) of the unloading from w_m = w; Hertz: √w."""
    return _beyond_hertz("secant", 1.0, w, e_y, n, c, constants)


def stored(w: Any, e_y: float, n: float, c: float = C_STEEL, constants: Any = CONSTANTS) -> Any:
    """s (q + 1) = (F_m/F_Y)² over the work of unloading; Hertz: 2.5 √w."""
    return _beyond_hertz("energy", 2.5, w, e_y, n, c, constants)


def exponent(w: Any, e_y: float, n: float, c: float = C_STEEL) -> Any:
    """q of F = F_m ((w − w_f)/(w_m − w_f))^q, from the work of unloading F_m (w_m − w_f)/(q + 1)."""
    return stored(w, e_y, n, c) / secant(w, e_y, n, c) - 1.0

"""Strength from hardness and hardening, of one material or of many (arrays, element by element).

Tabor 1951, The Hardness of Metals: the mean pressure H of an indentation is `CONSTRAINT` times the flow stress at the
plastic strain `REPRESENTATIVE_STRAIN` of the Vickers pyramid. Flow stress: σ = Y (1 + E ε/Y)^n.

- Laws without hardening take the flow stress at the representative strain: H/2.8; without a hardness, that of the given
  yield strength and hardening.
- Laws with hardening take n, and the Y for which σ at the representative strain is H/2.8; without a hardness, the given
  yield strength.
- Johnson & Cook's A + B ε^m becomes Y = A, and the n for which σ at the representative strain is A + B 0.08^m.
"""

from __future__ import annotations

from typing import Any

from film_model.base.arrays import any_of, exponential, logarithm

CONSTRAINT = 2.8
"""Mean pressure over flow stress: Tabor's value for balls; for pyramids he has up to 3.3."""

SCATTER = 0.15
"""Relative scatter of a flow stress from the hardness, either way: that of `CONSTRAINT`. The flow stresses at 8 %
strain of Johnson and Cook's 4340 steel, S-7 tool steel and tungsten alloy are 5 to 9 % below those from their HRC."""

REPRESENTATIVE_STRAIN = 0.08
"""Plastic strain at which a Vickers indentation measures the flow stress (Tabor 1951)."""

MOST_HARDENING = 0.6
"""Largest strain hardening exponent n."""

MOST_OVER_YIELD = 3.0
"""Largest flow stress from a hardness over the yield strength given beside it."""


def flow_of_hardness(hardness: Any) -> Any:
    """Flow stress at the representative strain, Pa. hardness: mean pressure over the projected area, Pa."""
    return hardness / CONSTRAINT


def contradicts(hardness: Any, strength: Any) -> Any:
    """Whether the flow stress from a hardness [Pa] is too far from a yield strength [Pa] for one material."""
    flow = flow_of_hardness(hardness)
    return (flow < (1.0 - SCATTER) * strength) | (flow > MOST_OVER_YIELD * strength)


def flow_of_yield(strength: Any, exponent: Any, modulus: Any, strain: float = REPRESENTATIVE_STRAIN) -> Any:
    """Flow stress at a plastic strain, Pa."""
    return strength * exponential(exponent * logarithm(1.0 + modulus * strain / strength))


def yield_of_flow(flow: Any, exponent: Any, modulus: Any) -> Any:
    """The yield strength Y of a material with this flow stress at the representative strain, Pa.

    Newton's method for ln Y from Y = flow: the function is convex and grows, so that it converges from above.
    """
    strength = flow
    for _ in range(12):
        stretch = modulus * REPRESENTATIVE_STRAIN / strength
        excess = logarithm(strength / flow) + exponent * logarithm(1.0 + stretch)
        step = excess / (1.0 - exponent * stretch / (1.0 + stretch))
        strength = strength * exponential(-step)
        # the error is then the square of this change of ln Y; about 6 steps are taken
        if not any_of(abs(step) > 1e-12):
            break
    return strength


def johnson_cook_exponent(strength: Any, coefficient: Any, exponent: Any, modulus: Any) -> Any:
    """n of a material with Johnson and Cook's A (strength), B (coefficient) and exponent."""
    rise = coefficient * exponential(exponent * logarithm(REPRESENTATIVE_STRAIN)) / strength
    return logarithm(1.0 + rise) / logarithm(1.0 + modulus * REPRESENTATIVE_STRAIN / strength)

"""Studies around the solver: references and alternatives to compare it with, and comparisons of laws and effects.

References: `quadrature` (exact quadrature, conventional integration), `high_precision` (mpmath).
Alternatives: `impact_ode` (the equations), `integrators` (adaptive), `fixed_steps`, `dormand_prince` (numba).
Studies: `cost` (error against time, with `methods`, `reference`, `timing`), `hard_cases`, `explain` (effects and laws
of a scene), `law_gallery` (one impact under every law), `regimes` (map over Zener's λ and V/V_Y).

Import the module that is needed: most of them import optional or slow libraries.
"""

"""Effects that are estimated, not simulated.

Each rule takes the trial march of an impact and returns an :class:`Effect`. If the estimated change exceeds the
tolerance, the effect becomes a warning; if the scene lacks an input, the reason names it. No input is guessed; one that
is taken as 0 is named. The changes are first-order estimates: the order of magnitude is right, the second digit is not.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from film_model.effects import large_slope, oblique_limits
from film_model.effects import material_rules as materials
from film_model.effects.case import Case, case_of
from film_model.effects.effect import ABSENT, FREE, NOT_JUDGED, NOT_MODELLED, NOT_NEEDED, SIMULATED, Effect
from film_model.effects.surroundings import air_drag, roughness, squeeze_film
from film_model.problem.problem import Problem
from film_model.targets import Estimate


class Rule(NamedTuple):
    """Name, indicator and source of an effect that is estimated."""

    name: str
    indicator: str
    source: str


OF_BALLS = (materials.adhesion, materials.fracture, air_drag, roughness, squeeze_film)
"""Rules that hold for balls only."""


def judge(problem: Problem, vibrates: bool) -> dict[str, Effect]:
    """All rules applied to one impact, by name; "not judged" if its contact does not end.

    vibrates: the target does; `problem` is then the impact on its impedance or static stiffness.
    """
    case = _case(problem, vibrates)
    return {name: _apply(name, problem, case) for name in RULES}


def judged(problem: Problem, name: str) -> Effect:
    """One rule, by name, applied to one impact."""
    return _apply(name, problem, _case(problem, vibrates=False))


def _case(problem: Problem, vibrates: bool) -> Case | None:
    """What the rules judge; None if the impact does not end, or its indentation is rounding of the deflection."""
    sound = problem.trial.ends and problem.approach > 0.0 and problem.trial.summary.maximum_indentation > 0.0
    return case_of(problem, vibrates) if sound else None


def _apply(name: str, problem: Problem, case: Case | None) -> Effect:
    (rule, estimate), scene = RULES[name], problem.scene
    if scene.nose is not None and estimate in OF_BALLS:
        found = Estimate("known for balls only")
    elif case is not None:
        found = getattr(scene.target, estimate)(case.seen) if isinstance(estimate, str) else estimate(case)
    elif estimate is oblique_limits.obliqueness:
        found = oblique_limits.oblique(scene, None)
    elif problem.approach == 0.0:
        found = Estimate("the impactor has no velocity")
    else:
        soft = "the target is too soft for an estimate of the indentation"
        found = Estimate(soft if problem.trial.ends else "contact did not end")
    return effect_of(rule, found, scene.effect_tolerance)


def effect_of(rule: Rule, found: Estimate, tolerance: float) -> Effect:
    """What a rule found, as an effect. tolerance: change from which it matters."""
    name, indicator, source = rule
    reason, value, limit, size, applies, fails, own, remedy, below, simulated = found
    if not applies:
        return Effect(name, own or indicator, None, None, 0.0, NOT_NEEDED, reason, source)
    cost = ABSENT
    if simulated:
        cost, state = FREE, SIMULATED
    elif fails or size is None or value is None:
        size, state = None, NOT_MODELLED if fails else NOT_JUDGED
    else:
        if remedy is not None:
            cost, reason = f"{ABSENT}: {remedy}", f"{reason}: {remedy}" if size > tolerance else reason
        limit = limit if below else agreeing(value, limit, size, tolerance)
        state = NOT_MODELLED if size > tolerance else NOT_NEEDED
    return Effect(name, own or indicator, value, limit, size, state, reason, source, cost)


def agreeing(value: float | None, threshold: float | None, size: float | None, tolerance: float) -> float | None:
    """The threshold of an indicator; replaced by one that agrees with the change if it contradicts it.

    Thresholds are first-order estimates. If the indicator is beyond one and the change below the tolerance, or the
    reverse, the change is taken as proportional to the indicator instead.
    """
    if value is None or threshold is None or size is None or (value > threshold) == (size > tolerance):
        return threshold
    return value * tolerance / size if size > 0.0 else None


_TABLE: dict[str, tuple[str, str, str | Callable[[Case], Estimate]]] = {
    "boundary_reflections": (
        "t_c/t_return",
        "fitted to sums over the modes of simply supported plates struck at the centre; one-dimensional waves in a rod",
        "reflections",
    ),
    "thickness": (
        "k h",
        "Zener 1941; three-dimensional waves of a layer, to first order",
        "thickness_effect",
    ),
    "stretching": ("deflection/h", "Berger 1955, J. Appl. Mech. 22:465, in one term", "stretching"),
    "bending_strength": (
        "bending stress/strength",
        "infinite plate under a sudden force; Westergaard in Timoshenko & Woinowsky-Krieger 1959",
        "bending_strength",
    ),
    "cross_bending": ("-", "response to a half-sine; classical lamination theory", "cross_bending"),
    "omitted_modes": (
        "Ω T/π",
        "response to a half-sine of the contact time T on a fixed target",
        "omitted_modes",
    ),
    "small_slope": (
        "a/R",
        "fitted to axisymmetric finite elements made for this package; compare Sneddon 1965, Tatara 1991",
        large_slope.judge,
    ),
    "contact_width": (
        "a/h",
        "half-space laws fail for contacts wider than the plate thickness",
        "contact_width",
    ),
    "adhesion": ("V/V_s", "Thornton & Ning 1998; work of separation by Johnson, Kendall & Roberts", materials.adhesion),
    "material_damping": ("tan δ", "Lee & Radok 1960; Ting 1966, with a modulus t^−β", materials.material_damping),
    "wave_losses": ("E_waves/E", "Lamb's problem, Miller & Pursey 1955", "wave_losses"),
    "heating": ("plastic work/volume, J/m³", "balance of energy", materials.heating),
    "fracture": (
        "force/least force of a crack",
        "Auerbach 1891; Frank & Lawn 1967; Warren 1995, J. Eur. Ceram. Soc. 15:201; Johnson 1985, section 4.2; "
        "crushing: balance of energy",
        materials.fracture,
    ),
    "air_drag": ("2 g h/v_t²", "Schiller & Naumann 1933: drag of a sphere; balance of energy", air_drag),
    "roughness": (
        "σ/δ",
        "Greenwood & Tripp 1967, J. Appl. Mech. 34:153; Greenwood, Johnson & Matsubara 1984, Wear 100:47",
        roughness,
    ),
    "squeeze_film": (
        "m V/(6 π μ R²)",
        "lubrication of a sphere; Davis, Serayssol & Hinch 1986; compare Joseph et al. 2001, Legendre et al. 2005",
        squeeze_film,
    ),
    "obliqueness": (
        "angle from the normal, °",
        "impulse and angular momentum; Maw, Barber & Fawcett 1976",
        oblique_limits.obliqueness,
    ),
}
"""Name → indicator, source, and the estimate: a function, or the name of a method of the target."""

RULES = {name: (Rule(name, indicator, source), rule) for name, (indicator, source, rule) in _TABLE.items()}

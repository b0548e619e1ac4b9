"""Effects that are estimated, not simulated.

Each rule takes the trial march of an impact and returns an :class:`Effect`. If the estimated change exceeds the
tolerance, the effect becomes a warning; if the scene lacks an input, the reason names it. No input is guessed; one that
is taken as 0 is named. The changes are first-order estimates: the order of magnitude is right, the second digit is not.
"""

from __future__ import annotations

from collections.abc import Callable

from film_model.effects import large_slope, oblique_limits
from film_model.effects import material_rules as materials
from film_model.effects.case import Case, Rule, by_target, case_of
from film_model.effects.effect import Effect
from film_model.effects.surroundings import air_drag, roughness, squeeze_film
from film_model.problem.problem import Problem

OF_BALLS = (materials.adhesion, materials.fracture, air_drag, roughness, squeeze_film)
"""Rules that hold for balls only."""


def judge(problem: Problem, vibrates: bool) -> dict[str, Effect]:
    """All rules applied to one impact, by name; "not judged" if its contact does not end.

    vibrates: the target does; `problem` is then the impact on its impedance or static stiffness.
    """
    case = _case(problem, vibrates)
    if case is None or problem.scene.nose is not None:
        return {name: _apply(name, problem, case) for name in RULES}
    return {name: judge_case(case, rule) for name, (rule, judge_case) in RULES.items()}


def judged(problem: Problem, name: str) -> Effect:
    """One rule, by name, applied to one impact."""
    return _apply(name, problem, _case(problem, vibrates=False))


def _case(problem: Problem, vibrates: bool) -> Case | None:
    """What the rules judge; None if the impact does not end, or its indentation is rounding of the deflection."""
    sound = problem.trial.ends and problem.approach > 0.0 and problem.trial.summary.maximum_indentation > 0.0
    return case_of(problem, vibrates) if sound else None


def _apply(name: str, problem: Problem, case: Case | None) -> Effect:
    rule, judge_case = RULES[name]
    if problem.scene.nose is not None and judge_case in OF_BALLS:
        return rule.unjudged("known for balls only")
    if case is not None:
        return judge_case(case, rule)
    if judge_case is oblique_limits.obliqueness:
        return oblique_limits.oblique(problem.scene, rule, None, problem.scene.effect_tolerance)
    ends = "the target is too soft for an estimate of the indentation" if problem.trial.ends else "contact did not end"
    return rule.unjudged("the impactor has no velocity" if problem.approach == 0.0 else ends)


_TABLE: dict[str, tuple[str, str, Callable[[Case, Rule], Effect]]] = {
    "boundary_reflections": (
        "t_c/t_return",
        "fitted to sums over the modes of simply supported plates struck at the centre; one-dimensional waves in a rod",
        by_target("reflections"),
    ),
    "thickness": (
        "k h",
        "Zener 1941; three-dimensional waves of a layer, to first order",
        by_target("thickness_effect"),
    ),
    "stretching": ("deflection/h", "Berger 1955, J. Appl. Mech. 22:465, in one term", by_target("stretching")),
    "bending_strength": (
        "bending stress/strength",
        "infinite plate under a sudden force; Westergaard in Timoshenko & Woinowsky-Krieger 1959",
        by_target("bending_strength"),
    ),
    "cross_bending": ("-", "response to a half-sine; classical lamination theory", by_target("cross_bending")),
    "omitted_modes": (
        "Ω T/π",
        "response to a half-sine of the contact time T on a fixed target",
        by_target("omitted_modes"),
    ),
    "small_slope": (
        "a/R",
        "fitted to axisymmetric finite elements made for this package; compare Sneddon 1965, Tatara 1991",
        large_slope.judge,
    ),
    "contact_width": (
        "a/h",
        "half-space laws fail for contacts wider than the plate thickness",
        by_target("contact_width"),
    ),
    "adhesion": ("V/V_s", "Thornton & Ning 1998; work of separation by Johnson, Kendall & Roberts", materials.adhesion),
    "material_damping": ("tan δ", "Lee & Radok 1960; Ting 1966, with a modulus t^−β", materials.material_damping),
    "wave_losses": ("E_waves/E", "Lamb's problem, Miller & Pursey 1955", by_target("wave_losses")),
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
"""Name → indicator, source and rule."""

RULES = {name: (Rule(name, indicator, source), rule) for name, (indicator, source, rule) in _TABLE.items()}

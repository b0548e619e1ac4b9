"""Results of a march in SI: summary values, energies, and the difference of two summaries.

Every formula serves one impact, with the core's structure native.Summary, and many, with one array per field
(problem.Columns).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from film_model.base.arrays import all_of, any_of, either, ratio, unwarned
from film_model.core import native, solving
from film_model.problem.problem import Problem
from film_model.problem.stresses import stresses_of

SUMMARY: dict[str, tuple[str, str]] = {
    "maximum_force": ("force", "largest contact force"),
    "maximum_indentation": ("length", "largest indentation"),
    "time_of_maximum_indentation": ("time", "time from first touch to maximum indentation"),
    "time_impactor_stops": ("time", "time at which the impactor's velocity is zero; none if it never is"),
    "contact_duration": ("time", "time from first touch to the end of contact"),
    "permanent_indentation": ("length", "indentation that is left at the end of contact"),
    "rebound_velocity": ("velocity", "impactor velocity at the end of contact; a rebound is negative"),
    "coefficient_of_restitution": ("dimensionless", "separation velocity over approach velocity"),
    "energy_absorbed": ("energy", "work done on the indentation and not given back"),
    "energy_radiated": ("energy", "energy that went into the motion of the target"),
    "impulse": ("impulse", "of the contact force, until the end of contact"),
    "contact_radius": ("length", "largest radius of contact: Hertz's, and beyond yield that of finite elements"),
    "dent_diameter": ("length", "twice contact_radius if an indentation is left; its depth is permanent_indentation"),
    "mean_pressure": ("pressure", "largest force over the area of contact"),
    "peak_pressure": ("pressure", "at the centre of contact; elastic contacts only, none beyond yield"),
    "maximum_shear_stress": ("pressure", "below the surface, on the axis; elastic contacts only, none beyond yield"),
    "maximum_von_mises_stress": ("pressure", "at the same point; elastic contacts only, none beyond yield"),
    "depth_of_maximum_stress": ("length", "of that point below the surface; elastic contacts only, none beyond yield"),
}
"""Summary names, with dimension and meaning."""

COMPARED = (
    *("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "time_impactor_stops"),
    *("contact_duration", "permanent_indentation", "rebound_velocity", "energy_absorbed"),
)
"""Values of the summary that the core compares, in the order of film_differences."""


def summary_of(problem: Problem, status: Any, core: Any) -> dict[str, Any]:
    """Summary in SI from the core's; nan for what did not happen, and for all values of an impact that failed."""
    s, approach, final = problem.scales, problem.approach, core.final_velocity
    over = status == native.EVENT
    turned = core.maximum_indentation > 0.0
    absorbed = either(abs(core.work) > 1e-14 * approach**2, core.work, 0.0)  # less is rounding
    left = dent_of(problem, core.maximum_indentation, core.permanent_indentation)
    with unwarned(status):
        begun = {
            "maximum_indentation": core.maximum_indentation * s.length,
            "time_of_maximum_indentation": core.time_of_maximum_indentation * s.time,
        }
        whole = {
            "contact_duration": core.contact_duration * s.time,
            "permanent_indentation": left * s.length,
            "rebound_velocity": problem.drift + problem.share * (final * s.velocity),
            "coefficient_of_restitution": ratio(-final, approach),
            "energy_absorbed": absorbed * s.energy,
            "energy_radiated": radiated_energy(problem, core),
            "impulse": _impulse(problem, core),
        }
        values = {
            "maximum_force": core.maximum_force * s.force,
            **_where(turned, begun),
            "time_impactor_stops": core.time_impactor_stops * s.time,
            **_where(over, whole),
        }
        values |= stresses_of(problem, values)
    return _where(status >= 0, values)


def dent_of(problem: Problem, deepest: Any, end: Any) -> Any:
    """The dent of a contact that turned at `deepest` and ended at `end`, over δ_s; 0 where damping delays the end."""
    left = problem.own.dents(problem.curve, deepest, end) if problem.curve.pulls else end
    if problem.damps or problem.relaxation is not None:
        left = either((problem.damping > 0.0) | (problem.relaxation is not None), 0.0, left)
    return left


def _where(condition: Any, values: dict[str, Any]) -> dict[str, Any]:
    """The values where the condition holds, else nan."""
    if all_of(condition):
        return values
    return {name: either(condition, value, math.nan) for name, value in values.items()}


def _impulse(problem: Problem, core: Any) -> Any:
    """Impulse of the contact force, N s: m (V − v) + P t. On a vibrating target it needs a load of 0."""
    s = problem.scales
    push = problem.approach - core.final_velocity + problem.load * core.contact_duration
    impulse = push * (s.force * s.time)
    return either(problem.load > 0.0, math.nan, impulse) if problem.vibrates else impulse


def radiated(problem: Problem, core: Any) -> Any:
    """Energy transferred to target motion, over F_s δ_s: the remainder in the balance of energy."""
    lost = 0.5 * (problem.approach**2 - core.final_velocity**2) - core.work
    return lost + problem.load * (core.permanent_indentation + core.shift)


def radiated_energy(problem: Problem, core: Any) -> Any:
    """Energy transferred to target motion, J: ∫F²/Z dt, or the kinetic energy that a free target gains.

    A free target's momentum grows by m (V − v), m the effective mass. The energy is half of that times the sum of its
    velocities before and after, which avoids the cancellation in a difference of squares.
    """
    s = problem.scales
    if not problem.free:
        moves = problem.gamma > 0.0
        return either(moves, radiated(problem, core) * s.energy, 0.0) if any_of(moves) else 0.0 * problem.gamma
    other = 1.0 - problem.share
    before, after = problem.approach * s.velocity, core.final_velocity * s.velocity
    return 0.5 * problem.mass * (before - after) * (2.0 * problem.drift - other * (before + after))


def difference(problem: Problem, a: Any, b: Any) -> Any:
    """Largest relative difference of two summaries, relative to `b`: film_compare in film_solve.h."""
    return solving.compare(problem.start, a, b, problem.vibrates)


def differences(problem: Problem, a: native.Summary, b: native.Summary) -> dict[str, float]:
    """The same value by value, of one impact, by the names of `COMPARED`."""
    found = dict(zip(COMPARED, solving.differences(problem.start, a, b, problem.vibrates), strict=True))
    if problem.curve.reversible:  # a permanent indentation is reported as 0
        del found["permanent_indentation"]
    return found


def rounding(problem: Problem, summary: Any) -> Any:
    """How much rounding may change a summary, relative as in :func:`difference`: film_rounding in film_solve.h.

    It is large where the summary is a small difference of large numbers: the velocity of a ball whose weight does more
    work than its impact, or an indentation beyond a deep clearance.
    """
    return solving.rounding(problem.curve.native, problem.start, summary, problem.curve.clearance)


def gains_energy(problem: Problem, absorbed: Any) -> Any:
    """Whether the law's unloading returns more energy than its loading stored. absorbed: energy, J."""
    # a smaller negative energy is rounding, not a law that gains energy
    return absorbed < -1e-9 * problem.impact_energy


def gains_from_weight(problem: Problem, summary: Mapping[str, Any]) -> Any:
    """Whether an impact leaves faster than it comes by the work of its weight, without what its law gains."""
    # Energy that an impact has more than before, over its own, below which it may be a numerical error: accuracies are
    # seldom above 1e-3
    least_gain = 1e-3
    pressed = problem.load > 0.0
    if not any_of(pressed):
        return pressed
    impact = problem.impact_energy
    restitution, absorbed = summary["coefficient_of_restitution"], summary["energy_absorbed"]
    gain = impact * (restitution * restitution - 1.0) + either(absorbed < 0.0, absorbed, 0.0)
    return pressed & (gain > least_gain * impact)


def energy_warning(problem: Problem, summary: dict[str, float | None]) -> list[str]:
    """A warning if the law gains energy, and one if the impact leaves faster than it comes by the work of its weight.

    That work follows from the balance of energy: ½ m V² (e² − 1) and what the contact absorbs and the target takes.
    """
    absorbed, restitution = summary["energy_absorbed"], summary["coefficient_of_restitution"]
    if absorbed is None:
        return []
    impact, said = problem.impact_energy, list[str]()
    if gains_energy(problem, absorbed):
        share = f" ({-100 * absorbed / impact:.3g} % of the impact energy)" if impact > 0.0 else ""
        said = [f"law {problem.law.name}: its unloading returns {-absorbed:.4g} J{share} more than its loading stored"]
    if restitution is not None and gains_from_weight(problem, summary):
        work = impact * (restitution**2 - 1.0) + absorbed + (summary["energy_radiated"] or 0.0)
        times = f"{work:.4g} J of work, {work / impact:.3g} times the impact energy"
        said.append(
            f"restitution is {restitution:.4g}: contact ends below first touch, and on the way down to there the "
            f"weight does {times}; it is no property of the contact"
        )
    return said


def weight_warning(count: int) -> list[str]:
    """The warning about restitution above 1 by the work of the weight, in so many of several impacts."""
    if not count:
        return []
    return [
        f"in {count} impacts restitution is above 1: contact ends below first touch, and on the way down to there the "
        "weight does more work than is lost; it is no property of the contact"
    ]

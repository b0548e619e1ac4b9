"""Oblique impact as an effect, in closed form: how the contact will slide, and how far the rebound is open without
friction."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from film_model.base.units import format_si
from film_model.effects.case import Case
from film_model.scene import Scene
from film_model.scene.friction_table import FrictionTable
from film_model.scene.rolling import sliding_before, stiffness_ratio, tangential_mobility
from film_model.targets import Estimate

LARGEST = 1.0
"""Coefficient of friction up to which the rebound is bounded; the least is 0."""

REVERSED = (
    *((0.5, 1.0), (0.6, 0.9794), (0.7, 0.9265), (0.8333, 0.8295), (1.0, 0.7039), (1.1667, 0.597), (1.25, 0.5521)),
    *((1.4412, 0.4678), (1.75, 0.3718), (2.0, 0.3176), (2.5, 0.245)),
)
"""χ and the largest share of the sliding velocity that comes back reversed, over all coefficients of friction: a scan
of the elastic solution for Hertz's law. Beyond these χ all of it may, as friction does no negative work."""


class Open(NamedTuple):
    """Least and greatest speed after the impact, m/s, angle of the path to the normal, rad, and spin, rad/s. change:
    range of the tangential velocity over the speed before."""

    speed: tuple[float, float]
    angle: tuple[float, float]
    spin: tuple[float, float]
    change: float


def unknown(scene: Scene, restitution: float) -> Open:
    """The rebound for coefficients of friction from 0 to `LARGEST`.

    The impulse of friction lies between 0 and the lesser of µ m (1 + e) V_n, that of sliding throughout, and m_t v
    (1 + β), with β of `REVERSED`, v the sliding velocity and 1/m_t = Σ (1/m + R²/J).
    """
    ball, along = scene.impactor, scene.impactor.tangential_speed
    spin, normal = ball.spin or 0.0, scene.effective_mass * (1.0 + restitution) * scene.approach_velocity
    inertia = ball.inertia_number * scene.mass * ball.radius**2
    sliding = sliding_before(scene)
    mobility = tangential_mobility(scene)
    most = min(LARGEST * normal, abs(sliding) / mobility * (1.0 + reversed_share(scene, mobility)))
    impulses = 0.0, math.copysign(most, sliding)
    tangential = sorted(along - impulse / scene.mass for impulse in impulses)
    spins = sorted(spin - ball.radius * impulse / inertia for impulse in impulses)
    away = normal / scene.mass - ball.speed
    speeds = sorted(math.hypot(end, away) for end in tangential)
    least = abs(away) if tangential[0] < 0.0 < tangential[1] else speeds[0]
    low, high = (math.atan2(end, abs(away)) for end in tangential)
    change = most / scene.mass / max(ball.path_speed, scene.approach_velocity)
    return Open((least, speeds[1]), (low, high), (spins[0], spins[1]), change)


def reversed_share(scene: Scene, mobility: float) -> float:
    """β of `REVERSED` for χ = m/(2 κ m_t); without the materials for κ = 3/2, the largest. mobility: 1/m_t, 1/kg."""
    chi, share = np.array(REVERSED).T
    own = 0.5 * mobility * scene.effective_mass / (stiffness_ratio(scene) or 1.5)
    return float(np.interp(own, chi, share, 1.0, 1.0))


def expected(scene: Scene, restitution: float) -> str | None:
    """How the contact will slide, in words; None without the materials, or without friction or with a table of it.

    It sticks first below ψ₁ = 1 and slides throughout from ψ₁ = 2 χ (1 + e) − e on: under any law with elastic
    unloading friction then never falls below its limit.
    """
    friction, ratio = scene.contact.friction, stiffness_ratio(scene)
    if not friction or ratio is None or isinstance(friction, FrictionTable):
        return None
    number = abs(sliding_before(scene)) / (ratio * friction * scene.approach_velocity)
    chi = 0.5 * tangential_mobility(scene) * scene.effective_mass / ratio
    last = 2.0 * chi * (1.0 + restitution) - restitution
    how = "sticks first" if number < 1.0 else "slides first" if number < last else "slides throughout"
    return f"the contact {how}: impact number {number:.3g}, limits 1 and {last:.3g}"


def obliqueness(case: Case) -> Estimate:
    """An impact at an angle or with spin: simulated with friction in [contact], otherwise its normal component.

    Without friction the change is the range of the ball's tangential velocity for friction coefficients from 0 to 1,
    over its speed before: the impulse is at most µ m (1 + e) V cos α and m_t v (1 + β), with the largest share β of the
    velocity that an elastic contact gives back.
    """
    # how it slides is not said under damping, which lets more friction through
    scene, damps = case.scene, case.problem.damps and case.scene.contact.friction is not None
    return oblique(scene, None if damps else case.seen.restitution)


def oblique(scene: Scene, restitution: float | None) -> Estimate:
    """The same, also for an impact whose restitution is unknown."""
    angle, friction = scene.impactor.angle or 0.0, scene.contact.friction
    if angle == 0.0 and not scene.impactor.spin and not getattr(scene.target, "spin", None):
        return Estimate("the impact is along the normal, without spin", applies=False)
    if friction is not None:
        why = f"the tangential motion and the spin are simulated with a friction coefficient of {friction:g}"
        sliding = None if restitution is None else expected(scene, restitution)
        why += f"; {sliding}" if sliding else ""
        if scene.target.kind not in ("half-space", "body"):
            why += f"; the {scene.target.kind} is immovable along its surface"
        return Estimate(why, math.degrees(angle), 0.0, simulated=True)
    normal = format_si(scene.impactor.speed, "velocity")
    why = f"only the normal component, {normal}, is simulated: give friction in [contact]"
    if restitution is None:
        return Estimate(why, math.degrees(angle), 0.0, fails=True)
    found = unknown(scene, restitution)
    kinds = {"velocity": found.speed, "angle": found.angle, "angular_frequency": found.spin}
    speed, turn, spun = (_range(ends, kind) for kind, ends in kinds.items())
    why += (
        f"; with coefficients from 0 to {LARGEST:g} the ball leaves with {speed} at {turn} to the normal, spin {spun}"
    )
    return Estimate(why, math.degrees(angle), 0.0, found.change)


def _range(ends: tuple[float, float], kind: str) -> str:
    if kind == "angle":
        return " to ".join(f"{math.degrees(end):.3g}°" for end in ends)
    return " to ".join(format_si(end, kind, 3) for end in ends)

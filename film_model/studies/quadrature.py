"""Reference solutions that do not use the core: quadrature of the energy integral, and conventional integration.

Both use a law's own stage functions and unloading rules, not their fits. Arguments: effective mass m [kg], approach
velocity V_0 > 0 [m/s], impedance Z of the target [N·s/m], infinite for a half-space. Both return SI floats by the names
of `REFERENCE_VALUES`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from film_model.laws.law import AbstractLaw, Array, Function, Power, Stage, Unloading, origin_of

REFERENCE_VALUES = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "time_impactor_stops",
    "contact_duration",
    "permanent_indentation",
    "rebound_velocity",
    "coefficient_of_restitution",
    "energy_absorbed",
    "energy_radiated",
)
"""Names of the results: N, m, s, s, s, m, m/s (negative: away from the target), 1, J, J."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


def quadrature(law: AbstractLaw, mass: float, velocity: float) -> dict[str, float]:
    """Summary of an impact on a half-space, to about 1e-13: the energy integral, v² = V_0² − 2W(δ)/m and t = ∫dδ/v.

    The substitution δ = δ_end − h s² in each stage removes the square root at the turning point; the integrals are
    adaptive Gauss–Legendre sums of 20 points. A reversible law unloads in the same time as it loads.

    Raises ValueError if the law ends before the motion turns, or has damping.
    """
    _undamped(law)
    scale, force_scale = law.scales(0.5 * mass * velocity**2)
    square = mass * velocity**2 / (force_scale * scale)  # ν², falls from stage to stage
    time, peak = 0.0, 0.0
    for stage in law.stages():
        to = _turning_point(stage, 0.5 * square)
        left = 0.0 if to is not None else square - 2.0 * float(work_before(stage, stage.end, stage.end - stage.begin))
        end = stage.end if to is None else to
        time += _passage(stage, end, left)
        peak = max(peak, _peak(stage, end))
        square = left
        if to is not None:
            break
    else:
        raise ValueError(f"the law ends at {law.stages()[-1].end * scale:g} m, before the motion turns")
    force = float(value(stage.force, end, stage))
    clock = math.sqrt(mass * scale / force_scale)
    if stage.unloading is None:
        residual, out, opening = 0.0, velocity * clock / scale, time
    else:
        branch = unloaded(stage.unloading, stage, end, force)
        residual, opening = branch.begin, _passage(branch, end, 0.0)
        out = math.sqrt(2.0 * float(work_before(branch, end, end - residual)))
    rebound = -out * scale / clock
    times = (time * clock, time * clock, (time + opening) * clock)
    absorbed = 0.5 * mass * (velocity**2 - rebound**2) if stage.unloading is not None else 0.0
    depths = (end * scale, residual * scale)
    return _summary(depths, peak * force_scale, times, (velocity, rebound), (absorbed, 0.0))


def integrate(
    law: AbstractLaw,
    mass: float,
    velocity: float,
    impedance: float = math.inf,
    method: str = "DOP853",
    rtol: float = 1e-12,
    atol: float = 1e-14,
    load: float = 0.0,
) -> dict[str, float]:
    """Summary of an impact on a half-space or an impedance target by `scipy.integrate.solve_ivp`, any `method`.

    Zener's equations ξ' = ν − γf, ν' = p − f, p a constant load [N], in units of V_0 and the maximum indentation on a
    half-space. In a stage that begins at ξ_b, and on an unloading branch that ends there, the variables are
    y = √(ξ − ξ_b) and σ, with dt = 2y dσ:

        dy/dσ = ν − γf,  dν/dσ = 2y(p − f),  dt/dσ = 2y,  dr/dσ = 2yγf²  (r: energy radiated)

    so that a 3/2-power force is smooth where contact begins and ends, and both are ordinary crossings. The
    integration restarts at every stage boundary, at the maximum indentation and where the impactor stops; each of
    these points is located on the interpolant, reached by a step of the method, and corrected by Newton's method.
    With the defaults the errors are near 1e-12 of the largest value of a variable: a rebound of 2e-4 V_0 has eight
    correct digits. `atol` is in the units above. The time at which the impactor stops is NaN if it does not stop.

    Adds "force_evaluations" to the names of `REFERENCE_VALUES`. Raises ValueError if the law ends before the motion
    turns, has damping, or if its force jumps up by more than the target's motion allows; RuntimeError if the method
    fails, or if the load turns the impactor back before contact ends.
    """
    _undamped(law)
    scale, force_scale = law.scales(0.5 * mass * velocity**2)
    stages = law.stages()
    square = mass * velocity**2 / (force_scale * scale)
    size = _half_space_depth(stages, 0.5 * square)
    unit = size / square  # force: law's units to those of the impact
    gamma = mass * velocity / (size * scale * impedance)
    solver = _Solver(gamma, load / force_scale * unit, method, rtol, atol)
    turn = _load(solver, stages, size, unit)
    if turn is None:
        raise ValueError(f"the law ends at {stages[-1].end * scale:g} m, before the motion turns")
    state, stops, residual, given_back = _unload(solver, stages, turn, size, unit)

    clock = size * scale / velocity
    times = (turn.state[2] * clock, (math.nan if stops is None else stops) * clock, state[2] * clock)
    energies = ((turn.work - given_back) * force_scale * scale, state[3] * mass * velocity**2)
    depths = (turn.depth * scale, residual * scale)
    result = _summary(depths, turn.peak * force_scale, times, (velocity, state[1] * velocity), energies)
    return {**result, "force_evaluations": float(solver.calls)}


class _Turn(NamedTuple):
    """The maximum indentation: state, stage, ξ, work and largest force of loading."""

    state: Array
    stage: Stage
    depth: float
    work: float
    peak: float


def _load(solver: _Solver, stages: tuple[Stage, ...], size: float, unit: float) -> _Turn | None:
    """Integrate loading; None if the law ends before the motion turns."""
    state, work, peak = np.array([0.0, 1.0, 0.0, 0.0]), 0.0, 0.0
    for stage in stages:
        state[0] = 0.0
        solver.force = _loading(stage, size, unit)
        if solver.rates(0.0, state)[0] <= 0.0:
            raise ValueError(f"stage {stage.name!r} begins with a force that stops the indentation at once")
        state, turned = solver.advance(state, math.sqrt((stage.end - stage.begin) / size), until="turns")
        depth = stage.begin + size * state[0] ** 2 if turned else stage.end
        work += float(work_before(stage, depth, depth - stage.begin))
        peak = max(peak, _peak(stage, depth))
        if turned:
            return _Turn(state, stage, depth, work, peak)
    return None


def _unload(
    solver: _Solver, stages: tuple[Stage, ...], turn: _Turn, size: float, unit: float
) -> tuple[Array, float | None, float, float]:
    """Integrate unloading: state at the end, time at which the impactor stops, residual ξ, and work given back."""
    stage, depth, state = turn.stage, turn.depth, turn.state.copy()
    force = float(value(stage.force, depth, stage))
    stops = state[2] if solver.gamma == 0.0 else None  # on a target that does not move the impactor stops at the turn
    if stage.unloading is not None:
        branch = unloaded(stage.unloading, stage, depth, force)
        residual = branch.begin
        given_back = float(work_before(branch, depth, depth - residual))
        branches = [((depth - residual) / size, _loading(branch, size, unit))]
    else:  # back through the stages, from the one in which the motion turned
        passed = stages[: stages.index(stage) + 1][::-1]
        residual, given_back = 0.0, turn.work
        branches = [((min(s.end, depth) - s.begin) / size, _loading(s, size, unit)) for s in passed]
    for span, solver.force in branches:
        state[0], stopped = math.sqrt(span), True
        while stopped:
            state, stopped = solver.advance(state, 0.0, until="stops" if stops is None else None)
            stops = state[2] if stopped else stops
    return state, stops, residual, given_back


def _undamped(law: AbstractLaw) -> None:
    if law.damped:
        raise ValueError(f"law {law.name} is damped: this reference is for forces that depend on the indentation alone")


@dataclass
class _Solver:
    """Integrates (y, ν, t, r) over σ with solve_ivp; `force` is f as a function of y² = ξ − ξ_b."""

    gamma: float
    load: float
    method: str
    rtol: float
    atol: float
    force: Callable[[float], float] = lambda x: 0.0
    calls: int = 0

    def rates(self, _: float, state: Any) -> Array:
        y, nu = float(state[0]), float(state[1])
        f = self.force(y * y)
        self.calls += 1
        return np.array([nu - self.gamma * f, 2.0 * y * (self.load - f), 2.0 * y, 2.0 * y * self.gamma * f * f])

    def advance(self, state: Array, target: float, until: str | None) -> tuple[Array, bool]:
        """Integrate to y = target, or until the indentation "turns" or the impactor "stops"; True for the latter."""
        reaches = _event(lambda _, s: s[0] - target, 1.0 if target > 0.0 else -1.0)
        events = [reaches] if math.isfinite(target) else []
        watched = {"turns": lambda _, s: self.rates(_, s)[0], "stops": lambda _, s: s[1]}
        if until is not None:
            events.append(_event(watched[until], -1.0))
        if self.load > 0.0 and until != "turns":
            events.insert(0, _event(watched["turns"], 1.0))
        solution = self._solve(state, 1e6, events)  # no contact lasts as long as σ = 1e6
        if solution.status != 1:
            raise RuntimeError(f"{self.method}: {solution.message}")
        if self.load > 0.0 and until != "turns" and solution.t_events[0].size > 0:
            raise RuntimeError("the load turns the impactor back before contact ends")
        stopped = until is not None and solution.t_events[-1].size > 0
        step, state = solution.t[-1] - solution.t[-2], solution.y[:, -2]
        if step > 0.0:
            state = self._solve(state, step, None).y[:, -1]
        # Newton steps on an event; each squares its error, which starts near 1e-7
        for _ in range(3):
            rates = self.rates(0.0, state)
            # where the indentation turns, (ν − γf)' = ν' because y' = 0
            miss = state[0] - target if not stopped else rates[0] if until == "turns" else state[1]
            step = -miss / (rates[1] if stopped else rates[0])
            state = state + step * self.rates(0.0, state + 0.5 * step * rates)
        return state, stopped

    def _solve(self, state: Array, span: float, events: Any) -> Any:
        from scipy.integrate import solve_ivp

        options: Any = {"method": self.method, "rtol": self.rtol, "atol": self.atol, "events": events}
        return solve_ivp(self.rates, (0.0, span), state, **options)


def _event(function: Callable[[float, Any], float], direction: float) -> Any:
    """A terminal event; solve_ivp reads its settings from attributes of the function."""
    event: Any = function
    event.terminal, event.direction = True, direction
    return event


def _loading(stage: Stage, size: float, unit: float) -> Callable[[float], float]:
    return lambda x: unit * float(value(stage.force, stage.begin + size * x, stage))


def _half_space_depth(stages: tuple[Stage, ...], energy: float) -> float:
    """ξ at which the work reaches `energy`, or the end of the law if that is less."""
    for stage in stages:
        depth = _turning_point(stage, energy)
        if depth is not None:
            return depth
        energy -= float(work_before(stage, stage.end, stage.end - stage.begin))
    return stages[-1].end


def value(function: Function | float, xi: Any, stage: Stage) -> Array:
    """A function of a law's stage at indentation ξ (float or array, in units of the law's scale)."""
    x = np.asarray(xi, dtype=np.float64)
    if isinstance(function, (int, float)):
        return np.full(x.shape, float(function))
    if not isinstance(function, Power):
        return np.broadcast_to(np.asarray(function(np.atleast_1d(x)), dtype=np.float64).reshape(x.shape), x.shape)
    return function.at(np.maximum(x - origin_of(function, stage), 0.0))


def work_before(stage: Stage, to: float, lengths: Any) -> Array:
    """∫f dξ from `to` − length to `to`, for lengths within the stage; closed form without cancellation for a power."""
    d = np.asarray(lengths, dtype=np.float64)
    force = stage.force
    if not isinstance(force, Power):
        flat = np.atleast_1d(d)
        mean = _integral(lambda u: value(force, to - np.multiply.outer(u, flat), stage))
        return (flat * mean).reshape(d.shape)
    top = max(to - origin_of(force, stage), 0.0)
    x = np.minimum(d, top)
    if top == 0.0:
        return force.constant * d
    n = force.exponent + 1.0
    with np.errstate(divide="ignore"):
        # top^n − (top − x)^n
        difference = -(top**n) * np.expm1(n * np.log1p(-x / top))
    line, square = x * (top - 0.5 * x), x * (top * (top - x) + x * x / 3.0)
    return force.constant * d + force.slope * line + force.square * square + force.coefficient * difference / n


def unloaded(rule: Unloading, stage: Stage, xi: float, force: float) -> Stage:
    """The unloading branch from (ξ, f), as a stage from ξ_f to ξ."""
    name, function = rule.rule
    q, given = float(value(rule.exponent, xi, stage)), float(value(function, xi, stage))
    if name == "shifted":
        free = max(xi**q - force / given, 0.0) ** (1.0 / q)
        return Stage("unloading", free, xi, Power(force - given * xi**q, coefficient=given, exponent=q, origin=0.0))
    if name == "residual":
        free = given
    elif name == "secant":
        free = max(xi - force / given, 0.0)
    else:
        free = xi - (force / math.sqrt(given)) ** (1.0 / q)
    return Stage("unloading", free, xi, Power(coefficient=force / (xi - free) ** q, exponent=q, origin=free))


def _passage(stage: Stage, end: float, left: float) -> float:
    """Time from the beginning of a stage to `end`, at which ν² = `left`, without a load."""
    length = end - stage.begin
    if length == 0.0:
        return 0.0

    def slowness(s: Array) -> Array:
        return 2.0 * length * s / np.sqrt(left + 2.0 * work_before(stage, end, length * s * s))

    return float(_integral(slowness))


def _integral(function: Callable[[Array], Array]) -> Array:
    """∫ function(u) du over 0 ≤ u ≤ 1, along the first axis of what `function` returns."""

    def sums(left: Array, width: float) -> Array:
        values = function((left[:, None] + width * 0.5 * (1.0 + _NODES)).ravel())
        panels = values.reshape(left.size, _NODES.size, *values.shape[1:])
        return np.einsum("pn...,n->p...", panels, 0.5 * width * _WEIGHTS)

    left, width = np.zeros(1), 1.0
    whole = sums(left, width)
    total = np.zeros(whole.shape[1:])
    for _ in range(60):
        width *= 0.5
        halves = sums(np.stack([left, left + width], axis=1).ravel(), width)
        pairs = halves.reshape(left.size, 2, *halves.shape[1:])
        fine = pairs.sum(axis=1)
        size = np.abs(total + fine.sum(axis=0))
        poor = (np.abs(fine - whole) > 1e-15 * size).reshape(left.size, -1).any(axis=1)
        total = total + fine[~poor].sum(axis=0)
        left, whole = np.stack([left, left + width], axis=1)[poor].ravel(), pairs[poor].reshape(-1, *fine.shape[1:])
        if left.size == 0:
            return total
    return total + whole.sum(axis=0)


def _turning_point(stage: Stage, energy: float) -> float | None:
    """ξ at which the work of the stage reaches `energy`, or None if the stage ends before."""
    from scipy.optimize import brentq

    reach = min(stage.end - stage.begin, 1.0)

    def excess(length: float) -> float:
        return float(work_before(stage, stage.begin + length, length)) - energy

    while excess(reach) < 0.0:
        if stage.begin + reach >= stage.end:
            return None
        reach = min(2.0 * reach, stage.end - stage.begin)
    tightest: Any = 4.0 * np.finfo(np.float64).eps
    root: Any = brentq(excess, 0.0, reach, xtol=1e-300, rtol=tightest)
    return stage.begin + float(root)


def _peak(stage: Stage, to: float) -> float:
    """Largest f between the beginning of the stage and `to`; a peak inside is refined until the force is exact."""
    from scipy.optimize import minimize_scalar

    grid = np.linspace(stage.begin, to, 257)
    k = int(np.argmax(value(stage.force, grid, stage)))
    best = float(value(stage.force, grid[k], stage))
    if 0 < k < 256:
        found: Any = minimize_scalar(
            lambda xi: -float(value(stage.force, xi, stage)), bounds=(grid[k - 1], grid[k + 1]), method="bounded"
        )
        best = max(best, -float(found.fun))
    return best


def _summary(
    depths: tuple[float, float], force: float, times: tuple[float, float, float], speeds: tuple[float, float],
    energies: tuple[float, float],
) -> dict[str, float]:  # fmt: skip
    """`REFERENCE_VALUES` from ξ (maximum, residual), F_m, times (turn, stop, end), speeds (approach, end), energies."""
    values = (force, depths[0], *times, depths[1], speeds[1], -speeds[1] / speeds[0], *energies)
    return dict(zip(REFERENCE_VALUES, (float(v) for v in values), strict=True))

"""Stages of a law → the pieces that the core evaluates.

The core evaluates a :class:`~film_model.laws.law.Power` exactly. Any other function is fitted by Chebyshev series in ξ,
or in √(ξ − ξ_b) for a stage marked `root`; the stage is halved until every series in it meets `FIT_TOLERANCE`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from film_model.core import native
from film_model.laws.law import Array, Function, Power, Stage, origin_of
from film_model.problem.series import coefficients, mean_series

FIT_TOLERANCE = 1e-13
"""Largest difference between a fitted function and the law, relative to the function's largest value in the stage."""

FIT_ROUNDING = 4e-16
"""Trailing terms of a series are dropped if smaller than this, relative to the function's largest value."""

FIT_LIMIT = 1e-6
"""ValueError if the relative error of the fit is larger with all pieces that the core can hold."""

CHECKS = 157
"""Points between the nodes at which a fit is checked; shares no factor with the number of nodes."""

_TERMS = native.MAX_TERMS
_KINDS = {
    "radius_ratio": native.RADIUS,
    "residual": native.RESIDUAL,
    "secant": native.SECANT,
    "shifted": native.SHIFTED,
    "contact_area": native.SIMILAR,
}
_CLOSER = (1e-12, 1e-9, 1e-6, 1e-3)
"""Where the first piece of a stage with f(0) = 0 is split: rounding errors are relative to a piece's largest value."""

Span = tuple[float, float, bool, dict[str, Any]]
"""A piece of a stage: begin, end, whether it is fitted over the root, and its series by name."""

Split = Callable[[Stage, Mapping[str, Function], int], tuple[list[Span], float]]
"""A stage, its functions and the largest number of pieces → the pieces, and the largest error of a series."""


def assemble(law: str, stages: list[Stage], split: Split | None = None) -> tuple[native.Curve, float, float]:
    """The core's curve of checked stages, the largest error of a fit, and the largest exponent of unloading.

    split: how a stage is cut into pieces; by default halved until the series fit.
    """
    made = native.Curve()
    made.stages = len(stages)
    error, pieces, steepest = 0.0, 0, 0.0
    for index, stage in enumerate(stages):
        functions = functions_of(stage)
        if stage.unloading is not None:
            steepest = max(steepest, float(values_of(functions["exponent"], np.array([stage.begin]), stage)[0]))
        room = native.MAX_PIECES - pieces - (len(stages) - index - 1)
        spans, worst = (split or halved)(stage, functions, room)
        error = max(error, worst)
        if worst > FIT_LIMIT:
            raise ValueError(
                f"{law}: stage {stage.name!r} cannot be fitted: the series still differ by {worst:.1e}; "
                "split it where its force has a kink, or set root=True if the force begins like a square root"
            )
        entry = made.stage[index]
        entry.begin, entry.end, entry.first, entry.count = stage.begin, stage.end, pieces, len(spans)
        entry.unloading = native.RETRACE if stage.unloading is None else _KINDS[stage.unloading.rule[0]]
        entry.damped = stage.damping is not None
        entry.reload_exponent = 0.0 if stage.unloading is None else stage.unloading.reload_exponent or 0.0
        if stage.pulls:
            made.pull = max(
                made.pull, -float(values_of(stage.force, np.linspace(stage.begin, stage.end, CHECKS), stage).min())
            )
        work = 0.0
        for span in spans:
            work = _fill(made.piece[pieces], stage, functions, span, work)
            pieces += 1
    made.pieces = pieces
    return made, error, steepest


def checked(law: str, given: tuple[Stage, ...]) -> list[Stage]:
    """The stages, split at extremes of the force. Raises ValueError for what the core cannot take."""
    stages = [part for stage in given for part in _split_at_peak(stage)]
    if not 1 <= len(stages) <= native.MAX_STAGES:
        cut = "" if len(stages) == len(given) else ", split where the force has a maximum or minimum"
        raise ValueError(f"{law}: {len(stages)} stages{cut}; 1 to {native.MAX_STAGES} are allowed")
    if any(stage.damping is not None and (len(stages) > 1 or stage.unloading is not None) for stage in stages):
        raise ValueError(f"{law}: a damped law must have one stage, and no unloading")
    pulls = any(stage.pulls for stage in stages)
    rules = ["" if stage.unloading is None else stage.unloading.rule[0] for stage in stages]
    damped = any(stage.damping is not None for stage in stages)
    if pulls and (damped or rules != sorted(rules) or not {*rules} <= {"", "contact_area"}):
        raise ValueError(
            f"{law}: a law that pulls has no damping, and its stages unload reversibly, then by contact_area"
        )
    if "contact_area" in rules and not (pulls and rules[0] == ""):
        raise ValueError(f"{law}: only a law that pulls unloads by contact_area, after reversible stages")
    begin = min(stages[0].begin, 0.0) if pulls else 0.0
    for stage in stages:
        if stage.begin != begin or not stage.end > stage.begin:
            raise ValueError(
                f"{law}: stage {stage.name!r} runs from {stage.begin!r} to {stage.end!r}; it must begin at "
                f"{begin!r}, where the stage before ends, and end beyond that"
            )
        begin = stage.end
        if math.isinf(stage.end) and not all(isinstance(f, Power) for f in functions_of(stage).values()):
            raise ValueError(
                f"{law}: stage {stage.name!r} has no end, so all its functions must be Power(...); "
                "give the others an end beyond the deepest indentation you expect"
            )
        end = stage.end if math.isfinite(stage.end) else 10.0 * (stage.begin + 1.0)
        xi = np.linspace(stage.begin, end, CHECKS)
        force = values_of(stage.force, xi, stage)
        finite = np.isfinite(force)
        wrong = force[~(finite & (stage.pulls | (force >= -1e-12 * np.abs(force[finite]).max(initial=0.0))))]
        if wrong.size:
            raise ValueError(f"{law}: stage {stage.name!r} has a force of {wrong[0]:g}; it must be finite and >= 0")
        for name, function in functions_of(stage).items():
            if not np.isfinite(values_of(function, xi[1:-1], stage)).all():
                what = stage.unloading.rule[0] if name == "recovery" and stage.unloading is not None else name
                raise ValueError(f"{law}: the {what} of stage {stage.name!r} is not finite everywhere")
    return stages


def functions_of(stage: Stage) -> dict[str, Function]:
    """The functions of a stage, by the names of the core's fields."""
    functions: dict[str, Function] = {"force": stage.force}
    unloading = stage.unloading
    if unloading is not None:
        exponent = unloading.exponent
        functions["recovery"] = unloading.rule[1]
        functions["exponent"] = Power(constant=float(exponent)) if isinstance(exponent, (int, float)) else exponent
    if stage.damping is not None:
        functions["damping"] = stage.damping
    return functions


def values_of(function: Function, xi: Array, stage: Stage) -> Array:
    """A function of a stage at points."""
    if isinstance(function, Power):
        return function.at(np.maximum(xi - origin_of(function, stage), 0.0))
    return np.broadcast_to(np.asarray(function(xi), dtype=np.float64), xi.shape)


def _split_at_peak(stage: Stage) -> list[Stage]:
    """The stage, split at maxima and minima of its force, so that these lie at the ends of stages."""
    if isinstance(stage.force, Power) and min(stage.force.slope, stage.force.square, stage.force.coefficient) >= 0.0:
        return [stage]
    end = stage.end if math.isfinite(stage.end) else stage.begin + 1e3
    grid = np.linspace(stage.begin, end, 20 * CHECKS)
    rises = np.sign(np.diff(values_of(stage.force, grid, stage)))
    cuts = [stage.begin]
    for k in np.flatnonzero(rises[:-1] * rises[1:] < 0):
        cuts.append(_extreme(stage, float(grid[k]), float(grid[k + 2]), float(rises[k])))
    edges = [*cuts, stage.end]
    if len(edges) == 2:
        return [stage]
    force = stage.force
    if isinstance(force, Power):
        force = replace(force, origin=origin_of(force, stage))
    return [replace(stage, begin=a, end=b, force=force, work=None) for a, b in pairwise(edges)]


def _extreme(stage: Stage, low: float, high: float, sign: float) -> float:
    """Golden-section search for the extreme of the force between low and high."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(80):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        f_a, f_b = sign * values_of(stage.force, np.array([a, b]), stage)
        low, high = (a, high) if f_a < f_b else (low, b)
    return 0.5 * (low + high)


def halved(stage: Stage, functions: Mapping[str, Function], room: int) -> tuple[list[Span], float]:
    """The stage in pieces (begin, end, root, series by name); the worst piece is halved while `room` allows it."""
    fitted = {name: f for name, f in functions.items() if not isinstance(f, Power)}
    end = stage.end if stage.reach is None else stage.reach
    edges = [stage.begin, *(knot for knot in stage.knots if stage.begin < knot < end), end]
    from_nothing = stage.begin == 0.0 and values_of(stage.force, np.zeros(1), stage)[0] == 0.0
    knot = edges[1]
    if "force" in fitted and from_nothing and len(edges) + len(_CLOSER) <= room:
        edges[1:1] = [part * knot for part in _CLOSER]
    spans = [(a, b, stage.root and b <= knot) for a, b in pairwise(edges if fitted else [edges[0], edges[-1]])]
    pieces = [(a, b, root, *fit(fitted, stage.begin if root else a, b, root)) for a, b, root in spans]
    while fitted and len(pieces) < room:
        worst = max(range(len(pieces)), key=lambda k: pieces[k][4])
        begin, end, root, _, error = pieces[worst]
        # a stage that pulls may begin like a root below 0: the rounding of ξ limits the root of ξ − ξ_b
        if error <= (1e-11 if root and stage.pulls else FIT_TOLERANCE):
            break
        # a root stage is split near its singular point, so that the function is smooth on the rest
        middle = begin + (0.25 if root else 0.5) * (end - begin)
        pieces[worst : worst + 1] = [
            (begin, middle, root, *fit(fitted, stage.begin if root else begin, middle, root)),
            (middle, end, False, *fit(fitted, middle, end, False)),
        ]
    return [(a, b, root, series) for a, b, root, series, _ in pieces], max(piece[4] for piece in pieces)


def fit(
    functions: Mapping[str, Callable[[Array], Array]], begin: float, end: float, root: bool
) -> tuple[dict[str, Any], float]:
    """Series of each function on [begin, end], and the largest relative error, checked between the nodes."""
    found = {name: _series(function, begin, end, root) for name, function in functions.items()}
    return {name: series for name, (series, _) in found.items()}, max((off for _, off in found.values()), default=0.0)


@lru_cache(maxsize=4096)
def _series(function: Callable[[Array], Array], begin: float, end: float, root: bool) -> tuple[Array, float]:
    """The same of one function; cached, because laws of one kind often share their rule of unloading."""
    nodes, checks = np.polynomial.chebyshev.chebpts1(_TERMS), np.cos(np.pi * np.arange(CHECKS) / (CHECKS - 1))

    def on(z: Array) -> Array:
        x = 0.5 * (1.0 + z)
        xi = begin + (end - begin) * (x * x if root else x)
        return np.broadcast_to(np.asarray(function(xi), dtype=np.float64), xi.shape)

    exact = on(checks)
    scale = max(float(np.abs(exact).max()), 1e-300)
    series: Any = np.polynomial.chebyshev.chebtrim(coefficients(on(nodes)), FIT_ROUNDING * scale)
    return series, float(np.abs(np.polynomial.chebyshev.chebval(checks, series) - exact).max()) / scale


def _fill(
    piece: native.Piece,
    stage: Stage,
    functions: Mapping[str, Function],
    span: Span,
    work: float,
) -> float:
    """Write one piece. work: done in the stage before this piece; returns the work up to its end."""
    begin, end, root, series = span
    start = stage.begin if root else begin
    piece.end = end
    for name, function in functions.items():
        target = getattr(piece, name)
        if isinstance(function, Power):
            target.form, target.origin, target.per_span = native.POWER, origin_of(function, stage), 1.0
            target.constant, target.slope, target.square = function.constant, function.slope, function.square
            target.coefficient, target.exponent = function.coefficient, function.exponent
        else:
            _write(target, series[name], start, end, root)
    if isinstance(stage.force, Power):
        origin = origin_of(stage.force, stage)
        at_begin = stage.force.work(max(begin - origin, 0.0))
        piece.work_at_begin = at_begin - work
        return work + stage.force.work(max(end - origin, 0.0)) - at_begin if end < math.inf else work
    mean = mean_series(series["force"], root)
    _write(piece.mean, mean, start, end, root)
    before, whole = np.polynomial.chebyshev.chebval([2.0 * math.sqrt((begin - start) / (end - start)) - 1.0, 1.0], mean)
    piece.work_at_begin = float(begin - start) * float(before) - work
    return work + (end - start) * float(whole) - (begin - start) * float(before)


def _write(target: native.Function, series: Any, begin: float, end: float, root: bool) -> None:
    target.form = native.ROOT_SERIES if root else native.SERIES
    target.terms, target.origin, target.per_span = len(series), begin, 1.0 / (end - begin)
    target.exponent = 1.0
    target.series[: len(series)] = [float(term) for term in series]

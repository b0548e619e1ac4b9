"""Contact law → Curve: the dimensionless stages that the core evaluates.

A :class:`~film_model.laws.law.Power` goes over as it is. Any other function becomes Chebyshev series in ξ, or in
√(ξ − ξ_b) for a stage marked `root`; a stage is halved until every series in it meets `FIT_TOLERANCE`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from film_model.core import native
from film_model.errors import SimulationError
from film_model.laws.law import AbstractLaw, Array, Function, Power, Stage, origin_of

FIT_TOLERANCE = 1e-13
"""Largest difference between a fitted function and the law, relative to the function's largest value in the stage."""

FIT_ROUNDING = 4e-16
"""Last terms of a series that are smaller than this part of the function's largest value are left out."""

FIT_LIMIT = 1e-6
"""A law that cannot be fitted better than this within the core's room is refused."""

_TERMS = native.MAX_TERMS
_KINDS = {
    "radius_ratio": native.RADIUS,
    "residual": native.RESIDUAL,
    "secant": native.SECANT,
    "shifted": native.SHIFTED,
}
_CLOSER = (1e-12, 1e-9, 1e-6, 1e-3)
"""Where the first piece of a stage that begins without force is cut: a series is rounded at its own largest value."""

_CHECKS = 157  # points between the nodes at which a fit is checked; shares no factor with the number of nodes


@dataclass(frozen=True)
class Curve:
    """A law ready for the core.

    native: the core's structure, with its compliance. stage_names: one a stage. fit_error: largest relative
    difference between a fitted function and the law (0 when nothing had to be fitted). steepest: largest exponent of
    an unloading branch. warnings: what a user of the law should know, in sentences.
    """

    native: native.Curve = field(repr=False, compare=False)
    stage_names: tuple[str, ...]
    fit_error: float
    steepest: float
    warnings: tuple[str, ...]

    def force(self, xi: float) -> float:
        """f(ξ) in loading, as the core evaluates it."""
        return native.stage_law(self.native, self._stage_at(xi), xi)[0]

    def work(self, xi: float) -> float:
        """∫f dξ from 0 to ξ in loading, as the core evaluates it."""
        last = self._stage_at(xi)
        ends = [*(self.native.stage[k].end for k in range(last)), xi]
        return sum(native.stage_law(self.native, k, end)[1] for k, end in enumerate(ends))

    def _stage_at(self, xi: float) -> int:
        stages = [self.native.stage[k].end for k in range(self.native.stages)]
        return min(sum(end < xi for end in stages), len(stages) - 1)


def curve_of(law: AbstractLaw, compliance: float = 0.0) -> Curve:
    """The curve of a law; with a `compliance` c [δ_s/F_s] in series with a spring, over ξ + c f.

    Raises ValueError when stages do not follow each other, a force is negative, a function is not finite, a stage that
    has to be fitted has no end, a fit does not come within `FIT_LIMIT`, or a stage has damping and the law does not say
    so; SimulationError for a force that jumps, or falls so fast that it snaps through, in series with a spring. The
    message names the law, the stage and the value.
    """
    try:
        stages = tuple(law.stages())
        curve = _build(_name(law), stages, compliance)
    except TypeError as error:
        if "unhashable" not in str(error):
            raise
        raise ValueError(f"{_name(law)}: a law must be a frozen dataclass with hashable fields ({error})") from None
    for stage in stages:
        if stage.damping is not None and not law.damped:
            raise ValueError(
                f"{_name(law)}: stage {stage.name!r} has damping, so the law must say damped = True and give its "
                "damping_factor"
            )
    return curve


@lru_cache(maxsize=256)
def _build(law: str, given: tuple[Stage, ...], compliance: float) -> Curve:
    """The curve of these stages: laws that differ in their scales only share it."""
    stages = _checked(law, given)
    made = native.Curve()
    made.stages = len(stages)
    error, pieces, steepest = 0.0, 0, 0.0
    for index, stage in enumerate(stages):
        functions = _functions(stage)
        if stage.unloading is not None:
            steepest = max(steepest, float(_values(functions["exponent"], np.array([stage.begin]), stage)[0]))
        room = native.MAX_PIECES - pieces - (len(stages) - index - 1)
        spans, worst = _split(stage, functions, room)
        error = max(error, worst)
        if worst > FIT_LIMIT:
            raise ValueError(
                f"{law}: stage {stage.name!r} cannot be fitted: the series still differ by {worst:.1e}; "
                "split it where its force has a kink, or set root=True if it begins like a root"
            )
        entry = made.stage[index]
        entry.begin, entry.end, entry.first, entry.count = stage.begin, stage.end, pieces, len(spans)
        entry.unloading = native.RETRACE if stage.unloading is None else _KINDS[stage.unloading.rule[0]]
        entry.damped = stage.damping is not None
        entry.reload_exponent = 0.0 if stage.unloading is None else stage.unloading.reload_exponent or 0.0
        work = 0.0
        for span in spans:
            work = _fill(made.piece[pieces], stage, functions, span, work)
            pieces += 1
    made.pieces = pieces
    if compliance > 0.0:
        _put_in_series(law, made, stages, compliance)
    if native.library().film_check_curve(ctypes.byref(made)) != native.OK:
        raise ValueError(f"{law}: the core refuses the numbers of its stages: all must be finite, their work too")
    return Curve(made, tuple(stage.name for stage in stages), error, steepest, tuple(_remarks(law, stages, error)))


def _put_in_series(law: str, made: native.Curve, stages: list[Stage], compliance: float) -> None:
    """Ends of stages and pieces over ξ + c f, and their work with the spring's, c f²/2 from the stage's beginning."""
    if any(stage.damping is not None for stage in stages):
        raise SimulationError(f"{law}: a damped law cannot be put in series with a spring, nor on vibrations")
    made.compliance, before, begin = compliance, 0.0, 0.0
    for entry, stage in zip(made.stage, stages, strict=False):
        reach = stage.end if math.isfinite(stage.end) else 10.0 * (stage.begin + 1.0)
        xi = np.linspace(stage.begin, reach, _CHECKS)
        force = _values(stage.force, xi, stage)
        if abs(force[0] - before) > 1e-9 * float(np.abs(force).max()):
            raise SimulationError(
                f"{law}: on a target that gives way no force may jump, and that of stage {stage.name!r} does, "
                f"from {before:g} to {force[0]:g}"
            )
        if (np.diff(xi + compliance * force) <= 0.0).any():
            raise SimulationError(
                f"{law}: the force of stage {stage.name!r} falls faster than the target springs back: the contact "
                "would snap through"
            )
        for piece in made.piece[entry.first : entry.first + entry.count]:
            piece.work_at_begin += 0.5 * compliance * force[0] ** 2
            if math.isfinite(piece.end):
                piece.end += compliance * float(_values(stage.force, np.array([piece.end]), stage)[0])
        before = float(force[-1])
        entry.begin, entry.end = begin, made.piece[entry.first + entry.count - 1].end
        begin = entry.end


def _name(law: AbstractLaw) -> str:
    return f"law {getattr(law, 'name', type(law).__name__)!r}"


def _checked(law: str, given: tuple[Stage, ...]) -> list[Stage]:
    stages = [part for stage in given for part in _split_at_peak(stage)]
    if not 1 <= len(stages) <= native.MAX_STAGES:
        cut = "" if len(stages) == len(given) else ", cut where the force turns from rising to falling or back"
        raise ValueError(f"{law}: {len(stages)} stages{cut}; 1 to {native.MAX_STAGES} are allowed")
    if any(stage.damping is not None and (len(stages) > 1 or stage.unloading is not None) for stage in stages):
        raise ValueError(f"{law}: a damped law must have one stage, and no unloading")
    begin = 0.0
    for stage in stages:
        if stage.begin != begin or not stage.end > stage.begin:
            raise ValueError(
                f"{law}: stage {stage.name!r} runs from {stage.begin!r} to {stage.end!r}; it must begin at "
                f"{begin!r}, where the stage before ends, and end beyond that"
            )
        begin = stage.end
        if math.isinf(stage.end) and not all(isinstance(f, Power) for f in _functions(stage).values()):
            raise ValueError(
                f"{law}: stage {stage.name!r} has no end, so all its functions must be Power(...); "
                "give the others an end beyond the deepest indentation you expect"
            )
        end = stage.end if math.isfinite(stage.end) else 10.0 * (stage.begin + 1.0)
        xi = np.linspace(stage.begin, end, _CHECKS)
        force = _values(stage.force, xi, stage)
        finite = np.isfinite(force)
        wrong = force[~(finite & (force >= -1e-12 * np.abs(force[finite]).max(initial=0.0)))]
        if wrong.size:
            raise ValueError(f"{law}: stage {stage.name!r} has a force of {wrong[0]:g}; it must be finite and >= 0")
        for name, function in _functions(stage).items():
            if not np.isfinite(_values(function, xi[1:-1], stage)).all():
                what = stage.unloading.rule[0] if name == "recovery" and stage.unloading is not None else name
                raise ValueError(f"{law}: the {what} of stage {stage.name!r} is not finite everywhere")
    return stages


def _functions(stage: Stage) -> dict[str, Function]:
    """The functions of a stage that the core needs, by the names of the core's fields."""
    functions: dict[str, Function] = {"force": stage.force}
    unloading = stage.unloading
    if unloading is not None:
        exponent = unloading.exponent
        functions["recovery"] = unloading.rule[1]
        functions["exponent"] = Power(constant=float(exponent)) if isinstance(exponent, (int, float)) else exponent
    if stage.damping is not None:
        functions["damping"] = stage.damping
    return functions


def _values(function: Function, xi: Array, stage: Stage) -> Array:
    if isinstance(function, Power):
        x = np.maximum(xi - origin_of(function, stage), 0.0)
        return function.constant + function.slope * x + function.coefficient * x**function.exponent
    return np.broadcast_to(np.asarray(function(xi), dtype=np.float64), xi.shape)


def _split_at_peak(stage: Stage) -> list[Stage]:
    """The stage cut where its force turns from rising to falling or back, so that extremes lie at its ends."""
    if isinstance(stage.force, Power) and stage.force.slope >= 0.0 and stage.force.coefficient >= 0.0:
        return [stage]
    end = stage.end if math.isfinite(stage.end) else stage.begin + 1e3
    grid = np.linspace(stage.begin, end, 20 * _CHECKS)
    rises = np.sign(np.diff(_values(stage.force, grid, stage)))
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
        f_a, f_b = sign * _values(stage.force, np.array([a, b]), stage)
        low, high = (a, high) if f_a < f_b else (low, b)
    return 0.5 * (low + high)


def _split(
    stage: Stage, functions: Mapping[str, Function], room: int
) -> tuple[list[tuple[float, float, bool, dict[str, Any]]], float]:
    """The stage in pieces (begin, end, root, series by name), the piece that fits worst halved while there is room."""
    fitted = {name: f for name, f in functions.items() if not isinstance(f, Power)}
    edges = [stage.begin, *(knot for knot in stage.knots if stage.begin < knot < stage.end), stage.end]
    from_nothing = stage.begin == 0.0 and _values(stage.force, np.zeros(1), stage)[0] == 0.0
    if "force" in fitted and from_nothing and not stage.root and len(edges) + len(_CLOSER) <= room:
        edges[1:1] = [part * edges[1] for part in _CLOSER]
    spans = [(a, b, stage.root and a == stage.begin) for a, b in pairwise(edges if fitted else [edges[0], edges[-1]])]
    pieces = [(a, b, root, *_fit(stage, fitted, a, b, root)) for a, b, root in spans]
    while fitted and len(pieces) < room:
        worst = max(range(len(pieces)), key=lambda k: pieces[k][4])
        begin, end, root, _, error = pieces[worst]
        if error <= FIT_TOLERANCE:
            break
        # the first piece of a root stage shrinks towards its singular point, so that the rest is smooth
        middle = begin + (0.25 if root else 0.5) * (end - begin)
        pieces[worst : worst + 1] = [
            (begin, middle, root, *_fit(stage, fitted, begin, middle, root)),
            (middle, end, False, *_fit(stage, fitted, middle, end, False)),
        ]
    return [(a, b, root, series) for a, b, root, series, _ in pieces], max(piece[4] for piece in pieces)


def _fit(
    stage: Stage, functions: Mapping[str, Function], begin: float, end: float, root: bool
) -> tuple[dict[str, Any], float]:
    """Series of each function on [begin, end] and the largest relative difference, seen between their nodes."""
    series: dict[str, Any] = {}
    worst = 0.0
    nodes, checks = chebyshev.chebpts1(_TERMS), np.cos(np.pi * np.arange(_CHECKS) / (_CHECKS - 1))
    for name, function in functions.items():

        def on(z: Array, function: Function = function) -> Array:
            x = 0.5 * (1.0 + z)
            return _values(function, begin + (end - begin) * (x * x if root else x), stage)

        terms = chebyshev.chebfit(nodes, on(nodes), _TERMS - 1)
        scale = max(float(np.abs(on(checks)).max()), 1e-300)
        series[name] = chebyshev.chebtrim(terms, FIT_ROUNDING * scale)
        worst = max(worst, float(np.abs(chebyshev.chebval(checks, series[name]) - on(checks)).max()) / scale)
    return series, worst


def _fill(
    piece: native.Piece,
    stage: Stage,
    functions: Mapping[str, Function],
    span: tuple[float, float, bool, dict[str, Any]],
    work: float,
) -> float:
    """Write one piece; `work` is the stage's up to its beginning, and the return value up to its end."""
    begin, end, root, series = span
    piece.end = end
    for name, function in functions.items():
        target = getattr(piece, name)
        if isinstance(function, Power):
            target.form, target.origin, target.per_span = native.POWER, origin_of(function, stage), 1.0
            target.constant, target.slope = function.constant, function.slope
            target.coefficient, target.exponent = function.coefficient, function.exponent
        else:
            _write(target, series[name], begin, end, root)
    if isinstance(stage.force, Power):
        origin = origin_of(stage.force, stage)
        at_begin = _power_work(stage.force, begin - origin)
        piece.work_at_begin = at_begin - work
        return work + _power_work(stage.force, end - origin) - at_begin if end < math.inf else work
    mean = _mean(series["force"], root)
    _write(piece.mean, mean, begin, end, root)
    piece.work_at_begin = -work
    return work + (end - begin) * float(chebyshev.chebval(1.0, mean))


def _mean(series: Array, root: bool) -> Array:
    """The series of the mean of a series from where its interval begins: of the same degree."""
    nodes, weights = np.polynomial.legendre.leggauss(_TERMS)
    part = 0.5 * (1.0 + nodes)
    weights = weights * part if root else 0.5 * weights  # over x = u²: dx = 2 u du
    at = chebyshev.chebpts1(len(series))
    values = chebyshev.chebval(0.5 * (1.0 + at[:, None]) * part * 2.0 - 1.0, series) @ weights
    return np.asarray(chebyshev.chebfit(at, values, len(series) - 1), dtype=np.float64)


def _power_work(power: Power, reach: float) -> float:
    x = max(reach, 0.0)
    return x * (power.constant + 0.5 * power.slope * x + power.coefficient * x**power.exponent / (power.exponent + 1.0))


def _write(target: native.Function, series: Any, begin: float, end: float, root: bool) -> None:
    target.form = native.ROOT_SERIES if root else native.SERIES
    target.terms, target.origin, target.per_span = len(series), begin, 1.0 / (end - begin)
    target.exponent = 1.0
    target.series[: len(series)] = [float(term) for term in series]


def _remarks(law: str, stages: list[Stage], fit_error: float) -> list[str]:
    """Sentences about forces that jump between stages, works that are not the force's integral, and poor fits."""
    said: list[str] = []
    for before, after in pairwise(stages):
        left, right = (float(_values(s.force, np.array([after.begin]), s)[0]) for s in (before, after))
        if abs(right - left) > 1e-9 * max(abs(left), abs(right)):
            said.append(
                f"{law}: the force jumps by {100 * (right - left) / max(left, 1e-300):+.2f} % where stage "
                f"{after.name!r} begins"
            )
    if fit_error > 1e-11:
        said.append(f"{law}: its functions are fitted to {fit_error:.1e} of their largest values, no better")
    for stage in stages:
        if stage.work is not None and math.isfinite(stage.end):
            difference = _work_difference(stage.work, stage)
            if difference > 1e-9:
                said.append(
                    f"{law}: the work given for stage {stage.name!r} differs from the integral of its force by "
                    f"{difference:.1e}; the integral is used"
                )
    return said


def _work_difference(work: Callable[[Array], Array], stage: Stage) -> float:
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x = 0.5 * (nodes + 1.0)  # squared: also exact enough for a force that begins like a root
    length = stage.end - stage.begin
    integral = float(np.sum(weights * x * length * _values(stage.force, stage.begin + length * x * x, stage)))
    given = float(work(np.array([stage.end]))[0])
    return abs(given - integral) / max(abs(integral), 1e-300)

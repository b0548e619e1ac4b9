"""Vibrating targets for the core: the modes up to a frequency with the core's tables, kept for the latest targets.

The omitted high modes follow the force statically, with the remaining part c f of the static deflection; the
indentation is x − Σ w_n − c f. Errors then decrease with the square of the number of modes or faster, without that
compliance only in proportion to it. A law that cannot be in series with a spring, because it is damped or its force
jumps, gets the remaining compliance as one more mode above the others, well damped.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from film_model.base.arrays import Array, logarithm
from film_model.base.errors import SimulationError, TooManyModes
from film_model.core import modal
from film_model.core.refining import MOST_FOLLOWED
from film_model.problem.curve import can_be_in_series
from film_model.problem.problem import Problem
from film_model.targets import AbstractTarget, Modes
from film_model.targets.ritz import Panel
from film_model.targets.ritz_errors import raised

ABOVE, RATIO = 4.0, 0.5
"""Frequency of the mode that stands for the omitted ones, over the highest, and its damping ratio. Without damping it
rings between the impactor and the others: where a plate has no further vibrations, no run then agrees with the next.
With critical damping it is late, and errors are twice as large."""


SLOWEST = 2.0**-20
"""Frequency over that of `rate_of` from which the lowest one is sought: a period of ten weeks where that is 1 rad/s."""


@dataclass(frozen=True)
class Structure:
    """A target's modes up to the frequency `highest` [rad/s], with the core's tables, which are kept. omitted: the
    remaining compliance, m/N. error: bound on its error. inexact: the plate whose frequencies have errors."""

    highest: float
    tables: modal.Tables
    omitted: float
    error: float
    with_omitted: modal.Tables
    """The same with one more mode of the omitted compliance."""
    inexact: Panel | None = None

    @cached_property
    def raised(self) -> tuple[Array, float]:
        """The frequencies with their errors, and what the modes then lack, as of :func:`ritz_errors.raised`."""
        return raised(self.inexact, self.tables.frequency, self.tables.share, self.highest)

    @property
    def doubt(self) -> float:
        """Compliance that may be omitted in addition, m/N: by its error, and what the modes lack."""
        return self.error + self.raised[1]

    @cached_property
    def softer(self) -> Structure:
        """The same with all errors."""
        own, omitted = self.tables, self.omitted + self.doubt
        modes = Modes(self.raised[0], own.share, own.ratio)
        columns = modes.frequency, modes.share, modes.damping_ratio
        tables = own if self.inexact is None else modal.Tables(*columns, own.longest, own.forms)
        with_omitted = _with_omitted(modes, omitted, self.highest, own.longest, own.forms)
        return replace(self, tables=tables, omitted=omitted, with_omitted=with_omitted)


CARRIED = 16
"""Most vibrations with membrane forces, the lowest. At 2.8 thicknesses the largest force on a square plate is 979,
1033, 1052 and 1064 N with 6, 11, 15 and 20 of them; the time grows with the fourth power of their number."""


def structure_of(target: AbstractTarget, highest: float, unit: float, carried: int = 0) -> Structure:
    """The modes up to the frequency `highest` [rad/s]; unit: of time in the march, s. Kept for the latest targets.
    carried: most modes with membrane forces."""
    return _by_target(_kept, made, target, highest, rounded(unit), carried)


def omitted_compliance(target: AbstractTarget, highest: float, unit: float) -> float:
    """The part of the static compliance that modes above `highest` have, m/N."""
    return structure_of(target, highest, unit).omitted


def modes_of(target: AbstractTarget, highest: float, carried: int = 0) -> tuple[Modes, Array | None]:
    """The modes up to a frequency, and the forms of the membrane energy of at most `carried` of them, None without."""
    if not carried:
        return target.modes(highest).merged(), None
    (low, forms), high = _by_target(_kept_membrane, _membrane, target), target.modes(highest)
    low = low.below(min(highest, _border(low.frequency, carried)))
    count = low.frequency.size
    names = ("frequency", "share", "damping_ratio", "factor", "strain")
    parts = ((getattr(low, name), getattr(high, name)[..., count:]) for name in names)
    return Modes(*(np.concatenate(part, axis=-1) for part in parts)), forms[:, :count, :count]


def _membrane(target: AbstractTarget) -> tuple[Modes, Array]:
    """The `CARRIED` lowest modes, up to a frequency from which the next is apart, and their forms."""
    most_raised = 1e6  # frequency over the lowest, below which they are sought
    highest = 2.0 * lowest_frequency(target)
    while (known := target.modes(highest).frequency).size <= CARRIED:
        highest *= 1.5
        if highest > most_raised * lowest_frequency(target):  # a thick plate has no more
            return target.membrane(highest)
    return target.membrane(_border(known, CARRIED))


def _border(known: Array, carried: int) -> float:
    """A frequency below which at most `carried` of the known modes are, apart from the next."""
    if known.size <= carried:
        return math.inf
    least = 1e-3  # relative distance between the frequencies of the last of them and the next
    gaps = np.flatnonzero(np.diff(known[: carried + 1]) > least * known[1 : carried + 1])
    last = int(gaps[-1]) if gaps.size else 0
    return 0.5 * float(known[last] + known[last + 1])


_kept_membrane = lru_cache(maxsize=16)(_membrane)


def made(target: AbstractTarget, highest: float, longest: float, carried: int = 0) -> Structure:
    """The modes up to a frequency, with tables of their own. longest: step, s. carried: as of :func:`modes_of`."""
    modes, forms = modes_of(target, highest, carried)
    if modes.frequency.size > MOST_FOLLOWED:
        raise TooManyModes(
            f"{modes.frequency.size} natural vibrations would be needed, more than {MOST_FOLLOWED}: the contact ends "
            "long before waves return from the edges, so set boundary_reflections = false in [effects]"
        )
    try:
        tables = modal.Tables(modes.frequency, modes.share, modes.damping_ratio, longest, forms)
    except ValueError as error:
        raise SimulationError(f"the target's natural vibrations cannot be simulated: {error}") from None
    omitted, error = target.omitted(modes, highest)
    return Structure(
        highest,
        tables,
        omitted,
        error,
        _with_omitted(modes, omitted, highest, longest, forms) if omitted > 0.0 else tables,
        target.inexact,
    )


_kept = lru_cache(maxsize=16)(made)


def forget() -> None:
    """Discard the kept structures."""
    _kept.cache_clear()
    _kept_membrane.cache_clear()
    _kept_lowest.cache_clear()


def _with_omitted(
    modes: Modes, omitted: float, highest: float, longest: float, forms: Array | None = None
) -> modal.Tables:
    columns = zip((modes.frequency, modes.share, modes.damping_ratio), mode_of(omitted, highest), strict=True)
    frequency, share, ratio = (np.append(*pair) for pair in columns)
    return modal.Tables(frequency, share, ratio, longest, forms)


def mode_of(omitted: Any, highest: Any) -> tuple[Any, Any, float]:
    """Frequency, share and damping ratio of the mode that stands for the compliance of those above the highest."""
    frequency = ABOVE * highest
    return frequency, omitted * frequency**2, RATIO


def computable(target: AbstractTarget, highest: float, unit: float, least: float = 0.0) -> float:
    """The frequency, `highest` or less by powers of 2^(1/2), up to which the modes can be computed; by powers of 2 of
    targets that share modes, but close to `least`. TooManyModes if it is below `least`."""
    highest = on_grid(target, highest)
    while True:
        try:
            structure_of(target, highest, unit)
        except TooManyModes:
            highest /= 2.0 if steps_of(target) == 1.0 and highest >= 2.0 * least else 2.0**0.5
            if highest < least:
                raise
        else:
            return highest


def tables_of(problem: Problem, structure: Structure, rest: float) -> tuple[modal.Tables, float]:
    """The tables for the law, and its compliance: 0 if the compliance `rest` has to be a mode."""
    return (structure.with_omitted, 0.0) if _as_mode(problem, rest) else (structure.tables, rest)


def omitted_as_mode(problem: Problem, target: AbstractTarget, highest: float) -> bool:
    """Whether the compliance that modes above `highest` have is one more mode, because of the law."""
    rest = omitted_compliance(target, highest, problem.scales.time) * problem.scales.force / problem.scales.length
    return _as_mode(problem, rest)


def _as_mode(problem: Problem, rest: float) -> bool:
    return rest > 0.0 and not can_be_in_series(problem.law, rest)


def lowest_frequency(target: AbstractTarget) -> float:
    """The lowest frequency > 0 with motion of the struck point, rad/s; 0 if the target only moves as a rigid body."""
    return _by_target(_kept_lowest, _lowest, target)


def _lowest(target: AbstractTarget) -> float:
    highest, rigid = SLOWEST * rate_of(target), False
    growth = 16.0  # four times the half-waves along a side take as long as few
    for _ in range(120):
        try:
            found = target.modes(highest).frequency
        except TooManyModes:
            if growth == 2.0:
                raise
            highest, growth = 2.0 * highest / growth, 2.0
            continue
        rigid = rigid or bool(found.size)
        if (bends := found[found > 0.0]).size:
            return float(bends[0])
        highest *= growth
    if rigid:
        return 0.0
    raise SimulationError("the target has no natural vibration that an impact could excite")


_kept_lowest = lru_cache(maxsize=64)(_lowest)


def _by_target(kept: Any, made: Any, *arguments: Any) -> Any:
    """The kept result for a target, or one made again for a target that has no hash."""
    try:
        return kept(*arguments)
    except TypeError as error:
        if "unhashable" not in str(error):
            raise
        return made(*arguments)


def rate_of(target: AbstractTarget) -> float:
    """A frequency in which those of similar targets, such as plates of any thickness, are the same, rad/s."""
    return 1.0 / (target.longest_time or 1.0)


def on_grid(target: AbstractTarget, frequency: float) -> float:
    """The frequency rounded up in units of the target's own; if it has some, to a power of 2: plates of all thicknesses
    then share few sets of modes. As it is doubled until results agree, impacts need no more modes on average."""
    return rounded(frequency, rate_of(target), steps_of(target))


def steps_of(target: AbstractTarget) -> float:
    """Steps of :func:`on_grid` for each power of 2."""
    return 1.0 if target.longest_time else 4.0


def rounded(value: Any, unit: Any = 1.0, steps: Any = 4.0) -> Any:
    """`unit` times the power of 2^(1/steps) that is not below `value`, so that similar impacts on a target share its
    tables; of such a power with rounding errors, itself."""
    return unit * 2.0 ** (math.ceil(steps * (logarithm(value / unit) / math.log(2.0)) - 1e-9) / steps)

"""How far measurements lie from what law "auto" computes: 90 % intervals of the model, by family of impacts.

The intervals come from the residuals ln(measured/computed) of published measurements, which
`python -m examples.model_intervals` stores in model_intervals.json. They say nothing about numerical errors.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple, TypeAlias

from film_model.base.arrays import either, exponential, lesser, root
from film_model.base.units import format_si
from film_model.problem.brittle import fails
from film_model.problem.law_of_scene import ELASTIC, STEEP
from film_model.problem.law_of_scene import YIELDING as YIELDS
from film_model.problem.problem import Problem
from film_model.scene import Scene

STORED = f"{os.path.splitext(__file__)[0]}.json"

LARGEST = {"coefficient_of_restitution": 1.0}
"""Bounds of summary values."""

COVERED = 0.9
"""Share of the measurements in an interval."""

FEWEST = 9
"""Residuals that a family needs for an interval of its own, which covers 80 % if it spans so few. With fewer it takes
that of all impacts that yield."""

MANY_YIELD_VELOCITIES = 50.0
"""Approach velocity over yield velocity that parts the two families of impacts that yield."""

STIFFEST_POLYMER = 6e9
"""Effective modulus, Pa, below which one of the bodies is a polymer."""

BELOW, ABOVE, YIELDING = "yielding_below_50", "yielding_above_50", "yielding"
_KNOWN = {
    BELOW: f"steel of known hardness at 1 to {MANY_YIELD_VELOCITIES:g} yield velocities",
    ABOVE: f"steel of known hardness beyond {MANY_YIELD_VELOCITIES:g} yield velocities",
    YIELDING: "steel of known hardness that yields",
}
_SLOW = "_slow"
SLOW = {name: f"{name}{_SLOW}" for name in _KNOWN}
"""Families → those of the same impacts without a rate law of the material that yields: rates raise the strength of
steel, and of some metals hardly, so that intervals of these hold what is computed with a rate law, too."""

POLYMER, BRITTLE, ADHESIVE = "polymer", "brittle", "adhesive"
_COMPLETE = "with complete conditions"

FAMILIES = (
    {
        "elastic": "elastic contacts, of glass and alumina that did not crack",
        POLYMER: f"polymers {_COMPLETE}",
        BRITTLE: "brittle contacts that may crush or crack",
        ADHESIVE: f"contacts that adhere {_COMPLETE}",
    }
    | _KNOWN
    | {SLOW[name]: f"{words}, computed with and without rate hardening" for name, words in _KNOWN.items()}
)
"""Families of impacts → in words; "yielding" pools the two before it."""

KINDS = ("elastic", BELOW, ABOVE, SLOW[BELOW], SLOW[ABOVE], POLYMER, BRITTLE)
"""Families under law "auto", by the approach velocity over the yield velocity, the rate law and the stiffness; the last
where a body crushes or may crack."""

ASKED = (*KINDS, ADHESIVE)
"""Families of which an impact is asked for measurements."""

POOLED = {
    YIELDING: (BELOW, ABOVE),
    SLOW[YIELDING]: (SLOW[BELOW], SLOW[ABOVE]),
}
"""Families → those that they pool."""

_WIDER = {one: wide for wide, own in POOLED.items() for one in own}


class Residuals(NamedTuple):
    """Residuals of one family and quantity.

    low, high: of ln(measured/computed). most: yield velocities of any row, 0 of elastic ones.
    """

    family: str
    quantity: str
    rows: int
    low: float
    high: float
    most: float


class ModelInterval(NamedTuple):
    """A 90 % interval of the model, SI, and the measurements that it comes from."""

    low: float
    high: float
    evidence: str

    def text(self, dimension: str) -> str:
        """For behind a value: ", 0.44 to 0.52 (90 % of 61 measurements of steel that yields)"."""
        low, high = (format_si(end, dimension, 3) for end in (self.low, self.high))
        return f", {low} to {high} ({100 * COVERED:g} % of {self.evidence})"


def yield_velocities(scene: Scene) -> Any:
    """Approach velocity over the yield velocity of slow loading, by energy; None without a strength or a modulus."""
    if scene.yield_point is None:
        return None
    indentation, force = scene.yield_point
    return root(scene.kinetic_energy / (0.4 * force * indentation))


def family_number(scene: Scene) -> Any:
    """The place in `KINDS` of each impact of a scene, as if nothing crushes or cracks."""
    modulus, ratio, slow = scene.effective_modulus, yield_velocities(scene), 2
    if scene.rate_hardening is not None:  # where it is unknown, C is nan, on the page infinite
        coefficient, slowness, _ = scene.rate_hardening
        slow = either(((coefficient > 0.0) & (coefficient < math.inf)) | (slowness > 0.0), 0, 2)
    yielding = 0 if ratio is None else either(ratio > 1.0, either(ratio > MANY_YIELD_VELOCITIES, 2, 1) + slow, 0)
    return yielding if modulus is None else either(modulus < STIFFEST_POLYMER, KINDS.index(POLYMER), yielding)


def family_of(scene: Scene) -> str:
    """The family of a scene's impact."""
    return KINDS[family_number(scene)]


def asked_number(problem: Problem) -> Any:
    """The place in `ASKED` of one impact or many; -1 where measurements are not asked for.

    They are of what law "auto" takes for impacts of this kind, on bodies that do not move but by waves in a half-space,
    vibrate or creep, with rate hardening if its law is known; and of laws that pull.
    """
    base, scene = problem.scene, problem.impacts.scene
    if problem.free or problem.vibrates or not base.is_round:
        return -1
    number: Any = -1
    if problem.curve.pulls:
        number = ASKED.index(ADHESIVE)
    elif base.contact.law == "auto" and base.effects.rate_hardening is not False:
        family = family_number(scene)
        law = problem.law.name if problem.relaxation is None else ""
        elastic, yields = law in (ELASTIC, STEEP[ELASTIC]), law == YIELDS
        number = kind_of(family, elastic, yields, fails(problem))
    return either((problem.gamma > 0.0) & scene.target.gives_way, -1, number)


def kind_of(family: Any, elastic: Any, yields: Any, failing: Any) -> Any:
    """The place in `KINDS`, -1 under another law than "auto" takes. elastic, yields: what the law does; failing:
    whether a brittle body fails."""
    took = (family == KINDS.index(POLYMER)) | ((family == 0) & elastic) | ((family != 0) & yields)
    return either(took, either(failing, KINDS.index(BRITTLE), family), -1)


def _family(problem: Problem) -> str | None:
    """The family of one impact; None where measurements are not asked for."""
    number = asked_number(problem)
    return None if number < 0 else ASKED[number]


def no_interval(problem: Problem, name: str) -> str:
    """Why a summary value of one impact has no interval, by `missing`; empty if it has one, or none is asked for."""
    family = _family(problem)
    return "" if family is None else missing(family, name)


def missing(family: str, name: str) -> str:
    """Why a value of a family has no interval, in words; empty if it has one, or no family has."""
    if residuals_of(family, name) is not None or not any(residuals_of(one, name) for one in KINDS):
        return ""
    known = stored().get((family, name))
    rows = 0 if known is None else known.rows
    return f"no interval: {rows} measurements of {FAMILIES[family]}, {FEWEST} are needed"


def model_interval(problem: Problem, name: str, value: float | None) -> ModelInterval | None:
    """The interval of a summary value of one impact; None if it is not positive, or too few measurements are known."""
    family = _family(problem)
    if family is None or value is None or not value > 0.0:
        return None
    found = residuals_of(family, name)
    if found is None:
        return None
    low, high = (at_residual(value, residual, LARGEST.get(name, math.inf)) for residual in (found.low, found.high))
    said = evidence(family, found)
    ratio = yield_velocities(problem.scene)
    if ratio is not None and extrapolated(ratio, found.most):
        said += f"; extrapolated from {found.most:.0f} to {ratio:.0f} yield velocities"
    return ModelInterval(low, high, said)


def at_residual(value: Any, residual: Any, largest: Any) -> Any:
    """What is measured, with this residual, of a computed value."""
    return lesser(value * exponential(residual), largest)


def extrapolated(ratio: Any, most: Any) -> Any:
    """Whether an impact is beyond the yield velocities of all measurements."""
    return (most > 0.0) & (ratio > most)


def evidence(family: str, found: Residuals) -> str:
    """The measurements that an interval of an impact of this family comes from, in words."""
    said = f"{found.rows} measurements of {FAMILIES[found.family]}"
    likely = (found.rows - 1) / (found.rows + 1)
    if likely < COVERED:
        said += f"; so few cover {100 * likely:.0f} % of the next"
    if found.family != family:
        said += f"; fewer than {FEWEST} of them are like this one"
    return said


Table: TypeAlias = dict[tuple[str, str], Residuals]
"""Residuals by family and quantity."""


def residuals_of(family: str, quantity: str, table: Table | None = None) -> Residuals | None:
    """The residuals of a family, or of the wider one if it has too few; None if that has too few too.

    table: where they are; default those that are stored.
    """
    known = stored() if table is None else table
    for one in (family, _WIDER.get(family)):
        found = known.get((one or "", quantity))
        if found is not None and found.rows >= FEWEST:
            return found
    return None


@cache
def stored() -> Table:
    """The stored residuals."""
    with open(STORED, encoding="utf-8") as file:
        return by_family(Residuals(**entry) for entry in json.load(file)["residuals"])


def by_family(rows: Iterable[Residuals]) -> Table:
    """Residuals as a table."""
    return {(row.family, row.quantity): row for row in rows}

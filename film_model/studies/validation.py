"""Every law against measured and computed values: errors by source, and whether restitution falls with velocity."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from film_model.base.errors import SimulationError
from film_model.laws import LAWS
from film_model.laws.example_ball import example_ball, example_law
from film_model.problem.curve import curve_of
from film_model.problem.law_of_scene import YIELDING
from film_model.scene import Contact, Effects, Scene, Sphere
from film_model.solve.simulate import simulate_quietly
from film_model.targets import HalfSpace, Plate

AUTO = "auto"
TESTED = (AUTO, *(name for name, law in LAWS.items() if law.family == "yields"))
"""Laws that are compared: the default, and those of spheres that yield."""

ACCURACY = 1e-5


class Row(NamedTuple):
    """One value and its conditions, SI; nan: not given. See datasets/published/measured_impacts.csv."""

    value: float
    uncertainty: float
    radius: float
    mass: float
    velocity: float
    effective_modulus: float
    yield_strength: float
    poissons_ratio: float
    target_impedance: float
    quantity: str
    source: str
    kind: str
    sureness: str
    law: str
    note: str

    @property
    def yields(self) -> bool:
        """Whether it says something about a law that yields."""
        return self.yield_strength == self.yield_strength and self.kind != "same_law"


class Prediction(NamedTuple):
    """What a law gives for a row; nan: it cannot simulate it."""

    row: Row
    value: float

    @property
    def error(self) -> float:
        """Relative to the row's value."""
        return self.value / self.row.value - 1.0


@dataclass(frozen=True)
class LawReport:
    """One law against the rows. largest: restitution found; rises: where it rises with velocity, in sentences."""

    law: str
    predictions: tuple[Prediction, ...]
    largest: float
    rises: tuple[str, ...]

    @property
    def monotone(self) -> bool:
        """Whether restitution falls with velocity everywhere."""
        return not self.rises and self.largest <= 1.0 + 1e-9

    def errors(self, where: Callable[[Row], bool] = lambda row: True) -> list[float]:
        """Absolute errors of the rows that the law can simulate, sorted."""
        found = (abs(p.error) for p in self.predictions if where(p.row))
        return sorted(error for error in found if not math.isnan(error))

    @cached_property
    def sources(self) -> dict[str, list[float]]:
        """Errors by source."""
        words = dict.fromkeys(p.row.source for p in self.predictions)
        return {word: self.errors(lambda row, word=word: row.source == word) for word in words}

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "law": self.law,
            "monotone": self.monotone,
            "rises": list(self.rises),
            "median": median(self.errors()),
            "measured_median": median(self.errors(measured)),
            "sources": {word: {"median": median(e), "worst": max(e, default=None)} for word, e in self.sources.items()},
        }


def measured(row: Row) -> bool:
    """Whether the row is a measurement of a contact that yields."""
    return row.kind == "measured"


def median(errors: Sequence[float]) -> float | None:
    """The median, None without values."""
    return statistics.median(errors) if errors else None


def compare(rows: Sequence[Row], laws: Sequence[str] = TESTED) -> list[LawReport]:
    """Reports of laws on the rows of contacts that yield, best median first. Raises ValueError for an unknown name."""
    wrong = [name for name in laws if name not in TESTED]
    if wrong:
        raise ValueError(f"law {wrong[0]!r} is not compared; there are {', '.join(TESTED)}")
    own = [row for row in rows if row.yields]
    reports = [_report(law, own) for law in laws]
    return sorted(reports, key=lambda report: median(report.errors()) or math.inf)


def elastic(rows: Sequence[Row]) -> LawReport:
    """Hertz's law on the rows of elastic contacts."""
    return LawReport("hertz", tuple(predict("hertz", row) for row in rows if _is_elastic(row)), 1.0, ())


def own_numbers(rows: Sequence[Row]) -> list[Prediction]:
    """What the laws give for values that were computed with them."""
    return [predict(row.law, row) for row in rows if row.kind == "same_law"]


def _is_elastic(row: Row) -> bool:
    return row.yield_strength != row.yield_strength and row.kind != "same_law"


def _report(law: str, rows: Sequence[Row]) -> LawReport:
    predictions = tuple(predict(law, row) for row in rows)
    restitution = [p.value for p in predictions if p.row.quantity == "coefficient_of_restitution"]
    largest = max((value for value in restitution if not math.isnan(value)), default=0.0)
    name = YIELDING if law == AUTO else law
    said = (f"from {r.low:.3f} to {r.high:.3f}" for r in curve_of(_law_of(name, rows[0])).rises) if rows else ()
    return LawReport(law, predictions, largest, tuple(said))


def predict(law: str, row: Row) -> Prediction:
    """What a law gives for a row."""
    try:
        summary = simulate_quietly(scene_of(law, row), accuracy=ACCURACY).summary
    except (SimulationError, ValueError):
        return Prediction(row, math.nan)
    if row.quantity == "dent_diameter":
        return Prediction(row, _dent(row, summary))
    found = summary[row.quantity]
    return Prediction(row, math.nan if found is None else float(found))


def _dent(row: Row, summary: Any) -> float:
    """Diameter of the cap of the ball that is as deep as the permanent indentation, without pile-up: √(8 R δ_f)."""
    return math.sqrt(8.0 * row.radius * max(summary["permanent_indentation"] or 0.0, 0.0))


def _law_of(name: str, row: Row) -> Any:
    ball = example_ball(
        row.effective_modulus, row.radius, row.yield_strength, row.poissons_ratio, row.mass, row.velocity
    )
    return example_law(LAWS[name], ball)


def scene_of(law: str, row: Row) -> Scene:
    """The scene of a row: a ball on a half-space, or on an infinite plate of the row's impedance."""
    ball = Sphere(f"{row.radius!r} m", velocity=f"{row.velocity!r} m/s", mass=f"{row.mass!r} kg")
    given: dict[str, Any] = {"effective_modulus": f"{row.effective_modulus!r} Pa"}
    effects = Effects(gravity=False)
    if law == AUTO:
        given |= {"yield_strength": f"{row.yield_strength!r} Pa", "poissons_ratio": row.poissons_ratio}
        contact = Contact(AUTO, **given)
    elif law == "hertz":
        contact = Contact(law, **given)
    else:
        contact = Contact(_law_of(law, row))
    impedance = row.target_impedance
    if impedance != impedance:
        return Scene(ball, HalfSpace(), contact, effects)
    bending = (impedance / 8.0) ** 2  # of an isotropic plate of 1 kg/m²: Z = 8 sqrt(ρ_A D)
    shares = {"D11": 1.0, "D12": 0.3, "D22": 1.0, "D66": 0.35}
    stiffness = {name: f"{share * bending!r} N*m" for name, share in shares.items()}
    return Scene(ball, Plate(mass_per_area="1 kg/m^2", bending_stiffness=stiffness), contact, effects)


def table(reports: Sequence[LawReport]) -> str:
    """Median and worst error in percent, law × source, for a terminal."""
    words = list(reports[0].sources)
    lines = [f"{'median / worst error in %':26}" + "".join(f"{word[:17]:>19}" for word in (*words, "all", "measured"))]
    for report in reports:
        cells = [*report.sources.values(), report.errors(), report.errors(measured)]
        shown = "".join(f"{_cell(errors):>19}" for errors in cells)
        lines.append(f"{report.law:26}{shown}  {'falls' if report.monotone else 'not monotone'}")
    return "\n".join(lines)


def _cell(errors: Sequence[float]) -> str:
    return f"{100 * statistics.median(errors):.1f} / {100 * max(errors):.1f}" if errors else "-"

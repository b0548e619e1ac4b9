"""Every law against measured and computed values: errors by family, and whether restitution falls with velocity."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from film_model.base.errors import SimulationError
from film_model.effects.law_range import law_warnings
from film_model.laws import LAWS
from film_model.laws.example_ball import example_ball, example_law
from film_model.problem.curve import curve_of
from film_model.problem.law_of_scene import ASSUMED_POISSONS_RATIO, ELASTIC, YIELDING
from film_model.problem.model_intervals import family_of
from film_model.scene import Contact, Effects, Scene, Sphere
from film_model.solve.simulate import simulate_quietly
from film_model.studies.validation_rows import Row, material
from film_model.targets import HalfSpace, Plate

AUTO = "auto"
TESTED = (AUTO, *(name for name, law in LAWS.items() if law.family == "yields"))
"""Laws that are compared: the default, and those of spheres that yield."""

GROUPS: dict[str, Callable[[Row], bool]] = {
    "measured": lambda row: row.of_steel,
    "measured, used": lambda row: row.of_steel and not row.held_out,
    "measured, held out": lambda row: row.of_steel and row.held_out,
    "theory": lambda row: row.kind == "theory",
}
"""Groups of rows whose errors are shown; measured: those on steel of known hardness."""


class Prediction(NamedTuple):
    """What a law gives for a row; nan: it cannot simulate it. outside: of the range of the law, or of plasticity."""

    row: Row
    value: float
    family: str
    outside: bool

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
        return absolute(p for p in self.predictions if where(p.row))

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        groups = {name: self.errors(where) for name, where in GROUPS.items()}
        return {
            "law": self.law,
            "monotone": self.monotone,
            "rises": list(self.rises),
            "groups": {
                name: {"count": len(e), "median": median(e), "worst": max(e, default=None)}
                for name, e in groups.items()
            },
        }


def absolute(predictions: Iterable[Prediction]) -> list[float]:
    """Absolute errors, sorted, of those that were simulated."""
    return sorted(abs(p.error) for p in predictions if not math.isnan(p.value))


def median(errors: Sequence[float]) -> float | None:
    """The median, None without values."""
    return statistics.median(errors) if errors else None


def compare(rows: Sequence[Row], laws: Sequence[str] = TESTED) -> list[LawReport]:
    """Reports of laws on measured rows and on those computed for contacts that yield: "auto", then the best first.

    They are sorted by the median of the measured rows. Raises ValueError for an unknown name.
    """
    wrong = [name for name in laws if name not in TESTED]
    if wrong:
        raise ValueError(f"law {wrong[0]!r} is not compared; there are {', '.join(TESTED)}")
    own = [row for row in rows if row.usable or row.yields]
    reports = [_report(law, own) for law in laws]
    return sorted(reports, key=lambda r: (r.law != AUTO, median(r.errors(GROUPS["measured"])) or math.inf))


def _report(law: str, rows: Sequence[Row]) -> LawReport:
    predictions = tuple(predict(law, row) for row in rows)
    restitution = [p.value for p in predictions if p.row.quantity == "coefficient_of_restitution"]
    largest = max((value for value in restitution if not math.isnan(value)), default=0.0)
    name = YIELDING if law == AUTO else law
    first = next((scene_of(AUTO, row) for row in rows if row.yields or row.usable), None)
    said = () if first is None else curve_of(_law_of(name, first)).rises
    return LawReport(law, predictions, largest, tuple(f"from {r.low:.3f} to {r.high:.3f}" for r in said))


def predict(law: str, row: Row, changes: Mapping[str, Any] | None = None) -> Prediction:
    """What a law gives for a row, with changes of the scene."""
    family = family_of(scene_of(AUTO, row))
    try:
        history = simulate_quietly(scene_of(law, row).replace(changes or {}), accuracy=1e-5)
    except (SimulationError, ValueError):
        return Prediction(row, math.nan, family, False)
    found = history.summary[row.quantity]
    outside = any("outside its range" in said for said in law_warnings(history.problem))
    return Prediction(row, math.nan if found is None else float(found), family, outside)


def _law_of(name: str, scene: Scene) -> Any:
    """A named law with the parameters that follow from the strength of a scene of law "auto"."""
    modulus, strength, ratio = scene.effective_modulus, scene.yield_strength, scene.poissons_ratio
    if modulus is None or strength is None:
        raise ValueError(f"law {name} needs a strength")
    ratio = ASSUMED_POISSONS_RATIO if ratio is None else ratio
    ball = example_ball(modulus, scene.effective_radius, strength, ratio, scene.effective_mass, scene.approach_velocity)
    return example_law(LAWS[name], ball)


def scene_of(law: str, row: Row) -> Scene:
    """The scene of a row: a ball on a half-space, or on an infinite plate of the row's impedance."""
    ball: dict[str, Any] = {"velocity": f"{row.velocity!r} m/s", "mass": f"{row.mass!r} kg"}
    effects, given = Effects(gravity=False), dict[str, Any]()
    if row.target:
        sphere = Sphere(f"{row.radius!r} m", **ball, material=material(row.ball))
        scene = Scene(sphere, HalfSpace(material(row.target)), Contact(AUTO), effects)
    else:
        given |= {"effective_modulus": f"{row.effective_modulus!r} Pa"}
        if row.yield_strength == row.yield_strength:
            given |= {"yield_strength": f"{row.yield_strength!r} Pa", "poissons_ratio": row.poissons_ratio}
        scene = Scene(Sphere(f"{row.radius!r} m", **ball), _target(row), Contact(AUTO, **given), effects)
    if law == AUTO:
        return scene
    if law in (ELASTIC, YIELDING):
        return Scene(scene.impactor, scene.target, Contact(law, **given), effects)
    return Scene(scene.impactor, scene.target, Contact(_law_of(law, scene)), effects)


def _target(row: Row) -> HalfSpace | Plate:
    impedance = row.target_impedance
    if impedance != impedance:
        return HalfSpace()
    bending = (impedance / 8.0) ** 2  # of an isotropic plate of 1 kg/m²: Z = 8 sqrt(ρ_A D)
    shares = {"D11": 1.0, "D12": 0.3, "D22": 1.0, "D66": 0.35}
    stiffness = {name: f"{share * bending!r} N*m" for name, share in shares.items()}
    return Plate(mass_per_area="1 kg/m^2", bending_stiffness=stiffness)


def table(reports: Sequence[LawReport]) -> str:
    """Median and worst error in percent, law × group of rows, for a terminal."""
    names = [f"{name} ({len(reports[0].errors(where))})" for name, where in GROUPS.items()]
    lines = [f"{'median / worst error in %':26}" + "".join(f"{name:>24}" for name in names)]
    for report in reports:
        shown = "".join(f"{error_cell(report.errors(where)) or '-':>24}" for where in GROUPS.values())
        lines.append(f"{report.law:26}{shown}  {'falls' if report.monotone else 'not monotone'}")
    return "\n".join(lines)


def error_cell(errors: Sequence[float]) -> str:
    """Median and worst error in percent; empty without values."""
    return f"{100 * statistics.median(errors):.1f} / {100 * max(errors):.1f}" if errors else ""

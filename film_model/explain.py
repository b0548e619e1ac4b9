"""What a scene comes down to and why: its effects with their numbers, and what every contact law makes of it."""

from __future__ import annotations

import textwrap
from typing import Any

from film_model.contact import Contact
from film_model.effects import Effect, percent
from film_model.errors import SceneError, SimulationError
from film_model.history import SUMMARY
from film_model.laws import LAWS
from film_model.problem import problem_of
from film_model.scene import Scene
from film_model.solve import simulate
from film_model.units import format_si, si_unit

SHOWN = {
    "maximum_force": "peak force",
    "maximum_indentation": "indentation",
    "contact_duration": "contact",
    "coefficient_of_restitution": "restitution",
    "permanent_indentation": "dent",
}
"""Summary values of the comparison of laws, with their headings."""


def explain(scene: Scene, *, laws: bool = False) -> dict[str, Any]:
    """Plain values: title, law, tolerance, effects, warnings, and with `laws` what every law gives, SI throughout.

    Raises SimulationError as `simulate` does.
    """
    problem = problem_of(scene)
    report: dict[str, Any] = {
        "title": scene.title,
        "law": problem.law.name,
        "tolerance": scene.effect_tolerance,
        "effects": [effect.to_json() for effect in problem.effects],
        "warnings": list(problem.warnings),
    }
    return {**report, "laws": compare_laws(scene)} if laws else report


def compare_laws(scene: Scene) -> list[dict[str, Any]]:
    """One row a law: name, and summary as in `History.to_json`, or why there is none.

    The laws have the scene's materials and [contact] entries in common; entries of its own law go to that law alone.
    """
    table = scene.to_table()
    common = {name: value for name, value in table["contact"].items() if name in Contact.FIELDS}
    rows: list[dict[str, Any]] = []
    for name in dict.fromkeys((scene.contact.law_name, *LAWS)):
        if name == "auto":
            continue
        contact = table["contact"] if name == scene.contact.law_name else {**common, "law": name}
        row: dict[str, Any] = {"name": name, "summary": None, "missing": None}
        try:
            summary = simulate(Scene.from_table({**table, "contact": contact})).summary
            row["summary"] = {
                key: {"value": value, "units": si_unit(SUMMARY[key][0])} for key, value in summary.items()
            }
        except SceneError as error:
            row["missing"] = "; ".join(f"{m.key.partition('.')[2]}: {m.message}" for m in error.mistakes)
        except SimulationError as error:
            row["missing"] = str(error)
        rows.append(row)
    return rows


def effects_text(scene: Scene) -> str:
    """The effects as a table: a line of numbers each, then the reason and the source."""
    problem = problem_of(scene)
    what = f"law {problem.law.name}; an effect is left out if it changes the summary by less than "
    lines = [scene.title or f"Impact on a {scene.target.kind}", what + percent(scene.effect_tolerance), ""]
    lines.append(f"{'effect':22}{'state':25}{'indicator':40}{'left out, changes':>18}  cost")
    for effect in problem.effects:
        size = "?" if effect.change is None else percent(effect.change) if effect.change else "0"
        name = effect.name.replace("_", " ")
        lines.append(f"{name:22}{effect.state:25}{_indicator(effect):40}{size:>18}  {effect.cost}")
        lines += textwrap.wrap(
            f"{effect.reason} [{effect.source}]", 110, initial_indent=" " * 4, subsequent_indent=" " * 4
        )
    return "\n".join(lines)


def _indicator(effect: Effect) -> str:
    if effect.value is None:
        return "-"
    limit = "" if effect.threshold is None else f" (matters from {effect.threshold:.3g})"
    return f"{effect.indicator} = {effect.value:.3g}{limit}"


def laws_text(rows: list[dict[str, Any]]) -> str:
    """The comparison of laws as a table."""
    lines = [f"{'law':20}" + "".join(f"{word:>14}" for word in SHOWN.values())]
    for row in rows:
        if row["summary"] is None:
            lines.append(f"{row['name']:20}  - {row['missing']}")
            continue
        values = ((row["summary"][name]["value"], SUMMARY[name][0]) for name in SHOWN)
        cells = ("-" if value is None else format_si(value, kind) for value, kind in values)
        lines.append(f"{row['name']:20}" + "".join(f"{cell:>14}" for cell in cells))
    return "\n".join(lines)

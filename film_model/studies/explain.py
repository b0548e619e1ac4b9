"""The effects of a scene with the numbers that decide, and a comparison of what the contact laws predict."""

from __future__ import annotations

from typing import Any

from film_model.base.errors import SceneError, SimulationError, not_compared
from film_model.base.units import format_si, si_unit
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_JUDGED, NOT_MODELLED, NOT_NEEDED, SIMULATED, SWITCHED_OFF, Effect, percent
from film_model.laws import LAWS
from film_model.scene import Contact, Scene
from film_model.solve.history import SUMMARY
from film_model.solve.simulate import simulate_quietly

SHOWN = {
    "maximum_force": "peak force",
    "maximum_indentation": "indentation",
    "contact_duration": "contact",
    "coefficient_of_restitution": "restitution",
    "permanent_indentation": "dent",
}
"""Summary values in the comparison of laws, with their headings."""


def explain(scene: Scene, *, laws: bool = False) -> dict[str, Any]:
    """Plain values, SI: title, law, tolerance, effects, warnings, and with `laws` the predictions of all laws.

    Raises SimulationError under the same conditions as `simulate`.
    """
    choice = choose(scene)
    report: dict[str, Any] = {
        "title": scene.title,
        "law": choice.problem.law.name,
        "tolerance": scene.effect_tolerance,
        "effects": [effect.to_dict() for effect in choice.effects],
        "warnings": list(choice.warnings),
    }
    return {**report, "laws": compare_laws(scene, report["law"])} if laws else report


def compare_laws(scene: Scene, law: str) -> list[dict[str, Any]]:
    """One row per law: name, and summary as in `History.to_dict`, or the reason why it is missing; needs: the entries
    of [contact] that would have to be given, if that is the reason.

    law: the one that the scene is simulated with, the first row, which is as the scene says. The others use the scene's
    materials and the common [contact] entries, and only the effects that they have when a scene names them.
    """
    table = scene.to_table()
    common = {name: value for name, value in table["contact"].items() if name in Contact.FIELDS}
    rows: list[dict[str, Any]] = []
    for name in dict.fromkeys((law, *LAWS)):
        contact = table["contact"] if name == law else {**common, "law": name}
        row: dict[str, Any] = {"name": name, "summary": None, "missing": None, "needs": []}
        try:
            summary = simulate_quietly(Scene.from_table({**table, "contact": contact})).summary
            row["summary"] = {
                key: {"value": value, "units": si_unit(SUMMARY[key][0])} for key, value in summary.items()
            }
        except SceneError as error:
            row["missing"] = "; ".join(f"{m.key.partition('.')[2]}: {m.message}" for m in error.mistakes)
            row["needs"] = error.needed
        except SimulationError as error:
            row["missing"] = str(error)
        rows.append(row)
    return rows


GROUPS = {
    "Computed": {SIMULATED: "computed"},
    "Neglected": {NOT_NEEDED: "negligible", SWITCHED_OFF: "switched off"},
    "Cannot be judged": {NOT_JUDGED: "unknown"},
    "Not modelled, but important": {NOT_MODELLED: "important"},
}
"""Groups of effects in a text, each with the verdict for every state in it."""


def effects_text(scene: Scene, *, verbose: bool = False) -> str:
    """The effects as a text: a line for each, by groups, and what follows; verbose: with all numbers and sources."""
    choice = choose(scene)
    lines = [
        scene.title or f"Impact on a {scene.target.kind}",
        f"law {choice.problem.law.name}; an effect is neglected if it changes every result by less than "
        f"{percent(scene.effect_tolerance)}",
    ]
    lines += [""] if verbose else ["", f"{'':2}{'effect':22}{'verdict':14}{'error if neglected':20}reason"]
    if verbose:
        lines += [line for effect in choice.effects for line in _details(effect)]
        return "\n".join(lines)
    for heading, verdicts in GROUPS.items():
        members = [effect for effect in choice.effects if effect.state in verdicts]
        lines += [heading] if members else []
        for effect in members:
            name, reason = effect.name.replace("_", " "), _plain(effect)
            lines.append(f"{'':2}{name:22}{verdicts[effect.state]:14}{_size(effect):20}{reason}")
    return "\n".join([*lines, "", _conclusion(choice.effects, scene.effect_tolerance)])


def _plain(effect: Effect) -> str:
    """The first clause of the reason; for a missing entry, what to give."""
    first = effect.reason.partition("; ")[0]
    return f"give {first.removeprefix('missing: ')}" if first.startswith("missing: ") else first


def _size(effect: Effect) -> str:
    return "unknown" if effect.change is None else percent(effect.change) if effect.change else "none"


def _conclusion(effects: tuple[Effect, ...], tolerance: float) -> str:
    """What the results leave out, as one sentence or two."""
    wrong = [effect for effect in effects if effect.state == NOT_MODELLED]
    unknown = sum(effect.state == NOT_JUDGED for effect in effects)
    if wrong:
        listed = ", ".join(f"{e.name.replace('_', ' ')} (error {_size(e)})" for e in wrong)
        said = f"The results leave out: {listed}."
    else:
        said = f"No effect that was judged and left out changes a result by more than {percent(tolerance)}."
    return said + (f" {unknown} {'effect' if unknown == 1 else 'effects'} cannot be judged." if unknown else "")


def _details(effect: Effect) -> list[str]:
    """Verdict, numbers, cost, reason and source of an effect."""
    verdict = next(words[effect.state] for words in GROUPS.values() if effect.state in words)
    numbers = [_indicator(effect), f"error if neglected {_size(effect)}", f"cost of computing it: {effect.cost}"]
    return [
        f"{effect.name.replace('_', ' ')}: {verdict}",
        *(f"    {text}" for text in ("; ".join(filter(None, numbers)), effect.reason, f"source: {effect.source}")),
    ]


def _indicator(effect: Effect) -> str:
    if effect.value is None:
        return ""
    limit = "" if effect.threshold is None else f" (threshold {effect.threshold:.3g})"
    return f"{effect.indicator} = {effect.value:.3g}{limit}"


def laws_text(rows: list[dict[str, Any]]) -> str:
    """The comparison of laws as a table, and a sentence on those that need entries of their own."""
    lines = [f"{'law':20}" + "".join(f"{word:>14}" for word in SHOWN.values())]
    needing = {row["name"]: row["needs"] for row in rows if row["needs"]}
    for row in rows:
        if row["name"] in needing:
            continue
        if row["summary"] is None:
            lines.append(f"{row['name']:20}  - {row['missing']}")
            continue
        values = ((row["summary"][name]["value"], SUMMARY[name][0]) for name in SHOWN)
        cells = ("-" if value is None else format_si(value, kind) for value, kind in values)
        lines.append(f"{row['name']:20}" + "".join(f"{cell:>14}" for cell in cells))
    if needing:
        lines.append(not_compared(needing))
    return "\n".join(lines)

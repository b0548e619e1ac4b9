"""The documentation page inside an FMU, with pictures of the law and of the impact."""

from __future__ import annotations

import html
import math
import tomllib
from inspect import cleandoc
from pathlib import Path

import numpy as np

from film_model.base.units import format_si, scene_unit
from film_model.core.relaxing import MOST_STEPS
from film_model.effects.choose import Choice
from film_model.laws.law import AbstractLaw
from film_model.plot import check_picture, plot_history
from film_model.plot.style import svg
from film_model.problem.law_of_scene import YIELDING
from film_model.problem.problem import Problem
from film_model.scene import Scene
from film_model.solve.history import SUMMARY, History
from film_model.version import __version__
from fmu_wrapper.layout import DAMPING
from fmu_wrapper.model_description import Experiment
from fmu_wrapper.powers import damping_power
from fmu_wrapper.resource import Data, has, has_exchange, mode_frequencies
from fmu_wrapper.variables import KINDS, VARIABLES, of_sensors, reference, settable

TEXTS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))

COUPLINGS = tuple(TEXTS["coupling"]["errors"])
"""How a master couples the contact FMU and the bodies."""

COUPLING_ERRORS: dict[int, tuple[float, ...]] = dict(
    zip(TEXTS["coupling"]["steps"], zip(*TEXTS["coupling"]["errors"].values(), strict=True), strict=True)
)
"""Communication steps per contact → error of the coefficient of restitution for each of `COUPLINGS`."""

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.2rem .8rem;border-bottom:1px solid #ccc;text-align:left}"
    "img{max-width:100%}pre{background:#f5f5f5;padding:1rem;overflow:auto}"
)


def documentation(
    title: str, scene: Scene, choice: Choice, data: Data, history: History | None, experiment: Experiment
) -> dict[str, bytes]:
    """The files of the folder `documentation`, by name: index.html and its pictures. scene: as given."""
    problem, kind = choice.problem, KINDS[data.kind]
    pictures: dict[str, bytes] = {}
    if history is not None:
        check_picture("law.svg")
        pictures = {"law.svg": _law_picture(problem, history), "history.svg": svg(plot_history(history))}
    parts = [f"<h1>{html.escape(title)}</h1>", f"<p>{TEXTS['about'][kind]} Made by film-model {__version__}.</p>"]
    if history is not None:
        parts += [
            '<p><img src="history.svg" alt="Force, indentation and velocity over time"></p>',
            _table(("result", "value for this scene"), _summary_rows(history)),
        ]
    parts += [
        "<h2>Contact law</h2>",
        *_law(problem.law),
        *_chosen(kind, scene, problem),
        *_validity(data),
        *_damping(kind, problem, data),
    ]
    if history is not None:
        parts.append('<p><img src="law.svg" alt="Contact force over indentation"></p>')
    effects = [(effect.name.replace("_", " "), effect.state, effect.reason) for effect in choice.effects]
    parts += ["<h2>Effects</h2>", _table(("effect", "state", "reason"), effects)]
    warnings = history.warnings if history is not None else choice.warnings
    parts += [f"<p><strong>Warning:</strong> {html.escape(warning)}</p>" for warning in warnings]
    parts += ["<h2>Steps</h2>", *_steps(kind, data, history, experiment)]
    parts += ["<h2>Variables</h2>", _table(("name", "unit", "causality", "meaning"), _variable_rows(data, scene))]
    parts += ["<h2>Scene</h2>", f"<pre>{html.escape(scene.archived_text())}</pre>"]
    page = (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>\n'
        f"<style>{_STYLE}</style>\n</head>\n<body>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )
    return {"index.html": page.encode(), **pictures}


def _law(law: AbstractLaw) -> list[str]:
    """Name, source, equations and range of validity of the law."""
    own = type(law).__doc__ or ""
    texts = [f"{law.name}: {law.summary}. {law.source}."]
    if not own.startswith(f"{type(law).__name__}("):  # not the docstring that dataclass generates
        texts += cleandoc(own).removeprefix(f"{law.source}.").strip("\n").split("\n\n")
    texts += [f"Valid: {law.validity}."] if law.validity else []
    return [f"<{tag}>{html.escape(text)}</{tag}>" for text in texts for tag in ["pre" if text[:4].isspace() else "p"]]


def _chosen(kind: str, scene: Scene, problem: Problem) -> list[str]:
    """For law "auto": the law in the FMU, and what it serves."""
    if scene.contact.law != "auto":
        return []
    text = f'The scene has law = "auto": the FMU contains {problem.law.name}'
    if problem.relaxation is not None:
        return [f"<p>{html.escape(text)}, the law of which the modulus can relax.</p>"]
    if problem.law.name == YIELDING:
        return [f"<p>{html.escape(text)}, which is elastic below yield, for slow impacts and fast ones.</p>"]
    why = "the scene has plasticity = false" if scene.effects.plasticity is False else "no strength is known for it"
    return [f"<p>{html.escape(text)}, because {why}.</p>"]


def _validity(data: Data) -> list[str]:
    """What the variable `validity` tests."""
    rows: list[tuple[str, ...]] = []
    for k, v in enumerate(VARIABLES[: settable()]):
        (low, high), (below, above) = data.valid[k], (side.value.decode() for side in data.reason[k])
        if data.available[k] and (below or above) and v.dimension is not None:
            name = "velocity at first touch" if v.name == "initial_velocity" else v.name
            ends = [(below, "below", low), (above, "above", high)]
            rows += [(name, f"{side} {format_si(at, v.dimension, 3)}", what) for what, side, at in ends if what]
    if data.also[1] > 0.0:
        rows.append(("velocity at first touch", f"below {format_si(data.also[1], 'velocity', 3)}", "nothing again"))
    limits = (("yields, but the law is elastic", data.limit[0]), ("is too wide for the law", data.limit[1]))
    rows += [
        ("indentation", f"above {format_si(at, 'length', 3)}", f"the contact {what}")
        for what, at in limits
        if at < math.inf
    ]
    text = (
        "The output validity is 0 as long as the assumptions of the export hold; otherwise a message says what fails:"
    )
    if not rows:
        return []
    return [f"<p>{text}</p>", _table(("quantity", "value", "what fails"), rows)]


def _damping(kind: str, problem: Problem, data: Data) -> list[str]:
    """How a damped law behaves in an FMU; nothing for other laws."""
    if not problem.curve.native.stage[0].damped:
        return []
    texts = [
        "The force also depends on the rate of indentation. Contact ends where the force falls to zero, without "
        "tension. Then the surface recovers by itself: the next contact begins at zero indentation, or within the dent "
        "as soon as the law's force is positive again."
    ]
    follows = [name for k, name in enumerate(DAMPING) if data.damping_power[k] != 0.0]
    follows += ["restitution"] if has(data, "restitution") else []
    if follows:
        texts.append(f"The damping follows the law if {', '.join(follows)} are changed after export.")
    fixed = [name for name in DAMPING if damping_power(problem.law, name, problem) != 0.0 and not has(data, name)]
    if fixed:
        texts.append(f"The damping is valid for the scene's {', '.join(fixed)} only: export again for other values.")
    if "initial_velocity" in follows:
        texts.append("Its coefficient of restitution holds at initial_velocity, which must be > 0 m/s.")
    if kind == "contact":
        texts.append(
            "maximum_force is taken at communication points and, in Model Exchange, at completed integrator steps."
        )
    return [f"<p>{html.escape(text)}</p>" for text in texts]


def _steps(kind: str, data: Data, history: History | None, experiment: Experiment) -> list[str]:
    texts = TEXTS["steps"]
    if kind == "impact":
        whole = ""
        if history is not None:
            lasts = format_si(history.duration, "time", 4)
            parts = "steps" if data.relaxation.tolerance > 0.0 else "linear force segments"
            whole = f"The contact lasts {lasts} and has {history.accuracy.lines} {parts}."
            whole = whole if history.vibration is None else f"The first contact and those that follow it last {lasts}."
        steps = [texts["impact"].format(whole=whole)]
        if data.modes.count > 0:
            return [*steps, _modes(data)]
        if data.relaxation.tolerance > 0.0:
            return [*steps, texts["relaxing"].format(rest=100.0 * data.relaxation.law.rest, most=MOST_STEPS)]
        loading, unloading = (int(data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
        moves = texts["exchange"].format(tolerance=experiment.tolerance) if has_exchange(data) else texts["static"]
        return [*steps, moves, texts["mesh"].format(loading=loading, unloading=unloading)]
    rows = [(str(n), *(f"{100.0 * error:+.3g} %" for error in errors)) for n, errors in COUPLING_ERRORS.items()]
    heads = ("steps per contact", *COUPLINGS)
    return [texts["contact"].format(table=_table(heads, rows))]


def _modes(data: Data) -> str:
    """What an FMU contains of a vibrating target."""
    frequency = mode_frequencies(data) / (2.0 * math.pi)
    shortest = format_si(1.0 / float(frequency[-1]), "time", 2) if frequency[-1] > 0.0 else "infinite"
    ends = {"lowest": f"{frequency[0]:.4g}", "highest": f"{frequency[-1]:.4g}", "shortest": shortest}
    return TEXTS["steps"]["modes"].format(modes=data.modes.count, states=2 * data.modes.count, **ends)


def _table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in heads)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>\n" for row in rows)
    return f"<table>\n<tr>{head}</tr>\n{body}</table>"


def _summary_rows(history: History) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        rows.append((name.replace("_", " "), "–" if value is None else format_si(value, dimension, 6)))
    return [*rows, ("estimated relative error", f"≤ {history.accuracy.estimated:.1e} of every value")]


def _variable_rows(data: Data, scene: Scene) -> list[tuple[str, ...]]:
    kind, sensors = KINDS[data.kind], (scene.target.sensors or ())[: data.modes.sensors]
    sensed, rows = of_sensors(sensor.name for sensor in sensors), list[tuple[str, ...]]()
    for k, v in enumerate((*VARIABLES, *sensed)):
        if (v in sensed or has(data, v.name)) and v.causality[kind] not in ("local", "independent"):
            unit = scene_unit(v.dimension) if v.dimension else ""
            start = f" = {data.start[k]:g}" if k < settable() and v.causality[kind] == "parameter" else ""
            rows.append((v.name + start, unit, v.causality[kind], v.description))
    return rows


def _law_picture(problem: Problem, history: History) -> bytes:
    """Contact force over indentation: the loading curve and this impact."""
    from matplotlib.figure import Figure

    loop = history.sample_si(np.linspace(0.0, history.duration, 801))
    deepest = float(loop.indentation.max())
    stage_end = problem.curve.native.stage[problem.curve.native.stages - 1].end * problem.scales.length
    reach = min(1.3 * deepest, stage_end)
    xi = np.linspace(0.0, reach, 401) / problem.scales.length
    force = np.array([problem.curve.force(x) for x in xi.tolist()]) * problem.scales.force
    curve = "without damping" if problem.damping > 0.0 else "loading curve"
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    panel = figure.add_subplot()
    panel.plot(xi * problem.scales.length * 1e6, force, "--", color="#717581", label=curve)
    panel.plot(loop.indentation * 1e6, loop.contact_force, color="#3f90da", label="this impact")
    panel.set(xlabel="indentation (µm)", ylabel="contact force (N)", xlim=(0, None), ylim=(0, None))
    panel.legend(frameon=False)
    return svg(figure)

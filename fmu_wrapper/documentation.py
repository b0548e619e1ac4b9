"""The page of documentation inside an FMU, with pictures of the law and of a history."""

from __future__ import annotations

import html
import io
from inspect import cleandoc
from typing import Any

import numpy as np

from film_datasets.provenance import scene_text
from film_model.history import SUMMARY, History
from film_model.laws.law import AbstractLaw
from film_model.plot import check_picture, plot_history
from film_model.problem import Problem
from film_model.scene import Scene
from film_model.units import format_si, scene_unit
from film_model.version import __version__
from fmu_wrapper.model_description import Experiment
from fmu_wrapper.resource import DAMPING, Data, damping_power, has
from fmu_wrapper.variables import KINDS, VARIABLES, reference, settable

COUPLING_ERRORS = {
    20: (0.151, 0.520, -0.120, 0.0029),
    100: (0.0283, 0.0878, -0.0272, 5.5e-5),
    1000: (0.00279, 0.00839, -0.00278, 1.8e-7),
}
"""Steps a contact → error of the restitution of an elastic half-space contact, whose true value is 1, under four
couplings of the contact FMU: force held over the step; force one step late; force one step ahead; force extended along
its derivative."""

_ABOUT = {
    "impact": """An impactor in front of its target, or in contact with it. Its mass is inside; the importer gives the
external force on it and the velocity of the target's support. All directions are positive into the target.""",
    "contact": """The contact force between two bodies of the importer's, with the memory of earlier indentation. The
importer gives the indentation and its rate; a gap is a negative indentation.""",
}

_IMPACT_STEPS = """\
<p>Co-Simulation is exact at any communication step: between steps the inputs are held, and the motion is
marched in closed form. {whole} One step may span a whole contact, or many; outputs and event times do not
depend on it. What the step does limit is how often the inputs are heard. Coupled to a body eight times as heavy
as the impactor, with sixteen steps a contact, velocities were off by up to 1.4 per cent of the approach
velocity when the body heard the force at the end of each step, and by 0.2 per cent when it heard the mean
force, which is the momentum the impactor lost; the first error falls with the step, the second with its
square.</p>
<p>In FMI 3.0 with event mode, each event ends the step at its exact time. Otherwise events are outputs: their
kind, exact time and values. In Model Exchange the true law is integrated, to the importer's tolerance (a relative
one of {tolerance:g} unless it gives another), and events are state events.</p>
<p>Accuracy is set by <code>loading_segments</code> ({loading}) and <code>unloading_segments</code>
({unloading}); the error falls with their fourth power.</p>"""

_CONTACT_STEPS = """\
<p>A force element that is exchanged at steps adds energy or takes it, whatever is in it. The restitution of an elastic
contact is off by</p>
{table}
<p>After a step, contact_force is that of the indentation carried on at its rate to the time that was reached; once
indentation is set, that of the new one. So a master that steps the contact and the bodies side by side, and then
exchanges their outputs, couples as in the first column. One that steps the bodies first, and then the contact with the
indentation they have reached, couples as in the third if it does not read the force before that step.</p>
<p>The last column needs the directional derivative of contact_force by indentation, which this FMU provides. In
Model Exchange, and as the primary FMU “impact”, there is no such error.</p>
<p>The memory follows the communicated path along the cubic with its indentations and rates, so that the deepest
point between two steps is remembered; what an importer only tries, and takes back, is not.</p>"""

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.2rem .8rem;border-bottom:1px solid #ccc;text-align:left}"
    "img{max-width:100%}pre{background:#f5f5f5;padding:1rem;overflow:auto}"
)


def documentation(
    scene: Scene, problem: Problem, data: Data, history: History | None, experiment: Experiment
) -> dict[str, bytes]:
    """The files of the folder, by name: index.html and its pictures."""
    title = scene.title or f"Impact on a {scene.target.kind}"
    kind = KINDS[data.kind]
    pictures: dict[str, bytes] = {}
    if history is not None:
        check_picture("law.svg")
        pictures = {"law.svg": _law_picture(problem, history), "history.svg": _svg(plot_history(history))}
    parts = [f"<h1>{html.escape(title)}</h1>", f"<p>{_ABOUT[kind]} Made by film-model {__version__}.</p>"]
    if history is not None:
        parts += [
            '<p><img src="history.svg" alt="Force, indentation and velocity over time"></p>',
            _table(("value", "of this scene"), _summary_rows(history)),
        ]
    parts += [
        "<h2>Contact law</h2>",
        *_law(problem.law),
        *_chosen(kind, scene, problem),
        *_damping(kind, problem, data),
    ]
    if history is not None:
        parts.append('<p><img src="law.svg" alt="Contact force over indentation"></p>')
    parts += ["<h2>Effects</h2>", _table(("effect", "state", "why"), _effect_rows(problem))]
    warnings = history.warnings if history is not None else problem.warnings
    parts += [f"<p><strong>Warning:</strong> {html.escape(warning)}</p>" for warning in warnings]
    parts += ["<h2>Steps</h2>", *_steps(kind, data, history, experiment)]
    parts += ["<h2>Variables</h2>", _table(("name", "unit", "causality", "meaning"), _variable_rows(data))]
    parts += ["<h2>Scene</h2>", f"<pre>{html.escape(scene_text(scene))}</pre>"]
    page = (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>\n'
        f"<style>{_STYLE}</style>\n</head>\n<body>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )
    return {"index.html": page.encode(), **pictures}


def _law(law: AbstractLaw) -> list[str]:
    """What the law is, its equations and where it is valid."""
    own = type(law).__doc__ or ""
    texts = [f"{law.name}: {law.summary}. {law.source}."]
    if not own.startswith(f"{type(law).__name__}("):  # a dataclass that says nothing of itself
        texts += cleandoc(own).split("\n\n")
    texts += [f"Valid: {law.validity}."] if law.validity else []
    return [f"<p>{html.escape(text)}</p>" for text in texts]


def _chosen(kind: str, scene: Scene, problem: Problem) -> list[str]:
    """That a law of the library's choice is the scene's, and what will not change it."""
    if scene.contact.law != "auto":
        return []
    speed = format_si(scene.approach_velocity, "velocity", 4)
    later = "whatever velocity the importer gives" if kind == "contact" else "whatever initial_velocity or mass is set"
    text = f'The scene says law = "auto": {problem.law.name} was chosen for an approach at {speed}, and stays {later}.'
    return [f"<p>{html.escape(text)} For faster or slower impacts, export a scene of theirs.</p>"]


def _damping(kind: str, problem: Problem, data: Data) -> list[str]:
    """What a user of a damped law has to know of it as an FMU."""
    if not problem.curve.native.stage[0].damped:
        return []
    texts = [
        "The force depends on the rate of indentation too. Contact ends where it falls to zero, without tension. Then "
        "the surface recovers by itself: the next contact begins at indentation zero, or within the dent, where the "
        "law's force is above zero again."
    ]
    follows = [name for k, name in enumerate(DAMPING) if data.damping_power[k] != 0.0]
    if follows:
        texts.append(f"Set after export, {', '.join(follows)} change the damping as the law says.")
    fixed = [name for name in DAMPING if damping_power(problem.law, name, problem) != 0.0 and not has(data, name)]
    if fixed:
        texts.append(f"The damping is that for the scene's {', '.join(fixed)}: export again for others.")
    if "initial_velocity" in follows:
        texts.append("Its restitution is that of an approach at initial_velocity, which must be above 0 m/s.")
    if kind == "contact":
        texts.append(
            "The largest force is that of communication points and, in Model Exchange, of completed integrator steps."
        )
    return [f"<p>{html.escape(text)}</p>" for text in texts]


def _steps(kind: str, data: Data, history: History | None, experiment: Experiment) -> list[str]:
    if kind == "impact":
        whole = ""
        if history is not None:
            lasts = format_si(history.duration, "time", 4)
            whole = f"The whole contact lasts {lasts} and is {history.accuracy.lines} straight pieces of the force."
        loading, unloading = (int(data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
        numbers = {"loading": loading, "unloading": unloading, "tolerance": experiment.tolerance}
        return [_IMPACT_STEPS.format(whole=whole, **numbers)]
    rows = [(str(n), *(f"{100.0 * error:+.3g} %" for error in errors)) for n, errors in COUPLING_ERRORS.items()]
    heads = (
        "steps a contact",
        "force held over the step",
        "force one step late",
        "force one step ahead",
        "force extended along its derivative",
    )
    return [_CONTACT_STEPS.format(table=_table(heads, rows))]


def _table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in heads)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>\n" for row in rows)
    return f"<table>\n<tr>{head}</tr>\n{body}</table>"


def _summary_rows(history: History) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        rows.append((name.replace("_", " "), "–" if value is None else format_si(value, dimension, 6)))
    return [*rows, ("error at most", f"{history.accuracy.estimated:.1e} of every value")]


def _effect_rows(problem: Problem) -> list[tuple[str, ...]]:
    return [(effect.name.replace("_", " "), effect.state, effect.reason) for effect in problem.effects]


def _variable_rows(data: Data) -> list[tuple[str, ...]]:
    kind = KINDS[data.kind]
    rows: list[tuple[str, ...]] = []
    for k, v in enumerate(VARIABLES):
        if has(data, v.name) and v.causality[kind] not in ("local", "independent"):
            unit = scene_unit(v.dimension) if v.dimension else ""
            start = f" = {data.start[k]:g}" if k < settable() and v.causality[kind] == "parameter" else ""
            rows.append((v.name + start, unit, v.causality[kind], v.description))
    return rows


def _law_picture(problem: Problem, history: History) -> bytes:
    """The loading curve, and the loop of this history."""
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
    return _svg(figure)


def _svg(figure: Any) -> bytes:
    """The same picture with the same bytes."""
    import matplotlib

    picture = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "film-model"}):
        figure.savefig(picture, format="svg", metadata={"Date": None})
    return picture.getvalue()

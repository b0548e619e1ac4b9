"""The documentation page inside an FMU, with pictures of the law and of the impact."""

from __future__ import annotations

import html
import math
from inspect import cleandoc

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
from fmu_wrapper.sensor_variables import of_sensors
from fmu_wrapper.variables import KINDS, VARIABLES, reference, settable

COUPLINGS = (
    "side by side",
    "side by side, input_extrapolation = 1",
    "bodies first, input_extrapolation = 0.5",
    "force read after the input was set",
    "force extrapolated with its derivative",
)
"""How a master couples the contact FMU and the bodies."""

COUPLING_ERRORS = {
    5: (1.07, 1.36, 0.112, 0.729, 0.0508),
    10: (0.104, 0.39, 0.0203, 0.327, 0.0153),
    20: (0.0117, 0.158, 0.00363, 0.151, 0.00289),
    50: (0.000867, 0.058, 0.00037, 0.0576, 0.000306),
    100: (0.000128, 0.0284, 6.56e-5, 0.0283, 5.53e-5),
    500: (1.68e-6, 0.00559, 1.17e-6, 0.00559, 1.02e-6),
}
"""Communication steps per contact → error of the coefficient of restitution for an elastic half-space contact (exact
value 1), for each of `COUPLINGS`."""

_ABOUT = {
    "impact": """An impactor in front of its target, or in contact with it. The FMU contains the impactor's mass; the
inputs are the external force on the impactor and the velocity of the target's support. Positive directions point into
the target.""",
    "contact": """The contact force between two bodies that the importer models; it depends on earlier indentation. The
inputs are the indentation and its rate; a gap is a negative indentation.""",
}

_IMPACT_STEPS = """\
<p>In Co-Simulation the result does not depend on the communication step: the inputs are constant during a step, and
the motion is computed in closed form. {whole} One step may cover a whole contact or several contacts; outputs and event
times stay the same. The step only limits how often the inputs change. An example: coupled to a body of eight times the
impactor's mass, with sixteen steps per contact, the velocity errors were up to 1.4 % of the approach velocity if the
body received the force at the end of each step, and 0.2 % if it received the mean force, which is the momentum that the
impactor lost divided by the step; the first error is proportional to the step, the second to its square.</p>
<p>In FMI 3.0 with event mode, each event ends the step at its exact time. Otherwise the kind, exact time and values of
events are outputs.</p>"""

_EXCHANGE = """\
<p>In Model Exchange the importer integrates the true law to its own tolerance (default: {tolerance:g}, relative), and
events are state events.</p>"""

_STATIC = """\
<p>The target follows the contact force by its static stiffness, <code>target_stiffness</code>, without delay: it has no
inertia, and <code>indentation</code> and <code>target_displacement</code> share the displacement of the impactor as the
two forces balance. This FMU is for Co-Simulation: Model Exchange would need that balance in place of a state.</p>"""

_MESH = """\
<p><code>loading_segments</code> ({loading}) and <code>unloading_segments</code> ({unloading}) set the accuracy; the
error is proportional to their number to the power of −4.</p>"""

_MODES_STEPS = """\
<p>The target is followed by {modes} natural vibrations, from {lowest} to {highest} Hz, as many as the accuracy of this
scene needs; those above follow the force statically. They belong to the export: they are no parameters, and a much
smaller radius or mass, or a much larger velocity, needs more of them. The structure rings on between contacts. A
support_velocity moves it as a whole and does not make it vibrate.</p>
<p>This FMU is for Co-Simulation: in Model Exchange the vibrations would be {states} states of an integrator,
whose steps could not be longer than the shortest period, {shortest}.</p>"""

_RELAXING_STEPS = """\
<p>The bodies are viscoelastic: the contact modulus falls with time under load to {rest:.3g} % of the instantaneous one,
which is <code>effective_modulus</code>. That parameter multiplies the modulus at all times; the relaxation times belong
to the export. The contact is solved by Ting's solution in steps of its own, to the accuracy of the scene; a saved state
contains those of the latest contact, at most {most}. A step is refused with an error where the indentation grows again
before contact ends, or where a contact begins before the material has forgotten the one before.</p>
<p>This FMU is for Co-Simulation: in Model Exchange an importer's integrator has no memory of how the contact
grew.</p>"""

_CONTACT_STEPS = """\
<p>Any force element whose force is exchanged only at communication points adds or removes energy. Error of the
coefficient of restitution of an elastic contact:</p>
{table}
<p>“Side by side”: an importer steps the contact and the bodies in parallel and then exchanges their outputs, as
ordinary masters do. The force that the contact reports after a step then acts on the bodies during the following one,
whose middle is 1.5 steps after the input of the contact. Therefore it belongs to the indentation extrapolated at its
rate by input_extrapolation steps; the default is 1.5. A damped law's rate is extrapolated by its latest change.
“Bodies first”: an importer steps the bodies first, and then the contact with the indentation that they have reached, or
iterates; its best value is 0.5. With 0 or 1, contact_force belongs to the indentation at the last input, or to that
extrapolated to the end of the step. After indentation was set, contact_force always belongs to the new indentation.</p>
<p>The last column needs the directional derivative of contact_force with respect to indentation, which this FMU
provides. Model Exchange and the FMU of kind “impact” do not have this error.</p>
<p>Between two communication points the indentation is taken as the cubic through both indentations and rates, so the
maximum indentation between them is part of the contact's memory. Values that an importer sets and then replaces before
the step are not.</p>"""

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
    parts = [f"<h1>{html.escape(title)}</h1>", f"<p>{_ABOUT[kind]} Made by film-model {__version__}.</p>"]
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
    if kind == "impact":
        whole = ""
        if history is not None:
            lasts = format_si(history.duration, "time", 4)
            parts = "steps" if data.relaxation.tolerance > 0.0 else "linear force segments"
            whole = f"The contact lasts {lasts} and has {history.accuracy.lines} {parts}."
            whole = whole if history.vibration is None else f"The first contact and those that follow it last {lasts}."
        steps = [_IMPACT_STEPS.format(whole=whole)]
        if data.modes.count > 0:
            return [*steps, _modes(data)]
        if data.relaxation.tolerance > 0.0:
            return [*steps, _RELAXING_STEPS.format(rest=100.0 * data.relaxation.law.rest, most=MOST_STEPS)]
        loading, unloading = (int(data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
        moves = _EXCHANGE.format(tolerance=experiment.tolerance) if has_exchange(data) else _STATIC
        return [*steps, moves, _MESH.format(loading=loading, unloading=unloading)]
    rows = [(str(n), *(f"{100.0 * error:+.3g} %" for error in errors)) for n, errors in COUPLING_ERRORS.items()]
    heads = ("steps per contact", *COUPLINGS)
    return [_CONTACT_STEPS.format(table=_table(heads, rows))]


def _modes(data: Data) -> str:
    """What an FMU contains of a vibrating target."""
    frequency = mode_frequencies(data) / (2.0 * math.pi)
    shortest = format_si(1.0 / float(frequency[-1]), "time", 2) if frequency[-1] > 0.0 else "infinite"
    ends = {"lowest": f"{frequency[0]:.4g}", "highest": f"{frequency[-1]:.4g}", "shortest": shortest}
    return _MODES_STEPS.format(modes=data.modes.count, states=2 * data.modes.count, **ends)


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

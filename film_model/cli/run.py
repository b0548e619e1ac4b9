"""film-model run, bounce, spectrum: one impact or a chain of bodies, all bounces of a ball, a spectrum."""

from __future__ import annotations

import argparse
import os
from functools import partial
from typing import TYPE_CHECKING, Any

import film_model.plot as pictures
from film_model.cli.output import (
    Commands,
    add_common,
    add_scene,
    check_dataset,
    check_writable,
    give,
    give_result,
    listed,
    read_scene,
)

if TYPE_CHECKING:
    from film_model.solve.bounce import Bounce, Bounces
    from film_model.solve.chain_motion import ChainMotion
    from film_model.solve.history import History

ENDS = ("contact_begins", "contact_ends")
"""Of more contacts only these events are in the table."""

SHORT = (
    *("maximum_force", "maximum_indentation", "contact_duration", "permanent_indentation"),
    *("rebound_velocity", "coefficient_of_restitution"),
)
"""Results without --verbose."""

MOST_ROWS = 12
"""Rows of the table without --verbose, half of them at its end."""


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add("run", "simulate the impact of a scene file, or a chain", run)
    add_scene(parser)
    parser.add_argument(
        "--output", metavar="FILE", help="write the history: .nc or .zarr (complete), .csv, .parquet or .mat (motion)"
    )
    parser.add_argument(
        "--strobe", metavar="FILE", help="draw the ball at even times before and after (.png, .svg or .pdf)"
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--accuracy", type=float, help="relative accuracy of every summary value, e.g. 1e-6")
    how.add_argument("--segments", type=int, help="segments per stage, instead of an accuracy")
    parser.add_argument(
        "--linearisation", choices=("work-preserving", "chord"), help="how segments approximate the law"
    )
    parser.add_argument(
        "--derivatives", metavar="KEY[,KEY]", help="of the summary, by keys of the scene such as impactor.velocity"
    )
    parser.add_argument("--verbose", action="store_true", help="print every result, event and effect")
    add_common(parser, plot="draw the history")

    parser = commands.add("bounce", "all bounces of a ball under gravity, to rest", bounce)
    add_scene(parser)
    parser.add_argument("--resolution", metavar="LENGTH", help="a lower bounce is rest (default: 1e-6 of the fall)")
    parser.add_argument("--accuracy", type=float, help="relative accuracy of the first impact, e.g. 1e-6")
    parser.add_argument("--output", metavar="FILE", help="write all bounces: .nc, .zarr, .csv, .parquet or .mat")
    parser.add_argument("--verbose", action="store_true", help="print every bounce")
    add_common(parser, plot="draw height over time")

    parser = commands.add("spectrum", "bandwidth of the force, and response of the structure over frequency", spectrum)
    add_scene(parser)
    parser.add_argument("--highest", metavar="FREQUENCY", help='e.g. "5 kHz" (default: twice the bandwidth)')
    parser.add_argument("--accuracy", type=float, help="relative accuracy of the impact, e.g. 1e-6")
    parser.add_argument("--output", metavar="FILE.csv", help="write frequencies and complex values")
    add_common(parser, plot="draw the spectrum of the force, accelerances and strains")


def run(options: argparse.Namespace) -> int:
    from film_model.scene.scene import scene_of
    from film_model.scene.toml import read_text, toml_table
    from film_model.solve.simulate import simulate_quietly

    check_dataset(options)
    text, name = read_text(options.scene)
    table, folder = toml_table(text, name), os.path.dirname(options.scene)
    if "bodies" in table:
        return run_chain(text, name, folder, options)
    scene = scene_of(table, text, name, folder)
    history = simulate_quietly(
        scene,
        accuracy=options.accuracy,
        segments=options.segments,
        linearisation=options.linearisation,
        derivatives=listed(options.derivatives),
    )

    def shown() -> str:
        return "\n".join([_table(history, options.verbose), *_derivatives(history)])

    return give_result(options, history, shown, strobe=lambda path: pictures.plot_strobe(history, path))


def _table(history: History, verbose: bool) -> str:
    """The results, and the effects that are simulated; verbose: all results, events and computed effects."""
    from film_model.effects.effect import COMPUTED

    problem, accuracy = history.problem, history.accuracy
    lines = [history.scene.title or "Impact", f"law {problem.law.name}; {history.outcome.value}", ""]
    lines += _results(history, verbose)
    lines += _sensors(history)
    lines += [] if history.oblique is None else ["", history.oblique.text()]
    lines += [*_events(history), ""] if verbose else [""]
    lines += [
        f"  {effect.name.replace('_', ' ')}: {effect.state}; {effect.reason}"
        for effect in history.effects
        if effect.name in COMPUTED and (verbose or effect.simulated)
    ]
    pieces = "segments" if history.relaxed is None else "steps"
    means = f"{accuracy.modes} modes" if accuracy.modes else f"{accuracy.lines} {pieces}"
    lines.append(f"  estimated relative error ≤ {accuracy.estimated:.1e} ({means})")
    return "\n".join(lines)


def _results(history: History, verbose: bool) -> list[str]:
    from film_model.base.units import format_si
    from film_model.problem.summary import SUMMARY

    lines = list[str]()
    for name in SUMMARY if verbose else SHORT:
        value = history.summary[name]
        if value is None and not verbose:
            continue
        text = "-" if value is None else format_si(value, SUMMARY[name][0], 6)
        if value is None and name == "impulse" and history.vibration is not None:
            text = f"{text}  not known while the weight or a force presses, too"
        lines.append(f"  {name.replace('_', ' '):30}{text:>16}{history.interval_text(name)}")
    return lines


def _sensors(history: History) -> list[str]:
    """The largest motion of each sensor."""
    if not history.scene.target.sensors:
        return []
    if not history.sensor_peaks:
        return ["  sensors                       no motion: the vibrations of the target are not simulated"]
    from film_model.base.units import format_si
    from film_model.solve.sensed import MOTION, STRAIN

    lines = list[str]()
    for name, peaks in history.sensor_peaks.items():
        texts = (format_si(peaks[f"maximum_{what}"], kind, 4) for what, (kind, _) in MOTION.items())
        lines.append(f"  {f'sensor {name}, largest':30}{', '.join(texts)}")
        known = {what: peaks[key] for what in STRAIN if (key := f"maximum_{what}") in peaks}
        if known:
            texts = (f"{what.replace('_', ' ')} {format_si(own, STRAIN[what][0], 4)}" for what, own in known.items())
            lines.append(f"  {'':30}{', '.join(texts)}")
    return lines


def _events(history: History) -> list[str]:
    most_events = 24  # JSON and files contain all of them
    from film_model.base.units import format_si

    lines = ["", f"  {'event':24}{'time':>14}{'indentation':>16}{'force':>14}"]
    ends = sum(event.name == "contact_ends" for event in history.events)
    shown = [event for event in history.events if ends <= 5 or event.name in ENDS]
    for event in shown[:most_events]:
        numbers = (
            f"{format_si(event.time, 'time', 5):>14}{format_si(event.indentation, 'length', 5):>16}"
            f"{format_si(event.contact_force, 'force', 5):>14}"
        )
        what = f"  ({event.stage})" if event.name == "stage_changes" else ""
        lines.append(f"  {event.name.replace('_', ' '):24}{numbers}{what}")
    if len(history.events) > most_events or len(shown) < len(history.events):
        lines.append(f"  and {len(history.events) - len(shown[:most_events])} more: --json and files have all")
    return lines


def _derivatives(history: History) -> list[str]:
    """The derivatives, those by each number together: in SI, and as per cent of the value for 1 %."""
    found, lines = history.derivatives, list[str]()
    along = {} if history.oblique is None else history.oblique.summary
    if found is None:
        return []
    for path, entry in found.entries.items():
        lines += ["", f"  {f'derivatives by {path} = {entry.text}':50}{'per 1 %':>12}"]
        for name, value in {**history.summary, **along}.items():
            slope = found.values[name][path]
            if slope is None:
                continue
            share = f"{slope * entry.value / value:.4f} %" if value and entry.value else "-"
            lines.append(f"    {name.replace('_', ' '):30}{found.text_of(name, path):>24}{share:>12}")
    return lines


def run_chain(text: str, name: str, folder: str, options: argparse.Namespace) -> int:
    from film_model.scene.chain import Chain
    from film_model.solve.chain_motion import simulate_chain_quietly

    chain = Chain.from_text(text, name, folder)
    for option in ("strobe", "segments", "linearisation", "derivatives"):
        if getattr(options, option):
            raise ValueError(f"--{option} is not for a chain of bodies")
    if options.accuracy is not None:
        table = chain.to_table()
        chain = chain.from_table({**table, "solver": {**table["solver"], "accuracy": options.accuracy}})
    motion = simulate_chain_quietly(chain)
    return give_result(options, motion, lambda: _chain_text(motion, options.verbose))


def _chain_text(motion: ChainMotion, verbose: bool) -> str:
    most_rows = 8  # without --verbose, half of them at the end
    from film_model.solve.chain_motion import BODIES, CONTACTS

    energy = motion.energy
    whole = max(energy.kinetic_before + energy.weight, energy.kinetic_after)
    least = max(1e-11 * whole, 10.0 * abs(energy.error))  # J: less is rounding
    laws = ", ".join(dict.fromkeys(motion.laws))
    lines = [motion.chain.title or "Chain", f"law {laws}; {motion.outcome}"]
    short = [name for name in CONTACTS if name != "contact_ends"]
    for what, names in (("body", BODIES), ("contact", CONTACTS if verbose else short)):
        dimensions = [(BODIES | CONTACTS)[name][0] for name in names]
        lines += ["", f"  {what:8}" + "".join(f"{_head(name):>18}" for name in names)]
        rows = motion.rows(names)
        numbers = motion.chain.link_names if names is not BODIES else [str(number + 1) for number in range(len(rows))]
        named = list(zip(numbers, rows, strict=True))
        for number, row in _shown(named, len(rows) if verbose else most_rows):
            cells = (_cell(value, kind, least) for value, kind in zip(row.values(), dimensions, strict=True))
            lines.append(f"  {number:8}" + "".join(f"{cell:>18}" for cell in cells))
        if len(rows) > most_rows and not verbose:
            lines.insert(-most_rows // 2, f"  ... {len(rows) - most_rows} more")
    parts = {"before": energy.kinetic_before, "after": energy.kinetic_after, "absorbed": energy.absorbed}
    parts |= {"of weight": energy.weight} if motion.chain.gravity else {}
    parts |= {"of vibrations": energy.vibrations} if motion.chain.vibrates else {}
    lines += ["", "  energy  " + ", ".join(f"{name} {_cell(value, 'energy', least)}" for name, value in parts.items())]
    within = f"balance of energy within {max(abs(energy.error) / whole, 1e-12):.0e}"
    lines.append(f"  {within}; estimated relative error ≤ {motion.estimated:.1e}")
    return "\n".join(lines)


def _cell(value: float | None, dimension: str, least: float) -> str:
    """A value with unit; energies below the least [J] as 0."""
    from film_model.base.units import format_si

    if value is None:
        return "-"
    return format_si(0.0 if dimension == "energy" and abs(value) < least else value, dimension, 5)


def _head(name: str) -> str:
    return {"time_of_largest_force": "at", "energy_absorbed": "absorbed", "largest_indentation": "indentation"}.get(
        name, name.replace("contact_", "").replace("body_", "").replace("_velocity", "").replace("_", " ")
    )


def _shown(rows: list[tuple[str, dict[str, Any]]], most: int) -> list[tuple[str, dict[str, Any]]]:
    """The rows without the middle ones of more than `most`."""
    return rows if len(rows) <= most else [*rows[: most // 2], *rows[len(rows) - most // 2 :]]


def bounce(options: argparse.Namespace) -> int:
    from film_model.solve.bounce import bounce_quietly

    check_dataset(options)
    done = bounce_quietly(read_scene(options), resolution=options.resolution, accuracy=options.accuracy)
    return give_result(options, done, lambda: _bounces_table(done, len(done.bounces) if options.verbose else MOST_ROWS))


def _bounces_table(done: Bounces, most: int) -> str:
    count = len(done.bounces)
    waves = f" and waves in the {done.scene.target.kind}" if done.scene.effects.wave_losses is True else ""
    lines = [done.scene.title or "Bounces", f"law {done.law}, with the weight{waves}; {done.outcome}", ""]
    heads = ["time", "velocity", "rebound", "height", "force", "dent"]
    if done.scene.contact.friction is not None:
        heads += ["along", f"{'spin':>18}"]
    lines.append(f"{'':5}{''.join(f'{head:>14}' for head in heads)}{'e':>9}")
    for number, bounce in enumerate(done.bounces, 1):
        if count <= most or number <= most // 2 or number > count - most // 2:
            lines.append(f"{number:5}{_row(bounce, len(heads))}")
        elif number == most // 2 + 1:
            lines.append(f"  ... {count - 2 * (most // 2)} more")
    return "\n".join(lines)


def _row(bounce: Bounce, count: int) -> str:
    from film_model.base.units import format_si

    dent, along, spin = bounce.permanent_indentation, bounce.tangential_velocity, bounce.spin
    cells = (
        format_si(bounce.time, "time", 5),
        format_si(bounce.velocity_before, "velocity"),
        format_si(bounce.velocity_after, "velocity"),
        format_si(bounce.height, "length"),
        format_si(bounce.maximum_force, "force"),
        "-" if dent is None else format_si(dent, "length"),
        "-" if along is None else format_si(along, "velocity"),
        f"{'-' if spin is None else format_si(spin, 'angular_frequency'):>18}",
    )[:count]
    return f"{''.join(f' {cell:>13}' for cell in cells)}{bounce.restitution:9.4f}"


def spectrum(options: argparse.Namespace) -> int:
    from film_model.base.units import format_si, to_si
    from film_model.plot.spectrum import plot_spectrum
    from film_model.solve.simulate import simulate_quietly
    from film_model.solve.spectrum import FREQUENCIES

    check_writable(options.output, options.force)
    scene = read_scene(options)
    history = simulate_quietly(scene, accuracy=options.accuracy)
    frequencies = None
    if options.highest is not None:
        try:
            highest = to_si(options.highest, "frequency")
        except ValueError as error:
            raise ValueError(f"--highest: {error}") from None
        frequencies = [highest * (k + 1) / FREQUENCIES for k in range(FREQUENCIES)]
    found = history.spectrum(frequencies)
    title = scene.title or f"Impact on a {scene.target.kind}"
    lasts = format_si(history.summary["contact_duration"] or 0.0, "time", 4)
    falls = f"  force down by 10 dB at        {found.bandwidth / 1e3:.4g} kHz"
    text = "\n".join([title, falls, f"  contact duration              {lasts}"])
    draw = partial(plot_spectrum, found, title)
    return give(options, lambda: text, found.to_dict, history.warnings, output=found.write, plot=draw)

"""film-model bounce: all bounces of a ball until it rests."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from film_model.cli.output import Commands, add_common, add_scene, check_dataset, give_result, read_scene

if TYPE_CHECKING:
    from film_model.solve.bounce import Bounce, Bounces

MOST_ROWS = 12
"""Rows of the table without --verbose, half of them at its end."""


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("bounce", "all bounces of a ball under gravity, to rest", bounce)
    add_scene(parser)
    parser.add_argument("--resolution", metavar="LENGTH", help="a lower bounce is rest (default: 1e-6 of the fall)")
    parser.add_argument("--accuracy", type=float, help="relative accuracy of the first impact, e.g. 1e-6")
    parser.add_argument("--output", metavar="FILE", help="write all bounces: .nc, .zarr, .csv, .parquet or .mat")
    parser.add_argument("--verbose", action="store_true", help="print every bounce")
    add_common(parser, plot="draw height over time")


def bounce(options: argparse.Namespace) -> int:
    from film_model.solve.bounce import bounce_quietly

    check_dataset(options)
    done = bounce_quietly(read_scene(options), resolution=options.resolution, accuracy=options.accuracy)
    return give_result(options, done, lambda: _table(done, len(done.bounces) if options.verbose else MOST_ROWS))


def _table(done: Bounces, most: int) -> str:
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

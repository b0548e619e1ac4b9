"""film-model spectrum: an impact over frequency, as a hammer test sees it."""

from __future__ import annotations

import argparse
from functools import partial

from film_model.cli.output import Commands, add_common, add_scene, check_writable, give, read_scene


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("spectrum", "bandwidth of the force, and response of the structure over frequency", spectrum)
    add_scene(parser)
    parser.add_argument("--highest", metavar="FREQUENCY", help='e.g. "5 kHz" (default: twice the bandwidth)')
    parser.add_argument("--accuracy", type=float, help="relative accuracy of the impact, e.g. 1e-6")
    parser.add_argument("--output", metavar="FILE.csv", help="write frequencies and complex values")
    add_common(parser, plot="draw the spectrum of the force, accelerances and strains")


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

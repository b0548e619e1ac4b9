"""film-model spectrum: an impact over frequency, as a hammer test sees it."""

from __future__ import annotations

import argparse
from typing import Any

from film_model.cli.output import (
    DONE,
    add_force,
    add_json,
    add_plot,
    check_picture,
    check_writable,
    print_json,
    print_warnings,
    print_written,
)


def add_commands(named: Any) -> None:
    """The command and its options."""
    parser: argparse.ArgumentParser = named.add_parser(
        "spectrum", "bandwidth of the force, and response of the structure over frequency"
    )
    parser.add_argument("scene", help="scene file (TOML)")
    parser.add_argument("--highest", metavar="FREQUENCY", help='e.g. "5 kHz" (default: twice the bandwidth)')
    parser.add_argument("--accuracy", type=float, help="relative accuracy of the impact, e.g. 1e-6")
    parser.add_argument("--output", metavar="FILE.csv", help="write frequencies and complex values")
    add_plot(parser, "draw the spectrum of the force, accelerances and strains")
    add_force(parser)
    add_json(parser)
    parser.set_defaults(command=spectrum)


def spectrum(options: argparse.Namespace) -> int:
    from film_model.base.units import format_si, to_si
    from film_model.scene import Scene
    from film_model.solve.simulate import simulate_quietly
    from film_model.solve.spectrum import FREQUENCIES

    if options.output:
        check_writable(options.output, options.force)
    check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
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
    if options.output:
        found.write(options.output)
    if options.plot:
        from film_model.plot.spectrum import plot_spectrum

        plot_spectrum(found, title, options.plot)
    if options.json:
        print_json(found.to_dict())
    else:
        print(title)
        print(f"  force down by 10 dB at        {found.bandwidth / 1e3:.4g} kHz")
        print(f"  contact duration              {format_si(history.summary['contact_duration'] or 0.0, 'time', 4)}")
        print_written(options.output, options.plot)
    print_warnings(history.warnings)
    return DONE

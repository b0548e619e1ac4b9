"""film-model tolerance: how far tolerances spread the results."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from film_model.cli.output import (
    DONE,
    add_force,
    add_json,
    add_plot,
    check_picture,
    listed,
    print_json,
    print_warnings,
    print_written,
)


def add_commands(named: Any) -> None:
    """The command and its options."""
    parser: argparse.ArgumentParser = named.add_parser(
        "tolerance", help="spread of the results by tolerances and scatter, and which number causes it"
    )
    parser.add_argument("sweep", help="sweep file (TOML) with tolerances or distributions")
    parser.add_argument("--quantity", metavar="NAME[,NAME]", help="summary quantities (default: four)")
    parser.add_argument("--samples", type=int, metavar="N", help="points (default: those of the file)")
    parser.add_argument("--confidence", type=float, default=0.95, help="level of the intervals (default: 0.95)")
    add_plot(parser, "draw the tornado picture of the first quantity")
    add_force(parser, "overwrite an existing picture")
    add_json(parser)
    parser.set_defaults(command=tolerance)


def tolerance(options: argparse.Namespace) -> int:
    from film_datasets.sweeps import read_sweep
    from film_datasets.sweeps.designs import MOST_SAMPLES, SAMPLED
    from film_datasets.tolerances import tolerance_of
    from film_datasets.tolerances.analysis import SHOWN
    from film_datasets.tornado_plot import plot_tornado

    check_picture(options.plot, options.force)
    if not 0.0 < options.confidence < 1.0:
        raise ValueError(f"--confidence: {options.confidence:g} must be between 0 and 1")
    sweep = read_sweep(options.sweep)
    if sweep.design not in SAMPLED:
        raise ValueError(f'{options.sweep}: design "{sweep.design}" has no scatter: "sobol" is needed')
    if options.samples is not None:
        if not 8 <= options.samples <= MOST_SAMPLES["sobol"]:
            raise ValueError(f"--samples: {options.samples} is not allowed: 8 to {MOST_SAMPLES['sobol']} are needed")
        sweep = replace(sweep, samples=options.samples)
    quantities = listed(options.quantity) or SHOWN
    found = tolerance_of(sweep, quantities, options.confidence)
    if options.plot:
        plot_tornado(found, options.plot)
    if options.json:
        print_json(found.to_dict())
    else:
        print(found)
        print_written(options.plot)
    print_warnings(found.warnings)
    return DONE

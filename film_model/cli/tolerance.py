"""film-model tolerance: how far tolerances spread the results."""

from __future__ import annotations

import argparse
from dataclasses import replace

from film_model.cli.output import Commands, add_common, give, listed


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add(
        "tolerance", "spread of the results by tolerances and scatter, and which number causes it", tolerance
    )
    parser.add_argument("sweep", help="sweep file (TOML) with tolerances or distributions")
    parser.add_argument("--quantity", metavar="NAME[,NAME]", help="summary quantities (default: four)")
    parser.add_argument("--samples", type=int, metavar="N", help="points (default: those of the file)")
    parser.add_argument("--confidence", type=float, default=0.95, help="level of the intervals (default: 0.95)")
    add_common(parser, plot="draw the tornado picture of the first quantity")


def tolerance(options: argparse.Namespace) -> int:
    from film_datasets.sweeps import read_sweep
    from film_datasets.sweeps.designs import MOST_SAMPLES, SAMPLED
    from film_datasets.tolerances import tolerance_of
    from film_datasets.tolerances.analysis import SHOWN
    from film_datasets.tornado_plot import plot_tornado

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
    return give(options, lambda: str(found), found.to_dict, found.warnings, plot=lambda path: plot_tornado(found, path))

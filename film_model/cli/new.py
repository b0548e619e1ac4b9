"""film-model new: a commented scene to begin with."""

from __future__ import annotations

import argparse

from film_model.base.files import write_text
from film_model.cli.output import DONE, Commands, add_common, check_writable, print_written

TARGETS = {
    "half-space": """\
material = "mild steel"         # "film-model materials" lists the names
# or a table of your own values:
# material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7850 kg/m^3", yield_strength = "250 MPa" }
""",
    "plate": """\
material  = "mild steel"
thickness = "4 mm"
size      = ["150 mm", "100 mm"] # without it the plate is infinite
# edges    = "clamped"          # default "simply supported"; one word, or one for each of the four edges
# position = ["50 mm", "30 mm"] # of the impact, from a corner; default the middle
# damping_ratio = 0.01          # of the natural vibrations
""",
    "rod": """\
material = "mild steel"
diameter = "20 mm"              # or area, of any cross-section
# length  = "1 m"               # without it no waves return from the far end
# far_end = "fixed"             # default "free"
""",
    "beam": """\
material  = "mild steel"
length    = "300 mm"
width     = "20 mm"
thickness = "10 mm"
# ends     = "clamped"          # default "simply supported"; also "cantilever", or one word for each end
# position = "100 mm"           # of the impact, from one end; default the middle
""",
    "body": """\
radius   = "20 mm"              # of its surface at the contact
material = "mild steel"
# mass     = "250 g"            # default density × sphere volume
# velocity = "-1 m/s"           # in the impactor's direction; default 0
""",
    "structure": """\
material   = "mild steel"       # of the surface that is struck
frequency  = ["180 Hz", "410 Hz"] # natural vibrations that move the point of impact
modal_mass = ["0.9 kg", "1.4 kg"] # of each, if the point of impact moves by 1; or file = "modes.csv" for both
# damping_ratio = 0.01
""",
}
"""Entries of [target] by kind."""

SCENE = """\
# A scene of film-model: simulate it with "film-model run FILE", see what matters with "film-model explain FILE".
# Every quantity is a text with its unit.
title = "Ball on a {kind}"

[impactor]
radius   = "10 mm"              # of the contacting surface, or diameter; or shape = "cone", …
velocity = "1 m/s"              # towards the target, or drop_height = "50 mm"
material = "bearing steel"
# mass  = "32 g"                # default density × sphere volume
# angle = "20 deg"              # to the normal; with friction = 0.2 in [contact] sliding and spin, too

[target]
kind = "{kind}"
{target}
[contact]
law = "auto"                    # hertz below yield, elastoplastic above; "film-model laws" lists all

[effects]
tolerance = 0.01                # an effect that changes a result by more is simulated, or causes a warning

[solver]
accuracy = 1e-4                 # relative, of every summary value
"""


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("new", "write a commented scene file to begin with", new)
    parser.add_argument("--kind", choices=tuple(TARGETS), default="half-space", help="of target (default: half-space)")
    parser.add_argument("--output", metavar="FILE.toml", help="write to this file (default: standard output)")
    add_common(parser, json=False)


def new(options: argparse.Namespace) -> int:
    text = SCENE.format(kind=options.kind, target=TARGETS[options.kind])
    if options.output is None:
        print(text, end="")
        return DONE
    check_writable(options.output, options.force)
    write_text(options.output, text)
    print_written(options.output)
    return DONE

"""film-model new, explain, cite, laws, materials: a scene to begin with, what applies to it, what to choose from."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import film_model.plot as pictures
from film_model.base.files import write_text
from film_model.cli.output import (
    DONE,
    Commands,
    add_common,
    add_scene,
    check_writable,
    give,
    print_json,
    print_written,
    read_scene,
)

if TYPE_CHECKING:
    from film_model.base.materials import Material
    from film_model.laws import AbstractLaw

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
    """The commands and their options."""
    parser = commands.add("explain", "list the effects that a scene requires, with the numbers that decide", explain)
    add_scene(parser)
    parser.add_argument("--verbose", action="store_true", help="also indicators, thresholds, costs and sources")
    parser.add_argument("--law", choices=("all",), help="all: also compare what the contact laws predict")
    add_common(parser, plot="draw the scene on a map of regimes")

    parser = commands.add("laws", "list the contact laws and their parameters", laws)
    add_common(parser, plot="draw all of them")

    parser = commands.add("cite", "print what to cite for a scene, as BibTeX", cite)
    add_scene(parser)

    parser = commands.add("materials", "list the materials of the catalogue, or show one", materials)
    parser.add_argument("name", nargs="?", help="show this one, with the sources of its values")
    parser.add_argument("--search", metavar="WORD", help="list only materials whose name contains this")
    add_common(parser, force="")

    parser = commands.add("new", "write a commented scene file to begin with", new)
    parser.add_argument("--kind", choices=tuple(TARGETS), default="half-space", help="of target (default: half-space)")
    parser.add_argument("--output", metavar="FILE.toml", help="write to this file (default: standard output)")
    add_common(parser, json=False)


def explain(options: argparse.Namespace) -> int:
    from film_model.studies import explain as explaining

    scene = read_scene(options)
    report = explaining.explain(scene, laws=options.law == "all")

    def text() -> str:
        effects = explaining.effects_text(scene, verbose=options.verbose)
        return f"{effects}\n\n{explaining.laws_text(report['laws'])}" if options.law else effects

    return give(options, text, lambda: report, report["warnings"], plot=lambda path: pictures.plot_regimes(scene, path))


def laws(options: argparse.Namespace) -> int:
    from film_model.laws import LAWS
    from film_model.laws.unloading import UNLOADINGS

    rows = [{"name": name, **_law_row(law)} for name, law in LAWS.items()]
    rules = [{"name": name, **_law_row(law)} for name, law in UNLOADINGS.items()]
    heading = '\nRules of unloading for any law without damping, unloading = "..." in [contact]:\n'
    texts = (*map(_law_text, rows), heading, *map(_law_text, rules))
    return give(
        options,
        lambda: "\n".join(texts),
        lambda: {"laws": rows, "unloadings": rules},
        plot=lambda path: pictures.plot_laws(path),
    )


def _law_row(law: type[AbstractLaw]) -> dict[str, Any]:
    return {
        "summary": law.summary,
        "source": law.source,
        "validity": law.validity,
        "parameters": {
            key: {name: getattr(p, name) for name in ("dimension", "choices", "required", "several", "help")}
            for key, p in law.parameters.items()
        },
    }


def _law_text(row: dict[str, Any]) -> str:
    lines = [f"{row['name']:20}{row['summary']}", f"{'':20}{row['source']}", f"{'':20}valid: {row['validity']}"]
    for key, parameter in row["parameters"].items():
        kind = " | ".join(parameter["choices"]) or parameter["dimension"].replace("_", " ")
        kind = f"list of {kind}s" if parameter["several"] else kind
        needed = "" if parameter["required"] else ", optional"
        lines.append(f"{'':20}  {key}: {parameter['help']} ({kind}{needed})")
    return "\n".join(lines)


def cite(options: argparse.Namespace) -> int:
    from film_model.solve.simulate import simulate_quietly

    print(simulate_quietly(read_scene(options)).citations())
    return DONE


def materials(options: argparse.Namespace) -> int:
    from film_model.base.hardness import VICKERS
    from film_model.base.materials import Material, catalogue, material, search, synonyms
    from film_model.base.units import format_si

    if options.name is not None and options.search is not None:
        raise ValueError("give a name or --search, not both")
    chosen = list(catalogue().values())
    if options.name is not None:
        chosen = [material(options.name)]
    elif options.search is not None and not (chosen := search(options.search)):
        raise ValueError(f"--search: no material's name contains {options.search!r}")
    if options.json:
        rows = [{**{key: getattr(m, key) for key in Material.FIELDS}, "synonyms": synonyms(m.name)} for m in chosen]
        return print_json({"materials": rows})
    if options.name is not None:
        _print_material(chosen[0])
        return DONE
    heads = f"{'name':33}{'E':>10}{'nu':>7}{'density':>14}{'yield':>10}{'hardness':>10}{'n':>8}{'C':>8}"
    print(f'{heads}  main source ("materials NAME" shows all)')
    for m in chosen:
        strength = "-" if m.yield_strength is None else format_si(m.yield_strength, "pressure")
        hardness = "-" if m.hardness is None else f"{m.hardness / VICKERS:.0f} HV"
        density = f"{m.density:g} kg/m3"
        flow = (m.strain_hardening_exponent, m.strain_rate_coefficient)
        exponent, rate = ("-" if value is None else f"{value:g}" for value in flow)
        modulus = format_si(m.youngs_modulus, "pressure")
        print(
            f"{m.name:33}{modulus:>10}{m.poissons_ratio:>7}{density:>14}{strength:>10}{hardness:>10}"
            f"{exponent:>8}{rate:>8}  {m.source.partition('; ')[0]}"
        )
    return DONE


def _print_material(found: Material) -> None:
    """One material, a value on each line, and the sources."""
    from film_model.base.materials import Material, synonyms
    from film_model.base.units import format_si

    print(found.name)
    if words := synonyms(found.name):
        print(f"  {'also called':26}{', '.join(words)}")
    for key, field in Material.FIELDS.items():
        value = getattr(found, key)
        if isinstance(value, float) or value is None:
            text = "not known" if value is None else format_si(value, field.dimension)
            print(f"  {key.replace('_', ' '):26}{text}")
    for source in found.source.split("; "):
        print(f"  {'source':26}{source}")


def new(options: argparse.Namespace) -> int:
    text = SCENE.format(kind=options.kind, target=TARGETS[options.kind])
    if options.output is None:
        print(text, end="")
        return DONE
    check_writable(options.output, options.force)
    write_text(options.output, text)
    print_written(options.output)
    return DONE

"""film-model explain, cite, laws, materials: what applies to a scene, and what there is to choose from."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import film_model.plot as pictures
from film_model.cli.output import DONE, Commands, add_common, add_scene, give, print_json, read_scene

if TYPE_CHECKING:
    from film_model.base.materials import Material
    from film_model.laws import AbstractLaw


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

"""film-model explain, cite, laws, materials: what applies to a scene, and what there is to choose from."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from film_model.cli.output import (
    DONE,
    add_force,
    add_json,
    add_plot,
    check_picture,
    print_json,
    print_warnings,
    print_written,
)

if TYPE_CHECKING:
    from film_model.base.materials import Material
    from film_model.laws import AbstractLaw


def add_commands(named: Any) -> None:
    """The commands and their options."""
    parser: argparse.ArgumentParser = named.add_parser(
        "explain", help="list the effects that a scene requires, with the numbers that decide"
    )
    parser.add_argument("scene", help="scene file (TOML)")
    parser.add_argument("--verbose", action="store_true", help="also indicators, thresholds, costs and sources")
    parser.add_argument("--law", choices=("all",), help="all: also compare what the contact laws predict")
    add_plot(parser, "draw the scene on a map of regimes")
    add_force(parser, "overwrite an existing picture")
    add_json(parser)
    parser.set_defaults(command=explain)

    parser = named.add_parser("laws", help="list the contact laws and their parameters")
    add_json(parser)
    add_plot(parser, "draw all of them")
    add_force(parser, "overwrite an existing picture")
    parser.set_defaults(command=laws)

    parser = named.add_parser("cite", help="print what to cite for a scene, as BibTeX")
    parser.add_argument("scene", help="scene file (TOML)")
    parser.set_defaults(command=cite)

    parser = named.add_parser("materials", help="list the materials of the catalogue, or show one")
    parser.add_argument("name", nargs="?", help="show this one, with the sources of its values")
    parser.add_argument("--search", metavar="WORD", help="list only materials whose name contains this")
    add_json(parser)
    parser.set_defaults(command=materials)


def explain(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.studies import explain as explaining

    check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
    report = explaining.explain(scene, laws=options.law == "all")
    if options.plot:
        from film_model.plot.regimes import plot_regimes

        plot_regimes(scene, options.plot)
    if options.json:
        print_json(report)
    else:
        print(explaining.effects_text(scene, verbose=options.verbose))
        if options.law:
            print("\n" + explaining.laws_text(report["laws"]))
        print_written(options.plot)
    print_warnings(report["warnings"])
    return DONE


def laws(options: argparse.Namespace) -> int:
    from film_model.laws import LAWS
    from film_model.laws.unloading import UNLOADINGS

    if options.plot:
        from film_model.plot.laws import plot_laws

        check_picture(options.plot, options.force)
        plot_laws(options.plot)
        print_written(options.plot)
    rows = [{"name": name, **_law_row(law)} for name, law in LAWS.items()]
    rules = [{"name": name, **_law_row(law)} for name, law in UNLOADINGS.items()]
    if options.json:
        return print_json({"laws": rows, "unloadings": rules})
    for row in rows:
        _print_law(row)
    print('\nRules of unloading for any law without damping, unloading = "..." in [contact]:\n')
    for row in rules:
        _print_law(row)
    return DONE


def _law_row(law: type[AbstractLaw]) -> dict[str, Any]:
    return {
        "summary": law.summary,
        "source": law.source,
        "validity": law.validity,
        "parameters": {
            key: {
                "dimension": p.dimension,
                "choices": list(p.choices),
                "required": p.required,
                "several": p.several,
                "help": p.help,
            }
            for key, p in law.parameters.items()
        },
    }


def _print_law(row: dict[str, Any]) -> None:
    print(f"{row['name']:20}{row['summary']}\n{'':20}{row['source']}\n{'':20}valid: {row['validity']}")
    for key, parameter in row["parameters"].items():
        kind = " | ".join(parameter["choices"]) or parameter["dimension"].replace("_", " ")
        kind = f"list of {kind}s" if parameter["several"] else kind
        needed = "" if parameter["required"] else ", optional"
        print(f"{'':20}  {key}: {parameter['help']} ({kind}{needed})")


def cite(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.solve.simulate import simulate_quietly

    print(simulate_quietly(Scene.from_toml(options.scene)).citations())
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
    heads = f"{'name':33}{'E':>10}{'nu':>7}{'density':>14}{'yield':>10}{'hardness':>10}"
    print(f'{heads}  main source ("materials NAME" shows all)')
    for m in chosen:
        strength = "-" if m.yield_strength is None else format_si(m.yield_strength, "pressure")
        hardness = "-" if m.hardness is None else f"{m.hardness / VICKERS:.0f} HV"
        density = f"{m.density:g} kg/m3"
        modulus = format_si(m.youngs_modulus, "pressure")
        print(
            f"{m.name:33}{modulus:>10}{m.poissons_ratio:>7}{density:>14}{strength:>10}{hardness:>10}"
            f"  {m.source.partition('; ')[0]}"
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

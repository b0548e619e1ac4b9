"""What each command of the command line does; the exit status is returned."""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse

    from film_model.history import History
    from film_model.laws import AbstractLaw

DONE, WRONG, FAILED = 0, 2, 3

MOST_EVENTS = 24
"""Events in a table; JSON and files have all."""


def run(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.solve import simulate

    _check_outputs(options)
    scene = Scene.from_toml(options.scene)
    history = simulate(scene, accuracy=options.accuracy, segments=options.segments, linearisation=options.linearisation)
    if options.output:
        import film_datasets

        dataset = film_datasets.to_dataset(history)
        film_datasets.write(dataset, options.output, overwrite=options.force)
    if options.plot:
        from film_model.plot import plot_history

        plot_history(history, options.plot)
    if options.json:
        _print_json(history.to_json())
    else:
        print(_table(history))
        for path in filter(None, (options.output, options.plot)):
            print(f"wrote {path}", file=sys.stderr)
    for warning in history.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def cost(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.study import FILM, one_thread, study

    _check_outputs(options)
    one_thread()
    scene = Scene.from_toml(options.scene)
    done = study(scene, methods=options.method, progress=lambda name: print(f"timing {name}", file=sys.stderr))
    if not done.runs:
        raise ValueError(
            f"--method: no method begins with {' or '.join(options.method)}; there are {', '.join(FILM)} ..."
        )
    if options.output:
        import film_datasets

        film_datasets.write(film_datasets.to_dataset(done), options.output, overwrite=options.force)
    if options.plot:
        from film_model.plot_study import plot_study

        plot_study(done, options.plot)
    if options.json:
        return _print_json(done.to_json())
    print(f"{scene.title or 'Impact'}\nlaw {done.law}; errors are against {done.reference['method']}\n")
    print(f"{'':26}{'':16}{'error':>10}{'one impact':>14}{'in a batch':>14}{'forces':>9}")
    best = {id(run) for run in done.front()}
    for run in done.runs:
        error = f"{run.error:10.1e}" if run.errors else f"{'-':>10}"
        times = "".join(
            f"{'-' if t is None else f'{1e6 * t.median:.2f} us':>14}" for t in (run.time_single, run.time_batch)
        )
        said = "  *" if id(run) in best else "" if run.outcome == "done" else f"  {run.outcome}"
        print(f"{run.method:26}{run.setting:16}{error}{times}{run.force_evaluations or '-':>9}{said}")
    print("\n* nothing here is better in both error and time of one impact")
    print("\n".join([done.sentence(), *done.beaten()]))
    return DONE


def hard_cases(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.files import written_whole
    from film_model.hard_cases import all_cases, page, report

    if options.markdown:
        _check_writable(options.markdown, options.force)
    reports = []
    chosen = [case for case in all_cases() if options.match in case.name]
    if not chosen:
        raise ValueError(f"--match: no case's name contains {options.match!r}")
    for case in chosen:
        print(f"running {case.name}", file=sys.stderr)
        reports.append(report(case))
    good = all(r.finding.good for r in reports)
    if options.markdown:
        with written_whole(Path(options.markdown)) as beside:
            beside.write_text(page(reports), "utf-8")
    if options.json:
        _print_json({"good": good, "cases": [r.to_json() for r in reports]})
        return DONE if good else FAILED
    print(f"{'':6}{'case':52}{'error':>9}{'allowed':>9}{'segments':>10}{'time':>10}  outcome")
    for r in reports:
        f = r.finding
        numbers = f"{f.error:9.1e}{f.allowed:9.0e}{f.segments or '-':>10}{r.seconds:8.2f} s"
        print(f"{'good' if f.good else 'BAD':6}{r.case.name:52}{numbers}  {f.outcome}")
        for name, said in r.others.items():
            print(f"{'':58}{name}: {said}")
    print(f"{sum(r.finding.good for r in reports)} of {len(reports)} good")
    return DONE if good else FAILED


def explain(options: argparse.Namespace) -> int:
    from film_model import explain as explaining
    from film_model.scene import Scene

    if options.plot:
        _check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
    report = explaining.explain(scene, laws=options.law == "all")
    if options.plot:
        from film_model.plot import plot_regimes

        plot_regimes(scene, options.plot)
    if options.json:
        _print_json(report)
    else:
        print(explaining.effects_text(scene))
        if options.law:
            print("\n" + explaining.laws_text(report["laws"]))
        if options.plot:
            print(f"wrote {options.plot}", file=sys.stderr)
    for warning in report["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def export_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper
    from film_model.scene import Scene
    from film_model.units import to_si

    try:
        gap = to_si(options.initial_gap, "length")
    except ValueError as error:
        raise ValueError(f"--initial-gap: {error}") from None
    path = options.output or f"{options.kind}.fmu"
    _check_writable(path, options.force)
    scene = Scene.from_toml(options.scene)
    fmu_wrapper.export(
        scene,
        path,
        options.fmi,
        kind=options.kind,
        initial_gap=gap,
        platform=options.platform,
        with_sources=options.with_sources,
        overwrite=options.force,
    )
    print(f"wrote {path}", file=sys.stderr)
    return DONE


def check_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper

    report = fmu_wrapper.check(options.fmu)
    if options.json:
        _print_json(report.to_json())
    else:
        for problem in report.problems:
            print(f"wrong      {problem}")
        for finding in report.findings:
            word = "agrees" if finding.good else "differs"
            where = "" if finding.good else f"  at {finding.where}"
            print(f"{word:10} {finding.what:48} {finding.difference:8.1e}, allowed {finding.allowed:.0e}{where}")
        print(f"{report.path}: {'good' if report.good else 'not good'}")
    return DONE if report.good else FAILED


def sweep(options: argparse.Namespace) -> int:
    from film_datasets.progress import Bar
    from film_datasets.report import sweep_report
    from film_datasets.run import run as run_sweep
    from film_datasets.sweeps import Sweep

    asked = Sweep.from_toml(options.sweep, options.keep)
    dataset = run_sweep(
        asked,
        options.output,
        command=f"film-model sweep {options.sweep} --output {options.output} --keep {options.keep}",
        workers=options.workers,
        scheduler=options.scheduler,
        resume=options.resume,
        overwrite=options.force,
        progress=Bar(),
    )
    with dataset:
        report = sweep_report(dataset)
    if options.json:
        _print_json({"output": options.output, **report})
    else:
        print(_sweep_table(report))
        print(f"wrote {options.output}", file=sys.stderr)
    for warning in report["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _sweep_table(report: dict[str, Any]) -> str:
    """How the impacts ended, and the range of every summary quantity."""
    from film_model.history import SUMMARY
    from film_model.units import format_si

    ended = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in report["statuses"].items())
    lines = [report["title"], f"{report['impacts']} impacts: {ended}", ""]
    lines.append(f"  {'':30}{'least':>16}{'mean':>16}{'greatest':>16}")
    for name, row in report["summary"].items():
        cells = (row[key] for key in ("least", "mean", "greatest"))
        texts = ("-" if value is None else format_si(value, SUMMARY[name][0], 5) for value in cells)
        lines.append(f"  {name.replace('_', ' '):30}" + "".join(f"{text:>16}" for text in texts))
    lines += ["", f"  error at most {report['accuracy']['estimated']:.1e} of every value"]
    return "\n".join(lines)


def plot(options: argparse.Namespace) -> int:
    from film_datasets.files import open_dataset
    from film_datasets.pictures import plot as draw

    output = options.output or os.path.splitext(options.file.rstrip("/" + os.sep))[0] + ".png"
    over = [_dataset_name(name) for name in _names(options.over)]
    chosen: dict[str, Any] = {"quantity": options.quantity, "over": over}
    pairs = (pair.partition("=")[::2] for pair in options.at or ())
    with open_dataset(options.file) as dataset:
        _check_writable(output, options.force)
        given = {key: value for key, value in chosen.items() if value}
        draw(dataset, output, **given, at={_dataset_name(key): value for key, value in pairs})
    print(f"wrote {output}", file=sys.stderr)
    return DONE


def _dataset_name(path: str) -> str:
    """What a swept quantity such as impactor.velocity is called in a dataset."""
    return path.replace(".", "_")


def identify(options: argparse.Namespace) -> int:
    from film_datasets import identification
    from film_datasets.measured import from_csv
    from film_model.scene import Scene

    if options.plot:
        _check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
    found = identification.identify(from_csv(options.measured), scene, _names(options.fit), options.confidence)
    if options.plot:
        found.plot(options.plot)
    if options.json:
        _print_json(found.to_json())
    else:
        print(found.table())
        if options.plot:
            print(f"wrote {options.plot}", file=sys.stderr)
    for warning in found.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _names(text: str | None) -> list[str]:
    """Names that are separated by commas."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def _check_writable(path: str, force: bool) -> None:
    """Say before the work what would make it useless after."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{path}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{path}: the folder {folder} cannot be written to")
    if os.path.isdir(path):
        raise IsADirectoryError(f"{path} is a folder, the name of a file is needed")
    if os.path.exists(path) and not force:
        raise FileExistsError(f"{path} exists; use --force to overwrite it")


def _check_outputs(options: argparse.Namespace) -> None:
    """The same of --output and --plot, where they are given."""
    if options.output:
        from pathlib import Path

        from film_datasets.files import check_file

        _check_writable(options.output, options.force)
        check_file(Path(options.output), options.force)
    if options.plot:
        _check_picture(options.plot, options.force)


def _check_picture(path: str, force: bool) -> None:
    from film_model.plot import check_picture

    check_picture(path)
    _check_writable(path, force)


def _table(history: History) -> str:
    """Summary, events and choices as text."""
    from film_model.effects import COMPUTED
    from film_model.history import SUMMARY
    from film_model.units import format_si

    problem, accuracy = history.problem, history.accuracy
    lines = [history.scene.title or "Impact", f"law {problem.law.name}; {history.outcome.value}", ""]
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        lines.append(f"  {name.replace('_', ' '):30}{'-' if value is None else format_si(value, dimension, 6):>16}")
    lines += ["", f"  {'event':24}{'time':>14}{'indentation':>16}{'force':>14}"]
    for event in history.events[:MOST_EVENTS]:
        numbers = (
            f"{format_si(event.time, 'time', 5):>14}{format_si(event.indentation, 'length', 5):>16}"
            f"{format_si(event.contact_force, 'force', 5):>14}"
        )
        what = f"  ({event.stage})" if event.name == "stage_changes" else ""
        lines.append(f"  {event.name.replace('_', ' '):24}{numbers}{what}")
    if len(history.events) > MOST_EVENTS:
        lines.append(f"  and {len(history.events) - MOST_EVENTS} more")
    lines.append("")
    lines += [
        f"  {effect.name.replace('_', ' ')}: {effect.state}; {effect.reason}"
        for effect in problem.effects
        if effect.name in COMPUTED
    ]
    means = f"{accuracy.modes} modes" if accuracy.modes else f"{accuracy.lines} lines"
    lines.append(f"  error at most {accuracy.estimated:.1e} of every value, by {means}")
    return "\n".join(lines)


def laws(options: argparse.Namespace) -> int:
    from film_model.laws import LAWS
    from film_model.laws.unloading import UNLOADINGS

    if options.plot:
        from film_model.plot import plot_laws

        _check_picture(options.plot, options.force)
        plot_laws(options.plot)
        print(f"wrote {options.plot}", file=sys.stderr)
    rows = [{"name": name, **_law_row(law)} for name, law in LAWS.items()]
    rules = [{"name": name, **_law_row(law)} for name, law in UNLOADINGS.items()]
    if options.json:
        return _print_json({"laws": rows, "unloadings": rules})
    for row in rows:
        _print_law(row)
    print('\nof any law, with unloading = "..." in [contact]:\n')
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
        needed = "" if parameter["required"] else ", may be left out"
        print(f"{'':20}  {key}: {parameter['help']} ({kind}{needed})")


def materials(options: argparse.Namespace) -> int:
    from film_model.materials import catalogue
    from film_model.units import format_si

    materials = list(catalogue().values())
    if options.json:
        keys = ("name", "youngs_modulus", "poissons_ratio", "density", "yield_strength", "source")
        return _print_json({"materials": [{key: getattr(m, key) for key in keys} for m in materials]})
    print(f"{'name':28}{'E':>10}{'nu':>7}{'density':>14}{'yield':>10}  source")
    for m in materials:
        strength = "-" if m.yield_strength is None else format_si(m.yield_strength, "pressure")
        density = f"{m.density:g} kg/m3"
        modulus = format_si(m.youngs_modulus, "pressure")
        print(f"{m.name:28}{modulus:>10}{m.poissons_ratio:>7}{density:>14}{strength:>10}  {m.source}")
    return DONE


def _print_json(table: dict[str, Any]) -> int:
    escaped = not (sys.stdout.encoding or "").lower().startswith("utf")
    print(json.dumps(table, indent=2, ensure_ascii=escaped, allow_nan=False))
    return DONE

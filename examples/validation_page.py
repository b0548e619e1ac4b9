"""Write docs/validation.md, its picture, and the errors in docs/understand/choosing_a_law.md.

`python -m examples.validation_page [FOLDER]`.

The laws against the published datasets `measured_impacts` and `finite_element_impacts`, with a section for each kind of
evidence.
Every number is computed here, but for the intervals of the model, which `python -m examples.model_intervals` stores:
run that first when a law or the rows change.
"""

import dataclasses
import itertools
import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

import film_datasets as fd
import film_model as fm
from examples.finite_elements.against_laws import COMPARED, FASTEST, Runs, errors, runs_of
from examples.model_intervals import coverage, coverage_from_others, coverage_of_new_sources, slow_predictions
from examples.reference.validation_inputs import (
    COMPLETE,
    FAST,
    JOHNSON_COOK,
    NEAR,
    ROUGH,
    Spread,
    elastic,
    flow_of,
    hardening,
    inputs_of,
    own_numbers,
    steels,
    with_rate,
    within_input,
)
from film_datasets.evidence import evidence_rows
from film_model.laws import LAWS
from film_model.plot.validation import RESTITUTION as REBOUND
from film_model.plot.validation import plot_validation
from film_model.problem.law_of_scene import YIELDING
from film_model.problem.model_intervals import FAMILIES, residuals_of, stored
from film_model.scene import Solver
from film_model.solve.batch import simulate_many
from film_model.studies.validation import (
    AUTO,
    GROUPS,
    TESTED,
    LawReport,
    Prediction,
    absolute,
    compare,
    error_cell,
    predict,
)
from film_model.studies.validation_rows import Row

DOCS = Path(__file__).parent.parent / "docs"
CHOOSING = DOCS / "understand" / "choosing_a_law.md"
OBLIQUE = Path(__file__).parent / "measurements" / "alumina_on_glass.toml"

SOFT = 200.0
"""Vickers hardness below which a steel counts as soft."""

CLOSE = 0.01
"""Difference within which a tangential restitution counts as met."""

LAST = "small_ball_rebound"
"""The source that came after all choices but the residuals of the intervals."""

GLASS = "louge_glass"
"""The source of single impacts of glass on glass."""

MARKED = re.compile(r"(<!-- errors: .*? -->\n).*?(<!-- end of errors -->)", re.DOTALL)

TEXT = """# Validation

<!-- written by examples/validation_page.py -->

Errors are absolute and in percent, median / worst, as `film-model validate` prints them.

## Measured values

Of {measured} measured values from {sources} sources that can be opened, {complete} from {complete_sources} are
compared, of which sizes, mass, velocity and hardness or stiffness are known. {held_out}, drawn by a hash, are held out:
never used to choose or fit a law, nor for the intervals below.

{families}

{steel} are of steel, nearly all of them rebounds and dents of Leeb hardness testers, balls of tungsten carbide or
diamond at 1.3 to 3 m/s; {conversions} are conversions of hardness or tensile strength. Neighbours in one table, and
conversions of one manufacturer, are not independent. {glass} are single impacts of glass on glass, which scatter by
{scatter:.0f} % around a mean of {mean:.3f}. None are of force, duration, polymers, ice, adhesion, cracks or another
metal; {mild} of steels below {soft_steel:.0f} HV. "Outside": beyond the range that the law names.

| | |
|---|---|
| flow strength | H/2.8, H = 9.80665 HV/0.927 MPa |
| strain rate coefficient (Johnson & Cook 1983) | 0.022 (1006), 0.014 (4340) or 0.012 (S-7) |
| by the nearest flow stress A + B 0.08^n | {flows} MPa |
| without a strength to raise | {unraised} |
| hardness | known within ±10 %: half of a printed range; a number in HV, HB or HRC ±5 % |
| tensile strength without range | ±10 % (Proceq, Equotip 3 operating instructions, p. 22) |
| dents | `dent_diameter`, of `pce_2800` that of the depth where the printed one contradicts it |

Law `auto` with other inputs ("90 %": the error that 90 % of the rows stay within; "signed": the median with its sign):

{inputs}

Beyond 50 yield velocities rebounds are too high. Waves into the half-space, which `auto` leaves out below its
tolerance, are the smaller part; hardening as of the steel whose C the row has takes off more than that.

Two rebounds of an alumina ball at 10 m/s (`{last}`) came after every choice. They point to hardening, too:
errors of {last_rate} % with the rate alone, {last_slow} % without it, {last_both} % with rate and
hardening. {last_inside} of the two lie in intervals of the other sources; those below are made with them.

Signed medians of rebounds, with the rate alone and with hardening too: {soft_rebounds} % of steels below
{soft_steel:.0f} HV, {hard_rebounds} % of harder ones.

More than 10 % wrong on steel with complete conditions: {misses}.

"By name" takes the steel of the catalogue with the nearest Vickers hardness: none from {gap} HV, where {between}
rebounds lie. Of the {known} rows whose hardness is not known within ±10 %, {met} are met by one within its range; for
the others, soft steels of `gbt_50344` up to 360 HLD, the law is too high by up to {highest} %.

![computed over published values, and the distribution of the errors](validation.png)

Of steel of known hardness, by every law:

| law | {heads} | restitution |
|---|{lines}---|
{laws}

{said}

## Finite elements

{runs} [finite-element impacts](finite_elements.md) up to 1000 yield velocities, {left_out} of which law `elastoplastic`
was not fitted to. Laws without hardening take the flow stress at 8 % strain. Permanent indentations are over the
largest.

{finite_elements}

Law "auto" gives the values of `elastoplastic` within 0.05 %.

## Intervals of the model

The ranks of these [intervals](understand/accuracy_and_cost.md#how-far-measurements-lie) of 90 % were chosen after the
coverage had been seen: no blind test.

| held-out rows | in their interval |
|---|---|
| all | {inside} of {held}: {share} %; 90 ± {spread} % of independent rows |
| interval made without the source of the row | {new_inside} of {new} |
| material without a rate law | {slow_inside} of {slow} |

| family | quantity | rows | from, % | to, % | held-out rows inside |
|---|---|---|---|---|---|
{intervals}

## Oblique impacts

[Alumina on glass](oblique.md#alumina-on-glass) (dataset `oblique_impacts`): {close} of {angles} tangential restitutions
are met within {near:g}, spins within {spin} rad/s (of {fastest}), rebound angles within {turn}°.

{oblique}

## Computed for contacts that yield

Johnson's fully plastic impact.

{theory}

## Elastic theories

Hertz's law on a half-space or plate, without waves and losses in the material.

{elastic}

## Every measured value under law "auto"

{rows}

## Measured values with incomplete conditions

In the table of inputs, if the hardness alone is not known within ±10 %.

{incomplete}

## Sources

| source | |
|---|---|
{references}

## A law against its own authors' fit, and values computed with a law

These confirm the implementation, not the law.

{own}
"""


def family_rows(predictions: Sequence[Prediction]) -> str:
    """One line a family and quantity under one law: used and held-out rows apart."""
    lines = ["| family | quantity | rows | outside | all | used | held out |", "|---|---|---|---|---|---|---|"]
    groups = dict.fromkeys((p.family, p.row.quantity) for p in predictions)
    for family, quantity in sorted(groups, key=lambda key: (list(FAMILIES).index(key[0]), key[1])):
        own = [p for p in predictions if (p.family, p.row.quantity) == (family, quantity)]
        parts = (own, [p for p in own if not p.row.held_out], [p for p in own if p.row.held_out])
        cells = (error_cell(absolute(part)) for part in parts)
        counts = f"{len(own)} | {sum(p.outside for p in own)}"
        lines.append(f"| {FAMILIES[family]} | {quantity.replace('_', ' ')} | {counts} | {' | '.join(cells)} |")
    return "\n".join(lines)


def has_strength(law: str) -> bool:
    """Whether rate hardening raises a parameter of the law."""
    return "yield_strength" in (field.name for field in dataclasses.fields(LAWS[law]))


def input_rows(inputs: Mapping[str, Sequence[Prediction]]) -> str:
    """One line an input and quantity under law "auto"."""
    lines = ["| input | values | rows | median | 90 % | within 10 % | worst | signed |", f"|{'---|' * 8}"]
    for name, found in inputs.items():
        kinds = {} if "every steel" in name or FAST in name else {"rebounds": REBOUND, "dents": "dent_diameter"}
        parts = {word: [p for p in found if p.row.quantity == kind] for word, kind in kinds.items()}
        for values, own in {"all": found, **parts}.items():
            if own and (values == "all" or len(own) < len(found)):
                size = Spread.of(own)
                errors = (f"{100 * error:.1f}" for error in (size.median, size.most))
                cells = (
                    f"{' | '.join(errors)} | {100 * size.near:.0f} % | {100 * size.worst:.1f} | {100 * size.bias:+.1f}"
                )
                lines.append(f"| {name} | {values} | {size.rows} | {cells} |")
    return "\n".join(lines)


def interval_rows(predictions: Sequence[Prediction]) -> str:
    """One line a family and quantity with an interval of its own: its ends, and how many held-out rows it covers."""
    lines: list[str] = []
    for found in stored().values():
        if residuals_of(found.family, found.quantity) != found:
            continue
        own = coverage(p for p in predictions if residuals_of(p.family, p.row.quantity) == found)
        ends = (f"{100 * math.expm1(end):+.1f}" for end in (found.low, found.high))
        name, inside = found.quantity.replace("_", " "), f"{own.inside} of {own.rows}"
        lines.append(f"| {FAMILIES[found.family]} | {name} | {found.rows} | {' | '.join(ends)} | {inside} |")
    return "\n".join(lines)


def law_rows(reports: Sequence[LawReport]) -> str:
    """One line a law."""
    lines: list[str] = []
    for report in reports:
        cells = [error_cell(report.errors(where)) for where in shown_groups(reports).values()]
        lines.append(f"| `{report.law}` | {' | '.join(cells)} | {'falls' if report.monotone else 'not monotone'} |")
    return "\n".join(lines)


def shown_groups(reports: Sequence[LawReport]) -> dict[str, Callable[[Row], bool]]:
    """The groups of which there are rows."""
    return {name: where for name, where in GROUPS.items() if reports[0].errors(where)}


def prediction_rows(predictions: Sequence[Prediction]) -> str:
    """One line a value."""
    lines = [
        "| source | quantity | published | computed | error, % | | read from | conditions |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for p in predictions:
        row, marks = p.row, ["outside"] * p.outside + ["held out"] * (p.row.usable and p.row.held_out)
        numbers = f"{row.value:.4g} | {p.value:.4g} | {100 * p.error:.1f} | {', '.join(marks)}"
        name = row.quantity.replace("_", " ")
        lines.append(f"| {row.source} | {name} | {numbers} | {row.sureness} | {row.note} |")
    return "\n".join(lines)


def finite_element_rows(runs: Runs) -> str:
    """One line a law and group of runs up to `FASTEST`, the best law first."""
    lines = [f"| law | runs | {' | '.join(name.replace('_', ' ') for name in COMPARED)} |", "|---" * 7 + "|"]
    found = {name: errors(runs, name) for name in TESTED if name != AUTO}
    slow = ~runs.fast
    groups = {"fitted": slow & ~runs.held_out, "held out": slow & runs.held_out}
    for name in sorted(found, key=lambda law: float(np.median(np.abs(found[law]["coefficient_of_restitution"][slow])))):
        for group, rows in groups.items() if name == YIELDING else [("all", slow)]:
            cells = (error_cell(np.abs(values[rows]).tolist()) for values in found[name].values())
            lines.append(f"| `{name}` | {group} | {' | '.join(cells)} |")
    return "\n".join(lines)


def incomplete_rows(rows: Sequence[Row]) -> str:
    """One line a value that cannot be simulated."""
    lines = ["| source | quantity | published | read from | conditions |", "|---|---|---|---|---|"]
    for row in rows:
        cells = (row.source, row.quantity.replace("_", " "), f"{row.value:.4g}", row.sureness, row.note)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def oblique() -> dict[str, str]:
    """The measured oblique impacts: rows of tangential restitutions, how many are met, and the largest differences."""
    ds, scene = fd.load("oblique_impacts"), fm.Scene.from_toml(OBLIQUE)
    found = simulate_many(scene, {"impactor.angle": ds["impactor_angle"].values}, Solver(1e-8)).oblique
    off = {name: found.summary[name] - ds[name].values for name in ("rebound_spin", "rebound_angle")}
    lines = ["| angle, ° | measured | computed | difference |", "|---|---|---|---|"]
    met = 0
    for angle, value, computed in zip(
        np.degrees(ds["impactor_angle"].values),
        ds["tangential_restitution"].values,
        found.summary["tangential_restitution"],
        strict=True,
    ):
        if value == value:
            met += abs(computed - value) <= CLOSE
            lines.append(f"| {angle:.2f} | {value:.4f} | {computed:.4f} | {computed - value:+.4f} |")
    return {
        "oblique": "\n".join(lines),
        "close": str(met),
        "angles": str(len(lines) - 2),
        "spin": f"{np.nanmax(np.abs(off['rebound_spin'])):.0f}",
        "fastest": f"{np.nanmax(np.abs(ds['rebound_spin'].values)):.0f}",
        "turn": f"{math.degrees(np.nanmax(np.abs(off['rebound_angle']))):.1f}",
    }


def rebounds(rows: Iterable[Row]) -> str:
    """Errors of law "auto", percent."""
    return " and ".join(f"{100 * predict(AUTO, row).error:+.1f}" for row in rows)


def biases(rows: Iterable[Row]) -> str:
    """Signed medians of the errors of law "auto" without and with hardening, percent."""
    plain = list(rows)
    groups = plain, [hardening(row) for row in plain]
    found = (Spread.of(predict(AUTO, row) for row in group).bias for group in groups)
    return " and ".join(f"{100 * bias:+.1f}" for bias in found)


def page() -> tuple[str, list[LawReport]]:
    """The page, and the reports for the picture."""
    ds = fd.load("measured_impacts")
    rows = evidence_rows(ds)
    reports = compare(rows)
    auto = reports[0]
    found = [p for p in auto.predictions if p.row.usable]
    computed = [p for p in auto.predictions if not p.row.usable]
    measured = [row for row in rows if row.kind == "measured"]
    usable = [row for row in measured if row.usable]
    runs = runs_of(fd.load("finite_element_impacts"))
    slow = ~runs.fast
    covered, new = coverage(found), coverage_of_new_sources(found)
    soft = slow_predictions(rows)
    without, (met, known) = coverage(soft), within_input(rows)
    inputs, hardness = inputs_of(rows), list(steels().values())
    last = [row for row in usable if row.source == LAST]
    bounced = [row for row in usable if row.of_steel and row.quantity == REBOUND]
    panes = [row.value for row in usable if row.source == GLASS]
    low, high = max(itertools.pairwise(hardness), key=lambda ends: ends[1] / ends[0])
    flows = ", ".join(f"{flow_of(name) / 1e6:.0f}" for name in JOHNSON_COOK)
    heads = list(shown_groups(reports))
    said = [f"`{report.law}`: restitution rises with velocity, {rise}." for report in reports for rise in report.rises]
    lines = str(ds.attrs["sources"]).split("\n")
    text = TEXT.format(
        measured=len(measured),
        sources=len({row.source for row in measured}),
        complete=len(usable),
        complete_sources=len({row.source for row in usable}),
        held_out=sum(row.held_out for row in usable),
        conversions=sum(row.sureness == "conversion" for row in usable),
        steel=sum(row.of_steel for row in usable),
        glass=len(panes), scatter=100 * np.std(panes, ddof=1) / np.mean(panes), mean=np.mean(panes),
        mild=sum((row.hardness or math.inf) < SOFT for row in usable),
        soft_steel=SOFT,
        families=family_rows(found),
        flows=flows,
        unraised=", ".join(f"`{name}`" for name in TESTED if name != AUTO and not has_strength(name)),
        misses=", ".join(f"{p.row.note} ({100 * p.error:+.0f} %)" for p in inputs[COMPLETE] if abs(p.error) > NEAR),
        gap=f"{low:.0f} to {high:.0f}",
        between=sum(low < (p.row.hardness or 0.0) < high for p in found if p.row.quantity == REBOUND),
        inputs=input_rows(inputs),
        known=known, met=met,
        last=LAST, last_rate=rebounds(last), last_slow=rebounds(with_rate(row, None) for row in last),
        last_both=rebounds(hardening(row) for row in last),
        last_inside=coverage_from_others(found, found, LAST).inside,
        soft_rebounds=biases(row for row in bounced if (row.hardness or 0.0) < SOFT),
        hard_rebounds=biases(row for row in bounced if (row.hardness or 0.0) >= SOFT),
        highest=f"{100 * max(p.error for p in inputs[ROUGH]):.0f}",
        heads=" | ".join(heads), lines="---|" * len(heads),
        laws=law_rows(reports),
        said="\n".join(said),
        held=covered.rows, inside=covered.inside,
        new_inside=new.inside, new=new.rows,
        share=f"{100 * covered.share:.0f}",
        spread=f"{100 * covered.spread:.0f}",
        intervals=interval_rows([*found, *soft]),
        slow=without.rows, slow_inside=without.inside,
        runs=int(np.count_nonzero(slow)),
        left_out=int(np.count_nonzero(slow & runs.held_out)),
        finite_elements=finite_element_rows(runs),
        near=CLOSE, **oblique(),
        theory=prediction_rows(computed),
        elastic=prediction_rows(elastic(rows)),
        rows=prediction_rows(found),
        incomplete=incomplete_rows([row for row in measured if not row.complete]),
        references="\n".join(f"| `{word}` | {said} |" for word, _, said in (line.partition(": ") for line in lines)),
        own=prediction_rows(own_numbers(rows)),
    )  # fmt: skip
    return text, reports


def how_sure(reports: Sequence[LawReport]) -> str:
    """Errors of the laws as Markdown: on measured rebounds of yielding steel, on dents, and on finite elements."""
    runs = runs_of(fd.load("finite_element_impacts"))
    kinds = {"rebound": ("coefficient_of_restitution",), "dent": ("dent_diameter", "permanent_indentation")}
    counts = [sum(p.row.of_steel and p.row.quantity in own for p in reports[0].predictions) for own in kinds.values()]
    lines = [
        "Median and largest error in percent, of measured values on steel of known hardness and of finite",
        f"elements up to {FASTEST:.0f} yield velocities, to part of which `elastoplastic` was fitted:",
        "",
        f"| law | {counts[0]} measured rebounds | {counts[1]} measured dents | restitution, finite elements |",
        "|---|---|---|---|",
    ]
    for report in reports:
        groups = (report.errors(lambda row, own=own: row.of_steel and row.quantity in own) for own in kinds.values())
        cells = list(map(error_cell, groups))
        restitution = np.abs(errors(runs, report.law)["coefficient_of_restitution"][~runs.fast])
        lines.append(f"| `{report.law}` | {' | '.join(cells)} | {error_cell(restitution.tolist())} |")
    return "\n".join(lines)


def main(folder: Path = DOCS) -> tuple[Path, Path, Path]:
    """Write the page, the picture, and the errors on the page about the choice of a law; returns the paths."""
    text, reports = page()
    choosing = folder / CHOOSING.relative_to(DOCS)
    choosing.parent.mkdir(exist_ok=True)
    told = MARKED.sub(lambda found: f"{found[1]}{how_sure(reports)}\n{found[2]}", CHOOSING.read_text("utf-8"))
    choosing.write_text(told, encoding="utf-8")
    (folder / "validation.md").write_text(text, encoding="utf-8")
    plot_validation(reports, folder / "validation.png", dpi=80.0)
    return folder / "validation.md", folder / "validation.png", choosing


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:])):
        print(path)

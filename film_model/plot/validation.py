"""Pictures of the comparison of laws with measured and computed values."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, HIGHLIGHT, picture
from film_model.studies.validation import AUTO, GROUPS, LawReport

OTHERS = tuple(colour for colour in COLOURS if colour != HIGHLIGHT)
RESTITUTION = "coefficient_of_restitution"
MARKS = {"measured": "o", "finite_element": "s", "theory": "^"}


def plot_validation(
    reports: Sequence[LawReport], path: str | os.PathLike[str] | None = None, dpi: float = 200.0
) -> Figure:
    """Computed over published value for every row and law, of restitution and of dents; right: the distribution of the
    errors of each law."""

    def draw(figure: Figure) -> None:
        from matplotlib.ticker import LogLocator

        figure.set_layout_engine("constrained")
        figure.suptitle("Contact laws compared with published values", fontsize=11, fontweight="bold")
        *left, right = figure.subplots(1, 3, width_ratios=(3, 2, 3))
        for panel, restitution in zip(left, (True, False), strict=True):
            for k, report in _drawn(reports):
                _points(panel, report, _colour(report, k), restitution)
            panel.axhline(1.0, color="0.3", linewidth=0.8)
            what = "coefficient of restitution" if restitution else "dent, mm"
            panel.set(xscale="log", ylim=(0.4, 1.8), xlabel=f"published {what}")
            panel.xaxis.set_major_formatter("{x:g}")
            panel.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
            panel.xaxis.set_minor_formatter("{x:g}")
        left[0].set_ylabel("computed over published value")
        _legend(figure, reports)
        errors: list[Any] = [[100 * error for error in report.errors()] for report in reports]
        right.boxplot(errors, orientation="horizontal", whis=(0, 100))
        names = [f"{report.law}{'' if report.monotone else ' (not monotone)'}" for report in reports]
        right.set_yticks(range(1, len(names) + 1), names)
        right.invert_yaxis()
        right.set(xscale="symlog", xlabel="absolute error, %")
        right.xaxis.set_major_formatter("{x:g}")
        for k, report in enumerate(reports):
            own = [100 * error for error in report.errors(GROUPS["measured"])]
            right.plot(own, [k + 1] * len(own), "o", markersize=3.0, color=HIGHLIGHT)

    return picture(path, draw, (11.0, 5.0), dpi)


def _points(panel: Any, report: LawReport, colour: str, restitution: bool) -> None:
    """The values of one law: coefficients of restitution, or dents in mm."""
    first = report.law == AUTO
    rows = [p for p in report.predictions if p.value == p.value and (p.row.quantity == RESTITUTION) == restitution]
    for kind, mark in MARKS.items():
        found = [p for p in rows if p.row.kind == kind]
        values = [p.row.value * (1.0 if restitution else 1e3) for p in found]
        style: Any = {"linestyle": "", "marker": mark, "markersize": 5.0 if first else 3.0, "color": colour}
        panel.plot(values, [1.0 + p.error for p in found], **style, alpha=1.0 if first else 0.45)


def _drawn(reports: Sequence[LawReport]) -> list[tuple[int, LawReport]]:
    """The laws in the order in which they are drawn: that of "auto" on top."""
    return list(enumerate(reversed(reports)))


def _colour(report: LawReport, place: int) -> str:
    return HIGHLIGHT if report.law == AUTO else OTHERS[place % len(OTHERS)]


def _legend(figure: Figure, reports: Sequence[LawReport]) -> None:
    """Below the panels: the colours of the laws, and the marks of the kinds of values."""
    from matplotlib.lines import Line2D

    keys: list[tuple[str, Any]] = [
        (report.law, {"marker": "o", "color": _colour(report, k)}) for k, report in reversed(_drawn(reports))
    ]
    keys += [(name.replace("_", " "), {"marker": mark, "color": "0.4"}) for name, mark in MARKS.items()]
    handles = [Line2D([], [], linestyle="", label=label, **style) for label, style in keys]
    figure.legend(handles=handles, loc="outside lower left", ncols=6, frameon=False, fontsize=8)

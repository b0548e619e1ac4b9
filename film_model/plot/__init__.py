"""Pictures, by matplotlib: histories, bounces, chains, contact laws, regimes, cost of accuracy.

`style` holds what they share.

A function is imported when it is first used, with what it needs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from film_model.plot.bounces import plot_bounces
    from film_model.plot.chain import plot_chain
    from film_model.plot.cost import plot_studies, plot_study
    from film_model.plot.history import plot_history
    from film_model.plot.laws import plot_laws
    from film_model.plot.regimes import plot_regimes
    from film_model.plot.strobe import plot_strobe
    from film_model.plot.style import check_picture, picture_style

_HOMES = {
    "plot_bounces": "bounces",
    "plot_chain": "chain",
    "plot_studies": "cost",
    "plot_study": "cost",
    "plot_history": "history",
    "plot_laws": "laws",
    "plot_regimes": "regimes",
    "plot_strobe": "strobe",
    "check_picture": "style",
    "picture_style": "style",
}

__all__ = [
    "check_picture",
    "picture_style",
    "plot_bounces",
    "plot_chain",
    "plot_history",
    "plot_laws",
    "plot_regimes",
    "plot_strobe",
    "plot_studies",
    "plot_study",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)

"""Pictures, by matplotlib: histories, bounces, chains, contact laws, regimes, cost of accuracy.

`style` holds what they share.

A function is imported when it is first used, with what it needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import late_names

if TYPE_CHECKING:
    from film_model.plot.bounces import plot_bounces as plot_bounces
    from film_model.plot.chain import plot_chain as plot_chain
    from film_model.plot.cost import plot_studies as plot_studies
    from film_model.plot.cost import plot_study as plot_study
    from film_model.plot.history import plot_history as plot_history
    from film_model.plot.laws import plot_laws as plot_laws
    from film_model.plot.regimes import plot_regimes as plot_regimes
    from film_model.plot.strobe import plot_strobe as plot_strobe
    from film_model.plot.style import check_picture as check_picture
    from film_model.plot.style import picture_style as picture_style

__getattr__ = late_names(
    __name__,
    {
        **{"bounces": ("plot_bounces",), "chain": ("plot_chain",), "cost": ("plot_studies", "plot_study")},
        **{"history": ("plot_history",), "laws": ("plot_laws",), "regimes": ("plot_regimes",)},
        **{"strobe": ("plot_strobe",), "style": ("check_picture", "picture_style")},
    },
)

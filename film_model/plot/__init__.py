"""Pictures, by matplotlib: histories, contact laws, regimes, cost of accuracy; `style` holds what they share."""

from film_model.plot.cost import plot_studies, plot_study
from film_model.plot.history import plot_history
from film_model.plot.laws import plot_laws
from film_model.plot.regimes import plot_regimes
from film_model.plot.style import check_picture, picture_style

__all__ = ["check_picture", "picture_style", "plot_history", "plot_laws", "plot_regimes", "plot_studies", "plot_study"]

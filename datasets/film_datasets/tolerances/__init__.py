"""How the scatter of a scene's numbers spreads the results: linearly, by sampling, and which number causes it."""

from film_datasets.tolerances.analysis import Spread, Tolerance, tolerance, tolerance_of
from film_datasets.tolerances.one_at_a_time import Swing, one_at_a_time

__all__ = ["Spread", "Swing", "Tolerance", "one_at_a_time", "tolerance", "tolerance_of"]

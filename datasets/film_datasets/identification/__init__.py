"""Identification: parameters of a scene from a measurement, with confidence intervals."""

from film_datasets.identification.comparison import LawFit, compare_laws, comparison_table
from film_datasets.identification.least_squares import identify
from film_datasets.identification.likelihood import log_likelihood
from film_datasets.identification.result import FittedParameter, Identification

__all__ = [
    "FittedParameter",
    "Identification",
    "LawFit",
    "compare_laws",
    "comparison_table",
    "identify",
    "log_likelihood",
]

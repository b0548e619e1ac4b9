"""Identification: parameters of a scene, or the contact force, from a measurement, with confidence intervals."""

from film_datasets.identification.comparison import LawFit, compare_laws, comparison_table
from film_datasets.identification.contact_force import IdentifiedForce, identify_force
from film_datasets.identification.least_squares import identify
from film_datasets.identification.likelihood import log_likelihood
from film_datasets.identification.result import FittedParameter, Identification

__all__ = [
    "FittedParameter",
    "Identification",
    "IdentifiedForce",
    "LawFit",
    "compare_laws",
    "comparison_table",
    "identify",
    "identify_force",
    "log_likelihood",
]

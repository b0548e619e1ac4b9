"""The schema of our datasets: their variables and attributes, the hash of their content, and the check against both."""

from film_datasets.schema.content_hash import ContentHash, content_sha256, pieces
from film_datasets.schema.tables import (
    ATTRIBUTES,
    BRANCHES,
    COST,
    HISTORY,
    IMPACT_STATUSES,
    MEASUREMENT,
    OUT_OF_RANGE,
    SWEEP,
    TABLE,
    VERSIONS,
    has_failed,
    kind_of,
    sweep_variables,
    variables_of,
)
from film_datasets.schema.validation import validate
from film_datasets.schema.variable import (
    Variable,
    dimension_of,
    dimension_of_unit,
    flag_meanings,
    flag_words,
    swept_name,
    swept_variable,
)

__all__ = [
    "ATTRIBUTES",
    "BRANCHES",
    "COST",
    "HISTORY",
    "IMPACT_STATUSES",
    "MEASUREMENT",
    "OUT_OF_RANGE",
    "SWEEP",
    "TABLE",
    "VERSIONS",
    "ContentHash",
    "Variable",
    "content_sha256",
    "dimension_of",
    "dimension_of_unit",
    "flag_meanings",
    "flag_words",
    "has_failed",
    "kind_of",
    "pieces",
    "sweep_variables",
    "swept_name",
    "swept_variable",
    "validate",
    "variables_of",
]

"""The schema of our datasets: their variables and attributes, the hash of their content, and the check against both."""

# ruff: noqa: F401
# pyright: reportUnusedImport=false

from film_datasets.schema.content_hash import ContentHash, content_sha256, pieces
from film_datasets.schema.derivative_variables import (
    accuracy_name,
    derivative_name,
    derivative_variables,
    differentiated,
    side_name,
)
from film_datasets.schema.motion_variables import EQUATIONS_ON_MODES, MODE_ENERGY, RAGGED, SHARED, WIDE, branch_words
from film_datasets.schema.rows import BRANCHES, IMPACT_STATUSES, MEASURED_MOTION, OUT_OF_RANGE
from film_datasets.schema.sensor_variables import FORCE_INTERVAL, peak_name, peak_variables
from film_datasets.schema.tables import (
    ADDED,
    ATTRIBUTES,
    BOUNCES,
    CHAIN,
    CHOOSABLE,
    CONSTANTS,
    COST,
    HISTORY,
    MEASURED_CONDITIONS,
    MEASUREMENT,
    SCENE_KEY,
    SWEEP,
    TABLE,
    VERSIONS,
    has,
    has_failed,
    kind_of,
    require,
    require_impacts,
    sweep_variables,
    variables_of,
)
from film_datasets.schema.validation import validate
from film_datasets.schema.variable import (
    TEXT,
    Variable,
    dimension_of,
    dimension_of_unit,
    flag_meanings,
    flag_words,
    holds_text,
    swept_name,
    swept_variable,
    swept_words,
    words_of,
)

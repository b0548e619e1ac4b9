"""One figure of an impact: force, indentation and velocities over time, and the force-indentation loop."""

from __future__ import annotations

import contextlib
import io
import math
import os
import secrets
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import Body
from film_model.history import History, Samples
from film_model.units import format_si, si_unit

FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}

SAMPLES = 1001
"""Even samples over the contact; a line of a paper's width shows no corner."""

COLOURS = ("#3f90da", "#ffa90e", "#bd1f01", "#832db6", "#a96b59", "#e76300", "#b9ac70", "#717581", "#92dadd")
"""Of the law's stages: Petroff's ten colours (arXiv:2107.02270), colour-blind safe, without the grey of unloading."""

UNLOADING = "#94a4a2"

LABELS = {
    "stage_changes": "{stage}",
    "maximum_indentation": "deepest",
    "impactor_stops": "impactor stops",
    "contact_ends": "contact ends",
    "reloading_begins": "reloading",
}

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}

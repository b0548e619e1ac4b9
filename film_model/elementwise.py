"""Formulas that serve one impact and many: a float stays a float, arrays are taken element by element."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def root(x: Any) -> Any:
    """√x."""
    return np.sqrt(x) if isinstance(x, np.ndarray) else math.sqrt(x)


def lesser(a: Any, b: Any) -> Any:
    """The smaller of two."""
    return np.minimum(a, b) if isinstance(a, np.ndarray) or isinstance(b, np.ndarray) else min(a, b)


def either(condition: Any, a: Any, b: Any) -> Any:
    """a where the condition holds, else b."""
    return np.where(condition, a, b) if isinstance(condition, np.ndarray) else a if condition else b


def endless(x: Any) -> bool:
    """Whether x is infinite; an array never is as a whole."""
    return not isinstance(x, np.ndarray) and math.isinf(x)

"""Processor times: repeated timing loops on one processor, and the machine they were measured on."""

from __future__ import annotations

import math
import os
import platform
import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

SHORTEST, MOST_TIME = 2e-3, 0.15
"""Shortest timing loop [s], and time for all loops of a setting [s]."""

PACKAGES = ("film-model", "numpy", "scipy", "numba", "scikit-sundae", "heyoka")


class Timing(NamedTuple):
    """Median and half the interquartile range of the seconds per call."""

    median: float
    spread: float


def timed(call: Callable[[], object]) -> Timing:
    """Seconds of processor time per call, other programs left out: median over loops after a warm-up.

    A call of more than LONG is timed once, with no spread.
    """
    once = _seconds(call)
    if once > 0.5:  # long enough to be timed once
        return Timing(once, 0.0)
    once = max(_seconds(call), 1e-9)
    calls = max(1, math.ceil(SHORTEST / once))
    repeats = max(3, min(25, int(MOST_TIME / (calls * once))))
    found = [_seconds(call, calls) / calls for _ in range(repeats)]
    lower, _, upper = statistics.quantiles(found, n=4)
    return Timing(statistics.median(found), 0.5 * (upper - lower))


def _seconds(call: Callable[[], object], times: int = 1) -> float:
    begun = time.process_time()
    for _ in range(times):
        call()
    return time.process_time() - begun


def one_thread() -> None:
    """Bind this process and the libraries it calls to one processor, if the system supports it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def machine() -> dict[str, str]:
    """Processor, system and package versions."""
    from importlib.metadata import PackageNotFoundError, version  # lazy: it takes a tenth of `import film_datasets`

    found = {"machine": platform.machine(), "system": platform.system(), "python": platform.python_version()}
    found["processor"] = _processor()
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "unknown")
    except OSError:
        return platform.processor() or "unknown"

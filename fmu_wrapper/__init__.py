"""Impacts as FMUs (FMI 2.0 and 3.0): `export` a scene, `run` the FMU, `check` it against the library."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmu_wrapper.assumptions import served
    from fmu_wrapper.checking import Report, check
    from fmu_wrapper.cosimulation import run
    from fmu_wrapper.exporting import export

_HOMES = {
    "Report": "fmu_wrapper.checking",
    "check": "fmu_wrapper.checking",
    "export": "fmu_wrapper.exporting",
    "run": "fmu_wrapper.cosimulation",
    "served": "fmu_wrapper.assumptions",
}

__all__ = ["Report", "check", "export", "run", "served"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value

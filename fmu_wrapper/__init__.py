"""Impacts as FMUs (FMI 2.0 and 3.0): `export` a scene, `run` and `check` the FMU; `export_ssp` for systems."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmu_wrapper.assumptions import served
    from fmu_wrapper.checking import Report, check
    from fmu_wrapper.cosimulation import run
    from fmu_wrapper.exporting import export
    from fmu_wrapper.ssp import Package, export_ssp

_HOMES = {
    "Package": "fmu_wrapper.ssp",
    "Report": "fmu_wrapper.checking",
    "check": "fmu_wrapper.checking",
    "export": "fmu_wrapper.exporting",
    "export_ssp": "fmu_wrapper.ssp",
    "run": "fmu_wrapper.cosimulation",
    "served": "fmu_wrapper.assumptions",
}

__all__ = ["Package", "Report", "check", "export", "export_ssp", "run", "served"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value

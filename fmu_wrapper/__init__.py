"""Impacts as FMUs (FMI 2.0 and 3.0): `export` a scene, `run` the FMU, `check` it against the library."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmu_wrapper.assumptions import served
    from fmu_wrapper.check import Report, check
    from fmu_wrapper.cosimulation import run
    from fmu_wrapper.export import export

_HOMES = {
    "Report": "fmu_wrapper.check",
    "check": "fmu_wrapper.check",
    "export": "fmu_wrapper.export",
    "run": "fmu_wrapper.cosimulation",
    "served": "fmu_wrapper.assumptions",
}

__all__ = ["Report", "check", "export", "run", "served"]


class _Face(ModuleType):
    """This package. Importing a file sets the attribute of its name, where `check` and `export` stay functions."""

    def __setattr__(self, name: str, value: object) -> None:
        named_like_its_file = isinstance(value, ModuleType) and name in _HOMES
        super().__setattr__(name, getattr(value, name) if named_like_its_file else value)


sys.modules[__name__].__class__ = _Face


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value

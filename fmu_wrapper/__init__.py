"""Impacts as FMUs (FMI 2.0 and 3.0): `export` a scene, `run` and `check` the FMU; `export_ssp` for systems."""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import late_names

if TYPE_CHECKING:
    from fmu_wrapper.assumptions import served as served
    from fmu_wrapper.checking import Report as Report
    from fmu_wrapper.checking import check as check
    from fmu_wrapper.cosimulation import run as run
    from fmu_wrapper.exporting import export as export
    from fmu_wrapper.ssp import Package as Package
    from fmu_wrapper.ssp import export_ssp as export_ssp

__getattr__ = late_names(
    __name__,
    {
        **{"assumptions": ("served",), "checking": ("Report", "check"), "cosimulation": ("run",)},
        **{"exporting": ("export",), "ssp": ("Package", "export_ssp")},
    },
)

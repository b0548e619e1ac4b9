"""Types of libraries that are imported only where they are used."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas as pd
    import xarray as xr

Dataset: TypeAlias = "xr.Dataset"
DataArray: TypeAlias = "xr.DataArray"
DataFrame: TypeAlias = "pd.DataFrame"
Figure: TypeAlias = "matplotlib.figure.Figure"

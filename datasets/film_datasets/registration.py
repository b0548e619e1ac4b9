"""The registration of the accessor `ds.film`: at once if xarray is imported already, else as soon as it is.

xarray knows an accessor only once it is registered, and a user may open a file with xarray itself after importing this
package, so that no function of this package is called first.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING

from film_model.base.foreign import Dataset

if TYPE_CHECKING:
    from film_datasets.accessor import Film

XARRAY = "xarray"


def register_accessor() -> None:
    """Let every `xarray.Dataset` have the accessor `film`."""
    if XARRAY in sys.modules:
        _register()
    else:
        sys.meta_path.insert(0, _Finder())


def _register() -> None:
    import xarray as xr

    xr.register_dataset_accessor("film")(_film)


def _film(ds: Dataset) -> Film:
    """The accessor, which is imported when it is first used."""
    from film_datasets.accessor import Film

    return Film(ds)


class _Finder(MetaPathFinder):
    """Finds xarray where the other finders do; its import registers the accessor and removes this finder."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != XARRAY:
            return None
        found = (finder.find_spec(fullname, path, target) for finder in sys.meta_path if finder is not self)
        spec = next(filter(None, found), None)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                sys.meta_path.remove(self)
                _register()

            spec.loader.exec_module = execute_and_register
        return spec

"""The core's summaries of many impacts, by the names of native.Summary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from film_model.core.native import SUMMARY_DTYPE


class Columns:
    """Summaries of many impacts: one array per value. table: of SUMMARY_DTYPE, or arrays by these names."""

    __slots__ = ("table",)

    def __init__(self, table: Any) -> None:
        self.table = table

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return self.table

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


for _name in SUMMARY_DTYPE.names or ():  # properties, which take a third of the time of __getattr__
    setattr(Columns, _name, property(lambda columns, name=_name: columns.table[name]))

"""The variables of a sweep's derivatives: of each summary value by each number of the scene that was asked for."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial

from film_datasets.schema.variable import BYTE, FLOAT, Variable, swept_name
from film_model.base.foreign import Dataset
from film_model.problem.summary import SUMMARY

SIDES = ((-1, "of_smaller_values"), (0, "of_both_sides"), (1, "of_larger_values"), (2, "none"))


def derivative_name(quantity: str, path: str) -> str:
    """The variable of a derivative: d_maximum_force_d_impactor_velocity."""
    return f"d_{quantity}_d_{swept_name(path)}"


def accuracy_name(path: str) -> str:
    """The variable of the estimated error of the derivatives by a number."""
    return f"derivative_accuracy_{swept_name(path)}"


def side_name(path: str) -> str:
    """The variable that says from which side the derivatives by a number are."""
    return f"derivative_side_{swept_name(path)}"


def derivative_variables(
    path: str, unit_of: Callable[[str], str | None], chosen: Collection[str], dims: tuple[str, ...]
) -> tuple[Variable, ...]:
    """The variables for one number of the scene. unit_of: the unit of the derivative of a summary value. chosen: the
    summary values, all if empty."""
    by = path.replace(".", ", ").replace("_", " ")
    slopes = (
        Variable(
            *(
                derivative_name(name, path),
                dims,
                FLOAT,
                unit_of(name),
                f"derivative of {name.replace('_', ' ')} by {by}",
            ),
            comment="decisions about effects held fixed; NaN at a kink, or if there is no value",
            optional=True,
        )
        for name in SUMMARY
        if not chosen or name in chosen
    )
    error = Variable(
        *(accuracy_name(path), dims, FLOAT, "1", f"estimated relative error of the derivatives by {by}"),
        comment="relative to the larger of the derivative and the value over the number; NaN if there is none",
        optional=True,
    )
    side = Variable(
        *(side_name(path), dims, BYTE, None, f"side of the derivatives by {by}"),
        comment="one side: on the other the contact ends otherwise or reaches another stage of its law",
        flags=SIDES,
    )
    return (*slopes, error, side)


def derivatives_in(ds: Dataset, dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of the derivatives that a dataset says it has; their units are those in the dataset."""

    def unit(path: str, quantity: str) -> str | None:
        name = derivative_name(quantity, path)
        return ds.variables[name].attrs.get("units") if name in ds.variables else None

    chosen = str(ds.attrs.get("variables", "")).split()
    paths = differentiated(ds)
    return tuple(v for path in paths for v in derivative_variables(path, partial(unit, path), chosen, dims))


def differentiated(ds: Dataset) -> list[str]:
    """The numbers by which the summary of a sweep is differentiated."""
    return str(ds.attrs.get("derivatives", "")).split()

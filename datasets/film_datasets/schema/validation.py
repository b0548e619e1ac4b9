"""The check of a dataset against the schema."""

from __future__ import annotations

import hashlib

import numpy as np

from film_datasets.schema.content_hash import content_sha256, pieces
from film_datasets.schema.motion_variables import RAGGED, SHARED
from film_datasets.schema.tables import ADDED, ATTRIBUTES, MEASUREMENT, TABLE, VERSIONS, kind_of, variables_of
from film_datasets.schema.variable import FLOAT, TEXT, Variable, flag_meanings, holds_text
from film_model.base.foreign import DataArray, Dataset


def validate(ds: Dataset) -> list[str]:
    """Every difference between `ds` and the schema, one sentence each; an empty list if it matches.

    >>> fd.validate(fd.load("zener"))
    []
    """
    try:
        kind = kind_of(ds)
    except ValueError as error:
        return [str(error)]
    if kind == MEASUREMENT and f"{kind} {ds.attrs.get('measured')}" not in TABLE:
        return [
            f"attribute measured is {ds.attrs.get('measured')!r}, not 'history', 'impacts', 'values', "
            "'finite_elements' or 'finite_element_pairs'"
        ]
    variables = variables_of(ds)
    found = [f"attribute {name} is missing" for name in ATTRIBUTES[kind] if name not in ds.attrs]
    version = ds.attrs.get("film_model_schema_version", VERSIONS[kind])
    if version not in ADDED[kind]:
        found.append(f"attribute film_model_schema_version is {version!r}, not {VERSIONS[kind]!r}")
    known = {variable.name for variable in variables}
    found += [f"variable {name} is not in the schema" for name in ds.variables if name not in known]
    for variable in variables:
        if variable.name not in ds.variables:
            found.append(f"variable {variable.name} is missing")
        else:
            found += [f"variable {variable.name}: {what}" for what in _differences(variable, ds[variable.name])]
    return found or _inconsistencies(ds)


def _differences(variable: Variable, array: DataArray) -> list[str]:
    """Differences between an array and its variable in the schema."""
    kinds = (holds_text(array), array), (variable.dtype == TEXT, variable)
    found = [
        f"{what} {got!r}, not {want!r}"
        for what, got, want in (
            ("dimensions", array.dims, variable.dims),
            ("type", *("text" if is_text else of.dtype.name for is_text, of in kinds)),
            *((key, array.attrs.get(key), variable.attributes().get(key)) for key in ("units", "long_name", "comment")),
        )
        if got != want
    ]
    values = np.atleast_1d(array.attrs.get("flag_values", [])).tolist()
    meanings = flag_meanings(array)
    pairs = tuple(zip(values, meanings, strict=False))
    own = pairs[: len(variable.flags)] if variable.more else pairs
    if own != variable.flags or len(values) != len(meanings):
        found.append(f"flags {values} {meanings}, not {dict(variable.flags)}")
    elif values and not all(np.isin(piece, values).all() for piece in pieces(array)):
        found.append("values that are not in flag_values")
    if array.dtype == FLOAT and not variable.optional and not all(np.isfinite(p).all() for p in pieces(array)):
        found.append("values that are not finite")
    return found


def damage(ds: Dataset, values: bool = True) -> list[str]:
    """What does not match the hashes that were stored with it, texts and, if `values`, numbers; and units that are not
    those of the schema. Raises ValueError if a variable is missing."""
    checks: dict[str, bool] = {}
    if values:
        checks["content_sha256 does not match the variables"] = ds.attrs.get("content_sha256") == content_sha256(ds)
    for name in ("scene", "sweep"):
        if f"{name}_toml" in ds.attrs:
            text = str(ds.attrs[f"{name}_toml"]).encode()
            good = ds.attrs.get(f"{name}_sha256") == hashlib.sha256(text).hexdigest()
            checks[f"{name}_sha256 does not match {name}_toml"] = good
    for variable in variables_of(ds):
        if variable.name in ds.variables:
            got, want = ds[variable.name].attrs.get("units"), variable.attributes().get("units")
            checks[f"units of {variable.name} are {got!r}, not {want!r}"] = got == want
    return [message for message, good in checks.items() if not good]


def _inconsistencies(ds: Dataset) -> list[str]:
    """Contradictions within a dataset that has every variable and attribute."""
    checks = dict.fromkeys(damage(ds), False)
    if "t" in ds.variables:
        checks["t does not increase"] = bool((np.diff(ds["t"].values) > 0).all())
    if "event_time" in ds.variables:
        checks["an event_time is not on t"] = bool(np.isin(ds["event_time"].values, ds["t"].values).all())
    for dim in RAGGED:
        if f"{dim}_count" in ds.variables:
            checks |= _places(ds, dim)
    return [message for message, good in checks.items() if not good]


def _places(ds: Dataset, dim: str) -> dict[str, bool]:
    """Whether the rows of the impacts of a sweep follow each other along a dimension or, if shared, are there."""
    end, good = 0, True
    for begins, counts in zip(pieces(ds[f"{dim}_begin"]), pieces(ds[f"{dim}_count"]), strict=True):
        begin, ends = np.ravel(begins), np.ravel(begins) + np.ravel(counts)
        if dim in SHARED:
            good, end = good and bool((begin >= 0).all()), max(end, int(ends.max(initial=0)))
            continue
        after = end + np.cumsum(counts, dtype=np.int64)
        good, end = good and np.array_equal(ends, after), int(after.max(initial=end))
    return {
        f"{dim}_begin is not the sum of the {dim}_count before": good,
        f"{dim}_count does not add up to the {dim}s": end == ds.sizes[dim],
    }

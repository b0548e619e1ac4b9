"""Summary values as functions that JAX differentiates, compiles and maps; needs film-model[jax]."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import Mistake, did_you_mean, raise_all
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene
from film_model.scene.options import DEFAULT_ACCURACY
from film_model.solve.batch import simulate_many
from film_model.solve.derivatives import RESULTS, Entry, entries_of
from film_model.solve.many_derivatives import derivatives_of_many

NEEDS_JAX = 'film_model.jax needs JAX: install film-model[jax] (pip install "film-model[jax]")'


def summary_function(scene: Scene, paths: Sequence[str], quantities: Sequence[str]) -> Callable[..., dict[str, Any]]:
    """Summary values of a scene as a function of some of its numbers, for JAX.

    paths: keys of numbers that the scene has, such as "impactor.drop_height". quantities: of the summary and, with
    friction in the scene, of `History.oblique`. The function
    takes a number or an array, SI, for each path, which broadcast together, and gives an array, SI, for each quantity:
    nan where the impact fails, a number is out of the range of scenes, or the value does not exist. It may be used
    under jit, vmap, grad, jacfwd and jacrev; all impacts of an array, also of vmap, are simulated as one batch, by a
    callback to the host. Its derivatives are those of `simulate(scene, derivatives=…)`, first order only, with the
    decisions about effects held fixed; nan at kinks on both sides.
    JAX computes with 24 bits unless jax_enable_x64 is set.

    Raises SceneError for a path or quantity that the scene does not have, ImportError without JAX.

    With `force = summary_function(scene, ["impactor.velocity"], ["maximum_force"])`, the slope of the peak force at
    0.25 m/s is `jax.grad(lambda v: force(v)["maximum_force"])(0.25)`.
    """
    try:
        jax: Any = import_module("jax")
    except ImportError as error:
        raise ImportError(NEEDS_JAX) from error
    known = SUMMARY if scene.contact.friction is None else RESULTS
    unknown = [name for name in quantities if name not in known]
    raise_all([Mistake(None, None, f"quantities.{name}", f"unknown{did_you_mean(name, known)}") for name in unknown])
    host, jnp, names = _Host(scene, entries_of(scene, paths), tuple(quantities)), jax.numpy, tuple(quantities)

    def on_host(compute: Callable[[Any], tuple[Array, ...]], numbers: Any, *tails: int) -> Any:
        shapes = [(*numbers.shape[:-1], len(names)), (*numbers.shape[:-1], len(names), *tails)][: 1 + len(tails)]
        types = tuple(jax.ShapeDtypeStruct(shape, numbers.dtype) for shape in shapes)
        return jax.pure_callback(compute, types, numbers, vmap_method="expand_dims")

    @jax.custom_jvp
    def summary(numbers: Any) -> dict[str, Any]:
        (values,) = on_host(host.values, numbers)
        return {name: values[..., k] for k, name in enumerate(names)}

    def tangents(primals: Any, changes: Any) -> Any:
        values, slopes = on_host(host.values_and_slopes, primals[0], primals[0].shape[-1])
        found = {name: values[..., k] for k, name in enumerate(names)}
        return found, {name: (slopes[..., k, :] * changes[0]).sum(-1) for k, name in enumerate(names)}

    summary.defjvp(tangents)

    def of_numbers(*numbers: Any) -> dict[str, Any]:
        if len(numbers) != len(host.entries):
            raise TypeError(f"{len(numbers)} numbers given, one is needed for each of {', '.join(paths)}")
        given = jnp.broadcast_arrays(*(jnp.asarray(number, float) for number in numbers))
        return summary(jnp.stack(given, axis=-1))

    return of_numbers


class _Host:
    """The computation of arrays whose last axis has a value for each of the numbers."""

    def __init__(self, scene: Scene, entries: tuple[Entry, ...], names: tuple[str, ...]) -> None:
        self.scene, self.entries, self.names = scene, entries, names

    def values(self, numbers: Any) -> tuple[Array]:
        """The quantities, on the last axis."""
        return (self._compute(np.asarray(numbers), slopes=False)[0],)

    def values_and_slopes(self, numbers: Any) -> tuple[Array, Array]:
        """The quantities, and their derivatives by the numbers on one more axis."""
        return self._compute(np.asarray(numbers), slopes=True)

    def _compute(self, numbers: Any, slopes: bool) -> tuple[Array, Array]:
        rows = numbers.reshape(-1, len(self.entries)).astype(np.float64)
        values = np.full((len(rows), len(self.names)), np.nan)
        found = np.full((len(rows), len(self.names), len(self.entries)), np.nan)
        low, high = (np.array([getattr(entry, end) for entry in self.entries]) for end in ("low", "high"))
        inside = np.flatnonzero(((rows >= low) & (rows <= high)).all(axis=1))
        if inside.size:
            columns = {entry.path: rows[inside, k] for k, entry in enumerate(self.entries)}
            many = simulate_many(self.scene, columns)
            along = {} if many.oblique is None else many.oblique.summary
            results = {**many.summary, **along}
            values[inside] = np.stack([results[name] for name in self.names], axis=-1)
            if slopes:
                solver = self.scene.solver
                by = derivatives_of_many(
                    *(self.scene, columns, self.entries, many.problems, many.on_modes, solver),
                    solver.accuracy or DEFAULT_ACCURACY,
                    along=not SUMMARY.keys() >= set(self.names),
                )
                found[inside] = np.stack([by.values[name] for name in self.names], axis=1)
        shape = (*numbers.shape[:-1], len(self.names))
        dtype = numbers.dtype
        return values.reshape(shape).astype(dtype), found.reshape(*shape, len(self.entries)).astype(dtype)

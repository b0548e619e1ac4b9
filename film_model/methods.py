"""Methods of histories and scenes that use packages above theirs: pictures, explanations, datasets, notebooks.

The classes have them as `film_model.base.late.Late`, which imports this module when one is used.
"""

from __future__ import annotations

import base64
import math
import os
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.base.foreign import Dataset, Figure
from film_model.base.text import Text, escaped
from film_model.base.units import format_si
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene
from film_model.solve.bounce import COLUMNS, Bounces
from film_model.solve.history import MOTION, History

if TYPE_CHECKING:
    from film_model.solve.batch import BatchResult
    from film_model.solve.chain_motion import ChainMotion
    from film_model.solve.component import ImpactComponent
    from film_model.solve.derivatives import Derivatives


def plot(self: History, path: str | os.PathLike[str] | None = None) -> Figure:
    """The picture of the impact, as a matplotlib figure; written to `path` (.png, .svg or .pdf) if given.

    Raises ImportError without matplotlib.
    """
    from film_model.plot.history import plot_history

    return plot_history(self, path)


def to_dataset(self: History, samples: int = 201) -> Dataset:
    """The impact as an xarray.Dataset: motion at evenly spaced times and at all events, summary and segments."""
    import film_datasets

    return film_datasets.to_dataset(self, samples, "History.to_dataset")


def citations(self: History) -> Text:
    """What to cite, as BibTeX: this package, its method, and the sources of the law, the effects and the friction."""
    from film_model.studies.citations import citations as found

    return Text(found(self))


def explain(self: Scene, *, verbose: bool = False) -> Text:
    """What `film-model explain` prints: the effects of the scene, with the numbers that decide.

    verbose: also indicators, thresholds, costs and sources. Raises SimulationError as `simulate` does.
    """
    from film_model.studies.explain import effects_text

    return Text(effects_text(self, verbose=verbose))


def history_as_html(self: History) -> str:
    """For notebooks: the summary and the warnings, and the picture if matplotlib is installed."""
    rows = (
        (name.replace("_", " "), format_si(value, SUMMARY[name][0], 6) + self.interval_text(name))
        for name, value in self.summary.items()
        if value is not None
    )
    said = "".join(f"<li>{escaped(sentence)}</li>" for sentence in self.warnings)
    return _heading(self.scene, repr(self)) + _table(rows) + (f"<ul>{said}</ul>" if said else "") + _picture(self)


def batch_as_html(self: BatchResult) -> str:
    """For notebooks: what was varied, and the least and greatest of each summary value."""
    dimensions = {name: dimension for name, (dimension, _) in SUMMARY.items()} | {
        "velocity": "velocity",
        "mass": "mass",
    }
    rows = [
        (name.replace("_", " "), " to ".join(format_si(end(known), dimensions[name]) for end in (min, max)))
        for name, values in (*self.varied.items(), *self.summary.items())
        if (known := [float(value) for value in np.ravel(values) if not math.isnan(value)])
    ]
    return f"<p>{escaped(repr(self))}</p>" + _table(rows)


def derivatives_as_html(self: Derivatives) -> str:
    """For notebooks: the derivatives of every summary value, by each number."""
    head = ("", *(f"by {path} = {entry.text}" for path, entry in self.entries.items()))
    rows = (
        (name.replace("_", " "), *(self.text_of(name, path) for path in self.entries))
        for name, row in self.values.items()
        if any(value is not None for value in row.values())
    )
    return f"<p>{escaped(repr(self))}</p>" + _table([head, *rows])


def plot_bounces(self: Bounces, path: str | os.PathLike[str] | None = None) -> Figure:
    """The picture of height over time, as a matplotlib figure; written to `path` (.png, .svg or .pdf) if given."""
    from film_model.plot.bounces import plot_bounces as drawn

    return drawn(self, path)


def bounces_to_dataset(self: Bounces) -> Dataset:
    """The bounces as an xarray.Dataset, a row for each."""
    import film_datasets

    return film_datasets.to_dataset(self)


def bounces_as_html(self: Bounces) -> str:
    """For notebooks: all bounces, and the warnings."""
    head = tuple(name.replace("_", " ") for name in COLUMNS)
    rows = (
        tuple("" if value is None else format_si(value, COLUMNS[name][0]) for name, value in bounce._asdict().items())
        for bounce in self.bounces
    )
    said = "".join(f"<li>{escaped(sentence)}</li>" for sentence in self.warnings)
    return _heading(self.scene, repr(self)) + _table([head, *rows]) + (f"<ul>{said}</ul>" if said else "")


def plot_chain(self: ChainMotion, path: str | os.PathLike[str] | None = None) -> Figure:
    """The picture of velocities and forces over time, as a matplotlib figure; written to `path` if given."""
    from film_model.plot.chain import plot_chain as drawn

    return drawn(self, path)


def chain_to_dataset(self: ChainMotion, samples: int = 201) -> Dataset:
    """The motion as an xarray.Dataset over body, contact and t: values of each, and samples while forces act."""
    import film_datasets

    return film_datasets.to_dataset(self, samples)


def component_as_html(self: ImpactComponent) -> str:
    """For notebooks: the motion now."""
    rows = ((name.replace("_", " "), format_si(getattr(self.outputs, name), MOTION[name][0])) for name in MOTION)
    return f"<p>{escaped(repr(self))}</p>" + _table(rows)


def scene_as_html(self: Scene) -> str:
    """For notebooks: every entry of the scene file."""
    return _heading(self, repr(self)) + _table(_entries("", self.to_table()))


def _heading(scene: Scene, line: str) -> str:
    title = scene.title or f"Impact on a {scene.target.kind}"
    return f"<p><strong>{escaped(title)}</strong><br/>{escaped(line)}</p>"


def _table(rows: Iterable[tuple[str, ...]]) -> str:
    """A table whose first column has names."""
    cells = ((name, "".join(f"<td>{escaped(value)}</td>" for value in values)) for name, *values in rows)
    return f"<table>{''.join(f'<tr><th>{escaped(name)}</th>{values}</tr>' for name, values in cells)}</table>"


def _entries(path: str, table: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    for name, value in table.items():
        key = f"{path}.{name}".lstrip(".")
        if isinstance(value, dict):
            yield from _entries(key, value)
        else:
            yield key, str(value)


def _picture(history: History) -> str:
    """The picture as an image inside the page, so that identifiers of several pictures do not meet."""
    if find_spec("matplotlib") is None:
        return ""
    from film_model.plot.style import svg

    data = base64.b64encode(svg(plot(history))).decode("ascii")
    return f'<img alt="Force, indentation and velocity over time" src="data:image/svg+xml;base64,{data}"/>'

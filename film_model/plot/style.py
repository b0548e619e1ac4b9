"""The style of all pictures: palette, units on axes, and files that are written whole.

Colours are distinguishable for readers with colour-vision deficiency; where two areas meet, hatches differ as well.
"""

from __future__ import annotations

import contextlib
import contextvars
import io
import math
import os
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import numpy as np

from film_model.base.errors import did_you_mean, shown
from film_model.base.files import written_whole
from film_model.base.foreign import Figure
from film_model.base.units import PREFIXED, scene_unit

SUFFIXES = (".png", ".svg", ".pdf")

COLOURS = ("#3f90da", "#ffa90e", "#bd1f01", "#832db6", "#a96b59", "#e76300", "#b9ac70", "#717581", "#92dadd")
UNLOADING = "#94a4a2"
"""Petroff's ten colours (arXiv:2107.02270): stages of a law, or series; and the unloading branch."""

NO_CONTACT = "#d9dede"
"""Motion without contact."""

HIGHLIGHT = COLOURS[2]
"""The series, or the point, that a picture is about."""

REGIMES: dict[str, tuple[str, str | None]] = {
    "half-space": ("#e4eaef", None),
    "moving": ("#a9cbe6", None),
    "reflections": ("#ffdca8", ".."),
    "quasi-static": ("#e0ad94", "//"),
}
"""Colour and hatch of the areas of a map of regimes."""

MARKERS = "osD^v<>Pp*hXd"

STYLES: dict[str, str] = {
    "screen": "for reading on a screen, the default",
    "paper": "for print: thin lines, 600 dots per inch at least",
    "dark": "light lines on a dark ground",
}
"""Styles of pictures."""

_COMMON: dict[Any, Any] = {
    **{"font.size": 9.0, "lines.linewidth": 1.6, "hatch.linewidth": 0.5},
    **{"svg.hashsalt": "film-model", "svg.fonttype": "none"},
    **{"axes.spines.top": False, "axes.spines.right": False, "xtick.direction": "in", "ytick.direction": "in"},
}
_STYLE = contextvars.ContextVar("style", default="screen")
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def check_picture(path: str | os.PathLike[str]) -> None:
    """Raise before any work: ValueError for an unknown suffix of `path`, ImportError without matplotlib."""
    _checked(path)
    _matplotlib()


def picture(
    path: str | os.PathLike[str] | None, draw: Callable[[Figure], None], size: tuple[float, float], dpi: float = 200.0
) -> Figure:
    """A figure of `size` [inches], filled by `draw`; written to `path` (.png, .svg or .pdf) if given.

    The file is written under a temporary name and renamed, and replaces an existing one. dpi: of a PNG, dots per inch.
    pyplot is not used. Raises ValueError for another suffix, ImportError without matplotlib, OSError if the file
    cannot be written.
    """
    target, style = None if path is None else _checked(path), _STYLE.get()
    matplotlib, figure_class = _matplotlib()
    thin = {"lines.linewidth": 1.1, "axes.linewidth": 0.6} if style == "paper" else {}
    with matplotlib.rc_context(_COMMON | thin):
        figure = figure_class(figsize=size)
        draw(figure)
        if style == "dark":
            _darken(figure)
        if target is not None:
            _save(figure, target, max(dpi, 600.0) if style == "paper" else dpi)
    return figure


def svg(figure: Figure) -> bytes:
    """A figure as SVG, byte for byte reproducible."""
    matplotlib, _ = _matplotlib()
    with matplotlib.rc_context({"svg.hashsalt": "film-model"}):
        return _printed(figure, "svg", figure.dpi)


@contextlib.contextmanager
def picture_style(style: str) -> Generator[None]:
    """Pictures drawn within have the style, one of `STYLES`. Raises ValueError for another."""
    if style not in STYLES:
        raise ValueError(f"style: {shown(style)} is not one of {', '.join(STYLES)}{did_you_mean(style, list(STYLES))}")
    token = _STYLE.set(style)
    try:
        yield
    finally:
        _STYLE.reset(token)


def prefixed_unit(values: Any, dimension: str) -> tuple[float, str]:
    """Size in SI and symbol of a unit in which the largest of the values [SI] of a dimension is easy to read."""
    largest = float(np.abs(values).max(initial=0.0))
    if dimension not in (*PREFIXED, "velocity", "acceleration"):
        return 1.0, scene_unit(dimension)
    # 0.25 m/s, but 250 nm
    power = 0 if largest == 0.0 else math.floor((math.log10(largest) + (dimension == "velocity")) / 3) * 3
    power = min(max(power, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**power, _PREFIXES[power] + scene_unit(dimension)


def plain(text: str) -> str:
    """The text with dollar signs escaped: matplotlib would read what is between two as mathematics."""
    return text.replace("$", r"\$")


def _checked(path: str | os.PathLike[str]) -> Path:
    """The path of a picture. Raises ValueError for a suffix that is not one of `SUFFIXES`."""
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target}: the name of a picture must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    return target


def _matplotlib() -> tuple[Any, type[Figure]]:
    """matplotlib and its Figure class, which works without pyplot."""
    try:
        import matplotlib  # optional, and slow to import
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('plots need matplotlib: install film-model[plot] (pip install "film-model[plot]")') from error
    return matplotlib, Figure


def _darken(figure: Figure) -> None:
    """Turn the lightness of every colour but those of a colour map round: hue and saturation stay."""
    from colorsys import hls_to_rgb, rgb_to_hls

    from matplotlib.colors import ListedColormap, to_rgba_array

    def turned(colours: Any) -> Any:
        found = to_rgba_array(colours)
        for row in found:
            hue, lightness, saturation = rgb_to_hls(*row[:3])
            row[:3] = hls_to_rgb(hue, 1.0 - 0.88 * lightness, saturation)
        return found[0] if len(found) == 1 else found

    found: list[Any] = figure.findobj(include_self=False)
    boxes = [box for text in found if (box := getattr(text, "get_bbox_patch", lambda: None)()) is not None]
    for artist in {id(artist): artist for artist in [*found, *boxes]}.values():
        if getattr(artist, "colors", None) is not None:  # areas and lines of a map
            artist.set_cmap(ListedColormap(np.atleast_2d(turned(artist.get_cmap().colors))))
        if hasattr(artist, "patch") or getattr(artist, "get_array", lambda: None)() is not None:
            continue  # figures and axes are drawn by their patches
        for name in ("color", "facecolor", "edgecolor", "markerfacecolor", "markeredgecolor"):
            get, put = getattr(artist, f"get_{name}", None), getattr(artist, f"set_{name}", None)
            if get is None or put is None or (name == "color" and hasattr(artist, "get_facecolor")):
                continue
            value = get()
            if not (isinstance(value, str) and value == "auto") and to_rgba_array(value)[:, 3].any():
                put(turned(value))


def _save(figure: Figure, target: Path, dpi: float) -> None:
    """Write the whole picture or nothing; without a date, so that equal pictures are equal files."""
    picture = _printed(figure, target.suffix[1:].lower(), dpi)
    with written_whole(target) as beside:
        beside.write_bytes(picture)


def _printed(figure: Figure, kind: str, dpi: float) -> bytes:
    """A figure in a file's format. `savefig` draws it twice, which only a layout engine needs."""
    from matplotlib.backend_bases import get_registered_canvas_class

    picture, undated = io.BytesIO(), {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    if figure.get_layout_engine() is not None:
        figure.savefig(picture, format=kind, dpi=dpi, metadata=undated.get(kind))
        return picture.getvalue()
    canvas: Any = get_registered_canvas_class(kind)
    before, figure.dpi = figure.dpi, dpi
    getattr(canvas(figure), f"print_{kind}")(picture, metadata=undated.get(kind))
    figure.dpi = before
    return picture.getvalue()

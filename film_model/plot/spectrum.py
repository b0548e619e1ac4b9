"""The picture of an impact over frequency: the spectrum of its force, and the accelerance of the structure."""

from __future__ import annotations

import os
from itertools import cycle

import numpy as np

from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, picture, plain
from film_model.solve.spectrum import Spectrum


def plot_spectrum(
    found: Spectrum, title: str, path: str | os.PathLike[str] | None = None, dpi: float = 200.0
) -> Figure:
    """Amplitude of the force with its bandwidth and, on a structure, accelerance of each point and strain of each
    gauge. Files, errors and dpi: see `style.picture`."""
    below = bool(found.points) + bool(found.strain)
    return picture(path, lambda figure: _draw(figure, found, title), (7.2, 3.4 + 2.2 * below), dpi)


def _draw(figure: Figure, found: Spectrum, title: str) -> None:
    figure.set_layout_engine("constrained")
    figure.suptitle(plain(title), fontsize=min(12.0, 700.0 / len(title)), fontweight="bold", x=0.01, ha="left")
    strains = [
        (f"{name}, {what[-1]}", row)
        for what, rows in found.strain.items()
        if what.startswith("strain")
        for name, row in zip(found.gauges, rows, strict=True)
    ]
    below = {"accelerance (1/kg)": list(zip(found.points, found.accelerance, strict=True)), "strain (1/N)": strains}
    below = {label: rows for label, rows in below.items() if rows}
    panels = np.atleast_1d(figure.subplots(1 + len(below), 1, sharex=True))
    level = 20.0 * np.log10(np.abs(found.force) / np.abs(found.force[0]))
    panels[0].plot(found.frequency / 1e3, level, color="0.2")
    panels[0].axvline(found.bandwidth / 1e3, color="0.55", linewidth=0.5)
    panels[0].axhline(-10.0, color="0.55", linewidth=0.5)
    bandwidth = f"bandwidth at −10 dB: {found.bandwidth / 1e3:.4g} kHz"
    panels[0].set(ylabel="force (dB)", ylim=(max(-60.0, 1.05 * float(level.min())), 3.0))
    panels[0].set_title(bandwidth, loc="right", fontsize=8)
    for panel, (label, rows) in zip(panels[1:], below.items(), strict=True):
        for (name, row), colour in zip(rows, cycle(COLOURS), strict=False):
            panel.plot(found.frequency / 1e3, np.abs(row), color=colour, label=plain(name), linewidth=1.0)
        panel.set(yscale="log", ylabel=label)
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, fontsize=8, frameon=False)
    panels[-1].set(xlabel="frequency (kHz)", xlim=(0.0, float(found.frequency[-1]) / 1e3))

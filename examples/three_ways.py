"""One FMU run in three ways: Co-Simulation, Co-Simulation with event mode, and Model Exchange with CVODE.

Co-Simulation uses the library's segments and gives its numbers at any step size; Model Exchange integrates the law.
"""

import shutil
import tempfile
from pathlib import Path

import numpy as np
import xarray as xr

import film_model as fm
import fmu_wrapper
from film_model.plot.style import COLOURS, HIGHLIGHT, UNLOADING

SCENE = Path(__file__).parent / "scenes" / "tungsten_carbide_on_steel.toml"
WAYS = {"Co-Simulation": "steps", "with event mode": "events", "Model Exchange": "exchange"}


def main() -> tuple[fm.History, dict[str, xr.Dataset], dict[str, float]]:
    """The library's history, the three runs, and the largest difference in contact force relative to its maximum."""
    scene = fmu_wrapper.served(fm.Scene.from_toml(SCENE))  # with its weight, as in the FMU
    history = fm.simulate(scene, accuracy=1e-9)
    folder = Path(tempfile.mkdtemp())
    try:
        path = fmu_wrapper.export(history.scene, folder / "impact.fmu", fmi_version=3)
        runs = {way: fmu_wrapper.run(path, mode=mode, step_size="4 us") for way, mode in WAYS.items()}
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    differences = {}
    for way, run in runs.items():
        inside = run.t.values <= history.duration
        force = history.sample_si(run.t.values[inside]).contact_force
        differences[way] = float(
            np.abs(run.contact_force.values[inside] - force).max() / history.summary["maximum_force"]
        )
    return history, runs, differences


def draw(history: fm.History, runs: dict[str, xr.Dataset], path: str | Path) -> None:
    """Force over time: the library's as a line, the FMU's points and events on it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    panels = figure.subplots(len(runs), sharex=True)
    t = np.linspace(0.0, history.duration, 800)
    for panel, (way, run) in zip(panels, runs.items(), strict=True):
        panel.plot(t * 1e6, history.sample_si(t).contact_force, color=UNLOADING, label="library")
        panel.plot(run.t * 1e6, run.contact_force, ".", color=COLOURS[0], label=way)
        panel.plot(run.event_time * 1e6, run.event_contact_force, "o", mfc="none", color=HIGHLIGHT, label="events")
        panel.set(ylabel="force (N)")
        panel.legend(frameon=False)
    panels[-1].set(xlabel="time (µs)")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    history, runs, differences = main()
    print(f"{'':20}{'points':>8}{'events':>8}{'maximum force':>18}{'contact':>16}{'difference':>12}")
    print(f"{'library':20}{'':8}{len(history.events):8}{history.summary['maximum_force']:16.9f} N", end="")
    print(f"{history.summary['contact_duration'] * 1e6:13.7f} us")
    for way, run in runs.items():
        numbers = f"{run.sizes['t']:8}{run.sizes['event']:8}{float(run.maximum_force):16.9f} N"
        print(f"{way:20}{numbers}{float(run.contact_duration) * 1e6:13.7f} us{differences[way]:12.1e}")
    draw(history, runs, "three_ways.png")
    print("wrote three_ways.png")

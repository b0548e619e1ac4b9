"""Figures 2 to 6 of Big-Alabo, Cartmell & Harrison 2017, redrawn.

As in the paper, lines are FILM and markers are numerical integration. Every figure shows both linearisations: the
paper's chords, and work-preserving lines with the same number of segments. The markers are scipy's DOP853 for the same
contact law (`impact_by_integration`), which shares no code with the core.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

import film_model as fm
from film_model.effects.choose import problem_of
from film_model.studies import quadrature

SCENES = Path(__file__).parent / "scenes"
STYLES = {  # of a line; colours of Okabe and Ito's palette
    "chord": {"color": "#D55E00", "linestyle": "--", "linewidth": 1.6},
    "work-preserving": {"color": "#0072B2", "linestyle": "-", "linewidth": 1.6},
}
MARKERS = {"color": "black", "linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "none"}
SHADES = ("#FFFFFF", "#EDEDED", "#FFFFFF")  # behind the stages
PANELS = {  # quantity: label and factor from SI
    "contact_force": ("force [N]", 1.0),
    "indentation": ("indentation [µm]", 1e6),
    "relative_velocity": ("rate of indentation [m/s]", 1.0),
}


@dataclass(frozen=True)
class Integrated:
    """Motion by numerical integration: time of separation [s], and indentation, rate and force at a time (SI)."""

    duration: float
    at: Callable[[np.ndarray], dict[str, np.ndarray]]


def impact_by_integration(scene: fm.Scene) -> Integrated:
    """m v' = −F, δ' = v − F/Z by scipy's DOP853, along the loading curve and then along the unloading branch."""
    problem = problem_of(scene)
    mass, scales = problem.mass, problem.scales
    compliance = problem.gamma * scales.velocity / scales.force  # 1/Z
    stages = problem.law.stages()

    def loading(depth):
        xi = max(depth / scales.length, 0.0)
        stage = next(s for s in stages if xi <= s.end)
        return scales.force * float(quadrature.value(stage.force, xi, stage))

    def march(force, start, begin, until):
        until.terminal, until.direction = True, -1
        return solve_ivp(
            lambda _, s: (s[1] - compliance * force(s[0]), -force(s[0]) / mass), (begin, 1.0), start, "DOP853",
            events=until, dense_output=True, rtol=1e-10, atol=1e-16,
        )  # fmt: skip

    start = (0.0, problem.approach * scales.velocity)
    inward = march(loading, start, 0.0, lambda _, s: s[1] - compliance * loading(s[0]))
    depth, turn = inward.y[0, -1], inward.t[-1]
    stage = next(s for s in stages if depth / scales.length <= s.end)
    opening, free = loading, 0.0
    if stage.unloading is not None:
        top = loading(depth)
        branch = quadrature.unloaded(stage.unloading, stage, depth / scales.length, top / scales.force)
        free = branch.begin * scales.length

        def opening(deep):
            return scales.force * float(quadrature.value(branch.force, deep / scales.length, branch))

    outward = march(opening, inward.y[:, -1], turn, lambda _, s: s[0] - free)

    def at(times):
        inside = times <= turn
        deep, speed = np.where(inside, inward.sol(times), outward.sol(times))
        force = np.array([(loading if i else opening)(d) for i, d in zip(inside, deep, strict=True)])
        return {"contact_force": force, "indentation": deep, "relative_velocity": speed - compliance * force}

    return Integrated(outward.t[-1], at)


def histories(scene: fm.Scene, segments: int) -> dict[str, fm.History]:
    """The impact by both linearisations."""
    return {name: fm.simulate(scene, segments=segments, linearisation=name) for name in STYLES}


def history_figure(scene: fm.Scene, segments: int, title: str) -> tuple[Figure, dict[str, float]]:
    """Force, indentation and its rate over time; on the right, the differences from integration.

    Also returns the largest difference in force for each linearisation, relative to the maximum force.
    """
    integrated, runs = impact_by_integration(scene), histories(scene, segments)
    figure = Figure(figsize=(10.0, 7.5), layout="constrained")
    grid = figure.subplots(3, 2, sharex=True)
    marked = np.linspace(0.0, integrated.duration, 41)
    fine = np.linspace(0.0, integrated.duration, 1001)
    markers, exact = integrated.at(marked), integrated.at(fine)
    worst = {}
    for (quantity, (label, factor)), (left, right) in zip(PANELS.items(), grid, strict=True):
        size = np.abs(exact[quantity]).max()
        for name, history in runs.items():
            values = getattr(history.sample_si(fine), quantity)
            off = values - exact[quantity]
            left.plot(fine * 1e6, values * factor, **STYLES[name], label=name)
            right.plot(fine * 1e6, 100 * off / size, **STYLES[name])
            worst.setdefault(name, float(np.abs(off).max() / size))
        left.plot(marked * 1e6, markers[quantity] * factor, **MARKERS, label="integration")
        left.set(ylabel=label)
        right.set(ylabel="difference [% of largest]")
        for axes in (left, right):
            shade_stages(axes, runs["work-preserving"], named=axes is grid[0, 0])
            axes.axhline(0.0, color="grey", linewidth=0.8)
            axes.set_xlim(0.0, integrated.duration * 1e6)
    for axes in grid[-1]:
        axes.set_xlabel("time [µs]")
    grid[0, 0].legend()
    grid[0, 1].set_title("difference from integration", fontsize="medium")
    figure.suptitle(title)
    return figure, worst


def shade_stages(axes: Axes, history: fm.History, named: bool) -> None:
    """A band behind each stage of the contact, from the history's events, with its name above."""
    ends = [e for e in history.events if e.name in ("stage_changes", "maximum_indentation", "contact_ends")]
    begin, name = 0.0, history.events[0].stage
    for event, shade in zip(ends, SHADES, strict=False):
        end = event.time * 1e6
        axes.axvspan(begin, end, color=shade, zorder=0)
        if named:
            axes.text(
                (begin + end) / 2, 1.02, name, ha="center", fontsize="small", transform=axes.get_xaxis_transform()
            )
        begin, name = end, "unloading" if event.name == "maximum_indentation" else event.stage


def convergence_figure(scene: fm.Scene, zoom: bool) -> tuple[Figure, dict[str, list[float]]]:
    """Force over time with 10, 15 and 20 segments per stage, whole or around the peak; below, the differences.

    Also returns the maximum force [N] of each. The paper divides 96 µm into 30, 40 and 50 segments, of which the
    indentation crosses 14, 19 and 23 until it turns, and unloads in 10, 15 and 20.
    """
    integrated = impact_by_integration(scene)
    figure = Figure(figsize=(10.0, 6.5), layout="constrained")
    window = (15e-6, 65e-6) if zoom else (0.0, integrated.duration)
    fine, marked = (np.linspace(*window, count) for count in (1001, 41))
    exact = integrated.at(fine)["contact_force"]
    peaks: dict[str, list[float]] = {name: [] for name in STYLES}
    grid = figure.subplots(2, 2, sharex=True, sharey="row")
    for (above, below), name in zip(grid.T, STYLES, strict=True):
        for segments, colour, line in ((10, "#E69F00", ":"), (15, "#009E73", "--"), (20, "#0072B2", "-")):
            history = fm.simulate(scene, segments=segments, linearisation=name)
            force = history.sample_si(fine).contact_force
            above.plot(fine * 1e6, force, color=colour, linestyle=line, label=f"{segments} segments")
            below.plot(fine * 1e6, force - exact, color=colour, linestyle=line)
            peaks[name].append(history.summary["maximum_force"])
        above.plot(marked * 1e6, integrated.at(marked)["contact_force"], **MARKERS, label="integration")
        above.set(title=name, xlim=(window[0] * 1e6, window[1] * 1e6))
        below.set(xlabel="time [µs]")
        above.grid(alpha=0.3)
        below.grid(alpha=0.3)
    grid[0, 0].set(ylabel="force [N]", ylim=(250.0, 310.0) if zoom else (0.0, 350.0))
    grid[1, 0].set(ylabel="difference from integration [N]")
    grid[0, 1].legend()
    figure.suptitle("Figure 6: the peak of Figure 5" if zoom else "Figure 5: convergence on the composite plate")
    return figure, peaks


def main(folder: str | Path = "figures") -> dict[str, dict]:
    """Write figure_2.png to figure_6.png; the numbers of each figure by its name."""
    ball = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    stronge = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel_stronge.toml")
    plate = fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace(
        {"target.impedance_formula": "paper", "effects.boundary_reflections": False}
    )
    drawn = {
        "figure_2": history_figure(ball, 5, "Figure 2: tungsten carbide on steel, Big-Alabo's law, 5 segments a stage"),
        "figure_3": history_figure(
            stronge, 5, "Figure 3: tungsten carbide on steel, Stronge's law, 5 segments a stage"
        ),
        "figure_4": history_figure(plate, 20, "Figure 4: steel ball on a composite plate, 20 segments in and 20 out"),
        "figure_5": convergence_figure(plate, zoom=False),
        "figure_6": convergence_figure(plate, zoom=True),
    }
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, (figure, _) in drawn.items():
        figure.savefig(Path(folder) / f"{name}.png", dpi=150)
    return {name: numbers for name, (_, numbers) in drawn.items()}


if __name__ == "__main__":
    for figure_name, found in main(*sys.argv[1:2]).items():
        print(figure_name, found)

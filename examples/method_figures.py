"""The figures of docs/method.md, and the numbers that its text quotes.

Every number comes from the core; exact values are closed forms or a mesh of thousands of lines. `main(folder)` writes
the pictures and returns the numbers.
"""

import io
import itertools
import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator
from PIL import Image

import film_model as fm
from film_model.core import native

BLUE, ORANGE, GREEN, PURPLE, YELLOW = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00"  # Okabe and Ito's palette
CHORD = {"color": ORANGE, "linestyle": "--", "linewidth": 1.5}
WORK = {"color": BLUE, "linestyle": "-", "linewidth": 1.5}
LAW = {"color": "black", "linestyle": "-", "linewidth": 0.9}
DPI, COLOURS = 110, 96  # of the pictures: small files

Fractions = Callable[[np.ndarray], np.ndarray]
"""Node positions on a leg, 0 to 1, as a function of the fraction of segments, 0 to 1."""

EQUAL_TABLE, COSINE_TABLE, IN_TABLE, OUT_TABLE, SLOW_TABLE, CREEP_TABLE = range(6)  # FILM_EQUAL ... FILM_PLATE_CREEP
TIMES_AS_MANY = {SLOW_TABLE: 2, CREEP_TABLE: 4}  # unloading segments of these gradings


def equal(s: np.ndarray) -> np.ndarray:
    return 1.0 * s


def cosine(s: np.ndarray) -> np.ndarray:
    return np.sin(0.5 * np.pi * s) ** 2


def graded(a: float, b: float, c: float = 1.0) -> Fractions:
    """s^a/(s^a + c (1 − s)^b): nodes crowd as the power a at the start of the leg and as the power b at its end."""
    return lambda s: s**a / (s**a + c * (1.0 - s) ** b)


def mirrored(fractions: Fractions) -> Fractions:
    """The same nodes passed the other way."""
    return lambda s: 1.0 - fractions(1.0 - s)


def own_mesh(loading: int, inward: Fractions, unloading: int, outward: Fractions) -> native.Mesh:
    """Work-preserving lines on nodes of our own, in place of every grading of the core.

    As in the core, a slow way out takes 2 or 4 times as many lines.
    """
    mesh = native.Mesh()
    mesh.linearisation, mesh.loading, mesh.unloading = native.WORK_PRESERVING, loading, unloading
    mesh.memory = []
    for table in range(6):
        for pointers, count, fractions in (
            (mesh.loading_nodes, loading, inward),
            (mesh.unloading_nodes, TIMES_AS_MANY.get(table, 1) * unloading, outward),
        ):
            nodes = np.ascontiguousarray(fractions(np.arange(count + 1) / count))
            mesh.memory.append(nodes)
            pointers[table] = nodes.ctypes.data
    return mesh


def ball(law: fm.AbstractLaw | None = None) -> fm.Scene:
    """A tungsten-carbide ball on a mild-steel half-space, with Hertz's law unless another is given."""
    sphere = fm.Sphere(radius="10 mm", mass="60.74 g", velocity="0.25 m/s", material="WC, Big-Alabo 2017")
    contact = fm.Contact(law="hertz") if law is None else fm.Contact(law=law)
    return fm.Scene(sphere, fm.HalfSpace("mild steel"), contact=contact, effects=fm.Effects(gravity=False))


def on_plate(zener: float, law: fm.AbstractLaw | None = None) -> fm.Scene:
    """A 10 g ball at 1 m/s on an infinite plate with Zener's number λ = K^{2/5} m^{3/5} V^{1/5}/Z = `zener`."""
    radius, mass, modulus, density = 0.01, 0.01, 1e10, 10.0
    stiffness = 4 / 3 * modulus * math.sqrt(radius)
    bending = (stiffness**0.4 * mass**0.6 / zener / 8.0) ** 2 / density  # Z = 8 √(ρ_A D)
    stiffnesses = fm.BendingStiffness(*(f"{part * bending!r} N*m" for part in (1.0, 0.3, 1.0, 0.35)))
    plate = fm.Plate(mass_per_area=f"{density} kg/m^2", bending_stiffness=stiffnesses)
    contact = fm.Contact(law=law) if law is not None else fm.Contact(law="hertz", effective_modulus=f"{modulus} Pa")
    sphere = fm.Sphere(radius=f"{radius} m", mass=f"{mass} kg", velocity="1 m/s")
    return fm.Scene(sphere, plate, contact=contact, effects=fm.Effects(gravity=False))


def times_as_many(slowness: float) -> int:
    """Lines of a way out for each that a fast one takes."""
    return 1 if slowness < 1.1 else 2 if slowness < 2.5 else 4


def on_mild_steel_plate(scene: fm.Scene) -> fm.Scene:
    """The same ball and law on an infinite plate of 14 mm."""
    effects = fm.Effects(gravity=False, boundary_reflections=False)
    return fm.Scene(scene.impactor, fm.Plate("mild steel", thickness="14 mm"), contact=scene.contact, effects=effects)


class Case:
    """A dimensionless impact: curve, start, and its summary on a mesh so fine that only rounding is left."""

    def __init__(self, scene: fm.Scene):
        self.problem = fm.simulate(scene, segments=3).problem
        self.curve, self.start = self.problem.curve.native, self.problem.start
        self.exact = self.on(native.mesh(native.WORK_PRESERVING, 2000, 2000))
        top = self.exact.maximum_indentation - self.exact.permanent_indentation
        self.slowness = self.start.gamma * math.sqrt(self.exact.maximum_force / top)

    def on(self, mesh: native.Mesh) -> native.Summary:
        status, summary = native.marched(self.curve, mesh, self.start)
        assert status == native.EVENT
        return summary

    def error(self, mesh: native.Mesh, *names: str) -> float:
        """Largest relative error of the named summary values."""
        found = self.on(mesh)
        return max(abs(getattr(found, name) / getattr(self.exact, name) - 1.0) for name in names)

    def lines(self, mesh: native.Mesh) -> tuple[np.ndarray, np.ndarray]:
        """The lines of the whole contact, and the states at its events."""
        state = native.initial_state(self.curve, self.start)
        _, lines, events, _ = native.record(self.curve, mesh, state, math.inf, 10000)
        return lines[:-1], events  # without the flight


def slope(segments: np.ndarray, errors: np.ndarray) -> float:
    """Order of convergence by least squares, of errors above rounding."""
    seen = errors > 3e-12
    return float(-np.polyfit(np.log(segments[seen]), np.log(errors[seen]), 1)[0])


def line_force(line: np.void, xi: np.ndarray) -> np.ndarray:
    return line["phi"] + line["kappa"] * (xi - line["xi"])


# ---------------------------------------------------------------- the idea


def lines_figure() -> tuple[Figure, dict]:
    """Hertz's law on three equal segments: both kinds of lines, what they miss, and the motion they give."""
    case, n = Case(ball()), 3
    top, force = case.exact.maximum_indentation, case.exact.maximum_force
    meshes = {"chord": native.mesh(native.CHORD, n, n), "work-preserving": own_mesh(n, equal, n, equal)}
    figure = Figure(figsize=(10.5, 3.6), layout="constrained")
    law_axes, miss_axes, time_axes = figure.subplots(1, 3)
    xi = np.linspace(0.0, top, 400)
    law_axes.plot(xi / top, (xi / top) ** 1.5, **LAW, label="law, Hertz")
    clock = case.exact.contact_duration
    fine, _ = case.lines(native.mesh(native.WORK_PRESERVING, 400, 400))
    t = np.linspace(0.0, clock, 400)
    time_axes.plot(t / clock, native.sample(case.curve, fine, t)[0][:, 0] / top, **LAW)
    worst = {}
    for (name, mesh), style in zip(meshes.items(), (CHORD, WORK), strict=True):
        lines, _ = case.lines(mesh)
        inward = lines[lines["phase"] == native.PHASES.index("loading")]
        for k, line in enumerate(inward):
            end = inward[k + 1]["xi"] if k + 1 < len(inward) else top
            reach = np.linspace(line["xi"], end, 60)
            label = f"{name} lines" if k == 0 else None
            law_axes.plot(reach / top, line_force(line, reach) / force, **style, label=label)
            off = 100 * (line_force(line, reach) / force - (reach / top) ** 1.5)
            miss_axes.plot(reach / top, off, **style)
            miss_axes.fill_between(reach / top, off, 0.0, color=style["color"], alpha=0.15, linewidth=0)
        motion = native.sample(case.curve, lines, t)[0][:, 0]
        time_axes.plot(t / clock, motion / top, **style)
        at = lines["time"]
        time_axes.plot(at / clock, lines["xi"] / top, marker="o", markersize=4, linestyle="none", color=style["color"])
        worst[name] = case.error(mesh, "maximum_indentation", "contact_duration")
    law_axes.set(xlabel="indentation ξ/ξ_m", ylabel="force f/f_m", title="the law and its lines")
    law_axes.legend(fontsize="small")
    miss_axes.axhline(0.0, **LAW)
    miss_axes.set(xlabel="indentation ξ/ξ_m", ylabel="line − law [% of f_m]", title="what a line adds or takes")
    time_axes.set(xlabel="time/duration", ylabel="indentation ξ/ξ_m", title="the motion: one arc a line")
    time_axes.set_ylim(-0.02, 1.08)
    time_axes.annotate("dots: nodes", (0.5, 0.08), ha="center", fontsize="small")
    return figure, worst


# ---------------------------------------------------------------- order


def convergence_figure() -> tuple[Figure, dict]:
    """Error of the contact duration against segments a leg: both kinds of lines, equal and graded nodes."""
    segments = np.array([4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256])
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    orders = {}
    grid = figure.subplots(1, 2, sharey=True)
    for axes, (name, scene) in zip(grid, (("half-space", ball()), ("plate, λ = 0.5", on_plate(0.5))), strict=True):
        case = Case(scene)
        kinds = {
            "chords, equal nodes": (lambda n: native.mesh(native.CHORD, n, n), CHORD, "s"),
            "work-preserving, equal": (lambda n: own_mesh(n, equal, n, equal), {**WORK, "color": GREEN}, "^"),
            "work-preserving, graded": (lambda n: native.mesh(native.WORK_PRESERVING, n, n), WORK, "o"),
        }
        for kind, (mesh, style, marker) in kinds.items():
            found = np.array([case.error(mesh(int(n)), "contact_duration") for n in segments])
            late = segments >= 32
            orders[name, kind] = slope(segments[late], found[late])
            axes.loglog(segments, found, **style, marker=marker, markersize=4, label=kind)
            axes.annotate(
                f"order {orders[name, kind]:.1f}", (segments[-3], found[-3]), (4, 6), textcoords="offset points",
                color=style["color"], fontsize="small",
            )  # fmt: skip
        axes.set(title=name, xlabel="segments of a leg")
        axes.grid(alpha=0.3)
        axes.set_xlim(3.5, 400)
    grid[0].set(ylabel="relative error of the contact duration")
    grid[0].legend(fontsize="small", loc="lower left")
    return figure, orders


# ---------------------------------------------------------------- gradings

LIMIT_TOUCH, LIMIT_TURN = 8 / 7, 8 / 5
"""Exponents below which Hertz's singularity at first touch, and the turn's, cost the fourth order."""


def gradings_figure() -> tuple[Figure, dict]:
    """Error against grading exponents on a half-space, on plates inwards and outwards, and against slowness."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    grid = figure.subplots(2, 2)
    numbers: dict = {}
    inward_names = ("time_of_maximum_indentation",)
    outward_names = ("contact_duration", "final_velocity", "time_impactor_stops")
    half_space = [Case(ball())]
    plates = [Case(on_plate(value)) for value in (0.05, 0.3, 0.6, 1.0)]
    exponents, ends = np.linspace(1.0, 2.6, 17), np.linspace(1.0, 2.2, 13)
    maps = (
        ("half-space, way in, 12 lines", half_space, exponents, exponents, None, True),
        ("plates, way in, 12 lines", plates, exponents, exponents, (1.2, 1.7), True),
        ("plates, way out, 12 lines", plates, exponents, ends, (1.6, 1.2), False),
    )
    for axes, (title, cases, from_, to, chosen, inward) in zip(grid.flat, maps, strict=False):
        names = inward_names if inward else outward_names
        found = np.empty((from_.size, to.size))
        for i, a in enumerate(from_):
            for j, b in enumerate(to):
                way = graded(float(a), float(b))
                mesh = own_mesh(12, way, 4, cosine) if inward else own_mesh(150, graded(1.2, 1.7), 12, way)
                found[i, j] = max(case.error(mesh, *names) for case in cases)
        levels = np.arange(-7.5, -4.4, 0.25)
        x, y = (from_, to) if inward else (to, from_)
        drawn = axes.contourf(x, y, np.clip(np.log10(found.T if inward else found), -7.5, -4.5), levels, cmap="viridis")
        axes.axvline(LIMIT_TOUCH, color="white", linestyle=":", linewidth=1.2)
        axes.axhline(LIMIT_TURN, color="white", linestyle=":", linewidth=1.2)
        axes.set(title=title, xlabel="exponent at first touch" if inward else "exponent at the end of contact")
        axes.set(ylabel="exponent at the turn", xlim=(1.0, float(x[-1])), ylim=(1.0, float(y[-1])))
        at = (2.0, 2.0) if chosen is None else chosen if inward else chosen[::-1]
        axes.plot(*at, marker="*", markersize=13, color="white", markeredgecolor="black")
        if chosen is None:
            axes.annotate("cosine", at, (8, 4), textcoords="offset points", color="white", fontsize="small")
        figure.colorbar(drawn, ax=axes, label="log₁₀ of the relative error")
        mesh = native.mesh(native.WORK_PRESERVING, *((12, 4) if inward else (150, 12)))
        numbers[title] = {"chosen": max(case.error(mesh, *names) for case in cases), "best": float(found.min())}
    slow_figure(grid[1, 1], outward_names, numbers)
    return figure, numbers


def slow_figure(axes: Axes, names: tuple[str, ...], numbers: dict) -> None:
    """Error of each grading of the way out, on 48 lines, against slowness."""
    kinds = {
        "out (1.6, 1.2, 1)": (graded(1.6, 1.2), BLUE, "o"),
        "slow (1.6, 1.15, 0.19)": (graded(1.6, 1.15, 0.19), ORANGE, "s"),
        "creep (1, 2.5, 0.3)": (graded(1.0, 2.5, 0.3), GREEN, "^"),
    }
    cases = [Case(on_plate(float(value))) for value in np.geomspace(0.2, 9.0, 24)]
    slowness = [case.slowness for case in cases]
    for kind, (way, colour, marker) in kinds.items():
        found = [
            case.error(own_mesh(250, graded(1.2, 1.7), 48 // times_as_many(case.slowness), way), *names)
            for case in cases
        ]
        axes.loglog(slowness, found, color=colour, marker=marker, markersize=3.5, label=kind)
        numbers[kind] = dict(zip(slowness, found, strict=True))
    for limit in (1.1, 2.5):
        axes.axvline(limit, color="black", linestyle=":", linewidth=1.2)
    axes.set(title="plates, way out, 48 lines", xlabel="slowness Λ = γ √(f_m/(ξ_m − ξ_f))", ylabel="relative error")
    axes.set_ylim(1e-9, 1.0)
    axes.xaxis.set_major_locator(FixedLocator([0.2, 0.5, 1.0, 2.0, 5.0]))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("")
    axes.legend(fontsize="small", loc="upper left", title="a, b, c")
    axes.grid(alpha=0.3)


# ---------------------------------------------------------------- one line


def one_line(gamma: float, kappa: float, phi: float, nu: float, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Way x and relative velocity y on a line with this target, as the core evaluates it."""
    line = np.zeros(1, native.LINE_DTYPE)
    line["nu"], line["phi"], line["kappa"], line["gamma"], line["branch"] = nu, phi, kappa, gamma, native.FREE
    values, _, _ = native.sample(native.Curve(), line, times)
    return values[:, 0], values[:, 3] - gamma * (phi + kappa * values[:, 0])


def regimes_figure() -> tuple[Figure, dict]:
    """The motion on one line, κ = 1, from y = 1, under-, critically and over-damped by the target."""
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    way_axes, phase_axes = figure.subplots(1, 2)
    times = np.linspace(0.0, 2.0 * np.pi, 600)
    numbers = {}
    styles = ((0.0, "black", "-"), (0.25, BLUE, "-"), (1.0, ORANGE, "--"), (2.5, GREEN, "-."))
    for ratio, colour, dashes in styles:
        gamma = 2.0 * ratio  # ζ = γ √κ/2
        x, y = one_line(gamma, 1.0, 0.0, 1.0, times)
        name = {0.0: "ζ = 0, fixed target", 0.25: "ζ = 0.25", 1.0: "ζ = 1, critical", 2.5: "ζ = 2.5"}[ratio]
        way_axes.plot(times, x, color=colour, linestyle=dashes, label=name)
        phase_axes.plot(x, y, color=colour, linestyle=dashes)
        turn = int(np.argmax(y <= 0.0)) if (y <= 0.0).any() else -1
        numbers[ratio] = (float(times[turn]), float(x[turn])) if turn >= 0 else (math.inf, float(x[-1]))
    for axes in (way_axes, phase_axes):
        axes.axhline(0.0, color="grey", linewidth=0.7)
        axes.grid(alpha=0.3)
    way_axes.set(xlabel="time τ √κ", ylabel="way x √κ/y₀", title="indentation along the line")
    way_axes.legend(fontsize="small", loc="upper right")
    phase_axes.set_aspect("equal")
    phase_axes.axvline(0.0, color="grey", linewidth=0.7)
    phase_axes.set(xlabel="way x √κ/y₀", ylabel="relative velocity y/y₀", title="phase: it turns where y = 0")
    return figure, numbers


# ---------------------------------------------------------------- the turn


def march_in(case: Case, nodes: np.ndarray) -> float:
    """Time of the turn by a march of our own, on Hertz's law through `nodes`; no line is aimed at the turn.

    The motion turns on the first line that it does not pass, or on the last one, extended.
    """
    stiffness, gamma = case.curve.piece[0].force.coefficient, case.start.gamma
    time, nu = 0.0, case.start.nu
    for a, b in itertools.pairwise(nodes):
        h = b - a
        kappa = stiffness * (b**1.5 - a**1.5) / h
        phi = 0.4 * stiffness * (b**2.5 - a**2.5) / h - 0.5 * kappa * h
        damping, y0 = 0.5 * gamma * kappa, nu - gamma * phi
        root = math.sqrt(kappa - damping * damping)  # under-damped
        turn = math.atan2(root * y0, phi + damping * y0) / root
        if b == nodes[-1] or way_on(gamma, kappa, phi, nu, turn)[0] < h:
            break
        low, high = 0.0, turn
        while high - low > 1e-15 * high:
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            low, high = (middle, high) if way_on(gamma, kappa, phi, nu, middle)[0] < h else (low, middle)
        time, nu = time + high, way_on(gamma, kappa, phi, nu, high)[1]
    return time + turn


def way_on(gamma: float, kappa: float, phi: float, nu: float, tau: float) -> tuple[float, float]:
    """Way and impactor velocity on a line after tau."""
    x, y = one_line(gamma, kappa, phi, nu, np.array([tau]))
    return float(x[0]), float(y[0]) + gamma * (phi + kappa * float(x[0]))


def turn_figure() -> tuple[Figure, dict]:
    """Error of the time of maximum indentation on a plate, for three ways to end the leg."""
    case = Case(on_plate(1.0))
    segments = np.array([4, 6, 8, 12, 16, 24, 32, 48, 64, 96])
    exact, top = case.exact.time_of_maximum_indentation, case.exact.maximum_indentation
    figure = Figure(figsize=(6.6, 4.0), layout="constrained")
    axes = figure.subplots()
    fractions = graded(1.2, 1.7)
    kinds = {
        "leg 10 % too long, no aim": lambda n: march_in(case, 1.1 * top * fractions(np.arange(n + 1) / n)),
        "leg ends at the turn, line not aimed": (lambda n: march_in(case, top * fractions(np.arange(n + 1) / n))),
        "the core: last line meets the law": (
            lambda n: case.on(native.mesh(native.WORK_PRESERVING, n, 400)).time_of_maximum_indentation
        ),
    }
    numbers = {}
    styles = ((ORANGE, "s", "--"), (GREEN, "^", "-."), (BLUE, "o", "-"))
    for (kind, found), (colour, marker, dashes) in zip(kinds.items(), styles, strict=True):
        errors = np.array([abs(found(int(n)) / exact - 1.0) for n in segments])
        numbers[kind] = dict(zip(segments.tolist(), errors.tolist(), strict=True))
        axes.loglog(segments, errors, color=colour, marker=marker, linestyle=dashes, markersize=4, label=kind)
    axes.set(
        xlabel="segments of the way in", ylabel="relative error", title="time of maximum indentation, plate, λ = 1"
    )
    axes.legend(fontsize="small")
    axes.grid(alpha=0.3)
    return figure, numbers


# ---------------------------------------------------------------- loops


def follow(case: Case, mesh: native.Mesh, schedule: list[tuple[float, float]]) -> tuple[np.ndarray, float]:
    """Lines of a contact under a load that changes: (until, load) one after the other; and the energy absorbed."""
    state = native.initial_state(case.curve, case.start)
    found = []
    for until, load in schedule:
        native.set_input(state, load, 0.0, 0.0)
        _, lines, _, _ = native.record(case.curve, mesh, state, until, 10000)
        found.append(lines)
    return np.concatenate(found), state.spent


def loop_figure() -> tuple[Figure, dict]:
    """Forces pushed in again: a metal's dent, and a laminate that reloads on branches of its own."""
    figure = Figure(figsize=(9.5, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    modulus = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)
    metal = Case(ball(fm.BigAlabo(modulus, 0.01, 1e9)))
    laminate = Case(ball(fm.TanSun(stiffness=1e10, critical_indentation=2e-6)))
    mesh, numbers = native.mesh(native.WORK_PRESERVING, 4, 4), {}
    presses = ((0.72, 0.0), (1.15, 0.85), (1.36, -0.6), (1.9, 1.2), (math.inf, 0.0))  # until, load; of the impact alone
    for axes, case, title, schedules in (
        (left, metal, "Big-Alabo: one branch, out and in", ((0.85, 0.0), (1.45, 1.5), (math.inf, 0.0))),
        (right, laminate, "Tan–Sun: in again on branches of its own", presses),
    ):
        clock, force = case.exact.contact_duration, case.exact.maximum_force
        top = case.exact.maximum_indentation
        lines, spent = follow(case, mesh, [(part * clock, load * force) for part, load in schedules])
        times = np.linspace(0.0, lines[-1]["time"], 3000)
        values, stages, _ = native.sample(case.curve, lines, times)
        axes.plot(values[:, 0] / top, values[:, 2] / force, **LAW)
        for line, after in itertools.pairwise(lines):
            end = after["xi"]
            if line["branch"] == native.FREE:
                continue
            reach = np.array([line["xi"], end])
            inside = line["branch"] >= 0
            axes.plot(reach / top, line_force(line, reach) / force, color=ORANGE if inside else BLUE,
                      linestyle="--" if inside else "-", linewidth=1.3, marker=".", markersize=4)  # fmt: skip
        axes.plot([], [], color=ORANGE, linestyle="--", marker=".", label="lines, loading curve")
        axes.plot([], [], color=BLUE, linestyle="-", marker=".", label="lines, branch")
        axes.plot([], [], **LAW, label="law")
        axes.set(xlabel="indentation ξ/ξ_m (ξ_m: first turn)", ylabel="force f/f_m", title=title)
        axes.legend(fontsize="small", loc="upper left")
        axes.grid(alpha=0.3)
        numbers[title] = {"absorbed": spent, "branches": sorted(set(stages.tolist()))}
    right.set_xlim(0.65, 1.4)
    return figure, numbers


# ---------------------------------------------------------------- damping


def damping_figure() -> tuple[Figure, dict]:
    """A damped contact on five lines a leg, and the order of convergence of damped laws."""
    figure = Figure(figsize=(9.5, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    modulus = 1 / ((1 - 0.28**2) / 600e9 + (1 - 0.30**2) / 210e9)
    laws = {
        "Kuwabara–Kono": fm.KuwabaraKono(modulus, 0.01, dissipation_time=1e-5),
        "Tsuji": fm.Tsuji(modulus, 0.01, restitution=0.7),
    }
    case = Case(ball(laws["Kuwabara–Kono"]))
    top, force = case.exact.maximum_indentation, case.exact.maximum_force
    fine, _ = case.lines(native.mesh(native.WORK_PRESERVING, 400, 400))
    t = np.linspace(0.0, case.exact.contact_duration, 800)
    values = native.sample(case.curve, fine, t)[0]
    left.plot(values[:, 0] / top, values[:, 2] / force, **LAW, label="force F = f + c ξ′")
    elastic = np.array([native.stage_law(case.curve, 0, float(xi))[0] for xi in values[:, 0]])
    left.plot(values[:, 0] / top, elastic / force, color="grey", linestyle=":", label="elastic part f")
    lines, events = case.lines(native.mesh(native.WORK_PRESERVING, 5, 5))
    lines = lines[lines["branch"] != native.FREE]
    ends = [*lines["time"][1:], events[-1]["time"]]
    for k, (line, end) in enumerate(zip(lines, ends, strict=True)):
        tau = np.linspace(0.0, end - line["time"], 30)
        motion = native.sample(case.curve, lines[k : k + 1], line["time"] + tau)[0]
        drawn = line_force(line, motion[:, 0]) + line["damping"] * motion[:, 3]  # γ = 0: ξ′ = ν
        left.plot(motion[:, 0] / top, drawn / force, **WORK, label="five lines in, five out" if k == 0 else None)
        left.plot(motion[0, 0] / top, drawn[0] / force, marker=".", color=BLUE)
    left.set(xlabel="indentation ξ/ξ_m", ylabel="force F/F_m", title="Kuwabara–Kono, contact ends at F = 0")
    left.legend(fontsize="small", loc="upper left")
    left.grid(alpha=0.3)
    segments, numbers = np.array([8, 16, 32, 64, 128, 256]), {}
    styles = {"Kuwabara–Kono": (BLUE, "o"), "Tsuji": (ORANGE, "s")}
    for name, law in laws.items():
        for target, dashes in (("half-space", "-"), ("plate", "--")):
            scene = ball(law) if target == "half-space" else on_mild_steel_plate(ball(law))
            each = Case(scene)
            found = np.array(
                [each.error(native.mesh(native.WORK_PRESERVING, int(n), int(n)), "maximum_force") for n in segments]
            )
            numbers[name, target] = slope(segments[2:], found[2:])
            label = f"{name}, {target}: order {numbers[name, target]:.1f}"
            colour, marker = styles[name]
            right.loglog(segments, found, color=colour, marker=marker, markersize=4, linestyle=dashes, label=label)
    right.set(xlabel="segments of a leg", ylabel="relative error of the maximum force", title="order of damped laws")
    right.legend(fontsize="small")
    right.grid(alpha=0.3)
    return figure, numbers


# ---------------------------------------------------------------- friction


def oblique_figure() -> tuple[Figure, dict]:
    """Friction force of four impacts between its limits, and the path of force and displacement that it follows."""
    figure = Figure(figsize=(9.5, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
    ratio, friction, numbers = 1.7 / 1.4, 0.2, {}  # κ of alike bodies, µ
    for before, colour in ((0.4, BLUE), (1.5, GREEN), (3.6, PURPLE), (6.0, ORANGE)):
        ball = fm.Sphere("5 mm", "3 m/s", material=steel, angle=f"{math.atan(ratio * friction * before)!r} rad")
        contact, still = fm.Contact("hertz", friction=friction), fm.Effects(gravity=False)
        history = fm.simulate(fm.Scene(ball, fm.HalfSpace(steel), contact, still))
        oblique, clock = history.oblique, history.duration
        t, v = (oblique.motion[name] for name in ("time", "sliding_velocity"))
        q = oblique.motion["friction_force"] / (friction * history.summary["maximum_force"])
        way = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
        unit = ratio * friction * history.summary["maximum_indentation"]
        left.plot(t / clock, q, color=colour, linewidth=1.3, label=f"ψ₁ = {before:g}")
        right.plot(way / unit, q, color=colour, linewidth=1.3)
        for time, _ in oblique.events:
            left.plot(time / clock, np.interp(time, t, q), marker=".", color=colour)
            right.plot(np.interp(time, t, way) / unit, np.interp(time, t, q), marker=".", color=colour)
        unit = ratio * friction * history.scene.approach_velocity
        numbers[before] = oblique.summary["contact_point_rebound_velocity"] / unit
    limit = history.sample_si(times := np.linspace(0.0, clock, 400)).contact_force / history.summary["maximum_force"]
    left.fill_between(times / clock, -limit, limit, color="0.92", linewidth=0.0, label="up to µF")
    left.set(xlabel="time over that of contact", ylabel="friction force Q/(µ F_m)", title="dots: events")
    right.set(xlabel="displacement Δ/(κ µ δ_m)", ylabel="friction force Q/(µ F_m)")
    left.legend(fontsize="small", loc="lower left")
    for axes in (left, right):
        axes.grid(alpha=0.3)
    return figure, numbers


FIGURES = {
    "method_lines": lines_figure,
    "method_order": convergence_figure,
    "method_gradings": gradings_figure,
    "method_regimes": regimes_figure,
    "method_turn": turn_figure,
    "method_loops": loop_figure,
    "method_damping": damping_figure,
    "method_oblique": oblique_figure,
}


def main(folder: str | Path = "docs") -> dict[str, dict]:
    """Write method_*.png; the numbers of each figure by its name."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    numbers = {}
    for name, draw in FIGURES.items():
        figure, numbers[name] = draw()
        drawn = io.BytesIO()
        figure.savefig(drawn, dpi=DPI)
        Image.open(drawn).convert("RGB").quantize(COLOURS).save(Path(folder) / f"{name}.png", optimize=True)
    return numbers


if __name__ == "__main__":
    for figure_name, found in main(*sys.argv[1:2]).items():
        print(figure_name, found)

"""The error estimate of impacts on random structures against impacts on vibrations by other methods.

    python -m benchmarks.random_structures [COUNT] [SEED] [ACCURACY] [FIRST]

Plates (isotropic, orthotropic, on springs or a bed, any edges, damped or not), beams of three theories and rods; 10 g
to 3 kg, 0.1 to 10 m/s, laws that retrace, yield or are damped. The reference is the impact on the vibrations of
`other_modes.py` and `other_plates.py`, with more of them and shorter steps. Its own error is its difference to one with
fewer, made anew; an impact is judged if that is below a third of the estimate. FIRST: number of the first to follow.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

import film_model as fm
from benchmarks.other_modes import OtherModes, of_beam, of_rod
from benchmarks.other_plates import COARSE, FINE, Statics, of_plate
from film_model.base.errors import SimulationError
from film_model.core.modal import Tables
from film_model.laws import LAWS
from film_model.laws.example_ball import example_law
from film_model.problem.problem import Problem
from film_model.problem.summary import differences
from film_model.solve import structures
from film_model.solve.simulate import simulate_quietly
from film_model.solve.vibration import Vibration, run

ACCURACY = 1e-4
DOUBT = 1.0 / 3.0
MORE, FEWER = (1.5, 3.0), 2.0**0.5
"""Highest frequency of the reference over that of the impact, and over that of the reference with fewer vibrations."""

MANY = 8000
"""Vibrations beyond which the reference has the lesser of these."""

SHORTER = 10.0
"""Tolerance of the impact's steps over that of the reference's."""

EDGES = ("simply supported", "clamped", "free")
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3", yield_strength="1 GPa")
ALUMINIUM = fm.Material("aluminium", "70 GPa", 0.33, "2700 kg/m^3", yield_strength="300 MPa")
LAW_NAMES = ("hertz", "stronge", "walton-braun", "big-alabo", "hunt-crossley")
ON_EDGES = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)


class Judged(NamedTuple):
    """An impact: its estimate, its error, that of the reference, the numbers of vibrations of both, and the errors of
    the three values with the largest."""

    estimate: float
    error: float
    doubt: float
    modes: tuple[int, int]
    worst: dict[str, float]

    @property
    def clear(self) -> bool:
        """Whether the reference tells the error."""
        return self.doubt < DOUBT * self.estimate


def random_structures(count: int, seed: int) -> Iterator[fm.Scene]:
    """Scenes on random plates, beams and rods."""
    draw = np.random.default_rng(seed)
    for _ in range(count):
        kind = draw.random()
        target = _plate(draw) if kind < 0.65 else _beam(draw) if kind < 0.9 else _rod(draw)
        ball = fm.Sphere("10 mm", f"{10.0 ** draw.uniform(-1, 1):.4g} m/s", material=STEEL, mass=_mass(draw))
        law = example_law(LAWS[str(draw.choice(LAW_NAMES))])
        yield fm.Scene(ball, target, fm.Contact(law), ON_EDGES)


def _mass(draw: np.random.Generator) -> str:
    return f"{10.0 ** draw.uniform(-2, 0.5):.4g} kg"


def _material(draw: np.random.Generator) -> fm.Material:
    return (STEEL, ALUMINIUM)[draw.integers(2)]


def _damping(draw: np.random.Generator) -> float | None:
    return None if draw.random() < 0.7 else float(f"{10.0 ** draw.uniform(-4, -1):.3g}")


def _plate(draw: np.random.Generator) -> fm.Plate:
    """A third with simply supported edges, the others with any."""
    sides = draw.uniform(60.0, 400.0, 2)
    edges = [EDGES[0]] * 4 if draw.random() < 0.33 else [str(edge) for edge in draw.choice(EDGES, 4)]
    free = [edge == "free" for edge in edges]
    low, high = (np.where(free[k::2], (0.0, 1.0)[k], (0.1, 0.9)[k]) for k in (0, 1))
    options: dict[str, Any] = {
        "size": [f"{side:.4g} mm" for side in sides],
        "position": [
            f"{float(f'{side:.4g}') * at:.6g} mm" for side, at in zip(sides, draw.uniform(low, high), strict=True)
        ],
        "edges": edges,
        "damping_ratio": _damping(draw),
    }
    if any(free) and draw.random() < 0.2:
        springs = [f"{10.0 ** draw.uniform(4, 7):.3g} N/m^2" if each else "0 N/m^2" for each in free]
        options["edge_stiffness"] = springs
    if draw.random() < 0.15:
        options["foundation_stiffness"] = f"{10.0 ** draw.uniform(5, 8):.3g} N/m^3"
    if draw.random() < 0.25:
        d11, d22 = 10.0 ** draw.uniform(0.5, 3.0, 2)
        mean = float(np.sqrt(d11 * d22))
        values = (d11, 0.2 * mean * draw.random(), d22, mean * draw.uniform(0.1, 0.5))
        stiff = {name: f"{value:.4g} N*m" for name, value in zip(("D11", "D12", "D22", "D66"), values, strict=True)}
        return fm.Plate(
            ALUMINIUM, mass_per_area=f"{draw.uniform(2, 20):.4g} kg/m^2", bending_stiffness=stiff, **options
        )
    return fm.Plate(_material(draw), f"{draw.uniform(1.0, 10.0):.3g} mm", **options)


def _beam(draw: np.random.Generator) -> fm.Beam:
    length = f"{draw.uniform(60.0, 400.0):.4g} mm"
    ends: Any = [str(end) for end in draw.choice(EDGES, 2)]
    place = f"{float(length[:-3]) * draw.uniform(0.1, 0.9):.6g} mm"
    theory: Any = str(draw.choice(["timoshenko", "timoshenko", "euler-bernoulli", "plate"]))
    width = "40 mm" if theory == "plate" else "10 mm"
    thick = f"{draw.uniform(1.0, 10.0):.3g} mm"
    return fm.Beam(
        _material(draw), length, width, thick, ends=ends, position=place, theory=theory, damping_ratio=_damping(draw)
    )


def _rod(draw: np.random.Generator) -> fm.Rod:
    return fm.Rod(
        _material(draw),
        f"{draw.uniform(5.0, 30.0):.3g} mm",
        length=f"{draw.uniform(50.0, 1000.0):.4g} mm",
        far_end=("free", "fixed")[draw.integers(2)],
    )


def judged(scene: fm.Scene, accuracy: float) -> Judged:
    """The estimate and the error of one impact; SimulationError for one that cannot be simulated."""
    history = simulate_quietly(scene, accuracy=accuracy)
    own, problem = history.vibration, history.problem
    assert isinstance(own, Vibration)
    most = other_modes(scene.target, float(np.clip(MANY / own.modes, *MORE)) * own.highest)
    least = other_modes(scene.target, most.highest / FEWER, COARSE)
    fine, coarse = (
        run(problem, _structure(scene.target, modes, problem), own.start.tolerance / SHORTER, own.start.limit, False)
        for modes in (most, least)
    )
    errors, doubts = (differences(problem, each.summary, fine.summary) for each in (own, coarse))
    worst = dict(sorted(errors.items(), key=lambda item: -item[1])[:3])
    modes = own.modes, most.frequency.size
    return Judged(history.accuracy.estimated, max(errors.values()), max(doubts.values()), modes, worst)


def other_modes(target: Any, highest: float, statics: Statics = FINE) -> OtherModes:
    """Vibrations by other methods up to `highest` [rad/s], or up to what can be computed in about two seconds."""
    if isinstance(target, fm.Rod):
        return of_rod(target, highest)
    slender = isinstance(target, fm.Beam) and not target.wide
    return of_beam(target, highest) if slender else of_plate(target, highest, statics)


def _structure(target: Any, modes: OtherModes, problem: Problem) -> structures.Structure:
    """These vibrations as the core takes them."""
    ratio = np.full(modes.frequency.size, getattr(target, "damping_ratio", None) or 0.0)
    tables = Tables(modes.frequency, modes.share, ratio, structures.rounded(problem.scales.time))
    found = structures.Structure(modes.highest, tables, 0.0, modes.omitted, tables)
    return found.softer if modes.omitted else found


def main() -> None:
    """The study, with a line for each impact whose error is above its estimate."""
    given = sys.argv[1:]
    count, seed, accuracy, first = (
        kind(given[k]) if k < len(given) else default
        for k, (kind, default) in enumerate(((int, 1000), (int, 1), (float, ACCURACY), (int, 0)))
    )
    found, refused, begin = list[Judged](), 0, time.process_time()
    for number, scene in enumerate(random_structures(int(count), int(seed))):
        if number < first:
            continue
        try:
            one = judged(scene, accuracy)
        except SimulationError as error:
            refused += 1
            print(f"{number}: refused: {error}", flush=True)
            continue
        found.append(one)
        if one.clear and one.error > one.estimate:
            print(f"{number}: {one} {scene}", flush=True)
        if number % 50 == 49:
            _tell(found, refused, accuracy, time.process_time() - begin)
    _tell(found, refused, accuracy, time.process_time() - begin)


def _tell(found: list[Judged], refused: int, accuracy: float, spent: float) -> None:
    clear = [one for one in found if one.clear]
    bound = sum(one.error <= one.estimate for one in clear)
    middle, most = np.quantile([one.error / one.estimate for one in clear] or [0.0], [0.5, 0.99])
    reached = sum(one.estimate <= accuracy for one in found)
    print(
        f"{len(found) + refused} impacts: {refused} refused, {reached} reach the accuracy, {len(clear)} judged, "
        f"{bound} bounded, {len(found) - len(clear)} without a clear reference; error over estimate: "
        f"median {middle:.2f}, 99 % {most:.2f}; {spent:.0f} s",
        flush=True,
    )


if __name__ == "__main__":
    main()

"""The error estimate of impacts on random structures against their true error.

    python -m benchmarks.random_structures [COUNT] [SEED]

Plates (isotropic, orthotropic, on springs or a bed, any edges, damped or not), beams of three theories and rods; 10 g
to 3 kg, 0.1 to 10 m/s, laws that retrace, yield or are damped. The true error is the difference to a run at a thirtieth
of the accuracy; an impact is judged if that run's own estimate is below a third of the first one's.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

import film_model as fm
from film_model.base.errors import SimulationError
from film_model.laws import LAWS
from film_model.laws.example_ball import example_law
from film_model.problem.summary import differences
from film_model.solve.simulate import simulate_quietly

FINER = 30.0
DOUBT = 1.0 / 3.0
EDGES = ("simply supported", "clamped", "free")
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3", yield_strength="1 GPa")
ALUMINIUM = fm.Material("aluminium", "70 GPa", 0.33, "2700 kg/m^3", yield_strength="300 MPa")
LAW_NAMES = ("hertz", "stronge", "walton-braun", "big-alabo", "hunt-crossley")
ON_EDGES = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)


class Judged(NamedTuple):
    """An impact: its estimate, its error, the estimate of the finer run, and both numbers of modes."""

    estimate: float
    error: float
    finer: float
    modes: tuple[int, int]


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
    rough, fine = (simulate_quietly(scene, accuracy=value) for value in (accuracy, accuracy / FINER))
    assert rough.vibration is not None and fine.vibration is not None
    changes = differences(rough.problem, rough.vibration.summary, fine.vibration.summary)
    modes = rough.vibration.modes, fine.vibration.modes
    return Judged(rough.accuracy.estimated, max(changes.values()), fine.accuracy.estimated, modes)


def main() -> None:
    """The study, with a line for each impact whose error is above its estimate."""
    count, seed, accuracy = [*(int(word) for word in sys.argv[1:3]), *(1000, 1)[len(sys.argv[1:3]) :], 3e-3][:3]
    found, refused, begin = list[Judged](), dict[str, int](), time.process_time()
    for number, scene in enumerate(random_structures(int(count), int(seed))):
        try:
            one = judged(scene, accuracy)
        except SimulationError as error:
            refused[str(error)] = refused.get(str(error), 0) + 1
            print(f"{number}: refused: {error}", flush=True)
            continue
        found.append(one)
        if one.error > one.estimate and one.finer < DOUBT * one.estimate:
            print(f"{number}: {one} {scene}", flush=True)
        if number % 50 == 49:
            _tell(found, refused, number + 1, time.process_time() - begin)
    _tell(found, refused, int(count), time.process_time() - begin)


def _tell(found: list[Judged], refused: dict[str, int], count: int, spent: float) -> None:
    clear = [one for one in found if one.finer < DOUBT * one.estimate]
    bound = sum(one.error <= one.estimate for one in clear)
    ratio = [one.error / one.estimate for one in clear] or [0.0]
    middle, most = np.quantile(ratio, [0.5, 0.99])
    reached = sum(one.estimate <= 3e-3 for one in found)
    print(
        f"{count} impacts: {sum(refused.values())} refused, {reached} reach the accuracy, {len(clear)} judged, "
        f"{bound} bounded; error over estimate: median {middle:.2f}, 99 % {most:.2f}; {spent:.0f} s",
        flush=True,
    )


if __name__ == "__main__":
    main()

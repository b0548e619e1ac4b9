"""The cost of effects, which is zero for an effect that is off: `python -m benchmarks.effects [--json FILE]`.

The scene is an elastic ball on a half-space. First the whole simulation: with every effect on "auto", with every effect
switched off, and without the choice of effects (the problem is assembled directly). Then one effect at a time: the
core's march and the whole simulation with the effect, relative to the same without it. Last, viscoelastic bodies: the
contact in the core at two tolerances, one impact of a batch of 200, and one simulation, against the elastic contact of
the same scene. The cases run in turn; times are the minimum over many rounds. They are printed, never asserted.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import film_model as fm
from film_model.core import native
from film_model.effects.choose import choose, problem_of
from film_model.laws import Hertz
from film_model.solve.accuracy import mesh_of
from film_model.solve.simulate import simulate, simulate_chosen

STEEL = {
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "density": "7850 kg/m^3",
    "yield_strength": "1 GPa",
}
SWITCHES = ("plasticity", "target_motion", "gravity")


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and write the rows as JSON if asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.effects", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--rounds", type=int, default=400, help="of ten calls each (default: 400)")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the rows there")
    options = parser.parse_args(arguments)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    off, on = elastic(options.rounds), effects(options.rounds)
    print("elastic half-space, one simulation of accuracy 1e-4        µs")
    for name, seconds in off.items():
        print(f"  {name:52}{1e6 * seconds:9.1f}")
    print("\neffect on, over off                lines   march   a line   simulate")
    for name, row in on.items():
        lines, march = row["lines"], row["march"]
        print(f"  {name:32}{lines:6.2f}{march:8.2f}{march / lines:9.2f}{row['simulate']:11.2f}")
    relaxing = viscoelastic(max(options.rounds // 10, 3))
    print("\nviscoelastic ball, one impact                              µs")
    for name, seconds in relaxing.items():
        print(f"  {name:52}{1e6 * seconds:9.1f}")
    if options.json is not None:
        options.json.write_text(json.dumps({"elastic": off, "effects": on, "viscoelastic": relaxing}, indent=1) + "\n")
    return 0


def scene(velocity: str, target: fm.HalfSpace | fm.Plate, **switches: Any) -> fm.Scene:
    """A steel ball of 2 mm on a target of steel."""
    chosen: dict[str, Any] = {**dict.fromkeys(SWITCHES, False), **switches}
    ball = fm.Sphere("2 mm", velocity=velocity, material=STEEL)
    return fm.Scene(ball, target, effects=fm.Effects(**chosen))


def elastic(rounds: int) -> dict[str, float]:
    """Seconds of one simulation of an elastic impact on a half-space."""
    auto = scene("40 mm/s", fm.HalfSpace(STEEL), **dict.fromkeys(SWITCHES, "auto"))
    off = scene("40 mm/s", fm.HalfSpace(STEEL))
    assert auto.effective_modulus is not None
    law = Hertz(auto.effective_modulus, auto.effective_radius)
    assert problem_of(auto).start.load == 0.0 and problem_of(auto).law == law

    choice = choose(auto)
    calls: dict[str, Callable[[], object]] = {
        "every effect on auto": lambda: simulate(auto),
        "every effect switched off": lambda: simulate(off),
        "effects chosen beforehand": lambda: simulate_chosen(choice, auto.solver),
        "the report of effects, only when it is asked for": lambda: choose(auto).effects,
    }
    return best(calls, rounds)


def effects(rounds: int) -> dict[str, dict[str, float]]:
    """Segments and times of an impact with an effect, relative to those without."""
    half = fm.HalfSpace(STEEL)
    pairs = [
        ("plasticity", scene("0.25 m/s", half)),
        ("target_motion", scene("40 mm/s", fm.Plate(STEEL, thickness="4 mm"))),
        ("target_motion", scene("40 mm/s", fm.Plate(STEEL, thickness="0.8 mm"))),
        ("gravity", scene("4 mm/s", half)),
    ]
    rows: dict[str, dict[str, float]] = {}
    for switch, without in pairs:
        full = without.replace({f"effects.{switch}": True})
        effect = next(e for e in choose(full).effects if e.name == switch)
        name = f"{switch.replace('_', ' ')}, {effect.indicator} = {effect.value:.2g}"
        lines = [float(simulate(s).accuracy.lines) for s in (full, without)]
        march = best({str(k): _march(s) for k, s in enumerate((full, without))}, rounds)
        whole = best({str(k): (lambda s=s: simulate(s)) for k, s in enumerate((full, without))}, rounds)
        rows[name] = {
            "lines": lines[0] / lines[1],
            "march": march["0"] / march["1"],
            "simulate": whole["0"] / whole["1"],
        }
    return rows


def viscoelastic(rounds: int) -> dict[str, float]:
    """Seconds of one impact of a rubber ball with one and with three relaxation times, and of the elastic contact."""
    calls: dict[str, Callable[[], object]] = {}
    series = {1: [[0.5, "1 ms"]], 3: [[0.2, "0.1 ms"], [0.2, "1 ms"], [0.2, "10 ms"]]}
    speeds = [f"{0.5 + 0.01 * k} m/s" for k in range(200)]
    for count, prony in series.items():
        rubber = fm.Material("rubber", "50 MPa", 0.49, "1100 kg/m^3", prony=prony)
        given = fm.Scene(fm.Sphere("10 mm", velocity="1 m/s", material=rubber), fm.HalfSpace(STEEL))
        problem, many = problem_of(given), f"{count} relaxation times"
        for tolerance in (1e-3, 1e-4):
            calls[f"core, {many}, tolerance {tolerance:g}"] = lambda p=problem, t=tolerance: p.relax(t)
        calls[f"simulate, {many}"] = lambda s=given: simulate(s)
        calls[f"batch of 200, {many}"] = lambda s=given: fm.simulate_batch(s, velocity=speeds)
    off = given.replace({"effects.viscoelasticity": False})
    mesh, elastic_problem = native.mesh(native.WORK_PRESERVING, 12, 12), problem_of(off)
    calls["core, elastic, 24 segments"] = lambda: elastic_problem.march(mesh)
    calls["simulate, elastic"] = lambda: simulate(off)
    calls["batch of 200, elastic"] = lambda: fm.simulate_batch(off, velocity=speeds)
    found = best(calls, rounds)
    return {name: seconds / (200 if "batch" in name else 1) for name, seconds in found.items()}


def _march(given: fm.Scene) -> Callable[[], object]:
    """The march in the core on the mesh that the accuracy takes."""
    history = simulate(given)
    problem, accuracy = history.problem, history.accuracy
    mesh = mesh_of(given.solver, (accuracy.segments, accuracy.unloading_segments))
    start = problem.start
    return lambda: [native.impact(problem.curve.native, mesh, start) for _ in range(10)]


def best(calls: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Seconds per call: the minimum over rounds, in each of which every case makes ten calls."""
    least = dict.fromkeys(calls, math.inf)
    for _ in range(rounds):
        for name, call in calls.items():
            begun = time.perf_counter()
            for _ in range(10):
                call()
            least[name] = min(least[name], (time.perf_counter() - begun) / 10)
    return least


if __name__ == "__main__":
    raise SystemExit(main())

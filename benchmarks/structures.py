"""Impacts on structures: the core's contact on modes, and integrators on the same modes, in one process.

    python -m benchmarks.structures [--slow]

Prints milliseconds of processor time, the best of several runs, and the relative error of the maximum force and of the
time at which the first contact ends. With --slow also the scenes of heavy impactors on thin plates.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import film_datasets as fd
import film_model as fm
from benchmarks.modal_integrators import dormand_prince, newmark
from film_model.base import units
from film_model.effects.choose import problem_of
from film_model.solve import structures, vibration
from film_model.studies import modal_reference
from film_model.targets import panel_statics, ritz

OLSSON = fm.Scene.from_toml(Path(__file__).parent.parent / "examples" / "scenes" / "olsson_plate.toml")
HIGHEST = 4e6  # rad/s: 671 modes of the paper's plate
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
GLASS = fm.Material("glass", "70 GPa", 0.23, "2500 kg/m^3")
ALUMINIUM = fm.Material("aluminium", "70 GPa", 0.33, "2700 kg/m^3")
EDGES = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)


def timed(run: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Least processor time of a call in ms, and its result."""
    best, found = np.inf, None
    for _ in range(repeats):
        begin = time.process_time()
        found = run()
        best = min(best, time.process_time() - begin)
    return 1e3 * best, found


def papers_plate() -> None:
    """The paper's plate, 200 mm by 200 mm."""
    problem = problem_of(OLSSON)
    structure = structures.structure_of(OLSSON.target, HIGHEST, problem.scales.time)
    scales, tables = problem.scales, structure.tables
    exact = vibration.run(problem, structure, 1e-11, 1.0).summary
    rest, frequency = structure.omitted * scales.force / scales.length, tables.frequency * scales.time
    share = tables.share * problem.mass
    print(f"paper's plate, {tables.count} modes")

    def tell(name: str, milliseconds: float, force: float, end: float) -> None:
        errors = force / exact.maximum_force - 1.0, end / exact.contact_duration - 1.0
        print(f"  {name:30} {milliseconds:10.2f} ms   errors {errors[0]:9.1e} {errors[1]:9.1e}")

    for tolerance in (1e-3, 1e-5, 1e-7):
        spent, run = timed(lambda tolerance=tolerance: vibration.run(problem, structure, tolerance, 1.0), 7)
        tell(f"core, tolerance {tolerance:g}", spent, run.summary.maximum_force, run.summary.contact_duration)
    for tolerance in (1e-4, 1e-6):

        def dop853(tolerance: float = tolerance) -> Any:
            return modal_reference.integrate(problem, frequency, share, rest, 1.0, 1.0 / scales.time, tolerance)

        spent, run = timed(dop853, 1)
        tell(f"DOP853, tolerance {tolerance:g}", spent, run.summary.maximum_force, run.summary.contact_duration)
    for steps in (2000, 8000):
        end = 1.5 * exact.contact_duration
        spent, found = timed(lambda n=steps, end=end: newmark(problem.approach, frequency, share, rest, end, n), 1)
        tell(f"Newmark, {steps} steps, one contact", spent, *found)
    if find_spec("numba"):
        dormand_prince(problem.approach, frequency, share, rest, 1e-2)  # compiles
    for tolerance in (1e-4, 1e-6) if find_spec("numba") else ():

        def compiled(tolerance: float = tolerance) -> Any:
            return dormand_prince(problem.approach, frequency, share, rest, tolerance)

        spent, found = timed(compiled, 3)
        tell(f"numba, {tolerance:g}, one contact", spent, *found)


def whole(name: str, scene: fm.Scene, accuracy: float) -> None:
    """A simulation with its choice of modes, the structure kept from a first one."""
    fm.simulate(scene, accuracy=accuracy)
    spent, history = timed(lambda: fm.simulate(scene, accuracy=accuracy), 3)
    run = history.vibration
    error = history.accuracy.estimated
    print(f"  {name:22} {spent:9.1f} ms  {run.modes:6} modes, {run.contacts:3} contacts, estimated {error:.0e}")


def struck(target: fm.Plate | fm.Beam) -> fm.Scene:
    """A steel ball at 1 m/s on a target."""
    return fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), target, fm.Contact("hertz"))


def pane(**entries: Any) -> fm.Plate:
    """An aluminium plate of 200 x 200 x 4 mm."""
    return fm.Plate("aluminium 6061-T6", "4 mm", size=["200 mm", "200 mm"], **entries)


def forget() -> None:
    """Drop all vibrations and static deflections that are kept."""
    structures.forget()
    ritz.unit_modes.cache_clear()
    panel_statics.unit_compliance.cache_clear()


def cold(scene: fm.Scene) -> fm.History:
    """A simulation with vibrations that are not kept."""
    forget()
    return fm.simulate(scene)


def refused(scene: fm.Scene) -> str:
    """The sentence with which a scene is refused; an error if it is not."""
    try:
        fm.simulate(scene)
    except fm.SimulationError as error:
        return str(error)
    raise AssertionError("the scene is simulated")


def swept(scene: fm.Scene, path: str, low: str, high: str, rows: int) -> Any:
    """A sweep of one entry on one worker."""
    return fd.sweep(scene, {path: {"from": low, "to": high, "count": rows}}, workers=1)


def bars() -> None:
    """Single times that should not grow."""
    both = OLSSON.replace({"effects.boundary_reflections": True, "effects.target_inertia": True})
    tsuji = both.replace({"contact.law": "tsuji", "contact.restitution": 0.8})
    print("simulate() on the paper's plate, structure kept")
    for name, scene, accuracy in (("hertz", both, 1e-4), ("hertz", both, 1e-6), ("tsuji", tsuji, 1e-4)):
        whole(f"{name}, {accuracy:g}", scene, accuracy)
    corner = struck(pane(edges="clamped", position=["70 mm", "55 mm"]))
    print("clamped plate of 200 x 200 x 4 mm, struck off centre")
    print(f"  simulate(), nothing kept     {timed(lambda: cold(corner), 3)[0]:9.1f} ms")
    for low, high in (("3 mm", "6 mm"), ("1 mm", "20 mm")):
        forget()
        for name in ("first sweep", "again"):
            spent, _ = timed(lambda low=low, high=high: swept(corner, "target.thickness", low, high, 20), 1)
            print(f"  20 thicknesses, {low} to {high}, {name:12} {spent / 20:9.1f} ms a row")
    sensors = [{"name": "a", "position": ["40 mm", "40 mm"]}, {"name": "b", "position": ["120 mm", "90 mm"]}]
    sensed = struck(pane(sensors=sensors))
    spent, _ = timed(lambda: swept(sensed, "impactor.velocity", "0.1 m/s", "3 m/s", 1000), 3)
    print(f"1000 velocities, two sensors, simply supported plate: {spent:.0f} ms")
    size = {"length": "10 m", "width": "5 mm", "thickness": "3 mm"}
    long = struck(fm.Beam(material="aluminium 6061-T6", **size, ends="clamped", position="0.3 m"))
    spent, sentence = timed(lambda: refused(long), 3)
    print(f"refusal of a long beam: {spent:.0f} ms ({sentence[:60]} ...)")


def main() -> None:
    """The table."""
    bars()
    papers_plate()
    print("simulate() at an accuracy of 1e-3, structure kept")
    whole("paper's plate", OLSSON, 1e-3)
    glass = fm.Plate(GLASS, "4 mm", size=["1 m", "1 m"])
    ball = fm.Sphere("25 mm", "4.43 m/s", material=STEEL, mass="500 g")
    whole("glass pane, 500 g", fm.Scene(ball, glass, fm.Contact("hertz"), EDGES), 1e-3)
    for mass in ("0.2 kg", "0.5 kg", "1 kg", "2 kg", "3 kg", "5 kg") if "--slow" in sys.argv else ():
        for thickness in ("1 mm", "2 mm", "4 mm", "8 mm"):
            plate = fm.Plate(ALUMINIUM, thickness, size=["150 mm", "100 mm"])
            ball = fm.Sphere("12 mm", "2 m/s", material=STEEL, mass=mass)
            whole(f"{mass} on {thickness}", fm.Scene(ball, plate, fm.Contact("hertz"), EDGES), 1e-3)
    speeds = units.quantity(np.linspace(0.1, 1.0, 2000), "velocity")
    scene = OLSSON.replace({"effects.boundary_reflections": True, "effects.target_inertia": True})
    for accuracy in (1e-3, 1e-4):
        spent, _ = timed(lambda asked=accuracy: fm.simulate_batch(scene, velocity=speeds, accuracy=asked), 1)
        print(f"2000 velocities on the plate at {accuracy:g}: {2e6 / spent:.0f} impacts a second of processor time")


if __name__ == "__main__":
    main()

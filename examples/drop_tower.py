"""A system-level co-simulation: the impact FMU on a carriage that is another FMU, of another exporter.

A ball hits a slab on a carriage with a spring and a damper, which moves during contact. A small master couples the two
FMUs at macro steps, in three ways:

* parallel: each receives the other's output from the beginning of the step;
* in turn: the carriage receives the contact force from the end of the step;
* balanced: the ball receives the carriage's velocity extrapolated to the middle of the step, and the carriage the mean
  force, computed from the ball's change of momentum.

Errors are of first order in the step, balanced of second. The reference is the coupled equations by DOP853.
"""

import math
import shutil
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from pythonfmu.builder import FmuBuilder
from scipy.integrate import OdeSolution, solve_ivp

import film_model as fm
import fmu_wrapper
from film_model.laws.hertz import hertz_stiffness
from film_model.plot.style import COLOURS, HIGHLIGHT

CARRIAGE = Path(__file__).parent / "fmus" / "carriage.py"
CARRIAGE_MASS, STIFFNESS, DAMPING = 0.5, 2e5, 20.0  # kg, N/m, N s/m
WAY_COLOURS = (COLOURS[1], COLOURS[0], HIGHLIGHT)
STEPS = (10, 20, 40, 80, 160, 320)
END = 130e-6  # s, after the contact


def scene() -> fm.Scene:
    """An elastic impact, so that the reference is a plain differential equation."""
    return fm.Scene(
        fm.Sphere(radius="10 mm", velocity="0.25 m/s", material="WC, Big-Alabo 2017"),
        fm.HalfSpace("mild steel"),
        contact=fm.Contact(law="hertz"),
        effects=fm.Effects(gravity=False),
        solver=fm.Solver(accuracy=1e-8),
        title="Ball on a carriage",
    )


class Unit:
    """One FMU under the master, by the names of its variables."""

    def __init__(self, path: Path, folder: Path) -> None:
        description = read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=extract(str(path), str(folder)),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=path.stem,
        )
        self.messages: set[bytes] = set()
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self.log)
        self.slave.instantiate(callbacks=self.callbacks)

    def log(self, _environment: int, _name: bytes, _status: int, _category: bytes, message: bytes) -> None:
        """Print a message of the FMU, each once: every run after a reset repeats it."""
        if message not in self.messages:
            print(message.decode())
        self.messages.add(message)

    def start(self, **values: float) -> None:
        """Set parameters and initialize."""
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        for name, value in values.items():
            self.set(name, value)
        self.slave.exitInitializationMode()

    def set(self, name: str, value: float) -> None:
        """Set a variable."""
        self.slave.setReal([self.references[name]], [value])

    def get(self, name: str) -> float:
        """A variable's value."""
        return self.slave.getReal([self.references[name]])[0]


def couple(impact: Unit, carriage: Unit, mass: float, steps: int, how: str) -> list[tuple[float, float]]:
    """Velocities [m/s] of ball and carriage after each of this many macro steps."""
    for unit in (impact, carriage):
        unit.slave.reset()
    impact.start()
    carriage.start(mass=CARRIAGE_MASS, stiffness=STIFFNESS, damping=DAMPING)
    size, last, told = END / steps, 0.0, []
    for n in range(steps):
        now, before, force = carriage.get("velocity"), impact.get("impactor_velocity"), impact.get("contact_force")
        impact.set("support_velocity", 1.5 * now - 0.5 * last if how == "balanced" else now)
        impact.slave.doStep(n * size, size)
        if how == "in turn":
            force = impact.get("contact_force")
        elif how == "balanced":
            force = mass * (before - impact.get("impactor_velocity")) / size
        carriage.set("force", force)
        carriage.slave.doStep(n * size, size)
        last = now
        told.append((impact.get("impactor_velocity"), carriage.get("velocity")))
    return told


def reference(on: fm.Scene) -> OdeSolution:
    """The same from the coupled equations, over time: indentation, ball, carriage and its velocity."""
    stiffness = hertz_stiffness(on.effective_modulus, on.effective_radius)

    def rates(t: float, y: np.ndarray) -> list[float]:
        indentation, ball, z, v = y
        force = stiffness * max(indentation, 0.0) ** 1.5
        return [ball - v, -force / on.mass, v, (force - DAMPING * v - STIFFNESS * z) / CARRIAGE_MASS]

    start = [0.0, on.approach_velocity, 0.0, 0.0]
    return solve_ivp(
        rates, (0.0, END), start, "DOP853", rtol=1e-12, atol=1e-16, max_step=END / 500, dense_output=True
    ).sol


def main() -> dict[str, list[float]]:
    """The largest error of either velocity over the approach velocity, by coupling, for each number of steps."""
    on = scene()
    exact = reference(on)
    errors: dict[str, list[float]] = {"parallel": [], "in turn": [], "balanced": []}
    folder = Path(tempfile.mkdtemp())
    try:
        own = fmu_wrapper.export(on, folder / "impact.fmu", fmi_version=2)
        other = FmuBuilder.build_FMU(CARRIAGE, dest=folder)
        impact, carriage = Unit(own, folder / "impact"), Unit(Path(other), folder / "carriage")
        for name, found in errors.items():
            for steps in STEPS:
                told = np.array(couple(impact, carriage, on.mass, steps, name))
                true = exact(END / steps * np.arange(1, steps + 1))[[1, 3]].T
                found.append(float(np.abs(told - true).max() / on.approach_velocity))
        for unit in (impact, carriage):
            unit.slave.terminate()
            unit.slave.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return errors


def draw(errors: dict[str, list[float]], path: str | Path) -> None:
    """The convergence plot."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.2), layout="constrained")
    panel = figure.add_subplot()
    sizes = END / np.array(STEPS) * 1e6
    for (name, found), colour, order in zip(errors.items(), WAY_COLOURS, (1, 1, 2), strict=True):
        panel.loglog(sizes, found, "o-", color=colour, label=name)
        panel.loglog(sizes, found[-1] * (sizes / sizes[-1]) ** order, ":", color=colour, label=f"order {order}")
    panel.set(xlabel="macro step (µs)", ylabel="largest error of a velocity / approach velocity")
    panel.legend(frameon=False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    errors = main()
    print(f"{'steps':>6}" + "".join(f"{name:>12}{'order':>7}" for name in errors))
    for k, steps in enumerate(STEPS):
        cells = ""
        for found in errors.values():
            order = f"{math.log2(found[k - 1] / found[k]):7.2f}" if k else " " * 7
            cells += f"{found[k]:12.2e}{order}"
        print(f"{steps:6}{cells}")
    draw(errors, "drop_tower.png")
    print("wrote drop_tower.png")

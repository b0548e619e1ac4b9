"""A drop height tuned to a peak force by gradients: the FMU under CasADi (pip install "film-model[interop]").

CasADi integrates the FMU's equations of motion with CVODES and differentiates the result with the FMU's directional
derivatives. Newton's method finds the velocity at first touch and the time of the peak, for which the indentation rate
is zero and the force is the one asked for. CasADi does not handle the FMU's events in this, so the law must have one
stage up to the peak, as Hertz's has.

    $ python -m examples.tune_drop_height
"""

from __future__ import annotations

import tempfile
import zipfile
from pathlib import Path

import casadi

import film_model as fm
import fmu_wrapper

SCENE = Path(__file__).parent / "scenes" / "tungsten_carbide_on_steel.toml"
FORCE, GRAVITY = 60.0, 9.80665  # N, m/s²


def tuned(fmi_version: int = 3) -> tuple[float, fm.History]:
    """The drop height, m, and the library's impact at the velocity that belongs to it."""
    scene = fm.Scene.from_toml(SCENE).replace(
        {"contact.law": "hertz", "effects.gravity": True, "impactor.velocity": "0.03 m/s"}
    )
    first = fm.simulate(scene)
    with tempfile.TemporaryDirectory() as folder:
        path = fmu_wrapper.export(scene, Path(folder, "impact.fmu"), fmi_version)
        with zipfile.ZipFile(path) as archive:
            archive.extractall(Path(folder, "extracted"))
        dae = casadi.DaeBuilder("impact", str(Path(folder, "extracted")))
        dae.set_y(["contact_force"])
        model = dae.create("model", ["x", "u"], ["ode", "y"])
        speed, time = scene.approach_velocity, first.summary["time_of_maximum_indentation"]
        assert time is not None
        found = _solve(model, speed, time)
    velocity = found * speed
    history = fm.simulate(scene.replace({"impactor.velocity": f"{velocity} m/s"}), accuracy=1e-8)
    return velocity**2 / (2.0 * GRAVITY), history


def _solve(model: casadi.Function, speed: float, time: float) -> float:
    """Velocity of the peak force FORCE over `speed`; `time` is that of the first guess."""
    x, span, unknown = casadi.MX.sym("x", 3), casadi.MX.sym("span"), casadi.MX.sym("unknown", 2)
    rates, _ = model(x, [0.0, 0.0])
    problem = {"x": x, "p": span, "ode": span * rates}
    march = casadi.integrator("march", "cvodes", problem, 0.0, 1.0, {"abstol": 1e-15, "reltol": 1e-10})
    end = march(x0=casadi.vertcat(0.0, speed * unknown[0], 0.0), p=time * unknown[1])["xf"]
    _, force = model(end, [0.0, 0.0])
    equations = casadi.vertcat(end[1] / speed, force / FORCE - 1.0)
    solve = casadi.rootfinder("solve", "newton", {"x": unknown, "g": equations})
    return float(solve(x0=[1.0, 1.0])["x"][0])


def main() -> None:
    """Print the drop height."""
    height, history = tuned()
    force = history.summary["maximum_force"]
    print(f"drop height {1e3 * height:.4g} mm: {history.scene.approach_velocity:.5g} m/s, peak force {force:.6g} N")


if __name__ == "__main__":
    main()

"""Effects as the package judges them beside numbers that were found without it: a part of docs/effects.md."""

from __future__ import annotations

import math
import re
from typing import Any, NamedTuple

import film_model as fm
from film_model.effects.choose import choose
from film_model.effects.effect import Effect
from film_model.problem.model_intervals import yield_velocities
from film_model.solve.bounce import bounce_quietly
from film_model.solve.simulate import simulate_quietly

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
RIGID = {**STEEL, "youngs_modulus": "99 TPa"}
FINITE_ELEMENTS = "axisymmetric finite elements"


class Row(NamedTuple):
    """A scene, what was counted for it, in which unit and how, and the package's number."""

    scene: str
    quantity: str
    counted: float
    unit: str
    by: str
    found: float


def _on(target: fm.HalfSpace | fm.Plate, material: str | dict[str, Any], velocity: str = "1 m/s") -> fm.Scene:
    return fm.Scene(fm.Sphere("5 mm", material=material, velocity=velocity), target)


def _effect(scene: fm.Scene, name: str) -> Effect:
    return next(effect for effect in choose(scene).effects if effect.name == name)


def _change(scene: fm.Scene, *names: str) -> float:
    """The sum of some changes, %."""
    return 100.0 * sum(_effect(scene, name).change or 0.0 for name in names)


def _said(scene: fm.Scene, name: str, pattern: str) -> float:
    """A number of the reason of an effect."""
    found = re.search(pattern, _effect(scene, name).reason)
    assert found is not None, (name, pattern)
    return float(found[1])


REBOUNDS = {1: 0.688, 2: 0.903, 3: 0.953, 4: 0.971}
"""Thickness over radius, and the restitution of a rigid ball from a steel plate at 1 m/s by finite elements."""


def rows() -> list[Row]:
    """Every comparison."""
    found: list[Row] = []
    for radii, rebound in REBOUNDS.items():
        scene = _on(fm.Plate(STEEL, thickness=f"{5 * radii} mm"), RIGID)
        simulated = simulate_quietly(scene).summary["coefficient_of_restitution"]
        assert simulated is not None
        found.append(
            Row(
                f"rigid ball, 1 m/s, steel plate of thickness {radii} R",
                "energy lost beside the simulated waves (`thickness` and `wave_losses`)",
                100.0 * (simulated**2 - rebound**2),
                "%",
                FINITE_ELEMENTS,
                _change(scene, "thickness", "wave_losses"),
            )
        )
    for speed, lost in (("1 m/s", 1.54), ("5 m/s", 4.00)):
        scene = _on(fm.HalfSpace(STEEL), RIGID, speed)
        where = f"rigid ball of steel's density, {speed}, steel half-space"
        waves = _change(scene, "wave_losses")
        found.append(Row(where, "energy of waves (`wave_losses`)", lost, "%", FINITE_ELEMENTS, waves))
    carbide = _on(fm.HalfSpace({**STEEL, "yield_strength": "250 MPa"}), "WC, Big-Alabo 2017", "5 m/s")
    heated = _said(carbide, "heating", r"by ([0-9.e+]+) K")
    by = "plastic work over a³ of axisymmetric finite elements"
    found.append(
        Row("tungsten carbide on steel of 250 MPa, 5 m/s", "rise of temperature (`heating`)", 11.6, "K", by, heated)
    )
    glass = fm.HalfSpace("soda-lime glass")
    least = _said(_on(glass, "bearing steel"), "fracture", r"glass, ([0-9.e+]+) N")
    by = "Auerbach's law; not traced to a measurement"
    found.append(Row("steel ball, R = 5 mm, on glass", "least force of a crack (`fracture`)", 300.0, "N", by, least))
    summary = simulate_quietly(_on(glass, "bearing steel", "0.01 m/s")).summary
    shear, peak = summary["maximum_shear_stress"], summary["peak_pressure"]
    assert shear is not None and peak is not None
    found.append(Row("steel ball on glass", "largest shear stress", 0.329, "p0", "point loads", shear / peak))
    rough = _on(fm.HalfSpace(STEEL), STEEL, "50 mm/s").replace({"contact.law": "hertz", "contact.roughness": "0.8 um"})
    by = "the model of Greenwood & Tripp, integrated: μ = 4"
    where = "steel ball, 50 mm/s, on steel, roughness of 0.8 µm: α = 0.75"
    found.append(Row(where, "indentation (`roughness`)", 89.0, "%", by, _change(rough, "roughness")))
    for radius, velocity, viscosity in (("3 mm", "0.518 m/s", "0.1 Pa*s"), ("1.5 mm", "0.585 m/s", "10 mPa*s")):
        film = {"contact.fluid_viscosity": viscosity, "contact.roughness": f"{1e-4 * float(radius[:-3])} mm"}
        scene = _on(glass, "bearing steel").replace(
            {"impactor.radius": radius, "impactor.velocity": velocity, "contact.law": "hertz"} | film
        )
        stokes = _effect(scene, "squeeze_film").value
        assert stokes is not None
        found.append(
            Row(
                f"steel ball, R = {radius}, on glass in oil, Stokes number {stokes:.0f}",
                "restitution lost (`squeeze_film`)",
                100.0 * (1.0 - math.exp(-35.0 / stokes)),
                "%",
                "exp(−35/St), fitted to measurements by Legendre et al. 2005",
                _change(scene, "squeeze_film"),
            )
        )
    return found + _yielding() + _falling() + _steep()


def _yielding() -> list[Row]:
    """A rigid ball on a half-space that yields, E/Y = 200: strain hardening, and the second impact on the same dent."""
    found: list[Row] = []
    for exponent, rebound in ((0.1, 0.6054), (0.2, 0.6437)):
        restitution = simulate_quietly(_yields(100, exponent)).summary["coefficient_of_restitution"]
        assert restitution is not None
        where = f"rigid ball at 100 yield velocities, strain hardening exponent {exponent}"
        found.append(Row(where, "restitution (`plasticity`)", rebound, "", FINITE_ELEMENTS, restitution))
    scene = _yields(200, 0.0)
    height = scene.approach_velocity**2 / (2.0 * 9.80665)
    again = bounce_quietly(scene, resolution=f"{0.01 * height!r} m").bounces[1]
    where = "rigid ball at 200 yield velocities, its rebound back on the dent"
    by = "finite elements, examples/finite_elements/again.py"
    ratio = -again.velocity_after / again.velocity_before
    found.append(Row(where, "restitution of `film-model bounce`", 0.9970, "", by, ratio))
    return found


def _yields(speeds: float, exponent: float) -> fm.Scene:
    """The impact of a rigid ball at a velocity in yield velocities."""
    soft = {**STEEL, "yield_strength": "1.05 GPa", "strain_hardening_exponent": exponent}
    scene = _on(fm.HalfSpace(soft), RIGID).replace({"effects.wave_losses": False})
    ratio = yield_velocities(scene)
    return scene.replace({"impactor.velocity": f"{speeds / ratio!r} m/s"})


def _falling() -> list[Row]:
    """Hail: the fall in steps of 1 ms, with Schiller and Naumann's drag at each velocity."""
    ball = fm.Sphere("10 mm", material="ice", drop_height="500 m")
    scene, velocity, way = fm.Scene(ball, fm.HalfSpace("aluminium")), 0.0, 0.0
    while way < 500.0:
        reynolds = max(1.204 * 0.02 * velocity / 1.813e-5, 1e-9)
        coefficient = max(24.0 / reynolds * (1.0 + 0.15 * reynolds**0.687), 0.44)
        drag = 0.5 * 1.204 * coefficient * math.pi * 0.01**2 * velocity**2
        velocity += 1e-3 * (9.80665 - drag / scene.mass)
        way += 1e-3 * velocity
    left = 1.0 - (_effect(scene, "air_drag").change or 0.0)
    by = "the fall integrated, a smooth sphere; 18.2 m/s with C_d = 0.6"
    where = "hailstone of 20 mm from 500 m, 99 m/s without air"
    return [Row(where, "velocity (`air_drag`)", velocity, "m/s", by, ball.path_speed * math.sqrt(left))]


def _steep() -> list[Row]:
    """Contacts of large slope: an elastic ball on a rigid plane under Hertz's law."""
    found: list[Row] = []
    soft = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3, "density": "1000 kg/m^3"}
    for slope, counted in ((0.13, 5.7), (0.27, 12.1), (0.42, 17.1)):
        scene = _on(fm.HalfSpace(RIGID), soft).replace({"contact.law": "hertz"})
        stiffness = 4.0 / 3.0 * (scene.effective_modulus or math.nan) * math.sqrt(scene.effective_radius)
        energy = 0.4 * stiffness * (slope**2 * scene.effective_radius) ** 2.5
        scene = scene.replace({"impactor.velocity": f"{math.sqrt(2.0 * energy / scene.mass)!r} m/s"})
        by = "finite elements with the ball's inertia, examples/finite_elements/ball.py"
        where = f"elastic ball on a rigid plane, a/R = {slope} by Hertz"
        found.append(Row(where, "force (`small_slope`)", counted, "%", by, _change(scene, "small_slope")))
    return found


def compared() -> str:
    """The table as Markdown."""
    lines = ["| scene | quantity | counted | by | package | package/counted |", "|---|---|---|---|---|---|"]
    lines += [
        f"| {row.scene} | {row.quantity} | {f'{row.counted:.3g} {row.unit}'.strip()} | {row.by} | "
        f"{f'{row.found:.3g} {row.unit}'.strip()} | "
        f"{row.found / row.counted:.2f} |"
        for row in rows()
    ]
    return "\n".join(lines) + "\n"

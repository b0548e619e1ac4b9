"""Effects as the package judges them beside numbers that were found without it: a part of docs/effects.md."""

from __future__ import annotations

import math
import re
from typing import Any, NamedTuple

import film_model as fm
from film_model.effects.choose import choose
from film_model.effects.effect import Effect
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
    return found


def compared() -> str:
    """The table as Markdown."""
    lines = ["| scene | quantity | counted | by | package | package/counted |", "|---|---|---|---|---|---|"]
    lines += [
        f"| {row.scene} | {row.quantity} | {row.counted:.3g} {row.unit} | {row.by} | {row.found:.3g} {row.unit} | "
        f"{row.found / row.counted:.2f} |"
        for row in rows()
    ]
    return "\n".join(lines) + "\n"

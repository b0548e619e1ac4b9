"""Write docs/oblique.md and its picture: oblique impact beside measurements, finite elements and usual models.

`python examples/oblique_page.py [FOLDER]`. Nothing is fitted; every number is computed here but those that are quoted.
"""

import csv
import math
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import film_model as fm
from film_model.plot.style import COLOURS, HIGHLIGHT, picture
from film_model.solve.simulate import simulate_quietly
from film_model.studies.tangential_models import MODELS, theory

EXAMPLES = Path(__file__).parent
DOCS = EXAMPLES.parent / "docs"
SCENE, MEASURED = (EXAMPLES / "measurements" / name for name in ("alumina_on_glass.toml", "kharaz_2001.csv"))

COMPARED = {"mindlin": "Mindlin's spring", "mindlin_rescale/force": "rescaled", "hooke": "Hooke", "rigid": "rigid"}
"""Models of the table, and their headings."""

CONTACT_ANGLES = (
    *((2.10, 0.77), (3.94, 0.77), (9.72, -1.06), (20.31, -8.53), (30.16, -2.55)),
    *((39.12, 9.91), (49.51, 30.0), (59.90, 49.95), (70.46, 66.90), (84.78, 85.68)),
)
"""Angle of impact and measured angle of the contact point's rebound, degrees: figure 1 of the same digitisation."""

FINITE_ELEMENTS = (
    *((1.190, -0.213), (1.553, -0.373), (1.915, -0.627), (2.314, -0.947), (2.786, -1.253), (3.317, -1.520)),
    *((3.970, -1.720), (4.755, -1.707), (5.758, -1.200), (7.124, 0.133), (9.118, 2.147)),
)
"""Wu's finite elements, elastic, ν = 0.3: κψ₁ = tan θ/µ and κψ₂, as digitised for Kratos (benchmark5_graph1)."""

SIZE, DPI = (10.0, 4.4), 110

TEXT = """# Oblique impact: theory, measurements and other models

<!-- written by examples/oblique_page.py -->

See also [how to simulate it](how_to/oblique_impact.md) and [the method](method.md#15-oblique-impact).

![Rebound of the contact point, and tangential restitution over the angle](oblique.png)

Left: sliding velocity v of the contact point after the impact over that before, ψ = v/(κ µ V_n), for χ = {chi:.4f}.
From ψ₁ = {end:.3f} = 4χ − 1 on the contact slides throughout; below, what it has stored along the surface throws the
contact point back: ψ₂ < 0. Right: tangential restitution of the same impacts.

## Alumina on glass

Kharaz, Gorham & Salman (2001): alumina balls of 5 mm on glass, 3.9 m/s, µ = 0.092, no spin before
(`examples/measurements/`). Digitisations of their figures differ by up to 0.4° and 0.005. Computed with Hertz's law,
e = 1 (measured 0.98), nothing fitted.

Tangential restitution:

{restitution}

| model, stiffness 8 G* a | in a contact that grows, shrinks and slips |
|---|---|
| Mindlin's spring (`mindlin` in LAMMPS; LIGGGHTS, MFiX) | its length accumulates, its force is cut at µ F |
| rescaled (`mindlin_rescale/force`) | its force accumulates, and shrinks with the contact radius on the way out |
| Hooke | both springs are linear, K_t = K_n/κ |
| rigid | the contact slides until it rolls |

At small angles the rim of the contact slips on the way out although its middle sticks, and takes tangential velocity.
A spring with one slider does not slip then: `mindlin` gives the whole velocity back.

Spin after the impact (opposite to the sliding before):

{spin}

Angle of the path of the centre to the normal after the impact:

{angle}

Difference of the models from the theory in ψ₂, over 0 < ψ₁ ≤ 6 and for alike bodies with ν = 0.3 (χ = {steel:.4f}):

{models}

## Finite elements

Elastic ball, ν = 0.3, µ = 0.3, 5 m/s (Wu; test 5 of Chung & Ooi 2011): tangential velocity of the contact point over
µ V_n.

{elements}
"""


def table(heads: list[str], rows: list[list[str]]) -> str:
    """A table of Markdown."""
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in rows])


def measured() -> dict[str, list[tuple[float, float]]]:
    """Angle of impact, °, and value, by the name of the column without its unit."""
    lines = [line for line in MEASURED.read_text("utf-8").splitlines() if not line.startswith("#")]
    found: dict[str, list[tuple[float, float]]] = {}
    for row in csv.DictReader(lines, skipinitialspace=True):
        values = {name.partition(" ")[0]: float(text) for name, text in row.items() if text.strip()}
        for name in values.keys() - {"velocity", "angle"}:
            found.setdefault(name, []).append((values["angle"], values[name]))
    return found


def ours(scene: fm.Scene, angle: float) -> Mapping[str, float]:
    """Results of the scene at an angle, °."""
    found = simulate_quietly(scene.replace({"impactor.angle": f"{angle} deg"})).oblique
    assert found is not None
    return found.summary


def restitution_of(found: Mapping[str, float], before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Tangential restitution of ψ₂ after ψ₁: 1 − c (ψ₁ − ψ₂)/ψ₁, with c from an impact of the scene without spin."""
    lost = 1.0 - found["contact_point_rebound_velocity"] / sliding_before(found)
    return 1.0 - (1.0 - found["tangential_restitution"]) / lost * (before - after) / before


def sliding_before(found: Mapping[str, float]) -> float:
    """Without spin before, that of the centre, m/s."""
    return found["tangential_rebound_velocity"] / found["tangential_restitution"]


def restitution_rows(scene: fm.Scene, values: list[tuple[float, float]]) -> tuple[str, dict[str, np.ndarray]]:
    """The table of tangential restitutions, and what each model is off by."""
    rows: list[list[float]] = []
    for angle, value in values:
        found = ours(scene, angle)
        chi, before = found["tangential_parameter"], np.array([found["impact_number"]])
        models = (float(restitution_of(found, before, MODELS[name](chi, before))[0]) for name in COMPARED)
        rows.append([angle, value, found["tangential_restitution"], *models])
    numbers = np.array(rows)
    off = {name: numbers[:, 2 + k] - numbers[:, 1] for k, name in enumerate(("ours", *COMPARED))}
    cells = [[f"{row[0]:.2f}", *(f"{value:.4f}" for value in row[1:])] for row in rows]
    largest = ["largest error", "", *(f"{np.abs(one).max():.3f}" for one in off.values())]
    rms = ["rms error", "", *(f"{math.sqrt(float(np.mean(one**2))):.3f}" for one in off.values())]
    return table(["angle, °", "measured", "film-model", *COMPARED.values()], [*cells, largest, rms]), off


def plain_rows(scene: fm.Scene, name: str, values: list[tuple[float, float]], unit: str, size: float) -> str:
    """Measured and computed values of one result."""
    rows = [[f"{angle:.2f}", f"{value:.4g}", f"{ours(scene, angle)[name] / size:.4g}"] for angle, value in values]
    return table(["angle, °", f"measured, {unit}", f"film-model, {unit}"], rows)


def alike(ratio: float = 0.3) -> fm.Scene:
    """A ball on a half-space of the same material."""
    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": ratio, "density": "7850 kg/m^3"}
    return fm.Scene(fm.Sphere("5 mm", "3 m/s", material=steel), fm.HalfSpace(steel))


def model_rows(chi: float) -> str:
    """Largest and rms difference of each model in ψ₂."""
    before = np.linspace(0.05, 6.0, 120)
    exact, rows = theory(alike(), before), list[list[str]]()
    for name, model in MODELS.items():
        off = model(chi, before) - exact
        worst = int(np.abs(off).argmax())
        rms = math.sqrt(float(np.mean(off**2)))
        rows.append([f"`{name}`", f"{abs(off[worst]):.2f}", f"{before[worst]:.2f}", f"{rms:.2f}"])
    return table(["model", "largest difference", "at ψ₁", "rms"], rows)


def element_rows(kappa: float) -> str:
    """Wu's finite elements beside the theory."""
    points = np.array(FINITE_ELEMENTS)
    own = kappa * theory(alike(), points[:, 0] / kappa)
    rows = [[f"{x:.3f}", f"{y:.3f}", f"{z:.3f}"] for (x, y), z in zip(FINITE_ELEMENTS, own, strict=True)]
    return table(["tan θ/µ", "finite elements", "film-model"], rows)


def draw(figure: Figure, scene: fm.Scene, found: Mapping[str, float], values: list[tuple[float, float]]) -> None:
    """ψ₂ over ψ₁ with its limits, and the tangential restitution over the angle."""
    figure.set_layout_engine("constrained")
    left, right = figure.subplots(1, 2)
    chi, unit = found["tangential_parameter"], math.tan(math.radians(20.0)) / found["impact_number"]  # κ µ
    before = np.concatenate([np.linspace(0.02, 1.2, 24), np.linspace(1.3, 8.0, 40)])
    exact = theory(scene, before)
    angles = np.degrees(np.arctan(before * unit))
    left.plot(before, before * exact[0] / before[0], ":", color="0.4", label="sticking limit")
    left.plot(before, before - 4.0 * chi, "--", color="0.4", label="sliding limit")
    for colour, (name, head) in zip((COLOURS[0], COLOURS[1], COLOURS[3], COLOURS[4]), COMPARED.items(), strict=True):
        after = MODELS[name](chi, before)
        left.plot(before, after, color=colour, linewidth=1.0, label=head)
        right.plot(angles, restitution_of(found, before, after), color=colour, linewidth=1.0, label=head)
    left.plot(before, exact, color=HIGHLIGHT, label="film-model")
    right.plot(angles, restitution_of(found, before, exact), color=HIGHLIGHT, label="film-model")
    seen = np.tan(np.radians(np.array(CONTACT_ANGLES))) / unit
    left.plot(*seen[seen[:, 0] < 8.0].T, "ko", markersize=4, label="Kharaz et al. 2001")
    right.plot(*np.array([pair for pair in values if pair[0] < angles[-1]]).T, "ko", markersize=4)
    left.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
    left.set(xlabel="ψ₁ before", ylabel="ψ₂ after", xlim=(0.0, 8.0), ylim=(-2.4, 2.4))
    right.set(xlabel="angle from the normal, °", ylabel="tangential restitution", xlim=(0.0, None), ylim=(0.5, 1.02))
    left.legend(fontsize=8, frameon=False, loc="lower right")


def main(folder: Path = DOCS) -> tuple[Path, Path]:
    """Write the page and its picture; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    scene, values = fm.Scene.from_toml(SCENE), measured()
    found, steel = ours(scene, 20.0), ours(alike().replace({"contact.friction": 0.2}), 20.0)
    parameter, kappa = steel["tangential_parameter"], 3.5 / (2.0 * steel["tangential_parameter"])
    text = TEXT.format(
        chi=found["tangential_parameter"],
        end=4.0 * found["tangential_parameter"] - 1.0,
        steel=parameter,
        restitution=restitution_rows(scene, values["tangential_restitution"])[0],
        spin=plain_rows(scene, "rebound_spin", values["rebound_spin"], "rad/s", -1.0),
        angle=plain_rows(scene, "rebound_angle", values["rebound_angle"], "°", math.radians(1.0)),
        models=model_rows(parameter),
        elements=element_rows(kappa),
    )
    page, drawn = folder / "oblique.md", folder / "oblique.png"
    page.write_text(text, encoding="utf-8")
    picture(drawn, lambda figure: draw(figure, scene, found, values["tangential_restitution"]), SIZE, DPI)
    return page, drawn


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:2])):
        print(path)

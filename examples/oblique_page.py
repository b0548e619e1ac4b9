"""Write docs/oblique.md and its picture: oblique impact beside measurements, finite elements and usual models.

`python examples/oblique_page.py [FOLDER]`. Nothing is fitted; every number is computed here but those that are quoted.
"""

import csv
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import film_model as fm
from film_datasets.reference_impacts.cases import cases, scene_of
from film_model.oblique.friction import results
from film_model.plot.style import COLOURS, HIGHLIGHT, picture
from film_model.scene.rolling import sliding_of
from film_model.solve.simulate import simulate_quietly
from film_model.studies.tangential_models import MODELS, theory

EXAMPLES = Path(__file__).parent
DOCS = EXAMPLES.parent / "docs"
FILES = ("alumina_on_glass.toml", "kharaz_2001.csv", "glass_on_glass.csv")
SCENE, MEASURED, GLASS = (EXAMPLES / "measurements" / name for name in FILES)

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

FRICTION, WALTON, RESTITUTION = 0.092, 0.44, 0.97
"""Of glass on glass in the chart below: friction, β₀ and normal restitution."""

PLATEAUS = (
    *(("soda-lime glass", (0.25, None), "0.44 ± 0.07"), ("chrome steel", (0.3, None), "0.54 ± 0.05")),
    ("soda-lime glass on aluminium", (0.25, 0.33), "0.31 ± 0.06"),
)
"""Bodies, Poisson's ratios (of both if they differ; their moduli are alike), and β₀ of the chart."""

SIZE, DPI = (10.0, 4.4), 110

TEXT = """# Oblique impact: theory, measurements and other models

<!-- written by examples/oblique_page.py -->

See also [how to simulate it](how_to/oblique_impact.md) and [the method](method.md#15-oblique-impact).

![Rebound of the contact point, and tangential restitution over the angle](oblique.png)

Left: sliding velocity v of the contact point after the impact over that before, ψ = v/(κ µ V_n), for χ = {chi:.4f}.
From ψ₁ = {end:.3f} = 4χ − 1 on the contact slides throughout; below, what it has stored along the surface throws it
back: ψ₂ < 0. Right: tangential restitution of these impacts.

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

At small angles the rim of the contact slips on the way out although its middle sticks, and takes tangential velocity,
which a spring with one slider, `mindlin`, gives back.

Spin after the impact, rad/s (opposite to the sliding before):

{spin}

Angle of the centre's path to the normal after the impact, °:

{angle}

Angle of the contact point's path, °, negative where it is thrown back:

{contact_angle}

Difference of the models to the theory in ψ₂, for 0 < ψ₁ ≤ 6 and alike bodies with ν = 0.3 (χ = {steel:.4f}):

{models}

## Glass on glass

24 impacts of balls of 3.18 mm on each other at 0.6 to 1.3 m/s, by the method of Foerster, Louge, Chang & Allia (1994);
14 of them do not slide throughout. Source: a worksheet of Louge's laboratory at Cornell, transcribed with its chart of
1999 by svenviktorjonsson/rigid-body-collisions (`examples/measurements/`). The chart has µ = 0.092, e = 0.97 and
β₀ = 0.44 of Walton's model, −β₀ ψ₁ or sliding. film-model takes µ and ν = 0.25; Walton's β₀ is fitted to such impacts.

{glass}

Walton's β₀ beside the largest −ψ₂/ψ₁ of the theory, which is elastic; on aluminium e is 0.83:

{plateaus}

## Finite elements

Elastic ball, ν = 0.3, µ = 0.3, 5 m/s (Wu; test 5 of Chung & Ooi 2011): tangential velocity of the contact point over
µ V_n.

{elements}

## Test cases of Chung & Ooi in closed form

Tests 3 to 8 (2011, *Granular Matter* 13:643) in the [reference impacts](reference_impacts.md), where a formula is
exact: test 3 gives the restitution; contacts that slide throughout have v₂/v₁ = 1 − 4χ/ψ₁. In test 7 nothing slides.

{cases}

## Cost

Microseconds an impact (Hertz's law, χ = 1.4412; `python -m benchmarks.oblique`): the exact solution alone, and by its
table in batches and sweeps, beside Dormand–Prince 5(4), compiled by numba, on as many springs that slip as the error
needs.

| contact | largest error of the springs in ψ₂ | Dormand–Prince | springs | exact, error 6e-10 | table, error 1e-8 |
|---|---|---|---|---|---|
| sticks first | 1e-2 | 20 | 16 | 67 | 0.32 |
|  | 1e-3 | 170 | 64 | 67 | 0.32 |
| slides first | 1e-2 | 11 | 32 | 53 | 0.29 |
|  | 1e-3 | 300 | 128 | 53 | 0.29 |
| slides throughout | 1e-3 | 2.9 | 32 | 0.11 | 0.11 |
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


def of_models(scene: fm.Scene, angle: float) -> dict[str, Mapping[str, float]]:
    """Results of the scene at an angle, °, and those that follow from each model's ψ₂."""
    history = simulate_quietly(scene.replace({"impactor.angle": f"{angle} deg"}))
    given, oblique = sliding_of(history.scene), history.oblique
    assert given is not None and oblique is not None
    chi, before = (oblique.summary[name] for name in ("tangential_parameter", "impact_number"))
    found: dict[str, Mapping[str, float]] = {"film-model": oblique.summary}
    for name, heading in COMPARED.items():
        after = float(MODELS[name](chi, np.array([before]))[0]) / before * given.velocity
        found[heading] = results(history.scene, given, history.summary["rebound_velocity"], after, (0.0, 0.0))
    return found


def contact_angle(found: Mapping[str, float]) -> float:
    """Between the normal and the velocity of the contact point after the impact, °."""
    normal = found["tangential_rebound_velocity"] / math.tan(found["rebound_angle"])
    return math.degrees(math.atan2(found["contact_point_rebound_velocity"], normal))


def compared_rows(
    scene: fm.Scene, points: Iterable[tuple[float, float]], value: Callable[[Mapping[str, float]], float], digits: str
) -> tuple[str, dict[str, np.ndarray]]:
    """The table of a measured result over the angle of impact, °, and what ours and each model are off by."""
    rows = [(angle, seen, *map(value, of_models(scene, angle).values())) for angle, seen in points]
    numbers = np.array(rows)
    off = {name: numbers[:, 2 + k] - numbers[:, 1] for k, name in enumerate(("film-model", *COMPARED.values()))}
    cells = [[f"{row[0]:.2f}", *(format(each, digits) for each in row[1:])] for row in rows]
    largest = ["largest error", "", *(format(np.abs(one).max(), digits) for one in off.values())]
    rms = ["rms error", "", *(format(math.sqrt(float(np.mean(one**2))), digits) for one in off.values())]
    return table(["angle, °", "measured", *off], [*cells, largest, rms]), off


def alike(ratio: float = 0.3, other: float | None = None) -> fm.Scene:
    """A ball on a half-space of the same material, or of another Poisson's ratio."""
    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": ratio, "density": "7850 kg/m^3"}
    target = steel | {"poissons_ratio": ratio if other is None else other}
    return fm.Scene(fm.Sphere("5 mm", "3 m/s", material=steel), fm.HalfSpace(target))


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


def case_rows() -> str:
    """Tests of Chung & Ooi whose results are known in closed form."""
    rows = list[list[str]]()
    for name, case in cases().items():
        if not name.startswith("chung-ooi"):
            continue
        history = simulate_quietly(scene_of(case))
        oblique, given = history.oblique, history.scene.contact.parameters.get("restitution")
        if given is not None:
            exact = "coefficient of restitution", float(given), history.summary["coefficient_of_restitution"]
        elif oblique is not None and oblique.sliding_regime == "slides throughout":
            found, before = oblique.summary, oblique.motion["sliding_velocity"][0]
            slid = 1.0 - 4.0 * found["tangential_parameter"] / found["impact_number"]
            exact = "v₂/v₁", slid, found["contact_point_rebound_velocity"] / before
        else:
            continue
        rows.append([name.removeprefix("chung-ooi-"), exact[0], *(f"{value:.6f}" for value in exact[1:])])
    return table(["test", "result", "exact", "film-model"], rows)


def walton(before: np.ndarray, chi: float) -> np.ndarray:
    """ψ₂ of Walton's model."""
    slid = before - 2.0 * chi * (1.0 + RESTITUTION)
    return np.maximum(-WALTON * before, slid)


def glass_rows() -> str:
    """Impacts of glass on glass below ψ₁ = 4χ − 1, and what each model is off by."""
    lines = [line for line in GLASS.read_text("utf-8").splitlines() if not line.startswith("#")]
    normal, sliding, _, after = np.loadtxt(lines[1:], delimiter=",", unpack=True)
    chi = 7.0 * (1.0 - 0.25) / (2.0 * (2.0 - 0.25))
    unit = 3.5 / (2.0 * chi) * FRICTION * normal
    before, seen = sliding / unit, after / unit
    order = np.argsort(before)[: int((before < 4.0 * chi - 1.0).sum())]
    before, seen = before[order], seen[order]
    found = {"film-model": theory(alike(0.25), before), "Walton": walton(before, chi)}
    found |= {COMPARED[name]: MODELS[name](chi, before) for name in COMPARED}
    columns = (before, seen, *found.values())
    cells = [[f"{value:.2f}" for value in row] for row in zip(*columns, strict=True)]
    rms = (f"{math.sqrt(float(np.mean((values - seen) ** 2))):.2f}" for values in found.values())
    return table(["ψ₁", "measured ψ₂", *found], [*cells, ["rms difference", "", *rms]])


def plateau_rows() -> str:
    """Walton's β₀, measured, beside the theory."""
    before, rows = np.linspace(1.0, 4.5, 71), list[list[str]]()
    for name, (ratio, other), value in PLATEAUS:
        after = theory(alike(ratio, other), before)
        rows.append([name, value, f"{float((-after / before).max()):.2f}"])
    return table(["bodies", "measured β₀", "film-model"], rows)


def tables(values: Mapping[str, list[tuple[float, float]]]) -> dict[str, tuple[Any, ...]]:
    """Measured points, value and digits of each table of the alumina balls."""
    restitution, spin, angle = (values[name] for name in ("tangential_restitution", "rebound_spin", "rebound_angle"))
    return {
        "restitution": (restitution, itemgetter("tangential_restitution"), ".4f"),
        "spin": (spin, lambda found: -found["rebound_spin"], ".1f"),
        "angle": (angle, lambda found: math.degrees(found["rebound_angle"]), ".2f"),
        "contact_angle": (CONTACT_ANGLES, contact_angle, ".2f"),
    }


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
        **{name: compared_rows(scene, *given)[0] for name, given in tables(values).items()},
        models=model_rows(parameter),
        glass=glass_rows(),
        plateaus=plateau_rows(),
        elements=element_rows(kappa),
        cases=case_rows(),
    )
    page, drawn = folder / "oblique.md", folder / "oblique.png"
    page.write_text(text, encoding="utf-8")
    picture(drawn, lambda figure: draw(figure, scene, found, values["tangential_restitution"]), SIZE, DPI)
    return page, drawn


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:2])):
        print(path)

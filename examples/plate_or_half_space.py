"""When is a plate a half-space? One ball on aluminium plates of growing thickness.

A thin plate carries energy away in bending waves, so the ball hardly rebounds; on a thick one only the dent costs
energy, as on a half-space. Zener's λ tells which: the table and the figure show the restitution against it. Thin-plate
theory holds while a wave crosses the thickness several times during contact; beyond, λ is small and hardly matters.
"""

import sys

from matplotlib.figure import Figure

import film_model as fm

THICKNESSES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)  # mm
BALL = fm.Sphere(radius="5 mm", velocity="1 m/s", material="bearing steel")
ALUMINIUM = "aluminium 6061-T6"
BLUE, VERMILION = "#0072B2", "#D55E00"  # of Okabe and Ito's palette


def restitution(target: fm.HalfSpace | fm.Plate, plasticity: bool) -> tuple[float, float]:
    """Zener's λ and the coefficient of restitution."""
    effects = fm.Effects(plasticity=plasticity, target_motion=True, gravity=False)  # even if the change is small
    history = fm.simulate(fm.Scene(BALL, target, effects=effects), accuracy=1e-6)
    motion = next(effect for effect in history.effects if effect.name == "target_motion")
    return motion.value, history.summary["coefficient_of_restitution"]


def main() -> dict[str, list[float]]:
    """Columns by name: thickness [mm], λ, restitution with and without plasticity; the half-space is the last row."""
    plates = [fm.Plate(material=ALUMINIUM, thickness=f"{thickness} mm") for thickness in THICKNESSES]
    targets = [*plates, fm.HalfSpace(material=ALUMINIUM)]
    elastic = [restitution(target, plasticity=False) for target in targets]
    plastic = [restitution(target, plasticity=True) for target in targets]
    return {
        "thickness": [*map(float, THICKNESSES), float("inf")],
        "lambda": [zener for zener, _ in elastic],
        "elastic": [e for _, e in elastic],
        "plastic": [e for _, e in plastic],
    }


def draw(columns: dict[str, list[float]], path: str) -> None:
    """Restitution against thickness, as a PNG."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    thickness = columns["thickness"][:-1]
    for name, colour, marker in (("elastic", BLUE, "o"), ("plastic", VERMILION, "s")):
        axes.semilogx(thickness, columns[name][:-1], color=colour, marker=marker, label=f"plate, {name}")
        axes.axhline(columns[name][-1], color=colour, linestyle="--", label=f"half-space, {name}")
    ticks = [1, 2, 4, 8, 16, 32, 64]
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set(xlabel="plate thickness [mm]", ylabel="coefficient of restitution", ylim=(0.0, 1.05))
    axes.set_title("Steel ball, radius 5 mm, 1 m/s, on aluminium")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    result = main()
    print(f"{'thickness, mm':>14}{'λ':>10}{'e, elastic':>14}{'e, plastic':>14}")
    for row in zip(*result.values(), strict=True):
        print("{:14g}{:10.4f}{:14.5f}{:14.5f}".format(*row))
    draw(result, sys.argv[1] if len(sys.argv) > 1 else "plate_or_half_space.png")

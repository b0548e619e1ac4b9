"""Table 3 of Big-Alabo, Cartmell & Harrison 2017, recomputed and compared with exact values.

The paper uses five chords per stage. With Big-Alabo's law, its permanent indentation of 1.78 µm is reproduced only with
constants="printed", its impact duration only with the continuous ones. "exact" is quadrature of the energy integral.
"""

from pathlib import Path

import film_model as fm
from film_model.effects.choose import problem_of
from film_model.studies import quadrature

SCENES = Path(__file__).parent / "scenes"

ROWS = {  # summary name: heading, factor from SI, the paper's values for Big-Alabo's and Stronge's law
    "contact_duration": ("Impact duration, µs", 1e6, 105.14, 79.78),
    "time_of_maximum_indentation": ("Time at maximum indentation, µs", 1e6, 55.57, 43.24),
    "permanent_indentation": ("Permanent indentation, µm", 1e6, 1.78, 2.09),
    "maximum_indentation": ("Maximum indentation, µm", 1e6, 9.45, 7.44),
    "maximum_force": ("Maximum impact force, N", 1.0, 513.41, 657.29),
    "rebound_velocity": ("Final rebound velocity, m/s", -1.0, 0.23, 0.22),
    "coefficient_of_restitution": ("Coefficient of restitution", 1.0, 0.92, 0.87),
}


def five_segments(scene: fm.Scene, linearisation: str) -> dict[str, float]:
    """Summary of the impact with five segments per stage, in the units of the table."""
    summary = fm.simulate(scene, segments=5, linearisation=linearisation).summary
    return {name: summary[name] * factor for name, (_, factor, *_) in ROWS.items()}


def exact(scene: fm.Scene) -> dict[str, float]:
    """Exact summary of the half-space impact, in the units of the table."""
    summary = quadrature.quadrature(problem_of(scene).law, scene.mass, scene.approach_velocity)
    return {name: summary[name] * factor for name, (_, factor, *_) in ROWS.items()}


def main() -> dict[str, dict[str, dict[str, float]]]:
    """Values by law, then by method, then by summary name, in the units of the table."""
    big_alabo = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    printed = big_alabo.replace({"contact.law": "big-alabo", "contact.constants": "printed"})
    stronge = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel_stronge.toml")
    return {
        "Big-Alabo's law": {
            "paper": {name: row[2] for name, row in ROWS.items()},
            "chord": five_segments(big_alabo, "chord"),
            "chord, printed": five_segments(printed, "chord"),
            "work-preserving": five_segments(big_alabo, "work-preserving"),
            "exact": exact(big_alabo),
        },
        "Stronge's law": {
            "paper": {name: row[3] for name, row in ROWS.items()},
            "chord": five_segments(stronge, "chord"),
            "work-preserving": five_segments(stronge, "work-preserving"),
            "exact": exact(stronge),
        },
    }


def show(table: dict[str, dict[str, dict[str, float]]]) -> str:
    """The values as aligned text."""
    lines = []
    for law, columns in table.items():
        lines.append(f"{law:32}" + "".join(f"{method:>17}" for method in columns))
        for name, (heading, *_) in ROWS.items():
            cells = (f"{values[name]:17.{2 if method == 'paper' else 4}f}" for method, values in columns.items())
            lines.append(f"{heading:32}" + "".join(cells))
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    print(show(main()))

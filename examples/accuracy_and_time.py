"""Error against computing time for the three cases of Big-Alabo, Cartmell & Harrison 2017: docs/cost.png.

All installed methods run each impact at several settings (`pip install '.[benchmark]'` installs all of them). It takes
one or two minutes on an otherwise idle machine.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import film_model as fm
from film_model.plot.cost import plot_studies
from film_model.studies.cost import Study, study
from film_model.studies.timing import one_thread

SCENES = Path(__file__).parent / "scenes"
PICTURE = Path(__file__).parent.parent / "docs" / "cost.png"
CASES = {
    "Big-Alabo, half-space": "tungsten_carbide_on_steel",
    "Stronge, half-space": "tungsten_carbide_on_steel_stronge",
    "Hertz, plate": "olsson_plate",
}


def main(picture: str | Path = PICTURE, methods: Sequence[str] | None = None) -> dict[str, Study]:
    """The studies by case; draws them side by side."""
    wide = {"effects.boundary_reflections": False}
    studies = {
        name: study(fm.Scene.from_toml(SCENES / f"{file}.toml").replace(wide), methods=methods)
        for name, file in CASES.items()
    }
    plot_studies(list(studies.items()), picture)
    return studies


if __name__ == "__main__":
    one_thread()
    for case, done in main(*sys.argv[1:2]).items():
        print(case)
        for line in (*(done.sentence(error) for error in (1e-3, 1e-4, 1e-6)), *done.beaten()):
            print(f"  {line}")
